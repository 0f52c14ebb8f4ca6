#include "segment/pair_oscillation.h"

#include <float.h>

#include "math/pi.h"
#include "segment/flight_head_on.h"

/* Lowest damped frequency treated as an oscillation [radians per s]: at 0.97 of critical damping. Beyond, y
 * decays below rounding within one period. */
static const double LOWEST_FREQUENCY = 0.25;

/* A viscous contact drifts towards the centre. Largest |g| at which such a segment may start, and at which it
 * ends, in parts of the reach. */
static const double DRIFT_STARTS = 0.5;
static const double DRIFT_ENDS = 0.75;

static double along_normal(const struct contact_pair *from, int degree)
{
    return from->shape.side * vec3_dot(from->normal, pair_across(from, from->flight.c[degree]));
}

/* What |g| must stay below. */
static double largest_gap(const struct contact_pair *from)
{
    return contact_may_reach_centre(&from->shape) ? contact_reach(&from->shape) : DBL_MAX;
}

static bool make_of_spring(struct pair_oscillation *p)
{
    const struct contact_pair *from = p->from;
    p->stiffness = from->coefficients.k;
    p->oscillator = (struct oscillator){1.0, from->coefficients.c / from->reduced_mass / p->rate};
    p->omega_d = sqrt(fmax(1.0 - 0.25 * p->oscillator.damping_rate * p->oscillator.damping_rate, 0.0));
    p->equilibrium = p->load;
    p->y = from->gap - p->equilibrium;
    p->amplitude = oscillator_envelope_of(&p->oscillator, p->y, p->y_rate).amplitude;
    if (p->omega_d < LOWEST_FREQUENCY) {
        p->omega_d = 0.0;
        p->overdamped = overdamped_of(p->oscillator.damping_rate, p->y, p->y_rate);
    }
    return fabs(p->equilibrium) + p->amplitude < largest_gap(from);
}

static bool make_of_dashpot(struct pair_oscillation *p)
{
    const struct contact_pair *from = p->from;
    p->stiffness = from->coefficients.c * p->rate;
    p->omega_d = p->equilibrium = 0.0;
    p->y = from->gap;
    p->overdamped = overdamped_of_dashpot(p->y, p->y_rate, p->load);
    p->amplitude = fabs(p->y) + fabs(p->overdamped.by_faster);
    return p->amplitude < DRIFT_STARTS * largest_gap(from);
}

bool pair_oscillation_make(struct pair_oscillation *p, const struct contact_pair *from)
{
    const bool has_spring = from->coefficients.k > 0.0;
    p->rate = has_spring ? sqrt(from->coefficients.k / from->reduced_mass)
                         : from->coefficients.c / from->reduced_mass;
    if (!(p->rate > 0.0)) {
        return false;
    }
    p->from = from;
    p->load = 2.0 * along_normal(from, 2) / (p->rate * p->rate);
    p->y_rate = pair_gap_derivative(from) / p->rate;
    return has_spring ? make_of_spring(p) : make_of_dashpot(p);
}

double pair_oscillation_longest(const struct pair_oscillation *p)
{
    if (p->omega_d > 0.0) {
        return (double)INFINITY;
    }
    const double longest = p->overdamped.half_period;
    if (p->from->coefficients.k > 0.0 || !contact_may_reach_centre(&p->from->shape)) {
        return longest;
    }
    const double free = DRIFT_ENDS * contact_reach(&p->from->shape) - p->amplitude;
    return fmin(longest, free / fabs(p->overdamped.drift));
}

/* Whether y or y' is more accurate by itself than by its increment since the start: it has decayed. */
static bool has_decayed(double now, double start)
{
    return 2.0 * fabs(now) < fabs(start);
}

static double gap_after_decay(const struct pair_oscillation *p, double y, double change)
{
    return has_decayed(y, p->y) ? p->equilibrium + y : p->from->gap + change;
}

