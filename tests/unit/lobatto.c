/* The tables of the Gauss-Lobatto nodes by what defines them, and functions known at the nodes. */
#include "contact/lobatto_row.h"

#include <float.h>

#include "check.h"
#include "random.h"

enum { POINTS = LOBATTO_POINTS };

static long double node(int i)
{
    return lobatto_node[i];
}

/* The factors of lobatto_monomial are up to 611 and of both signs: so many roundings a sum has at most. */
static const long double ROUNDINGS = 1e3L * DBL_EPSILON;

static void the_nodes_are_ascending_and_symmetric(void)
{
    CHECK(lobatto_node[0] == -1.0 && lobatto_node[POINTS - 1] == 1.0);
    for (int i = 0; i < POINTS; ++i) {
        CHECK(lobatto_node[i] == -lobatto_node[POINTS - 1 - i]);
        CHECK(i == 0 || lobatto_node[i] > lobatto_node[i - 1]);
    }
}

static void a_basis_polynomial_is_one_at_its_node_and_zero_at_the_others(void)
{
    for (int j = 0; j < POINTS; ++j) {
        for (int i = 0; i < POINTS; ++i) {
            long double sum = 0.0L;
            for (int k = POINTS - 1; k >= 0; --k) {
                sum = sum * node(i) + lobatto_monomial[j][k];
            }
            CHECK_CLOSE("basis", sum, i == j ? 1.0L : 0.0L, ROUNDINGS);
        }
    }
}

/* sigma^k from -1 to each node, up to the degree that twelve values determine. */
static void integrals_to_each_node_are_exact_up_to_degree_eleven(void)
{
    for (int k = 0; k < POINTS; ++k) {
        for (int i = 0; i < POINTS; ++i) {
            long double sum = 0.0L;
            for (int j = 0; j < POINTS; ++j) {
                sum += lobatto_integral[j][i] * powl(node(j), k);
            }
            const long double at_start = k % 2 == 0 ? -1.0L : 1.0L;
            CHECK_CLOSE("integral", sum, (powl(node(i), k + 1) - at_start) / (k + 1), 4.0L * DBL_EPSILON);
        }
    }
}

static void integrals_over_the_whole_are_exact_up_to_degree_twenty_one_and_no_further(void)
{
    for (int k = 0; k <= 22; ++k) {
        long double sum = 0.0L;
        for (int j = 0; j < POINTS; ++j) {
            sum += lobatto_integral[j][POINTS - 1] * powl(node(j), k);
        }
        const long double exact = k % 2 == 0 ? 2.0L / (k + 1) : 0.0L;
        if (k < 22) {
            CHECK_CLOSE("quadrature", sum, exact, 4.0L * DBL_EPSILON);
        } else {
            CHECK(fabsl(sum - exact) > 1e-8L);
        }
    }
}

/* Coefficients of sigma = s - 1, exact values and derivatives in long double. */
static void random_polynomial(struct random *r, double *a)
{
    for (int k = 0; k < POINTS; ++k) {
        a[k] = random_between(r, -1.0, 1.0);
    }
}

