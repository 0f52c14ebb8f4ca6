/* Friction as an unknown: its responses vanish where the law holds; their slopes are their derivatives. */
#include "contact/friction.h"
#include "contact/slopes.h"

#include "check.h"
#include "random.h"

enum { SAMPLES = 400 };

static const double ADMITTANCE = 0.03; /* m/(N s) */
static const double MOBILE = 1e3; /* an admittance with which every friction here changes the slip by v_0 */

static struct friction_law law_of(struct random *random)
{
    return (struct friction_law){.kind = FRICTION_REGULARIZED,
                                 .coefficient = random_between(random, 0.1, 1.0),
                                 .slip_velocity = pow(10.0, random_between(random, -6.0, 0.0)),
                                 .largest = 50.0};
}

static struct vec3 vector_of(struct random *random, double size)
{
    return vec3_make(size * random_between(random, -1.0, 1.0), size * random_between(random, -1.0, 1.0),
                     size * random_between(random, -1.0, 1.0));
}

static struct friction_state state_of(double normal_force, struct vec3 slip)
{
    return (struct friction_state){.normal_force = normal_force, .slip = slip};
}

TEST(the_responses_vanish_where_the_law_holds)
{
    struct random random = {1};
    int rolling = 0;
    for (int i = 0; i < SAMPLES; ++i) {
        const struct friction_law law = law_of(&random);
        const double normal_force = random_between(&random, 0.5, 40.0);
        const struct vec3 slip = vector_of(&random, 3.0 * law.slip_velocity);
        struct vec3 force = friction_force(
            &law, FRICTION_SLIDING, (struct friction_state){.normal_force = normal_force, .slip = slip});
        const bool rolls = friction_rolls(&law, FRICTION_SLIDING, normal_force, force, MOBILE);
        rolling += rolls;
        for (int form = 0; form <= (int)rolls; ++form) {
            const double scale = form ? vec3_norm(slip) : ADMITTANCE * vec3_norm(force);
            const struct friction_missed missed = friction_missed(
                &law, FRICTION_SLIDING, state_of(normal_force, slip), &force, form != 0, ADMITTANCE, NULL);
            CHECK(vec3_norm(missed.velocity) <= 1e-13 * scale);
        }
    }
    CHECK(rolling > SAMPLES / 4 && rolling < SAMPLES);
}

/* The response for changes of force, slip and normal force by a step of each size along a component. */
static struct vec3 missed_at(const struct friction_law *law, double normal_force, struct vec3 slip,
                             struct vec3 force, bool rolls)
{
    return friction_missed(law, FRICTION_SLIDING, state_of(normal_force, slip), &force, rolls, ADMITTANCE,
                           NULL)
        .velocity;
}

static void check_column(const struct vec3 matrix[3], int column, struct vec3 more, struct vec3 less,
                         double step, double size)
{
    for (int i = 0; i < 3; ++i) {
        const double slope = (vec3_get(more, i) - vec3_get(less, i)) / (2.0 * step);
        CHECK(fabs(slope - vec3_get(matrix[i], column)) <= 1e-6 * size);
    }
}

TEST(the_slopes_are_the_derivatives_of_the_responses)
{
    struct random random = {2};
    for (int i = 0; i < SAMPLES; ++i) {
        const struct friction_law law = law_of(&random);
        const double normal_force = random_between(&random, 0.5, 40.0);
        const double limit = law.coefficient * normal_force;
        const bool rolls = i % 2 == 0;
        const struct vec3 slip = vector_of(&random, law.slip_velocity);
        struct vec3 force = vector_of(&random, 0.5 * limit);
        struct friction_slopes r;
        const double steepness = friction_missed(&law, FRICTION_SLIDING, state_of(normal_force, slip), &force,
                                                 rolls, ADMITTANCE, &r)
                                     .steepness;
        const double of_force = rolls ? steepness : ADMITTANCE;
        const double of_slip = rolls ? 1.0 : ADMITTANCE * limit / law.slip_velocity;
        for (int k = 0; k < 3; ++k) {
            struct vec3 step = {0.0, 0.0, 0.0};
            *vec3_part(&step, k) = 1e-4 * limit;
            check_column(r.by_force, k, missed_at(&law, normal_force, slip, vec3_add(force, step), rolls),
                         missed_at(&law, normal_force, slip, vec3_sub(force, step), rolls), 1e-4 * limit,
                         of_force);
            *vec3_part(&step, k) = 1e-4 * law.slip_velocity;
            check_column(r.by_slip, k, missed_at(&law, normal_force, vec3_add(slip, step), force, rolls),
                         missed_at(&law, normal_force, vec3_sub(slip, step), force, rolls),
                         1e-4 * law.slip_velocity, of_slip);
        }
        const double h = 1e-4 * normal_force;
        const struct vec3 column[3] = {
            {.x = r.by_normal_force.x}, {.x = r.by_normal_force.y}, {.x = r.by_normal_force.z}};
        check_column(column, 0, missed_at(&law, normal_force + h, slip, force, rolls),
                     missed_at(&law, normal_force - h, slip, force, rolls), h, of_force);
    }
}

