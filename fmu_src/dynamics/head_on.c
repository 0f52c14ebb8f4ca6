#include "dynamics/head_on.h"

#if SCENE_ANY_FREE

/* Of the terms of the discriminant: below it the bodies might just graze, and the root keeps less than half of its digits. */
static const double LEAST_DISCRIMINANT = 1e-8;

/* Of the reach: nearer to the centre the gap does not tell any more on which side of it the source is. */
static const double CLEAR_OF_CENTRE = 1e-9;

static bool is_along(struct vec3 normal, struct vec3 a)
{
    return vec3_is_zero(vec3_cross(normal, a));
}

bool head_on_is(const struct contact_shape *shape, const struct separation *separation, struct vec3 normal)
{
    const struct vec3 speed = contact_across(shape, separation->c[1]);
    const struct vec3 bend = contact_across(shape, separation->c[2]);
    const struct vec3 rate = contact_across(shape, separation->w[0]);
    const struct vec3 pull = contact_across(shape, separation->w[1]);
    if (!is_along(normal, speed) || !is_along(normal, bend) || !vec3_is_zero(vec3_sub(rate, speed)) ||
        !vec3_is_zero(vec3_axpy(pull, -2.0, bend))) {
        return false;
    }
    for (int i = 3; i <= SEPARATION_DEGREE; ++i) {
        if (!vec3_is_zero(contact_across(shape, separation->c[i])) ||
            !vec3_is_zero(contact_across(shape, separation->w[i - 1]))) {
            return false;
        }
    }
    return true;
}

/* g = gap + rate t + bend t^2 */
struct parabola {
    double gap, rate, bend;
};

/* Apart for good, beyond rounding: by the gap, or on the way out and up to where the bend brings them back. */
static bool is_clearly_apart(const struct parabola *p, double resolution)
{
    return p->gap > resolution ||
           (p->gap >= 0.0 && p->rate > 0.0 && p->rate * p->rate > -4.0 * p->bend * resolution);
}

/* The first zero at which g >= 0 falls, by the one of the two formulas that does not cancel, and a step of Newton's method. */
static double first_zero(const struct parabola *p, double discriminant)
{
    const double root = sqrt(discriminant);
    const double t = p->rate < 0.0 ? 2.0 * p->gap / (root - p->rate) : -0.5 * (root + p->rate) / p->bend;
    if (!(t > 0.0)) {
        return (double)INFINITY;
    }
    return t - (p->gap + t * (p->rate + t * p->bend)) / (p->rate + 2.0 * t * p->bend);
}

static double widest_until(const struct parabola *p, double t)
{
    const double widest = fmax(p->gap, p->gap + t * (p->rate + t * p->bend));
    const double top = -0.5 * p->rate / p->bend;
    return p->bend < 0.0 && top > 0.0 && top < t ? p->gap + 0.5 * top * p->rate : widest;
}

bool head_on_touch(const struct contact_shape *shape, const struct separation *separation,
                   const struct contact_geometry *now, double resolution, double horizon, double *touch)
{
    const struct parabola p = {now->gap, shape->side * vec3_dot(now->normal, separation->c[1]),
                               shape->side * vec3_dot(now->normal, separation->c[2])};
    const double square = p.rate * p.rate;
    const double product = 4.0 * p.bend * p.gap;
    const double size = square + fabs(product);
    if (now->degenerate || !is_clearly_apart(&p, resolution) ||
        !(fabs(square - product) > LEAST_DISCRIMINANT * size) || !isfinite(size)) {
        return false;
    }
    *touch = square > product ? first_zero(&p, square - product) : (double)INFINITY;
    if (!(*touch <= horizon)) {
        *touch = (double)INFINITY;
    }
    return shape->side > 0 ||
           widest_until(&p, fmin(*touch, horizon)) < (1.0 - CLEAR_OF_CENTRE) * contact_reach(shape);
}

#endif
