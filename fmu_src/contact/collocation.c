#include "contact/collocation.h"

#include <float.h>
#include <string.h>

/* The iteration gains a factor of the angle turned in a step, some two radians, divided by the count of sweeps; where it needs
 * more than this, a shorter step is cheaper. */
enum { MAX_SWEEPS = 30 };

/* The coefficients of a row are sums with factors up to 611 (lobatto_monomial): so much of them is rounding, with some to spare. */
static const double ROW_ROUNDING = 1e-12;

/* What stays the same from sweep to sweep. */
struct node_table {
    struct vec3_row pull;  /* A */
    struct vec3_row drive; /* A - damping E */
    struct vec3_row lead;  /* half E */
};

static struct vec3 polynomial_of_time(const struct vec3 *a, int terms, double t)
{
    struct vec3 sum = a[terms - 1];
    for (int i = terms - 2; i >= 0; --i) {
        sum = vec3_axpy(a[i], t, sum);
    }
    return sum;
}

static struct oscillator oscillator_of(const struct collocation *p)
{
    return (struct oscillator){p->from.square * p->half * p->half, p->from.damping * p->half};
}

static void fill_table(struct collocation *p, struct node_table *table)
{
    const struct oscillator oscillator = oscillator_of(p);
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        const double s = 1.0 + lobatto_node[i];
        const struct vec3 pull = polynomial_of_time(p->from.pull, COLLOCATION_PULL_TERMS, p->half * s);
        const struct vec3 lead = polynomial_of_time(p->from.lead, COLLOCATION_LEAD_TERMS, p->half * s);
        row_put_vec3(&table->pull, i, pull);
        row_put_vec3(&table->drive, i, vec3_axpy(pull, -p->from.damping, lead));
        row_put_vec3(&table->lead, i, vec3_scale(p->half, lead));
        if (p->kind == COLLOCATION_RESOLVED) {
            const struct oscillator_basis basis = oscillator_basis_at(&oscillator, s);
            p->y_of_y[i] = basis.y_of_y;
            p->y_of_rate[i] = basis.y_of_rate;
        }
    }
}

/* s follows the load, y is the rest. */
static void follow(struct collocation *p, double softening)
{
    oscillator_follow(&p->oscillator, p->load, p->slow, LOBATTO_POINTS);
    row_at_nodes(p->slow, p->x);
    p->oscillator.square += softening;
    p->y = p->from.excess - row_at(p->slow, 0.0);
    p->y_rate = p->half * vec3_dot(p->from.normal, p->from.rate) - row_slope(p->slow, 0.0);
    for (int i = 0; i < LOBATTO_POINTS && p->kind == COLLOCATION_RESOLVED; ++i) {
        p->x[i] += p->y * p->y_of_y[i] + p->y_rate * p->y_of_rate[i];
    }
}

/* (D + slower)(D + faster) x = load: u = (D + slower) x follows the load but for a fast decay, and X follows u. */
static void creep(struct collocation *p)
{
    const struct oscillator_rates rates = oscillator_rates_of(&p->oscillator);
    lobatto_row u;
    lobatto_row u_at_nodes;
    lobatto_row rate;
    relaxation_follow(rates.faster, p->load, u, LOBATTO_POINTS);
    row_at_nodes(u, u_at_nodes);
    const double start_rate = p->half * vec3_dot(p->from.normal, p->from.rate);
    const double fast = start_rate + rates.slower * p->from.excess - u_at_nodes[0];
    p->y = -fast / (rates.faster - rates.slower);
    p->y_rate = -rates.faster * p->y;
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        rate[i] = u_at_nodes[i] - rates.slower * p->x[i];
    }
    row_integrate_one(rate, p->x);
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        p->x[i] += p->from.excess - p->y;
    }
    row_coefficients(p->x, p->slow);
}

/* The largest that x comes to in the step, roughly [m]. */
static double size_of_excess(const struct collocation *p)
{
    double largest = fabs(p->y) + fabs(p->y_rate);
    for (int k = 0; k < LOBATTO_POINTS; ++k) {
        largest = fmax(largest, fabs(p->slow[k]));
    }
    return largest;
}

