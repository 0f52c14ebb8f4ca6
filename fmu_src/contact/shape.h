/*
 * The geometry of one contact is the position of the source sphere relative to the destination, in the world
 * frame, in SI units.
 *
 *   c = x_dst - x_src     separation [m], w = v_dst - v_src its rate [m/s]
 *   sphere:    d = |c|,   n = c / d
 *   cylinder:  rho = c - (c.e_d) e_d, d = |rho|, n = rho / d
 *   plane:     d = -c.e_d, n = -e_d; the half-space behind the plane is solid, and d < 0 there
 *   torus:     the nearest point of the circle in the middle of the tube: n is the unit vector to it, d its
 *              distance, r_d the radius of the tube
 *   outside:   g = d - (r_s + r_d)        inside a hollow destination:   g = (r_d - r_s) - d
 *
 *   capped:    the nearest of side, cap and rim of the solid cylinder; the rim is a circle,
 *              n is the unit vector to the circle's nearest point, and d its distance
 *
 * All gaps have the form g = side (d - reach), so that g' = side n.w; side is +1 outside and -1 inside, reach
 * is r_s + r_d outside and r_d - r_s inside. A plane and a rim have r_d = 0 and no inside. The gradient of d
 * with respect to c is n for all shapes; n is perpendicular to e_d for a cylinder and constant for a plane.
 * On the axis of a torus all points of the circle are equally near, and n jumps to the other side.
 *
 * Skew cylinders: d is the distance of the axes, which are segments where the cylinders are finite, and n
 * points from the nearest point of the source's axis to that of the destination's (see skew_frame).
 */
#ifndef CONTACT_CONTACT_SHAPE_H
#define CONTACT_CONTACT_SHAPE_H

#include <float.h>
#include <stdbool.h>

#include "contact/choices.h"
#include "math/vec3.h"

/* This struct describes a pair of skew cylinders by the parallelogram of all a along[0] + b along[1] with
 * |a| <= half[0] and |b| <= half[1], where [0] belongs to the source and [1] to the destination. The zones
 * of the parallelogram are listed before SKEW_ZONE below. */
struct skew_frame {
    struct vec3 along[2];  /* e_s and -e_d, unit vectors */
    double half[2];        /* of the lengths [m], may be INFINITY; 0: no pair of skew cylinders */
    struct vec3 across[2]; /* unit vectors in the plane: along[i] = cosine along[1 - i] + sine across[i] */
    double reach[2];       /* sine half[i] [m]: the face has |c.across[i]| <= reach[i] */
    struct vec3 normal;    /* along e_s x e_d */
    double cosine, sine;   /* of the angle between along[0] and along[1] */
};

/* A capped cylinder, of which the struct contact_shape below is the zone (side, cap, rim) that the source
 * meets; or a torus, whose radius here is that of the circle in the middle of its tube. A torus has no height
 * and no zone. */
struct contact_solid {
    struct vec3 axis;           /* e_d, unit length */
    double radius, half_height; /* r_d, L / 2 [m]; half_height 0: not a capped cylinder */
    /* The enum zone that holds, negative at the end to which -e_d points; or the zone of skew cylinders, as
     * below. With 0 the nearest zone holds. */
    int zone;
    int race; /* of a torus: +1 only rho <= R is touched, -1 only rho >= R, 0 all of it */
#if CONTACT_ANY_SKEW
    struct skew_frame skew;
#endif
};

/* The data that are constant during a contact, or while the contact stays in one zone. */
struct contact_shape {
    struct vec3 axis;     /* e_d, unit vector; not of a sphere */
    double source_radius; /* r_s > 0 [m] */
    double other_radius;  /* r_d > 0 [m] of the destination; 0 for a plane and a rim, L / 2 for a cap */
    double half_length;   /* L / 2 [m] of a finite cylinder, R of a race; INFINITY otherwise */
    int side;             /* +1: the source is outside the destination, -1: inside */
    enum shape destination;
    struct contact_solid solid;
};

struct contact_geometry {
    /* unit normal n, towards the destination's centre or axis, or into a plane; `fallback` where d = 0 */
    struct vec3 normal;
    struct vec3 offset; /* c of a sphere or a plane, rho of a cylinder [m] */
    double distance;    /* d [m]; signed for a plane */
    double gap;         /* g [m], radial, also where the source is beyond a cylinder's end planes */
    /* the term of g besides d that rounds [m]: r_s + r_d, or r_d - r_s where it is exact */
    double gap_terms;
    double gap_rate; /* g' [m/s] */
    /* c.e_d of a cylinder; rho at an inner race, 2 R - rho at an outer one; 0 for the other shapes [m] */
    double axial;
    bool degenerate; /* d = 0, so that n is the fallback; never true for a plane */
    int zone;        /* zone of a capped cylinder, as in struct contact_solid; 0 for other shapes */
    /* at a rim or a torus: unit direction b along the circle, and the circle's radius / rho [1], see
     * contact_turning_part */
    struct vec3 circumferential;
    double circumferential_part;
};

