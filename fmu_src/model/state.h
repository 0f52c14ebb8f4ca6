/* The model's memory, for the files of this folder. */
#ifndef CONTACT_MODEL_STATE_H
#define CONTACT_MODEL_STATE_H

#include "integrator/phases.h"
#include "math/compiler.h"
#include "model/model.h"
#include "scene.h"
#include "scene/scene_jet.h"
#include "scene/scene_state.h"

/* Raised when struct model_state, struct scene_state or struct scene_values change their meaning. */
#define MODEL_STATE_VERSION 14u
#define MODEL_STATE_MAGIC 0x464d5543u /* "CUMF" */

/* Who integrates: the model itself, or the importer, in event mode or in continuous-time mode. */
enum exchange_mode { EXCHANGE_NONE, EXCHANGE_EVENTS, EXCHANGE_CONTINUOUS };

/* Bits of input_signal.marks */
enum {
    SIGNAL_VALUE = 1,     /* the value was set at this communication point */
    SIGNAL_RATE = 2,      /* a first derivative was set at this communication point */
    SIGNAL_CURVATURE = 4, /* a second derivative was set at this communication point */
    SIGNAL_EXPLICIT = 8   /* the input goes on by given derivatives */
};

/* One scalar input as the importer set it. */
struct input_signal {
    double rate, curvature; /* d/dt and d^2/dt^2 */
};

/* Input components of a body: prescribed displacement, velocity and external force; where bodies may turn,
 * prescribed angular velocity, axis and external torque. */
enum { SIGNALS_EACH = SCENE_ANY_ROTATION ? 18 : 9 };

/* Parameters that may be set between steps and of which the motion keeps no copy of its own. */
struct tunable_values {
    struct vec3 gravity;                           /* [m/s^2] */
    double relative_tolerance, absolute_tolerance; /* of the solver */
    int32_t dashpot[SCENE_CONTACTS];
    int32_t unused; /* in place of padding */
};

/* Flat and without pointers: this is what is saved. Doubles come first so that there is no padding inside. */
struct model_state {
    uint32_t magic, version, scene, size;
    uint64_t checksum; /* of everything below */
    struct scene_values values;
    struct input_signal signals[SCENE_BODIES][SIGNALS_EACH];
    struct scene_state motion;
    double importer_tolerance; /* 0: none given */
    double start_time;
    /* mark of the states that events make jump, when the importer last set or read them */
    uint64_t booked;
    struct tunable_values in_force; /* while `tuned`: the parameters in force, which `values` no longer has */
    uint8_t marks[SCENE_BODIES][SIGNALS_EACH];
    uint8_t signals_changed; /* a mark is set that model_apply_inputs has not seen */
    uint8_t signals_open;    /* some mark is set since the last step */
    uint8_t tuned;           /* some parameter is set that model_tune has not taken over */
    uint8_t initialized;
    uint8_t exchange; /* enum exchange_mode */
    /* whether warnings of contradictions of a body's inputs (bits, model/inputs.c), of a contact without
     * direction were given */
    uint8_t warned_of_rate[SCENE_BODIES], warned_of_direction[SCENE_CONTACTS];
};

/* Which outputs are up to date; each value includes the ones before. As bits these are the variables that can
 * be read as they stand (enum variable_source). VARIABLE_FIXED only tells the first two values apart. */
enum outputs {
    OUTPUTS_NONE = VARIABLE_GIVEN,
    OUTPUTS_FIXED = OUTPUTS_NONE | VARIABLE_FIXED,  /* of bodies that never move */
    OUTPUTS_BODIES = OUTPUTS_FIXED | VARIABLE_BODY, /* displacement, position and velocity of all */
    OUTPUTS_ALL = OUTPUTS_BODIES | VARIABLE_COMPUTED
};

struct model {
    struct model_state state;
    struct model_host host;
    struct integrator integrator;
    enum outputs outputs; /* in state.values */
};

/* Whether the host wants messages of this status; asked before a costly message is made. */
bool model_reports(const struct model *m, enum model_status status);

/* Marks the outputs that change as out of date. */
static inline void model_forget_outputs(struct model *m)
{
    if (m->outputs > OUTPUTS_FIXED) {
        m->outputs = OUTPUTS_FIXED;
    }
}

/* Formats and sends a message when the host wants the category. */
CONTACT_COLD enum model_status model_report(const struct model *m, enum model_status status,
                                            const char *format, ...) CONTACT_PRINTF_LIKE(3, 4);

/* MODEL_DISCARD of a step within which contacts change without end, or nearly so. */
CONTACT_COLD enum model_status model_report_stalled(const struct model *m,
                                                    const struct step_request *request);

/* Puts the motion at the start that the present parameters and inputs describe. */
CONTACT_COLD void model_prepare(struct model *m);

/* The factors of a contact that the parameters describe, with the diagonal in force. */
struct contact_coefficients model_factors(const struct scene_values *v, const struct scene_state *q,
                                          int contact);