/* How much y and y' have changed since the start. */
static struct oscillator_increment oscillation_change(const struct pair_oscillation *p, double s)
{
    const double damping_rate = p->oscillator.damping_rate;
    if (s * (1.0 + damping_rate) <= OSCILLATOR_SERIES_RANGE) {
        return oscillator_increment(&p->oscillator, p->y, p->y_rate, 0.0, s);
    }
    const double half_angle = 0.5 * p->omega_d * s;
    const double sine = sin(half_angle);
    const double cosine_less = -2.0 * sine * sine; /* cos - 1 */
    const double shrink_less = damping_rate > 0.0 ? expm1(-0.5 * damping_rate * s) : 0.0;
    const double by_rate = 2.0 * (1.0 + shrink_less) * sine * cos(half_angle) / p->omega_d;
    const double by_y = shrink_less + (1.0 + shrink_less) * cosine_less + 0.5 * damping_rate * by_rate;
    return (struct oscillator_increment){p->y * by_y + p->y_rate * by_rate,
                                         p->y_rate * (by_y - damping_rate * by_rate) - p->y * by_rate};
}

/* Increments of y and y' since the start, which would lose digits if added to the start values, then y'' and
 * y'''. */
static void grow(const struct pair_oscillation *p, double s, double y[4])
{
    const struct oscillator_increment change = oscillation_change(p, s);
    y[0] = change.x;
    y[1] = change.x_rate;
    y[2] = -p->oscillator.damping_rate * (p->y_rate + y[1]) - (p->y + y[0]);
    y[3] = -p->oscillator.damping_rate * y[2] - (p->y_rate + y[1]);
}

/* y' = exp(-damping_rate s / 2) (y_rate cos + sideways sin) of omega_d s. */
double pair_oscillation_first_extremum(const struct pair_oscillation *p)
{
    const double sideways = -(p->y + 0.5 * p->oscillator.damping_rate * p->y_rate) / p->omega_d;
    const double angle = p->y_rate == 0.0  ? PI
                         : p->y_rate < 0.0 ? atan2(-p->y_rate, sideways)
                                           : atan2(p->y_rate, -sideways);
    return angle / p->omega_d;
}

bool pair_oscillation_closes(const struct pair_oscillation *p)
{
    return p->y_rate < 0.0 || (p->y_rate == 0.0 && p->y > 0.0);
}

bool pair_oscillation_stays_above(const struct pair_oscillation *p, enum pair_quantity quantity,
                                  double factor, double offset)
{
    if (!(p->from->coefficients.k > 0.0)) {
        return false; /* without a spring the gap drifts */
    }
    if (quantity == PAIR_GAP) {
        return p->amplitude < factor * p->equilibrium + offset;
    }
    const double k = p->from->coefficients.k;
    const double c = p->from->coefficients.c * p->rate;
    const double bend = -p->oscillator.damping_rate * p->y_rate - p->y;
    double equilibrium = 0.0;
    double start = p->rate * p->y_rate; /* of what oscillates, and its rate */
    double start_rate = p->rate * bend;
    if (quantity == PAIR_FORCE) {
        equilibrium = -k * p->equilibrium;
        start = k * p->y + c * p->y_rate;
        start_rate = k * p->y_rate + c * bend;
    }
    return oscillator_envelope_of(&p->oscillator, start, start_rate).amplitude <
           factor * equilibrium + offset;
}

static void sample_from(const struct pair_oscillation *p, const double y[4], struct pair_sample *sample)
{
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP][i] = y[i];
        sample->of[PAIR_GAP_RATE][i] = p->rate * y[i + 1];
        sample->of[PAIR_FORCE][i] =
            contact_linear_force(p->from->coefficients, y[i], sample->of[PAIR_GAP_RATE][i]);
    }
}

/* F_n = m_red (g'' - side n.A). */
static void sample_overdamped(const struct pair_oscillation *p, double s, struct pair_sample *sample)
{
    double y[1 + OVERDAMPED_DERIVATIVES];
    overdamped_at(&p->overdamped, s, y);
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP][i] = y[i];
        sample->of[PAIR_GAP_RATE][i] = p->rate * y[1 + i];
        sample->of[PAIR_FORCE][i] = p->stiffness * y[2 + i];
    }
    sample->of[PAIR_GAP][0] = gap_after_decay(p, y[0], overdamped_since(&p->overdamped, s).y);
    sample->of[PAIR_FORCE][0] -= p->stiffness * p->load;
}

