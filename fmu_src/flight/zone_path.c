#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "flight/relative_path.h"
#include "flight/zone_path.h"

double zone_path_rounding(const struct contact_solid *solid, struct vec3 c)
{
    return 8.0 * DBL_EPSILON * (vec3_norm(c) + solid->radius + solid->half_height);
}

/* Adds where the path crosses the cone rho = |offset + slope z| about the axis of the solid. */
static int add_cone(const struct contact_solid *solid, const struct separation_path *path, double horizon,
                    double offset, double slope, double *places, int count)
{
    struct polynomial cone = {.degree = 2 * SEPARATION_DEGREE}; /* (rho^2 - (offset + slope z)^2) / r_d^2 */
    struct vec3 across[SEPARATION_DEGREE + 1];
    double line[SEPARATION_DEGREE + 1];
    double factor = 1.0 / solid->radius;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        const double axial = vec3_dot(path->c[i], solid->axis);
        across[i] = vec3_scale(factor, vec3_axpy(path->c[i], -axial, solid->axis));
        line[i] = factor * (slope * axial + (i == 0 ? offset : 0.0));
        factor *= horizon;
        for (int k = 0; k <= i; ++k) {
            const double product = vec3_dot(across[i], across[k]) - line[i] * line[k];
            cone.a[i + k] += k < i ? 2.0 * product : product;
        }
    }
    return polynomial_add_sign_changes(&cone, places, count);
}

/* Returns the distance of the centre from the outer edge of a side, a cap or the face of skew cylinders [m],
 * whatever the depth. */
static double face_margin(const struct contact_solid *solid, struct vec3 c)
{
    if (SCENE_ANY_SKEW && abs(solid->zone) == SKEW_FACE) {
        const struct skew_frame *face = contact_skew_frame(solid);
        return fmin(face->reach[0] - fabs(vec3_dot(c, face->across[0])),
                    face->reach[1] - fabs(vec3_dot(c, face->across[1])));
    }
    const struct solid_place place = contact_place_at(solid, c);
    return solid->zone == ZONE_SIDE ? -place.axial : -place.radial;
}

/* Number of places that are tried between two edges. The polynomial of an edge has degree eight at most, so
 * it touches zero without a change of sign at four places at most, as where a path turns back just at an
 * edge. One of five places is clear of the edge. */
enum { CLEAR_PLACES = 5 };

/* Whether the centre is outside the edge of its face or zone, by more than rounding, at the place between
 * `from` and `to` that is farthest from the edge. */
static bool is_outside(const struct contact_solid *solid, const struct separation_path *path, double horizon,
                       double from, double to, bool face)
{
    bool outside = false;
    double farthest = -1.0;
    for (int i = 1; i <= CLEAR_PLACES; ++i) {
        const double time = horizon * (from + (to - from) * i / (CLEAR_PLACES + 1));
        const struct vec3 c = path_at(path->c, SEPARATION_DEGREE + 1, time);
        const double margin = face ? face_margin(solid, c) : contact_zone_margin(solid, solid->zone, c);
        if (fabs(margin) > farthest) {
            farthest = fabs(margin);
            outside = margin < -zone_path_rounding(solid, c);
        }
    }
    return outside;
}

/* Returns the time of the first of the sorted places after which the centre is outside its face or zone
 * [s]. */
static double first_outside(const struct contact_solid *solid, const struct separation_path *path,
                            double horizon, const double *places, int count, bool face)
{
    double from = 0.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? places[i] : 1.0;
        if (to > from && is_outside(solid, path, horizon, from, to, face)) {
            return from * horizon;
        }
        from = to;
    }
    return (double)INFINITY;
}

enum { ZONE_EDGES = 4 * POLYNOMIAL_MAX_DEGREE };

double zone_path_end(const struct contact_solid *solid, const struct separation_path *path, double horizon)
{
    const double r = solid->radius;
    const double h = solid->half_height;
    double places[ZONE_EDGES];
    int count = separation_path_planes(path, horizon, solid->axis, h, places, 0);
    count = separation_path_planes(path, horizon, solid->axis, 0.0, places, count);
    count = add_cone(solid, path, horizon, r, 0.0, places, count);
    for (int end = -1; end <= 1; end += 2) { /* inside the solid a side and a cap are equally near there */
        count = add_cone(solid, path, horizon, r - h, end, places, count);
    }
    return first_outside(solid, path, horizon, places, count, false);
}

double zone_path_leaves_face(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon)
{
    double places[ZONE_EDGES];
    int count = 0;
    if (face_margin(solid, path->c[0]) > horizon * path_size(path->c + 1, SEPARATION_DEGREE, horizon)) {
        return (double)INFINITY; /* the path is too short to reach an edge */
    }
    if (SCENE_ANY_SKEW && abs(solid->zone) == SKEW_FACE) {
        const struct skew_frame *face = contact_skew_frame(solid);
        for (int i = 0; i < 2; ++i) {
            count = separation_path_planes(path, horizon, face->across[i], face->reach[i], places, count);
        }
    } else if (solid->zone == ZONE_SIDE) {
        count = separation_path_planes(path, horizon, solid->axis, solid->half_height, places, count);
    } else {
        count = add_cone(solid, path, horizon, solid->radius, 0.0, places, count);
    }
    return first_outside(solid, path, horizon, places, count, true);
}
