/*
 * One step of Radau IIA for y' = f(t, y) is the polynomial through the start that has the right rate at all
 * stages. With s stages its order is 2 s - 1 at the end and s within; parts of the motion that are too fast
 * for the step are damped away (Hairer and Wanner, Solving Ordinary Differential Equations II, chapter IV.8).
 * The caller finds the rates at the stages by iterations of its own, such as those of
 * integrator/node_forces.c. The polynomial is one of time, or of a place whose time has another pace where
 * forces are no polynomials of time (math/node_tables.h).
 *
 * The states come in three groups. The first `coupled` states depend on each other. Next come quaternions q'
 * = w q, where w depends on the coupled states; each feels only itself. From `integrals` on, the states are
 * integrals of functions of the others. Iterations move the coupled states alone. The rate of some of these,
 * places, is another state, their speed; the coupled states that are no places are called the others.
 */
#ifndef CONTACT_MATH_RADAU_STEP_H
#define CONTACT_MATH_RADAU_STEP_H

#include <stdbool.h>
#include <stddef.h>

#include "math/lu.h"
#include "math/node_tables.h"

struct radau_problem {
    const void *context;
    int size, coupled, integrals;
    bool turns;   /* whether bodies turn, which the caller asks */
    int unknowns; /* the most unknowns at a stage of the caller's iterations */
    int paired;   /* number of states y[place[i]] whose rate is y[speed[i]]; both are coupled */
    const int *place, *speed;
    void (*rates)(const void *context, double clock, const double *y, double *rates);
};

/* The matrix of the caller's iterations, `all`, has room for all unknowns at twelve stages, or for this
 * number of rows, which take 32 MB. More unknowns have room at four stages. */
enum { RADAU_ROOM = 2048, RADAU_LEAST_STAGES = 4 };

struct radau_step {
    struct radau_problem problem;
    const struct radau_stages *stages; /* method of the last solution */
    double start, length;              /* clock at the start, and length of the last solution [s] */
    int evaluations;                   /* number since the caller set it to zero */
    int iterations;                    /* number in the last solution, counted by the caller */
    /* [size]: states at the start; rates there, which radau_step_guess_on sets if no polynomial goes on */
    double *y, *start_rates;
    double *change, *rates; /* [stages][stride]: the states less y, and their rates */
    double *chebyshev;      /* [stages + 1][stride]: coefficients of change, -1 at the start, 1 at the end */
    double known_start, known_length; /* start and length of `chebyshev`; length 0: there is none */
    const struct radau_stages *known; /* its method */
    double *weight;                   /* [size]: 1 / error allowed, set by the caller */
    double *others_change;            /* [stages][width] */
    double *bare, *scratch, *more;    /* [stages][width], for the caller */
    double *places_change;            /* [stages][paired, padded] */
    struct lu_matrix all;             /* for the caller, as `side`: [radau_room] rows */
    double *side;
    double *point, *re; /* [size] each */
    int stride, width;  /* padded lengths of rows of all states, and of the others */
    int others;         /* number of coupled states that are no places */
    int *other;         /* [others]: their indices */
    int *among;         /* [coupled]: index of a state among the others; -1: a place */
};

/* The first returns the number of rows of the matrix `all`, the second the bytes of memory for a problem; the
 * third sets up a step in such memory. */
int radau_room(const struct radau_problem *problem);
size_t radau_step_memory(const struct radau_problem *problem);
void radau_step_place(struct radau_step *p, const struct radau_problem *problem, void *memory);

/* Begins a step at the state y. */
void radau_step_begin(struct radau_step *p, double clock, const double *y);

/* Starts iterations from the last polynomial if it begins or ends at the start, else from the rates there. */
void radau_step_guess_on(struct radau_step *p, const struct radau_stages *stages, double length);

/* radau_step_pending serves at least `count` of the others, the coupled states that are no places, from
 * number `first` on. It writes the integrals of their `rates` from the start to each stage, less `done` (1
 * or 0) times their changes. All arrays are [stage][p->width]. radau_step_integrate sets the changes of
 * the coupled states to the integrals, and returns the largest weighted difference from the changes
 * before. After radau_step_guess_on from a polynomial, radau_step_guess_rates gives the rates of `count`
 * states from `first` on, along the guess, at [stage * count + state]. */
void radau_step_pending(const struct radau_step *p, int first, int count, const double *rates, double done,
                        double *pending);
double radau_step_integrate(struct radau_step *p, const double *rates);
void radau_step_guess_rates(const struct radau_step *p, int first, int count, double *rates);

/* Whether the last polynomial begins where the step begins, or ends there and can be continued: a polynomial
 * to a release cannot. */
bool radau_step_goes_on(const struct radau_step *p);

/* Writes the coupled states at a stage by the last iteration, and leaves the other entries of y alone. */
void radau_step_stage(const struct radau_step *p, int stage, double *y);

/* Takes over a step as the last solution: its Chebyshev coefficients [stages + 1][size] in rows of `stride`
 * numbers. */
void radau_step_take_over(struct radau_step *p, double start, double length, const double *y,
                          const struct radau_stages *stages, const double *chebyshev, int stride);

/* radau_stages_of returns the method with this number of stages and this pace. The time of a step is a
 * function of its place: radau_place returns the place at which a part, 0 to 1, of the step's length has
 * passed, and radau_part the part that has passed at a place. Parts above 1 have places too, in a step to a
 * release only up to the release. */
const struct radau_stages *radau_stages_of(int stages, enum radau_pace pace);
double radau_place(const struct radau_stages *stages, double part);
double radau_part(const struct radau_stages *stages, double place);

/* Makes the polynomial of all states of a solved step; the states at a part of the step's length, 0 to 1. */
void radau_step_finish(struct radau_step *p);
void radau_step_at(const struct radau_step *p, double part, double *y);

/* Estimated error of the polynomial within the step and at its end, by the weights. */
struct radau_error {
    double within, at_end;
};
struct radau_error radau_step_error(const struct radau_step *p);

#endif
