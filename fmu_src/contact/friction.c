#include <string.h>

#include "contact/friction.h"

#include "math/compiler.h"
#include "math/vec3.h"

/* This struct holds the length and the unit direction of a vector; a zero vector has the direction zero. The
 * components are divided by the length, because the inverse of a length near 1e-309 would overflow. */
struct direction {
    double length;
    struct vec3 unit;
};

static struct direction direction_of(struct vec3 a)
{
    const double length = vec3_norm(a);
    const struct vec3 zero = {0.0, 0.0, 0.0};
    return (struct direction){length,
                              length > 0.0 ? vec3_make(a.x / length, a.y / length, a.z / length) : zero};
}

/* Sets the rows of along u u^T + across (I - u u^T). */
static void set_axial(struct vec3 row[3], struct vec3 u, double along, double across)
{
    for (int i = 0; i < 3; ++i) {
        row[i] = vec3_scale((along - across) * vec3_get(u, i), u);
        *vec3_part(&row[i], i) += across;
    }
}

/* Whether k_t follows the penetration; a compile-time false in builds without this law (ContactFmu.cmake). */
static bool follows_depth(const struct friction_law *law)
{
    return CONTACT_ANY_MINDLIN && law->tangential == TANGENTIAL_LAW_MINDLIN;
}

double friction_stiffness(const struct friction_law *law, double depth)
{
    return follows_depth(law) ? law->stiffness * sqrt(fmax(depth, FRICTION_LEAST_DEPTH)) : law->stiffness;
}

double friction_stiffening(const struct friction_law *law, double depth)
{
    return follows_depth(law) && depth > FRICTION_LEAST_DEPTH ? 0.5 / depth : 0.0;
}

/* Returns F* [N]. */
static struct vec3 carried(const struct friction_law *law, struct friction_state at)
{
    return vec3_axpy(vec3_scale(friction_stiffness(law, at.depth), at.spring), law->damping, at.slip);
}

double friction_limit(const struct friction_law *law, enum friction_regime regime, double normal_force)
{
    return regime == FRICTION_STICKING ? fmin(law->static_coefficient * fmax(normal_force, 0.0), law->largest)
           : regime == FRICTION_SLIDING ? law->coefficient * normal_force
           : regime == FRICTION_CAPPED  ? law->largest
                                        : 0.0;
}

/* Returns dL/dF_n [1] of a sliding contact. */
static double limit_slope(const struct friction_law *law, enum friction_regime regime)
{
    return regime == FRICTION_SLIDING ? law->coefficient : 0.0;
}

enum friction_regime friction_sliding_regime(const struct friction_law *law, double normal_force)
{
    if (!(normal_force > 0.0)) {
        return FRICTION_LIFTED;
    }
    return law->coefficient * normal_force > law->largest ? FRICTION_CAPPED : FRICTION_SLIDING;
}

/* Under Hertz's law F_n grows with the power 1.5 of time after the touch, and so does the spring's part of F*
 * where k_t follows the depth: it is k_t |v_t| t, while L is L' t / 1.5. */
static const double ONSET_POWER = 1.5;

/* Where F_n jumps to a positive value at the touch, friction sticks if the dashpot's part of F* is below the
 * limit. Where F_n grows from zero, friction sticks if the dashpot's part is zero and the limit grows at
 * least as fast as the spring's part. With mu_s = 0 it slides. */
enum friction_regime friction_onset_regime(const struct friction_law *law, struct friction_state at,
                                           double normal_force_rate)
{
    const double speed = vec3_norm(at.slip);
    const bool begins_loaded = at.normal_force > 0.0;
    const double limit = friction_limit(law, FRICTION_STICKING, at.normal_force);
    const bool touches = at.depth_rate >= 0.0; /* otherwise F_n grows again during a rebound */
    const double power = follows_depth(law) && touches ? ONSET_POWER : 1.0;
    const bool holds =
        begins_loaded ? law->damping * speed < limit
                      : law->damping * speed == 0.0 && power * friction_stiffness(law, at.depth) * speed <=
                                                           law->static_coefficient * normal_force_rate;
    if (law->kind == FRICTION_ELASTIC && holds && law->static_coefficient > 0.0) {
        return FRICTION_STICKING;
    }
    return begins_loaded ? friction_sliding_regime(law, at.normal_force) : FRICTION_SLIDING;
}

/* F_t = -f(|w|, L) w / |w|, where w is the slip of regularized friction and F* of elastic friction. A change
 * of w changes F_t by -`across` times its part across w and by -`along` times its part along w; a change of L
 * changes F_t by -`by_limit` w / |w| times itself. */
