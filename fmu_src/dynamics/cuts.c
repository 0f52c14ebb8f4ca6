#include "dynamics/cuts.h"

#if SCENE_ANY_FREE

/* k (d - reach) + c d' = 0, times d, with the root squared: (k d^2 + c d d')^2 = k^2 reach^2 d^2. */
static struct polynomial law_condition(const struct approach *path, const struct contact_law *law)
{
    const double damping = law->damping / path->horizon;
    const double unit = fmax(law->stiffness, damping);
    const double k = law->stiffness / unit;
    struct polynomial sum = {{0.0}, 0};
    const struct polynomial offset2 = approach_offset2(path);
    sum = polynomial_add(&sum, k, &offset2);
    sum = polynomial_add(&sum, damping / unit, &path->half_rate);
    const struct polynomial square = polynomial_multiply(&sum, &sum);
    const double pull = k * path->reach;
    return polynomial_add(&square, -pull * pull, &offset2);
}

/* k (d - reach) + c d' = 0 times d + reach, with reach / d for 1 where the gap is small: exact the closer the bodies are, where the
 * squares above have lost the gap to rounding. */
static struct polynomial law_condition_nearby(const struct approach *path, const struct contact_law *law)
{
    const double damping = law->damping / path->horizon;
    const double unit = fmax(law->stiffness, damping);
    const struct polynomial surplus = approach_surplus2(path);
    struct polynomial sum = {{0.0}, 0};
    sum = polynomial_add(&sum, law->stiffness / unit, &surplus);
    return polynomial_add(&sum, 2.0 * damping / unit, &path->half_rate);
}

static int insert_cut(double root, double *cuts, int count)
{
    int at = count;
    for (; at > 0 && cuts[at - 1] > root; --at) {
        cuts[at] = cuts[at - 1];
    }
    cuts[at] = root;
    return count + 1;
}

static int add_cuts(const struct polynomial *p, double *cuts, int count)
{
    double roots[POLYNOMIAL_MAX_DEGREE];
    const int found = polynomial_sign_changes(p, roots);
    for (int i = 0; i < found; ++i) {
        count = insert_cut(roots[i], cuts, count);
    }
    return count;
}

struct extremes extremes_of(const struct approach *path)
{
    struct extremes found;
    found.count = polynomial_sign_changes(&path->closing, found.at);
    return found;
}

struct bracket_end cuts_gap_end(const struct approach *path, double s)
{
    struct bracket_end end = {.s = s};
    approach_gap(path, s, &end.value, &end.slope);
    return end;
}

double cuts_least_gap(const struct approach *path)
{
    const struct extremes extremes = extremes_of(path);
    double least = fmin(path->gap, cuts_gap_end(path, 1.0).value);
    for (int i = 0; i < extremes.count; ++i) {
        least = fmin(least, cuts_gap_end(path, extremes.at[i]).value);
    }
    return path->scale * least;
}

/* Where the gap passes zero. */
static int touching_cuts(const struct approach *path, const struct extremes *extremes, double *cuts,
                         int count)
{
    const int pieces = extremes->count + 1;
    struct bracket_end low = cuts_gap_end(path, 0.0);
    for (int i = 0; i < pieces; ++i) {
        const struct bracket_end high = cuts_gap_end(path, i < pieces - 1 ? extremes->at[i] : 1.0);
        if ((low.value < 0.0 && high.value > 0.0) || (low.value > 0.0 && high.value < 0.0)) {
            count = insert_cut(bracket_root_between(approach_gap, path, low, high), cuts, count);
        }
        low = high;
    }
    return count;
}

int cuts_of_ends(const struct approach *path, double *cuts, int count)
{
    for (int end = -1; end <= 1; end += 2) {
        struct polynomial plane = path->axial;
        plane.a[0] += end * path->half_length;
        count = add_cuts(&plane, cuts, count);
    }
    return count;
}

/* All instants at which the regime may change: a superset, sorted. */
int cuts_of_all(const struct approach *path, const struct extremes *extremes,
                const struct contact_shape *shape, const struct contact_law *law, double *cuts)
{
    int count = touching_cuts(path, extremes, cuts, 0);
    if (approach_has_ends(shape)) {
        count = cuts_of_ends(path, cuts, count);
    }
    if (law->damping > 0.0 && law->dashpot != DASHPOT_UNCLAMPED) {
        count = add_cuts(&path->half_rate, cuts, count);
        if (law->dashpot == DASHPOT_NON_ADHESIVE && law->stiffness > 0.0) {
            const struct polynomial condition = law_condition(path, law);
            const struct polynomial nearby = law_condition_nearby(path, law);
            count = add_cuts(&condition, cuts, count);
            count = add_cuts(&nearby, cuts, count);
        }
    }
    return count;
}

#endif
