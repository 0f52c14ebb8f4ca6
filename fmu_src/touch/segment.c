#include <float.h>
#include <string.h>

#include "contact/shape.h"
#include "flight/zone_path.h"
#include "math/compiler.h"
#include "math/nodes.h"
#include "math/polynomial.h"
#include "scene/evaluate.h"
#include "touch/segment.h"

/* This part of the file finds the terminal event: which event function ends the regime, and with which
 * hysteresis. */

/* The law's margin ends a regime only once it is negative by rounding and this fraction of the load, so that
 * truncation errors do not change the regime of a contact at rest. */
static const double HYSTERESIS = 1e-8;

/* A separation slower than CLEAR_SEPARATION of the largest speed in the segment does not end the contact at g
 * = 0 if a load presses the bodies together again at once. The contact then lasts until the gap exceeds its
 * rounding bound, or GAP_HYSTERESIS of the penetration where rounding exceeds a stiff contact's compression.
 * A ball that oscillates about g = 0 would bounce on rounding otherwise. */
static const double CLEAR_SEPARATION = 1e-3;
static const double GAP_HYSTERESIS = 1e-6;

/* Lower bound of the gap up to which contact lasts [m]: products of smaller penetrations underflow. */
static const double DIED_AWAY = 1e-100;

/* An approach-only dashpot is switched at every turn of an oscillation, because nothing else damps it, until
 * the oscillation is HYSTERESIS of the penetration under the load. A damping below LIGHTEST of the critical
 * one would take more than 12,000 turns. Such a dashpot is not switched while its force is less than
 * IDLE_DASHPOT of the load and deforms the contact by less than the tolerance. */
static const double LIGHTEST = 1e-3;
static const double IDLE_DASHPOT = 1e-3;

/* Under a load that falls slowly the full law lets the bodies separate at the load's pace, r0 at most. The
 * dashpot's pull p_nv r0 holds the contact deeper by p_nv r0 / p_n than the spring alone would. Left to the
 * spring alone the contact oscillates about the falling load with speeds up to swing r0, where swing = p_nv /
 * sqrt(p_n m_red), and approaches again at up to (swing - 1) r0, which is r0 or more from critical damping on
 * (swing >= 2). Switching to the full law at that speed would begin an endless cycle, so the spring alone
 * lasts up to REBOUND swing r0. The force left out at that speed is HYSTERESIS of the load, or rounding where
 * that is more. */
static const double REBOUND = 2.0;
static const double CRITICAL_SWING = 2.0;

/* Returns the largest absolute value of a quantity in the segment: its bound in p->largest where `make` has
 * set one, else the largest of the samples. */
static double largest_size(const struct segment *p, enum pair_quantity quantity)
{
    double largest = p->largest[quantity];
    const bool known = largest > 0.0;
    for (int i = 0; i < p->output.count && !known; ++i) {
        largest = fmax(largest, fabs(p->output.at[i].of[quantity][0]));
    }
    return largest;
}

/* Returns how far the rounding of the gap rate moves the gap at most [m]. Each segment computes the gap rate
 * afresh from rounded velocities. */
static double terminal_event_gap_noise(const struct contact_pair *from)
{
    const double spring = sqrt(from->coefficients.k / from->reduced_mass);
    const double dashpot = from->coefficients.c / from->reduced_mass;
    return from->rate_rounding / fmax(spring, dashpot);
}

/* Returns the gap up to which contact lasts where the bodies separate slowly [m]. */
static double terminal_event_gap_tolerance(const struct segment *p)
{
    const double most = 2.0 * p->gap_rounding;
    if (contact_is_hertz(&p->pair.law)) { /* coasting at the touch: bodies that come back have not parted */
        return most;
    }
    const double part = GAP_HYSTERESIS * largest_size(p, PAIR_GAP);
    return part >= most ? most : fmin(most, fmax(part, fmax(terminal_event_gap_noise(&p->pair), DIED_AWAY)));
}

/* Returns k and c of the law in compression. Under Hertz's law these are the slopes of the force at the
 * segment's largest penetration. */
static struct contact_coefficients full_coefficients(const struct segment *p)
{
    const struct contact_slopes slopes =
        contact_force_slopes(&p->pair.law, REGIME_COMPRESSION, -largest_size(p, PAIR_GAP), 0.0);
    return (struct contact_coefficients){-slopes.by_gap, -slopes.by_rate};
}

/* Returns the speed of separation at which an approach-only dashpot stops, without rounding [m/s]; `open` is
 * a force [N]. */
static double separating_speed(const struct segment *p, struct contact_coefficients full, double open)
{
    const double swing = sqrt(full.k * p->pair.reduced_mass); /* force by speed, of the spring alone */
    if (full.c >= 2.0 * LIGHTEST * swing) {
        return open / fmax(full.c, swing);
    }
    return fmax(open, fmin(full.k * p->tolerance, IDLE_DASHPOT * pair_load(&p->pair))) / full.c;
}

/* Returns how far below zero the law's margin falls before the regime ends [N]. Rounding of the rate is not
 * included. */
static double hysteresis_of_force(const struct segment *p, struct contact_coefficients full)
{
    return HYSTERESIS * pair_load(&p->pair) + full.k * 8.0 * DBL_EPSILON * largest_size(p, PAIR_GAP);
}

/* The push of the full law (contact_push): a dashpot that may not pull is clipped where the push ends. Where
 * the dashpot may pull, friction lasts while the push is positive, or stays lifted while it is negative. */
static struct event_function push_margin(const struct segment *p)
{
    const double sign = p->is_lifted ? -1.0 : 1.0;
    const struct contact_law *law = &p->pair.law;
    if (contact_is_hertz(law)) {
        /* The margin 1 - chi g' is 1 at rest, so only rounding needs a hysteresis. Bodies pushed out of a
         * deep overlap move at 1/chi for long. A hysteresis in parts of the load would hold them back by that
         * part of a force far above the load. */
        const double still = 1.0 / contact_factors_of(law, REGIME_COMPRESSION).c;
        return (struct event_function){PAIR_GAP_RATE, -sign, sign * still + p->pair.rate_rounding};
    }
    const struct contact_coefficients full = full_coefficients(p);
    return (struct event_function){PAIR_FORCE, sign,
                                   hysteresis_of_force(p, full) + full.c * p->pair.rate_rounding};
}

/* Whether the law ends a regime, or the force's sign ends one of friction. */
static bool has_margin(const struct segment *p)
{
    return contact_has_events(&p->pair.law) || p->may_pull;
}

