/* A decay against its closed form in long double: as it stands, what has changed, where its derivatives pass
 * zero. */
#include "math/oscillator.h"

#include <float.h>

#include "check.h"
#include "random.h"

/* With what rounding may leave of it. */
struct expected {
    long double y[1 + OVERDAMPED_DERIVATIVES], rounding[1 + OVERDAMPED_DERIVATIVES];
};

static struct expected of_two_rates(const struct overdamped *d, long double s)
{
    const long double mean = d->oscillator.damping_rate / 2.0L;
    const long double spread = sqrtl((mean - 1.0L) * (mean + 1.0L));
    const long double rate[2] = {1.0L / (mean + spread), mean + spread};
    struct expected e = {.y = {0.0L}};
    for (int k = 0; k < 2; ++k) {
        const long double other = rate[1 - k];
        const long double left = (k == 0 ? 1.0L : -1.0L) * expl(-rate[k] * s) / (2.0L * spread);
        long double part = (d->y_rate + other * d->y) * left;
        long double size = (fabsl(d->y_rate) + other * fabsl(d->y)) * fabsl(left);
        for (int i = 0; i <= OVERDAMPED_DERIVATIVES; ++i) {
            e.y[i] += part;
            e.rounding[i] += DBL_EPSILON * (16.0L + 8.0L * rate[k] * s) * size;
            part *= -rate[k];
            size *= rate[k];
        }
    }
    return e;
}

/* By cos and sin or cosh and sinh, which do not mind that the rates are close. */
static struct expected near_critical_damping(const struct overdamped *d, long double s)
{
    const long double damping_rate = d->oscillator.damping_rate;
    const long double mean = damping_rate / 2.0L;
    const long double omega2 = (mean - 1.0L) * (mean + 1.0L);
    const long double x = sqrtl(fabsl(omega2)) * s;
    const long double shrink = expl(-mean * s);
    const long double sine = x < 1e-4L       ? s * (1.0L + omega2 * s * s / 6.0L)
                             : omega2 > 0.0L ? sinhl(x) * s / x
                                             : sinl(x) * s / x;
    const long double cosine = omega2 > 0.0L ? coshl(x) : cosl(x);
    struct expected e;
    e.y[0] = shrink * (d->y * cosine + (d->y_rate + mean * d->y) * sine);
    e.y[1] = shrink * (d->y_rate * cosine - (d->y + mean * d->y_rate) * sine);
    const long double slowest = expl(-(mean - sqrtl(fmaxl(omega2, 0.0L))) * s);
    for (int i = 0; i <= OVERDAMPED_DERIVATIVES; ++i) {
        e.y[i] = i < 2 ? e.y[i] : -damping_rate * e.y[i - 1] - e.y[i - 2];
        const double size = (fabs(d->y) + fabs(d->y_rate)) * (double)(1 << i);
        e.rounding[i] = DBL_EPSILON * 32.0L * (1.0L + s) * (1.0L + s) * slowest * size;
    }
    return e;
}

static struct expected expected_at(const struct overdamped *d, double s)
{
    return d->distinct ? of_two_rates(d, s) : near_critical_damping(d, s);
}

/* From 0.97 of critical damping to 1e6 times it. */
static struct overdamped random_decay(struct random *r, int k)
{
    const double share = k % 3 == 0 ? random_between(r, 0.97, 1.0) : 1.0 + random_power(r, -16.0, 6.0);
    const double y = k % 5 == 0 ? 0.0 : random_between(r, -1.0, 1.0);
    return overdamped_of(2.0 * share, y, random_between(r, -1.0, 1.0) * (k % 2 == 0 ? 1.0 : share));
}

/* Until e^-300 of the slower part is left. */
static double random_place(struct random *r, const struct overdamped *d)
{
    return fmin(d->half_period, 300.0 * d->faster) * random_power(r, -8.0, 0.0);
}

static void it_is_the_closed_form_however_little_is_left(void)
{
    struct random r = {41};
    for (int k = 0; k < 20000; ++k) {
        const struct overdamped d = random_decay(&r, k);
        const double s = random_place(&r, &d);
        const struct expected e = expected_at(&d, s);
        double y[1 + OVERDAMPED_DERIVATIVES];
        overdamped_at(&d, s, y);
        for (int i = 0; i <= OVERDAMPED_DERIVATIVES; ++i) {
            CHECK_CLOSE("derivative", y[i], e.y[i], e.rounding[i]);
        }
    }
}

static void what_has_changed_keeps_its_digits(void)
{
    struct random r = {42};
    for (int k = 0; k < 20000; ++k) {
        const struct overdamped d = random_decay(&r, k);
        const double s = random_place(&r, &d);
        const struct expected e = expected_at(&d, s);
        const struct overdamped_change change = overdamped_since(&d, s);
        const double size = fabs(d.y) + fabs(d.y_rate);
        const long double moved = 32.0L * DBL_EPSILON * fmin(s, 1.0) * size;
        CHECK_CLOSE("y", change.y, e.y[0] - d.y, moved + e.rounding[0]);
        CHECK_CLOSE("rate", change.y_rate, e.y[1] - d.y_rate,
                    32.0L * DBL_EPSILON * fmin(s * d.faster, 1.0) * d.faster * size + e.rounding[1]);
    }
}