/* The load into x; returns the largest change of a coefficient, scaled as if x were of the size of d: the force, which follows from x,
 * is to be as accurate as the position, however small x is. */
static double answer(struct collocation *p, const double *values, double softening)
{
    lobatto_row before;
    double change = 0.0;
    memcpy(before, p->slow, sizeof before);
    p->oscillator = oscillator_of(p);
    row_coefficients(values, p->load);
    if (p->kind == COLLOCATION_CREEPING) {
        creep(p);
    } else {
        follow(p, p->kind == COLLOCATION_SPANNING ? softening : 0.0);
    }
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        change = fmax(change, fabs(p->slow[i] - before[i]));
    }
    const double size = size_of_excess(p);
    return change > ROW_ROUNDING * size ? change * fmax(1.0, p->distance / size) : 0.0;
}

/* f at the nodes, and x that answers. */
static double respond(struct collocation *p, const struct node_table *table)
{
    const double half2 = p->half * p->half;
    const struct vec3 n = vec3_sub(p->from.normal, p->turned);
    const struct vec3 h = vec3_sub(p->momentum, p->spun);
    lobatto_row values;
    double softening = 0.0;
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        const double hx = h.x + p->h.x[i];
        const double hy = h.y + p->h.y[i];
        const double hz = h.z + p->h.z[i];
        const double inverse = 1.0 / (p->from.reach + p->x[i]);
        const double spin = half2 * (hx * hx + hy * hy + hz * hz) * inverse * inverse * inverse;
        values[i] =
            spin + half2 * ((n.x + p->n.x[i]) * table->drive.x[i] + (n.y + p->n.y[i]) * table->drive.y[i] +
                            (n.z + p->n.z[i]) * table->drive.z[i]);
        /* -df/dx of the spin, averaged over the step: integral / 2 */
        softening += lobatto_integral[i][LOBATTO_POINTS - 1] * 1.5 * spin * inverse;
    }
    return answer(p, values, softening);
}

static double spin_up(struct collocation *p, const struct node_table *table)
{
    const struct vec3 n = vec3_sub(p->from.normal, p->turned);
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        const double nx = n.x + p->n.x[i];
        const double ny = n.y + p->n.y[i];
        const double nz = n.z + p->n.z[i];
        const double arm = p->half * (p->from.reach + p->x[i]);
        p->h_rate.x[i] = arm * (ny * table->pull.z[i] - nz * table->pull.y[i]);
        p->h_rate.y[i] = arm * (nz * table->pull.x[i] - nx * table->pull.z[i]);
        p->h_rate.z[i] = arm * (nx * table->pull.y[i] - ny * table->pull.x[i]);
    }
    return 2.0 * p->half / p->distance * row_integrate(&p->h_rate, &p->h);
}

static double turn(struct collocation *p)
{
    const struct vec3 n = vec3_sub(p->from.normal, p->turned);
    const struct vec3 h = vec3_sub(p->momentum, p->spun);
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        const double nx = n.x + p->n.x[i];
        const double ny = n.y + p->n.y[i];
        const double nz = n.z + p->n.z[i];
        const double hx = h.x + p->h.x[i];
        const double hy = h.y + p->h.y[i];
        const double hz = h.z + p->h.z[i];
        const double d = p->from.reach + p->x[i];
        const double by = p->half / (d * d);
        p->n_rate.x[i] = by * (hy * nz - hz * ny);
        p->n_rate.y[i] = by * (hz * nx - hx * nz);
        p->n_rate.z[i] = by * (hx * ny - hy * nx);
    }
    return p->distance * row_integrate(&p->n_rate, &p->n);
}

/* Of the integrals: that of a Chebyshev polynomial is smaller by its degree. */
static double tail_of_all(const struct collocation *p)
{
    const double by_turn = p->distance * row_tail3(&p->n_rate);
    const double by_spin = 2.0 * p->half / p->distance * row_tail3(&p->h_rate);
    const double of_excess = fmax(fabs(p->slow[LOBATTO_POINTS - 1]), fabs(p->slow[LOBATTO_POINTS - 2]));
    const double size = size_of_excess(p);
    /* The next coefficient is smaller by half a step's radians, two at most, over its number: less than a quarter. */
    const double left_out = 0.25 * ldexp(of_excess, 2 - LOBATTO_POINTS);
    const bool creeps = p->kind == COLLOCATION_CREEPING;
    const double by_excess = creeps && size > 0.0 ? left_out * fmax(1.0, p->distance / size) : left_out;
    return fmax(by_excess, fmax(by_turn, by_spin) / LOBATTO_POINTS);
}

