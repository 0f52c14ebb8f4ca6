/* The jet of the energies of energy.h along a path (scene_jet.h), by its coefficients. */
#ifndef CONTACT_SCENE_ENERGY_JET_H
#define CONTACT_SCENE_ENERGY_JET_H

#include "scene/scene_jet.h"

double jet_of_kinetic(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_potential(const struct scene_values *v, const struct scene_jet *along, int order);
double jet_of_stored(const struct scene_values *v, const struct scene_state *q, const struct scene_jet *along,
                     int order);

#endif
