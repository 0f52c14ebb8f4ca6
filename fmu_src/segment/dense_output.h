/* Dense output of a segment, location of event functions on it, and largest values of its quantities. */
#ifndef CONTACT_SEGMENT_DENSE_OUTPUT_H
#define CONTACT_SEGMENT_DENSE_OUTPUT_H

#include "segment/contact_pair.h"

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

#endif
