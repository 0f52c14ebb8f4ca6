#include "dynamics/press_straight.h"

#if SCENE_ANY_FREE

/* Radians of y per s: 0.97 of critical damping. Nearer to it most of a turn is below rounding. */
static const double SLOWEST_TURN = 0.25;

static bool is_constant(const struct press_work *work)
{
    return work->order == 0 || (vec3_is_zero(work->path[1]) && vec3_is_zero(work->path[2]));
}

/* Exactly so, not nearly: any other motion leaves the normal. */
static bool is_along_normal(const struct press *from)
{
    const struct separation *flight = &from->flight;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = press_across(from, flight->c[i]);
        const struct vec3 w = press_across(from, flight->w[i - 1]);
        const struct vec3 sideways = vec3_cross(from->normal, c);
        if (!vec3_is_zero(sideways) || !vec3_is_zero(vec3_axpy(w, -i, c)) || (i > 2 && !vec3_is_zero(c))) {
            return false;
        }
    }
    return is_constant(&from->work[0]) && is_constant(&from->work[1]);
}

static double along_normal(const struct press *from, int degree)
{
    return from->shape.side * vec3_dot(from->normal, press_across(from, from->flight.c[degree]));
}

bool press_straight_make(struct press_straight *p, const struct press *from)
{
    const double square = from->by.k / from->reduced_mass;
    const double damping = from->by.c / from->reduced_mass;
    if (!(damping * damping < 4.0 * square) || !is_along_normal(from)) {
        return false;
    }
    p->from = from;
    p->rate = sqrt(square);
    p->oscillator = (struct oscillator){1.0, damping / p->rate};
    p->turn = sqrt(1.0 - 0.25 * p->oscillator.damping * p->oscillator.damping);
    p->settled = 2.0 * along_normal(from, 2) / square;
    p->y = from->gap - p->settled;
    p->y_rate = along_normal(from, 1) / p->rate;
    const double amplitude = oscillator_envelope_of(&p->oscillator, p->y, p->y_rate).amplitude;
    return p->turn >= SLOWEST_TURN && fabs(p->settled) + amplitude < contact_reach(&from->shape);
}

/* y and its first three derivatives; without what y and y' are at the start, which they keep in digits of their own. */
static void grow(const struct press_straight *p, double s, double y[4])
{
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

bool press_straight_keeps(const struct press_straight *p, enum press_quantity quantity, double factor,
                          double offset)
{
    const double k = p->from->by.k;
    const double c = p->from->by.c * p->rate;
    const double bend = -p->oscillator.damping * p->y_rate - p->y;
    double settled = p->settled;
    double start = p->y; /* of what oscillates, and its rate */
    double start_rate = p->y_rate;
    if (quantity == PRESS_RATE) {
        settled = 0.0;
        start = p->rate * p->y_rate;
        start_rate = p->rate * bend;
    } else if (quantity == PRESS_FORCE) {
        settled = -k * p->settled;
        start = k * p->y + c * p->y_rate;
        start_rate = k * p->y_rate + c * bend;
    }
    return oscillator_envelope_of(&p->oscillator, start, start_rate).amplitude < factor * settled + offset;
}

void press_straight_sample(const void *press_straight, double s, struct press_sample *sample)
{
    const struct press_straight *p = press_straight;
    double y[4];
    grow(p, s, y);
    y[0] += p->from->gap;
    y[1] += p->y_rate;
    for (int i = 0; i < 3; ++i) {
        sample->of[PRESS_GAP][i] = y[i];
        sample->of[PRESS_RATE][i] = p->rate * y[i + 1];
        sample->of[PRESS_FORCE][i] = -(p->from->by.k * y[i] + p->from->by.c * sample->of[PRESS_RATE][i]);
    }
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