static void keep_lead(struct collocation *p, const struct node_table *table)
{
    const struct vec3 n = vec3_sub(p->from.normal, p->turned);
    lobatto_row values;
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        values[i] = (n.x + p->n.x[i]) * table->lead.x[i] + (n.y + p->n.y[i]) * table->lead.y[i] +
                    (n.z + p->n.z[i]) * table->lead.z[i];
    }
    row_coefficients(values, p->led);
}

/* The first guess: n and H go on as they begin. */
static void start(struct collocation *p, const struct node_table *table)
{
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        p->x[i] = p->from.excess;
    }
    if (!p->straight) {
        (void)turn(p);
        (void)spin_up(p, table);
    }
}

/* Numbers all of them, and the centre, where local coordinates end, not reached: d > 0. */
static bool is_sound(const struct collocation *p)
{
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        const double sum = p->n.x[i] + p->n.y[i] + p->n.z[i] + p->h.x[i] + p->h.y[i] + p->h.z[i];
        if (!(p->from.reach + p->x[i] > 0.0) || !isfinite(sum)) {
            return false;
        }
    }
    return true;
}

/* n and H stay: the motion is along the normal and so is the pull. */
static bool is_straight(const struct collocation *p)
{
    double across = vec3_max_abs(p->momentum);
    for (int i = 0; i < COLLOCATION_PULL_TERMS; ++i) {
        across = fmax(across, vec3_max_abs(vec3_cross(p->from.normal, p->from.pull[i])));
    }
    return !(across > 0.0);
}

/* One sweep: the load, x that answers, H, n. Returns how far it moved anything [m]. */
static double sweep(struct collocation *p, const struct node_table *table)
{
    const double by_load = respond(p, table);
    if (p->straight) {
        return p->kind == COLLOCATION_CREEPING ? by_load : 0.0; /* otherwise the load does not depend on x */
    }
    if (p->kind != COLLOCATION_RESOLVED) {
        const struct collocation_wave wave = collocation_wave_of(p, p->y, p->y_rate, p->from.normal,
                                                                 p->momentum, p->from.pull[0], p->distance);
        p->turned = wave.turned;
        p->spun = wave.spun;
    }
    const double by_spin = spin_up(p, table);
    return fmax(by_load, fmax(by_spin, turn(p)));
}

static void finish(struct collocation *p, const struct node_table *table)
{
    const double largest = size_of_excess(p);
    p->terms = LOBATTO_POINTS;
    while (p->terms > 1 && fabs(p->slow[p->terms - 1]) <= DBL_EPSILON * DBL_EPSILON * largest) {
        p->terms -= 1;
    }
    p->interior_error = tail_of_all(p);
    if (p->from.leads) {
        keep_lead(p, table);
    }
}

bool collocation_make(struct collocation *p, const struct collocation_problem *from, double step,
                      enum collocation_kind kind, double tolerance)
{
    struct node_table table;
    memset(p, 0, sizeof *p);
    p->from = *from;
    p->half = 0.5 * step;
    p->kind = kind;
    p->distance = from->reach + from->excess;
    p->momentum = vec3_scale(p->distance, vec3_cross(from->normal, from->rate));
    p->straight = is_straight(p);
    fill_table(p, &table);
    start(p, &table);
    double before = 0.0;
    for (int i = 0; i < MAX_SWEEPS; ++i) {
        const double change = sweep(p, &table);
        /* A sweep that moved things by so much less than the one before leaves less than that again. Not so the second: the first
         * brings in all of the load. And X, which creeps through several of its decay times, comes in last. */
        const bool slow = i < 2 || kind == COLLOCATION_CREEPING;
        const double left = slow ? change : change * fmin(1.0, change / before);
        if (left <= tolerance) {
            finish(p, &table);
            return is_sound(p);
        }
        before = change;
    }
    return false;
}
