/*
 * The contact model as an adapter sees it: variables, steps, saved states. It knows nothing of FMI.
 *
 * Time in seconds, everything in SI units. No function prints, and none allocates except model_create,
 * model_exit_initialization and model_restore. Refusals are reported through model_host.log with the
 * variable, the value and the allowed range, and change nothing.
 */
#ifndef CONTACT_MODEL_MODEL_H
#define CONTACT_MODEL_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "integrator/phases.h"
#include "integrator/step_request.h"
#include "math/compiler.h"
#include "model/variable.h"
#include "scene.h"
#include "scene/scene_state.h"

/* In the order of fmi2Status. */
enum model_status { MODEL_OK, MODEL_WARNING, MODEL_DISCARD, MODEL_ERROR, MODEL_FATAL };

/* What the model may ask of its owner. */
struct model_host {
    void *context;
    /* category: logEvents, logStatusWarning, logStatusDiscard, logStatusError or logStatusFatal */
    void (*log)(void *context, enum model_status status, const char *category, const char *message);
    /* messages nobody wants are not formatted */
    bool (*wants)(void *context, const char *category);
    void *(*allocate)(size_t count, size_t size); /* zeroed, as calloc */
    void (*release)(void *memory);
    bool exchange; /* an integrator outside moves the model (exchange.h); else it takes steps of its own */
};

struct model;

/* A model with its start values; NULL when out of memory. */
struct model *model_create(const struct model_host *host);

void model_destroy(struct model *m);

/* Back to what model_create returns. */
void model_reset(struct model *m);

/* Start time, and the importer's relative tolerance where it has one; a tolerance outside the range of
 * solver.relative_tolerance is clipped to it with a warning. */
enum model_status model_setup(struct model *m, bool tolerance_defined, double tolerance, double start_time);

/* Refuses contradictory parameters (naming both) and leaves everything settable; otherwise the model can
 * step. */
enum model_status model_exit_initialization(struct model *m);

/* Integrates to end_time > model_time. MODEL_DISCARD: solver.max_internal_steps ended it earlier, at
 * model_time; the values are those of that time and the next step may go on from there. */
enum model_status model_step(struct model *m, double end_time);

/* The same with more to ask for. Outputs may be read while at_event is asked; they are those of that instant,
 * and nothing else may be called. */
enum model_status model_step_requested(struct model *m, const struct step_request *request);

/* model_step for a deferred flight: only the clock advances (flight/flight.h). False, and nothing done,
 * where model_step is needed. */
bool model_step_deferred(struct model *m, double end_time);

double model_time(const struct model *m);

/* `value` is a double for VARIABLE_REAL, else an int32_t. Would this value be refused? Reports it if so. NaN
 * and infinity always are. Then sets one that has been checked. */
enum model_status model_check(struct model *m, const struct variable *variable, const void *value);
void model_set(struct model *m, const struct variable *variable, const void *value);

/* Reads a value; outputs are brought up to date with the inputs first. MODEL_DISCARD, and nothing read, where
 * it would be beyond the range of numbers. */
enum model_status model_read(struct model *m, const struct variable *variable, void *value);

/* The same for many references once the model is initialized, quickly: returns how many it read before one
 * that is no Real variable or that has to be computed. model_get_vector reads the three of a vector; none
 * where they are anything else or an array is missing. */
size_t model_get_reals(const struct model *m, const uint32_t *references, size_t count, double *values);
bool model_get_vector(const struct model *m, const uint32_t *references, double *values);

/* d^order/dt^order of a real input from the present communication point on; orders 1 and 2. */
enum model_status model_set_input_derivative(struct model *m, const struct variable *variable, int order,
                                             double value);

/* Whether an output has derivatives with respect to time: those do not that sum up the last step (mean and
 * peaks). */
bool model_has_derivatives(const struct variable *variable);

/* d^order/dt^order of such outputs at the present time, orders 1 and 2, in the regimes in force.
 * MODEL_DISCARD: beyond the range of numbers. */
CONTACT_COLD enum model_status model_get_output_derivatives(struct model *m, const uint32_t *references,
                                                            const int *orders, size_t count, double *values);

/* What the real variables `unknowns` change by, to first order and in the regimes in force, when the real
 * inputs `knowns` change by `direction`: J direction. Until the end of initialization the inputs move the
 * start, with the automatic factors. MODEL_DISCARD: beyond the range of numbers. */
CONTACT_COLD enum model_status model_get_directional_derivative(struct model *m, const uint32_t *unknowns,
                                                                size_t unknown_count, const uint32_t *knowns,
                                                                size_t known_count, const double *direction,
                                                                double *values);

/* The other way round, seed J: what the sum of the unknowns, each times its seed, changes by for each known.
 * At most MODEL_ADJOINT_MOST unknowns. */
enum { MODEL_ADJOINT_MOST = 64 };
CONTACT_COLD enum model_status model_get_adjoint_derivative(struct model *m, const uint32_t *unknowns,
                                                            size_t unknown_count, const uint32_t *knowns,
                                                            size_t known_count, const double *seed,
                                                            double *values);

size_t model_state_size(void);

/* Writes model_state_size() bytes. With event_driven this is only looking: nothing that follows changes.
 * CVODE drops its history, so that the run that goes on and a run restored from these bytes are the same, bit
 * for bit. */
void model_save(struct model *m, void *bytes);

