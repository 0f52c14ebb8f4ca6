/*
 * A ball let go at rest at the wall of a hollow cylinder, 60 degrees off its lowest line, seen along the
 * axis: problem P3 of the report with any penalty factor and dashpot, in which the contact never ends (the
 * pull of the spring and the dashpot included).
 */
#ifndef LASTING_PROBLEM_H
#define LASTING_PROBLEM_H

#include <stdbool.h>

static const double MASS = 0.1;     /* kg */
static const double GRAVITY = 9.81; /* m/s^2 */
static const double RADIUS = 0.45;  /* of the centre's path where the bodies just touch [m] */
static const double ANGLE = 1.0471975511965977;

struct problem {
    double penalty; /* p_n [N/m] */
    double viscous; /* p_nv [N s/m] */
    double end;     /* s */
    int steps;      /* all of one size */
    double omega;   /* sqrt(p_n / m) [1/s] */
    double root;    /* sqrt(m p_n) [kg/s] */
};

struct outcome {
    double x, z;       /* of the centre at the end [m] */
    long iterations;   /* of Newton; sweeps */
    long evaluations;  /* of the right side, at one instant */
    long solves;       /* of complex linear systems of four equations */
    long factorisings; /* of their matrices */
};

#endif
