/*
 * A chain consists of contacts without damping under the linear law that share free bodies and whose normals
 * never turn, as in a row of balls that hit each other head-on, or where balls meet planes. Its motion is a
 * sum of modes in closed form, however stiff the contacts are.
 *
 * Let u = side n be the direction in which a contact pushes its destination, so that g' = u.(v_d - v_s). The
 * gaps obey
 *
 *   g'' = W F + a,   F = -k g in touch, else 0
 *
 * with the Delassus operator W (W_ij sums u_i.u_j / m over shared free bodies, negative where the body is the
 * source of one contact and the destination of the other) and the relative acceleration a without contact
 * forces. With y = sqrt(k) g for the contacts in touch and S = sqrt(k) W sqrt(k) = Q L Q^T
 *
 *   z = Q^T y,   z'' + L z = b = Q^T sqrt(k) a
 *
 * so that each z is an oscillator under a constant load. Velocities and places follow from the first and
 * second integrals of z, which are closed forms as well.
 */
#ifndef CONTACT_TOUCH_CHAIN_H
#define CONTACT_TOUCH_CHAIN_H

#include "scene/evaluate.h"

/* A chain has at most this many contacts, those apart included. Its eigenvalues cost some 30 n^3 operations
 * for n contacts in touch, and are computed once for each phase. */
enum { CHAIN_MOST = SCENE_CONTACTS < 48 ? SCENE_CONTACTS : 48 };

struct chain {
    /* the first `touching` contacts are in touch; the others, up to `rows`, are apart, and the chain changes
     * their gaps head-on */
    int touching, rows;
    int contact[CHAIN_MOST];
    bool has[SCENE_CONTACTS];        /* whether a contact apart is one of the rows */
    struct vec3 push[CHAIN_MOST];    /* u */
    struct vec3 lever[CHAIN_MOST];   /* part of c across u, which gives the torque on a destination [m] */
    double gap[CHAIN_MOST];          /* g at the start [m] */
    double rate[CHAIN_MOST];         /* g' at the start [m/s] */
    double acceleration[CHAIN_MOST]; /* a [m/s^2] */
    double root[CHAIN_MOST];         /* sqrt(k) of a contact in touch [sqrt(N/m)] */
    double shared[CHAIN_MOST][CHAIN_MOST]; /* W_ij without the factor u_i.u_j, of j in touch [1/kg] */
    /* row i: how modes add to the gap of a contact in touch, or how their second integrals add to that of a
     * contact apart */
    double mode[CHAIN_MOST][CHAIN_MOST];
    double frequency[CHAIN_MOST];  /* sqrt(L) [1/s] */
    double start[CHAIN_MOST];      /* z at the start [sqrt(N m)] */
    double start_rate[CHAIN_MOST]; /* z' */
    double start_bend[CHAIN_MOST]; /* z'' */
    /* bounds of the gap of a contact in touch for all time [m], and of its |g''| [m/s^2]; of a contact apart
     * the upper bounds are INFINITY */
    double least[CHAIN_MOST], most[CHAIN_MOST], bend[CHAIN_MOST];
    double offset[CHAIN_MOST]; /* a contact changes where its gap passes zero by more than this [m] */
    double fastest;            /* the largest frequency [1/s] */
    double speed, pull;        /* largest speed [m/s] and acceleration [m/s^2] of free bodies at the start */
    struct vec3 flight[SCENE_BODIES]; /* the acceleration of each body without contact forces [m/s^2] */
    double end;   /* the time at which the first contact changes, or the time asked for [s] */
    int terminal; /* the row of this contact; -1: none changes */
};

/* Makes the chain of all contacts in touch from the present instant. Returns false where it is none. */
bool chain_make(struct chain *c, const struct scene_instant *at);

/* Finds the first contact of the chain that begins or ends within `longest` seconds. */
void chain_find_end(struct chain *c, double longest);

/* Moves the bodies from the start of the chain to a time since then, and notes peaks since the time `from`
 * [s]. The caller advances the clock and all bodies without contact force. */
void chain_advance(const struct chain *c, double from, double time, struct scene_state *q);

#endif
