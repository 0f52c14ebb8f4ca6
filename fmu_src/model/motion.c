/* This file moves the model from one time to another. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/state.h"
#include "prescribed/prescribed.h"
#include "scene/evaluate.h"
#include "scene/transition.h"

/* Whether the scene has outputs over the last step, means or peaks. In a scene without a body that may be
 * free the clock is the only state, and all outputs are functions of the inputs, now or over the last
 * step. */
static const bool SUMS_UP_STEPS = HAS_contact_mean_force || HAS_contact_peak_force ||
                                  HAS_contact_peak_penetration || HAS_contact_mean_source_torque ||
                                  HAS_contact_mean_destination_torque;

void motion_shown(const struct scene_state *q, struct scene_state *settled, struct scene_instant *at)
{
    if (!SCENE_ANY_FREE) {
        *settled = *q; /* scene_state_copy may leave out the start of bodies that do not turn */
        prescribed_settle(settled);
    }
    scene_now(SCENE_ANY_FREE ? q : settled, at);
    if (SCENE_ANY_TURNING && !scene_turns(q->v)) {
        turning_complete(at);
    }
}

void motion_forget_integration(struct scene_state *q)
{
    for (int j = 0; SCENE_ANY_FREE && j < SCENE_CONTACTS; ++j) {
        struct contact_state *contact = &q->contact[j];
        contact->physics.accumulated_gap = DBL_MAX; /* the gap then comes from the positions */
        contact->schedule.change_clock = (double)INFINITY;
        contact->peaks = (struct contact_peaks){0.0, 0.0};
    }
}

enum model_status motion_open(struct model *m, const char *otherwise)
{
    if (!SCENE_ANY_FREE) {
        return MODEL_OK;
    }
    const struct integrator_memory memory = {m->host.allocate, m->host.release};
    return integrator_open(&m->integrator, &m->state.values, &memory)
               ? MODEL_OK
               : model_report(m, MODEL_ERROR, "%s: %s.", otherwise, m->integrator.message);
}

void motion_close(struct integrator *integrator)
{
    if (SCENE_ANY_FREE) {
        integrator_close(integrator);
    }
}

static void begin_step(struct scene_state *q)
{
    if (SCENE_ANY_FREE) {
        struct scene_instant at;
        (void)transition_begin_step(q, &at);
    } else if (SUMS_UP_STEPS) {
        prescribed_begin(q);
    }
}

void motion_begin(struct scene_state *q)
{
    if (SCENE_ANY_FREE) {
        transition_settle_regimes(q, 0.0, true);
    }
    begin_step(q);
}

/* Takes over new paths. Where inputs jump in a force element that turns or rubs, the friction springs turn
 * into the new tangent planes. */
static void take_paths(struct scene_state *q, const struct body_path *next, bool jumps)
{
    scene_rebase(q);
    memcpy(q->path, next, sizeof q->path);
    turning_take_axes(q);
    if (SCENE_ANY_FRICTION && SCENE_ANY_FREE && jumps && scene_turns(q->v) && scene_is_force_element(q->v)) {
        prescribed_lay_springs(q);
    }
}

bool motion_follow(struct scene_state *q, const struct body_path *next, bool jumps)
{
    if (!motion_remembers_force(q)) {
        take_paths(q, next, jumps);
        return true;
    }
    struct scene_state before;
    struct scene_instant at;
    scene_state_copy(q, &before);
    scene_now(q, &at);
    const double stored = energy_stored(&at);
    bool stopped[SCENE_CONTACTS * OPPOSED];
    transition_stop_sliding(q, &at, stopped);
    take_paths(q, next, jumps);
    transition_settle_regimes(q, stored, false);
    transition_hold_springs(q, stopped);
    if (isfinite(q->external_work) || scene_is_force_element(q->v)) {
        return true;
    }
    scene_state_copy(&before, q);
    return false;
}

/* Reports a step that ends early: the internal steps are used up, or else contacts change their regimes
 * without end or too often. */
