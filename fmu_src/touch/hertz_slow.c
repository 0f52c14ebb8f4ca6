#include <float.h>
#include <string.h>

#include "math/compiler.h"
#include "math/lu.h"
#include "math/node_tables.h"
#include "touch/hertz.h"
#include "touch/hertz_slow.h"
#include "touch/segment.h"
#include "touch/terminal_event.h"

/* n, H, delta and d delta/ds at s. */
struct slow_place {
    double turned[HERTZ_TURNING];
    double depth, rate;
};

/* factor a x b */
static inline void slow_cross(const double *a, const double *b, double slow_factor, double out[FRAME])
{
    out[0] = slow_factor * (a[1] * b[2] - a[2] * b[1]);
    out[1] = slow_factor * (a[2] * b[0] - a[0] * b[2]);
    out[2] = slow_factor * (a[0] * b[1] - a[1] * b[0]);
}

static inline double slow_distance(const struct hertz_slow *p, double depth)
{
    return p->from->distance - p->from->shape.side * (depth - p->depth_start);
}

/* Whether a component of n or H changes. */
static inline bool is_turning(const struct hertz_slow *p, int row)
{
    if (contact_is_rim(&p->from->shape)) { /* its third rows are zero */
        return p->flight.dimensions > 1 && row % FRAME < 2;
    }
    const bool in_plane = row == 0 || row == 1 || row == HERTZ_TURNING - 1;
    return p->flight.dimensions == 3 || (p->flight.dimensions == 2 && in_plane);
}

/* The bend by the law, and its derivatives with respect to delta and d delta/ds. */
static inline void slow_law(const struct hertz_slow *p, double depth, double rate, double out[3])
{
    const double root = sqrt(depth);
    const double scale = p->half * p->half * p->k;
    const double damping = 1.0 + p->from->chi * rate / p->half;
    out[0] = scale * depth * root * damping;
    out[1] = 1.5 * scale * root * damping;
    out[2] = scale * depth * root * p->from->chi / p->half;
}

/* How n and H turn at a place. The rows of n and H are those of the frame; a place may use them otherwise. */
struct slow_turning {
    /* One sweep with delta as it is: H by n, then n by that H, so that the error falls by two powers of the
     * radians in the step; returns the largest change of n. */
    double (*sweep)(struct hertz_slow *p);
    void (*load)(const struct hertz_slow *p, double load[SLOW_N]); /* half^2 L [m] at the nodes */
    void (*normal)(const struct hertz_slow *p, const struct slow_place *at,
                   double n[FRAME]); /* in the frame */
    /* r and r' at a place, in the frame */
    void (*deviation)(const struct hertz_slow *p, const struct slow_place *at, double s, double r[FRAME],
                      double r_rate[FRAME]);
};

/* How the normal turns in a slow segment, and the load that comes of it. */

/* The relative acceleration of flight at a time, in the frame [m/s^2]. */
static void slow_acceleration(const struct frame_flight *flight, double time, double out[FRAME])
{
    for (int j = 0; j < FRAME; ++j) {
        out[j] = 0.0;
        for (int k = flight->degree; k >= 2; --k) {
            out[j] = out[j] * time + k * (k - 1) * flight->c[k][j];
        }
    }
}

/* p->pull, from p->flight and p->half. */
static void slow_note_pull(struct hertz_slow *p)
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
    for (int j = first; j < first + FRAME; ++j) {
        if (is_turning(p, j)) {
            change = fmax(change, nodal_integrate(&radau, p->turning[j], p->turned[j]));
        }
    }
    return change;
}

static double slow_centre_sweep(struct hertz_slow *p)
{
    if (p->flight.dimensions == 1) {
        return 0.0;
    }
    for (int i = 0; i < SLOW_N; ++i) {
        double at[HERTZ_TURNING];
        double rate[FRAME];
        turned_at(p, i, at);
        slow_cross(at, p->pull[i], p->half * slow_distance(p, p->depth[i]), rate);
        for (int j = 0; j < FRAME; ++j) {
            p->turning[FRAME + j][i] = rate[j];
        }
    }
    (void)integrate_turning(p, FRAME);
    for (int i = 0; i < SLOW_N; ++i) {
        const double d = slow_distance(p, p->depth[i]);
        double at[HERTZ_TURNING];
        double rate[FRAME];
        turned_at(p, i, at);
        slow_cross(at + FRAME, at, p->half / (d * d), rate);
        for (int j = 0; j < FRAME; ++j) {
            p->turning[j][i] = rate[j];
        }
    }
    return integrate_turning(p, 0);
}

