/*
 * A segment: smooth motion of one contact pair. Its users make it, sample it, advance the bodies along it and
 * stop at its terminal event; by which kind of segment it is computed is known in this folder only
 * (kinds.h).
 */
#ifndef CONTACT_SEGMENT_SEGMENT_H
#define CONTACT_SEGMENT_SEGMENT_H

#include "segment/dense_output.h"
#include "segment/hertz_elastic.h"
#include "segment/hertz_slow.h"
#include "segment/pair_collocation.h"
#include "segment/pair_oscillation.h"
#include "segment/pair_taylor.h"
#include "segment/rim_series.h"

/* Of the linear law in order of preference; the table in segment.c says why. */
enum segment_kind {
    SEGMENT_CLOSED_FORM,
    SEGMENT_AVERAGED,
    SEGMENT_RESOLVED,
    SEGMENT_OVERDAMPED,
    SEGMENT_TAYLOR,
    SEGMENT_HERTZ_SLOW,
    SEGMENT_HERTZ_ELASTIC,
    SEGMENT_HERTZ,
    SEGMENT_RIM
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
#if SCENE_ANY_CAPS
    bool leaves_zone; /* the terminal event: the zone of a capped cylinder ends, and the regime goes on */
#endif
#if SCENE_ANY_HERTZ
    bool may_be_slow; /* under Hertz's law, and to be looked at */
#endif
    /* Below: for the kinds and the search for peaks. */
    enum segment_kind kind;
    union {
        struct pair_oscillation oscillation;
        struct pair_taylor taylor;
        struct pair_collocation collocation;
#if SCENE_ANY_HERTZ
        struct pair_hertz hertz;
        struct hertz_elastic hertz_elastic;
        struct hertz_slow hertz_slow;
#endif
#if SCENE_ANY_CAPS
        struct rim_series rim;
#endif
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
static inline double segment_time(const struct segment *p, double s)
{
#if SCENE_ANY_HERTZ
    if (p->kind == SEGMENT_HERTZ) {
        return pair_hertz_time(&p->as.hertz, s);
    }
    if (p->kind == SEGMENT_HERTZ_ELASTIC) {
        return hertz_elastic_time(&p->as.hertz_elastic, s);
    }
#endif
#if SCENE_ANY_CAPS
    if (p->kind == SEGMENT_RIM) {
        return rim_series_time(&p->as.rim, s);
    }
#endif
    return s * p->unit;
}

static inline double segment_place(const struct segment *p, double time)
{
#if SCENE_ANY_HERTZ
    if (p->kind >= SEGMENT_HERTZ_ELASTIC && !(time > 0.0)) {
        return 0.0; /* at a touch the time is of second order in s, and gives no root there */
    }
    if (p->kind == SEGMENT_HERTZ) {
        const double end = fmin(p->end, p->terminal.s);
        return !(time < segment_time(p, end)) ? end : pair_hertz_place(&p->as.hertz, time, end);
    }
    if (p->kind == SEGMENT_HERTZ_ELASTIC) {
        return hertz_elastic_place(&p->as.hertz_elastic, time);
    }
#endif
#if SCENE_ANY_CAPS
    if (p->kind == SEGMENT_RIM) {
        const double end = fmin(p->end, p->terminal.s);
        return !(time < segment_time(p, end)) ? end : rim_series_place(&p->as.rim, time, end);
    }
#endif
    return time / p->unit;
}

/* Gap, gap rate and force with two derivatives at s in [0, end]. */
const struct pair_sample *segment_sample(struct segment *p, double s);

/* Moves the bodies to s, books impulse, energies, work and peaks of the contact, but not the clock. */
void segment_advance(struct segment *p, double s, const struct scene_values *v, struct scene_state *q,
                     int contact);

#endif
