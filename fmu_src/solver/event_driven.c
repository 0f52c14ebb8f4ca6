#include "solver/event_driven.h"

#if SCENE_ANY_FREE

#include <float.h>

#include "dynamics/flight.h"
#include "solver/peaks.h"

/* How far below zero the law's margin must fall for a regime to end, in parts of the largest force of the piece: a contact that
 * has just begun, or lies at rest, does not change its regime by rounding. The law is followed beyond its range for so little
 * that the impulse is off by the square of it. */
static const double HYSTERESIS = 1e-8;

/* Bodies that part at less than this part of the largest speed in the piece hardly part at all: they are held together until the gap
 * is wider than its own rounding, or a millionth of the penetration where a stiff contact is pressed in by less. A ball that
 * oscillates at the verge of parting would bounce on rounding otherwise. */
static const double CLEAN_PARTING = 1e-3;
static const double GAP_HYSTERESIS = 1e-6;

static double largest_size(const struct piece *p, enum press_quantity quantity)
{
    double largest = 0.0;
    for (int i = 0; i < p->watch.count; ++i) {
        largest = fmax(largest, fabs(p->watch.at[i].of[quantity][0]));
    }
    return largest;
}

static double parting_of(const struct piece *p, const struct scene_values *v, const struct system_instant *at,
                         int contact)
{
    struct watched overlap = {PRESS_GAP, -1.0, 0.0};
    const double s = watch_first_fall(&p->watch, &overlap);
    if (s < (double)INFINITY) {
        struct press_sample then;
        p->watch.sampler(p->watch.piece, s, &then);
        if (then.of[PRESS_RATE][0] > CLEAN_PARTING * largest_size(p, PRESS_RATE)) {
            return s;
        }
    }
    overlap.offset =
        fmin(2.0 * system_gap_resolution(v, at, contact), GAP_HYSTERESIS * largest_size(p, PRESS_GAP));
    return watch_first_fall(&p->watch, &overlap);
}

/* What ends the regime by the law: see contact_regime_margin. */
static struct watched margin_of(const struct piece *p, enum contact_regime regime)
{
    const struct contact_law *law = &p->press.law;
    const double force = HYSTERESIS * largest_size(p, PRESS_FORCE);
    const double rate = 8.0 * DBL_EPSILON * vec3_norm(p->press.flight.w[0]);
    if (regime == REGIME_PRESSING && law->dashpot == DASHPOT_NON_ADHESIVE) {
        return (struct watched){PRESS_FORCE, 1.0, force + law->damping * rate};
    }
    return (struct watched){PRESS_RATE, regime == REGIME_RECEDING ? 1.0 : -1.0, force / law->damping + rate};
}

struct ending {
    double s;
    enum contact_regime regime;
};

static struct ending first_ending(const struct piece *p, const struct scene_values *v, const struct motion *q,
                                  const struct system_instant *at, int contact)
{
    const struct contact_law *law = &p->press.law;
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    struct ending first = {(double)INFINITY, REGIME_APART};
    if (p->spans) {
        return first;
    }
    first.s = parting_of(p, v, at, contact);
    if (law->damping > 0.0 && law->dashpot != DASHPOT_UNCLAMPED) {
        const struct watched margin = margin_of(p, regime);
        const double s = watch_first_fall(&p->watch, &margin);
        if (s < first.s) {
            first.s = s;
            first.regime = contact_regime_after(law, regime);
        }
    }
    return first;
}

/* The error allowed in a piece: of what the user asks for a thousandth, for impacts multiply errors, and no less than what
 * rounding leaves. */
static double tolerance_of(const struct scene_values *v, const struct system_instant *at, int contact)
{
    const double size = at->geometry[contact].distance;
    const double asked = solver_relative_tolerance(v) * size + solver_absolute_tolerance(v);
    return fmax(1e-3 * asked, 8.0 * DBL_EPSILON * size);
}

/* Islands: the bodies that pressing contacts join. A pair alone is what pieces are made for. */
static bool pairs_are_alone(const struct scene_values *v, const struct motion *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_is_coupled(v, q, j)) {
            return false;
        }
    }
    return true;
}

/* What all pairs that press do until the first of them comes to the end of a piece or of its regime. */
struct stretch {
    struct piece piece[SCENE_CONTACTS];
    double time; /* [s] */
    int ending;  /* the contact whose regime ends then; -1: none */
    enum contact_regime next;
};

static bool add_pair(struct stretch *all, const struct scene_values *v, const struct motion *q,
                     const struct system_instant *at, int contact)
{
    struct piece *p = &all->piece[contact];
    if (at->geometry[contact].degenerate ||
        !piece_make(p, v, q, at, contact, all->time, tolerance_of(v, at, contact))) {
        return false;
    }
    const struct ending ending = first_ending(p, v, q, at, contact);
    if (ending.s <= p->end) {
        all->time = ending.s * p->unit;
        all->ending = contact;
        all->next = ending.regime;
    } else if (p->end * p->unit < all->time) {
        all->time = p->end * p->unit;
        all->ending = -1;
    }
    return true;
}

/* Pairs made before a shorter one came are made again: a piece is at its best at its end. */
static bool stretch_make(struct stretch *all, const struct scene_values *v, const struct motion *q,
                         double longest)
{
    struct system_instant at;
    double before;
    system_now(v, q, &at);
    all->time = longest;
    all->ending = -1;
    do {
        before = all->time;
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            if (contact_transmits(q, j) && j != all->ending && !add_pair(all, v, q, &at, j)) {
                return false;
            }
        }
    } while (SCENE_CONTACTS > 1 && all->time < before);
    return true;
}

/* Bodies outside islands fly. */
static void book_flights(const struct scene_values *v, struct motion *q, double time)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && !body_is_pressed(q, i, -1)) {
            struct vec3 force[3] = {q->path[i].force[0], q->path[i].force[1], q->path[i].force[2]};
            path_shift(force, 3, q->clock);
            q->external_work += flight_work(v, i, q->body[i], force, time);
        }
    }
}

static void stretch_apply(const struct stretch *all, const struct scene_values *v, struct motion *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j)) {
            const struct piece *p = &all->piece[j];
            const double s = j == all->ending || all->time < p->end * p->unit ? all->time / p->unit : p->end;
            const struct press_change change = piece_change(p, s);
            peaks_note(p, &q->contact[j], s);
            press_apply(&p->press, &change, v, q, j);
            q->counters.steps += 1;
            q->counters.force_evaluations += 1;
        }
    }
    book_flights(v, q, all->time);
    q->clock += all->time;
    flight_restore(v, q);
}

enum advance_result event_driven_advance(const struct scene_values *v, struct motion *q, struct advance *step)
{
    if (!pairs_are_alone(v, q)) {
        return ADVANCE_FAILED;
    }
    while (q->clock < step->clock_end) {
        struct stretch all;
        const double left = step->clock_end - q->clock;
        if (step->budget-- <= 0) {
            return ADVANCE_STEP_LIMIT;
        }
        if (!stretch_make(&all, v, q, left)) {
            return ADVANCE_FAILED;
        }
        stretch_apply(&all, v, q);
        if (all.ending >= 0) {
            step->contact = all.ending;
            step->regime = all.next;
            return ADVANCE_EVENT;
        }
        if (all.time >= left) {
            q->clock = step->clock_end;
        }
    }
    return ADVANCE_REACHED;
}

#endif
