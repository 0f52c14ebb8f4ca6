/*
 * A pair that presses head-on: it moves along the normal alone, under a pull along the normal that stays the same. The gap is
 * then a damped oscillator under a constant load, in closed form however long it lasts:
 *
 *   g = settled + y,   m_red y'' + p_nv y' + p_n y = 0,   settled = side m_red n.A / p_n
 *
 * Variable s = rate time, in radians of the undamped oscillator. Up to 0.97 of critical damping y oscillates, beyond it decays.
 * By a dashpot alone y = g decays towards a drift, m_red y'' + p_nv y' = side m_red n.A, with s in its decay times.
 */
#ifndef CONTACT_PRESS_STRAIGHT_H
#define CONTACT_PRESS_STRAIGHT_H

#include "contact/decay.h"
#include "contact/oscillator.h"
#include "dynamics/press.h"

#if SCENE_ANY_FREE

struct press_straight {
    const struct press *from;
    double rate;                  /* sqrt(p_n / m_red), or p_nv / m_red [1/s] */
    double stiffness;             /* m_red rate^2: p_n where there is a spring [N/m] */
    double pull;                  /* side n.A per s^2 [m] */
    struct oscillator oscillator; /* of y, per s, where there is a spring: square 1 */
    double turn;                  /* radians of y per s: sqrt(1 - damping^2 / 4); 0 where it decays */
    struct decay decay;           /* there */
    double settled;               /* the pull, or 0 by a dashpot alone [m] */
    double y, y_rate;             /* at the start, per s [m] */
    double amplitude;             /* |y| stays below it, the drift left out [m] */
};

/* False where the motion is of another kind or might reach the centre; in a hollow body the bodies part before. */
bool press_straight_make(struct press_straight *p, const struct press *from);

/* Whether factor quantity + offset stays above zero for ever. */
bool press_straight_keeps(const struct press_straight *p, enum press_quantity quantity, double factor,
                          double offset);

/* How far one goes that does not stay for ever. Where y decays, no quantity turns twice within it, and the flight that r is taken from
 * is not so long that its rounding would count: `resolution` of the gap, by positions [m]. INFINITY where y oscillates. */
double press_straight_longest(const struct press_straight *p, double resolution);

/* The first s > 0 at which the gap turns; it turns again every half turn of y, pi / turn, and so does every other quantity. */
double press_straight_first_turn(const struct press_straight *p);

/* Whether the gap closes until that first turn. */
bool press_straight_closes(const struct press_straight *p);

/* The sample at a turn of an oscillation, one of the deepest ones or not, without sines. */
void press_straight_sample_turn(const struct press_straight *p, double s, bool deepest,
                                struct press_sample *sample);

void press_straight_sample(const void *press_straight, double s, struct press_sample *sample);

struct press_change press_straight_change(const struct press_straight *p, double s);

#endif
#endif