TEST(a_force_beyond_the_limit_is_shortened_and_steep)
{
    const struct friction_law law = {
        .kind = FRICTION_REGULARIZED, .coefficient = 0.5, .slip_velocity = 1e-3, .largest = 1e9};
    struct vec3 force = {30.0, 0.0, 0.0};
    const struct friction_missed r = friction_missed(
        &law, FRICTION_SLIDING, state_of(10.0, vec3_make(0.0, 0.0, 0.0)), &force, true, ADMITTANCE, NULL);
    CHECK(force.x > 0.99 * 5.0 && force.x < 5.0);
    CHECK(r.steepness > 500.0 * law.slip_velocity / 5.0);
    const struct vec3 none = {0.0, 0.0, 0.0};
    CHECK(!friction_rolls(&law, FRICTION_SLIDING, 10.0, force, MOBILE));
    CHECK(friction_rolls(&law, FRICTION_SLIDING, 10.0, none, MOBILE));
    CHECK(!friction_rolls(&law, FRICTION_SLIDING, 10.0, none, 0.9 * law.slip_velocity / 5.0));
    CHECK(!friction_rolls(&law, FRICTION_SLIDING, 0.0, none, MOBILE));
}

/* The drive of a spring is another form of the law: by the slip it has the derivative of the spring's
 * rate. */
TEST(the_drive_of_a_spring_is_that_of_its_rate)
{
    struct random random = {3};
    for (int i = 0; i < SAMPLES; ++i) {
        const bool damped = i % 2 == 0;
        const enum friction_regime regime = i % 4 < 2 ? FRICTION_STICKING : FRICTION_SLIDING;
        const struct friction_law law = {.kind = FRICTION_ELASTIC,
                                         .coefficient = 0.5,
                                         .static_coefficient = 0.6,
                                         .largest = 1e9,
                                         .stiffness = 1e4,
                                         .damping = damped ? 30.0 : 0.0};
        const struct friction_state at = {.normal_force = random_between(&random, 0.5, 40.0),
                                          .slip = vector_of(&random, 0.3),
                                          .spring = vector_of(&random, 1e-3)};
        const struct friction_spring_drive drive = friction_spring_drive_of(&law, regime, at);
        CHECK(drive.is_force == (damped && regime == FRICTION_SLIDING));
        const struct friction_state pulled = {.normal_force = -at.normal_force}; /* no load, and no limit */
        CHECK(friction_stick_event(&law, FRICTION_STICKING, pulled, 0.0) == 0.0);
        for (int k = 0; k < 9 && !drive.is_force; ++k) {
            const double units = vec3_get(drive.unit, k / 3) * vec3_get(drive.unit, k % 3);
            const double entry = (drive.along - drive.across) * units + (k / 3 == k % 3 ? drive.across : 0.0);
            struct friction_path path = {JET_TERMS, {at.normal_force}, {0.0}, {at.slip}, {at.spring}, 0.0};
            *vec3_part(&path.slip[1], k % 3) = 1.0;
            const struct vec3 change = friction_spring_rate_change(&law, regime, &path);
            CHECK(fabs(entry - vec3_get(change, k / 3)) <= 1e-12 * fmax(drive.along, drive.across));
        }
    }
}
