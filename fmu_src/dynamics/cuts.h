/* Instants at which the regime of a contact in flight may change: roots of polynomials. */
#ifndef CONTACT_CUTS_H
#define CONTACT_CUTS_H

#include "contact/bracket.h"
#include "dynamics/approach.h"

#if SCENE_ANY_FREE

/* Touching, two ends, gap rate, law twice: at most so many roots together. */
enum { MAX_CUTS = 6 * POLYNOMIAL_MAX_DEGREE };

/* Where the distance has its extremes: between them it is monotone. */
struct extremes {
    double at[POLYNOMIAL_MAX_DEGREE];
    int count;
};

struct extremes extremes_of(const struct approach *path);

/* The least gap from now to the end of the path [m]. */
double cuts_least_gap(const struct approach *path);

/* The gap and its slope at s. */
struct bracket_end cuts_gap_end(const struct approach *path, double s);

/* Passages of a cylinder's ends, sorted into `cuts` (MAX_CUTS of them), of which there are `count`; returns how many there are. */
int cuts_of_ends(const struct approach *path, double *cuts, int count);

/* All instants at which the regime may change: a superset, sorted. */
int cuts_of_all(const struct approach *path, const struct extremes *extremes,
                const struct contact_shape *shape, const struct contact_law *law, double *cuts);

#endif
#endif
