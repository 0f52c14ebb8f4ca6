/* One root of a smooth function inside a bracket on which it is monotone and changes sign. */
#ifndef CONTACT_MATH_ROOT_H
#define CONTACT_MATH_ROOT_H

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

#endif
