/* The start of a motion from parameters and inputs. */
#include <string.h>

#include "contact/bounding_box.h"
#include "model/motion.h"

static struct vec3 start_displacement(const struct scene_values *v, const struct scene_state *q, int body)
{
    if (body_is_free(v, body)) {
        return body_initial_displacement(v, body);
    }
    return body_is_prescribed(v, body) ? q->path[body].displacement[0] : vec3_make(0.0, 0.0, 0.0);
}

static struct vec3 unit_axis(const struct scene_values *v, int body)
{
    const struct vec3 axis = body_axis(v, body);
    return vec3_scale(1.0 / vec3_norm(axis), axis);
}

/* A plane has no box of its own: that of `other`, so that both together are that. */
static struct bounding_box body_box(const struct scene_values *v, int body, struct vec3 centre,
                                    const struct bounding_box *other)
{
    if (SCENE_ANY_PLANE && body_shape(body) == SHAPE_PLANE) {
        return *other;
    }
    if (SCENE_ANY_CYLINDER && body_shape(body) == SHAPE_CYLINDER) {
        const double half_length = body_finite_length(v, body) ? 0.5 * body_length(v, body) : 0.0;
        return bounding_box_cylinder(centre, body_radius(v, body), unit_axis(v, body), half_length);
    }
    return bounding_box_sphere(centre, body_radius(v, body));
}

/* Seen from the source's centre, so that a common offset costs no digits. */
static void start_boxes(const struct scene_values *v, const struct scene_state *q, int contact,
                        struct bounding_box boxes[2])
{
    const int from = contact_source(contact);
    const int to = contact_destination(contact);
    const struct vec3 apart = vec3_sub(body_center(v, to), body_center(v, from));
    const struct vec3 moved = vec3_sub(start_displacement(v, q, to), start_displacement(v, q, from));
    boxes[0] = body_box(v, from, vec3_make(0.0, 0.0, 0.0), NULL);
    boxes[1] = body_box(v, to, vec3_add(apart, moved), &boxes[0]);
}

double model_diagonal_slope(const struct model *m, int contact, struct vec3 rate)
{
    struct bounding_box boxes[2];
    start_boxes(&m->state.values, &m->state.motion, contact, boxes);
    return bounding_box_diagonal_rate(&boxes[0], &boxes[1], rate);
}

/* Inside when the centre (or axis) is closer than r_d and the source fits in, else outside. */
static int automatic_side(const struct contact_shape *shape, const struct contact_geometry *start)
{
    const bool inside = start->distance < shape->other_radius && shape->source_radius < shape->other_radius;
    return inside ? -1 : 1;
}

#if SCENE_ANY_FRICTION
/* A thousandth of the diagonal per second, or the user's [m/s]. */
static double slip_velocity_of(const struct scene_values *v, int contact, double diagonal)
{
    return contact_slip_velocity_control(v, contact) == SLIP_VELOCITY_CONTROL_AUTOMATIC
               ? 1e-3 * diagonal
               : contact_characteristic_slip_velocity(v, contact);
}
#endif

static void prepare_contact(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct contact_state *state = &q->contact[contact];
    struct bounding_box boxes[2];
    start_boxes(v, q, contact, boxes);
    state->parameters.diagonal = bounding_box_diagonal(&boxes[0], &boxes[1]);
    state->side = 1;
    state->regime = (int32_t)REGIME_APART;
#if SCENE_ANY_FRICTION
    state->parameters.slip_velocity = slip_velocity_of(v, contact, state->parameters.diagonal);
#endif
#if SCENE_ANY_CYLINDER || SCENE_ANY_PLANE
    if (body_shape(contact_destination(contact)) != SHAPE_SPHERE) {
        state->parameters.axis = unit_axis(v, contact_destination(contact));
    }
#endif
    struct contact_shape shape = scene_contact_shape(v, q, contact);
    state->normal = contact_default_normal(&shape);
    struct scene_instant at;
    scene_now(v, q, &at);
    if (contact_location(v, contact) == LOCATION_AUTOMATIC && !contact_is_capped(&shape)) {
        state->side = automatic_side(&shape, &at.geometry[contact]);
    } else {
        state->side = shape.side;
    }
    state->normal = at.geometry[contact].normal;
    state->parameters.factors = model_factors(v, q, contact);
}

void model_prepare(struct model *m)
{
    struct scene_state *q = &m->state.motion;
    const struct scene_values *v = &m->state.values;
    memset(q, 0, sizeof *q);
    if (m->state.importer_tolerance > 0.0) {
        put_solver_relative_tolerance(&m->state.values, m->state.importer_tolerance);
    }
    q->base = m->state.start_time;
    model_start_paths(m);
    motion_place(v, q);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].side = 1;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        prepare_contact(v, q, j);
    }
    motion_begin(v, q);
    if (m->host.exchange) {
        motion_begin_exchange(q);
    }
}