/* The law's event function (contact_event): the regime lasts while factor quantity + offset > 0. */
static struct event_function terminal_event_margin(const struct segment *p)
{
    if (p->may_pull || p->pair.law.dashpot == DASHPOT_NON_ADHESIVE) {
        return push_margin(p);
    }
    const struct contact_coefficients full = full_coefficients(p);
    const double swing = full.c / sqrt(full.k * p->pair.reduced_mass);
    /* approach speed at which the spring alone ends, divided by the separation speed r0 at which it began */
    const double rebound = full.k > 0.0 && swing >= CRITICAL_SWING ? REBOUND * swing : 1.0;
    const double separating = separating_speed(p, full, hysteresis_of_force(p, full)) + p->pair.rate_rounding;
    return p->regime == REGIME_RESTITUTION ? (struct event_function){PAIR_GAP_RATE, 1.0, rebound * separating}
                                           : (struct event_function){PAIR_GAP_RATE, -1.0, separating};
}

/* Whether bodies that part at this speed are pressed together again before the gap has grown to `room`
 * [m]. */
static bool comes_back_within(const struct segment *p, double speed, double room)
{
    const double pressing = pair_pressing_load(&p->pair);
    return pressing > 0.0 && speed * speed <= 2.0 * pressing * room;
}

/* Returns the s of the release. It is p->parting if that is known and the bodies do not come back at once;
 * else the gap tells it. */
static double parting(struct segment *p)
{
    struct event_function overlap = {PAIR_GAP, -1.0, 0.0};
    if (SCENE_ANY_HERTZ && !isnan(p->parting)) {
        const double speed = p->output.at[p->output.count - 1].of[PAIR_GAP_RATE][0];
        const bool ends = p->parting > 0.0 && p->parting <= p->end;
        const bool comes_back = ends && comes_back_within(p, speed, hertz_idle_depth(&p->pair));
        return comes_back ? (double)INFINITY : p->parting;
    }
    const double s = dense_output_first_event(&p->output, &overlap);
    if (s < (double)INFINITY) {
        const double speed = dense_output_at(&p->output, s)->of[PAIR_GAP_RATE][0];
        const double clean = CLEAR_SEPARATION * largest_size(p, PAIR_GAP_RATE);
        if (contact_is_hertz(&p->pair.law) || !(speed > p->pair.rate_rounding) ||
            (speed <= clean && comes_back_within(p, speed, GAP_HYSTERESIS * largest_size(p, PAIR_GAP)))) {
            overlap.offset = terminal_event_gap_tolerance(p);
            return dense_output_first_event(&p->output, &overlap);
        }
    }
    return s;
}

static struct terminal_event terminal_event_first(struct segment *p)
{
    struct terminal_event first = {parting(p), REGIME_APART, false};
    if (has_margin(p)) {
        const struct event_function margin = terminal_event_margin(p);
        const double s = dense_output_first_event(&p->output, &margin);
        if (s < first.s) {
            const enum contact_regime next =
                p->may_pull ? p->regime : contact_regime_after(&p->pair.law, p->regime);
            first = (struct terminal_event){s, next, p->may_pull};
        }
    }
    return first;
}

/* Between two samples a quantity may have one extremum that exceeds both, but by a factor below four. */
double segment_bound(const struct segment *p, enum pair_quantity quantity)
{
    return p->largest[quantity] > 0.0 ? p->largest[quantity] : 4.0 * largest_size(p, quantity);
}

/* Returns the s at which d = 0 and n reverses; INFINITY where that is not within the segment. */
static double terminal_event_centre(struct segment *p)
{
    if (!SCENE_ANY_CURVED || p->clear_of_centre ||
        segment_bound(p, PAIR_GAP) < contact_reach(&p->pair.shape)) {
        return (double)INFINITY;
    }
    const struct event_function distance = {PAIR_GAP, p->pair.shape.side, contact_reach(&p->pair.shape)};
    return dense_output_first_event(&p->output, &distance);
}

/* Ends the segment at d = 0 if the centre is met before p->terminal. The regime may change there. */
static void terminal_event_at_centre(struct segment *p)
{
    const double s = terminal_event_centre(p);
    if (s <= p->end && s < p->terminal.s) {
        /* the gap rate has the opposite sign beyond the centre */
        const struct pair_sample *then = dense_output_at(&p->output, s);
        const enum contact_regime next =
            contact_regime_of(&p->pair.law, then->of[PAIR_GAP][0], -then->of[PAIR_GAP_RATE][0], true);
        p->end = s;
        p->terminal = (struct terminal_event){next == p->regime ? (double)INFINITY : s, next, false};
    }
}

/* Adds samples at the first two extrema of the gap after the one sample there is. They are half a period
 * apart, so no quantity has two extrema between them. */
static void add_extrema_of_oscillation(struct dense_output *w, const struct pair_oscillation *made,
                                       double end)
{
    const double half = PI / made->omega_d;
    const double first = pair_oscillation_first_extremum(made);
    const double before = fmax(ceil((w->s[0] - first) / half), 0.0); /* extrema before the sample */
    const bool closes = made->free.y_rate < 0.0 || (made->free.y_rate == 0.0 && made->free.y > 0.0);
    bool deepest = closes == (fmod(before, 2.0) == 0.0);
    double extremum = first + before * half;
    for (; w->count < 3 && extremum < end; extremum += half) {
        pair_oscillation_sample_extremum(made, extremum, deepest, &w->at[w->count]);
        w->s[w->count++] = extremum;
        deepest = !deepest;
    }
    if (w->count < 3) {
        dense_output_add(w, end);
    }
}

/* A decay is over after this many of its times: exp(-64) is below rounding. */
static const double OVER = 64.0;

/* Adds samples between two places at 0.5, 1, 2, 4, ... times of the fast decay and of the slow one. No
 * quantity of a decay has two extrema. */
static void add_times_of_decay(struct dense_output *w, struct oscillator_rates rates, double from, double to)
{
    double s = fmax(0.5 / rates.faster, 2.0 * from);
    while (s < to && w->count < DENSE_OUTPUT_POINTS - LOBATTO_MAX) {
        dense_output_add(w, s);
        s = fmax(2.0 * s, s * rates.faster > OVER ? 0.5 / rates.slower : 0.0);
    }
}

/* This is the smallest length of a collocated segment [radians of the oscillator]. Over a shorter one a
 * single Taylor step is exact, and oscillator_particular loses digits. */
static const double COLLOCATED_SHORTEST = 3.0;

/* The oscillation and the tangential motion are treated apart where the oscillator's rate is at least this
 * many times the tangential rate. */
static const double SEPARATION_OF_RATES = 20.0;

/* Whether the step may be long enough, the oscillator or its decay is faster than the tangential motion, and
 * the law's rate is that of the gap. */
static bool collocated_applies(const struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    return !p->pair.has_mismatch && scales->problem.reach > 0.0 &&
           scales->rates.faster * p->longest >= COLLOCATED_SHORTEST &&
           scales->rates.faster >= SEPARATION_OF_RATES * scales->tangential_rate;
}

/* Adds samples from `from` on, first at the times of the decays and then at the nodes up to `to`, so that no
 * quantity has two extrema between two samples. The nodes show the extrema of the motion under the load. */
