#include "segment/flight_candidates.h"

/* chi g' = 1, where Hunt and Crossley's damping would begin to pull: g' = side (c.w)/d, of a plane n.w,
 * squared. */
static struct polynomial hertz_condition(const struct relative_path *path, const struct contact_law *law)
{
    const double unit = contact_factors_of(law).c * path->scale / path->horizon;
    const struct polynomial one = {{1.0}, 0};
    const struct polynomial distance2 =
        SCENE_ANY_PLANE && path->flat ? one : relative_path_distance_squared(path);
    const struct polynomial squared_rate = polynomial_multiply(&path->half_rate, &path->half_rate);
    struct polynomial sum = {{0.0}, 0};
    sum = polynomial_add(&sum, fmin(unit * unit, 1.0), &squared_rate);
    return polynomial_add(&sum, -fmin(1.0 / (unit * unit), 1.0), &distance2);
}

/* k g + c g' of a plane: a polynomial as it stands. */
static struct polynomial law_condition_of_plane(const struct relative_path *path,
                                                const struct contact_law *law)
{
    const struct contact_coefficients full = contact_coefficients_of(law, REGIME_COMPRESSION);
    const double scaled_damping = full.c / path->horizon;
    const double unit = fmax(full.k, scaled_damping);
    struct polynomial gap = {{path->gap}, path->degree};
    for (int i = 1; i <= path->degree; ++i) {
        gap.a[i] = path->c[i].x;
    }
    struct polynomial sum = {{0.0}, 0};
    sum = polynomial_add(&sum, full.k / unit, &gap);
    return polynomial_add(&sum, scaled_damping / unit, &path->half_rate);
}

/* k (d - reach) + c d' = 0, times d, with the root squared: (k d^2 + c d d')^2 = k^2 reach^2 d^2. */
static struct polynomial law_condition(const struct relative_path *path, const struct contact_law *law)
{
    const struct contact_coefficients full = contact_coefficients_of(law, REGIME_COMPRESSION);
    const double scaled_damping = full.c / path->horizon;
    const double unit = fmax(full.k, scaled_damping);
    const double k = full.k / unit;
    struct polynomial sum = {{0.0}, 0};
    const struct polynomial offset2 = relative_path_distance_squared(path);
    sum = polynomial_add(&sum, k, &offset2);
    sum = polynomial_add(&sum, scaled_damping / unit, &path->half_rate);
    const struct polynomial squared_sum = polynomial_multiply(&sum, &sum);
    const double reach_term = k * path->reach;
    return polynomial_add(&squared_sum, -reach_term * reach_term, &offset2);
}

/* k (d - reach) + c d' = 0 times d + reach, with reach / d for 1 where the gap is small: exact the closer the
 * bodies are, where the squares above have lost the gap to rounding. */
static struct polynomial law_condition_nearby(const struct relative_path *path, const struct contact_law *law)
{
    const struct contact_coefficients full = contact_coefficients_of(law, REGIME_COMPRESSION);
    const double scaled_damping = full.c / path->horizon;
    const double unit = fmax(full.k, scaled_damping);
    const struct polynomial squared_deviation = relative_path_squared_deviation(path);
    struct polynomial sum = {{0.0}, 0};
    sum = polynomial_add(&sum, full.k / unit, &squared_deviation);
    return polynomial_add(&sum, 2.0 * scaled_damping / unit, &path->half_rate);
}

static int insert_candidate(double root, double *candidates, int count)
{
    int at = count;
    for (; at > 0 && candidates[at - 1] > root; --at) {
        candidates[at] = candidates[at - 1];
    }
    candidates[at] = root;
    return count + 1;
}

static int add_candidates(const struct polynomial *p, double *candidates, int count)
{
    double roots[POLYNOMIAL_MAX_DEGREE];
    const int found = polynomial_sign_changes(p, roots);
    for (int i = 0; i < found; ++i) {
        count = insert_candidate(roots[i], candidates, count);
    }
    return count;
}

struct extremes extremes_of(const struct relative_path *path)
{
    struct extremes found;
    found.count = polynomial_sign_changes(&path->closing, found.at);
    return found;
}

struct root_bracket_end flight_gap_bracket_end(const struct relative_path *path, double s)
{
    struct root_bracket_end end = {.s = s};
    relative_path_gap(path, s, &end.value, &end.slope);
    return end;
}

double candidates_least_gap(const struct relative_path *path)
{
    const struct extremes extremes = extremes_of(path);
    double least = fmin(path->gap, flight_gap_bracket_end(path, 1.0).value);
    for (int i = 0; i < extremes.count; ++i) {
        least = fmin(least, flight_gap_bracket_end(path, extremes.at[i]).value);
    }
    return path->scale * least;
}

/* Where the gap passes zero. */
static int touching_candidates(const struct relative_path *path, const struct extremes *extremes,
                               double *candidates, int count)
{
    const int intervals = extremes->count + 1;
    struct root_bracket_end low = flight_gap_bracket_end(path, 0.0);
    for (int i = 0; i < intervals; ++i) {
        const struct root_bracket_end high =
            flight_gap_bracket_end(path, i < intervals - 1 ? extremes->at[i] : 1.0);
        if ((low.value < 0.0 && high.value > 0.0) || (low.value > 0.0 && high.value < 0.0)) {
            count = insert_candidate(root_between(relative_path_gap, path, low, high), candidates, count);
        }
        low = high;
    }
    return count;
}

int candidates_of_ends(const struct relative_path *path, double *candidates, int count)
{
    for (int end = -1; end <= 1; end += 2) {
        struct polynomial plane = path->axial;
        plane.a[0] += end * path->half_length;
        count = add_candidates(&plane, candidates, count);
    }
    return path->ends_settle > 0.0 && path->ends_settle < 1.0
               ? insert_candidate(path->ends_settle, candidates, count)
               : count;
}

/* All instants at which the regime may change: a superset, sorted. */
int candidates_of_all(const struct relative_path *path, const struct extremes *extremes,
                      const struct contact_shape *shape, const struct contact_law *law, double *candidates)
{
    int count = touching_candidates(path, extremes, candidates, 0);
    if (relative_path_has_ends(shape)) {
        count = candidates_of_ends(path, candidates, count);
    }
    if (contact_has_events(law)) {
        count = add_candidates(&path->half_rate, candidates, count);
        if (contact_is_hertz(law)) {
            const struct polynomial condition = hertz_condition(path, law);
            count = add_candidates(&condition, candidates, count);
        } else if (contact_regime_after(law, REGIME_COMPRESSION) == REGIME_SEPARATING &&
                   contact_coefficients_of(law, REGIME_COMPRESSION).k > 0.0) {
            if (SCENE_ANY_PLANE && path->flat) {
                const struct polynomial of_plane = law_condition_of_plane(path, law);
                return add_candidates(&of_plane, candidates, count);
            }
            const struct polynomial condition = law_condition(path, law);
            const struct polynomial nearby = law_condition_nearby(path, law);
            count = add_candidates(&condition, candidates, count);
            count = add_candidates(&nearby, candidates, count);
        }
    }
    return count;
}