/* Whether the destination is a cylinder; whether it is a plane. The answer is a compile-time false where the
 * build has no such shape (ContactFmu.cmake). */
bool contact_is_cylinder(const struct contact_shape *shape);

bool contact_is_plane(const struct contact_shape *shape);

/* Whether the shape is the rim of a capped cylinder; whether it is a capped cylinder or a zone of one. */
bool contact_is_rim(const struct contact_shape *shape);

bool contact_is_capped(const struct contact_shape *shape);

/* Whether the shape is a torus; whether it is one or a rim, so that n points to a circle. */
bool contact_is_torus(const struct contact_shape *shape);

bool contact_is_circle(const struct contact_shape *shape);

/* Returns the parallelogram of skew cylinders. Other shapes have none, and their result may not be used. */
const struct skew_frame *contact_skew_frame(const struct contact_solid *solid);

/* contact_is_skew tells whether the shape is a pair of skew cylinders or a zone of such a pair,
 * contact_is_zoned whether the shape has zones. */
bool contact_is_skew(const struct contact_shape *shape);

bool contact_is_zoned(const struct contact_shape *shape);

/* Whether a penetrating source may reach the destination's centre or axis, where n has no direction. Only an
 * outside contact may, except with a plane, a rim, whose zone ends before, or a torus, whose tube is thin. */
bool contact_may_reach_centre(const struct contact_shape *shape);

/* Whether n turns, in proportion to 1/d, as the source moves across n. A plane's normal never turns. */
bool contact_turns(const struct contact_shape *shape, const struct contact_geometry *at);

/* Returns the part of c across a cylinder's axis; c itself for other shapes. */
struct vec3 contact_across(const struct contact_shape *shape, struct vec3 c);

/* Returns the component of a vector along a plane's normal, or zero where the component is only the rounding
 * of its products. A vector in the plane thus has no normal component. */
double contact_along_plane(struct vec3 normal, struct vec3 a);

/* Returns the part of a vector across a plane's normal, or zero where this part is only rounding. The
 * projection is done twice, because the first leaves rounding of the size of what it removes. */
struct vec3 contact_across_plane(struct vec3 normal, struct vec3 a);

/* Returns the distance d at which the bodies touch [m]: r_s + r_d outside, r_d - r_s inside. */
double contact_reach(const struct contact_shape *shape);

/* Returns the geometry for the separation c and its rate w; `fallback` is the unit normal where d = 0. */
struct contact_geometry contact_geometry_at(const struct contact_shape *shape, struct vec3 c, struct vec3 w,
                                            struct vec3 fallback);

/*
 * Returns T w, which is d times the rate of n while the source moves with w. T removes the components along n
 * and along a cylinder's axis, and is zero for a plane. For a circle of radius R n turns by 1/d across the
 * circle and by (rho - R)/(rho d) along the circle, with the distance rho from the axis: T = I - n n^T -
 * (R / rho) b b^T with the circumferential direction b.
 */
struct vec3 contact_turning_part(const struct contact_shape *shape, const struct contact_geometry *at,
                                 struct vec3 w);

/* Returns w.T w [m^2/s^2] with the T of contact_turning_part. It is d times the rate of n.w by the turning of
 * n while the source moves with w. */
double contact_turning_rate(const struct contact_shape *shape, const struct contact_geometry *at,
                            struct vec3 w);

/* Returns a unit normal where no other direction is known. For a sphere it is -z (the source is above the
 * destination). For a cylinder it is the negative coordinate axis least aligned with e_d, made perpendicular
 * to e_d. For a plane it is n. */
struct vec3 contact_default_normal(const struct contact_shape *shape);

