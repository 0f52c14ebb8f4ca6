/*
 * The power series of contacts that share free bodies, under either law, with dashpots or without: of one
 * contact pair (touch/series.c) or of an island (touch/island.c). All are series in s, and time follows s:
 *
 *   dt/ds = unit pace,   pace = 1, or u = sqrt(delta) of one contact under Hertz's law
 *
 * Under Hertz's law, F_n = k_h delta^(3/2) (1 + chi delta') (Hunt and Crossley), the force is a singular
 * function of time where its contact begins and ends. A series in time cannot begin at the touch, and it
 * converges ever more slowly towards the release. By u all are analytic functions of s there. u passes
 * through zero with a slope: a series may begin at u = 0, and the release is an ordinary root of u.
 *
 * With the deviation r_b of a body from its flight C, and with the direction e = side n in which a contact
 * pushes its destination, the motion follows from
 *
 *   c = C + r_d - r_s,   g_t = e.c',   d = reach + side g,   n = f/d,   m_b r_b'' = sum of -+F e
 *
 * where f = c, without its part along the axis of a cylinder. At a rim f points to the nearest point of the
 * circle of radius R at the height h. There e is the axis, and rho and a are the length and the direction of
 * the part of c across e:
 *
 *   f = c - R a + h e;   the centre is rho - R beyond the side and -(c.e + h) beyond the cap.
 *
 * Products and quotients give the coefficients order by order (Jorba and Zou, Experimental Mathematics 14
 * (2005) 99). Vectors have the axes of the world or of a pair's frame.
 */
#ifndef CONTACT_TOUCH_EXPANSION_H
#define CONTACT_TOUCH_EXPANSION_H

#include "flight/relative_path.h"
#include "math/series.h"

enum { EXPANSION_AXES = 3, EXPANSION_FLOWN = (SEPARATION_DEGREE + 1) * EXPANSION_AXES };

/* The circle that a contact at a rim is nearest to, about the second axis. */
struct expansion_rim {
    double radius, half_height; /* [m] */
    /* the part of c across the axis, its square, its length and its direction */
    taylor_row across[2], rho_squared, rho, a[2];
    taylor_row radial, axial; /* how far the centre is beyond side and cap [m] */
};

/* A contact in touch. */
struct expansion_row {
    int end[2]; /* its source and destination among the bodies */
    double side;
    bool is_hertz, is_straight;  /* straight: n never turns */
    double k, c;                 /* k and c of the linear law, k_h and chi of Hertz's, in the regime */
    double by_distance;          /* 1/d at the start [1/m] */
    double axis[EXPANSION_AXES]; /* axis of the destination if it is a cylinder; else zero [1] */
    double flown[EXPANSION_FLOWN], flown_rate[EXPANSION_FLOWN]; /* coefficients of C and C' in time */
    taylor_row gap, rate, force;                                /* g [m], g' [m/s], F [N] or, alone, F pace */
    taylor_row impulse;                                         /* F pace [N] */
    struct two_way depth, power;                                /* delta and delta^(3/2) under Hertz's law */
    taylor_row pushed[EXPANSION_AXES];                          /* momentum given to the destination [N s] */
    double lower_push[EXPANSION_AXES]; /* the part of the next push by lower coefficients */
    struct two_way n[EXPANSION_AXES];
    taylor_row d;                         /* from coefficient 1 on [m] */
    taylor_row rate_of_c[EXPANSION_AXES]; /* [m/s] */
    struct expansion_rim *rim;            /* NULL away from a rim */
    const double *mismatch; /* coefficients of C' less those of flown_rate in time; NULL: zero */
    /* Only an island uses the members below. */
    int contact;
    double by_gap, by_rate,
        margin;             /* the event function of the law, linear in g and g'; margin: at the start */
    double offset;          /* the contact ends where its gap exceeds this [m] */
    double passage, bend;   /* rate at which c turns [1/s] and g'' [m/s^2] at the start */
    double spring, dashpot; /* rates of the contact at the start [1/s] */
    double deepest;         /* the depth that the contact will reach, as an impact without damping [m] */
};

/* A free body on which contacts act. */
struct expansion_body {
    int body;
    double by_mass;                   /* 1/m [1/kg] */
    taylor_row rate[EXPANSION_AXES];  /* r_b' [m/s] */
    taylor_row moved[EXPANSION_AXES]; /* r_b [m] */
};

struct expansion {
    int rows, bodies; /* body 0 stands for all on which no contact acts */
    struct expansion_row *row;
    struct expansion_body *body;
    /* body 1 is the reduced mass of one contact in the frame of a pair; number and ends of bodies, the axes
     * below and whether the row is straight are then not read */
    bool is_framed;
    int axes, along[EXPANSION_AXES]; /* the axes along which contact forces act */
    int degree;                      /* of the flights in time */
    int paced_by;                    /* the row whose u is the pace; -1: the pace is one */
    double unit;                     /* [s], or [s/sqrt(m)] */
    struct two_way pace, power_of_time[SEPARATION_DEGREE + 1]; /* powers from the first one on [s, s^2...] */
};

/* Makes the coefficients from order `begin` up to but without `end`; those before `begin` are known. Order
 * zero needs g, g', n and the pace at the start; everything else that the series make is zero before. */
void expansion_make(struct expansion *s, int begin, int end);

/* Adds the powers of time up to a degree. */
void expansion_add_powers(struct expansion *s, int degree);

/* Returns the s at which the first omitted terms, divided by the whole, are `accuracy` (Jorba and Zou). It
 * follows from the least radius of convergence of the last coefficients; a quotient of zeros is ignored.
 * Gaps count as `opened` [m] at least, momenta as `pushed` [N s]. */
double expansion_reliable(const struct expansion *s, double opened, double pushed, double accuracy);

/* Returns the time since the start at a place [s]; expansion_time also sets the derivative of the time by s,
 * as a time_function (touch/pair.h). */
double expansion_time_at(const struct expansion *s, double place);
void expansion_time(const void *expansion, double place, double time[3]);

/* Returns the place of node i of a quadrature over [0, place] by LOBATTO_MAX nodes, and writes its weight.
 * Products of series have coefficients beyond the last one. Twelve nodes integrate them to rounding, because
 * a series ends within a third of its radius of convergence. */
double expansion_node(int i, double place, double *weight);

/* Returns the energy that the dashpots take up to a place [J]. */
double expansion_dissipated(const struct expansion *s, double place);

#endif
