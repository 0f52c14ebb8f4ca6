/*
 * The scene along a path through the present instant, as contact/variation.h has it for one contact: in time, or in the
 * direction of a change of the inputs. Asked for now and then: cold, so that it takes the optimizer's room from nobody.
 */
#ifndef CONTACT_VARIED_SCENE_H
#define CONTACT_VARIED_SCENE_H

#include "contact/variation.h"
#include "dynamics/system.h"

struct system_variation {
    struct vec3 displacement[SCENE_BODIES][VARIATION_TERMS];
    struct vec3 velocity[SCENE_BODIES][VARIATION_TERMS];
    struct contact_law law_slope[SCENE_CONTACTS]; /* d/ds of the factors, where they are automatic */
    struct contact_variation contact[SCENE_CONTACTS];
#if SCENE_ANY_FREE
    double dissipated[VARIATION_TERMS], external_work[VARIATION_TERMS]; /* without the first term */
#endif
};

/* Contacts from what is there of the bodies and the factors. */
__attribute__((cold)) void variation_of_contacts(const struct scene_values *v, const struct motion *q,
                                                 const struct system_instant *at,
                                                 struct system_variation *along);

/* All of it in time: free bodies by Newton's law, prescribed ones by their velocity, which counts as the derivative of their
 * displacement. */
__attribute__((cold)) void variation_in_time(const struct scene_values *v, const struct motion *q,
                                             const struct system_instant *at, struct system_variation *along);

#if SCENE_ANY_FREE
/* Coefficients of the energies of energy.h. */
double variation_of_kinetic(const struct scene_values *v, const struct system_variation *along, int order);
double variation_of_potential(const struct scene_values *v, const struct system_variation *along, int order);
double variation_of_stored(const struct scene_values *v, const struct motion *q,
                           const struct system_variation *along, int order);
#endif

#endif
