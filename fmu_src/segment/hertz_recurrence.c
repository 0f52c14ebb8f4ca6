#include "segment/hertz_recurrence.h"

#include "math/compiler.h"
#include "math/nodal_values.h"

/* Coefficient i of a polynomial of time, C or W, of which `terms` count. */
static double hertz_along_time(const struct pair_hertz *p, const struct hertz_recurrence *z,
                               double a[][HERTZ_DIMENSIONS], int terms, int j, int i)
{
    double sum = (i == 0 ? a[0][j] : 0.0) + (terms > 1 ? a[1][j] * p->time[i] : 0.0);
    for (int k = 2; k < terms; ++k) {
        sum += a[k][j] * z->power[k][i];
    }
    return sum;
}

/* The parts of products at one order that come from lower ones. */
struct hertz_sums {
    double time2, square, cube, force, impulse, speed;
    double n[HERTZ_DIMENSIONS], push[HERTZ_DIMENSIONS], r[HERTZ_DIMENSIONS];
};

/* row[i], row[i - 1], ...: as many as one instruction takes. */
static inline double2 backwards(const double *row, int i)
{
#if CONTACT_GNU_C
    return (double2){row[i], row[i - 1]};
#else
    return row[i];
#endif
}

static inline double lanes_together(double2 a)
{
#if CONTACT_GNU_C
    return a[0] + a[1];
#else
    return a;
#endif
}

/* Of scalars, all in one loop, so that none waits for another. */
static inline void hertz_lower_scalars(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                       struct hertz_sums *sum)
{
    double2 time2 = {0.0};
    double2 square = {0.0};
    double2 cube = {0.0};
    double2 force = {0.0};
    double2 impulse = {0.0};
    int k = 1;
    for (; k + LANES <= i; k += LANES) {
        const double2 root = double2_at(p->root, k);
        const double2 roots = backwards(p->root, i - k);
        time2 += double2_at(p->time, k) * backwards(p->time, i - k);
        square += root * roots;
        cube += double2_at(z->square, k) * roots;
        force += double2_at(p->cube, k) * backwards(z->damped, i - k);
        impulse += root * backwards(p->force, i - k);
    }
    const bool is_left = k < i;
    sum->time2 = lanes_together(time2) + (is_left ? p->time[k] * p->time[i - k] : 0.0);
    sum->square = lanes_together(square) + (is_left ? p->root[k] * p->root[i - k] : 0.0);
    sum->cube = lanes_together(cube) + (is_left ? z->square[k] * p->root[i - k] : 0.0);
    sum->force = lanes_together(force) + (is_left ? p->cube[k] * z->damped[i - k] : 0.0);
    sum->impulse = lanes_together(impulse) + (is_left ? p->root[k] * p->force[i - k] : 0.0);
}

/* Of one component. */
static inline void hertz_lower_component(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                         int j, bool turns, struct hertz_sums *sum)
{
    double2 r = {0.0};
    double2 n = {0.0};
    double2 push = {0.0};
    double2 speed = {0.0};
    int k = 1;
    for (; k + LANES <= i; k += LANES) {
        r += double2_at(p->root, k) * backwards(p->r_rate[j], i - k);
        if (turns) {
            const double2 normal = backwards(z->n[j], i - k);
            n += double2_at(z->d, k) * normal;
            push += double2_at(z->impulse, k) * normal;
            speed += double2_at(z->w[j], k) * normal;
        }
    }
    const bool is_left = k < i;
    sum->r[j] = lanes_together(r) + (is_left ? p->root[k] * p->r_rate[j][i - k] : 0.0);
    if (turns) {
        const double normal = is_left ? z->n[j][i - k] : 0.0;
        sum->n[j] = lanes_together(n) + (is_left ? z->d[k] * normal : 0.0);
        sum->push[j] = lanes_together(push) + (is_left ? z->impulse[k] * normal : 0.0);
        sum->speed += lanes_together(speed) + (is_left ? z->w[j][k] * normal : 0.0);
    }
}

/* Coefficient i of the derivative of c along n, where W is another. */
static double hertz_closing(const struct pair_hertz *p, struct hertz_recurrence *z, int i, int dimensions)
{
    double closing = 0.0;
    for (int j = 0; j < dimensions; ++j) {
        double rate = p->r_rate[j][i];
        for (int k = 1; k <= p->flight.degree; ++k) {
            const double power = k == 1 ? (i == 0) : k == 2 ? p->time[i] : z->power[k - 1][i];
            rate += k * p->flight.c[k][j] * power;
        }
        z->c_rate[j][i] = rate;
        for (int k = 0; k <= i; ++k) {
            closing += z->n[j][k] * z->c_rate[j][i - k];
        }
    }
    return closing;
}

