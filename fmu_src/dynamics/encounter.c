#include "dynamics/encounter.h"

#include <float.h>

#include "contact/bracket.h"
#include "contact/polynomial.h"

enum { DEGREE = 4, MAX_CUTS = 4 * POLYNOMIAL_MAX_DEGREE };

/* The motion of the separation over the horizon, s = time / horizon in [0, 1], lengths in units of `scale`; of a
 * cylinder the part across its axis. */
struct approach {
    struct vec3 c[DEGREE + 1];   /* c or rho */
    struct polynomial closing;   /* c.c': its roots are the extremes of the distance */
    struct polynomial offset2;   /* |c|^2 */
    struct polynomial half_rate; /* c.w, what the law sees; equal to `closing` for consistent motion */
    struct polynomial axial;     /* c.e_d */
    double scale, horizon;       /* [m], [s] */
    double reach, half_length;   /* [scale] */
    int side;
};

/* Coefficients of time from the present: separation c and its rate w. For consistent prescribed motion w = dc/dt; the
 * law sees the prescribed velocity as it is given. */
struct separation {
    struct vec3 c[DEGREE + 1];
    struct vec3 w[DEGREE];
};

static void add_free(const struct scene_values *v, const struct motion *q, const struct system_instant *at,
                     double clock, int body, double sign, struct separation *out)
{
    struct vec3 force[3] = {q->path[body].force[0], q->path[body].force[1], q->path[body].force[2]};
    path_shift(force, 3, clock);
    const double inverse_mass = 1.0 / body_mass(v, body);
    const struct vec3 rate[DEGREE] = {at->velocity[body], vec3_axpy(gravity(v), inverse_mass, force[0]),
                                      vec3_scale(inverse_mass / 2.0, force[1]),
                                      vec3_scale(inverse_mass / 3.0, force[2])};
    for (int i = 0; i < DEGREE; ++i) {
        out->w[i] = vec3_axpy(out->w[i], sign, rate[i]);
        out->c[i + 1] = vec3_axpy(out->c[i + 1], sign / (i + 1), rate[i]);
    }
}

