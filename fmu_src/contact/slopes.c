#include "contact/slopes.h"
#include "math/series.h"
#include "math/vec3.h"

double jet_dot(const struct vec3 *a, const struct vec3 *b, int order)
{
    double sum = 0.0;
    for (int i = 0; i <= order && i < JET_TERMS; ++i) {
        sum += vec3_dot(a[i], b[order - i]);
    }
    return sum;
}

struct vec3 jet_scale(const double *a, const struct vec3 *b, int order)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i <= order && i < JET_TERMS; ++i) {
        sum = vec3_axpy(sum, a[i], b[order - i]);
    }
    return sum;
}

void jet_length(const struct vec3 a[JET_TERMS], double length[JET_TERMS])
{
    length[0] = vec3_norm(a[0]);
    for (int i = 1; i < JET_TERMS; ++i) {
        length[i] = 0.0;
    }
    if (length[0] > 0.0) {
        length[1] = vec3_dot(a[0], a[1]) / length[0];
        length[2] =
            (0.5 * vec3_dot(a[1], a[1]) + vec3_dot(a[0], a[2]) - 0.5 * length[1] * length[1]) / length[0];
        return;
    }
    length[1] = vec3_norm(a[1]);
    length[2] = length[1] > 0.0 ? vec3_dot(a[1], a[2]) / length[1] : 0.0;
}

void jet_divide(const struct vec3 a[JET_TERMS], const double by[JET_TERMS], struct vec3 quotient[JET_TERMS])
{
    for (int i = 1; i < JET_TERMS; ++i) {
        struct vec3 rest = a[i];
        for (int k = 1; k <= i; ++k) {
            rest = vec3_axpy(rest, -by[k], quotient[i - k]);
        }
        quotient[i] = vec3_scale(1.0 / by[0], rest);
    }
}

void jet_of_axis_distance(const struct vec3 c[JET_TERMS], const struct vec3 axis[JET_TERMS],
                          struct vec3 across[JET_TERMS], double axial[JET_TERMS], double rho[JET_TERMS])
{
    for (int i = 0; i < JET_TERMS; ++i) {
        axial[i] = jet_dot(c, axis, i);
        across[i] = vec3_sub(c[i], jet_scale(axial, axis, i));
    }
    jet_length(across, rho);
}

/* Sets the coefficients of the largest friction force L [N] in the regime. */
static void put_limit(const struct friction_law *law, enum friction_regime regime,
                      const struct friction_path *path, double limit[JET_TERMS])
{
    for (int i = 0; i < JET_TERMS; ++i) {
        limit[i] = regime == FRICTION_SLIDING ? law->coefficient * path->normal_force[i] : 0.0;
    }
    limit[0] = friction_limit(law, regime, path->normal_force[0]);
}

/* Sets the coefficients of k_t [N/m]. */
static void put_stiffness(const struct friction_law *law, const struct friction_path *path,
                          double stiffness[JET_TERMS])
{
    const bool stiffens = friction_stiffening(law, path->depth[0]) > 0.0;
    stiffness[0] = friction_stiffness(law, path->depth[0]);
    for (int i = 1; i < JET_TERMS; ++i) {
        stiffness[i] = stiffens ? taylor_power(path->depth, 0.5, stiffness, i) : 0.0;
    }
}

/* Sets (1 - exp(-z))/z and its first two derivatives. Below z = 1 differences would cancel, and the series
 * sum (-z)^k/(k + 1)! is used; its terms up to k = 20 are exact to rounding up to z = 1. */
static void put_saturation(double z, double out[JET_TERMS])
{
    enum { TERMS = 20 };
    if (z >= 1.0) {
        const double e = exp(-z);
        out[0] = -expm1(-z) / z;
        out[1] = (e * (1.0 + z) - 1.0) / (z * z);
        out[2] = (2.0 - e * (2.0 + z * (2.0 + z))) / (z * z * z);
        return;
    }
    out[0] = out[1] = out[2] = 0.0;
    for (int k = TERMS; k >= 0; --k) {
        double factorial = 1.0;
        for (int i = 2; i <= k + 1; ++i) {
            factorial *= i;
        }
        const double coefficient = (k % 2 ? -1.0 : 1.0) / factorial;
        out[2] = out[2] * z + out[1];
        out[1] = out[1] * z + out[0];
        out[0] = out[0] * z + coefficient;
    }
    out[2] *= 2.0; /* Horner's scheme gives derivatives over factorials */
}

