#include "segment/path_change.h"

static enum contact_regime regime_at(const struct relative_path *path, const struct contact_law *law,
                                     double s)
{
    double gap;
    double slope;
    relative_path_gap(path, s, &gap, &slope);
    const double distance = relative_path_divisor(path, gap);
    const double rate = distance > 0.0 ? path->side * polynomial_at(&path->half_rate, s) / distance : 0.0;
    return contact_regime_of(law, path->scale * gap, rate * path->scale / path->horizon,
                             relative_path_within(path, s));
}

struct regime_change path_first_change(const struct relative_path *path, const double *events, int count,
                                       const struct contact_law *law, enum contact_regime present,
                                       bool ends_only, double settle)
{
    double from = 0.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? events[i] : 1.0;
        if (to > settle && to > from) {
            from = fmax(from, settle);
            const double middle = 0.5 * (from + to);
            const enum contact_regime next = !ends_only ? regime_at(path, law, middle)
                                             : relative_path_within(path, middle) ? present
                                                                                  : REGIME_APART;
            if (next != present) {
                double gap;
                double slope;
                relative_path_gap(path, from, &gap, &slope);
                return (struct regime_change){from * path->horizon, next, path->scale * gap, false};
            }
        }
        from = to;
    }
    return (struct regime_change){(double)INFINITY, present, 0.0, false};
}

/* A distance so small [scale] has lost its direction to rounding. */
static const double NO_DISTANCE = 1e-9;

static bool is_at_centre(const struct relative_path *path, double s)
{
    double gap;
    double slope;
    relative_path_gap(path, s, &gap, &slope);
    return path->side * gap + path->reach <= NO_DISTANCE;
}

bool path_passes_centre(const struct relative_path *path, const struct extremes *extremes, double until)
{
    if (path->degree == 0 || (SCENE_ANY_PLANE && path->flat)) {
        return false;
    }
    bool passes = is_at_centre(path, 0.0) || is_at_centre(path, fmin(until, 1.0));
    for (int i = 0; i < extremes->count && extremes->at[i] < until; ++i) {
        passes = passes || is_at_centre(path, extremes->at[i]);
    }
    return passes;
}

bool path_keeps_away(const struct relative_path *path)
{
    const double start = SCENE_ANY_PLANE && path->flat ? path->c[0].x : vec3_norm(path->c[0]);
    double length = 0.0;
    for (int i = 1; i <= path->degree; ++i) {
        length += vec3_norm(path->c[i]);
    }
    if (path->side > 0) {
        return start - length > path->reach + NO_DISTANCE;
    }
    return start + length < path->reach - NO_DISTANCE && start - length > NO_DISTANCE;
}