static void slow_centre_load(const struct hertz_slow *p, double load[SLOW_N])
{
    for (int i = 0; i < SLOW_N; ++i) {
        double at[HERTZ_TURNING];
        turned_at(p, i, at);
        double push = slow_dot(at, p->pull[i]);
        if (p->flight.dimensions > 1) {
            const double *h = at + FRAME;
            const double d = slow_distance(p, p->depth[i]);
            push += slow_dot(h, h) / (d * d * d);
        }
        load[i] = -p->from->shape.side * p->half * p->half * push;
    }
}

static void slow_centre_deviation(const struct hertz_slow *p, const struct slow_place *at, double s,
                                  double r[FRAME], double r_rate[FRAME])
{
    const double time = p->half * s;
    const double d = slow_distance(p, at->depth);
    const double radial = -p->from->shape.side * at->rate / p->half;
    double along[FRAME] = {0.0, 0.0, 0.0};
    slow_cross(at->turned + FRAME, at->turned, 1.0 / d, along);
    for (int j = 0; j < FRAME; ++j) {
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

static void slow_centre_normal(const struct hertz_slow *p, const struct slow_place *at, double n[FRAME])
{
    (void)p;
    memcpy(n, at->turned, FRAME * sizeof *n);
}

static const struct slow_turning about_a_centre = {slow_centre_sweep, slow_centre_load, slow_centre_normal,
                                                   slow_centre_deviation};

/*
 * At the rim of a capped cylinder, in the coordinates of rim.h: the rows of n hold the changes of azimuth
 * and tilt, those of H the changes of their momenta; the third ones are zero.
 */

/* Rows of azimuth and tilt, then of their momenta. */
enum { RIM_ROWS = 4 };
static const int rim_rows[RIM_ROWS] = {0, 1, FRAME, FRAME + 1};

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

/* The frame, and the flight in it. */
static void slow_rim_begin(struct hertz_slow *p)
{
    p->rim = pair_rim_start(p->from);
    p->flight = frame_flight_at_rim(p->from);
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

static double slow_rim_sweep(struct hertz_slow *p)
{
    (void)slow_rim_integrate(p, 2);
    return slow_rim_integrate(p, 0);
}

static void slow_rim_load(const struct hertz_slow *p, double load[SLOW_N])
{
    for (int i = 0; i < SLOW_N; ++i) {
        struct rim_state at;
        load[i] = -p->half * p->half * slow_rim_slopes(p, i, &at).load;
    }
}

static void put_components(struct vec3 a, double out[FRAME])
{
    out[0] = a.x;
    out[1] = a.y;
    out[2] = a.z;
}

static void slow_rim_normal(const struct hertz_slow *p, const struct slow_place *at, double n[FRAME])
{
    const struct rim_state state = slow_rim_state(p, at->turned, at->depth);
    put_components(rim_normal(&state), n);
}

static void slow_rim_deviation(const struct hertz_slow *p, const struct slow_place *at, double s,
                               double r[FRAME], double r_rate[FRAME])
{
    const double none[RIM_ROWS] = {0.0, 0.0, 0.0, 0.0};
    const double time = p->half * s;
    const struct rim_state start = rim_state_of(&p->rim, none, 0.0);
    const struct rim_state then = slow_rim_state(p, at->turned, at->depth);
    put_components(rim_moved(&p->rim, &then), r);
    put_components(
        vec3_sub(rim_velocity(&then, -at->rate / p->half), rim_velocity(&start, -p->rate_start / p->half)),
        r_rate);
    for (int j = 0; j < FRAME; ++j) {
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

static const struct slow_turning about_a_rim = {slow_rim_sweep, slow_rim_load, slow_rim_normal,
                                                slow_rim_deviation};

static struct vec3 acceleration_of_flight(const struct hertz_slow *p, double time)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int k = p->flight.degree; k >= 2; --k) {
        const double *c = p->flight.c[k];
        sum = vec3_add(vec3_scale(time, sum), vec3_scale(k * (k - 1), vec3_make(c[0], c[1], c[2])));
    }
    return sum;
}

/* PAIR_RADIAL and PAIR_AXIAL at a place; of a head-on motion too. */
static void slow_rim_edges(const struct hertz_slow *p, const struct slow_place *at, double s,
                           struct pair_sample *sample)
{
    double tilt[3] = {0.0, 0.0, 0.0};
    if (p->turns == &about_a_rim) {
        const struct rim_state state = slow_rim_state(p, at->turned, at->depth);
        const struct rim_slopes slopes = rim_slopes_at(&state, acceleration_of_flight(p, p->half * s));
        const double bend = p->half * p->half * slopes.over / (state.d * state.d);
        tilt[0] = state.tilt;
        tilt[1] = p->half * slopes.tilt;
        tilt[2] = bend + 2.0 * tilt[1] * at->rate / state.d;
    } else {
        tilt[0] = pair_rim_start(p->from).tilt;
    }
    if (SCENE_ANY_CAPS) { /* else samples have no room for it */
        rim_edges(tilt, contact_reach(&p->from->shape), sample->of[PAIR_RADIAL], sample->of[PAIR_AXIAL]);
    }
}

enum { SLOW_SWEEPS = 30 };

/* Sweeps have converged where what is left changes delta and n by less than this part of them; their rounding
 * is less. */
static const double SLOW_SWEPT = 4.0 * DBL_EPSILON;

/* Newton's matrix is made once n changes by less than this, and anew while delta changes by more than this
 * part, on its way to its place. */
static const double NEW_MATRIX = 1e-3;

/* Columns of Newton's matrix are a vector longer than the matrix has rows (lu.h). */
enum { SLOW_STRIDE = SLOW_N + LANES };

/* The defect's slope with the rate at the nodes, factored: D + spring I + dashpot, where I integrates
 * values at the nodes and D is its inverse. */
struct slow_newton {
    double at[SLOW_N * SLOW_STRIDE];
    int pivot[SLOW_N];
};

static struct dense_matrix slow_system(struct slow_newton *newton)
{
    return (struct dense_matrix){SLOW_N, SLOW_STRIDE, newton->at, newton->pivot};
}

/* d/ds at node i of the polynomial that is 1 at node j and 0 at the others and at the start: the step of
 * [0, 1] that radau_stages_12 has is half as long. */
static double slow_derivative(int i, int j)
{
    return 0.5 * radau_stages_12.inverse[i * SLOW_N + j];
}

/* False where it is singular. */
static bool slow_matrix(const struct hertz_slow *p, struct slow_newton *newton)
{
    memset(newton->at, 0, sizeof newton->at);
    for (int i = 0; i < SLOW_N; ++i) {
        double law[3];
        slow_law(p, p->depth[i], p->rate[i], law);
        for (int j = 0; j < SLOW_N; ++j) {
            newton->at[j * SLOW_STRIDE + i] =
                slow_derivative(i, j) + law[1] * radau.integral[j * SLOW_N + i] + (i == j ? law[2] : 0.0);
        }
    }
    return dense_lu_factor(slow_system(newton));
}

/* delta and its rate from the bend; false where the bodies would part. */
static bool take_bend(struct hertz_slow *p, double *change)
{
    nodal_values moved = {0.0};
    nodal_values deeper = {0.0};
    (void)nodal_integrate(&radau, p->bend, moved);
    for (int i = 0; i < SLOW_N; ++i) {
        p->rate[i] = p->rate_start + moved[i];
    }
    (void)nodal_integrate(&radau, p->rate, deeper);
    *change = 0.0;
    for (int i = 0; i < SLOW_N; ++i) {
        const double depth = p->depth_start + deeper[i];
        const double part = fabs(depth - p->depth[i]) / depth;
        *change = larger(part, *change);
        if (!(depth > 0.0)) {
            return false;
        }
        p->depth[i] = depth;
    }
    return true;
}

/* A first guess of delta: at rest under the load at each node; as at the start beyond critical damping, for
 * there it creeps. The bend is left zero, leading elsewhere: for Newton's first step, `apart` is how far. */
static bool guess_depth(struct hertz_slow *p, const double *load, double apart[SLOW_N])
{
    double law[3];
    slow_law(p, p->depth_start, p->rate_start, law);
    const bool creeps = law[2] * law[2] > 4.0 * law[1];
    for (int i = 0; i < SLOW_N; ++i) {
        if (!creeps && !(load[i] > 0.0)) {
            return false;
        }
        const double rest = load[i] / (p->half * p->half * p->k);
        p->depth[i] = creeps ? p->depth_start : cbrt(rest * rest);
        p->rate[i] = p->rate_start;
        p->bend[i] = 0.0;
        apart[i] = p->depth_start + p->rate_start * (1.0 + radau.node[i]) - p->depth[i];
    }
    return true;
}

/* The polynomial through the nodes at the start, less the value there: what truncation leaves, and a part
 * that is too fast for the step. */
static double misses_start(const double *values, double start)
{
    nodal_values a;
    nodal_coefficients(&radau, values, a);
    return fabs(nodal_polynomial_at(a, SLOW_N, 0.0) - start);
}

/* After so many sweeps delta is near enough to its place to tell whether anything fast is left of it: a
 * step is given up where that is so many times too much. */
enum { LOOK_AFTER = 2 };
static const double TOO_FAST = 1e3;

/* Whether the changes of sweeps to come are below SLOW_SWEPT in all, as they fall by the ratio of the last
 * two. */
static bool sweeps_have_converged(double last, double before)
{
    return last <= SLOW_SWEPT || (last < before && last * last <= SLOW_SWEPT * (before - last));
}

static bool slow_iterate(struct hertz_slow *p, double depth_tolerance)
{
    struct slow_newton newton;
    nodal_values load;
    double apart[SLOW_N];
    for (int i = 0; i < SLOW_SWEEPS && p->turns->sweep(p) > NEW_MATRIX; ++i) {
        /* until the load is near enough for Newton's matrix to last */
    }
    p->turns->load(p, load);
    if (!guess_depth(p, load, apart)) {
        return false;
    }
    double change = 1.0;
    double largest = 0.0; /* of the changes of delta and n; none yet */
    for (int i = 0; i < SLOW_SWEEPS; ++i) {
        double error[SLOW_STRIDE] = {0.0};
        const double before = largest;
        const double turned = p->turns->sweep(p);
        p->turns->load(p, load);
        if (change > NEW_MATRIX && !slow_matrix(p, &newton)) {
            return false;
        }
        for (int j = 0; j < SLOW_N; ++j) {
            double law[3];
            slow_law(p, p->depth[j], p->rate[j], law);
            error[j] = load[j] - law[0] - p->bend[j] - (i == 0 ? law[1] * apart[j] : 0.0);
        }
        dense_lu_solve(slow_system(&newton), error);
        for (int j = 0; j < SLOW_N; ++j) {
            for (int k = 0; k < SLOW_N; ++k) {
                p->bend[j] += slow_derivative(j, k) * error[k];
            }
        }
        if (!take_bend(p, &change)) {
            return false;
        }
        largest = fmax(change, turned);
        if (sweeps_have_converged(largest, before)) {
            (void)p->turns->sweep(p); /* with the last delta */
            return true;
        }
        if (i == LOOK_AFTER && misses_start(p->depth, p->depth_start) > TOO_FAST * depth_tolerance) {
            return false;
        }
    }
    return false;
}

static bool slow_is_accurate(const struct hertz_slow *p, double tolerance, double depth_tolerance)
{
    const double stiffness = 1.5 * p->k * sqrt(p->depth_start);
    const double damping = p->k * p->depth_start * sqrt(p->depth_start) * p->from->chi;
    /* Beyond critical damping the force is known by the rate, at which the contact settles. */
    const bool creeps = damping * damping > 4.0 * stiffness;
    const double fast = fmax(sqrt(stiffness), damping);
    const double by_rate = creeps ? stiffness / damping * p->half : fmax(1.0, fast * p->half);
    double error = misses_start(p->depth, p->depth_start);
    error = fmax(error, misses_start(p->rate, p->rate_start) / by_rate);
    if (!(error <= depth_tolerance)) {
        return false;
    }
    for (int j = 0; j < FRAME; ++j) {
        if (is_turning(p, j) && !(p->from->distance * misses_start(p->turned[j], 0.0) <= tolerance)) {
            return false;
        }
    }
    return true;
}

bool slow_hertz_make(struct hertz_slow *p, const struct contact_pair *from, double step, double tolerance,
                     double depth_tolerance)
{
    p->from = from;
    p->flight = frame_flight_of(from);
    p->half = 0.5 * step;
    p->k = from->hertz_stiffness / from->reduced_mass;
    p->depth_start = -from->gap;
    p->rate_start = -p->half * pair_gap_derivative(from);
    const double normal[HERTZ_TURNING] = {
        1.0, 0.0, 0.0, 0.0, -from->distance * p->flight.w[0][2], from->distance * p->flight.w[0][1]};
    for (int j = 0; j < HERTZ_TURNING; ++j) {
        p->start[j] = normal[j];
        for (int i = 0; i < SLOW_N; ++i) {
            p->turned[j][i] = p->turning[j][i] = 0.0;
        }
    }
    for (int i = 0; i < SLOW_N; ++i) {
        p->depth[i] = p->depth_start;
    }
    p->turns = &about_a_centre;
    if (contact_is_rim(&from->shape) && p->flight.dimensions > 1) {
        p->turns = &about_a_rim;
        slow_rim_begin(p);
    }
    slow_note_pull(p);
    if (!slow_iterate(p, depth_tolerance) || !slow_is_accurate(p, tolerance, depth_tolerance)) {
        return false;
    }
    nodal_coefficients(&radau, p->rate, p->rate_terms);
    return true;
}

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
    if (contact_is_rim(&p->from->shape)) {
        const struct slow_place at = slow_place_at(p, s);
        slow_rim_edges(p, &at, s, sample);
    }
}

static struct slow_place slow_place_of_node(const struct hertz_slow *p, int node)
{
    struct slow_place at = {.depth = p->depth[node], .rate = p->rate[node]};
    for (int j = 0; j < HERTZ_TURNING; ++j) {
        at.turned[j] = p->start[j] + p->turned[j][node];
    }
    return at;
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
        double rows[3][FRAME];
        double n[FRAME];
        p->turns->normal(p, &at, n);
        p->turns->deviation(p, &at, place, rows[0], rows[1]);
        change->dissipated += weight * (force - spring) * rate;
        for (int body = 0; body < PAIR_BODIES; ++body) {
            const struct pair_work *work = &p->from->work[body];
            for (int j = 0; j < FRAME && j < p->flight.dimensions && work->order > 0; ++j) {
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
    double r[FRAME];
    double r_rate[FRAME];
    p->turns->deviation(p, &at, s, r, r_rate);
    struct pair_change change = {.time = p->half * s, .gap = -at.depth};
    change.head_on = p->from->is_head_on;
    change.gap_rate = -at.rate / p->half;
    change.r = change.r_rate = vec3_make(0.0, 0.0, 0.0);
    for (int j = 0; j < FRAME; ++j) {
        change.r = vec3_axpy(change.r, r[j], p->flight.frame[j]);
        change.r_rate = vec3_axpy(change.r_rate, r_rate[j], p->flight.frame[j]);
    }
    slow_powers(p, s, &change);
    return change;
}

/* When a lasting contact under Hertz's law is slow, and how long a segment of it is. */

/* Length of a slow segment at the finest accuracy [radians of the tangential motion]; an event may end it, so
 * that it is accurate in between too. It grows as polynomials of the stages' degree allow. */
static const double SLOW_STEP = 0.7;

/* Smallest length of it [radians of the contact's oscillation, or decay times of its damping]. A shorter one
 * is no longer than a few of the other kind. */
static const double SLOW_SHORTEST = 16.0;

/* The accuracy of the penetration, and what is left of its oscillation, relative to it: the tolerance of the
 * solver, relative to the bodies' size, so that outputs of the force are as good as those of positions; but
 * no less than this, and no more. */
static const double SLOW_FINEST = 1e-9;
static const double SLOW_COARSEST = 1e-4;

/* A segment may be wrong by this part of the solver's tolerances (event_driven.c). */
static const double PART_OF_TOLERANCE = 1e-3;

static double slow_accuracy(const struct segment *p)
{
    const double size = fmax(p->pair.distance, contact_reach(&p->pair.shape));
    const double asked = p->tolerance / (PART_OF_TOLERANCE * size);
    return fmin(fmax(asked, SLOW_FINEST), SLOW_COARSEST);
}

/* The derivatives of the slow motion fall with powers of the ratio of the rates, those of what is fast do
 * not: by this order and the next only that is left. */
enum { FAST_ORDER = 6 };
_Static_assert(FAST_ORDER + 1 <= SERIES_FIRST, "they are among the first");

/* By them an oscillation is known to about a quarter of it; beyond critical damping, where it is none, to
 * about this factor. */
static const double FAST_CLEARLY = 0.8;
static const double DECAY_CLEARLY = 4.0;

/* Trials, each at half the step, the third at this many of the times in which a contact beyond critical
 * damping settles: it may have to be followed. */
enum { SLOW_ATTEMPTS = 6, FOLLOWING = 2 };
static const double CREEP_STEP = 2.0;

/* Force and energy go with powers of the depth: bodies that leave go no farther than this part of it; nor, at
 * the third trial, bodies that sink. */
static const double PART_OF_DEPTH = 0.5;

/* The pair as the slow motion sees it. */
struct slow_scales {
    double load;  /* L: the acceleration that presses [m/s^2] */
    double along; /* the tangential rate [1/s] */
    double fast;  /* of the contact's oscillation or of its damping, whichever is faster [1/s] */
    double creep; /* beyond critical damping the rate at which it settles; 0: it oscillates [1/s] */
};

static struct slow_scales slow_scales_of(const struct contact_pair *from)
{
    const struct vec3 across = pair_tangential(from, pair_across(from, from->flight.c[1]));
    const struct vec3 acceleration = pair_across(from, vec3_scale(2.0, from->flight.c[2]));
    const double d = from->distance;
    const double depth = -from->gap;
    const double k = from->hertz_stiffness / from->reduced_mass;
    const bool turns = !vec3_is_zero(across) || !vec3_is_zero(pair_tangential(from, acceleration));
    const double spring = sqrt(1.5 * k * sqrt(depth));
    const double dashpot = k * from->chi * depth * sqrt(depth);
    return (struct slow_scales){.load = hertz_pressing_load(from),
                                .along =
                                    turns ? vec3_norm(across) / d + sqrt(vec3_norm(acceleration) / d) : 0.0,
                                .fast = fmax(spring, dashpot),
                                .creep = dashpot > 2.0 * spring ? spring * spring / dashpot : 0.0};
}

/* What is fast in the penetration, as a part of it, by the coefficients of u = sqrt(delta). */
static double fast_part_of(const double *root, double unit, double fast)
{
    const double radians = fast * unit * root[0]; /* of it in a unit of s */
    double power = 1.0;
    double part = 0.0;
    for (int i = 1; i <= FAST_ORDER + 1; ++i) {
        power *= radians / i;
        part = i >= FAST_ORDER ? fmax(part, fabs(root[i]) / power) : 0.0;
    }
    return 2.0 * part / root[0];
}

bool hertz_slow_applies(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    if (from->has_mismatch || !(from->gap < 0.0)) {
        return false;
    }
    const struct slow_scales scales = slow_scales_of(from);
    /* without a load that presses they are pushed out of a deep overlap at the speed 1/chi: where the dashpot
     * may not pull that is where the law ends, to rounding */
    const bool leaves = scales.creep > 0.0 && !terminal_event_by_law(p);
    return (scales.load > 0.0 || leaves) && scales.fast * p->longest >= SLOW_SHORTEST;
}

bool hertz_is_slow(const struct segment *p, const double *root, double unit)
{
    const struct slow_scales scales = slow_scales_of(&p->pair);
    /* beyond critical damping the force goes with the rate: a decay counts more by the ratio of the rates */
    const double clearly = scales.creep > 0.0 ? DECAY_CLEARLY * scales.creep / scales.fast : FAST_CLEARLY;
    return fast_part_of(root, unit, scales.fast) <= clearly * slow_accuracy(p);
}

bool hertz_slow_make(struct segment *p)
{
    struct hertz_slow *made = &p->as.hertz_slow;
    const struct slow_scales scales = slow_scales_of(&p->pair);
    const double accuracy = slow_accuracy(p);
    const double radians = SLOW_STEP * pow(accuracy / SLOW_FINEST, 1.0 / RADAU_POINTS);
    double step = scales.along > 0.0 ? fmin(p->longest, radians / scales.along) : p->longest;
    const double opening = pair_gap_derivative(&p->pair);
    const double part_of_depth = PART_OF_DEPTH * -p->pair.gap / fabs(opening);
    if (scales.creep > 0.0 && opening > 0.0) {
        step = fmin(step, part_of_depth);
    }
    const int attempts = scales.creep > 0.0 ? SLOW_ATTEMPTS : FOLLOWING;
    for (int i = 0; i < attempts && step * scales.fast >= SLOW_SHORTEST; ++i) {
        if (slow_hertz_make(made, &p->pair, step, p->tolerance, -p->pair.gap * accuracy)) {
            p->unit = made->half;
            p->end = 2.0;
            dense_output_add(&p->output, 0.0);
            for (int k = 0; k < RADAU_POINTS; ++k) {
                dense_output_add(&p->output, 1.0 + radau.node[k]);
            }
            hertz_find_terminal_event(p, (double)INFINITY);
            return true;
        }
        step *= 0.5;
        if (i + 1 == FOLLOWING) {
            step = fmin(step, fmin(CREEP_STEP / scales.creep, part_of_depth));
        }
    }
    return false;
}
