/*
 * Invariants at the end of a contact phase (projection methods: Hairer, Lubich, Wanner, Geometric Numerical
 * Integration, chapter IV.4). CVODE keeps them only to its tolerance; along the normal they can be put right
 * exactly, without touching momentum.
 *
 * The gap is zero where the bodies part, so that the flight that follows starts outside.
 *
 * The energy of the relative motion of the two bodies is what it was when the phase began: m_red |w|^2 / 2 +
 * p_n g^2 / 2, and the potential of gravity where one of them is not free. Of these two bodies alone: in the
 * energy of a heavy body that falls, what its contact with a light one has would be rounding. Only where
 * nothing but this undamped contact and gravity acts on them: the work of anything else is integrated too,
 * and its error would be taken for one of the speed.
 */
#ifndef CONTACT_SCENE_PROJECTION_H
#define CONTACT_SCENE_PROJECTION_H

#include "scene/evaluate.h"

/* That energy, with the potential of the displacement alone: its constant part would only cost digits [J]. Of
 * the present instant, in the regimes of q; zero where no contact keeps it. */
double projection_balance(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at);

/* Moves the free bodies of a contact apart along the normal, by their inverse masses, until the gap is
 * zero. */
void projection_close_gap(const struct scene_values *v, struct scene_state *q, int contact);

/* Gives the bodies of a contact opposite impulses along the normal that bring the energy back to
 * q->phase_energy. `tolerated` is what the integrator may be off by in a step [m/s]. Nothing happens where
 * that does not explain the error, and where rounding does. */
void projection_restore_energy(const struct scene_values *v, struct scene_state *q, int contact,
                               double tolerated);

#endif
