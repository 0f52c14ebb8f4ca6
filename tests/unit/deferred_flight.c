/*
 * Deferred flight (flight/flight.h): most steps of a flight move the clock alone. Whoever takes the long way
 * every time, or looks after every step, finds the same digits in every variable.
 */
#include <string.h>

#include "check.h"
#include "random.h"
#include "scene_model.h"

enum { STEPS = 400 };

static const double STEP = 1e-3;

static const struct variable *named(const char *name)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        if (strcmp(scene_variables[i].name, name) == 0) {
            return &scene_variables[i];
        }
    }
    printf("no variable %s\n", name);
    exit(2);
}

static struct model *created(void)
{
    const struct model_host host = {.allocate = scene_allocate, .release = free};
    struct model *m = model_create(&host);
    if (!m) {
        exit(2);
    }
    return m;
}

/* A sphere near a cylinder, about to fly, bounce or roll; the cylinder is fixed, prescribed or free. */
static struct model *random_start(struct random *r)
{
    struct model *m = created();
    struct scene_values *v = &m->state.values;
    const bool inside = random_index(r, 2) == 0;
    scene_start_free(m, SOURCE, vec3_scale(inside ? 0.2 : 0.7, random_direction(r)), random_vector(r, 3.0));
    scene_put_vector(v->world.gravity, random_vector(r, 10.0));
    scene_put_vector(v->body[DESTINATION].axis, random_direction(r));
    scene_put_vector(v->body[DESTINATION].prescribed_velocity, random_vector(r, 1.0));
    scene_put_vector(v->body[DESTINATION].initial_velocity, random_vector(r, 1.0));
    v->body[DESTINATION].finite_length = random_index(r, 2);
    v->body[DESTINATION].motion =
        (int32_t[]){MOTION_FIXED, MOTION_PRESCRIBED, MOTION_FREE}[random_index(r, 3)];
    v->contact[0].location = inside ? LOCATION_INSIDE : LOCATION_OUTSIDE;
    v->contact[0].dashpot = (int32_t[]){DASHPOT_NON_ADHESIVE, DASHPOT_UNCLAMPED}[random_index(r, 2)];
    v->body[DESTINATION].ends =
        !inside && v->body[DESTINATION].finite_length && random_index(r, 2) ? ENDS_CAPPED : ENDS_OPEN;
    v->world.solver_method = SOLVER_METHOD_EVENT_DRIVEN;
    CHECK(model_exit_initialization(m) == MODEL_OK);
    return m;
}

enum manner { AS_IT_COMES, THE_LONG_WAY, LOOKING };

/* How many of the steps were deferred. */
static int run(struct model *m, enum manner manner, double push)
{
    int deferred = 0;
    for (int i = 1; i <= STEPS; ++i) {
        if (manner == THE_LONG_WAY) {
            m->state.motion.deferrable_clock = 0.0;
        }
        if (i == STEPS / 2 && push != 0.0) {
            model_set(m, named("source.external_force[2]"), &push);
        }
        CHECK(scene_step(m, i * STEP) == MODEL_OK);
        deferred += m->state.motion.deferred;
        if (manner == LOOKING) {
            (void)scene_read(m, named(i % 2 == 0 ? "source.position[1]" : "contact.gap"));
        }
    }
    return deferred;
}

/* All that the run shows at its end. */
static struct scene_values shown(struct model *m)
{
    (void)scene_read(m, named("contact.gap"));
    return m->state.values;
}

static void check_same(const struct scene_values *a, const struct scene_values *b)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        const struct variable *row = &scene_variables[i];
        const size_t size = row->type == VARIABLE_REAL ? sizeof(double) : sizeof(int32_t);
        if (memcmp((const char *)a + row->offset, (const char *)b + row->offset, size) != 0) {
            printf("%s differs\n", row->name);
            CHECK(false);
        }
    }
}

TEST(every_variable_is_the_same_however_a_flight_is_followed)
{
    struct random r = {29};
    long deferred = 0;
    long contacts = 0;
    for (int n = 0; n < 200; ++n) {
        const double push = n % 3 == 0 ? random_between(&r, -1.0, 1.0) : 0.0;
        const struct random start = r;
        struct scene_values end[3];
        for (int manner = 0; manner < 3; ++manner) {
            r = start;
            struct model *m = random_start(&r);
            const int taken = run(m, (enum manner)manner, push);
            CHECK(manner != THE_LONG_WAY || taken == 0);
            deferred += taken;
            end[manner] = shown(m);
            contacts += m->state.motion.contact[0].record.onsets;
            model_destroy(m);
        }
        check_same(&end[AS_IT_COMES], &end[THE_LONG_WAY]);
        check_same(&end[AS_IT_COMES], &end[LOOKING]);
    }
    CHECK(deferred > 200L * STEPS / 2);
    CHECK(contacts > 100);
}

/* Thrown up from 0.4 m above a cylinder with 3 m/s the source is back after 0.73 s: in steps of 1 ms only the
 * first asks when. */
TEST(a_flight_that_cannot_touch_is_deferred_throughout)
{
    for (int ends = ENDS_OPEN; ends <= ENDS_CAPPED; ++ends) {
        struct model *m = created();
        struct scene_values *v = &m->state.values;
        scene_start_free(m, SOURCE, vec3_make(0.2, 0.0, 1.0), vec3_make(0.5, 0.0, 3.0));
        scene_put(v->body[DESTINATION].axis, 1.0, 0.0, 0.0);
        scene_put(v->world.gravity, 0.0, 0.0, -9.81);
        v->body[DESTINATION].finite_length = ends == ENDS_CAPPED;
        v->body[DESTINATION].ends = ends;
        v->contact[0].location = LOCATION_OUTSIDE;
        CHECK(model_exit_initialization(m) == MODEL_OK);
        CHECK(run(m, AS_IT_COMES, 0.0) == STEPS - 1);
        CHECK_CLOSE("height", scene_read(m, named("source.position[3]")), 1.0 + 1.2 - 9.81 * 0.08, 1e-14);
        model_destroy(m);
    }
}

/* At the axis of a hollow cylinder n is that of the communication point before, which a deferred flight would
 * not know: here the source comes there at 7/16 s along x = (7/16 - t) / 2, y = (7/16 - t)^2. */
TEST(the_last_direction_is_that_of_the_step_before_the_axis)
{
    struct model *m = created();
    struct scene_values *v = &m->state.values;
    scene_start_free(m, SOURCE, vec3_make(7.0 / 32.0, 49.0 / 256.0, 0.0), vec3_make(-0.5, -0.875, 0.0));
    scene_put(v->body[DESTINATION].axis, 0.0, 0.0, 1.0);
    scene_put(v->world.gravity, 0.0, 2.0, 0.0);
    CHECK(model_exit_initialization(m) == MODEL_OK);
    for (int i = 1; i <= 7; ++i) {
        CHECK(scene_step(m, i / 16.0) == MODEL_OK);
    }
    CHECK_CLOSE("distance", scene_read(m, named("contact.distance")), 0.0, 0.0);
    /* At 6/16 s: x = 1/32, y = 1/256. Inside a cylinder e_c points from its axis to the wall. */
    CHECK_CLOSE("direction x", scene_read(m, named("contact.direction[1]")), 8.0L / sqrtl(65.0L), 1e-15);
    CHECK_CLOSE("direction y", scene_read(m, named("contact.direction[2]")), 1.0L / sqrtl(65.0L), 1e-15);
    model_destroy(m);
}
