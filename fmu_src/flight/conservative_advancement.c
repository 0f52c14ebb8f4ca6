#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "contact/shape.h"
#include "flight/conservative_advancement.h"
#include "math/polynomial.h"

struct axis_motion axis_motion_of_rotor(const struct rotor *rotor)
{
    const bool turns = rotor_axis_speed(rotor) > 0.0;
    return (struct axis_motion){
        .kind = turns ? AXIS_PRECESSES : AXIS_FIXED, .axis = rotor->axis, .rotor = *rotor};
}

struct axis_motion axis_motion_tumbling(struct vec3 axis, const struct body_turn *body, struct vec3 inertia,
                                        const struct vec3 torque[ROTOR_TORQUES])
{
    struct axis_motion motion = {.kind = AXIS_TUMBLES, .axis = axis, .body = *body, .inertia = inertia};
    memcpy(motion.coefficient, torque, ROTOR_TORQUES * sizeof *torque);
    return motion;
}

struct axis_motion axis_motion_prescribed(struct vec3 axis, const struct vec3 rate[AXIS_TERMS])
{
    const struct body_turn start = {quaternion_identity(), rate[0]};
    if (path_is_steady(rate, AXIS_TERMS)) {
        /* a steady turn is the torque-free rotation of a sphere (equal moments of inertia) */
        struct rotor rotor = rotor_from(start, 1.0, 1.0);
        rotor.axis = axis;
        return axis_motion_of_rotor(&rotor);
    }
    const struct vec3 torque[ROTOR_TORQUES] = {rate[1], vec3_scale(2.0, rate[2])};
    return axis_motion_tumbling(axis, &start, vec3_make(1.0, 1.0, 1.0), torque);
}

struct axis_motion axis_motion_following(const struct vec3 direction[AXIS_TERMS])
{
    struct axis_motion motion = {.kind = path_is_steady(direction, AXIS_TERMS) ? AXIS_FIXED : AXIS_FOLLOWS};
    motion.axis = vec3_scale(1.0 / vec3_norm(direction[0]), direction[0]);
    memcpy(motion.coefficient, direction, AXIS_TERMS * sizeof *direction);
    return motion;
}

/* Returns e_d and its rate at a time no earlier than `from`. */
static struct rotor_axis axis_motion_at(const struct axis_motion *motion, double time)
{
    struct rotor_axis now = {motion->axis, vec3_make(0.0, 0.0, 0.0)};
    if (CONTACT_ANY_ROTATION && motion->kind == AXIS_PRECESSES) {
        now = rotor_axis_at(&motion->rotor, time - motion->from);
    } else if (CONTACT_ANY_ROTATION && motion->kind == AXIS_TUMBLES) {
        const struct body_turn then =
            rotor_of_three_after(&motion->body, motion->inertia, motion->coefficient, time - motion->from);
        now.axis = quaternion_rotate(then.orientation, motion->axis);
        now.rate = vec3_cross(then.angular_velocity, now.axis);
    } else if (CONTACT_ANY_ROTATION && motion->kind == AXIS_FOLLOWS) {
        const struct vec3 at = path_at(motion->coefficient, AXIS_TERMS, time);
        const struct vec3 rate = path_slope(motion->coefficient, time);
        const double length = vec3_norm(at);
        if (length > 0.0) {
            now.axis = vec3_scale(1.0 / length, at);
            now.rate = vec3_scale(1.0 / length, vec3_axpy(rate, -vec3_dot(rate, now.axis), now.axis));
        }
    }
    return now;
}

void advancement_move_on(struct advancement_path *path, double time)
{
    for (int i = 0; CONTACT_ANY_ROTATION && i < (CONTACT_ANY_COMPOUND ? 3 : 1); ++i) {
        struct axis_motion *motion = i == 0 ? &path->axis : &path->lever[i - 1];
        const double after = time - motion->from;
        if (motion->kind == AXIS_TUMBLES && after > 0.0) {
            motion->body = rotor_of_three_after(&motion->body, motion->inertia, motion->coefficient, after);
            path_shift(motion->coefficient, ROTOR_TORQUES, after);
            motion->from = time;
        }
    }
}