static void add_decay_samples(const struct segment *p, struct dense_output *w, double from, double to)
{
    const struct oscillator *decays = &p->as.collocation.step.result.oscillator;
    dense_output_add(w, from);
    add_times_of_decay(w, oscillator_rates_of(decays), from, fmin(nodal_place(2), to));
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const double s = nodal_place(i);
        if (s > w->s[w->count - 1] && s < to) {
            dense_output_add(w, s);
        }
    }
    dense_output_add(w, to);
}

/* Sets up the segment and its samples from the step in p->as.collocation. */
static void collocated_sample(struct segment *p)
{
    p->as.collocation.from = &p->pair;
    p->unit = p->as.collocation.step.half;
    p->end = 2.0;
    p->output.count = 0;
    if (p->kind == SEGMENT_OVERDAMPED) {
        add_decay_samples(p, &p->output, 0.0, p->end);
        return;
    }
    for (; p->output.count < LOBATTO_MAX; ++p->output.count) {
        const double s = nodal_place(p->output.count);
        p->output.s[p->output.count] = s;
        pair_collocation_sample_averaged(&p->as.collocation, s, &p->output.at[p->output.count]);
    }
}

/* This is the longest averaged step [radians of the tangential motion]: twelve nodes have full accuracy over
 * it, with about 15 sweeps. */
static const double LONG_STEP = 2.5;

/* An averaged or an overdamped step is tried with at most so many lengths. */
enum { ATTEMPTS = 12 };

/* Whether a step [s] is accurate if n and H contain the oscillation or the fast decay, of amplitude `a` [m],
 * to first order only. The second order of its closed-form part is 4 a ratio^2, where `ratio` is the
 * tangential rate divided by the rate of oscillation or decay. The mean of (a/d)^2 in n' acts over `radians`
 * of the tangential motion, in which a decay has died away, and adds 3 a^2 radians / d. */
static bool first_order_suffices(const struct segment *p, double step, double a)
{
    const struct pair_timescales *scales = &p->scales;
    const bool decays = p->kind == SEGMENT_OVERDAMPED;
    const double tangential_rate = pair_tangential_rate_within(scales, step);
    const double fast = decays ? scales->rates.faster : scales->rates.slower;
    const double ratio = tangential_rate / fast;
    const double radians = decays ? ratio : tangential_rate * step;
    const double error = 4.0 * a * ratio * ratio + 3.0 * a * a / scales->problem.reach * radians;
    return fast >= SEPARATION_OF_RATES * tangential_rate && error <= p->tolerance;
}

/* A bound of a quantity in an averaged step: the averaged quantity plus sign times the envelope of the
 * oscillation. */
struct pair_bound {
    const struct pair_collocation *of;
    enum pair_quantity quantity;
    double sign;
    struct oscillator_envelope envelope;
};

static struct pair_bound pair_bound_of(const struct pair_collocation *p, enum pair_quantity quantity,
                                       double sign)
{
    return (struct pair_bound){p, quantity, sign, pair_collocation_envelope(p, quantity)};
}

/* Adds to a sample at s the envelope of the oscillation or decay that the averaged motion leaves out. */
static void pair_bound_add(const struct pair_bound *bound, double s, struct pair_sample *sample)
{
    const double decay_rate = bound->envelope.decay_rate;
    double still = bound->sign * bound->envelope.amplitude * (decay_rate > 0.0 ? exp(-decay_rate * s) : 1.0);
    for (int i = 0; i < 3; ++i) {
        sample->of[bound->quantity][i] += still;
        still *= -decay_rate;
    }
}

/* Serves as a dense_output_sampler. */
static void pair_bound_sample(const void *pair_bound, double s, struct pair_sample *sample)
{
    const struct pair_bound *bound = pair_bound;
    pair_collocation_sample_averaged(bound->of, s, sample);
    pair_bound_add(bound, s, sample);
}

/* Returns the dense output of a bound between two places of an averaged segment, by the samples that the
 * segment has at its nodes. */
static struct dense_output bound_between(const struct segment *p, const struct pair_bound *bound, double from,
                                         double end)
{
    struct dense_output w = {pair_bound_sample, bound, p->output.worth_a_search, .latest_s = -1.0};
    dense_output_add(&w, from);
    for (int i = 0; i < p->output.count; ++i) {
        const double s = p->output.s[i];
        if (s > from && s < end) {
            w.at[w.count] = p->output.at[i];
            pair_bound_add(bound, s, &w.at[w.count]);
            w.s[w.count++] = s;
        }
    }
    if (end > from) {
        dense_output_add(&w, end);
    }
    return w;
}

/* Returns the s up to which an event function surely stays positive in an averaged segment, or in one in
 * closed form. */
static double positive_until(const struct segment *p, const struct event_function *what)
{
    if (p->kind == SEGMENT_CLOSED_FORM) {
        return pair_oscillation_stays_positive(&p->as.oscillation, what) ? (double)INFINITY : 0.0;
    }
    const struct pair_bound bound =
        pair_bound_of(&p->as.collocation, what->quantity, what->factor > 0.0 ? -1.0 : 1.0);
    struct dense_output w = bound_between(p, &bound, 0.0, 2.0);
    const double first = what->factor * w.at[0].of[what->quantity][0] + what->offset;
    return first > 0.0 ? fmin(dense_output_first_event(&w, what), 2.0) : 0.0;
}

/* Returns the s up to which neither the bodies part nor the law ends the regime. */
static double event_free_until(const struct segment *p)
{
    const struct event_function overlap = {PAIR_GAP, -1.0, terminal_event_gap_tolerance(p)};
    const double parts = positive_until(p, &overlap);
    if (!(parts > 0.0) || !has_margin(p)) {
        return parts;
    }
    const struct event_function margin = terminal_event_margin(p);
    return fmin(parts, positive_until(p, &margin));
}

/* Makes a segment of head-on motion under constant acceleration: over all of p->longest where no event
 * follows. Otherwise the segment lasts a period of the oscillation at most, or as long as the decay. */
static bool closed_form_make(struct segment *p)
{
    struct pair_oscillation *made = &p->as.oscillation;
    if (!p->pair.is_head_on || contact_is_rim(&p->pair.shape) || !pair_oscillation_make(made, &p->pair)) {
        return false;
    }
    p->work += CLOSED_FORM_WORK;
    p->clear_of_centre = p->clear_of_centre || p->pair.coefficients.k > 0.0;
    p->unit = 1.0 / made->rate;
    double end = p->longest / p->unit;
    if (end * p->unit < p->longest) {
        end = nextafter(end, (double)INFINITY);
    }
    p->end = made->omega_d == 0.0 && made->free.omega_d > 0.0 ? fmin(end, PI / made->free.omega_d) : end;
    dense_output_add(&p->output, 0.0);
    if (made->omega_d > 0.0) {
        /* the samples are extrema of the gap, where the gap rate is zero */
        p->largest[PAIR_GAP] = fabs(made->equilibrium) + made->amplitude;
        p->largest[PAIR_GAP_RATE] = made->rate * made->amplitude;
        add_extrema_of_oscillation(&p->output, made, p->end);
    } else {
        const struct oscillator_rates rates = {made->free.slower, made->free.faster};
        add_times_of_decay(&p->output, rates, 0.0, p->end);
        dense_output_add(&p->output, p->end);
    }
    const bool is_event_free = !(event_free_until(p) < (double)INFINITY);
    p->terminal.s = is_event_free ? (double)INFINITY : (double)NAN;
    p->end = is_event_free ? end : p->output.s[p->output.count - 1];
    return true;
}

