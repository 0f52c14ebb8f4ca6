#include "touch/chain.h"

#include <float.h>
#include <string.h>

#include "flight/flight.h"
#include "math/polynomial.h"
#include "math/series.h"
#include "scene/evaluate.h"

#if SCENE_HAS_CHAINS

/* Directions that differ by so many roundings are the same. Velocities and accelerations across a normal are
 * zero if they are below so many roundings of the largest of the scene. */
static const double CHAIN_SAME = 256.0 * DBL_EPSILON;

/* An eigenvalue below this part of the largest is a rounding of zero: its mode has no stiffness. */
static const double LEAST_STIFFNESS = 16.0 * DBL_EPSILON;

/* A chain lasts at most this many radians of the fastest mode. To search them costs some ten milliseconds. */
static const double CHAIN_LONGEST = 10000.0;

/* Whether a vector has no part across the normal of a contact that turns the normal or moves the point of
 * contact of a torque, but for rounding of vectors of this size. */
static bool goes_along(const struct contact_shape *shape, struct vec3 normal, struct vec3 a, double size)
{
    if (!SCENE_HAS_TORQUES && contact_is_plane(shape)) {
        return true;
    }
    const struct vec3 across = SCENE_HAS_TORQUES ? a : contact_across(shape, a);
    return vec3_max_abs(vec3_axpy(across, -vec3_dot(normal, across), normal)) <= CHAIN_SAME * size;
}

/* Whether n keeps its direction while the bodies fly with the relative acceleration `a` [m/s^2], and the gap
 * is a parabola. */
static bool flies_along(const struct chain *c, const struct scene_instant *at, int contact,
                        const struct contact_shape *shape, struct vec3 a)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const bool may_turn_over =
        !contact_is_plane(shape) && shape->side < 0 && !contact_transmits(at->q, contact);
    if (g->degenerate || may_turn_over || contact_is_zoned(shape) || scene_ends_suddenly(at->v, contact) ||
        !flight_is_steady(at->q, source) || !flight_is_steady(at->q, destination)) {
        return false;
    }
    return goes_along(shape, g->normal, at->rate[contact], c->speed) &&
           goes_along(shape, g->normal, a, c->pull);
}

/* Returns W_ij [1/kg] without the factor u_i.u_j. */
static double shared_inverse_mass(const struct scene_values *v, int i, int j)
{
    const int ends[2] = {contact_source(j), contact_destination(j)};
    double sum = 0.0;
    for (int end = 0; end < 2; ++end) {
        const bool is_source = ends[end] == contact_source(i);
        if (is_source || ends[end] == contact_destination(i)) {
            sum += (is_source == (end == 0) ? 1.0 : -1.0) * body_inverse_mass(v, ends[end]);
        }
    }
    return sum;
}

/* Sets the row after the last one. Returns false where the contact cannot be one of a chain; one in touch has
 * a spring alone, under the linear law. */
static bool put_row(struct chain *c, const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_shape shape = scene_contact_shape(at->q, contact);
    const struct vec3 a =
        vec3_sub(c->flight[contact_destination(contact)], c->flight[contact_source(contact)]);
    const int i = c->rows;
    const struct contact_law law = scene_contact_law(at->q, contact);
    const double k = contact_factors_of(&law, REGIME_COMPRESSION).k;
    const bool is_spring = contact_is_elastic(&law) && !contact_is_hertz(&law) && k > 0.0;
    if (i == CHAIN_MOST || !(is_spring || !contact_transmits(at->q, contact)) ||
        !flies_along(c, at, contact, &shape, a)) {
        return false;
    }
    c->contact[i] = contact;
    c->push[i] = vec3_scale(shape.side, g->normal);
    c->lever[i] = vec3_make(0.0, 0.0, 0.0);
    if (shape.destination != SHAPE_SPHERE) {
        const struct vec3 separation = at->separation[contact];
        c->lever[i] = vec3_axpy(separation, -vec3_dot(separation, c->push[i]), c->push[i]);
    }
    c->gap[i] = g->gap;
    c->rate[i] = g->gap_rate;
    c->acceleration[i] = vec3_dot(c->push[i], contact_across(&shape, a));
    c->root[i] = sqrt(k);
    const double missing = contact_transmits(at->q, contact) ? c->gap[i] : -c->gap[i];
    c->offset[i] = fmax(missing, 0.0) + rounding_of_gap(at, contact);
    return true;
}