/*
 * Bounds over [time, time + length] for the frame that moves with the axis e and does not spin about e. The
 * angular velocity of this frame is e x e', of size |e'|; the rate of the angular velocity is e x e''.
 * INFINITY means that there is no bound.
 */
struct axis_bounds {
    double speed; /* upper bound of |e'| [1/s] */
    double turn;  /* upper bound of |e x e''| [1/s^2] */
};

/* Returns a bound of |a x b| for vectors whose components are in size at most those of `a` and `b`. */
static double cross_at_most(const double a[3], const double b[3])
{
    return vec3_norm(
        vec3_make(a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]));
}

/* Bounds for a tumbling body, by components in the frame of its principal axes. |omega_k| is at most
 * |L| / I_k, sqrt(2 E / I_k), and its start plus its change. By Euler's equations |omega_k'| is at most
 * (|tau| + |I_i - I_j| |omega_i| |omega_j|) / I_k. Then e x e'' = e x (omega' x e) - (omega x e)(omega.e). */
static struct axis_bounds tumbling_bounds(const struct axis_motion *motion, double time, double length)
{
    const struct vec3 omega =
        quaternion_rotate(quaternion_inverse(motion->body.orientation), motion->body.angular_velocity);
    const double start[3] = {fabs(omega.x), fabs(omega.y), fabs(omega.z)};
    const double axis[3] = {fabs(motion->axis.x), fabs(motion->axis.y), fabs(motion->axis.z)};
    const double i[3] = {motion->inertia.x, motion->inertia.y, motion->inertia.z};
    const double until = time + length - motion->from;
    const double torque = path_size(motion->coefficient, ROTOR_TORQUES, until);
    const double momentum =
        vec3_norm(vec3_make(i[0] * omega.x, i[1] * omega.y, i[2] * omega.z)) + torque * until;
    const double root = sqrt(i[0] * omega.x * omega.x + i[1] * omega.y * omega.y + i[2] * omega.z * omega.z) +
                        torque * until / sqrt(fmin(i[0], fmin(i[1], i[2])));
    double most[3];
    double rate[3];
    double change[3];
    for (int k = 0; k < 3; ++k) {
        most[k] = fmin(momentum / i[k], root / sqrt(i[k]));
    }
    for (int pass = 0; pass < 6; ++pass) { /* each twice: sharper bounds of two sharpen the third */
        const int k = pass % 3;
        const int next = (k + 1) % 3;
        const int last = (k + 2) % 3;
        rate[k] = (torque + fabs(i[next] - i[last]) * most[next] * most[last]) / i[k];
        change[k] = until * rate[k];
        most[k] = fmin(most[k], start[k] + change[k]);
    }
    const double now = vec3_norm(vec3_cross(omega, motion->axis));
    const double speed = fmin(cross_at_most(most, axis), now + cross_at_most(change, axis));
    const double along = most[0] * axis[0] + most[1] * axis[1] + most[2] * axis[2];
    return (struct axis_bounds){speed, cross_at_most(rate, axis) + speed * along};
}

