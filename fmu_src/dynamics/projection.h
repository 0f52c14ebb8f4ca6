/*
 * Invariants at the end of a contact phase (projection methods: Hairer, Lubich, Wanner, Geometric Numerical Integration,
 * chapter IV.4). An integrator keeps them only to its tolerance; along the normal they can be put right exactly, without
 * touching momentum:
 *
 *   the gap         is zero where the bodies part, so that the flight that follows starts outside
 *   the balance     kinetic + potential + contact + dissipated - external work is what it was when the phase began;
 *                   without damping only: the dissipated energy is integrated too, and where most of the energy goes into
 *                   it, its error would be all that the little remaining speed gets
 */
#ifndef CONTACT_PROJECTION_H
#define CONTACT_PROJECTION_H

#include "dynamics/system.h"

#if SCENE_ANY_FREE

/* kinetic + potential + contact + dissipated - external work, with the potential of the displacements alone: its constant
 * part would only cost digits [J]. Of the present instant, in the regimes of q. */
double projection_balance(const struct scene_values *v, const struct motion *q,
                          const struct system_instant *at);

/* Moves the free bodies of a contact apart along the normal, by their inverse masses, until the gap is zero. */
void projection_close_gap(const struct scene_values *v, struct motion *q, int contact);

/* Gives the bodies of a contact opposite impulses along the normal that bring the balance back to q->phase_energy. Nothing
 * happens where the error is not small against the energy of the relative motion along the normal. */
void projection_restore_energy(const struct scene_values *v, struct motion *q, int contact);

#endif
#endif
