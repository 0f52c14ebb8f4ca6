/* The linear oscillator against its closed form in long double, and what its solutions must satisfy. */
#include "math/oscillator.h"

#include <float.h>

#include "check.h"
#include "random.h"

struct long_basis {
    long double value[4]; /* y_of_y, y_of_rate, rate_of_y, rate_of_rate */
    long double scale[4]; /* the size of the terms that make them up */
};

/* By the exponentials of both rates where they differ, otherwise by cos and sin or cosh and sinh. */
static struct long_basis closed_form(long double omega2, long double damping_rate, long double z)
{
    const long double decay_rate = damping_rate / 2.0L;
    const long double omega_d2 = omega2 - decay_rate * decay_rate;
    const long double omega_d = sqrtl(fabsl(omega_d2));
    long double cosine;
    long double sine; /* sin(turn z) / turn */
    if (omega_d2 < 0.0L && omega_d * z > 1.0L) {
        const long double fast = -(decay_rate + omega_d);
        const long double slow = omega2 / fast;
        const long double by_fast = expl(fast * z);
        const long double by_slow = expl(slow * z);
        sine = (by_slow - by_fast) / (slow - fast);
        cosine = (by_slow + by_fast) / 2.0L;
    } else {
        const long double shrink = expl(-decay_rate * z);
        const long double small = omega_d2 * z * z;
        sine = omega_d2 > 0.0L ? sinl(omega_d * z) / omega_d : sinhl(omega_d * z) / omega_d;
        if (fabsl(small) < 1e-10L) {
            sine = z * (1.0L - small / 6.0L);
        }
        sine *= shrink;
        cosine = shrink * (omega_d2 > 0.0L ? cosl(omega_d * z) : coshl(omega_d * z));
    }
    const long double spread = omega_d2 < 0.0L ? omega_d : 0.0L;
    const long double slowest = expl(-(spread > 0.0L ? omega2 / (decay_rate + spread) : decay_rate) * z);
    const long double reach = slowest * (omega_d > 0.0L ? fminl(z, 1.0L / omega_d) : z);
    const long double whole = slowest + (decay_rate + spread) * reach;
    return (struct long_basis){{cosine + decay_rate * sine, sine, -omega2 * sine, cosine - decay_rate * sine},
                               {whole, reach, omega2 * reach, whole}};
}

/* As exact as for a omega2 and a damping_rate that differ by roundings. */
static void check_basis(const struct oscillator *o, double z)
{
    static const char *const name[4] = {"y of y", "y of rate", "rate of y", "rate of rate"};
    const long double change = 1.0L + 4.0L * DBL_EPSILON;
    const struct oscillator_basis basis = oscillator_basis_at(o, z);
    const double got[4] = {basis.y_of_y, basis.y_of_rate, basis.rate_of_y, basis.rate_of_rate};
    const struct long_basis expected = closed_form(o->omega2, o->damping_rate, z);
    const struct long_basis stiffer = closed_form(o->omega2 * change, o->damping_rate, z);
    const struct long_basis thicker = closed_form(o->omega2, o->damping_rate * change, z);
    for (int i = 0; i < 4; ++i) {
        const long double sensitive =
            fabsl(stiffer.value[i] - expected.value[i]) + fabsl(thicker.value[i] - expected.value[i]);
        CHECK_CLOSE(name[i], got[i], expected.value[i], 8.0L * DBL_EPSILON * expected.scale[i] + sensitive);
    }
}

TEST(the_basis_is_the_closed_form)
{
    struct random r = {1};
    for (int k = 0; k < 20000; ++k) {
        const double omega2 = random_power(&r, -3.0, 8.0);
        const double ratio = k % 2 == 0 ? random_between(&r, 0.0, 2.0) : random_power(&r, -6.0, 6.0);
        const struct oscillator o = {omega2, 2.0 * ratio * sqrt(omega2)};
        check_basis(&o, random_power(&r, -6.0, 2.0) / sqrt(omega2));
    }
}

TEST(the_basis_is_the_closed_form_about_critical_damping)
{
    struct random r = {2};
    for (int k = 0; k < 5000; ++k) {
        const double decay_rate = random_power(&r, -1.0, 4.0);
        const double off = k % 5 == 0 ? 0.0 : random_sign(&r) * random_power(&r, -16.0, -1.0);
        const struct oscillator o = {decay_rate * decay_rate * (1.0 + off), 2.0 * decay_rate};
        check_basis(&o, random_power(&r, -3.0, 1.3) / decay_rate);
    }
}

