/*
 * Saved states in which a single value is one that no model ever has: each is refused with a message and
 * changes nothing. What has no end or no number by right is taken.
 */
#include <float.h>
#include <stddef.h>

#include "check.h"
#include "scene_model.h"

enum kind { REAL, INTEGER, FLAG };

struct change {
    const char *name;
    size_t at; /* in struct model_state */
    enum kind kind;
    double value;
};

#define IN(member) #member, offsetof(struct model_state, member)
#define NOT_A_NUMBER ((double)NAN)
#define ENDLESS ((double)INFINITY)

static const struct change harmful[] = {
    {IN(values.body[0].radius), REAL, 0.0},
    {IN(values.body[0].radius), REAL, 1e151},
    {IN(values.body[0].radius), REAL, NOT_A_NUMBER},
    {IN(values.body[0].velocity[1]), REAL, ENDLESS},
    {IN(values.body[0].motion), INTEGER, 0.0},
    {IN(values.body[0].motion), INTEGER, 4.0},
    {IN(signals[1][3][0]), REAL, NOT_A_NUMBER},
    {IN(signals[0][8][1]), REAL, -ENDLESS},
    {IN(importer_tolerance), REAL, NOT_A_NUMBER},
    {IN(start_time), REAL, ENDLESS},
    {IN(motion.base), REAL, NOT_A_NUMBER},
    {IN(motion.clock), REAL, -0.5},
    {IN(motion.clock), REAL, ENDLESS},
    {IN(motion.deferrable_clock), REAL, NOT_A_NUMBER},
    {IN(motion.deferred), INTEGER, 2.0},
    {IN(motion.horizon_clock), REAL, NOT_A_NUMBER},
    {IN(motion.contact[0].physics.normal.x), REAL, 2.0},
    {IN(motion.contact[0].parameters.axis.z), REAL, 1e200},
    {IN(motion.contact[0].parameters.factors.k), REAL, ENDLESS},
    {IN(motion.contact[0].physics.impulse.force.y), REAL, NOT_A_NUMBER},
    {IN(motion.contact[0].record.touch_clock), REAL, NOT_A_NUMBER},
    {IN(motion.contact[0].schedule.change_clock), REAL, NOT_A_NUMBER},
    {IN(motion.contact[0].schedule.dead_band_clock), REAL, NOT_A_NUMBER},
    {IN(motion.contact[0].schedule.change_regime), INTEGER, -1.0},
    {IN(motion.contact[0].schedule.change_regime), INTEGER, 99.0},
    {IN(motion.contact[0].record.onsets), INTEGER, -1.0},
    {IN(motion.contact[0].regime), INTEGER, -1.0},
    {IN(motion.contact[0].regime), INTEGER, 99.0},
    {IN(motion.contact[0].side), INTEGER, 0.0},
    {IN(motion.counters.steps), INTEGER, -1.0},
    {IN(motion.counters.force_evaluations), INTEGER, -1.0},
    {IN(motion.counters.events), INTEGER, -1.0},
    {IN(motion.counters.rejected_steps), INTEGER, -1.0},
    {IN(motion.counters.fallbacks), INTEGER, -1.0},
    {IN(motion.integrator_fresh), INTEGER, -1.0},
    {IN(motion.integrator_fresh), INTEGER, 2.0},
    {IN(motion.origin[0].displacement.x), REAL, ENDLESS},
    {IN(motion.origin[0].displacement.z), REAL, DBL_MAX}, /* finite, but the energy is not */
    {IN(motion.body[0].velocity.z), REAL, NOT_A_NUMBER},
    {IN(motion.phase_energy), REAL, NOT_A_NUMBER},
    {IN(motion.dissipated), REAL, ENDLESS},
    {IN(motion.step_length), REAL, NOT_A_NUMBER},
    {IN(motion.path[1].displacement[3].z), REAL, 2e300},
    {IN(motion.path[0].force[0].x), REAL, NOT_A_NUMBER},
};

static const struct change harmless[] = {
    {IN(motion.horizon_clock), REAL, ENDLESS},
    {IN(motion.contact[0].schedule.change_clock), REAL, ENDLESS},
    {IN(motion.contact[0].schedule.dead_band_clock), REAL, -ENDLESS},
    {IN(warned_of_direction[0]), FLAG, 1.0},
    {IN(motion.counters.steps), INTEGER, 2147483647.0},
};

struct heard {
    enum model_status status;
    int messages;
};

static void hear(void *context, enum model_status status, const char *message)
{
    struct heard *heard = context;
    heard->status = status;
    heard->messages += 1;
    CHECK(message[0] != '\0');
}

