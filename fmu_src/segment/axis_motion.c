#include "segment/axis_motion.h"

struct axis_motion axis_motion_fixed(struct vec3 axis)
{
    return (struct axis_motion){.kind = AXIS_FIXED, .axis = axis};
}

struct axis_motion axis_motion_of_rotor(const struct rotor *rotor)
{
    const bool turns = rotor_axis_speed(rotor) > 0.0;
    return (struct axis_motion){
        .kind = turns ? AXIS_PRECESSES : AXIS_FIXED, .axis = rotor->axis, .rotor = *rotor};
}

static bool is_steady_axis(const struct vec3 *coefficient, int count)
{
    for (int i = 1; i < count; ++i) {
        if (!vec3_is_zero(coefficient[i])) {
            return false;
        }
    }
    return true;
}

static void copy_terms(struct axis_motion *motion, const struct vec3 *coefficient, int count)
{
    for (int i = 0; i < count; ++i) {
        motion->coefficient[i] = coefficient[i];
    }
}

struct axis_motion axis_motion_driven(struct vec3 axis, const struct vec3 *rate, int count)
{
    if (is_steady_axis(rate, count)) {
        /* a sphere's free motion is a steady turn */
        const struct rotor_state start = {quaternion_between(vec3_make(0.0, 0.0, 1.0), axis), rate[0]};
        struct rotor rotor = rotor_from(start, 1.0, 1.0);
        rotor.axis = axis;
        return axis_motion_of_rotor(&rotor);
    }
    struct axis_motion motion = {.kind = AXIS_DRIVEN, .axis = axis};
    copy_terms(&motion, rate, count);
    return motion;
}

struct axis_motion axis_motion_following(const struct vec3 *direction, int count)
{
    struct axis_motion motion = {.kind = is_steady_axis(direction, count) ? AXIS_FIXED : AXIS_FOLLOWS};
    motion.axis = vec3_scale(1.0 / vec3_norm(direction[0]), direction[0]);
    copy_terms(&motion, direction, count);
    return motion;
}

/* A polynomial and its first two derivatives `time` after its origin. */
static void polynomial_of_vectors(const struct vec3 coefficient[AXIS_TERMS], double time, struct vec3 at[3])
{
    at[0] = at[1] = at[2] = vec3_make(0.0, 0.0, 0.0);
    for (int i = AXIS_TERMS - 1; i >= 0; --i) {
        at[2] = vec3_axpy(vec3_scale(2.0, at[1]), time, at[2]);
        at[1] = vec3_axpy(at[0], time, at[1]);
        at[0] = vec3_axpy(coefficient[i], time, at[0]);
    }
}

static struct rotor_axis following_axis_at(const struct axis_motion *motion, double time)
{
    struct rotor_axis now = {motion->axis, vec3_make(0.0, 0.0, 0.0)};
    struct vec3 at[3];
    polynomial_of_vectors(motion->coefficient, time, at);
    const double length = vec3_norm(at[0]);
    if (length > 0.0) {
        now.axis = vec3_scale(1.0 / length, at[0]);
        now.rate = vec3_scale(1.0 / length, vec3_axpy(at[1], -vec3_dot(at[1], now.axis), now.axis));
    }
    return now;
}

static struct rotor_axis driven_axis_at(const struct axis_motion *motion, double time)
{
    const double since = time - motion->from;
    struct vec3 at[3];
    polynomial_of_vectors(motion->coefficient, since, at);
    const struct vec3 axis = rotor_axis_after(motion->coefficient, motion->axis, since);
    return (struct rotor_axis){axis, vec3_cross(at[0], axis)};
}

struct rotor_axis axis_motion_at(const struct axis_motion *motion, double time)
{
    switch (motion->kind) {
    case AXIS_PRECESSES:
        return rotor_axis_at(&motion->rotor, time - motion->from);
    case AXIS_DRIVEN:
        return driven_axis_at(motion, time);
    case AXIS_FOLLOWS:
        return following_axis_at(motion, time);
    case AXIS_FIXED:
    default:
        return (struct rotor_axis){motion->axis, vec3_make(0.0, 0.0, 0.0)};
    }
}

void axis_motion_move_on(struct axis_motion *motion, double time)
{
    if (motion->kind == AXIS_DRIVEN && time > motion->from) {
        motion->axis = driven_axis_at(motion, time).axis;
        rotor_rates_shift(motion->coefficient, AXIS_TERMS, time - motion->from);
        motion->from = time;
    }
}

/* A polynomial's size and its first two derivatives' over some time, at most; of itself at least, too. */
struct vector_sizes {
    double least, most, first, second;
};

static struct vector_sizes sizes_within(const struct vec3 coefficient[AXIS_TERMS], double time, double length)
{
    struct vec3 at[3];
    polynomial_of_vectors(coefficient, time, at);
    const double third = 6.0 * vec3_norm(coefficient[3]);
    const double second = vec3_norm(at[2]) + third * length;
    const double first = vec3_norm(at[1]) + second * length;
    const double start = vec3_norm(at[0]);
    return (struct vector_sizes){start - first * length, start + first * length, first, second};
}

struct axis_bounds axis_motion_bounds(const struct axis_motion *motion, double time, double length)
{
    if (motion->kind == AXIS_PRECESSES) {
        /* e' = P x e and e'' = P x (P x e) with a constant P at a constant angle to e */
        const double along = fabs(vec3_dot(motion->rotor.direction, motion->axis));
        const double speed = rotor_axis_speed(&motion->rotor);
        return (struct axis_bounds){speed, along * rotor_precession(&motion->rotor) * speed};
    }
    if (motion->kind == AXIS_FIXED) {
        return (struct axis_bounds){0.0, 0.0};
    }
    const struct vector_sizes size = sizes_within(motion->coefficient, time - motion->from, length);
    if (motion->kind == AXIS_DRIVEN) {
        /* e x e'' = e x (lambda' x e) - (lambda.e) lambda x e, whose last part is |lambda|^2/2 at most */
        return (struct axis_bounds){size.most, size.first + 0.5 * size.most * size.most};
    }
    /* e = a/|a|: |e'| <= |a'|/|a| and |e x e''| <= (|a''| + 2 |a'| |e'|)/|a| */
    if (!(size.least > 0.0)) {
        return (struct axis_bounds){(double)INFINITY, (double)INFINITY};
    }
    const double speed = size.first / size.least;
    return (struct axis_bounds){speed, (size.second + 2.0 * size.first * speed) / size.least};
}
