/*
 * This file describes the state of motion of a scene. The struct is flat and has no pointers but that to the
 * scene's values, so that copying it saves it; a saved state of an FMU leaves the pointer out
 * (model/model.c). It has fields for every kind of scene; the fields that this scene has no code for stay
 * zero.
 *
 * Time is kept as base + base_tail + clock. The clock starts at zero whenever the motion is rebased (an
 * event, a change of input), so that short contacts keep all their digits at late times; base_tail holds what
 * base rounded away. Input paths are polynomials in the clock.
 */
#ifndef CONTACT_SCENE_SCENE_STATE_H
#define CONTACT_SCENE_SCENE_STATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "contact/friction.h"
#include "contact/law.h"
#include "math/node_tables.h"
#include "math/rotor.h"
#include "scene.h"

/* Where a free body was at clock 0. */
struct body_origin {
    struct vec3 displacement; /* u [m] */
    struct vec3 velocity;     /* v [m/s] */
};

/* Where a free body is now: u = origin.displacement + moved. A short motion far from the origin keeps all its
 * digits in `moved`. */
struct body_state {
    struct vec3 moved;    /* since clock 0 [m] */
    struct vec3 velocity; /* v [m/s] */
};

/* The states that turning bodies and friction add to those of the bodies. The integrator advances them. */
struct turning_state {
    /* of bodies whose rotation is free; a prescribed rotation follows its path from turn_origin */
    struct body_turn body[SCENE_BODIES];
    /* xi of elastic friction [m], theta of elastic rolling and spinning [rad]; zero where it is none */
    struct vec3 spring[SCENE_CONTACTS][OPPOSED];
};

/* The inputs that a prescribed rotation follows. */
enum turn_follows {
    TURN_FOLLOWS_VELOCITY, /* the angular velocity turns the body and its axis, from turn_origin on */
    TURN_FOLLOWS_AXIS, /* the angular velocity turns the body about its axis; the axis follows its own path */
    /* the axis alone sets the orientation, as the smallest rotation from z; for an importer's integrator */
    TURN_FOLLOWS_AXIS_ALONE
};

/* Between communication points an input is the sum of coefficient[i] clock^i. */
struct body_path {
    struct vec3 displacement[4];     /* of a prescribed body [m, m/s, ...] */
    struct vec3 velocity[3];         /* of a prescribed body [m/s, ...] */
    struct vec3 force[3];            /* external force on a free body [N, N/s, ...] */
    struct vec3 angular_velocity[3]; /* of a body of prescribed rotation [rad/s, rad/s^2, ...] */
    struct vec3 axis[3];             /* axis of a body of prescribed rotation, of any length */
    /* of a compound body of prescribed rotation at clock 0, of any length; from there it turns by its angular
     * velocity, in Model Exchange not at all */
    struct quaternion orientation;
    struct vec3 torque[3]; /* external torque on a body of free rotation [N m, ...] */
    double turn_follows;   /* enum turn_follows: what a body of prescribed rotation follows */
};

/* Parameters of a contact that are fixed at the start. */
struct contact_parameters {
    /* p_n and p_nv in force [N/m, N s/m]; k_h and chi [N/m^1.5, s/m], with restitution k_h and chi v */
    struct contact_coefficients factors;
    double diagonal;      /* of the bounding box of both bodies at the start [m] */
    double slip_velocity; /* v_0 of regularized friction [m/s] */
    struct vec3 axis;     /* e_d at the start, unit length; zero where the destination is a sphere */
#if SCENE_ANY_SKEW
    struct skew_frame skew; /* contact_skew_axes where the axes are skew, else zero */
#endif
};

/* This struct holds impulses of the force on the source [N s], and of the torques about the bodies' centres
 * [N m s]. */
struct contact_impulses {
    struct vec3 force, destination_torque, source_torque;
};

/* Quantities of a contact that integration changes besides the motion of the bodies. */
struct contact_physics {
    struct vec3 normal;              /* the last valid n, for d = 0 */
    struct contact_impulses impulse; /* since initialization */
    /* the gap g as integration has accumulated it, in contact and as contact ends; it is more accurate than
     * positions give it [m] */
    double accumulated_gap;
    /* g' at the end of the last segment, which has more digits than the velocities give [m/s] */
    double carried_rate;
    /* carried_rate is used while velocities differ from it by less than this; 0: it is not used [m/s] */
    double rate_rounding;
    /* the part of the peak force's rounding error that has not decayed; 0: negligible [N] */
    double force_error;
};

