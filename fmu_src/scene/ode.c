#include "scene/ode.h"

#include <float.h>

#include "scene/energy.h"
#include "scene/present.h"
#include "scene/rounding.h"
#include "scene/singularity.h"
#include "scene/turning_ode.h"
#include "scene/zones.h"

/* Relative acceleration by all but the contact itself. */
static struct vec3 acceleration_by_others(const struct scene_values *v, const struct scene_instant *at,
                                          int contact)
{
    const struct vec3 all =
        vec3_sub(at->acceleration[contact_destination(contact)], at->acceleration[contact_source(contact)]);
    return vec3_axpy(all, scene_inverse_mass(v, contact), at->source_force[contact]);
}

/* At rest n takes the direction of the acceleration by other contacts: the contact's own force acts along c,
 * so no other direction persists. */
void ode_leave_centres(const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (at.geometry[j].degenerate) {
            const struct contact_shape shape = scene_contact_shape(v, q, j);
            q->contact[j].normal =
                singularity_escape(&shape, at.rate[j], vec3_make(0.0, 0.0, 0.0), q->contact[j].normal);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (at.geometry[j].degenerate && contact_is_coupled(v, q, j)) {
            const struct contact_shape shape = scene_contact_shape(v, q, j);
            scene_now(v, q, &at); /* the others' directions are known better now */
            q->contact[j].normal = singularity_escape(&shape, at.rate[j], acceleration_by_others(v, &at, j),
                                                      q->contact[j].normal);
        }
    }
}

/* What the lightest free body would have of momentum with that energy: sqrt(2 m E) [N s]. */
static double momentum_scale(const struct scene_values *v, double energy)
{
    double lightest = (double)INFINITY;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        lightest = body_is_free(v, i) ? fmin(lightest, body_mass(v, i)) : lightest;
    }
    return sqrt(2.0 * lightest * energy);
}

/* See rounding_margin_offset. Twice the gap's rounding bound: the start itself may be off by one. */
void ode_begin(struct scene_ode *ode, const struct scene_instant *at, double relative, double absolute)
{
    const struct scene_values *v = ode->values;
    ode->energy_scale = energy_kinetic_of(v, at) + energy_stored(v, ode->state, at);
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        ode->energy_scale += energy_rotational_of(v, at);
    }
#endif
    ode->momentum_scale = momentum_scale(v, ode->energy_scale);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double tolerated = relative * vec3_norm(at->rate[j]) + absolute;
        ode->gap_offset[j] = 2.0 * rounding_of_gap(v, at, j);
        ode->zone_offset[j] = ode->gap_offset[j] + 2.0 * fmax(-zones_margin(v, ode->state, at, j), 0.0);
        ode->margin_offset[j] = rounding_margin_offset(v, ode->state, at, j, tolerated);
#if SCENE_ANY_TURNING
        if (scene_turns(v)) {
            turning_begin(ode, at, j, tolerated);
        }
#endif
    }
}

static struct vec3 vec3_from(const double *data)
{
    return vec3_make(data[0], data[1], data[2]);
}

static void vec3_to(struct vec3 a, double *data)
{
    data[0] = a.x;
    data[1] = a.y;
    data[2] = a.z;
}

static void unpack_bodies(const struct scene_values *v, const double *y,
                          struct body_state bodies[SCENE_BODIES])
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const double *at = y + ode_body(v, i);
            bodies[i] = (struct body_state){vec3_from(at), vec3_from(at + 3)};
        }
    }
}

void ode_pack(const struct scene_ode *ode, double *y)
{
    const struct scene_values *v = ode->values;
    const struct scene_state *q = ode->state;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            vec3_to(q->body[i].moved, y + ode_body(v, i));
            vec3_to(q->body[i].velocity, y + ode_body(v, i) + 3);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        vec3_to(q->contact[j].physics.impulse, y + ode_impulse(v, j));
    }
    y[ode_dissipated(v)] = q->dissipated;
    y[ode_dissipated(v) + 1] = q->external_work;
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        turning_pack(ode, y);
        turning_pack_integrals(ode, y);
    }
#endif
}

void ode_unpack(const struct scene_values *v, struct scene_state *q, const double *y)
{
    unpack_bodies(v, y, q->body);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].physics.impulse = vec3_from(y + ode_impulse(v, j));
    }
    q->dissipated = y[ode_dissipated(v)];
    q->external_work = y[ode_dissipated(v) + 1];
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        turning_unpack(v, y, &q->turning);
        turning_unpack_integrals(v, q, y);
    }
#endif
}

void ode_instant(const struct scene_ode *ode, double clock, const double *y, struct scene_instant *at)
{
    struct body_state bodies[SCENE_BODIES];
    unpack_bodies(ode->values, y, bodies);
#if SCENE_ANY_TURNING
    if (scene_turns(ode->values)) {
        struct turning_state turning = ode->state->turning;
        turning_unpack(ode->values, y, &turning);
        scene_evaluate_turning(ode->values, ode->state, clock, bodies, &turning, at);
        return;
    }
#endif
    scene_evaluate(ode->values, ode->state, clock, bodies, at);
}

void ode_rates(const struct scene_ode *ode, double clock, const double *y, double *rates)
{
    const struct scene_values *v = ode->values;
    struct scene_instant at;
    ode_instant(ode, clock, y, &at);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            vec3_to(at.velocity[i], rates + ode_body(v, i));
            vec3_to(at.acceleration[i], rates + ode_body(v, i) + 3);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        vec3_to(at.source_force[j], rates + ode_impulse(v, j));
    }
    rates[ode_dissipated(v)] = energy_dissipated_power(v, ode->state, &at);
    rates[ode_dissipated(v) + 1] = scene_external_power(v, ode->state, clock, &at);
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        turning_rates(ode, clock, y, &at, rates);
    }
#endif
}

static void set_three(double *sizes, double size)
{
    sizes[0] = sizes[1] = sizes[2] = size;
}

void ode_nominal(const struct scene_ode *ode, const double *y, double *sizes)
{
    const struct scene_values *v = ode->values;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const int index = ode_body(v, i);
            set_three(sizes + index, vec3_norm(vec3_from(y + index)));
            set_three(sizes + index + 3, vec3_norm(vec3_from(y + index + 3)));
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int index = ode_impulse(v, j);
        set_three(sizes + index, fmax(vec3_norm(vec3_from(y + index)), ode->momentum_scale));
    }
    for (int i = ode_dissipated(v); i < ode_size(v); ++i) {
        sizes[i] = fmax(fabs(y[i]), ode->energy_scale);
    }
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        turning_nominal(ode, y, sizes);
    }
#endif
}
