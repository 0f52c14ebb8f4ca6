#include <string.h>

#include "flight/flight.h"
#include "scene/evaluate.h"
#include "scene/transition.h"

static struct rotor rotor_of(const struct scene_state *q, int body)
{
    const struct vec3 inertia = body_inertia_of(q->v, body);
    return rotor_from(q->turn_origin[body], inertia.x, inertia.z);
}

/* Sets the external torque as a polynomial of the time since the present. */
static void torque_from_now(const struct scene_state *q, int body, struct vec3 torque[ROTOR_TORQUES])
{
    memcpy(torque, q->path[body].torque, sizeof q->path[body].torque);
    path_shift(torque, ROTOR_TORQUES, q->clock);
    for (int i = 0; i < ROTOR_TORQUES; ++i) {
        torque[i] = body_part_that_turns(q->v, body, torque[i]);
    }
}

void flight_turn(struct scene_state *q, int body, double clock)
{
    struct body_turn *turn = &q->turning.body[body];
    const bool by_itself = path_rests(q->path[body].torque);
    if (!body_is_compound(body) && by_itself) {
        const struct rotor rotor = rotor_of(q, body);
        *turn = rotor_at(&rotor, clock);
        return;
    }
    struct vec3 torque[ROTOR_TORQUES];
    torque_from_now(q, body, torque);
    const double before = body_rotational_energy(q->v, body, turn);
    *turn = rotor_of_three_after(turn, body_inertia_of(q->v, body), torque, clock - q->clock);
    q->external_work += by_itself ? 0.0 : body_rotational_energy(q->v, body, turn) - before;
}

struct axis_motion flight_axis_motion(const struct scene_state *q, const struct body_turn *at, int body,
                                      struct vec3 direction)
{
    const bool is_compound = body_is_compound(body);
    if (!is_compound && path_rests(q->path[body].torque)) {
        const struct rotor rotor = rotor_of(q, body);
        struct axis_motion motion = axis_motion_of_rotor(&rotor);
        motion.from = -q->clock; /* the rotor's time is the clock */
        return motion;
    }
    struct vec3 torque[ROTOR_TORQUES];
    torque_from_now(q, body, torque);
    const struct vec3 inertia = body_inertia_of(q->v, body);
    if (is_compound) {
        const struct quaternion to_body = quaternion_inverse(at->orientation);
        return axis_motion_tumbling(quaternion_rotate(to_body, direction), at, inertia, torque);
    }
    /* the axis turns with L / I_1, as that of a body with three moments I_1 does */
    const struct body_turn whole = {quaternion_identity(), body_spin_of(q->v, body, at)};
    return axis_motion_tumbling(direction, &whole, vec3_make(inertia.x, inertia.x, inertia.x), torque);
}

/* Least discriminant as a fraction of the sum of its two terms' sizes. Below it the parabola may just touch
 * zero, and its root would have less than half of its digits. */
static const double LEAST_DISCRIMINANT = 1e-8;

/* This is the least distance from the centre as a fraction of the reach. Nearer to the centre the gap does
 * not show on which side of the centre the source is. */
static const double CLEAR_OF_CENTRE = 1e-9;

struct vec3 flight_part_that_counts(const struct contact_shape *shape, struct vec3 normal, struct vec3 a)
{
    return contact_is_plane(shape) ? vec3_scale(contact_along_plane(normal, a), normal)
                                   : contact_across(shape, a);
}

bool flight_is_head_on(const struct contact_shape *shape, const struct separation_path *separation,
                       struct vec3 normal)
{
    for (int i = 1; i <= separation->degree; ++i) {
        const struct vec3 moved = flight_part_that_counts(shape, normal, separation->c[i]);
        const struct vec3 mismatch = vec3_axpy(separation->w[i - 1], -i, separation->c[i]);
        const bool is_along = contact_is_plane(shape) || vec3_is_zero(vec3_cross(normal, moved));
        if (!is_along || (i > 2 && !vec3_is_zero(moved)) ||
            !(vec3_is_zero(mismatch) || vec3_is_zero(flight_part_that_counts(shape, normal, mismatch)))) {
            return false;
        }
    }
    return true;
}

/* This struct is the function value + rate t + bend t^2 of the time t [s]. */
struct parabola {
    double value, rate, bend;
};

/* Sets the time at which a parabola first falls through zero, INFINITY if it never does, by the root formula
 * without cancellation and one step of Newton's method. Returns false where rounding decides. */
