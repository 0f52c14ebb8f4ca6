/* One step of Radau IIA against closed forms: an oscillator, a stiff relaxation, a quaternion; where a
 * polynomial first falls through zero. */
#include "math/radau_step.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "math/polynomial.h"
#include "random.h"

/* Blocks of zeros in every other pair of rows make more runs than lu_factor tells apart. The right side is
 * A x of a known x. */
TEST(a_matrix_with_many_blocks_of_zeros_gives_the_solution_of_its_system)
{
    enum { ROWS = 60, STRIDE = 64 };
    static double a[ROWS * STRIDE];
    double side[STRIDE] = {0.0};
    double wanted[ROWS];
    int pivot[ROWS];
    struct random r = {5};
    for (int j = 0; j < ROWS; ++j) {
        wanted[j] = random_between(&r, -1.0, 1.0);
        for (int i = 0; i < ROWS; ++i) {
            const bool is_zero = (i / 2 + j / 2) % 2 == 1 && i / 20 != j / 20;
            a[j * STRIDE + i] = is_zero ? 0.0 : random_between(&r, -1.0, 1.0) + (i == j ? 9.0 : 0.0);
            side[i] += a[j * STRIDE + i] * wanted[j];
        }
    }
    const struct lu_matrix m = {.rows = ROWS, .stride = STRIDE, .re = a, .pivot = pivot};
    CHECK(lu_factor(m));
    lu_solve(m, side);
    for (int i = 0; i < ROWS; ++i) {
        CHECK_CLOSE("x", side[i], wanted[i], 1e-13);
    }
}

/* The states are x and v of x'' = -x - damping x', a quaternion that turns about its first axis with the
 * angular velocity v, and the integral of v^2. */
enum { PLACE, SPEED, TURN, SQUARE = 6, SIZE };

static void oscillator_rates(const void *damping, double clock, const double *y, double *rates)
{
    (void)clock;
    rates[PLACE] = y[SPEED];
    rates[SPEED] = -y[PLACE] - *(const double *)damping * y[SPEED];
    rates[TURN] = -0.5 * y[SPEED] * y[TURN + 1];
    rates[TURN + 1] = 0.5 * y[SPEED] * y[TURN];
    rates[TURN + 2] = -0.5 * y[SPEED] * y[TURN + 3];
    rates[TURN + 3] = 0.5 * y[SPEED] * y[TURN + 2];
    rates[SQUARE] = y[SPEED] * y[SPEED];
}

static struct radau_problem oscillator(double *damping)
{
    static const int place = PLACE, speed = SPEED;
    return (struct radau_problem){.context = damping,
                                  .size = SIZE,
                                  .coupled = 2,
                                  .integrals = SQUARE,
                                  .unknowns = 1,
                                  .paired = 1,
                                  .place = &place,
                                  .speed = &speed,
                                  .rates = oscillator_rates};
}

/* Begins a step of a problem from the states y, all of the weight 1, and returns its memory. */
static void *begin_at(struct radau_step *p, const struct radau_problem *problem, const double *y)
{
    void *memory = calloc(1, radau_step_memory(problem));
    radau_step_place(p, problem, memory);
    for (int i = 0; i < problem->size; ++i) {
        p->weight[i] = 1.0;
    }
    radau_step_begin(p, 0.0, y);
    return memory;
}

/* Begins at x = 0, v = 1, unturned. */
static void *begin(struct radau_step *p, double *damping)
{
    const double y[SIZE] = {[SPEED] = 1.0, [TURN] = 1.0};
    const struct radau_problem problem = oscillator(damping);
    return begin_at(p, &problem, y);
}

/* Writes the rates of all states at the stages, as they are after the last iteration. */
static void put_rates(struct radau_step *p)
{
    memcpy(p->point, p->y, (size_t)p->problem.size * sizeof *p->point);
    for (int i = 0; i < p->stages->stages; ++i) {
        radau_step_stage(p, i, p->point);
        p->problem.rates(p->problem.context, p->start + p->length * p->stages->node[i], p->point,
                         p->rates + i * p->stride);
    }
}

/* Solves a step of the oscillator for the rates a of v, which change their law -x - damping v by (damping h A
 * + h^2 A^2) a. Later solutions correct the rounding of the first. */
