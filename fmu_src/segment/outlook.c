#include "segment/outlook.h"

#include "scene/rounding.h"
#include "segment/flight_turning.h"
#include "segment/relative_path.h"
#include "segment/tumbling_touch.h"

#if SCENE_ANY_ROTATION

/* Instants per radian that the axis turns, and at least, at which the law of a contact without touch or
 * parting is looked at: its changes are smooth functions of the motion, and none of them is an onset. */
static const double LAW_INSTANTS_PER_RADIAN = 16.0, LEAST_LAW_INSTANTS = 64.0, MOST_LAW_INSTANTS = 1e6;

/* Whether the axis of the destination may turn. */
static bool axis_turns(const struct scene_values *v, int contact)
{
    const int destination = contact_destination(contact);
    return body_turns(v, destination) && body_shape(destination) != SHAPE_SPHERE;
}

/* Whether another contact presses on a body of this one. */
static bool is_loaded(const struct scene_values *v, const struct scene_state *q, int contact)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < 2; ++i) {
        const int body = i == 0 ? contact_source(contact) : contact_destination(contact);
        const bool moves = body_is_free(v, body) || body_turns_freely(v, body);
        if (moves && body_is_loaded(q, body, contact)) {
            return true;
        }
    }
    return false;
}

static struct tumbling_path tumbling_path_of(const struct scene_values *v, const struct scene_state *q,
                                             const struct scene_instant *at, int contact)
{
    const struct separation_path separation = separation_path_of(v, q, at, q->clock, contact);
    const int destination = contact_destination(contact);
    struct tumbling_path path = {.shape = scene_contact_shape_at(v, q, at, contact),
                                 .rounding = rounding_of_gap(v, at, contact)};
    for (int i = 0; i < TUMBLING_TERMS; ++i) {
        path.c[i] = separation.c[i];
    }
    path.axis = flight_axis_motion(v, q, &at->turning.body[destination], destination);
    return path;
}

static enum contact_regime regime_at_time(const struct tumbling_path *path, const struct contact_law *law,
                                          double time)
{
    struct tumbling_instant at;
    tumbling_at(path, TUMBLING_TOUCH, time, &at);
    return contact_regime_of(law, at.geometry.gap, at.geometry.gap_rate,
                             contact_within_extents(&path->shape, at.geometry.axial));
}

static double halve_to_regime(const struct tumbling_path *path, const struct contact_law *law,
                              enum contact_regime present, double before, double after)
{
    for (;;) {
        const double middle = 0.5 * (before + after);
        if (!(middle > before && middle < after)) {
            return after;
        }
        if (regime_at_time(path, law, middle) == present) {
            before = middle;
        } else {
            after = middle;
        }
    }
}

/* What the law changes before `until`, while the bodies go on touching. */
static void look_for_law(const struct tumbling_path *from_now, const struct contact_law *law,
                         enum contact_regime present, double until, long budget, struct outlook *found)
{
    struct tumbling_path path = *from_now;
    const struct axis_bounds axis = axis_motion_bounds(&path.axis, 0.0, until);
    const double wanted = LEAST_LAW_INSTANTS + LAW_INSTANTS_PER_RADIAN * axis.speed * until;
    const long count = (long)fmin(wanted, fmin(MOST_LAW_INSTANTS, fmax(LEAST_LAW_INSTANTS, (double)budget)));
    double before = 0.0;
    for (long i = 1; i < count; ++i) {
        const double time = until * ((double)i / (double)count);
        const enum contact_regime then = regime_at_time(&path, law, time);
        found->evaluations += 1;
        if (then != present && then != REGIME_APART) {
            const double change = halve_to_regime(&path, law, present, before, time);
            struct tumbling_instant at;
            tumbling_at(&path, TUMBLING_TOUCH, change, &at);
            found->next = (struct regime_change){change, then, at.geometry.gap, true};
            return;
        }
        before = time;
        axis_motion_move_on(&path.axis, time);
    }
}

static struct outlook tumbling_outlook(const struct scene_values *v, const struct scene_state *q,
                                       const struct scene_instant *at, int contact, double horizon,
                                       long budget)
{
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct tumbling_path path = tumbling_path_of(v, q, at, contact);
    const bool apart = present == REGIME_APART;
    const struct tumbling_result change =
        tumbling_first(&path, apart ? TUMBLING_TOUCH : TUMBLING_PARTING, horizon, budget);
    struct outlook found = {{change.after, present, change.gap, true}, change.searched, change.evaluations};
    if (change.after < (double)INFINITY) {
        found.searched = horizon;
        found.next.regime = !apart              ? REGIME_APART
                            : change.gap == 0.0 ? REGIME_COMPRESSION
                                                : regime_at_time(&path, &law, change.after);
        if (found.next.regime == REGIME_APART && apart) {
            found.next.regime = REGIME_COMPRESSION; /* on the end plane, to rounding */
        }
    }
    if (!apart && contact_has_events(&law)) {
        look_for_law(&path, &law, present, fmin(change.after, change.searched), budget, &found);
    }
    return found;
}
#endif

struct outlook outlook_of(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact, double horizon, long budget)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
        const struct outlook nothing = {{(double)INFINITY, present, 0.0, true}, horizon, 0};
        if (contact_transmits(q, contact) && !contact_is_driven(v, contact)) {
            return nothing;
        }
#if SCENE_ANY_ROTATION
        if (axis_turns(v, contact)) {
            return is_loaded(v, q, contact) ? nothing : tumbling_outlook(v, q, at, contact, horizon, budget);
        }
#endif
    }
#endif
    (void)budget;
    const struct regime_change next = next_regime_change(v, q, at, q->clock, contact, horizon);
    return (struct outlook){next, horizon, 0};
}
