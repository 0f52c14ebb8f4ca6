/* What happens within a piece of pressing motion: first falls through zero and largest values of its quantities. */
#ifndef CONTACT_WATCH_H
#define CONTACT_WATCH_H

#include "dynamics/press.h"

#if SCENE_ANY_FREE

typedef void watch_sampler(const void *piece, double s, struct press_sample *sample);

enum { WATCH_POINTS = 24 };

/* A piece sampled at ascending places so close that no quantity turns twice between two of them. */
struct watch {
    watch_sampler *sampler;
    const void *piece;
    int count;
    double s[WATCH_POINTS];
    struct press_sample at[WATCH_POINTS];
    double seen_s; /* where watch_see has looked last; below zero: nowhere yet */
    struct press_sample seen;
};

/* Samples at one place more, beyond those there are. */
void watch_place(struct watch *w, double s);

/* Samples at the first `count` places already in w->s. */
void watch_sample(struct watch *w);

/* The sample at a place of its own, kept for whoever asks for the same next. */
const struct press_sample *watch_see(struct watch *w, double s);

/* factor quantity + offset */
struct watched {
    enum press_quantity quantity;
    double factor, offset;
};

/* The first s at which it falls through zero, also where it rises above zero first; the first place if it is below and
 * stays there; INFINITY if it does not. */
double watch_first_fall(const struct watch *w, const struct watched *what);

/* Largest value of factor quantity up to `end`, which may be less than the last place; `then` is the sample there. */
double watch_largest(const struct watch *w, const struct watched *what, double end,
                     const struct press_sample *then);

#endif
#endif