static void oscillate(struct radau_step *p, const struct radau_stages *stages, double h)
{
    double a[RADAU_MOST_STAGES + 4] = {0.0};
    const double damping = *(const double *)p->problem.context;
    const int s = stages->stages;
    radau_step_guess_on(p, stages, h);
    const struct lu_matrix m = lu_part(p->all, 0, s);
    for (int k = 0; k < s * s; ++k) {
        m.re[k / s * m.stride + k % s] =
            (k / s == k % s ? 1.0 : 0.0) + damping * h * stages->once[k] + h * h * stages->twice[k];
        m.re[k / s * m.stride + s] = 0.0;
    }
    CHECK(lu_factor(m));
    memset(p->bare, 0, (size_t)(s * p->width) * sizeof *p->bare);
    for (int round = 0; round < 5; ++round) { /* the last one only integrates */
        (void)radau_step_integrate(p, p->bare);
        put_rates(p);
        for (int i = 0; i < s; ++i) {
            a[i] = p->rates[i * p->stride + SPEED] - p->bare[i * p->width];
        }
        lu_solve(m, a);
        for (int i = 0; i < s; ++i) {
            p->bare[i * p->width] += a[i];
        }
        a[s] = 0.0;
    }
    radau_step_finish(p);
}

TEST(an_oscillation_is_right_at_the_end_and_within)
{
    static const struct {
        const struct radau_stages *stages;
        double length, at_end, within;
    } cases[] = {{&radau_stages_4, 0.1, 1e-13, 1e-9},
                 {&radau_stages_8, 1.5, 1e-13, 1e-8},
                 {&radau_stages_12, 4.0, 1e-13, 1e-9},
                 {&radau_stages_touch, 1.0, 1e-13, 1e-9},
                 {&radau_stages_release, 1.0, 1e-13, 1e-9}};
    double damping = 0.0;
    for (int k = 0; k < 5; ++k) {
        struct radau_step p;
        double y[SIZE];
        const double h = cases[k].length;
        void *memory = begin(&p, &damping);
        oscillate(&p, cases[k].stages, h);
        radau_step_at(&p, 1.0, y);
        CHECK_CLOSE("x at the end", y[PLACE], sin(h), cases[k].at_end);
        CHECK_CLOSE("v at the end", y[SPEED], cos(h), cases[k].at_end);
        CHECK_CLOSE("integral of v^2", y[SQUARE], 0.5 * h + 0.25 * sin(2.0 * h), 10.0 * cases[k].at_end);
        CHECK_CLOSE("turned by x", y[TURN], cos(0.5 * sin(h)), cases[k].within);
        CHECK_CLOSE("about the first axis", y[TURN + 1], sin(0.5 * sin(h)), cases[k].within);
        for (double part = 0.0; part <= 1.0; part += 0.01) {
            radau_step_at(&p, part, y);
            CHECK_CLOSE("x within", y[PLACE], sin(part * h), cases[k].within);
        }
        oscillate(&p, cases[k].stages, 0.6 * h);
        radau_step_at(&p, 1.0, y);
        CHECK_CLOSE("x of a shorter step", y[PLACE], sin(0.6 * h), cases[k].at_end);
        free(memory);
    }
}

/* Rates 1e8 and 1e-8: in a step of 100 seconds x follows v = -x / damping, whatever v was. The speeds at the
 * stages are 1 less their change, with a rounding of 1e-16, and x has a hundred times that at most. */
TEST(what_is_too_fast_is_damped_away)
{
    double damping = 1e8;
    struct radau_step p;
    double y[SIZE];
    void *memory = begin(&p, &damping);
    oscillate(&p, &radau_stages_12, 100.0);
    radau_step_at(&p, 1.0, y);
    CHECK_CLOSE("x has moved by v / damping, and crept", y[PLACE], 1e-8 * (1.0 - 1e-6), 4e-15);
    CHECK_CLOSE("v is 12 / 1e10 of what it was", y[SPEED], 0.0, 2e-9);
    free(memory);
}

/* A hundred radians or more in one step are no solution: the error is above a hundredth of the quaternion. */
TEST(a_quaternion_that_turns_too_far_has_no_small_error)
{
    const double y[SIZE] = {[SPEED] = 2e7, [TURN] = 1.0};
    double damping = 0.0;
    struct radau_step p;
    void *memory = begin(&p, &damping);
    radau_step_begin(&p, 0.0, y);
    for (int i = 0; i < SIZE; ++i) {
        p.weight[i] = i < TURN || i == SQUARE ? 1e-30 : 100.0; /* the quaternion alone decides */
    }
    for (double length = 1e-5; length < 2.0; length *= 10.0) {
        oscillate(&p, &radau_stages_12, length);
        const struct radau_error error = radau_step_error(&p);
        CHECK(error.at_end > 1.0 && error.within > 1.0);
    }
    free(memory);
}