static long double derivative(const double *a, int terms, int order, long double s)
{
    long double sum = 0.0L;
    for (int k = order; k < terms; ++k) {
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
    for (int k = 0; k < POINTS; ++k) {
        sum += a[k] * (powl(s - 1.0L, k + 1) - (k % 2 == 0 ? -1.0L : 1.0L)) / (k + 1);
    }
    return sum;
}

static void a_polynomial_is_evaluated_with_its_derivatives(void)
{
    struct random r = {1};
    for (int n = 0; n < 500; ++n) {
        double a[POINTS];
        double out[4];
        random_polynomial(&r, a);
        const double s = random_between(&r, 0.0, 2.0);
        const int terms = 1 + random_index(&r, POINTS);
        row_derivatives(a, terms, s, out);
        long double largest = 1.0L; /* 12, 12 11, 12 11 10: of the factors of a derivative */
        for (int i = 0; i < 4; ++i) {
            CHECK_CLOSE("derivative", out[i], derivative(a, terms, i, s), 32.0L * DBL_EPSILON * largest);
            largest *= POINTS - i;
        }
        CHECK_CLOSE("value", row_at(a, s), derivative(a, POINTS, 0, s), 32.0L * DBL_EPSILON);
        CHECK_CLOSE("slope", row_slope(a, s), derivative(a, POINTS, 1, s), 384.0L * DBL_EPSILON);
        CHECK_CLOSE("integral", row_integral(a, s), integral_to(a, s), 32.0L * DBL_EPSILON);
    }
}

static void values_and_coefficients_are_two_forms_of_one_polynomial(void)
{
    struct random r = {2};
    for (int n = 0; n < 500; ++n) {
        double a[POINTS];
        double values[POINTS];
        double back[POINTS];
        random_polynomial(&r, a);
        row_at_nodes(a, values);
        row_coefficients(values, back);
        for (int k = 0; k < POINTS; ++k) {
            CHECK_CLOSE("value", values[k], derivative(a, POINTS, 0, 1.0L + node(k)), 16.0L * DBL_EPSILON);
            CHECK_CLOSE("coefficient", back[k], a[k], 12.0L * ROUNDINGS);
        }
    }
}

static void a_large_constant_costs_a_small_change_no_digits(void)
{
    double values[POINTS];
    double a[POINTS];
    for (int i = 0; i < POINTS; ++i) {
        values[i] = 1e6 + (i == 5 ? 0x1p-20 : 0.0);
    }
    row_coefficients(values, a);
    CHECK_CLOSE("first", a[0], 1e6L + lobatto_monomial[5][0] * 0x1p-20L, 2.0L * DBL_EPSILON * 1e6L);
    for (int k = 1; k < POINTS; ++k) {
        CHECK_CLOSE("coefficient", a[k], lobatto_monomial[5][k] * 0x1p-20L,
                    DBL_EPSILON * fabsl(lobatto_monomial[5][k] * 0x1p-20L));
    }
}

/* Each component a polynomial of its own; the sums start from elsewhere, to see what changed most. */
static void rates_at_the_nodes_are_integrated(void)
{
    struct random r = {3};
    for (int n = 0; n < 200; ++n) {
        double a[3][POINTS];
        struct vec3_row rate;
        struct vec3_row sum;
        double *const rates[3] = {rate.x, rate.y, rate.z};
        double *const sums[3] = {sum.x, sum.y, sum.z};
        const double s = n % 10 == 0 ? 2.0 : random_between(&r, 0.0, 2.0);
        long double change = 0.0L;
        for (int c = 0; c < 3; ++c) {
            random_polynomial(&r, a[c]);
            row_at_nodes(a[c], rates[c]);
            for (int i = 0; i < POINTS; ++i) {
                sums[c][i] = random_between(&r, -1.0, 1.0);
                change = fmaxl(change, fabsl(integral_to(a[c], 1.0L + node(i)) - sums[c][i]));
            }
        }
        CHECK_CLOSE("change", row_integrate(&rate, &sum), change, 32.0L * DBL_EPSILON);
        CHECK(row_integrate(&rate, &sum) == 0.0);
        for (int c = 0; c < 3; ++c) {
            for (int i = 0; i < POINTS; ++i) {
                CHECK_CLOSE("sum", sums[c][i], integral_to(a[c], 1.0L + node(i)), 32.0L * DBL_EPSILON);
            }
            CHECK_CLOSE("integral", vec3_get(row_integral3(&sum, &rate, s), c), integral_to(a[c], s),
                        ROUNDINGS);
        }
    }
}

static void at_the_end_the_integral_is_the_sum_itself(void)
{
    struct vec3_row rate = {{0.0}, {0.0}, {0.0}};
    struct vec3_row sum = {{0.0}, {0.0}, {0.0}};
    row_put_vec3(&sum, POINTS - 1, vec3_make(1.0, 2.0, 3.0));
    const struct vec3 end = row_integral3(&sum, &rate, 2.0);
    CHECK(end.x == 1.0 && end.y == 2.0 && end.z == 3.0);
    row_put_vec3(&rate, 4, vec3_make(5.0, 6.0, 7.0));
    CHECK(rate.x[4] == 5.0 && rate.y[4] == 6.0 && rate.z[4] == 7.0 && rate.x[3] == 0.0 && rate.z[5] == 0.0);
}

/* T_k at the nodes in one component: the tail is what of T_11 and T_10 there is, nothing of the lower ones. */
static void the_tail_is_that_of_chebyshev_polynomials(void)
{
    for (int k = 0; k < POINTS; ++k) {
        for (int c = 0; c < 3; ++c) {
            struct vec3_row values = {{0.0}, {0.0}, {0.0}};
            double *const row[3] = {values.x, values.y, values.z};
            for (int i = 0; i < POINTS; ++i) {
                row[c][i] = (double)cosl(k * acosl(node(i)));
            }
            const double tail = row_tail3(&values);
            if (k == POINTS - 1) {
                CHECK_CLOSE("tail", tail, 1.0L, ROUNDINGS);
            } else if (k == POINTS - 2) {
                CHECK(tail >= 0.5 - 1e-12 && tail <= 1.0 + 1e-12);
            } else {
                CHECK(tail < 1e-13);
            }
        }
    }
}

int main(void)
{
    CHECK_TEST(the_nodes_are_ascending_and_symmetric);
    CHECK_TEST(a_basis_polynomial_is_one_at_its_node_and_zero_at_the_others);
    CHECK_TEST(integrals_to_each_node_are_exact_up_to_degree_eleven);
    CHECK_TEST(integrals_over_the_whole_are_exact_up_to_degree_twenty_one_and_no_further);
    CHECK_TEST(a_polynomial_is_evaluated_with_its_derivatives);
    CHECK_TEST(values_and_coefficients_are_two_forms_of_one_polynomial);
    CHECK_TEST(a_large_constant_costs_a_small_change_no_digits);
    CHECK_TEST(rates_at_the_nodes_are_integrated);
    CHECK_TEST(at_the_end_the_integral_is_the_sum_itself);
    CHECK_TEST(the_tail_is_that_of_chebyshev_polynomials);
    return check_summary("lobatto");
}
