/*
 * A segment: one stretch of smooth motion in contact, by the method that covers most time for its cost:
 *
 *   closed form   head-on motion under constant acceleration: without limit, or most of an impact
 *   averaged      small oscillations, clear of g = 0: as far as the tangential motion allows
 *   resolved      most of an impact: half a period of the oscillation and more
 *   overdamped    far beyond critical damping, or without a spring: a radian of the tangential motion
 *   Taylor        soft contacts, short remainders: two radians of the contact or of its passage
 */
#ifndef CONTACT_SEGMENT_SEGMENT_H
#define CONTACT_SEGMENT_SEGMENT_H

#include "segment/dense_output.h"
#include "segment/pair_collocation.h"
#include "segment/pair_oscillation.h"
#include "segment/pair_taylor.h"

enum segment_kind { SEGMENT_CLOSED_FORM, SEGMENT_COLLOCATED, SEGMENT_TAYLOR };

/* The event that ends the regime: at s (INFINITY: not within the segment), where `function` falls through
 * zero; the regime that follows. */
struct terminal_event {
    double s;
    struct event_function function;
    enum contact_regime regime;
};

struct segment {
    struct contact_pair pair;
    enum contact_regime regime;
    double gap_rounding; /* of the gap, as positions give it [m] */
    double tolerance;    /* the error allowed in the segment [m] */
    union {
        struct pair_oscillation oscillation;
        struct pair_taylor taylor;
        struct pair_collocation collocation;
    } as;
    enum segment_kind kind;
    bool event_free; /* known to have no event */
    double unit;     /* time per s [s] */
    double end;      /* s */
    /* samples up to `end`; of an event-free closed form over the first period; of an averaged segment without
     * the oscillation */
    struct dense_output output;
    struct terminal_event terminal;
};

/* Smallest length of a collocated segment [radians of the oscillator]. Below it one Taylor step is exact, and
 * oscillator_particular loses digits. */
static const double SEGMENT_SHORTEST = 3.0;

/* The oscillator must be faster than the motion along the contact by so much for the two to be told apart. */
static const double SEPARATION_OF_RATES = 20.0;

/* Length of a resolved step [radians of the oscillator]: an impact takes a little more than half a period. At
 * the nodes the oscillation, whose effect on the load is of relative size (tangential_rate / oscillator's
 * rate)^2, is then accurate to 3e-7. */
static const double SEGMENT_RESOLVED = 4.0;

/* p->as.collocation has been made: sets up the rest. */
void segment_collocated(struct segment *p);

/* A collocated step within tolerance everywhere, not only at its end, since an event may end it. */
bool segment_controlled(struct segment *p, const struct pair_timescales *scales, double step,
                        enum collocation_kind kind);

/* A segment from the present instant over at most `longest` > 0 seconds. `tolerance` is the error allowed in
 * it [m]. False where there is none. */
bool segment_make(struct segment *p, const struct scene_values *v, const struct scene_state *q,
                  const struct scene_instant *at, int contact, double longest, double tolerance);

/* The s at which d = 0 and n reverses; INFINITY: not within the segment, or never, as in a hollow body or a
 * closed form. */
double segment_meets_centre(const struct segment *p);

struct pair_change segment_change(const struct segment *p, double s);

#endif
