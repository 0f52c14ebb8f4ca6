/* The corrections at the end of a contact phase: exact along the normal, and nothing else is touched. */
#include "scene/ode.h"

#include <float.h>

#include "check.h"
#include "random.h"
#include "scene_model.h"

static double balance_of(const struct model *m)
{
    struct scene_instant at;
    scene_now(&m->state.values, &m->state.motion, &at);
    return projection_balance(&m->state.values, &m->state.motion, &at);
}

static struct vec3 momentum(const struct model *m)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        sum = vec3_axpy(sum, m->state.values.body[i].mass, m->state.motion.body[i].velocity);
    }
    return sum;
}

static struct vec3 mass_moment(const struct model *m)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        sum = vec3_axpy(sum, m->state.values.body[i].mass, m->state.motion.body[i].moved);
    }
    return sum;
}

static struct contact_geometry geometry(const struct model *m)
{
    struct scene_instant at;
    scene_now(&m->state.values, &m->state.motion, &at);
    return at.geometry[0];
}

/* So much [m/s] that only the size of the correction counts. */
static const double ANY_ERROR = 1.0;

/* An undamped contact in mid-phase, inside or outside, about to part: the gap off zero by little, the balance
 * set. A prescribed destination rests. */
static struct model random_parting(struct random *r, enum motion_kind destination)
{
    struct model m = scene_model();
    struct scene_values *v = &m.state.values;
    const bool inside = random_index(r, 2) == 0;
    const struct vec3 axis = random_direction(r);
    struct vec3 across = random_vector(r, 1.0);
    across = vec3_axpy(across, -vec3_dot(across, axis), axis);
    const double reach = inside ? 0.4 : 0.6;
    const double off = random_power(r, -12.0, -6.0);
    const double distance = inside ? reach + off : reach - off;
    const struct vec3 n = vec3_scale(-1.0 / vec3_norm(across), across);
    scene_start_free(&m, SOURCE, vec3_scale(-distance, n), vec3_scale(inside ? 1.0 : -1.0, n));
    scene_start_free(&m, DESTINATION, vec3_make(0.0, 0.0, 0.0), vec3_scale(0.25, random_vector(r, 1.0)));
    v->body[DESTINATION].motion = (int32_t)destination;
    scene_put_vector(v->body[DESTINATION].axis, axis);
    v->body[SOURCE].mass = random_power(r, -1.0, 1.0);
    v->body[DESTINATION].mass = random_power(r, -1.0, 1.0);
    v->contact[0].location = inside ? LOCATION_INSIDE : LOCATION_OUTSIDE;
    v->contact[0].method = METHOD_PENALTY;
    v->contact[0].penalty_factor = 1000.0;
    scene_put_vector(v->world.gravity, random_vector(r, 10.0));
    model_prepare(&m);
    m.state.motion.phase_energy = balance_of(&m);
    return m;
}

static enum motion_kind random_motion_kind(struct random *r)
{
    return (enum motion_kind)(MOTION_FIXED + random_index(r, 3));
}

static void closing_the_gap_leaves_it_zero_and_the_centre_of_mass_in_place(void)
{
    struct random r = {91};
    for (int n = 0; n < 2000; ++n) {
        const enum motion_kind motion = random_motion_kind(&r);
        struct model m = random_parting(&r, motion);
        struct scene_state *q = &m.state.motion;
        const struct scene_state before = *q;
        const struct contact_geometry start = geometry(&m);
        CHECK(start.gap < 0.0);
        projection_close_gap(&m.state.values, q, 0);
        CHECK_CLOSE("g", geometry(&m).gap, 0.0, 4.0 * DBL_EPSILON);
        const struct vec3 moved = vec3_sub(q->body[SOURCE].moved, q->body[DESTINATION].moved);
        CHECK_CLOSE("moved along n only", vec3_norm(moved), fabs(start.gap), 8.0 * DBL_EPSILON);
        for (int i = 0; i < SCENE_BODIES; ++i) {
            CHECK(memcmp(&q->body[i].velocity, &before.body[i].velocity, sizeof(struct vec3)) == 0);
        }
        if (motion == MOTION_FREE) {
            CHECK_CLOSE("centre of mass", vec3_norm(mass_moment(&m)), 0.0,
                        4.0 * DBL_EPSILON * fabs(start.gap) * 20.0);
        } else {
            CHECK_CLOSE("body that is not free", vec3_norm(q->body[DESTINATION].moved), 0.0, 0.0);
        }
    }
}

static void check_restored(const struct model *m, const struct scene_state *before, enum motion_kind motion,
                           double scale)
{
    const struct scene_state *q = &m->state.motion;
    CHECK_CLOSE("balance", balance_of(m), q->phase_energy, 32.0 * DBL_EPSILON * scale);
    const struct vec3 n = geometry(m).normal;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct vec3 change = vec3_sub(q->body[i].velocity, before->body[i].velocity);
        const struct vec3 across = vec3_axpy(change, -vec3_dot(change, n), n);
        CHECK_CLOSE("change across the normal", vec3_norm(across), 0.0, 8.0 * DBL_EPSILON);
        CHECK(memcmp(&q->body[i].moved, &before->body[i].moved, sizeof(struct vec3)) == 0);
    }
    const double mass = m->state.values.body[SOURCE].mass;
    const struct vec3 kick = vec3_sub(q->body[SOURCE].velocity, before->body[SOURCE].velocity);
    const struct vec3 booked = vec3_axpy(q->contact[0].physics.impulse, -mass, kick);
    CHECK_CLOSE("impulse on the source", vec3_norm(booked), 0.0, 16.0 * DBL_EPSILON * mass);
    if (motion != MOTION_FREE) {
        CHECK(memcmp(&q->body[DESTINATION].velocity, &before->body[DESTINATION].velocity,
                     sizeof(struct vec3)) == 0);
    }
    CHECK_CLOSE("work of whatever moves the destination", q->external_work, before->external_work, 0.0);
}

