#include "segment/zone_change.h"

#include <float.h>

#include "contact/zone.h"
#include "scene/present.h"
#include "scene/rounding.h"
#include "segment/zone_path.h"

#if SCENE_ANY_CAPS

static double rounding_now(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact)
{
    return scene_gap_is_accumulated(q, at, contact) ? 8.0 * DBL_EPSILON * fabs(at->geometry[contact].gap)
                                                    : rounding_of_gap(v, at, contact);
}

/* How a gap within its rounding goes on: by its rate, and by the acceleration along the normal and the
 * turning of it. */
struct opening {
    double speed, bend; /* [m/s], half the acceleration [m/s^2] */
};

static struct opening opening_at(const struct contact_shape *shape, const struct separation_path *path)
{
    const struct contact_geometry at =
        contact_geometry_at(shape, path->c[0], path->c[1], vec3_make(0.0, 0.0, 0.0));
    const struct contact_shape met = contact_shape_in(shape, at.zone);
    const double turning = contact_turns(&met, &at)
                               ? contact_turning_rate(&met, &at, path->c[1], path->c[1]) / at.distance
                               : 0.0;
    return (struct opening){at.gap_rate, vec3_dot(at.normal, path->c[2]) + 0.5 * turning};
}

/* Whether bodies whose gap is zero, to rounding, go on to overlap; else for how long they stay within it
 * [s]. */
static bool closes(struct opening opening, double noise, double rate_noise, double *leaving)
{
    *leaving = fmin(noise / fabs(opening.speed), sqrt(noise / fabs(opening.bend)));
    return opening.speed < -rate_noise || (fabs(opening.speed) <= rate_noise && opening.bend < 0.0);
}

/* Rounding of a gap that stays at zero may be met more than once. */
enum { TRIALS = 1000 };

double zone_change_touch(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon)
{
    const struct contact_shape shape = scene_whole_shape(v, q, contact);
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    const double rate_noise = rounding_of_rate(at, contact);
    double time = fmax(0.0, q->contact[contact].schedule.settled_clock - clock);
    double noise = rounding_now(v, q, at, contact);
    bool near = fabs(at->geometry[contact].gap) <= noise;
    noise = rounding_of_gap(v, at, contact);
    for (int i = 0; i < TRIALS && time <= horizon; ++i) {
        struct separation_path from = path;
        path_shift(from.c, SEPARATION_DEGREE + 1, time);
        double leaving;
        const bool touches = closes(opening_at(&shape, &from), noise, rate_noise, &leaving);
        if (near && touches) {
            return time;
        }
        if (near && !(leaving < horizon)) {
            return (double)INFINITY; /* they stay as they are */
        }
        time = zone_path_first_touch(&shape, &path, near ? time + leaving : time, horizon);
        if (!(time < (double)INFINITY)) {
            return (double)INFINITY;
        }
        near = true;
    }
    return (double)INFINITY;
}

double zone_change_after(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    return zone_path_end(&shape.solid, &path, horizon);
}

struct rim_change zone_change_at_rim(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, double clock, int contact,
                                     double horizon)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    return rim_first_change(&shape, &law, &path, rounding_of_gap(v, at, contact), present, 0.0, horizon);
}

#endif
