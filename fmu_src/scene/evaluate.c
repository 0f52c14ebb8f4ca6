#include "scene/evaluate.h"

#include <float.h>
#include <stddef.h>

#include "contact/factors.h"
#include "math/compiler.h"
#include "scene/free_bodies.h"
#include "scene/turning.h"

struct contact_law scene_contact_law(const struct scene_values *v, const struct scene_state *q, int contact)
{
    struct contact_coefficients factors = q->contact[contact].parameters.factors;
#if SCENE_ANY_HERTZ
    if (scene_damps_by_onset(v, contact)) {
        factors.c = q->contact[contact].onset_damping;
    }
#endif
    return contact_law_with(factors, (enum method)contact_method(v, contact),
                            (enum penalty_control)contact_penalty_control(v, contact),
                            (enum dashpot)contact_dashpot(v, contact),
                            (enum contact_force_law)contact_law(v, contact));
}

static struct body_instant body_at(const struct scene_values *v, const struct scene_state *q, double clock,
                                   const struct body_state *bodies, int body)
{
    struct body_instant at = {.origin = {0.0, 0.0, 0.0}};
    if (body_is_free(v, body)) {
        free_bodies_put(q, bodies, body, &at);
    }
    if (body_is_prescribed(v, body)) {
        at.origin = q->path[body].displacement[0];
        at.moved = vec3_scale(clock, path_at(q->path[body].displacement + 1, 3, clock));
        at.velocity = path_at(q->path[body].velocity, 3, clock);
    }
    at.displacement = vec3_add(at.origin, at.moved);
    return at;
}

struct body_instant scene_body_now(const struct scene_values *v, const struct scene_state *q, int body)
{
    return body_at(v, q, q->clock, free_bodies_now(q), body);
}

#if SCENE_ANY_TURNING
/* w as the destination's frame sees it, which may turn. */
static struct vec3 rate_in_destination(const struct scene_values *v, const struct scene_instant *at,
                                       int contact)
{
#if SCENE_ANY_ROTATION
    const int destination = contact_destination(contact);
    if (body_turns(v, destination)) {
        return vec3_sub(at->rate[contact],
                        vec3_cross(at->turning.body[destination].angular_velocity, at->separation[contact]));
    }
#else
    (void)v;
#endif
    return at->rate[contact];
}
#endif

static void put_kinematics(const struct scene_values *v, const struct scene_state *q, double clock,
                           const struct body_state *bodies, struct scene_instant *at)
{
    struct vec3 origin[SCENE_BODIES];
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct body_instant body = body_at(v, q, clock, bodies, i);
        origin[i] = body.origin;
        at->moved[i] = body.moved;
        at->displacement[i] = body.displacement;
        at->velocity[i] = body.velocity;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int source = contact_source(j);
        const int destination = contact_destination(j);
        /* The undeformed locations are subtracted first, then the displacements at clock 0, then the
         * displacements since: large common parts cancel before small ones are added. */
        const struct vec3 apart = vec3_sub(body_center(v, destination), body_center(v, source));
        const struct vec3 start = vec3_add(apart, vec3_sub(origin[destination], origin[source]));
        const struct vec3 c = vec3_add(start, vec3_sub(at->moved[destination], at->moved[source]));
        at->rate[j] = vec3_sub(at->velocity[destination], at->velocity[source]);
        at->separation[j] = c;
    }
}

CONTACT_FLATTEN void scene_kinematics(const struct scene_values *v, const struct scene_state *q, double clock,
                                      const struct body_state *bodies, struct scene_instant *at)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        scene_kinematics_turning(v, q, clock, bodies, &q->turning, at);
        return;
    }
#endif
    put_kinematics(v, q, clock, bodies, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_shape shape = scene_contact_shape(v, q, j);
        at->geometry[j] = contact_geometry_at(&shape, at->separation[j], at->rate[j], q->contact[j].normal);
    }
}

#if SCENE_ANY_TURNING
CONTACT_NOINLINE void scene_kinematics_turning(const struct scene_values *v, const struct scene_state *q,
                                               double clock, const struct body_state *bodies,
                                               const struct turning_state *turning, struct scene_instant *at)
{
    put_kinematics(v, q, clock, bodies, at);
    turning_of_bodies(v, q, clock, turning, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_shape shape = scene_contact_shape_at(v, q, at, j);
        at->geometry[j] = contact_geometry_at(&shape, at->separation[j], rate_in_destination(v, at, j),
                                              q->contact[j].normal);
    }
}
#endif

/* Gravity and the external force; contacts are added by scene_evaluate. */
static struct vec3 free_acceleration(const struct scene_values *v, const struct scene_state *q, double clock,
                                     int body)
{
    const struct vec3 force = path_at(q->path[body].force, 3, clock);
    return vec3_axpy(gravity(v), 1.0 / body_mass(v, body), force);
}

/* d/dt of a prescribed velocity. */
static struct vec3 path_rate(const struct scene_state *q, double clock, int body)
{
    return vec3_axpy(q->path[body].velocity[1], 2.0 * clock, q->path[body].velocity[2]);
}

struct turning_state; /* of scenes in which something may turn or rub */