static void put(struct model_state *state, const struct change *change)
{
    unsigned char *at = (unsigned char *)state + change->at;
    if (change->kind == REAL) {
        memcpy(at, &change->value, sizeof change->value);
    } else if (change->kind == INTEGER) {
        const int32_t value = (int32_t)change->value;
        memcpy(at, &value, sizeof value);
    } else {
        *at = change->value != 0.0;
    }
}

/* A ball that has fallen on a lying cylinder for a while. */
static void begin(struct model *m, struct heard *heard)
{
    *heard = (struct heard){MODEL_OK, 0};
    *m = scene_model();
    m->host.context = heard;
    m->host.log = hear;
    m->state.values.world.gravity[2] = -9.81;
    vec3_to(vec3_make(0.0, 1.0, 0.0), m->state.values.body[DESTINATION].axis);
    CHECK(model_exit_initialization(m) == MODEL_OK);
    CHECK(model_step(m, &(struct step_request){.end_time = 0.25}) == MODEL_OK);
    CHECK(model_step(m, &(struct step_request){.end_time = 0.5}) == MODEL_OK);
}

TEST(a_state_with_one_wrong_value_is_refused_and_changes_nothing)
{
    struct heard heard;
    struct model m;
    struct model_state good, after;
    begin(&m, &heard);
    model_save(&m, &good);
    for (size_t i = 0; i < sizeof harmful / sizeof harmful[0]; ++i) {
        struct model_state wrong = good;
        put(&wrong, &harmful[i]);
        heard.messages = 0;
        const enum model_status status = model_restore(&m, &wrong);
        model_save(&m, &after);
        const bool holds = status == MODEL_ERROR && heard.messages == 1 && heard.status == MODEL_ERROR &&
                           memcmp(&after, &good, sizeof good) == 0;
        check_that(holds, harmful[i].name, __FILE__, __LINE__);
    }
    CHECK(model_step(&m, &(struct step_request){.end_time = 0.75}) == MODEL_OK);
    integrator_close(&m.integrator);
}

TEST(only_a_model_that_integrates_itself_defers_steps)
{
    static const struct change deferred = {IN(motion.deferred), INTEGER, 1.0};
    for (int exchange = 0; exchange < 2; ++exchange) {
        struct heard heard = {MODEL_OK, 0};
        struct model m = scene_model();
        struct model_state state;
        m.host.context = &heard;
        m.host.log = hear;
        m.host.exchange = exchange;
        CHECK(!exchange || model_exit_initialization(&m) == MODEL_OK);
        model_save(&m, &state);
        put(&state, &deferred);
        CHECK(model_restore(&m, &state) == MODEL_ERROR && heard.messages == 1);
        integrator_close(&m.integrator);
    }
}

TEST(what_may_be_without_end_is_taken)
{
    struct heard heard;
    struct model m;
    struct model_state good;
    begin(&m, &heard);
    heard.messages = 0;
    model_save(&m, &good);
    for (size_t i = 0; i < sizeof harmless / sizeof harmless[0]; ++i) {
        struct model_state other = good;
        put(&other, &harmless[i]);
        check_that(model_restore(&m, &other) == MODEL_OK, harmless[i].name, __FILE__, __LINE__);
        CHECK_CLOSE("time", model_time(&m), 0.5, DBL_EPSILON);
    }
    CHECK(heard.messages == 0);
    integrator_close(&m.integrator);
}

TEST(counters_stay_at_the_largest_integer_and_can_be_restored)
{
    struct heard heard = {MODEL_OK, 0};
    struct model m = scene_model();
    struct model_state saved;
    m.host.context = &heard;
    m.host.log = hear;
    m.state.values.body[SOURCE].motion = MOTION_PRESCRIBED;
    vec3_to(vec3_make(-1.0, 0.1, 0.0), m.state.values.body[SOURCE].center);
    vec3_to(vec3_make(3.0, 0.0, 0.0), m.state.values.body[SOURCE].prescribed_velocity);
    CHECK(model_exit_initialization(&m) == MODEL_OK);
    m.state.motion.counters.force_evaluations = INT32_MAX - 3;
    CHECK(model_step(&m, &(struct step_request){.end_time = 2.0}) == MODEL_OK);
    CHECK(m.state.motion.counters.force_evaluations == INT32_MAX);
    model_save(&m, &saved);
    CHECK(model_restore(&m, &saved) == MODEL_OK);
    integrator_close(&m.integrator);
}

TEST(a_model_that_is_not_there_can_be_destroyed)
{
    model_destroy(NULL);
    CHECK(true);
}
