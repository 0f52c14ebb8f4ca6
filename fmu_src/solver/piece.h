/*
 * One piece of pressing motion, by whichever way takes it furthest for its cost:
 *
 *   closed form              head-on under a steady pull: for ever, or most of an impact
 *   a long collocated step   the oscillation is small and stays clear of parting: as far as the motion along the contact allows
 *   a resolved one           most of an impact: half a turn of the oscillation and more
 *   a creeping one           far beyond critical damping, or without a spring: a radian of the motion along the contact
 *   a power series           soft contacts, short remainders: two radians of the contact or of its passage
 */
#ifndef CONTACT_PIECE_H
#define CONTACT_PIECE_H

#include "dynamics/press_collocation.h"
#include "dynamics/press_series.h"
#include "dynamics/press_straight.h"
#include "solver/watch.h"

#if SCENE_ANY_FREE

enum piece_kind { PIECE_STRAIGHT, PIECE_COLLOCATED, PIECE_SERIES };

/* How the regime of its contact ends: at s, or not within the piece (INFINITY), by what falls below zero there, to which regime. */
struct ending {
    double s;
    struct watched by;
    enum contact_regime regime;
};

struct piece {
    struct press press;
    enum contact_regime regime;
    double resolution; /* of the gap, by positions [m] */
    double tolerance;  /* the error allowed in the piece [m] */
    union {
        struct press_straight straight;
        struct press_series series;
        struct press_collocation collocation;
    } by;
    enum piece_kind kind;
    bool spans;         /* a long step: nothing happens in it */
    double unit;        /* time per s [s] */
    double end;         /* s */
    struct watch watch; /* sampled up to `end`; where closed form spans it, over the first turn;
                           of a spanning collocated piece without the oscillation */
    struct ending ending;
};

/* For those who make collocated pieces. Below this many radians of the oscillator a series is exact in one step, and the load's
 * response loses digits (oscillator_follow). */
static const double PIECE_SHORTEST = 3.0;

/* The oscillator must be faster than the motion along the contact by so much for the two to be told apart. */
static const double SEPARATION_OF_RATES = 20.0;

/* Radians of the oscillator in a resolved step: half a turn and a little more is an impact; at the nodes the oscillation, itself a
 * correction to the load of relative size (turning / settling)^2, is then known to 3e-7. */
static const double PIECE_RESOLVED = 4.0;

/* p->by.collocation has been made: sets up the rest. */
void piece_collocated(struct piece *p);

/* A step that is not more than the tolerance off anywhere, since it may end anywhere. */
bool piece_watched(struct piece *p, const struct press_outlook *outlook, double step,
                   enum collocation_kind kind);

/* A piece from the present instant over at most `longest` > 0 seconds. `tolerance` is the error allowed in it [m]. False where
 * there is none. */
bool piece_make(struct piece *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact, double longest, double tolerance);

/* The s at which d = 0, where the normal turns round, which a head-on piece does not see; INFINITY: not within it, or never, as in a
 * hollow body. */
double piece_meets_centre(const struct piece *p);

struct press_change piece_change(const struct piece *p, double s);

#endif
#endif