/*
 * A capped cylinder is a solid with flat caps and sharp circular rims. It is divided into three zones.
 *
 *   z = -c.e_d, rho     where the source's centre is along the axis and across it, from the cylinder's centre
 *   dr = rho - r_d, dz = |z| - h, h = L / 2
 *
 *   zone   where                           distance of the centre from the solid    what it looks like
 *   side   dz <= 0, dr >= dz               dr                                       an endless cylinder
 *   cap    dr <= 0, dz > dr                dz                                       a plane
 *   rim    dr > 0 and dz > 0               sqrt(dr^2 + dz^2)                        a circle
 *
 * The gap is the distance of the centre from the solid minus r_s. Outside the solid the gap and its gradient
 * n are continuous; n turns at a different rate in each zone. A centre inside the solid is pushed out through
 * the nearest face, and n jumps where the nearest face changes. In each zone the shape is a cylinder, a plane
 * or a circle, smooth beyond the edges of the zone too: an integration stays in a zone until the zone's
 * margin falls through zero. A cap is a plane whose height is measured from the cylinder's centre, so that
 * its reach is h + r_s.
 */

/* This struct holds the position of the source's centre: dr and dz [m]. */
struct solid_place {
    double radial, axial;
};

struct solid_place contact_place_at(const struct contact_solid *solid, struct vec3 c);

/* Makes the shape of a solid, or of any of its zones, that of another zone; zone 0 makes it the solid. Shapes
 * without zones are in zone 0. */
void contact_enter_zone(struct contact_shape *shape, int zone);

/* Returns the distance of the centre from a zone's edges [m]: negative where another zone is nearer. */
double contact_zone_margin(const struct contact_solid *solid, int zone, struct vec3 c);

/*
 * Returns the zone that a centre enters as it leaves `zone` at c; `rate` is the rate of c in the frame of the
 * solid [m/s]. The next zone is the nearest of the other zones. Several zones may be equally near within
 * `rounding` [m], as at the circle of the rim, or at a point as near to both caps as to the side. The rate
 * then decides which zone will be nearest; if the rate does not decide either, the next zone is the side.
 */
int contact_zone_next(const struct contact_solid *solid, int zone, struct vec3 c, struct vec3 rate,
                      double rounding);

/* Returns the zone with the largest margin at c, but not the zone `except`; 0: none is left out. Of skew
 * cylinders none may be left out. */
int contact_zone_at(const struct contact_solid *solid, int except, struct vec3 c);

/* Whether n jumps as c passes from one zone into the next; `distance` is d [m]. */
bool contact_zone_jumps(const struct contact_solid *solid, int zone, int next, struct vec3 c, double distance,
                        double rounding);

/*
 * Skew cylinders follow. The point of the source's axis at a e_s and that of the destination's at b e_d, from
 * their centres, are apart by c + b e_d - a e_s. So d is the distance of c from the parallelogram of all a
 * e_s - b e_d with |a| <= L_s / 2 and |b| <= L_d / 2, a strip or a plane where lengths are infinite. This set
 * is convex, so that d is convex, and n is continuous where d > 0. The nearest point of the parallelogram
 * gives ten zones:
 *
 *   zone     a, b                      what c meets
 *   face     both within               a plane; one zone for each side of it, since n jumps where axes meet
 *   edge     one at an end             an endless cylinder about the other axis, through that end
 *   corner   both at an end            a sphere about both ends
 *
 * A zone is +-(SKEW_ZONE + 3 (i + 1) + j + 1). i and j are -1, 0 or +1 where a and b are at the lower end,
 * within, or at the upper end. The sign is that of c.(e_s x e_d) at the face, else +1. All zones are bounded
 * by planes, and the margin of a zone is the distance from the nearest of them.
 *
 * Reference: C. Ericson, Real-Time Collision Detection (2005), section 5.1.9.
 */
enum { SKEW_ZONE = 8, SKEW_FACE = SKEW_ZONE + 4, SKEW_LAST = SKEW_ZONE + 8 };

/* Returns the parallelogram of the unit vectors e_s and e_d, without the lengths of its sides. */
struct skew_frame contact_skew_axes(struct vec3 source_axis, struct vec3 destination_axis);

/* Returns the point of the source's axis that is nearest to the destination's, from the source's centre [m],
 * where c is in a zone, and its change with a change of c within the zone of the shape. Both are zero for
 * shapes other than skew cylinders, where contact is opposite to the source's centre. */
struct vec3 contact_foot(const struct contact_shape *shape, int zone, struct vec3 c);
struct vec3 contact_foot_along(const struct contact_shape *shape, struct vec3 change);

/* Returns the arm from the source's centre to the point of contact [m], or its change if `normal` and `foot`
 * are changes. */
struct vec3 contact_source_arm(const struct contact_shape *shape, struct vec3 normal, struct vec3 foot);

#endif
