/* The singularity d = 0 of solid bodies: n is undefined there and reverses; the escape direction takes its
 * place. */
#ifndef CONTACT_SCENE_SINGULARITY_H
#define CONTACT_SCENE_SINGULARITY_H

#include "scene/evaluate.h"

/* Whether d = 0 within rounding, by positions or by the accumulated gap. */
bool singularity_is_reached(const struct scene_values *v, const struct scene_instant *at, int contact,
                            const struct contact_shape *shape);

/* The escape direction, in which bodies leave d = 0: that of their relative velocity `rate`; at relative rest
 * that of `acceleration`, the relative one that counts; without both, `held`. */
struct vec3 singularity_escape(const struct contact_shape *shape, struct vec3 rate, struct vec3 acceleration,
                               struct vec3 held);

#endif
