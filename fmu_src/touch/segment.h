/*
 * A segment is the smooth motion of one contact pair within one regime. Its users make it, advance the bodies
 * along it and stop at its terminal event. The kind of segment is known in this folder only: each kind solves
 * one form of the problem and answers `make`, `sample`, `advance` and `moments` (the table in segment.c).
 */
#ifndef CONTACT_TOUCH_SEGMENT_H
#define CONTACT_TOUCH_SEGMENT_H

#include "math/nodes.h"
#include "math/series.h"
#include "scene/dense_output.h"
#include "touch/expansion.h"
#include "touch/pair.h"

/* The kinds that the linear law uses stand in order of preference; the table in segment.c gives the
 * reasons. */
enum segment_kind {
    SEGMENT_CLOSED_FORM,
    SEGMENT_AVERAGED,
    SEGMENT_OVERDAMPED,
    SEGMENT_SERIES,
    SEGMENT_QUASI_STATIC,
    SEGMENT_HERTZ_ELASTIC
};

/* This struct describes a contact pair by power series (series.c). Body 1 stands for the deviation of the
 * separation from its flight. */
struct pair_series {
    struct expansion terms; /* comes first: a series of a pair has the time of its expansion */
    const struct contact_pair *from;
    const struct frame_flight *flight;
    struct expansion_row row;
    struct expansion_body body[2];
    struct expansion_rim rim;
    double mismatch[EXPANSION_FLOWN];
};

/* This struct describes an undamped head-on impact under Hertz's law (hertz.c). */
struct hertz_elastic {
    const struct contact_pair *from;
    double load;     /* L [m/s^2] */
    double touch;    /* e: the square of the speed at the touch [m^2/s^2] */
    double pressed;  /* 2 L delta_max [m^2/s^2] */
    double deepest;  /* delta_max [m] */
    double start;    /* w at the start [1] */
    double end;      /* s at the release [1] */
    double end_time; /* time at the release [s] */
};

/* The event that ends a regime. */
struct terminal_event {
    double s; /* INFINITY: not within the segment; NaN: `make` has not set it, and the samples are searched */
    enum contact_regime regime; /* the regime after the event */
    bool lifts;                 /* F_n changes its sign, and with it friction; the regime goes on */
};

struct segment {
    struct contact_pair pair;
    enum contact_regime regime;
    double gap_rounding; /* rounding bound of the gap computed from positions [m] */
    bool gap_is_known;   /* the gap is carried or exactly zero: gap_rounding does not apply */
    double tolerance;    /* error allowed in the segment [m] */
    double longest;      /* the segment need not be longer [s] */
    double unit;         /* time per s, where that is constant [s]; see segment_time */
    double end;          /* the segment covers s from 0 to `end` */
    int work;            /* cost of making it, in steps in closed form (integrator/phases.h) */
    struct dense_output output;
    double parting; /* s of the release, if `make` finds it; INFINITY: none; NaN: the samples tell */
    struct terminal_event terminal;
    bool leaves_zone;         /* the terminal event leaves the zone of the shape; the regime goes on */
    bool rubs;                /* the contact has friction (rubbing.h) */
    bool may_pull;            /* it rubs and its dashpot may pull: the sign of F_n is an event */
    bool is_lifted;           /* in such a contact: F_n < 0 at the start */
    bool may_be_quasi_static; /* quasi_static_applies: the first coefficients of the series decide */
    /* Only the kinds and the search for peaks read the members below. */
    enum segment_kind kind;
    union {
        struct pair_oscillation oscillation;
        struct pair_collocation collocation;
        struct pair_series series;
        struct hertz_elastic hertz_elastic;
    } as;
    struct frame_flight flight;    /* set for all kinds but the closed forms */
    struct pair_timescales scales; /* set for the collocated kinds */
    bool clear_of_centre;          /* the segment does not meet d = 0 */
    /* bounds of the absolute values of the quantities; 0: the largest of the samples counts */
    double largest[PAIR_QUANTITIES];
};

/* Makes a segment from the present instant over at most `longest` > 0 seconds, accurate to `tolerance` [m].
 * Returns false where no segment can be made. */
bool segment_make(struct segment *p, const struct scene_instant *at, int contact, double longest,
                  double tolerance);

/* segment_time returns the time since the segment's start at s [s], and segment_pace the derivative of this
 * time by s. segment_place returns the s in [0, end] at such a time; where the end or the terminal event is
 * earlier, it returns the s of that. */
