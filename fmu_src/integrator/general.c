/* The general segment finds terminal events and peaks, and moves the scene from one clock to another. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "flight/flight.h"
#include "integrator/general.h"
#include "integrator/general_step.h"
#include "integrator/node_forces.h"
#include "math/compiler.h"
#include "scene/evaluate.h"
#include "scene/ode.h"

/* An event is located by a step that ends close to it. If the distance is below this part of the step, the
 * rate of the event function gives the rest. */
static const double CLOSE = 1e-6;

/* A dip of an event function below zero counts only if it is deeper than this part of the function's largest
 * value plus the error of its polynomial. */
static const double NOISE = 64.0 * DBL_EPSILON;

/* Where bodies turn, a polynomial whose error is below this part of the error allowed needs no shorter step
 * to end at an event. With this part, momenta are kept to 1e-12 over a thousand impacts. */
static const double ACCURATE_WITHIN = 1e-3;

/* Largest number of trials that locate an event: each trial halves the bracket or converges quadratically. */
enum { MOST_TRIALS = 40 };

/* Largest number of Newton steps from a state that is CLOSE to an event to the event itself. */
enum { MOST_MOVES = 4 };

/*
 * The gap of bodies that fly past each other within a step is no polynomial, because d = |c| bends sharply
 * where they are nearest. d^2 is a polynomial wherever the motion is. For outer surfaces (g = d - R) the gap
 * is therefore replaced by g (1 + g/(2 R)) = (d^2 - R^2) / (2 R), for inner surfaces (g = R - d) by
 * g (1 - g/(2 R)). Each replacement has the sign and the root of the gap, and its slope at the root.
 */
static double smooth_gap(const struct general *g, int contact, double gap)
{
    const struct contact_shape shape = scene_whole_shape(g->state, contact);
    const double reach = contact_reach(&shape);
    if (contact_is_plane(&shape) || !(reach > 0.0)) {
        return gap;
    }
    const double smooth = gap * fmax(1.0 + shape.side * gap / (2.0 * reach), 0.5); /* d >= 0 */
    return isfinite(smooth) ? smooth : gap;
}

/*
 * Where the slip u passes zero, regularized friction -L (u - |u| u / (2 v_0) + ...) / v_0 bends: |u| u has a
 * jump of its second derivative. The Chebyshev coefficients do not show it before it is as large as they are.
 * Radau quadrature of |t| t over the unit interval has an error of at most this number divided by the cube of
 * the number of stages (computed for 4, 8 and 12 stages).
 */
static const double MISSED_AT_BEND = 0.15;

/* Where in a step the slip is least: the part of the step, the limit L of friction [N] and the least slip
 * [m/s] there, and the change of the slip at that rate in the whole step [m/s]. For a resistance the units
 * are N m and rad/s. */
struct bend {
    double part, limit, rate, least;
};

/* Returns the error of the impulse by friction in the step [N s]. It is less near the ends of the step, where
 * a polynomial fits the longer piece. A slip that does not reach zero is a smooth function of time, with
 * singularities at complex times; the convergence of Radau quadrature follows from their distance. */
static double missed_at_bend(const struct radau_step *p, const struct friction_law *law,
                             const struct bend *bend)
{
    const int s = p->stages->stages;
    const double end = fmin(bend->part, 1.0 - bend->part);
    const double share = fmin(MISSED_AT_BEND / (s * s * s), end * end * end);
    const double away = 2.0 * bend->least / bend->rate; /* in halves of the step */
    const double slips = bend->rate / law->slip_velocity;
    return 0.5 * bend->limit * slips * slips * p->length * share *
           pow(away + sqrt(1.0 + away * away), 1.0 - 2.0 * s);
}

/* Notes the part of the step at which friction bends between the last sample of the slip and this one, unless
 * the error is below that allowed in the impulse. */
static void note_bend(struct general *g, const struct scene_instant *at, int contact, int part, int place)
{
    const struct radau_step *p = &g->step;
    const struct vec3 slip = turning_rubbing(&g->state->turning, at, contact, part).slip;
    const struct vec3 last = g->slip[contact][part];
    const struct vec3 change = vec3_axpy(slip, -1.0, last);
    const double back = -vec3_dot(last, change);
    g->slip[contact][part] = slip;
    if (place == 0 || !(back > 0.0) || !(vec3_dot(slip, change) > 0.0)) {
        return;
    }
    const struct friction_law law = scene_friction_law(g->state, contact, part);
    const double square = vec3_dot(change, change);
    const double from = place > 1 ? p->stages->node[place - 2] : 0.0;
    const double lasts = p->stages->node[place - 1] - from;
    const struct bend bend = {.limit = friction_limit(&law, FRICTION_SLIDING, at->normal_force[contact]),
                              .part = from + lasts * back / square,
                              .rate = sqrt(square) / lasts,
                              .least = vec3_norm(vec3_axpy(last, back / square, change))};
    const int impulse = g->ode.layout.impulse[contact] + (part == OPPOSED_SLIP ? 0 : 3);
    if (law.kind == FRICTION_REGULARIZED && missed_at_bend(p, &law, &bend) * p->weight[impulse] > 1.0) {
        g->bend = fmin(g->bend, bend.part);
    }
}

