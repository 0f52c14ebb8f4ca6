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
    for (int i = 0; i < JET_TERMS; ++i) {
        if (i > 0) {
            jet_of_direction(shape, at, c, i, result);
        }
        result->gap[i] = i > 0 ? shape->side * result->distance[i] : at->gap;
        result->gap_rate[i] = i > 0 ? shape->side * jet_dot(result->normal, w, i) : at->gap_rate;
        result->normal_force[i] = contact_force_term(law, change, regime, result->gap, result->gap_rate, i);
        result->source_force[i] =
            vec3_scale(-shape->side, jet_scale(result->normal_force, result->normal, i));
    }
}
