/* The event functions of the scene's differential equations. */
#include <float.h>

#include "scene/present.h"
#include "scene/turning_ode.h"
#include "scene/zones.h"

/* Zero is returned as a tiny negative number: a contact that starts at g = 0 does not end at once, a root is
 * not found twice, and CVODE, which rejects functions that stay at zero, never sees one. 1e-100 is far below
 * any meaningful gap, rate or force and leaves room for the root finder's products and quotients. */
static double not_zero(double value)
{
    return fabs(value) < 1e-100 ? -1e-100 : value;
}

/* The event functions of a contact whose bodies are loaded by another contact, so that closed forms do not
 * foresee its changes. */
static void coupled_events(const struct scene_ode *ode, const struct contact_shape *shape,
                           const struct contact_law *law, const struct contact_geometry *g, int j,
                           double out[ODE_EVENTS_EACH])
{
    const enum contact_regime regime = (enum contact_regime)ode->state->contact[j].regime;
    if (regime == REGIME_APART) {
        out[0] = not_zero(ode->gap_offset[j] + fmax(g->gap, scene_beyond_ends(shape, g)));
    } else {
        out[0] = not_zero(ode->gap_offset[j] - fmax(g->gap, scene_beyond_ends(shape, g)));
    }
    if (regime == REGIME_SEPARATING) {
        out[1] = not_zero(ode->margin_offset[j] + contact_event(law, regime, g->gap, g->gap_rate));
    }
}

static void put_zone(const struct scene_ode *ode, const struct scene_instant *at, int contact, double *out)
{
    if (SCENE_ANY_CAPS) {
        out[ODE_EVENTS_EACH - 1] =
            not_zero(ode->zone_offset[contact] + zones_margin(ode->values, ode->state, at, contact));
    }
}

void ode_events_at(const struct scene_ode *ode, double clock, const double *y, struct scene_instant *at,
                   double events[ODE_EVENTS])
{
    const struct scene_values *v = ode->values;
    ode_instant(ode, clock, y, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        double *out = events + ODE_EVENTS_EACH * j;
        const enum contact_regime regime = (enum contact_regime)ode->state->contact[j].regime;
        const struct contact_law law = scene_contact_law(v, ode->state, j);
        const struct contact_geometry *g = &at->geometry[j];
#if SCENE_ANY_TURNING
        if (scene_turns(v)) {
            turning_events(ode, clock, y, at, j, out);
            put_zone(ode, at, j, out);
            for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
                out[i] = not_zero(out[i]);
            }
            continue;
        }
        out[ODE_EVENT_STICK] = out[ODE_EVENT_CAP] = out[ODE_EVENT_LIFT] = 1.0;
#endif
        out[0] = out[1] = 1.0;
        if (contact_transmits(ode->state, j) && !contact_is_driven(v, j)) {
            out[0] = not_zero(ode->gap_offset[j] - g->gap);
            out[1] = not_zero(ode->margin_offset[j] + contact_event(&law, regime, g->gap, g->gap_rate));
        }
        if (contact_is_coupled(v, ode->state, j)) {
            const struct contact_shape shape = scene_contact_shape(v, ode->state, j);
            coupled_events(ode, &shape, &law, g, j, out);
        }
        put_zone(ode, at, j, out);
    }
}

void ode_events(const struct scene_ode *ode, double clock, const double *y, double events[ODE_EVENTS])
{
    struct scene_instant at;
    ode_events_at(ode, clock, y, &at, events);
}

enum contact_regime ode_regime_after(const struct scene_values *v, const struct scene_state *q, int contact,
                                     int event)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    if (event == ODE_EVENT_ZONE) {
        return regime; /* in the next zone */
    }
    if (event == 1) {
        return contact_regime_after(&law, regime);
    }
    if (regime != REGIME_APART) {
        return REGIME_APART;
    }
    struct scene_instant at;
    scene_now(v, q, &at);
    const double gap = fmin(at.geometry[contact].gap, -DBL_MIN);
    return contact_regime_of(&law, gap, at.geometry[contact].gap_rate, true);
}
