/*
 * The stages of one step of the general segment, with the contact forces at the stages as unknowns.
 *
 * Given the forces, all motion follows by quadrature. Each contact tells how far its force is from its laws,
 * in a form that is nearly linear in the forces: the normal force by the gap and its rate, friction that
 * rolls by the slip as a function of the force, friction that slides by the force as a function of the slip
 * (friction_response_of). Newton's method solves for the forces; its slopes are kept as long as they serve.
 */
#ifndef CONTACT_INTEGRATOR_NODE_FORCES_H
#define CONTACT_INTEGRATOR_NODE_FORCES_H

#include "integrator/general_step.h"

/* Whether the scene can be solved so: no friction is elastic, and the forces are no more unknowns than the
 * states that are no places, whose memory they use. */
bool node_forces_apply(const struct general *g);

/* Solves the stages of g->step from their guess; false where the iterations do not converge. */
bool node_forces_solve(struct general *g, double tolerance);

#endif
