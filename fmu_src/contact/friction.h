/*
 * This file has the laws of friction and their regimes, in SI units. Vectors are tangent to the contact.
 *
 *   regularized   F_t = -L (1 - exp(-|v_t| / v_0)) v_t / |v_t|,   L = min(mu F_n, F_max)
 *   elastic       F* = k_t xi + c_t v_t, the force that the tangential spring and dashpot would carry
 *     sticking    F_t = -F*             xi' = v_t
 *     sliding     F_t = -L F* / |F*|    c_t > 0: xi' = (L F* / |F*| - k_t xi) / c_t
 *
 * v_t is the slip velocity: the velocity of the source's contact point relative to the destination's. xi is
 * the elongation of the tangential spring. The spring also turns with the contact's normal; the xi' given
 * here excludes that part. F_t acts on the source, and -F_t on the destination.
 *
 * k_t is constant, or follows the normal stiffness of Hertz's law (mindlin): k_t = K sqrt(delta), where delta
 * is the penetration. F* is the total form: k_t multiplies the whole elongation, also while k_t changes. All
 * functions but the stored energy depend on xi through k_t xi, so that a change of delta acts on them as the
 * change xi ddelta / (2 delta) of xi. In the stored energy k_t xi^2 / 2 the part k_t' xi^2 / 2 of the rate is
 * no work of friction. The approach adds this energy and the rebound removes it, both at the expense of
 * energy.friction, which is the work of friction less the stored energy. Source: R. D. Mindlin, Journal of
 * Applied Mechanics 16 (1949) 259, for a contact that nowhere slips.
 *
 * Without a dashpot (c_t = 0) the spring of a sliding contact has the length L / k_t at every instant. The
 * state xi then gives only the spring's direction; |xi| stays at a typical length of the contact, and
 * friction_spring returns the spring itself. The slip would turn a spring of no length infinitely fast,
 * although its direction has no effect. The denominator L is therefore replaced by L + (1e-5 k_t |xi|)^2 / L:
 *     xi' = k_t |xi| / (L + (1e-5 k_t |xi|)^2 / L) (v_t - (v_t.xi) xi / |xi|^2)
 *
 * In each regime all functions are smooth; a regime ends where an event function falls through zero. Source:
 * P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47.
 *
 * Resistance to rolling and to spinning is a torque M on the source, and -M on the destination. It opposes
 * omega = omega_s - omega_d, the angular velocity of the source as the destination sees it. The part of omega
 * across n is rolling, the part along n is spinning. Each part has its own law and its own regime:
 *
 *   regularized   M = -mu_r R_r F_n (1 - exp(-|omega| / omega_0)) omega / |omega|
 *   elastic       M* = k_r theta + c_r omega,   sticking M = -M*,   sliding M = -mu_r R_r F_n M* / |M*|
 *
 * Both are laws of friction with omega for the slip, mu_r R_r for mu and mu_s, omega_0 for v_0, the angle
 * theta for xi, k_r and c_r for k_t and c_t, and no F_max. Struct friction_law therefore serves for each
 * part. The spring of rolling turns with the normal as that of friction does, and the spring of spinning
 * stays along the normal. Source: J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, Powder Technology 206 (2011)
 * 269.
 */
#ifndef CONTACT_CONTACT_FRICTION_H
#define CONTACT_CONTACT_FRICTION_H

#include <stdbool.h>

#include "contact/choices.h"
#include "math/vec3.h"

/* A law of friction opposes these relative motions of a contact. Where no contact resists rolling or
 * spinning, the slip is the only one. */
enum opposed { OPPOSED_SLIP, OPPOSED_ROLLING, OPPOSED_SPINNING };
enum { OPPOSED = CONTACT_ANY_ROLLING ? 3 : 1 };

/* The units are those of friction. A resistance has radians for metres and newton metres for newtons. */
struct friction_law {
    enum friction kind;
    double coefficient;        /* mu [1], or mu_r R_r [m] */
    double static_coefficient; /* mu_s >= mu [1] of elastic friction */
    double slip_velocity;      /* v_0 of regularized friction [m/s] */
    double largest;            /* F_max [N] */
    double stiffness, damping; /* k_t [N/m], or K [N/m^1.5]; c_t [N s/m] of elastic friction */
    enum tangential_law tangential;
};

/* These are the regimes of friction. Regularized friction never sticks. */
enum friction_regime {
    FRICTION_STICKING,
    FRICTION_SLIDING, /* L = mu F_n */
    FRICTION_CAPPED,  /* sliding with L = F_max */
    FRICTION_LIFTED   /* penetration with F_n <= 0: no friction; the spring relaxes through its dashpot */
};

/* The variables of a contact on which friction depends. */
struct friction_state {
    double normal_force; /* F_n [N] */
    struct vec3 slip;    /* v_t [m/s] */
    struct vec3 spring;  /* xi [m] of elastic friction */
    double depth;        /* delta [m], on which only a k_t that follows it depends */
    double depth_rate;   /* delta' [m/s], for the onset and the stick event alone */
};

/* Least penetration [m] at which k_t is evaluated, so that divisions by k_t at the touch have their limits.
 * Its power 3/2 is far above the least double. */
#define FRICTION_LEAST_DEPTH 1e-100

/* Returns k_t [N/m]. */
double friction_stiffness(const struct friction_law *law, double depth);

/* Returns the relative change dk_t / (k_t ddelta) = 1 / (2 delta) [1/m], or 0 where k_t is constant. */
double friction_stiffening(const struct friction_law *law, double depth);

/* Returns L [N], the largest |F_t| in a regime; for sticking the breakaway force min(mu_s F_n, F_max). */
double friction_limit(const struct friction_law *law, enum friction_regime regime, double normal_force);

