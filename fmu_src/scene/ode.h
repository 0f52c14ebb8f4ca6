/*
 * The scene as a system of ordinary differential equations within fixed regimes, for integrators that know
 * nothing of contact. SI units; all arrays are the caller's.
 *
 *   y = (moved [m], v [m/s] of each free body; impulse on the source of each contact [N s];
 *        dissipated energy [J]; external work [J])
 *
 * and where bodies turn or rub (scene_turns)
 *
 *   y = (moved, v of each free body; L / I_1 [rad/s] of each body of free rotation;
 *        orientation (w, x, y, z) of those with an axis; spring xi [m] of each elastic friction;
 *        orientation of the spheres among them;
 *        impulse, impulse of torque on the source and on the destination of each contact [N s, N m s];
 *        dissipated energy, external work, work on friction and its springs [J])
 *
 * L is the angular momentum about the centre, I_1 the transverse inertia: L is what torques change, and an
 * integrator that keeps quadratic invariants keeps the angular momentum of all bodies. Of a sphere L / I_1 is
 * the angular velocity.
 *
 * Three kinds of states, in this order: those that rates depend on, ode_coupled of them; orientations of
 * spheres, on which only their own rates depend; and integrals, from ode_integrals on, on which nothing does.
 *
 * Two event functions for each contact, each an event where it falls through zero, which ends the phase:
 *   0   -g              contact ends
 *   1   contact_event   the law changes
 * and where bodies turn or rub
 *   2   friction_stick_event   sticking and sliding change
 *   3   friction_cap_event     mu F_n passes F_max; of elastic friction that sticks, F* passes it
 *   4   friction_lift_event    F_n changes its sign while the bodies overlap
 * and last where cylinders may be capped
 *       zones_margin           the contact leaves its zone
 * An offset is added, so that they start above zero in spite of rounding. Without contact both are the
 * constant 1, unless another contact loads one of the bodies: then 0 is also the first touch and the passage
 * of a cylinder's end. Where neither body is free closed forms foresee both, which are then constant.
 */
#ifndef CONTACT_SCENE_ODE_H
#define CONTACT_SCENE_ODE_H

#include "scene/evaluate.h"

enum ode_event { ODE_EVENT_GAP, ODE_EVENT_LAW, ODE_EVENT_STICK, ODE_EVENT_CAP, ODE_EVENT_LIFT };

enum {
    ODE_EVENT_ZONE = SCENE_ANY_TURNING ? 5 : 2,
    ODE_EVENTS_EACH = ODE_EVENT_ZONE + SCENE_ANY_CAPS,
    ODE_EVENTS = ODE_EVENTS_EACH * SCENE_CONTACTS
};

struct scene_ode {
    const struct scene_values *values;
    const struct scene_state *state;      /* regimes, paths; its body states are not read */
    double gap_offset[SCENE_CONTACTS];    /* added to events 0 [m] */
    double margin_offset[SCENE_CONTACTS]; /* added to events 1 [as the event] */
    /* added to events 2, 3 and 4 */
    double stick_offset[SCENE_CONTACTS], cap_offset[SCENE_CONTACTS], lift_offset[SCENE_CONTACTS];
    double zone_offset[SCENE_CONTACTS];  /* added to events ODE_EVENT_ZONE [m] */
    double energy_scale, momentum_scale; /* of the motion as the phase begins [J], [N s] */
};

/* Number of states. Indices in y: of a body's `moved`, which v follows; of a contact's impulse; of the
 * dissipated energy, which the external work follows. */
int ode_size(const struct scene_values *v);
int ode_body(const struct scene_values *v, int body);
int ode_impulse(const struct scene_values *v, int contact);
int ode_dissipated(const struct scene_values *v);

/* Number of leading states that are coupled; index of the first integral. */
int ode_coupled(const struct scene_values *v);
int ode_integrals(const struct scene_values *v);

/* Gives contacts at d = 0 a direction: n takes the escape direction. */
void ode_leave_centres(const struct scene_values *v, struct scene_state *q);

/* Sets offsets and scales for a phase that begins at the instant `at` of ode->state, for an integrator whose
 * speeds are right to relative |w| + absolute [m/s]. */
void ode_begin(struct scene_ode *ode, const struct scene_instant *at, double relative, double absolute);

/* Packs ode->state into y; unpacks y into the bodies, impulses and energies of q, but not into its clock. */
void ode_pack(const struct scene_ode *ode, double *y);
void ode_unpack(const struct scene_values *v, struct scene_state *q, const double *y);

