#include "segment/driven_turning.h"

#include "scene/free_bodies.h"
#include "scene/rounding.h"
#include "segment/driven_quadrature.h"
#include "segment/driven_regime.h"
#include "segment/relative_path.h"
#include "segment/tumbling_touch.h"

#if SCENE_ANY_TURNING

static struct axis_motion axis_from(const struct driven_span *s, const struct scene_instant *at, double clock)
{
    const int destination = contact_destination(s->c.contact);
    const struct vec3 axis = at->turning.axis[s->c.contact];
#if SCENE_ANY_ROTATION
    if (body_turn_is_prescribed(s->c.v, destination) && body_shape(destination) != SHAPE_SPHERE) {
        struct body_path path = s->c.q->path[destination];
        path_shift(path.angular_velocity, 3, clock);
        path_shift(path.axis, 3, clock);
        return path.turn_follows == TURN_FOLLOWS_VELOCITY ? axis_motion_driven(axis, path.angular_velocity, 3)
                                                          : axis_motion_following(path.axis, 3);
    }
#else
    (void)destination, (void)clock;
#endif
    return axis_motion_fixed(axis);
}

/* The motion from a clock on. */
static struct tumbling_path path_from(const struct driven_span *s, double clock)
{
    struct scene_instant at;
    scene_kinematics(s->c.v, s->c.q, clock, free_bodies_now(s->c.q), &at);
    const struct separation_path separation = separation_path_of(s->c.v, s->c.q, &at, clock, s->c.contact);
    struct tumbling_path path = {.shape = scene_contact_shape_at(s->c.v, s->c.q, &at, s->c.contact),
                                 .axis = axis_from(s, &at, clock),
                                 .rounding = rounding_of_gap(s->c.v, &at, s->c.contact)};
    for (int i = 0; i < TUMBLING_TERMS; ++i) {
        path.c[i] = separation.c[i];
    }
    return path;
}

/* So many evaluations of the gap in search of touches and partings, some tenths of a second; some dozens are
 * usual. */
static const long SEARCH_BUDGET = 1000000;

/* The clock of the next change, `end` where there is none. False where that is not found out. */
static bool finds_change(const struct driven_span *s, double clock, double end, enum tumbling_change change,
                         double *next)
{
    const struct tumbling_path path = path_from(s, clock);
    if (*s->evaluations <= 0) {
        return false;
    }
    const struct tumbling_result found = tumbling_first(&path, change, end - clock, *s->evaluations);
    *s->evaluations -= found.evaluations;
    *next = found.after < end - clock ? clock + found.after : end;
    return *next < end || !(found.searched < end - clock);
}

static void begin_contact(struct driven_span *s, double clock)
{
    struct scene_state *q = s->c.q;
    driven_begin(&s->c, clock);
    s->total.spring = driven_spring(q, s->c.contact);
#if SCENE_ANY_FREE
    struct contact_record *record = &q->contact[s->c.contact].record;
    counter_add(&record->onsets, 1);
    record->onset_time = q->base + (q->base_tail + clock);
    record->touch_clock = clock;
#endif
    counter_add(&q->counters.events, 1);
}

static void end_contact(struct driven_span *s, double clock)
{
    driven_end(&s->c);
#if SCENE_ANY_FREE
    struct contact_record *record = &s->c.q->contact[s->c.contact].record;
    record->last_duration = clock - record->touch_clock;
#else
    (void)clock;
#endif
    counter_add(&s->c.q->counters.events, 1);
}

/* What a finite cylinder's end or a jump leaves of the stored energy is dissipated. */
static double stored_at(const struct driven_span *s, double clock)
{
    struct scene_instant at;
    const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
    scene_kinematics(s->c.v, s->c.q, clock, free_bodies_now(s->c.q), &at);
    const double gap = fmin(at.geometry[s->c.contact].gap, 0.0);
    return contact_stored_energy(&law, REGIME_COMPRESSION, gap);
}

static bool span_over(struct driven_span *s, double end)
{
    struct scene_state *q = s->c.q;
    const int j = s->c.contact;
    double clock = q->clock;
    s->total.spring = driven_spring(q, j);
    while (clock < end) {
        const bool touches = q->contact[j].regime != (int32_t)REGIME_APART;
        double next;
        if ((*s->panels)-- <= 0 || /* any number of changes ends */
            !finds_change(s, clock, end, touches ? TUMBLING_PARTING : TUMBLING_TOUCH, &next) ||
            (touches && !driven_integrate(s, clock, next))) {
            return false;
        }
        if (next < end && touches) {
            s->sum[DRIVEN_DISSIPATED] += stored_at(s, next);
            end_contact(s, next);
        } else if (next < end) {
            begin_contact(s, next);
            s->sum[DRIVEN_DISSIPATED] -= stored_at(s, next);
        }
        clock = next;
    }
    return true;
}

static struct vec3 vector_from(const double *a)
{
    return vec3_make(a[0], a[1], a[2]);
}

/* Of a span of this length [s]. */
static void book_span(const struct driven_span *s, double length)
{
    struct contact_state *state = &s->c.q->contact[s->c.contact];
    const struct vec3 force = vector_from(s->sum + DRIVEN_FORCE);
    const struct vec3 source = vector_from(s->sum + DRIVEN_SOURCE_TORQUE);
    const struct vec3 destination = vector_from(s->sum + DRIVEN_DESTINATION_TORQUE);
#if SCENE_ANY_FREE
    state->physics.impulse = vec3_add(state->physics.impulse, force);
    state->torques.source_impulse = vec3_add(state->torques.source_impulse, source);
    state->torques.destination_impulse = vec3_add(state->torques.destination_impulse, destination);
    s->c.q->dissipated += s->sum[DRIVEN_DISSIPATED];
    s->c.q->friction_energy += s->sum[DRIVEN_FRICTION];
    s->c.q->external_work += s->sum[DRIVEN_WORK];
    (void)length;
#else
    state->mean_force = vec3_scale(1.0 / length, force);
    state->torques.source_mean = vec3_scale(1.0 / length, source);
    state->torques.destination_mean = vec3_scale(1.0 / length, destination);
#endif
#if SCENE_ANY_FRICTION
    s->c.q->turning.spring[s->c.contact] = s->total.spring;
#endif
}

/* So many steps of turning_prescribed_steps in all of its evaluations take as long as a panel does else. */
static const double STEPS_OF_PANEL = 5.0;

bool driven_turning_over(const struct scene_values *v, struct scene_state *q, double length, long panels)
{
    long evaluations = SEARCH_BUDGET;
    const double steps = turning_prescribed_steps(v, q, q->clock + length);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct driven_span s = {.c = {v, q, j},
                                .elastic = contact_rubs_elastically(v, j),
                                .panels = &panels,
                                .evaluations = &evaluations,
                                .panel_cost = 1 + (long)fmin(steps / STEPS_OF_PANEL, DRIVEN_PANELS)};
        if (!contact_is_driven(v, j)) {
            continue;
        }
        if (!span_over(&s, q->clock + length)) {
            return false;
        }
        book_span(&s, length);
    }
    return true;
}

#endif
