#include "segment/pair_taylor.h"

#include <float.h>

/* Everything that the recurrence needs besides the results. */
struct recurrence {
    struct taylor_vec3 c; /* separation; of a cylinder the part across its axis */
    struct taylor_vec3 w; /* its rate */
    struct taylor_vec3 n;
    double d_squared[TAYLOR_TERMS]; /* c.c */
    double d[TAYLOR_TERMS];
    double closing[TAYLOR_TERMS]; /* c.w */
    double speed[TAYLOR_TERMS];   /* c.w / d = n.w */
    bool head_on;                 /* n stays: d = n.c, through the centre too */
};

/* Exactly so, not nearly: head-on, whatever the forces do with time. */
static bool stays_on_normal(const struct contact_pair *from)
{
    if (contact_is_plane(&from->shape)) {
        return true;
    }
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = vec3_cross(from->normal, pair_across(from, from->flight.c[i]));
        const struct vec3 w = vec3_cross(from->normal, pair_across(from, from->flight.w[i - 1]));
        if (!vec3_is_zero(c) || !vec3_is_zero(w)) {
            return false;
        }
    }
    return true;
}

/* Time in which d changes by its own size: at the present speed, or by the force from rest [s]. */
static double passage_of(const struct contact_pair *from)
{
    const double force = fabs(from->coefficients.k * from->gap) / from->reduced_mass;
    const double acceleration = force + 2.0 * vec3_norm(from->flight.c[2]);
    return fmin(from->distance / vec3_norm(from->flight.w[0]), sqrt(from->distance / acceleration));
}

/* The unit of time: one radian of the spring's oscillation, one decay time of the dashpot, or the time of
 * passage, whichever is shortest. Where the passage is shortest, terms that do not contain d vanish below the
 * range of numbers; they do so for up to LONGEST_PASSAGE units. */
static const double LONGEST_PASSAGE = 16.0;

static double natural_unit(const struct contact_pair *from, double passage)
{
    const struct contact_coefficients full = contact_coefficients_of(&from->law, REGIME_COMPRESSION);
    const double spring = sqrt(from->reduced_mass / full.k);
    const double dashpot = from->reduced_mass / full.c;
    const double unit = fmin(spring, fmin(dashpot, passage));
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
}

/* Jorba and Zou: from the last two coefficients, the step at which they are a rounding of `whole`. */
static double convergent_step(double last_but_one, double last, double whole)
{
    const double rounding = 0.5 * DBL_EPSILON * whole;
    return fmin(pow(rounding / fabs(last_but_one), 1.0 / (TAYLOR_ORDER - 1)),
                pow(rounding / fabs(last), 1.0 / (double)TAYLOR_ORDER));
}

/* The step for which both the motion, relative to its largest term, and the gap, relative to `distance`, have
 * converged. A contact without force at the start has r = 0, but a gap. */
static double reliable_step(const struct pair_taylor *p, double distance)
{
    double largest = 0.0;
    for (int i = 2; i < TAYLOR_TERMS; ++i) {
        largest = fmax(largest, vec3_norm(p->r.at[i]));
    }
    const double by_gap = convergent_step(p->gap[TAYLOR_ORDER - 1], p->gap[TAYLOR_ORDER], distance);
    const double by_motion =
        convergent_step(vec3_norm(p->r.at[TAYLOR_ORDER - 1]), vec3_norm(p->r.at[TAYLOR_ORDER]), largest);
    return largest > 0.0 ? fmin(by_gap, by_motion) : by_gap;
}

/* Coefficient i of everything, from r[0..i + 1]; then r[i + 2]. */
static void next_coefficient(struct pair_taylor *p, struct recurrence *z, int i, double power)
{
    const struct contact_pair *from = p->from;
    const int side = from->shape.side;
    const struct vec3 none = {0.0, 0.0, 0.0};
    const struct vec3 c = i <= SEPARATION_DEGREE ? vec3_scale(power, from->flight.c[i]) : none;
    const struct vec3 w = i < SEPARATION_DEGREE ? vec3_scale(power, from->flight.w[i]) : none;
    const struct vec3 next = i + 1 < TAYLOR_TERMS ? p->r.at[i + 1] : none;
    z->c.at[i] = pair_across(from, vec3_add(c, p->r.at[i]));
    z->w.at[i] = vec3_axpy(w, (i + 1) / p->unit, next);
    if (z->head_on) {
        z->d[i] = vec3_dot(from->normal, z->c.at[i]);
        z->speed[i] = vec3_dot(from->normal, z->w.at[i]);
        z->n.at[i] = i == 0 ? from->normal : none;
    } else {
        z->d_squared[i] = taylor_dot(&z->c, &z->c, i);
        z->d[i] = taylor_root(z->d_squared, z->d, i);
        z->closing[i] = taylor_dot(&z->c, &z->w, i);
        z->speed[i] = taylor_divide(z->closing, z->d, z->speed, i);
        z->n.at[i] = taylor_divide_vec3(&z->c, z->d, &z->n, i);
    }
    const bool is_carried = !isnan(from->carried_rate);
    p->gap[i] = i == 0 ? from->gap : side * z->d[i];
    if (i == 1 && is_carried) { /* d from c moves by the rounding of velocities */
        p->gap[1] = p->unit * pair_gap_derivative(from);
    }
    p->rate[i] = i == 0 && is_carried ? from->carried_rate : side * z->speed[i];
    p->force[i] = contact_linear_force(from->coefficients, p->gap[i], p->rate[i]);
    if (i + 2 < TAYLOR_TERMS) {
        struct vec3 push = {0.0, 0.0, 0.0};
        for (int k = 0; k <= i; ++k) {
            push = vec3_axpy(push, p->force[k], z->n.at[i - k]);
        }
        p->r.at[i + 2] =
            vec3_scale(side * p->unit * p->unit / (from->reduced_mass * (i + 1) * (i + 2)), push);
    }
}

