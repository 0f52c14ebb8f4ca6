#include <float.h>

#include "touch/terminal_event.h"

/* A regime ends only when the law's margin is negative by more than this part of the load, besides rounding:
 * truncation errors do not change the regime of a contact at rest. */
static const double HYSTERESIS = 1e-8;

/* Separation slower than this part of the largest speed in the segment is not accepted at g = 0 where a load
 * presses the bodies together again at once. Contact then
 * lasts until the gap exceeds its rounding bound, or 1e-6 of the penetration where a stiff contact is
 * compressed by less than rounding. Otherwise a ball that oscillates about g = 0 would bounce on rounding. */
static const double CLEAR_SEPARATION = 1e-3;
static const double GAP_HYSTERESIS = 1e-6;

/* Lower bound of that gap [m]: below it products of the penetration underflow. */
static const double DIED_AWAY = 1e-100;

/* Approach-only dashpot: it is switched at every turn of an oscillation, however little it deforms a stiff
 * contact, for it is what damps the oscillation and that of the force: until the oscillation is HYSTERESIS of
 * the penetration under the load. With less than LIGHTEST of the critical damping that takes more than
 * 12,000 turns. Then it is not switched while its force is less than IDLE_DASHPOT of the load and deforms the
 * contact by less than the tolerance. */
static const double LIGHTEST = 1e-3;
static const double IDLE_DASHPOT = 1e-3;

/* Under a load that falls slowly the full law lets the bodies separate at the load's pace, r0 at most.
 * The dashpot's pull p_nv r0 then holds the contact deeper by p_nv r0 / p_n than the spring alone would.
 * Left to the spring alone it oscillates about the falling load with speeds up to swing r0, where
 * swing = p_nv / sqrt(p_n m_red), and approaches again at up to (swing - 1) r0.
 * From critical damping on, swing >= 2, that is r0 or more.
 * If it switched the full law on, a cycle without end would begin.
 * So the spring alone lasts up to this many times swing r0. The error stays bounded:
 * the force left out at that speed is HYSTERESIS of the load, or more only where rounding asks for it. */
static const double REBOUND = 2.0;
static const double CRITICAL_SWING = 2.0;

/* The largest |g| [m] or |g'| [m/s] in the segment. */
static double largest_size(const struct segment *p, enum pair_quantity quantity)
{
    double largest = quantity == PAIR_GAP ? p->largest_gap : p->largest_rate;
    const bool known = largest > 0.0;
    for (int i = 0; i < p->output.count && !known; ++i) {
        largest = fmax(largest, fabs(p->output.at[i].of[quantity][0]));
    }
    return largest;
}

double terminal_event_gap_noise(const struct contact_pair *from)
{
    const double spring = sqrt(from->coefficients.k / from->reduced_mass);
    const double dashpot = from->coefficients.c / from->reduced_mass;
    return from->rate_rounding / fmax(spring, dashpot);
}

double terminal_event_gap_tolerance(const struct segment *p)
{
    const double most = 2.0 * p->gap_rounding;
    if (contact_is_hertz(&p->pair.law)) { /* it coasts at the touch: whatever comes back has not parted */
        return most;
    }
    const double part = GAP_HYSTERESIS * largest_size(p, PAIR_GAP);
    return part >= most ? most : fmin(most, fmax(part, fmax(terminal_event_gap_noise(&p->pair), DIED_AWAY)));
}

bool terminal_event_by_law(const struct segment *p)
{
    return contact_has_events(&p->pair.law);
}

/* k and c of the full law; of Hertz's law its slopes at the deepest of the segment. */
static struct contact_coefficients full_coefficients(const struct segment *p)
{
    const struct contact_law *law = &p->pair.law;
    if (!contact_is_hertz(law)) {
        return contact_coefficients_of(law, REGIME_COMPRESSION);
    }
    const struct contact_slopes slopes =
        contact_force_slopes(law, REGIME_COMPRESSION, -largest_size(p, PAIR_GAP), 0.0);
    return (struct contact_coefficients){-slopes.by_gap, -slopes.by_rate};
}

/* Ratio of the approach speed at which the spring alone ends to the separation speed at its start, r0. */
static double rebound_of(struct contact_coefficients full, double reduced_mass)
{
    const double swing = full.c / sqrt(full.k * reduced_mass);
    return full.k > 0.0 && swing >= CRITICAL_SWING ? REBOUND * swing : 1.0;
}

/* Speed of separation at which an approach-only dashpot stops, rounding apart [m/s]; `open` is a force. */
static double separating_speed(const struct segment *p, struct contact_coefficients full, double open)
{
    const double swing = sqrt(full.k * p->pair.reduced_mass); /* force by speed, of the spring alone */
    if (full.c >= 2.0 * LIGHTEST * swing) {
        return open / fmax(full.c, swing);
    }
    return fmax(open, fmin(full.k * p->tolerance, IDLE_DASHPOT * pair_load(&p->pair))) / full.c;
}

