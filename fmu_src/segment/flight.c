#include "segment/flight.h"

#include <string.h>

#include "scene/energy.h"
#include "scene/present.h"
#include "segment/flight_turning.h"

bool flight_is_free(const struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j)) {
            return false;
        }
    }
    return true;
}

void flight_force(const struct scene_state *q, int body, double clock, struct vec3 force[3])
{
    memcpy(force, q->path[body].force, sizeof q->path[body].force);
    if (!path_is_steady(force, 3)) {
        path_shift(force, 3, clock);
    }
}

int flight_velocity(const struct scene_values *v, int body, struct vec3 start, const struct vec3 force[3],
                    struct vec3 velocity[FLIGHT_TERMS])
{
    const double inverse_mass = 1.0 / body_mass(v, body);
    velocity[0] = start;
    velocity[1] = vec3_axpy(gravity(v), inverse_mass, force[0]);
    if (path_is_steady(force, 3)) {
        return 2;
    }
    velocity[2] = vec3_scale(inverse_mass / 2.0, force[1]);
    velocity[3] = vec3_scale(inverse_mass / 3.0, force[2]);
    return FLIGHT_TERMS;
}

struct vec3 flight_displacement(const struct vec3 *velocity, int terms, double time)
{
    struct vec3 mean[FLIGHT_TERMS];
    for (int i = 0; i < terms; ++i) {
        mean[i] = vec3_scale(FLIGHT_MEAN[i], velocity[i]);
    }
    return vec3_scale(time, path_at(mean, terms, time));
}

struct body_state flight_from(const struct scene_values *v, int body, struct body_state start,
                              const struct vec3 force[3], double time)
{
    struct vec3 velocity[FLIGHT_TERMS];
    const int terms = flight_velocity(v, body, start.velocity, force, velocity);
    return (struct body_state){vec3_add(start.moved, flight_displacement(velocity, terms, time)),
                               path_at(velocity, terms, time)};
}

/* Force times velocity has degree five: exact with three Gauss-Legendre nodes, 0 and +-sqrt(3/5). */
double flight_work_along(const struct vec3 *velocity, int terms, const struct vec3 force[3], double time)
{
    const double node = 0.77459666924148338;
    const double nodes[3] = {-node, 0.0, node};
    const double weights[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double at = 0.5 * time * (1.0 + nodes[i]);
        sum += weights[i] * vec3_dot(path_at(force, 3, at), path_at(velocity, terms, at));
    }
    return 0.5 * time * sum;
}

double flight_work(const struct scene_values *v, int body, struct body_state start,
                   const struct vec3 force[3], double time)
{
    struct vec3 velocity[FLIGHT_TERMS];
    const int terms = flight_velocity(v, body, start.velocity, force, velocity);
    return flight_work_along(velocity, terms, force, time);
}

struct body_state flight_body_at(const struct scene_values *v, const struct scene_state *q, int body,
                                 double clock)
{
    const struct body_state start = {.velocity = q->origin[body].velocity};
    return flight_from(v, body, start, q->path[body].force, clock);
}

static bool is_forced(const struct scene_state *q, int body)
{
    const struct vec3 *force = q->path[body].force;
    return !(vec3_is_zero(force[0]) && vec3_is_zero(force[1]) && vec3_is_zero(force[2]));
}

/* From the present to another clock. */
static double work_until(const struct scene_values *v, const struct scene_state *q, int body, double clock)
{
    struct vec3 force[3];
    flight_force(q, body, q->clock, force);
    return flight_work(v, body, q->body[body], force, clock - q->clock);
}

static double stored_now(const struct scene_values *v, const struct scene_state *q)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    return energy_stored(v, q, &at);
}

void flight_advance(const struct scene_values *v, struct scene_state *q, double clock)
{
    const bool apart = scene_is_apart(q);
    const double stored = apart ? 0.0 : stored_now(v, q);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            if (is_forced(q, i)) {
                q->external_work += work_until(v, q, i, clock);
            }
            q->body[i] = flight_body_at(v, q, i, clock);
        }
    }
#if SCENE_ANY_ROTATION
    if (scene_turns(v)) {
        flight_turn_all(v, q, clock);
    }
#endif
    q->clock = clock;
    q->dissipated += apart ? 0.0 : stored - stored_now(v, q);
}

static bool contact_is_deferrable(const struct contact_state *state)
{
    return state->regime == REGIME_APART && !state->schedule.passes_centre &&
           state->peaks.penetration == 0.0 &&
           vec3_is_zero(vec3_sub(state->physics.impulse, state->record.impulse_mark));
}

/* No external force, and speed, displacement and kinetic energy far from the range of numbers. */
static bool body_is_deferrable(const struct scene_values *v, const struct scene_state *q, int body,
                               double clock)
{
    const double speed = vec3_max_abs(q->origin[body].velocity) + vec3_max_abs(gravity(v)) * clock;
    return !is_forced(q, body) && speed < 1e70 && speed * clock < 1e70;
}

double flight_deferrable_until(const struct scene_values *v, const struct scene_state *q)
{
    double clock = q->horizon_clock;
    if (scene_turns(v)) {
        return 0.0;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        clock = fmin(clock, q->contact[j].schedule.change_clock);
        if (!contact_is_deferrable(&q->contact[j])) {
            return 0.0;
        }
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && !body_is_deferrable(v, q, i, clock)) {
            return 0.0;
        }
    }
    return clock;
}

bool flight_defer(struct scene_state *q, double end_time)
{
    const double remaining = scene_remaining(q, end_time);
    const double clock = q->clock + remaining;
    if (!(remaining > 0.0 && clock < q->deferrable_clock)) {
        return false;
    }
    q->clock = clock;
    q->deferred = 1;
    return true;
}

void flight_catch_up(const struct scene_values *v, struct scene_state *q)
{
    if (!q->deferred) {
        return;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            q->body[i] = flight_unforced_at(v, q, i, q->clock);
        }
    }
    q->deferred = 0;
}

#if SCENE_ANY_CYLINDER
static struct vec3 with_axial_of(struct vec3 a, struct vec3 exact, struct vec3 axis)
{
    return vec3_axpy(a, vec3_dot(vec3_sub(exact, a), axis), axis);
}

static void restore_axial(const struct scene_values *v, struct scene_state *q, int contact, int body)
{
    if (body_is_free(v, body) && !body_is_loaded(q, body, contact)) {
        const struct vec3 axis = q->contact[contact].parameters.axis;
        const struct body_state exact = flight_body_at(v, q, body, q->clock);
        q->body[body].moved = with_axial_of(q->body[body].moved, exact.moved, axis);
        q->body[body].velocity = with_axial_of(q->body[body].velocity, exact.velocity, axis);
    }
}
#endif

void flight_restore(const struct scene_values *v, struct scene_state *q)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && !body_is_loaded(q, i, -1)) {
            q->body[i] = flight_body_at(v, q, i, q->clock);
        }
    }
#if SCENE_ANY_CYLINDER
    /* friction acts along the axis, and an axis that turns keeps nothing */
    for (int j = 0; !scene_turns(v) && j < SCENE_CONTACTS; ++j) {
        if (scene_ends_suddenly(v, j) && contact_transmits(q, j)) {
            restore_axial(v, q, j, contact_source(j));
            restore_axial(v, q, j, contact_destination(j));
        }
    }
#endif
}
