/*
 * A capped cylinder: a solid with flat caps and sharp circular rims, as three zones.
 *
 *   z = -c.e_d, rho     where the source's centre is along the axis and across it, from the cylinder's centre
 *   dr = rho - r_d, dz = |z| - h, h = L / 2
 *
 *   zone   where                           distance of the centre from the solid    what it looks like
 *   side   dz <= 0, dr >= dz               dr                                       an endless cylinder
 *   cap    dr <= 0, dz > dr                dz                                       a plane
 *   rim    dr > 0 and dz > 0               sqrt(dr^2 + dz^2)                        a circle
 *
 * The gap is that distance less r_s. Outside the solid it is continuous with its slope n, which turns at
 * another rate in each zone; a centre inside the solid is pushed out through the nearest face, and n jumps
 * where that changes. In each zone the shape is one of geometry.h, smooth beyond the edges of the zone too:
 * who integrates stays in a zone until its margin falls through zero. A cap is a plane whose height is
 * measured from the cylinder's centre, so that its reach is h + r_s.
 */
#ifndef CONTACT_CONTACT_ZONE_H
#define CONTACT_CONTACT_ZONE_H

#include "contact/geometry.h"

#ifndef CONTACT_NO_CAPS

/* Where the source's centre is, by dr and dz [m], and the sign of z. */
struct solid_place {
    double radial, axial;
    int end; /* +1, -1 */
};

struct solid_place contact_place_at(const struct contact_solid *solid, struct vec3 c);

/* The zone that is nearest, with the sign of its end. */
int contact_zone_by(const struct solid_place *place);

/* The shape in a zone, from that of the solid or of any of its zones; 0: of the solid. */
struct contact_shape contact_shape_in(const struct contact_shape *shape, int zone);

/* How far the centre is within the edges of a zone [m]: negative beyond them, where another one is nearer. */
double contact_zone_margin(const struct contact_solid *solid, int zone, struct vec3 c);

/* The distance from the axis along a path of the separation and of e_d: value and Taylor coefficients [m]. */
void contact_axis_distance(const struct vec3 c[3], const struct vec3 axis[3], double rho[3]);

/* The zone beyond the edge that is nearest to c, from within a zone. */
int contact_zone_after(const struct contact_solid *solid, int zone, struct vec3 c);

/* The zone into which a centre goes that is at the circle of the rim, where all zones meet, by its rate
 * [m/s]. */
int contact_zone_ahead(const struct contact_solid *solid, struct vec3 c, struct vec3 rate);

#endif
#endif