/* Samples the event functions at the instant `at` of the state g->y. */
static void sample_events_at(struct general *g, double clock, const struct scene_instant *at, int place)
{
    double *events = g->events[place];
    ode_events_at(&g->ode, clock, g->y, at, events);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!g->ode.layout.met[j]) {
            continue;
        }
        g->loads[place][j][GENERAL_FORCE] = at->normal_force[j];
        g->loads[place][j][GENERAL_DEPTH] = -at->geometry[j].gap;
        const bool rubs = SCENE_ANY_FRICTION && g->step.problem.turns && contact_transmits(g->state, j);
        for (int i = 0; rubs && i < contact_opposed(g->ode.values, j); ++i) {
            note_bend(g, at, j, i, place);
        }
        for (int e = ODE_EVENTS_EACH * j; e < ODE_EVENTS_EACH * (j + 1); ++e) {
            const double size = fabs(events[e]);
            g->event_size[e] = size > g->event_size[e] ? size : g->event_size[e];
        }
        if (g->state->contact[j].regime == (int32_t)REGIME_APART && SCENE_CONTACTS > 1) {
            events[ODE_EVENTS_EACH * j] = smooth_gap(g, j, events[ODE_EVENTS_EACH * j]);
        }
    }
}

/* Returns the limit [N] with which an event function compares |F*|, see contact/friction.h. */
static double limit_of_event(const struct friction_law *law, enum friction_regime regime,
                             enum ode_event event, double normal_force)
{
    if (regime != FRICTION_STICKING) {
        return friction_limit(law, regime, normal_force);
    }
    return event == ODE_EVENT_CAP ? law->largest : law->static_coefficient * normal_force;
}

/*
 * |F*| of elastic friction has a kink where the spring passes zero, while |F*|^2 is a polynomial wherever the
 * motion is. The samples L - |F*|, where L is the limit, are therefore replaced by (L^2 - |F*|^2) / S, where
 * S is the largest L + |F*| in the step. No sample changes its sign, so that the event stays.
 */
static void smooth_limit(struct general *g, int contact, const struct friction_law *law, enum ode_event event,
                         double offset)
{
    const int e = ODE_EVENTS_EACH * contact + (int)event;
    const int count = g->step.stages->stages + 1;
    const enum friction_regime regime =
        (enum friction_regime)g->state->contact[contact].friction_regime[ode_event_part(event)];
    const double sign = regime == FRICTION_STICKING ? -1.0 : 1.0;
    double sum[RADAU_MOST_STAGES + 1]; /* L + |F*| */
    double most = 0.0;
    for (int i = 0; i < count; ++i) {
        const double limit = limit_of_event(law, regime, event, g->loads[i][contact][GENERAL_FORCE]);
        sum[i] = 2.0 * limit + sign * (g->events[i][e] - offset);
        most = fmax(most, sum[i]);
    }
    for (int i = 0; i < count && most > 0.0 && isfinite(most); ++i) {
        g->events[i][e] *= fmax(sum[i] / most, DBL_EPSILON);
    }
}

static void smooth_friction(struct general *g, int contact, int part)
{
    const enum friction_regime regime =
        (enum friction_regime)g->state->contact[contact].friction_regime[part];
    if (!contact_has_spring(g->ode.values, contact, part) || regime == FRICTION_LIFTED ||
        !contact_transmits(g->state, contact)) {
        return;
    }
    const struct friction_law law = scene_friction_law(g->state, contact, part);
    if (!friction_compares_forces(&law, regime)) {
        return;
    }
    smooth_limit(g, contact, &law, ode_stick_event(part), g->ode.offset[contact][ode_stick_event(part)]);
    if (part == OPPOSED_SLIP && regime == FRICTION_STICKING) {
        smooth_limit(g, contact, &law, ODE_EVENT_CAP, g->ode.offset[contact][ODE_EVENT_CAP]);
    }
}

/* Samples the event functions at the start of the step and at all Radau stages, once for a solved step. */
static void sample_events(struct general *g)
{
    const struct radau_step *p = &g->step;
    struct scene_instant at;
    if (g->is_sampled) {
        return;
    }
    g->is_sampled = true;
    g->bend = (double)INFINITY;
    memset(g->event_size, 0, sizeof g->event_size);
    memcpy(g->y, p->y, (size_t)g->size * sizeof *g->y);
    ode_instant(&g->ode, p->start, g->y, &at);
    sample_events_at(g, p->start, &at, 0);
    for (int i = 0; i < p->stages->stages; ++i) {
        const double clock = p->start + p->stages->node[i] * p->length;
        radau_step_stage(p, i, g->y);
        sample_events_at(g, clock, &g->at_stage[i], i + 1);
    }
    for (int k = 0; SCENE_ANY_SPRINGS && k < SCENE_CONTACTS * OPPOSED; ++k) {
        smooth_friction(g, k / OPPOSED, k % OPPOSED);
    }
}

/* Computes the Bernstein coefficients of the polynomial through a quantity's values at the start of the step
 * and all stages. The values stand `stride` doubles apart. */
static void bernstein_of(const struct radau_stages *stages, const double *values, int stride,
                         double of[RADAU_MOST_STAGES + 1])
{
    const int count = stages->stages + 1;
    for (int k = 0; k < count; ++k) {
        of[k] = 0.0;
    }
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < count; ++k) {
            of[k] += stages->bernstein[i * count + k] * values[i * stride];
        }
    }
}

/* Computes the Bernstein coefficients of one event function. Returns false where all are positive, and where
 * the function is constant. */
