/* The parts of the general segment that general.c and general_step.c share. */
#ifndef CONTACT_INTEGRATOR_GENERAL_STEP_H
#define CONTACT_INTEGRATOR_GENERAL_STEP_H

#include "integrator/general.h"
#include "math/polynomial.h"
#include "math/radau_step.h"
#include "scene/dense_output.h"
#include "scene/ode.h"

/* Newton's iteration ends when its last correction is below this part of the error allowed in a step. The
 * part is smaller where bodies turn, because the angular momentum shall be kept over a thousand impacts. */
#define GENERAL_NEWTON_SHARE 0.05
#define GENERAL_TURNING_NEWTON_SHARE 0.002

/* The quantities whose peaks are sought: the normal force and the penetration. */
enum { GENERAL_FORCE, GENERAL_DEPTH, GENERAL_LOADS };

struct general_event {
    double part; /* time from the start of the step, divided by its length; INFINITY: no event */
    int event;   /* index of the event function */
};

/* The end of the last step. */
struct general_end {
    double clock;
    struct general_event event; /* the event that ends the step */
    double *y;                  /* [size] */
};

/* The largest of the contacts of an island that transmit forces, at the start of a step. */
struct general_rounding {
    double place;    /* rounding of the gap [m] */
    double friction; /* rounding of regularized friction, and of the force between moved bodies [N] */
    double mass;     /* reduced mass [kg] */
    double momentum; /* reduced mass times the speeds that meet [N s] */
    double force;    /* normal force [N] */
};

struct general {
    struct scene_ode ode;
    struct scene_state *state;  /* as ode.state */
    struct radau_step step;     /* of the bodies in contact (ode.layout) */
    struct radau_problem whole; /* that of all states, for which there is memory */
    int size;
    int place[3 * SCENE_BODIES], speed[3 * SCENE_BODIES]; /* pairs of states for math/radau_step.h */
    double relative, absolute;                            /* error allowed in a step [1], [m, m/s, ...] */
    double solvable;      /* estimate of the longest step that is solved where bodies rub [s] */
    double fastest_decay; /* fastest decay of a state at the start of the step [1/s] */
    struct general_rounding rounding[ODE_MOST_GROUPS]; /* of each group of states */
    double error_of_rolling; /* error where rolling ends within the step, divided by the error allowed */
    double error_within;     /* largest error within the last step, divided by the error allowed */
    double error_at_end;     /* error at the end of the last step, divided by the error allowed */
    bool error_is_noise;     /* whether rounding decides error_at_end */
    double error_of_start;   /* error by decay before the first stage, divided by the error allowed */
    double longest;          /* estimate of the longest accurate step of twelve stages [s] */
    double last_length, last_error; /* of the last accepted step of this phase; a length of 0: none yet */
    double swing[SCENE_CONTACTS]; /* F_n / (m_red d) of contacts in touch, at the start of the step [1/s^2] */
    double since_touch[SCENE_CONTACTS]; /* time since the touch under Hertz's law [s]; INFINITY: long ago */
    double release_clock;               /* when a contact under Hertz's law ends; INFINITY: not known */
    double release_rest;                /* what a step to that release leaves for the steps after it [s] */
    int steps_to_release;               /* number of steps made to that release */
    struct vec3 slip[SCENE_CONTACTS][OPPOSED]; /* the last sample of the slips in the step [m/s, rad/s] */
    double bend;         /* part of the step at which friction bends first and matters; INFINITY: nowhere */
    double within_share; /* factor of error_within when it is compared with error_at_end */
    double read_share;   /* within_share where outputs are read within the step */
    bool is_sampled;     /* whether `events` and `loads` are those of the solved step */
    double *y, *size_of, *end_size; /* [size]: a state; sizes of the states at both ends of the step */
    /* [size], noted at the start of the step: change of integrals and spins by an impulse of a contact,
     * divided by that impulse; largest errors allowed */
    double *per_impulse, *largest_error;
    struct scene_instant at_stage[RADAU_MOST_STAGES]; /* at the stages of node_forces_solve */
    struct general_end end;
    double at_start[ODE_EVENTS];                      /* event functions at the start */
    double events[RADAU_MOST_STAGES + 1][ODE_EVENTS]; /* event functions at start and stages, smoothed */
    double event_size[ODE_EVENTS];                    /* largest |event function| before smoothing */
    /* F_n [N] and -g [m] at the start and at the stages; their Bernstein coefficients */
    double loads[RADAU_MOST_STAGES + 1][SCENE_CONTACTS][GENERAL_LOADS];
    double peaks[SCENE_CONTACTS][GENERAL_LOADS][RADAU_MOST_STAGES + 1];
    struct scene_output output[SCENE_CONTACTS];
    long rejected;
    void (*release)(void *memory); /* frees this struct */
    void *nodes;                   /* [node_forces_memory()]: the iteration of node_forces_solve */
    char *message;                 /* INTEGRATOR_MESSAGE_SIZE bytes */
};

/* Whether bodies may turn and rub. */
static inline bool general_rubs(const struct general *g)
{
    return SCENE_ANY_FRICTION && g->step.problem.turns;
}

static inline double general_newton_share(const struct general *g)
{
    return g->step.problem.turns ? GENERAL_TURNING_NEWTON_SHARE : GENERAL_NEWTON_SHARE;
}

/* general_begin begins steps at the state `y`. general_step_make makes one accurate step of at most `limit`
 * [s] in g->step. It returns false with a message where no step is accurate enough, and false where the
 * `budget` of steps is used up. A step longer than `left` [s] is accurate within as well, because outputs are
 * read there. release_within returns the clock of the first release under Hertz's law within g->step, or
 * INFINITY. */
void general_begin(struct general *g, double clock, const double *y);
bool general_step_make(struct general *g, double limit, double left, long *budget,
                       double (*release_within)(struct general *g));
bool general_force_bends(const struct general *g, int contact);

/* Each function returns a limit of a step's length [s]; INFINITY: no limit. The springs at the start of
 * g->step and impacts that begin under Hertz's law limit the first step. Regularized friction whose slip is
 * about to end limits every step. */
double general_length_of_springs(const struct general *g);
double general_length_of_sliding(const struct general *g);
double general_length_of_impacts(const struct scene_instant *at);

/* Sets the errors allowed in the states from their sizes in the step. */
void general_set_weights(struct general *g);

/* Whether a state decays within the step so fast that the polynomial does not follow it. */
bool general_is_stiff(const struct general *g);

/* Completes a step whose stages are solved. Returns its largest error, divided by the error allowed. */
double general_finish_step(struct general *g);

#endif