/* Returns the longest step to try [s], or 0 for none. A shorter step helps only where the relative
 * acceleration grows. */
static double longest_step(const struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    double step = pair_step_within(scales, p->longest, LONG_STEP);
    while (step * scales->rates.slower >= COLLOCATED_SHORTEST &&
           !first_order_suffices(p, step, scales->oscillation)) {
        step *= pair_tangential_rate_within(scales, step) > scales->tangential_rate ? 0.5 : 0.0;
    }
    return step;
}

static bool averaged_make(struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    /* an oscillation below rounding counts as none, even where no load is left */
    const double small = fmax(scales->equilibrium_depth, terminal_event_gap_noise(&p->pair));
    if (!collocated_applies(p) || scales->rates.slower < SEPARATION_OF_RATES * scales->tangential_rate ||
        !(scales->oscillation < small)) {
        return false;
    }
    const double d = scales->problem.reach;
    double step = longest_step(p);
    p->work += COLLOCATED_WORK;
    for (int i = 0; i < ATTEMPTS && step * scales->rates.slower >= COLLOCATED_SHORTEST; ++i) {
        struct pair_collocation *made = &p->as.collocation;
        const bool is_made =
            collocation_make(&made->step, &scales->problem, step, COLLOCATION_AVERAGED, 0.1 * p->tolerance);
        /* The error at the end of a step is about the square of the error in between. Ten times the square of
         * points times tail is above all measured errors. */
        const double tail = is_made ? LOBATTO_MAX * made->step.result.interior_error : 0.0;
        if (!(is_made && tail * (10.0 * tail / d) <= p->tolerance)) {
            step *= 0.5;
            continue;
        }
        collocated_sample(p);
        const double until = event_free_until(p);
        if (until >= 2.0) {
            p->terminal.s = (double)INFINITY;
            return true;
        }
        /* what is left is too short for another averaged step: series go on and locate the event */
        step = until * made->step.half - COLLOCATED_SHORTEST / scales->rates.slower;
    }
    return false;
}

/* This is the length of an overdamped segment [radians of the tangential motion]. The segment must be
 * accurate between its ends too, because an event may end it anywhere. */
static const double OVERDAMPED_STEP = 1.0;

/* Largest growth of d in an overdamped segment that begins near the centre: n' is proportional to 1 / d^2. */
static const double OVERDAMPED_GROWTH = 4.0;

/* The slow and the fast decay are treated apart where their rates differ by this factor or more. */
static const double SEPARATION_OF_DECAYS = 4.0;

/* An error of n [rad] changes the load along n by as large a part of it. Where the law has events, the
 * sweeps leave an error of less than this part of HYSTERESIS. The decay of a larger one would look as if it
 * might end the regime, segment after segment, and no averaged segment would follow. */
static const double ERROR_OF_LOAD = 1e-2;

/* Makes a step that is within tolerance everywhere, not only at its end, because an event may end it. */
static bool overdamped_make(struct segment *p)
{
    const struct pair_timescales *scales = &p->scales;
    if (!collocated_applies(p) || scales->rates.faster < SEPARATION_OF_DECAYS * scales->rates.slower) {
        return false;
    }
    p->work += COLLOCATED_WORK;
    struct collocation *made = &p->as.collocation.step;
    const double turned = ERROR_OF_LOAD * HYSTERESIS * scales->problem.reach;
    const double tolerance = has_margin(p) ? fmin(0.1 * p->tolerance, turned) : 0.1 * p->tolerance;
    const double longest = fmin(p->longest, COLLOCATED_SHORTEST / scales->rates.slower);
    double step = pair_step_within(scales, longest, OVERDAMPED_STEP);
    if (pair_tangential_rate_within(scales, step) > 0.0) {
        step = fmin(step, OVERDAMPED_GROWTH * p->pair.distance / vec3_norm(scales->problem.flown[0]));
    }
    double decay = 0.0;
    for (int i = 0; i < ATTEMPTS && step * scales->rates.faster >= COLLOCATED_SHORTEST; ++i) {
        if (first_order_suffices(p, step, decay) &&
            collocation_make(made, &scales->problem, step, COLLOCATION_OVERDAMPED, tolerance) &&
            made->result.interior_error <= p->tolerance) {
            decay = fabs(made->result.y);
            if (first_order_suffices(p, step, decay)) {
                collocated_sample(p);
                return true;
            }
        }
        step *= 0.5;
    }
    return false;
}

/* This part of the file finds the peaks of a segment: the largest force and penetration, and how far rounding
 * changes them in a very stiff contact. */

/* The number of roundings in the bounds of scene/evaluate.h. */
static const double BOUND_ROUNDINGS = 8.0;

/* This is the number of roundings in a product n.w, without the rounding of n itself. */
static const double RATE_ROUNDINGS = 2.0;

/* An error of a peak is not reported where it is below NEGLIGIBLE times the load or the peak: the forces of
 * all other contacts are no more accurate (pair.c). */
static const double NEGLIGIBLE = 1e-6;

/* The rounding of a dashpot's force at the start counts in full if that force is more than this fraction of
 * the largest force at the start, because it may then itself be the peak. */
static const double OUTWEIGHED = 0.5;

/*
 * Returns the rounding error of the largest force at the start of a segment, and sets `size` to this force
 * [N]. A gap or rate that is carried from the segment before has no new rounding, nor has one of exactly
 * zero: bodies set down where they touch, or at rest. The amplitude is the root of a sum of squares, to which
 * an error of the rate adds its own square. An error of the gap counts in full, as does an error of a
 * dashpot's force that is itself the peak.
 */
static double error_at_start(const struct segment *p, double *size)
{
    const struct contact_pair *pair = &p->pair;
    const double k = pair->coefficients.k;
    const double c = pair->coefficients.c;
    const double per_rate = sqrt(k * pair->reduced_mass);
    const double rate = fabs(pair_gap_derivative(pair));
    const double spring = fabs(k * pair->gap);
    const double load = pair_load(pair);
    const double error = p->gap_is_known ? 0.0 : k * p->gap_rounding / BOUND_ROUNDINGS;
    *size = fmax(fmax(load, spring), fmax(per_rate, c) * rate);
    if (pair->rate_is_known) {
        return error;
    }
    const double turned = contact_is_plane(&pair->shape)
                              ? 0.0
                              : p->gap_rounding / pair->distance * vec3_norm(pair->flight.w[0]);
    const double rounding = (RATE_ROUNDINGS * pair->rate_rounding + turned) / BOUND_ROUNDINGS;
    const double by_error = per_rate * rounding;
    const double swing = fmax(fabs(spring - load), per_rate * rate);
    const double longer = fmin(1.0, (per_rate * rate + 0.5 * by_error) / fmax(swing, DBL_MIN));
    return error + by_error * longer + (c * (rate + rounding) > OUTWEIGHED * *size ? c * rounding : 0.0);
}

