/* Collocated steps of every kind against extrapolation in long double, over the range each kind declares. */
#include "check.h"
#include "collocation_problems.h"
#include "contact_reference.h"

static const struct lobatto *const twelve = &lobatto[LOBATTO_TWELVE];

enum { SAMPLES = 8 };

/* Asked of the iteration, in parts of d; how many times it the result may be off: the estimate is made from
 * two sweeps. */
static const double TOLERANCE = 1e-14;
static const double TIMES = 10.0;

/* What a first-order answer to an oscillation or decay of amplitude a leaves out: the next order, and the
 * mean of its omega2. */
static double left_out(const struct trial *t, const struct collocation *p)
{
    if (t->kind == COLLOCATION_RESOLVED) {
        return 0.0;
    }
    const double rate = t->kind == COLLOCATION_AVERAGED ? t->rates.slower : t->rates.faster;
    const double ratio = t->turning / rate;
    const double a = fabs(p->result.y) + fabs(p->result.y_rate) / (p->half * rate);
    return 4.0 * a * ratio * ratio + 3.0 * a * a / t->distance * t->turning * t->step;
}

/* At the end of an averaged step the square of its tail, before that twice the tail. */
static double allowed(const struct trial *t, const struct collocation *p, bool end)
{
    const double tail = p->nodes->points * p->result.interior_error;
    const double by_tail = t->kind == COLLOCATION_AVERAGED && end ? 10.0 * tail * tail / t->distance
                                                                  : 2.5 * p->result.interior_error;
    return TIMES * TOLERANCE * t->distance + by_tail + left_out(t, p);
}

struct exact {
    struct long_vec3 moved, gained;
    long double x, x_rate, bend; /* d - reach and its derivatives in time */
    long double force;           /* size of what acts on the way */
};

static struct exact exact_of(const struct reference *r, long double t, const struct reference_state *y)
{
    const struct collocation_problem *p = r->problem;
    const struct reference_state slope = reference_slope(r, t, y);
    const long double d = long_norm(y->c);
    const struct long_vec3 zero = {0.0L, 0.0L, 0.0L};
    const struct long_vec3 n = long_axpy(zero, 1.0L / d, y->c);
    const long double radial = long_dot(n, y->rate);
    const long double mismatch = long_dot(n, long_polynomial(p->mismatch, COLLOCATION_MISMATCH_TERMS, t));
    const long double spin = (long_dot(y->rate, y->rate) - radial * radial) / d;
    const long double x = d - p->reach;
    const long double acceleration =
        long_norm(long_polynomial(p->acceleration, COLLOCATION_ACCELERATION_TERMS, t));
    return (struct exact){.moved = long_axpy(y->c, -1.0L, r->start.c),
                          .gained = long_axpy(y->rate, -1.0L, r->start.rate),
                          .x = x,
                          .x_rate = radial,
                          .bend = long_dot(n, slope.rate) + spin,
                          .force = p->omega2 * fabsl(x) + p->damping_rate * fabsl(radial + mismatch) +
                                   acceleration + long_dot(y->rate, y->rate) / d};
}

static void check_vector(const char *name, struct vec3 got, struct long_vec3 expected, long double tolerance)
{
    CHECK_CLOSE(name, long_norm(long_axpy(expected, -1.0L, long_of(got))), 0.0L, tolerance);
}

static void check_motion(const struct trial *t, const struct collocation *p, double s,
                         const struct exact *expected)
{
    const struct collocation_change change = collocation_change_at(p, s);
    const double off = allowed(t, p, s == 2.0);
    const long double rate = t->rates.faster;
    double x[4];
    collocation_deviation(p, s, x);
    check_vector("moved", change.moved, expected->moved, off);
    check_vector("gained", change.gained, expected->gained, off * rate);
    CHECK_CLOSE("x", x[0], expected->x, off);
    CHECK_CLOSE("x rate", x[1] / (long double)p->half, expected->x_rate, off * rate);
    CHECK_CLOSE("x bend", x[2] / ((long double)p->half * p->half), expected->bend, off * rate * rate);
}

/* A moment leaves out what y adds to n, whose integral is smaller than y by the ratio of the rates and by its
 * rate. */
static void check_sums(const struct trial *t, const struct collocation *p, const struct reference *r,
                       const struct reference_state *y, const struct vec3 weight[2], long double force)
{
    const double off = allowed(t, p, true);
    const double most = vec3_norm(weight[0]) + t->step * vec3_norm(weight[1]);
    double of_y = 0.0;
    if (t->kind != COLLOCATION_RESOLVED) {
        const double rate = t->kind == COLLOCATION_AVERAGED ? t->rates.slower : t->rates.faster;
        of_y = 4.0 * (fabs(p->result.y) + fabs(p->result.y_rate) / (p->half * rate)) / rate *
               (t->turning / rate);
    }
    CHECK_CLOSE("dissipated", collocation_dissipated(p, 2.0), y->dissipated,
                off * force + 16.0L * DBL_EPSILON * long_dot(r->start.rate, r->start.rate));
    CHECK_CLOSE("moment", collocation_moment(p, weight, 2.0), y->moment, most * (off * t->step + of_y));
}