/* Notes the inverse masses that a row shares with the contacts in touch. Returns whether the forces of those
 * contacts leave its normal as it is. */
static bool keeps_normal(struct chain *c, int row, const struct scene_state *q)
{
    const struct contact_shape shape = scene_contact_shape(q, c->contact[row]);
    bool keeps = true;
    for (int j = 0; keeps && j < c->touching; ++j) {
        c->shared[row][j] = shared_inverse_mass(q->v, c->contact[row], c->contact[j]);
        keeps = c->shared[row][j] == 0.0 || goes_along(&shape, c->push[row], c->push[j], 1.0);
    }
    return keeps;
}

/* Turns two rows, or with a stride two columns. */
static void turn_two(double *a, double *b, int stride, int n, double cosine, double sine)
{
    for (int k = 0; k < n * stride; k += stride) {
        const double before = a[k];
        a[k] = cosine * before - sine * b[k];
        b[k] = sine * before + cosine * b[k];
    }
}

/* Turns the rows and columns a and b of S so that S_ab becomes zero, and the rows a and b of Q^T. */
static void rotate(double (*s)[CHAIN_MOST], double (*q)[CHAIN_MOST], int n, int a, int b)
{
    const double theta = 0.5 * (s[b][b] - s[a][a]) / s[a][b];
    const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(1.0 + theta * theta));
    const double cosine = 1.0 / sqrt(1.0 + t * t);
    turn_two(s[a], s[b], 1, n, cosine, t * cosine);
    turn_two(&s[0][a], &s[0][b], CHAIN_MOST, n, cosine, t * cosine);
    turn_two(q[a], q[b], 1, n, cosine, t * cosine);
}

/* Jacobi's method needs some six sweeps; with more it would go round in roundings. */
enum { SWEEPS = 30 };

/* Diagonalizes a symmetric matrix: its diagonal becomes the eigenvalues, the rows of `q` the eigenvectors.
 * Source: G. Golub, C. Van Loan, Matrix Computations (2013), 8.5. */
static void diagonalize(double (*s)[CHAIN_MOST], double (*q)[CHAIN_MOST], int n)
{
    bool rotates = true;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            q[i][j] = i == j;
        }
    }
    for (int sweep = 0; sweep < SWEEPS && rotates; ++sweep) {
        rotates = false;
        for (int a = 0; a < n; ++a) {
            for (int b = a + 1; b < n; ++b) {
                if (fabs(s[a][b]) > 0.25 * DBL_EPSILON * sqrt(fabs(s[a][a] * s[b][b]))) {
                    rotate(s, q, n, a, b);
                    rotates = true;
                }
            }
        }
    }
}

/* The squares of two contacts' frequencies differ at most by this factor. Beyond it the least stiffness of a
 * mode could not be told from rounding. */
static const double MOST_RATIO = 1e10;

/* Sets the frequencies, and the modes as they begin. Returns false where the contacts differ too much. */
static bool make_modes(struct chain *c)
{
    double s[CHAIN_MOST][CHAIN_MOST];
    double q[CHAIN_MOST][CHAIN_MOST];
    const int n = c->touching;
    double largest = 0.0;
    double least = (double)INFINITY;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            s[i][j] = c->root[i] * c->root[j] * vec3_dot(c->push[i], c->push[j]) * c->shared[i][j];
        }
        largest = fmax(largest, s[i][i]);
        least = fmin(least, s[i][i]);
    }
    if (largest > MOST_RATIO * least) {
        return false;
    }
    diagonalize(s, q, n);
    for (int k = 0; k < n; ++k) {
        largest = fmax(largest, s[k][k]);
    }
    c->fastest = sqrt(largest);
    for (int k = 0; k < n; ++k) {
        double z = 0.0;
        double rate = 0.0;
        double load = 0.0;
        for (int j = 0; j < n; ++j) {
            z += q[k][j] * c->root[j] * c->gap[j];
            rate += q[k][j] * c->root[j] * c->rate[j];
            load += q[k][j] * c->root[j] * c->acceleration[j];
            c->mode[j][k] = q[k][j] / c->root[j];
        }
        const double stiffness = s[k][k] > LEAST_STIFFNESS * largest ? s[k][k] : 0.0;
        c->frequency[k] = sqrt(stiffness);
        c->start[k] = z;
        c->start_rate[k] = rate;
        c->start_bend[k] = load - stiffness * z;
    }
    for (int i = n; i < c->rows; ++i) {
        for (int k = 0; k < n; ++k) {
            c->mode[i][k] = 0.0;
            for (int j = 0; j < n; ++j) {
                c->mode[i][k] -= c->shared[i][j] * vec3_dot(c->push[i], c->push[j]) * c->root[j] *
                                 c->root[j] * c->mode[j][k];
            }
        }
    }
    return true;
}

