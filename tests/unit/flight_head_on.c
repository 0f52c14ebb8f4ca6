/* Head-on flight: the first touch against bisection in long double, and what needs a closer look. */
#include "flight/flight.h"

#include <float.h>

#include "check.h"
#include "random.h"

static const double REACH = 0.7;
static const double HORIZON = 3.0;

/* A small sphere below a large one (outside) or in it, that moves along z. */
struct flight {
    struct contact_shape shape;
    struct separation_path separation;
    struct contact_geometry now;
};

static struct flight flight_of(int side, double gap, double rate, double bend)
{
    struct flight f = {.shape = {.source_radius = side > 0 ? 0.2 : 0.3,
                                 .other_radius = side > 0 ? 0.5 : 1.0,
                                 .half_length = (double)INFINITY,
                                 .side = side,
                                 .destination = SHAPE_SPHERE}};
    f.now.normal = vec3_make(0.0, 0.0, 1.0);
    f.now.gap = gap;
    f.now.distance = REACH + side * gap;
    f.separation.c[0] = vec3_make(0.0, 0.0, f.now.distance);
    f.separation.c[1] = f.separation.w[0] = vec3_make(0.0, 0.0, side * rate);
    f.separation.c[2] = vec3_make(0.0, 0.0, side * bend);
    f.separation.w[1] = vec3_make(0.0, 0.0, side * 2.0 * bend);
    return f;
}

static long double gap_at(double gap, double rate, double bend, long double t)
{
    return gap + t * (rate + t * (long double)bend);
}

/* INFINITY where g keeps above zero. Between turns it is monotone. */
static long double touch_by_bisection(double gap, double rate, double bend)
{
    const long double turn = bend == 0.0 ? -1.0L : -0.5L * rate / bend;
    long double low = turn > 0.0L && bend < 0.0 ? turn : 0.0L;
    long double high = turn > 0.0L && bend > 0.0 ? turn : HORIZON;
    high = high < HORIZON ? high : HORIZON;
    if (low >= high || gap_at(gap, rate, bend, high) > 0.0L || gap_at(gap, rate, bend, low) < 0.0L) {
        return (long double)INFINITY;
    }
    for (int i = 0; i < 200; ++i) {
        const long double middle = 0.5L * (low + high);
        *(gap_at(gap, rate, bend, middle) > 0.0L ? &low : &high) = middle;
    }
    return low;
}

static void the_touch_is_where_the_parabola_falls_through_zero(void)
{
    struct random r = {41};
    int touches = 0;
    for (int k = 0; k < 20000; ++k) {
        const double gap = k % 3 == 0 ? 0.0 : random_between(&r, 0.0, 0.3);
        const double rate = k % 3 == 0 ? random_between(&r, 1e-3, 1.0) : random_between(&r, -1.0, 1.0);
        const double bend = k % 5 == 0 ? 0.0 : random_between(&r, -2.0, 2.0);
        const struct flight f = flight_of(1, gap, rate, bend);
        const long double expected = touch_by_bisection(gap, rate, bend);
        double touch = 0.0;
        CHECK(flight_is_head_on(&f.shape, &f.separation, f.now.normal));
        if (!flight_head_on_touch(&f.shape, &f.separation, &f.now, 1e-15, HORIZON, &touch)) {
            /* Nothing but a near graze is left to a closer look. */
            CHECK_CLOSE("discriminant", rate * rate, 4.0L * bend * gap, 1e-7L * rate * rate + 1e-14L);
        } else if (isinf(expected)) {
            CHECK(isinf(touch));
        } else {
            /* How far rounding of the terms moves the root. */
            const double slope = fabs(rate + 2.0 * touch * bend);
            const double noise = (gap + touch * (fabs(rate) + touch * fabs(bend))) / slope + touch;
            CHECK_CLOSE("touch", touch, expected, 8.0L * DBL_EPSILON * noise);
            ++touches;
        }
    }
    CHECK(touches > 5000);
}

static void what_rounding_decides_is_left_to_a_closer_look(void)
{
    double touch;
    const struct flight graze = flight_of(1, 0.25, -1.0, 1.0 + 1e-12);
    CHECK(!flight_head_on_touch(&graze.shape, &graze.separation, &graze.now, 1e-15, HORIZON, &touch));
    const struct flight touching = flight_of(1, 0.0, -1.0, 0.0);
    CHECK(
        !flight_head_on_touch(&touching.shape, &touching.separation, &touching.now, 1e-15, HORIZON, &touch));
    const struct flight near = flight_of(1, 1e-16, -1.0, 0.0);
    CHECK(flight_head_on_touch(&near.shape, &near.separation, &near.now, 1e-15, HORIZON, &touch));
    CHECK_CLOSE("touch", touch, 1e-16L, 1e-30L);
    const struct flight hop = flight_of(1, 0.0, 1e-9, -4.9); /* 5e-20 m high */
    CHECK(!flight_head_on_touch(&hop.shape, &hop.separation, &hop.now, 1e-15, HORIZON, &touch));
    struct flight huge = flight_of(1, 1.0, -1e200, 0.0);
    CHECK(!flight_head_on_touch(&huge.shape, &huge.separation, &huge.now, 1e-15, HORIZON, &touch));
    huge = flight_of(1, 1.0, -1.0, 0.0);
    huge.now.degenerate = true;
    CHECK(!flight_head_on_touch(&huge.shape, &huge.separation, &huge.now, 1e-15, HORIZON, &touch));
}