/* The past of a contact, as outputs show it. */
struct contact_record {
    struct contact_impulses impulse_mark; /* the impulses at the start of the communication step */
    double force_bound; /* upper bound of the peak force with its rounding error; 0: no bound is needed [N] */
    double onset_time;  /* the time at which the present or the last contact began [s] */
    double last_duration; /* duration of the last finished contact [s] */
    /* the clock at onset_time, negative after the clock's origin has moved; gives exact durations [s] */
    double touch_clock;
    int32_t onsets;
    int32_t unused; /* in place of padding */
};

/* The largest values over the last communication step. */
struct contact_peaks {
    double force;       /* [N] */
    double penetration; /* max(-g) >= 0 [m] */
};

/* Raises the peaks to a force [N] and a penetration [m] where these are larger. */
void contact_peaks_note(struct contact_peaks *peaks, double force, double penetration);

/* The changes of a contact that have been predicted. */
struct contact_schedule {
    /* the clock at which the regime changes, by a closed form; INFINITY: not before the horizon */
    double change_clock;
    /* until this clock a root finder cannot distinguish the regime from the one before */
    double dead_band_clock;
    double change_gap;     /* g at change_clock, more accurate than positions give it [m] */
    int32_t change_regime; /* the regime after change_clock */
    /* 1: d may fall to its rounding error before the horizon, so that n may be undefined; else 0 */
    int32_t passes_centre;
};

struct contact_state {
    struct contact_parameters parameters;
    double onset_damping; /* with restitution: chi of the present or the last contact [s/m] */
    struct contact_peaks peaks;
    struct contact_physics physics;
    struct contact_record record;
    struct contact_schedule schedule;
    int32_t regime; /* enum contact_regime */
    int32_t side;   /* +1 outside, -1 inside: the location in force */
    /* enum friction_regime of friction, rolling and spinning; of no meaning while the bodies are apart */
    int32_t friction_regime[OPPOSED];
    /* of a contact that is divided into zones, as in struct contact_solid; 0: whichever is nearest */
    int32_t zone;
};

/*
 * A step of the general segment (integrator/general.h) that reaches the communication point or goes beyond
 * it: the polynomial of the states of scene/ode.h over the step, and the start values of later steps. The
 * step is a part of the state of motion, so that a restored state goes on exactly as the instance that was
 * saved.
 */
enum {
    /* states at most: 6 of motion and 7 of rotation for each body, 3 of each spring and 9 impulses for each
     * contact, 3 energies; without rotation 6, 3 and 2 */
    ODE_MOST_STATES = SCENE_ANY_TURNING ? 13 * SCENE_BODIES + (9 + 3 * OPPOSED) * SCENE_CONTACTS + 3
                                        : 6 * SCENE_BODIES + 3 * SCENE_CONTACTS + 2,
    /* only scenes keep a step in which scene_keeps_steps may be true */
    UNFINISHED_STATES = SCENE_HAS_GENERAL && SCENE_ANY_FREE ? ODE_MOST_STATES : 1
};

struct unfinished_step {
    double start, length; /* the clock at the start of the step, and its length [s] */
    double end;           /* the clock of the event that ends the step early, or of its end [s] */
    double end_part;      /* the part of the step's length at the clock `end` */
    double present;       /* the clock up to which the motion has followed the step [s] */
    double at_start[UNFINISHED_STATES];
    double weight[UNFINISHED_STATES];                           /* 1 divided by the error allowed */
    double chebyshev[RADAU_MOST_STAGES + 1][UNFINISHED_STATES]; /* as in struct radau_step */
    double peaks[SCENE_CONTACTS][2][RADAU_MOST_STAGES + 1];     /* as in struct general */
    int32_t stages, pace; /* of the method of the step (math/node_tables.h) */
    int32_t event;        /* the index of the event function of scene/ode.h that ends the step; -1: none */
    int32_t unused;       /* in place of padding */
};

