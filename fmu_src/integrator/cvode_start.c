#include "integrator/cvode_start.h"

#include <cvode/cvode.h>

#include "integrator/cvode_memory.h"
#include "scene/present.h"

/* Largest rotation of n in one internal step [rad]: contact cannot end and begin again within such a step.
 * Near the centre, where n rotates fast, the penetration stands for d, since the gap opens only after that
 * distance. */
static const double LARGEST_ANGLE = 0.1;

/* Largest step [s]: until n has rotated by that angle, or the bodies have moved by that part of the
 * penetration, or of the source's radius where a touch is not foreseen. Within it speeds are below sqrt(w^2 +
 * 4 a d). */
static double largest_step_of(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact)
{
    const int source = contact_source(contact);
    const double distance = at->geometry[contact].distance;
    const struct vec3 force_difference =
        vec3_sub(path_at(q->path[source].force, 3, q->clock),
                 path_at(q->path[contact_destination(contact)].force, 3, q->clock));
    const double a = vec3_norm(gravity(v)) + vec3_norm(force_difference) / body_mass(v, source);
    const double speed = sqrt(vec3_dot(at->rate[contact], at->rate[contact]) + 4.0 * a * distance);
    const double length =
        contact_transmits(q, contact) ? fmax(distance, -at->geometry[contact].gap) : body_radius(v, source);
    return LARGEST_ANGLE * length / speed;
}

/* Bound on the internal step [s]; 0: none. */
static double largest_step(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at)
{
    double bound = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j) || contact_is_coupled(v, q, j)) {
            const double step = largest_step_of(v, q, at, j);
            bound = step > 0.0 && isfinite(step) && (bound == 0.0 || step < bound) ? step : bound;
        }
    }
    return bound;
}

/* What the local error of one internal step may take of the tolerance: the errors of some hundred steps of a
 * contact add up, BDF's all with the sign of its damping. Chosen so that at 1e-10 the energy balance after
 * the 63 impacts of a ball in a cylinder (scripts/scenarios/p3b_bouncing_in_cylinder.toml) closes to better
 * than 1e-9 of its largest term. */
static double tolerance_share(enum solver_method method)
{
    return method == SOLVER_METHOD_CVODE_ADAMS ? 0.02 : 0.005;
}

bool cvode_start(struct cvode *c, const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    ode_leave_centres(v, q);
    scene_now(v, q, &at);
    c->problem.relative = tolerance_share(c->method) * solver_relative_tolerance(v);
    c->problem.absolute = tolerance_share(c->method) * solver_absolute_tolerance(v);
    ode_begin(&c->problem.ode, &at, c->problem.relative, c->problem.absolute);
    ode_pack(&c->problem.ode, NV_DATA_S(c->y));
    c->steps = c->evaluations = c->rejected = 0;
    q->integrator_fresh = 0;
    c->longest_step = largest_step(v, q, &at);
    return CVodeReInit(c->memory, q->clock, c->y) == CV_SUCCESS &&
           CVodeSetMaxStep(c->memory, c->longest_step) == CV_SUCCESS;
}
