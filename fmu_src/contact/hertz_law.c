#include "contact/hertz_law.h"

#include <math.h>

#include "math/taylor.h"

/* delta^(3/2) */
static double three_halves(double gap)
{
    return gap < 0.0 ? -gap * sqrt(-gap) : 0.0;
}

double hertz_force(struct hertz_law law, double gap, double gap_rate)
{
    return law.stiffness * three_halves(gap) * (1.0 - law.damping * gap_rate);
}

double hertz_force_by_gap(struct hertz_law law, double gap, double gap_rate)
{
    return gap < 0.0 ? -1.5 * law.stiffness * sqrt(-gap) * (1.0 - law.damping * gap_rate) : 0.0;
}

double hertz_force_by_rate(struct hertz_law law, double gap)
{
    return -law.stiffness * three_halves(gap) * law.damping;
}

double hertz_energy(double stiffness, double gap)
{
    return gap < 0.0 ? -0.4 * stiffness * three_halves(gap) * gap : 0.0;
}

double hertz_energy_slope(double stiffness, double gap)
{
    return -stiffness * three_halves(gap);
}

double hertz_energy_bend(double stiffness, double gap)
{
    return gap < 0.0 ? 1.5 * stiffness * sqrt(-gap) : 0.0;
}

/* Coefficients 0..order of delta^exponent. */
static void power_of_depth(const double *gap, double exponent, int order, double power[TAYLOR_TERMS])
{
    double depth[TAYLOR_TERMS];
    depth[0] = -gap[0];
    power[0] = depth[0] > 0.0 ? taylor_power(depth, exponent, power, 0) : 0.0; /* there is one at least */
    for (int i = 1; i <= order; ++i) {
        depth[i] = -gap[i];
        power[i] = depth[0] > 0.0 ? taylor_power(depth, exponent, power, i) : 0.0;
    }
}

double hertz_force_term(struct hertz_law law, const double *gap, const double *gap_rate, int order)
{
    double power[TAYLOR_TERMS];
    power_of_depth(gap, 1.5, order, power);
    return law.stiffness * (power[order] - law.damping * taylor_multiply(power, gap_rate, order));
}

double hertz_energy_term(double stiffness, const double *gap, int order)
{
    double power[TAYLOR_TERMS];
    power_of_depth(gap, 2.5, order, power);
    return 0.4 * stiffness * power[order];
}

double hertz_spring_term(double stiffness, const double *gap, int order)
{
    return hertz_force_term((struct hertz_law){stiffness, 0.0}, gap, gap, order);
}