static struct axis_bounds axis_motion_bounds(const struct axis_motion *motion, double time, double length)
{
    if (CONTACT_ANY_ROTATION && motion->kind == AXIS_PRECESSES) {
        /* precession: e' = P x e and e'' = P x (P x e) with a constant P at a constant angle to e */
        const double along = fabs(vec3_dot(motion->rotor.direction, motion->axis));
        const double speed = rotor_axis_speed(&motion->rotor);
        return (struct axis_bounds){speed, along * rotor_precession(&motion->rotor) * speed};
    }
    if (!CONTACT_ANY_ROTATION || motion->kind == AXIS_FIXED) {
        return (struct axis_bounds){0.0, 0.0};
    }
    if (motion->kind == AXIS_TUMBLES) {
        return tumbling_bounds(motion, time, length);
    }
    /* e = a/|a|: |e'| <= |a'|/|a| and |e x e''| <= (|a''| + 2 |a'| |e'|)/|a| */
    const double second = 2.0 * vec3_norm(motion->coefficient[2]);
    const double first = vec3_norm(path_slope(motion->coefficient, time)) + second * length;
    const double least = vec3_norm(path_at(motion->coefficient, AXIS_TERMS, time)) - first * length;
    if (!(least > 0.0)) {
        return (struct axis_bounds){(double)INFINITY, (double)INFINITY};
    }
    const double speed = first / least;
    return (struct axis_bounds){speed, (second + 2.0 * first * speed) / least};
}

/* Returns an upper bound of the second derivatives of the lever arms [m/s^2]: for b = |b| e it is
 * |b| (|e x e''| + |e'|^2). */
static double bend_of_levers(const struct advancement_path *path, double time, double length)
{
    double bend = 0.0;
    for (int end = 0; CONTACT_ANY_COMPOUND && end < 2; ++end) {
        const struct axis_bounds turn = axis_motion_bounds(&path->lever[end], time, length);
        bend += path->lever_length[end] * (turn.turn + turn.speed * turn.speed);
    }
    return bend;
}

double advancement_turning(const struct advancement_path *path, double time, double length)
{
    double speed = axis_motion_bounds(&path->axis, time, length).speed;
    for (int end = 0; CONTACT_ANY_COMPOUND && end < 2; ++end) {
        speed = fmax(speed, axis_motion_bounds(&path->lever[end], time, length).speed);
    }
    return speed;
}

/* Relative rounding of a gap, a sum of products of vectors, as in rounding_of_gap. */
static const double ADVANCEMENT_ROUNDINGS = 8.0 * DBL_EPSILON;

/* Returns the number of functions; without end planes the gap is the only function. */
static int functions_of(const struct advancement_path *path)
{
    const bool may_end = contact_is_cylinder(&path->shape) || contact_is_torus(&path->shape);
    return may_end && isfinite(path->shape.half_length) ? ADVANCEMENT_FUNCTIONS : 1;
}

/* Sets the separation and its time derivatives. Lever arms, which are no polynomials, are added to the
 * separation and to its rate alone. */
static void separation_at(const struct advancement_path *path, double time, struct vec3 at[ADVANCEMENT_TERMS])
{
    double factorial = 1.0;
    memcpy(at, path->c, sizeof path->c);
    path_shift(at, path->degree + 1, time);
    for (int k = 2; k <= path->degree; ++k) {
        factorial *= k;
        at[k] = vec3_scale(factorial, at[k]);
    }
    for (int end = 0; CONTACT_ANY_COMPOUND && end < 2; ++end) {
        const struct rotor_axis lever = axis_motion_at(&path->lever[end], time);
        const double part = end == 0 ? -path->lever_length[end] : path->lever_length[end];
        at[0] = vec3_axpy(at[0], part, lever.axis);
        at[1] = vec3_axpy(at[1], part, lever.rate);
    }
}

/* Returns the shape with another axis; one that is divided into zones becomes whole, whatever its zone. */
static struct contact_shape shape_with(const struct advancement_path *path, struct vec3 axis)
{
    struct contact_shape shape = path->shape;
    shape.axis = axis;
    if (contact_is_capped(&shape)) {
        shape.solid.axis = axis;
    }
    contact_enter_zone(&shape, 0);
    return shape;
}

/* Whether d grows through the reach at the change: a touch inside a shell, or a parting outside. */
static bool distance_grows(const struct advancement_path *path)
{
    return (path->change == ADVANCEMENT_TOUCH) == (path->shape.side < 0);
}

/* Returns the value, at the parting, of a distance whose square is smooth everywhere: r_s for the distance
 * from a capped solid, the reach for the distance from an axis or a centre. */