void pair_taylor_make(struct pair_taylor *p, const struct contact_pair *from)
{
    struct recurrence z;
    p->from = from;
    z.head_on = stays_on_normal(from);
    const double passage = z.head_on ? (double)INFINITY : passage_of(from);
    p->unit = natural_unit(from, passage);
    p->r.at[0] = p->r.at[1] = vec3_make(0.0, 0.0, 0.0);
    double power = 1.0;
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        next_coefficient(p, &z, i, power);
        power *= p->unit;
    }
    p->step =
        reliable_step(p, z.head_on ? fmax(contact_reach(&from->shape), from->distance) : from->distance);
    if (p->unit == passage) {
        p->step = fmin(p->step, LONGEST_PASSAGE);
    }
}

static void sample_series(const double *series, double s, double out[3])
{
    out[0] = out[1] = out[2] = 0.0;
    for (int i = TAYLOR_TERMS - 1; i >= 0; --i) {
        out[2] = out[2] * s + 2.0 * out[1];
        out[1] = out[1] * s + out[0];
        out[0] = out[0] * s + series[i];
    }
}

void pair_taylor_sample(const void *pair_taylor, double s, struct pair_sample *sample)
{
    const struct pair_taylor *p = pair_taylor;
    sample_series(p->gap, s, sample->of[PAIR_GAP]);
    sample_series(p->rate, s, sample->of[PAIR_GAP_RATE]);
    sample_series(p->force, s, sample->of[PAIR_FORCE]);
}

/* The integral of pair_work over [0, s]. */
static double work_along_series(const struct pair_taylor *p, const struct pair_work *work, double s)
{
    double sum[TAYLOR_TERMS + 2] = {0.0};
    double power = 1.0;
    if (work->order == 0) {
        return 0.0;
    }
    for (int j = 0; j < 3; ++j) {
        for (int i = work->order; i < TAYLOR_TERMS; ++i) {
            const double factor = work->order == 1 ? i : i * (i - 1);
            sum[i - work->order + j] += power * factor * vec3_dot(work->path[j], p->r.at[i]);
        }
        power *= p->unit;
    }
    /* dt = unit ds; r' and r'' bring 1/unit and 1/unit^2 */
    return taylor_integral(sum, TAYLOR_TERMS + 2 - work->order, s) / (work->order == 1 ? 1.0 : p->unit);
}

static double dissipated(const struct pair_taylor *p, double s)
{
    double rate_squared[TAYLOR_TERMS];
    if (!(p->from->coefficients.c > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        rate_squared[i] = taylor_multiply(p->rate, p->rate, i);
    }
    return p->from->coefficients.c * p->unit * taylor_integral(rate_squared, TAYLOR_TERMS, s);
}

struct pair_change pair_taylor_change(const void *pair_taylor, double s)
{
    const struct pair_taylor *p = pair_taylor;
    struct taylor_vec3 slope;
    for (int i = 1; i < TAYLOR_TERMS; ++i) {
        slope.at[i - 1] = vec3_scale(i / p->unit, p->r.at[i]);
    }
    return (struct pair_change){
        .time = p->unit * s,
        .r = taylor_at_vec3(&p->r, TAYLOR_TERMS, s),
        .r_rate = taylor_at_vec3(&slope, TAYLOR_ORDER, s),
        .gap = taylor_at(p->gap, TAYLOR_TERMS, s),
        .dissipated = dissipated(p, s),
        .work = {work_along_series(p, &p->from->work[0], s), work_along_series(p, &p->from->work[1], s)}};
}
