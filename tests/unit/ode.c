/* The scene as differential equations: layout, Jacobian, event functions, without any integrator. */
#include "scene/ode.h"

#include <float.h>

#include "check.h"
#include "random.h"
#include "scene/present.h"
#include "scene_model.h"

enum { MOST_STATES = 6 * SCENE_BODIES + 3 * SCENE_CONTACTS + 2 };

/* A sphere in, on or off a cylinder, overlapping by 1 cm and moving; the destination free or prescribed. */
static struct model overlapping(struct random *r)
{
    struct model m = scene_model();
    struct scene_values *v = &m.state.values;
    v->body[SOURCE].radius = 0.1;
    v->body[DESTINATION].radius = 0.5;
    v->contact[0].method = METHOD_PENALTY_DYNAMIC;
    v->contact[0].penalty_factor = 1e3;
    v->contact[0].viscous_penalty_factor = 20.0;
    v->contact[0].dashpot = DASHPOT_UNCLAMPED;
    const double distance = random_index(r, 2) == 0 ? 0.41 : 0.59;
    const struct vec3 axis = {0.0, 0.0, 1.0};
    const struct vec3 across = vec3_make(random_between(r, 0.3, 1.0), random_between(r, 0.3, 1.0), 0.0);
    scene_put_vector(v->body[DESTINATION].axis, axis);
    v->contact[0].location = distance < 0.5 ? LOCATION_INSIDE : LOCATION_OUTSIDE;
    scene_start_free(&m, SOURCE, vec3_scale(distance / vec3_norm(across), across), random_vector(r, 1.0));
    scene_start_free(&m, DESTINATION, vec3_make(0.0, 0.0, 0.0), random_vector(r, 1.0));
    scene_put_vector(v->body[SOURCE].external_force, random_vector(r, 1.0));
    if (random_index(r, 2) == 0) {
        v->body[DESTINATION].motion = MOTION_PRESCRIBED;
        scene_put_vector(v->body[DESTINATION].prescribed_velocity, random_vector(r, 1.0));
    }
    model_prepare(&m);
    return m;
}

static struct scene_ode begin(const struct model *m)
{
    struct scene_ode ode = {.values = &m->state.values, .state = &m->state.motion};
    struct scene_instant at;
    scene_now(ode.values, ode.state, &at);
    ode_begin(&ode, &at, 1e-9, 1e-12);
    return ode;
}

static void the_jacobian_is_the_slope_of_the_rates(void)
{
    struct random r = {51};
    const double h = 1e-5;
    for (int i = 0; i < 500; ++i) {
        const struct model m = overlapping(&r);
        const struct scene_ode ode = begin(&m);
        const int size = ode_size(ode.values);
        double y[MOST_STATES], up[MOST_STATES], down[MOST_STATES], columns[MOST_STATES * MOST_STATES];
        CHECK(size <= MOST_STATES && m.state.motion.contact[0].regime == REGIME_COMPRESSION);
        ode_pack(&ode, y);
        ode_jacobian(&ode, 0.0, y, columns);
        for (int j = 0; j < size; ++j) {
            const double here = y[j];
            y[j] = here + h;
            ode_rates(&ode, 0.0, y, up);
            y[j] = here - h;
            ode_rates(&ode, 0.0, y, down);
            y[j] = here;
            for (int k = 0; k < size; ++k) {
                /* h^2 / 6 times a third derivative of p_n g or p_nv g'^2 of 1e3 / 0.41^2 at most, and
                 * rounding */
                CHECK_CLOSE("slope", columns[j * size + k], (up[k] - down[k]) / (2.0 * h), 1e-5);
            }
        }
    }
}

static void unpacking_gives_back_what_was_packed(void)
{
    struct random r = {52};
    for (int i = 0; i < 200; ++i) {
        const struct model m = overlapping(&r);
        const struct scene_ode ode = begin(&m);
        double y[MOST_STATES], again[MOST_STATES];
        ode_pack(&ode, y);
        for (int k = 0; k < ode_size(ode.values); ++k) {
            y[k] = random_between(&r, -1.0, 1.0);
        }
        struct scene_state q = m.state.motion;
        ode_unpack(ode.values, &q, y);
        const struct scene_ode other = {.values = ode.values, .state = &q};
        ode_pack(&other, again);
        for (int k = 0; k < ode_size(ode.values); ++k) {
            CHECK(again[k] == y[k]);
        }
        CHECK(q.dissipated == y[ode_dissipated(ode.values)]);
        CHECK(q.contact[0].physics.impulse.x == y[ode_impulse(ode.values, 0)]);
        CHECK(q.body[SOURCE].velocity.z == y[ode_body(ode.values, SOURCE) + 5]);
    }
}

static void a_phase_begins_with_positive_event_functions_that_end_it(void)
{
    struct random r = {53};
    for (int i = 0; i < 200; ++i) {
        const struct model m = overlapping(&r);
        const struct scene_ode ode = begin(&m);
        double y[MOST_STATES], events[ODE_EVENTS];
        ode_pack(&ode, y);
        ode_events(&ode, 0.0, y, events);
        CHECK(events[0] > 0.0 && events[1] > 0.0);
        CHECK_CLOSE("-g", events[0], 0.01, 1e-12);
        CHECK(ode_regime_after(ode.values, ode.state, 0, 0) == REGIME_APART);
    }
}

static void the_three_parts_of_a_vector_share_their_size(void)
{
    struct random r = {54};
    const struct model m = overlapping(&r);
    const struct scene_ode ode = begin(&m);
    double y[MOST_STATES], sizes[MOST_STATES];
    ode_pack(&ode, y);
    ode_nominal(&ode, y, sizes);
    const int speed = ode_body(ode.values, SOURCE) + 3;
    CHECK_CLOSE("|v|", sizes[speed], vec3_norm(m.state.motion.body[SOURCE].velocity), 0.0);
    CHECK(sizes[speed] == sizes[speed + 1] && sizes[speed] == sizes[speed + 2]);
    const int impulse = ode_impulse(ode.values, 0);
    CHECK(sizes[impulse] == ode.momentum_scale && ode.momentum_scale > 0.0);
    CHECK(sizes[ode_dissipated(ode.values)] == ode.energy_scale && ode.energy_scale > 0.0);
}

/* Of bodies at d = 0: the direction of motion, at rest that of the acceleration, else the one held. */
static void the_escape_direction_is_that_of_motion_then_of_acceleration(void)
{
    const struct contact_shape shape = {.axis = {0.0, 0.0, 1.0}, .destination = SHAPE_CYLINDER, .side = 1};
    const struct vec3 none = {0.0, 0.0, 0.0}, held = {0.0, -1.0, 0.0};
    const struct vec3 along_x = {2.0, 0.0, 5.0}, along_y = {0.0, 3.0, 0.0}, axial = {0.0, 0.0, 1.0};
    CHECK(singularity_escape(&shape, along_x, along_y, held).x == 1.0);
    CHECK(singularity_escape(&shape, axial, along_y, held).y == 1.0);
    CHECK(singularity_escape(&shape, none, none, held).y == -1.0);
}

int main(void)
{
    CHECK_TEST(the_jacobian_is_the_slope_of_the_rates);
    CHECK_TEST(unpacking_gives_back_what_was_packed);
    CHECK_TEST(a_phase_begins_with_positive_event_functions_that_end_it);
    CHECK_TEST(the_three_parts_of_a_vector_share_their_size);
    CHECK_TEST(the_escape_direction_is_that_of_motion_then_of_acceleration);
    return check_summary("ode");
}
