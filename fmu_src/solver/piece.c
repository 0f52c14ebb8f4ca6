#include "solver/piece.h"

#if SCENE_ANY_FREE

#include "dynamics/resolution.h"
#include "solver/ending.h"
#include "solver/resolved.h"
#include "solver/spanning.h"
#include "solver/straight_piece.h"

/* Radians of the motion along the contact in a creeping step, which must be exact in between too. */
static const double CREEPING_STEP = 1.0;

/* Nor may d grow by more than this in one that leaves the centre: n turns with 1 / d^2. */
static const double CREEPING_GROWTH = 4.0;

enum { ATTEMPTS = 12 };

static void series_piece(struct piece *p, double longest)
{
    press_series_make(&p->by.series, &p->press);
    p->kind = PIECE_SERIES;
    p->spans = false;
    p->unit = p->by.series.unit;
    p->end = fmin(p->by.series.step, longest / p->unit);
    p->watch.sampler = press_series_sample;
    p->watch.piece = &p->by.series;
    p->watch.seen_s = -1.0;
    /* A step is a fifth of the radius of convergence at most (SERIES_ORDER); within a quarter of it, a twentieth of the
     * radius, no quantity of the contact turns twice. */
    p->watch.count = 5;
    for (int i = 0; i < p->watch.count; ++i) {
        p->watch.s[i] = p->end * i / (p->watch.count - 1);
    }
    watch_sample(&p->watch);
}

/* At half the fast decay's time, once, twice, four times it and so on, as long as they come before the nodes: no quantity turns twice between them. */
static void add_decay_places(struct piece *p)
{
    const struct lobatto *nodes = p->by.collocation.step.nodes;
    const double first = 0.5 / oscillator_rates_of(&p->by.collocation.step.oscillator).faster;
    double s = 0.0;
    while (s < 1.0 + nodes->node[2] && p->watch.count < WATCH_POINTS - LOBATTO_MOST) {
        press_collocation_sample(&p->by.collocation, s, &p->watch.at[p->watch.count]);
        p->watch.s[p->watch.count++] = s;
        s = fmax(first, 2.0 * s);
    }
}

void piece_collocated(struct piece *p)
{
    p->kind = PIECE_COLLOCATED;
    p->spans = p->by.collocation.step.kind == COLLOCATION_SPANNING;
    p->unit = p->by.collocation.step.half;
    p->end = 2.0;
    p->watch.sampler = press_collocation_sample;
    p->watch.piece = &p->by.collocation;
    p->watch.seen_s = -1.0;
    p->watch.count = 0;
    if (p->by.collocation.step.kind == COLLOCATION_CREEPING) {
        add_decay_places(p);
    }
    const struct lobatto *nodes = p->by.collocation.step.nodes;
    for (int i = 0; i < nodes->points; ++i) {
        const double s = 1.0 + nodes->node[i];
        if (p->watch.count == 0 || s > p->watch.s[p->watch.count - 1]) {
            struct press_sample *at = &p->watch.at[p->watch.count];
            if (p->spans) {
                press_collocation_sample_slow(&p->by.collocation, s, at);
            } else {
                press_collocation_sample_node(&p->by.collocation, i, at);
            }
            p->watch.s[p->watch.count++] = s;
        }
    }
}

bool piece_watched(struct piece *p, const struct press_outlook *outlook, double step,
                   enum collocation_kind kind)
{
    if (!press_collocation_make(&p->by.collocation, &p->press, outlook, step, kind, &lobatto[LOBATTO_TWELVE],
                                0.1 * p->tolerance) ||
        !(p->by.collocation.step.interior_error <= p->tolerance)) {
        return false;
    }
    piece_collocated(p);
    return true;
}

/* Whether a creeping step may leave out what it does of a fast decay of such an amplitude [m]. */
static bool may_creep(const struct piece *p, const struct press_outlook *outlook, double step, double decay)
{
    const double turning = press_turning_within(outlook, step);
    const double ratio = turning / outlook->rates.faster;
    return outlook->rates.faster >= SEPARATION_OF_RATES * turning &&
           spanning_left_out(decay, ratio, outlook->problem.reach, ratio) <= p->tolerance;
}