static double smooth_reach(const struct contact_shape *shape)
{
    return contact_is_capped(shape) ? shape->source_radius : contact_reach(shape);
}

/* Returns the gap, or (reach^2 - d^2)/(2 reach) in place of reach - d where d grows; a plane keeps d. */
static struct falling gap_function(const struct advancement_path *path, const struct contact_shape *shape,
                                   const struct contact_geometry *g)
{
    const double sign = path->change == ADVANCEMENT_TOUCH ? 1.0 : -1.0;
    struct falling gap = {sign * g->gap, sign * g->gap_rate, 0.0, 0.0};
    if (distance_grows(path) && !contact_is_plane(shape)) {
        const bool capped = contact_is_capped(shape);
        const double distance = capped ? fmax(g->gap + shape->source_radius, 0.0) : g->distance;
        const double part = distance / smooth_reach(shape);
        const bool deep = capped && !(part > 0.0);
        gap.value = deep ? 0.5 * shape->source_radius : gap.value * 0.5 * (1.0 + part);
        gap.slope *= part;
    }
    return gap;
}

void advancement_at(const struct advancement_path *path, double time, struct advancement_instant *at)
{
    separation_at(path, time, at->c);
    at->axis = axis_motion_at(&path->axis, time);
    const struct contact_shape shape = shape_with(path, at->axis.axis);
    /* the gap changes by the rate of c in the frame of the axis, whose angular velocity is e x e' */
    const struct vec3 omega = vec3_cross(at->axis.axis, at->axis.rate);
    const struct vec3 rate = vec3_sub(at->c[1], vec3_cross(omega, at->c[0]));
    at->geometry = contact_geometry_at(&shape, at->c[0], rate, path->shape.axis);
    at->axial_rate = vec3_dot(rate, at->axis.axis);
    if (contact_is_torus(&shape)) {
        at->axial_rate =
            shape.solid.race * vec3_dot(rate, vec3_cross(at->geometry.circumferential, at->axis.axis));
    }
    at->of[ADVANCEMENT_GAP] = gap_function(path, &shape, &at->geometry);
    const double distance = vec3_norm(at->c[0]);
    /* whether the source moves, to rounding, in a plane across the axis */
    const bool in_plane = fabs(at->axial_rate) <= ADVANCEMENT_ROUNDINGS * vec3_norm(at->c[1]);
    at->noise[ADVANCEMENT_GAP] =
        fmax(path->rounding, ADVANCEMENT_ROUNDINGS * (distance + at->geometry.gap_terms));
    for (int i = ADVANCEMENT_UPPER_END; i < functions_of(path); ++i) {
        const double end = i == ADVANCEMENT_UPPER_END ? 1.0 : -1.0;
        const double sign = path->change == ADVANCEMENT_TOUCH ? 1.0 : -1.0;
        at->noise[i] = fmax(path->rounding, ADVANCEMENT_ROUNDINGS * (distance + shape.half_length));
        double beyond = end * at->geometry.axial - shape.half_length;
        /* a source in the end plane counts as within by more than rounding */
        if (!(beyond > at->noise[i]) && in_plane) {
            beyond = fmin(beyond, -2.0 * at->noise[i]);
        }
        at->of[i] = (struct falling){sign * beyond, sign * end * at->axial_rate, 0.0, 0.0};
    }
}

/* Returns an upper bound of a derivative of the separation over the next `length` seconds: of |c^(first)|, or
 * of |e.c^(first)| with a unit vector e. The bound is the sum over i of |c^(first + i)| length^i / i!. */
static double size_within(const struct vec3 c[ADVANCEMENT_TERMS], const struct vec3 *e, int first,
                          double length)
{
    double size = 0.0;
    for (int i = ADVANCEMENT_TERMS - 1; i >= first; --i) {
        const double norm = e != NULL ? fabs(contact_along_plane(*e, c[i])) : vec3_norm(c[i]);
        size = norm + (size > 0.0 ? size * length / (i - first + 1) : 0.0);
    }
    return size;
}

