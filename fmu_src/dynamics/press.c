#include "dynamics/press.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "dynamics/flight.h"

/* Everything that the recurrence needs besides the results. */
struct recurrence {
    struct vec3_series c; /* separation; of a cylinder the part across its axis */
    struct vec3_series w; /* its rate */
    struct vec3_series n;
    double square[SERIES_TERMS]; /* c.c */
    double d[SERIES_TERMS];
    double closing[SERIES_TERMS]; /* c.w */
    double speed[SERIES_TERMS];   /* c.w / d = n.w */
};

static struct vec3 across(const struct contact_shape *shape, struct vec3 a)
{
    if (SCENE_ANY_CYLINDER && shape->destination == SHAPE_CYLINDER) {
        return vec3_axpy(a, -vec3_dot(a, shape->axis), shape->axis);
    }
    return a;
}

/* One radian of the spring's or the dashpot's own motion, whichever is shorter; with neither, of the passage. */
static double natural_unit(const struct contact_law *law, double reduced_mass,
                           const struct system_instant *at, int contact)
{
    const double spring = sqrt(reduced_mass / law->stiffness);
    const double dashpot = reduced_mass / law->damping;
    const double passage = at->geometry[contact].distance / vec3_norm(at->rate[contact]);
    const double unit = fmin(spring, fmin(dashpot, passage));
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
}

/* Jorba and Zou: from the last two coefficients, the step at which they are a rounding of `whole`. */
static double convergent_step(double last_but_one, double last, double whole)
{
    const double rounding = 0.5 * DBL_EPSILON * whole;
    return fmin(pow(rounding / fabs(last_but_one), 1.0 / (SERIES_ORDER - 1)),
                pow(rounding / fabs(last), 1.0 / SERIES_ORDER));
}

/* Both the motion, to a rounding of its largest term, and the gap, to a rounding of the distance, must have converged: a
 * contact without force at the moment has no r, but a distance all the same. */
static double reliable_step(const struct press *p, double distance)
{
    double largest = 0.0;
    for (int i = 2; i < SERIES_TERMS; ++i) {
        largest = fmax(largest, vec3_norm(p->r.at[i]));
    }
    const double by_gap = convergent_step(p->gap[SERIES_ORDER - 1], p->gap[SERIES_ORDER], distance);
    const double by_motion =
        convergent_step(vec3_norm(p->r.at[SERIES_ORDER - 1]), vec3_norm(p->r.at[SERIES_ORDER]), largest);
    return largest > 0.0 ? fmin(by_gap, by_motion) : by_gap;
}

void press_make(struct press *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact)
{
    const struct contact_shape shape = system_shape(v, q, contact);
    const struct contact_law law = system_law(v, q, contact);
    const struct contact_coefficients by =
        contact_coefficients_of(&law, (enum contact_regime)q->contact[contact].regime);
    const struct separation flight = separation_of(v, q, at, q->clock, contact);
    struct recurrence z;
    p->reduced_mass = 1.0 / system_inverse_mass(v, contact);
    p->unit = natural_unit(&law, p->reduced_mass, at, contact);
    p->r.at[0] = p->r.at[1] = vec3_make(0.0, 0.0, 0.0);
    double power = 1.0;
    for (int i = 0; i < SERIES_TERMS; ++i) {
        /* r[i + 1] is known here; w = W + r' */
        const struct vec3 none = {0.0, 0.0, 0.0};
        const struct vec3 c = i <= SEPARATION_DEGREE ? vec3_scale(power, flight.c[i]) : none;
        const struct vec3 w = i < SEPARATION_DEGREE ? vec3_scale(power, flight.w[i]) : none;
        z.c.at[i] = across(&shape, vec3_add(c, p->r.at[i]));
        const struct vec3 next = i + 1 < SERIES_TERMS ? p->r.at[i + 1] : none;
        z.w.at[i] = vec3_axpy(w, (i + 1) / p->unit, next);
        z.square[i] = series_dot(&z.c, &z.c, i);
        z.d[i] = series_root(z.square, z.d, i);
        z.closing[i] = series_dot(&z.c, &z.w, i);
        z.speed[i] = series_divide(z.closing, z.d, z.speed, i);
        z.n.at[i] = series_divide_vec3(&z.c, z.d, &z.n, i);
        p->gap[i] = i == 0 ? at->geometry[contact].gap : shape.side * z.d[i];
        p->rate[i] = shape.side * z.speed[i];
        p->force[i] = -(by.k * p->gap[i] + by.c * p->rate[i]);
        if (i + 2 < SERIES_TERMS) {
            struct vec3 push = {0.0, 0.0, 0.0};
            for (int k = 0; k <= i; ++k) {
                push = vec3_axpy(push, p->force[k], z.n.at[i - k]);
            }
            p->r.at[i + 2] =
                vec3_scale(shape.side * p->unit * p->unit / (p->reduced_mass * (i + 1) * (i + 2)), push);
        }
        power *= p->unit;
    }
    p->step = reliable_step(p, at->geometry[contact].distance);
}

