#include "segment/hertz_slow_rim.h"

static double slow_depth(const struct hertz_slow *p, double s)
{
    return p->depth_start + nodal_integral(p->rate_terms, SLOW_N, s);
}

static struct slow_place slow_place_at(const struct hertz_slow *p, double s)
{
    struct slow_place at = {.depth = slow_depth(p, s), .rate = nodal_polynomial_at(p->rate_terms, SLOW_N, s)};
    for (int j = 0; j < HERTZ_TURNING; ++j) {
        at.turned[j] = p->start[j];
        if (is_turning(p, j)) {
            at.turned[j] += nodal_integral_to(&radau, p->turned[j], p->turning[j], s);
        }
    }
    return at;
}

void slow_hertz_sample(const void *hertz_slow, double s, struct pair_sample *sample)
{
    const struct hertz_slow *p = hertz_slow;
    double rate[4];
    const double depth = slow_depth(p, s);
    const double root = sqrt(fmax(depth, 0.0));
    nodal_derivatives(p->rate_terms, SLOW_N, s, rate);
    const double chi = p->from->chi / p->half;
    const double damping[3] = {1.0 + chi * rate[0], chi * rate[1], chi * rate[2]};
    const double spring[3] = {depth * root, 1.5 * root * rate[0],
                              0.75 / root * rate[0] * rate[0] + 1.5 * root * rate[1]};
    const double k = p->from->hertz_stiffness;
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP][i] = i == 0 ? -depth : -rate[i - 1];
        sample->of[PAIR_GAP_RATE][i] = -rate[i] / p->half;
    }
    sample->of[PAIR_FORCE][0] = k * spring[0] * damping[0];
    sample->of[PAIR_FORCE][1] = k * (spring[1] * damping[0] + spring[0] * damping[1]);
    sample->of[PAIR_FORCE][2] =
        k * (spring[2] * damping[0] + 2.0 * spring[1] * damping[1] + spring[0] * damping[2]);
#if SCENE_ANY_CAPS
    if (contact_is_rim(&p->from->shape)) {
        const struct slow_place at = slow_place_at(p, s);
        slow_rim_edges(p, &at, s, sample);
    }
#endif
}

static struct slow_place slow_place_of_node(const struct hertz_slow *p, int node)
{
    struct slow_place at = {.depth = p->depth[node], .rate = p->rate[node]};
    for (int j = 0; j < HERTZ_TURNING; ++j) {
        at.turned[j] = p->start[j] + p->turned[j][node];
    }
    return at;
}

/* r and r' at a place, in the frame. */
static void slow_deviation(const struct hertz_slow *p, const struct slow_place *at, double s,
                           double r[HERTZ_DIMENSIONS], double r_rate[HERTZ_DIMENSIONS])
{
    if (slow_at_rim(p)) {
        slow_rim_deviation(p, at, s, r, r_rate);
        return;
    }
    const double time = p->half * s;
    const double d = slow_distance(p, at->depth);
    const double radial = -p->from->shape.side * at->rate / p->half;
    double along[HERTZ_DIMENSIONS] = {0.0, 0.0, 0.0};
    slow_cross(at->turned + HERTZ_DIMENSIONS, at->turned, 1.0 / d, along);
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        double c = 0.0;
        double w = 0.0;
        for (int k = p->flight.degree; k >= 1; --k) {
            c = (c + p->flight.c[k][j]) * time;
            w = w * time + k * p->flight.c[k][j];
        }
        const double start = j == 0 ? p->from->distance : 0.0;
        const bool counts = j < p->flight.dimensions;
        r[j] = counts ? (d * at->turned[j] - start) - c : 0.0;
        r_rate[j] = counts ? radial * at->turned[j] + along[j] - w : 0.0;
    }
}

/* F_n at a place [SLOW_N]. */
static double slow_force(const struct hertz_slow *p, const struct slow_place *at)
{
    double law[3];
    slow_law(p, at->depth, at->rate, law);
    return p->from->reduced_mass * law[0] / (p->half * p->half);
}

static bool has_work(const struct pair_work *work)
{
    return work->order > 0 &&
           !(vec3_is_zero(work->path[0]) && vec3_is_zero(work->path[1]) && vec3_is_zero(work->path[2]));
}

/* The integrals of pair_work and of the dashpot's power over [0, s], by Radau's quadrature: over the whole
 * step its places are the nodes. */
static void slow_powers(const struct hertz_slow *p, double s, struct pair_change *change)
{
    change->dissipated = change->work[0] = change->work[1] = 0.0;
    if (!has_work(&p->from->work[0]) && !has_work(&p->from->work[1]) && !(p->from->chi > 0.0)) {
        return;
    }
    for (int i = 0; i < SLOW_N; ++i) {
        const double place = 0.5 * s * (1.0 + radau.node[i]);
        const double weight = 0.5 * s * p->half * radau.integral[i * SLOW_N + SLOW_N - 1];
        const double time = p->half * place;
        const struct slow_place at = s == 2.0 ? slow_place_of_node(p, i) : slow_place_at(p, place);
        const double force = slow_force(p, &at);
        const double rate = at.rate / p->half;
        const double spring = p->from->hertz_stiffness * at.depth * sqrt(at.depth);
        double rows[3][HERTZ_DIMENSIONS];
        const double *n = at.turned;
        double rim_normal_then[HERTZ_DIMENSIONS];
        if (slow_at_rim(p)) {
            slow_rim_normal(p, &at, rim_normal_then);
            n = rim_normal_then;
        }
        slow_deviation(p, &at, place, rows[0], rows[1]);
        change->dissipated += weight * (force - spring) * rate;
        for (int body = 0; body < PAIR_BODIES; ++body) {
            const struct pair_work *work = &p->from->work[body];
            for (int j = 0; j < p->flight.dimensions && work->order > 0; ++j) {
                rows[2][j] = p->from->shape.side * force / p->from->reduced_mass * n[j];
                const struct vec3 path =
                    vec3_axpy(vec3_axpy(work->path[0], time, work->path[1]), time * time, work->path[2]);
                change->work[body] += weight * vec3_dot(path, p->flight.frame[j]) * rows[work->order][j];
            }
        }
    }
}

struct pair_change slow_hertz_change(const void *hertz_slow, double s)
{
    const struct hertz_slow *p = hertz_slow;
    const struct slow_place at = slow_place_at(p, s);
    double r[HERTZ_DIMENSIONS];
    double r_rate[HERTZ_DIMENSIONS];
    slow_deviation(p, &at, s, r, r_rate);
    struct pair_change change = {.time = p->half * s, .gap = -at.depth};
    change.head_on = p->from->is_head_on;
    change.gap_rate = -at.rate / p->half;
    change.r = change.r_rate = vec3_make(0.0, 0.0, 0.0);
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        change.r = vec3_axpy(change.r, r[j], p->flight.frame[j]);
        change.r_rate = vec3_axpy(change.r_rate, r_rate[j], p->flight.frame[j]);
    }
    slow_powers(p, s, &change);
    return change;
}
