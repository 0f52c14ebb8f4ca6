/* Dense output of a segment, location of event functions on it, and largest values of its quantities. */
#ifndef CONTACT_SCENE_DENSE_OUTPUT_H
#define CONTACT_SCENE_DENSE_OUTPUT_H

#include <stdbool.h>

#include "scene/scene_state.h"

/* The quantities whose zeros are events, each with its first two derivatives with respect to the segment's
 * variable s. */
enum pair_quantity {
    PAIR_GAP,
    PAIR_GAP_RATE,
    PAIR_FORCE,
    PAIR_RADIAL,
    PAIR_AXIAL,
    PAIR_QUANTITIES = SCENE_ANY_CAPS ? PAIR_AXIAL + 1 : PAIR_RADIAL
};

struct pair_sample {
    /* g [m], g' as the law sees it [m/s], F_n [N]; at a rim how far beyond side and cap the centre is [m] */
    double of[PAIR_QUANTITIES][3];
};

typedef void dense_output_sampler(const void *segment, double s, struct pair_sample *sample);

enum { DENSE_OUTPUT_POINTS = 24 };

/* Between tops less than this part of the largest value known is not worth a search: it is less than the
 * tolerance that anybody asks for (1e-8 is the start value). */
#define DENSE_OUTPUT_WORTH_A_SEARCH 1e-9

/* A segment sampled at ascending s, so densely that no quantity has two extrema between two samples. */
struct dense_output {
    dense_output_sampler *sampler;
    const void *segment;
    /* a top that is larger than the largest value known by less than this part of it is not looked for */
    double worth_a_search;
    int count;
    double s[DENSE_OUTPUT_POINTS];
    struct pair_sample at[DENSE_OUTPUT_POINTS];
    double latest_s; /* the s of `latest`; negative: none */
    struct pair_sample latest;
};

/* Samples at one place more, beyond those there are. */
void dense_output_add(struct dense_output *w, double s);

/* Samples at the first `count` places already in w->s. */
void dense_output_sample(struct dense_output *w);

/* The sample at any s; the latest one is kept. */
const struct pair_sample *dense_output_at(struct dense_output *w, double s);

/* An event function: factor quantity + offset. The event is its fall through zero. */
struct event_function {
    enum pair_quantity quantity;
    double factor, offset;
};

/* The first s at which the event function falls through zero, also after a rise from below; the first sample
 * if it starts below zero and stays there; INFINITY if there is no event. */
double dense_output_first_event(const struct dense_output *w, const struct event_function *what);

/* Newton's method from s towards a top of factor quantity, inside [low, high]. `largest` becomes the largest
 * value met; false where no top was reached. */
bool dense_output_climb(const struct dense_output *w, const struct event_function *what, double s, double low,
                        double high, double *largest);

/* Whether a value is larger than the largest known by so much that it is worth a search. */
bool dense_output_is_larger(const struct dense_output *w, double value, double largest);

/* The larger of `known` and of factor quantity up to `end`, which may be before the last sample; `then` is
 * the sample at `end`. */
double dense_output_largest(const struct dense_output *w, const struct event_function *what, double end,
                            const struct pair_sample *then, double known);

/*
 * Dense output of a contact whose motion no segment computes: the motion is given, or an integrator knows it
 * between the ends of its steps. It finds the largest force and penetration.
 */

struct scene_output {
    const struct scene_values *values;
    const struct scene_state *state; /* regimes and paths */
    int contact;
    /* puts the free bodies where they are at a clock; NULL: the contact has none */
    void (*move)(void *mover, double clock, struct scene_state *q);
    void *mover;
    struct dense_output output; /* its variable is the clock; empty to begin with */
};

/* Takes the motion from where the last call ended, or `from`, to another clock into account for the peaks of
 * the communication step, looked at in so many parts that no quantity has two extrema within one. */
void scene_output_note_peaks(struct scene_output *o, double from, double to, int parts,
                             struct contact_peaks *peaks);

/* Where nothing turns or rubs, and the destination is no sphere: the impulse of the torque on it from one
 * clock to another, in so many panels of degree nine [N m s]. */
void scene_output_add_torque(const struct scene_output *o, double from, double to, int panels,
                             struct scene_state *q);

#endif
