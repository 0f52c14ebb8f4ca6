/* Constants of Radau IIA with simplified Newton iterations; source: scripts/tools/make_radau.py, which says
 * what each array holds. */
#ifndef CONTACT_MATH_RADAU_STAGES_H
#define CONTACT_MATH_RADAU_STAGES_H

struct radau_stages {
    int stages; /* s, even: all eigenvalues of A^-1 are complex, in s/2 pairs */
    const double *node, *integral, *inverse, *eigenvalue, *into, *back, *chebyshev, *bernstein;
};

enum { RADAU_MOST_STAGES = 12 };

extern const struct radau_stages radau_stages_4, radau_stages_8, radau_stages_12;

#endif
