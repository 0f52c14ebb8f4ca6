#include <string.h>

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
    double factorial = 51090942171709440000.0; /* 21!, exact as all smaller ones */
    if (z >= 1.0) {
        const double e = exp(-z);
        out[0] = -expm1(-z) / z;
        out[1] = (e * (1.0 + z) - 1.0) / (z * z);
        out[2] = (2.0 - e * (2.0 + z * (2.0 + z))) / (z * z * z);
        return;
    }
    out[0] = out[1] = out[2] = 0.0;
    for (int k = TERMS; k >= 0; --k) {
        out[2] = out[2] * z + out[1];
        out[1] = out[1] * z + out[0];
        out[0] = out[0] * z + (k % 2 ? -1.0 : 1.0) / factorial;
        factorial /= k + 1;
    }
    out[2] *= 2.0; /* Horner's scheme gives derivatives over factorials */
}

/* Sets the series of regularized friction, F_t = -L (1 - exp(-|v_t|/v_0))/|v_t| v_t. */
static void put_regularized(const struct friction_law *law, const struct friction_path *path,
                            const double limit[JET_TERMS], struct vec3 force[JET_TERMS])
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
        force[i] = jet_scale(weight, path->slip, i);
    }
}

void friction_force_terms(const struct friction_law *law, enum friction_regime regime,
                          const struct friction_path *path, struct vec3 force[JET_TERMS])
{
    double limit[JET_TERMS];
    double stiffness[JET_TERMS];
    double length[JET_TERMS];
    struct vec3 pull[JET_TERMS]; /* of spring and dashpot */
    struct vec3 unit[JET_TERMS] = {{0.0, 0.0, 0.0}};
    memset(force, 0, JET_TERMS * sizeof *force);
    if (law->kind == FRICTION_NONE || regime == FRICTION_LIFTED) {
        return;
    }
    put_limit(law, regime, path, limit);
    if (law->kind == FRICTION_REGULARIZED) {
        put_regularized(law, path, limit, force);
        return;
    }
    put_stiffness(law, path, stiffness);
    for (int i = 0; i < JET_TERMS; ++i) {
        pull[i] = vec3_axpy(jet_scale(stiffness, path->spring, i), law->damping, path->slip[i]);
    }
    jet_length(pull, length);
    if (regime != FRICTION_STICKING && length[0] > 0.0) {
        unit[0] = vec3_make(pull[0].x / length[0], pull[0].y / length[0], pull[0].z / length[0]);
        jet_divide(pull, length, unit);
    }
    for (int i = 0; i < JET_TERMS; ++i) {
        force[i] = vec3_scale(-1.0, regime == FRICTION_STICKING ? pull[i] : jet_scale(limit, unit, i));
    }
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

struct vec3 opposed_turned_change(enum opposed part, const struct vec3 spring[2], const struct vec3 normal[2],
                                  const struct vec3 normal_rate[2])
{
    const bool spins = part == OPPOSED_SPINNING;
    double factor[2];
    for (int i = 0; i < 2; ++i) {
        factor[i] = spins ? jet_dot(spring, normal, i) : -jet_dot(spring, normal_rate, i);
    }
    return jet_scale(factor, spins ? normal_rate : normal, 1);
}

void friction_stored_terms(const struct friction_law *law, enum friction_regime regime,
                           const struct friction_path *path, double stored[JET_TERMS])
{
    double limit[JET_TERMS];
    double stiffness[JET_TERMS];
    double square[JET_TERMS]; /* xi^2, or L^2 */
    double twice[JET_TERMS];
    const bool slides = regime == FRICTION_SLIDING || regime == FRICTION_CAPPED;
    memset(stored, 0, JET_TERMS * sizeof *stored);
    if (law->kind != FRICTION_ELASTIC) {
        return;
    }
    const bool is_limit = slides && law->damping == 0.0; /* the spring is L / k_t long */
    put_limit(law, regime, path, limit);
    put_stiffness(law, path, stiffness);
    for (int i = 0; i < JET_TERMS; ++i) {
        square[i] = is_limit ? taylor_multiply(limit, limit, i) : jet_dot(path->spring, path->spring, i);
        twice[i] =
            is_limit ? taylor_divide(square, stiffness, twice, i) : taylor_multiply(stiffness, square, i);
        stored[i] = 0.5 * twice[i];
    }
}

static struct vec3 matrix_times(double m[3][3], struct vec3 a)
{
    return vec3_make(m[0][0] * a.x + m[0][1] * a.y + m[0][2] * a.z,
                     m[1][0] * a.x + m[1][1] * a.y + m[1][2] * a.z,
                     m[2][0] * a.x + m[2][1] * a.y + m[2][2] * a.z);
}

struct vec3 friction_slopes_along(const struct friction_slopes *slopes, double normal_force, struct vec3 slip,
                                  struct vec3 spring)
{
    struct friction_slopes m = *slopes;
    const struct vec3 by_motion = vec3_add(matrix_times(m.by_slip, slip), matrix_times(m.by_spring, spring));
    return vec3_axpy(by_motion, normal_force, m.by_normal_force);
}
