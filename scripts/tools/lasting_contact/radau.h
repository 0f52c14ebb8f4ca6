/* Radau IIA with any number of stages in local coordinates, by simplified Newton iterations (Hairer and
 * Wanner, Solving Ordinary Differential Equations II, IV.8). */
#ifndef LASTING_RADAU_H
#define LASTING_RADAU_H

#include <complex.h>

#include "local.h"

enum { RADAU_STAGES = 16, RADAU_SYSTEMS = RADAU_STAGES / 2 + 1 };

/* A^-1 = T diag(lambda) T^-1; of a pair of conjugate eigenvalues only one, with weight 2. */
struct radau_table {
    int stages, systems;
    double inverse[RADAU_STAGES][RADAU_STAGES]; /* A^-1 */
    double weight[RADAU_SYSTEMS];
    double complex lambda[RADAU_SYSTEMS];
    double complex vectors[RADAU_STAGES][RADAU_SYSTEMS];   /* T */
    double complex covectors[RADAU_SYSTEMS][RADAU_STAGES]; /* T^-1 */
};

/* From standard input; false where something is missing. */
bool radau_read(struct radau_table *table);

/* Whether every Newton iteration converged. */
bool radau_run(const struct radau_table *table, const struct local *local, const struct problem *problem,
               struct outcome *outcome);

#endif
