#include <float.h>
#include <string.h>

#include "flight/flight.h"
#include "flight/relative_path.h"

static void add_free(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at, double clock, int body, double sign,
                     struct separation_path *out)
{
    struct vec3 force[3];
    flight_force(q, body, clock, force);
    struct vec3 rate[SEPARATION_DEGREE];
    const int terms = flight_velocity(v, body, at->velocity[body], force, rate);
    for (int i = 0; i < terms; ++i) {
        out->w[i] = vec3_axpy(out->w[i], sign, rate[i]);
        out->c[i + 1] = vec3_axpy(out->c[i + 1], sign * FLIGHT_MEAN[i], rate[i]);
    }
}

static void add_prescribed(const struct scene_state *q, double clock, int body, double sign,
                           struct separation_path *out)
{
    struct body_path path = q->path[body];
    path_shift(path.displacement, 4, clock);
    path_shift(path.velocity, 3, clock);
    for (int i = 1; i < 4; ++i) {
        out->c[i] = vec3_axpy(out->c[i], sign, path.displacement[i]);
    }
    for (int i = 0; i < 3; ++i) {
        out->w[i] = vec3_axpy(out->w[i], sign, path.velocity[i]);
    }
}

struct separation_path separation_path_of(const struct scene_values *v, const struct scene_state *q,
                                          const struct scene_instant *at, double clock, int contact)
{
    const int ends[2] = {contact_destination(contact), contact_source(contact)};
    struct separation_path path = {.c = {at->separation[contact]}, .offset = at->geometry[contact].offset};
    for (int i = 0; i < 2; ++i) {
        const double sign = i == 0 ? 1.0 : -1.0;
        if (SCENE_ANY_FREE && body_is_free(v, ends[i])) {
            add_free(v, q, at, clock, ends[i], sign, &path);
        } else if (body_is_prescribed(v, ends[i])) {
            add_prescribed(q, clock, ends[i], sign, &path);
        }
    }
    return path;
}

/* Sets the lever arms of the compound bodies of a contact, and takes them off c, which then leads from centre
 * of mass to centre of mass. */
static void put_levers(const struct scene_values *v, const struct scene_state *q,
                       const struct scene_instant *at, double clock, int contact,
                       struct advancement_path *path)
{
    for (int end = 0; SCENE_ANY_COMPOUND && end < 2; ++end) {
        const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
        const struct vec3 part = end == 0 ? contact_source_part(contact) : contact_destination_part(contact);
        const double length = vec3_norm(part);
        if (!(length > 0.0)) {
            continue;
        }
        const struct vec3 lever = scene_lever(at, contact, end);
        const struct vec3 axis = vec3_scale(1.0 / vec3_norm(lever), lever);
        const struct body_turn *turn = &at->turning.body[body];
        struct body_path follows = q->path[body];
        path_shift(follows.angular_velocity, 3, clock);
        path_shift(follows.torque, 3, clock);
        path->lever_length[end] = length;
        path->lever[end] = axis_motion_fixed(axis);
        path->c[0] = vec3_axpy(path->c[0], end == 0 ? 1.0 : -1.0, lever); /* to the centres of mass */
        if (body_turns_freely(v, body)) {
            path->lever[end] = axis_motion_tumbling(vec3_scale(1.0 / length, part), turn,
                                                    body_principal_inertia(v, body), follows.torque);
        } else if (body_turn_is_prescribed(v, body) && follows.turn_follows == TURN_FOLLOWS_VELOCITY) {
            path->lever[end] = axis_motion_prescribed(axis, follows.angular_velocity, 3);
        }
    }
}

static struct axis_motion prescribed_axis(const struct scene_state *q, const struct body_turn *turn,
                                          double clock, int body)
{
    struct body_path path = q->path[body];
    path_shift(path.angular_velocity, 3, clock);
    path_shift(path.axis, 3, clock);
    const bool by_axis = path.turn_follows != TURN_FOLLOWS_VELOCITY && !vec3_is_zero(path.axis[0]);
    return by_axis
               ? axis_motion_following(path.axis, 3)
               : axis_motion_prescribed(quaternion_third_axis(turn->orientation), path.angular_velocity, 3);
}