/* Adds to the bends what the curvature of a torus around its axis adds. At the speed v the distance rho from
 * the axis has rho'' >= -|c''| and at most v^2/rho more, and q has q'' >= -|c''| - (v^2/q) (R/rho - 1) within
 * R. Across the axis q has a bend without bound, but no rate above v. */
static void bound_ring(const struct contact_shape *shape, bool grows, double speed, double length,
                       struct advancement_instant *at)
{
    const double ring = shape->solid.radius;
    const double nearest = ring / at->geometry.circumferential_part - speed * length;
    const double hoop = nearest > 0.0 ? speed * speed / nearest : (double)INFINITY;
    at->of[ADVANCEMENT_UPPER_END].bend += hoop;
    at->of[ADVANCEMENT_LOWER_END].bend += hoop;
    if (!grows && nearest < ring) {
        at->of[ADVANCEMENT_GAP].bend += hoop * (ring - nearest) / contact_reach(shape);
        at->of[ADVANCEMENT_GAP].steepest = speed;
    }
}

/* Sharpens the bounds of functions whose gradients turn with the axis, by the angle `turned` over `length`
 * seconds at most: c bends them along their present gradients, and by `whole` in other directions. */
static void bound_along(const struct advancement_path *path, bool grows, double length, double turned,
                        double whole, double of_turns, struct advancement_instant *at)
{
    for (int i = grows ? ADVANCEMENT_UPPER_END : 0; i < functions_of(path); ++i) {
        const struct vec3 gradient = i == ADVANCEMENT_GAP ? at->geometry.normal : at->axis.axis;
        const double along = size_within(at->c, &gradient, 2, length) + turned * whole;
        at->of[i].bend = fmin(along, whole) + of_turns;
    }
}

/* Sets the bounds of the second derivatives over `length` seconds from `time` on; INFINITY: no bound. */
static void bound_bends(const struct advancement_path *path, double time, double length,
                        struct advancement_instant *at)
{
    const struct axis_bounds axis = axis_motion_bounds(&path->axis, time, length);
    const struct contact_shape shape = shape_with(path, path->axis.axis);
    const double of_levers = bend_of_levers(path, time, length);
    const bool grows = distance_grows(path) && !contact_is_plane(&shape);
    const bool stands = !(axis.speed > 0.0) && !contact_is_torus(&shape);
    struct falling *gap = &at->of[ADVANCEMENT_GAP];
    for (int i = ADVANCEMENT_UPPER_END; stands && i < functions_of(path); ++i) {
        at->of[i].bend = size_within(at->c, &path->axis.axis, 2, length) + of_levers;
    }
    if (stands && !grows) {
        /* the distance from a convex set falls by no more than c changes along its present gradient n */
        gap->bend = size_within(at->c, &at->geometry.normal, 2, length) + of_levers;
        return;
    }
    const bool is_open = stands && !contact_is_capped(&shape); /* motion along an axis leaves d as it is */
    struct vec3 c[ADVANCEMENT_TERMS];
    for (int i = 0; i < ADVANCEMENT_TERMS; ++i) {
        c[i] = is_open ? contact_across(&shape, at->c[i]) : at->c[i];
    }
    const double whole = size_within(c, NULL, 2, length);
    double of_turns = of_levers;
    double speed = size_within(c, NULL, 1, length) + of_levers * length;
    if (axis.speed > 0.0) {
        const double separation = size_within(at->c, NULL, 0, length) + 0.5 * of_levers * length * length;
        of_turns += 2.0 * axis.speed * speed + (axis.turn + axis.speed * axis.speed) * separation;
        speed += axis.speed * separation;
    }
    for (int i = 0; i < (stands ? 1 : functions_of(path)); ++i) {
        at->of[i].bend = whole + of_turns;
    }
    if (contact_is_torus(&shape)) {
        bound_ring(&shape, grows, speed, length, at);
    } else if (!stands && axis.speed * length < 1.0) {
        bound_along(path, grows, length, axis.speed * length, whole, of_turns, at);
    }
    if (grows) {
        gap->bend += speed * speed / smooth_reach(&shape);
    }
}