TEST(without_a_spring_the_basis_is_that_of_the_dashpot_alone)
{
    struct random r = {3};
    for (int k = 0; k < 1000; ++k) {
        const struct oscillator o = {0.0, random_power(&r, -4.0, 6.0)};
        const double z = random_power(&r, -6.0, 3.0) / o.damping_rate;
        const struct oscillator_basis basis = oscillator_basis_at(&o, z);
        const long double by = -expm1l(-(long double)o.damping_rate * z);
        CHECK(basis.y_of_y == 1.0 && basis.rate_of_y == 0.0);
        CHECK_CLOSE("y of rate", basis.y_of_rate, by / o.damping_rate,
                    4.0L * DBL_EPSILON * by / o.damping_rate);
        CHECK_CLOSE("rate of rate", basis.rate_of_rate, 1.0L - by, 4.0L * DBL_EPSILON);
    }
}

/* Two decays multiply to the omega2 and add to the damping_rate; a turning one has one rate. */
TEST(the_rates_are_the_roots)
{
    struct random r = {4};
    for (int k = 0; k < 5000; ++k) {
        const double omega2 = random_power(&r, -6.0, 12.0);
        const double ratio = random_power(&r, -8.0, 8.0);
        const struct oscillator o = {omega2, 2.0 * ratio * sqrt(omega2)};
        const struct oscillator_rates rates = oscillator_rates_of(&o);
        CHECK(rates.slower > 0.0 && rates.faster >= rates.slower);
        CHECK_CLOSE("product", (long double)rates.slower * rates.faster / omega2, 1.0L, 4.0L * DBL_EPSILON);
        if (ratio > 1.0) {
            CHECK_CLOSE("sum", ((long double)rates.slower + rates.faster) / o.damping_rate, 1.0L,
                        4.0L * DBL_EPSILON);
        } else {
            CHECK(rates.slower == rates.faster);
        }
    }
    const struct oscillator_rates dashpot = oscillator_rates_of(&(struct oscillator){0.0, 3.0});
    CHECK(dashpot.slower == 0.0 && dashpot.faster == 3.0);
}

enum { TERMS = 12 };

/* s'' + damping_rate s' + omega2 s = load, coefficient by coefficient, to roundings of what is added. */
TEST(what_follows_the_load_solves_the_equation)
{
    struct random r = {5};
    for (int k = 0; k < 2000; ++k) {
        const struct oscillator o = {random_power(&r, -1.0, 12.0),
                                     k % 4 == 0 ? 0.0 : random_power(&r, -3.0, 8.0)};
        const int terms = 1 + random_index(&r, TERMS);
        double load[TERMS];
        double s[TERMS + 2] = {0.0};
        for (int i = 0; i < terms; ++i) {
            load[i] = random_between(&r, -1.0, 1.0);
        }
        oscillator_particular(&o, 1.0, load, s, terms);
        for (int i = 0; i < terms; ++i) {
            const long double bent = (i + 1.0L) * (i + 2.0L) * s[i + 2];
            const long double damped = (i + 1.0L) * o.damping_rate * s[i + 1];
            const long double forced = (long double)o.omega2 * s[i];
            CHECK_CLOSE("load", bent + damped + forced, load[i],
                        4.0L * DBL_EPSILON * (fabsl(bent) + fabsl(damped) + fabsl(forced)));
        }
        CHECK(s[terms] == 0.0);
    }
}

TEST(what_relaxes_to_the_load_solves_the_equation)
{
    struct random r = {6};
    for (int k = 0; k < 2000; ++k) {
        const double rate = random_sign(&r) * random_power(&r, -1.0, 8.0);
        const int terms = 1 + random_index(&r, TERMS);
        double load[TERMS];
        double s[TERMS + 1] = {0.0};
        for (int i = 0; i < terms; ++i) {
            load[i] = random_between(&r, -1.0, 1.0);
        }
        oscillator_particular(&(struct oscillator){rate, 1.0}, 0.0, load, s, terms);
        for (int i = 0; i < terms; ++i) {
            const long double slope = (i + 1.0L) * s[i + 1];
            const long double forced = (long double)rate * s[i];
            CHECK_CLOSE("load", slope + forced, load[i], 4.0L * DBL_EPSILON * (fabsl(slope) + fabsl(forced)));
        }
        CHECK(s[terms] == 0.0);
    }
}

