#include "dynamics/press_straight.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "dynamics/head_on.h"

/* Radians of y per s: 0.97 of critical damping. Nearer to it most of a turn is below rounding. */
static const double SLOWEST_TURN = 0.25;

/* The flight that r is taken from may be this many times what y can come to, three digits of sixteen, or as long as the bodies are far. */
static const double LONGEST_FLIGHT = 1e3;

/* Where a gap that drifts towards the centre starts at most and ends, in parts of the reach: a good way from there. */
static const double DRIFT_STARTS = 0.5;
static const double DRIFT_ENDS = 0.75;

static const double HALF_TURN = 3.141592653589793;

static bool is_constant(const struct press_work *work)
{
    return work->order == 0 || (vec3_is_zero(work->path[1]) && vec3_is_zero(work->path[2]));
}

static bool is_pulled_straight(const struct press *from)
{
    return is_constant(&from->work[0]) && is_constant(&from->work[1]) &&
           head_on_is(&from->shape, &from->flight, from->normal);
}

static double along_normal(const struct press *from, int degree)
{
    return from->shape.side * vec3_dot(from->normal, press_across(from, from->flight.c[degree]));
}

/* What |g| must stay below. */
static double keeps_within(const struct press *from)
{
    return from->shape.side < 0 ? DBL_MAX : contact_reach(&from->shape);
}

static bool make_of_spring(struct press_straight *p)
{
    const struct press *from = p->from;
    p->stiffness = from->by.k;
    p->oscillator = (struct oscillator){1.0, from->by.c / from->reduced_mass / p->rate};
    p->turn = sqrt(fmax(1.0 - 0.25 * p->oscillator.damping * p->oscillator.damping, 0.0));
    p->settled = p->pull;
    p->y = from->gap - p->settled;
    p->amplitude = oscillator_envelope_of(&p->oscillator, p->y, p->y_rate).amplitude;
    if (p->turn < SLOWEST_TURN) {
        p->turn = 0.0;
        p->decay = decay_of(p->oscillator.damping, p->y, p->y_rate);
    }
    return fabs(p->settled) + p->amplitude < keeps_within(from);
}

static bool make_of_dashpot(struct press_straight *p)
{
    const struct press *from = p->from;
    p->stiffness = from->by.c * p->rate;
    p->turn = p->settled = 0.0;
    p->y = from->gap;
    p->decay = decay_of_dashpot(p->y, p->y_rate, p->pull);
    p->amplitude = fabs(p->y) + fabs(p->decay.by_faster);
    return p->amplitude < DRIFT_STARTS * keeps_within(from);
}

bool press_straight_make(struct press_straight *p, const struct press *from)
{
    const bool has_spring = from->by.k > 0.0;
    p->rate = has_spring ? sqrt(from->by.k / from->reduced_mass) : from->by.c / from->reduced_mass;
    if (!(p->rate > 0.0) || !is_pulled_straight(from)) {
        return false;
    }
    p->from = from;
    p->pull = 2.0 * along_normal(from, 2) / (p->rate * p->rate);
    p->y_rate = press_closing(from) / p->rate;
    return has_spring ? make_of_spring(p) : make_of_dashpot(p);
}

double press_straight_longest(const struct press_straight *p, double resolution)
{
    if (p->turn > 0.0) {
        return (double)INFINITY;
    }
    const double flight = fmax(LONGEST_FLIGHT * p->amplitude, resolution / DBL_EPSILON);
    const double by_rate = flight / fabs(p->y_rate);
    const double by_fall = sqrt(2.0 * flight / fabs(p->pull));
    const double by_time = fmin(p->decay.half_turn, fmin(by_rate, by_fall));
    if (p->from->by.k > 0.0 || p->from->shape.side < 0) {
        return by_time;
    }
    const double free = DRIFT_ENDS * contact_reach(&p->from->shape) - p->amplitude;
    return fmin(by_time, free / fabs(p->decay.drift));
}