/* Coefficient i of d, n, w and of both rates of the gap, from those of t, u, r and r'. */
static inline void hertz_geometry(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                                  const struct hertz_sums *sum, int dimensions)
{
    const struct contact_pair *from = p->from;
    const double side = from->shape.side;
    double speed = dimensions > 1 ? sum->speed : 0.0;
    for (int k = 2; k <= p->flight.degree; ++k) {
        z->power[k][i] = k == 2 ? sum->time2 : series_product(z->power[k - 1], p->time, i);
    }
    z->square[i] = sum->square + (i == 0 ? 1.0 : 2.0) * p->root[0] * p->root[i];
    z->d[i] = i == 0 ? from->distance : -side * z->square[i];
    for (int j = 0; j < dimensions; ++j) {
        z->w[j][i] = hertz_along_time(p, z, p->flight.w, p->flight.degree, j, i) + p->r_rate[j][i];
        z->n[j][i] = i == 0 && j == 0 ? 1.0 : 0.0;
        if (dimensions > 1 && i > 0) {
            const double c = hertz_along_time(p, z, p->flight.c, p->flight.degree + 1, j, i) + p->r[j][i];
            z->n[j][i] = (c - sum->n[j] - z->d[i] * z->n[j][0]) * z->inverse_distance;
            speed += z->n[j][i] * z->w[j][0];
        }
    }
    speed += z->w[0][i]; /* n[0] is the first direction of the frame */
    p->rate[i] = i == 0 && !isnan(from->carried_rate) ? from->carried_rate : side * speed;
    z->opening[i] = !from->has_mismatch ? p->rate[i]
                    : i == 0            ? pair_gap_derivative(from)
                                        : side * hertz_closing(p, z, i, dimensions);
    if (from->has_mismatch && i == 0) {
        (void)hertz_closing(p, z, 0, dimensions);
    }
}

/* 1 / i: a division would keep the next order waiting. */
#define RECIPROCALS(i) 1.0 / (i), 1.0 / ((i) + 1), 1.0 / ((i) + 2), 1.0 / ((i) + 3)
static const double reciprocal[TAYLOR_TERMS] = {
    0.0, RECIPROCALS(1), RECIPROCALS(5), RECIPROCALS(9), RECIPROCALS(13), RECIPROCALS(17), RECIPROCALS(21)};

/* Coefficient i of everything, from those below and of t, u, r, r'; then i + 1 of these. */
static inline void hertz_coefficient(struct pair_hertz *p, struct hertz_recurrence *z, int i, int dimensions)
{
    const struct contact_pair *from = p->from;
    const double both = i == 0 ? 0.0 : 1.0; /* the first and the last term of a product are two */
    struct hertz_sums sum;
    hertz_lower_scalars(p, z, i, &sum);
    sum.speed = 0.0;
    for (int j = 0; j < dimensions; ++j) {
        hertz_lower_component(p, z, i, j, dimensions > 1, &sum);
    }
    hertz_geometry(p, z, i, &sum, dimensions);
    p->cube[i] = sum.cube + z->square[i] * p->root[0] + both * z->square[0] * p->root[i];
    z->damped[i] = (i == 0 ? 1.0 : 0.0) - from->chi * p->rate[i];
    p->force[i] =
        from->hertz_stiffness * (sum.force + p->cube[i] * z->damped[0] + both * p->cube[0] * z->damped[i]);
    z->impulse[i] = sum.impulse + p->root[0] * p->force[i] + both * p->root[i] * p->force[0];
    if (i + 1 == TAYLOR_TERMS) {
        return;
    }
    const double unit = p->unit * reciprocal[i + 1];
    p->time[i + 1] = unit * p->root[i];
    p->root[i + 1] = -0.5 * unit * z->opening[i];
    for (int j = 0; j < dimensions; ++j) {
        const double push =
            dimensions == 1 ? z->impulse[i]
                            : sum.push[j] + z->impulse[i] * z->n[j][0] + both * z->impulse[0] * z->n[j][i];
        p->r[j][i + 1] = unit * (sum.r[j] + p->root[0] * p->r_rate[j][i]);
        p->r_rate[j][i + 1] = unit * (z->side_by_mass * push);
    }
}

/* A number of dimensions at a time, each a constant. */
CONTACT_FLATTEN void hertz_recurrence_run(struct pair_hertz *p, struct hertz_recurrence *z)
{
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        if (p->flight.dimensions == 1) {
            hertz_coefficient(p, z, i, 1);
        } else if (p->flight.dimensions == 2) {
            hertz_coefficient(p, z, i, 2);
        } else {
            hertz_coefficient(p, z, i, HERTZ_DIMENSIONS);
        }
    }
}