/* `turning`: NULL where nothing turns or rubs. */
static inline void put_forces(const struct scene_values *v, const struct scene_state *q, double clock,
                              const struct turning_state *turning, struct scene_instant *at)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        at->acceleration[i] = body_is_free(v, i)         ? free_acceleration(v, q, clock, i)
                              : body_is_prescribed(v, i) ? path_rate(q, clock, i)
                                                         : vec3_make(0.0, 0.0, 0.0);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_geometry *g = &at->geometry[j];
        const enum contact_regime regime = (enum contact_regime)q->contact[j].regime;
        at->normal_force[j] = 0.0;
        if (regime != REGIME_APART) {
            const struct contact_law law = scene_contact_law(v, q, j);
            at->normal_force[j] = contact_force(&law, regime, g->gap, g->gap_rate);
        }
        at->source_force[j] = vec3_scale(-scene_contact_side(v, q, j) * at->normal_force[j], g->normal);
#if SCENE_ANY_TURNING
        if (turning) {
            turning_of_contact(v, q, turning, j, at);
        }
#else
        (void)turning;
#endif
        const int source = contact_source(j);
        const int destination = contact_destination(j);
        if (body_is_free(v, source)) {
            at->acceleration[source] =
                vec3_axpy(at->acceleration[source], 1.0 / body_mass(v, source), at->source_force[j]);
        }
        if (body_is_free(v, destination)) {
            at->acceleration[destination] = vec3_axpy(at->acceleration[destination],
                                                      -1.0 / body_mass(v, destination), at->source_force[j]);
        }
    }
}

#if SCENE_ANY_TURNING
/* Apart from where nothing turns or rubs, which stays small. */
CONTACT_NOINLINE static void put_forces_turning(const struct scene_values *v, const struct scene_state *q,
                                                double clock, const struct turning_state *turning,
                                                struct scene_instant *at)
{
    put_forces(v, q, clock, turning, at);
}
#endif

CONTACT_FLATTEN void scene_forces(const struct scene_values *v, const struct scene_state *q, double clock,
                                  struct scene_instant *at)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        put_forces_turning(v, q, clock, &q->turning, at);
        return;
    }
#endif
    put_forces(v, q, clock, NULL, at);
}

#if SCENE_ANY_TURNING
void scene_evaluate_turning(const struct scene_values *v, const struct scene_state *q, double clock,
                            const struct body_state *bodies, const struct turning_state *turning,
                            struct scene_instant *at)
{
    scene_kinematics_turning(v, q, clock, bodies, turning, at);
    put_forces_turning(v, q, clock, turning, at);
}
#endif

void scene_evaluate(const struct scene_values *v, const struct scene_state *q, double clock,
                    const struct body_state *bodies, struct scene_instant *at)
{
    scene_kinematics(v, q, clock, bodies, at);
    scene_forces(v, q, clock, at);
}

double body_inverse_mass(const struct scene_values *v, int body)
{
    return body_is_free(v, body) ? 1.0 / body_mass(v, body) : 0.0;
}

double scene_inverse_mass(const struct scene_values *v, int contact)
{
    return body_inverse_mass(v, contact_source(contact)) + body_inverse_mass(v, contact_destination(contact));
}

double scene_pressing_acceleration(const struct scene_values *v, const struct scene_state *q,
                                   const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_shape_met(v, q, at, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct vec3 relative =
        vec3_sub(at->acceleration[contact_destination(contact)], at->acceleration[contact_source(contact)]);
    const struct vec3 w = at->rate[contact];
    const double turning =
        contact_turns(&shape, g) ? contact_turning_rate(&shape, g, w, w) / g->distance : 0.0;
    const double parts = shape.side * (vec3_dot(g->normal, relative) + turning);
    return fmax(scene_inverse_mass(v, contact) * at->normal_force[contact] - parts, 0.0);
}

struct vec3 scene_torque_of_force(const struct scene_instant *at, int contact)
{
    return body_shape(contact_destination(contact)) == SHAPE_SPHERE
               ? vec3_make(0.0, 0.0, 0.0)
               : vec3_cross(at->separation[contact], at->source_force[contact]);
}

double scene_driving_power(const struct scene_values *v, const struct scene_instant *at, int contact)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    double power = 0.0;
    if (body_is_prescribed(v, source)) {
        power -= vec3_dot(at->source_force[contact], at->velocity[source]);
    }
    if (body_is_prescribed(v, destination)) {
        power += vec3_dot(at->source_force[contact], at->velocity[destination]);
    }
#if SCENE_ANY_ROTATION
    if (body_turn_is_prescribed(v, source)) {
        power -= vec3_dot(at->turning.source_torque[contact], at->turning.body[source].angular_velocity);
    }
    if (body_turn_is_prescribed(v, destination)) {
        power -=
            vec3_dot(at->turning.destination_torque[contact], at->turning.body[destination].angular_velocity);
    }
#endif
    return power;
}

double scene_external_power(const struct scene_values *v, const struct scene_state *q, double clock,
                            const struct scene_instant *at)
{
    double power = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            power += vec3_dot(path_at(q->path[i].force, 3, clock), at->velocity[i]);
        }
#if SCENE_ANY_FREE_ROTATION
        if (body_turns_freely(v, i)) {
            power += vec3_dot(path_at(q->path[i].torque, 3, clock), at->turning.body[i].angular_velocity);
        }
#endif
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        power += scene_driving_power(v, at, j);
    }
    return power;
}
