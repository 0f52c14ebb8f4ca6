/*
 * The model's interface without an adapter: wrong calls, and the quadrature over a given motion
 * (prescribed/prescribed.c), where impulse, work, dissipated energy and peaks have closed forms.
 */
#include "model/model.h"

#include <float.h>

#include "check.h"
#include "scene_model.h"

/* What the model last told its host. */
struct heard {
    enum model_status status;
    int messages;
    char category[32];
};

static void hear(void *context, enum model_status status, const char *category, const char *message)
{
    struct heard *heard = context;
    heard->status = status;
    heard->messages += 1;
    snprintf(heard->category, sizeof heard->category, "%s", category);
    CHECK(message[0] != '\0');
}

static struct model *new_model(struct heard *heard)
{
    *heard = (struct heard){MODEL_OK, 0, ""};
    const struct model_host host = {heard, hear, 0, scene_allocate, free, false};
    struct model *m = model_create(&host);
    if (!m) {
        exit(2);
    }
    m->state.values.world.gravity[2] = 0.0;
    return m;
}

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

static void a_step_before_initialization_is_an_error(void)
{
    struct heard heard;
    struct model *m = new_model(&heard);
    CHECK(model_step(m, 0.1) == MODEL_ERROR);
    CHECK(heard.messages == 1 && heard.status == MODEL_ERROR);
    CHECK(strcmp(heard.category, "logStatusError") == 0);
    CHECK(model_setup(m, false, 0.0, 2.0) == MODEL_OK);
    CHECK(model_step(m, 2.1) == MODEL_ERROR);
    CHECK_CLOSE("time", model_time(m), 2.0, 0.0);
    /* It is none afterwards, and is one again after a reset. */
    CHECK(model_exit_initialization(m) == MODEL_OK);
    CHECK(model_step(m, 2.1) == MODEL_OK);
    CHECK_CLOSE("time", model_time(m), 2.1, DBL_EPSILON);
    model_reset(m);
    CHECK(model_step(m, 2.2) == MODEL_ERROR);
    model_destroy(m);
}

static void what_is_not_finite_or_out_of_range_is_refused_with_a_message(void)
{
    struct heard heard;
    struct model *m = new_model(&heard);
    CHECK(model_setup(m, false, 0.0, (double)INFINITY) == MODEL_ERROR);
    CHECK(model_setup(m, true, (double)NAN, 0.0) == MODEL_ERROR);
    CHECK(model_setup(m, true, 1.0, 0.0) == MODEL_WARNING);
    const double refused[] = {(double)NAN, (double)INFINITY, -1.0, 0.0};
    for (int i = 0; i < 4; ++i) {
        CHECK(model_check(m, named("source.radius"), &refused[i]) == MODEL_DISCARD);
    }
    CHECK(model_check(m, named("source.radius"), &(double){0.3}) == MODEL_OK);
    CHECK(model_check(m, named("contact.dashpot"), &(int32_t){DASHPOT_APPROACH_ONLY + 1}) == MODEL_DISCARD);
    CHECK(heard.messages == 8);
    CHECK(model_set_input_derivative(m, named("source.radius"), 1, 1.0) == MODEL_ERROR);
    CHECK(model_set_input_derivative(m, named("source.external_force[1]"), 3, 1.0) == MODEL_ERROR);
    CHECK(model_set_input_derivative(m, named("source.external_force[1]"), 1, (double)NAN) == MODEL_DISCARD);
    model_destroy(m);
}

static void altered_bytes_are_not_restored(void)
{
    struct heard heard;
    struct model *m = new_model(&heard);
    CHECK(model_exit_initialization(m) == MODEL_OK);
    CHECK(model_step(m, 0.1) == MODEL_OK);
    const size_t size = model_state_size();
    unsigned char *bytes = scene_allocate(1, size);
    if (!bytes) {
        exit(2);
    }
    model_save(m, bytes);
    CHECK(model_step(m, 0.2) == MODEL_OK);
    CHECK(model_restore(m, bytes, size - 1) != MODEL_OK);
    for (size_t at = 0; at < size; at += 97) {
        bytes[at] ^= 0x10;
        CHECK(model_restore(m, bytes, size) != MODEL_OK);
        bytes[at] ^= 0x10;
    }
    CHECK_CLOSE("time after refusals", model_time(m), 0.2, DBL_EPSILON);
    CHECK(model_restore(m, bytes, size) == MODEL_OK);
    CHECK_CLOSE("time after the restore", model_time(m), 0.1, DBL_EPSILON);
    free(bytes);
    model_destroy(m);
}