/* In a thousandth of a radian of the faster rate: the digits of what y changes are its own, and not those of
 * y. */
static void a_small_change_is_not_a_difference(void)
{
    struct random r = {43};
    for (int k = 0; k < 20000; ++k) {
        const struct overdamped d = random_decay(&r, k);
        const double s = 1e-3 / d.faster * random_between(&r, 0.1, 1.0);
        const double damping_rate = d.oscillator.damping_rate;
        const struct overdamped_change change = overdamped_since(&d, s);
        long double term = d.y_rate * (long double)s; /* of the power series of y */
        long double before = d.y;
        long double sum = term;
        long double rate_sum = 0.0L;
        for (int i = 2; i < 12; ++i) {
            const long double next =
                -(s * damping_rate * term * (i - 1) + (long double)s * s * before) / (i * (i - 1));
            before = term;
            term = next;
            sum += term;
            rate_sum += i * term / s;
        }
        const double speeds_up = fabs(d.y) + damping_rate * fabs(d.y_rate);
        CHECK_CLOSE("y", change.y, sum, 4.0L * DBL_EPSILON * s * (fabs(d.y_rate) + s * speeds_up));
        CHECK_CLOSE("rate", change.y_rate, rate_sum, 4.0L * DBL_EPSILON * s * speeds_up);
    }
}

/* Beyond critical damping exactly there, once; where none is given the sign stays. */
static void each_derivative_passes_zero_once(void)
{
    struct random r = {44};
    int passed = 0;
    for (int k = 0; k < 20000; ++k) {
        const struct overdamped d = random_decay(&r, 3 * k + 1);
        const int order = 1 + k % OVERDAMPED_DERIVATIVES;
        const double zero = overdamped_zero(&d, order);
        const double until = zero > 0.0 ? zero : 0.0;
        const double slower = 1e-4 * (until + 1.0 / d.faster);
        double before[1 + OVERDAMPED_DERIVATIVES], after[1 + OVERDAMPED_DERIVATIVES],
            later[1 + OVERDAMPED_DERIVATIVES];
        const double from = zero < (double)INFINITY ? until : 0.0;
        overdamped_at(&d, fmax(from - slower, 0.0), before);
        overdamped_at(&d, from + slower, after);
        overdamped_at(&d, from + 1e3 * d.faster * slower, later);
        if (zero > slower && zero < 300.0 * d.faster) {
            CHECK((before[order] > 0.0) != (after[order] > 0.0));
            ++passed;
        }
        CHECK(later[order] == 0.0 || (after[order] > 0.0) == (later[order] > 0.0));
    }
    CHECK(passed > 2000);
}

static void a_dashpot_alone_leaves_a_drift(void)
{
    struct random r = {45};
    for (int k = 0; k < 20000; ++k) {
        const double drift = k % 4 == 0 ? 0.0 : random_between(&r, -1.0, 1.0);
        const struct overdamped d =
            overdamped_of_dashpot(random_between(&r, -1.0, 1.0), random_between(&r, -1.0, 1.0), drift);
        const double s = random_power(&r, -8.0, 4.0);
        /* of y' */
        const long double part = (d.y_rate - (long double)drift) * expl(-(long double)s);
        const struct overdamped_change change = overdamped_since(&d, s);
        double y[1 + OVERDAMPED_DERIVATIVES];
        overdamped_at(&d, s, y);
        const long double moved =
            (d.y_rate - (long double)drift) * -expm1l(-(long double)s) + drift * (long double)s;
        CHECK_CLOSE("moved", change.y, moved, 8.0L * DBL_EPSILON * fmin(s, 1.0 + s * fabs(drift)));
        CHECK_CLOSE("slowed", change.y_rate, (d.y_rate - (long double)drift) * expm1l(-(long double)s),
                    8.0L * DBL_EPSILON * fmin(s, 1.0));
        CHECK_CLOSE("y", y[0], d.y + moved, 8.0L * DBL_EPSILON * (4.0 + s * fabs(drift)));
        const long double rounding = DBL_MIN + 8.0L * DBL_EPSILON * (1.0L + s) * fabsl(part);
        for (int i = 1; i <= OVERDAMPED_DERIVATIVES; ++i) {
            const long double expected = (i % 2 == 1 ? part : -part) + (i == 1 ? drift : 0.0);
            CHECK_CLOSE("derivative", y[i], expected,
                        rounding + (i == 1 ? 2.0 * DBL_EPSILON * fabs(drift) : 0.0));
        }
        const double turn = overdamped_zero(&d, 1);
        if (turn > 0.0 && turn < 30.0) {
            overdamped_at(&d, turn, y);
            CHECK_CLOSE("turn", y[1], 0.0L, 8.0L * DBL_EPSILON * (1.0 + turn) * fabs(drift));
        }
        CHECK(overdamped_zero(&d, 2) == (double)INFINITY);
    }
}

int main(void)
{
    CHECK_TEST(it_is_the_closed_form_however_little_is_left);
    CHECK_TEST(what_has_changed_keeps_its_digits);
    CHECK_TEST(a_small_change_is_not_a_difference);
    CHECK_TEST(each_derivative_passes_zero_once);
    CHECK_TEST(a_dashpot_alone_leaves_a_drift);
    return check_summary("decay");
}
