/* One root of a smooth function inside a bracket on which it is monotone and changes sign. */
#ifndef CONTACT_MATH_ROOT_H
#define CONTACT_MATH_ROOT_H

#include <stdbool.h>

/* Writes f(s) and f'(s) for the function that `data` describes. */
typedef void root_function(const void *data, double s, double *value, double *slope);

/* Newton's method kept inside [low, high], 0 <= low < high, by bisection; exact to the rounding of f or of
 * s. */
double root_in_bracket(root_function *f, const void *data, double low, double high);

/* An end of a bracket with what is known there. */
struct root_bracket_end {
    double s, value, slope;
};

/* A first guess of the root: of the cubic through both ends, or of half a cosine where both ends are
 * extrema. */
double root_guess(struct root_bracket_end low, struct root_bracket_end high);

/* The root where f is known at both ends, other than zero at the first. */
double root_between(root_function *f, const void *data, struct root_bracket_end low,
                    struct root_bracket_end high);

/* A place and the value there. */
struct root_place {
    double s, value;
};

/* Whether a function that is positive at three ascending places, and lowest at the second, may fall below
 * zero about it: where the parabola through the three falls by at least half of that value. */
bool root_may_dip(const struct root_place place[3]);

/* Then where it is lowest between the first and the third, by golden sections, or below zero. */
double root_lowest(root_function *f, const void *data, const struct root_place place[3]);

#endif
