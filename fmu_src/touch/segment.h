/*
 * A segment: smooth motion of one contact pair. Its users make it, sample it, advance the bodies along it and
 * stop at its terminal event; by which kind of segment it is computed is known in this folder only
 *.
 */
#ifndef CONTACT_TOUCH_SEGMENT_H
#define CONTACT_TOUCH_SEGMENT_H

#include "scene/dense_output.h"
#include "touch/hertz.h"
#include "touch/hertz_slow.h"
#include "touch/pair.h"
#include "touch/series.h"

/* Of the linear law in order of preference; the table in segment.c says why. */
enum segment_kind {
    SEGMENT_CLOSED_FORM,
    SEGMENT_AVERAGED,
    SEGMENT_RESOLVED,
    SEGMENT_OVERDAMPED,
    SEGMENT_SERIES,
    SEGMENT_HERTZ_SLOW,
    SEGMENT_HERTZ_ELASTIC
};

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
    bool gap_is_known;   /* carried, or exactly zero: without that rounding */
    double tolerance;    /* the error allowed in the segment [m] */
    double longest;      /* the segment need not be longer [s] */
    double unit, end;    /* time per s [s], see segment_time; the segment covers s from 0 to `end` */
    struct dense_output output;
    struct terminal_event terminal;
    bool leaves_zone; /* the terminal event: the zone of a capped cylinder ends, and the regime goes on */
    bool may_be_slow; /* under Hertz's law, and to be looked at */
    int work;         /* that it took to make it, in steps in closed form (integrator/phases.h) */
    /* Below: for the kinds and the search for peaks. */
    enum segment_kind kind;
    union {
        struct pair_oscillation oscillation;
        struct pair_collocation collocation;
        struct pair_series series;
        struct hertz_elastic hertz_elastic;
        struct hertz_slow hertz_slow;
    } as;
    struct pair_timescales scales;    /* of all kinds but the closed form */
    bool event_free;                  /* known to have no event */
    bool clear_of_centre;             /* known not to meet d = 0 */
    double largest_gap, largest_rate; /* |g| [m] and |g'| [m/s] at most; 0: as the samples say */
};

/* A segment from the present instant over at most `longest` > 0 seconds. `tolerance` is the error allowed in
 * it [m]. False where there is none. */
bool segment_make(struct segment *p, const struct scene_values *v, const struct scene_state *q,
                  const struct scene_instant *at, int contact, double longest, double tolerance);

/* The time since the segment's start at s [s], and the s in [0, end] of such a time. */
double segment_time(const struct segment *p, double s);
double segment_place(const struct segment *p, double time);

/* Gap, gap rate and force with two derivatives at s in [0, end]. */
const struct pair_sample *segment_sample(struct segment *p, double s);

/* Moves the bodies to s, books impulse, energies, work and peaks of the contact, but not the clock. */
void segment_advance(struct segment *p, double s, const struct scene_values *v, struct scene_state *q,
                     int contact);

/* The kinds of segment. Of each, `applies` says whether the problem is of the form that it solves, and `make`
 * makes it over p->longest or less; false where it would not be accurate to p->tolerance. */

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

/* Under Hertz's law without damping, head-on: up to the release. p->terminal is known. */
bool hertz_elastic_applies(const struct segment *p);
bool hertz_elastic_segment_make(struct segment *p);

/* Any contact. False where p->may_be_slow and the first coefficients show that it is. At rest at the touch
 * under Hertz's law the force is nothing beside the load for a while: then that is how long p->longest is.
 * Under that law p->terminal is known. */
bool series_applies(const struct segment *p);
bool series_make(struct segment *p);

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

/* What the averaged, resolved and overdamped kinds share. */

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

/* Where a segment leaves the zone of a capped cylinder that it is made for (shape.h): a terminal event, after
 * which the regime goes on in the next zone. Without capped cylinders there is none. */

/* Ends the segment there, if that is before p->terminal. */
void zone_end_note(struct segment *p);

/* For how long a segment inside the solid may be, so that no change of the nearest face is missed [s]. */
double zone_longest_inside(const struct segment *p);

static inline bool zone_end_is_terminal(const struct segment *p)
{
    return SCENE_ANY_CAPS && p->leaves_zone;
}

#endif
