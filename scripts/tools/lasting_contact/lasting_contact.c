/*
 * lasting_contact exponential|plane|space PENALTY VISCOUS END STEPS RUNS
 *
 * Prints where the centre is at the end, what it cost in numbers, and the least time of RUNS, as one JSON
 * object; "failed" where an iteration did not converge. Radau IIA, in the plane or in space, reads its
 * coefficients from standard input (contact_fmus/lasting/study.py writes them).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "exponential.h"
#include "radau.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void print_outcome(const struct problem *p, const struct outcome *out, double seconds)
{
    printf("{\"position\": [%.17g, %.17g], \"steps\": %d, \"iterations\": %ld, \"evaluations\": %ld, ",
           out->x, out->z, p->steps, out->iterations, out->evaluations);
    printf("\"solves\": %ld, \"factorisings\": %ld, \"seconds\": %.3e}\n", out->solves, out->factorisings,
           seconds);
}

int main(int count, char **argument)
{
    struct radau_table table;
    struct outcome out = {0.0, 0.0, 0, 0, 0, 0};
    if (count != 7) {
        fputs("lasting_contact exponential|plane|space PENALTY VISCOUS END STEPS RUNS\n", stderr);
        return 2;
    }
    const bool by_radau = strcmp(argument[1], "exponential") != 0;
    const struct local *local = strcmp(argument[1], "plane") == 0 ? &local_plane : &local_space;
    const double penalty = strtod(argument[2], NULL);
    const struct problem p = {.penalty = penalty,
                              .viscous = strtod(argument[3], NULL),
                              .end = strtod(argument[4], NULL),
                              .steps = (int)strtol(argument[5], NULL, 10),
                              .omega = sqrt(penalty / MASS),
                              .root = sqrt(penalty * MASS)};
    if (by_radau && !radau_read(&table)) {
        fputs("lasting_contact: no coefficients\n", stderr);
        return 2;
    }
    double least = 1e9;
    for (long run = strtol(argument[6], NULL, 10); run > 0; --run) {
        const double start = now();
        if (!(by_radau ? radau_run(&table, local, &p, &out) : exponential_run(&p, &out))) {
            puts("{\"failed\": true}");
            return 0;
        }
        const double seconds = now() - start;
        least = seconds < least ? seconds : least;
    }
    print_outcome(&p, &out, least);
    return 0;
}
