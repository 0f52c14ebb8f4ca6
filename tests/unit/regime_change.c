/* When the regime of a contact changes first, where that has a closed form. */
#include "integrator/prediction.h"

#include <float.h>

#include "check.h"
#include "scene_model.h"

static struct regime_change find(const struct model *m, double horizon)
{
    struct scene_instant at;
    scene_now(&m->state.values, &m->state.motion, &at);
    return next_regime_change(&m->state.values, &m->state.motion, &at, m->state.motion.clock, 0, horizon);
}

/* A fixed cylinder along z of the given radius at the origin, and a free sphere. */
static struct model sphere_and_cylinder(double r_s, double r_d, struct vec3 centre, struct vec3 velocity)
{
    struct model m = scene_model();
    m.state.values.body[SOURCE].radius = r_s;
    m.state.values.body[DESTINATION].radius = r_d;
    scene_start_free(&m, SOURCE, centre, velocity);
    return m;
}

static void check_change(struct model *m, double horizon, long double after, long double tolerance,
                         enum contact_regime regime)
{
    model_prepare(m);
    const struct regime_change next = find(m, horizon);
    CHECK_CLOSE("time of the change", next.after, after, tolerance);
    CHECK(next.regime == regime);
}

static void head_on_the_bodies_touch_when_the_way_is_covered(void)
{
    struct model m = sphere_and_cylinder(0.1, 0.5, vec3_make(2.0, 0.0, 7.0), vec3_make(-1.0, 0.0, 3.0));
    for (double horizon = 1.5; horizon < 1e7; horizon *= 10.0) {
        check_change(&m, horizon, 1.4L, 16.0 * DBL_EPSILON, REGIME_COMPRESSION);
    }
    check_change(&m, 1.3, (long double)INFINITY, 0.0, REGIME_APART);
    /* Thrown away and drawn back: 2 + t - t^2 = 0.6 */
    m.state.values.world.gravity[0] = -2.0;
    scene_put(m.state.values.body[SOURCE].initial_velocity, 1.0, 0.0, 0.0);
    check_change(&m, 100.0, (1.0L + sqrtl(1.0L + 4.0L * 1.4L)) / 2.0L, 32.0 * DBL_EPSILON,
                 REGIME_COMPRESSION);
}

static void a_graze_is_not_missed_and_a_near_miss_is_none(void)
{
    for (double depth = 1e-3; depth > 1e-13; depth /= 10.0) {
        const double y = 0.6 * (1.0 - depth);
        struct model m = sphere_and_cylinder(0.1, 0.5, vec3_make(5.0, y, 0.0), vec3_make(-1.0, 0.0, 0.0));
        /* The half chord sqrt(reach^2 - y^2); the gap's rounding of some 1e-16 m moves it by that / slope. */
        const long double reach = 0.1L + 0.5L;
        const long double half_chord = sqrtl((reach - y) * (reach + y));
        const long double tolerance = 64.0L * DBL_EPSILON * (5.0L + reach / half_chord);
        check_change(&m, 1000.0, 5.0L - half_chord, tolerance, REGIME_COMPRESSION);
        m.state.values.body[SOURCE].center[1] = 0.6 * (1.0 + depth);
        check_change(&m, 1000.0, (long double)INFINITY, 0.0, REGIME_APART);
    }
}

static void a_small_body_is_met_from_a_thousand_kilometres(void)
{
    struct model m = sphere_and_cylinder(1e-3, 1e-3, vec3_make(1e6, 1e-3, 0.0), vec3_make(-1e3, 0.0, 0.0));
    /* Rounding of the position over the speed. */
    const long double half_chord = sqrtl(3.0L) * 1e-3L;
    check_change(&m, 1e6, (1e6L - half_chord) / 1e3L, 4.0 * DBL_EPSILON * 1e6 / 1e3, REGIME_COMPRESSION);
    m.state.values.body[SOURCE].center[1] = 2.1e-3;
    check_change(&m, 1e6, (long double)INFINITY, 0.0, REGIME_APART);
}

