/*
 * A contact pair consists of two bodies that exchange a contact force, from one instant on, within one
 * regime.
 *
 * Without that force the separation would follow the polynomial C(t), its rate W(t) (relative_path.h). With
 * it c = C + r, w = W + r' and m_red r'' = side F_n n, where 1/m_red is the sum of the free bodies' inverse
 * masses. Momentum is conserved exactly: the bodies deviate from their flights by -r m_red/m_s and +r
 * m_red/m_d, and the impulse on the source is -m_red r'. Each kind of segment finds r (segment.h).
 */
#ifndef CONTACT_TOUCH_PAIR_H
#define CONTACT_TOUCH_PAIR_H

#include "flight/relative_path.h"
#include "math/oscillator.h"
#include "scene/dense_output.h"
#include "touch/collocation.h"
#include "touch/rim.h"

/* Stiffness [N/m] from which the rounding of gap and rate, some 1e-16 m and m/s, makes forces that count
 * beside a load. Real contacts have some 1e10 at most. */
#define PAIR_STIFF 1e18

enum { PAIR_BODIES = 2 }; /* source, destination */

struct contact_pair {
    struct contact_shape shape;
    struct contact_law law;
    /* k and c in the regime; under Hertz's law the slopes of the force at the start, for estimates */
    struct contact_coefficients coefficients;
    double hertz_stiffness; /* k_h; 0 under the linear law [N/m^1.5] */
    double chi;             /* the factor of Hunt and Crossley in the regime; 0 under the linear law [s/m] */
    struct separation_path flight; /* C and W, also along a cylinder's axis; at the centre C has `rounded` */
    struct vec3 normal;            /* n */
    double distance, gap;          /* d [m], accumulated gap g [m] */
    /* rounding, added to c so that c agrees with the accumulated gap or with the direction taken at the
     * centre [m] */
    struct vec3 rounded;
    struct vec3 rate_rounded; /* rounding, added to w so that side n.w is `rate` [m/s] */
    double rate;              /* g' [m/s] */
    bool rate_is_known;       /* g' is carried or exactly zero: no rounding of velocities */
    bool has_mismatch;        /* W differs from C' by more than rounding */
    /* Whether the motion goes along n alone, under a constant acceleration along n. A motion along a plane or
     * along a cylinder's axis may come in addition, because it does not change the gap. */
    bool is_head_on;
    double reduced_mass;  /* m_red [kg] */
    double rate_rounding; /* rounding bound of g' [m/s] */
    /* The external work that is due to r is the integral of force(t).r' dt and, at the end, momentum(t).r'. A
     * free body has a part of the first in its external force. A prescribed body has the momentum -+m_red
     * times its velocity, the derivative of which is minus its force, because its work is the integral of
     * momentum.r''. Both are coefficients of time from the instant. */
    struct vec3 force[3], momentum[3]; /* [N, N/s, ...], [N s, N, ...] */
};

/* The number of moments of r that works and torques need. Moment j is the integral of t^j r dt since the
 * instant at which the pair was made [m s^(j+1)]. */
enum { PAIR_MOMENTS = SEPARATION_DEGREE - 1 };

/* The change of the motion since the instant at which the pair was made. */
struct pair_change {
    double time;           /* [s] */
    struct vec3 r, r_rate; /* [m], [m/s] */
    double gap;            /* g now [m] */
    bool head_on;          /* gap and gap_rate are all of the relative motion along n */
    double gap_rate;       /* g' now, if head_on [m/s] */
    double dissipated;     /* energy dissipated by the dashpot [J] */
};

/* Makes the pair of a contact in compression or restitution from an instant at the present clock of at->q. */
void pair_make(struct contact_pair *p, const struct scene_instant *at, int contact);

/* Returns dg/dt at the start [m/s]. It differs from g' where a prescribed velocity is not the derivative of
 * the prescribed displacement. */
double pair_gap_derivative(const struct contact_pair *p);

/* Returns L, the acceleration that presses the bodies together, -side (|w_t|^2 / d + n.A) [m/s^2]. Near the
 * centre half the reach replaces d, since the bodies only pass the centre; at a rim n turns less. */
double pair_pressing_load(const struct contact_pair *p);

/* Returns the force that would keep the bodies at their present distance, m_red |L| [N]. */
double pair_load(const struct contact_pair *p);

/* Returns the part of a vector that does not act on head-on motion: the part along a plane or along the axis
 * of a cylinder, and zero for other shapes. The difference of the vector and the part that acts would serve
 * too, but its rounding would move bodies that rest for long. */
struct vec3 pair_aside(const struct contact_pair *p, struct vec3 a);

/* Returns the change by side r n, along the normal. */
struct pair_change pair_change_along_normal(const struct contact_pair *from, double time, double r,
                                            double r_rate, double gap);

/* Sets Hertz's force and its first two derivatives with respect to s from those of u = sqrt(delta) and g'. */
void pair_hertz_force(const struct contact_pair *from, const double u[3], const double rate[3],
                      double force[3]);

/* Moves the bodies and books impulse, dissipated energy and external work. The caller advances the clock, and
 * sets the rate that the next segment starts with. */
void pair_apply(const struct contact_pair *p, const struct pair_change *change,
                const struct vec3 moment[PAIR_MOMENTS], struct scene_state *q, int contact);

enum { FRAME = 3 }; /* directions of a frame */