static bool creeping_piece(struct piece *p, const struct press_outlook *outlook, double longest)
{
    const double faster = outlook->rates.faster;
    const double slower = outlook->rates.slower;
    if (outlook->swings || faster < 4.0 * slower) {
        return false;
    }
    double step = press_step_within(outlook, fmin(longest, PIECE_SHORTEST / slower), CREEPING_STEP);
    if (press_turning_within(outlook, step) > 0.0) {
        step = fmin(step, CREEPING_GROWTH * p->press.distance / vec3_norm(outlook->problem.rate));
    }
    double decay = 0.0;
    for (int i = 0; i < ATTEMPTS && step * faster >= PIECE_SHORTEST; ++i) {
        if (may_creep(p, outlook, step, decay) && piece_watched(p, outlook, step, COLLOCATION_CREEPING)) {
            decay = fabs(p->by.collocation.step.y);
            if (may_creep(p, outlook, step, decay)) {
                return true;
            }
        }
        step *= 0.5;
    }
    return false;
}

/* A node as near to the centre as this part of the bodies' size: between the nodes it may come nearer, and d, as the sum of a large
 * and a negative number, lack digits. */
static const double NEAR_CENTRE = 0.1;

/* Whether local coordinates hold all through a collocated piece: not where the direction turns about a centre that is too near. */
static bool keeps_off_centre(const struct piece *p)
{
    const struct collocation *step = &p->by.collocation.step;
    double nearest = step->from.reach;
    for (int i = 0; i < step->nodes->points; ++i) {
        nearest = fmin(nearest, step->from.reach + step->x[i]);
    }
    if (step->straight || nearest > NEAR_CENTRE * step->from.reach) {
        return true;
    }
    return step->kind == COLLOCATION_CREEPING && !(piece_meets_centre(p) < (double)INFINITY);
}

static bool collocate(struct piece *p, double longest)
{
    const struct press_outlook outlook = press_outlook_of(&p->press);
    if (!(outlook.rates.faster * longest >= PIECE_SHORTEST) || !(outlook.problem.reach > 0.0)) {
        return false;
    }
    if (!(outlook.rates.faster >= SEPARATION_OF_RATES * outlook.turning)) {
        return false;
    }
    if (outlook.rates.slower >= SEPARATION_OF_RATES * outlook.turning &&
        spanning_piece(p, &outlook, longest)) {
        return true;
    }
    return resolved_piece(p, &outlook, longest) || creeping_piece(p, &outlook, longest);
}

static void piece_over(struct piece *p, double longest)
{
    p->watch.seen_s = -1.0;
    p->ending.s = (double)NAN;
    if (!straight_piece_make(p, longest) && !(collocate(p, longest) && keeps_off_centre(p))) {
        p->ending.s = (double)NAN;
        series_piece(p, longest);
    }
    if (isnan(p->ending.s)) {
        p->ending = ending_first(p);
    }
}

/* What a piece is off is small against what happens in all of it, not against a contact that ends in less than this part of it. */
static const double EARLY_ENDING = 1e-3;

bool piece_make(struct piece *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact, double longest, double tolerance)
{
    press_make(&p->press, v, q, at, contact);
    p->regime = (enum contact_regime)q->contact[contact].regime;
    p->resolution = resolution_of_gap(v, at, contact);
    p->tolerance = tolerance;
    piece_over(p, longest);
    if (p->kind == PIECE_COLLOCATED && p->ending.s > 0.0 && p->ending.s < EARLY_ENDING * p->end) {
        piece_over(p, 2.0 * p->ending.s * p->unit);
    }
    ending_at_centre(p);
    return p->end > 0.0;
}

/* From one place to the next a quantity may turn once, so that it comes to more than at either; not to four times as much. */
static bool stays_clear_of_centre(const struct piece *p)
{
    double deepest = 0.0;
    for (int i = 0; i < p->watch.count; ++i) {
        deepest = fmax(deepest, fabs(p->watch.at[i].of[PRESS_GAP][0]));
    }
    return 4.0 * deepest < contact_reach(&p->press.shape);
}

double piece_meets_centre(const struct piece *p)
{
    if (p->kind == PIECE_STRAIGHT || p->press.shape.side < 0 || stays_clear_of_centre(p)) {
        return (double)INFINITY; /* made where it cannot; in a hollow body it parts before */
    }
    const struct watched distance = {PRESS_GAP, p->press.shape.side, contact_reach(&p->press.shape)};
    return watch_first_fall(&p->watch, &distance);
}

struct press_change piece_change(const struct piece *p, double s)
{
    switch (p->kind) {
    case PIECE_STRAIGHT:
        return press_straight_change(&p->by.straight, s);
    case PIECE_COLLOCATED:
        return press_collocation_change(&p->by.collocation, s);
    default:
        return press_series_change(&p->by.series, s);
    }
}

#endif
