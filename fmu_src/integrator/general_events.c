/* Terminal events of the general segment. */
#include <float.h>
#include <string.h>

#include "integrator/general_memory.h"

/* An event is put where a step of its own length has it; closer than this part of the step, by its rate. */
static const double CLOSE = 1e-6;

/* A dip below zero by so many roundings of the largest value, or by the error of the polynomial, is none. */
static const double NOISE = 64.0 * DBL_EPSILON;

/* Of the error allowed: a polynomial as accurate as this is so wherever an event of what turns is, whose
 * momenta a thousand impacts shall keep to 1e-12. */
static const double ACCURATE_WITHIN = 1e-3;

/* Each halves the length at least, or comes closer by its square. */
enum { MOST_TRIALS = 40 };

/* Newton's steps from a state that is CLOSE to the event to the event itself. */
enum { MOST_MOVES = 4 };

/*
 * The gap of bodies that fly past each other within a step is no polynomial: d = |c| has a kink, the sharper
 * the nearer they come. d^2 is one wherever the motion is. Of outer surfaces, in place of g = d - R,
 *
 *   (d^2 - R^2) / (2 R) = g (1 + g/(2 R)),   of inner ones, g = R - d,   g (1 - g/(2 R))
 *
 * which has the same sign, root and slope there.
 */
static double smooth_gap(const struct general *g, int contact, double gap)
{
    const struct contact_shape shape = scene_whole_shape(g->ode.values, g->state, contact);
    const double reach = contact_reach(&shape);
    if (contact_is_plane(&shape) || !(reach > 0.0)) {
        return gap;
    }
    const double smooth = gap * fmax(1.0 + shape.side * gap / (2.0 * reach), 0.5); /* d >= 0 */
    return isfinite(smooth) ? smooth : gap;
}

static void sample_events_at(struct general *g, double clock, int place)
{
    double *events = g->events[place];
    struct scene_instant at;
    ode_events_at(&g->ode, clock, g->y, &at, events);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        g->loads[place][j][GENERAL_FORCE] = at.normal_force[j];
        g->loads[place][j][GENERAL_DEPTH] = -at.geometry[j].gap;
    }
    for (int e = 0; e < ODE_EVENTS; ++e) {
        g->event_size[e] = fmax(g->event_size[e], fabs(events[e]));
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (g->state->contact[j].regime == (int32_t)REGIME_APART && SCENE_CONTACTS > 1) {
            events[ODE_EVENTS_EACH * j] = smooth_gap(g, j, events[ODE_EVENTS_EACH * j]);
        }
    }
}

/* Event functions at the start and at all stages. */
static void sample_events(struct general *g)
{
    const struct radau_step *p = &g->step;
    memset(g->event_size, 0, sizeof g->event_size);
    memcpy(g->y, p->y, (size_t)g->size * sizeof *g->y);
    sample_events_at(g, p->start, 0);
    for (int i = 0; i < p->stages->stages; ++i) {
        radau_step_stage(p, i, g->y);
        sample_events_at(g, p->start + p->stages->node[i] * p->length, i + 1);
    }
}

/* Bernstein coefficients of one event function; false where it is above zero everywhere. */
static bool may_fall(const struct general *g, int event, double of[BERNSTEIN_MOST], double *largest)
{
    const struct radau_stages *stages = g->step.stages;
    const int count = stages->stages + 1;
    bool falls = false;
    *largest = 0.0;
    for (int k = 0; k < count; ++k) {
        of[k] = 0.0;
    }
    for (int i = 0; i < count; ++i) {
        const double value = g->events[i][event];
        *largest = fmax(*largest, fabs(value));
        for (int k = 0; k < count; ++k) {
            of[k] += stages->bernstein[i * count + k] * value;
        }
    }
    of[0] = g->events[0][event];
    of[count - 1] = g->events[count - 1][event];
    for (int k = 0; k < count; ++k) {
        falls = falls || !(of[k] > 0.0);
    }
    return falls;
}

static bool event_is_constant(const struct general *g, int event)
{
    for (int i = 0; i <= g->step.stages->stages; ++i) {
        if (g->events[i][event] != g->events[0][event]) {
            return false;
        }
    }
    return true;
}

static double event_at(struct general *g, int event, double clock, const double *y)
{
    double all[ODE_EVENTS];
    ode_events(&g->ode, clock, y, all);
    return all[event];
}

/* The event function at a part of the step, of the state that the polynomial has there. */
static double event_within(struct general *g, int event, double part)
{
    const struct radau_step *p = &g->step;
    radau_step_at(p, part, g->y);
    return event_at(g, event, p->start + part * p->length, g->y);
}

/* Parts of the step about a root, from the samples; false where the function falls between two of them
 * only. */
static bool enclose_root(const struct general *g, int event, double ends[2])
{
    const struct radau_stages *stages = g->step.stages;
    for (int i = 1; i <= stages->stages; ++i) {
        if (!(g->events[i][event] > 0.0)) {
            ends[0] = i > 1 ? stages->node[i - 2] : 0.0;
            ends[1] = stages->node[i - 1];
            return true;
        }
    }
    return false;
}