/* The first time at which p_n g + p_nv g' falls below zero or g rises above it, by small steps and
 * bisection. */
static long double separation_by_steps(const struct contact_law *law, double gap, double rate, double bend,
                                       bool *parts)
{
    const long double step = 1e-4L;
    for (long double t = step; t < HORIZON; t += step) {
        for (int what = 0; what < 2; ++what) {
            long double low = t - step;
            long double high = t;
            for (int i = 0; i < 100; ++i) {
                const long double at = i == 0 ? t : 0.5L * (low + high);
                const long double g = gap_at(gap, rate, bend, at);
                const long double margin = law->stiffness * g + law->damping * (rate + 2.0L * at * bend);
                const bool over = what == 0 ? g >= 0.0L : margin < 0.0L;
                if (i == 0 && !over) {
                    high = -1.0L;
                    break;
                }
                *(over ? &high : &low) = at;
            }
            if (high >= 0.0L) {
                *parts = what == 0;
                return high;
            }
        }
    }
    return (long double)INFINITY;
}

static void separation_ends_where_the_gap_opens_or_the_law_pushes_again(void)
{
    struct random r = {43};
    int seen[2] = {0, 0};
    for (int k = 0; k < 1000; ++k) {
        const struct contact_law law = {100.0, random_between(&r, 5.0, 50.0), DASHPOT_NON_ADHESIVE,
                                        LAW_LINEAR};
        const double gap = -random_between(&r, 1e-3, 0.3);
        const double bend = k % 3 == 0 ? 0.0 : random_between(&r, -3.0, 1.0);
        /* The law has just ceased to push: its margin is zero, and grows. */
        const double rate = -law.stiffness * gap / law.damping;
        if (law.stiffness * rate + 2.0 * law.damping * bend < 1e-2) {
            continue;
        }
        const struct flight f = flight_of(k % 2 == 0 ? 1 : -1, gap, rate, bend);
        struct flight_regime_end end;
        bool parts = false;
        const long double expected = separation_by_steps(&law, gap, rate, bend, &parts);
        CHECK(flight_head_on_regime_end(&f.shape, &law, &f.separation, &f.now, 1e-15, 1e-13, &end));
        if (isinf(expected)) {
            CHECK(end.after > HORIZON - 1e-3);
            continue;
        }
        CHECK(end.regime == (parts ? REGIME_APART : REGIME_COMPRESSION));
        CHECK_CLOSE("end", end.after, expected, 1e-11L);
        CHECK_CLOSE("gap", end.gap, parts ? 0.0L : gap_at(gap, rate, bend, expected), 1e-10L);
        ++seen[parts];
    }
    CHECK(seen[0] > 20 && seen[1] > 200);
}

static void through_the_centre_of_a_hollow_ball_the_normal_reverses(void)
{
    double touch;
    const struct flight across = flight_of(-1, 0.1, 1.0, 0.0);
    CHECK(!flight_head_on_touch(&across.shape, &across.separation, &across.now, 1e-15, HORIZON, &touch));
    const struct flight hop = flight_of(-1, 0.1, 1.0, -1.0); /* up to 0.35 of 0.7 */
    CHECK(flight_head_on_touch(&hop.shape, &hop.separation, &hop.now, 1e-15, HORIZON, &touch));
    CHECK_CLOSE("touch", touch, 0.5L * (1.0L + sqrtl(1.4L)), 8.0L * DBL_EPSILON);
    const struct flight high_hop = flight_of(-1, 0.1, 1.0, -0.4); /* up to 0.725 */
    CHECK(
        !flight_head_on_touch(&high_hop.shape, &high_hop.separation, &high_hop.now, 1e-15, HORIZON, &touch));
}

static void other_flights_are_refused(void)
{
    for (int k = 0; k < 6; ++k) {
        struct flight f = flight_of(1, 0.1, -1.0, 0.5);
        CHECK(flight_is_head_on(&f.shape, &f.separation, f.now.normal));
        struct vec3 *const changed[] = {&f.separation.c[1], &f.separation.c[2], &f.separation.c[3],
                                        &f.separation.w[0], &f.separation.w[1], &f.separation.w[3]};
        changed[k]->x += 1e-14;
        CHECK(!flight_is_head_on(&f.shape, &f.separation, f.now.normal));
    }
}

int main(void)
{
    CHECK_TEST(the_touch_is_where_the_parabola_falls_through_zero);
    CHECK_TEST(separation_ends_where_the_gap_opens_or_the_law_pushes_again);
    CHECK_TEST(what_rounding_decides_is_left_to_a_closer_look);
    CHECK_TEST(through_the_centre_of_a_hollow_ball_the_normal_reverses);
    CHECK_TEST(other_flights_are_refused);
    return check_summary("head_on");
}
