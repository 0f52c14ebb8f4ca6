/* Power series: each operation against functions whose coefficients are known in closed form. */
#include "math/series.h"

#include "check.h"

/* (1 + q s)^alpha has the binomial coefficients alpha (alpha - 1) ... q^n / n!. */
static void binomial(long double alpha, long double q, double out[TAYLOR_TERMS])
{
    long double coefficient = 1.0L;
    for (int n = 0; n < TAYLOR_TERMS; ++n) {
        out[n] = (double)coefficient;
        coefficient *= (alpha - n) * q / (n + 1);
    }
}

static void check_series(const char *name, const double *got, const double *expected, long double scale)
{
    for (int n = 0; n < TAYLOR_TERMS; ++n) {
        CHECK_CLOSE(name, got[n], expected[n], 1e-13L * scale);
    }
}

TEST(root_product_and_quotient_are_binomial_series)
{
    const long double ratios[] = {-0.9L, -0.25L, 0.5L, 1.0L};
    for (int k = 0; k < 4; ++k) {
        double whole[TAYLOR_TERMS], half[TAYLOR_TERMS], inverse[TAYLOR_TERMS], one[TAYLOR_TERMS] = {1.0};
        double root[TAYLOR_TERMS], omega2[TAYLOR_TERMS], quotient[TAYLOR_TERMS];
        binomial(1.0L, ratios[k], whole);
        binomial(0.5L, ratios[k], half);
        binomial(-1.0L, ratios[k], inverse);
        for (int n = 0; n < TAYLOR_TERMS; ++n) {
            root[n] = taylor_root(whole, root, n);
            omega2[n] = taylor_multiply(half, half, n);
            quotient[n] = taylor_divide(one, whole, quotient, n);
        }
        check_series("root", root, half, 1.0L);
        check_series("omega2", omega2, whole, 1.0L);
        check_series("quotient", quotient, inverse, 1.0L);
    }
}

TEST(sum_and_integral_are_those_of_the_function)
{
    double a[TAYLOR_TERMS];
    binomial(-1.0L, -0.2L, a);
    for (int k = -4; k <= 4; ++k) {
        const double s = 0.25 * k;
        const long double inverse = 1.0L / (1.0L - 0.2L * s);
        CHECK_CLOSE("sum", taylor_at(a, TAYLOR_TERMS, s), inverse, 1e-15L);
        CHECK_CLOSE("integral", taylor_integral(a, TAYLOR_TERMS, s), -5.0L * logl(1.0L - 0.2L * s), 1e-15L);
    }
}
