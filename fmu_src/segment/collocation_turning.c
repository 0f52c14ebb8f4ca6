#include "segment/collocation_turning.h"

#include "math/compiler.h"
#include "segment/collocation_rim.h"

static double larger_change(double a, double b)
{
    return a > b ? a : b;
}

void collocation_load(const struct collocation *p, double *values, double *softening)
{
    if (collocation_at_rim(p)) {
        collocation_rim_load(p, values, softening);
        return;
    }
    const int points = p->nodes->points;
    const double half2 = p->half * p->half;
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->result.normal_correction);
    const struct vec3 h = vec3_sub(p->local.momentum, p->result.momentum_correction);
    for (int i = 0; i < points; i += LANES) {
        const double2 hz = h.z + double2_at(p->result.h.z, i);
        double2 h_squared = hz * hz;
        double2 drive = (n.x + double2_at(p->result.n.x, i)) * double2_at(p->work.drive_at.x, i) +
                        (n.y + double2_at(p->result.n.y, i)) * double2_at(p->work.drive_at.y, i);
        if (!p->local.planar) {
            const double2 hx = h.x + double2_at(p->result.h.x, i);
            const double2 hy = h.y + double2_at(p->result.h.y, i);
            h_squared += hx * hx + hy * hy;
            drive += (n.z + double2_at(p->result.n.z, i)) * double2_at(p->work.drive_at.z, i);
        }
        const double2 inverse = 1.0 / (p->from.reach + double2_at(p->result.x, i));
        const double2 centrifugal = half2 * h_squared * inverse * inverse * inverse;
        double2_put(values, i, centrifugal + half2 * drive);
        double2_put(softening, i, 1.5 * centrifugal * inverse);
    }
}

/* H' = d n x A */
static double integrate_momentum(struct collocation *p)
{
    const struct nodal_vec3 *a = &p->work.acceleration_at;
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->result.normal_correction);
    for (int i = 0; i < p->nodes->points; i += LANES) {
        const double2 arm = p->half * (p->from.reach + double2_at(p->result.x, i));
        const double2 nx = n.x + double2_at(p->result.n.x, i);
        const double2 ny = n.y + double2_at(p->result.n.y, i);
        double2_put(p->result.h_rate.z, i, arm * (nx * double2_at(a->y, i) - ny * double2_at(a->x, i)));
        if (!p->local.planar) {
            const double2 nz = n.z + double2_at(p->result.n.z, i);
            double2_put(p->result.h_rate.x, i, arm * (ny * double2_at(a->z, i) - nz * double2_at(a->y, i)));
            double2_put(p->result.h_rate.y, i, arm * (nz * double2_at(a->x, i) - nx * double2_at(a->z, i)));
        }
    }
    double change = nodal_integrate(p->nodes, p->result.h_rate.z, p->result.h.z);
    if (!p->local.planar) {
        change = larger_change(nodal_integrate(p->nodes, p->result.h_rate.x, p->result.h.x), change);
        change = larger_change(nodal_integrate(p->nodes, p->result.h_rate.y, p->result.h.y), change);
    }
    return 2.0 * p->half / p->local.distance * change;
}

/* n' = H x n / d^2 */
static double integrate_normal(struct collocation *p)
{
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->result.normal_correction);
    const struct vec3 h = vec3_sub(p->local.momentum, p->result.momentum_correction);
    for (int i = 0; i < p->nodes->points; i += LANES) {
        const double2 d = p->from.reach + double2_at(p->result.x, i);
        const double2 by = p->half / (d * d);
        const double2 nx = n.x + double2_at(p->result.n.x, i);
        const double2 ny = n.y + double2_at(p->result.n.y, i);
        const double2 hz = h.z + double2_at(p->result.h.z, i);
        double2 to_x = -hz * ny;
        double2 to_y = hz * nx;
        if (!p->local.planar) {
            const double2 nz = n.z + double2_at(p->result.n.z, i);
            const double2 hx = h.x + double2_at(p->result.h.x, i);
            const double2 hy = h.y + double2_at(p->result.h.y, i);
            to_x += hy * nz;
            to_y -= hx * nz;
            double2_put(p->result.n_rate.z, i, by * (hx * ny - hy * nx));
        }
        double2_put(p->result.n_rate.x, i, by * to_x);
        double2_put(p->result.n_rate.y, i, by * to_y);
    }
    double change = larger_change(nodal_integrate(p->nodes, p->result.n_rate.x, p->result.n.x),
                                  nodal_integrate(p->nodes, p->result.n_rate.y, p->result.n.y));
    if (!p->local.planar) {
        change = larger_change(nodal_integrate(p->nodes, p->result.n_rate.z, p->result.n.z), change);
    }
    return p->local.distance * change;
}

double collocation_turn(struct collocation *p)
{
    if (collocation_at_rim(p)) {
        return collocation_rim_turn(p);
    }
    if (p->kind != COLLOCATION_RESOLVED) {
        const struct collocation_correction correction =
            collocation_correction_of(p, p->result.y, p->result.y_rate, vec3_make(1.0, 0.0, 0.0),
                                      p->local.momentum, p->local.acceleration[0], p->local.distance);
        p->result.normal_correction = correction.normal;
        p->result.momentum_correction = correction.momentum;
    }
    const double by_momentum = integrate_momentum(p);
    return larger_change(by_momentum, integrate_normal(p));
}

void collocation_keep_mismatch(struct collocation *p)
{
    const struct vec3 n = vec3_sub(vec3_make(1.0, 0.0, 0.0), p->result.normal_correction);
    nodal_values values;
    for (int i = 0; i < p->nodes->points && !collocation_at_rim(p); ++i) {
        values[i] = (n.x + p->result.n.x[i]) * p->work.mismatch_at.x[i] +
                    (n.y + p->result.n.y[i]) * p->work.mismatch_at.y[i] +
                    (n.z + p->result.n.z[i]) * p->work.mismatch_at.z[i];
    }
    if (collocation_at_rim(p)) {
        collocation_rim_mismatch(p, values);
    }
    nodal_coefficients(p->nodes, values, p->result.normal_mismatch);
}

void collocation_keep_tilt(struct collocation *p)
{
    if (collocation_at_rim(p)) {
        collocation_rim_keep_tilt(p);
    }
}
