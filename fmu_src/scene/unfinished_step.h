/*
 * A step of the general segment (integrator/general.h) that ends at the communication point or goes on beyond
 * it: its polynomial in the states of scene/ode.h, and what the steps after it start from. It is a part of
 * the state of motion, so that a saved state goes on as the instance does from which it was saved.
 */
#ifndef CONTACT_SCENE_UNFINISHED_STEP_H
#define CONTACT_SCENE_UNFINISHED_STEP_H

#include <stdint.h>

#include "math/node_tables.h"
#include "scene.h"

enum {
    /* states at most: 6 of motion and 7 of rotation for each body, 3 of the spring and 9 impulses for each
     * contact, 3 energies; without rotation 6, 3 and 2 */
    ODE_MOST_STATES = SCENE_ANY_TURNING ? 13 * SCENE_BODIES + 12 * SCENE_CONTACTS + 3
                                        : 6 * SCENE_BODIES + 3 * SCENE_CONTACTS + 2,
    /* only scenes with free bodies that turn or rub keep a step */
    UNFINISHED_STATES = SCENE_ANY_TURNING && SCENE_ANY_FREE ? ODE_MOST_STATES : 1
};

struct unfinished_step {
    double start, length;    /* clock at its start, time up to its end [s] */
    double end;              /* clock at which it is left: at an event, or at its end [s] */
    double present;          /* clock up to which the motion has followed it [s] */
    double solvable, simple; /* as in struct general [s] */
    double at_start[UNFINISHED_STATES];
    double at_end[UNFINISHED_STATES];                           /* at the clock `end` */
    double weight[UNFINISHED_STATES];                           /* 1 / error allowed */
    double chebyshev[RADAU_MOST_STAGES + 1][UNFINISHED_STATES]; /* as in struct radau_step */
    double peaks[SCENE_CONTACTS][2][RADAU_MOST_STAGES + 1];     /* as in struct general */
    int32_t stages;
    int32_t event; /* which function of scene/ode.h ends it; -1: none */
};

#endif