static void add_prescribed(const struct motion *q, double clock, int body, double sign, struct separation *out)
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
static struct separation separation_of(const struct scene_values *v, const struct motion *q,
                                       const struct system_instant *at, double clock, int contact)
{
    const int ends[2] = {contact_destination(contact), contact_source(contact)};
    struct separation path = {.c = {at->separation[contact]}, .w = {{0.0, 0.0, 0.0}}};
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

static double coefficient_scale(const struct vec3 *c, double horizon, double reach)
{
    double scale = reach;
    double power = 1.0;
    for (int i = 0; i <= DEGREE; ++i) {
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

static struct approach approach_make(const struct contact_shape *shape, const struct separation *separation,
                                     double horizon)
{
    struct approach path = {.horizon = horizon, .axial = {.degree = DEGREE}, .side = shape->side};
    struct vec3 slope[DEGREE];
    struct vec3 w[DEGREE];
    path.scale = coefficient_scale(separation->c, horizon, contact_reach(shape));
    double factor = 1.0 / path.scale;
    for (int i = 0; i <= DEGREE; ++i) {
        path.c[i] = vec3_scale(factor, separation->c[i]);
        if (shape->destination == SHAPE_CYLINDER) {
            path.axial.a[i] = vec3_dot(path.c[i], shape->axis);
            path.c[i] = vec3_axpy(path.c[i], -path.axial.a[i], shape->axis);
        }
        factor *= horizon;
        if (i < DEGREE) {
            w[i] = vec3_scale(factor, separation->w[i]);
        }
        if (i > 0) {
            slope[i - 1] = vec3_scale(i, path.c[i]);
        }
    }
    path.reach = contact_reach(shape) / path.scale;
    path.half_length = shape->half_length / path.scale;
    path.offset2 = dot_product(path.c, DEGREE, path.c, DEGREE);
    path.closing = dot_product(path.c, DEGREE, slope, DEGREE - 1);
    path.half_rate = dot_product(path.c, DEGREE, w, DEGREE - 1);
    return path;
}

/* Gap and its slope in s, from the vectors: the difference of squares would lose all digits where bodies come from further
 * away than 1e8 times their size. */
static void gap_along(const void *data, double s, double *gap, double *slope)
{
    const struct approach *path = data;
    const double distance = vec3_norm(path_at(path->c, DEGREE + 1, s));
    *gap = path->side * (distance - path->reach);
    *slope = distance > 0.0 ? path->side * polynomial_at(&path->closing, s) / distance : 0.0;
}

static bool within_at(const struct approach *path, double s)
{
    return fabs(polynomial_at(&path->axial, s)) <= path->half_length;
}

static enum contact_regime regime_at(const struct approach *path, const struct contact_law *law, double s)
{
    double gap;
    double slope;
    gap_along(path, s, &gap, &slope);
    const double distance = path->side * gap + path->reach;
    const double rate = distance > 0.0 ? path->side * polynomial_at(&path->half_rate, s) / distance : 0.0;
    return contact_regime_of(law, path->scale * gap, rate * path->scale / path->horizon, within_at(path, s));
}

/* k (d - reach) + c d' = 0, times d, with the root squared: (k d^2 + c d d')^2 = k^2 reach^2 d^2. */
static struct polynomial law_condition(const struct approach *path, const struct contact_law *law)
{
    const double damping = law->damping / path->horizon;
    const double unit = fmax(law->stiffness, damping);
    const double k = law->stiffness / unit;
    struct polynomial sum = {{0.0}, 0};
    sum = polynomial_add(&sum, k, &path->offset2);
    sum = polynomial_add(&sum, damping / unit, &path->half_rate);
    const struct polynomial square = polynomial_multiply(&sum, &sum);
    const double pull = k * path->reach;
    return polynomial_add(&square, -pull * pull, &path->offset2);
}

static int insert_cut(double root, double *cuts, int count)
{
    int at = count;
    for (; at > 0 && cuts[at - 1] > root; --at) {
        cuts[at] = cuts[at - 1];
    }
    cuts[at] = root;
    return count + 1;
}

static int add_cuts(const struct polynomial *p, double *cuts, int count)
{
    double roots[POLYNOMIAL_MAX_DEGREE];
    const int found = polynomial_sign_changes(p, roots);
    for (int i = 0; i < found; ++i) {
        count = insert_cut(roots[i], cuts, count);
    }
    return count;
}

/* Where the gap passes zero: between the extremes of the distance it is monotone. */
static int touching_cuts(const struct approach *path, double *cuts, int count)
{
    double extremes[POLYNOMIAL_MAX_DEGREE];
    const int pieces = polynomial_sign_changes(&path->closing, extremes) + 1;
    double low = 0.0;
    double slope;
    double at_low;
    gap_along(path, low, &at_low, &slope);
    for (int i = 0; i < pieces; ++i) {
        const double high = i < pieces - 1 ? extremes[i] : 1.0;
        double at_high;
        gap_along(path, high, &at_high, &slope);
        if ((at_low < 0.0 && at_high > 0.0) || (at_low > 0.0 && at_high < 0.0)) {
            count = insert_cut(bracket_root(gap_along, path, low, high), cuts, count);
        }
        low = high;
        at_low = at_high;
    }
    return count;
}

static int end_cuts(const struct approach *path, double *cuts, int count)
{
    for (int end = -1; end <= 1; end += 2) {
        struct polynomial plane = path->axial;
        plane.a[0] += end * path->half_length;
        count = add_cuts(&plane, cuts, count);
    }
    return count;
}

/* All instants at which the regime may change: a superset, sorted. */
static int all_cuts(const struct approach *path, const struct contact_shape *shape, const struct contact_law *law,
                    double *cuts)
{
    int count = touching_cuts(path, cuts, 0);
    if (isfinite(shape->half_length)) {
        count = end_cuts(path, cuts, count);
    }
    if (law->damping > 0.0 && law->dashpot != DASHPOT_UNCLAMPED) {
        count = add_cuts(&path->half_rate, cuts, count);
        if (law->dashpot == DASHPOT_NON_ADHESIVE && law->stiffness > 0.0) {
            const struct polynomial condition = law_condition(path, law);
            count = add_cuts(&condition, cuts, count);
        }
    }
    return count;
}

/* Seconds in which a quantity moving with `speed` and half acceleration `bend` leaves the rounding `noise` around zero;
 * 0 when it is not within it. On a shorter scale its sign means nothing. */
static double leaving_time(double value, double noise, double speed, double bend)
{
    if (fabs(value) > noise) {
        return 0.0;
    }
    const double soonest = fmin(noise / fabs(speed), sqrt(noise / fabs(bend)));
    return isfinite(soonest) ? soonest : 0.0;
}

/* Until then the present regime, whose boundary has just been crossed, is taken to last. */
static double settling_time(const struct approach *path, const struct contact_shape *shape,
                            const struct contact_law *law, const struct contact_geometry *now, double resolution,
                            const struct separation *separation, enum contact_regime present)
{
    const double closing = vec3_dot(now->normal, separation->c[1]);
    double settle = leaving_time(now->gap, resolution, closing, vec3_norm(separation->c[2]));
    if (isfinite(shape->half_length)) {
        const double beyond = fabs(now->axial) - shape->half_length;
        settle = fmax(settle, leaving_time(beyond, resolution + 8.0 * DBL_EPSILON * shape->half_length,
                                           vec3_dot(separation->c[1], shape->axis),
                                           vec3_dot(separation->c[2], shape->axis)));
    }
    if (present == REGIME_RELEASED) {
        const double margin = law->stiffness * now->gap + law->damping * now->gap_rate;
        const double noise =
            law->stiffness * resolution + 8.0 * DBL_EPSILON * law->damping * vec3_norm(separation->w[0]);
        settle = fmax(settle, leaving_time(margin, noise, law->stiffness * now->gap_rate, 0.0));
    }
    return settle / path->horizon;
}

static struct encounter first_change(const struct approach *path, const struct contact_shape *shape,
                                     const struct contact_law *law, enum contact_regime present, bool ends_only,
                                     double settle)
{
    double cuts[MAX_CUTS];
    const int count = ends_only ? end_cuts(path, cuts, 0) : all_cuts(path, shape, law, cuts);
    double from = 0.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? cuts[i] : 1.0;
        if (to > settle && to > from) {
            from = fmax(from, settle);
            const double middle = 0.5 * (from + to);
            const enum contact_regime next =
                !ends_only                 ? regime_at(path, law, middle)
                : within_at(path, middle) ? present
                                           : REGIME_APART;
            if (next != present) {
                return (struct encounter){from * path->horizon, next};
            }
        }
        from = to;
    }
    return (struct encounter){INFINITY, present};
}

struct encounter encounter_next(const struct scene_values *v, const struct motion *q, const struct system_instant *at,
                                double clock, int contact, double horizon)
{
    const struct contact_shape shape = system_shape(v, q, contact);
    const struct contact_law law = system_law(v, q, contact);
    const struct contact_geometry *now = &at->geometry[contact];
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const bool ends_only =
        present != REGIME_APART && present != REGIME_RELEASED && !system_is_force_element(v);
    if (ends_only && !isfinite(shape.half_length)) {
        return (struct encounter){INFINITY, present};
    }
    const struct separation separation = separation_of(v, q, at, clock, contact);
    const struct approach path = approach_make(&shape, &separation, horizon);
    const double resolution = system_gap_resolution(v, at, contact);
    const double settle = settling_time(&path, &shape, &law, now, resolution, &separation, present);
    return first_change(&path, &shape, &law, present, ends_only, settle);
}
