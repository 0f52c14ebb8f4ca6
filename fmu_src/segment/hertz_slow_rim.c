#include "segment/hertz_slow_rim.h"

#include <string.h>

#if SCENE_ANY_CAPS && SCENE_ANY_HERTZ

/* Rows of azimuth and tilt, then of their momenta. */
enum { RIM_ROWS = 4 };
static const int rim_rows[RIM_ROWS] = {0, 1, HERTZ_DIMENSIONS, HERTZ_DIMENSIONS + 1};

static struct rim_state slow_rim_state(const struct hertz_slow *p, const double turned[HERTZ_TURNING],
                                       double depth)
{
    double change[RIM_ROWS];
    for (int k = 0; k < RIM_ROWS; ++k) {
        change[k] = turned[rim_rows[k]];
    }
    return rim_state_of(&p->rim, change, p->depth_start - depth);
}

static struct rim_slopes slow_rim_slopes(const struct hertz_slow *p, int node, struct rim_state *at)
{
    const double *pull = p->pull[node];
    double turned[HERTZ_TURNING];
    for (int j = 0; j < HERTZ_TURNING; ++j) {
        turned[j] = p->turned[j][node];
    }
    *at = slow_rim_state(p, turned, p->depth[node]);
    return rim_slopes_at(at, vec3_make(pull[0], pull[1], pull[2]));
}

void slow_rim_begin(struct hertz_slow *p)
{
    p->rim = pair_rim_start(p->from);
    memcpy(p->flight.frame, p->rim.frame, sizeof p->flight.frame);
    p->flight.dimensions = HERTZ_DIMENSIONS;
    for (int k = 1; k <= p->flight.degree; ++k) {
        for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
            p->flight.c[k][j] = vec3_dot(p->flight.frame[j], p->from->flight.c[k]);
            p->flight.w[k - 1][j] = vec3_dot(p->flight.frame[j], p->from->flight.w[k - 1]);
        }
    }
    memset(p->start, 0, sizeof p->start);
}

/* The rates of two rows, from `first` of rim_rows on, and what they come to; returns the largest change. */
static double slow_rim_integrate(struct hertz_slow *p, int first)
{
    double change = 0.0;
    for (int i = 0; i < SLOW_N; ++i) {
        struct rim_state at;
        const struct rim_slopes slopes = slow_rim_slopes(p, i, &at);
        double rates[RIM_ROWS];
        rim_change_rates(&p->rim, &slopes, rates);
        for (int k = first; k < first + 2; ++k) {
            p->turning[rim_rows[k]][i] = p->half * rates[k];
        }
    }
    for (int k = first; k < first + 2; ++k) {
        const int row = rim_rows[k];
        change = fmax(change, nodal_integrate(&radau, p->turning[row], p->turned[row]));
    }
    return change;
}

double slow_rim_sweep(struct hertz_slow *p)
{
    (void)slow_rim_integrate(p, 2);
    return slow_rim_integrate(p, 0);
}

void slow_rim_load(const struct hertz_slow *p, double load[SLOW_N])
{
    for (int i = 0; i < SLOW_N; ++i) {
        struct rim_state at;
        load[i] = -p->half * p->half * slow_rim_slopes(p, i, &at).load;
    }
}

static void put_components(struct vec3 a, double out[HERTZ_DIMENSIONS])
{
    out[0] = a.x;
    out[1] = a.y;
    out[2] = a.z;
}

void slow_rim_normal(const struct hertz_slow *p, const struct slow_place *at, double n[HERTZ_DIMENSIONS])
{
    const struct rim_state state = slow_rim_state(p, at->turned, at->depth);
    put_components(rim_normal(&state), n);
}

void slow_rim_deviation(const struct hertz_slow *p, const struct slow_place *at, double s,
                        double r[HERTZ_DIMENSIONS], double r_rate[HERTZ_DIMENSIONS])
{
    const double none[RIM_ROWS] = {0.0, 0.0, 0.0, 0.0};
    const double time = p->half * s;
    const struct rim_state start = rim_state_of(&p->rim, none, 0.0);
    const struct rim_state then = slow_rim_state(p, at->turned, at->depth);
    put_components(rim_moved(&p->rim, &then), r);
    put_components(
        vec3_sub(rim_velocity(&then, -at->rate / p->half), rim_velocity(&start, -p->rate_start / p->half)),
        r_rate);
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        double c = 0.0;
        double w = 0.0;
        for (int k = p->flight.degree; k >= 1; --k) {
            c = (c + p->flight.c[k][j]) * time;
            w = k > 1 ? (w + k * p->flight.c[k][j]) * time : w;
        }
        r[j] -= c;
        r_rate[j] -= w;
    }
}

static struct vec3 acceleration_of_flight(const struct hertz_slow *p, double time)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int k = p->flight.degree; k >= 2; --k) {
        const double *c = p->flight.c[k];
        sum = vec3_add(vec3_scale(time, sum), vec3_scale(k * (k - 1), vec3_make(c[0], c[1], c[2])));
    }
    return sum;
}

void slow_rim_edges(const struct hertz_slow *p, const struct slow_place *at, double s,
                    struct pair_sample *sample)
{
    double tilt[3] = {0.0, 0.0, 0.0};
    if (slow_at_rim(p)) {
        const struct rim_state state = slow_rim_state(p, at->turned, at->depth);
        const struct rim_slopes slopes = rim_slopes_at(&state, acceleration_of_flight(p, p->half * s));
        const double bend = p->half * p->half * slopes.over / (state.d * state.d);
        tilt[0] = state.tilt;
        tilt[1] = p->half * slopes.tilt;
        tilt[2] = bend + 2.0 * tilt[1] * at->rate / state.d;
    } else {
        tilt[0] = pair_rim_start(p->from).tilt;
    }
    rim_edges(tilt, contact_reach(&p->from->shape), sample->of[PAIR_RADIAL], sample->of[PAIR_AXIAL]);
}

#endif
