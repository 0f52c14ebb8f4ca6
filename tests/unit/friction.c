/* Laws of friction: known numbers, and how their regimes meet. */
#include "contact/friction.h"

#include "check.h"
#include "random.h"

enum { CASES = 400 };

static struct friction_law random_law(struct random *r, enum friction kind)
{
    struct friction_law law = {.kind = kind};
    law.coefficient = random_between(r, 0.05, 1.5);
    law.static_coefficient = law.coefficient * random_between(r, 1.0, 2.0);
    law.slip_velocity = random_between(r, 1e-3, 1.0);
    law.largest = random_between(r, 1.0, 20.0);
    law.stiffness = random_between(r, 10.0, 1e3);
    law.damping = random_between(r, 0.0, 1.0) < 0.5 ? 0.0 : random_between(r, 0.1, 10.0);
    return law;
}

static struct friction_state random_state(struct random *r)
{
    return (struct friction_state){random_between(r, 0.5, 30.0), random_vector(r, 2.0),
                                   random_vector(r, 0.1)};
}

/* Where sticking gives way to sliding under mu_s = mu, the force does not jump; with a dashpot neither does
 * the spring's rate. The events of both regimes are zero there. */
static void breaking_away_is_continuous(void)
{
    struct random r = {13};
    for (int i = 0; i < CASES; ++i) {
        struct friction_law law = random_law(&r, FRICTION_ELASTIC);
        law.static_coefficient = law.coefficient;
        struct friction_state at = random_state(&r);
        const struct vec3 carried = vec3_scale(-1.0, friction_force(&law, FRICTION_STICKING, at));
        at.normal_force = vec3_norm(carried) / law.coefficient;
        law.largest = 2.0 * vec3_norm(carried);
        const enum friction_regime after = friction_sliding_regime(&law, at.normal_force);
        CHECK(after == FRICTION_SLIDING);
        const struct vec3 jump = vec3_add(friction_force(&law, after, at), carried);
        const double size = vec3_norm(carried);
        CHECK_CLOSE("jump", vec3_norm(jump), 0.0L, 1e-14L * size);
        CHECK_CLOSE("stick event", friction_stick_event(&law, FRICTION_STICKING, at, 0.0), 0.0L,
                    1e-14L * size);
        if (law.damping > 0.0) {
            CHECK_CLOSE("stick event", friction_stick_event(&law, after, at, 0.0), 0.0L, 1e-14L * size);
            const struct vec3 rate = friction_spring_rate(&law, after, at);
            CHECK_CLOSE("jump of the rate", vec3_norm(vec3_sub(rate, at.slip)), 0.0L,
                        1e-13L * size / law.damping);
        } else {
            CHECK_CLOSE("stored energy", friction_stored_energy(&law, after, at),
                        0.5 * size * size / law.stiffness, 1e-14L * size * size / law.stiffness);
        }
    }
}