/* This struct holds what the general segment knows of its next step. */
struct step_plan {
    double longest; /* estimate of the longest accurate step of twelve stages [s]; 0: none yet */
    double last_length, last_error; /* of the last accepted step of this phase; a length of 0: none yet */
    double solvable;                /* estimate of the longest step that is solved where bodies rub [s] */
};

struct solver_counters {
    int32_t steps, force_evaluations, events, rejected_steps, fallbacks;
};

/* Adds to a counter; the counter stops at the largest FMI Integer. */
void counter_add(int32_t *counter, long more);

/*
 * The start of a phase of contact pairs (integrator/phases.c) that reaches beyond the communication point.
 * The motion within the phase is a function of its start and of the clock alone, so that communication points
 * within the phase change nothing.
 */
struct phase_start {
    double clock, longest; /* the clock at the start, and the longest time asked for [s] */
    double end;            /* the clock at the end of the phase; 0: there is no phase [s] */
    struct contact_physics contact[SCENE_CONTACTS];
    struct body_state body[SCENE_BODIES];
    struct body_turn turn[SCENE_BODIES]; /* of bodies whose rotation is free */
    double dissipated, external_work, friction_energy;
    struct solver_counters counters;
    int32_t unused;  /* in place of padding */
    double followed; /* the clock up to which the motion has followed the phase [s]; last, see phases.c */
};

struct scene_state {
    double base, base_tail, clock; /* [s] */
    struct contact_state contact[SCENE_CONTACTS];
    /* clock up to which regime changes have been predicted; at or before `clock`: predict again */
    double horizon_clock;
    /* steps may be deferred up to this clock, see flight_defer; 0: not known. Below zero: up to the opposite
     * clock, once the means and peaks of the last step have ended */
    double deferrable_clock;
    struct step_plan plan;                   /* may hold INFINITY */
    struct body_origin origin[SCENE_BODIES]; /* used where the body is free */
    struct body_state body[SCENE_BODIES];
    double phase_energy; /* projection_balance at the start of the phase [J] */
    /* since initialization [J]; friction_energy is taken by friction and its springs. The file scene/ode.c
     * copies these three numbers at once. */
    double dissipated, external_work, friction_energy;
    double step_length; /* length of the part of the last communication step that was completed [s] */
    /* time from the start of a phase to the last touch [s]; 0 at the start and after new inputs */
    double last_flight;
    struct body_path path[SCENE_BODIES];
    struct solver_counters counters;
    /* 1: integrators start from this state: neither CVODE's history nor `unfinished` matters */
    int32_t integrator_fresh;
    /* 1: the motion is deferred and stands at an earlier clock; see integrator_catch_up */
    int32_t deferred;
    int32_t only_flies; /* 1: the deferred steps are flights in which nothing turns; see outputs_foresee */
    const struct scene_values *v; /* of the scene */
    double deferred_from;         /* the clock at which the last deferred step began [s] */
    struct phase_start phase;     /* used by event_driven */
    /* the fields from here on have no meaning where nothing turns or rubs and no step is kept, see
     * scene_state_copy */
    struct turning_state turning;
    struct body_turn turn_origin[SCENE_BODIES]; /* at clock 0, of bodies that turn */
    /* event_driven goes on with this step unless `integrator_fresh`. sample_scene needs it to be last. */
    struct unfinished_step unfinished;
};

/* Returns the present time [s]. */
double scene_time(const struct scene_state *q);

/* Returns the time left until `end_time` [s], without the rounding of base + clock. */
double scene_remaining(const struct scene_state *q, double end_time);

/* Moves the origin of the clock to the present: paths are shifted, durations kept; nothing else changes. The
 * integrator restarts. The function is to be called after every change of body states, and not during a
 * deferred flight (flight/flight.h). */
void scene_rebase(struct scene_state *q);

/* Whether a body moves freely, by Newton's law; whether its motion is prescribed. The answers are
 * compile-time constants where the scene pins the choice. */
bool body_is_free(const struct scene_values *v, int body);
bool body_is_prescribed(const struct scene_values *v, int body);

/* Whether a body turns freely, by Euler's equations; whether its rotation is prescribed; whether it turns in
 * either way. The answers are compile-time constants where the scene pins the choice. */
