/*
 * The smooth problem within fixed regimes, as CVODE sees it.
 *
 *   y = (moved, v of each free body; impulse on the source of each contact; dissipated energy; external work)
 *
 * Four event functions for each contact, each an event where it falls through zero:
 *   0   -g                  contact ends
 *   1   contact_event       the law changes
 *   2   -g'                 deepest penetration
 *   3   dF_n/dt             largest force
 * An offset is added to 0 and 1, so that they start above zero in spite of rounding; they end the phase. 2
 * and 3 are peaks only. Without contact all are the constant 1, unless another contact loads one of the
 * bodies: then 0 is also the first touch and the passage of a cylinder's end. Where neither body is free
 * closed forms foresee 0 and 1, which are then constant.
 */
#ifndef CONTACT_INTEGRATOR_CVODE_PROBLEM_H
#define CONTACT_INTEGRATOR_CVODE_PROBLEM_H

#include <nvector/nvector_serial.h>
#include <sundials/sundials_matrix.h>

#include "scene/transition.h"

enum { CVODE_ROOTS_EACH = 4, CVODE_ROOTS = CVODE_ROOTS_EACH * SCENE_CONTACTS };

struct cvode_problem {
    const struct scene_values *values;
    const struct scene_state *state;      /* regimes, paths; its body states are not read */
    double relative, absolute;            /* tolerances [1], [m, m/s, ...] */
    double gap_offset[SCENE_CONTACTS];    /* added to roots 0 [m] */
    double margin_offset[SCENE_CONTACTS]; /* added to roots 1 [as the margin] */
    double energy_scale, momentum_scale;  /* of the motion as the phase begins [J], [N s] */
};

int cvode_problem_size(const struct scene_values *v);

void cvode_pack(const struct cvode_problem *p, N_Vector y);

/* y into the motion's bodies, impulses and energies; the clock is the caller's. */
void cvode_unpack(const struct scene_values *v, struct scene_state *q, N_Vector y);

int cvode_rhs(double clock, N_Vector y, N_Vector rate, void *problem);
int cvode_jacobian(double clock, N_Vector y, N_Vector rate, SUNMatrix jacobian, void *problem, N_Vector,
                   N_Vector, N_Vector);
int cvode_roots(double clock, N_Vector y, double *roots, void *problem);

/* Error weights 1 / (relative size + absolute). `size` is the length of the whole vector, so that results do
 * not depend on the orientation of the axes; displacements count from the start of the phase, so that they do
 * not depend on the place; energies and impulses are compared with those of the free bodies. */
int cvode_weights(N_Vector y, N_Vector weights, void *problem);

#endif