/* Numbers worked out by hand. */
static void known_numbers(void)
{
    const struct friction_law smooth = {
        .kind = FRICTION_REGULARIZED, .coefficient = 0.3, .slip_velocity = 0.1, .largest = 1e300};
    const struct friction_state slow = {10.0, {0.1, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    CHECK_CLOSE("F_t", friction_force(&smooth, FRICTION_SLIDING, slow).x, -1.896361676485673029L, 1e-15L);
    const struct friction_state still = {10.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    CHECK_CLOSE("slope at rest", friction_force_slopes(&smooth, FRICTION_SLIDING, still).by_slip[1][1],
                -30.0L, 1e-14L);
    /* a spring of 3-4-5: F* = (3, 4, 0) N under L = 2.5 N */
    const struct friction_law hard = {.kind = FRICTION_ELASTIC,
                                      .coefficient = 0.25,
                                      .static_coefficient = 0.5,
                                      .largest = 1e300,
                                      .stiffness = 100.0};
    const struct friction_state pulled = {10.0, {1.0, 0.0, 0.0}, {0.03, 0.04, 0.0}};
    CHECK_CLOSE("F_t", friction_force(&hard, FRICTION_STICKING, pulled).y, -4.0L, 1e-15L);
    CHECK_CLOSE("F_t", friction_force(&hard, FRICTION_SLIDING, pulled).y, -2.0L, 1e-15L);
    CHECK_CLOSE("stored energy", friction_stored_energy(&hard, FRICTION_STICKING, pulled), 0.125L, 1e-16L);
    CHECK_CLOSE("stored energy", friction_stored_energy(&hard, FRICTION_SLIDING, pulled), 0.03125L, 1e-16L);
    CHECK_CLOSE("stick event", friction_stick_event(&hard, FRICTION_STICKING, pulled, 0.0), 0.0L, 1e-15L);
    /* v_t . u = 0.6 m/s; L' / k_t = 0.25 * 40 / 100 m/s */
    CHECK_CLOSE("stick event", friction_stick_event(&hard, FRICTION_SLIDING, pulled, 40.0), 0.5L, 1e-15L);
}

/* As contact begins the spring must not outgrow the limit: k_t |v_t| <= mu_s F_n' with F_n = 0. */
static void onset_sticks_where_that_persists(void)
{
    struct friction_law law = {.kind = FRICTION_ELASTIC,
                               .coefficient = 0.2,
                               .static_coefficient = 0.4,
                               .largest = 1e300,
                               .stiffness = 100.0};
    const struct vec3 slip = {0.0, 2.0, 0.0};
    CHECK(friction_onset_regime(&law, 0.0, 501.0, slip) == FRICTION_STICKING);
    CHECK(friction_onset_regime(&law, 0.0, 499.0, slip) == FRICTION_SLIDING);
    CHECK(friction_onset_regime(&law, 1.0, -9.0, slip) == FRICTION_STICKING);
    law.damping = 0.1; /* F* = 0.2 N at once, under a limit of 0.4 F_n */
    CHECK(friction_onset_regime(&law, 0.0, 501.0, slip) == FRICTION_SLIDING);
    CHECK(friction_onset_regime(&law, 0.6, 0.0, slip) == FRICTION_STICKING);
    CHECK(friction_onset_regime(&law, 0.4, 0.0, slip) == FRICTION_SLIDING);
    law.largest = 0.05;
    CHECK(friction_onset_regime(&law, 0.4, 0.0, slip) == FRICTION_CAPPED);
}

/* The caps at F_max and F_n = 0 are passed where their events are zero, from both sides. */
static void regimes_of_sliding_meet(void)
{
    struct random r = {14};
    for (int i = 0; i < CASES; ++i) {
        const struct friction_law law = random_law(&r, i % 2 == 0 ? FRICTION_ELASTIC : FRICTION_REGULARIZED);
        struct friction_state at = random_state(&r);
        at.normal_force = law.largest / law.coefficient;
        const struct vec3 below = friction_force(&law, FRICTION_SLIDING, at);
        const struct vec3 above = friction_force(&law, FRICTION_CAPPED, at);
        CHECK_CLOSE("jump", vec3_norm(vec3_sub(below, above)), 0.0L, 1e-14L * law.largest);
        CHECK_CLOSE("cap event", friction_cap_event(&law, FRICTION_SLIDING, at.normal_force), 0.0L,
                    1e-14L * law.largest);
        CHECK(friction_cap_event(&law, FRICTION_CAPPED, 1.01 * at.normal_force) > 0.0);
        CHECK(friction_cap_event(&law, FRICTION_SLIDING, 0.99 * at.normal_force) > 0.0);
        at.normal_force = 0.0;
        CHECK(vec3_norm(friction_force(&law, FRICTION_SLIDING, at)) == 0.0);
        CHECK(friction_sliding_regime(&law, 0.0) == FRICTION_LIFTED);
        CHECK(friction_lift_event(&law, FRICTION_LIFTED, -1.0) > 0.0);
    }
}

int main(void)
{
    CHECK_TEST(breaking_away_is_continuous);
    CHECK_TEST(known_numbers);
    CHECK_TEST(onset_sticks_where_that_persists);
    CHECK_TEST(regimes_of_sliding_meet);
    return check_summary("friction");
}
