#include "dynamics/press_straight.h"

#if SCENE_ANY_FREE

#include "dynamics/head_on.h"

/* Radians of y per s: 0.97 of critical damping. Nearer to it most of a turn is below rounding. */
static const double SLOWEST_TURN = 0.25;

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

bool press_straight_make(struct press_straight *p, const struct press *from)
{
    const double square = from->by.k / from->reduced_mass;
    const double damping = from->by.c / from->reduced_mass;
    if (!(damping * damping < 4.0 * square) || !is_pulled_straight(from)) {
        return false;
    }
    p->from = from;
    p->rate = sqrt(square);
    p->oscillator = (struct oscillator){1.0, damping / p->rate};
    p->turn = sqrt(1.0 - 0.25 * p->oscillator.damping * p->oscillator.damping);
    p->settled = 2.0 * along_normal(from, 2) / square;
    p->y = from->gap - p->settled;
    p->y_rate = along_normal(from, 1) / p->rate;
    p->amplitude = oscillator_envelope_of(&p->oscillator, p->y, p->y_rate).amplitude;
    return p->turn >= SLOWEST_TURN && fabs(p->settled) + p->amplitude < contact_reach(&from->shape);
}

static void grow_nothing(const struct press_straight *p, double y[4])
{
    y[0] = y[1] = 0.0;
    y[2] = -p->oscillator.damping * p->y_rate - p->y;
    y[3] = -p->oscillator.damping * y[2] - p->y_rate;
}

/* y and its first three derivatives; without what y and y' are at the start, which they keep in digits of their own. */
static void grow(const struct press_straight *p, double s, double y[4])
{
    if (s == 0.0) {
        grow_nothing(p, y);
        return;
    }
    const double damping = p->oscillator.damping;
    const double half_turn = 0.5 * p->turn * s;
    const double sine = sin(half_turn);
    const double cosine_less = -2.0 * sine * sine; /* cos - 1 */
    const double shrink_less = damping > 0.0 ? expm1(-0.5 * damping * s) : 0.0;
    const double by_rate = 2.0 * (1.0 + shrink_less) * sine * cos(half_turn) / p->turn;
    const double by_y = shrink_less + (1.0 + shrink_less) * cosine_less + 0.5 * damping * by_rate;
    y[0] = p->y * by_y + p->y_rate * by_rate;
    y[1] = p->y_rate * (by_y - damping * by_rate) - p->y * by_rate;
    y[2] = -damping * (p->y_rate + y[1]) - (p->y + y[0]);
    y[3] = -damping * y[2] - (p->y_rate + y[1]);
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

void press_straight_sample(const void *press_straight, double s, struct press_sample *sample)
{
    const struct press_straight *p = press_straight;
    double y[4];
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

/* From the oscillator's own balance of energy: p_nv g'^2 = -(m g'^2 / 2 + p_n (g - settled)^2 / 2)'. */
static double dissipated_straight(const struct press_straight *p, const double grown[4])
{
    const double by_rate = grown[1] * (2.0 * p->y_rate + grown[1]);
    const double by_spring = grown[0] * (2.0 * p->y + grown[0]);
    return p->from->by.c > 0.0 ? -0.5 * p->from->by.k * (by_rate + by_spring) : 0.0;
}

struct press_change press_straight_change(const struct press_straight *p, double s)
{
    const struct press *from = p->from;
    const double time = s / p->rate;
    const double side = from->shape.side;
    const double fall = 2.0 * along_normal(from, 2) * time;
    double grown[4];
    grow(p, s, grown);
    const double r = grown[0] - (p->y_rate * s + 0.5 * fall * time);
    const double r_rate = p->rate * grown[1] - fall;
    struct press_change change = {.time = time,
                                  .r = vec3_scale(side * r, from->normal),
                                  .r_rate = vec3_scale(side * r_rate, from->normal),
                                  .gap = from->gap + grown[0],
                                  .dissipated = dissipated_straight(p, grown)};
    for (int end = 0; end < PRESS_ENDS; ++end) {
        const struct press_work *work = &from->work[end];
        const struct vec3 by = work->order == 1 ? change.r : change.r_rate;
        change.work[end] = work->order == 0 ? 0.0 : vec3_dot(work->path[0], by);
    }
    return change;
}

#endif