/* The change of a mode since the start, z', z'', and the first and second integral of z. */
struct mode_at {
    double change, rate, bend, integral, second;
};

#define RECIPROCALS_OF(i) 1.0 / (i), 1.0 / ((i) + 1), 1.0 / ((i) + 2), 1.0 / ((i) + 3), 1.0 / ((i) + 4)
static const double RECIPROCAL[] = {0.0, RECIPROCALS_OF(1), RECIPROCALS_OF(6), RECIPROCALS_OF(11),
                                    RECIPROCALS_OF(16)};

/* Returns (x - sin x)/x^3 for power = 3, or (x^2/2 - 1 + cos x)/x^4 for power = 4, where x < 1:
 * 1/p! - x^2/(p+2)! + ... with the power as p. */
static double sine_remainder(double x, int power)
{
    double sum = 0.0;
    for (int p = power + 16; p > power; p -= 2) {
        sum = (1.0 - x * x * sum) * (RECIPROCAL[p] * RECIPROCAL[p - 1]);
    }
    return (1.0 - x * x * sum) / (power == 3 ? 6.0 : 24.0);
}

/* How modes go on within a time: sin(x) / omega, its integral, and cos(x). */
struct mode_step {
    double first, second, cosine;
};

static struct mode_step mode_step_of(double omega, double t)
{
    const double x = omega * t;
    const double sine = sin(0.5 * x);
    const double square = 2.0 * sine * sine;
    return (struct mode_step){.first = x > 0.0 ? 2.0 * sine * cos(0.5 * x) / omega : t,
                              .second = x > 0.0 ? square / (omega * omega) : 0.5 * t * t,
                              .cosine = 1.0 - square};
}

/* Moves a mode on, but not its integrals. */
static void mode_go_on(const struct chain *c, int k, const struct mode_step *by, struct mode_at *mode)
{
    mode->change += mode->rate * by->first + mode->bend * by->second;
    mode->rate = mode->rate * by->cosine + mode->bend * by->first;
    mode->bend = c->start_bend[k] - c->frequency[k] * c->frequency[k] * mode->change;
}

static struct mode_at mode_at(const struct chain *c, int k, double t, bool with_integrals)
{
    struct mode_at mode = {.rate = c->start_rate[k], .bend = c->start_bend[k]};
    if (!(t > 0.0)) {
        return mode;
    }
    const double omega = c->frequency[k];
    const struct mode_step by = mode_step_of(omega, t);
    mode_go_on(c, k, &by, &mode);
    if (with_integrals) {
        const double x = omega * t;
        const double square = omega * omega;
        const double cube = t * t * t;
        const double third = x < 1.0 ? cube * sine_remainder(x, 3) : (t - by.first) / square;
        const double fourth = x < 1.0 ? cube * t * sine_remainder(x, 4) : (0.5 * t * t - by.second) / square;
        mode.integral = c->start[k] * t + c->start_rate[k] * by.second + c->start_bend[k] * third;
        mode.second = 0.5 * c->start[k] * t * t + c->start_rate[k] * third + c->start_bend[k] * fourth;
    }
    return mode;
}

/* All modes at one time since the start; contacts apart need the integrals. */
struct chain_instant {
    double time;
    struct mode_at mode[CHAIN_MOST];
};

static void chain_at(const struct chain *c, double time, struct chain_instant *at, bool with_integrals)
{
    at->time = time;
    for (int k = 0; k < c->touching; ++k) {
        at->mode[k] = mode_at(c, k, time, with_integrals);
    }
}

/* This struct holds g, g' and g'' of a contact. */
struct gap_at {
    double gap, rate, bend;
};

