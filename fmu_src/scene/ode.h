/*
 * This file has the scene as a system of ordinary differential equations within fixed regimes, for
 * integrators that know nothing of contact. SI units; all arrays are the caller's.
 *
 *   y = (moved [m], v [m/s] of each free body; impulse on the source of each contact [N s], and of the
 *        torque on the destination [N m s], if there may be one; dissipated energy [J]; external work [J])
 *
 * and where bodies turn or rub (scene_turns)
 *
 *   y = (moved, v of each free body, L / I_1 [rad/s] of each body of free rotation, orientation (w, x, y, z)
 *        of those with an axis, body by body; spring xi [m] of each elastic friction, theta [rad] of each
 *        elastic resistance to rolling or spinning;
 *        orientation of the spheres among them;
 *        impulses of each contact, of torques on the destination and on the source [N s, N m s];
 *        dissipated energy, external work, work on friction and its springs [J])
 *
 * L is the angular momentum about a body's centre, and I_1 the body's transverse moment of inertia. The
 * states hold L because torques change L: an integrator that keeps quadratic invariants keeps the angular
 * momentum of all bodies. For a sphere L / I_1 is the angular velocity.
 *
 * An integrator may choose the states of the bodies in contact alone. Those of an island stand together.
 *
 * y holds three kinds of states in this order. Rates depend on the first `coupled` states. The orientations
 * of spheres follow, on which only their own rates depend. The integrals follow, and no rate depends on them.
 *
 * Each contact has the event functions below. A fall through zero is an event, which ends the phase of
 * motion.
 *   0   -g              contact ends
 *   1   contact_event   the law changes
 * and where bodies turn or rub
 *   2   friction_stick_event   sticking and sliding change
 *   3   friction_cap_event     mu F_n passes F_max; in elastic friction that sticks: F* passes F_max
 *   4   lift                   F_n changes its sign while the bodies overlap
 *   5, 6  friction_stick_event of rolling and of spinning, where contacts may resist them
 * and last where contacts may be divided into zones
 *       zones_margin           the contact leaves its zone
 * An offset is added to each function, so that it starts above zero in spite of rounding. While the bodies
 * are apart, 0 and 1 are the constant 1. If another contact loads one of the bodies, 0 is instead the
 * distance to the first touch or to the passage of a cylinder's end. Where neither body is free, 0 and 1 are
 * always 1, because closed forms foresee the changes.
 */
#ifndef CONTACT_SCENE_ODE_H
#define CONTACT_SCENE_ODE_H

#include "scene/evaluate.h"

enum ode_event { ODE_EVENT_GAP, ODE_EVENT_LAW, ODE_EVENT_STICK, ODE_EVENT_CAP, ODE_EVENT_LIFT };

enum {
    ODE_EVENT_ZONE = SCENE_ANY_TURNING ? ODE_EVENT_LIFT + OPPOSED : 2,
    ODE_EVENTS_EACH = ODE_EVENT_ZONE + SCENE_ANY_ZONES,
    ODE_EVENTS = ODE_EVENTS_EACH * SCENE_CONTACTS
};

/* Returns the event at which an opposed motion (contact/friction.h) sticks or breaks away. ode_event_part
 * returns the motion of such an event, and the slip for any other event. */
static inline enum ode_event ode_stick_event(int part)
{
    return part == OPPOSED_SLIP ? ODE_EVENT_STICK : (enum ode_event)((int)ODE_EVENT_LIFT + part);
}
static inline int ode_event_part(enum ode_event event)
{
    const int part = (int)event - (int)ODE_EVENT_LIFT;
    return OPPOSED > 1 && part > 0 && part < OPPOSED ? part : OPPOSED_SLIP;
}

enum { ODE_MOST_GROUPS = SCENE_BODIES + SCENE_CONTACTS };

/* This struct holds the indices in y of the states; -1: y has no such state. y may leave out bodies that fly
 * and contacts of such bodies that are apart. */
struct ode_layout {
    int body[SCENE_BODIES];        /* `moved`, which v follows */
    int spin[SCENE_BODIES];        /* L / I_1 */
    int orientation[SCENE_BODIES]; /* w, x, y, z */
    int spring[SCENE_CONTACTS][OPPOSED];
    int impulse[SCENE_CONTACTS];    /* the impulses, in the order of struct contact_impulses */
    bool met[SCENE_CONTACTS];       /* whether y has the impulse */
    int island[SCENE_CONTACTS];     /* the group of its island; -1: apart */
    int groups;                     /* of states: no rate depends on states of another group */
    int group_end[ODE_MOST_GROUPS]; /* the end of each group among the leading states */
    int coupled;                    /* number of leading states on which rates of others depend */
    int integrals;                  /* the first integral */
    int dissipated;                 /* the dissipated energy, which the other energies follow */
    int size;                       /* number of states */
};

/* Returns the number of components of a contact's impulses: 3 of the force; 3 of the torque on the
 * destination, if there may be one; 3 of the torque on the source where something turns or rubs. */
static inline int ode_impulses(const struct scene_values *v)
{
    return scene_turns(v) ? 9 : SCENE_HAS_TORQUES ? 6 : 3;
}

/* Returns the layout of all states; or, where `q` is not NULL, of the bodies in contact in q. A body in
 * flight whose axis a contact sees counts as in contact where the other body of that contact is loaded. */
struct ode_layout ode_layout_of(const struct scene_values *v, const struct scene_state *q);