static bool may_fall(const struct general *g, int event, double of[RADAU_MOST_STAGES + 1], double *largest)
{
    const int count = g->step.stages->stages + 1;
    bool falls = false;
    bool changes = false;
    *largest = 0.0;
    for (int i = 0; i < count; ++i) {
        const double size = fabs(g->events[i][event]);
        *largest = size > *largest ? size : *largest;
        changes = changes || g->events[i][event] != g->events[0][event];
    }
    if (!changes) {
        return false;
    }
    bernstein_of(g->step.stages, &g->events[0][event], ODE_EVENTS, of);
    of[0] = g->events[0][event];
    of[count - 1] = g->events[count - 1][event];
    for (int k = 0; k < count; ++k) {
        falls = falls || !(of[k] > 0.0);
    }
    return falls;
}

/* Returns the event function at a place of the step, for the state given by the polynomial of the states. */
static double event_within(struct general *g, int event, double place)
{
    const struct radau_step *p = &g->step;
    const double part = radau_part(p->stages, place);
    radau_step_at(p, part, g->y);
    return ode_event(&g->ode, p->start + part * p->length, g->y, event);
}

/* Finds two neighbouring samples that enclose the first root. Returns false where no sample is at or below
 * zero, so that the function can be so between two samples only. */
static bool enclose_root(const struct general *g, int event, double ends[2])
{
    const struct radau_stages *stages = g->step.stages;
    for (int i = 1; i <= stages->stages; ++i) {
        if (!(g->events[i][event] > 0.0)) {
            ends[0] = i > 1 ? stages->place[i - 2] : 0.0;
            ends[1] = stages->place[i - 1];
            return true;
        }
    }
    return false;
}

/* Encloses a root between two samples that are both above zero, where the polynomial falls through zero at
 * `from`. The event function itself is evaluated where the polynomial is lowest before the next sample. If it
 * is above zero there, the dip is an error of the polynomial, and false is returned. */
static bool enclose_dip(struct general *g, int event, const double *of, double from, double ends[2])
{
    const struct radau_stages *stages = g->step.stages;
    const int count = stages->stages + 1;
    double dip[RADAU_MOST_STAGES + 1];
    int after = 0;
    while (after + 1 < stages->stages && stages->place[after] <= from) {
        after += 1;
    }
    memcpy(dip, of, (size_t)count * sizeof *dip);
    bernstein_restrict(dip, count, from, stages->place[after]);
    for (int i = 0; i + 1 < count; ++i) {
        dip[i] -= dip[i + 1]; /* now the polynomial of the slope down, which is zero at the lowest place */
    }
    const struct bernstein_fall fall = bernstein_first_fall(dip, count - 1, 0.0);
    const double lowest = fall.low < (double)INFINITY ? bernstein_root(dip, count - 1, fall) : 1.0;
    ends[0] = after > 0 ? stages->place[after - 1] : 0.0;
    ends[1] = from + lowest * (stages->place[after] - from);
    return !(event_within(g, event, ends[1]) > 0.0);
}

/* Returns the place in the step at which the event function, evaluated along the polynomial of the states,
 * falls through zero. INFINITY: it does not.
 * The root is found by bisection and secants in turn; the polynomial of the event function gives the first
 * guess. These roots decide which event comes first. */
static double root_within(struct general *g, int event, const double *of, double guess)
{
    double ends[2];
    double dip[2];
    const bool enclosed = enclose_root(g, event, ends);
    if (!enclosed || guess < ends[0]) {
        if (enclose_dip(g, event, of, guess, dip)) {
            ends[0] = dip[0];
            ends[1] = dip[1];
        } else if (!enclosed) {
            return (double)INFINITY;
        }
    }
    double values[2] = {event_within(g, event, ends[0]), event_within(g, event, ends[1])};
    for (int i = 0; i < MOST_TRIALS && values[0] > 0.0 && values[1] < 0.0; ++i) {
        const double secant = ends[0] + (ends[1] - ends[0]) * values[0] / (values[0] - values[1]);
        const double middle = 0.5 * (ends[0] + ends[1]);
        const bool is_guess = i == 0 && guess > ends[0] && guess < ends[1];
        const double next = is_guess ? guess : i % 3 == 2 ? middle : secant;
        if (!(next > ends[0] && next < ends[1])) {
            break;
        }
        const double value = event_within(g, event, next);
        const int side = value > 0.0 ? 0 : 1;
        const double moved = fabs(next - ends[side]);
        ends[side] = next;
        values[side] = value;
        if (moved <= DBL_EPSILON) {
            break;
        }
    }
    return fabs(values[0]) < fabs(values[1]) ? ends[0] : ends[1];
}

/* Returns the place in the step, before `limit`, at which an event function first falls through zero, by the
 * samples; INFINITY if it does not. */
static double fall_within(struct general *g, int event, double limit)
{
    const int count = g->step.stages->stages + 1;
    const double of_polynomial = g->relative * fmax(g->error_within, 1.0);
    double of[RADAU_MOST_STAGES + 1];
    double largest;
    if (!may_fall(g, event, of, &largest)) {
        return (double)INFINITY;
    }
    const double noise = NOISE * largest + of_polynomial * g->event_size[event];
    const struct bernstein_fall fall = bernstein_first_fall(of, count, noise);
    double ends[2] = {fall.low, 0.0};
    if (g->step.problem.turns && enclose_root(g, event, ends)) {
        ends[0] = fmin(ends[0], fall.low); /* the function itself may fall earlier than its polynomial */
    }
    if (!(ends[0] < limit)) {
        return (double)INFINITY;
    }
    const double by_polynomial = bernstein_root(of, count, fall);
    return g->step.problem.turns ? root_within(g, event, of, by_polynomial) : by_polynomial;
}