/* Returns coefficient `order` of -L (1 - exp(-|v_t|/v_0))/|v_t| v_t. */
static struct vec3 regularized_term(const struct friction_law *law, const struct friction_path *path,
                                    const double limit[JET_TERMS], int order)
{
    double speed[JET_TERMS];
    double s[JET_TERMS];
    double factor[JET_TERMS];
    double weight[JET_TERMS];
    const double v_0 = law->slip_velocity;
    jet_length(path->slip, speed);
    const double z = speed[0] / v_0;
    put_saturation(z, s);
    factor[0] = s[0] / v_0;
    factor[1] = s[1] * speed[1] / (v_0 * v_0) - path->slip_velocity_slope * (s[1] * z + s[0]) / (v_0 * v_0);
    factor[2] = (s[1] * speed[2] + 0.5 * s[2] * speed[1] * speed[1] / v_0) / (v_0 * v_0);
    for (int i = 0; i < JET_TERMS; ++i) {
        weight[i] = -taylor_multiply(limit, factor, i);
    }
    return jet_scale(weight, path->slip, order);
}

struct vec3 friction_force_term(const struct friction_law *law, enum friction_regime regime,
                                const struct friction_path *path, int order)
{
    double limit[JET_TERMS];
    double stiffness[JET_TERMS];
    struct vec3 force[JET_TERMS];
    struct vec3 unit[JET_TERMS] = {{0.0, 0.0, 0.0}};
    double length[JET_TERMS];
    if (law->kind == FRICTION_NONE || regime == FRICTION_LIFTED) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    put_limit(law, regime, path, limit);
    if (law->kind == FRICTION_REGULARIZED) {
        return regularized_term(law, path, limit, order);
    }
    put_stiffness(law, path, stiffness);
    for (int i = 0; i < JET_TERMS; ++i) {
        force[i] = vec3_axpy(jet_scale(stiffness, path->spring, i), law->damping, path->slip[i]);
    }
    if (regime == FRICTION_STICKING) {
        return vec3_scale(-1.0, force[order]);
    }
    jet_length(force, length);
    if (length[0] > 0.0) {
        unit[0] = vec3_make(force[0].x / length[0], force[0].y / length[0], force[0].z / length[0]);
        jet_divide(force, length, unit);
    }
    return vec3_scale(-1.0, jet_scale(limit, unit, order));
}

void opposed_terms(enum opposed part, const struct vec3 slip[JET_TERMS], const struct vec3 omega[JET_TERMS],
                   const struct vec3 normal[JET_TERMS], struct vec3 motion[JET_TERMS])
{
    double along[JET_TERMS];
    for (int i = 0; i < JET_TERMS; ++i) {
        along[i] = jet_dot(omega, normal, i);
        const struct vec3 spinning = jet_scale(along, normal, i);
        motion[i] = part == OPPOSED_SLIP       ? slip[i]
                    : part == OPPOSED_SPINNING ? spinning
                                               : vec3_sub(omega[i], spinning);
    }
}

struct vec3 opposed_turned_term(enum opposed part, const struct vec3 spring[JET_TERMS],
                                const struct vec3 normal[JET_TERMS], int order)
{
    const struct vec3 rate[2] = {normal[1], vec3_scale(2.0, normal[2])};
    double factor[2];
    for (int i = 0; i <= order; ++i) {
        factor[i] = part == OPPOSED_SPINNING ? jet_dot(spring, normal, i) : -jet_dot(spring, rate, i);
    }
    return jet_scale(factor, part == OPPOSED_SPINNING ? rate : normal, order);
}

double friction_stored_term(const struct friction_law *law, enum friction_regime regime,
                            const struct friction_path *path, int order)
{
    double limit[JET_TERMS];
    double stiffness[JET_TERMS];
    double square[JET_TERMS]; /* xi^2, or L^2 */
    double stored[JET_TERMS];
    const bool slides = regime == FRICTION_SLIDING || regime == FRICTION_CAPPED;
    if (law->kind != FRICTION_ELASTIC) {
        return 0.0;
    }
    const bool is_limit = slides && law->damping == 0.0; /* the spring is L / k_t long */
    put_limit(law, regime, path, limit);
    put_stiffness(law, path, stiffness);
    for (int i = 0; i <= order; ++i) {
        square[i] = is_limit ? taylor_multiply(limit, limit, i) : jet_dot(path->spring, path->spring, i);
        stored[i] =
            is_limit ? taylor_divide(square, stiffness, stored, i) : taylor_multiply(stiffness, square, i);
    }
    return 0.5 * stored[order];
}