static struct gap_at chain_gap_at(const struct chain *c, int row, const struct chain_instant *at)
{
    const bool touches = row < c->touching;
    const double t = at->time;
    const double a = touches ? 0.0 : c->acceleration[row];
    const double flown = touches ? 0.0 : c->rate[row];
    struct gap_at g = {c->gap[row] + t * (flown + 0.5 * t * a), flown + t * a, a};
    for (int k = 0; k < c->touching; ++k) {
        const struct mode_at *mode = &at->mode[k];
        const double part = c->mode[row][k];
        g.gap += part * (touches ? mode->change : mode->second);
        g.rate += part * (touches ? mode->rate : mode->integral);
        g.bend += part * (touches ? mode->bend : c->start[k] + mode->change);
    }
    return g;
}

/* Bounds the gaps of the contacts in touch and their g'': the change of each mode stays within middle +-
 * swing. A mode without frequency moves no gap, because the bodies cannot move so. */
static void bound_gaps(struct chain *c)
{
    for (int i = 0; i < c->rows; ++i) {
        c->least[i] = c->gap[i];
        c->most[i] = i < c->touching ? c->gap[i] : (double)INFINITY;
        c->bend[i] = i < c->touching ? 0.0 : (double)INFINITY;
    }
    for (int k = 0; k < c->touching; ++k) {
        const double square = c->frequency[k] * c->frequency[k];
        const double along = c->frequency[k] * c->start_rate[k];
        const double bend = sqrt(c->start_bend[k] * c->start_bend[k] + along * along);
        const double middle = square > 0.0 ? c->start_bend[k] / square : 0.0;
        const double swing = square > 0.0 ? bend / square : 0.0;
        for (int i = 0; i < c->touching; ++i) {
            const double size = fabs(c->mode[i][k]);
            c->least[i] += c->mode[i][k] * middle - size * swing;
            c->most[i] += c->mode[i][k] * middle + size * swing;
            c->bend[i] += size * bend;
        }
    }
}

/* A piece of the motion lasts a radian of the fastest mode. There a Taylor polynomial of degree 16 about its
 * start has an error of 1/17! = 3e-15 of the modes. */
enum { CHAIN_TERMS = 17 };

/* The Taylor coefficients of all modes about the start of a piece, by the time divided by its length. */
struct chain_piece {
    struct chain_instant start;
    double length; /* [s] */
    double z[CHAIN_MOST][CHAIN_TERMS];
};

static void make_piece(const struct chain *c, double from, double to, struct chain_piece *piece)
{
    const double square = (to - from) * (to - from);
    piece->length = to - from;
    chain_at(c, from, &piece->start, c->rows > c->touching);
    for (int k = 0; k < c->touching; ++k) {
        const struct mode_at *mode = &piece->start.mode[k];
        const double stiffness = c->frequency[k] * c->frequency[k];
        double *z = piece->z[k];
        z[0] = c->start[k] + mode->change;
        z[1] = piece->length * mode->rate;
        z[2] = 0.5 * square * mode->bend;
        for (int n = 3; n < CHAIN_TERMS; ++n) {
            z[n] = -stiffness * square * z[n - 2] * (RECIPROCAL[n] * RECIPROCAL[n - 1]);
        }
    }
}

/* Sets the event function of a contact in a piece, as a polynomial of x in [0, 1]. It falls through zero
 * where the contact begins or ends. */
static void make_event(const struct chain *c, int row, const struct chain_piece *piece, struct gap_at g,
                       double of[restrict CHAIN_TERMS])
{
    const bool touches = row < c->touching;
    const double sign = touches ? -1.0 : 1.0;
    const double square = piece->length * piece->length;
    const int back = touches ? 0 : 2; /* orders of the second integral of z */
    memset(of, 0, CHAIN_TERMS * sizeof *of);
    for (int k = 0; k < c->touching; ++k) {
        const double part = sign * c->mode[row][k];
        for (int n = 3; n < CHAIN_TERMS; ++n) {
            of[n] += part * piece->z[k][n - back];
        }
    }
    for (int n = 3; n < CHAIN_TERMS && !touches; ++n) {
        of[n] *= square * RECIPROCAL[n] * RECIPROCAL[n - 1];
    }
    of[0] = sign * g.gap + c->offset[row];
    of[1] = sign * piece->length * g.rate;
    of[2] = sign * 0.5 * square * g.bend;
}

