/* One root of a smooth function inside a bracket on which it is monotone and changes sign. */
#ifndef CONTACT_BRACKET_H
#define CONTACT_BRACKET_H

/* Writes f(s) and f'(s) for the function that `data` describes. */
typedef void bracket_function(const void *data, double s, double *value, double *slope);

/* Newton's method kept inside [low, high], 0 <= low < high, by bisection; exact to the rounding of f or of s. */
double bracket_root(bracket_function *f, const void *data, double low, double high);

#endif
