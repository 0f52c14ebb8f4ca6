/* Candidate events of a contact in flight: roots of polynomials among which the next change of regime is. */
#ifndef CONTACT_SEGMENT_FLIGHT_CANDIDATES_H
#define CONTACT_SEGMENT_FLIGHT_CANDIDATES_H

#include "math/root.h"
#include "segment/relative_path.h"

/* Touching, two ends and where their rounding ends, gap rate, law twice: so many roots together at most, as
 * none of them has the highest degree but the law. */
enum { MAX_CANDIDATES = 6 * POLYNOMIAL_MAX_DEGREE };

/* Where the distance has its extremes: between them it is monotone. */
struct extremes {
    double at[POLYNOMIAL_MAX_DEGREE];
    int count;
};

struct extremes extremes_of(const struct relative_path *path);

/* The least gap from now to the end of the path [m]. */
double candidates_least_gap(const struct relative_path *path);

/* The gap and its slope at s. */
struct root_bracket_end flight_gap_bracket_end(const struct relative_path *path, double s);

/* Passages of a cylinder's ends, sorted into `candidates` (MAX_CANDIDATES of them), of which there are
 * `count`; returns how many there are. */
int candidates_of_ends(const struct relative_path *path, double *candidates, int count);

/* All instants at which the regime may change: a superset, sorted. */
int candidates_of_all(const struct relative_path *path, const struct extremes *extremes,
                      const struct contact_shape *shape, const struct contact_law *law, double *candidates);

#endif