struct radial_force {
    struct vec3 force, unit;        /* F_t [N] and w / |w| [1] */
    double across, along, by_limit; /* f / |w|, df/d|w|, df/dL */
    double by_slip, by_spring;      /* the changes of w with the slip and with the spring */
};

static struct radial_force radial_force_of(const struct friction_law *law, enum friction_regime regime,
                                           struct friction_state at)
{
    const double limit = friction_limit(law, regime, at.normal_force);
    if (law->kind == FRICTION_NONE || regime == FRICTION_LIFTED) {
        return (struct radial_force){.across = 0.0};
    }
    if (law->kind == FRICTION_REGULARIZED) {
        const struct direction v = direction_of(at.slip);
        const double v_0 = law->slip_velocity;
        const double z = v.length / v_0;
        const double part = -expm1(-z);
        const double across = limit * (z > 0.0 ? part / z : 1.0) / v_0;
        return (struct radial_force){
            vec3_scale(-across, at.slip), v.unit, across, limit * (1.0 - part) / v_0, part, 1.0, 0.0};
    }
    const double stiffness = friction_stiffness(law, at.depth);
    const struct vec3 pull = carried(law, at);
    const struct direction f = direction_of(pull);
    if (regime == FRICTION_STICKING) {
        return (struct radial_force){vec3_scale(-1.0, pull), f.unit, 1.0, 1.0, 0.0, law->damping, stiffness};
    }
    const double across = f.length > 0.0 ? limit / f.length : 0.0;
    return (struct radial_force){
        vec3_scale(-limit, f.unit), f.unit, across, 0.0, 1.0, law->damping, stiffness};
}

struct vec3 friction_force(const struct friction_law *law, enum friction_regime regime,
                           struct friction_state at)
{
    return radial_force_of(law, regime, at).force;
}

struct vec3 opposed_turned(enum opposed part, struct vec3 spring, struct vec3 normal, struct vec3 normal_rate)
{
    return part == OPPOSED_SPINNING ? vec3_scale(vec3_dot(spring, normal), normal_rate)
                                    : vec3_scale(-vec3_dot(spring, normal_rate), normal);
}

struct vec3 opposed_laid(enum opposed part, struct vec3 spring, struct vec3 normal)
{
    const struct vec3 along = vec3_scale(vec3_dot(spring, normal), normal);
    return part == OPPOSED_SPINNING ? along : vec3_sub(spring, along);
}

bool friction_has_spring(const struct friction_law *law, enum friction_regime regime)
{
    return law->kind == FRICTION_ELASTIC && (regime != FRICTION_LIFTED || law->damping > 0.0);
}