static void a_finite_cylinder_is_entered_and_left_at_its_ends(void)
{
    /* Into the solid's cross-section: overlapping as soon as the centre is past the end plane. */
    struct model m = sphere_and_cylinder(0.1, 0.5, vec3_make(0.45, 0.0, 3.0), vec3_make(0.0, 0.0, -2.0));
    m.state.values.body[DESTINATION].finite_length = 1;
    m.state.values.contact[0].location = LOCATION_OUTSIDE;
    check_change(&m, 100.0, 1.25L, 8.0 * DBL_EPSILON, REGIME_COMPRESSION);
    /* Separating between the ends and out at the other; gravity along the axis. */
    scene_put(m.state.values.body[SOURCE].center, 0.45, 0.0, 0.25);
    scene_put(m.state.values.body[SOURCE].initial_velocity, 1.0, 0.0, -2.0);
    m.state.values.contact[0].penalty_factor = 1.0;
    m.state.values.contact[0].viscous_penalty_factor = 1e3;
    m.state.values.world.gravity[0] = -1e-3;
    check_change(&m, 0.1, (long double)INFINITY, 0.0, REGIME_SEPARATING);
    scene_put(m.state.values.body[SOURCE].initial_velocity, 0.125, 0.0, -2.0);
    check_change(&m, 100.0, 0.375L, 8.0 * DBL_EPSILON, REGIME_APART);
    /* In compression it is the integrator's business, except for the end. */
    scene_put(m.state.values.body[SOURCE].initial_velocity, -0.125, 0.0, -2.0);
    m.state.values.world.gravity[2] = -4.0;
    check_change(&m, 100.0, (sqrtl(4.0L + 6.0L) - 2.0L) / 4.0L, 8.0 * DBL_EPSILON, REGIME_APART);
    m.state.values.body[DESTINATION].finite_length = 0;
    check_change(&m, 100.0, (long double)INFINITY, 0.0, REGIME_COMPRESSION);
}

/* On the axis there is no direction across it; the way along it is what it is anywhere else. */
static void a_ball_on_the_axis_enters_the_cylinder_at_its_end(void)
{
    for (int location = LOCATION_OUTSIDE; location <= LOCATION_INSIDE; ++location) {
        struct model m = sphere_and_cylinder(0.1, 0.5, vec3_make(0.0, 0.0, 3.0), vec3_make(0.0, 0.0, -2.0));
        m.state.values.body[DESTINATION].finite_length = 1;
        m.state.values.contact[0].location = location;
        check_change(&m, 100.0, location == LOCATION_OUTSIDE ? 1.25L : (long double)INFINITY,
                     8.0 * DBL_EPSILON, location == LOCATION_OUTSIDE ? REGIME_COMPRESSION : REGIME_APART);
    }
}

static void a_separating_contact_is_compressed_again_where_the_law_is_zero(void)
{
    /* g = -0.3 + t - 2 t^2, which turns below zero: 100 g + 50 g' = 0 where 20 - 100 t - 200 t^2 = 0. */
    struct model m = sphere_and_cylinder(0.1, 0.5, vec3_make(0.3, 0.0, 0.0), vec3_make(1.0, 0.0, 0.0));
    m.state.values.contact[0].location = LOCATION_OUTSIDE;
    m.state.values.contact[0].penalty_factor = 100.0;
    m.state.values.contact[0].viscous_penalty_factor = 50.0;
    m.state.values.world.gravity[0] = -4.0;
    const long double zero = (-100.0L + sqrtl(1e4L + 4.0L * 200.0L * 20.0L)) / 400.0L;
    check_change(&m, 10.0, zero, 64.0 * DBL_EPSILON, REGIME_COMPRESSION);
}

int main(void)
{
    CHECK_TEST(head_on_the_bodies_touch_when_the_way_is_covered);
    CHECK_TEST(a_graze_is_not_missed_and_a_near_miss_is_none);
    CHECK_TEST(a_small_body_is_met_from_a_thousand_kilometres);
    CHECK_TEST(a_finite_cylinder_is_entered_and_left_at_its_ends);
    CHECK_TEST(a_ball_on_the_axis_enters_the_cylinder_at_its_end);
    CHECK_TEST(a_separating_contact_is_compressed_again_where_the_law_is_zero);
    return check_summary("regime_change");
}
