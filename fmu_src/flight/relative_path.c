#include <float.h>
#include <math.h>
#include <string.h>

#include "flight/flight.h"
#include "flight/relative_path.h"
#include "math/series.h"

struct separation_path separation_path_of(const struct scene_instant *at, double clock, int contact)
{
    const int ends[2] = {contact_destination(contact), contact_source(contact)};
    struct separation_path path = {.c = {at->separation[contact]}, .degree = 1};
    for (int end = 0; end < 2; ++end) {
        const double sign = end == 0 ? 1.0 : -1.0;
        int terms = 0;
        if (SCENE_ANY_FREE && body_is_free(at->v, ends[end])) {
            const struct free_flight f = free_flight_of(at->q, ends[end], clock, at->velocity[ends[end]]);
            terms = f.terms;
            for (int i = 0; i < terms; ++i) {
                path.w[i] = vec3_axpy(path.w[i], sign, f.velocity[i]);
                path.c[i + 1] = vec3_axpy(path.c[i + 1], sign * FLIGHT_MEAN[i], f.velocity[i]);
            }
        } else if (body_is_prescribed(at->v, ends[end])) {
            struct body_path given = at->q->path[ends[end]];
            body_path_shift(at->v, ends[end], &given, clock);
            terms = 3;
            for (int i = 0; i < terms; ++i) {
                path.w[i] = vec3_axpy(path.w[i], sign, given.velocity[i]);
                path.c[i + 1] = vec3_axpy(path.c[i + 1], sign, given.displacement[i + 1]);
            }
        }
        path.degree = terms > path.degree ? terms : path.degree;
    }
    return path;
}

int separation_path_planes(const struct separation_path *path, double horizon, struct vec3 direction,
                           double half, double *places, int count)
{
    struct polynomial along = {.degree = SEPARATION_DEGREE};
    double power = 1.0;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        along.a[i] = power * vec3_dot(path->c[i], direction);
        power *= horizon;
    }
    for (int end = -1; isfinite(half) && end <= 1; end += 2) {
        struct polynomial plane = along;
        plane.a[0] += end * half;
        count = polynomial_add_sign_changes(&plane, places, count);
    }
    return count;
}

/* Returns how a direction turns that is fixed in a body; `direction` is the unit vector at the present. */
static struct axis_motion motion_with(const struct scene_instant *at, double clock, int body,
                                      struct vec3 direction)
{
    const struct body_turn *turn = &at->turning.body[body];
    struct body_path path = at->q->path[body];
    body_path_shift(at->v, body, &path, clock);
    if (SCENE_ANY_FREE && body_turns_freely(at->v, body)) {
        return flight_axis_motion(at->q, turn, body, direction);
    }
    if (!body_turn_is_prescribed(at->v, body) ||
        (body_is_compound(body) && path.turn_follows != TURN_FOLLOWS_VELOCITY)) {
        return (struct axis_motion){.kind = AXIS_FIXED, .axis = direction};
    }
    const bool by_axis = path.turn_follows != TURN_FOLLOWS_VELOCITY && !vec3_is_zero(path.axis[0]);
    return by_axis ? axis_motion_following(path.axis)
                   : axis_motion_prescribed(direction, path.angular_velocity);
}

struct advancement_path advancement_path_of(const struct scene_instant *at, double clock, int contact)
{
    const struct separation_path separation = separation_path_of(at, clock, contact);
    const bool apart = at->q->contact[contact].regime == (int32_t)REGIME_APART;
    struct advancement_path path = {.change = apart ? ADVANCEMENT_TOUCH : ADVANCEMENT_PARTING,
                                    .shape = scene_contact_shape_at(at, contact),
                                    .degree = separation.degree,
                                    .rounding = rounding_of_gap(at, contact)};
    memcpy(path.c, separation.c, sizeof path.c);
    for (int i = 0; SCENE_ANY_PRESCRIBED && i < SEPARATION_DEGREE; ++i) {
        path.mismatch[i] = vec3_axpy(separation.w[i], -(i + 1), separation.c[i + 1]);
    }
    for (int end = 0; SCENE_ANY_COMPOUND && end < 2; ++end) {
        const struct vec3 lever = scene_lever(at, contact, end);
        const double length = vec3_norm(lever);
        if (length > 0.0) { /* without the lever arms c leads from centre of mass to centre of mass */
            const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
            path.lever_length[end] = length;
            path.lever[end] = motion_with(at, clock, body, vec3_scale(1.0 / length, lever));
            path.c[0] = vec3_axpy(path.c[0], end == 0 ? 1.0 : -1.0, lever);
        }
    }
    if (SCENE_ANY_AXIS) {
        path.axis = contact_tips(at->v, contact)
                        ? motion_with(at, clock, contact_destination(contact), path.shape.axis)
                        : (struct axis_motion){.kind = AXIS_FIXED, .axis = path.shape.axis};
    }
    return path;
}

struct relative_path relative_path_make(const struct contact_shape *shape,
                                        const struct separation_path *separation, double gap, double horizon)
{
    struct relative_path path = {.shape = shape, .horizon = horizon};
    path.scale =
        fmax(path_size(separation->c, SEPARATION_DEGREE + 1, horizon), fmax(contact_reach(shape), DBL_MIN));
    double factor = 1.0 / path.scale;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        path.c[i] = vec3_scale(factor, contact_across(shape, separation->c[i]));
        if (contact_is_plane(shape)) {
            path.c[i] = vec3_make(-vec3_dot(path.c[i], shape->axis), 0.0, 0.0);
        }
        factor *= horizon;
        factor = factor < DBL_MAX ? factor : DBL_MAX; /* keeps a product with a zero coefficient finite */
    }
    path.reach = contact_reach(shape) / path.scale;
    path.degree = path_degree(path.c, SEPARATION_DEGREE + 1);
    path.start = vec3_norm(path.c[0]);
    path.gap = gap / path.scale;
    const int by_degree = contact_is_plane(shape) ? 0 : path.degree;
    path.closing.degree = by_degree + (path.degree > 0 ? path.degree - 1 : 0);
    for (int i = 0; i <= by_degree; ++i) {
        const struct vec3 by = contact_is_plane(shape) ? vec3_make(1.0, 0.0, 0.0) : path.c[i];
        for (int j = 0; j < path.degree; ++j) {
            path.closing.a[i + j] += vec3_dot(by, vec3_scale(j + 1, path.c[j + 1]));
        }
    }
    return path;
}

void relative_path_gap(const void *data, double s, double *gap, double *slope)
{
    const struct relative_path *path = data;
    const struct vec3 moved =
        path->degree > 0 ? vec3_scale(s, path_at(path->c + 1, path->degree, s)) : vec3_make(0.0, 0.0, 0.0);
    if (contact_is_plane(path->shape)) {
        *gap = path->gap + moved.x;
        *slope = taylor_at(path->closing.a, path->closing.degree + 1, s);
        return;
    }
    const double distance = vec3_norm(vec3_add(path->c[0], moved));
    const double both = path->start + distance;
    /* |a + b| - |a| = (2 a.b + b.b) / (|a + b| + |a|) */
    const double grown = both > 0.0 ? vec3_dot(vec3_axpy(moved, 2.0, path->c[0]), moved) / both : 0.0;
    *gap = path->gap + path->shape->side * grown;
    const double closing = taylor_at(path->closing.a, path->closing.degree + 1, s);
    *slope = distance > 0.0 ? path->shape->side * closing / distance : 0.0;
}