/* d/ds of the diagonal of the bounding box, and of the factors made from it, when the separation at the start
 * changes by `rate` s. */
double model_diagonal_slope(const struct model *m, int contact, struct vec3 rate);
struct contact_law model_law_slope(const struct model *m, int contact, double diagonal_slope);

/* The paths that the inputs describe at the start. */
void model_start_paths(struct model *m);

/* Contradictions between parameters; reports the first. */
CONTACT_COLD enum model_status model_check_consistency(struct model *m);

/* Warns of each parameter that has been set and that nothing reads, naming the choice by which something
 * would. */
CONTACT_COLD void model_warn_of_idle(struct model *m);

/* Takes changed inputs over into the paths of the motion. False: an energy would be beyond the range of
 * numbers; the motion is unchanged, and other inputs may be set. */
bool model_apply_inputs(struct model *m);

/* Keeps the parameters in force before one is set between steps. */
void model_begin_tuning(struct model *m);

/* Takes parameters that were set between steps over into the motion and books the energy that this adds or
 * removes. False: a force or an energy would be beyond the range of numbers; the motion is unchanged. The
 * second function tells whether one value would be refused so. */
bool model_tune(struct model *m);
bool model_can_tune(const struct model *m, const struct variable *variable, const void *value);

/* From the present communication point on, inputs go on as they are. */
void model_close_inputs(struct model *m);

/* Warns once of each prescribed body whose given derivative of displacement is not its prescribed
 * velocity. */
void model_warn_of_rates(struct model *m);

/* Computes outputs of the present, `wanted` at least; false where the inputs cannot be taken over. */
bool model_update_outputs(struct model *m, enum outputs wanted);

/* Reports that the inputs lead beyond the range of numbers. */
enum model_status model_refuse_inputs(const struct model *m);

/* The integrator's memory for the method that v chooses; MODEL_ERROR when there is none to be had, with a
 * message that begins with `otherwise`. */
enum model_status motion_open(struct model *m, const struct scene_values *v, const char *otherwise);
void motion_close(struct model *m);

/* Whether the method goes on from a history that is not part of the saved state, as CVODE does. */
bool motion_has_history(const struct scene_values *v);

/* Puts free bodies to where they start; then, all else being known, begins the motion. */
void motion_place(const struct scene_values *v, struct scene_state *q);
void motion_begin(const struct scene_values *v, struct scene_state *q);

/* Changes the paths of the inputs and books the work that the change does; false, and nothing changed, where
 * the work is not finite. `jumps`: no integrator outside has the springs as its states, so that those of
 * contacts without a free body are laid onto the new tangent planes. */
bool motion_follow(const struct scene_values *v, struct scene_state *q, const struct body_path *next,
                   bool jumps);

/* New factors of the contacts, and by how much gravity has changed. */
struct motion_tuning {
    struct contact_coefficients factors[SCENE_CONTACTS];
    bool law_changed[SCENE_CONTACTS]; /* the factors or the dashpot */
    struct vec3 more_gravity;         /* [m/s^2] */
};

/* Takes them over and books the work; false where something is not finite (q is of no use then). `v` holds
 * the new parameters. */
bool motion_tune(const struct scene_values *v, struct scene_state *q, const struct motion_tuning *tuning);

/* Moves to the end of the step. */
enum model_status motion_advance(struct model *m, const struct step_request *request);

/* Deferred flight (flight/flight.h): whether the step was such, and computing what was deferred. */
bool motion_defer(struct model *m, double end_time);
void motion_catch_up(const struct scene_values *v, struct scene_state *q);

/* Sums that are finite only if the motion of the free bodies and all energies are. */
double motion_size(const struct scene_values *v, const struct scene_state *q);
double motion_energy(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at);

/* Speeds below it are none [m/s]. */
double motion_least_speed(const struct scene_values *v);

/* The state that outputs show: q, or `settled`, a copy with the regimes that the present inputs ask for. A
 * reading leaves q as it is. */
const struct scene_state *motion_shown(const struct scene_values *v, const struct scene_state *q,
                                       struct scene_state *settled);

/* Model Exchange, before the first step and after an event: clears caches that only the model's own
 * integrator fills. */
void motion_forget_integration(struct scene_state *q);

/* The value of a state, a rate or an indicator. */
double model_exchange_value(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at, const struct variable *variable);

/* Changes a state along a path; a state of a body that is not free has no effect. */
void model_exchange_move(const struct scene_values *v, const struct scene_state *q,
                         const struct variable *state, double change, struct scene_jet *along);

/* The change of a rate along the path. */
double model_exchange_slope(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at, const struct scene_jet *along,
                            const struct variable *variable);

/* Along a path (scene_jet.h): coefficient `order` of a variable; zero where nothing along the path changes
 * it. */
double output_term(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                   const struct scene_jet *along, const struct variable *variable, int order);

#endif