/* Returns how far the distance of the centres exceeds the largest distance of a touch [m], with the bend over
 * `length` seconds. The function is valid for any motion of the axis. */
static struct falling beyond_reach(const struct advancement_path *path, const struct advancement_instant *at,
                                   double time, double length)
{
    const double distance = vec3_norm(at->c[0]);
    const struct contact_shape shape = shape_with(path, path->axis.axis);
    double farthest =
        contact_reach(&shape) + (contact_is_torus(&shape) ? shape.solid.radius : shape.half_length);
    if (contact_is_capped(&shape)) {
        farthest = shape.solid.radius + shape.solid.half_height + shape.source_radius;
    }
    const double slope = distance > 0.0 ? vec3_dot(at->c[0], at->c[1]) / distance : 0.0;
    return (struct falling){distance - farthest, slope,
                            size_within(at->c, NULL, 2, length) + bend_of_levers(path, time, length), 0.0};
}

/* Returns a time during which a function surely stays above -noise [s]. */
static double stays_above(const struct falling *f, double noise)
{
    const double height = f->value + noise;
    const double slowly = f->steepest > 0.0 ? height / f->steepest : 0.0;
    if (!(height > 0.0) || !(f->bend < (double)INFINITY)) {
        return fmax(slowly, 0.0);
    }
    const double root = sqrt(f->slope * f->slope + 2.0 * f->bend * height);
    if (f->slope >= 0.0) {
        return f->bend > 0.0 ? fmax((f->slope + root) / f->bend, slowly) : (double)INFINITY;
    }
    return fmax(2.0 * height / (root - f->slope), slowly);
}

/* Returns the function that decides: the highest function for a touch, the lowest for a parting. Each
 * function counts with its noise times `noises`. */
static int deciding(const struct advancement_path *path, const struct advancement_instant *at, double noises)
{
    int found = 0;
    for (int i = 1; i < functions_of(path); ++i) {
        const bool higher =
            at->of[i].value + noises * at->noise[i] > at->of[found].value + noises * at->noise[found];
        found = higher == (path->change == ADVANCEMENT_TOUCH) ? i : found;
    }
    return found;
}

/* Returns the deciding function and its slope, as a root_function of time. */
static void decision(const void *data, double time, double *value, double *slope)
{
    const struct advancement_path *path = data;
    struct advancement_instant at;
    advancement_at(path, time, &at);
    const struct falling *f = &at.of[deciding(path, &at, 0.0)];
    *value = f->value;
    *slope = f->slope;
}

/* Returns a time during which a function stays above -noise [s]; 0 if the function is already below.
 * Otherwise the time is at least `least`, in which a function falls by no more than three eighths of the
 * noise. */
static double stays_unchanged(const struct falling *f, double noise)
{
    const double quarter = 0.25 * noise;
    const double least = quarter / (fabs(f->slope) + sqrt(f->bend * quarter));
    return f->value < -noise ? 0.0 : fmax(stays_above(f, noise), least);
}

/* Returns the longest time without a change by more than rounding [s], by the bends at `at`. A touch needs
 * all functions to fall, so the longest time counts; a parting needs one, so the shortest counts. */
static double unchanged_for(const struct advancement_path *path, const struct advancement_instant *at)
{
    double time = stays_unchanged(&at->of[0], at->noise[0]);
    for (int i = 1; i < functions_of(path); ++i) {
        const double other = stays_unchanged(&at->of[i], at->noise[i]);
        time = (other > time) == (path->change == ADVANCEMENT_TOUCH) ? other : time;
    }
    return time;
}