/* At eight places of the step; sums at its end. False where there is no step to check. */
static bool check_trial(struct random *random, const struct trial *t)
{
    struct collocation p;
    const struct vec3 weight[2] = {random_vector(random, 1.0), random_vector(random, 1.0 / t->step)};
    const struct reference r = reference_of(&t->problem, weight);
    const long double longest = 1.0L / fmaxl(t->rates.faster, 2.0L * t->turning);
    struct reference_state y = r.start;
    long double force = 0.0L;
    if (!collocation_make(&p, &t->problem, t->step, t->kind, twelve, TOLERANCE * t->distance)) {
        return false;
    }
    for (int i = 1; i <= SAMPLES; ++i) {
        const long double before = (long double)t->step * (i - 1) / SAMPLES;
        y = reference_move(&r, y, before, (long double)t->step / SAMPLES, longest);
        const struct exact expected = exact_of(&r, (long double)t->step * i / SAMPLES, &y);
        force = fmaxl(force, expected.force);
        check_motion(t, &p, 2.0 * i / SAMPLES, &expected);
    }
    check_sums(t, &p, &r, &y, weight, force);
    return true;
}

static void check_kind(enum collocation_kind kind, uint64_t seed, int count)
{
    static const double swing[3] = {0.0, 0.01, 1.0};
    struct random r = {seed};
    int made = 0;
    for (int k = 0; k < count; ++k) {
        const struct trial t = random_trial(&r, kind, swing[k % 3], k % 2 == 0);
        made += check_trial(&r, &t);
    }
    CHECK(made >= count * 95 / 100); /* the rest does not converge, and says so */
}

static void a_resolved_step_moves_as_the_reference(void)
{
    check_kind(COLLOCATION_RESOLVED, 1, 600);
}

static void an_averaged_step_moves_as_the_reference(void)
{
    check_kind(COLLOCATION_AVERAGED, 2, 300);
}

static void an_overdamped_step_moves_as_the_reference(void)
{
    check_kind(COLLOCATION_OVERDAMPED, 3, 300);
}

/* With eight nodes, from a third of the length, to what is said of the end and of places close to it; twelve
 * nodes are the reference, far more accurate there. */
static void near_its_end_a_resolved_step_is_off_by_less_than_it_says(void)
{
    struct random r = {7};
    int strict = 0;
    for (int k = 0; k < 6000; ++k) {
        struct trial t = random_trial(&r, COLLOCATION_RESOLVED, k % 3, k % 2 == 0);
        struct collocation p;
        struct collocation exact;
        t.step *= random_between(&r, 0.34, 1.0);
        const double asked = TOLERANCE * t.distance;
        if (!collocation_make(&p, &t.problem, t.step, t.kind, &lobatto[LOBATTO_EIGHT], asked) ||
            !collocation_make(&exact, &t.problem, t.step, t.kind, twelve, asked)) {
            continue;
        }
        const double s = k % 4 == 0 ? 2.0 : 2.0 - random_power(&r, -8.0, -1.0);
        const struct collocation_change got = collocation_change_at(&p, s);
        const struct collocation_change expected = collocation_change_at(&exact, s);
        const double off = collocation_error_near_end(&p, s) + exact.result.interior_error + TIMES * asked;
        CHECK_CLOSE("moved", vec3_norm(vec3_sub(got.moved, expected.moved)), 0.0L, off);
        CHECK_CLOSE("gained", vec3_norm(vec3_sub(got.gained, expected.gained)), 0.0L, off * t.rates.faster);
        strict += off < 0.01 * p.result.interior_error;
    }
    CHECK(strict > 400);
}

/* All along one coordinate axis but the velocity mismatch, of which n takes its part. */
static void straighten(struct trial *t, struct random *r)
{
    struct collocation_problem *p = &t->problem;
    const int axis = random_index(r, 3);
    const double radial = vec3_dot(p->normal, p->rate);
    const struct vec3 n = vec3_make(axis == 0, axis == 1, axis == 2);
    p->normal = n;
    p->rate = vec3_scale(radial, n);
    p->radial = radial;
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
        p->acceleration[i] = vec3_scale(vec3_dot(n, p->acceleration[i]), n);
    }
}

static void a_head_on_step_goes_straight_on(void)
{
    struct random r = {4};
    for (int k = 0; k < 300; ++k) {
        struct trial t = random_trial(&r, (enum collocation_kind)(k % 3), 1.0, k % 2 == 0);
        struct collocation p;
        straighten(&t, &r);
        CHECK(check_trial(&r, &t));
        CHECK(collocation_make(&p, &t.problem, t.step, t.kind, twelve, TOLERANCE * t.distance) &&
              p.local.head_on);
        const struct collocation_change change = collocation_change_at(&p, 1.3);
        CHECK(vec3_is_zero(vec3_cross(change.moved, t.problem.normal)));
        CHECK(vec3_is_zero(vec3_cross(change.gained, t.problem.normal)));
    }
}