/* Returns where a contact begins or ends within a piece that begins at `from`, INFINITY: it does not. */
static double change_within(const struct chain *c, int row, const struct chain_piece *piece, double from)
{
    double event[CHAIN_TERMS];
    const double length = piece->length;
    const struct gap_at g = chain_gap_at(c, row, &piece->start);
    /* No gap in the piece is larger than the gap at its start and this bound of the gap at its end. |g'''| is
     * at most the bound of |g''| times the fastest frequency, and the piece lasts a radian of it at most. */
    const double bend = fmin(c->bend[row], fmax(g.bend, 0.0) + c->bend[row] / 3.0);
    const double largest_gap = g.gap + length * (g.rate + 0.5 * length * bend);
    if (g.gap < 0.0 && largest_gap < 0.0) {
        return (double)INFINITY;
    }
    make_event(c, row, piece, g, event);
    return from > 0.0 && event[0] <= 0.0 ? from /* the change lies between two pieces */
                                         : from + length * taylor_first_fall(event, CHAIN_TERMS, 1.0);
}

void chain_find_end(struct chain *c, double longest)
{
    bool any = false;
    for (int i = 0; i < c->rows; ++i) {
        any = any || c->most[i] >= 0.0;
    }
    c->terminal = -1;
    c->end = fmin(longest, CHAIN_LONGEST / c->fastest);
    for (double from = 0.0; any && from < c->end;) {
        struct chain_piece piece;
        const double to = fmin(from + 1.0 / c->fastest, c->end);
        make_piece(c, from, to, &piece);
        for (int i = 0; i < c->rows; ++i) {
            const double change = c->most[i] >= 0.0 ? change_within(c, i, &piece, from) : (double)INFINITY;
            if (change < c->end) {
                c->end = change;
                c->terminal = i;
            }
        }
        from = to;
    }
}

/* Notes the accelerations of the bodies without contact forces, and the largest speed and acceleration. */
static void note_flight(struct chain *c, const struct scene_instant *at)
{
    c->speed = c->pull = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        c->flight[i] = vec3_make(0.0, 0.0, 0.0);
        if (body_is_free(at->v, i)) {
            const struct vec3 by_force = vec3_scale(1.0 / body_mass(at->v, i), at->q->path[i].force[0]);
            c->flight[i] = vec3_add(gravity(at->v), by_force);
            c->speed = fmax(c->speed, vec3_norm(at->velocity[i]));
            c->pull = fmax(c->pull, vec3_norm(gravity(at->v)) + vec3_norm(by_force));
        }
    }
}

bool chain_make(struct chain *c, const struct scene_instant *at)
{
    const struct scene_state *q = at->q;
    c->rows = 0;
    memset(c->has, 0, sizeof c->has);
    if (scene_turns(q->v)) {
        return false;
    }
    note_flight(c, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const bool pushes = contact_pushes(q, j);
        if (pushes && !put_row(c, at, j)) {
            return false;
        }
        c->rows += pushes ? 1 : 0;
    }
    c->touching = c->rows;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const bool is_pushed = !contact_transmits(q, j) && contact_is_coupled(q, j);
        if (is_pushed && q->contact[j].regime == (int32_t)REGIME_SEPARATING) {
            return false; /* it may push again before it parts */
        }
        if (is_pushed && put_row(c, at, j) && keeps_normal(c, c->rows, q)) {
            c->has[j] = true;
            c->rows += 1;
        }
    }
    for (int i = 0; i < c->touching; ++i) {
        if (!keeps_normal(c, i, q)) {
            return false;
        }
    }
    if (c->touching == 0 || !make_modes(c)) {
        return false;
    }
    bound_gaps(c);
    for (int i = 0; i < c->touching; ++i) { /* n jumps where a source passes the centre of its destination */
        const struct contact_shape shape = scene_contact_shape(q, c->contact[i]);
        if (contact_may_reach_centre(&shape) && -c->least[i] > 0.5 * contact_reach(&shape)) {
            return false;
        }
    }
    return true;
}

/* A peak is looked for where it may exceed the one known by this part. */
static const double CHAIN_WORTH = 1e-9;

/* In this part of a radian of the fastest mode a gap has one extremum at most that counts. */
static const double CHAIN_PART = 0.5;

/* Returns the largest of `depth` and of the depths at the end and at a top of a part of the motion. `before`
 * is the motion at the start of the part; the function sets it to the motion at the end. */