/* Returns the first terminal event within g->step. */
static struct general_event general_first_event(struct general *g)
{
    struct general_event first = {(double)INFINITY, -1}; /* by its place until all are compared */
    sample_events(g);
    for (int e = 0; e < ODE_EVENTS; ++e) {
        if (!g->ode.layout.met[e / ODE_EVENTS_EACH]) {
            continue;
        }
        const double place = fall_within(g, e, first.part);
        first = place < first.part ? (struct general_event){place, e} : first;
    }
    first.part = first.event < 0 ? first.part : radau_part(g->step.stages, first.part);
    return first;
}

/* Returns the rate of the event function at a part of the step [its unit/s], by a backward difference along
 * the polynomial of the states. */
static double rate_at(struct general *g, int event, double part)
{
    const struct radau_step *p = &g->step;
    const double apart = 0.02 * part;
    radau_step_at(p, part - apart, g->y);
    const double before = ode_event(&g->ode, p->start + (part - apart) * p->length, g->y, event);
    radau_step_at(p, part, g->y);
    return (ode_event(&g->ode, p->start + part * p->length, g->y, event) - before) / (apart * p->length);
}

/* Estimates the time from a state to the event [s] by the rate of the event function. */
static double missing_to(struct general *g, int event, double rate, double clock, const double *y)
{
    return rate < 0.0 ? -ode_event(&g->ode, clock, y, event) / rate : 0.0;
}

/* Solves the step again for another length, with its polynomial as guess. Returns false where the iteration
 * does not converge or the error is too large. A stiff step is judged by its error within as well, because
 * the longer step had not resolved the slip at the new end. */
static bool solve_again(struct general *g, double length)
{
    struct radau_step *p = &g->step;
    radau_step_guess_on(p, p->stages, length);
    if (!node_forces_solve(g, general_newton_share(g), NULL)) {
        return false;
    }
    const double error = general_finish_step(g);
    return (general_is_stiff(g) ? fmax(error, g->error_within) : error) <= 1.0;
}

/* Moves a state that is close to the event to the event. The rate is right to a few hundredths, so that each
 * move leaves a few hundredths of the distance. The last move leaves only rounding of the gap, so that bodies
 * whose contact ends do not overlap. */
static void move_to_event(struct general *g, int event, double rate, double *clock, double *y)
{
    const struct radau_problem *problem = &g->step.problem;
    const double most = CLOSE * g->step.length;
    for (int k = 0; k < MOST_MOVES; ++k) {
        const double back = fmin(most, *clock - g->step.start);
        const double missing = fmin(fmax(missing_to(g, event, rate, *clock, y), -back), most);
        if (fabs(missing) <= DBL_EPSILON * fabs(*clock)) {
            return;
        }
        problem->rates(problem->context, *clock, y, g->step.start_rates);
        g->step.evaluations += 1;
        for (int i = 0; i < g->size; ++i) {
            y[i] += missing * g->step.start_rates[i];
        }
        *clock += missing;
    }
}

/* Makes a step of another length and looks for the first event on its polynomial. `clock` and `y` become the
 * clock and the state at its end. */
static bool look_again(struct general *g, double length, struct general_event *found, double *clock,
                       double *y)
{
    if (!solve_again(g, length)) {
        return false;
    }
    *found = general_first_event(g);
    radau_step_at(&g->step, 1.0, y);
    *clock = g->step.start + length;
    return true;
}

/* Shortens the step so that it ends at the event `found`; `y` and `clock` become the state and the clock at
 * its end. Where the shorter step shows that the event comes later, the step ends before the event and
 * `found` becomes "no event". Returns false where no step is accurate enough.
 *
 * Where the polynomial is not accurate enough between its ends, a shorter step is made that ends at the
 * event. The event is located again on the shorter step's polynomial until both agree. A shorter step without
 * an event is made longer by what its end misses, because the next long step would only find the same event
 * and end before it again. Where no such step can be made, because friction has no direction where
 * the normal force ends, a step of half the length comes first. A stiff step is made again in any case,
 * because its polynomial may reach F_n < 0 and reverse the slip. */
static bool general_end_at(struct general *g, struct general_event *found, double *clock, double *y)
{
    struct radau_step *p = &g->step;
    for (int i = 0; i < MOST_TRIALS && found->event >= 0; ++i) {
        const double rate = rate_at(g, found->event, found->part);
        const int event = found->event;
        double length = p->length * found->part;
        const double accurate = g->step.problem.turns ? ACCURATE_WITHIN : 1.0;
        if (!(g->error_within > accurate) && !general_is_stiff(g)) {
            radau_step_at(p, found->part, y);
            *clock = p->start + length;
            move_to_event(g, event, rate, clock, y);
            return true;
        }
        if (!look_again(g, length, found, clock, y)) {
            if (!look_again(g, 0.5 * length, found, clock, y)) {
                return false;
            }
            continue;
        }
        double missing = missing_to(g, event, rate, *clock, y);
        for (int k = 0;
             k < MOST_MOVES && found->event < 0 && missing > CLOSE * length && missing < 0.1 * length; ++k) {
            length += missing;
            if (!look_again(g, length, found, clock, y)) {
                return false;
            }
            missing = missing_to(g, event, rate, *clock, y);
        }
        const bool is_first =
            found->event < 0 || found->part >= 1.0 - CLOSE; /* on the shorter step's polynomial */
        if (is_first && fabs(missing) <= CLOSE * length) {
            *found = (struct general_event){1.0, event};
            move_to_event(g, event, rate, clock, y);
            return true;
        }
    }
    return found->event < 0;
}

