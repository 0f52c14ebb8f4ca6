#include "segment/contact_pair.h"

#include <float.h>
#include <string.h>

#include "scene/present.h"
#include "scene/rounding.h"
#include "scene/singularity.h"
#include "segment/flight.h"
#include "segment/flight_head_on.h"

static struct pair_work work_on(const struct contact_pair *p, const struct scene_values *v,
                                const struct scene_state *q, int body, double sign)
{
    struct pair_work work = {.order = 0};
    const struct body_path *path = &q->path[body];
    if (body_is_free(v, body)) {
        memcpy(work.path, path->force, sizeof work.path);
        work.factor = sign * p->reduced_mass / body_mass(v, body);
        work.order = 1;
    } else if (body_is_prescribed(v, body)) {
        memcpy(work.path, path->velocity, sizeof work.path);
        work.factor = -sign * p->reduced_mass;
        work.order = 2;
    } else {
        return work;
    }
    path_shift(work.path, 3, q->clock);
    return work;
}

/* Across a plane's normal no work is done, whatever the path. */
static bool is_constant(const struct contact_pair *p, const struct pair_work *work)
{
    if (contact_is_plane(&p->shape)) {
        return work->order == 0 || (contact_along_plane(p->normal, work->path[1]) == 0.0 &&
                                    contact_along_plane(p->normal, work->path[2]) == 0.0);
    }
    return work->order == 0 || (vec3_is_zero(work->path[1]) && vec3_is_zero(work->path[2]));
}

bool pair_is_head_on(const struct contact_pair *p)
{
    return is_constant(p, &p->work[0]) && is_constant(p, &p->work[1]) &&
           flight_is_head_on(&p->shape, &p->flight, p->normal);
}

/*
 * At d = 0, n is undefined. It becomes the direction of motion, and c, which is rounding there, is set along
 * it. At rest it keeps the direction at hand, unless the relative acceleration outweighs the contact force
 * along it: then it takes that of the relative acceleration.
 */
static void leave_centre(struct contact_pair *p, const struct contact_geometry *geometry)
{
    const double reach = contact_reach(&p->shape);
    struct vec3 acceleration = pair_across(p, vec3_scale(2.0, p->flight.c[2]));
    if (!(p->coefficients.k * reach / p->reduced_mass + vec3_dot(p->normal, acceleration) < 0.0)) {
        acceleration = vec3_make(0.0, 0.0, 0.0);
    }
    p->normal = singularity_escape(&p->shape, p->flight.c[1], acceleration, p->normal);
    p->distance = fmax(reach + p->gap, 2.0 * DBL_EPSILON * reach);
    p->gap = p->distance - reach;
    p->rounded = vec3_axpy(vec3_scale(p->distance, p->normal), -1.0, geometry->offset);
    p->flight.c[0] = p->flight.offset = vec3_scale(p->distance, p->normal);
    p->starts_rounded = true;
}

/* Corrects w so that side n.w is `rate`, the g' carried from the segment before. */
static void take_carried_rate(struct contact_pair *p, double rate)
{
    const double missing = p->shape.side * rate - vec3_dot(p->normal, pair_across(p, p->flight.w[0]));
    p->carried_rate = rate;
    p->rate_rounded = vec3_scale(missing, p->normal);
    p->flight.c[1] = vec3_add(p->flight.c[1], p->rate_rounded);
    p->flight.w[0] = vec3_add(p->flight.w[0], p->rate_rounded);
}

/* Whether a prescribed displacement has a derivative other than the prescribed velocity, by more than
 * rounding. */
static bool path_contradicts(const struct scene_values *v, const struct scene_state *q, int body)
{
    if (!body_is_prescribed(v, body)) {
        return false;
    }
    struct body_path path = q->path[body];
    path_shift(path.displacement, 4, q->clock);
    path_shift(path.velocity, 3, q->clock);
    for (int i = 0; i < 3; ++i) {
        const struct vec3 rate = vec3_scale(i + 1, path.displacement[i + 1]);
        const double size = vec3_max_abs(rate) + vec3_max_abs(path.velocity[i]);
        if (vec3_max_abs(vec3_sub(path.velocity[i], rate)) > 16.0 * DBL_EPSILON * size) {
            return true;
        }
    }
    return false;
}