/* Integral over [0, s] of path(t).r'(t) dt or, with `derivative` 2, of path(t).r''(t) dt, for a path of three coefficients
 * of time from the present. */
static double work_along(const struct press *p, const struct vec3 path[3], int derivative, double s)
{
    double sum[SERIES_TERMS + 2] = {0.0};
    double power = 1.0;
    for (int j = 0; j < 3; ++j) {
        for (int i = derivative; i < SERIES_TERMS; ++i) {
            const double factor = derivative == 1 ? i : i * (i - 1);
            sum[i - derivative + j] += power * factor * vec3_dot(path[j], p->r.at[i]);
        }
        power *= p->unit;
    }
    /* dt = unit ds; r' and r'' bring 1/unit and 1/unit^2 */
    return series_integral(sum, SERIES_TERMS + 2 - derivative, s) / (derivative == 1 ? 1.0 : p->unit);
}

static double extra_work(const struct press *p, const struct scene_values *v, const struct motion *q,
                         int contact, int body, double s)
{
    const double sign = body == contact_source(contact) ? -1.0 : 1.0;
    struct body_path path = q->path[body];
    if (body_is_free(v, body)) {
        path_shift(path.force, 3, q->clock);
        return sign * p->reduced_mass / body_mass(v, body) * work_along(p, path.force, 1, s);
    }
    if (body_is_prescribed(v, body)) {
        path_shift(path.velocity, 3, q->clock);
        return -sign * p->reduced_mass * work_along(p, path.velocity, 2, s);
    }
    return 0.0;
}

static double dissipated(const struct press *p, const struct contact_law *law, enum contact_regime regime,
                         double s)
{
    double square[SERIES_TERMS];
    if (regime != REGIME_PRESSING || !(law->damping > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < SERIES_TERMS; ++i) {
        square[i] = series_multiply(p->rate, p->rate, i);
    }
    return law->damping * p->unit * series_integral(square, SERIES_TERMS, s);
}

void press_advance(const struct press *p, const struct scene_values *v, struct motion *q, int contact,
                   double s)
{
    const struct contact_law law = system_law(v, q, contact);
    const int ends[2] = {contact_source(contact), contact_destination(contact)};
    const struct vec3 r = series_at_vec3(&p->r, SERIES_TERMS, s);
    struct vec3_series slope;
    for (int i = 1; i < SERIES_TERMS; ++i) {
        slope.at[i - 1] = vec3_scale(i / p->unit, p->r.at[i]);
    }
    const struct vec3 rate = series_at_vec3(&slope, SERIES_ORDER, s);
    const double time = p->unit * s;
    q->dissipated += dissipated(p, &law, (enum contact_regime)q->contact[contact].regime, s);
    for (int end = 0; end < 2; ++end) {
        const int body = ends[end];
        q->external_work += extra_work(p, v, q, contact, body, s);
        if (body_is_free(v, body)) {
            const double share = (end == 0 ? -1.0 : 1.0) * p->reduced_mass / body_mass(v, body);
            struct vec3 force[3] = {q->path[body].force[0], q->path[body].force[1], q->path[body].force[2]};
            path_shift(force, 3, q->clock);
            q->external_work += flight_work(v, body, q->body[body], force, time);
            const struct body_state flown = flight_from(v, body, q->body[body], force, time);
            q->body[body].moved = vec3_axpy(flown.moved, share, r);
            q->body[body].velocity = vec3_axpy(flown.velocity, share, rate);
        }
    }
    q->contact[contact].impulse = vec3_axpy(q->contact[contact].impulse, -p->reduced_mass, rate);
    q->clock += time;
}

#endif