/* From what the step itself says: |c'|^2 / 2 + omega2 x^2 / 2 - A.c and what the dashpot takes, for a
 * constant A. */
static void energy_falls_by_what_the_dashpot_takes(void)
{
    struct random r = {5};
    for (int k = 0; k < 600; ++k) {
        struct trial t = random_trial(&r, (enum collocation_kind)(k % 3), 1.0, false);
        struct collocation_problem *from = &t.problem;
        struct collocation p;
        from->acceleration[1] = from->acceleration[2] = vec3_make(0.0, 0.0, 0.0);
        if (!collocation_make(&p, from, t.step, t.kind, twelve, TOLERANCE * t.distance)) {
            continue;
        }
        const double s = k % 5 == 0 ? 2.0 : random_between(&r, 0.0, 2.0);
        const struct collocation_change change = collocation_change_at(&p, s);
        double x[4];
        collocation_deviation(&p, s, x);
        const double twice =
            2.0 * vec3_dot(from->rate, change.gained) + vec3_dot(change.gained, change.gained);
        const double stored = from->omega2 * (x[0] - from->deviation) * (x[0] + from->deviation);
        const double taken = collocation_dissipated(&p, s);
        const double load = vec3_norm(from->acceleration[0]) + vec3_dot(from->rate, from->rate) / t.distance;
        const double force = 2.0 * load + from->omega2 * fabs(from->deviation) +
                             2.0 * t.rates.faster * fabs(vec3_dot(from->rate, from->normal));
        CHECK_CLOSE("balance", 0.5 * (twice + stored) + taken, vec3_dot(from->acceleration[0], change.moved),
                    4.0 * allowed(&t, &p, false) * (force + vec3_norm(from->rate) * t.rates.faster));
        CHECK(from->damping_rate > 0.0 || fabs(taken) <= 4.0 * allowed(&t, &p, false) * force);
    }
}

/* x and three derivatives: with all of them the next place is known to the fourth power of the way, with one
 * wrong not. */
static void check_taylor(const double here[4], const double there[4], double way, double rounding)
{
    const double next = here[0] + way * (here[1] + way / 2.0 * (here[2] + way / 3.0 * here[3]));
    const double next_rate = way * (here[1] + way * (here[2] + way / 2.0 * here[3]));
    const double third = way * way * way * fabs(here[3]);
    CHECK_CLOSE("next", there[0], next, rounding + 0.01 * third);
    CHECK_CLOSE("next rate", way * there[1], next_rate, rounding + 0.01 * third);
}

static void derivatives_are_those_of_x(void)
{
    struct random r = {6};
    for (int k = 0; k < 600; ++k) {
        const struct trial t = random_trial(&r, (enum collocation_kind)(k % 3), 1.0, k % 2 == 0);
        struct collocation p;
        if (!collocation_make(&p, &t.problem, t.step, t.kind, twelve, TOLERANCE * t.distance)) {
            continue;
        }
        const double s = random_between(&r, 0.1, 1.9);
        const double rate = p.half * t.rates.faster;
        const double way = 1e-3 / rate;
        const double size =
            fabs(p.result.slow[0]) + fabs(p.result.slow[1]) + fabs(p.result.y) + fabs(p.result.y_rate) / rate;
        const double rounding = 64.0 * DBL_EPSILON * size;
        double here[4];
        double there[4];
        collocation_averaged_deviation(&p, s, here);
        collocation_averaged_deviation(&p, s + way, there);
        check_taylor(here, there, way, rounding);
        collocation_deviation(&p, s, here);
        collocation_deviation(&p, s + way, there);
        check_taylor(here, there, way, rounding);
        for (int i = 0; i < p.nodes->points; ++i) {
            collocation_deviation(&p, 1.0 + p.nodes->node[i], here);
            collocation_deviation_at_node(&p, i, there);
            double power = 1.0;
            for (int j = 0; j < 4; ++j) {
                CHECK_CLOSE("at node", there[j], here[j], rounding * power);
                power *= rate;
            }
        }
    }
}

int main(void)
{
    CHECK_TEST(a_resolved_step_moves_as_the_reference);
    CHECK_TEST(an_averaged_step_moves_as_the_reference);
    CHECK_TEST(an_overdamped_step_moves_as_the_reference);
    CHECK_TEST(near_its_end_a_resolved_step_is_off_by_less_than_it_says);
    CHECK_TEST(a_head_on_step_goes_straight_on);
    CHECK_TEST(energy_falls_by_what_the_dashpot_takes);
    CHECK_TEST(derivatives_are_those_of_x);
    return check_summary("collocation");
}