struct advancement_path advancement_path_of(const struct scene_values *v, const struct scene_state *q,
                                            const struct scene_instant *at, double clock, int contact)
{
    const struct separation_path separation = separation_path_of(v, q, at, clock, contact);
    const int destination = contact_destination(contact);
    struct advancement_path path = {.shape = scene_contact_shape_at(v, q, at, contact),
                                    .rounding = rounding_of_gap(v, at, contact)};
    memcpy(path.c, separation.c, sizeof path.c);
    for (int i = 0; SCENE_ANY_PRESCRIBED && i < SEPARATION_DEGREE; ++i) {
        path.mismatch[i] = vec3_axpy(separation.w[i], -(i + 1), separation.c[i + 1]);
    }
    put_levers(v, q, at, clock, contact, &path);
    if (SCENE_ANY_AXIS) {
        path.axis = axis_motion_fixed(path.shape.axis);
    }
    if (contact_tips(v, contact)) {
        const struct body_turn *turn = &at->turning.body[destination];
        path.axis = SCENE_ANY_FREE && body_turns_freely(v, destination)
                        ? flight_axis_motion(v, q, turn, destination)
                        : prescribed_axis(q, turn, clock, destination);
    }
    return path;
}

bool relative_path_has_ends(const struct contact_shape *shape)
{
    return !SCENE_ANY_ENDLESS || (SCENE_ANY_CYLINDER && isfinite(shape->half_length));
}

static double coefficient_scale(const struct vec3 *c, double horizon, double reach)
{
    double scale = reach;
    double power = 1.0;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        scale = fmax(scale, vec3_max_abs(c[i]) * power);
        power *= horizon;
    }
    return scale > 0.0 ? scale : 1.0;
}

static struct polynomial dot_product(const struct vec3 *a, int a_degree, const struct vec3 *b, int b_degree)
{
    struct polynomial p = {{0.0}, a_degree + b_degree};
    for (int i = 0; i <= a_degree; ++i) {
        for (int j = 0; j <= b_degree; ++j) {
            p.a[i + j] += vec3_dot(a[i], b[j]);
        }
    }
    return p;
}

struct relative_path relative_path_make(const struct contact_shape *shape,
                                        const struct separation_path *separation, double gap, double horizon)
{
    struct relative_path path = {
        .horizon = horizon, .axial = {.degree = SEPARATION_DEGREE}, .side = shape->side};
    path.flat = contact_is_plane(shape);
    struct vec3 slope[SEPARATION_DEGREE];
    struct vec3 w[SEPARATION_DEGREE];
    path.scale = coefficient_scale(separation->c, horizon, contact_reach(shape));
    double factor = 1.0 / path.scale;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        path.c[i] = vec3_scale(factor, separation->c[i]);
        if (SCENE_ANY_CYLINDER && shape->destination == SHAPE_CYLINDER) {
            path.axial.a[i] = vec3_dot(path.c[i], shape->axis);
            path.c[i] = vec3_axpy(path.c[i], -path.axial.a[i], shape->axis);
            if (i == 0 && contact_is_near_axis(path.c[0], path.axial.a[0])) {
                path.c[0] = vec3_scale(factor, separation->offset);
            }
        }
        if (relative_path_is_flat(&path)) {
            path.c[i] = vec3_make(-vec3_dot(path.c[i], shape->axis), 0.0, 0.0);
        }
        factor *= horizon;
        factor = factor < DBL_MAX ? factor : DBL_MAX; /* keeps a product with a zero coefficient finite */
        if (i < SEPARATION_DEGREE) {
            w[i] = vec3_scale(factor, separation->w[i]);
            if (relative_path_is_flat(&path)) {
                w[i] = vec3_make(-vec3_dot(w[i], shape->axis), 0.0, 0.0);
            }
        }
        if (i > 0) {
            slope[i - 1] = vec3_scale(i, path.c[i]);
        }
    }
    path.reach = contact_reach(shape) / path.scale;
    if (relative_path_has_ends(shape)) {
        /* both numbers are divided alike, so that a source in an end plane stays exactly there */
        path.axial.a[0] = vec3_dot(separation->c[0], shape->axis) / path.scale;
        path.half_length = shape->half_length / path.scale;
        path.has_ends = true;
    }
    path.degree = path_degree(path.c, SEPARATION_DEGREE + 1);
    path.start = vec3_norm(path.c[0]);
    path.gap = gap / path.scale;
    const struct vec3 unit = {1.0, 0.0, 0.0};
    const struct vec3 *by = relative_path_is_flat(&path) ? &unit : path.c;
    const int by_degree = relative_path_is_flat(&path) ? 0 : path.degree;
    path.closing = dot_product(by, by_degree, slope, path.degree > 0 ? path.degree - 1 : 0);
    path.half_rate = dot_product(by, by_degree, w, path_degree(w, SEPARATION_DEGREE));
    return path;
}

