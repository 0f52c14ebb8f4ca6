#include "solver/ending.h"

#if SCENE_ANY_FREE

#include <float.h>

/* How far below zero the law's margin must fall for a regime to end, besides rounding, in parts of the load: a contact at rest
 * does not change its regime by what the integration leaves open. */
static const double HYSTERESIS = 1e-8;

/* Bodies that part at less than this part of the largest speed in the piece hardly part at all: they are held together until the gap
 * is wider than its own rounding, or a millionth of the penetration where a stiff contact is pressed in by less. A ball that
 * oscillates at the verge of parting would bounce on rounding otherwise. */
static const double CLEAN_PARTING = 1e-3;
static const double GAP_HYSTERESIS = 1e-6;

/* But no less than this [m]: a penetration that has died away so far is noise, for its powers are no numbers any more. */
static const double DIED_AWAY = 1e-100;

/* A dashpot that acts on approach only: about rest, and where the load slowly fades, the gap rate touches zero once in every
 * oscillation. Which side it is on matters as little as the dashpot's force there: not at all to the motion while that force
 * deforms the contact by less than the error allowed, nor beyond this part of the load. */
static const double IDLE_DASHPOT = 1e-3;

/* Under a load that falls slowly the full law lets the bodies separate at the load's pace, r0 at most.
 * The dashpot's pull p_nv r0 then holds the contact deeper by p_nv r0 / p_n than the spring alone would.
 * Left to the spring alone it oscillates about the falling load with speeds up to swing r0, where
 * swing = p_nv / sqrt(p_n m_red), and approaches again at up to (swing - 1) r0.
 * From critical damping on, swing >= 2, that is r0 or more.
 * If it switched the full law on, a cycle without end would begin.
 * So the spring alone lasts up to this many times swing r0. The error stays bounded:
 * the force left out at that speed is the idle one, or more only where rounding asks for it. */
static const double REBOUND = 2.0;
static const double CRITICAL_SWING = 2.0;

/* Of the gap or its rate. */
static double largest_size(const struct piece *p, enum press_quantity quantity)
{
    double largest = 0.0;
    if (p->kind == PIECE_STRAIGHT && p->by.straight.turn > 0.0) { /* whose places do not show the rate */
        const struct press_straight *made = &p->by.straight;
        return quantity == PRESS_RATE ? made->rate * made->amplitude : fabs(made->settled) + made->amplitude;
    }
    for (int i = 0; i < p->watch.count; ++i) {
        largest = fmax(largest, fabs(p->watch.at[i].of[quantity][0]));
    }
    return largest;
}

double ending_gap_noise(const struct press *from)
{
    const double spring = sqrt(from->by.k / from->reduced_mass);
    const double dashpot = from->by.c / from->reduced_mass;
    return from->rate_resolution / fmax(spring, dashpot);
}

double ending_gap_slack(const struct piece *p)
{
    const double noise = fmax(ending_gap_noise(&p->press), DIED_AWAY);
    return fmin(2.0 * p->resolution, fmax(GAP_HYSTERESIS * largest_size(p, PRESS_GAP), noise));
}

bool ending_by_law(const struct piece *p)
{
    return p->press.law.damping > 0.0 && p->press.law.dashpot != DASHPOT_UNCLAMPED;
}

/* The speed of approach at which the spring alone ends over the speed of separation r0 at which it begins. */
static double rebound_of(const struct press *from)
{
    const double swing = from->law.damping / sqrt(from->law.stiffness * from->reduced_mass);
    return from->law.stiffness > 0.0 && swing >= CRITICAL_SWING ? REBOUND * swing : 1.0;
}

struct watched ending_margin(const struct piece *p)
{
    const struct contact_law *law = &p->press.law;
    const double rate = p->press.rate_resolution;
    const double open =
        HYSTERESIS * press_load(&p->press) + law->stiffness * 8.0 * DBL_EPSILON * largest_size(p, PRESS_GAP);
    if (law->dashpot == DASHPOT_NON_ADHESIVE) {
        return (struct watched){PRESS_FORCE, 1.0, open + law->damping * rate};
    }
    const double load = press_load(&p->press);
    const double idle = fmin(law->stiffness * p->tolerance, IDLE_DASHPOT * load);
    const double rebound = rebound_of(&p->press);
    const double separating = fmax(open, idle / rebound) / law->damping + rate;
    return p->regime == REGIME_RECEDING ? (struct watched){PRESS_RATE, 1.0, rebound * separating}
                                        : (struct watched){PRESS_RATE, -1.0, separating};
}

static struct ending parting(struct piece *p)
{
    struct ending ending = {(double)INFINITY, {PRESS_GAP, -1.0, 0.0}, REGIME_APART};
    ending.s = watch_first_fall(&p->watch, &ending.by);
    if (ending.s < (double)INFINITY) {
        const struct press_sample *then = watch_see(&p->watch, ending.s);
        const double clean = fmax(CLEAN_PARTING * largest_size(p, PRESS_RATE), p->press.rate_resolution);
        if (!(then->of[PRESS_RATE][0] > clean)) {
            ending.by.offset = ending_gap_slack(p);
            ending.s = watch_first_fall(&p->watch, &ending.by);
        }
    }
    return ending;
}

struct ending ending_first(struct piece *p)
{
    struct ending first = {(double)INFINITY, {PRESS_GAP, -1.0, 0.0}, REGIME_APART};
    if (p->spans) {
        return first;
    }
    first = parting(p);
    if (ending_by_law(p)) {
        const struct watched margin = ending_margin(p);
        const double s = watch_first_fall(&p->watch, &margin);
        if (s < first.s) {
            first = (struct ending){s, margin, contact_regime_after(&p->press.law, p->regime)};
        }
    }
    return first;
}

void ending_at_centre(struct piece *p)
{
    const double s = piece_meets_centre(p);
    if (s <= p->end && s < p->ending.s) {
        /* Beyond it the bodies part as fast as they came. */
        const struct press_sample *then = watch_see(&p->watch, s);
        const double gap = then->of[PRESS_GAP][0];
        p->ending.s = s;
        p->ending.regime = contact_regime_of(&p->press.law, gap, -then->of[PRESS_RATE][0], true);
    }
}

#endif