bool body_turns_freely(const struct scene_values *v, int body);
bool body_turn_is_prescribed(const struct scene_values *v, int body);
bool body_turns(const struct scene_values *v, int body);

/* Moves the origin of the paths that the motion and the rotation of a body follow to a clock. */
void body_path_shift(const struct scene_values *v, int body, struct body_path *path, double clock);

/* Whether forces or torques move a body. */
bool body_moves_freely(const struct scene_values *v, int body);

/* Whether a body turns and its axis may turn with it: the axis of a sphere has no meaning, and that of a
 * cylinder which touches a cylinder keeps its direction. */
bool body_tips(const struct scene_values *v, int body);

/* Whether only conservative advancement finds a change of the contact: the destination's axis may turn, or it
 * is a torus, or the axes of both cylinders are skew. */
bool contact_advances(const struct scene_values *v, int contact);

/* Whether a contact is one of cylinders with skew axes. */
bool contact_has_skew_axes(const struct scene_values *v, int contact);

/* Returns the unit vector along the axis that a body has at the start. */
struct vec3 body_unit_axis(const struct scene_values *v, int body);

/* Sets those parameters of a contact that follow from the axes of its bodies. */
void contact_fix_axes(const struct scene_values *v, int contact, struct contact_parameters *fixed);

/* Whether a contact may have a friction force or resist rolling and spinning; whether it resists them. */
bool contact_rubs(const struct scene_values *v, int contact);
bool contact_resists(const struct scene_values *v, int contact);

/* Returns the number of opposed motions of a contact (contact/friction.h) that may have a law. */
int contact_opposed(const struct scene_values *v, int contact);

/* Whether an opposed motion of a contact has a spring; whether any has one. */
bool contact_has_spring(const struct scene_values *v, int contact, int part);
bool contact_has_springs(const struct scene_values *v, int contact);

/* Whether any body turns, any contact rubs, any shape is a torus or any axes are skew, which have no closed
 * forms. Else the scene is computed as one without rotation. */
bool scene_turns(const struct scene_values *v);

/* Whether a step of the general segment may go on beyond a communication point: in scenes that turn, and
 * where contacts share a free body. */
bool scene_keeps_steps(const struct scene_values *v);

/* Copies a state, but leaves out two fields where they have no meaning: `unfinished` where no step is kept
 * for the next call, and `turning` where nothing turns or rubs. */
void scene_state_copy(const struct scene_state *from, struct scene_state *to);

/* Whether the motion of a contact is prescribed: neither body is free or turns freely. */
bool contact_is_prescribed(const struct scene_values *v, int contact);

/* Whether no body is free or turns freely: the scene is a force element and has no states of bodies. */
bool scene_is_force_element(const struct scene_values *v);

/* Whether the motion may be integrated as differential equations (scene/ode.h): by CVODE, or by the general
 * segment of event_driven, for bodies in several contacts and where something turns or rubs. */
bool scene_uses_ode(const struct scene_values *v);

/* Whether a contact transmits a force: it is in compression or restitution. A separating contact counts too
 * while a spring of its friction relaxes, because no closed form has the spring. Whether any contact but
 * `except` transmits a force to a body. */
bool contact_transmits(const struct scene_state *q, int contact);
bool body_is_loaded(const struct scene_state *q, int body, int except);

/* Whether a contact transmits a force and one of its bodies is free. */
bool contact_pushes(const struct scene_state *q, int contact);

/* Islands are sets of contacts in touch that share free bodies. Contacts of one island have one number, which
 * counts from zero; -1: apart. */
struct islands {
    int count, largest; /* how many there are, and the number of contacts of the largest */
    int of[SCENE_CONTACTS];
};

struct islands scene_islands(const struct scene_state *q);

/* Whether a body is a compound: one rigid body of several spheres, its parts. */
bool body_is_compound(int body);

/* Whether a body has an axis of its own; spheres and compounds have none. */
bool body_has_axis(int body);

/* Whether the axis of a contact's destination tilts. */
bool contact_tips(const struct scene_values *v, int contact);

/* Whether another contact exerts a force on a free body of this contact, so that its motion is no polynomial
 * even while this one is apart. Constant false in scenes of one contact. */
bool contact_is_coupled(const struct scene_state *q, int contact);

#endif
