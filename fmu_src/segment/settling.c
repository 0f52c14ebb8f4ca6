#include "segment/settling.h"

#include <float.h>

/* Seconds in which a quantity moving with `speed` and half acceleration `bend` leaves the rounding `noise`
 * around zero; 0 when it is not within it. On a shorter scale its sign means nothing. */
static double leaving_time(double value, double noise, double speed, double bend)
{
    if (fabs(value) > noise) {
        return 0.0;
    }
    const double soonest = fmin(noise / fabs(speed), sqrt(noise / fabs(bend)));
    return isfinite(soonest) ? soonest : 0.0;
}

/* d/dt of the event function while separating, in flight: g changes with c', g' = side n.w with w and as n
 * turns, by c' across n / d. */
static double margin_slope(const struct contact_shape *shape, const struct contact_law *law,
                           const struct contact_geometry *now, const struct separation_path *separation)
{
    const double turning =
        contact_turns(shape, now)
            ? contact_turning_rate(shape, now, separation->w[0], separation->c[1]) / now->distance
            : 0.0;
    const double bend = shape->side * (vec3_dot(now->normal, separation->w[1]) + turning);
    const double opening = shape->side * vec3_dot(now->normal, separation->c[1]);
    const struct contact_slopes slopes =
        contact_event_slopes(law, REGIME_SEPARATING, now->gap, now->gap_rate);
    return slopes.by_gap * opening + slopes.by_rate * bend;
}

double settling_margin_rounding(const struct contact_shape *shape, const struct contact_law *law,
                                const struct contact_geometry *now, double gap_rounding, double by_positions,
                                const struct separation_path *separation)
{
    const double turn = 8.0 * DBL_EPSILON + (contact_turns(shape, now) ? by_positions / now->distance : 0.0);
    const struct contact_slopes slopes =
        contact_event_slopes(law, REGIME_SEPARATING, now->gap, now->gap_rate);
    return slopes.by_gap * gap_rounding + fmin(turn, 1.0) * slopes.by_rate * vec3_norm(separation->w[0]);
}

double settling_time(const struct relative_path *path, const struct contact_shape *shape,
                     const struct contact_law *law, const struct contact_geometry *now, double gap_rounding,
                     double by_positions, const struct separation_path *separation,
                     enum contact_regime present, bool just_begun)
{
    const double closing = vec3_dot(now->normal, separation->c[1]);
    double settle = leaving_time(now->gap, gap_rounding, closing, vec3_norm(separation->c[2]));
    if (present == REGIME_SEPARATING) {
        const double margin = contact_event(law, present, now->gap, now->gap_rate);
        const double slope = margin_slope(shape, law, now, separation);
        double noise = settling_margin_rounding(shape, law, now, gap_rounding, by_positions, separation);
        if (just_begun && margin < 0.0 && slope > 0.0) {
            /* what the integrator left of the force that is now zero */
            noise = fmax(noise, -2.0 * margin);
        }
        settle = fmax(settle, leaving_time(margin, noise, slope, 0.0));
    }
    return settle / path->horizon;
}

void settling_at_ends(struct relative_path *path, const struct contact_shape *shape,
                      const struct contact_geometry *now, double rounding,
                      const struct separation_path *separation, enum contact_regime present)
{
    const double beyond = fabs(now->axial) - shape->half_length;
    const double along = vec3_dot(separation->c[1], shape->axis);
    path->ends_settle =
        leaving_time(beyond, rounding, along, vec3_dot(separation->c[2], shape->axis)) / path->horizon;
    path->starts_within = present != REGIME_APART || (beyond <= 0.0 && !(now->gap < 0.0));
}