static bool first_fall(const struct parabola *p, double rounding, double *t)
{
    const double product = 4.0 * p->bend * p->value;
    const double discriminant = p->rate * p->rate - product;
    const double size = p->rate * p->rate + fabs(product);
    /* above zero beyond rounding, or rising by more than rounding before it returns */
    const bool is_clear = p->value > rounding ||
                          (p->value >= 0.0 && p->rate > 0.0 && p->rate * p->rate > -4.0 * p->bend * rounding);
    if (!is_clear || !(fabs(discriminant) > LEAST_DISCRIMINANT * size) || !isfinite(size)) {
        return false;
    }
    const double root = sqrt(fmax(discriminant, 0.0));
    *t = p->rate < 0.0 ? 2.0 * p->value / (root - p->rate) : -0.5 * (root + p->rate) / p->bend;
    *t = discriminant > 0.0 && *t > 0.0 && isfinite(*t)
             ? *t - (p->value + *t * (p->rate + *t * p->bend)) / (p->rate + 2.0 * *t * p->bend)
             : (double)INFINITY;
    return true;
}

bool flight_head_on_touch(const struct contact_shape *shape, const struct separation_path *separation,
                          const struct contact_geometry *now, double rounding, double horizon, double *touch)
{
    const struct parabola gap = {now->gap, shape->side * vec3_dot(now->normal, separation->c[1]),
                                 shape->side * vec3_dot(now->normal, separation->c[2])};
    /* bodies that approach touch however small the gap is; rounding affects only the time */
    const double unclear = gap.value > 0.0 && gap.rate < 0.0 ? 0.0 : rounding;
    if (now->degenerate || !first_fall(&gap, unclear, touch)) {
        return false;
    }
    const double end = fmin(*touch, horizon);
    *touch = *touch <= horizon ? *touch : (double)INFINITY;
    if (shape->side > 0) {
        return true;
    }
    const double top = -0.5 * gap.rate / gap.bend;
    const double largest = gap.bend < 0.0 && top > 0.0 && top < end
                               ? gap.value + 0.5 * top * gap.rate
                               : fmax(gap.value, gap.value + end * (gap.rate + end * gap.bend));
    return largest < (1.0 - CLEAR_OF_CENTRE) * contact_reach(shape);
}

bool flight_is_free(const struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j)) {
            return false;
        }
    }
    return true;
}

bool flight_is_steady(const struct scene_state *q, int body)
{
    return body_is_free(q->v, body) ? path_is_steady(q->path[body].force, 3)
                                    : !body_is_prescribed(q->v, body);
}

struct free_flight free_flight_of(const struct scene_state *q, int body, double clock, struct vec3 velocity)
{
    const double inverse_mass = 1.0 / body_mass(q->v, body);
    struct free_flight f;
    f.terms = path_is_steady(q->path[body].force, 3) ? 2 : FLIGHT_TERMS;
    memcpy(f.force, q->path[body].force, sizeof f.force);
    if (f.terms > 2) {
        path_shift(f.force, 3, clock);
        f.velocity[2] = vec3_scale(inverse_mass / 2.0, f.force[1]);
        f.velocity[3] = vec3_scale(inverse_mass / 3.0, f.force[2]);
    }
    f.velocity[0] = velocity;
    f.velocity[1] = vec3_axpy(gravity(q->v), inverse_mass, f.force[0]);
    return f;
}

struct vec3 flight_displacement(const struct vec3 *velocity, int terms, double time)
{
    struct vec3 mean = {0.0, 0.0, 0.0};
    for (int i = terms - 1; i >= 0; --i) {
        mean = vec3_axpy(vec3_scale(FLIGHT_MEAN[i], velocity[i]), time, mean);
    }
    return vec3_scale(time, mean);
}

/* Force times velocity has degree five, for which three Gauss-Legendre nodes, 0 and +-sqrt(3/5), are
 * exact. */
double flight_work_along(const struct free_flight *f, double time)
{
    const double node = 0.77459666924148338;
    const double nodes[3] = {-node, 0.0, node};
    const double weights[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double at = 0.5 * time * (1.0 + nodes[i]);
        sum += weights[i] * vec3_dot(path_at(f->force, 3, at), path_at(f->velocity, f->terms, at));
    }
    return 0.5 * time * sum;
}

double flight_work(const struct scene_state *q, int body, struct vec3 velocity, double clock, double time)
{
    if (path_rests(q->path[body].force)) {
        return 0.0;
    }
    const struct free_flight f = free_flight_of(q, body, clock, velocity);
    return flight_work_along(&f, time);
}

void flight_deviate(struct scene_state *q, int body, double time, struct vec3 moved, struct vec3 velocity)
{
    struct body_state *state = &q->body[body];
    const struct free_flight f = free_flight_of(q, body, q->clock, state->velocity);
    q->external_work += path_rests(f.force) ? 0.0 : flight_work_along(&f, time);
    const struct vec3 flown = flight_displacement(f.velocity, f.terms, time);
    state->moved = vec3_add(vec3_add(state->moved, flown), moved);
    state->velocity = vec3_add(path_at(f.velocity, f.terms, time), velocity);
}