/* Takes the bytes over as a whole or refuses them (another version or scene, cut short, altered) and changes
 * nothing. */
enum model_status model_restore(struct model *m, const void *bytes, size_t size);

/* The model's memory, for the files of this folder. */

/* Raised when struct model_state, struct scene_state or struct scene_values change their meaning. */
#define MODEL_STATE_VERSION 13u
#define MODEL_STATE_MAGIC 0x464d5543u /* "CUMF" */

/* Who integrates: the model itself; or an integrator outside, which is in event mode or goes on. */
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

/* Of a body: prescribed displacement, velocity and external force; where bodies may turn, prescribed angular
 * velocity, axis and external torque. */
enum { SIGNALS_EACH = SCENE_ANY_ROTATION ? 18 : 9 };

/* Parameters that may be set between steps and of which the motion keeps no copy of its own. */
struct tunable_values {
    struct vec3 gravity;                           /* [m/s^2] */
    double relative_tolerance, absolute_tolerance; /* of the solver */
    int32_t dashpot[SCENE_CONTACTS];
#if SCENE_CONTACTS % 2
    int32_t unused; /* in place of padding */
#endif
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
    uint64_t booked;                /* motion_booked when the importer last set or read the states */
    struct tunable_values in_force; /* while `tuned`: the parameters that `values` has others for by now */
    uint8_t marks[SCENE_BODIES][SIGNALS_EACH];
    uint8_t signals_changed; /* some mark is set that model_apply_inputs has not seen */
    uint8_t signals_open;    /* some mark is set since the last step */
    uint8_t tuned;           /* some parameter is set that model_tune has not taken over */
    uint8_t initialized;
    uint8_t exchange; /* enum exchange_mode */
    /* whether warnings of contradictions of a body's inputs (bits, model/inputs.c), of a contact without
     * direction were given */
    uint8_t warned_of_rate[SCENE_BODIES], warned_of_direction[SCENE_CONTACTS];
};

/* Which outputs are those of the present; each includes the ones before. As bits, these are the variables
 * that can be read as they stand (enum variable_source); VARIABLE_FIXED means nothing there and tells the
 * first two apart. */
enum outputs {
    OUTPUTS_NONE = VARIABLE_GIVEN,
    OUTPUTS_FIXED = OUTPUTS_NONE | VARIABLE_FIXED,  /* of bodies that never move */
    OUTPUTS_BODIES = OUTPUTS_FIXED | VARIABLE_BODY, /* displacement, position and velocity of all */
    OUTPUTS_ALL = OUTPUTS_BODIES | VARIABLE_COMPUTED
};

struct model {
    struct model_state state;
    struct model_host host;
#if SCENE_ANY_FREE
    struct integrator integrator;
#endif
    enum outputs outputs; /* in state.values */
};

/* Whether the host wants messages of this status: asked before what costs time only to be shown. */
bool model_reports(const struct model *m, enum model_status status);

/* The outputs that change are no longer those of the present. */
void model_forget_outputs(struct model *m);

/* Formats and sends a message when the host wants the category. */
enum model_status model_report(const struct model *m, enum model_status status, const char *format, ...)
    CONTACT_PRINTF_LIKE(3, 4);

/* MODEL_DISCARD of a step within which contacts change without end, or nearly so. */
enum model_status model_report_stalled(const struct model *m, const struct step_request *request);

/* Puts the motion at the start that the present parameters and inputs describe. */
void model_prepare(struct model *m);

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
enum model_status model_check_consistency(struct model *m);

/* Warns of each parameter that has been set and that nothing reads, naming the choice by which something
 * would. */
void model_warn_of_idle(struct model *m);
#if SCENE_ANY_ROTATION
/* Those of one body, of how it turns; a part of it. */
enum model_status model_check_rotation(struct model *m, int body);
#endif

/* Takes changed inputs over into the paths of the motion; false, and the motion as before, where an energy
 * would be beyond the range of numbers. They remain to be taken over: others may be set. */
bool model_apply_inputs(struct model *m);

/* Before a parameter is set between steps: keeps those in force. */
void model_begin_tuning(struct model *m);

/* Takes parameters that were set between steps over into the motion and books the energy that this adds or
 * removes; false, and the motion as before, where a force or an energy would be beyond the range of numbers.
 * And whether it would be with this value of one of them. */
bool model_tune(struct model *m);
bool model_can_tune(const struct model *m, const struct variable *variable, const void *value);

/* From the present communication point on, inputs go on as they are. */
void model_close_inputs(struct model *m);

/* Warns once of each prescribed body whose given derivative of displacement is not its prescribed
 * velocity. */
void model_warn_of_rates(struct model *m);

/* Computes outputs of the present, `wanted` at least; false where the inputs cannot be taken over. */
bool model_update_outputs(struct model *m, enum outputs wanted);

/* "The inputs ... beyond the range of numbers ...", for who cannot take them over. */
enum model_status model_refuse_inputs(const struct model *m);

/* Shows where a body is: its displacement, position and velocity; as given, or those of the present. */
void model_show_body(struct scene_values *v, int body, struct vec3 displacement, struct vec3 velocity);
/* Shows what turns and rubs; a sum that is finite only if all of it is. */
double model_show_turning(struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at);
void model_show_body_now(struct scene_values *v, const struct scene_state *q, int body);

#endif
