/*
 * Inputs between communication points: each continues from its last value as a polynomial with the given
 * derivatives. A prescribed body follows its prescribed velocity unless its displacement has derivatives of
 * its own. A force element (all bodies prescribed) moves by given derivatives only. An integrator outside
 * sets inputs at each instant; they are constants until it sets them again.
 */
#ifndef CONTACT_MODEL_INPUT_PATHS_H
#define CONTACT_MODEL_INPUT_PATHS_H

#include "model/state.h"

/* Whether all bodies are prescribed: a force element. */
bool inputs_prescribe_all(const struct scene_values *v);

/* Moves the origin of a body's paths to the present. An axis that follows the angular velocity goes on from
 * where it has turned to. */
void input_path_shift(const struct model *m, int body, struct body_path *path);

/* The body's paths from now on, by the signals with these marks (SIGNALS_EACH of them); `path` comes with its
 * origin at the present. */
void input_path_renew(const struct model *m, int body, const uint8_t *marks, struct body_path *path);

/* Whether both paths are the same in every coefficient. */
bool input_path_is_same(const struct body_path *a, const struct body_path *b);

#endif
