#include "dynamics/encounter.h"

#include <float.h>

#include "contact/polynomial.h"

enum { DEGREE = 4, MAX_CUTS = 4 * POLYNOMIAL_MAX_DEGREE };

/* Separation as a polynomial of s = time / horizon, lengths in units of `scale`. */
struct approach {
    struct polynomial offset2;   /* |c|^2 of a sphere, |rho|^2 of a cylinder [scale^2] */
    struct polynomial half_rate; /* rho.rho' = half the derivative of offset2 */
    struct polynomial excess;    /* offset2 - reach^2 */
    struct polynomial axial;     /* c.e_d */
    double scale, horizon;       /* [m], [s] */
    double reach, half_length;   /* [scale] */
};

/* Force-free path of a body, displacement only: coefficients of time from the present. */
static void body_coefficients(const struct scene_values *v, const struct motion *q, const struct system_instant *at,
                              double clock, int body, struct vec3 out[DEGREE + 1])
{
    for (int i = 0; i <= DEGREE; ++i) {
        out[i] = vec3_make(0.0, 0.0, 0.0);
    }
    if (body_is_free(v, body)) {
        struct vec3 force[3] = {q->path[body].force[0], q->path[body].force[1], q->path[body].force[2]};
        const double inverse_mass = 1.0 / body_mass(v, body);
        path_shift(force, 3, clock);
        out[0] = at->displacement[body];
        out[1] = at->velocity[body];
        out[2] = vec3_scale(0.5, vec3_axpy(gravity(v), inverse_mass, force[0]));
        out[3] = vec3_scale(inverse_mass / 6.0, force[1]);
        out[4] = vec3_scale(inverse_mass / 12.0, force[2]);
    } else if (body_is_prescribed(v, body)) {
        for (int i = 0; i < DEGREE; ++i) {
            out[i] = q->path[body].displacement[i];
        }
        path_shift(out, DEGREE, clock);
    }
}

/* Coefficients of c(t) from the present; a large common offset of the bodies cancels first. */
static void separation_coefficients(const struct scene_values *v, const struct motion *q,
                                    const struct system_instant *at, double clock, int contact,
                                    struct vec3 c[DEGREE + 1])
{
    const int from = contact_source(contact);
    const int to = contact_destination(contact);
    struct vec3 source[DEGREE + 1];
    body_coefficients(v, q, at, clock, from, source);
    body_coefficients(v, q, at, clock, to, c);
    for (int i = 0; i <= DEGREE; ++i) {
        c[i] = vec3_sub(c[i], source[i]);
    }
    c[0] = vec3_add(vec3_sub(body_center(v, to), body_center(v, from)), c[0]);
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

static struct polynomial dot_product(const struct vec3 *a)
{
    struct polynomial p = {{0.0}, 2 * DEGREE};
    for (int i = 0; i <= DEGREE; ++i) {
        for (int j = 0; j <= DEGREE; ++j) {
            p.a[i + j] += vec3_dot(a[i], a[j]);
        }
    }
    return p;
}

static struct approach approach_make(const struct contact_shape *shape, const struct contact_geometry *now,
                                     struct vec3 *c, double horizon)
{
    struct approach path = {.horizon = horizon};
    path.scale = coefficient_scale(c, horizon, contact_reach(shape));
    path.axial.degree = DEGREE;
    double factor = 1.0 / path.scale;
    for (int i = 0; i <= DEGREE; ++i) {
        c[i] = vec3_scale(factor, c[i]);
        factor *= horizon;
        if (shape->destination == SHAPE_CYLINDER) {
            path.axial.a[i] = vec3_dot(c[i], shape->axis);
            c[i] = vec3_axpy(c[i], -path.axial.a[i], shape->axis);
        }
    }
    path.reach = contact_reach(shape) / path.scale;
    path.half_length = shape->half_length / path.scale;
    path.offset2 = dot_product(c);
    path.half_rate = polynomial_derivative(&path.offset2);
    for (int i = 0; i <= path.half_rate.degree; ++i) {
        path.half_rate.a[i] *= 0.5;
    }
    path.excess = path.offset2;
    /* (d - reach) (d + reach): keeps the digits of a small gap */
    path.excess.a[0] = shape->side * (now->gap / path.scale) * (now->distance / path.scale + path.reach);
    return path;
}

static bool within_at(const struct approach *path, double s)
{
    return fabs(polynomial_at(&path->axial, s)) <= path->half_length;
}

static enum contact_regime regime_at(const struct approach *path, const struct contact_shape *shape,
                                     const struct contact_law *law, double s)
{
    const double distance = sqrt(fmax(0.0, polynomial_at(&path->offset2, s)));
    const double gap = shape->side * path->scale * polynomial_at(&path->excess, s) / (distance + path->reach);
    const double half_rate = polynomial_at(&path->half_rate, s);
    const double rate = distance > 0.0 ? half_rate / distance : 0.0;
    const double gap_rate = shape->side * rate * path->scale / path->horizon;
    return contact_regime_of(law, gap, gap_rate, within_at(path, s));
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

static int add_cuts(const struct polynomial *p, double *cuts, int count)
{
    double roots[POLYNOMIAL_MAX_DEGREE];
    const int found = polynomial_sign_changes(p, roots);
    for (int i = 0; i < found; ++i) {
        int at = count++;
        for (; at > 0 && cuts[at - 1] > roots[i]; --at) {
            cuts[at] = cuts[at - 1];
        }
        cuts[at] = roots[i];
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
    int count = add_cuts(&path->excess, cuts, 0);
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

/* Until then the present regime, whose boundary has just been crossed, is taken to last. Eight roundings of the largest
 * term cover the few operations behind a gap or an axial position. */
static double settling_time(const struct approach *path, const struct contact_shape *shape,
                            const struct contact_law *law, const struct contact_geometry *now, struct vec3 w,
                            struct vec3 half_acceleration, enum contact_regime present)
{
    const double rounding = 8.0 * DBL_EPSILON;
    const double size = now->distance + shape->source_radius + shape->other_radius;
    double settle = leaving_time(now->gap, rounding * size, now->gap_rate, vec3_norm(half_acceleration));
    if (isfinite(shape->half_length)) {
        const double beyond = fabs(now->axial) - shape->half_length;
        settle = fmax(settle, leaving_time(beyond, rounding * shape->half_length, vec3_dot(w, shape->axis),
                                           vec3_dot(half_acceleration, shape->axis)));
    }
    if (present == REGIME_RELEASED) {
        const double margin = law->stiffness * now->gap + law->damping * now->gap_rate;
        const double noise = rounding * (law->stiffness * size + law->damping * vec3_norm(w));
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
                !ends_only                 ? regime_at(path, shape, law, middle)
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
    struct vec3 c[DEGREE + 1];
    separation_coefficients(v, q, at, clock, contact, c);
    const struct vec3 w = c[1];
    const struct vec3 half_acceleration = c[2];
    const struct approach path = approach_make(&shape, now, c, horizon);
    const double settle = settling_time(&path, &shape, &law, now, w, half_acceleration, present);
    return first_change(&path, &shape, &law, present, ends_only, settle);
}
