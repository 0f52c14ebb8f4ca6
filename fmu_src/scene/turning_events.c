/* The event functions of contacts in a scene that turns or rubs. */
#include <float.h>
#include <math.h>

#include "scene/turning_ode.h"

#if SCENE_ANY_TURNING

/* The gap, or how far the source is beyond the ends of its cylinder where that is more [m]. */
static double way_to_contact(const struct scene_ode *ode, const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(ode->values, ode->state, at, contact);
    return fmax(at->geometry[contact].gap, scene_beyond_ends(&shape, &at->geometry[contact]));
}

/* Depth until contact ends [m]. Where a cylinder has ends, it is multiplied by how far the source is within
 * them, (h^2 - z^2)/2 over h^2 with h = L/2. The lesser of both would have a corner, which the polynomial of
 * a long step does not follow: it would seem to fall near the start of a contact that begins at an end. */
static double depth_to_parting(const struct scene_ode *ode, const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(ode->values, ode->state, at, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const double depth = ode->gap_offset[contact] - g->gap;
    if (!contact_is_cylinder(&shape) || !isfinite(shape.half_length)) {
        return depth;
    }
    const double half = shape.half_length;
    const double within = (half - fabs(g->axial)) * 0.5 * (1.0 + fabs(g->axial) / half);
    return depth * (ode->gap_offset[contact] + within) / half;
}

static bool breaks_away(const struct turning_laws *laws)
{
    return laws->friction.kind == FRICTION_ELASTIC && laws->friction_regime == FRICTION_STICKING;
}

/* Where sticking ends is min(mu_s F_n, F_max); each by itself is smooth, as steps that are long need it. */
static void friction_events(const struct scene_ode *ode, double clock, const struct turning_state *turning,
                            const struct scene_instant *at, int contact, double *out)
{
    const struct turning_laws laws = turning_laws_of(ode->values, ode->state, contact);
    const struct friction_state rubbing = turning_rubbing(turning, at, contact);
    const double force_rate = turning_normal_force_rate(ode->values, ode->state, clock, at, contact);
    out[ODE_EVENT_STICK] = ode->stick_offset[contact] +
                           friction_stick_event(&laws.friction, laws.friction_regime, rubbing, force_rate);
    out[ODE_EVENT_CAP] = ode->cap_offset[contact] +
                         friction_cap_event(&laws.friction, laws.friction_regime, rubbing.normal_force);
    if (breaks_away(&laws)) {
        const double carried = vec3_norm(friction_force(&laws.friction, FRICTION_STICKING, rubbing));
        out[ODE_EVENT_STICK] =
            ode->stick_offset[contact] + laws.friction.static_coefficient * rubbing.normal_force - carried;
        out[ODE_EVENT_CAP] = ode->cap_offset[contact] + laws.friction.largest - carried;
    }
    if (contact_may_pull(&laws.normal)) {
        const struct contact_geometry *g = &at->geometry[contact];
        const double push = contact_push(&laws.normal, g->gap, g->gap_rate);
        out[ODE_EVENT_LIFT] =
            ode->lift_offset[contact] + friction_lift_event(&laws.friction, laws.friction_regime, push);
    }
}

void turning_events(const struct scene_ode *ode, double clock, const double *y,
                    const struct scene_instant *at, int contact, double out[ODE_EVENTS_EACH])
{
    const struct turning_laws laws = turning_laws_of(ode->values, ode->state, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
        out[i] = 1.0;
    }
    if (!contact_is_foreseen(ode->values, ode->state, contact)) {
        const bool apart = laws.regime == REGIME_APART;
        out[ODE_EVENT_GAP] = apart ? ode->gap_offset[contact] + way_to_contact(ode, at, contact)
                                   : depth_to_parting(ode, at, contact);
        out[ODE_EVENT_LAW] = apart ? 1.0
                                   : ode->margin_offset[contact] +
                                         contact_event(&laws.normal, laws.regime, g->gap, g->gap_rate);
    }
    if (contact_transmits(ode->state, contact) && contact_rubs(ode->values, contact)) {
        struct turning_state turning = ode->state->turning;
        turning_unpack(ode->values, y, &turning);
        friction_events(ode, clock, &turning, at, contact, out);
    }
}

/* What an event function of friction may be off by where speeds are right to `tolerated` [m/s]. */
static double stick_rounding(const struct turning_laws *laws, double normal_force, double tolerated)
{
    const double limit = fabs(friction_limit(&laws->friction, laws->friction_regime, normal_force));
    const bool is_force = laws->friction_regime == FRICTION_STICKING || laws->friction.damping > 0.0;
    return is_force ? laws->friction.damping * tolerated + 8.0 * DBL_EPSILON * limit : tolerated;
}

/* That of contact_push, which is the force or its factor. */
static double push_rounding(const struct contact_law *law, double of_force, double tolerated)
{
    return contact_is_hertz(law) ? 8.0 * DBL_EPSILON + law->damping * tolerated : of_force;
}

/* Offsets by rounding alone. */
static void put_friction_offsets(struct scene_ode *ode, const struct scene_instant *at, int contact,
                                 double tolerated)
{
    const struct turning_laws laws = turning_laws_of(ode->values, ode->state, contact);
    const double force = at->normal_force[contact];
    const struct contact_geometry *g = &at->geometry[contact];
    const double by_rate = contact_force_slopes(&laws.normal, laws.regime, g->gap, g->gap_rate).by_rate;
    const double rounding = 8.0 * DBL_EPSILON * fabs(force) + fabs(by_rate) * tolerated;
    ode->stick_offset[contact] = 2.0 * stick_rounding(&laws, force, tolerated);
    ode->cap_offset[contact] =
        breaks_away(&laws) ? ode->stick_offset[contact] : 2.0 * laws.friction.coefficient * rounding;
    ode->lift_offset[contact] = 2.0 * push_rounding(&laws.normal, rounding, tolerated);
}

void turning_friction_events(struct scene_ode *ode, const struct scene_instant *at, int contact,
                             double tolerated, double events[ODE_EVENTS_EACH])
{
    for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
        events[i] = 1.0;
    }
    put_friction_offsets(ode, at, contact, tolerated);
    friction_events(ode, ode->state->clock, &ode->state->turning, at, contact, events);
}

void turning_begin(struct scene_ode *ode, const struct scene_instant *at, int contact, double tolerated)
{
    double events[ODE_EVENTS_EACH];
    ode->stick_offset[contact] = ode->cap_offset[contact] = ode->lift_offset[contact] = 0.0;
    if (!contact_transmits(ode->state, contact) || !contact_rubs(ode->values, contact)) {
        return;
    }
    turning_friction_events(ode, at, contact, tolerated, events);
    ode->stick_offset[contact] += 2.0 * fmax(-events[ODE_EVENT_STICK], 0.0);
    ode->cap_offset[contact] += 2.0 * fmax(-events[ODE_EVENT_CAP], 0.0);
    ode->lift_offset[contact] += 2.0 * fmax(-events[ODE_EVENT_LIFT], 0.0);
}

#endif