/* x' = v, a' = (1 + x) v, v' = -x - damping v - 5 a. */
enum { TIPPING = 2, TIPPING_STATES = 3 };

static void tipping_rates(const void *damping, double clock, const double *y, double *rates)
{
    (void)clock;
    rates[PLACE] = y[SPEED];
    rates[SPEED] = -y[PLACE] - *(const double *)damping * y[SPEED] - 5.0 * y[TIPPING];
    rates[TIPPING] = (1.0 + y[PLACE]) * y[SPEED];
}

/* A step from x = 0, v = 1, a = 0 and its memory. */
static void *begin_tipping(struct radau_step *p, double *damping)
{
    static const int place = PLACE, speed = SPEED;
    const double start[TIPPING_STATES] = {[SPEED] = 1.0};
    const struct radau_problem problem = {.context = damping,
                                          .size = TIPPING_STATES,
                                          .coupled = TIPPING_STATES,
                                          .integrals = TIPPING_STATES,
                                          .turns = true,
                                          .paired = 1,
                                          .place = &place,
                                          .speed = &speed,
                                          .rates = tipping_rates};
    return begin_at(p, &problem, start);
}

/* Integrates the rates at the stages and returns how much that changes the states. */
static double integrate_rates(struct radau_step *p)
{
    for (int i = 0; i < 12 * p->others; ++i) {
        const int stage = i / p->others;
        p->bare[stage * p->width + i % p->others] = p->rates[stage * p->stride + p->other[i % p->others]];
    }
    return radau_step_integrate(p, p->bare);
}

/* Makes a step whose iterations converge without a matrix: the rates at the stages give the states there, and
 * these the next rates. */
static void tip(struct radau_step *p, double length)
{
    double size = 1.0;
    radau_step_guess_on(p, &radau_stages_12, length);
    for (int round = 0; round < 40; ++round) {
        put_rates(p);
        size = integrate_rates(p);
    }
    CHECK(size < 1e-15);
    put_rates(p);
    radau_step_finish(p);
}

TEST(iterations_without_a_matrix_find_a_state_that_follows_another)
{
    double damping = 1.0;
    struct radau_step p;
    double y[TIPPING_STATES];
    void *memory = begin_tipping(&p, &damping);
    tip(&p, 0.1);
    radau_step_at(&p, 1.0, y);
    CHECK_CLOSE("a follows x", y[TIPPING], y[PLACE] + 0.5 * y[PLACE] * y[PLACE], 1e-14);
    free(memory);
}

/* v' = 6 t and a' = 2 t given at the stages: v = 1 + 3 t^2, x = t + t^3, a = t^2. */
TEST(given_rates_are_integrated_exactly_and_a_guess_tells_its_rates)
{
    double length = 0.7;
    struct radau_step p;
    double y[TIPPING_STATES], rates[RADAU_MOST_STAGES];
    void *memory = begin_tipping(&p, &length);
    radau_step_guess_on(&p, &radau_stages_12, length);
    for (int round = 0; round < 2; ++round) {
        for (int i = 0; i < 12; ++i) {
            p.rates[i * p.stride + SPEED] = 6.0 * length * p.stages->node[i];
            p.rates[i * p.stride + TIPPING] = 2.0 * length * p.stages->node[i];
        }
        const double size = integrate_rates(&p);
        CHECK(round == 0 ? size > 0.1 : size < 1e-15);
    }
    for (int i = 0; i < 12; ++i) {
        const double t = length * p.stages->node[i];
        radau_step_stage(&p, i, y);
        CHECK_CLOSE("v", y[SPEED], 1.0 + 3.0 * t * t, 1e-14);
        CHECK_CLOSE("x", y[PLACE], t + t * t * t, 1e-14);
        CHECK_CLOSE("a", y[TIPPING], t * t, 1e-14);
        double twice = 0.0; /* A^2 times 6 t is t^3 / h^2 */
        for (int j = 0; j < 12; ++j) {
            twice += p.stages->twice[j * 12 + i] * 6.0 * length * p.stages->node[j];
        }
        CHECK_CLOSE("A^2", length * length * twice, t * t * t, 1e-14);
        p.rates[i * p.stride + PLACE] = y[SPEED];
    }
    radau_step_finish(&p);
    radau_step_guess_on(&p, &radau_stages_8, 0.5 * length);
    radau_step_guess_rates(&p, SPEED, 1, rates);
    for (int i = 0; i < 8; ++i) {
        CHECK_CLOSE("v'", rates[i], 6.0 * 0.5 * length * p.stages->node[i], 1e-12);
    }
    free(memory);
}