/* Notes how far rounding changes the peaks. It is called once the peaks of a segment between two times [s]
 * are in the state. The error dies away as the oscillation does. */
static void peak_error_note(const struct segment *p, double from, double to, struct contact_state *state)
{
    struct contact_record *record = &state->record;
    double *force_error = &state->physics.force_error;
    double size;
    const double start = error_at_start(p, &size);
    const struct contact_coefficients *by = &p->pair.coefficients;
    const struct oscillator oscillator = {by->k / p->pair.reduced_mass, by->c / p->pair.reduced_mass};
    const double decay_rate = fmin(oscillator_rates_of(&oscillator).slower, 0.5 * oscillator.damping_rate);
    const double left = exp(-decay_rate * from);
    const double error = fmin(*force_error + start, DBL_MAX) * left;
    const double peak = state->peaks.force;
    *force_error = error * exp(-decay_rate * (to - from));
    if (error > NEGLIGIBLE * fmax(size * left, peak)) {
        record->force_bound = fmin(fmax(record->force_bound, peak + error), DBL_MAX);
    }
}

/* A period with fewer representable places than this is not searched: its largest value cannot be found to
 * rounding, since it is missed by (2 pi / places)^2 / 8 of the oscillation. */
static const double PLACES_OF_TURN = 4096.0;

/* An oscillation whose squared damped frequency is below this part of its squared decay rate dies away within
 * a period and does not reach its envelope (oscillator_envelope_of). */
static const double HARDLY_TURNS = 1.0 / 16.0;

/* The search about a place covers a turn of the oscillation before it and one after it, in thirds of a turn:
 * the slope has one extremum at most in a third. */
enum { THIRDS = 3 };

/* Returns the larger of `known` and of the largest value about a place of an averaged segment. */
static double largest_about(const struct segment *p, const struct event_function *what,
                            const struct dense_range *range, double place, double third, double known)
{
    struct dense_output w = {p->output.sampler, p->output.segment, p->output.worth_a_search,
                             .latest_s = -1.0};
    for (int i = -THIRDS; i <= THIRDS; ++i) {
        const double s = fmin(fmax(place + i * third, range->from), range->to);
        if (w.count == 0 || s > w.s[w.count - 1]) {
            dense_output_add(&w, s);
        }
    }
    const int last = w.count - 1;
    const struct dense_range searched = {w.s[0], w.s[last], &w.at[0], &w.at[last]};
    return dense_output_largest(&w, what, &searched, known).of[0];
}

/* Returns the largest value in a range of an averaged segment whose oscillation has this frequency. The
 * search is about each place where the quantity's upper bound (struct pair_bound) is highest between two
 * of its samples and exceeds the largest value found: a decaying oscillation may not reach the bound. An
 * oscillation too small to be searched for is left out, and one whose turns are too short to be searched
 * counts with the bound. */
static double largest_of_swinging(const struct segment *p, const struct event_function *what, double omega,
                                  const struct dense_range *range, double known)
{
    const double third = 2.0 / 3.0 * PI / omega;
    const double last = what->factor * range->last->of[what->quantity][0];
    double largest = fmax(known, last);
    struct pair_bound bound =
        pair_bound_of(&p->as.collocation, what->quantity, what->factor > 0.0 ? 1.0 : -1.0);
    const double swing = bound.envelope.amplitude * exp(-bound.envelope.decay_rate * range->from);
    const bool swings = dense_output_is_larger(&p->output, fabs(last) + swing, fabs(last));
    bound.envelope.amplitude = swings ? bound.envelope.amplitude : 0.0;
    struct dense_output w = bound_between(p, &bound, range->from, range->to);
    for (int i = 0; i + 1 < w.count; ++i) {
        const struct dense_range part = {w.s[i], w.s[i + 1], &w.at[i], &w.at[i + 1]};
        const struct event_place top = dense_output_largest(&w, what, &part, largest);
        if (!swings || THIRDS * third <= PLACES_OF_TURN * DBL_EPSILON * top.s) {
            largest = fmax(largest, top.of[0]);
        } else if (dense_output_is_larger(&w, top.of[0], largest)) {
            largest = largest_about(p, what, range, top.s, third, largest);
        }
    }
    return largest;
}

/* Returns the largest value in a range. The samples of a closed form end after its first extrema; it does not
 * grow, so that two later ones suffice. The nodes do not resolve the oscillation or decay of an averaged
 * step. */
static double largest_of(struct segment *p, const struct event_function *what,
                         const struct dense_range *range, double known)
{
    const struct oscillator *o = &p->as.collocation.step.result.oscillator;
    const bool goes_on = p->kind == SEGMENT_CLOSED_FORM && range->from > 0.0;
    if (p->kind != SEGMENT_AVERAGED && !goes_on) {
        return dense_output_largest(&p->output, what, range, known).of[0];
    }
    const double decay_square = 0.25 * o->damping_rate * o->damping_rate;
    const double omega_d2 = o->omega2 - decay_square;
    if (!goes_on && omega_d2 > HARDLY_TURNS * decay_square) {
        return largest_of_swinging(p, what, sqrt(omega_d2), range, known);
    }
    struct dense_output w = {p->output.sampler, p->output.segment, p->output.worth_a_search,
                             .latest_s = -1.0};
    if (goes_on) {
        w.s[0] = range->from;
        w.at[0] = *range->first;
        w.count = 1;
        add_extrema_of_oscillation(&w, &p->as.oscillation, range->to);
    } else {
        add_decay_samples(p, &w, range->from, range->to);
    }
    const struct dense_range whole = {range->from, range->to, &w.at[0], &w.at[w.count - 1]};
    return dense_output_largest(&w, what, &whole, known).of[0];
}

/* Raises the peaks to those of the segment between two places. */
static void peaks_note(struct segment *p, struct contact_peaks *peaks, double from, double to)
{
    const struct pair_sample last = *dense_output_at(&p->output, to);
    const struct pair_sample first = from > 0.0 ? *dense_output_at(&p->output, from) : p->output.at[0];
    const struct dense_range range = {from, to, &first, &last};
    if (p->pair.coefficients.c > 0.0 || p->pair.chi > 0.0) {
        peaks->penetration = largest_of(p, &dense_output_penetration, &range, peaks->penetration);
        peaks->force = largest_of(p, &dense_output_force, &range, peaks->force);
    } else { /* a spring's force is largest at the largest penetration */
        const double deepest = largest_of(p, &dense_output_penetration, &range, -(double)INFINITY);
        contact_peaks_note(peaks, contact_force(&p->pair.law, p->regime, -deepest, 0.0), deepest);
    }
}

