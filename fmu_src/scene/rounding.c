#include "scene/rounding.h"

#include <float.h>

static double size_along(struct vec3 axis, struct vec3 a)
{
    return fabs(axis.x * a.x) + fabs(axis.y * a.y) + fabs(axis.z * a.z);
}

double rounding_of_gap(const struct scene_values *v, const struct scene_instant *at, int contact)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(v, destination), body_center(v, source));
    if (SCENE_ANY_PLANE && body_shape(destination) == SHAPE_PLANE) { /* what lies in the plane has no part */
        const struct vec3 n = at->geometry[contact].normal;
        return 8.0 * DBL_EPSILON *
               (size_along(n, apart) + size_along(n, at->displacement[source]) +
                size_along(n, at->displacement[destination]) + at->geometry[contact].gap_terms);
    }
    return 8.0 * DBL_EPSILON *
           (vec3_max_abs(apart) + vec3_max_abs(at->displacement[source]) +
            vec3_max_abs(at->displacement[destination]) + at->geometry[contact].gap_terms);
}

double rounding_of_axial(const struct scene_values *v, const struct scene_instant *at, int contact,
                         const struct contact_shape *shape)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(v, destination), body_center(v, source));
    return 8.0 * DBL_EPSILON *
           (size_along(shape->axis, apart) + size_along(shape->axis, at->displacement[source]) +
            size_along(shape->axis, at->displacement[destination]) + shape->half_length);
}

double rounding_of_rate(const struct scene_instant *at, int contact)
{
    const double source = vec3_norm(at->velocity[contact_source(contact)]);
    const double destination = vec3_norm(at->velocity[contact_destination(contact)]);
    return 8.0 * DBL_EPSILON * fmax(vec3_norm(at->rate[contact]), fmax(source, destination));
}

double rounding_of_force(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_slopes slopes = contact_force_slopes(&law, REGIME_COMPRESSION, g->gap, g->gap_rate);
    const double gap_rounding = rounding_of_gap(v, at, contact);
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const double turned = contact_is_plane(&shape) ? 0.0 : gap_rounding / fabs(g->distance);
    const double angle = fmin(8.0 * DBL_EPSILON + turned, 1.0);
    return fabs(slopes.by_gap) * gap_rounding +
           angle * (fabs(slopes.by_rate) * vec3_norm(at->rate[contact]) + fabs(at->normal_force[contact]));
}

/* Below this [m/s] the sign of g' means nothing: rounding of w; rounding of n, which has no meaning where d =
 * 0 (d < 0: a centre below a cap); the speed of an oscillation as large as the gap's rounding bound; the
 * integrator's tolerance. */
static double rate_rounding(const struct scene_values *v, const struct contact_law *law,
                            const struct scene_instant *at, int contact, double tolerated)
{
    const double gap_rounding = rounding_of_gap(v, at, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const bool turns = !g->degenerate && body_shape(contact_destination(contact)) != SHAPE_PLANE;
    const double angle = turns ? fmin(gap_rounding / fabs(g->distance), 1.0) : 0.0;
    const double spring = -contact_force_slopes(law, REGIME_COMPRESSION, g->gap, g->gap_rate).by_gap;
    const double oscillation = sqrt(fmax(spring, 0.0) * scene_inverse_mass(v, contact));
    return vec3_norm(at->rate[contact]) * angle + rounding_of_rate(at, contact) + oscillation * gap_rounding +
           tolerated;
}

double rounding_of_event(const struct scene_values *v, const struct contact_law *law,
                         const struct contact_slopes *slopes, const struct scene_instant *at, int contact,
                         double tolerated)
{
    return fabs(slopes->by_gap) * rounding_of_gap(v, at, contact) +
           fabs(slopes->by_rate) * rate_rounding(v, law, at, contact, tolerated);
}

double rounding_margin_offset(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact, double tolerated)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const double event = contact_event(&law, regime, g->gap, g->gap_rate);
    const struct contact_slopes slopes = contact_event_slopes(&law, regime, g->gap, g->gap_rate);
    const double rounding = rounding_of_event(v, &law, &slopes, at, contact, tolerated);
    return 2.0 * (fmax(-event, 0.0) + rounding);
}
