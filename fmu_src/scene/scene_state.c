#include <stddef.h>
#include <string.h>

#include "contact/shape.h"
#include "scene/evaluate.h"
#include "scene/scene_state.h"

void contact_peaks_note(struct contact_peaks *peaks, double force, double penetration)
{
    peaks->force = force > peaks->force ? force : peaks->force;
    peaks->penetration = penetration > peaks->penetration ? penetration : peaks->penetration;
}

void counter_add(int32_t *counter, long more)
{
    const long room = (long)INT32_MAX - *counter;
    *counter += (int32_t)(more < room ? more : room);
}

double scene_time(const struct scene_state *q)
{
    return q->base + (q->base_tail + q->clock);
}

double scene_remaining(const struct scene_state *q, double end_time)
{
    return (end_time - q->base) - q->base_tail - q->clock;
}

bool body_is_free(const struct scene_values *v, int body)
{
    return SCENE_ANY_FREE && body_motion(v, body) == MOTION_FREE;
}

bool body_is_prescribed(const struct scene_values *v, int body)
{
    return SCENE_ANY_PRESCRIBED && body_motion(v, body) == MOTION_PRESCRIBED;
}

bool body_turns_freely(const struct scene_values *v, int body)
{
    return SCENE_ANY_FREE_ROTATION && body_rotation(v, body) == ROTATION_FREE;
}

bool body_moves_freely(const struct scene_values *v, int body)
{
    return body_is_free(v, body) || body_turns_freely(v, body);
}

bool body_turn_is_prescribed(const struct scene_values *v, int body)
{
    return SCENE_ANY_ROTATION && body_rotation(v, body) == ROTATION_PRESCRIBED;
}

bool body_turns(const struct scene_values *v, int body)
{
    return SCENE_ANY_ROTATION && body_rotation(v, body) != ROTATION_NONE;
}

void body_path_shift(const struct scene_values *v, int body, struct body_path *path, double clock)
{
    if (body_is_prescribed(v, body)) {
        path_shift(path->displacement, 4, clock);
        path_shift(path->velocity, 3, clock);
    } else if (body_is_free(v, body)) {
        path_shift(path->force, 3, clock);
    }
    if (body_turn_is_prescribed(v, body)) {
        path_shift(path->angular_velocity, 3, clock);
        path_shift(path->axis, 3, clock);
    } else if (body_turns_freely(v, body)) {
        path_shift(path->torque, 3, clock);
    }
}

bool body_is_compound(int body)
{
    return SCENE_ANY_COMPOUND && body_shape(body) == SHAPE_COMPOUND;
}

bool body_has_axis(int body)
{
    return body_shape(body) != SHAPE_SPHERE && !body_is_compound(body);
}

bool body_tips(const struct scene_values *v, int body)
{
    return body_turns(v, body) && body_shape(body) != SHAPE_SPHERE && !body_keeps_axis(body);
}

bool contact_advances(const struct scene_values *v, int contact)
{
    const int destination = contact_destination(contact);
    return body_tips(v, destination) || (SCENE_ANY_TORUS && body_shape(destination) == SHAPE_TORUS) ||
           contact_has_skew_axes(v, contact) || body_is_compound(contact_source(contact)) ||
           body_is_compound(destination);
}

bool contact_has_skew_axes(const struct scene_values *v, int contact)
{
    return SCENE_ANY_SKEW && contact_axes(v, contact) == AXES_SKEW;
}

bool contact_tips(const struct scene_values *v, int contact)
{
    return body_tips(v, contact_destination(contact)) && !body_is_compound(contact_destination(contact));
}

bool contact_rubs(const struct scene_values *v, int contact)
{
    return SCENE_ANY_FRICTION &&
           (contact_friction(v, contact) != FRICTION_NONE || contact_resists(v, contact));
}

bool contact_resists(const struct scene_values *v, int contact)
{
    return SCENE_ANY_ROLLING &&
           (contact_rolling(v, contact) != RESISTANCE_NONE ||
            contact_spinning(v, contact) != RESISTANCE_NONE) &&
           (body_turns(v, contact_source(contact)) || body_turns(v, contact_destination(contact)));
}