/*
 * The impulse of the torque on a destination where nothing turns or rubs. The torque is c x F with F the
 * force on the source, because the lever arm of the source is along F. With c = C + r and F = -m_red r''
 * (pair.h)
 *
 *   integral of c x F = -m_red ([C x r' - C' x r + r x r'] + integral of C'' x r)
 *
 * where the moments of r give the last integral. r is along n. Of C only the part along the axis counts at
 * the side of a cylinder, and the part across n at a plane and at a cap. r x r' counts at a rim alone. A
 * destination sphere has no torque.
 */
struct torque_lever {
    int moments;                          /* how many moments of r count */
    bool acts;                            /* whether there is a torque */
    struct vec3 c[SEPARATION_DEGREE + 1]; /* part of C by which the force has a torque, by powers of time */
    /* at skew cylinders the foot of c (contact_foot), by which the destination's lever is shorter; else c */
    struct vec3 foot[SEPARATION_DEGREE + 1];
};

static struct torque_lever torque_lever_of(const struct contact_pair *pair)
{
    const struct contact_shape *shape = &pair->shape;
    struct torque_lever lever = {.moments = 0};
    for (int i = 0; SCENE_HAS_TORQUES && i <= pair->flight.degree; ++i) {
        const struct vec3 flown = pair->flight.c[i];
        struct vec3 *c = &lever.c[i];
        *c = contact_is_circle(shape) ? flown : pair_aside(pair, flown);
        lever.foot[i] = contact_is_skew(shape)
                            ? contact_across_plane(pair->normal, contact_foot_along(shape, flown))
                            : *c;
        const bool counts = !vec3_is_zero(*c) || !vec3_is_zero(lever.foot[i]);
        lever.acts = lever.acts || counts;
        lever.moments = i >= 2 && counts ? i - 1 : lever.moments;
    }
    return lever;
}

struct vec3 segment_lever(const struct contact_pair *pair, const struct pair_change *change,
                          const struct vec3 moment[PAIR_MOMENTS], const struct vec3 c[SEPARATION_DEGREE + 1])
{
    const double t = change->time;
    const int degree = pair->flight.degree;
    struct vec3 rate = {0.0, 0.0, 0.0};
    for (int i = degree; i > 0; --i) {
        rate = vec3_axpy(vec3_scale(i, c[i]), t, rate);
    }
    const struct vec3 at = path_at(c, degree + 1, t);
    struct vec3 sum = vec3_sub(vec3_cross(at, change->r_rate), vec3_cross(rate, change->r));
    if (contact_is_circle(&pair->shape)) {
        sum = vec3_add(sum, vec3_cross(change->r, change->r_rate));
    }
    for (int j = 0; j + 2 <= degree; ++j) {
        sum = vec3_axpy(sum, (j + 2) * (j + 1), vec3_cross(c[j + 2], moment[j]));
    }
    return sum;
}

/* Adds the torque's impulse up to the time of `change` [N m s], and at skew cylinders the impulse on the
 * source, foot x F. */
static void add_torque_impulse(const struct contact_pair *pair, const struct torque_lever *lever,
                               const struct pair_change *change, const struct vec3 moment[PAIR_MOMENTS],
                               struct contact_impulses *impulse)
{
    if (!lever->acts) { /* the powers of huge times would overflow for nothing */
        return;
    }
    struct vec3 sum = segment_lever(pair, change, moment, lever->c);
    if (contact_is_skew(&pair->shape)) {
        const struct vec3 of_foot = segment_lever(pair, change, moment, lever->foot);
        sum = vec3_sub(sum, of_foot);
        impulse->source_torque = vec3_axpy(impulse->source_torque, -pair->reduced_mass, of_foot);
    }
    impulse->destination_torque = vec3_axpy(impulse->destination_torque, -pair->reduced_mass, sum);
}

/* This part of the file finds where a segment leaves its zone of a capped cylinder or of skew cylinders
 * (shape.h). To leave the zone is a terminal event, after which the regime goes on in the next zone. */

/* Returns the s at which the centre is no longer beyond the side or the cap. `beyond` is the exact distance
 * at the start [m], from which the sample differs by the segment's tolerance. A centre outside by up to
 * `rounding` counts as within. A centre that is as near the edge at the start is on its way out of a face; it
 * counts as within only once it has gone inwards by `rounding`. */
static double end_of_rim_by(struct segment *p, enum pair_quantity quantity, double beyond, double rounding)
{
    const double now = p->output.at[0].of[quantity][0];
    const double raised = fmax(fmax(beyond - now, 0.0) - rounding, rounding - now);
    const struct event_function margin = {quantity, 1.0, raised};
    return dense_output_first_event(&p->output, &margin);
}

static double end_at_rim(struct segment *p)
{
    const struct contact_solid *solid = &p->pair.shape.solid;
    const double rounding = zone_path_rounding(solid, p->pair.flight.c[0]);
    const struct solid_place place = contact_place_at(solid, p->pair.flight.c[0]);
    return fmin(end_of_rim_by(p, PAIR_RADIAL, place.radial, rounding),
                end_of_rim_by(p, PAIR_AXIAL, place.axial, rounding));
}

/* This struct describes a segment along a face of the solid, with the centre near the face or inside the
 * solid. */
struct face_path {
    const struct segment *segment;
    double raised; /* amount added to the margin, see sample_depth_margin [m] */
};

/* Puts the margin [m] in place of the gap, without its second derivative; serves as a dense_output_sampler.
 * The margin is negative where another face is nearer to a centre inside the solid, and positive outside the
 * solid. Rounding and the error of the edge just passed raise it. The gap gives the depth, the flight gives
 * the distance from the other face. */
static void sample_depth_margin(const void *face_path, double s, struct pair_sample *at)
{
    const struct face_path *path = face_path;
    const struct segment *p = path->segment;
    const struct contact_solid *solid = &p->pair.shape.solid;
    double *margin = at->of[PAIR_GAP];
    p->output.sampler(p->output.segment, s, at);
    const double depth = margin[0] + p->pair.shape.source_radius;
    const double time = segment_time(p, s);
    const struct vec3 c = path_at(p->pair.flight.c, SEPARATION_DEGREE + 1, time);
    const struct vec3 by_s =
        vec3_scale(segment_pace(p, s), path_at(p->pair.flight.w, SEPARATION_DEGREE, time));
    const struct solid_place place = contact_place_at(solid, c);
    const double along = vec3_dot(solid->axis, c);
    const double along_by_s = vec3_dot(solid->axis, by_s);
    margin[0] = path->raised + depth;
    margin[2] = 0.0; /* the root finders then bisect */
    if (solid->zone == ZONE_SIDE && depth <= 0.0) {
        margin[0] -= place.axial;
        margin[1] -= along < 0.0 ? -along_by_s : along_by_s;
    } else if (depth <= 0.0 && -place.radial < solid->half_height) {
        margin[0] -= place.radial;
        margin[1] -= (vec3_dot(c, by_s) - along * along_by_s) / fmax(place.radial + solid->radius, DBL_MIN);
    } else if (depth <= 0.0) {
        margin[0] += solid->half_height;
    }
}

