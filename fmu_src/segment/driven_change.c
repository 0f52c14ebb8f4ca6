#include "segment/driven_change.h"

#include <float.h>

/* Roundings of a sum of products of vectors, as g and g' are: as many as rounding_of_gap grants. */
static const double ROUNDINGS = 8.0 * DBL_EPSILON;

/* What the law sees at one place of the path, and what rounding makes of it. */
struct driven_instant {
    double gap, rate, beyond;                   /* [m], [m/s], how far beyond a cylinder's end [m] */
    double gap_noise, rate_noise, beyond_noise; /* likewise */
    enum contact_regime regime;
};

/* The size of a polynomial's terms at s >= 0: its rounding is in proportion to it. */
static double size_of(const struct polynomial *p, double s)
{
    double size = fabs(p->a[p->degree]);
    for (int i = p->degree - 1; i >= 0; --i) {
        size = size * s + fabs(p->a[i]);
    }
    return size;
}

static double size_of_path(const struct relative_path *path, double s)
{
    double size = vec3_norm(path->c[path->degree]);
    for (int i = path->degree - 1; i >= 0; --i) {
        size = size * s + vec3_norm(path->c[i]);
    }
    return size;
}

static struct driven_instant driven_at(const struct relative_path *path, const struct contact_law *law,
                                       const struct driven_rounding *rounding, double s)
{
    double gap;
    double slope;
    relative_path_gap(path, s, &gap, &slope);
    const double speed_unit = path->scale / path->horizon;
    const double distance = relative_path_divisor(path, gap);
    const double along = polynomial_at(&path->half_rate, s);
    struct driven_instant at = {.gap = path->scale * gap, .beyond = -1.0};
    at.gap_noise = fmax(rounding->gap, ROUNDINGS * path->scale * (size_of_path(path, s) + path->reach));
    if (distance > 0.0) {
        at.rate = path->side * along / distance * speed_unit;
        /* c.w / d: of the sum itself, and of an error of c as large as that of the gap. */
        const double sum = ROUNDINGS * size_of(&path->half_rate, s) / distance * speed_unit;
        at.rate_noise = sum + at.gap_noise * rounding->speed / (path->scale * distance);
    }
    if (SCENE_ANY_CYLINDER && path->has_ends) {
        at.beyond = path->scale * (fabs(polynomial_at(&path->axial, s)) - path->half_length);
        at.beyond_noise =
            fmax(rounding->axial, ROUNDINGS * path->scale * (size_of(&path->axial, s) + path->half_length));
    }
    at.regime = contact_regime_of(law, at.gap, at.rate, relative_path_within(path, s));
    return at;
}

/* Whether the regime there is another one, whatever rounding does. */
static bool has_changed(const struct driven_instant *at, const struct contact_law *law,
                        enum contact_regime present)
{
    if (at->regime == present) {
        return false;
    }
    if (present == REGIME_APART) {
        return at->gap < -at->gap_noise && !(fabs(at->beyond) <= at->beyond_noise);
    }
    if (at->regime == REGIME_APART) {
        return at->gap > at->gap_noise || at->beyond > at->beyond_noise;
    }
    const struct contact_slopes slopes = contact_event_slopes(law, present, at->gap, at->rate);
    return fabs(contact_event(law, present, at->gap, at->rate)) >
           fabs(slopes.by_gap) * at->gap_noise + fabs(slopes.by_rate) * at->rate_noise;
}

/* Candidate events of the law come from squared polynomials, which lose digits where the path is long. So the
 * change is located by bisection of the regime itself, between an instant before it and one after. */
static double halve_to_change(const struct relative_path *path, const struct contact_law *law,
                              const struct driven_rounding *rounding, double before, double after,
                              enum contact_regime next)
{
    for (;;) {
        const double middle = 0.5 * (before + after);
        if (!(middle > before && middle < after)) {
            return after;
        }
        if (driven_at(path, law, rounding, middle).regime == next) {
            after = middle;
        } else {
            before = middle;
        }
    }
}

struct driven_change driven_first_change(const struct relative_path *path, const struct contact_law *law,
                                         const struct driven_rounding *rounding, const double *events,
                                         int count, enum contact_regime present)
{
    double from = 0.0;
    double before = -1.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? events[i] : 1.0;
        if (!(to > from)) {
            continue;
        }
        const double middle = 0.5 * (from + to);
        const struct driven_instant at = driven_at(path, law, rounding, middle);
        if (has_changed(&at, law, present)) {
            const bool by_law = present != REGIME_APART && at.regime != REGIME_APART;
            if (by_law && before >= 0.0) {
                from = halve_to_change(path, law, rounding, before, middle, at.regime);
            }
            double gap;
            double slope;
            relative_path_gap(path, from, &gap, &slope);
            return (struct driven_change){from, at.regime, path->scale * gap};
        }
        before = middle;
        from = to;
    }
    return (struct driven_change){(double)INFINITY, present, 0.0};
}