/* Prepares the search for peaks, after general_first_event. */
static void general_set_peaks(struct general *g)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        for (int i = 0; i < GENERAL_LOADS && g->state->contact[j].regime != REGIME_APART; ++i) {
            bernstein_of(g->step.stages, &g->loads[0][j][i], SCENE_CONTACTS * GENERAL_LOADS, g->peaks[j][i]);
        }
    }
}

static double largest_coefficient(const double *of, int count)
{
    double most = of[0];
    for (int i = 1; i < count; ++i) {
        most = of[i] > most ? of[i] : most;
    }
    return most;
}

/* Notes force and penetration at the tops of one of them between two places of the step, where it exceeds
 * what is known. The scene itself is evaluated at each top of the polynomial, so that an error of the
 * polynomial counts by its square only. Returns an upper bound of the quantity. */
static double note_tops(struct general *g, int contact, int load, const double ends[2], double known)
{
    const struct radau_step *p = &g->step;
    const int count = p->stages->stages + 1;
    double of[RADAU_MOST_STAGES + 1];
    double slope[RADAU_MOST_STAGES + 1] = {0.0};
    double from = ends[0];
    memcpy(of, g->peaks[contact][load], sizeof of);
    double most = largest_coefficient(of, count); /* the largest coefficient is an upper bound */
    if (most > known && (ends[0] > 0.0 || ends[1] < 1.0)) {
        bernstein_restrict(of, count, ends[0], ends[1]);
        most = largest_coefficient(of, count);
    }
    for (int i = 0; i + 1 < count; ++i) {
        slope[i] = of[i + 1] - of[i];
    }
    for (int i = 0; i < count && most > known; ++i) {
        const struct bernstein_fall fall = bernstein_first_fall(slope, count - 1, 0.0);
        struct scene_instant at;
        if (!(fall.low < (double)INFINITY)) {
            break;
        }
        const double top = bernstein_root(slope, count - 1, fall);
        from += top * (ends[1] - from);
        const double part = radau_part(p->stages, from);
        radau_step_at(p, part, g->y);
        ode_instant(&g->ode, p->start + part * p->length, g->y, &at);
        contact_peaks_note(&g->state->contact[contact].peaks, at.normal_force[contact],
                           -at.geometry[contact].gap);
        bernstein_restrict(slope, count - 1, top, 1.0);
        slope[0] = fmin(slope[0], 0.0); /* rounding would find the same top again */
    }
    return most;
}

/* Notes tops that exceed the peaks noted by so much that the search is worth it. Returns false if the bodies
 * may have passed each other's centre, where the force jumps and is no polynomial. */
static bool search_tops(struct general *g, const struct scene_instant *at, int contact, const double ends[2])
{
    const struct contact_peaks *noted = &g->state->contact[contact].peaks;
    const struct contact_geometry *now = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(g->state, contact);
    const enum contact_regime regime = (enum contact_regime)g->state->contact[contact].regime;
    const double by_gap = fabs(contact_force_slopes(&law, regime, now->gap, now->gap_rate).by_gap);
    const double rounding = rounding_of_gap(at, contact);
    const double worth = 1.0 + fmax(g->relative, dense_output_worth_a_search(g->ode.values));
    const struct contact_shape shape = scene_contact_shape(g->state, contact);
    const double depth = worth * noted->penetration + rounding;
    const double deepest = fmax(note_tops(g, contact, GENERAL_DEPTH, ends, depth), depth);
    if (shape.side > 0 && 2.0 * deepest > contact_reach(&shape)) {
        return false;
    }
    (void)note_tops(g, contact, GENERAL_FORCE, ends, worth * noted->force + by_gap * rounding);
    return true;
}

/* A step of twelve stages lasts five radians at most. Its parts are shorter than half an oscillation. */
static void look_for_peaks(struct general *g, struct scene_state *q, const struct scene_instant *at,
                           int contact, double from)
{
    const struct radau_step *p = &g->step;
    struct scene_output *output = &g->output[contact];
    const double first = fmax(from - p->start, 0.0) / p->length;
    const double last = fmin((q->clock - p->start) / p->length, 1.0);
    const int parts = (int)ceil((last - first) * p->stages->stages / 3);
    const double ends[2] = {radau_place(p->stages, first), radau_place(p->stages, last)};
    output->state = q;
    if (!search_tops(g, at, contact, ends)) {
        output->output.count = 0; /* the last call may have found no need */
        output->output.latest_s = -1.0;
        scene_output_note_peaks(output, from, q->clock, parts, &q->contact[contact].peaks);
    }
}

/* Notes the peaks between the clock `from`, within the step, and the present. */
static void note_peaks_within(struct general *g, struct scene_state *q, double from)
{
    struct scene_instant at;
    if (!(q->clock > from)) {
        return;
    }
    scene_now(q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime != REGIME_APART) {
            contact_peaks_note(&q->contact[j].peaks, at.normal_force[j], -at.geometry[j].gap);
            look_for_peaks(g, q, &at, j, from);
        }
    }
}

