/*
 * One step of Radau IIA for y' = f(t, y): the polynomial through the start that has the right rate at all
 * stages. Of s stages, order 2 s - 1 at its end and s within; what is too fast for the step is damped away
 * (Hairer and Wanner, Solving Ordinary Differential Equations II, chapter IV.8). Simplified Newton
 * iterations with the Jacobian at the start, split by the eigenvalues of A^-1 into s/2 complex systems of
 * the problem's size.
 *
 * Of the states the first `coupled` depend on each other. From `integrals` on they are integrals of what
 * depends on those. Those between are quaternions q' = w q, w a quaternion that depends on the coupled
 * states: each feels but itself. Neither are a part of the systems; nor are states whose rate is another
 * state: these are eliminated.
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
    bool turns; /* radau_step_solve_fully may be asked for, and needs whole_jacobian */
    int paired; /* so many states y[place[i]] have the rate y[speed[i]], both coupled */
    const int *place, *speed;
    void (*rates)(const void *context, double clock, const double *y, double *rates);
    /* of the coupled states: d(rate i)/d(y j) at [j * coupled + i] */
    void (*jacobian)(const void *context, double clock, const double *y, double *columns);
    /* of all states: d(rate i)/d(y j) at [j * size + i] */
    void (*whole_jacobian)(const void *context, double clock, const double *y, double *columns);
    /* 0, or so many forces, fewer than states left, do all that couples them but for the last `tipping` of
     * the coupled states, whose rates also depend on the other states: `columns` as the Jacobian has them
     * without the forces; d(rate i)/d(force j) at [j * coupled + i]; d(force i)/d(y j) at [j * forces + i] */
    int forces, tipping;
    void (*split_jacobian)(const void *context, double clock, const double *y, double *columns,
                           double *by_forces, double *of_forces);
};

/* Of math/radau_step.c: of one stage as it is asked for; of all stages by states left, then places; what
 * follows from forces; room for sums. */
struct radau_forces {
    double *by_forces, *of_forces;
    double *by, *of, *own, *tips, *twice;
    double *row, *change, *places, *moved, *side;
    const struct radau_stages *twice_of; /* whose A^2 `twice` is; NULL: nobody's */
};

struct radau_step {
    struct radau_problem problem;
    const struct radau_stages *stages; /* of the last solution */
    double start, length;              /* clock, and length of the last solution */
    int evaluations;                   /* of the rates, since whoever counts them set it to zero */
    int iterations;                    /* of the last solution */
    double contraction;                /* of the corrections, in that */
    double *y, *start_rates;           /* [size], at the start */
    double *change, *rates;            /* [stages][stride]: the states less y, and their rates */
    double *chebyshev; /* [stages + 1][stride]: of change, from -1 at the start to 1 at the end */
    double known_start, known_length; /* and its start, length and stages; length 0: there is none */
    int known_stages;
    double *weight;                /* [size]: 1 / error allowed, by the caller */
    double *jacobian;              /* [coupled][coupled], by columns */
    double *by_others, *by_places; /* of those left: [others][others], [paired][others], by columns */
    struct complex_matrix system[RADAU_MOST_STAGES / 2];
    double factored_length; /* what the systems hold; 0: nothing */
    const struct radau_stages *factored_stages;
    double *others_change, *residual, *scratch; /* [stages][width] */
    double *places_change;                      /* [stages][paired, padded] */
    double *stage_others, *stage_places, *side; /* of radau_step_solve_fully */
    double *whole;                              /* [size][size]; of that, too */
    struct dense_matrix all;
    struct radau_forces forces; /* of that where forces are its unknowns */
    double *point, *re;         /* [size] each */
    int stride, width;          /* of rows, padded: of all states, of those left */
    int others;                 /* how many are coupled, but no places */
    int *other;                 /* [others]: which they are */
    int *speed_among;           /* [paired]: where a speed stands among them */
};

/* Bytes of memory for a problem of so many states, and a step that uses them for one of no more. */
size_t radau_step_memory(const struct radau_problem *problem);
void radau_step_place(struct radau_step *p, const struct radau_problem *problem, void *memory);

/* Begins at a state; evaluates rates and Jacobian there. */
void radau_step_begin(struct radau_step *p, double clock, const double *y);

/* Starts the iterations from the solution of the linear problem; from the last polynomial, for a step of
 * another length. To be followed by radau_step_solve with the same arguments. False where the systems have
 * no solution. */
bool radau_step_guess(struct radau_step *p, const struct radau_stages *stages, double length);
bool radau_step_guess_again(struct radau_step *p, const struct radau_stages *stages, double length);

/* Starts them, for radau_step_solve_fully, from the last polynomial, if it begins or ends at the start,
 * else from the rates there: stiff directions that turn would mislead the solution of the linear problem.
 * */
void radau_step_guess_on(struct radau_step *p, const struct radau_stages *stages, double length);

/* Whether the last polynomial does begin or end where the step begins. */
bool radau_step_goes_on(const struct radau_step *p);

/* Writes the coupled states at a stage, as far as they are known; the others are left as they are. */
void radau_step_stage(const struct radau_step *p, int stage, double *y);

/* Iterates until what is left of the correction is below `tolerance`, by the weights, or rounding. False
 * where that does not happen. */
bool radau_step_solve(struct radau_step *p, double tolerance);

/* The same with the Jacobian at every stage: dearer, but it converges where what is stiff turns within the
 * step. Quickly: from a good guess only, given up soon otherwise. To approach it is to be about as close as
 * the errors allowed: a guess for another problem. */
bool radau_step_solve_fully(struct radau_step *p, double tolerance);
bool radau_step_solve_quickly(struct radau_step *p, double tolerance);
bool radau_step_approach(struct radau_step *p);

/* Error at the end, by the weights, of what dies away before the first stage, where the stages do not see
 * it: after radau_step_finish. It is nothing where that dies away still at the end: the states forget it.
 * */
double radau_step_start_error(struct radau_step *p);

/* Makes a step that is known from elsewhere the last solution: its coefficients [count + 1][size] in rows of
 * `stride`, `count` stages. */
void radau_step_take_over(struct radau_step *p, double start, double length, const double *y, int count,
                          const double *chebyshev, int stride);

/* The polynomial of all states, once solved; the state at a part of the step, 0 to 1. */
void radau_step_finish(struct radau_step *p);
void radau_step_at(const struct radau_step *p, double part, double *y);

/* Estimated error of the polynomial anywhere in the step, of its end; by the weights. */
struct radau_error {
    double within, at_end;
};
struct radau_error radau_step_error(const struct radau_step *p);

#endif