struct polynomial relative_path_distance_squared(const struct relative_path *path)
{
    return dot_product(path->c, path->degree, path->c, path->degree);
}

double relative_path_divisor(const struct relative_path *path, double gap)
{
    return relative_path_is_flat(path) ? 1.0 : path->side * gap + path->reach;
}

void relative_path_gap(const void *data, double s, double *gap, double *slope)
{
    const struct relative_path *path = data;
    const struct vec3 moved =
        path->degree > 0 ? vec3_scale(s, path_at(path->c + 1, path->degree, s)) : vec3_make(0.0, 0.0, 0.0);
    if (relative_path_is_flat(path)) {
        *gap = path->gap + moved.x;
        *slope = polynomial_at(&path->closing, s);
        return;
    }
    const double distance = vec3_norm(vec3_add(path->c[0], moved));
    const double both = path->start + distance;
    /* |a + b| - |a| = (2 a.b + b.b) / (|a + b| + |a|) */
    const double grown = both > 0.0 ? vec3_dot(vec3_axpy(moved, 2.0, path->c[0]), moved) / both : 0.0;
    *gap = path->gap + path->side * grown;
    *slope = distance > 0.0 ? path->side * polynomial_at(&path->closing, s) / distance : 0.0;
}

bool relative_path_within(const struct relative_path *path, double s)
{
    if (SCENE_ANY_ENDLESS && (!SCENE_ANY_CYLINDER || !path->has_ends)) {
        return true;
    }
    return s < path->ends_dead_band ? path->starts_within
                                    : fabs(polynomial_at(&path->axial, s)) <= path->half_length;
}

/* Returns a polynomial with the roots of (chi g')^2 = 1, where Hunt and Crossley's damping would begin to
 * pull: g' = side (c.w)/d, or n.w for a plane. */
static struct polynomial hertz_condition(const struct relative_path *path, const struct contact_law *law)
{
    const double unit = contact_factors_of(law).c * path->scale / path->horizon;
    const struct polynomial one = {{1.0}, 0};
    const struct polynomial distance2 =
        relative_path_is_flat(path) ? one : relative_path_distance_squared(path);
    const struct polynomial squared_rate = polynomial_multiply(&path->half_rate, &path->half_rate);
    struct polynomial sum = {{0.0}, 0};
    sum = polynomial_add(&sum, fmin(unit * unit, 1.0), &squared_rate);
    return polynomial_add(&sum, -fmin(1.0 / (unit * unit), 1.0), &distance2);
}

/* Returns `times` c c.w + k `spring`, both divided by `unit`, where k and c are those of compression. */
static struct polynomial law_sum(const struct relative_path *path, const struct contact_coefficients *full,
                                 double unit, const struct polynomial *spring, double times)
{
    struct polynomial sum = {{0.0}, 0};
    sum = polynomial_add(&sum, full->k / unit, spring);
    return polynomial_add(&sum, times * (full->c / path->horizon) / unit, &path->half_rate);
}

/* Adds the roots of the law's force to the candidates. For a plane k g + c g' is a polynomial. Else
 * k (d - reach) + c d' = 0 has the roots of (k d^2 + c d d')^2 = k^2 reach^2 d^2, and, multiplied by
 * d + reach with reach / d taken as 1, about those of another polynomial. The latter is the more exact the
 * smaller the gap is, where the squares have lost the gap to rounding. */