/* Turns the bodies that the step leaves out to a clock, and books the work of their external forces since the
 * start of the step. flight_restore moves them. */
static void fly_others(const struct general *g, struct scene_state *q, double clock)
{
    const struct scene_values *v = g->ode.values;
    const double start = g->step.start;
    for (int i = 0; !g->ode.layout.is_whole && i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && g->ode.layout.body[i] < 0) {
            q->external_work += flight_work(q, i, flight_body_at(v, q, i, start), start, clock - start);
        }
        if (SCENE_ANY_ROTATION && body_turns_freely(v, i) && g->ode.layout.spin[i] < 0) {
            flight_turn(q, i, clock);
        }
    }
}

/* Moves the scene to a clock within the step or at its end, and notes the peaks up to that clock. */
static void general_move_scene(struct general *g, struct scene_state *q, double clock, const double *y)
{
    const double from = q->clock;
    ode_unpack(&g->ode, q, y);
    fly_others(g, q, clock);
    q->clock = clock;
    flight_restore(q);
    note_peaks_within(g, q, from);
}

/* The error allowed in a step is this part of the tolerances, because impacts multiply errors. The relative
 * error allowed is at least LEAST_TOLERANCE, the rounding in a step and its events. */
static const double TOLERANCE_SHARE = 1e-3;
static const double LEAST_TOLERANCE = 1024.0 * DBL_EPSILON;

/* Where outputs are read within a step, the error allowed there is this part of the tolerance. Below a
 * tolerance of 2.3e-12 it is the error allowed at the end, a quarter of the tolerance at 1e-12. */
static const double READ_PART = 0.1;

static void general_rates(void *general, double clock, const double *y, double *rates)
{
    const struct general *g = general;
    ode_rates(&g->ode, clock, y, rates);
}

static void general_slopes(void *general, double clock, const double *y, double *slopes)
{
    const struct general *g = general;
    ode_jacobian(&g->ode, g->ode.layout.coupled, clock, y, slopes);
}

/* Returns the problem of the states of g->ode.layout. */
static struct radau_problem problem_of(struct general *g, const struct scene_values *v)
{
    const struct ode_layout *layout = &g->ode.layout;
    struct radau_problem problem = {.context = g,
                                    .size = layout->size,
                                    .coupled = layout->coupled,
                                    .integrals = layout->integrals,
                                    .turns = scene_turns(v),
                                    .unknowns = node_forces_unknowns(v),
                                    .groups = layout->groups,
                                    .group_end = layout->group_end,
                                    .place = g->place,
                                    .speed = g->speed,
                                    .rates = general_rates,
                                    .slopes = general_slopes};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        for (int k = 0; k < 3 && layout->body[i] >= 0; ++k) {
            g->place[problem.paired] = layout->body[i] + k;
            g->speed[problem.paired] = layout->body[i] + 3 + k;
            problem.paired += 1;
        }
    }
    return problem;
}

static bool same_layout(const struct radau_problem *a, const struct radau_problem *b)
{
    return a->size == b->size && a->coupled == b->coupled && a->integrals == b->integrals &&
           a->paired == b->paired && a->turns == b->turns && a->unknowns == b->unknowns;
}

bool general_open(struct general **slot, const struct scene_values *v, const struct integrator_memory *memory,
                  char *message)
{
    struct general trial;
    trial.ode.layout = ode_layout_of(v, NULL);
    const struct radau_problem wanted = problem_of(&trial, v);
    const int size = wanted.size;
    if (*slot == NULL || !same_layout(&(*slot)->whole, &wanted)) {
        const size_t own = (sizeof(struct general) + 15) / 16 * 16;
        const size_t nodes = (node_forces_memory() + 15) / 16 * 16;
        const size_t rows = 6 * (size_t)size * sizeof(double);
        struct general *g = memory->allocate(1, own + nodes + rows + radau_step_memory(&wanted));
        if (g == NULL) {
            snprintf(message, INTEGRATOR_MESSAGE_SIZE, "the integrator's memory could not be had");
            return false;
        }
        general_close(slot);
        *slot = g;
        g->whole = wanted;
        g->release = memory->release;
        g->nodes = (char *)g + own;
        g->y = (double *)(void *)((char *)g + own + nodes);
        g->size_of = g->y + size;
        g->end_size = g->size_of + size;
        g->per_impulse = g->end_size + size;
        g->largest_error = g->per_impulse + size;
        g->end.y = g->largest_error + size;
    }
    (*slot)->message = message;
    return true;
}

void general_close(struct general **slot)
{
    if (*slot) {
        (*slot)->release(*slot);
        *slot = NULL;
    }
}

/* Moves the scene to a clock within the last step; serves as `move` of a scene_output. */
static void move_along_step(void *memory, double clock, struct scene_state *q)
{
    struct general *g = memory;
    const struct radau_step *p = &g->step;
    radau_step_at(p, fmin((clock - p->start) / p->length, 1.0), g->y);
    ode_unpack(&g->ode, q, g->y);
}

