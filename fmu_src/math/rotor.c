#include "math/rotor.h"

/* 2 pi to 160 digits of two: three doubles that do not overlap. */
static const double TURN[3] = {0x1.921fb54442d18p+2, 0x1.1a62633145c07p-52, -0x1.f1976b7ed8fbcp-108};

/* Beyond so many turns not even twice the digits tell an angle. It then counts as zero, and so does an angle
 * that overflows. */
static const double TOO_MANY_TURNS = 1e30;

struct sine_cosine {
    double sine, cosine;
};

static struct double_double add_times(struct double_double sum, double a, double b)
{
    return double_double_add(sum, double_double_product(a, b));
}

/* Returns the angle without its whole turns. Each round leaves half a turn and the rounding error of the
 * number of turns; three rounds are enough for all digits. */
static struct double_double without_turns(struct double_double angle)
{
    if (!(fabs(angle.high) < TOO_MANY_TURNS)) {
        return (struct double_double){0.0, 0.0};
    }
    for (int i = 0; i < 3 && fabs(angle.high) > 0.5 * TURN[0]; ++i) {
        const double turns = floor(angle.high / TURN[0] + 0.5);
        for (int j = 0; j < 3; ++j) {
            angle = add_times(angle, -turns, TURN[j]);
        }
    }
    return angle;
}

/* Returns the sine and cosine of rate times factor times time; `rate` is in 1/unit. */
static struct sine_cosine sine_cosine_after(const struct rotor *rotor, struct double_double rate,
                                            double factor, double time)
{
    const struct double_double scaled = {factor * (time / rotor->unit), 0.0};
    const struct double_double angle = without_turns(double_double_multiply(rate, scaled));
    const double sine = sin(angle.high);
    const double cosine = cos(angle.high);
    return (struct sine_cosine){sine + angle.low * cosine, cosine - angle.low * sine};
}

/* e_3 of a quaternion that is unit to rounding, with twice the digits: of its direction alone. */
static void third_axis(struct quaternion q, struct double_double axis[3])
{
    const struct double_double ww = double_double_product(q.w, q.w);
    const struct double_double xx = double_double_product(q.x, q.x);
    const struct double_double yy = double_double_product(q.y, q.y);
    const struct double_double zz = double_double_product(q.z, q.z);
    const struct double_double along = double_double_add(ww, zz);
    const struct double_double across = double_double_add(xx, yy);
    const struct double_double squared = double_double_add(along, across);
    axis[0] = add_times(double_double_product(2.0 * q.x, q.z), 2.0 * q.w, q.y);
    axis[1] = add_times(double_double_product(2.0 * q.y, q.z), -2.0 * q.w, q.x);
    axis[2] = double_double_subtract(along, across);
    for (int i = 0; i < 3; ++i) {
        axis[i] = double_double_divide(axis[i], squared);
    }
}

/* Returns a power of two near the size of a. Numbers divided by it are near 1, and their products neither
 * overflow nor lose digits. */
static double power_of_two_near(double a)
{
    int exponent = 0;
    (void)frexp(a, &exponent);
    return a > 0.0 && isfinite(a) ? ldexp(1.0, exponent) : 1.0;
}

struct rotor rotor_from(struct body_turn start, double transverse_inertia, double axial_inertia)
{
    struct rotor rotor = {.start = start, .direction = {0.0, 0.0, 1.0}};
    const double size = power_of_two_near(vec3_max_abs(start.angular_velocity));
    rotor.unit = 1.0 / size;
    struct double_double axis[3];
    third_axis(start.orientation, axis);
    rotor.axis = vec3_make(axis[0].high, axis[1].high, axis[2].high);

