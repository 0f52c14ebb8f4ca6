#include "contact/friction_jet.h"

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

/* The limit of the regime. */
static void put_limit(const struct friction_law *law, enum friction_regime regime,
                      const struct friction_path *path, double limit[JET_TERMS])
{
    for (int i = 0; i < JET_TERMS; ++i) {
        limit[i] = regime == FRICTION_SLIDING ? law->coefficient * path->normal_force[i] : 0.0;
    }
    limit[0] = friction_limit(law, regime, path->normal_force[0]);
}

/* (1 - exp(-z))/z and its first two derivatives: by its series sum (-z)^k/(k + 1)! where differences would
 * cancel, of which 20 terms are exact to rounding up to one. */
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

static double scalar_term(const double *a, const double *b, int order)
{
    switch (order) {
    case 0:
        return a[0] * b[0];
    case 1:
        return a[0] * b[1] + a[1] * b[0];
    default:
        return a[0] * b[2] + a[1] * b[1] + a[2] * b[0];
    }
}

/* -L (1 - exp(-|v_t|/v_0))/|v_t| v_t */
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
        weight[i] = -scalar_term(limit, factor, i);
    }
    return jet_scale(weight, path->slip, order);
}

/* a/|a| */
static void put_direction(const struct vec3 a[JET_TERMS], struct vec3 unit[JET_TERMS])
{
    double length[JET_TERMS];
    jet_length(a, length);
    for (int i = 0; i < JET_TERMS; ++i) {
        unit[i] = vec3_make(0.0, 0.0, 0.0);
        if (length[0] > 0.0) {
            struct vec3 rest = a[i];
            for (int k = 1; k <= i; ++k) {
                rest = vec3_axpy(rest, -length[k], unit[i - k]);
            }
            unit[i] = vec3_scale(1.0 / length[0], rest);
        }
    }
}

struct vec3 friction_force_term(const struct friction_law *law, enum friction_regime regime,
                                const struct friction_path *path, int order)
{
    double limit[JET_TERMS];
    struct vec3 force[JET_TERMS];
    struct vec3 unit[JET_TERMS];
    if (law->kind == FRICTION_NONE || regime == FRICTION_LIFTED) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    put_limit(law, regime, path, limit);
    if (law->kind == FRICTION_REGULARIZED) {
        return regularized_term(law, path, limit, order);
    }
    for (int i = 0; i < JET_TERMS; ++i) {
        force[i] = vec3_axpy(vec3_scale(law->stiffness, path->spring[i]), law->damping, path->slip[i]);
    }
    if (regime == FRICTION_STICKING) {
        return vec3_scale(-1.0, force[order]);
    }
    put_direction(force, unit);
    return vec3_scale(-1.0, jet_scale(limit, unit, order));
}

double friction_stored_term(const struct friction_law *law, enum friction_regime regime,
                            const struct friction_path *path, int order)
{
    double limit[JET_TERMS];
    const bool slides = regime == FRICTION_SLIDING || regime == FRICTION_CAPPED;
    if (law->kind != FRICTION_ELASTIC) {
        return 0.0;
    }
    if (slides && law->damping == 0.0) { /* the spring is L / k_t long */
        put_limit(law, regime, path, limit);
        return 0.5 * scalar_term(limit, limit, order) / law->stiffness;
    }
    return 0.5 * law->stiffness * jet_dot(path->spring, path->spring, order);
}
