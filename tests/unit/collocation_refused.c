/* What the iteration of a collocated step promises: to converge as far as asked, and to refuse what it cannot
 * do. */
#include "check.h"
#include "collocation_problems.h"

static const struct lobatto *const twelve = &lobatto[LOBATTO_TWELVE];

/* Ten times what is asked: what is left is estimated from two sweeps. */
static void a_step_is_converged_to_what_is_asked(void)
{
    struct random r = {1};
    for (int k = 0; k < 3000; ++k) {
        const struct trial t = random_trial(&r, (enum collocation_kind)(k % 3), k % 2, k % 4 < 2);
        const double asked = random_power(&r, -13.0, -5.0) * t.distance;
        struct collocation p;
        struct collocation best;
        if (!collocation_make(&best, &t.problem, t.step, t.kind, twelve, 1e-15 * t.distance)) {
            continue;
        }
        CHECK(collocation_make(&p, &t.problem, t.step, t.kind, twelve, asked));
        const struct collocation_change change = collocation_change_at(&p, 2.0);
        const struct collocation_change target = collocation_change_at(&best, 2.0);
        CHECK_CLOSE("moved", vec3_norm(vec3_sub(change.moved, target.moved)), 0.0L, 10.0 * asked);
    }
}

static void a_step_that_turns_too_far_is_refused(void)
{
    struct random r = {2};
    for (int k = 0; k < 300; ++k) {
        const struct trial t = random_trial(&r, (enum collocation_kind)(k % 3), 1.0, k % 2 == 0);
        struct collocation p;
        CHECK(!collocation_make(&p, &t.problem, 100.0 / t.turning, t.kind, twelve, 1e-12 * t.distance));
    }
}

/* Head-on and fast enough for the centre, where the direction turns round. */
static void a_step_through_the_centre_is_refused(void)
{
    struct random r = {3};
    for (int k = 0; k < 300; ++k) {
        const double rate = random_power(&r, -1.0, 5.0);
        struct collocation_problem from = {.normal = {0.0, -1.0, 0.0}, .reach = random_power(&r, -3.0, 1.0)};
        struct collocation p;
        from.omega2 = rate * rate;
        from.damping_rate = k % 2 == 0 ? 0.0 : 0.2 * rate;
        from.radial = -1.5 * rate * from.reach;
        from.rate = vec3_scale(from.radial, from.normal);
        CHECK(!collocation_make(&p, &from, 3.5 / rate, COLLOCATION_RESOLVED, twelve, 1e-12 * from.reach));
        from.radial *= 0.1;
        from.rate = vec3_scale(0.1, from.rate);
        CHECK(collocation_make(&p, &from, 3.5 / rate, COLLOCATION_RESOLVED, twelve, 1e-12 * from.reach));
    }
}

static void check_refused(struct trial *t, double *value, const char *name)
{
    struct collocation p;
    const double kept = *value;
    *value = (double)NAN;
    const bool made = collocation_make(&p, &t->problem, t->step, t->kind, twelve, 1e-12 * t->distance);
    check_that(!made, name, __FILE__, __LINE__);
    *value = kept;
}

static void nan_is_refused_wherever_it_comes_in(void)
{
    struct random r = {4};
    for (int k = 0; k < 300; ++k) {
        struct trial t = random_trial(&r, (enum collocation_kind)(k % 3), 1.0, true);
        struct collocation_problem *p = &t.problem;
        if (k % 2 == 0) { /* straight, where nothing but x depends on it */
            p->normal = vec3_make(1.0, 0.0, 0.0);
            p->rate = vec3_make(p->rate.x, 0.0, 0.0);
            p->radial = p->rate.x;
            for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
                p->acceleration[i] = vec3_make(p->acceleration[i].x, 0.0, 0.0);
            }
        }
        check_refused(&t, &p->normal.x, "NaN in the normal");
        check_refused(&t, &p->rate.x, "NaN in the rate");
        check_refused(&t, &p->rate.z, "NaN in the rate");
        check_refused(&t, &p->reach, "NaN in the reach");
        check_refused(&t, &p->deviation, "NaN in the excess");
        check_refused(&t, &p->omega2, "NaN in the omega2");
        check_refused(&t, &p->damping_rate, "NaN in the damping_rate");
        check_refused(&t, &p->acceleration[0].x, "NaN in the pull");
        check_refused(&t, &p->acceleration[2].y, "NaN in the pull");
        check_refused(&t, &p->mismatch[0].x, "NaN in the lead");
        check_refused(&t, &p->mismatch[3].z, "NaN in the lead");
        check_refused(&t, &t.step, "a step of NaN");
    }
}

int main(void)
{
    CHECK_TEST(a_step_is_converged_to_what_is_asked);
    CHECK_TEST(a_step_that_turns_too_far_is_refused);
    CHECK_TEST(a_step_through_the_centre_is_refused);
    CHECK_TEST(nan_is_refused_wherever_it_comes_in);
    return check_summary("collocation_refused");
}