double segment_time(const struct segment *p, double s);
double segment_pace(const struct segment *p, double s);
double segment_place(const struct segment *p, double time);

/* Returns the motion from the segment's start to s. */
struct pair_change segment_change(const struct segment *p, double s);

/* Sets the first `count` moments of r from the segment's start to s (pair.h), where `change` is the motion at
 * s. All moments are zero at the start. */
void segment_moments(const struct segment *p, double s, const struct pair_change *change, int count,
                     struct vec3 moment[PAIR_MOMENTS]);

/* Returns the integral of c x r'' up to the time of `change`, by the moments of r, where `c` is the part of C
 * that counts. At a rim c has r, too. */
struct vec3 segment_lever(const struct contact_pair *pair, const struct pair_change *change,
                          const struct vec3 moment[PAIR_MOMENTS], const struct vec3 c[SEPARATION_DEGREE + 1]);

/* Returns a bound of the absolute value of a quantity in the segment. */
double segment_bound(const struct segment *p, enum pair_quantity quantity);

/* Whether the contact may become deeper than the bodies are wide. Positions then do not give the gap. */
bool segment_is_deep(const struct segment *p);

/* Moves the bodies from the start of the segment to s, books impulse, energies and work of the contact, but
 * not the clock. Notes the peaks from the place `from` on. */
void segment_advance(struct segment *p, double from, double s, struct scene_state *q, int contact);

/* The cost of making and using a segment, in steps in closed form of 3,000 instructions each: a series takes
 * 30,000 instructions, a radian of the tangential motion 125,000. */
enum { CLOSED_FORM_WORK = 1, SERIES_WORK = 10, COLLOCATED_WORK = 40 };

/*
 * The functions below belong to the kinds of segment in series.c and hertz.c. `make` makes a segment over
 * p->longest or less, and adds to p->work; it returns false where the problem is not of the form that the
 * kind solves, or where the segment would not be accurate to p->tolerance. `time` sets the time since the
 * start [s] and its derivative by s.
 */

/* This is the kind for any contact. `make` returns false where p->may_be_quasi_static and the first
 * coefficients confirm it. From rest at the touch under Hertz's law it sets p->longest to the time for which
 * the force is negligible beside the load. Under Hertz's law it finds p->parting. */
bool series_make(struct segment *p);
void series_sample(const void *pair_series, double s, struct pair_sample *sample);
struct pair_change series_advance(const void *pair_series, double s);
void series_moments(const void *pair_series, double s, const struct pair_change *change, int count,
                    struct vec3 *moment);

/* This is the kind for head-on motion under Hertz's law without damping: a segment lasts up to the release,
 * and `make` sets p->parting. */
bool hertz_elastic_make(struct segment *p);
void hertz_elastic_sample(const void *hertz_elastic, double s, struct pair_sample *sample);
struct pair_change hertz_elastic_advance(const void *hertz_elastic, double s);
void hertz_elastic_time(const void *hertz_elastic, double s, double time[3]);
void hertz_elastic_moments(const void *hertz_elastic, double s, const struct pair_change *change, int count,
                           struct vec3 *moment);

/* The quasi-static kind serves Hertz's law under a load that presses the bodies together and changes far more
 * slowly than the contact oscillates or settles. `make` leaves unit, end and samples to its caller. */
bool quasi_static_applies(const struct segment *p);
bool quasi_static_make(struct segment *p);

/* Whether the first coefficients of u = sqrt(delta) show no oscillation and no decay; `unit` is dt/ds divided
 * by u. */
bool quasi_static_is_shown(const struct segment *p, const double *root, double unit);

/* Returns the order of magnitude of the penetration to which the present speed, load and penetration lead
 * before damping makes the bodies creep [m]. With k = k_h / m_red, an impact reaches delta^(5/2) = 5/4 v^2 /
 * k, and 5/2 v / (k chi) with much damping. A load a reaches delta^(3/2) = a / k, and delta^4 = a / (2 (k
 * chi)^2) with much damping. */
double hertz_depth_to_come(const struct contact_pair *from, double opening);

/* Returns for how long the force of a contact that starts at rest at the touch stays negligible beside the
 * load [s]; 0 for any other contact. */
double hertz_coasting_time(const struct segment *p);

/* Returns the depth at which the force is negligible beside the load [m]. Bodies that come back from within
 * as large a gap have not parted: an oscillation that touches zero then has no events by rounding. */
double hertz_idle_depth(const struct contact_pair *from);

#endif
