#include "scene/regime_margin.h"

#include <float.h>

#include "scene/present.h"
#include "scene/rounding.h"
#include "scene/turning_ode.h"
#include "scene/zones.h"

/* In bounds of the rounding error: the margin itself may be off by one of them on either side of
 * a change. */
static const double MARGIN_ROUNDINGS = 4.0;

double regime_touch_margin(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    double rounding = rounding_of_gap(v, at, contact);
    if (SCENE_ANY_CYLINDER && isfinite(shape.half_length)) {
        rounding = fmax(rounding, rounding_of_axial(v, at, contact, &shape));
    }
    const double margin = fmax(g->gap, scene_beyond_ends(&shape, g));
    const bool apart = q->contact[contact].regime == (int32_t)REGIME_APART;
    return apart ? margin + MARGIN_ROUNDINGS * rounding : margin - MARGIN_ROUNDINGS * rounding;
}

double regime_dashpot_margin(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    if (regime == REGIME_APART || !contact_has_events(&law)) {
        return 1.0;
    }
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_slopes slopes = contact_event_slopes(&law, regime, g->gap, g->gap_rate);
    const double tolerated =
        solver_relative_tolerance(v) * vec3_norm(at->rate[contact]) + solver_absolute_tolerance(v);
    const double rounding = rounding_of_event(v, &law, &slopes, at, contact, tolerated);
    const double margin = contact_event_force(&law, contact_event(&law, regime, g->gap, g->gap_rate) +
                                                        MARGIN_ROUNDINGS * rounding);
    return regime == REGIME_COMPRESSION ? margin : -margin;
}

double regime_zone_margin(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact)
{
    return zones_margin(v, q, at, contact) + MARGIN_ROUNDINGS * rounding_of_gap(v, at, contact);
}

enum contact_regime regime_by_margins(const struct scene_values *v, const struct scene_state *q,
                                      const struct scene_instant *at, int contact)
{
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const struct contact_law law = scene_contact_law(v, q, contact);
    const bool touches = regime_touch_margin(v, q, at, contact) < 0.0;
    if (!touches) {
        return REGIME_APART;
    }
    if (regime == REGIME_APART) {
        return scene_regime(v, q, at, contact);
    }
    const double margin = regime_dashpot_margin(v, q, at, contact);
    const bool within = regime == REGIME_COMPRESSION ? margin > 0.0 : margin < 0.0;
    return within || !contact_has_events(&law) ? regime : contact_regime_after(&law, regime);
}

#if SCENE_ANY_FRICTION
static bool is_beyond(enum friction_regime regime, enum ode_event event)
{
    switch (event) {
    case ODE_EVENT_STICK:
        return regime != FRICTION_STICKING;
    case ODE_EVENT_CAP:
        return regime == FRICTION_CAPPED;
    default:
        return regime == FRICTION_LIFTED;
    }
}

/* Its event function, raised by what rounding and the tolerance of speeds may make of it. */
static double raised_friction_event(const struct scene_values *v, const struct scene_state *q,
                                    const struct scene_instant *at, int contact, enum ode_event event)
{
    struct scene_ode ode = {.values = v, .state = q};
    double events[ODE_EVENTS_EACH];
    const double tolerated =
        solver_relative_tolerance(v) * vec3_norm(at->turning.slip[contact]) + solver_absolute_tolerance(v);
    turning_friction_events(&ode, at, contact, tolerated, events);
    return events[event];
}

double regime_friction_margin(const struct scene_values *v, const struct scene_state *q,
                              const struct scene_instant *at, int contact, enum ode_event event)
{
    if (!contact_rubs(v, contact) || !contact_transmits(q, contact)) {
        return 1.0;
    }
    const double margin = raised_friction_event(v, q, at, contact, event);
    return is_beyond((enum friction_regime)q->contact[contact].friction_regime, event) ? -margin : margin;
}

enum ode_event regime_friction_event(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, int contact)
{
    static const enum ode_event EVENTS[] = {ODE_EVENT_STICK, ODE_EVENT_CAP, ODE_EVENT_LIFT};
    for (int i = 0; i < 3 && contact_rubs(v, contact) && contact_transmits(q, contact); ++i) {
        if (raised_friction_event(v, q, at, contact, EVENTS[i]) < 0.0) {
            return EVENTS[i];
        }
    }
    return ODE_EVENT_GAP;
}
#endif