/* Returns the next step from `time` [s]. `*length` is the time over which the bends hold; it adapts. */
static double step_from(const struct advancement_path *path, struct advancement_instant *at, double time,
                        double horizon, double *length)
{
    const double rest = horizon - time;
    const struct contact_shape *shape = &path->shape;
    /* bodies of finite size touch only where their centres are near each other */
    const bool has_reach =
        shape->side > 0 && (functions_of(path) > 1 || contact_is_capped(shape) || contact_is_torus(shape));
    if (path->change == ADVANCEMENT_TOUCH && has_reach) {
        const struct falling beyond = beyond_reach(path, at, time, rest);
        const double away = stays_above(&beyond, 0.0);
        if (away >= rest) {
            return rest;
        }
        if (away > *length) {
            return away;
        }
    }
    const double within = fmin(*length, rest);
    bound_bends(path, time, within, at);
    const struct falling *gap = &at->of[ADVANCEMENT_GAP];
    if (!(gap->bend < (double)INFINITY) && !(gap->steepest > 0.0)) {
        *length = 0.25 * within; /* no bound: the axis polynomial passes zero */
        return 0.0;
    }
    const double step = fmin(unchanged_for(path, at), within);
    *length = 2.0 * step;
    return step;
}

/* Returns the change at the root of the deciding function between `before`, a time without the change, and
 * `after`, a time with the change; the start if before.s < 0. */
static struct advancement_result located(const struct advancement_path *path, struct root_bracket_end before,
                                         struct root_bracket_end after, long evaluations)
{
    const double root = before.s < 0.0 ? 0.0 : root_between(decision, path, before, after);
    struct advancement_instant at;
    advancement_at(path, root, &at);
    const bool by_gap = deciding(path, &at, 0.0) == ADVANCEMENT_GAP;
    return (struct advancement_result){root, by_gap ? 0.0 : at.geometry.gap, root, evaluations};
}

struct advancement_result advancement_first(const struct advancement_path *path, double horizon, long budget)
{
    struct advancement_path moving = *path; /* the axis motion moves on with the search */
    double time = 0.0;
    /* the deciding function where it was last not negative; a time of -1: it has been negative throughout */
    struct root_bracket_end before = {-1.0, 0.0, 0.0};
    double length = horizon;
    for (long evaluations = 1; evaluations <= budget; ++evaluations) {
        struct advancement_instant at;
        advancement_at(&moving, time, &at);
        const struct falling *decides = &at.of[deciding(&moving, &at, 0.0)];
        const struct root_bracket_end now = {time, decides->value, decides->slope};
        double step = 0.0;
        const int surely = deciding(&moving, &at, 1.0);
        if (at.of[surely].value < -at.noise[surely]) { /* the change has taken place by more than rounding */
            /* within rounding of the opposite change the functions rise above zero; `step` is how long */
            step = before.s < 0.0 && now.slope > 0.0 ? -2.0 * now.value / now.slope : 0.0;
            if (!(step > 0.0)) {
                return located(&moving, before, now, evaluations);
            }
        } else if (time < horizon) {
            if (!(now.value < 0.0)) {
                before = now;
                advancement_move_on(&moving, time);
            }
            step = step_from(&moving, &at, time, horizon, &length);
            /* the step is halved until the deciding function has been >= 0: a value that rounding put below
             * zero is above zero half-way, or stays within rounding */
            step *= before.s < 0.0 ? 0.5 : 1.0;
        }
        /* bodies beyond the range of numbers touch no more */
        if (!(time < horizon && at.noise[ADVANCEMENT_GAP] < (double)INFINITY)) {
            return (struct advancement_result){(double)INFINITY, 0.0, horizon, evaluations};
        }
        /* a step of 0 repeats the time with a shorter length; another step is at least the time's rounding */
        const double least = step > 0.0 || !(length > DBL_EPSILON * horizon) ? 4.0 * DBL_EPSILON * time : 0.0;
        time = fmin(time + fmax(step, fmax(least, DBL_MIN)), horizon);
        length = fmax(length, DBL_EPSILON * horizon);
    }
    return (struct advancement_result){(double)INFINITY, 0.0, time, budget};
}
