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

/* Returns the bytes of memory that g->nodes needs. */
size_t node_forces_memory(void);

/* Returns the number of unknowns of a stage for which a step of twelve stages has room: those that there are
 * while all contacts transmit forces. */
int node_forces_unknowns(const struct scene_values *v);

/* Returns the largest number of stages at which the unknowns of the contacts in touch have room in a step of
 * this length [s]. */
int node_forces_stages(const struct general *g, double length);

/* Solves the stages of g->step from their guess. Returns false where the iterations do not converge. Where
 * the guess is far from the end of the step, `set_weights` sets the errors allowed anew after the first
 * iteration; it is NULL elsewhere. */
bool node_forces_solve(struct general *g, double tolerance, void (*set_weights)(struct general *g));

#endif
