#include "math/rotor.h"

/* 2 pi to 160 digits of two: three doubles that do not overlap. */
static const double TURN[3] = {0x1.921fb54442d18p+2, 0x1.1a62633145c07p-52, -0x1.f1976b7ed8fbcp-108};

/* Beyond so many turns not even twice the digits tell the angle: it is zero then. */
static const double TOO_MANY_TURNS = 1e30;

struct sine_cosine {
    double sine, cosine;
};

static struct double_double add_times(struct double_double sum, double a, double b)
{
    return double_double_add(sum, double_double_product(a, b));
}

/* The angle without its whole turns. Each round leaves half a turn and what rounding of the number of turns
 * left: three are enough for all digits that there are. */
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

/* Of rate times factor times time; `rate` in 1/unit. */
static struct sine_cosine sine_cosine_after(const struct rotor *rotor, struct double_double rate,
                                            double factor, double time)
{
    const double scaled = factor * (time / rotor->unit);
    /* an angle that overflows is beyond all digits, and so is a product of halves that does */
    const double rough = rate.high * scaled;
    if (!(fabs(rough) < TOO_MANY_TURNS) || !(fabs(scaled) < 1e290)) {
        return (struct sine_cosine){0.0, 1.0};
    }
    const struct double_double angle = without_turns(double_double_times(rate, scaled));
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
    axis[2] = double_double_add(along, double_double_negative(across));
    for (int i = 0; i < 3; ++i) {
        axis[i] = double_double_divide(axis[i], squared);
    }
}

/* A power of two near the size of a, so that products of what is divided by it keep their digits. */
static double power_of_two_near(double a)
{
    int exponent = 0;
    (void)frexp(a, &exponent);
    return a > 0.0 && isfinite(a) ? ldexp(1.0, exponent) : 1.0;
}

struct rotor rotor_from(struct rotor_state start, double transverse_inertia, double axial_inertia)
{
    struct rotor rotor = {.start = start, .direction = {0.0, 0.0, 1.0}};
    const double size = power_of_two_near(vec3_max_abs(start.angular_velocity));
    rotor.unit = 1.0 / size;
    struct double_double axis[3];
    third_axis(start.orientation, axis);
    rotor.axis = vec3_make(axis[0].high, axis[1].high, axis[2].high);

    const double inertia = power_of_two_near(transverse_inertia);
    const double transverse = transverse_inertia / inertia;
    const struct double_double excess = double_double_sum(axial_inertia / inertia, -transverse);
    const struct double_double ratio = double_double_divide(excess, (struct double_double){transverse, 0.0});
    struct double_double along = {0.0, 0.0}; /* omega_3 */
    for (int i = 0; i < 3; ++i) {
        along = double_double_add(along,
                                  double_double_times(axis[i], vec3_get(start.angular_velocity, i) / size));
    }
    const struct double_double spin = double_double_negative(double_double_multiply(ratio, along));
    struct double_double precession[3];
    struct double_double squared = {0.0, 0.0};
    for (int i = 0; i < 3; ++i) {
        const struct double_double omega = {vec3_get(start.angular_velocity, i) / size, 0.0};
        precession[i] =
            double_double_add(omega, double_double_negative(double_double_multiply(spin, axis[i])));
        squared = double_double_add(squared, double_double_multiply(precession[i], precession[i]));
    }
    rotor.spin = spin;
    rotor.precession = double_double_root(squared);
    if (rotor.precession.high > 0.0) {
        for (int i = 0; i < 3; ++i) {
            vec3_set(&rotor.direction, i, double_double_divide(precession[i], rotor.precession).high);
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

struct rotor_state rotor_at(const struct rotor *rotor, double time)
{
    /* half angles, reduced by whole turns of their own: the sign of the quaternion follows */
    const struct sine_cosine round = sine_cosine_after(rotor, rotor->precession, 0.5, time);
    const struct sine_cosine about = sine_cosine_after(rotor, rotor->spin, 0.5, time);
    const struct quaternion first = quaternion_make(about.cosine, vec3_make(0.0, 0.0, about.sine));
    const struct quaternion last = quaternion_make(round.cosine, vec3_scale(round.sine, rotor->direction));
    const struct quaternion middle = quaternion_product(rotor->start.orientation, first);
    const struct sine_cosine whole = {2.0 * round.sine * round.cosine, 1.0 - 2.0 * round.sine * round.sine};
    return (struct rotor_state){quaternion_unit(quaternion_product(last, middle)),
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
