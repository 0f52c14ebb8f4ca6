/*
 * A pair that presses head-on: it moves along the normal alone, under a pull along the normal that stays the same. The gap is
 * then a damped oscillator under a constant load, in closed form however long it lasts:
 *
 *   g = settled + y,   m_red y'' + p_nv y' + p_n y = 0,   settled = side m_red n.A / p_n
 *
 * Variable s = rate time, in radians of the undamped oscillator.
 */
#ifndef CONTACT_PRESS_STRAIGHT_H
#define CONTACT_PRESS_STRAIGHT_H

#include "contact/oscillator.h"
#include "dynamics/press.h"

#if SCENE_ANY_FREE

struct press_straight {
    const struct press *from;
    double rate;                  /* sqrt(p_n / m_red) [1/s] */
    struct oscillator oscillator; /* of y, per s: square 1 */
    double turn;                  /* radians of y per s: sqrt(1 - damping^2 / 4) */
    double settled;               /* [m] */
    double y, y_rate;             /* at the start, per s [m] */
    double amplitude;             /* |y| stays below it [m] */
};

/* False where the motion is of another kind, close to critical damping or beyond, or might reach the centre. */
bool press_straight_make(struct press_straight *p, const struct press *from);

/* Whether factor quantity + offset stays above zero for ever. */
bool press_straight_keeps(const struct press_straight *p, enum press_quantity quantity, double factor,
                          double offset);

/* The first s > 0 at which the gap turns; it turns again every half turn of y, pi / turn, and so does every other quantity. */
double press_straight_first_turn(const struct press_straight *p);

/* Whether the gap closes until that first turn. */
bool press_straight_closes(const struct press_straight *p);

/* The sample at a turn, one of the deepest ones or not, without sines. */
void press_straight_sample_turn(const struct press_straight *p, double s, bool deepest,
                                struct press_sample *sample);

void press_straight_sample(const void *press_straight, double s, struct press_sample *sample);

struct press_change press_straight_change(const struct press_straight *p, double s);

#endif
#endif