    const double inertia = power_of_two_near(transverse_inertia);
    const double transverse = transverse_inertia / inertia;
    const struct double_double excess = double_double_sum(transverse, -axial_inertia / inertia);
    const struct double_double ratio = double_double_divide(excess, (struct double_double){transverse, 0.0});
    struct double_double omega[3], precession[3];
    struct double_double along = {0.0, 0.0}; /* omega_3 */
    for (int i = 0; i < 3; ++i) {
        omega[i] = (struct double_double){vec3_get(start.angular_velocity, i) / size, 0.0};
        along = double_double_add(along, double_double_multiply(axis[i], omega[i]));
    }
    const struct double_double spin = double_double_multiply(ratio, along);
    struct double_double squared = {0.0, 0.0};
    for (int i = 0; i < 3; ++i) {
        precession[i] = double_double_subtract(omega[i], double_double_multiply(spin, axis[i]));
        squared = double_double_add(squared, double_double_multiply(precession[i], precession[i]));
    }
    rotor.spin = spin;
    rotor.precession = double_double_root(squared);
    if (rotor.precession.high > 0.0) {
        for (int i = 0; i < 3; ++i) {
            *vec3_part(&rotor.direction, i) = double_double_divide(precession[i], rotor.precession).high;
        }
    }
    return rotor;
}

/* a turned about the unit vector u: a + sin u x a + (1 - cos) u x (u x a). */
static struct vec3 turned_about(struct vec3 u, struct sine_cosine by, struct vec3 a)
{
    const struct vec3 once = vec3_cross(u, a);
    const double versine =
        by.cosine > 0.0 ? by.sine * by.sine / (1.0 + by.cosine) : 1.0 - by.cosine; /* without cancellation */
    return vec3_axpy(vec3_axpy(a, by.sine, once), versine, vec3_cross(u, once));
}

struct body_turn rotor_at(const struct rotor *rotor, double time)
{
    /* half angles, reduced by whole turns of their own: the sign of the quaternion follows */
    const struct sine_cosine round = sine_cosine_after(rotor, rotor->precession, 0.5, time);
    const struct sine_cosine about = sine_cosine_after(rotor, rotor->spin, 0.5, time);
    const struct quaternion first = quaternion_make(about.cosine, vec3_make(0.0, 0.0, about.sine));
    const struct quaternion last = quaternion_make(round.cosine, vec3_scale(round.sine, rotor->direction));
    const struct quaternion middle = quaternion_product(rotor->start.orientation, first);
    const struct sine_cosine whole = {2.0 * round.sine * round.cosine, 1.0 - 2.0 * round.sine * round.sine};
    return (struct body_turn){quaternion_unit(quaternion_product(last, middle)),
                              turned_about(rotor->direction, whole, rotor->start.angular_velocity)};
}

struct rotor_axis rotor_axis_at(const struct rotor *rotor, double time)
{
    const struct sine_cosine round = sine_cosine_after(rotor, rotor->precession, 1.0, time);
    const struct vec3 axis = turned_about(rotor->direction, round, rotor->axis);
    return (struct rotor_axis){axis, vec3_scale(rotor_precession(rotor), vec3_cross(rotor->direction, axis))};
}

double rotor_precession(const struct rotor *rotor)
{
    return rotor->precession.high / rotor->unit;
}

double rotor_axis_speed(const struct rotor *rotor)
{
    return rotor_precession(rotor) * vec3_norm(vec3_cross(rotor->direction, rotor->axis));
}

enum { ROTOR_TERMS = 21 };

static struct vec3 quotient(struct vec3 a, struct vec3 by)
{
    return vec3_make(a.x / by.x, a.y / by.y, a.z / by.z);
}

/* Terms of l, of omega and of q in powers of time / unit, and of u = q* tau. */
struct three_terms {
    struct vec3 momentum[ROTOR_TERMS + 1], omega[ROTOR_TERMS + 1];
    struct quaternion q[ROTOR_TERMS + 1], u[ROTOR_TERMS + 1];
};