/* dy/dt. This and the Jacobians are handed to integrators that know no scene (math/radau_step.h). */
void ode_rates(const void *scene_ode, double clock, const double *y, double *rates);

/* d(dy/dt)_i / dy_j at [j * ode_size + i]: dense, by columns. */
void ode_jacobian(const void *scene_ode, double clock, const double *y, double *columns);

/* The Jacobian of the coupled states: ode_coupled rows and columns. */
void ode_coupled_jacobian(const void *scene_ode, double clock, const double *y, double *columns);

/* Number of forces by which the coupled states act on each other, 0: they do not act by a few forces only;
 * number of the last coupled states whose rates depend on other states directly as well. The split Jacobian:
 * the part without the forces; d rate / d force at [force * ode_coupled + rate]; d force / d state at [state
 * * ode_forces + force]. The effect of the places of the forces on their torques is left out. */
int ode_forces(const struct scene_values *v);
int ode_tipping(const struct scene_values *v);
void ode_split_jacobian(const void *scene_ode, double clock, const double *y, double *columns,
                        double *by_forces, double *of_forces);

void ode_events(const struct scene_ode *ode, double clock, const double *y, double events[ODE_EVENTS]);

/* The event functions and the instant at which they are evaluated. */
void ode_events_at(const struct scene_ode *ode, double clock, const double *y, struct scene_instant *at,
                   double events[ODE_EVENTS]);

/* The regime after an event of a contact, at the present of q. */
enum contact_regime ode_regime_after(const struct scene_values *v, const struct scene_state *q, int contact,
                                     int event);

/* Size of each state, for relative errors. A vector's components have the vector's length, so that results do
 * not depend on the orientation of the axes. Displacements count from the start of the phase, so that results
 * do not depend on the place. Energies and impulses are at least those of the free bodies. */
void ode_nominal(const struct scene_ode *ode, const double *y, double *sizes);

/* The instant at y. */
void ode_instant(const struct scene_ode *ode, double clock, const double *y, struct scene_instant *at);

/* Where the states of scenes that turn or rub are in y; -1: there is none. */
struct turning_layout {
    int spin[SCENE_BODIES];        /* L / I_1 */
    int orientation[SCENE_BODIES]; /* w, x, y, z */
    int spring[SCENE_CONTACTS];
    int coupled, integrals; /* see ode_coupled, ode_integrals */
};

enum { TURNING_IMPULSES = 9 }; /* of a contact: of force, of torque on the source, on the destination */

struct turning_layout turning_layout_of(const struct scene_values *v);

/* The event functions of friction at the present of ode->state, the instant `at`, each raised by twice what
 * rounding and an error of the speeds by `tolerated` [m/s] make of it. */
void turning_friction_events(struct scene_ode *ode, const struct scene_instant *at, int contact,
                             double tolerated, double events[ODE_EVENTS_EACH]);

/*
 * Invariants at the end of a contact phase (projection methods: Hairer, Lubich, Wanner, Geometric Numerical
 * Integration, chapter IV.4). CVODE keeps them only to its tolerance; along the normal they can be put right
 * exactly, without touching momentum.
 *
 * The gap is zero where the bodies part, so that the flight that follows starts outside.
 *
 * The energy of the relative motion of the two bodies is restored to its value at the start of the phase:
 * m_red |w|^2 / 2 + p_n g^2 / 2, and the potential of gravity where one of them is not free. It excludes the
 * common motion, beside whose energy that of a light body's contact could be rounding. It is restored only
 * where this undamped contact and gravity alone act on the bodies, because an error in the work of another
 * force would be taken for an error of the speed.
 */

/* That energy at the present instant, in the regimes of q [J]; zero where no contact keeps it. The potential
 * counts from the displacement, because its constant part would cost digits. */
double projection_balance(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at);

/* Moves the free bodies of a contact apart along the normal, by their inverse masses, until the gap is
 * zero. */
void projection_close_gap(const struct scene_values *v, struct scene_state *q, int contact);

/* Gives the bodies of a contact opposite impulses along the normal that restore the energy q->phase_energy.
 * `tolerated` is the integrator's error in a step [m/s]. Nothing is done where this error does not explain
 * the difference of energy, or where rounding explains it. */
void projection_restore_energy(const struct scene_values *v, struct scene_state *q, int contact,
                               double tolerated);

#endif
