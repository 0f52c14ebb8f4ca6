/*
 * Geometry of one contact: where the source sphere is relative to the destination, in the world frame, SI
 * units.
 *
 *   c = x_dst - x_src     separation [m], w = v_dst - v_src its rate [m/s]
 *   sphere:    d = |c|,   n = c / d
 *   cylinder:  rho = c - (c.e_d) e_d, d = |rho|, n = rho / d
 *   plane:     d = -c.e_d, n = -e_d; the half-space behind it is solid, and d is negative there
 *   outside:   g = d - (r_s + r_d)        inside a hollow destination:   g = (r_d - r_s) - d
 *
 *   capped:    side, cap or rim of the solid cylinder, whichever is nearest; of the rim, a circle,
 *              n is the unit vector to its nearest point, d how far that is
 *
 * All are g = side (d - reach) with side +1 outside, -1 inside, and reach r_s + r_d or r_d - r_s, so that g'
 * = side n.w; a plane has r_d = 0 and no inside, a rim too. The gradient of d with respect to c is n for all
 * shapes; n is perpendicular to e_d for a cylinder and constant for a plane.
 */
#ifndef CONTACT_CONTACT_SHAPE_H
#define CONTACT_CONTACT_SHAPE_H

#include <float.h>
#include <stdbool.h>

#include "contact/choices.h"
#include "math/compiler.h"
#include "math/vec3.h"

/* A capped cylinder, of which the shape below is the part that is met. */
struct contact_solid {
    struct vec3 axis;           /* e_d, unit length */
    double radius, half_height; /* r_d, L / 2; half_height 0: it is no capped cylinder */
    int zone; /* enum zone, negative at the end that -e_d points to; 0: whichever is nearest */
};

/* What does not change while a contact exists, or stays in a zone. */
struct contact_shape {
    struct vec3 axis;     /* e_d, unit length; cylinder and plane only */
    double source_radius; /* r_s > 0 */
    double other_radius;  /* r_d > 0, of the destination; 0 of a plane and a rim, L / 2 of a cap */
    double half_length;   /* L / 2 of a finite cylinder; INFINITY otherwise */
    int side;             /* +1: the source is outside the destination, -1: inside */
    enum shape destination;
    struct contact_solid solid;
};

struct contact_geometry {
    /* n, unit; towards the destination's centre or axis, or into a plane; the fallback where d = 0 */
    struct vec3 normal;
    struct vec3 offset; /* c of a sphere or a plane, rho of a cylinder [m] */
    double distance;    /* d [m]; of a plane with its sign */
    double gap;         /* g, radial, whether or not the source is within a cylinder's extents [m] */
    /* what rounds in g besides d: r_s + r_d, or r_d - r_s where that is exact [m] */
    double gap_terms;
    double gap_rate;             /* g' [m/s] */
    double axial;                /* c.e_d of a cylinder [m]; 0 for the other shapes */
    bool degenerate;             /* d = 0: n is the fallback; never with a plane */
    int zone;                    /* of a capped cylinder, as in struct contact_solid; 0 of any other shape */
    struct vec3 circumferential; /* direction along a rim's circle, see contact_turning_part */
    double circumferential_part; /* r_d / rho at a rim */
};

/* Whether the destination is a cylinder, a plane; never, at compile time, where the build has none
 * (ContactFmu.cmake). */
bool contact_is_cylinder(const struct contact_shape *shape);

bool contact_is_plane(const struct contact_shape *shape);

/* Whether it is the rim of a capped cylinder; whether it is a capped cylinder, or a part of one. */
bool contact_is_rim(const struct contact_shape *shape);

bool contact_is_capped(const struct contact_shape *shape);

/* Whether its axis is against the body's: a zone at the end of a capped cylinder to which -e_d points. */
bool contact_is_upside_down(const struct contact_shape *shape);

/* Whether penetration may come to a centre or axis, where n has no direction: outside, but for a plane. The
 * zone of a rim ends before. */
bool contact_may_reach_centre(const struct contact_shape *shape);

/* Whether n turns as the source moves across it, by 1/d. A plane's normal never does. */
bool contact_turns(const struct contact_shape *shape, const struct contact_geometry *at);

/* Whether the part of a vector across the axis, `across`, is so small beside its part along the axis that a
 * single projection leaves it less than about half of its digits. */
bool contact_is_near_axis(struct vec3 across, double axial);

/* Near the axis what is left of c by one projection, `once`, is rounding, which points anywhere, along the
 * axis too: projected once more it lies across, to rounding of its own size. Zero where nothing is left
 * then: c is on the axis. */
struct vec3 contact_across_again(const struct contact_shape *shape, struct vec3 once);