/* Makes the segment work on q and its values. */
static void general_attach(struct general *g, struct scene_state *q)
{
    const struct scene_values *v = q->v;
    g->ode.values = v;
    g->ode.state = g->state = q;
    g->ode.layout = ode_layout_of(v, q);
    g->ode.flight = flight_body_at;
    g->size = g->ode.layout.size;
    const struct radau_problem problem = problem_of(g, v);
    radau_step_place(&g->step, &problem, g->end.y + g->whole.size);
    g->relative = fmax(TOLERANCE_SHARE * solver_relative_tolerance(v), LEAST_TOLERANCE);
    g->absolute = TOLERANCE_SHARE * solver_absolute_tolerance(v);
    g->read_share = fmin(g->relative / (READ_PART * solver_relative_tolerance(v)), 1.0);
    g->release_clock = (double)INFINITY;
    g->release_rest = 0.0;
    g->steps_to_release = 0;
    g->longest = q->general_length; /* kept in the state, so that a restored state continues bit for bit */
    g->last_length = q->general_last[0];
    g->last_error = q->general_last[1];
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        g->output[j] = (struct scene_output){
            .contact = j,
            .move = move_along_step,
            .mover = g,
            .output = {.latest_s = -1.0,
                       .worth_a_search = fmax(g->relative, dense_output_worth_a_search(v))}};
    }
}

/* Sets the offsets of the event functions at the present instant `at`. */
static void general_set_events(struct general *g, struct scene_instant *at)
{
    ode_leave_centres(g->state);
    scene_now(g->state, at);
    ode_begin(&g->ode, at, g->relative, g->absolute);
}

/* Prepares a step that starts from `q`. */
static void general_start(struct general *g, struct scene_state *q)
{
    struct scene_instant at;
    general_attach(g, q);
    g->solvable = (double)INFINITY;
    g->last_length = 0.0;
    g->step.known_length = 0.0;
    general_set_events(g, &at);
    ode_pack(&g->ode, g->y);
    general_begin(g, q->clock, g->y);
    if (SCENE_ANY_HERTZ) {
        g->longest = fmin(g->longest, general_length_of_impacts(&at));
    }
}

/* A step may go on beyond a communication point. The state of motion then stores the step's polynomial, which
 * gives the motion at that point. */

static void general_keep_step(const struct general *g, struct scene_state *q)
{
    const struct radau_step *p = &g->step;
    struct unfinished_step *kept = &q->unfinished;
    const size_t bytes = (size_t)g->size * sizeof(double);
    kept->start = p->start;
    kept->length = p->length;
    kept->end = g->end.clock;
    kept->solvable = g->solvable;
    kept->release_clock = g->release_clock;
    kept->release_rest = g->release_rest;
    kept->steps_to_release = g->steps_to_release;
    kept->stages = p->stages->stages;
    kept->pace = (int32_t)p->stages->pace;
    kept->event = g->end.event.event;
    memcpy(kept->at_start, p->y, bytes);
    memcpy(kept->at_end, g->end.y, bytes);
    memcpy(kept->weight, p->weight, bytes);
    memcpy(kept->peaks, g->peaks, sizeof kept->peaks);
    for (int k = 0; k <= p->stages->stages; ++k) {
        memcpy(kept->chebyshev[k], p->chebyshev + k * p->stride, bytes);
    }
    kept->present = q->clock;
    q->integrator_fresh = 0;
}

/* Goes on with the step that `q` stores. Returns false where `q` stores none. */
static bool general_take_up(struct general *g, struct scene_state *q)
{
    const struct unfinished_step *kept = &q->unfinished;
    if (!scene_keeps_steps(q->v) || q->integrator_fresh || q->clock != kept->present) {
        return false;
    }
    general_attach(g, q);
    const size_t bytes = (size_t)g->size * sizeof(double);
    g->solvable = kept->solvable;
    g->release_clock = kept->release_clock;
    g->release_rest = kept->release_rest;
    g->steps_to_release = kept->steps_to_release;
    g->end.clock = kept->end;
    g->end.event = (struct general_event){1.0, kept->event};
    memcpy(g->end.y, kept->at_end, bytes);
    memcpy(g->step.weight, kept->weight, bytes);
    memcpy(g->peaks, kept->peaks, sizeof g->peaks);
    radau_step_take_over(&g->step, kept->start, kept->length, kept->at_start,
                         radau_stages_of(kept->stages, (enum radau_pace)kept->pace), kept->chebyshev[0],
                         ODE_MOST_STATES);
    return true;
}

/* Moves the scene along the step to a clock within it. */
static void general_follow(struct general *g, struct scene_state *q, double clock)
{
    radau_step_at(&g->step, (clock - g->step.start) / g->step.length, g->y);
    general_move_scene(g, q, clock, g->y);
    q->unfinished.present = clock;
    q->integrator_fresh = 0;
}

void general_follow_kept(struct general *g, struct scene_state *q, double noted, double clock)
{
    q->clock = q->unfinished.present;
    if (general_take_up(g, q)) {
        q->clock = noted;
        general_follow(g, q, clock);
    }
}

/* Returns the clock of the first release under Hertz's law that the polynomial shows within the step, or
 * INFINITY. The bend of the force there makes the step inaccurate, but hardly moves the release. */
static double release_within(struct general *g)
{
    double first = (double)INFINITY;
    sample_events(g);
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        if (general_force_bends(g, j)) {
            const double place = fall_within(g, ODE_EVENTS_EACH * j + (int)ODE_EVENT_GAP, first);
            first = place > 0.0 ? fmin(first, place) : first;
        }
    }
    return first < (double)INFINITY ? g->step.start + radau_part(g->step.stages, first) * g->step.length
                                    : first;
}