static struct vec3 matrix_times(double m[3][3], struct vec3 a)
{
    return vec3_make(m[0][0] * a.x + m[0][1] * a.y + m[0][2] * a.z,
                     m[1][0] * a.x + m[1][1] * a.y + m[1][2] * a.z,
                     m[2][0] * a.x + m[2][1] * a.y + m[2][2] * a.z);
}

/* Sets the opposed motions, the forces and torques that oppose them, and the derivatives of these. */
static void put_opposed_slopes(const struct turning_laws *laws, struct vec3 slip, struct turning_slopes *s)
{
    s->parts = 1;
    for (int i = 1; i < OPPOSED; ++i) {
        s->parts = laws->rubbing[i].kind != FRICTION_NONE ? OPPOSED : s->parts;
    }
    for (int i = 0; i < s->parts; ++i) {
        const struct friction_law *law = &laws->rubbing[i];
        const enum friction_regime regime = laws->rubbing_regime[i];
        s->opposed[i] = i == OPPOSED_SLIP ? slip : opposed_laid((enum opposed)i, s->spin, s->geometry.normal);
        const struct friction_state at = {.normal_force = s->normal_force,
                                          .slip = s->opposed[i],
                                          .spring = s->motion.spring[i],
                                          .depth = -s->geometry.gap,
                                          .depth_rate = -s->geometry.gap_rate};
        s->opposing[i] = friction_force(law, regime, at);
        s->force_slopes[i] = friction_force_slopes(law, regime, at);
        s->spring_slopes[i] = friction_spring_rate_slopes(law, regime, at);
    }
}

/* Returns the angular velocity with which the shape turns: omega_d, but zero for skew cylinders. */
static struct vec3 shape_rotation(const struct contact_shape *shape, const struct turning_motion *motion)
{
    return contact_is_skew(shape) ? vec3_make(0.0, 0.0, 0.0) : motion->destination_rotation;
}

/* Returns the part of a vector across n. */
static struct vec3 across_normal(struct vec3 n, struct vec3 a)
{
    return vec3_axpy(a, -vec3_dot(n, a), n);
}

/* Returns what rotation adds to the slip of skew cylinders besides r_s omega x n: omega_d x c + omega x foot,
 * also along n, which the caller takes away. */
static struct vec3 skew_passing(const struct turning_slopes *s)
{
    return vec3_add(vec3_cross(s->motion.destination_rotation, s->motion.separation),
                    vec3_cross(s->spin, contact_foot(&s->shape, s->motion.separation)));
}

struct turning_slopes turning_slopes_at(const struct contact_shape *shape, const struct contact_geometry *at,
                                        const struct turning_motion *motion, const struct turning_laws *laws)
{
    struct turning_slopes s = {.shape = *shape, .geometry = *at, .motion = *motion};
    const struct vec3 n = at->normal;
    const double lever = shape->source_radius * shape->side;
    const struct vec3 turn = shape_rotation(shape, motion);
    s.seen_rate = vec3_sub(motion->rate, vec3_cross(turn, motion->separation));
    s.across = contact_turning_part(shape, at, s.seen_rate);
    s.inverse_distance = contact_turns(shape, at) ? 1.0 / at->distance : 0.0;
    s.normal_rate = vec3_axpy(vec3_cross(turn, n), s.inverse_distance, s.across);
    s.spin = vec3_sub(motion->source_rotation, motion->destination_rotation);
    const struct vec3 tangential = vec3_axpy(s.seen_rate, -vec3_dot(n, s.seen_rate), n);
    struct vec3 slip = vec3_sub(vec3_scale(lever, vec3_cross(s.spin, n)), tangential);
    if (contact_is_skew(shape)) {
        slip = vec3_add(slip, across_normal(n, skew_passing(&s)));
    }

    s.normal_force = contact_force(&laws->normal, laws->regime, at->gap, at->gap_rate);
    s.normal_slopes = contact_force_slopes(&laws->normal, laws->regime, at->gap, at->gap_rate);
    s.stored_slope = contact_stored_slope(&laws->normal, laws->regime, at->gap);
    s.bend = contact_stored_bend(&laws->normal, laws->regime, at->gap);

    s.stiffening = friction_stiffening(&laws->rubbing[OPPOSED_SLIP], -at->gap);
    put_opposed_slopes(laws, slip, &s);
    s.force = vec3_axpy(s.opposing[OPPOSED_SLIP], -shape->side * s.normal_force, n);
    return s;
}

