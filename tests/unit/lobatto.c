/* Functions known at the Gauss-Lobatto nodes; tests/generator/test_c_code.py has the tables. */
#include "math/nodes.h"
#include "math/series.h"

#include <float.h>

#include "check.h"
#include "random.h"

enum { MOST = LOBATTO_MAX };

/* The factors of the coefficients are up to 611 and of both signs: so many roundings a sum has at most. */
static const long double ROUNDINGS = 1e3L * DBL_EPSILON;

static long double node(int i)
{
    return NODAL_RULE->node[i];
}

static double monomial(int j, int k)
{
    return NODAL_RULE->monomial[j * MOST + k];
}

/* Coefficients of sigma = s - 1, exact values and derivatives in long double. */
static void random_polynomial(struct random *r, double *a)
{
    for (int k = 0; k < MOST; ++k) {
        a[k] = random_between(r, -1.0, 1.0);
    }
}

static long double derivative(const double *a, int order, long double s)
{
    long double sum = 0.0L;
    for (int k = order; k < MOST; ++k) {
        long double factor = a[k];
        for (int i = 0; i < order; ++i) {
            factor *= k - i;
        }
        sum += factor * powl(s - 1.0L, k - order);
    }
    return sum;
}

static long double integral_to(const double *a, long double s)
{
    long double sum = 0.0L;
    for (int k = 0; k < MOST; ++k) {
        sum += a[k] * (powl(s - 1.0L, k + 1) - (k % 2 == 0 ? -1.0L : 1.0L)) / (k + 1);
    }
    return sum;
}

TEST(a_polynomial_is_evaluated_with_its_derivatives)
{
    struct random r = {1};
    for (int n = 0; n < 500; ++n) {
        double a[MOST], out[4];
        random_polynomial(&r, a);
        const double s = random_between(&r, 0.0, 2.0);
        nodal_derivatives(a, s, out);
        long double largest = 1.0L; /* 12, 12 11, 12 11 10: of the factors of a derivative */
        for (int i = 0; i < 4; ++i) {
            CHECK_CLOSE("derivative", out[i], derivative(a, i, s), 32.0L * DBL_EPSILON * largest);
            largest *= MOST - i;
        }
        CHECK_CLOSE("value", taylor_at(a, MOST, s - 1.0), derivative(a, 0, s), 32.0L * DBL_EPSILON);
        CHECK_CLOSE("slope", nodal_slope(a, s), derivative(a, 1, s), 384.0L * DBL_EPSILON);
        CHECK_CLOSE("integral", nodal_integral(a, s), integral_to(a, s), 32.0L * DBL_EPSILON);
    }
}

TEST(values_and_coefficients_are_two_forms_of_one_polynomial)
{
    struct random r = {2};
    for (int n = 0; n < 500; ++n) {
        double a[MOST], values[MOST], back[MOST];
        random_polynomial(&r, a);
        nodal_values_of(a, values);
        nodal_coefficients(values, back);
        for (int k = 0; k < MOST; ++k) {
            CHECK_CLOSE("value", values[k], derivative(a, 0, 1.0L + node(k)), 16.0L * DBL_EPSILON);
            CHECK_CLOSE("coefficient", back[k], a[k], 12.0L * ROUNDINGS);
        }
    }
}

TEST(a_large_constant_costs_a_small_change_no_digits)
{
    double values[MOST], a[MOST];
    for (int i = 0; i < MOST; ++i) {
        values[i] = 1e6 + (i == 2 ? 0x1p-20 : 0.0);
    }
    nodal_coefficients(values, a);
    CHECK_CLOSE("first", a[0], 1e6L + monomial(2, 0) * 0x1p-20L, 2.0L * DBL_EPSILON * 1e6L);
    for (int k = 1; k < MOST; ++k) {
        CHECK_CLOSE("coefficient", a[k], monomial(2, k) * 0x1p-20L,
                    DBL_EPSILON * fabsl(monomial(2, k) * 0x1p-20L));
    }
}

/* The sums start from elsewhere, to see what changed most. */
TEST(rates_at_the_nodes_are_integrated)
{
    struct random r = {3};
    for (int n = 0; n < 500; ++n) {
        double a[MOST], rate[MOST], sum[MOST];
        const double s = n % 10 == 0 ? 2.0 : random_between(&r, 0.0, 2.0);
        long double change = 0.0L;
        random_polynomial(&r, a);
        nodal_values_of(a, rate);
        for (int i = 0; i < MOST; ++i) {
            sum[i] = random_between(&r, -1.0, 1.0);
            change = fmaxl(change, fabsl(integral_to(a, 1.0L + node(i)) - sum[i]));
        }
        CHECK_CLOSE("change", nodal_integrate(rate, sum), change, 32.0L * DBL_EPSILON);
        CHECK(nodal_integrate(rate, sum) == 0.0);
        for (int i = 0; i < MOST; ++i) {
            CHECK_CLOSE("sum", sum[i], integral_to(a, 1.0L + node(i)), 32.0L * DBL_EPSILON);
        }
        CHECK_CLOSE("integral", nodal_integral_to(sum, rate, s), integral_to(a, s), ROUNDINGS);
    }
}

/* T_k at the nodes: the tail is what of the last two there is, nothing of the lower ones. */
TEST(the_tail_is_that_of_chebyshev_polynomials)
{
    for (int k = 0; k < MOST; ++k) {
        double values[MOST];
        for (int i = 0; i < MOST; ++i) {
            values[i] = (double)cosl(k * acosl(node(i)));
        }
        const double tail = nodal_tail(values);
        if (k == MOST - 1) {
            CHECK_CLOSE("tail", tail, 1.0L, ROUNDINGS);
        } else if (k == MOST - 2) {
            CHECK(tail >= 0.5 - 1e-12 && tail <= 1.0 + 1e-12);
        } else {
            CHECK(tail < 1e-13);
        }
    }
}