/* The part of c across a cylinder's axis, near the axis too; `axial` is c.e_d. */
struct vec3 contact_across_axis(const struct contact_shape *shape, struct vec3 c, double axial);

/* c without its part along a cylinder's axis. */
struct vec3 contact_across(const struct contact_shape *shape, struct vec3 c);

/* The part of a vector along n; with a plane zero where that is the rounding of its products: what lies in
 * the plane stays in it. */
double contact_along_plane(struct vec3 normal, struct vec3 a);

/* The part of a vector across n, in a plane; zero where that is rounding: what is along n stays along it. One
 * projection leaves rounding of the size of what it takes away, which the second takes away too. */
struct vec3 contact_across_plane(struct vec3 normal, struct vec3 a);

/* The distance at which the bodies touch: r_s + r_d outside, r_d - r_s inside [m]. */
double contact_reach(const struct contact_shape *shape);

/* Geometry for separation c and its rate w; `fallback` is the unit vector to use for n where d = 0. */
struct contact_geometry contact_geometry_at(const struct contact_shape *shape, struct vec3 c, struct vec3 w,
                                            struct vec3 fallback);

/* Whether the source's centre lies between the end planes of the destination (always, unless it is
 * finite). */
bool contact_within_extents(const struct contact_shape *shape, double axial);

/* e_c as users see it: towards the destination's centre (sphere) or the contact point (cylinder, plane). */
struct vec3 contact_direction_of(const struct contact_shape *shape, const struct contact_geometry *at);

/* The part of w that rotates n: without its components along n and along a cylinder's axis; none of a plane
 * [m/s]. */
struct vec3 contact_tangential(const struct contact_shape *shape, struct vec3 normal, struct vec3 w);

/*
 * d times the change of n as the source moves across it by w: T w with the projection T of
 * contact_tangential, but for a rim, which is curved in two ways: by 1/d across the circle and by
 * (rho - r_d)/(rho d) along it, with rho the distance from the axis: T = I - n n^T - (r_d / rho) b b^T with
 * the circumferential b.
 */
struct vec3 contact_turning_part(const struct contact_shape *shape, const struct contact_geometry *at,
                                 struct vec3 w);

/* d times the rate of n.w by the turning of n, for a rate w and a motion `moved`: w.T moved. */
double contact_turning_rate(const struct contact_shape *shape, const struct contact_geometry *at,
                            struct vec3 w, struct vec3 moved);

/* The escape direction at d = 0, where the distance can only grow: the unit vector along w, perpendicular to
 * a cylinder's axis; `fallback` where w has no such part. */
CONTACT_COLD struct vec3 contact_escape_direction(const struct contact_shape *shape, struct vec3 w,
                                                  struct vec3 fallback);

/* A unit vector to start from where no direction is known: -z for a sphere (the source above the
 * destination); for a cylinder the coordinate axis least aligned with e_d, made perpendicular to it,
 * negative; for a plane n itself. */
struct vec3 contact_default_normal(const struct contact_shape *shape);

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
 * where that changes. In each zone the shape is one of shape.h, smooth beyond the edges of the zone too:
 * who integrates stays in a zone until its margin falls through zero. A cap is a plane whose height is
 * measured from the cylinder's centre, so that its reach is h + r_s.
 */

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

/*
 * The zone that a centre goes into as it leaves `zone`, at c with the rate of c as the solid sees it [m/s]:
 * the nearest of the others. Where several are as near but for `rounding` [m], as at the circle of the rim,
 * where all zones meet, and in a point as near to both caps as to the side, the rate tells which will be
 * nearest; where that tells nothing either, it is the side.
 */
int contact_zone_next(const struct contact_solid *solid, int zone, struct vec3 c, struct vec3 rate,
                      double rounding);

/* The axis-aligned box around bodies, whose diagonal scales the automatic penalty factors. World frame,
 * metres. */

struct bounding_box {
    struct vec3 low, high;
};

/* A sphere: the radius in every direction. */
struct bounding_box bounding_box_sphere(struct vec3 centre, double radius);

/* A cylinder around the unit vector `axis`: half_length |e_i| + radius sqrt(1 - e_i^2) in direction i.
 * half_length 0 gives the cross-section alone, which is how an infinite cylinder enters. */
struct bounding_box bounding_box_cylinder(struct vec3 centre, double radius, struct vec3 axis,
                                          double half_length);

/* Diagonal of the smallest box around both [m]. */
double bounding_box_diagonal(const struct bounding_box *a, const struct bounding_box *b);

/* d/dt of that diagonal while b moves with `rate` [m/s]; where edges of both lie on each other, it is a's
 * that counts. */
double bounding_box_diagonal_rate(const struct bounding_box *a, const struct bounding_box *b,
                                  struct vec3 rate);

#endif