/* The changes of the geometry by a change of the motion. */
struct geometry_change {
    struct vec3 normal, seen_rate, tangential; /* of n, of w_g, and of the part of w_g across n */
    struct vec3 spin;                          /* of omega */
    double distance, along;                    /* of d and of n.w_g */
    struct vec3 axis;                          /* e of the shape */
    struct vec3 circumferential;               /* of b, at a circle */
    double circumferential_part;               /* of R / rho, at a circle */
};

/* Returns the change of a circle's offset and sets the changes of b and R / rho, with offset = (rho - R) a +
 * (c.e + h) e, b = e x a, rho a = c - (c.e) e. */
static struct vec3 circle_offset_along(const struct turning_slopes *s, const struct turning_motion *change,
                                       struct geometry_change *d)
{
    const struct vec3 e = s->shape.axis;
    const struct vec3 c = s->motion.separation;
    const struct vec3 a = vec3_cross(s->geometry.circumferential, e);
    const double axial = vec3_dot(c, e);
    const double rho = vec3_dot(c, a);
    const double more_axial = vec3_dot(change->separation, e) + vec3_dot(c, d->axis);
    const struct vec3 across = vec3_axpy(vec3_axpy(change->separation, -more_axial, e), -axial, d->axis);
    const double more_rho = vec3_dot(a, across);
    const struct vec3 turned = vec3_scale(1.0 / rho, vec3_axpy(across, -more_rho, a));
    d->circumferential = vec3_add(vec3_cross(d->axis, a), vec3_cross(e, turned));
    d->circumferential_part = -s->geometry.circumferential_part * more_rho / rho;
    const struct vec3 radial = vec3_axpy(vec3_scale(more_rho, a), rho - s->shape.solid.radius, turned);
    return vec3_axpy(vec3_axpy(radial, more_axial, e), axial + s->shape.solid.half_height, d->axis);
}

/* Returns the change of (R / rho) b (b.w_g), the term by which n' of a circle is reduced along it. */
static struct vec3 hoop_along(const struct turning_slopes *s, const struct geometry_change *d)
{
    const struct vec3 b = s->geometry.circumferential;
    const double part = s->geometry.circumferential_part;
    const double rate = vec3_dot(b, s->seen_rate);
    const double more = d->circumferential_part * rate +
                        part * (vec3_dot(d->circumferential, s->seen_rate) + vec3_dot(b, d->seen_rate));
    return vec3_axpy(vec3_scale(more, b), part * rate, d->circumferential);
}

/* Returns the change of the offset d n. */
static struct vec3 offset_along(const struct turning_slopes *s, const struct turning_motion *change,
                                struct geometry_change *d)
{
    if (contact_is_circle(&s->shape)) {
        return circle_offset_along(s, change, d);
    }
    if (!contact_is_cylinder(&s->shape)) {
        return change->separation;
    }
    const struct vec3 axis = s->shape.axis;
    const double axial = vec3_dot(change->separation, axis) + vec3_dot(s->motion.separation, d->axis);
    return vec3_axpy(vec3_axpy(change->separation, -axial, axis), -s->geometry.axial, d->axis);
}

