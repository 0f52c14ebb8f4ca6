/* This file has the dense output of a segment: samples of it, the first event on it, and the largest values
 * on it. */
#ifndef CONTACT_SCENE_DENSE_OUTPUT_H
#define CONTACT_SCENE_DENSE_OUTPUT_H

#include <stdbool.h>

#include "scene/scene_state.h"

/* The quantities that may end a segment or have a peak. */
enum pair_quantity {
    PAIR_GAP,
    PAIR_GAP_RATE,
    PAIR_FORCE,
    PAIR_RADIAL,
    PAIR_AXIAL,
    PAIR_QUANTITIES = SCENE_ANY_CAPS ? PAIR_AXIAL + 1 : PAIR_RADIAL
};

/* A sample holds each quantity with its first two derivatives by the segment's variable s: g [m], g' as the
 * law sees it [m/s], F_n [N]; at a rim the distances of the centre beyond side and cap [m]. */
struct pair_sample {
    double of[PAIR_QUANTITIES][3];
};

typedef void dense_output_sampler(const void *segment, double s, struct pair_sample *sample);

enum { DENSE_OUTPUT_POINTS = 32 };

/* Returns the usual value of `worth_a_search` below: at most the tolerance. */
double dense_output_worth_a_search(const struct scene_values *v);

/* A segment sampled at ascending s, so densely that no quantity has two extrema between two samples. */
struct dense_output {
    dense_output_sampler *sampler;
    const void *segment;
    /* a top is looked for only if it may exceed the largest value known by this fraction of that value */
    double worth_a_search;
    int count;
    double s[DENSE_OUTPUT_POINTS];
    struct pair_sample at[DENSE_OUTPUT_POINTS];
    double latest_s; /* the s of `latest`; negative: none */
    struct pair_sample latest;
};

/* Adds a sample at s, which is larger than all s so far. */
void dense_output_add(struct dense_output *w, double s);

/* Returns the sample at any s and keeps it, until this function or a search below asks for another s. */
const struct pair_sample *dense_output_at(struct dense_output *w, double s);

/* This struct describes an event function: factor times quantity + offset. A fall through zero is an
 * event. */
struct event_function {
    enum pair_quantity quantity;
    double factor, offset;
};

/* Returns the first s at which the event function falls through zero, also after a rise from below. Returns
 * the first sample's s if the function starts below zero and stays there, and INFINITY if there is no
 * event. */
double dense_output_first_event(struct dense_output *w, const struct event_function *what);

/* Whether a value exceeds the largest known by so much that a search for a top is worth while. */
bool dense_output_is_larger(const struct dense_output *w, double value, double largest);

/* A part of a segment, and the samples at its ends. */
struct dense_range {
    double from, to;
    const struct pair_sample *first, *last;
};

/* A place of a segment, and an event function there with its slope and its bend. */
struct event_place {
    double s, of[3];
};

/* The quantities that have peaks. */
extern const struct event_function dense_output_force, dense_output_penetration;

/* Returns the place in a range where factor times quantity is largest; if `known` is larger, it is the value
 * at the place. */
struct event_place dense_output_largest(struct dense_output *w, const struct event_function *what,
                                        const struct dense_range *range, double known);

/*
 * These functions serve the dense output of a contact without a segment: its motion is prescribed, or an
 * integrator computes it between the ends of its steps. The samples show the largest force and penetration.
 */

struct scene_output {
    const struct scene_state *state; /* regimes and paths */
    int contact;
    /* moves the free bodies to their places at a clock; NULL: no body is free */
    void (*move)(void *mover, double clock, struct scene_state *q);
    void *mover;
    struct dense_output output; /* its variable is the clock [s]; it is empty at the start */
};

/* Raises the peaks to the largest force and penetration up to the clock `to`, from the end of the last call
 * on; the first call starts at `from`. The caller chooses so many `parts` that no quantity has two extrema
 * within one. */
void scene_output_note_peaks(struct scene_output *o, double from, double to, int parts,
                             struct contact_peaks *peaks);

#endif