int contact_opposed(const struct scene_values *v, int contact)
{
    return contact_resists(v, contact) ? OPPOSED : 1;
}

bool contact_has_spring(const struct scene_values *v, int contact, int part)
{
    if (part == OPPOSED_SLIP) {
        return SCENE_ANY_ELASTIC_FRICTION && contact_friction(v, contact) == FRICTION_ELASTIC;
    }
    const int kind = part == OPPOSED_ROLLING ? contact_rolling(v, contact) : contact_spinning(v, contact);
    return SCENE_ANY_ELASTIC_ROLLING && kind == RESISTANCE_ELASTIC && contact_resists(v, contact);
}

bool contact_has_springs(const struct scene_values *v, int contact)
{
    return contact_has_spring(v, contact, OPPOSED_SLIP) || contact_has_spring(v, contact, OPPOSED_ROLLING) ||
           contact_has_spring(v, contact, OPPOSED_SPINNING);
}

bool scene_turns(const struct scene_values *v)
{
    bool turns = SCENE_ANY_TORUS || SCENE_ANY_COMPOUND;
    for (int i = 0; SCENE_ANY_ROTATION && i < SCENE_BODIES && !turns; ++i) {
        turns = body_turns(v, i);
    }
    for (int j = 0; (SCENE_ANY_FRICTION || SCENE_ANY_SKEW) && j < SCENE_CONTACTS && !turns; ++j) {
        turns =
            (SCENE_ANY_FRICTION && contact_friction(v, j) != FRICTION_NONE) || contact_has_skew_axes(v, j);
    }
    return turns;
}

/* Whether any free body is in more than one contact, so that contacts may act on each other through it. */
static bool scene_shares_free_body(const struct scene_values *v)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        int contacts = 0;
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            contacts += contact_source(j) == i || contact_destination(j) == i;
        }
        if (body_is_free(v, i) && contacts > 1) {
            return true;
        }
    }
    return false;
}

bool scene_keeps_steps(const struct scene_values *v)
{
    return SCENE_HAS_GENERAL && (scene_turns(v) || scene_shares_free_body(v));
}

void scene_state_copy(const struct scene_state *from, struct scene_state *to)
{
    const bool goes_on = !from->integrator_fresh && scene_keeps_steps(from->v);
    memcpy(to, from,
           goes_on                ? sizeof *to
           : scene_turns(from->v) ? offsetof(struct scene_state, unfinished)
                                  : offsetof(struct scene_state, turning));
}

bool contact_is_prescribed(const struct scene_values *v, int contact)
{
    return SCENE_ANY_PRESCRIBED_CONTACT && !body_moves_freely(v, contact_source(contact)) &&
           !body_moves_freely(v, contact_destination(contact));
}

bool scene_is_force_element(const struct scene_values *v)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_moves_freely(v, i)) {
            return false;
        }
    }
    return true;
}

bool scene_uses_ode(const struct scene_values *v)
{
    return solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN || scene_keeps_steps(v);
}

/* Whether a spring of friction, rolling or spinning has not relaxed. */
CONTACT_NOINLINE static bool any_spring_is_drawn(const struct scene_state *q, int contact)
{
    bool any = false;
    for (int i = 0; SCENE_ANY_SPRINGS && i < OPPOSED; ++i) {
        any = any || vec3_max_abs(q->turning.spring[contact][i]) > 0.0;
    }
    return any;
}

bool contact_transmits(const struct scene_state *q, int contact)
{
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    return regime == REGIME_COMPRESSION || regime == REGIME_RESTITUTION ||
           (regime == REGIME_SEPARATING && any_spring_is_drawn(q, contact));
}

bool contact_pushes(const struct scene_state *q, int contact)
{
    return contact_transmits(q, contact) && !contact_is_prescribed(q->v, contact);
}