static enum model_status report_early_end(const struct model *m, const struct step_request *request,
                                          bool limited)
{
    char why[160] = "contacts change there more often than can be followed within about a second (allowed: "
                    "some ten thousand times)";
    if (limited) {
        (void)snprintf(
            why, sizeof why,
            "solver.max_internal_steps = %d are used up, by number or by work (allowed: 1 .. 2147483647)",
            (int)solver_max_internal_steps(&m->state.values));
    }
    return model_report(
        m, MODEL_DISCARD, "The step to %s s %s at %s s: %s. Go on from %s, %s.",
        shortest_digits(request->end_time).text, request->whole ? "is undone, it got stuck" : "stopped",
        shortest_digits(scene_time(&m->state.motion)).text, why, request->whole ? "where it began" : "there",
        limited ? "if need be in smaller steps, or set a larger limit" : "in smaller steps");
}

/* Takes a step of a force element. Its contacts are integrated over the step where a state or an output of
 * the scene needs their integrals. */
static enum model_status advance_force_element(struct model *m, const struct step_request *request)
{
    const struct scene_values *v = &m->state.values;
    struct scene_state *q = &m->state.motion;
    const struct scene_state before = *q;
    const double length = scene_remaining(q, request->end_time);
    const long limit = SCENE_ANY_FREE ? solver_max_internal_steps(v) : PRESCRIBED_PANELS;
    begin_step(q);
    if ((SCENE_ANY_FREE || SUMS_UP_STEPS) &&
        !prescribed_over(q, length, limit < PRESCRIBED_PANELS ? limit : PRESCRIBED_PANELS)) {
        const struct step_request whole = {.end_time = request->end_time, .whole = true};
        *q = before;
        return report_early_end(m, &whole, limit < PRESCRIBED_PANELS);
    }
    q->clock += length;
    q->step_length = length;
    scene_rebase(q);
    if (SCENE_ANY_FREE) {
        transition_end_step(q);
    }
    return MODEL_OK;
}

enum model_status motion_advance(struct model *m, const struct step_request *request)
{
    if (!SCENE_ANY_FREE || (scene_turns(&m->state.values) && scene_is_force_element(&m->state.values))) {
        return advance_force_element(m, request);
    }
    const double end_time = request->end_time;
    const int32_t events = m->state.motion.counters.events;
    const enum advance_result status = integrator_run(&m->integrator, &m->state.motion, request);
    if (status == ADVANCE_FAILED) {
        return model_report(m, MODEL_ERROR, "The step to %s s failed at %s s: %s",
                            shortest_digits(end_time).text,
                            shortest_digits(scene_time(&m->state.motion)).text, m->integrator.message);
    }
    if (status != ADVANCE_REACHED) {
        return report_early_end(m, request, status == ADVANCE_STEP_LIMIT);
    }
    if (m->state.motion.counters.events != events && model_reports(m, MODEL_OK)) {
        model_report(m, MODEL_OK, "Changes of contact up to %s s: %d; since initialization: %d.",
                     shortest_digits(end_time).text, (int)(m->state.motion.counters.events - events),
                     (int)m->state.motion.counters.events);
    }
    return MODEL_OK;
}

void motion_catch_up(struct model *m)
{
    if (SCENE_ANY_FREE && m->state.motion.deferred) {
        integrator_catch_up(&m->integrator, &m->state.motion, true);
    }
}

bool all_within(const void *from, const void *to, double most)
{
    const char *end = to;
    for (const char *at = from; at < end; at += sizeof(double)) {
        double value;
        memcpy(&value, at, sizeof value);
        if (!(fabs(value) <= most)) {
            return false;
        }
    }
    return true;
}

bool all_finite(const void *from, const void *to)
{
    return all_within(from, to, DBL_MAX);
}

bool motion_is_finite(const struct scene_state *q)
{
    double sum = scene_time(q);
    sum += !SCENE_ANY_FREE || scene_is_force_element(q->v) ? 0.0 : q->dissipated + q->external_work;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct body_state at = scene_body_at(q, q->clock, i);
        const struct vec3 displacement = scene_displacement_of(q, i, at.moved);
        sum += displacement.x + displacement.y + displacement.z;
        sum += at.velocity.x + at.velocity.y + at.velocity.z;
        sum += body_is_free(q->v, i) ? body_mass(q->v, i) * vec3_dot(at.velocity, at.velocity) : 0.0;
    }
    for (int j = 0; !SCENE_ANY_FREE && SUMS_UP_STEPS && j < SCENE_CONTACTS; ++j) {
        const struct contact_state *state = &q->contact[j];
        sum += vec3_norm(state->physics.impulse.force) + state->peaks.force + state->peaks.penetration;
    }
    return isfinite(sum);
}
