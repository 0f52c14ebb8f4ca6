/* One root of a smooth function inside a bracket on which it is monotone and changes sign. */
#ifndef CONTACT_BRACKET_H
#define CONTACT_BRACKET_H

/* Writes f(s) and f'(s) for the function that `data` describes. */
typedef void bracket_function(const void *data, double s, double *value, double *slope);

/* Newton's method kept inside [low, high], 0 <= low < high, by bisection; exact to the rounding of f or of s. */
double bracket_root(bracket_function *f, const void *data, double low, double high);

/* An end of a bracket with what is known there. */
struct bracket_end {
    double s, value, slope;
};

/* Of the cubic through both ends, of half a cosine where both are turns. */
double bracket_guess(struct bracket_end low, struct bracket_end high);

/* The root where f is known at both ends, other than zero at the first. */
double bracket_root_between(bracket_function *f, const void *data, struct bracket_end low,
                            struct bracket_end high);

#endif
