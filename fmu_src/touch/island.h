/*
 * Contacts without friction that share free bodies move by one power series, under either law, with dashpots
 * or without. Each phase is one series in s, and time follows it:
 *
 *   dt/ds = unit pace,   pace = 1, or u = sqrt(delta) of one contact under Hertz's law
 *
 * Hertz's force is a singular function of time where its contact begins and ends. All forces are analytic
 * functions of s there, if the pace is the u of that contact (touch/series.c). The pace belongs to the
 * contact that is nearest to its touch or its release. With the deviation r_b of a body from its flight C,
 * and with the direction e = side n in which a contact pushes its destination, the motion follows from
 *
 *   c = C + r_d - r_s,   g_t = e.c',   d = reach + side g,   n = c/d,   m_b r_b'' = sum of -+F e
 *
 * where c is the part of the separation across the axis of a cylinder. Products and quotients give the
 * coefficients order by order (Jorba and Zou, Experimental Mathematics 14 (2005) 99). Events are roots of the
 * series of gaps and forces, isolated by their Bernstein coefficients.
 */
#ifndef CONTACT_TOUCH_ISLAND_H
#define CONTACT_TOUCH_ISLAND_H

#include "flight/relative_path.h"
#include "math/series.h"

/* An island has at most so many contacts in touch. The general segment takes larger ones. */
enum { ISLAND_MOST = SCENE_CONTACTS < 48 ? SCENE_CONTACTS : 48, ISLAND_AXES = 3 };

/* Rows of coefficients end with zeros, because products take four terms at a time. */
enum { ISLAND_ROW = TAYLOR_TERMS + 3, ISLAND_FLOWN = (SEPARATION_DEGREE + 1) * ISLAND_AXES };

/* A series, and in `back` the same in reversed order: coefficient j at [TAYLOR_ORDER - j]. Products read both
 * of their factors forwards, two terms in one instruction. */
struct two_way {
    double row[ISLAND_ROW];
    double back[ISLAND_ROW];
};

/* A contact in touch. */
struct island_row {
    int contact, end[2]; /* the contact, and its source and destination among the bodies of the island */
    double side;
    bool is_hertz, is_straight; /* straight: n never turns */
    double k, c;                /* k and c of the linear law, k_h and chi of Hertz's, in the regime */
    double by_gap, by_rate,
        margin;               /* the event function of the law, linear in g and g'; margin: at the start */
    double offset;            /* the contact ends where its gap exceeds this [m] */
    double passage;           /* rate at which c turns at the start [1/s] */
    double by_distance, bend; /* 1/d [1/m] and g'' [m/s^2] at the start */
    double spring, dashpot;   /* rates of the contact at the start [1/s] */
    double deepest;           /* the depth that the contact will reach, as an impact without damping [m] */
    double axis[ISLAND_AXES]; /* axis of the destination if it is a cylinder; else zero [1] */
    double flown[ISLAND_FLOWN], flown_rate[ISLAND_FLOWN];        /* coefficients of C and C' in time */
    double gap[ISLAND_ROW], rate[ISLAND_ROW], force[ISLAND_ROW]; /* g [m], g' [m/s], F [N] */
    double impulse[ISLAND_ROW], drag[ISLAND_ROW]; /* F pace, and the dashpot's part of -F [N] */
    double depth[ISLAND_ROW], slope[ISLAND_ROW];  /* delta under Hertz's law, i times its coefficient i */
    struct two_way power;                         /* delta^(3/2) */
    double pushed[ISLAND_AXES][TAYLOR_TERMS];     /* momentum given to the destination [N s] */
    double lower_push[ISLAND_AXES];               /* the part of the next push by lower coefficients */
    struct two_way n[ISLAND_AXES];
    double d[ISLAND_ROW];                      /* from coefficient 1 on [m] */
    double rate_of_c[ISLAND_AXES][ISLAND_ROW]; /* [m/s] */
};

/* A free body on which contacts of the island act. */
struct island_body {
    int body;
    double by_mass;                          /* 1/m [1/kg] */
    double rate[ISLAND_AXES][ISLAND_ROW];    /* r_b' [m/s] */
    double moved[ISLAND_AXES][TAYLOR_TERMS]; /* r_b [m] */
};

struct island {
    int rows, bodies;            /* body 0 stands for all on which no contact of the island acts */
    int index[SCENE_BODIES];     /* of a body of the scene among these bodies */
    int axes, axis[ISLAND_AXES]; /* the axes of the world along which contact forces act */
    int degree;                  /* of the flights in time */
    int paced_by;                /* the row whose u is the pace; -1: the pace is one */
    double unit;                 /* [s], or [s/sqrt(m)] */
    double end;                  /* the s at the end */
    double time;                 /* the time from the start to the end [s] */
    int terminal;                /* the contact that changes at the end; -1: none */
    enum contact_regime next;
    struct two_way pace, power_of_time[SEPARATION_DEGREE + 1]; /* powers from the first one on [s, s^2...] */
    struct island_row row[ISLAND_MOST];
    struct island_body body[1 + 2 * ISLAND_MOST];
};

/* Whether the contacts in touch may be an island by power series, by their laws; island_make tells by their
 * motion. */
bool island_may_be(const struct scene_values *v, const struct scene_state *q);

/* Makes one series of all contacts in touch over at most `longest` seconds, up to the first contact that
 * begins, ends or changes its regime. It is exact to a few roundings. Returns false where there is none, or
 * where no contact oscillates by more than `quiet` [m]: the general segment then takes longer steps. */
bool island_make(struct island *s, const struct scene_values *v, const struct scene_state *q,
                 const struct scene_instant *at, double longest, double quiet);

/* Returns the cost of making it, in steps in closed form (integrator/phases.h). */
long island_work(const struct island *s);

/* Moves the bodies from the start to a time since then, and notes peaks since the time `from` [s]. The caller
 * advances the clock and all bodies without contact force. */
void island_advance(const struct island *s, double from, double time, const struct scene_values *v,
                    struct scene_state *q);

#endif
