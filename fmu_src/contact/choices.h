/* These are the choices that a scene offers. The enumerations that begin at 1 have the values of the FMI
 * enumerations, which never change. */
#ifndef CONTACT_CONTACT_CHOICES_H
#define CONTACT_CONTACT_CHOICES_H

/* CONTACT_ANY_X is 1 where a scene of the build may contain X. The build of a scene defines CONTACT_PARTS and
 * each of these macros (ContactFmu.cmake); the compiler then drops the code for what is 0. */
#ifndef CONTACT_PARTS
#define CONTACT_ANY_CYLINDER 1
#define CONTACT_ANY_CAPS 1
#define CONTACT_ANY_PLANE 1
#define CONTACT_ANY_TORUS 1
#define CONTACT_ANY_SKEW 1 /* whether cylinders may touch with skew axes */
#define CONTACT_ANY_COMPOUND 1
#define CONTACT_ANY_CURVED 1 /* whether a destination may be other than a plane */
#define CONTACT_ANY_HERTZ 1
#define CONTACT_ANY_PRESCRIBED 1 /* whether the importer may move a body */
#define CONTACT_ANY_ROTATION 1   /* whether a body may turn */
#define CONTACT_ANY_ROLLING 1    /* whether a contact may resist rolling or spinning */
#define CONTACT_ANY_MINDLIN 1    /* whether a tangential stiffness may follow the normal one */
#endif

/* Whether a shape may be a rim or a torus, whose nearest point is on a circle. */
#define CONTACT_ANY_CIRCLE (CONTACT_ANY_CAPS || CONTACT_ANY_TORUS)

/* No body has the shapes SHAPE_RIM and SHAPE_SKEW: the rim is the circular edge of a capped cylinder, which a
 * sphere meets from beyond both the side and the cap; SHAPE_SKEW is what two skew cylinders are to each other
 * (shape.h). No contact has the shape SHAPE_COMPOUND: the parts of a compound body are met as spheres. */
enum shape { SHAPE_SPHERE, SHAPE_CYLINDER, SHAPE_PLANE, SHAPE_RIM, SHAPE_TORUS, SHAPE_SKEW, SHAPE_COMPOUND };

enum ends { ENDS_OPEN = 1, ENDS_CAPPED };

enum zone { ZONE_NONE = 1, ZONE_SIDE, ZONE_CAP, ZONE_RIM };

enum tube_side { TUBE_SIDE_WHOLE = 1, TUBE_SIDE_INNER_RACE, TUBE_SIDE_OUTER_RACE };

enum motion_kind { MOTION_FIXED = 1, MOTION_PRESCRIBED, MOTION_FREE };

enum location { LOCATION_AUTOMATIC = 1, LOCATION_OUTSIDE, LOCATION_INSIDE };

enum axes { AXES_PARALLEL = 1, AXES_SKEW }; /* of two cylinders */

enum method { METHOD_PENALTY = 1, METHOD_PENALTY_DYNAMIC };

enum contact_force_law { LAW_LINEAR = 1, LAW_HERTZ };

enum penalty_control {
    PENALTY_CONTROL_AUTOMATIC = 1,
    PENALTY_CONTROL_USER_DEFINED,
    PENALTY_CONTROL_VISCOUS_ONLY
};

enum viscous_control {
    VISCOUS_CONTROL_AUTOMATIC = 1,
    VISCOUS_CONTROL_USER_DEFINED,
    VISCOUS_CONTROL_RESTITUTION
};

enum dashpot { DASHPOT_NON_ADHESIVE = 1, DASHPOT_UNCLAMPED, DASHPOT_APPROACH_ONLY };

enum rotation { ROTATION_NONE = 1, ROTATION_PRESCRIBED, ROTATION_FREE };

enum inertia_control { INERTIA_CONTROL_AUTOMATIC = 1, INERTIA_CONTROL_USER_DEFINED };

enum slip_velocity_control { SLIP_VELOCITY_CONTROL_AUTOMATIC = 1, SLIP_VELOCITY_CONTROL_USER_DEFINED };

enum friction { FRICTION_NONE = 1, FRICTION_REGULARIZED, FRICTION_ELASTIC };

enum tangential_law { TANGENTIAL_LAW_LINEAR = 1, TANGENTIAL_LAW_MINDLIN };

enum resistance { RESISTANCE_NONE = 1, RESISTANCE_REGULARIZED, RESISTANCE_ELASTIC }; /* as of friction */

enum solver_method { SOLVER_METHOD_EVENT_DRIVEN = 1, SOLVER_METHOD_CVODE_BDF, SOLVER_METHOD_CVODE_ADAMS };

#endif
