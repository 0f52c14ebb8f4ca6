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

#include "integrator/step_request.h"
#include "math/compiler.h"
#include "model/variable.h"

/* In the order of fmi2Status. */
enum model_status { MODEL_OK, MODEL_WARNING, MODEL_DISCARD, MODEL_ERROR, MODEL_FATAL };

/* The category of messages of a status: logEvents, logStatusWarning, logStatusDiscard, logStatusError or
 * logStatusFatal. */
const char *model_category(enum model_status status);

/* What the model may ask of its owner. */
struct model_host {
    void *context;
    /* category: see model_category */
    void (*log)(void *context, enum model_status status, const char *category, const char *message);
    /* messages nobody wants are not formatted */
    bool (*wants)(void *context, const char *category);
    void *(*allocate)(size_t count, size_t size); /* zeroed, as calloc */
    void (*release)(void *memory);
    bool exchange; /* the importer integrates the model (Model Exchange); else it takes steps of its own */
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

/* model_step with a request (integrator/step_request.h). While at_event is called, outputs of that instant
 * may be read and no other function may be called. */
enum model_status model_step_requested(struct model *m, const struct step_request *request);

/* model_step for a deferred flight: only the clock advances (flight/flight.h). False, and nothing done,
 * where model_step is needed. */
bool model_step_deferred(struct model *m, double end_time);

double model_time(const struct model *m);

/* Reports whether a value would be refused, as NaN and infinity always are. `value` is a double for
 * VARIABLE_REAL, else an int32_t. model_set sets a value that has been checked. */
enum model_status model_check(struct model *m, const struct variable *variable, const void *value);
void model_set(struct model *m, const struct variable *variable, const void *value);

/* Reads a value; outputs are brought up to date with the inputs first. MODEL_DISCARD, and nothing read, where
 * it would be beyond the range of numbers. */
enum model_status model_read(struct model *m, const struct variable *variable, void *value);

/* Reads many Real variables quickly once the model is initialized. Returns the number read before the first
 * that is no Real variable or has to be computed. model_get_vector reads the three components of a vector, or
 * none where the references are anything else or an array is missing. */
size_t model_get_reals(const struct model *m, const uint32_t *references, size_t count, double *values);
bool model_get_vector(const struct model *m, const uint32_t *references, double *values);

/* d^order/dt^order of a real input from the present communication point on; orders 1 and 2. */
enum model_status model_set_input_derivative(struct model *m, const struct variable *variable, int order,
                                             double value);

/* Whether an output has derivatives with respect to time. Mean and peaks over the last step have none. */
bool model_has_derivatives(const struct variable *variable);

/* d^order/dt^order of such outputs at the present time, orders 1 and 2, in the regimes in force. There is one
 * order for each reference and one value for each component. MODEL_DISCARD: beyond the range of numbers. */
CONTACT_COLD enum model_status model_get_output_derivatives(struct model *m,
                                                            const struct variable_list *outputs,
                                                            const int *orders, double *values);

/* J direction: the changes of the real variables `unknowns`, to first order and in the regimes in force, when
 * the real inputs `knowns` change by `direction`. Until the end of initialization the inputs move the start,
 * with the automatic factors. MODEL_DISCARD: beyond the range of numbers. */
CONTACT_COLD enum model_status model_get_directional_derivative(struct model *m,
                                                                const struct variable_list *unknowns,
                                                                const struct variable_list *knowns,
                                                                const double *direction, double *values);

/* seed J: for each known the change of the sum of the unknowns, each times its seed. */
CONTACT_COLD enum model_status model_get_adjoint_derivative(struct model *m,
                                                            const struct variable_list *unknowns,
                                                            const struct variable_list *knowns,
                                                            const double *seed, double *values);

size_t model_state_size(void);

/* Writes model_state_size() bytes. With event_driven the run is not changed by it. CVODE drops its history,
 * so that the run goes on with the same bits as a run restored from these bytes. */
void model_save(struct model *m, void *bytes);

/* Takes over the bytes as a whole, or refuses them (of another version or scene, cut short, altered) and
 * changes nothing. */
enum model_status model_restore(struct model *m, const void *bytes, size_t size);

/*
 * Model Exchange: the model for an integrator of the importer.
 *
 * - States: displacement and velocity of every body that may be free; orientation (a quaternion of any
 *   length) and angular velocity of every body that may turn freely; the spring of every contact that may
 *   have elastic friction; the dissipated energy, the external work and the energy taken by friction. The
 *   states of a body that is not free are constant.
 * - Rates: the time derivatives of the states, in the regimes in force.
 * - Indicators of each contact: the larger of the gap and the distance beyond a cylinder's ends; the force at
 *   which the dashpot changes the law; the distance from the edge of a capped cylinder's zone; three margins
 *   of friction, for stick and slip, the largest force, and a dashpot that pulls.
 *
 * Regimes change in event mode only, where an indicator has passed zero by more than rounding. The importer
 * says when it changes between event mode and continuous-time mode. A jump of an input in event mode is a
 * jump of the motion, whose work is booked. In continuous-time mode the power of the inputs is integrated. A
 * scene without a body that may be free has neither states nor indicators. SCENE_STATES and
 * SCENE_INDICATORS are their numbers.
 */

/* Begins continuous-time mode, or event mode; a model begins in event mode. */
void model_exchange_set_continuous(struct model *m, bool continuous);

/* MODEL_ERROR: no number, or before the last event. */
enum model_status model_exchange_set_time(struct model *m, double time);

/* MODEL_DISCARD, and nothing set: out of the range of the states. */
enum model_status model_exchange_set_states(struct model *m, const double *states);

/* Sets a state that model_check has found in range. */
void model_exchange_set_state(struct model *m, const struct variable *state, double value);

/* The values that model_exchange_get reads; the nominal values are those of the states. */
enum exchange_values { EXCHANGE_STATES, EXCHANGE_RATES, EXCHANGE_INDICATORS, EXCHANGE_NOMINALS };

/* MODEL_DISCARD: beyond the range of numbers. */
enum model_status model_exchange_get(struct model *m, enum exchange_values which, double *values);

/* In event mode: takes over inputs and changes the regimes of the contacts whose indicators ask for it.
 * *changed: some regime did, and another one may have to; *jumped: a state did. */
enum model_status model_exchange_update(struct model *m, bool *changed, bool *jumped);

/* The time of the next touch of bodies in free flight under constant forces [s], after
 * model_exchange_update. INFINITY: not foreseen, or so soon that an integrator cannot miss it. */
double model_exchange_next_touch(const struct model *m);

/* After a step that the importer's integrator accepts: keeps the contacts' directions for d = 0. */
enum model_status model_exchange_accept(struct model *m);

/* Room for a sign, 17 digits, a point, an exponent and the end: -1.2345678901234567e-308 is the longest. */
enum { SHORTEST_SIZE = 25 };

struct shortest {
    char text[SHORTEST_SIZE];
};

/* The fewest digits that read back as the same number: 0.7 gives "0.7", where "%.17g" gives
 * 0.69999999999999996. Use: "%s" with shortest_digits(x).text. */
struct shortest shortest_digits(double value);

#endif
