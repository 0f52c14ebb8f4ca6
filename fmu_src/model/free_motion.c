#include <math.h>
#include <string.h>

#include "math/compiler.h"
#include "model/motion.h"
#include "model/shortest.h"
#include "scene/energy.h"
#include "scene/turning.h"
#include "segment/driven_turning.h"
#include "segment/flight.h"

enum model_status motion_open(struct model *m, const struct scene_values *v, const char *otherwise)
{
    const struct integrator_memory memory = {m->host.allocate, m->host.release};
    return integrator_open(&m->integrator, v, &memory)
               ? MODEL_OK
               : model_report(m, MODEL_ERROR, "%s: %s.", otherwise, m->integrator.message);
}

void motion_close(struct model *m)
{
    integrator_close(&m->integrator);
}

bool motion_has_history(const struct scene_values *v)
{
    return solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN;
}

void motion_place(const struct scene_values *v, struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            q->origin[i] = (struct body_origin){body_initial_displacement(v, i), body_initial_velocity(v, i)};
            q->body[i].velocity = q->origin[i].velocity;
        }
    }
#if SCENE_ANY_TURNING
    turning_place(v, q);
#endif
}

void motion_begin(const struct scene_values *v, struct scene_state *q)
{
    transition_settle_regimes(v, q, 0.0, true);
    struct scene_instant at;
    transition_begin_step(v, q, &at);
}

bool motion_follow(const struct scene_values *v, struct scene_state *q, const struct body_path *next)
{
    struct scene_state before;
    scene_state_copy(v, q, &before);
    struct scene_instant at;
    scene_now(v, q, &at);
    const double stored = energy_stored(v, q, &at);
    scene_rebase(v, q);
    memcpy(q->path, next, sizeof q->path);
#if SCENE_ANY_TURNING
    turning_take_axes(v, q);
#endif
    transition_settle_regimes(v, q, stored, false);
    if (isfinite(q->external_work) || scene_is_force_element(v)) {
        return true;
    }
    scene_state_copy(v, &before, q);
    return false;
}

/* Factors and forces: a sum that is finite only if all are. */
static double size_of_forces(const struct scene_values *v, const struct scene_state *q)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_coefficients *factors = &q->contact[j].parameters.factors;
        sum += factors->k + factors->c + fabs(at.normal_force[j]);
    }
    return sum;
}

bool motion_tune(const struct scene_values *v, struct scene_state *q, const struct motion_tuning *tuning)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    const double stored = energy_stored(v, q, &at);
    q->external_work += energy_potential_change(v, &at, tuning->more_gravity);
    scene_rebase(v, q);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        transition_scale_force_error(q, j, tuning->factors[j]);
        q->contact[j].parameters.factors = tuning->factors[j];
    }
    transition_take_law(v, q, tuning->law_changed, stored);
    return isfinite(size_of_forces(v, q)) && (isfinite(q->external_work) || scene_is_force_element(v));
}

static enum model_status report_step_limit(const struct model *m, const struct step_request *request)
{
    return model_report(
        m, MODEL_DISCARD,
        "The step to %s s %s at %s s: solver.max_internal_steps = %d are used up "
        "(allowed: 1 .. 2147483647). Go on from %s, if need be in smaller steps, or set a larger limit.",
        shortest_digits(request->end_time).text, request->whole ? "is undone, it got stuck" : "stopped",
        shortest_digits(scene_time(&m->state.motion)).text, (int)solver_max_internal_steps(&m->state.values),
        request->whole ? "where it began" : "there");
}

#if SCENE_ANY_TURNING
/* No body is free or turns freely, but something turns or rubs. */
static enum model_status advance_given(struct model *m, const struct step_request *request)
{
    const struct scene_values *v = &m->state.values;
    struct scene_state *q = &m->state.motion;
    const struct scene_state before = *q;
    const double length = scene_remaining(q, request->end_time);
    const long limit = solver_max_internal_steps(v);
    struct scene_instant at;
    transition_begin_step(v, q, &at);
    if (!driven_turning_over(v, q, length, limit < DRIVEN_PANELS ? limit : DRIVEN_PANELS)) {
        const struct step_request whole = {.end_time = request->end_time, .whole = true};
        *q = before;
        return limit < DRIVEN_PANELS ? report_step_limit(m, &whole) : model_report_stalled(m, &whole);
    }
    q->clock += length;
    q->step_length = length;
    scene_rebase(v, q);
    transition_end_step(v, q);
    return MODEL_OK;
}
#endif