/* The source dips into a fixed cylinder along x: g = -0.01 - 0.1 t + 0.4 t^2, within 0 <= t <= 0.25. */
static struct model *dipping_source(struct heard *heard)
{
    struct model *m = new_model(heard);
    struct scene_values *v = &m->state.values;
    v->body[SOURCE].motion = MOTION_PRESCRIBED;
    v->contact[0].location = LOCATION_OUTSIDE;
    v->contact[0].dashpot = DASHPOT_UNCLAMPED;
    v->contact[0].penalty_factor = 1e4;
    v->contact[0].viscous_penalty_factor = 200.0;
    scene_put(v->body[SOURCE].center, 0.59, 0.0, 0.0);
    scene_put(v->body[SOURCE].prescribed_velocity, -0.1, 0.0, 0.0);
    CHECK(model_exit_initialization(m) == MODEL_OK);
    const struct variable *u = named("source.prescribed_displacement[1]");
    const struct variable *rate = named("source.prescribed_velocity[1]");
    CHECK(model_set_input_derivative(m, u, 1, -0.1) == MODEL_OK);
    CHECK(model_set_input_derivative(m, u, 2, 0.8) == MODEL_OK);
    CHECK(model_set_input_derivative(m, rate, 1, 0.8) == MODEL_OK);
    return m;
}

/* Integrals from 0 to t of -g, of g' and of g'^2, and of the energy that the spring holds. */
static long double depth_integral(long double t)
{
    return 0.01L * t + 0.05L * t * t - 0.4L / 3.0L * t * t * t;
}

static long double gap_of(long double t)
{
    return -0.01L - 0.1L * t + 0.4L * t * t;
}

static long double square_rate_integral(long double t)
{
    return 0.01L * t - 0.08L * t * t + 0.64L / 3.0L * t * t * t;
}

static void a_given_motion_has_the_impulse_work_and_loss_of_its_closed_form(void)
{
    struct heard heard;
    struct model *m = dipping_source(&heard);
    long double before = 0.0L;
    for (int i = 1; i <= 5; ++i) {
        const double end = 0.05 * i;
        CHECK(model_step(m, end) == MODEL_OK);
        const long double impulse = 1e4L * depth_integral(end) - 200.0L * (gap_of(end) - gap_of(0.0L));
        const long double lost = 200.0L * square_rate_integral(end);
        const long double stored = 5e3L * (gap_of(end) * gap_of(end) - 1e-4L);
        const double tolerance =
            1e-12; /* polynomials below degree nine: exact but for rounding of some 10 N m */
        const struct scene_state *q = &m->state.motion;
        CHECK_CLOSE("impulse along x", q->contact[0].physics.impulse.x, impulse, tolerance);
        CHECK_CLOSE("impulse along y", q->contact[0].physics.impulse.y, 0.0, 0.0);
        CHECK_CLOSE("impulse along z", q->contact[0].physics.impulse.z, 0.0, 0.0);
        CHECK_CLOSE("dissipated", q->dissipated, lost, tolerance);
        CHECK_CLOSE("work on the source", q->external_work, lost + stored, tolerance);
        CHECK_CLOSE("mean force", scene_read(m, named("contact.mean_force[1]")), (impulse - before) / (0.05L),
                    1e3 * tolerance);
        before = impulse;
    }
    CHECK(m->state.motion.counters.force_evaluations > 0);
    model_destroy(m);
}

/* -g is largest at t = 1/8: 0.01625 m. F_n = -1e4 g - 200 g' is largest at t = 0.105: the slope 1e3 - 8e3 t -
 * 160. */
static void peaks_between_communication_points_are_found(void)
{
    struct heard heard;
    struct model *m = dipping_source(&heard);
    CHECK(model_step(m, 0.25) == MODEL_OK);
    const long double largest = -1e4L * gap_of(0.105L) - 200.0L * (-0.1L + 0.8L * 0.105L);
    CHECK_CLOSE("peak penetration", scene_read(m, named("contact.peak_penetration")), 0.01625, 1e-15);
    CHECK_CLOSE("peak force", scene_read(m, named("contact.peak_force")), largest, 1e-10);
    model_destroy(m);
}

static void counters_of_a_given_motion_stay_at_the_largest_integer(void)
{
    struct heard heard;
    struct model *m = new_model(&heard);
    m->state.values.body[SOURCE].motion = MOTION_PRESCRIBED;
    scene_put(m->state.values.body[SOURCE].center, -1.0, 0.1, 0.0);
    scene_put(m->state.values.body[SOURCE].prescribed_velocity, 3.0, 0.0, 0.0);
    CHECK(model_exit_initialization(m) == MODEL_OK);
    m->state.motion.counters.force_evaluations = INT32_MAX - 3;
    CHECK(model_step(m, 2.0) == MODEL_OK);
    CHECK(m->state.motion.counters.force_evaluations == INT32_MAX);
    struct model_state *saved = scene_allocate(1, model_state_size());
    if (!saved) {
        exit(2);
    }
    model_save(m, saved);
    CHECK(model_restore(m, saved, model_state_size()) == MODEL_OK);
    free(saved);
    model_destroy(m);
}

int main(void)
{
    CHECK_TEST(a_step_before_initialization_is_an_error);
    CHECK_TEST(what_is_not_finite_or_out_of_range_is_refused_with_a_message);
    CHECK_TEST(altered_bytes_are_not_restored);
    CHECK_TEST(a_given_motion_has_the_impulse_work_and_loss_of_its_closed_form);
    CHECK_TEST(peaks_between_communication_points_are_found);
    CHECK_TEST(counters_of_a_given_motion_stay_at_the_largest_integer);
    return check_summary("model_step");
}
