#include "math/rotor_series.h"

/*
 * Coefficient n of the series in t/step is at most exp(a)/8^n, where a is the angle that the sizes of
 * lambda's terms would turn by in 8 steps (Cauchy's bound). With a <= 8, of a constant lambda a step of one
 * radian, what follows 21 terms is below exp(8)/8^22 = 4e-17 of a rotation.
 */
enum { ROTOR_TERMS = 21 };
static const double ROTOR_REACH = 8.0;

void rotor_rates_shift(struct vec3 *coefficient, int count, double time)
{
    for (int first = 0; first < count - 1; ++first) {
        for (int i = count - 2; i >= first; --i) {
            coefficient[i] = vec3_axpy(coefficient[i], time, coefficient[i + 1]);
        }
    }
}

/* I_1 omega + (I_3 - I_1) omega_3 e_3, over I_1 */
static struct vec3 rate_of_momentum(const struct rotor_state *start, double transverse_inertia,
                                    double axial_inertia)
{
    const struct vec3 axis = quaternion_third_axis(start->orientation);
    const double ratio = (axial_inertia - transverse_inertia) / transverse_inertia;
    return vec3_axpy(start->angular_velocity, ratio * vec3_dot(start->angular_velocity, axis), axis);
}

void rotor_rates_under_torque(const struct rotor_state *start, double transverse_inertia,
                              double axial_inertia, const struct vec3 torque[ROTOR_TORQUES],
                              struct vec3 lambda[ROTOR_RATES])
{
    lambda[0] = rate_of_momentum(start, transverse_inertia, axial_inertia);
    for (int i = 0; i < ROTOR_TORQUES; ++i) {
        lambda[i + 1] = vec3_scale(1.0 / ((i + 1) * transverse_inertia), torque[i]);
    }
}

/* The longest such step, from `left` down. */
static double step_of(const struct vec3 lambda[ROTOR_RATES], double left)
{
    double size[ROTOR_RATES];
    for (int i = 0; i < ROTOR_RATES; ++i) {
        size[i] = vec3_norm(lambda[i]);
    }
    double step = left;
    for (;;) {
        double angle = 0.0;
        for (int i = ROTOR_RATES - 1; i >= 0; --i) {
            angle = ROTOR_REACH * step * (size[i] / (i + 1) + angle);
        }
        if (!(angle > ROTOR_REACH)) {
            return step;
        }
        step *= fmax(0.999 * ROTOR_REACH / angle, 0.5); /* the angle grows no slower than the step */
    }
}

/* Terms of e_3 in powers of t/step: (n + 1) e_(n+1) = sum_i step^(i+1) lambda_i x e_(n-i). */
static struct vec3 axis_terms(const struct vec3 lambda[ROTOR_RATES], double step,
                              struct vec3 term[ROTOR_TERMS + 1])
{
    struct vec3 end = term[0];
    for (int n = 0; n < ROTOR_TERMS; ++n) {
        struct vec3 sum = {0.0, 0.0, 0.0};
        double power = step;
        for (int i = 0; i < ROTOR_RATES && i <= n; ++i) {
            sum = vec3_axpy(sum, power, vec3_cross(lambda[i], term[n - i]));
            power *= step;
        }
        term[n + 1] = vec3_scale(1.0 / (n + 1), sum);
        end = vec3_add(end, term[n + 1]);
    }
    return vec3_scale(1.0 / vec3_norm(end), end);
}

struct vec3 rotor_axis_after(const struct vec3 lambda[ROTOR_RATES], struct vec3 axis, double time)
{
    struct vec3 rate[ROTOR_RATES] = {lambda[0], lambda[1], lambda[2], lambda[3]};
    for (double left = time; left > 0.0;) {
        const double step = step_of(rate, left);
        struct vec3 term[ROTOR_TERMS + 1] = {axis};
        axis = axis_terms(rate, step, term);
        rotor_rates_shift(rate, ROTOR_RATES, step);
        left -= step;
    }
    return axis;
}

/* The orientation turned by lambda: (n + 1) q_(n+1) = sum_i step^(i+1) (0, lambda_i) q_(n-i) / 2. */
static struct quaternion turned_by_series(const struct vec3 lambda[ROTOR_RATES], double step,
                                          struct quaternion q)
{
    struct quaternion term[ROTOR_TERMS + 1] = {q};
    for (int n = 0; n < ROTOR_TERMS; ++n) {
        struct quaternion sum = {0.0, 0.0, 0.0, 0.0};
        double power = step;
        for (int i = 0; i < ROTOR_RATES && i <= n; ++i) {
            sum = quaternion_axpy(sum, power, quaternion_rate(term[n - i], lambda[i]));
            power *= step;
        }
        term[n + 1] = quaternion_scale(1.0 / (n + 1), sum);
        q = quaternion_axpy(q, 1.0, term[n + 1]);
    }
    return quaternion_unit(q);
}

/* How omega_3 grows in a step, and its integral: tau.e_3 / I_3 is a product of series. */
static double spin_grown(const struct vec3 torque[ROTOR_TORQUES], double axial_inertia,
                         const struct vec3 term[ROTOR_TERMS + 1], double step, double *integral)
{
    double grown = 0.0;
    for (int n = 0; n < ROTOR_TERMS; ++n) {
        double sum = 0.0;
        double power = step / axial_inertia;
        for (int i = 0; i < ROTOR_TORQUES && i <= n; ++i) {
            sum += power * vec3_dot(torque[i], term[n - i]);
            power *= step;
        }
        grown += sum / (n + 1);
        *integral += step * sum / ((n + 1) * (n + 2));
    }
    return grown;
}

struct rotor_state rotor_under_torque(const struct rotor_state *start, double transverse_inertia,
                                      double axial_inertia, const struct vec3 torque[ROTOR_TORQUES],
                                      double time)
{
    struct rotor_state now = *start;
    struct vec3 lambda[ROTOR_RATES];
    struct vec3 moment[ROTOR_TORQUES] = {torque[0], torque[1], torque[2]};
    rotor_rates_under_torque(start, transverse_inertia, axial_inertia, torque, lambda);
    const double ratio = (transverse_inertia - axial_inertia) / transverse_inertia;
    struct vec3 axis = quaternion_third_axis(now.orientation);
    double spin = vec3_dot(now.angular_velocity, axis);
    for (double left = time; left > 0.0;) {
        const double step = step_of(lambda, left);
        struct vec3 term[ROTOR_TERMS + 1] = {axis};
        (void)axis_terms(lambda, step, term);
        double turned = step * spin;
        spin += spin_grown(moment, axial_inertia, term, step, &turned);
        const struct quaternion about = quaternion_of_rotation(vec3_make(0.0, 0.0, ratio * turned));
        now.orientation = quaternion_product(turned_by_series(lambda, step, now.orientation), about);
        axis = quaternion_third_axis(now.orientation);
        rotor_rates_shift(lambda, ROTOR_RATES, step);
        rotor_rates_shift(moment, ROTOR_TORQUES, step);
        left -= step;
    }
    /* omega = L/I_1 + (1 - I_3/I_1) omega_3 e_3 */
    now.angular_velocity = vec3_axpy(lambda[0], ratio * spin, axis);
    return now;
}