static double end_by_depth(const struct segment *p, double end)
{
    const struct event_function margin = {PAIR_GAP, 1.0, 0.0};
    struct face_path path = {p, zone_path_rounding(&p->pair.shape.solid, p->pair.flight.c[0])};
    struct dense_output w = {sample_depth_margin, &path, 0.0, .latest_s = -1.0};
    struct pair_sample start;
    sample_depth_margin(&path, 0.0, &start);
    path.raised += 2.0 * fmax(-start.of[PAIR_GAP][0], 0.0);
    for (int i = 0; i < DENSE_OUTPUT_POINTS; ++i) {
        dense_output_add(&w, end * i / (DENSE_OUTPUT_POINTS - 1));
    }
    return dense_output_first_event(&w, &margin);
}

/* Whether the centre may get so deep into the solid that another face is nearer, by bounds of the depth and
 * of the length that the flight goes along the face. */
static bool may_change_face(const struct segment *p)
{
    const struct contact_solid *solid = &p->pair.shape.solid;
    const double depth = segment_bound(p, PAIR_GAP) - p->pair.shape.source_radius;
    const double time = segment_time(p, p->end);
    const double length = time * path_size(p->pair.flight.c + 1, SEPARATION_DEGREE, time);
    const struct solid_place place = contact_place_at(solid, p->pair.flight.c[0]);
    const double other = solid->zone == ZONE_SIDE ? place.axial : place.radial;
    const bool opposite = solid->zone != ZONE_SIDE && depth >= solid->half_height;
    return depth >= 0.0 && (opposite || other + length >= -depth);
}

static double zone_end_of_face(const struct segment *p, double end)
{
    /* The force has no part along the side, nor across the axis at a cap: the centre leaves the face by its
     * flight, at a root of polynomials. */
    const double time = zone_path_leaves_face(&p->pair.shape.solid, &p->pair.flight, segment_time(p, end));
    const double s = time < (double)INFINITY ? segment_place(p, time) : (double)INFINITY;
    /* at skew cylinders segment_make refuses a depth at which n would jump */
    const bool may_change = !contact_is_skew(&p->pair.shape) && may_change_face(p);
    return may_change ? fmin(s, end_by_depth(p, fmin(s, end))) : s;
}

/* Ends the segment where its zone ends, if the zone ends before p->terminal. */
static void zone_end_note(struct segment *p)
{
    p->leaves_zone = false;
    if (!contact_is_zoned(&p->pair.shape)) {
        return;
    }
    const double end = fmin(p->end, p->terminal.s);
    const double s = contact_is_rim(&p->pair.shape) ? end_at_rim(p) : zone_end_of_face(p, end);
    if (s <= p->end && s < p->terminal.s) {
        p->terminal.s = s;
        p->terminal.regime = p->regime;
        p->leaves_zone = true;
    }
}

/* Longest segment inside the solid [radians of the contact's oscillation], in which the samples of the margin
 * show every turn: the centre may get nearer to another face in each oscillation. */
static const double LONGEST_INSIDE = 8.0;

/* The first kind that can be made is taken. For a kind without `time`, the time is unit times s. */
static const struct {
    bool (*make)(struct segment *p);
    dense_output_sampler *sample;
    struct pair_change (*advance)(const void *motion, double s);
    void (*moments)(const void *motion, double s, const struct pair_change *change, int count,
                    struct vec3 *moment);
    void (*time)(const void *motion, double s, double time[3]);
} kinds[] = {
    /* Head-on oscillation under constant acceleration: the closed form is exact for any time, so it comes
     * first. */
    [SEGMENT_CLOSED_FORM] = {closed_form_make, pair_oscillation_sample, pair_oscillation_advance,
                             pair_oscillation_moments, NULL},
    /* Fast oscillations that are small and clear of g = 0: one step covers as many as the tangential motion
     * allows. */
    [SEGMENT_AVERAGED] = {averaged_make, pair_collocation_sample, pair_collocation_advance,
                          pair_collocation_moments, NULL},
    /* Contacts far beyond critical damping or without a spring: a segment covers a radian of the tangential
     * motion. */
    [SEGMENT_OVERDAMPED] = {overdamped_make, pair_collocation_sample, pair_collocation_advance,
                            pair_collocation_moments, NULL},
    /* All other contacts: soft ones, short remainders of a motion and Hertz's law. A segment
     * covers two radians of the contact's oscillation, of the bodies' passage or of the rim. */
    [SEGMENT_SERIES] = {series_make, series_sample, series_advance, series_moments, expansion_time},
#if SCENE_ANY_HERTZ
    /* Hertz's law after the oscillation has died away: a segment covers a radian of the tangential motion. */
    [SEGMENT_QUASI_STATIC] = {quasi_static_make, pair_collocation_sample, pair_collocation_advance,
                              pair_collocation_moments, NULL},
    /* Hertz's law without damping, head-on under constant acceleration: a segment covers all the rest of an
     * impact. */
    [SEGMENT_HERTZ_ELASTIC] = {hertz_elastic_make, hertz_elastic_sample, hertz_elastic_advance,
                               hertz_elastic_moments, hertz_elastic_time},
#endif
};

double segment_time(const struct segment *p, double s)
{
    double time[3] = {s * p->unit};
    if (kinds[p->kind].time != NULL) {
        kinds[p->kind].time(&p->as, s, time);
    }
    return time[0];
}

double segment_pace(const struct segment *p, double s)
{
    double time[3] = {0.0, p->unit};
    if (kinds[p->kind].time != NULL) {
        kinds[p->kind].time(&p->as, s, time);
    }
    return time[1];
}

double segment_place(const struct segment *p, double time)
{
    if (!(time > 0.0)) {
        return 0.0; /* after a start at the touch, time may be of second order in s: no root at 0 */
    }
    return kinds[p->kind].time == NULL
               ? time / p->unit
               : pair_place_by(kinds[p->kind].time, &p->as, time, fmin(p->end, p->terminal.s));
}

struct pair_change segment_change(const struct segment *p, double s)
{
    return kinds[p->kind].advance(&p->as, s);
}

void segment_moments(const struct segment *p, double s, const struct pair_change *change, int count,
                     struct vec3 moment[PAIR_MOMENTS])
{
    memset(moment, 0, PAIR_MOMENTS * sizeof *moment);
    if (count > 0 && change->time > 0.0) {
        kinds[p->kind].moments(&p->as, s, change, count, moment);
    }
}