/* Returns the regime of sliding friction under the normal force F_n. */
enum friction_regime friction_sliding_regime(const struct friction_law *law, double normal_force);

/* Returns the regime at the onset (xi = 0) from the rate of F_n [N/s]: sticking where sticking persists. At
 * the touch the rate is that of the least penetration. */
enum friction_regime friction_onset_regime(const struct friction_law *law, struct friction_state at,
                                           double normal_force_rate);

/* Returns F_t on the source [N]. */
struct vec3 friction_force(const struct friction_law *law, enum friction_regime regime,
                           struct friction_state at);

/* This is the least length of the turning spring divided by its typical length. A shorter spring turns
 * faster, up to this length. The bound changes the rate at the typical length by a fraction of 1e-10. */
#define FRICTION_LEAST_LENGTH 1e-5

/* Whether a regime has a spring: without a dashpot no force holds the spring of a contact that is lifted. */
bool friction_has_spring(const struct friction_law *law, enum friction_regime regime);

/* Returns the rate at which the normal, with the rate n', turns the spring of an opposed motion [m/s, rad/s]:
 * a spring across n stays across it, and a spring along n stays along it. */
struct vec3 opposed_turned(enum opposed part, struct vec3 spring, struct vec3 normal,
                           struct vec3 normal_rate);

/* Returns the part of a vector in which an opposed motion takes place: along n for spinning, across n for
 * rolling and for the slip. It gives the rolling or the spinning of omega. It gives a spring without what
 * rounding or a jump of n has put aside. */
struct vec3 opposed_laid(enum opposed part, struct vec3 spring, struct vec3 normal);

/* Returns the spring's elongation [m]. Its energy is stored; the other work of friction is dissipated. */
struct vec3 friction_spring(const struct friction_law *law, enum friction_regime regime,
                            struct friction_state at);

/*
 * The event functions are positive within the regime, and 1 where no event ends the regime.
 *
 *   stick      sticking: mu_s max(F_n, 0) - |F*|                     [N]
 *              sliding, c_t > 0: |F*| - L                            [N]
 *              sliding, c_t = 0: v_t . F* / |F*| - (L / k_t)'        [m/s]
 *   cap        sticking: F_max - |F*|                                [N]
 *              sliding: F_max - mu F_n, capped: mu F_n - F_max       [N]
 *
 * Sticking ends at the lesser of mu_s F_n and F_max; each of the two has an event function, because the
 * minimum is not smooth.
 */
double friction_stick_event(const struct friction_law *law, enum friction_regime regime,
                            struct friction_state at, double normal_force_rate);

/*
 * How far a friction force F_t, taken as an unknown, is from its law at the slip v_t, as a velocity [m/s]:
 *
 *   rolling    v_t + psi(F_t),   psi(F_t) = -v_0 ln(1 - |F_t| / L) F_t / |F_t|
 *   else       a (F_t - law(v_t))
 *
 * Both are zero where the law of regularized friction holds. The first is nearly linear in F_t while |F_t| is
 * well below L, the second is nearly linear in v_t where |F_t| is almost L. The admittance a [m/(N s)], a
 * change of velocity by a force, scales the second.
 */
struct friction_missed {
    struct vec3 velocity;
    double steepness; /* the derivative by |F_t| in the first form [m/(N s)]; 0 in the second */
};

/* This struct holds the derivatives by F_t, by v_t, by the spring xi and by F_n: rows of matrices, and a
 * vector. */
struct friction_slopes {
    struct vec3 by_force[3], by_slip[3], by_spring[3];
    struct vec3 by_normal_force;
};

/* Whether friction rolls, so that its response has the first form. It does not where its limit could change
 * the slip by less than v_0, as where F_n passes through zero: the law is nearly linear in the slip there. */
bool friction_rolls(const struct friction_law *law, enum friction_regime regime, double normal_force,
                    struct vec3 force, double admittance);

/* Returns how far a force F_t is from its law, in the form that `rolls` names, and sets the derivatives if
 * `slopes` is not NULL. The function first shortens a force of nearly L or more. */
struct friction_missed friction_missed(const struct friction_law *law, enum friction_regime regime,
                                       struct friction_state at, struct vec3 *force, bool rolls,
                                       double admittance, struct friction_slopes *slopes);

/*
 * How the rate of the spring of elastic friction changes where F_t is an unknown:
 *
 *   dxi' = -decay dxi + along u (u.dz) + across (dz - u (u.dz))
 *
 * The drive z is the slip v_t; but F_t where friction slides with a dashpot, and while the contact is lifted:
 * there xi' = -(F_t + k_t xi) / c_t, whatever the slip.
 */
struct friction_spring_drive {
    bool is_force;        /* whether z is F_t */
    double decay;         /* [1/s] */
    double along, across; /* [1], or [m/(N s)] where z is F_t */
    struct vec3 unit;     /* u */
};
struct friction_spring_drive friction_spring_drive_of(const struct friction_law *law,
                                                      enum friction_regime regime, struct friction_state at);

/* Returns the part of the spring's rate that the drive z gives. If z is a change of the drive, the result is
 * the change of that part. */
struct vec3 friction_driven(const struct friction_spring_drive *drive, struct vec3 z);

/* Returns xi' [m/s] under the force F_t, without what the normal turns (opposed_turned). */
struct vec3 friction_spring_rate(const struct friction_law *law, enum friction_regime regime,
                                 struct friction_state at, struct vec3 force);

/* Whether the stick event of elastic friction compares |F*| with a limit. */
bool friction_compares_forces(const struct friction_law *law, enum friction_regime regime);
double friction_cap_event(const struct friction_law *law, enum friction_regime regime,
                          struct friction_state at);

#endif
