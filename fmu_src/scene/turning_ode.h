/*
 * What scenes that turn or rub add to the scene's differential equations (scene/ode.h), for ode.c and
 * ode_jacobian.c.
 */
#ifndef CONTACT_SCENE_TURNING_ODE_H
#define CONTACT_SCENE_TURNING_ODE_H

#include "scene/ode.h"
#include "scene/turning_motion.h"

#if SCENE_ANY_TURNING

/* Where the states are in y; -1: there is none. */
struct turning_layout {
    int spin[SCENE_BODIES];        /* L / I_1 */
    int orientation[SCENE_BODIES]; /* w, x, y, z */
    int spring[SCENE_CONTACTS];
    int coupled, integrals; /* see ode_coupled, ode_integrals */
};

enum { TURNING_IMPULSES = 9 }; /* of a contact: of force, of torque on the source, on the destination */

struct turning_layout turning_layout_of(const struct scene_values *v);

/* I_1 of a body of free rotation [kg m^2], and I_1/I_3 - 1. */
double turning_inertia(const struct scene_values *v, int body);
double turning_flatness(const struct scene_values *v, int body);

/* The orientation in y, made unit. */
struct quaternion turning_orientation_from(const double *data);

/* The states of bodies that turn and of springs into y, and out of it; y's orientations need not be unit. */
void turning_pack(const struct scene_ode *ode, double *y);
void turning_unpack(const struct scene_values *v, const double *y, struct turning_state *turning);

/* The rest of y: impulses of torques and the work on friction. */
void turning_pack_integrals(const struct scene_ode *ode, double *y);
void turning_unpack_integrals(const struct scene_values *v, struct scene_state *q, const double *y);

/* The rates of all of these, and the event functions of a contact; `at` is the instant at y. */
void turning_rates(const struct scene_ode *ode, double clock, const double *y, const struct scene_instant *at,
                   double *rates);
void turning_events(const struct scene_ode *ode, double clock, const double *y,
                    const struct scene_instant *at, int contact, double out[ODE_EVENTS_EACH]);

/* The leading `size` rows and columns of the Jacobian, by columns. */
void turning_jacobian(const struct scene_ode *ode, double clock, const double *y, int size, double *columns);

/* As ode_split_jacobian has it. */
void turning_split_jacobian(const struct scene_ode *ode, double clock, const double *y, double *columns,
                            double *by_forces, double *of_forces);

/* Sets the offsets of these event functions of a contact for a phase that begins at the instant `at` of
 * ode->state, of speeds that are right to `tolerated` [m/s]. */
void turning_begin(struct scene_ode *ode, const struct scene_instant *at, int contact, double tolerated);

/* The event functions of friction at the present of ode->state, the instant `at`, each raised by twice what
 * rounding and an error of the speeds by `tolerated` [m/s] make of it. */
void turning_friction_events(struct scene_ode *ode, const struct scene_instant *at, int contact,
                             double tolerated, double events[ODE_EVENTS_EACH]);

/* Sizes to compare errors with, as ode_nominal has them. */
void turning_nominal(const struct scene_ode *ode, const double *y, double *sizes);

#endif
#endif