/* The largest |y| exp(decay z), y from the closed form, over some turns or until the faster decay is over. */
static long double largest_part(const struct oscillator *o, double y, double rate, double decay_rate)
{
    const struct oscillator_rates rates = oscillator_rates_of(o);
    const long double end = 40.0L / rates.faster;
    long double largest = 0.0L;
    for (int i = 0; i <= 600; ++i) {
        const long double z = end * i / 600.0L;
        const struct long_basis basis = closed_form(o->omega2, o->damping_rate, z);
        const long double now = fabsl(y * basis.value[0] + rate * basis.value[1]);
        largest = fmaxl(largest, now * expl(decay_rate * z));
    }
    return largest;
}

/* Tight: reached by one that turns, at most four times the need where the parts cancel. */
TEST(the_envelope_bounds_the_oscillation_tightly)
{
    struct random r = {7};
    for (int k = 0; k < 600; ++k) {
        const double omega2 = random_power(&r, -2.0, 6.0);
        const double near = 1.0 + random_sign(&r) * random_power(&r, -12.0, -1.0);
        const double far = k % 3 == 0 ? random_between(&r, 0.0, 2.0) : random_power(&r, -3.0, 2.0);
        const double ratio = k % 3 == 1 ? near : far;
        const struct oscillator o = {omega2, 2.0 * ratio * sqrt(omega2)};
        const double y = random_index(&r, 5) == 0 ? 0.0 : random_between(&r, -1.0, 1.0);
        const double rate =
            random_index(&r, 5) == 0 ? 0.0 : random_sign(&r) * random_power(&r, -2.0, 2.0) * sqrt(omega2);
        const struct oscillator_envelope bound = oscillator_envelope_of(&o, y, rate);
        const long double needed = largest_part(&o, y, rate, bound.decay_rate);
        CHECK(bound.amplitude >= needed * (1.0L - 16.0L * DBL_EPSILON * (1.0L + ratio * ratio)));
        CHECK(bound.amplitude <= (ratio < 0.95 ? 1.01L : 4.0L) * needed);
        CHECK(bound.decay_rate >= 0.49 * fmin(oscillator_rates_of(&o).slower, 0.5 * o.damping_rate));
    }
}

/* Under a load that alone would take it to load / omega2, 1e6 times as far: its motion lacks no digits. */
TEST(what_has_hardly_begun_keeps_its_digits)
{
    struct random r = {29};
    for (int k = 0; k < 20000; ++k) {
        const struct oscillator o = {k % 7 == 0 ? 0.0 : random_power(&r, -6.0, 0.0),
                                     random_power(&r, -3.0, 3.0)};
        const double x = random_between(&r, -1.0, 1.0);
        const double x_rate = random_between(&r, -1.0, 1.0);
        const double load = random_between(&r, -1.0, 1.0);
        const double z = OSCILLATOR_SERIES_RANGE / (1.0 + o.damping_rate) * random_between(&r, 0.01, 1.0);
        const struct oscillator_increment begun = oscillator_increment(&o, x, x_rate, load, z);
        /* Runge and Kutta's method, 400 steps of long double: off by less than (0.1 / 400)^4 / 100. */
        const long double h = z / 400.0L;
        long double moved = 0.0L;
        long double gained = 0.0L;
        for (int i = 0; i < 400; ++i) {
            long double a[4], b[4];
            for (int stage = 0; stage < 4; ++stage) {
                const long double part = stage == 0 ? 0.0L : (stage == 3 ? 1.0L : 0.5L) * h;
                a[stage] = x_rate + gained + (stage == 0 ? 0.0L : part * b[stage - 1]);
                const long double at = x + moved + (stage == 0 ? 0.0L : part * a[stage - 1]);
                b[stage] = load - o.damping_rate * a[stage] - o.omega2 * at;
            }
            moved += h / 6.0L * (a[0] + 2.0L * (a[1] + a[2]) + a[3]);
            gained += h / 6.0L * (b[0] + 2.0L * (b[1] + b[2]) + b[3]);
        }
        const double speeds_up = fabs(load) + o.damping_rate * fabs(x_rate) + o.omega2 * fabs(x);
        CHECK_CLOSE("moved", begun.x, moved, 4.0L * DBL_EPSILON * z * (fabs(x_rate) + z * speeds_up));
        CHECK_CLOSE("rate", begun.x_rate, gained, 8.0L * DBL_EPSILON * z * speeds_up);
    }
}