static int add_roots_of_law(const struct relative_path *path, const struct contact_law *law,
                            double *candidates, int count)
{
    const struct contact_coefficients full = contact_coefficients_of(law, REGIME_COMPRESSION);
    const double unit = fmax(full.k, full.c / path->horizon);
    if (relative_path_is_flat(path)) {
        struct polynomial gap = {{path->gap}, path->degree};
        for (int i = 1; i <= path->degree; ++i) {
            gap.a[i] = path->c[i].x;
        }
        const struct polynomial force = law_sum(path, &full, unit, &gap, 1.0);
        return polynomial_add_sign_changes(&force, candidates, count);
    }
    const struct polynomial offset2 = relative_path_distance_squared(path);
    const double reach_term = full.k / unit * path->reach;
    const struct polynomial sum = law_sum(path, &full, unit, &offset2, 1.0);
    const struct polynomial squared_sum = polynomial_multiply(&sum, &sum);
    const struct polynomial condition = polynomial_add(&squared_sum, -reach_term * reach_term, &offset2);
    struct polynomial squared_deviation = offset2;
    /* d^2 - reach^2 = (d - reach)(d + reach) has the digits of the gap */
    squared_deviation.a[0] = path->side * path->gap * (path->start + path->reach);
    const struct polynomial nearby = law_sum(path, &full, unit, &squared_deviation, 2.0);
    count = polynomial_add_sign_changes(&condition, candidates, count);
    return polynomial_add_sign_changes(&nearby, candidates, count);
}

struct extremes extremes_of(const struct relative_path *path)
{
    struct extremes found;
    found.count = polynomial_sign_changes(&path->closing, found.at);
    return found;
}

struct root_bracket_end flight_gap_bracket_end(const struct relative_path *path, double s)
{
    struct root_bracket_end end = {.s = s};
    relative_path_gap(path, s, &end.value, &end.slope);
    return end;
}

/* Sets the values of s where the gap passes zero; returns their number. */
static int touching_candidates(const struct relative_path *path, const struct extremes *extremes,
                               double *candidates)
{
    int count = 0;
    const int intervals = extremes->count + 1;
    struct root_bracket_end low = flight_gap_bracket_end(path, 0.0);
    for (int i = 0; i < intervals; ++i) {
        const struct root_bracket_end high =
            flight_gap_bracket_end(path, i < intervals - 1 ? extremes->at[i] : 1.0);
        if ((low.value < 0.0 && high.value > 0.0) || (low.value > 0.0 && high.value < 0.0)) {
            count = insert_sorted(root_between(relative_path_gap, path, low, high), candidates, count);
        }
        low = high;
    }
    return count;
}

int candidates_of_ends(const struct relative_path *path, double *candidates, int count)
{
    for (int end = -1; end <= 1; end += 2) {
        struct polynomial plane = path->axial;
        plane.a[0] += end * path->half_length;
        count = polynomial_add_sign_changes(&plane, candidates, count);
    }
    return path->ends_dead_band > 0.0 && path->ends_dead_band < 1.0
               ? insert_sorted(path->ends_dead_band, candidates, count)
               : count;
}

int candidates_of_all(const struct relative_path *path, const struct extremes *extremes,
                      const struct contact_shape *shape, const struct contact_law *law, double *candidates)
{
    int count = touching_candidates(path, extremes, candidates);
    if (relative_path_has_ends(shape)) {
        count = candidates_of_ends(path, candidates, count);
    }
    if (contact_has_events(law)) {
        count = polynomial_add_sign_changes(&path->half_rate, candidates, count);
        if (contact_is_hertz(law)) {
            const struct polynomial condition = hertz_condition(path, law);
            count = polynomial_add_sign_changes(&condition, candidates, count);
        } else if (contact_regime_after(law, REGIME_COMPRESSION) == REGIME_SEPARATING &&
                   contact_coefficients_of(law, REGIME_COMPRESSION).k > 0.0) {
            count = add_roots_of_law(path, law, candidates, count);
        }
    }
    return count;
}
