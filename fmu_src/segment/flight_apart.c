#include "segment/flight_apart.h"

#include <math.h>

#include "scene/present.h"
#include "scene/rounding.h"
#include "segment/relative_path.h"

/* Part of the terms of the discriminant below which the parabola may only touch zero: its root then has less
 * than half of its digits. */
static const double CLEAR_OF_GRAZING = 1e-8;

/* Part of the time by which the bound stays below the root: far more than rounding, and too little to cost
 * anything. */
static const double CLEARANCE = 1e-3;

/* The last time up to which value + rate t + bend t^2 is positive; `gap_rounding` and `rate_rounding` are
 * those of the first two. A value that is only rounding counts as zero. */
static double above_plane_until(double value, double rate, double bend, double gap_rounding,
                                double rate_rounding)
{
    const double square = rate * rate;
    const double product = 4.0 * bend * value;
    const double discriminant = square - product;
    if (!(fabs(discriminant) > CLEAR_OF_GRAZING * (square + fabs(product))) || !isfinite(discriminant)) {
        return 0.0;
    }
    if (discriminant < 0.0 || (bend >= 0.0 && rate > rate_rounding)) {
        return (double)INFINITY;
    }
    const double root = sqrt(discriminant);
    const double t = rate < 0.0 ? 2.0 * value / (root - rate) : -0.5 * (root + rate) / bend;
    const double rounding = 2.0 * (gap_rounding + t * rate_rounding) / root;
    return fmax(0.0, t * (1.0 - CLEARANCE) - rounding);
}

/* The acceleration of a body in unforced flight. */
static struct vec3 free_fall(const struct scene_values *v, int body)
{
    return body_is_free(v, body) ? gravity(v) : vec3_make(0.0, 0.0, 0.0);
}

/* Whether anything of the kind can be told: not of a source inside, nor of bodies whose motion is given. */
static bool apart_is_known(const struct scene_values *v, const struct scene_state *q, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    return shape.side > 0 && !body_is_prescribed(v, contact_source(contact)) &&
           !body_is_prescribed(v, contact_destination(contact));
}

/* Seconds from the present instant `at` for which bodies that are apart cannot touch. A convex destination
 * lies behind the plane that touches it in the point nearest to the source, so the gap is at least the
 * source's height above that plane, a parabola of time. */
static double apart_for(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *now = &at->geometry[contact];
    const double rounding = rounding_of_gap(v, at, contact);
    /* Beyond a cylinder's open ends bodies may overlap. */
    const double least = relative_path_has_ends(&shape) ? 0.0 : -rounding;
    if (now->degenerate || !(now->gap > least)) {
        return 0.0;
    }
    const struct vec3 bend =
        vec3_sub(free_fall(v, contact_destination(contact)), free_fall(v, contact_source(contact)));
    return above_plane_until(fmax(now->gap, 0.0), now->gap_rate, 0.5 * vec3_dot(now->normal, bend), rounding,
                             rounding_of_rate(at, contact));
}

double flight_apart_until(const struct scene_values *v, const struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!apart_is_known(v, q, j)) {
            return 0.0;
        }
    }
    struct scene_instant at;
    scene_kinematics_now(v, q, &at);
    double least = (double)INFINITY;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        least = fmin(least, apart_for(v, q, &at, j));
    }
    return q->clock + least;
}
