#include "segment/tumbling_touch.h"

#include <float.h>

#include "math/root.h"

struct tumbling_search {
    const struct tumbling_path *path;
    enum tumbling_change change;
    int count; /* of functions */
};

/* The function that decides: of a touch the highest, of a parting the lowest. */
static int deciding(const struct tumbling_search *search, const struct tumbling_instant *at)
{
    int found = 0;
    for (int i = 1; i < search->count; ++i) {
        const bool higher = at->of[i].value > at->of[found].value;
        found = higher == (search->change == TUMBLING_TOUCH) ? i : found;
    }
    return found;
}

/* Whether the change has taken place, whatever rounding does. */
static bool surely_changed(const struct tumbling_search *search, const struct tumbling_instant *at)
{
    const bool touch = search->change == TUMBLING_TOUCH;
    for (int i = 0; i < search->count; ++i) {
        const bool beyond = at->of[i].value < -at->noise[i];
        if (beyond != touch) {
            return beyond;
        }
    }
    return touch;
}

/* A root_function of time. */
static void decision(const void *data, double time, double *value, double *slope)
{
    const struct tumbling_search *search = data;
    struct tumbling_instant at;
    tumbling_at(search->path, search->change, time, &at);
    const struct falling *f = &at.of[deciding(search, &at)];
    *value = f->value;
    *slope = f->slope;
}

/* The longest time from an instant on in which nothing changes by more than rounding, as far as the bends of
 * that instant tell. Never zero: where all is within rounding it is so short that no more than three eighths
 * of it can be missed. */
static double unchanged_for(const struct tumbling_search *search, const struct tumbling_instant *at)
{
    double time = falling_stays_above(&at->of[0], at->noise[0]);
    for (int i = 1; i < search->count; ++i) {
        const double other = falling_stays_above(&at->of[i], at->noise[i]);
        time = (other > time) == (search->change == TUMBLING_TOUCH) ? other : time;
    }
    const struct falling *gap = &at->of[TUMBLING_GAP];
    const double quarter = 0.25 * at->noise[TUMBLING_GAP];
    return fmax(time, quarter / (fabs(gap->slope) + sqrt(gap->bend * quarter)));
}

/* How far to go from an instant on; `*length` is how far the bends are made to hold, and adapts. */
static double step_from(const struct tumbling_search *search, struct tumbling_instant *at, double time,
                        double horizon, double *length)
{
    const double rest = horizon - time;
    if (search->change == TUMBLING_TOUCH && tumbling_has_reach(search->path)) {
        const struct falling beyond = tumbling_beyond_reach(search->path, at, rest);
        const double away = falling_stays_above(&beyond, 0.0);
        if (away >= rest) {
            return rest;
        }
        if (away > *length) {
            return away;
        }
    }
    const double within = fmin(*length, rest);
    tumbling_bend(search->path, search->change, time, within, at);
    if (!(at->of[TUMBLING_GAP].bend < (double)INFINITY)) {
        *length = 0.25 * within; /* the direction of an axis that vanishes in between has no bound */
        return 0.0;
    }
    const double step = fmin(unchanged_for(search, at), within);
    *length = 2.0 * step;
    return step;
}

/* The root of the deciding function between an instant without the change and one with it; at the start where
 * there is none before (before < 0). */
static struct tumbling_result located(const struct tumbling_search *search, double before, double after,
                                      long evaluations)
{
    const double root = before < 0.0 ? 0.0 : root_in_bracket(decision, search, before, after);
    struct tumbling_instant at;
    tumbling_at(search->path, search->change, root, &at);
    const bool by_gap = deciding(search, &at) == TUMBLING_GAP;
    return (struct tumbling_result){root, by_gap ? 0.0 : at.geometry.gap, root, evaluations};
}

/* At the start the opposite change may just have been made, at an instant that is not right to rounding: it
 * lasts as long as the functions then rise. Returns how long by the slope of the deciding one, 0: not so. */
static double still_rising_for(const struct tumbling_search *search, const struct tumbling_instant *at)
{
    const struct falling *f = &at->of[deciding(search, at)];
    return f->slope > 0.0 ? -2.0 * f->value / f->slope : 0.0;
}

struct tumbling_result tumbling_first(const struct tumbling_path *path, enum tumbling_change change,
                                      double horizon, long budget)
{
    struct tumbling_path moving = *path; /* what it holds of the axis moves on with the search */
    const struct tumbling_search search = {&moving, change, tumbling_functions(path)};
    double time = 0.0;
    double before = -1.0; /* the last instant at which the deciding function was not negative; none yet */
    double length = horizon;
    for (long evaluations = 1; evaluations <= budget; ++evaluations) {
        struct tumbling_instant at;
        tumbling_at(&moving, change, time, &at);
        double step = 0.0;
        if (surely_changed(&search, &at)) {
            step = before < 0.0 ? still_rising_for(&search, &at) : 0.0;
            if (!(step > 0.0)) {
                return located(&search, before, time, evaluations);
            }
        } else if (time < horizon) {
            if (!(at.of[deciding(&search, &at)].value < 0.0)) {
                before = time;
                axis_motion_move_on(&moving.axis, time);
            }
            step = step_from(&search, &at, time, horizon, &length);
            /* where rounding has it below zero at the start: half-way it is above, or it stays within that */
            step *= before < 0.0 ? 0.5 : 1.0;
        }
        if (!(time < horizon)) {
            return (struct tumbling_result){(double)INFINITY, 0.0, horizon, evaluations};
        }
        /* no shorter than the rounding of time itself, once no bound can be had over a longer time */
        const double least = step > 0.0 || !(length > DBL_EPSILON * horizon) ? 4.0 * DBL_EPSILON * time : 0.0;
        time = fmin(time + fmax(step, fmax(least, DBL_MIN)), horizon);
        length = fmax(length, DBL_EPSILON * horizon);
    }
    return (struct tumbling_result){(double)INFINITY, 0.0, time, budget};
}