static void the_energy_is_restored_and_momentum_kept(void)
{
    struct random r = {92};
    for (int n = 0; n < 5000; ++n) {
        const enum motion_kind motion = random_motion_kind(&r);
        struct model m = random_parting(&r, motion);
        struct scene_state *q = &m.state.motion;
        const struct contact_geometry start = geometry(&m);
        const double by_both = 1.0 / m.state.values.body[SOURCE].mass +
                               (motion == MOTION_FREE ? 1.0 / m.state.values.body[DESTINATION].mass : 0.0);
        const double normal_energy = 0.5 * start.gap_rate * start.gap_rate / by_both;
        q->phase_energy += random_between(&r, -0.99e-3, 0.99e-3) * normal_energy;
        const struct scene_state before = *q;
        const struct vec3 momentum_before = momentum(&m);
        projection_restore_energy(&m.state.values, q, 0, ANY_ERROR);
        check_restored(&m, &before, motion,
                       1.0 + m.state.values.body[SOURCE].mass + m.state.values.body[DESTINATION].mass);
        if (motion == MOTION_FREE) {
            CHECK_CLOSE("momentum", vec3_norm(vec3_sub(momentum(&m), momentum_before)), 0.0,
                        16.0 * DBL_EPSILON *
                            (m.state.values.body[SOURCE].mass + m.state.values.body[DESTINATION].mass));
        }
    }
}

/* What the error of an integrator does not explain is not put right. */
static void large_errors_and_damped_contacts_are_left_alone(void)
{
    struct random r = {93};
    for (int n = 0; n < 500; ++n) {
        struct model m = random_parting(&r, MOTION_FIXED);
        struct scene_state *q = &m.state.motion;
        const double rate = geometry(&m).gap_rate;
        const double normal_energy = 0.5 * m.state.values.body[SOURCE].mass * rate * rate;
        const double balance = q->phase_energy;
        q->phase_energy = balance + random_sign(&r) * 1.1e-3 * normal_energy;
        struct scene_state before = *q;
        projection_restore_energy(&m.state.values, q, 0, ANY_ERROR);
        CHECK(memcmp(&before, q, sizeof before) == 0);
        q->phase_energy = balance + 0.5e-3 * normal_energy;
        m.state.values.contact[0].method = METHOD_PENALTY_DYNAMIC;
        q->contact[0].parameters.factors.c = 1e-3;
        before = *q;
        projection_restore_energy(&m.state.values, q, 0, ANY_ERROR);
        CHECK(memcmp(&before, q, sizeof before) == 0);
    }
}

static void check_left_alone(struct model *m, double tolerated)
{
    const struct scene_state before = m->state.motion;
    projection_restore_energy(&m->state.values, &m->state.motion, 0, tolerated);
    CHECK(memcmp(&before, &m->state.motion, sizeof before) == 0);
}

/* An integrator's error is beyond rounding and within what its tolerance makes of some thousand steps. */
static void what_is_no_error_of_the_integrator_is_left_alone(void)
{
    struct random r = {94};
    for (int n = 0; n < 500; ++n) {
        struct model m = random_parting(&r, random_motion_kind(&r));
        struct scene_state *q = &m.state.motion;
        const double rate = geometry(&m).gap_rate;
        const double by_both = scene_inverse_mass(&m.state.values, 0);
        const double balance = q->phase_energy;
        q->phase_energy = balance + random_sign(&r) * 0.5e-3 * rate * rate / by_both * 0.5;
        check_left_alone(&m, 1e-9 * fabs(rate));
        q->phase_energy = balance + random_sign(&r) * 8.0 * DBL_EPSILON * fabs(balance);
        check_left_alone(&m, ANY_ERROR);
    }
}

/* What drives a body does work that is integrated as well; and inputs may disagree. */
static void driven_bodies_are_left_alone(void)
{
    struct random r = {95};
    for (int n = 0; n < 500; ++n) {
        struct model m = random_parting(&r, MOTION_PRESCRIBED);
        struct model pushed = random_parting(&r, MOTION_FREE);
        const struct vec3 drive = random_vector(&r, 1.0);
        m.state.motion.phase_energy += 1e-6;
        m.state.motion.path[DESTINATION].velocity[0] = drive;
        check_left_alone(&m, ANY_ERROR);
        m.state.motion.path[DESTINATION].velocity[0] = vec3_make(0.0, 0.0, 0.0);
        m.state.motion.path[DESTINATION].displacement[1] = drive;
        check_left_alone(&m, ANY_ERROR);
        pushed.state.motion.phase_energy += 1e-6;
        pushed.state.motion.path[SOURCE].force[0] = drive;
        check_left_alone(&pushed, ANY_ERROR);
    }
}

int main(void)
{
    CHECK_TEST(closing_the_gap_leaves_it_zero_and_the_centre_of_mass_in_place);
    CHECK_TEST(the_energy_is_restored_and_momentum_kept);
    CHECK_TEST(large_errors_and_damped_contacts_are_left_alone);
    CHECK_TEST(what_is_no_error_of_the_integrator_is_left_alone);
    CHECK_TEST(driven_bodies_are_left_alone);
    return check_summary("projection");
}