static bool make_kind(struct segment *p, enum segment_kind kind)
{
    p->kind = kind;
    /* contact in a hollow body ends before the centre */
    p->clear_of_centre = !contact_may_reach_centre(&p->pair.shape);
    memset(p->largest, 0, sizeof p->largest);
    p->parting = (double)NAN;
    p->terminal = (struct terminal_event){.s = (double)NAN};
    p->output.sampler = kinds[kind].sample;
    p->output.segment = &p->as;
    p->output.count = 0;
    p->output.latest_s = -1.0;
    return kinds[kind].make(p);
}

/* Returns the longest segment of bodies that are not head-on [s]. Their motion is the flight plus a deviation
 * that nearly cancels the flight, so the flight may only be so long that its rounding stays within that of
 * the gap. */
static double longest_by_flight(const struct segment *p)
{
    const double flight = p->gap_rounding / DBL_EPSILON;
    double longest = (double)INFINITY;
    for (int i = 2; i <= p->pair.flight.degree; ++i) {
        const double along = fabs(vec3_dot(p->pair.normal, p->pair.flight.c[i]));
        longest = fmin(longest, pow(flight / (SEPARATION_DEGREE * along), 1.0 / i));
    }
    return longest;
}

/* The distance d of a node from the centre is at least this fraction of the reach. The sum d = reach + x
 * loses one decimal digit where d is a tenth of the reach. If a node is nearer, the motion between the
 * nodes may be nearer still. */
static const double NEAR_CENTRE = 0.1;

/* Whether a collocated segment stays so far from the centre that local coordinates are accurate. */
static bool stays_off_centre(struct segment *p)
{
    return p->scales.problem.head_on || p->clear_of_centre ||
           largest_size(p, PAIR_GAP) < (1.0 - NEAR_CENTRE) * p->scales.problem.reach ||
           (p->kind == SEGMENT_OVERDAMPED && !(terminal_event_centre(p) < (double)INFINITY));
}

/* Makes the segment by the first collocated kind that applies, if that segment stays off the centre. */
static bool make_collocated(struct segment *p)
{
    pair_timescales_make(&p->scales, &p->pair, &p->flight);
    return (make_kind(p, SEGMENT_AVERAGED) || make_kind(p, SEGMENT_OVERDAMPED)) && stays_off_centre(p);
}

/* Makes a segment under Hertz's law by the series. If its first coefficients show nothing fast, the
 * quasi-static kind follows. If that kind fails, the series is made after all. */
static void make_hertz(struct segment *p)
{
    p->may_be_quasi_static = SCENE_ANY_HERTZ && quasi_static_applies(p);
    const bool is_series = make_kind(p, SEGMENT_SERIES);
    if (!is_series && make_kind(p, SEGMENT_QUASI_STATIC)) {
        collocated_sample(p);
    } else if (!is_series) {
        p->may_be_quasi_static = false;
        (void)make_kind(p, SEGMENT_SERIES);
    }
}

static void make_up_to(struct segment *p, double longest)
{
    const bool is_hertz = SCENE_ANY_HERTZ && contact_is_hertz(&p->pair.law);
    p->longest = p->pair.is_head_on ? longest : fmin(longest, longest_by_flight(p));
    if (!make_kind(p, is_hertz ? SEGMENT_HERTZ_ELASTIC : SEGMENT_CLOSED_FORM)) {
        frame_flight_make(&p->flight, &p->pair);
        if (is_hertz) {
            make_hertz(p);
        } else if (!make_collocated(p)) {
            (void)make_kind(p, SEGMENT_SERIES);
        }
    }
    if (isnan(p->terminal.s)) {
        p->terminal = terminal_event_first(p);
    }
}

/* A collocated step is most accurate at its end. If a zone ends within, the step is made to end there, longer
 * by this part so that the edge is found again. */
static const double BEYOND_EDGE = 1e-6;

static void note_zone_end(struct segment *p)
{
    const bool is_collocated = p->kind == SEGMENT_AVERAGED || p->kind == SEGMENT_OVERDAMPED;
    zone_end_note(p);
    if (p->leaves_zone && p->terminal.s > 0.0 && is_collocated && contact_is_rim(&p->pair.shape)) {
        make_up_to(p, p->terminal.s * p->unit * (1.0 + BEYOND_EDGE));
        zone_end_note(p);
    }
}

bool segment_make(struct segment *p, const struct scene_instant *at, int contact, double longest,
                  double tolerance)
{
    pair_make(&p->pair, at, contact);
    p->regime = (enum contact_regime)at->q->contact[contact].regime;
    p->work = 0;
    p->gap_rounding = rounding_of_gap(at, contact);
    p->gap_is_known = p->pair.gap == 0.0 || scene_gap_is_accumulated(at, contact);
    p->tolerance = tolerance;
    p->output.worth_a_search = dense_output_worth_a_search(at->v);
    p->rubs = contact_rubs(at->v, contact);
    p->may_pull = p->rubs && contact_may_pull(&p->pair.law);
    p->is_lifted =
        p->may_pull && at->q->contact[contact].friction_regime[OPPOSED_SLIP] == (int32_t)FRICTION_LIFTED;
    make_up_to(p, longest);
    if (contact_is_capped(&p->pair.shape) && !contact_is_rim(&p->pair.shape)) {
        const double inside = LONGEST_INSIDE * sqrt(p->pair.reduced_mass / p->pair.coefficients.k);
        if (inside < segment_time(p, p->end) && may_change_face(p)) {
            make_up_to(p, inside);
        }
    }
    terminal_event_at_centre(p);
    if (SCENE_ANY_ZONES) {
        note_zone_end(p);
    }
    return p->end > 0.0 &&
           !(contact_is_skew(&p->pair.shape) && segment_bound(p, PAIR_GAP) >= contact_reach(&p->pair.shape));
}

bool segment_is_deep(const struct segment *p)
{
    return p->largest[PAIR_GAP] > contact_reach(&p->pair.shape);
}

void segment_advance(struct segment *p, double from, double s, struct scene_state *q, int contact)
{
    struct contact_state *state = &q->contact[contact];
    struct pair_change change = segment_change(p, s);
    const struct torque_lever lever = torque_lever_of(&p->pair);
    struct vec3 moment[PAIR_MOMENTS];
    const int of_work = path_degree(p->pair.force, 3);
    segment_moments(p, s, &change, of_work > lever.moments ? of_work : lever.moments, moment);
    change.head_on = change.head_on && !segment_is_deep(p);
    state->physics.carried_rate = dense_output_at(&p->output, s)->of[PAIR_GAP_RATE][0];
    if (from < s) {
        peaks_note(p, &state->peaks, from, s);
    }
    if (p->pair.coefficients.k >= PAIR_STIFF) {
        peak_error_note(p, segment_time(p, from), segment_time(p, s), state);
    }
    pair_apply(&p->pair, &change, moment, q, contact);
    add_torque_impulse(&p->pair, &lever, &change, moment, &state->physics.impulse);
}