/* Rates that go with the root of the time since the start, or of the time to what a step leaves. */
TEST(roots_of_time_are_polynomials_of_a_paced_step)
{
    double length = 0.7;
    const struct radau_stages *paced[2] = {&radau_stages_touch, &radau_stages_release};
    for (int k = 0; k < 2; ++k) {
        struct radau_step p;
        double y[TIPPING_STATES];
        const double sign = k == 0 ? 1.0 : -1.0;
        const double from = k == 0 ? 0.0 : length * (1.0 + RADAU_REST);
        void *memory = begin_tipping(&p, &length);
        radau_step_guess_on(&p, paced[k], length);
        for (int i = 0; i < 12; ++i) {
            p.rates[i * p.stride + SPEED] = 1.5 * sign * sqrt(fabs(from - length * p.stages->node[i]));
        }
        (void)integrate_rates(&p);
        radau_step_finish(&p);
        for (double part = 0.0; part <= 1.0; part += 0.01) {
            const double expected = pow(fabs(from - length * part), 1.5) - pow(from, 1.5);
            radau_step_at(&p, part, y);
            CHECK_CLOSE("v", y[SPEED], 1.0 + expected, 1e-14);
            CHECK_CLOSE("part", radau_part(paced[k], radau_place(paced[k], part)), part, 1e-15);
        }
        free(memory);
    }
}

/* A cubic by its Bernstein coefficients. */
TEST(a_fall_is_the_first_change_from_above_to_below)
{
    /* (0.2 - s)(0.7 - s)(0.9 - s): falls at 0.2, rises at 0.7, falls at 0.9 */
    double of[4] = {0.126, -0.95, 1.8, -1.0};
    bernstein_from_powers(of, 4);
    const struct bernstein_fall fall = bernstein_first_fall(of, 4, 0.0);
    CHECK_CLOSE("first fall", bernstein_root(of, 4, fall), 0.2, 1e-14);
    double turned[4];
    for (int i = 0; i < 4; ++i) {
        turned[i] = -of[i];
    }
    CHECK_CLOSE("of what starts below zero", bernstein_root(turned, 4, bernstein_first_fall(turned, 4, 0.0)),
                0.7, 1e-13);
    const double bow[3] = {1.0, -0.999, 1.0}; /* least 0.0005, at a half */
    CHECK(bernstein_first_fall(bow, 3, 0.0).low == (double)INFINITY);
    const double dip[3] = {1.0, -1.0000001, 1.0}; /* least -5e-8 */
    CHECK(bernstein_first_fall(dip, 3, 0.0).low < 0.5);
    CHECK(bernstein_first_fall(dip, 3, 1e-6).low == (double)INFINITY);
}

/* The first secant of a straight line rounds to its root, on either side; the bracket is closed anyway. */
TEST(a_straight_line_falls_where_it_does)
{
    for (int k = 1; k < 1000; ++k) {
        const double root = k / 1000.0;
        double of[BERNSTEIN_MOST];
        for (int i = 0; i < BERNSTEIN_MOST; ++i) {
            of[i] = 0.01 * (root - i / (BERNSTEIN_MOST - 1.0));
        }
        const struct bernstein_fall fall = bernstein_first_fall(of, BERNSTEIN_MOST, 0.0);
        CHECK_CLOSE("of a straight line", bernstein_root(of, BERNSTEIN_MOST, fall), root, 1e-14);
    }
}

/* (1 - 2 s)^2 = 1 - 4 s + 4 s^2 between a quarter and a half is (1 - u)^2 / 4, at u of that part. */
TEST(coefficients_between_two_places_are_those_of_the_same_polynomial)
{
    double of[3] = {1.0, -1.0, 1.0};
    bernstein_restrict(of, 3, 0.25, 0.5);
    CHECK_CLOSE("at its start", of[0], 0.25, 1e-16);
    CHECK_CLOSE("between", of[1], 0.0, 1e-16);
    CHECK_CLOSE("at its end", of[2], 0.0, 1e-16);
    double whole[3] = {1.0, -1.0, 1.0};
    bernstein_restrict(whole, 3, 0.0, 1.0);
    CHECK(whole[0] == 1.0 && whole[1] == -1.0 && whole[2] == 1.0);
}
