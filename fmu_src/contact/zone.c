#include "contact/zone.h"

#ifndef CONTACT_NO_CAPS

struct solid_place contact_place_at(const struct contact_solid *solid, struct vec3 c)
{
    const double axial = vec3_dot(c, solid->axis);
    const double rho = vec3_norm(vec3_axpy(c, -axial, solid->axis));
    return (struct solid_place){rho - solid->radius, fabs(axial) - solid->half_height, axial > 0.0 ? -1 : 1};
}

int contact_zone_by(const struct solid_place *place)
{
    if (place->radial > 0.0 && place->axial > 0.0) {
        return place->end * ZONE_RIM;
    }
    return place->radial >= place->axial ? ZONE_SIDE : place->end * ZONE_CAP;
}

struct contact_shape contact_shape_in(const struct contact_shape *shape, int zone)
{
    struct contact_shape in = *shape;
    const int end = zone < 0 ? -1 : 1;
    in.solid.zone = zone;
    in.axis = vec3_scale(end, shape->solid.axis);
    switch (end * zone) {
    case ZONE_CAP:
        in.destination = SHAPE_PLANE;
        in.other_radius = shape->solid.half_height;
        break;
    case ZONE_RIM:
        in.destination = SHAPE_RIM;
        in.other_radius = 0.0;
        break;
    default:
        in.destination = SHAPE_CYLINDER;
        in.other_radius = shape->solid.radius;
        break;
    }
    return in;
}

double contact_zone_margin(const struct contact_solid *solid, int zone, struct vec3 c)
{
    const struct solid_place at = contact_place_at(solid, c);
    if (zone == ZONE_SIDE) {
        return fmin(at.radial, 0.0) - at.axial;
    }
    /* how far the centre is beyond the middle, and beyond the cap, at the end of the zone */
    const double height = (zone < 0 ? 1.0 : -1.0) * vec3_dot(c, solid->axis);
    const double beyond = height - solid->half_height;
    if (zone == ZONE_CAP || zone == -ZONE_CAP) {
        return fmin(fmin(beyond, 0.0) - at.radial, height);
    }
    return fmin(at.radial, beyond);
}

void contact_axis_distance(const struct vec3 c[3], const struct vec3 axis[3], double rho[3])
{
    struct vec3 across[3];
    double axial[3];
    for (int i = 0; i < 3; ++i) {
        axial[i] = vec3_dot(c[i], axis[0]);
        for (int k = 1; k <= i; ++k) {
            axial[i] += vec3_dot(c[i - k], axis[k]);
        }
        across[i] = vec3_axpy(c[i], -axial[i], axis[0]);
        for (int k = 1; k <= i; ++k) {
            across[i] = vec3_axpy(across[i], -axial[i - k], axis[k]);
        }
    }
    rho[0] = vec3_norm(across[0]);
    rho[1] = rho[2] = 0.0;
    if (rho[0] > 0.0) {
        rho[1] = vec3_dot(across[0], across[1]) / rho[0];
        rho[2] =
            (vec3_dot(across[0], across[2]) + 0.5 * vec3_dot(across[1], across[1]) - 0.5 * rho[1] * rho[1]) /
            rho[0];
    }
}

int contact_zone_after(const struct contact_solid *solid, int zone, struct vec3 c)
{
    const struct solid_place at = contact_place_at(solid, c);
    const int end = zone < 0 ? -1 : 1;
    if (zone == ZONE_SIDE) {
        return at.end * (at.radial > 0.0 ? ZONE_RIM : ZONE_CAP);
    }
    const double height = -end * vec3_dot(c, solid->axis);
    const double beyond = height - solid->half_height;
    if (end * zone == ZONE_RIM) {
        return at.radial < beyond ? end * ZONE_CAP : ZONE_SIDE;
    }
    if (height < fmin(beyond, 0.0) - at.radial) {
        return -zone; /* through the middle */
    }
    return beyond > 0.0 ? end * ZONE_RIM : ZONE_SIDE;
}

int contact_zone_ahead(const struct contact_solid *solid, struct vec3 c, struct vec3 rate)
{
    const double axial = vec3_dot(c, solid->axis);
    const struct vec3 across = vec3_axpy(c, -axial, solid->axis);
    const double along = vec3_dot(rate, solid->axis);
    const struct solid_place ahead = {vec3_dot(across, rate) / vec3_norm(across),
                                      axial > 0.0 ? along : -along, axial > 0.0 ? -1 : 1};
    return contact_zone_by(&ahead);
}

#endif