struct event_function terminal_event_margin(const struct segment *p)
{
    const struct contact_law *law = &p->pair.law;
    const double rate = p->pair.rate_rounding;
    if (contact_is_hertz(law) && law->dashpot == DASHPOT_NON_ADHESIVE) {
        /* At rest the margin 1 - chi g' is 1, so that only rounding is left to allow for. Bodies that are
         * pushed out of a deep overlap go at 1/chi for long; a load that pulls them apart adds to that speed,
         * and a hysteresis in parts of it would hold them back by that part of a force far above the load. */
        return (struct event_function){PAIR_GAP_RATE, -1.0, 1.0 / contact_factors_of(law).c + rate};
    }
    const struct contact_coefficients full = full_coefficients(p);
    const double open =
        HYSTERESIS * pair_load(&p->pair) + full.k * 8.0 * DBL_EPSILON * largest_size(p, PAIR_GAP);
    if (law->dashpot == DASHPOT_NON_ADHESIVE) {
        return (struct event_function){PAIR_FORCE, 1.0, open + full.c * rate};
    }
    const double rebound = rebound_of(full, p->pair.reduced_mass);
    const double separating = separating_speed(p, full, open) + rate;
    return p->regime == REGIME_RESTITUTION ? (struct event_function){PAIR_GAP_RATE, 1.0, rebound * separating}
                                           : (struct event_function){PAIR_GAP_RATE, -1.0, separating};
}

/* Whether bodies that part at this speed are pressed together again before the gap has grown to
 * GAP_HYSTERESIS of the penetration. */
static bool comes_back_at_once(const struct segment *p, double speed)
{
    const struct contact_pair *from = &p->pair;
    const double pressing = -from->shape.side * (pair_turning(from, fmax(from->distance, DBL_MIN)) +
                                                 2.0 * vec3_dot(from->normal, from->flight.c[2]));
    return pressing > 0.0 && speed * speed <= 2.0 * pressing * GAP_HYSTERESIS * largest_size(p, PAIR_GAP);
}

static struct terminal_event parting(struct segment *p)
{
    struct terminal_event terminal = {(double)INFINITY, {PAIR_GAP, -1.0, 0.0}, REGIME_APART};
    terminal.s = dense_output_first_event(&p->output, &terminal.function);
    if (terminal.s < (double)INFINITY) {
        const struct pair_sample *then = dense_output_at(&p->output, terminal.s);
        const double speed = then->of[PAIR_GAP_RATE][0];
        const double clean = CLEAR_SEPARATION * largest_size(p, PAIR_GAP_RATE);
        if (contact_is_hertz(&p->pair.law) || !(speed > p->pair.rate_rounding) ||
            (speed <= clean && comes_back_at_once(p, speed))) {
            terminal.function.offset = terminal_event_gap_tolerance(p);
            terminal.s = dense_output_first_event(&p->output, &terminal.function);
        }
    }
    return terminal;
}

struct terminal_event terminal_event_first(struct segment *p)
{
    struct terminal_event first = {(double)INFINITY, {PAIR_GAP, -1.0, 0.0}, REGIME_APART};
    if (p->event_free) {
        return first;
    }
    first = parting(p);
    if (terminal_event_by_law(p)) {
        const struct event_function margin = terminal_event_margin(p);
        const double s = dense_output_first_event(&p->output, &margin);
        if (s < first.s) {
            first = (struct terminal_event){s, margin, contact_regime_after(&p->pair.law, p->regime)};
        }
    }
    return first;
}

/* Between two samples a quantity may have one extremum larger than both, but less than four times as
 * large. */
static bool stays_clear_of_centre(const struct segment *p)
{
    double deepest = 0.0;
    for (int i = 0; i < p->output.count; ++i) {
        deepest = fmax(deepest, fabs(p->output.at[i].of[PAIR_GAP][0]));
    }
    return 4.0 * deepest < contact_reach(&p->pair.shape);
}

double terminal_event_centre(const struct segment *p)
{
    if (p->clear_of_centre || stays_clear_of_centre(p)) {
        return (double)INFINITY;
    }
    const struct event_function distance = {PAIR_GAP, p->pair.shape.side, contact_reach(&p->pair.shape)};
    return dense_output_first_event(&p->output, &distance);
}

void terminal_event_at_centre(struct segment *p)
{
    const double s = terminal_event_centre(p);
    if (s <= p->end && s < p->terminal.s) {
        /* Beyond the centre the gap rate has the opposite sign. */
        const struct pair_sample *then = dense_output_at(&p->output, s);
        const double gap = then->of[PAIR_GAP][0];
        p->terminal.s = s;
        p->terminal.regime = contact_regime_of(&p->pair.law, gap, -then->of[PAIR_GAP_RATE][0], true);
    }
}