/* The polynomial of an event function is as good as the function is smooth; the root is that of the
 * function itself, on the polynomial of the states. By halves and secants in turn. Of two events in a step
 * the first is the first by these. */
static double root_within(struct general *g, int event, double part)
{
    double ends[2];
    if (!enclose_root(g, event, ends)) {
        return part;
    }
    double values[2] = {event_within(g, event, ends[0]), event_within(g, event, ends[1])};
    for (int i = 0; i < MOST_TRIALS && values[0] > 0.0 && values[1] < 0.0; ++i) {
        const double secant = ends[0] + (ends[1] - ends[0]) * values[0] / (values[0] - values[1]);
        const double middle = 0.5 * (ends[0] + ends[1]);
        const bool is_guess = i == 0 && part > ends[0] && part < ends[1];
        const double next = is_guess ? part : i % 3 == 2 ? middle : secant;
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

/* No root is before, by the polynomial and, where that is not the last word, by the samples. */
static double earliest_root(const struct general *g, int event, double by_polynomial)
{
    double ends[2];
    const bool enclosed = g->step.problem.turns && enclose_root(g, event, ends);
    return enclosed ? fmin(ends[0], by_polynomial) : by_polynomial;
}

struct general_event general_first_event(struct general *g)
{
    struct general_event first = {(double)INFINITY, -1};
    const int count = g->step.stages->stages + 1;
    const double of_polynomial = g->relative * fmax(g->error_within, 1.0);
    sample_events(g);
    for (int e = 0; e < ODE_EVENTS; ++e) {
        double of[BERNSTEIN_MOST];
        double largest;
        if (event_is_constant(g, e) || !may_fall(g, e, of, &largest)) {
            continue;
        }
        const double noise = NOISE * largest + of_polynomial * g->event_size[e];
        const struct bernstein_fall fall = bernstein_first_fall(of, count, noise);
        if (earliest_root(g, e, fall.low) < first.part) {
            const double by_polynomial = bernstein_root(of, count, fall);
            const double part = g->step.problem.turns ? root_within(g, e, by_polynomial) : by_polynomial;
            first = part < first.part ? (struct general_event){part, e} : first;
        }
    }
    return first;
}

/* Rate of the event function along the polynomial [1/s], from its values about a place. */
static double rate_at(struct general *g, int event, double part)
{
    const struct radau_step *p = &g->step;
    const double apart = 0.02 * part;
    radau_step_at(p, part - apart, g->y);
    const double before = event_at(g, event, p->start + (part - apart) * p->length, g->y);
    radau_step_at(p, part, g->y);
    return (event_at(g, event, p->start + part * p->length, g->y) - before) / (apart * p->length);
}

/* How far the event is from a state, by its rate [s]. */
static double missing_to(struct general *g, int event, double rate, double clock, const double *y)
{
    return rate < 0.0 ? -event_at(g, event, clock, y) / rate : 0.0;
}

/* Solves the step again for another length, from the polynomial as guess. */
static bool solve_again(struct general *g, double length)
{
    struct radau_step *p = &g->step;
    if (!radau_step_guess_again(p, p->stages, length) ||
        !(g->fully ? radau_step_solve_fully : radau_step_solve)(p, general_newton_share(g))) {
        return false;
    }
    radau_step_finish(p);
    g->error_within = radau_step_error(p).within;
    return true;
}

/* The state at the event, from one that is close to it. The rate is a mean over some of the step, right to a
 * few hundredths: each time as much less is missing. The last leaves no more than rounding of the gap, so
 * that bodies that part are apart. */
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

/* A shorter step, on whose polynomial the event is looked for again; its end as `clock` and `y`. */
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

/* Where the polynomial is not as accurate within as at its end, a step of that length is made; the event is
 * where the end of that has it. Until both agree it is looked for again, on the polynomial of the shorter
 * step. Where there is no such step, as friction has no direction where the normal force ends, one of half
 * the length comes first. */
bool general_end_at(struct general *g, struct general_event *found, double *clock, double *y)
{
    struct radau_step *p = &g->step;
    for (int i = 0; i < MOST_TRIALS && found->event >= 0; ++i) {
        const double rate = rate_at(g, found->event, found->part);
        const int event = found->event;
        double length = p->length * found->part;
        if (!(g->error_within > (g->step.problem.turns ? ACCURATE_WITHIN : 1.0))) {
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
        const double missing = missing_to(g, event, rate, *clock, y);
        if (fabs(missing) <= CLOSE * length) {
            *found = (struct general_event){1.0, event};
            move_to_event(g, event, rate, clock, y);
            return true;
        }
        if (found->event < 0 && missing > 0.0 && missing < 0.1 * length &&
            !look_again(g, length + missing, found, clock, y)) {
            return false;
        }
    }
    return found->event < 0;
}
