/* This file describes the model's memory, for the files of this folder. */
#ifndef CONTACT_MODEL_STATE_H
#define CONTACT_MODEL_STATE_H

#include "integrator/phases.h"
#include "math/compiler.h"
#include "model/model.h"
#include "scene.h"
#include "scene/scene_jet.h"
#include "scene/scene_state.h"

/* Who integrates: the model itself, or the importer, in event mode or in continuous-time mode. */
enum exchange_mode { EXCHANGE_NONE, EXCHANGE_EVENTS, EXCHANGE_CONTINUOUS };

/* Bits of model_state.marks. Bit i tells that the derivative of order i was set at this communication point,
 * where that of order 0 is the value. */
enum {
    SIGNAL_VALUE = 1,
    SIGNAL_DERIVATIVES = 6, /* of orders 1 and 2 */
    SIGNAL_SET = SIGNAL_VALUE | SIGNAL_DERIVATIVES,
    SIGNAL_EXPLICIT = 8 /* the input goes on by given derivatives */
};

/* These are the input components of a body: prescribed displacement, velocity and external force; where
 * bodies may turn, prescribed angular velocity, axis and external torque; where any is a compound, prescribed
 * orientation. */
enum { SIGNALS_EACH = SCENE_ANY_COMPOUND ? 22 : SCENE_ANY_ROTATION ? 18 : 9 };

/* The state is saved as it stands: it is flat, and model_save leaves out its only pointer, motion.v. Doubles
 * come first, so that there is no padding inside. */
struct model_state {
    struct scene_values values;
    double signals[SCENE_BODIES][SIGNALS_EACH][2]; /* d/dt and d^2/dt^2 of inputs as the importer set them */
    struct scene_state motion;
    /* booked_states() (model_exchange.c) when the importer last set or read the states */
    uint64_t booked;
    double importer_tolerance; /* 0: none given */
    double start_time;
    struct scene_values in_force; /* while `tuned`: the values before parameters were set between steps */
    uint8_t marks[SCENE_BODIES][SIGNALS_EACH];
    uint8_t signals_changed; /* model_apply_inputs has not seen some mark yet */
    uint8_t signals_open;    /* some mark is set since the last step */
    uint8_t tuned;           /* model_tune has not taken over some parameter yet */
    uint8_t initialized;
    uint8_t exchange; /* enum exchange_mode */
    /* the warnings given so far: of a body whose inputs contradict each other (bits, model/inputs.c); of a
     * contact without direction (0 or 1) */
    uint8_t warned_of_rate[SCENE_BODIES], warned_of_direction[SCENE_CONTACTS];
};

/* Which outputs are up to date; each value includes the ones before. The bits of a value tell which variables
 * can be read as they stand (enum variable_source). */
enum outputs {
    OUTPUTS_NONE = VARIABLE_GIVEN,
    OUTPUTS_BODIES = OUTPUTS_NONE | VARIABLE_BODY, /* displacement, position, velocity of all */
    OUTPUTS_ALL = OUTPUTS_BODIES | VARIABLE_COMPUTED
};

struct model {
    struct model_state state;
    struct model_host host;
    struct integrator integrator;
    enum outputs outputs;               /* the outputs that are up to date in state.values */
    const struct step_request *request; /* of the present step */
};

/* Whether the host wants messages of this status; asked before a costly message is made. */
bool model_reports(const struct model *m, enum model_status status);

/* Formats and sends a message when the host wants the category. */
CONTACT_COLD enum model_status model_report(const struct model *m, enum model_status status,
                                            const char *format, ...) CONTACT_PRINTF_LIKE(3, 4);

/* Puts the motion at the start that the present parameters and inputs describe. */
CONTACT_COLD void model_prepare(struct model *m);

/* Returns the stiffness and damping factors of a contact by its parameters and the diagonal diag [m].
 *
 *   linear law       p_n = f_p E_ref diag, p_nv = tau_n p_n
 *   viscous only     p_n = 0, p_nv = tau_n E_ref diag
 *   restitution      p_nv = 2 zeta sqrt(p_n m_red), or the number chi v instead of chi (contact/law.h)
 *   Hertz's law      k_h of the theory, chi = tau_n / diag
 *
 * A factor may also be given by the user; damping of the method penalty is 0. */
struct contact_coefficients model_factors(const struct scene_state *q, int contact, double diagonal);

/* Returns the diagonal [m] of the smallest axis-aligned box around both bodies of a contact with the
 * separation c [m]; it scales the automatic penalty factors. Sets *slope to its rate while c changes by
 * `rate` [m/s]. */
double model_diagonal(const struct scene_values *v, int contact, struct vec3 c, struct vec3 rate,
                      double *slope);

/* Returns the rates of the law's factors while the diagonal changes by `diagonal_slope` [m/s]. */
struct contact_law model_law_slope(const struct model *m, int contact, double diagonal_slope);