static double raised_peak(double depth, struct gap_at *before, const struct chain *c, int row,
                          const struct chain_instant *end, double start)
{
    const double length = end->time - start;
    const struct root_bracket_end low = {start, before->rate, before->bend};
    const struct gap_at after = chain_gap_at(c, row, end);
    const double most = fmin(-length * before->rate - before->gap, length * after.rate - after.gap);
    *before = after;
    depth = fmax(depth, -after.gap);
    if (low.value < 0.0 && after.rate > 0.0 && most > depth * (1.0 + CHAIN_WORTH)) {
        const struct root_bracket_end high = {end->time, after.rate, after.bend};
        struct chain_instant at;
        chain_at(c, root_guess(low, high), &at, false);
        const struct gap_at top =
            chain_gap_at(c, row, &at); /* one step of Newton's method leads to the top */
        depth = fmax(depth, 0.5 * top.rate * top.rate / top.bend - top.gap);
    }
    return depth;
}

/* Notes the largest forces and depths of the contacts in touch from a time to the instant `end`. */
static void note_peaks_of_chain(const struct chain *c, double from, const struct chain_instant *end,
                                struct scene_state *q)
{
    struct gap_at before[CHAIN_MOST]; /* at the start of the present part */
    double depth[CHAIN_MOST];         /* the largest so far [m] */
    struct mode_step step[CHAIN_MOST];
    struct chain_instant at;
    bool any = true;
    const double part = CHAIN_PART / c->fastest;
    chain_at(c, from, &at, false);
    for (int i = 0; i < c->touching; ++i) {
        step[i] = mode_step_of(c->frequency[i], part);
        before[i] = chain_gap_at(c, i, &at);
        depth[i] = fmax(q->contact[c->contact[i]].peaks.penetration, -before[i].gap);
    }
    for (double time = from; time < end->time && any; time += part) {
        const bool is_last = !(time + part < end->time);
        any = false;
        for (int k = 0; k < c->touching && !is_last; ++k) {
            mode_go_on(c, k, &step[k], &at.mode[k]);
        }
        at.time = time + part;
        for (int i = 0; i < c->touching; ++i) {
            if (-c->least[i] > depth[i] * (1.0 + CHAIN_WORTH)) {
                any = true;
                depth[i] = raised_peak(depth[i], &before[i], c, i, is_last ? end : &at, time);
            }
        }
    }
    for (int i = 0; i < c->touching; ++i) {
        const struct contact_law law = scene_contact_law(q, c->contact[i]);
        contact_peaks_note(&q->contact[c->contact[i]].peaks,
                           contact_force(&law, REGIME_COMPRESSION, -depth[i], 0.0), depth[i]);
    }
}

void chain_advance(const struct chain *c, double from, double time, struct scene_state *q)
{
    struct body_state change[SCENE_BODIES]; /* what the contact forces add to the flight of a body */
    struct chain_instant at;
    memset(change, 0, sizeof change);
    chain_at(c, time, &at, true);
    if (from < time) {
        note_peaks_of_chain(c, from, &at, q);
    }
    for (int i = 0; i < c->touching; ++i) {
        const int contact = c->contact[i];
        struct contact_state *state = &q->contact[contact];
        double impulse = 0.0; /* integral of F = -k g */
        double second = 0.0;
        for (int k = 0; k < c->touching; ++k) {
            impulse -= c->root[i] * c->root[i] * c->mode[i][k] * at.mode[k].integral;
            second -= c->root[i] * c->root[i] * c->mode[i][k] * at.mode[k].second;
        }
        for (int end = 0; end < 2; ++end) {
            const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
            const double by_mass = (end == 0 ? -1.0 : 1.0) * body_inverse_mass(q->v, body);
            change[body].velocity = vec3_axpy(change[body].velocity, by_mass * impulse, c->push[i]);
            change[body].moved = vec3_axpy(change[body].moved, by_mass * second, c->push[i]);
        }
        struct contact_impulses *sum = &state->physics.impulse;
        sum->force = vec3_axpy(sum->force, -impulse, c->push[i]);
        if (SCENE_HAS_TORQUES) {
            sum->destination_torque =
                vec3_axpy(sum->destination_torque, -impulse, vec3_cross(c->lever[i], c->push[i]));
        }
        state->physics.accumulated_gap = chain_gap_at(c, i, &at).gap;
        state->physics.rate_rounding = 0.0;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(q->v, i) && body_is_loaded(q, i, -1)) {
            q->external_work += vec3_dot(q->path[i].force[0], change[i].moved);
            flight_deviate(q, i, time, change[i].moved, change[i].velocity);
        }
    }
}

#endif