enum model_status motion_advance(struct model *m, const struct step_request *request)
{
#if SCENE_ANY_TURNING
    if (scene_turns(&m->state.values) && scene_is_force_element(&m->state.values)) {
        return advance_given(m, request);
    }
#endif
    const double end_time = request->end_time;
    const struct scene_values *v = &m->state.values;
    const int32_t events = m->state.motion.counters.events;
    switch (integrator_run(&m->integrator, v, &m->state.motion, request)) {
    case INTEGRATOR_DONE:
        break;
    case INTEGRATOR_STEP_LIMIT:
        return report_step_limit(m, request);
    case INTEGRATOR_STALLED:
        return model_report_stalled(m, request);
    case INTEGRATOR_FAILED:
    default:
        return model_report(m, MODEL_ERROR, "The step to %s s failed at %s s: %s",
                            shortest_digits(end_time).text,
                            shortest_digits(scene_time(&m->state.motion)).text, m->integrator.message);
    }
    if (m->state.motion.counters.events != events && model_reports(m, MODEL_OK)) {
        model_report(m, MODEL_OK, "Changes of contact up to %s s: %d; since initialization: %d.",
                     shortest_digits(end_time).text, (int)(m->state.motion.counters.events - events),
                     (int)m->state.motion.counters.events);
    }
    return MODEL_OK;
}

void motion_catch_up(const struct scene_values *v, struct scene_state *q)
{
    flight_catch_up(v, q);
}

/* Apart from foresee_reading, which need not save registers for it. */
CONTACT_NOINLINE static void show_prescribed(struct scene_values *v, const struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_prescribed(v, i)) {
            model_show_body_now(v, q, i);
        }
    }
}

/* After a deferred flight to `clock`: a caller that has read outputs after the step before will read again,
 * so body states are computed at once where that is cheap. The clock is passed by value, because reading it
 * back just after it was written costs more. */
static void foresee_reading(struct model *m, double clock)
{
    struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    m->outputs = OUTPUTS_BODIES;
    _Static_assert(((int)MOTION_PRESCRIBED & ~(int)MOTION_FIXED) != 0, "fixed bodies hide prescribed ones");
    int others = 0; /* bits of the motions that are not free: one instruction a body */
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const struct body_state at = flight_unforced_at(v, q, i, clock);
            model_show_body(v, i, vec3_add(q->origin[i].displacement, at.moved), at.velocity);
        } else {
            others |= body_motion(v, i);
        }
    }
    if (others & ~(int)MOTION_FIXED) {
        show_prescribed(v, q);
    }
}

/* Apart from motion_defer, which need not save registers for it. */
CONTACT_NOINLINE static bool defer_further(struct model *m, double end_time)
{
    return integrator_defer_further(&m->state.values, &m->state.motion, end_time);
}

bool motion_defer(struct model *m, double end_time)
{
    struct scene_state *q = &m->state.motion;
    if (!flight_defer(q, end_time) && !(q->deferrable_clock > 0.0 && defer_further(m, end_time))) {
        return false;
    }
    if (m->outputs > OUTPUTS_FIXED) {
        foresee_reading(m, m->state.motion.clock);
    }
    return true;
}

/* A measure of a free body's motion that is infinite or NaN where any part of it is. */
static double size_of_motion(const struct scene_values *v, const struct scene_state *q, int body)
{
    const struct vec3 speed = q->body[body].velocity;
    return body_mass(v, body) * vec3_dot(speed, speed) + vec3_norm(q->body[body].moved);
}

double motion_size(const struct scene_values *v, const struct scene_state *q)
{
    double sum = scene_is_force_element(v) ? 0.0 : q->dissipated + q->external_work;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        sum += body_is_free(v, i) ? size_of_motion(v, q, i) : 0.0;
    }
    return sum;
}

double motion_least_speed(const struct scene_values *v)
{
    return solver_absolute_tolerance(v);
}
