/* Outputs along a path (scene_jet.h). */
#ifndef CONTACT_MODEL_OUTPUTS_H
#define CONTACT_MODEL_OUTPUTS_H

#include "model/state.h"
#include "scene/scene_jet.h"

/* Coefficient `order` of a variable; zero where nothing along the path changes it. */
double output_term(const struct model *m, const struct scene_state *q, const struct scene_instant *at,
                   const struct scene_jet *along, const struct variable *variable, int order);

#endif