/* The flight of a pair in a frame of its start, by powers of time; of a cylinder the part across the axis. */
struct frame_flight {
    struct vec3 frame[FRAME];               /* n, the tangential direction, across both; at a rim a, e, b */
    bool head_on;                           /* n never turns */
    int dimensions;                         /* directions of motion: one head-on, two in a plane */
    int degree;                             /* degree of C; that of W is one less */
    double c[SEPARATION_DEGREE + 1][FRAME]; /* C [m, m/s, ...] */
    double w[SEPARATION_DEGREE][FRAME];     /* W [m/s, ...] */
    struct rim_start rim;                   /* the start of a motion about a circle; else zero */
};

/* Makes the flight. At a rim the frame is that of rim.h, where two directions suffice in a plane through
 * the axis. */
void frame_flight_make(struct frame_flight *flight, const struct contact_pair *from);

/*
 * This struct describes a contact pair in head-on motion: along the normal alone, under a constant relative
 * acceleration along the normal. The gap is a damped oscillator under a constant load, in closed form for any
 * length of time:
 *
 *   g = equilibrium + y,   m_red y'' + p_nv y' + p_n y = 0,   equilibrium = side m_red n.A / p_n
 *
 * The variable s is the rate times the time: radians of the undamped oscillator. The deviation y oscillates
 * up to 0.97 of critical damping, and decays beyond that. Without a spring there is no equilibrium: y is g
 * itself, m_red y'' + p_nv y' = side m_red n.A, and s counts decay times of the dashpot.
 */

struct pair_oscillation {
    const struct contact_pair *from;
    double rate;                  /* sqrt(p_n / m_red), or p_nv / m_red [1/s] */
    double dynamic_stiffness;     /* m_red rate^2: p_n where there is a spring [N/m] */
    double load;                  /* side n.A per s^2 [m] */
    struct free_oscillation free; /* y, y' at the start [m] */
    double omega_d;               /* radians of y per s: sqrt(1 - damping_rate^2 / 4); 0 where it decays */
    double equilibrium;           /* gap at rest under the load; 0 without a spring [m] */
    double amplitude;             /* bound of |y|, without the drift [m] */
};

/* Makes the oscillation of a pair that moves head-on (from->is_head_on). Returns false where the motion
 * without its drift might reach the centre of solid bodies; contact inside a hollow body ends before the
 * centre. Without a spring the bodies may drift to the centre. */
bool pair_oscillation_make(struct pair_oscillation *p, const struct contact_pair *from);

/* Whether an event function stays positive for all s >= 0. */
bool pair_oscillation_stays_positive(const struct pair_oscillation *p, const struct event_function *what);

/* Returns the first s > 0 at which the gap has an extremum. Every quantity has further extrema each half
 * period pi / omega_d. The sample at an extremum needs no angle, because |y| there is omega_d times the
 * amplitude exp(-damping_rate s / 2). */
double pair_oscillation_first_extremum(const struct pair_oscillation *p);
void pair_oscillation_sample_extremum(const struct pair_oscillation *p, double s, bool deepest,
                                      struct pair_sample *sample);

void pair_oscillation_sample(const void *pair_oscillation, double s, struct pair_sample *sample);

struct pair_change pair_oscillation_advance(const void *pair_oscillation, double s);

/* Sets the first `count` moments of r up to s > 0, where `change` is the motion. */
void pair_oscillation_moments(const void *pair_oscillation, double s, const struct pair_change *change,
                              int count, struct vec3 *moment);

/* A contact pair by collocation in local coordinates (touch/collocation.h): steps as long as the tangential
 * motion allows, whatever the penalty factor. Variable s in [0, 2], time = half s. */

/* Rates and sizes of the motion at the start of a collocated step. */
struct pair_timescales {
    struct collocation_problem problem;
    double distance;   /* d [m]; INFINITY of a plane, whose normal never turns */
    double rate_along; /* |c' along the contact| / d [1/s] */
    /* rate_along + sqrt(|A| / d) at the start: n turns by about a radian in its inverse [1/s] */
    double tangential_rate;
    /* rates of the radial oscillator; sqrt(p_n / m_red) below critical damping [1/s] */
    struct oscillator_rates rates;
    double oscillation;       /* amplitude of the oscillation of x about its particular solution [m] */
    double equilibrium_depth; /* penetration at equilibrium with the load, -side f / omega2 [m] */
};

void pair_timescales_make(struct pair_timescales *out, const struct contact_pair *p,
                          const struct frame_flight *flight);

/* Returns the largest tangential rate within a step [1/s]. It exceeds the rate at the start where the
 * relative acceleration A grows with time, perhaps from zero. */
double pair_tangential_rate_within(const struct pair_timescales *scales, double step);

/* Returns the longest step, up to `longest` [s], in which the tangential motion covers about `radians`. */
double pair_step_within(const struct pair_timescales *scales, double longest, double radians);

struct pair_collocation {
    const struct contact_pair *from;
    struct collocation step;
};

void pair_collocation_sample(const void *pair_collocation, double s, struct pair_sample *sample);

/* Makes the sample of the averaged motion, without the oscillation. */
void pair_collocation_sample_averaged(const void *pair_collocation, double s, struct pair_sample *sample);

/* Returns the envelope of the oscillating part of a quantity. */
struct oscillator_envelope pair_collocation_envelope(const struct pair_collocation *p,
                                                     enum pair_quantity quantity);

struct pair_change pair_collocation_advance(const void *pair_collocation, double s);

void pair_collocation_moments(const void *pair_collocation, double s, const struct pair_change *change,
                              int count, struct vec3 *moment);

/* Sets the time since the start of a motion [s] at the place s, and its derivative by s. */
typedef void time_function(const void *of, double s, double time[3]);

/* Returns the place in [0, end] at a time [s], or `end` where that is earlier. */
double pair_place_by(time_function *time_of, const void *of, double time, double end);

#endif