/* Sets the terms after the first ones. */
static void put_three_terms(struct three_terms *t, struct vec3 inertia,
                            const struct vec3 torque[ROTOR_TORQUES], double unit)
{
    for (int n = 0; n < ROTOR_TERMS; ++n) {
        struct vec3 grown = {0.0, 0.0, 0.0};
        struct quaternion turned = {0.0, 0.0, 0.0, 0.0};
        double power = 1.0;
        t->u[n] = turned;
        for (int i = 0; i < ROTOR_TORQUES && i <= n; ++i) {
            const struct quaternion tau = quaternion_make(0.0, vec3_scale(power, torque[i]));
            t->u[n] = quaternion_axpy(t->u[n], 1.0, quaternion_product(quaternion_inverse(t->q[n - i]), tau));
            power *= unit;
        }
        for (int i = 0; i <= n; ++i) {
            const struct quaternion by = quaternion_make(0.0, vec3_scale(0.5, t->omega[i]));
            grown = vec3_add(grown, vec3_cross(t->momentum[n - i], t->omega[i]));
            grown = vec3_add(grown, quaternion_vector(quaternion_product(t->u[n - i], t->q[i])));
            turned = quaternion_axpy(turned, 1.0, quaternion_product(t->q[n - i], by));
        }
        t->momentum[n + 1] = vec3_scale(unit / (n + 1), grown);
        t->omega[n + 1] = quotient(t->momentum[n + 1], inertia);
        t->q[n + 1] = quaternion_scale(unit / (n + 1), turned);
    }
}

/* The last terms of q may have this size at the end of a step, which is less than rounding. */
static const double LAST_TERM = 1e-18;

/* Returns the longest step, at most `left`, at whose end the last two terms of q are small. */
static double three_step(const struct three_terms *t, double unit, double left)
{
    double step = left;
    for (int n = ROTOR_TERMS - 1; n <= ROTOR_TERMS; ++n) {
        const double size = sqrt(quaternion_dot(t->q[n], t->q[n]));
        step = size > 0.0 ? fmin(step, unit * pow(LAST_TERM / size, 1.0 / n)) : step;
    }
    return step;
}

struct body_turn rotor_of_three_after(const struct body_turn *start, struct vec3 inertia,
                                      const struct vec3 torque[ROTOR_TORQUES], double time)
{
    struct quaternion q = start->orientation;
    struct vec3 moment[ROTOR_TORQUES] = {torque[0], torque[1], torque[2]};
    struct vec3 omega = quaternion_rotate(quaternion_inverse(q), start->angular_velocity);
    struct vec3 momentum = quaternion_rotate(
        q, vec3_make(inertia.x * omega.x, inertia.y * omega.y, inertia.z * omega.z)); /* L, in the world */
    const double least = fmin(inertia.x, fmin(inertia.y, inertia.z));
    double before = (double)INFINITY;
    for (double left = time; left > 0.0 && left < before;) { /* where a step is rounding beside the rest */
        const struct vec3 in_body = quaternion_rotate(quaternion_inverse(q), momentum);
        const double rate = vec3_norm(in_body) / least + sqrt(vec3_norm(moment[0]) / least) +
                            cbrt(vec3_norm(moment[1]) / least) + sqrt(sqrt(vec3_norm(moment[2]) / least));
        const double unit = fmin(left, rate > 0.0 ? 1.0 / rate : left);
        struct three_terms t = {.momentum = {in_body}, .omega = {quotient(in_body, inertia)}, .q = {q}};
        put_three_terms(&t, inertia, moment, unit);
        const double step = three_step(&t, unit, left);
        const double part = step / unit;
        q = t.q[ROTOR_TERMS];
        for (int n = ROTOR_TERMS - 1; n >= 0; --n) {
            q = quaternion_axpy(t.q[n], part, q);
        }
        q = quaternion_unit(q);
        for (int i = ROTOR_TORQUES - 1; i >= 0; --i) {
            momentum = vec3_axpy(momentum, pow(step, i + 1) / (i + 1), moment[i]);
        }
        path_shift(moment, ROTOR_TORQUES, step);
        before = left;
        left -= step;
    }
    omega = quotient(quaternion_rotate(quaternion_inverse(q), momentum), inertia);
    return (struct body_turn){q, quaternion_rotate(q, omega)};
}

struct quaternion rotor_turned_after(const struct vec3 omega[ROTOR_TORQUES], struct quaternion q, double time)
{
    const struct body_turn start = {q, omega[0]};
    const struct vec3 torque[ROTOR_TORQUES] = {omega[1], vec3_scale(2.0, omega[2])};
    return rotor_of_three_after(&start, vec3_make(1.0, 1.0, 1.0), torque, time).orientation;
}
