/* Peaks of force and penetration within a step of the general segment, as the scene moves along it. */
#include <string.h>

#include "integrator/general_memory.h"
#include "scene/rounding.h"
#include "segment/flight.h"

/* Bernstein coefficients of the polynomial through the values at the start and all stages. */
static void put_coefficients(const struct general *g, int contact, int quantity, double of[BERNSTEIN_MOST])
{
    const struct radau_stages *stages = g->step.stages;
    const int count = stages->stages + 1;
    for (int k = 0; k < count; ++k) {
        of[k] = 0.0;
    }
    for (int i = 0; i < count; ++i) {
        const double value = g->loads[i][contact][quantity];
        for (int k = 0; k < count; ++k) {
            of[k] += stages->bernstein[i * count + k] * value;
        }
    }
}

void general_set_peaks(struct general *g)
{
    for (int j = 0; j < SCENE_CONTACTS && g->step.problem.turns; ++j) {
        for (int i = 0; i < GENERAL_LOADS && g->state->contact[j].regime != REGIME_APART; ++i) {
            put_coefficients(g, j, i, g->peaks[j][i]);
        }
    }
}

/* The largest coefficient between two parts of the step, which no value there exceeds. */
static double bound_between(const struct general *g, int contact, int quantity, double from, double to)
{
    const int count = g->step.stages->stages + 1;
    double of[BERNSTEIN_MOST];
    double most = -(double)INFINITY;
    memcpy(of, g->peaks[contact][quantity], sizeof of);
    bernstein_restrict(of, count, from, to);
    for (int i = 0; i < count; ++i) {
        most = fmax(most, of[i]);
    }
    return most;
}

/* Whether between the start of the part and its end, the present, nothing is larger than what has been noted
 * or is at the present, but for what the error of a step allows. */
static bool is_known(const struct general *g, const struct scene_state *q, const struct scene_instant *at,
                     int contact, double from)
{
    const struct radau_step *p = &g->step;
    const struct contact_peaks *noted = &q->contact[contact].peaks;
    const struct contact_geometry *now = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(g->ode.values, q, contact);
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const double by_gap = fabs(contact_force_slopes(&law, regime, now->gap, now->gap_rate).by_gap);
    const double rounding = rounding_of_gap(g->ode.values, at, contact);
    const double first = (from - p->start) / p->length;
    const double last = fmin((q->clock - p->start) / p->length, 1.0);
    const double worth = 1.0 + fmax(g->relative, DENSE_OUTPUT_WORTH_A_SEARCH);
    const double force = worth * noted->force + by_gap * rounding;
    const double depth = worth * noted->penetration + rounding;
    const struct contact_shape shape = scene_contact_shape(g->ode.values, q, contact);
    const bool may_pass_centre = shape.side > 0 && 2.0 * depth > contact_reach(&shape);
    return !may_pass_centre && bound_between(g, contact, GENERAL_FORCE, first, last) <= force &&
           bound_between(g, contact, GENERAL_DEPTH, first, last) <= depth;
}

/* A step of twelve stages is five radians of an oscillation at most: parts of less than half a turn. */
static void look_for_peaks(struct general *g, struct scene_state *q, int contact, double from)
{
    struct scene_output *output = &g->output[contact];
    const double part = g->step.problem.turns ? fmin((q->clock - from) / g->step.length, 1.0) : 1.0;
    const int parts = (int)ceil(part * g->step.stages->stages / 3);
    if (g->step.problem.turns) {
        output->output.count = 0; /* the last call may not have looked */
        output->output.latest_s = -1.0;
    }
    output->values = g->ode.values;
    output->state = q;
    scene_output_note_peaks(output, from, q->clock, parts, &q->contact[contact].peaks);
    scene_output_add_torque(output, from, q->clock, parts, q);
}

/* From a clock within the step to the present. */
static void note_peaks_within(struct general *g, struct scene_state *q, double from)
{
    struct scene_instant at;
    const bool turns = g->step.problem.turns;
    if (!(q->clock > from)) {
        return;
    }
    if (turns) {
        scene_now(g->ode.values, q, &at);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime == REGIME_APART) {
            continue;
        }
        if (turns) {
            contact_peaks_note(&q->contact[j].peaks, at.normal_force[j], -at.geometry[j].gap);
        }
        if (!turns || !is_known(g, q, &at, j, from)) {
            look_for_peaks(g, q, j, from);
        }
    }
}

void general_move_scene(struct general *g, struct scene_state *q, double clock, const double *y)
{
    const double from = q->clock;
    ode_unpack(g->ode.values, q, y);
    q->clock = clock;
    flight_restore(g->ode.values, q);
    note_peaks_within(g, q, from);
}