/* The gap that remains where y has decayed, else what it was and its change. */
static double decayed_gap(const struct press_straight *p, double y, double change)
{
    return 2.0 * fabs(y) < fabs(p->y) ? p->settled + y : p->from->gap + change;
}

/* How much y and y' have changed since the start. */
static struct oscillator_begun swung(const struct press_straight *p, double s)
{
    const double damping = p->oscillator.damping;
    if (s * (1.0 + damping) <= OSCILLATOR_BEGINS) {
        return oscillator_begun(&p->oscillator, p->y, p->y_rate, 0.0, s);
    }
    const double half_turn = 0.5 * p->turn * s;
    const double sine = sin(half_turn);
    const double cosine_less = -2.0 * sine * sine; /* cos - 1 */
    const double shrink_less = damping > 0.0 ? expm1(-0.5 * damping * s) : 0.0;
    const double by_rate = 2.0 * (1.0 + shrink_less) * sine * cos(half_turn) / p->turn;
    const double by_y = shrink_less + (1.0 + shrink_less) * cosine_less + 0.5 * damping * by_rate;
    return (struct oscillator_begun){p->y * by_y + p->y_rate * by_rate,
                                     p->y_rate * (by_y - damping * by_rate) - p->y * by_rate};
}

/* y and its first three derivatives; without what y and y' are at the start, which they keep in digits of their own. */
static void grow(const struct press_straight *p, double s, double y[4])
{
    const struct oscillator_begun change = swung(p, s);
    y[0] = change.x;
    y[1] = change.x_rate;
    y[2] = -p->oscillator.damping * (p->y_rate + y[1]) - (p->y + y[0]);
    y[3] = -p->oscillator.damping * y[2] - (p->y_rate + y[1]);
}

/* y' = exp(-damping s / 2) (y_rate cos + sideways sin) of turn s. */
double press_straight_first_turn(const struct press_straight *p)
{
    const double sideways = -(p->y + 0.5 * p->oscillator.damping * p->y_rate) / p->turn;
    const double angle = p->y_rate == 0.0  ? HALF_TURN
                         : p->y_rate < 0.0 ? atan2(-p->y_rate, sideways)
                                           : atan2(p->y_rate, -sideways);
    return angle / p->turn;
}

bool press_straight_closes(const struct press_straight *p)
{
    return p->y_rate < 0.0 || (p->y_rate == 0.0 && p->y > 0.0);
}

bool press_straight_keeps(const struct press_straight *p, enum press_quantity quantity, double factor,
                          double offset)
{
    if (!(p->from->by.k > 0.0)) {
        return false; /* for it drifts */
    }
    if (quantity == PRESS_GAP) {
        return p->amplitude < factor * p->settled + offset;
    }
    const double k = p->from->by.k;
    const double c = p->from->by.c * p->rate;
    const double bend = -p->oscillator.damping * p->y_rate - p->y;
    double settled = 0.0;
    double start = p->rate * p->y_rate; /* of what oscillates, and its rate */
    double start_rate = p->rate * bend;
    if (quantity == PRESS_FORCE) {
        settled = -k * p->settled;
        start = k * p->y + c * p->y_rate;
        start_rate = k * p->y_rate + c * bend;
    }
    return oscillator_envelope_of(&p->oscillator, start, start_rate).amplitude < factor * settled + offset;
}

static void sample_from(const struct press_straight *p, const double y[4], struct press_sample *sample)
{
    for (int i = 0; i < 3; ++i) {
        sample->of[PRESS_GAP][i] = y[i];
        sample->of[PRESS_RATE][i] = p->rate * y[i + 1];
        sample->of[PRESS_FORCE][i] = -(p->from->by.k * y[i] + p->from->by.c * sample->of[PRESS_RATE][i]);
    }
}

