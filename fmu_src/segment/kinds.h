/* The kinds of segment. Of each, `applies` says whether the problem is of the form that it solves, and `make`
 * makes it over p->longest or less; false where it would not be accurate to p->tolerance. */
#ifndef CONTACT_SEGMENT_KINDS_H
#define CONTACT_SEGMENT_KINDS_H

#include "segment/segment.h"

/* Over all of p->longest where no event follows; else over a period of the oscillation at most, or over the
 * decay. */
bool closed_form_applies(const struct segment *p);
bool closed_form_make(struct segment *p);

bool averaged_applies(const struct segment *p);
bool averaged_make(struct segment *p);

/* Up to the terminal event where that is near; p->terminal is then known. */
bool resolved_applies(const struct segment *p);
bool resolved_make(struct segment *p);

bool overdamped_applies(const struct segment *p);
bool overdamped_make(struct segment *p);

/* Under Hertz's law without damping, head-on: up to the release. */
bool hertz_elastic_applies(const struct segment *p);
bool hertz_elastic_segment_make(struct segment *p);

/* Under Hertz's law. False where p->may_be_slow and the first coefficients show that it is; or where the
 * force is nothing beside the load, as at rest at the touch, and the motion is a Taylor series over
 * p->longest, which is then as long as that lasts. Only in the former case p->may_be_slow stays. p->terminal
 * is known. */
bool hertz_applies(const struct segment *p);
bool hertz_make(struct segment *p);

/* Under a load that presses, far slower than the contact's oscillation or its decay. */
bool hertz_slow_applies(const struct segment *p);
bool hertz_slow_make(struct segment *p);

/* Whether nothing fast is left of the contact, by the first coefficients of u and the unit of s. */
bool hertz_is_slow(const struct segment *p, const double *root, double unit);

/* L: the acceleration that presses the bodies together [m/s^2]. */
double hertz_pressing_load(const struct contact_pair *from);

/* For how long the force of a contact at rest at the touch stays nothing beside the load [s], 0 where it is
 * not; and the terminal event of a segment that has been sampled, whose bodies part at s = `parting`. */
double hertz_coasting_time(const struct segment *p);
void hertz_find_terminal_event(struct segment *p, double parting);

#if SCENE_ANY_CAPS
/* At the rim of a capped cylinder, under either law; under Hertz's p->terminal is known then. False where
 * p->may_be_slow and the first coefficients show that it is. */
bool rim_applies(const struct segment *p);
bool rim_make(struct segment *p);
#endif

/* Smallest length of a collocated segment [radians of the oscillator]. Below it one Taylor step is exact, and
 * oscillator_particular loses digits. */
static const double COLLOCATED_SHORTEST = 3.0;

/* The oscillator must be faster than the motion along the contact by this factor for the two to be told
 * apart. */
static const double SEPARATION_OF_RATES = 20.0;

/* Length of a resolved segment [radians of the oscillator]: an impact takes a little more than half a period.
 * At the nodes the oscillation, whose effect on the load is of relative size (tangential_rate / oscillator's
 * rate)^2, is then accurate to 3e-7. */
static const double RESOLVED_LENGTH = 4.0;

/* What the averaged, resolved and overdamped kinds share (collocated.c). */

/* Whether the step may be long enough, and its oscillator or decay is faster than the tangential motion. */
bool collocated_applies(const struct segment *p);

/* p->as.collocation holds a step: `begin` sets up a segment without samples, `sample` samples it too. */
void collocated_begin(struct segment *p);
void collocated_sample(struct segment *p);

/* A segment within tolerance everywhere, not only at its end, since an event may end it. */
bool collocated_make(struct segment *p, double step, enum collocation_kind kind);

/* Whether local coordinates are accurate throughout the segment. */
bool collocated_stays_off_centre(const struct segment *p);

/* Error of treating an oscillation or fast decay of amplitude `a` [m] to first order: the second order of its
 * closed-form part, 4 a ratio^2 with `ratio` the tangential rate over the oscillation's; and the mean of
 * (a/d)^2 in n', which acts over `radians` of the tangential motion, 3 a^2 radians / d [m]. */
double averaged_error(double a, double ratio, double distance, double radians);

#endif