struct vec3 friction_spring(const struct friction_law *law, enum friction_regime regime,
                            struct friction_state at)
{
    if (!friction_has_spring(law, regime)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    if (regime == FRICTION_STICKING || law->damping > 0.0) {
        return at.spring;
    }
    const double length = friction_limit(law, regime, at.normal_force) / friction_stiffness(law, at.depth);
    return vec3_scale(length, direction_of(at.spring).unit);
}

/* Friction rolls below this part of its limit, at 3 v_0 of slip. Above it the slip is a steep function of the
 * force, and the force a flat one of the slip. */
static const double MOST_OF_ROLLING = 0.95;

/* A rolling force is shortened to this part of the limit, where psi is 7 v_0. */
static const double LARGEST_PART = 0.999;

bool friction_rolls(const struct friction_law *law, enum friction_regime regime, double normal_force,
                    struct vec3 force, double admittance)
{
    const double limit = friction_limit(law, regime, normal_force);
    return law->kind == FRICTION_REGULARIZED && vec3_norm(force) < MOST_OF_ROLLING * limit &&
           admittance * limit > law->slip_velocity;
}

struct friction_missed friction_missed(const struct friction_law *law, enum friction_regime regime,
                                       struct friction_state at, struct vec3 *force, bool rolls,
                                       double admittance, struct friction_slopes *slopes)
{
    const double limit = friction_limit(law, regime, at.normal_force);
    if (!(rolls && limit > 0.0)) {
        const struct radial_force by = radial_force_of(law, regime, at);
        if (slopes) {
            const double slip = admittance * by.by_slip;
            const double spring = admittance * by.by_spring;
            set_axial(slopes->by_force, by.unit, admittance, admittance);
            set_axial(slopes->by_slip, by.unit, slip * by.along, slip * by.across);
            set_axial(slopes->by_spring, by.unit, spring * by.along, spring * by.across);
            slopes->by_normal_force =
                vec3_scale(admittance * limit_slope(law, regime) * by.by_limit, by.unit);
        }
        return (struct friction_missed){vec3_scale(admittance, vec3_sub(*force, by.force)), 0.0};
    }
    const double whole = vec3_norm(*force) / limit;
    const double part = fmin(whole, LARGEST_PART);
    *force = whole > LARGEST_PART ? vec3_scale(LARGEST_PART / whole, *force) : *force;
    const double per_force = law->slip_velocity / limit;
    const double across = part > 0.0 ? -log1p(-part) / part * per_force : per_force;
    const double steepness = per_force / (1.0 - part);
    if (slopes) {
        const struct vec3 unit = direction_of(*force).unit;
        memset(slopes, 0, sizeof *slopes);
        set_axial(slopes->by_force, unit, steepness, across);
        set_axial(slopes->by_slip, unit, 1.0, 1.0);
        slopes->by_normal_force = vec3_scale(-limit_slope(law, regime) * steepness * part, unit);
    }
    return (struct friction_missed){vec3_axpy(at.slip, across, *force), steepness};
}

struct friction_spring_drive friction_spring_drive_of(const struct friction_law *law,
                                                      enum friction_regime regime, struct friction_state at)
{
    struct friction_spring_drive drive = {.is_force = false};
    if (!friction_has_spring(law, regime)) {
        return drive;
    }
    if (regime == FRICTION_STICKING) {
        drive.along = drive.across = 1.0;
    } else if (law->damping > 0.0) {
        drive.is_force = true;
        drive.decay = friction_stiffness(law, at.depth) / law->damping;
        drive.along = drive.across = -1.0 / law->damping;
    } else { /* the part of the slip across xi turns the spring, and keeps its length */
        const struct direction xi = direction_of(at.spring);
        const double limit = friction_limit(law, regime, at.normal_force);
        const double reach = friction_stiffness(law, at.depth) * xi.length;
        const double floor = FRICTION_LEAST_LENGTH * reach;
        const double square = limit * limit + floor * floor;
        drive.unit = xi.unit;
        drive.across = square > 0.0 ? reach * limit / square : 0.0;
        drive.decay =
            xi.length > 0.0 ? fmax(drive.across / xi.length * vec3_dot(at.slip, xi.unit), 0.0) : 0.0;
    }
    return drive;
}

struct vec3 friction_driven(const struct friction_spring_drive *drive, struct vec3 z)
{
    const double along = (drive->along - drive->across) * vec3_dot(drive->unit, z);
    return vec3_axpy(vec3_scale(drive->across, z), along, drive->unit);
}

struct vec3 friction_spring_rate(const struct friction_law *law, enum friction_regime regime,
                                 struct friction_state at, struct vec3 force)
{
    const struct friction_spring_drive drive = friction_spring_drive_of(law, regime, at);
    const struct vec3 rate = friction_driven(&drive, drive.is_force ? force : at.slip);
    return drive.is_force ? vec3_axpy(rate, -drive.decay, at.spring) : rate;
}

bool friction_compares_forces(const struct friction_law *law, enum friction_regime regime)
{
    return regime == FRICTION_STICKING || law->damping > 0.0;
}

double friction_stick_event(const struct friction_law *law, enum friction_regime regime,
                            struct friction_state at, double normal_force_rate)
{
    if (law->kind != FRICTION_ELASTIC || regime == FRICTION_LIFTED) {
        return 1.0;
    }
    const double limit = friction_limit(law, regime, at.normal_force);
    const struct direction f = direction_of(carried(law, at));
    if (regime == FRICTION_STICKING) {
        return law->static_coefficient * fmax(at.normal_force, 0.0) - f.length;
    }
    if (law->coefficient == 0.0 || (limit == 0.0 && normal_force_rate == 0.0)) {
        return 1.0; /* with mu = 0, or with a normal force that stays zero, sliding never ends */
    }
    if (law->damping > 0.0) {
        return f.length - limit;
    }
    /* (L / k_t)' is the rate of the length of the spring; at the touch L / k_t is proportional to delta */
    const double stiffening = friction_stiffening(law, at.depth);
    const double power = follows_depth(law) && stiffening == 0.0 ? ONSET_POWER : 1.0;
    const double limit_rate = limit_slope(law, regime) * normal_force_rate / power;
    const double by_depth = limit * stiffening * at.depth_rate;
    return vec3_dot(at.slip, f.unit) - (limit_rate - by_depth) / friction_stiffness(law, at.depth);
}

double friction_cap_event(const struct friction_law *law, enum friction_regime regime,
                          struct friction_state at)
{
    const double room = law->largest - law->coefficient * at.normal_force;
    if (law->kind == FRICTION_NONE || regime == FRICTION_LIFTED) {
        return 1.0;
    }
    return regime == FRICTION_STICKING  ? law->largest - vec3_norm(carried(law, at))
           : regime == FRICTION_SLIDING ? room
                                        : -room;
}