static void take_law(struct contact_pair *p, const struct contact_law *law, enum contact_regime regime,
                     const struct contact_geometry *geometry)
{
    p->law = *law;
    p->coefficients = contact_coefficients_of(law, regime);
    p->chi = p->hertz_stiffness = 0.0;
    if (contact_is_hertz(law)) {
        const struct contact_slopes slopes =
            contact_force_slopes(law, regime, geometry->gap, geometry->gap_rate);
        p->coefficients = (struct contact_coefficients){-slopes.by_gap, -slopes.by_rate};
        p->hertz_stiffness = contact_factors_of(law).k;
        p->chi = regime == REGIME_COMPRESSION ? contact_factors_of(law).c : 0.0;
    }
}

void pair_make(struct contact_pair *p, const struct scene_values *v, const struct scene_state *q,
               const struct scene_instant *at, int contact)
{
    const struct contact_geometry *geometry = &at->geometry[contact];
    p->shape = scene_contact_shape(v, q, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    take_law(p, &law, (enum contact_regime)q->contact[contact].regime, geometry);
    p->flight = separation_path_of(v, q, at, q->clock, contact);
    p->normal = geometry->normal;
    p->axial = geometry->axial;
    p->distance = geometry->distance;
    p->gap = geometry->gap;
    const double shorter = p->shape.side * p->gap - (geometry->distance - contact_reach(&p->shape));
    p->rounded = vec3_scale(shorter, p->normal);
    p->rate_rounding = rounding_of_rate(at, contact);
    p->reduced_mass = 1.0 / scene_inverse_mass(v, contact);
    p->rate_rounded = vec3_make(0.0, 0.0, 0.0);
    p->carried_rate = (double)NAN;
    p->rate_is_known = p->starts_rounded = false;
    if (singularity_is_reached(v, at, contact, &p->shape)) {
        leave_centre(p, geometry);
    } else {
        const bool is_carried = scene_rate_is_known(q, at, contact);
        const double rate = is_carried ? geometry->gap_rate
                                       : p->shape.side * vec3_dot(p->normal, pair_across(p, p->flight.w[0]));
        p->rate_is_known = is_carried || rate == 0.0;
        if (p->rate_is_known || p->coefficients.k >= PAIR_STIFF) { /* all formulas are to see the same rate */
            take_carried_rate(p, rate);
        }
    }
    p->has_mismatch = path_contradicts(v, q, contact_source(contact)) ||
                      path_contradicts(v, q, contact_destination(contact));
    p->work[0] = work_on(p, v, q, contact_source(contact), -1.0);
    p->work[1] = work_on(p, v, q, contact_destination(contact), 1.0);
    p->is_head_on = pair_is_head_on(p);
}

struct vec3 pair_across(const struct contact_pair *p, struct vec3 c)
{
    return contact_across(&p->shape, c);
}

struct vec3 pair_tangential(const struct contact_pair *p, struct vec3 across)
{
    if (contact_is_plane(&p->shape)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    return vec3_axpy(across, -vec3_dot(p->normal, across), p->normal);
}

double pair_gap_derivative(const struct contact_pair *p)
{
    if (isnan(p->carried_rate)) {
        return p->shape.side * vec3_dot(p->normal, pair_across(p, p->flight.c[1]));
    }
    if (!p->has_mismatch) {
        return p->carried_rate;
    }
    const struct vec3 mismatch = vec3_sub(p->flight.w[0], p->flight.c[1]);
    return p->carried_rate - p->shape.side * vec3_dot(p->normal, pair_across(p, mismatch));
}

double pair_turning(const struct contact_pair *p, double distance)
{
#if SCENE_ANY_CAPS
    if (contact_is_rim(&p->shape)) {
        const struct contact_geometry at =
            contact_geometry_at(&p->shape, p->flight.c[0], p->flight.c[1], p->normal);
        return contact_turning_rate(&p->shape, &at, p->flight.c[1], p->flight.c[1]) / distance;
    }
#endif
    const struct vec3 across = pair_tangential(p, pair_across(p, p->flight.c[1]));
    return vec3_dot(across, across) / distance;
}

#if SCENE_ANY_CAPS
struct rim_start pair_rim_start(const struct contact_pair *p)
{
    const struct contact_solid *solid = &p->shape.solid;
    return rim_start_of(p->shape.axis, solid->radius, solid->half_height, p->flight.c[0],
                        contact_reach(&p->shape) + p->gap, p->flight.c[1]);
}
#endif

double pair_load(const struct contact_pair *p)
{
    const double distance = fmax(p->distance, 0.5 * contact_reach(&p->shape));
    return p->reduced_mass * fabs(pair_turning(p, distance) + 2.0 * vec3_dot(p->normal, p->flight.c[2]));
}

static double speed_of(const struct scene_values *v, const struct scene_state *q, int body)
{
    if (body_is_prescribed(v, body)) {
        return vec3_norm(path_at(q->path[body].velocity, 3, q->clock));
    }
    return body_is_free(v, body) ? vec3_norm(q->body[body].velocity) : 0.0;
}

/* Error of the force, relative to it, up to which g' is taken from the rounded velocities. */
static const double FORCE_ACCURACY = 1e-6;

double pair_rate_rounding_after(const struct contact_pair *p, const struct pair_change *change,
                                const struct scene_values *v, const struct scene_state *q, int contact)
{
    const double speeds =
        speed_of(v, q, contact_source(contact)) + speed_of(v, q, contact_destination(contact));
    /* In lasting contact flight and deviation nearly cancel: the size of either counts. */
    const double rounding = 16.0 * DBL_EPSILON * (speeds + vec3_norm(change->r_rate));
    const double force_per_rate = sqrt(p->coefficients.k * p->reduced_mass) + p->coefficients.c;
    const double rate = fabs(vec3_dot(p->normal, pair_across(p, p->flight.w[0])));
    if (rounding <= FORCE_ACCURACY * rate) {
        return 0.0; /* an impact: its speed alone tells */
    }
    const double force =
        pair_load(p) + p->coefficients.k * fmax(fabs(p->gap), fabs(change->gap)) + force_per_rate * rate;
    const bool counts = force_per_rate * rounding > FORCE_ACCURACY * force;
    return counts || p->coefficients.k >= PAIR_STIFF ? rounding : 0.0;
}

static inline void move_body(const struct scene_values *v, struct scene_state *q, int body, double time,
                             struct vec3 r, struct vec3 r_rate)
{
    struct vec3 force[3];
    flight_force(q, body, q->clock, force);
    if (!vec3_is_zero(force[0]) || !vec3_is_zero(force[1]) || !vec3_is_zero(force[2])) {
        q->external_work += flight_work(v, body, q->body[body], force, time);
    }
    const struct body_state flown = flight_from(v, body, q->body[body], force, time);
    q->body[body].moved = vec3_add(flown.moved, r);
    q->body[body].velocity = vec3_add(flown.velocity, r_rate);
}

/* The part of a vector that head-on motion leaves alone: in a plane, along a cylinder's axis; a sphere has
 * none. */
static struct vec3 aside(const struct contact_pair *p, struct vec3 a)
{
    if (contact_is_plane(&p->shape)) {
        return contact_across_plane(p->normal, a);
    }
    return contact_is_cylinder(&p->shape) ? vec3_scale(vec3_dot(p->shape.axis, a), p->shape.axis)
                                          : vec3_make(0.0, 0.0, 0.0);
}

static struct vec3 not_aside(const struct contact_pair *p, struct vec3 a)
{
    return contact_is_plane(&p->shape) ? vec3_scale(vec3_dot(p->normal, a), p->normal) : pair_across(p, a);
}

/* The motion that both bodies share, but for what is aside: that of the one that is not free, or that of
 * their centre of mass. velocity[i] is the coefficient of time^i. */
struct common_motion {
    struct vec3 velocity[2];
};

static struct common_motion common_motion_of(const struct contact_pair *p, const struct scene_values *v,
                                             const struct scene_state *q, const int ends[PAIR_BODIES])
{
    struct common_motion common = {{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
    double inverse_mass = 0.0; /* of both together */
    for (int end = 0; end < PAIR_BODIES; ++end) {
        if (body_is_prescribed(v, ends[end])) {
            struct vec3 velocity[3];
            memcpy(velocity, q->path[ends[end]].velocity, sizeof velocity);
            path_shift(velocity, 3, q->clock);
            memcpy(common.velocity, velocity, sizeof common.velocity);
        }
    }
    if (body_is_free(v, ends[0]) && body_is_free(v, ends[1])) {
        inverse_mass = 1.0 / (body_mass(v, ends[0]) + body_mass(v, ends[1]));
        common.velocity[1] = gravity(v);
    }
    for (int end = 0; inverse_mass > 0.0 && end < PAIR_BODIES; ++end) {
        struct vec3 force[3];
        flight_force(q, ends[end], q->clock, force);
        const double part = body_mass(v, ends[end]) * inverse_mass;
        common.velocity[0] = vec3_axpy(common.velocity[0], part, q->body[ends[end]].velocity);
        common.velocity[1] = vec3_axpy(common.velocity[1], inverse_mass, force[0]);
    }
    common.velocity[0] = not_aside(p, common.velocity[0]);
    common.velocity[1] = not_aside(p, common.velocity[1]);
    return common;
}

/*
 * Moves a body head-on: as the common motion, its flight aside and its share of the separation. Bodies that
 * rest against each other for long would lose the digits of their places in a difference of two flights.
 */
static void move_head_on(const struct contact_pair *p, const struct pair_change *change,
                         const struct scene_values *v, struct scene_state *q, int body, double share,
                         const struct common_motion *common)
{
    struct vec3 force[3];
    struct vec3 velocity[FLIGHT_TERMS];
    struct body_state *state = &q->body[body];
    const double side = p->shape.side;
    flight_force(q, body, q->clock, force);
    const int terms = flight_velocity(v, body, state->velocity, force, velocity);
    for (int i = 0; i < terms; ++i) {
        velocity[i] = aside(p, velocity[i]);
    }
    const struct vec3 apart = vec3_axpy(p->rounded, side * (change->gap - p->gap), p->normal);
    const struct vec3 moved = vec3_axpy(flight_displacement(common->velocity, 2, change->time), share, apart);
    if (!vec3_is_zero(force[0]) || !vec3_is_zero(force[1]) || !vec3_is_zero(force[2])) {
        q->external_work +=
            flight_work_along(velocity, terms, force, change->time) + vec3_dot(force[0], moved);
    }
    const struct vec3 flown = aside(p, flight_displacement(velocity, terms, change->time));
    const struct vec3 together = path_at(common->velocity, 2, change->time);
    state->moved = vec3_add(state->moved, vec3_add(flown, moved));
    state->velocity = vec3_add(aside(p, path_at(velocity, terms, change->time)),
                               vec3_axpy(together, share * side * change->gap_rate, p->normal));
}

void pair_apply(const struct contact_pair *p, const struct pair_change *change, const struct scene_values *v,
                struct scene_state *q, int contact)
{
    struct contact_state *state = &q->contact[contact];
    const int ends[PAIR_BODIES] = {contact_source(contact), contact_destination(contact)};
    const struct vec3 rounded = vec3_axpy(p->rounded, change->time, p->rate_rounded);
    const struct vec3 r = vec3_add(change->r, rounded);
    const struct vec3 r_rate = vec3_add(change->r_rate, p->rate_rounded);
    struct common_motion common = {{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
    if (change->head_on) {
        common = common_motion_of(p, v, q, ends);
    }
    for (int end = 0; end < PAIR_BODIES; ++end) {
        if (!body_is_free(v, ends[end])) {
            q->external_work += p->work[end].factor * change->work[end];
            continue;
        }
        const double share = (end == 0 ? -1.0 : 1.0) * p->reduced_mass / body_mass(v, ends[end]);
        if (change->head_on) {
            move_head_on(p, change, v, q, ends[end], share, &common);
        } else {
            q->external_work += p->work[end].factor * change->work[end];
            move_body(v, q, ends[end], change->time, vec3_scale(share, r), vec3_scale(share, r_rate));
        }
    }
    q->dissipated += change->dissipated;
    state->physics.impulse = vec3_axpy(state->physics.impulse, -p->reduced_mass, change->r_rate);
    state->physics.accumulated_gap = change->gap;
}
