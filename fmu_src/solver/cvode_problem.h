/*
 * The smooth problem within fixed regimes, as CVODE sees it.
 *
 *   y = (moved, v of each free body; impulse on the source of each contact; dissipated energy; external work)
 *
 * Roots, four for each contact, all of them falling through zero where they matter:
 *   0  -g                 the bodies part
 *   1  the regime margin  the law changes (contact_regime_margin)
 *   2  -g'                the deepest penetration (rising gap rate)
 *   3  dF_n/dt            the largest force
 * The first two start with a trifle added, so that they are above zero wherever rounding let the phase begin; they end the
 * phase, the last two only feed the peaks. Without contact all are held at 1, unless another contact presses on the bodies: then
 * root 0 is also their touching, and an end of a cylinder. Where neither body is free closed forms know both, and 0 and 1 are held.
 */
#ifndef CONTACT_CVODE_PROBLEM_H
#define CONTACT_CVODE_PROBLEM_H

#include <nvector/nvector_serial.h>
#include <sundials/sundials_matrix.h>

#include "dynamics/events.h"

#if SCENE_ANY_FREE

enum { CVODE_ROOTS_EACH = 4, CVODE_ROOTS = CVODE_ROOTS_EACH * SCENE_CONTACTS };

struct cvode_problem {
    const struct scene_values *values;
    const struct motion *motion;          /* regimes, paths; its body states are not read */
    double relative, absolute;            /* tolerances [1], [m, m/s, ...] */
    double gap_armour[SCENE_CONTACTS];    /* added to roots 0 [m] */
    double margin_armour[SCENE_CONTACTS]; /* added to roots 1 [as the margin] */
    double energy_scale, momentum_scale;  /* of the motion as the phase begins [J], [N s] */
};

int cvode_problem_size(const struct scene_values *v);

void cvode_pack(const struct cvode_problem *p, N_Vector y);

/* y into the motion's bodies, impulses and energies; the clock is the caller's. */
void cvode_unpack(const struct scene_values *v, struct motion *q, N_Vector y);

int cvode_rhs(double clock, N_Vector y, N_Vector rate, void *problem);
int cvode_jacobian(double clock, N_Vector y, N_Vector rate, SUNMatrix jacobian, void *problem, N_Vector,
                   N_Vector, N_Vector);
int cvode_roots(double clock, N_Vector y, double *roots, void *problem);

/* Error weights: 1 / (relative size + absolute), where size is the length of the whole vector, so that turning the world
 * changes nothing, and displacements count from where the phase began, so that far away is like near;
 * energies and impulses are measured against those of the free bodies. */
int cvode_weights(N_Vector y, N_Vector weights, void *problem);

#endif
#endif
