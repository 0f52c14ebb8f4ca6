/* The singularity d = 0 of solid bodies: n is undefined there and reverses; the escape direction takes its
 * place (contact_escape_direction). */
#ifndef CONTACT_SCENE_SINGULARITY_H
#define CONTACT_SCENE_SINGULARITY_H

#include "scene/evaluate.h"

/* Whether d = 0 within rounding, by positions or by the accumulated gap. */
bool singularity_is_reached(const struct scene_values *v, const struct scene_instant *at, int contact,
                            const struct contact_shape *shape);

#endif