/* Makes a step up to its end or its first event. Where no step can be made to end at the event, a step of
 * half that length is made first. The length is halved until the event is within rounding of the clock. */
static enum advance_result make_step(struct general *g, const struct scene_state *q, struct advance *step)
{
    struct general_end *end = &g->end;
    const double left = step->clock_end - q->clock;
    /* a step reaches beyond the end, to be read there, only where rounding allows the tolerance */
    const bool reads = g->relative <= solver_relative_tolerance(g->ode.values);
    const double most = reads ? fmax(step->clock_limit - q->clock, left) : left;
    double longest = (double)INFINITY;
    double known = 0.0; /* g->longest of a step that a bend of friction has shortened */
    if (SCENE_ANY_FRICTION && g->step.problem.turns) {
        g->longest = fmin(g->longest, general_length_of_sliding(g));
    }
    for (;;) {
        if (!general_step_make(g, fmin(most, longest), left, &step->budget, release_within)) {
            return step->budget > 0 ? ADVANCE_FAILED : ADVANCE_STEP_LIMIT;
        }
        const struct general_event first = general_first_event(g);
        const double until = first.part * g->step.length;
        if (g->bend < first.part) { /* the step shall end at the bend */
            known = fmax(known, g->longest);
            longest = g->bend * g->step.length;
            g->rejected += 1;
            continue;
        }
        g->longest = fmax(g->longest, known);
        end->event = first;
        end->clock = g->step.length == left ? step->clock_end : q->clock + g->step.length;
        if (first.event < 0) {
            radau_step_at(&g->step, 1.0, end->y);
            return ADVANCE_REACHED;
        }
        if (general_end_at(g, &end->event, &end->clock, end->y)) {
            return ADVANCE_REACHED;
        }
        ode_pack(&g->ode, end->y);
        general_begin(g, q->clock, end->y);
        if (!(q->clock + 0.5 * until > q->clock)) {
            end->event = first;
            end->clock = q->clock;
            return ADVANCE_REACHED;
        }
        longest = 0.5 * until;
        step->budget += 1; /* this step is not counted: the length is halved fifty times at most */
    }
}

/* Moves the scene to the end of the step and, where an event ends it, sets the event and its regime. */
static enum advance_result end_step(struct general *g, struct scene_state *q, struct advance *step)
{
    const struct general_end *end = &g->end;
    general_move_scene(g, q, end->clock, end->y);
    if (end->event.event >= 0) {
        const enum advance_result result = advance_to_event(step, q, end->event.event);
        if (step->regime == REGIME_APART) {
            projection_end_contact(&g->ode, q, step->contact, g->relative, g->absolute);
        }
        q->contact[step->contact].schedule.dead_band_clock = q->clock * (1.0 + 16.0 * DBL_EPSILON);
        return result;
    }
    if (q->clock < step->clock_end) {
        end->y[g->ode.layout.dissipated + 1] = q->external_work; /* with that of fly_others */
        general_begin(g, q->clock, end->y);
    }
    return ADVANCE_REACHED;
}

static enum advance_result make_steps(struct general *g, struct scene_state *q, struct advance *step)
{
    enum advance_result result = ADVANCE_REACHED;
    while (result == ADVANCE_REACHED && q->clock < step->clock_end) {
        step->budget = g->step.evaluations < step->work / EVALUATION_WORK ? step->budget : 0;
        result = make_step(g, q, step);
        if (result != ADVANCE_REACHED) {
            return result;
        }
        counter_add(&q->counters.steps, 1);
        general_set_peaks(g);
        if (g->end.clock > step->clock_end) {
            general_keep_step(g, q);
            general_follow(g, q, step->clock_end);
            return ADVANCE_REACHED;
        }
        result = end_step(g, q, step);
    }
    if (result == ADVANCE_REACHED) {
        general_keep_step(g, q); /* the next call goes on from this step */
    }
    return result;
}

/* This function is not inlined, because its caller is faster while it is small. */
CONTACT_NOINLINE enum advance_result general_advance(struct general *g, struct scene_state *q,
                                                     struct advance *step)
{
    enum advance_result result = ADVANCE_REACHED;
    g->step.evaluations = 0;
    g->rejected = 0;
    if (general_take_up(g, q)) {
        if (g->end.clock > step->clock_end) {
            general_follow(g, q, step->clock_end);
            return ADVANCE_REACHED;
        }
        struct scene_instant at; /* the last call has stored a step, which ends here */
        general_set_events(g, &at);
        result = end_step(g, q, step);
    } else {
        general_start(g, q);
        const int passed =
            SCENE_CONTACTS > 1 || scene_turns(q->v) ? ode_event_passed(&g->ode, g->step.y) : -1;
        result = passed >= 0 ? advance_to_event(step, q, passed) : result;
    }
    q->integrator_fresh = 1;
    if (result == ADVANCE_REACHED) {
        result = make_steps(g, q, step);
    }
    q->general_length = isfinite(g->longest) ? g->longest : 0.0;
    q->general_last[0] = g->last_length;
    q->general_last[1] = g->last_error;
    advance_spend(step, 0, EVALUATION_WORK * (long)g->step.evaluations);
    counter_add(&q->counters.force_evaluations, g->step.evaluations);
    counter_add(&q->counters.rejected_steps, g->rejected);
    return result;
}
