/*
 * This file solves the stages of one step of the general segment, with the contact forces at the stages as
 * unknowns.
 *
 * Given the forces, all motion follows by quadrature. Each contact tells how far its force is from its laws,
 * in a form that is nearly linear in the forces: the normal force by the gap and its rate, friction that
 * rolls by the slip as a function of the force, friction that slides by the force as a function of the slip
 * (friction_missed). Newton's method solves for the forces; its slopes are kept as long as they serve.
 */
#ifndef CONTACT_INTEGRATOR_NODE_FORCES_H
#define CONTACT_INTEGRATOR_NODE_FORCES_H

#include "integrator/general.h"
#include "math/radau_step.h"
#include "scene/dense_output.h"
#include "scene/ode.h"

/* The quantities whose peaks are sought: the normal force and the penetration. */
enum { GENERAL_FORCE, GENERAL_DEPTH, GENERAL_LOADS };

struct general_event {
    double part; /* time from the start of the step, divided by its length; INFINITY: no event */
    int event;   /* index of the event function */
};

/* The end of the last step. */
struct general_end {
    double clock;
    struct general_event event; /* the event that ends the step, and the part of the step there */
};

/* This struct describes a contact that transmits a force, at the start of a step. */
struct general_rounding {
    double place;    /* rounding of the gap [m] */
    double spring;   /* stiffness of a spring that moves or turns a body [N/m] */
    double momentum; /* what moves at the point of contact times the speeds that meet [N s] */
    double force;    /* normal force [N] */
};

/* This struct holds the largest values among the contacts of an island, at the start of a step. */
struct general_island {
    double frequency; /* of the springs [rad/s] */
    double friction;  /* rounding of regularized friction, and of a force that moves no body [N] */
};

struct general {
    struct scene_ode ode;
    struct scene_state *state;                            /* as ode.state */
    struct radau_step step;                               /* of the bodies in contact (ode.layout) */
    size_t bytes;                                         /* bytes of memory from this struct on */
    int place[3 * SCENE_BODIES], speed[3 * SCENE_BODIES]; /* pairs of states for math/radau_step.h */
    double relative, absolute;                            /* error allowed in a step [1], [m, m/s, ...] */
    struct step_plan plan; /* a part of the state, so that a restored state continues bit for bit */
    struct general_rounding rounding[SCENE_CONTACTS];
    struct general_island island[ODE_MOST_GROUPS];
    int touching;         /* number of contacts that transmit forces at the start of the step */
    double fastest_decay; /* at the start of the step, of motions that friction and dashpots oppose [1/s] */
    double error_of_rolling; /* error where rolling ends within the step, divided by the error allowed */
    double error_within;     /* largest error within the last step, divided by the error allowed */
    double error_at_end;     /* error at the end of the last step, divided by the error allowed */
    bool error_is_noise;     /* whether rounding decides error_at_end */
    struct vec3 slip[SCENE_CONTACTS][OPPOSED]; /* the last sample of the slips in the step [m/s, rad/s] */
    double bend;         /* part of the step at which a force bends first and matters; INFINITY: nowhere */
    double within_share; /* factor of error_within when it is compared with error_at_end */
    double read_share;   /* within_share where outputs are read within the step */
    bool is_sampled;     /* whether `events` and `loads` are those of the solved step */
    double *y, *size_of, *end_size; /* [size]: a state; sizes of the states at both ends of the step */
    /* [size], noted at the start of the step: change of integrals and spins by an impulse of a contact,
     * divided by that impulse; largest errors allowed */
    double *per_impulse, *largest_error;
    struct scene_instant at_start;                    /* at the start of the step */
    struct scene_instant at_stage[RADAU_MOST_STAGES]; /* at the stages of node_forces_solve */
    struct general_end end;
    double events[RADAU_MOST_STAGES + 1][ODE_EVENTS]; /* event functions at start and stages, smoothed */
    double event_size[ODE_EVENTS];                    /* largest |event function| before smoothing */
    /* F_n [N] and -g [m] at the start and at the stages; their Bernstein coefficients */
    double loads[RADAU_MOST_STAGES + 1][SCENE_CONTACTS][GENERAL_LOADS];
    double peaks[SCENE_CONTACTS][GENERAL_LOADS][RADAU_MOST_STAGES + 1];
    long rejected;
    void (*release)(void *memory); /* frees this struct */
    void *nodes;                   /* [node_forces_memory()]: the iteration of node_forces_solve */
    void *steps;                   /* the memory of radau_step_place */
    char *message;                 /* INTEGRATOR_MESSAGE_SIZE bytes */
};

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
