#include "contact/jet.h"

double jet_dot(const struct vec3 *a, const struct vec3 *b, int order)
{
    double sum = 0.0;
    for (int i = 0; i <= order; ++i) {
        sum += vec3_dot(a[i], b[order - i]);
    }
    return sum;
}

struct vec3 jet_scale(const double *a, const struct vec3 *b, int order)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i <= order; ++i) {
        sum = vec3_axpy(sum, a[i], b[order - i]);
    }
    return sum;
}

#ifndef CONTACT_NO_CAPS

/* Coefficient `order` of a root from sums of products, r r = a a + b b: i r_i = sum of j (a/r)_(i-j) a_j +
 * the same of b. */
static double jet_of_hypotenuse(const double *cosine, const double *a, const double *sine, const double *b,
                                int order)
{
    double sum = 0.0;
    for (int j = 1; j <= order; ++j) {
        sum += j * (cosine[order - j] * a[j] + sine[order - j] * b[j]);
    }
    return sum / order;
}

static double jet_of_quotient(const double *a, const double *b, const double *quotient, int order)
{
    double rest = a[order];
    for (int j = 1; j <= order; ++j) {
        rest -= b[j] * quotient[order - j];
    }
    return rest / b[0];
}

/* All coefficients of d and n of a rim: n = (dr a + dz e) / d, with a the unit vector to the axis, which
 * turns along the circle, and e the normal of the cap; dz < 0 here is how far the centre is above it. */
static void jet_of_rim(const struct contact_shape *shape, const struct contact_geometry *at,
                       const struct vec3 *c, struct contact_jet *result)
{
    const struct vec3 outward = vec3_cross(at->hoop, shape->axis);
    const struct vec3 nowhere = {0.0, 0.0, 0.0};
    struct vec3 a[JET_TERMS] = {outward};
    double radial[JET_TERMS] = {vec3_dot(outward, at->offset)};
    double axial[JET_TERMS] = {vec3_dot(shape->axis, at->offset)};
    double rho[JET_TERMS] = {radial[0] + shape->solid.radius};
    double cosine[JET_TERMS] = {radial[0] / at->distance};
    double sine[JET_TERMS] = {axial[0] / at->distance};
    for (int i = 1; i < JET_TERMS; ++i) {
        const struct vec3 across = vec3_axpy(c[i], -vec3_dot(c[i], shape->axis), shape->axis);
        double grown = 0.0;
        for (int j = 1; j <= i; ++j) {
            grown += j * vec3_dot(a[i - j], c[j]);
        }
        rho[i] = radial[i] = grown / i;
        axial[i] = vec3_dot(c[i], shape->axis);
        a[i] = nowhere;
        a[i] = vec3_scale(1.0 / rho[0], vec3_sub(across, jet_scale(rho, a, i)));
        result->distance[i] = jet_of_hypotenuse(cosine, radial, sine, axial, i);
        cosine[i] = jet_of_quotient(radial, result->distance, cosine, i);
        sine[i] = jet_of_quotient(axial, result->distance, sine, i);
        result->normal[i] = vec3_axpy(jet_scale(cosine, a, i), sine[i], shape->axis);
    }
}
#endif

/* i d_i = sum of j n_(i-j).c_j, and n_i from the coefficients of d n = offset. */
static void jet_of_direction(const struct contact_shape *shape, const struct contact_geometry *at,
                             const struct vec3 *c, int order, struct contact_jet *result)
{
    double distance = 0.0;
    for (int j = 1; j <= order; ++j) {
        distance += j * vec3_dot(result->normal[order - j], c[j]);
    }
    result->distance[order] = distance / order;
    result->normal[order] = vec3_make(0.0, 0.0, 0.0);
    if (!contact_turns(shape, at)) {
        return;
    }
    struct vec3 turned = vec3_sub(c[order], jet_scale(result->distance, result->normal, order));
    if (contact_is_cylinder(shape)) {
        turned = vec3_axpy(turned, -vec3_dot(c[order], shape->axis), shape->axis);
    }
    result->normal[order] =
        vec3_make(turned.x / at->distance, turned.y / at->distance, turned.z / at->distance);
}

void contact_jet_make(const struct contact_shape *shape, const struct contact_geometry *at,
                      const struct vec3 c[JET_TERMS], const struct vec3 w[JET_TERMS],
                      const struct contact_law *law, const struct contact_law *change,
                      enum contact_regime regime, struct contact_jet *result)
{
    result->normal[0] = at->normal;
    result->distance[0] = at->distance;
#ifndef CONTACT_NO_CAPS
    const bool of_rim = contact_is_rim(shape) && !at->degenerate;
    if (of_rim) {
        jet_of_rim(shape, at, c, result);
    }
#else
    const bool of_rim = false;
#endif
    for (int i = 0; i < JET_TERMS; ++i) {
        if (i > 0 && !of_rim) {
            jet_of_direction(shape, at, c, i, result);
        }
        result->gap[i] = i > 0 ? shape->side * result->distance[i] : at->gap;
        result->gap_rate[i] = i > 0 ? shape->side * jet_dot(result->normal, w, i) : at->gap_rate;
        result->normal_force[i] = contact_force_term(law, change, regime, result->gap, result->gap_rate, i);
        result->source_force[i] =
            vec3_scale(-shape->side, jet_scale(result->normal_force, result->normal, i));
    }
}
