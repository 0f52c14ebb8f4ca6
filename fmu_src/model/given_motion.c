/* In place of free_motion.c in scenes without a body that may be free: a force element has
 * no state but the clock; its outputs are functions of the inputs, now or over the last step. */
#include <math.h>
#include <string.h>

#include "model/motion.h"
#include "prescribed/prescribed.h"
#include "scene/evaluate.h"

/* Whether the scene has not left all of them out. */
static const bool SUMS_UP_STEPS = HAS_contact_mean_force || HAS_contact_peak_force ||
                                  HAS_contact_peak_penetration || HAS_contact_mean_source_torque ||
                                  HAS_contact_mean_destination_torque;

enum model_status motion_open(struct model *m, const struct scene_values *v, const char *otherwise)
{
    (void)m, (void)v, (void)otherwise;
    return MODEL_OK;
}

void motion_close(struct model *m)
{
    (void)m;
}

bool motion_has_history(const struct scene_values *v)
{
    (void)v;
    return false;
}

void motion_place(const struct scene_values *v, struct scene_state *q)
{
    if (SCENE_ANY_ROTATION) {
        turning_place(v, q);
    }
}

void motion_begin(const struct scene_values *v, struct scene_state *q)
{
    if (SUMS_UP_STEPS) {
        prescribed_begin(v, q);
    }
}

bool motion_follow(const struct scene_values *v, struct scene_state *q, const struct body_path *next,
                   bool jumps)
{
    (void)jumps;
    scene_rebase(v, q);
    memcpy(q->path, next, sizeof q->path);
    turning_take_axes(v, q);
    return true;
}

bool motion_tune(const struct scene_values *v, struct scene_state *q, const struct motion_tuning *tuning)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].parameters.factors = tuning->factors[j];
    }
    struct scene_instant at;
    scene_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += tuning->factors[j].k + tuning->factors[j].c + fabs(at.normal_force[j]);
    }
    return isfinite(sum);
}

enum model_status motion_advance(struct model *m, const struct step_request *request)
{
    const struct scene_values *v = &m->state.values;
    struct scene_state *q = &m->state.motion;
    const double length = scene_remaining(q, request->end_time);
    if (SUMS_UP_STEPS) {
        const struct scene_state before = *q;
        prescribed_begin(v, q);
        if (!prescribed_over(v, q, length, PRESCRIBED_PANELS)) {
            const struct step_request whole = {.end_time = request->end_time, .whole = true};
            *q = before;
            return model_report_stalled(m, &whole);
        }
    }
    q->clock += length;
    scene_rebase(v, q);
    return MODEL_OK;
}

void motion_catch_up(const struct scene_values *v, struct scene_state *q)
{
    (void)v, (void)q;
}

bool motion_defer(struct model *m, double end_time)
{
    (void)m, (void)end_time;
    return false;
}

/* A sum that is finite only if all parts are. */
static double size_of_step(const struct contact_state *state)
{
    const struct vec3 mean = state->mean_force;
    return fabs(mean.x) + fabs(mean.y) + fabs(mean.z) + state->peaks.force + state->peaks.penetration;
}

double motion_size(const struct scene_values *v, const struct scene_state *q)
{
    (void)v;
    double sum = 0.0;
    for (int j = 0; SUMS_UP_STEPS && j < SCENE_CONTACTS; ++j) {
        sum += size_of_step(&q->contact[j]);
    }
    return sum;
}

double motion_least_speed(const struct scene_values *v)
{
    (void)v;
    return 1e-12; /* the start value of solver.absolute_tolerance in scenes with a solver */
}

const struct scene_state *motion_shown(const struct scene_values *v, const struct scene_state *q,
                                       struct scene_state *settled)
{
    scene_state_copy(v, q, settled);
    prescribed_settle(v, settled);
    return settled;
}

double motion_show(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at)
{
    (void)at;
    for (int j = 0; SUMS_UP_STEPS && j < SCENE_CONTACTS; ++j) {
        const struct contact_state *state = &q->contact[j];
        put_contact_mean_force(v, j, state->mean_force);
        put_contact_mean_source_torque(v, j, state->torques.source_mean);
        put_contact_mean_destination_torque(v, j, state->torques.destination_mean);
        put_contact_peak_force(v, j, state->peaks.force);
        put_contact_peak_penetration(v, j, state->peaks.penetration);
    }
    return motion_size(v, q);
}

double motion_energy(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at)
{
    (void)v, (void)q, (void)at;
    return 0.0;
}

const char *motion_unknown(const struct model *m, const struct variable *variable)
{
    (void)m, (void)variable;
    return NULL;
}

bool motion_jet(const struct model *m, const struct scene_state *q, const struct scene_jet *along,
                const struct variable *variable, int order, double *term)
{
    (void)m, (void)q, (void)along, (void)variable, (void)order, (void)term;
    return false;
}

void motion_begin_exchange(struct scene_state *q)
{
    (void)q;
}

void motion_set_state(struct scene_state *q, const struct variable *state, double value)
{
    (void)q, (void)state, (void)value;
}

double motion_local(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                    const struct variable *variable)
{
    (void)v, (void)q, (void)at, (void)variable;
    return 0.0;
}

void motion_move_state(const struct scene_values *v, const struct scene_state *q,
                       const struct variable *state, double change, struct scene_jet *along)
{
    (void)v, (void)q, (void)state, (void)change, (void)along;
}

double motion_local_slope(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_jet *along, const struct variable *variable)
{
    (void)v, (void)q, (void)along, (void)variable;
    return 0.0;
}

bool motion_change_regimes(const struct scene_values *v, struct scene_state *q)
{
    (void)v, (void)q;
    return false;
}

uint64_t motion_booked(const struct scene_state *q)
{
    (void)q;
    return 0;
}

double motion_touch_after(const struct scene_values *v, const struct scene_state *q)
{
    (void)v, (void)q;
    return (double)INFINITY;
}

void motion_jet_of_work(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along)
{
    (void)v, (void)q, (void)along;
}
