/*
 * This file is the contact model as an FMI adapter sees it: variables, steps, saved states. The model knows
 * nothing of FMI.
 *
 * Times are in seconds, all other quantities in SI units. No function prints. Only model_create,
 * model_exit_initialization and model_restore allocate memory. Each refusal is reported through
 * model_host.log with the variable, the value and the allowed range, and changes nothing.
 */
#ifndef CONTACT_MODEL_MODEL_H
#define CONTACT_MODEL_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "integrator/step_request.h"
#include "math/compiler.h"
#include "model/variable.h"

/* The order is that of fmi2Status. */
enum model_status { MODEL_OK, MODEL_WARNING, MODEL_DISCARD, MODEL_ERROR, MODEL_FATAL };

/* This struct holds the services that the owner of a model provides to it. */
struct model_host {
    void *context;
    void (*log)(void *context, enum model_status status, const char *message);
    /* whether the owner wants messages with a status; others are not formatted */
    bool (*wants)(void *context, enum model_status status);
    void *(*allocate)(size_t count, size_t size); /* zeroed, as calloc */
    void (*release)(void *memory);
    bool exchange; /* the importer integrates the model (Model Exchange); else it takes steps of its own */
};

struct model;

/* Returns a new model with its start values, or NULL when memory is exhausted. */
struct model *model_create(const struct model_host *host);

void model_destroy(struct model *m);

/* Returns the model to the state in which model_create hands it out. */
void model_reset(struct model *m);

/* Sets the finite start time [s] and, where the importer has one, the importer's relative tolerance. A
 * tolerance outside the range of solver.relative_tolerance is clipped to it with a warning. */
enum model_status model_setup(struct model *m, bool tolerance_defined, double tolerance, double start_time);

/* Ends initialization, after which the model can step. Contradictory parameters are refused with a message
 * that names both; all parameters can then still be set. */
enum model_status model_exit_initialization(struct model *m);

/* Integrates to the end of a requested step (integrator/step_request.h), which lies after model_time.
 * MODEL_DISCARD: solver.max_internal_steps ended the step earlier, at model_time. All values are then those
 * of model_time, where the next step may begin. A callback at_event may read the outputs of its instant, and
 * may call no other function. */
enum model_status model_step(struct model *m, const struct step_request *request);

/* Advances only the clock to end_time [s], where the flight of the bodies can be deferred (flight/flight.h).
 * Returns false, and does nothing, where model_step is needed. */
bool model_step_deferred(struct model *m, double end_time);

double model_time(const struct model *m);

/* model_check returns MODEL_OK, or reports that a value is refused; NaN and infinity always are. model_set
 * sets a value that model_check has accepted. A variable that is not Real takes whole numbers. */
enum model_status model_check(struct model *m, const struct variable *variable, double value);
void model_set(struct model *m, const struct variable *variable, double value);

/* Reads a value, after the outputs have been brought up to date with the inputs. Returns MODEL_DISCARD where
 * the value would be beyond the range of numbers; *value then has no meaning. */
enum model_status model_read(struct model *m, const struct variable *variable, double *value);

/* Reads many Real variables quickly once the model is initialized, after the outputs have been brought up to
 * date for the first. Returns whether all were read: each is Real and need not be computed by itself, and
 * there are `count` numbers. */
bool model_get_reals(struct model *m, const struct variable_list *list, size_t count, double *values);

/* Sets the time derivative of `order` 1 or 2 of a real input from the present communication point on, to a
 * value in the range of the input. */
void model_set_input_derivative(struct model *m, const struct variable *variable, int order, double value);

/* Whether an output has derivatives with respect to time. Means and peaks over the last step have none. */
bool model_has_derivatives(const struct variable *variable);

/* Computes time derivatives of outputs at the present time, of orders 1 and 2, in the regimes in force.
 * `orders` holds one order for each reference, and `values` takes one derivative for each component.
 * MODEL_DISCARD: beyond the range of numbers. */
CONTACT_COLD enum model_status model_get_output_derivatives(struct model *m,
                                                            const struct variable_list *outputs,
                                                            const int *orders, double *values);