/* Sets the paths of the bodies at the start by the inputs. */
void model_start_paths(struct model *m);

/* Returns the name of the input of a body's rotation that cannot be in force, or NULL: an axis without
 * direction, an orientation that is no rotation, or an angular velocity that would tilt an axis that is
 * kept. */
const char *model_unfit_turn(const struct model *m, int body);

/* Reports such a parameter or input of a body by its name: an error of the initialization, or an input
 * (MODEL_DISCARD) that is therefore not in force. */
enum model_status model_refuse_turn(const struct model *m, enum model_status status, int body,
                                    const char *name);

/* Whether the vector a, other than zero, has a part across the axis of a body that keeps its axis. */
bool model_tilts_axis(const struct scene_values *v, int body, struct vec3 a);

/* Takes changed inputs over into the paths of the motion. Returns false where an energy would be beyond the
 * range of numbers, where an axis has no direction, or where an axis that is kept would tilt. The motion is
 * then unchanged, and other inputs may be set. */
bool model_apply_inputs(struct model *m);

/* Takes over the inputs set at this communication point as a step begins, and clears their marks.
 * MODEL_DISCARD: they cannot be taken over, and a message has said so. */
enum model_status model_close_inputs(struct model *m);

/* Computes at least the outputs `wanted` of the present instant. Returns false where the inputs cannot be
 * taken over. */
bool model_update_outputs(struct model *m, enum outputs wanted);

/* Computes the body outputs after a deferred flight to `clock` [s]: a caller that has read outputs after the
 * previous step will probably read them again. */
void outputs_foresee(struct model *m, double clock);

/* Reports that an axis has no direction or would tilt that is kept, or that the inputs lead beyond the range
 * of numbers. */
enum model_status model_refuse_inputs(const struct model *m);

/* motion_open allocates the memory of the model's integrator for the method that the values choose;
 * motion_close frees that of any integrator.
 * MODEL_ERROR: the integrator could not be opened; the message begins with `otherwise`. */
enum model_status motion_open(struct model *m, const char *otherwise);
void motion_close(struct integrator *integrator);

/* Begins the motion of bodies that are where they start: it settles the regimes of the contacts. */
void motion_begin(struct scene_state *q);

/* Whether the forces of the present change the state: bodies may be free, or friction has springs. */
static inline bool motion_remembers_force(const struct scene_state *q)
{
    bool remembers = SCENE_ANY_FREE;
    for (int j = 0; !SCENE_ANY_FREE && SCENE_ANY_SPRINGS && j < SCENE_CONTACTS; ++j) {
        remembers = remembers || contact_has_springs(q->v, j);
    }
    return remembers;
}

/* Changes the paths of the inputs and books the work that the change does. Returns false, and changes
 * nothing, where that work is not finite. `jumps`: the model itself integrates, so that the friction springs
 * of contacts without a free body are laid onto the new tangent planes. */
bool motion_follow(struct scene_state *q, const struct body_path *next, bool jumps);

/* Moves the motion to the end of the requested step. */
enum model_status motion_advance(struct model *m, const struct step_request *request);

/* Computes the motion of deferred steps (integrator_catch_up). */
void motion_catch_up(struct model *m);

/* Whether all doubles from one place up to another have a magnitude of at most `most`, or are finite. */
bool all_within(const void *from, const void *to, double most);
bool all_finite(const void *from, const void *to);

/* Whether the motion of the bodies, its energies and its sums over the last step are finite. */
bool motion_is_finite(const struct scene_state *q);

/* Sets the instant that outputs show, with rotations. It is that of q where a body may be free, else that of
 * `settled`, a copy of q with the regimes that the present inputs ask for. Reading outputs leaves q as it
 * is. */
void motion_shown(const struct scene_state *q, struct scene_state *settled, struct scene_instant *at);

/* Clears the caches that only the model's own integrator fills. Model Exchange calls it before the first step
 * and after an event. */
void motion_forget_integration(struct scene_state *q);

/* Returns the value of a state, a rate or an indicator of Model Exchange. */
double model_exchange_value(const struct scene_instant *at, const struct variable *variable);

/* Changes a state along a path; a state of a body that is not free has no effect. */
void model_exchange_move(const struct scene_instant *at, const struct variable *state, double change,
                         struct scene_jet *along);

/* Returns the rate of a state, or the change of this rate along a path; NULL: no path. */
double model_exchange_rate(const struct scene_instant *at, const struct scene_jet *along,
                           const struct variable *rate);

/* Sets the Taylor coefficients of one order of all outputs and calculated parameters along a path
 * (scene_jet.h); zero where the path does not change them. */
void output_terms(const struct model *m, const struct scene_instant *at, const struct scene_jet *along,
                  int order, struct scene_values *terms);

#endif
