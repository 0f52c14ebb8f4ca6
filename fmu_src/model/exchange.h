/*
 * The model for an integrator outside of it (Model Exchange): states, their rates, event indicators.
 *
 *   states       of every body that may be free displacement and velocity, of every body that may turn freely
 *                orientation, a quaternion of any length, and angular velocity; of every contact that may
 *                have elastic friction its spring; then the dissipated energy, the external work and what
 *                friction has taken. Of a body that is not free they stand still
 *   rates        their time derivatives, in the regimes in force
 *   indicators   of each contact: the gap, or the way beyond a cylinder's ends if that is more; the force at
 *                which the dashpot changes the law; the way to the edge of a capped cylinder's zone; three
 *                of friction, where it sticks or slides, comes to its largest force, is lifted. A regime
 *                changes in event mode only, where an indicator has passed zero by more than rounding; then
 *                it is as far on the other side.
 *
 * The importer says when it changes between event mode and continuous-time mode. In event mode a jump of the
 * inputs is one of the motion, whose work is booked; in continuous-time mode their power is integrated.
 * A scene without a body that may be free has none of them: its outputs follow from its inputs.
 */
#ifndef CONTACT_MODEL_EXCHANGE_H
#define CONTACT_MODEL_EXCHANGE_H

#include "model/model.h"

/* Whether an integrator outside moves this model; see model_host. */
bool model_is_exchange(const struct model *m);

/* SCENE_STATES and SCENE_INDICATORS. */
size_t model_exchange_states(void);
size_t model_exchange_indicators(void);

/* Begins continuous-time mode, or event mode; a model begins in event mode. */
void model_exchange_set_continuous(struct model *m, bool continuous);

/* MODEL_ERROR: no number, or before the last event. */
enum model_status model_exchange_set_time(struct model *m, double time);

/* MODEL_DISCARD, and nothing set: out of the range of the states. */
enum model_status model_exchange_set_states(struct model *m, const double *states);

/* Sets one that model_check has found in range. */
void model_exchange_set_state(struct model *m, const struct variable *state, double value);

/* What of all that is to be read. */
enum exchange_values { EXCHANGE_STATES, EXCHANGE_RATES, EXCHANGE_INDICATORS, EXCHANGE_NOMINALS };

/* MODEL_DISCARD: beyond the range of numbers. */
enum model_status model_exchange_get(struct model *m, enum exchange_values which, double *values);

/* In event mode: takes over inputs and changes the regimes of the contacts whose indicators ask for it.
 * *changed: some regime did, and another one may have to; *jumped: a state did. */
enum model_status model_exchange_update(struct model *m, bool *changed, bool *jumped);

/* After that: when bodies in free flight touch next, in closed form, if the forces stay what they are [s];
 * INFINITY: not foreseen, or so soon that an integrator which starts here cannot miss it. */
double model_exchange_next_touch(const struct model *m);

/* After a step that the integrator accepts: the contacts' directions are those to keep where d = 0. */
enum model_status model_exchange_accept(struct model *m);

#endif