static struct geometry_change geometry_along(const struct turning_slopes *s,
                                             const struct turning_motion *change)
{
    const struct vec3 n = s->geometry.normal;
    const struct turning_motion *at = &s->motion;
    struct geometry_change d;
    d.spin = vec3_sub(change->source_rotation, change->destination_rotation);
    d.axis = contact_is_upside_down(&s->shape) ? vec3_scale(-1.0, change->axis) : change->axis;
    if (contact_is_plane(&s->shape)) {
        d.normal = vec3_scale(-1.0, d.axis);
        d.distance = vec3_dot(n, change->separation) + vec3_dot(d.normal, at->separation);
    } else {
        const struct vec3 offset = offset_along(s, change, &d);
        d.distance = vec3_dot(n, offset);
        d.normal = vec3_scale(s->inverse_distance, vec3_axpy(offset, -d.distance, n));
    }
    d.seen_rate =
        vec3_sub(vec3_sub(change->rate, vec3_cross(shape_rotation(&s->shape, change), at->separation)),
                 vec3_cross(shape_rotation(&s->shape, at), change->separation));
    d.along = vec3_dot(d.normal, s->seen_rate) + vec3_dot(n, d.seen_rate);
    d.tangential = vec3_axpy(vec3_axpy(d.seen_rate, -vec3_dot(n, s->seen_rate), d.normal), -d.along, n);
    return d;
}

/* Returns the change of n' = across / d + omega_d x n. */
static struct vec3 normal_rate_along(const struct turning_slopes *s, const struct turning_motion *change,
                                     const struct geometry_change *d)
{
    const struct vec3 turned = vec3_add(vec3_cross(shape_rotation(&s->shape, change), s->geometry.normal),
                                        vec3_cross(shape_rotation(&s->shape, &s->motion), d->normal));
    if (contact_is_plane(&s->shape)) {
        return turned;
    }
    struct vec3 across = d->tangential;
    if (contact_is_cylinder(&s->shape)) {
        const struct vec3 axis = s->shape.axis;
        const double axial = vec3_dot(d->axis, s->seen_rate) + vec3_dot(axis, d->seen_rate);
        across = vec3_axpy(vec3_axpy(across, -vec3_dot(axis, s->seen_rate), d->axis), -axial, axis);
    }
    if (contact_is_circle(&s->shape)) {
        across = vec3_sub(across, hoop_along(s, d));
    }
    across = vec3_axpy(across, -d->distance * s->inverse_distance, s->across);
    return vec3_axpy(turned, s->inverse_distance, across);
}

/* Returns the change of the part of skew_passing across n. */
static struct vec3 skew_passing_along(const struct turning_slopes *s, const struct turning_motion *change,
                                      const struct geometry_change *d)
{
    const struct vec3 n = s->geometry.normal;
    const struct vec3 c = s->motion.separation;
    const struct vec3 passing = skew_passing(s);
    const struct vec3 by_feet =
        vec3_add(vec3_cross(d->spin, contact_foot(&s->shape, c)),
                 vec3_cross(s->spin, contact_foot_along(&s->shape, change->separation)));
    const struct vec3 by_rotation = vec3_add(vec3_cross(change->destination_rotation, c),
                                             vec3_cross(s->motion.destination_rotation, change->separation));
    const struct vec3 across = across_normal(n, vec3_add(by_feet, by_rotation));
    return vec3_axpy(vec3_axpy(across, -vec3_dot(n, passing), d->normal), -vec3_dot(d->normal, passing), n);
}

static struct vec3 slip_along(const struct turning_slopes *s, const struct turning_motion *change,
                              const struct geometry_change *d)
{
    const double lever = s->shape.source_radius * s->shape.side;
    const struct vec3 rolled =
        vec3_add(vec3_cross(d->spin, s->geometry.normal), vec3_cross(s->spin, d->normal));
    const struct vec3 slip = vec3_sub(vec3_scale(lever, rolled), d->tangential);
    return contact_is_skew(&s->shape) ? vec3_add(slip, skew_passing_along(s, change, d)) : slip;
}

struct vec3 friction_slopes_along(const struct friction_slopes *slopes, double normal_force, struct vec3 slip,
                                  struct vec3 spring)
{
    struct friction_slopes m = *slopes;
    const struct vec3 by_motion = vec3_add(matrix_times(m.by_slip, slip), matrix_times(m.by_spring, spring));
    return vec3_axpy(by_motion, normal_force, m.by_normal_force);
}

/* Returns the change of a spring's rate. The law's part changes by the change `motion` of the opposed motion
 * and by `stretched`, the change of the spring with what a change of k_t adds. The part of opposed_turned
 * changes with the spring and the normal. */
