#include "segment/flight_head_on.h"

#include <stddef.h>

/* Part of the terms of the discriminant below which the parabola may only touch zero, and its root has less
 * than half of its digits. */
static const double LEAST_DISCRIMINANT = 1e-8;

/* Part of the reach. Nearer to the centre the gap does not tell on which side of it the source is. */
static const double CLEAR_OF_CENTRE = 1e-9;

static bool is_along(struct vec3 normal, struct vec3 a)
{
    return vec3_is_zero(vec3_cross(normal, a));
}

static bool is_zero_across(const struct contact_shape *shape, struct vec3 a)
{
    return vec3_is_zero(a) || (contact_is_cylinder(shape) && vec3_is_zero(contact_across(shape, a)));
}

/* Whether the first two terms of W are those of C', across a cylinder's axis. */
static bool rates_agree(const struct contact_shape *shape, const struct separation_path *separation,
                        struct vec3 speed, struct vec3 bend)
{
    const struct vec3 *c = separation->c;
    const struct vec3 *w = separation->w;
    if (vec3_is_zero(vec3_sub(w[0], c[1])) && vec3_is_zero(vec3_axpy(w[1], -2.0, c[2]))) {
        return true;
    }
    return contact_is_cylinder(shape) && vec3_is_zero(vec3_sub(contact_across(shape, w[0]), speed)) &&
           vec3_is_zero(vec3_axpy(contact_across(shape, w[1]), -2.0, bend));
}

/* With a plane the motion in it plays no part: that along n must have the terms of a parabola alone. */
static bool is_parabola_over_plane(const struct separation_path *separation, struct vec3 normal)
{
    const struct vec3 *c = separation->c;
    const struct vec3 *w = separation->w;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const bool highest = i > 2 && (contact_along_plane(normal, c[i]) != 0.0 ||
                                       contact_along_plane(normal, w[i - 1]) != 0.0);
        const struct vec3 differs = vec3_axpy(w[i - 1], -i, c[i]);
        if (highest || (i <= 2 && vec3_dot(normal, differs) != 0.0)) {
            return false;
        }
    }
    return true;
}

bool flight_is_head_on(const struct contact_shape *shape, const struct separation_path *separation,
                       struct vec3 normal)
{
    if (contact_is_plane(shape)) {
        return is_parabola_over_plane(separation, normal);
    }
    const struct vec3 speed = contact_across(shape, separation->c[1]);
    const struct vec3 bend = contact_across(shape, separation->c[2]);
    if (!is_along(normal, speed) || !is_along(normal, bend) || !rates_agree(shape, separation, speed, bend)) {
        return false;
    }
    for (int i = 3; i <= SEPARATION_DEGREE; ++i) {
        if (!is_zero_across(shape, separation->c[i]) || !is_zero_across(shape, separation->w[i - 1])) {
            return false;
        }
    }
    return true;
}

/* value + rate t + bend t^2 */
struct parabola {
    double value, rate, bend;
};

/* Above zero beyond rounding: by its value, or because it rises and returns later than rounding matters. */
static bool is_clearly_above(const struct parabola *p, double rounding)
{
    return p->value > rounding ||
           (p->value >= 0.0 && p->rate > 0.0 && p->rate * p->rate > -4.0 * p->bend * rounding);
}

/* The first zero at which it falls from value >= 0, by the one of the two formulas that does not cancel, and
 * a step of Newton's method. */
static double first_zero(const struct parabola *p, double discriminant)
{
    const double root = sqrt(discriminant);
    const double t = p->rate < 0.0 ? 2.0 * p->value / (root - p->rate) : -0.5 * (root + p->rate) / p->bend;
    if (!(t > 0.0 && isfinite(t))) {
        return (double)INFINITY;
    }
    return t - (p->value + t * (p->rate + t * p->bend)) / (p->rate + 2.0 * t * p->bend);
}

/* When it falls through zero first, INFINITY: never; false where rounding decides. */
static bool first_fall(const struct parabola *p, double rounding, double *t)
{
    const double rate_squared = p->rate * p->rate;
    const double product = 4.0 * p->bend * p->value;
    const double size = rate_squared + fabs(product);
    if (!is_clearly_above(p, rounding) || !(fabs(rate_squared - product) > LEAST_DISCRIMINANT * size) ||
        !isfinite(size)) {
        return false;
    }
    *t = rate_squared > product ? first_zero(p, rate_squared - product) : (double)INFINITY;
    return true;
}

static double largest_until(const struct parabola *p, double t)
{
    const double largest = fmax(p->value, p->value + t * (p->rate + t * p->bend));
    const double top = -0.5 * p->rate / p->bend;
    return p->bend < 0.0 && top > 0.0 && top < t ? p->value + 0.5 * top * p->rate : largest;
}

static struct parabola gap_of(const struct contact_shape *shape, const struct separation_path *separation,
                              const struct contact_geometry *now)
{
    return (struct parabola){now->gap, shape->side * vec3_dot(now->normal, separation->c[1]),
                             shape->side * vec3_dot(now->normal, separation->c[2])};
}

bool flight_head_on_touch(const struct contact_shape *shape, const struct separation_path *separation,
                          const struct contact_geometry *now, double rounding, double horizon, double *touch)
{
    const struct parabola gap = gap_of(shape, separation, now);
    /* Bodies that approach touch where the gap is zero, however small it is; rounding affects only the
     * time. */
    const double unclear = gap.value > 0.0 && gap.rate < 0.0 ? 0.0 : rounding;
    if (now->degenerate || !first_fall(&gap, unclear, touch)) {
        return false;
    }
    if (!(*touch <= horizon)) {
        *touch = (double)INFINITY;
    }
    return shape->side > 0 ||
           largest_until(&gap, fmin(*touch, horizon)) < (1.0 - CLEAR_OF_CENTRE) * contact_reach(shape);
}

bool flight_head_on_regime_end(const struct contact_shape *shape, const struct contact_law *law,
                               const struct separation_path *separation, const struct contact_geometry *now,
                               double rounding, double margin_rounding, struct flight_regime_end *end)
{
    const struct parabola gap = gap_of(shape, separation, now);
    const struct parabola overlap = {-gap.value, -gap.rate, -gap.bend};
    const double gap_terms[3] = {gap.value, gap.rate, gap.bend};
    const double rate_terms[3] = {gap.rate, 2.0 * gap.bend, 0.0};
    double terms[3];
    for (int i = 0; i < 3; ++i) {
        terms[i] = contact_separating_event_term(law, gap_terms, rate_terms, i);
    }
    struct parabola margin = {terms[0], terms[1], terms[2]};
    if (fabs(margin.value) <= margin_rounding) {
        margin.value = 0.0;
    }
    double opening;
    double recompression;
    if (now->degenerate || !(overlap.value > rounding) || !first_fall(&overlap, rounding, &opening) ||
        !first_fall(&margin, margin_rounding, &recompression)) {
        return false;
    }
    end->regime = opening <= recompression ? REGIME_APART : REGIME_COMPRESSION;
    end->after = fmin(opening, recompression);
    end->gap =
        opening <= recompression ? 0.0 : gap.value + recompression * (gap.rate + recompression * gap.bend);
    return true;
}
