/* What the general segment consists of; for general*.c only. */
#ifndef CONTACT_INTEGRATOR_GENERAL_STEP_H
#define CONTACT_INTEGRATOR_GENERAL_STEP_H

#include "integrator/general.h"
#include "math/polynomial.h"
#include "math/radau_step.h"
#include "scene/dense_output.h"
#include "scene/ode.h"

/* What remains of Newton's corrections, as part of the error allowed; less where momenta of what turns
 * shall be kept over a thousand impacts. */
#define GENERAL_NEWTON_SHARE 0.05
#define GENERAL_TURNING_NEWTON_SHARE 0.002

/* What peaks are of. */
enum { GENERAL_FORCE, GENERAL_DEPTH, GENERAL_LOADS };

struct general_event {
    double part; /* of the step; INFINITY: none */
    int event;   /* which function */
};

/* How far the last step goes. */
struct general_end {
    double clock;
    struct general_event event; /* that ends it */
    double *y;                  /* [size] */
};

struct general {
    struct scene_ode ode;
    struct scene_state *state; /* as ode.state */
    struct radau_step step;
    int size;
    int place[3 * SCENE_BODIES], speed[3 * SCENE_BODIES]; /* pairs of states for math/radau_step.h */
    double relative, absolute;                            /* error allowed in a step [1], [m, m/s, ...] */
    bool fully;            /* whether the step is stiff and radau_step_solve_fully solves it */
    double solvable;       /* the longest step that it solves, as far as known [s] */
    double simple;         /* the longest that simplified iterations solve, likewise [s] */
    double fastest_decay;  /* at the start of the step: of rates by their own states [1/s] */
    double place_rounding; /* there: of the gaps [m] */
    double error_within;   /* of the last step anywhere, by what is allowed */
    double error_at_end;   /* at its end, likewise */
    double error_of_start; /* of what dies away before its first stage, likewise */
    double longest;        /* length of a step of most stages that is accurate enough, as far as known [s] */
    double within_share;   /* of an error anywhere in the step, what is compared with that at its end */
    double read_share;     /* the same where outputs are read within the step; above 1 they are not */
    double *y, *size_of, *end_size; /* [size]: a state, and what errors are compared with */
    /* [size], by the start of the step: rounding of the rates of integrals; the largest errors of states */
    double *rate_rounding, *largest_error;
    struct general_end end;
    double at_start[ODE_EVENTS];                      /* event functions */
    double events[RADAU_MOST_STAGES + 1][ODE_EVENTS]; /* at the start of the step and its stages, smooth */
    double event_size[ODE_EVENTS];                    /* the largest there of the functions themselves */
    /* there, where something turns or rubs, and as Bernstein coefficients: F_n [N], -g [m] */
    double loads[RADAU_MOST_STAGES + 1][SCENE_CONTACTS][GENERAL_LOADS];
    double peaks[SCENE_CONTACTS][GENERAL_LOADS][BERNSTEIN_MOST];
    struct scene_output output[SCENE_CONTACTS];
    long rejected;
    void (*release)(void *memory); /* of this struct */
    char *message;                 /* INTEGRATOR_MESSAGE_SIZE bytes */
};

static inline double general_newton_share(const struct general *g)
{
    return g->step.problem.turns ? GENERAL_TURNING_NEWTON_SHARE : GENERAL_NEWTON_SHARE;
}

/* What is of values and state, not of a step; offsets of the events from the present instant
 * on; both, and a step that starts from the motion. */
void general_attach(struct general *g, const struct scene_values *v, struct scene_state *q);
void general_set_events(struct general *g, struct scene_instant *at);
void general_start(struct general *g, const struct scene_values *v, struct scene_state *q);

/* Begins steps at y; makes one of at most `limit` [s], accurate enough, as general->step;
 * false with a message where there is none, or where a `budget` of steps is used up. One that is longer than
 * `left` [s] is to be accurate at places within as well. */
void general_begin(struct general *g, double clock, const double *y);
bool general_step_make(struct general *g, double limit, double left, long *budget);

/* What peaks are found by, after general_first_event; moves the scene to a clock within the
 * step, or its end, and notes the peaks up to there and, where nothing turns, the impulses of torque. */
void general_set_peaks(struct general *g);
void general_move_scene(struct general *g, struct scene_state *q, double clock, const double *y);

/* Keeps the step in q; goes on with the one that q keeps, false where there is none; moves
 * the scene along it to a clock within. Where nothing turns or rubs no step is kept. */
void general_keep_step(const struct general *g, struct scene_state *q);
bool general_take_up(struct general *g, const struct scene_values *v, struct scene_state *q);
void general_follow(struct general *g, struct scene_state *q, double clock);

/* How long a step may be that is the first [s], INFINITY where nothing tells: by springs
 * between the bodies at the start of general->step; by impacts under Hertz's law that begin; of any step, by
 * regularized friction whose slip ends. */
double general_length_of_springs(const struct general *g);
double general_length_of_sliding(const struct scene_values *v, const struct scene_state *q);
double general_length_of_impacts(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at);

/* Errors allowed in the states, by their sizes in the step as far as that is known. */
void general_set_weights(struct general *g);

/* Whether something dies away within the step, so that its polynomial does not show each change. */
bool general_is_stiff(const struct general *g);

/* Completes a step whose stages are solved; its largest error, as part of what is allowed. */
double general_finish_step(struct general *g);

/* Solves a stiff step from its guess; false where that does not converge. Unless it is to be
 * done thoroughly a guess that goes on from the last step has to be a good one. */
bool general_solve_fully(struct general *g, bool thoroughly);

/* The first terminal event within general->step. */
struct general_event general_first_event(struct general *g);

/* Makes the step end there, and `y` the state at the event, `clock` its clock. Where a shorter step shows
 * that the event is not as early, the step ends before it: `found` is then none. False where no step is
 * accurate enough. */
bool general_end_at(struct general *g, struct general_event *found, double *clock, double *y);

#endif
