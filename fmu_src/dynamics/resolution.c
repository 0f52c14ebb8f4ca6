#include "dynamics/resolution.h"

#include <float.h>

double resolution_of_gap(const struct scene_values *v, const struct system_instant *at, int contact)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(v, destination), body_center(v, source));
    return 8.0 * DBL_EPSILON *
           (vec3_max_abs(apart) + vec3_max_abs(at->displacement[source]) +
            vec3_max_abs(at->displacement[destination]) + at->geometry[contact].gap_terms);
}

static double size_along(struct vec3 axis, struct vec3 a)
{
    return fabs(axis.x * a.x) + fabs(axis.y * a.y) + fabs(axis.z * a.z);
}

double resolution_of_axial(const struct scene_values *v, const struct system_instant *at, int contact,
                           const struct contact_shape *shape)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(v, destination), body_center(v, source));
    return 8.0 * DBL_EPSILON *
           (size_along(shape->axis, apart) + size_along(shape->axis, at->displacement[source]) +
            size_along(shape->axis, at->displacement[destination]) + shape->half_length);
}

double resolution_of_rate(const struct system_instant *at, int contact)
{
    const double source = vec3_norm(at->velocity[contact_source(contact)]);
    const double destination = vec3_norm(at->velocity[contact_destination(contact)]);
    return 8.0 * DBL_EPSILON * fmax(vec3_norm(at->rate[contact]), fmax(source, destination));
}

/* How little of g' means anything: what rounding makes of w and of n (which is chosen, not computed, where d = 0), what an oscillation of
 * the gap by its own resolution has, and what the integrator lets pass. */
static double rate_resolution(const struct scene_values *v, const struct contact_law *law,
                              const struct system_instant *at, int contact, double tolerated)
{
    const double gap_resolution = resolution_of_gap(v, at, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const double turn = g->degenerate ? 0.0 : fmin(gap_resolution / g->distance, 1.0);
    const double oscillation = sqrt(law->stiffness * system_inverse_mass(v, contact));
    return vec3_norm(at->rate[contact]) * turn + resolution_of_rate(at, contact) +
           oscillation * gap_resolution + tolerated;
}

double resolution_armour(const struct scene_values *v, const struct motion *q,
                         const struct system_instant *at, int contact, double tolerated)
{
    const struct contact_law law = system_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const bool is_force = regime != REGIME_RECEDING && law.dashpot == DASHPOT_NON_ADHESIVE;
    const double margin = regime == REGIME_RELEASED
                              ? law.stiffness * g->gap + law.damping * g->gap_rate
                              : contact_regime_margin(&law, regime, g->gap, g->gap_rate);
    double resolution = rate_resolution(v, &law, at, contact, tolerated);
    if (is_force) {
        resolution = law.stiffness * resolution_of_gap(v, at, contact) + law.damping * resolution;
    }
    return 2.0 * (fmax(-margin, 0.0) + resolution);
}