static struct vec3 spring_rate_along(const struct turning_slopes *s, enum opposed part, double normal_force,
                                     struct vec3 motion, struct vec3 spring, struct vec3 stretched,
                                     struct vec3 normal, struct vec3 normal_rate)
{
    const struct vec3 n = s->geometry.normal;
    const struct vec3 at = s->motion.spring[part];
    const struct vec3 own = friction_slopes_along(&s->spring_slopes[part], normal_force, motion, stretched);
    if (part == OPPOSED_SPINNING) {
        const double along = vec3_dot(spring, n) + vec3_dot(at, normal);
        return vec3_axpy(vec3_axpy(own, vec3_dot(at, n), normal_rate), along, s->normal_rate);
    }
    const double tilted = vec3_dot(spring, s->normal_rate) + vec3_dot(at, normal_rate);
    return vec3_axpy(vec3_axpy(own, -vec3_dot(at, s->normal_rate), normal), -tilted, n);
}

/* Adds the change of M, where n (n.omega) is the spinning part of omega. */
static void add_resistance(const struct turning_slopes *s, const struct turning_motion *change,
                           const struct geometry_change *d, struct vec3 normal_rate, double normal_force,
                           struct turning_change *out)
{
    const struct vec3 n = s->geometry.normal;
    const double more_along = vec3_dot(d->normal, s->spin) + vec3_dot(n, d->spin);
    const struct vec3 along = vec3_axpy(vec3_scale(vec3_dot(n, s->spin), d->normal), more_along, n);
    for (int i = 1; i < s->parts; ++i) {
        const struct vec3 motion = i == OPPOSED_SPINNING ? along : vec3_sub(d->spin, along);
        const struct vec3 more =
            friction_slopes_along(&s->force_slopes[i], normal_force, motion, change->spring[i]);
        out->source_torque = vec3_add(out->source_torque, more);
        out->destination_torque = vec3_sub(out->destination_torque, more);
        out->friction_power -= vec3_dot(more, s->opposed[i]) + vec3_dot(s->opposing[i], motion);
        out->spring_rate[i] = spring_rate_along(s, (enum opposed)i, normal_force, motion, change->spring[i],
                                                change->spring[i], d->normal, normal_rate);
    }
}

struct turning_change turning_slopes_along(const struct turning_slopes *s,
                                           const struct turning_motion *change)
{
    const struct geometry_change d = geometry_along(s, change);
    const double side = s->shape.side;
    const double gap = side * d.distance;
    const double gap_rate = side * d.along;
    const double normal_force = s->normal_slopes.by_gap * gap + s->normal_slopes.by_rate * gap_rate;
    const struct vec3 slip = slip_along(s, change, &d);
    /* a change of k_t acts as one of xi (friction.h) */
    const struct vec3 stretched = vec3_axpy(change->spring[0], -s->stiffening * gap, s->motion.spring[0]);
    const struct vec3 friction =
        friction_slopes_along(&s->force_slopes[OPPOSED_SLIP], normal_force, slip, stretched);

    struct turning_change out;
    const struct vec3 n = s->geometry.normal;
    out.force = vec3_axpy(vec3_axpy(friction, -side * normal_force, n), -side * s->normal_force, d.normal);

    const struct vec3 arm = contact_source_arm(&s->shape, n, contact_foot(&s->shape, s->motion.separation));
    const struct vec3 more_arm =
        contact_source_arm(&s->shape, d.normal, contact_foot_along(&s->shape, change->separation));
    out.source_torque = vec3_add(vec3_cross(more_arm, s->force), vec3_cross(arm, out.force));
    out.destination_torque = vec3_add(vec3_cross(vec3_sub(change->separation, more_arm), s->force),
                                      vec3_cross(vec3_sub(s->motion.separation, arm), out.force));

    const struct vec3 normal_rate = normal_rate_along(s, change, &d);
    out.spring_rate[OPPOSED_SLIP] = spring_rate_along(s, OPPOSED_SLIP, normal_force, slip, change->spring[0],
                                                      stretched, d.normal, normal_rate);

    out.dissipated_power = -(normal_force + s->bend * gap) * s->geometry.gap_rate -
                           (s->normal_force + s->stored_slope) * gap_rate;
    out.friction_power = -vec3_dot(friction, s->opposed[0]) - vec3_dot(s->opposing[0], slip);
    if (CONTACT_ANY_ROLLING) {
        add_resistance(s, change, &d, normal_rate, normal_force, &out);
    }
    return out;
}
