#include "segment/relative_path.h"

#include <float.h>

#if SCENE_ANY_FREE
#include "segment/flight.h"

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
#else /* there are none to be added */
static void add_free(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at, double clock, int body, double sign,
                     struct separation_path *out)
{
    (void)v, (void)q, (void)at, (void)clock, (void)body, (void)sign, (void)out;
}
#endif

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

/* Without contact force. */
struct separation_path separation_path_of(const struct scene_values *v, const struct scene_state *q,
                                          const struct scene_instant *at, double clock, int contact)
{
    const int ends[2] = {contact_destination(contact), contact_source(contact)};
    struct separation_path path = {.c = {at->separation[contact]}, .offset = at->geometry[contact].offset};
    for (int i = 0; i < 2; ++i) {
        const double sign = i == 0 ? 1.0 : -1.0;
        if (body_is_free(v, ends[i])) {
            add_free(v, q, at, clock, ends[i], sign, &path);
        } else if (body_is_prescribed(v, ends[i])) {
            add_prescribed(q, clock, ends[i], sign, &path);
        }
    }
    return path;
}

bool relative_path_has_ends(const struct contact_shape *shape)
{
    return SCENE_ANY_CYLINDER && isfinite(shape->half_length);
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

/* Without the highest coefficients that are zero. */
static int degree_of(const struct vec3 *a, int degree)
{
    while (degree > 0 && vec3_max_abs(a[degree]) == 0.0) {
        --degree;
    }
    return degree;
}

struct relative_path relative_path_make(const struct contact_shape *shape,
                                        const struct separation_path *separation, double gap, double horizon)
{
    struct relative_path path = {
        .horizon = horizon, .axial = {.degree = SEPARATION_DEGREE}, .side = shape->side};
    path.flat = SCENE_ANY_PLANE && shape->destination == SHAPE_PLANE;
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
        if (path.flat) {
            path.c[i] = vec3_make(-vec3_dot(path.c[i], shape->axis), 0.0, 0.0);
        }
        factor *= horizon;
        factor = factor < DBL_MAX ? factor : DBL_MAX; /* for coefficients that are zero */
        if (i < SEPARATION_DEGREE) {
            w[i] = vec3_scale(factor, separation->w[i]);
            if (path.flat) {
                w[i] = vec3_make(-vec3_dot(w[i], shape->axis), 0.0, 0.0);
            }
        }
        if (i > 0) {
            slope[i - 1] = vec3_scale(i, path.c[i]);
        }
    }
    path.reach = contact_reach(shape) / path.scale;
    if (relative_path_has_ends(shape)) {
        /* both divided alike, so that a source in the plane of an end is in it here, too */
        path.axial.a[0] = vec3_dot(separation->c[0], shape->axis) / path.scale;
        path.half_length = shape->half_length / path.scale;
        path.has_ends = true;
    }
    path.degree = degree_of(path.c, SEPARATION_DEGREE);
    path.start = vec3_norm(path.c[0]);
    path.gap = gap / path.scale;
    const struct vec3 unit = {1.0, 0.0, 0.0};
    const struct vec3 *by = path.flat ? &unit : path.c;
    const int by_degree = path.flat ? 0 : path.degree;
    path.closing = dot_product(by, by_degree, slope, path.degree > 0 ? path.degree - 1 : 0);
    path.half_rate = dot_product(by, by_degree, w, degree_of(w, SEPARATION_DEGREE - 1));
    return path;
}

struct polynomial relative_path_distance_squared(const struct relative_path *path)
{
    return dot_product(path->c, path->degree, path->c, path->degree);
}

struct polynomial relative_path_squared_deviation(const struct relative_path *path)
{
    struct polynomial squared_deviation = relative_path_distance_squared(path);
    /* d^2 - reach^2 = (d - reach)(d + reach) */
    squared_deviation.a[0] = path->side * path->gap * (path->start + path->reach);
    return squared_deviation;
}

double relative_path_divisor(const struct relative_path *path, double gap)
{
    return SCENE_ANY_PLANE && path->flat ? 1.0 : path->side * gap + path->reach;
}

void relative_path_gap(const void *data, double s, double *gap, double *slope)
{
    const struct relative_path *path = data;
    const struct vec3 moved =
        path->degree > 0 ? vec3_scale(s, path_at(path->c + 1, path->degree, s)) : vec3_make(0.0, 0.0, 0.0);
    if (SCENE_ANY_PLANE && path->flat) {
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
    if (!SCENE_ANY_CYLINDER || !path->has_ends) {
        return true;
    }
    return s < path->ends_settle ? path->starts_within
                                 : fabs(polynomial_at(&path->axial, s)) <= path->half_length;
}
