#include "solver/watch.h"

#if SCENE_ANY_FREE

#include "contact/bracket.h"

struct probe {
    const struct watch *watch;
    const struct watched *what;
};

void watch_sample(struct watch *w)
{
    for (int i = 0; i < w->count; ++i) {
        w->sampler(w->piece, w->s[i], &w->at[i]);
    }
}

static double value_of(const struct watched *what, const struct press_sample *at)
{
    return what->factor * at->of[what->quantity][0] + what->offset;
}

static double slope_of(const struct watched *what, const struct press_sample *at)
{
    return what->factor * at->of[what->quantity][1];
}

static void probe_value(const void *data, double s, double *value, double *slope)
{
    const struct probe *probe = data;
    struct press_sample at;
    probe->watch->sampler(probe->watch->piece, s, &at);
    *value = value_of(probe->what, &at);
    *slope = slope_of(probe->what, &at);
}

static void probe_slope(const void *data, double s, double *value, double *slope)
{
    const struct probe *probe = data;
    struct press_sample at;
    probe->watch->sampler(probe->watch->piece, s, &at);
    *value = slope_of(probe->what, &at);
    *slope = probe->what->factor * at.of[probe->what->quantity][2];
}

static double value_at(const struct probe *probe, double s)
{
    double value;
    double slope;
    probe_value(probe, s, &value, &slope);
    return value;
}

/* Between two places: falls through zero, possibly by way of a dip, or rises from zero and falls. */
static double fall_between(const struct probe *probe, int i)
{
    const struct watch *w = probe->watch;
    const double low = w->s[i];
    const double high = w->s[i + 1];
    const double at_low = value_of(probe->what, &w->at[i]);
    const double at_high = value_of(probe->what, &w->at[i + 1]);
    const double from_low = slope_of(probe->what, &w->at[i]);
    const double to_high = slope_of(probe->what, &w->at[i + 1]);
    if (at_low > 0.0 && at_high <= 0.0) {
        return bracket_root(probe_value, probe, low, high);
    }
    if (at_low > 0.0 && from_low < 0.0 && to_high > 0.0) {
        const double dip = bracket_root(probe_slope, probe, low, high);
        if (value_at(probe, dip) <= 0.0) {
            return bracket_root(probe_value, probe, low, dip);
        }
    }
    if (at_low <= 0.0 && at_high <= 0.0 && from_low > 0.0 && to_high < 0.0) {
        const double hump = bracket_root(probe_slope, probe, low, high);
        if (value_at(probe, hump) > 0.0) {
            return bracket_root(probe_value, probe, hump, high);
        }
    }
    return (double)INFINITY;
}

double watch_first_fall(const struct watch *w, const struct watched *what)
{
    const struct probe probe = {w, what};
    double fall = (double)INFINITY;
    for (int i = 0; i + 1 < w->count && !(fall < (double)INFINITY); ++i) {
        fall = fall_between(&probe, i);
        if (i == 0 && !(fall < (double)INFINITY) && value_of(what, &w->at[0]) <= 0.0 &&
            value_of(what, &w->at[1]) <= 0.0) {
            return w->s[0];
        }
    }
    return fall;
}

double watch_largest(const struct watch *w, const struct watched *what, double end)
{
    const struct probe probe = {w, what};
    double largest = fmax(value_of(what, &w->at[0]), value_at(&probe, end));
    for (int i = 0; i + 1 < w->count && w->s[i] < end; ++i) {
        if (slope_of(what, &w->at[i]) > 0.0 && slope_of(what, &w->at[i + 1]) < 0.0) {
            const double top = bracket_root(probe_slope, &probe, w->s[i], w->s[i + 1]);
            largest = fmax(largest, top <= end ? value_at(&probe, top) : 0.0);
        }
        if (w->s[i + 1] <= end) {
            largest = fmax(largest, value_of(what, &w->at[i + 1]));
        }
    }
    return largest;
}

#endif
