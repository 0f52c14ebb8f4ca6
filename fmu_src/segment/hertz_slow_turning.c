/* How the normal turns in a slow segment, and the load that comes of it. */
#include "segment/hertz_slow_rim.h"

/* The relative acceleration of flight at a time, in the frame [m/s^2]. */
static void slow_acceleration(const struct hertz_flight *flight, double time, double out[HERTZ_DIMENSIONS])
{
    for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
        out[j] = 0.0;
        for (int k = flight->degree; k >= 2; --k) {
            out[j] = out[j] * time + k * (k - 1) * flight->c[k][j];
        }
    }
}

void slow_note_pull(struct hertz_slow *p)
{
    for (int i = 0; i < SLOW_N; ++i) {
        slow_acceleration(&p->flight, p->half * (1.0 + radau.node[i]), p->pull[i]);
    }
}

static double slow_dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* n and H at a node; what does not turn keeps its start. */
static void turned_at(const struct hertz_slow *p, int node, double at[HERTZ_TURNING])
{
    for (int j = 0; j < HERTZ_TURNING; ++j) {
        at[j] = p->start[j] + p->turned[j][node];
    }
}

/* The changes of the components from `first` on, of n or of H, from their rates; returns the largest
 * difference from before. */
static double integrate_turning(struct hertz_slow *p, int first)
{
    double change = 0.0;
    for (int j = first; j < first + HERTZ_DIMENSIONS; ++j) {
        if (is_turning(p, j)) {
            change = fmax(change, nodal_integrate(&radau, p->turning[j], p->turned[j]));
        }
    }
    return change;
}

double slow_sweep_turning(struct hertz_slow *p)
{
    if (p->flight.dimensions == 1) {
        return 0.0;
    }
    if (slow_at_rim(p)) {
        return slow_rim_sweep(p);
    }
    for (int i = 0; i < SLOW_N; ++i) {
        double at[HERTZ_TURNING];
        double rate[HERTZ_DIMENSIONS];
        turned_at(p, i, at);
        slow_cross(at, p->pull[i], p->half * slow_distance(p, p->depth[i]), rate);
        for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
            p->turning[HERTZ_DIMENSIONS + j][i] = rate[j];
        }
    }
    (void)integrate_turning(p, HERTZ_DIMENSIONS);
    for (int i = 0; i < SLOW_N; ++i) {
        const double d = slow_distance(p, p->depth[i]);
        double at[HERTZ_TURNING];
        double rate[HERTZ_DIMENSIONS];
        turned_at(p, i, at);
        slow_cross(at + HERTZ_DIMENSIONS, at, p->half / (d * d), rate);
        for (int j = 0; j < HERTZ_DIMENSIONS; ++j) {
            p->turning[j][i] = rate[j];
        }
    }
    return integrate_turning(p, 0);
}

void slow_load(const struct hertz_slow *p, double load[SLOW_N])
{
    if (slow_at_rim(p)) {
        slow_rim_load(p, load);
        return;
    }
    for (int i = 0; i < SLOW_N; ++i) {
        double at[HERTZ_TURNING];
        turned_at(p, i, at);
        double push = slow_dot(at, p->pull[i]);
        if (p->flight.dimensions > 1) {
            const double *h = at + HERTZ_DIMENSIONS;
            const double d = slow_distance(p, p->depth[i]);
            push += slow_dot(h, h) / (d * d * d);
        }
        load[i] = -p->from->shape.side * p->half * p->half * push;
    }
}
