/*
 * Contacts without friction that share free bodies move by one power series (touch/expansion.h). The pace
 * belongs to the contact that is nearest to its touch or its release. Events are roots of the series of gaps
 * and forces, isolated by their Bernstein coefficients.
 */
#ifndef CONTACT_TOUCH_ISLAND_H
#define CONTACT_TOUCH_ISLAND_H

#include "touch/expansion.h"

/* An island has at most so many contacts in touch. The general segment takes larger ones. */
enum { ISLAND_MOST = SCENE_CONTACTS < 48 ? SCENE_CONTACTS : 48 };

struct island {
    struct expansion terms;
    int index[SCENE_BODIES];    /* of a body of the scene among these bodies */
    bool lives[EXPANSION_AXES]; /* whether contact forces act along an axis of the world */
    double end;                 /* the s at the end */
    double time;                /* the time from the start to the end [s] */
    int terminal;               /* the contact that changes at the end; -1: none */
    enum contact_regime next;
    struct expansion_row row[ISLAND_MOST];
    struct expansion_body body[1 + 2 * ISLAND_MOST];
};

/* Makes one series of all contacts in touch over at most `longest` seconds, up to the first contact that
 * begins, ends or changes its regime. It is exact to a few roundings. The scene must not turn. Returns false
 * where no such series exists, or where no contact oscillates by more than `quiet` [m]: the general segment
 * then takes longer steps. */
bool island_make(struct island *s, const struct scene_instant *at, double longest, double quiet);

/* Moves the bodies from the start to a time since then, and notes peaks since the time `from` [s]. The caller
 * advances the clock and all bodies without contact force. */
void island_advance(const struct island *s, double from, double time, struct scene_state *q);

#endif