/* F_n = m_red (g'' - side n.A). */
static void sample_decay(const struct press_straight *p, double s, struct press_sample *sample)
{
    double y[1 + DECAY_DERIVATIVES];
    decay_at(&p->decay, s, y);
    for (int i = 0; i < 3; ++i) {
        sample->of[PRESS_GAP][i] = y[i];
        sample->of[PRESS_RATE][i] = p->rate * y[1 + i];
        sample->of[PRESS_FORCE][i] = p->stiffness * y[2 + i];
    }
    sample->of[PRESS_GAP][0] = decayed_gap(p, y[0], decay_since(&p->decay, s).y);
    sample->of[PRESS_FORCE][0] -= p->stiffness * p->pull;
}

void press_straight_sample(const void *press_straight, double s, struct press_sample *sample)
{
    const struct press_straight *p = press_straight;
    double y[4];
    if (!(p->turn > 0.0)) {
        sample_decay(p, s, sample);
        return;
    }
    grow(p, s, y);
    y[0] += p->from->gap;
    y[1] += p->y_rate;
    sample_from(p, y, sample);
}

/* Where y' = 0 the phase of y is that of a turning point: |y| = turn amplitude exp(-damping s / 2). */
void press_straight_sample_turn(const struct press_straight *p, double s, bool deepest,
                                struct press_sample *sample)
{
    const double damping = p->oscillator.damping;
    const double shrunk = damping > 0.0 ? p->turn * exp(-0.5 * damping * s) : 1.0;
    const double size = deepest ? -shrunk * p->amplitude : shrunk * p->amplitude;
    const double y[4] = {p->settled + size, 0.0, -size, damping * size};
    sample_from(p, y, sample);
}

/* From the oscillator's own balance of energy: p_nv g'^2 = -(m g'^2 / 2 + p_n (g - settled)^2 / 2)', or -(m g'^2 / 2 - side m n.A g)'. */
static double dissipated_straight(const struct press_straight *p, const double grown[2])
{
    const bool has_spring = p->from->by.k > 0.0;
    const double by_rate = grown[1] * (2.0 * p->y_rate + grown[1]);
    const double by_place = grown[0] * (has_spring ? 2.0 * p->y + grown[0] : -2.0 * p->pull);
    return p->from->by.c > 0.0 ? -0.5 * p->stiffness * (by_rate + by_place) : 0.0;
}

/* The gap, and since the start that and its rate per s. */
static double gap_grown(const struct press_straight *p, double s, double grown[2])
{
    double y[1 + DECAY_DERIVATIVES];
    if (p->turn > 0.0) {
        grow(p, s, y);
        grown[0] = y[0];
        grown[1] = y[1];
        return p->from->gap + grown[0];
    }
    const struct decay_change since = decay_since(&p->decay, s);
    decay_at(&p->decay, s, y);
    grown[0] = since.y;
    grown[1] = since.y_rate;
    return decayed_gap(p, y[0], since.y);
}

struct press_change press_straight_change(const struct press_straight *p, double s)
{
    const struct press *from = p->from;
    const double time = s / p->rate;
    const double side = from->shape.side;
    const double fall = 2.0 * along_normal(from, 2) * time;
    double grown[2];
    const double gap = gap_grown(p, s, grown);
    const double r = grown[0] - (p->y_rate * s + 0.5 * fall * time);
    const double r_rate = p->rate * grown[1] - fall;
    struct press_change change = {.time = time,
                                  .r = vec3_scale(side * r, from->normal),
                                  .r_rate = vec3_scale(side * r_rate, from->normal),
                                  .gap = gap,
                                  .dissipated = dissipated_straight(p, grown)};
    for (int end = 0; end < PRESS_ENDS; ++end) {
        const struct press_work *work = &from->work[end];
        const struct vec3 by = work->order == 1 ? change.r : change.r_rate;
        change.work[end] = work->order == 0 ? 0.0 : vec3_dot(work->path[0], by);
    }
    return change;
}

#endif