struct body_state flight_body_at(const struct scene_state *q, int body, double clock)
{
    const struct free_flight f = free_flight_of(q, body, 0.0, q->origin[body].velocity);
    return (struct body_state){flight_displacement(f.velocity, f.terms, clock),
                               path_at(f.velocity, f.terms, clock)};
}

double flight_stored_energy(const struct scene_state *q, bool all)
{
    struct scene_instant at;
    double sum = 0.0;
    for (int j = 0, known = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime == REGIME_SEPARATING && (all || !contact_is_prescribed(q->v, j))) {
            if (!known) {
                scene_kinematics_now(q, &at);
                known = 1;
            }
            const struct contact_law law = scene_contact_law(q, j);
            sum += contact_stored_energy(&law, REGIME_SEPARATING, at.geometry[j].gap);
        }
    }
    return sum;
}

void flight_advance(struct scene_state *q, double clock)
{
    const double stored = flight_stored_energy(q, true);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(q->v, i)) {
            q->external_work += flight_work(q, i, q->body[i].velocity, q->clock, clock - q->clock);
            q->body[i] = flight_body_at(q, i, clock);
        }
    }
    for (int i = 0; SCENE_ANY_ROTATION && i < SCENE_BODIES; ++i) {
        if (body_turns_freely(q->v, i)) {
            flight_turn(q, i, clock);
        }
    }
    q->clock = clock;
    q->dissipated += stored - flight_stored_energy(q, true);
}

bool flight_stays_finite(const struct scene_state *q, double clock)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const double speed = vec3_max_abs(q->origin[i].velocity) + vec3_max_abs(gravity(q->v)) * clock;
        const bool turns_by_itself =
            !body_turns_freely(q->v, i) || (path_rests(q->path[i].torque) && !body_is_compound(i));
        if (body_moves_freely(q->v, i) &&
            !(path_rests(q->path[i].force) && turns_by_itself && speed < 1e70 && speed * clock < 1e70)) {
            return false;
        }
    }
    return true;
}

double flight_deferrable_until(const struct scene_state *q)
{
    double clock = q->horizon_clock;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_state *state = &q->contact[j];
        clock = fmin(clock, state->schedule.change_clock);
        if (state->regime != REGIME_APART || state->schedule.passes_centre) {
            return 0.0;
        }
    }
    return flight_stays_finite(q, clock) ? clock : 0.0;
}

bool flight_end_means(struct scene_state *q, double end_time)
{
    const double remaining = scene_remaining(q, end_time);
    if (!(remaining > 0.0 && q->clock + remaining < -q->deferrable_clock)) {
        return false;
    }
    transition_mark_step(q);
    q->deferrable_clock = -q->deferrable_clock;
    return true;
}

bool flight_defer(struct scene_state *q, double end_time)
{
    const double remaining = scene_remaining(q, end_time);
    const double clock = q->clock + remaining;
    if (!(remaining > 0.0 && clock < q->deferrable_clock)) {
        return false;
    }
    q->deferred_from = q->clock;
    q->clock = clock;
    q->deferred = 1;
    return true;
}

void flight_catch_up(struct scene_state *q)
{
    if (!q->deferred) {
        return;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(q->v, i)) {
            q->body[i] = flight_unforced_at(q, i, q->clock);
        }
        if (SCENE_ANY_ROTATION && body_turns_freely(q->v, i)) {
            flight_turn(q, i, q->clock);
        }
    }
    q->deferred = 0;
}

/* Restores the axial motion of a body that only the cylinder of this contact loads. */
static void restore_axial(struct scene_state *q, int contact, int body)
{
    if (body_is_free(q->v, body) && !body_is_loaded(q, body, contact)) {
        const struct vec3 axis = q->contact[contact].parameters.axis;
        const struct body_state exact = flight_body_at(q, body, q->clock);
        struct body_state *now = &q->body[body];
        now->moved = vec3_axpy(now->moved, vec3_dot(vec3_sub(exact.moved, now->moved), axis), axis);
        now->velocity =
            vec3_axpy(now->velocity, vec3_dot(vec3_sub(exact.velocity, now->velocity), axis), axis);
    }
}

void flight_restore(struct scene_state *q)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        if (body_is_free(q->v, i) && !body_is_loaded(q, i, -1)) {
            q->body[i] = flight_body_at(q, i, q->clock);
        }
    }
    if (SCENE_ANY_CYLINDER) {
        /* not in scenes that turn: friction acts along the axis, and a turning axis conserves no component */
        for (int j = 0; !scene_turns(q->v) && j < SCENE_CONTACTS; ++j) {
            if (scene_ends_suddenly(q->v, j) && contact_transmits(q, j)) {
                restore_axial(q, j, contact_source(j));
                restore_axial(q, j, contact_destination(j));
            }
        }
    }
}
