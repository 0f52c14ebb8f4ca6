#include "contact/collocation_answer.h"

#include <string.h>

/* The coefficients of a row are sums with factors up to 611 (lobatto_monomial): so much of them is rounding, with some to spare. */
static const double ROW_ROUNDING = 1e-12;

struct oscillator collocation_oscillator(const struct collocation *p)
{
    return (struct oscillator){p->from.square * p->half * p->half, p->from.damping * p->half};
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

double collocation_size_of_excess(const struct collocation *p)
{
    double largest = fabs(p->y) + fabs(p->y_rate);
    for (int k = 0; k < LOBATTO_POINTS; ++k) {
        largest = fmax(largest, fabs(p->slow[k]));
    }
    return largest;
}

double collocation_answer(struct collocation *p, const double *values, double softening)
{
    lobatto_row before;
    double change = 0.0;
    memcpy(before, p->slow, sizeof before);
    p->oscillator = collocation_oscillator(p);
    row_coefficients(values, p->load);
    if (p->kind == COLLOCATION_CREEPING) {
        creep(p);
    } else {
        follow(p, p->kind == COLLOCATION_SPANNING ? softening : 0.0);
    }
    for (int i = 0; i < LOBATTO_POINTS; ++i) {
        change = fmax(change, fabs(p->slow[i] - before[i]));
    }
    const double size = collocation_size_of_excess(p);
    return change > ROW_ROUNDING * size ? change * fmax(1.0, p->distance / size) : 0.0;
}
