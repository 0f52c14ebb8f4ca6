/* Contacts in the zones of a capped cylinder, by the distance from the solid written anew in long double. */
#ifndef CAPPED_PROBLEM_H
#define CAPPED_PROBLEM_H

#include "contact/shape.h"
#include "contact/slopes.h"
#include "long_vec3.h"
#include "random.h"

enum { QUANTITIES = 10 };

static const struct vec3 FALLBACK = {0.0, 0.0, -1.0};

static inline struct vec3 random_across(struct random *r, struct vec3 axis)
{
    struct vec3 across;
    do {
        across = vec3_cross(axis, random_vector(r, 1.0));
    } while (vec3_norm(across) < 0.1);
    return vec3_scale(1.0 / vec3_norm(across), across);
}

/* A contact in the zone `zone` of the solid `shape`; z and dr as in shape.h, for the end of the zone. */
struct problem {
    struct contact_shape shape;
    int zone;
    struct contact_law law, change; /* and its change with the path */
    struct vec3 c[JET_TERMS], w[JET_TERMS];
};

struct long_solid {
    struct long_vec3 outward, up; /* across the axis from it; along it, out of the nearer end */
    long double rho, radial, axial;
};

static inline struct long_solid long_solid_at(const struct contact_solid *solid, struct long_vec3 c, int end)
{
    const struct long_vec3 none = {0.0L, 0.0L, 0.0L};
    const struct long_vec3 e = long_of(solid->axis);
    const long double z = -long_dot(c, e);
    const struct long_vec3 across = long_axpy(long_axpy(none, -1.0L, c), -z, e);
    const long double rho = long_norm(across);
    return (struct long_solid){long_axpy(none, 1.0L / rho, across), long_axpy(none, end, e), rho,
                               rho - solid->radius, end * z - solid->half_height};
}

/* Distance, gap, its rate, force, normal into the solid, force on the source; by the zone's own formula. */
static inline void long_values(const struct problem *p, struct long_vec3 c, struct long_vec3 w,
                               long double by, long double out[QUANTITIES])
{
    const int end = p->zone < 0 ? -1 : 1;
    const struct long_solid at = long_solid_at(&p->shape.solid, c, end);
    const struct long_vec3 none = {0.0L, 0.0L, 0.0L};
    const int zone = end * p->zone;
    const long double cosine = zone == ZONE_CAP ? 0.0L : zone == ZONE_SIDE ? 1.0L : at.radial;
    const long double sine = zone == ZONE_CAP ? 1.0L : zone == ZONE_SIDE ? 0.0L : at.axial;
    const long double size = sqrtl(cosine * cosine + sine * sine);
    const long double away = zone == ZONE_CAP ? at.axial : zone == ZONE_SIDE ? at.radial : size;
    const struct long_vec3 n = long_axpy(long_axpy(none, -cosine / size, at.outward), -sine / size, at.up);
    const long double gap = away - p->shape.source_radius;
    const long double rate = long_dot(n, w);
    const long double k = p->law.stiffness + by * p->change.stiffness;
    const long double damping = p->law.damping + by * p->change.damping;
    const long double force = p->law.law == LAW_HERTZ ? k * powl(-gap, 1.5L) * (1.0L - damping * rate)
                                                      : -(k * gap + damping * rate);
    const long double reach = zone == ZONE_SIDE  ? p->shape.source_radius + p->shape.solid.radius
                              : zone == ZONE_CAP ? p->shape.source_radius + p->shape.solid.half_height
                                                 : (long double)p->shape.source_radius;
    const long double all[QUANTITIES] = {gap + reach, gap, rate,         force,        n.x,
                                         n.y,         n.z, -force * n.x, -force * n.y, -force * n.z};
    for (int i = 0; i < QUANTITIES; ++i) {
        out[i] = all[i];
    }
}

/* A place of the source's centre by dr and the height over the cap, in a zone and away from its centre of
 * curvature, where H would not be small. */
static inline struct problem random_problem(struct random *r, double scale)
{
    static const int ZONES[] = {ZONE_SIDE, ZONE_CAP, ZONE_RIM};
    struct problem p = {.zone = ZONES[random_index(r, 3)]};
    const struct vec3 axis = random_direction(r);
    const struct contact_solid solid = {axis, scale * random_between(r, 0.3, 2.0),
                                        scale * random_between(r, 0.3, 2.0), 0};
    p.shape = (struct contact_shape){.axis = axis,
                                     .source_radius = scale * random_between(r, 1.0, 2.0),
                                     .other_radius = solid.radius,
                                     .half_length = solid.half_height,
                                     .side = 1,
                                     .destination = SHAPE_CYLINDER,
                                     .solid = solid};
    const int end = p.zone == ZONE_SIDE || random_index(r, 2) == 0 ? 1 : -1;
    const double depth = scale * random_between(r, 0.02, 0.3);
    const double away = p.shape.source_radius - depth;
    const double angle = random_between(r, 0.05, 1.5);
    double radial = -random_between(r, 0.1, 0.9) * solid.radius;
    double axial = -random_between(r, 0.1, 1.9) * solid.half_height;
    if (p.zone == ZONE_RIM) {
        radial = away * cos(angle);
        axial = away * sin(angle);
    } else {
        *(p.zone == ZONE_SIDE ? &radial : &axial) = away;
    }
    p.zone *= end;
    const struct vec3 outward = random_across(r, axis);
    p.c[0] = vec3_scale(-(solid.radius + radial), outward);
    p.c[0] = vec3_axpy(p.c[0], -end * (solid.half_height + axial), axis);
    return p;
}

#endif
