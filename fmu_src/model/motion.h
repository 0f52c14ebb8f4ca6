/*
 * How the model moves from one time to another. Scenes with a body that may be free integrate their motion
 * (free_motion.c); in all others motion is given (given_motion.c).
 */
#ifndef CONTACT_MODEL_MOTION_H
#define CONTACT_MODEL_MOTION_H

#include "model/state.h"
#include "scene/scene_jet.h"

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

/* Shows the outputs of this motion: history of the contacts, energies, counters. The sum is finite only if
 * all of them are. */
double motion_show(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at);

/* Why such an output cannot be read although the motion is finite; NULL: it can. */
const char *motion_unknown(const struct model *m, const struct variable *variable);

/* Coefficient `order` of an output of these along a path, in the state that is shown; false where the
 * variable is none of them. */
bool motion_jet(const struct model *m, const struct scene_state *q, const struct scene_jet *along,
                const struct variable *variable, int order, double *term);

/* For an integrator outside (exchange.h). At the start; a state is set; a local variable is computed; regimes
 * change where their margins ask for it, and whether one did; a sum that tells whether events have changed
 * the energies [J]. */
void motion_begin_exchange(struct scene_state *q);
void motion_set_state(struct scene_state *q, const struct variable *state, double value);
double motion_local(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                    const struct variable *variable);
/* Along a path: a change of a state; what a local variable changes by. */
void motion_move_state(const struct scene_values *v, const struct scene_state *q,
                       const struct variable *state, double change, struct scene_jet *along);
double motion_local_slope(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_jet *along, const struct variable *variable);
bool motion_change_regimes(const struct scene_values *v, struct scene_state *q);
/* A mark of the states that events make jump: another one where any bit of them is another. */
uint64_t motion_booked(const struct scene_state *q);
/* How soon bodies in free flight touch, under the forces of the present [s]; INFINITY: not foreseen. */
double motion_touch_after(const struct scene_values *v, const struct scene_state *q);

/* Whoever moves a body by a jump of an input does the work on the contact. */
void motion_jet_of_work(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along);

/* Along a path (scene_jet.h): coefficient `order` of a variable. It is zero where nothing along the path
 * changes the variable. */
double output_term(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                   const struct scene_jet *along, const struct variable *variable, int order);

#endif
