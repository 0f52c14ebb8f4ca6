#include <string.h>

#include "contact/slopes.h"
#include "math/series.h"
#include "math/vec3.h"

void jet_direction(int terms, const struct vec3 a[JET_TERMS], double length[JET_TERMS],
                   struct vec3 unit[JET_TERMS])
{
    memset(length, 0, JET_TERMS * sizeof *length);
    memset(unit, 0, JET_TERMS * sizeof *unit);
    length[0] = vec3_norm(a[0]);
    if (!(length[0] > 0.0)) {
        length[1] = vec3_norm(a[1]);
        length[2] = terms > 2 && length[1] > 0.0 ? vec3_dot(a[1], a[2]) / length[1] : 0.0;
        return;
    }
    for (int i = 0; i < terms; ++i) {
        for (int k = 1; k <= i; ++k) {
            length[i] += k * vec3_dot(unit[i - k], a[k]) / i;
        }
        const struct vec3 rest = i > 0 ? vec3_sub(a[i], jet_scale(length, unit, i)) : a[0];
        unit[i] = vec3_make(rest.x / length[0], rest.y / length[0], rest.z / length[0]);
    }
}

void jet_across(int terms, const struct vec3 c[JET_TERMS], const struct vec3 direction[JET_TERMS],
                struct vec3 across[JET_TERMS], double along[JET_TERMS])
{
    for (int i = 0; i < terms; ++i) {
        along[i] = jet_dot(c, direction, i);
        across[i] = vec3_sub(c[i], jet_scale(along, direction, i));
    }
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

/* Sets (1 - exp(-z))/z and its first two derivatives. They are (-1)^k M_k with the integral M_k of t^k
 * exp(-z t) over [0, 1], for which z M_k = k M_(k-1) - exp(-z). Below z = 1 only the way downwards in k
 * keeps the digits; an error of M_20 is divided by 20!/2! there. */
static void put_saturation(double z, double out[JET_TERMS])
{
    const double e = exp(-z);
    double m = e / 21.0;
    if (z >= 1.0) {
        out[0] = -expm1(-z) / z;
        out[1] = (e - out[0]) / z;
        out[2] = -(e + 2.0 * out[1]) / z;
        return;
    }
    for (int k = 20; k > 0; --k) {
        m = (z * m + e) / k;
        if (k <= JET_TERMS) {
            out[k - 1] = k == 2 ? -m : m;
        }
    }
}

/* Sets the series of regularized friction, F_t = -L (1 - exp(-|v_t|/v_0))/|v_t| v_t. */
static void put_regularized(const struct friction_law *law, const struct friction_path *path,
                            const double limit[JET_TERMS], struct vec3 force[JET_TERMS])
{
    double speed[JET_TERMS];
    double s[JET_TERMS];
    double factor[JET_TERMS];
    double weight[JET_TERMS];
    struct vec3 unit[JET_TERMS];
    const double v_0 = law->slip_velocity;
    jet_direction(path->terms, path->slip, speed, unit);
    const double z = speed[0] / v_0;
    put_saturation(z, s);
    factor[0] = s[0] / v_0;
    factor[1] = s[1] * speed[1] / (v_0 * v_0) - path->slip_velocity_slope * (s[1] * z + s[0]) / (v_0 * v_0);
    factor[2] = (s[1] * speed[2] + 0.5 * s[2] * speed[1] * speed[1] / v_0) / (v_0 * v_0);
    for (int i = 0; i < path->terms; ++i) {
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
    struct vec3 pull[JET_TERMS] = {{0.0, 0.0, 0.0}}; /* of spring and dashpot */
    struct vec3 unit[JET_TERMS];
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
    for (int i = 0; i < path->terms; ++i) {
        pull[i] = vec3_axpy(jet_scale(stiffness, path->spring, i), law->damping, path->slip[i]);
    }
    jet_direction(path->terms, pull, length, unit);
    for (int i = 0; i < path->terms; ++i) {
        force[i] = vec3_scale(-1.0, regime == FRICTION_STICKING ? pull[i] : jet_scale(limit, unit, i));
    }
}

/* xi' is -(F_t + k_t xi) / c_t with a dashpot; without one it is the part of the slip across xi times the
 * factor k_t |xi| / (L + (1e-5 k_t |xi|)^2 / L). */
struct vec3 friction_spring_rate_change(const struct friction_law *law, enum friction_regime regime,
                                        const struct friction_path *path)
{
    struct vec3 force[JET_TERMS], unit[JET_TERMS], across[JET_TERMS];
    double stiffness[JET_TERMS], limit[JET_TERMS], length[JET_TERMS];
    double reach[2], factor[2], top[2], square[2], along[JET_TERMS];
    if (!friction_has_spring(law, regime)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    if (regime == FRICTION_STICKING) {
        return path->slip[1];
    }
    put_stiffness(law, path, stiffness);
    if (law->damping > 0.0) {
        friction_force_terms(law, regime, path, force);
        return vec3_scale(-1.0 / law->damping, vec3_add(force[1], jet_scale(stiffness, path->spring, 1)));
    }
    put_limit(law, regime, path, limit);
    jet_direction(path->terms, path->spring, length, unit);
    jet_across(2, path->slip, unit, across, along);
    for (int i = 0; i < 2; ++i) {
        const double floor = FRICTION_LEAST_LENGTH * FRICTION_LEAST_LENGTH;
        reach[i] = taylor_multiply(stiffness, length, i);
        top[i] = taylor_multiply(reach, limit, i);
        square[i] = taylor_multiply(limit, limit, i) + floor * taylor_multiply(reach, reach, i);
        factor[i] = reach[0] > 0.0 && square[0] > 0.0 ? taylor_divide(top, square, factor, i) : 0.0;
    }
    return jet_scale(factor, across, 1);
}

void opposed_laid_terms(enum opposed part, int terms, const struct vec3 a[JET_TERMS],
                        const struct vec3 normal[JET_TERMS], struct vec3 laid[JET_TERMS])
{
    double along[JET_TERMS];
    jet_across(terms, a, normal, laid, along);
    for (int i = 0; part == OPPOSED_SPINNING && i < terms; ++i) {
        laid[i] = jet_scale(along, normal, i);
    }
}

void friction_stored_terms(const struct friction_law *law, enum friction_regime regime,
                           const struct friction_path *path, double stored[JET_TERMS])
{
    double limit[JET_TERMS];
    double stiffness[JET_TERMS];
    double square[JET_TERMS]; /* xi^2, or L^2 */
    double twice[JET_TERMS];
    const bool slides = regime == FRICTION_SLIDING || regime == FRICTION_CAPPED;
    const bool is_limit = slides && law->damping == 0.0; /* the spring is L / k_t long */
    memset(stored, 0, JET_TERMS * sizeof *stored);
    if (law->kind != FRICTION_ELASTIC) {
        return;
    }
    put_limit(law, regime, path, limit);
    put_stiffness(law, path, stiffness);
    for (int i = 0; i < JET_TERMS; ++i) {
        square[i] = is_limit ? taylor_multiply(limit, limit, i) : jet_dot(path->spring, path->spring, i);
        twice[i] =
            is_limit ? taylor_divide(square, stiffness, twice, i) : taylor_multiply(stiffness, square, i);
        stored[i] = 0.5 * twice[i];
    }
}