struct scene_ode {
    const struct scene_values *values;
    const struct scene_state *state; /* regimes, paths; body states of bodies that fly */
    struct ode_layout layout;
    /* gives the motion of a body that y leaves out, at a clock; NULL: y leaves out none */
    struct body_state (*flight)(const struct scene_state *q, int body, double clock);
    double offset[SCENE_CONTACTS][ODE_EVENTS_EACH]; /* of the event functions, in their units */
    double energy_scale, momentum_scale;            /* sizes at the start of the phase [J], [N s] */
};

/* Sets n of each contact with d = 0 to the escape direction (scene/evaluate.h). */
void ode_leave_centres(struct scene_state *q);

/* Sets the offsets and scales of a phase that begins at the instant `at` of ode->state. The speeds of the
 * integrator have errors of at most relative |w| + absolute [m/s]. */
void ode_begin(struct scene_ode *ode, const struct scene_instant *at, double relative, double absolute);

/* ode_pack writes ode->state into y. ode_unpack reads bodies, impulses and energies of q from y, which holds
 * no clock. Both leave alone what y leaves out. */
void ode_pack(const struct scene_ode *ode, double *y);
void ode_unpack(const struct scene_ode *ode, struct scene_state *q, const double *y);

/* Computes dy/dt. */
void ode_rates(const void *scene_ode, double clock, const double *y, double *rates);

/* Sets columns[j * layout.size + i] to the derivative of (dy/dt)_i with respect to y_j. The rows of integrals
 * have what contacts change, which may be stiff. They leave out the power of external forces, and the turning
 * of the lever arm of a torque where nothing turns: a Newton iteration finds these by itself. */
void ode_jacobian(const struct scene_ode *ode, double clock, const double *y, double *columns);

void ode_events(const struct scene_ode *ode, double clock, const double *y, double events[ODE_EVENTS]);

/* Computes the event functions at the instant `at`. */
void ode_events_at(const struct scene_ode *ode, const struct scene_instant *at, double events[ODE_EVENTS]);

/* Returns the regime after an event of a contact at the present clock of q. */
enum contact_regime ode_regime_after(const struct scene_state *q, int contact, int event);

/* Returns an event by the gap that a contact has already passed at the present state y; -1: there is none.
 * Where two contacts end or begin at almost the same time, or friction changes just before a contact ends,
 * the first event ends the phase. The event function of the second event may then already be below zero by
 * more than its offset, and an integrator would not find that root any more. */
int ode_event_passed(const struct scene_ode *ode, const double *y);

/* Sets the size of each state, for relative errors. The components of a vector all get its length, so that
 * results do not depend on the direction of the axes. A displacement counts from the clock's origin, so that
 * results do not depend on the place. An energy or impulse counts as at least that of the free bodies. */
void ode_nominal(const struct scene_ode *ode, const double *y, double *sizes);

/* Returns the powers; of external forces and torques those on the bodies whose motion y holds. */
struct scene_powers ode_powers(const struct scene_ode *ode, const struct scene_instant *at);

/* Computes the instant at y. */
void ode_instant(const struct scene_ode *ode, double clock, const double *y, struct scene_instant *at);

/* For an integrator whose unknowns are the contact forces. ode_other_motion sets the motion of the bodies
 * without states in y at a clock. ode_contact_motion adds that of the others and the springs at y, and the
 * geometry of the contacts in touch, or of `all`; where scene_turns, also arms and slips, while it leaves the
 * orientations of spheres alone.
 * ode_rates_without_contact writes the rates of velocities and spins without the contact forces.
 * ode_rates_at writes the rates of all states at an instant that has forces. */
void ode_other_motion(const struct scene_ode *ode, double clock, struct scene_instant *at);
void ode_contact_motion(const struct scene_ode *ode, const double *y, bool all, struct scene_instant *at);
void ode_rates_without_contact(const struct scene_ode *ode, double clock, double *rates);
void ode_rates_at(const struct scene_ode *ode, const double *y, const struct scene_instant *at,
                  double *rates);

/* Computes the event functions of friction and both resistances of a contact that rubs and transmits a force.
 * Each is raised by its `offset`, which the function sets. An offset is twice the error by rounding and by
 * errors of the opposed motions: the slip has one of `tolerated` [m/s], the parts of omega have those of the
 * tolerances. */
void turning_friction_events(const struct scene_instant *at, int contact, double tolerated, double relative,
                             double absolute, double offset[ODE_EVENTS_EACH], double events[ODE_EVENTS_EACH]);

/*
 * The energy at the end of a contact phase (projection methods: Hairer, Lubich, Wanner, Geometric Numerical
 * Integration, chapter IV.4). An integrator keeps it only to its tolerance; an impulse along the normal can
 * put it right exactly, without a change of momentum.
 *
 * The energy of the relative motion of the two bodies is restored to its value at the start of the phase. The
 * terms of this energy are m_red |w|^2 / 2, p_n g^2 / 2, and the potential of gravity where one body is not
 * free. The energy of the common motion does not count, because the energy of a light body's contact could be
 * rounding beside it. The energy is restored only where this undamped contact and gravity alone act on the
 * bodies, because an error in the work of another force would be taken for an error of the speed.
 */

/* Returns the energy of the relative motion at the instant `at` in the regimes of at->q [J]; zero where no
 * contact keeps it. The potential counts from zero displacement, because its constant part would cost
 * digits. */
double projection_balance(const struct scene_instant *at);

/* Restores the energy q->phase_energy of a contact that ends at the present of q. The speeds of the
 * integrator have errors of at most relative |w| + absolute [m/s] in a step. */
void projection_end_contact(struct scene_state *q, int contact, double relative, double absolute);

#endif