/* This struct describes a product with the matrix J of the derivatives of unknowns with respect to knowns. */
struct product {
    bool adjoint; /* true: seed times J, one seed for each unknown; else J times seed, one for each known */
    struct variable_list unknowns, knowns;
    const double *seed;
    double *sensitivity;
};

/* Computes a product, where J holds the derivatives of real variables with respect to real inputs or states
 * in the regimes in force. Until the end of initialization the inputs move the start of the motion, and the
 * automatic penalty factors change with it. MODEL_DISCARD: beyond the range of numbers. */
CONTACT_COLD enum model_status model_product(struct model *m, const struct product *p);

size_t model_state_size(void);

/* Writes model_state_size() bytes. With event_driven the saving does not change the run. CVODE drops its
 * history, so that the run goes on with the same bits as a run restored from these bytes. */
void model_save(struct model *m, void *bytes);

/* Restores a saved state of this scene as a whole from model_state_size() bytes. Bytes that hold values out
 * of range are refused and change nothing. */
enum model_status model_restore(struct model *m, const void *bytes);

/*
 * In Model Exchange an integrator of the importer integrates the model.
 *
 * - States: displacement and velocity of every body that may be free; orientation (a quaternion of any
 *   length) and angular velocity of every body that may turn freely; the spring of every contact that may
 *   have elastic friction; the dissipated energy, the external work and the energy taken by friction. The
 *   states of a body that is not free are constant.
 * - Rates are the time derivatives of the states in the regimes in force.
 * - Indicators of each contact: the larger of the gap and the distance beyond a cylinder's ends; the force at
 *   which the dashpot changes the law; the distance from the edge of the contact's zone; three event
 *   functions of friction, for stick and slip, the largest force, and a dashpot that pulls.
 *
 * Regimes change in event mode only, where an indicator has passed zero by more than rounding. The importer
 * says when it changes between event mode and continuous-time mode. Where an input jumps in event mode, the
 * motion jumps, and the work of the jump is added to the external work. In continuous-time mode the power of
 * the inputs is integrated. A scene without a body that may be free has neither states nor indicators.
 * SCENE_STATES and SCENE_INDICATORS are the numbers of states and of indicators.
 */

/* Begins continuous-time mode, or event mode; a model begins in event mode. */
void model_exchange_set_continuous(struct model *m, bool continuous);

/* Sets the time [s]. MODEL_ERROR: the time is not finite or lies before the last event. */
enum model_status model_exchange_set_time(struct model *m, double time);

/* Sets all states. MODEL_DISCARD: a state is out of its range, and none is set. */
enum model_status model_exchange_set_states(struct model *m, const double *states);

/* Sets a state that model_check has found in range. */
void model_exchange_set_state(struct model *m, const struct variable *state, double value);

/* The kinds of values that model_exchange_get reads. EXCHANGE_NOMINALS are the nominal values of the
 * states. */
enum exchange_values { EXCHANGE_STATES, EXCHANGE_RATES, EXCHANGE_INDICATORS, EXCHANGE_NOMINALS };

/* Reads the values named by `which`. MODEL_DISCARD: a value is beyond the range of numbers. */
enum model_status model_exchange_get(struct model *m, enum exchange_values which, double *values);

/* The changes that an event has caused. */
struct exchange_news {
    bool again;        /* regimes have changed, and another one may have to */
    bool jumped;       /* a state has jumped */
    bool scheduled;    /* the next touch of bodies in free flight under constant forces is foreseen */
    double event_time; /* [s], of that touch; 0 where none is foreseen or it comes too soon to be announced */
};

/* Takes over the inputs in event mode and changes the regime of each contact whose indicators have passed
 * zero. */
enum model_status model_exchange_update(struct model *m, struct exchange_news *news);

/* Notes the contact normals after a step that the importer's integrator accepts. A noted normal serves while
 * the distance d of the contact is zero and gives no direction. */
enum model_status model_exchange_accept(struct model *m);

struct shortest {
    char text[25]; /* room for the longest, -1.2345678901234567e-308, with its terminating zero */
};

/* Writes a number with the fewest digits that read back as the same number: 0.7 gives "0.7", where "%.17g"
 * gives 0.69999999999999996. A message prints it by "%s" with shortest_digits(x).text. */
struct shortest shortest_digits(double value);

#endif