void pair_oscillation_sample(const void *pair_oscillation, double s, struct pair_sample *sample)
{
    const struct pair_oscillation *p = pair_oscillation;
    double y[4];
    if (!(p->omega_d > 0.0)) {
        sample_overdamped(p, s, sample);
        return;
    }
    grow(p, s, y);
    y[0] += p->from->gap;
    y[1] += p->y_rate;
    sample_from(p, y, sample);
}

/* Where y' = 0 the phase of y is that of a turning point: |y| = omega_d amplitude exp(-damping_rate s /
 * 2). */
void pair_oscillation_sample_extremum(const struct pair_oscillation *p, double s, bool deepest,
                                      struct pair_sample *sample)
{
    const double damping_rate = p->oscillator.damping_rate;
    const double shrunk = damping_rate > 0.0 ? p->omega_d * exp(-0.5 * damping_rate * s) : 1.0;
    const double size = deepest ? -shrunk * p->amplitude : shrunk * p->amplitude;
    const double y[4] = {p->equilibrium + size, 0.0, -size, damping_rate * size};
    sample_from(p, y, sample);
}

/* From the oscillator's own balance of energy: p_nv g'^2 = -(m g'^2 / 2 + p_n (g - equilibrium)^2 / 2)', or
 * -(m g'^2 / 2 - side m n.A g)'. */
static double dissipated_by_dashpot(const struct pair_oscillation *p, const double grown[2])
{
    const bool has_spring = p->from->coefficients.k > 0.0;
    const double by_rate = grown[1] * (2.0 * p->y_rate + grown[1]);
    const double by_place = grown[0] * (has_spring ? 2.0 * p->y + grown[0] : -2.0 * p->load);
    return p->from->coefficients.c > 0.0 ? -0.5 * p->stiffness * (by_rate + by_place) : 0.0;
}

/* The gap and its rate per s, and how much either has grown since the start. */
static double gap_grown(const struct pair_oscillation *p, double s, double grown[2], double *y_rate)
{
    double y[1 + OVERDAMPED_DERIVATIVES];
    if (p->omega_d > 0.0) {
        grow(p, s, y);
        grown[0] = y[0];
        grown[1] = y[1];
        *y_rate = p->y_rate + y[1];
        return p->from->gap + grown[0];
    }
    const struct overdamped_change since = overdamped_since(&p->overdamped, s);
    overdamped_at(&p->overdamped, s, y);
    grown[0] = since.y;
    grown[1] = since.y_rate;
    *y_rate = has_decayed(y[1], p->y_rate) ? y[1] : p->y_rate + since.y_rate;
    return gap_after_decay(p, y[0], since.y);
}

struct pair_change pair_oscillation_change(const void *pair_oscillation, double s)
{
    const struct pair_oscillation *p = pair_oscillation;
    const struct contact_pair *from = p->from;
    const double time = s / p->rate;
    const double side = from->shape.side;
    const double fall = 2.0 * along_normal(from, 2) * time;
    double grown[2];
    double y_rate;
    const double gap = gap_grown(p, s, grown, &y_rate);
    const double r = grown[0] - (p->y_rate * s + 0.5 * fall * time);
    const double r_rate = p->rate * grown[1] - fall;
    struct pair_change change = {.time = time,
                                 .r = vec3_scale(side * r, from->normal),
                                 .r_rate = vec3_scale(side * r_rate, from->normal),
                                 .gap = gap,
                                 .head_on = true,
                                 .gap_rate = p->rate * y_rate,
                                 .dissipated = dissipated_by_dashpot(p, grown)};
    for (int end = 0; end < PAIR_BODIES; ++end) {
        const struct pair_work *work = &from->work[end];
        const struct vec3 by = work->order == 1 ? change.r : change.r_rate;
        change.work[end] = work->order == 0 ? 0.0 : vec3_dot(work->path[0], by);
    }
    return change;
}