bool body_is_loaded(const struct scene_state *q, int body, int except)
{
#if SCENE_CONTACTS > 1
    for (const int16_t *j = body_contacts(body); *j >= 0; ++j) {
        if (*j != except && contact_transmits(q, *j)) {
            return true;
        }
    }
    return false;
#else
    return except != 0 && (contact_source(0) == body || contact_destination(0) == body) &&
           contact_transmits(q, 0);
#endif
}

struct islands scene_islands(const struct scene_state *q)
{
    struct islands found = {0};
    int number[SCENE_CONTACTS];
    int latest[SCENE_BODIES]; /* the latest contact in touch of each body */
    int size[SCENE_CONTACTS] = {0};
    memset(latest, -1, sizeof latest);
    memset(number, -1, sizeof number);
    for (int j = 0; j < SCENE_CONTACTS; ++j) { /* until all are joined, one of its contacts names an island */
        const int ends[2] = {contact_source(j), contact_destination(j)};
        found.of[j] = q->contact[j].regime != (int32_t)REGIME_APART ? j : -1;
        for (int k = 0; k < 2 && found.of[j] >= 0; ++k) {
            const int own = found.of[j];
            const bool joins = body_moves_freely(q->v, ends[k]) && latest[ends[k]] >= 0;
            const int other = joins ? found.of[latest[ends[k]]] : own;
            for (int i = own == j ? j : 0; own != other && i <= j; ++i) { /* j alone has the name j */
                found.of[i] = found.of[i] == own ? other : found.of[i];
            }
            latest[ends[k]] = j;
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int name = found.of[j];
        if (name >= 0) {
            number[name] = number[name] < 0 ? found.count++ : number[name];
            found.of[j] = number[name];
            ++size[name];
            found.largest = size[name] > found.largest ? size[name] : found.largest;
        }
    }
    return found;
}

bool contact_is_coupled(const struct scene_state *q, int contact)
{
    if (SCENE_CONTACTS == 1) {
        return false;
    }
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    return (body_moves_freely(q->v, source) && body_is_loaded(q, source, contact)) ||
           (body_moves_freely(q->v, destination) && body_is_loaded(q, destination, contact));
}

static bool has_caps(const struct scene_values *v, int body)
{
    return SCENE_ANY_CAPS && body_shape(body) == SHAPE_CYLINDER && body_finite_length(v, body) &&
           body_ends(v, body) == ENDS_CAPPED;
}

int scene_contact_side(const struct scene_state *q, int contact)
{
    if (has_caps(q->v, contact_destination(contact)) || contact_has_skew_axes(q->v, contact)) {
        return 1;
    }
    if (contact_location(q->v, contact) != LOCATION_AUTOMATIC) {
        return contact_location(q->v, contact) == LOCATION_INSIDE ? -1 : 1;
    }
    return q->contact[contact].side;
}

/* Returns struct contact_solid's race of a torus, 0 of other bodies. */
static int race_of(const struct scene_values *v, int body)
{
    if (!SCENE_ANY_TORUS || body_shape(body) != SHAPE_TORUS) {
        return 0;
    }
    return (body_side(v, body) == TUBE_SIDE_INNER_RACE) - (body_side(v, body) == TUBE_SIDE_OUTER_RACE);
}

struct vec3 body_unit_axis(const struct scene_values *v, int body)
{
    const struct vec3 axis = body_axis(v, body);
    return vec3_scale(1.0 / vec3_norm(axis), axis);
}

/* This function is not inlined: a restored state must have the bits that it gives, and a compiler that fuses
 * operations may give other bits at each place of inlining. */
CONTACT_NOINLINE void contact_fix_axes(const struct scene_values *v, int contact,
                                       struct contact_parameters *fixed)
{
    if (SCENE_ANY_AXIS && body_has_axis(contact_destination(contact))) {
        fixed->axis = body_unit_axis(v, contact_destination(contact));
    }
#if SCENE_ANY_SKEW
    if (contact_has_skew_axes(v, contact)) {
        fixed->skew = contact_skew_axes(body_unit_axis(v, contact_source(contact)), fixed->axis);
    }
#endif
}

/* Returns half of the length of a cylinder [m]. */
static double half_of(const struct scene_values *v, int body)
{
    return body_finite_length(v, body) ? 0.5 * body_length(v, body) : (double)INFINITY;
}

/* Returns the distance of the centres along the axis at which contact with a cylinder ends suddenly [m],
 * INFINITY where it never does: L/2, and half of both lengths where the source is a cylinder with a parallel
 * axis; R of a race. */
static double half_length_of(const struct scene_values *v, int contact)
{
    double sum = 0.0;
    if (race_of(v, contact_destination(contact)) != 0) {
        return body_ring_radius(v, contact_destination(contact));
    }
    for (int i = 0; i < 2 && !contact_has_skew_axes(v, contact); ++i) {
        const int body = i == 0 ? contact_destination(contact) : contact_source(contact);
        if (SCENE_ANY_CYLINDER && body_shape(body) == SHAPE_CYLINDER) {
            sum += half_of(v, body);
        }
    }
    return sum > 0.0 ? sum : (double)INFINITY;
}

bool scene_ends_suddenly(const struct scene_values *v, int contact)
{
    return !SCENE_ANY_ENDLESS ||
           (isfinite(half_length_of(v, contact)) && !has_caps(v, contact_destination(contact)));
}

struct contact_shape scene_whole_shape(const struct scene_state *q, int contact)
{
    const struct scene_values *v = q->v;
    const int destination = contact_destination(contact);
    struct contact_shape shape = {.source_radius = contact_source_radius(v, contact),
                                  .other_radius = contact_destination_radius(v, contact),
                                  .half_length = half_length_of(v, contact),
                                  .side = scene_contact_side(q, contact),
                                  .destination = contact_destination_shape(contact)};
    if (SCENE_ANY_AXIS) {
        shape.axis = q->contact[contact].parameters.axis;
    }
    if (SCENE_ANY_TORUS && shape.destination == SHAPE_TORUS) {
        shape.solid.radius = body_ring_radius(v, destination);
        shape.solid.race = race_of(v, destination);
    }
    if (SCENE_ANY_CAPS && has_caps(v, destination)) {
        shape.solid = (struct contact_solid){
            .axis = shape.axis, .radius = shape.other_radius, .half_height = shape.half_length};
        shape.half_length = (double)INFINITY; /* the gap goes on beyond the ends */
    }
#if SCENE_ANY_SKEW
    if (contact_has_skew_axes(v, contact)) {
        struct skew_frame *frame = &shape.solid.skew;
        shape.destination = SHAPE_SKEW;
        *frame = q->contact[contact].parameters.skew;
        for (int i = 0; i < 2; ++i) {
            frame->half[i] = half_of(v, i == 0 ? contact_source(contact) : destination);
            frame->reach[i] = frame->sine * frame->half[i];
        }
    }
#endif
    return shape;
}

struct contact_shape scene_contact_shape(const struct scene_state *q, int contact)
{
    struct contact_shape shape = scene_whole_shape(q, contact);
    contact_enter_zone(&shape, q->contact[contact].zone);
    return shape;
}

struct contact_shape scene_shape_met(const struct scene_instant *at, int contact)
{
    struct contact_shape shape = scene_contact_shape_at(at, contact);
    contact_enter_zone(&shape, at->geometry[contact].zone);
    return shape;
}

struct contact_shape scene_contact_shape_at(const struct scene_instant *at, int contact)
{
    struct contact_shape shape = scene_whole_shape(at->q, contact);
    if (contact_tips(at->v, contact)) {
        shape.axis = quaternion_third_axis(at->turning.body[contact_destination(contact)].orientation);
        shape.solid.axis = contact_is_capped(&shape) ? shape.axis : shape.solid.axis;
    }
    contact_enter_zone(&shape, at->q->contact[contact].zone);
    return shape;
}

double scene_beyond_ends(const struct contact_shape *shape, const struct contact_geometry *geometry)
{
    return SCENE_ANY_ENDS ? fabs(geometry->axial) - shape->half_length : -(double)INFINITY;
}
