/* This file makes the steps of the general segment: it has their lengths, errors, events and peaks, and the
 * motion of the scene along them. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "flight/flight.h"
#include "integrator/general.h"
#include "integrator/node_forces.h"
#include "math/compiler.h"
#include "math/polynomial.h"
#include "scene/dense_output.h"
#include "scene/evaluate.h"
#include "scene/ode.h"
#include "scene/scene_jet.h"

/* Newton's iteration ends when its last correction is below this part of the error allowed in a step. The
 * part is smaller where bodies turn: the angular momentum shall be kept over a thousand impacts, and at
 * rest large forces of several contacts cancel in their sum. */
static const double NEWTON_SHARE = 0.05;
static const double TURNING_NEWTON_SHARE = 0.001;

/* Whether bodies may turn and rub. */
static bool general_rubs(const struct general *g)
{
    return SCENE_ANY_FRICTION && g->step.problem.turns;
}

static double newton_share(const struct general *g)
{
    return g->step.problem.turns ? TURNING_NEWTON_SHARE : NEWTON_SHARE;
}

/* This is the length of a first step in radians of the fastest oscillation. An impact takes pi radians with a
 * linear spring, and four with Hertz's law. */
static const double FIRST_STEP = 4.0;

/* Length of a first step that begins at a touch under Hertz's law, in the same radians. A step from the touch
 * is accurate over a third of the impact. */
static const double FIRST_STEP_FROM_TOUCH = 1.3;

/* Returns the length of a first step by the springs at the start of g->step [s]; INFINITY: there are none. */
static double length_of_springs(const struct general *g)
{
    double fastest = 0.0;
    for (int i = 0; i < g->ode.layout.groups; ++i) {
        fastest = fmax(fastest, g->island[i].frequency);
    }
    return FIRST_STEP / fastest;
}

/* The stiffness of Hertz's spring grows with the square root of the penetration. From this part of the
 * largest penetration on, length_of_springs and the error of a step show the stiffness well enough. */
static const double DEEP = 0.25;

/* Returns the order of magnitude of the largest penetration delta after a touch [m]. An impact without
 * damping has delta^(5/2) = 5/4 v^2 / k; an impact with much damping has delta^(5/2) = 5/2 v / (k chi). A
 * body at rest under the acceleration `load` a has delta^(3/2) = a / k. `k` is k_h / m_red. */
static double depth_to_come(double k, double chi, double speed, double load)
{
    const double stops = fmin(0.5 * speed, 1.0 / chi); /* chi = 0: 0.5 speed */
    const double static_depth = cbrt(load / k);
    return fmax(pow(2.5 * speed * stops / k, 0.4), static_depth * static_depth);
}

static double length_of_impact(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    const double per_mass = scene_inverse_mass(at->v, contact);
    if (!contact_is_hertz(&law) || !contact_transmits(at->q, contact) || !(per_mass > 0.0)) {
        return (double)INFINITY;
    }
    const double k = contact_factors_of(&law, REGIME_COMPRESSION).k * per_mass;
    const double chi = contact_factors_of(&law, regime).c;
    const struct contact_geometry *g = &at->geometry[contact];
    const double load = scene_pressing_acceleration(at, contact);
    const double depth = depth_to_come(k, chi, fabs(g->gap_rate), load);
    if (!(-g->gap < DEEP * depth) || g->gap_rate > 0.0) {
        return (double)INFINITY;
    }
    const double spring = sqrt(1.5 * k * sqrt(depth));
    const double dashpot = k * chi * depth * sqrt(depth);
    return FIRST_STEP_FROM_TOUCH / fmax(spring, dashpot);
}

/* Returns the length of a first step by impacts that begin under Hertz's law [s]; INFINITY: no limit. */
static double length_of_impacts(const struct scene_instant *at)
{
    double least = (double)INFINITY;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        least = fmin(least, length_of_impact(at, j));
    }
    return least;
}

/* Regularized friction as a function of the slip bends where the slip falls to a few v_0. A step ends before
 * that, where exp(-slip/v_0) is still below the error allowed, or at a slip of SLIP_BEFORE times v_0, whose
 * effect on a speed is rounding. The next steps may last SLIP_WITHIN times v_0 / |du/dt|. Below SLIP_AFTER
 * times v_0 friction is nearly linear. */
static const double SLIP_BEFORE = 20.0;
static const double SLIP_WITHIN = 8.0;
static const double SLIP_AFTER = 4.0;

/* The slip makes no step shorter than this part of the clock or of a second. A slip below this part of the
 * speeds is rounding and limits no step. */
static const double SLIP_SHORTEST = 1e-13;
static const double SLIP_ROUNDING = 1e-12;

/* Returns the time at which of[0] + of[1] t + of[2] t^2, positive at t = 0, becomes zero; or INFINITY. */
static double time_to_zero(const double of[3])
{
    const double square = of[1] * of[1] - 4.0 * of[0] * of[2];
    if (!(square >= 0.0) || !(of[1] < 0.0 || of[2] < 0.0)) {
        return (double)INFINITY;
    }
    const double q = -0.5 * (of[1] + copysign(sqrt(square), of[1]));
    const double near = of[1] < 0.0 ? of[0] / q : q / of[2]; /* without cancellation */
    return near > 0.0 ? near : (double)INFINITY;
}

/* This struct describes an opposed motion of a contact (contact/friction.h). */
struct opposed_state {
    struct friction_law law;
    enum friction_regime regime;
    struct vec3 slip; /* [m/s], or the angular velocity [rad/s] */
    double size;      /* size of the terms whose difference the slip is */
};

static struct opposed_state opposed_of(const struct scene_instant *at, int contact, int part)
{
    return (struct opposed_state){scene_friction_law(at->q, contact, part),
                                  (enum friction_regime)at->q->contact[contact].friction_regime[part],
                                  turning_rubbing(at, contact, part).slip,
                                  part == OPPOSED_SLIP ? vec3_norm(at->rate[contact])
                                                       : turning_spin_size(at, contact)};
}

/* Returns the longest step [s] of the relative error `relative` for a motion with the present value `now`, of
 * which the Taylor coefficients 1 and 2 in time are in `terms`. */
static double length_of_opposed(const struct opposed_state *o, double relative, struct vec3 now,
                                const struct vec3 terms[JET_TERMS])
{
    const double slip = vec3_norm(o->slip);
    const double of[3] = {slip, vec3_dot(terms[1], now) / slip, vec3_dot(terms[2], now) / slip};
    const double zero = time_to_zero(of);
    const double v_0 = o->law.slip_velocity / fabs(of[1] + 2.0 * of[2] * zero); /* in time [s] */
    const double before = fmin(-log(relative), SLIP_BEFORE);
    return zero < (double)INFINITY && v_0 > 0.0 ? fmax(zero - before * v_0, SLIP_WITHIN * v_0)
                                                : (double)INFINITY;
}

/* Returns the limit of a step by regularized friction whose slip is about to end [s]; INFINITY: no limit. */
static double length_of_sliding(const struct general *g)
{
    const struct scene_values *v = g->ode.values;
    const struct scene_state *q = g->state;
    struct scene_jet along;
    double least = (double)INFINITY;
    bool known = false;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int count = q->contact[j].regime == REGIME_APART ? 0 : contact_opposed(v, j);
        for (int i = 0; i < count; ++i) {
            const struct opposed_state o = opposed_of(&g->at_start, j, i);
            if (o.law.kind != FRICTION_REGULARIZED ||
                !(vec3_norm(o.slip) > SLIP_AFTER * o.law.slip_velocity + SLIP_ROUNDING * o.size)) {
                continue;
            }
            if (!known) {
                jet_of_motion(&g->at_start, NULL, &along);
                known = true;
            }
            const struct turning_jet *jet = &along.turning[j];
            const struct vec3 *slip = jet->motion[OPPOSED_SLIP];
            least = fmin(least, i == OPPOSED_SLIP ? length_of_opposed(&o, g->relative, slip[0], slip)
                                                  : length_of_opposed(&o, g->relative, o.slip, jet->spin));
        }
    }
    return fmax(least, SLIP_SHORTEST * fmax(q->clock, 1.0));
}

/* The functions that follow set the errors allowed in a step. */

/* This is the rounding of a difference of states, such as the slip, divided by their size; see
 * rounding_of_rate. */
static const double ROUNDING_OF_STATES = 8.0 * DBL_EPSILON;

/* Returns the change of the speed of a body's point of contact by a unit impulse there, or, without an `arm`,
 * of its angular velocity by a unit impulse of torque [1/kg, 1/(kg m^2)]. A body turns about the axis of its
 * least moment of inertia at most. */
static double admittance_by_turning(const struct scene_values *v, int body, const struct vec3 *arm)
{
    if (!body_turns_freely(v, body)) {
        return 0.0;
    }
    const struct vec3 inertia = body_inertia_of(v, body);
    const double least = fmin(inertia.x, fmin(inertia.y, inertia.z));
    return (arm ? vec3_dot(*arm, *arm) : 1.0) / least;
}

/* Returns the change of an opposed motion by a unit impulse of its load [1/kg, 1/(kg m^2)]. The slip feels
 * the masses of both bodies and their inertia across the arms; rolling and spinning feel inertia alone. */
static double opposed_admittance(const struct scene_instant *at, int contact, int part)
{
    const bool slips = part == OPPOSED_SLIP;
    const struct turning_instant *turning = &at->turning;
    return (slips ? scene_inverse_mass(at->v, contact) : 0.0) +
           admittance_by_turning(at->v, contact_source(contact),
                                 slips ? &turning->source_arm[contact] : NULL) +
           admittance_by_turning(at->v, contact_destination(contact),
                                 slips ? &turning->destination_arm[contact] : NULL);
}

/* Returns the change of the speed along n of the point of contact on the source (end 0) or on the destination
 * by a unit impulse along n [1/kg]. A body that tips gives way by its inertia too. Where neither body moves
 * from its place, whatever turns counts as if the impulse were across its arm. */
static double normal_admittance(const struct scene_instant *at, int contact, int end)
{
    const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
    const struct turning_instant *turning = &at->turning;
    const bool moves = scene_inverse_mass(at->v, contact) > 0.0;
    if (!SCENE_ANY_ROTATION || (moves && !SCENE_ANY_TIPPING)) {
        return body_inverse_mass(at->v, body);
    }
    const struct vec3 arm = end == 0 ? turning->source_arm[contact] : turning->destination_arm[contact];
    if (!moves || !body_turns_freely(at->v, body)) {
        return body_inverse_mass(at->v, body) + admittance_by_turning(at->v, body, &arm);
    }
    const struct vec3 lever = vec3_cross(arm, at->geometry[contact].normal);
    const struct vec3 spin = vec3_scale(1.0 / body_inertia_of(at->v, body).x, lever);
    const struct quaternion orientation = turning->body[body].orientation;
    return body_inverse_mass(at->v, body) + vec3_dot(lever, body_rotation_of(at->v, body, orientation, spin));
}

/* Notes by how much a unit impulse of a contact changes its springs where the speed that it causes lasts for
 * the given time [s]. A resistance feels an impulse across the radius of the source. */
static void note_springs(struct general *g, int contact, double time)
{
    for (int k = 0; SCENE_ANY_SPRINGS && k < 3 * OPPOSED; ++k) {
        const int spring = g->ode.layout.spring[contact][k / 3];
        const double arm = k < 3 ? 1.0 : contact_source_radius(g->ode.values, contact);
        if (spring >= 0) {
            g->per_impulse[spring + k % 3] = time * arm * opposed_admittance(&g->at_start, contact, k / 3);
        }
    }
}

/* Adds the effect of an impulse of rounding [N s] to the errors allowed in `count` states from `first` on;
 * first = -1: there are no such states. */
static void allow_impulse(struct general *g, int first, int count, double impulse)
{
    for (int i = first; first >= 0 && i < first + count; ++i) {
        g->step.weight[i] = 1.0 / (1.0 / g->step.weight[i] + impulse * g->per_impulse[i]);
    }
}

/* Adds rounding to the errors allowed. A force made by rounding acts for at most one radian of the
 * oscillation of its island, and rounding of the speeds that meet acts through friction and dashpots. The
 * errors allowed in a speed, a spin and an impulse are at least the changes by the impulses of both. The
 * error allowed in a spring of friction is at least what such a speed does in that time. Each contact counts
 * for its own bodies: a heavy contact must not loosen light bodies. The rounding of regularized friction is
 * added to the errors of integrals alone, because friction brings the slip back to what its law says. */
static void allow_rounding(struct general *g)
{
    const struct ode_layout *layout = &g->ode.layout;
    const double length = g->step.length;
    double most = 0.0; /* of all contacts, on integrals [N s] */
    for (int i = 0; i < layout->coupled; ++i) {
        g->step.weight[i] = 1.0 / fmin(1.0 / g->step.weight[i], g->largest_error[i]);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!contact_transmits(g->state, j)) {
            continue;
        }
        const struct general_rounding *of = &g->rounding[j];
        const struct general_island *island = &g->island[layout->island[j]];
        const double acts = fmin(1.0 / island->frequency, length);
        const double impulse =
            of->spring * of->place * acts + ROUNDING_OF_STATES * (of->momentum + length * of->force);
        const int body[2] = {contact_source(j), contact_destination(j)};
        note_springs(g, j, acts);
        for (int i = 0; i < 2; ++i) {
            allow_impulse(g, layout->body[body[i]] >= 0 ? layout->body[body[i]] + 3 : -1, 3, impulse);
            allow_impulse(g, layout->spin[body[i]], 3, impulse);
        }
        for (int i = 0; SCENE_ANY_SPRINGS && i < OPPOSED; ++i) {
            allow_impulse(g, layout->spring[j][i], 3, impulse);
        }
        const double of_force = impulse + length * island->friction;
        allow_impulse(g, layout->impulse[j], ode_impulses(g->ode.values), of_force);
        most = fmax(most, of_force);
    }
    allow_impulse(g, layout->dissipated, layout->size - layout->dissipated, most);
}

/* The size of a state is the larger of its sizes at the start and at the end of the guess. Where bodies turn,
 * the errors allowed include rounding. */
static void general_set_weights(struct general *g)
{
    struct radau_step *p = &g->step;
    memcpy(g->y, p->y, (size_t)g->ode.layout.size * sizeof *g->y);
    radau_step_stage(p, p->stages->stages - 1, g->y);
    ode_nominal(&g->ode, p->y, g->size_of);
    ode_nominal(&g->ode, g->y, g->end_size);
    for (int i = 0; i < g->ode.layout.size; ++i) {
        p->weight[i] = 1.0 / (g->relative * fmax(g->size_of[i], g->end_size[i]) + g->absolute);
    }
    allow_rounding(g);
}

/* The functions that follow make one step: its stages, its length, its error. */

/* After a failure of Newton's method where bodies rub, the limit of the step's length is SOLVABLE_PART times
 * that length. After each success the limit is multiplied by SOLVABLE_GROWTH. */
static const double SOLVABLE_PART = 0.6;
static const double SOLVABLE_GROWTH = 1.1;

/* After a success with at most EASY_ITERATIONS iterations the limit is multiplied by EASY_GROWTH instead. */
enum { EASY_ITERATIONS = 3 };
static const double EASY_GROWTH = 2.0;

/* The polynomial follows a decay by fewer powers of e than this within a step. */
static const double LEAST_STIFF = 5.0;

/* Usual rounding of a gap, divided by the bound of that rounding (rounding_of_gap). */
static const double ROUNDING_OF_GAP = 0.5;

/* Factor of the error within a step. The error at its end may be TOLERANCE_SHARE of the tolerance. The error
 * before the end may be all of the tolerance where bodies turn, ten times that where outputs are read
 * (read_share). Elsewhere it may be a tenth: that costs 2 % more steps and brings the peaks of forces a
 * digit. A tolerance near rounding allows an error at the end of LEAST_TOLERANCE, and within the step nowhere
 * more than a hundred times as much. */
static const double WITHIN_SHARE = 1e-2;

/* This is the length of a step of four stages, divided by the length of an equally accurate step of eight.
 * The oscillation y'' = -y has an error of 1e-12 after steps of 0.18 and 2 radians (measured). */
static const double REACH_OF_FOUR = 0.09;

/* Limits of the growth and shrinkage from one step to the next. */
static const double GROWTH = 4.0;
static const double SHRINKAGE = 0.15;

/* Chebyshev coefficients that do not decrease are noise, as in the slip of friction whose v_0 is hardly more
 * than the rounding of velocities. A small error of noise says nothing about longer steps. */
static const double NOISE_OF_ERROR = 0.1;
static const double NOISE_OF_DECREASE = 0.1;

/* The next step is shorter by this factor than the error would allow. */
static const double SAFETY = 0.9;

/* A step of three to six radians of the springs, here in length_of_springs, may span an impact. */
static const double SPANS_IMPACT[2] = {0.8, 1.5};

/* Returns the stages of a long step. Twelve follow an impact of one contact in a step, where eight take four
 * and 60 % more instructions. Elsewhere eight take fewer, because Newton's method limits the steps as much as
 * their error does: F2 to F4 of the report and the rollers take 20 to 40 % fewer so at 1e-9. In steps that
 * are read within, twelve would save F3 a quarter and cost F2 and the rollers 10 to 60 %. */
static const struct radau_stages *stages_of_long_step(const struct general *g, double length)
{
    const double radians = length / length_of_springs(g);
    const bool spans = radians >= SPANS_IMPACT[0] && radians <= SPANS_IMPACT[1];
    return spans && g->touching == 1 ? &radau_stages_12 : &radau_stages_8;
}

/* Returns how long an accurate step with these stages is, as a part of one with eight or twelve stages. */
static double reach_of(const struct radau_stages *stages)
{
    return stages->stages == 4 ? REACH_OF_FOUR : 1.0;
}

/* Above this multiple of v_0 regularized friction is at its limit: exp(-40) is below the rounding of 1. */
static const double SATURATED_SLIP = 40.0;

/* Returns the error [N] that rounding of the slip leaves in the rate of an integral of regularized friction.
 * The forces are unknowns of the iterations, and the part linear in the rounding does not reach them. The
 * square of the rounding divided by v_0 remains. */
static double rounding_of_friction(const struct friction_law *law, double limit, double speeds)
{
    const double part = fmin(ROUNDING_OF_STATES * speeds / law->slip_velocity, 1.0);
    return fmax(limit, 0.0) * part * part;
}

/* Friction is a function of the slip divided by v_0. The error allowed in a speed, and in a spin times its
 * arm [m], is therefore at most v_0. Newton's method leaves its share of this error. The error of integrals
 * goes with the square of what is left, divided by v_0; this square may be the tolerance at most. */
static void limit_errors_of_slip(struct general *g, double slip_velocity, int body, double arm)
{
    const double part = sqrt(solver_relative_tolerance(g->ode.values)) / newton_share(g);
    const double speed = fmin(part, 1.0) * slip_velocity;
    const int spin = g->ode.layout.spin[body];
    for (int k = 0; k < 3; ++k) {
        if (g->ode.layout.body[body] >= 0) {
            double *largest = g->largest_error + g->ode.layout.body[body] + 3 + k;
            *largest = fmin(*largest, speed);
        }
        if (spin >= 0) {
            g->largest_error[spin + k] = fmin(g->largest_error[spin + k], speed / arm);
        }
    }
}

/* Limits the errors allowed in states by regularized friction, and notes its rounding. `speeds` is the sum of
 * all speeds that make up the slip [m/s]. A resistance to rolling has an omega_0 and a torque, which the arms
 * turn into a v_0 and a force. */
static void note_friction(struct general *g, const struct scene_instant *at, int contact, const int body[2],
                          const double arm[2], double speeds)
{
    for (int i = 0; i < contact_opposed(g->ode.values, contact); ++i) {
        const struct opposed_state o = opposed_of(at, contact, i);
        const double v_0 = o.law.slip_velocity;
        const bool slips = i == OPPOSED_SLIP;
        if (o.law.kind != FRICTION_REGULARIZED) {
            continue;
        }
        for (int k = 0; k < 2; ++k) {
            if (!(vec3_norm(o.slip) > SATURATED_SLIP * v_0)) {
                limit_errors_of_slip(g, slips ? v_0 : arm[k] * v_0, body[k], arm[k]);
            }
        }
        const double limit = friction_limit(&o.law, o.regime, at->normal_force[contact]);
        const double rounding = rounding_of_friction(&o.law, limit, slips ? speeds : o.size);
        double *largest = &g->island[g->ode.layout.island[contact]].friction;
        *largest = fmax(*largest, slips ? rounding : rounding / arm[0]);
    }
}

/* Returns the derivatives of the normal force of a contact in its regime. */
static struct contact_slopes slopes_at(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    return contact_force_slopes(&law, regime, at->geometry[contact].gap, at->geometry[contact].gap_rate);
}

/* Notes by how much a unit impulse of a contact changes its states: speeds by 1/m, spins by an arm across it,
 * the impulses of the force by one, those of the torques by their arms [m], the energies by the speeds [m/s].
 * Returns the sum of the speeds that meet [m/s]. */
static double note_impulse(struct general *g, const struct scene_instant *at, int contact, const int body[2],
                           const double arm[2])
{
    const struct scene_values *v = g->ode.values;
    const struct ode_layout *layout = &g->ode.layout;
    double speeds = 0.0;
    for (int i = 0; i < 2; ++i) {
        const int first = layout->body[body[i]];
        const int spin = layout->spin[body[i]];
        const double by_spin = spin >= 0 ? arm[i] / body_inertia_of(v, body[i]).x : 0.0;
        speeds += vec3_norm(at->velocity[body[i]]);
        speeds += scene_turns(v) ? vec3_norm(at->turning.body[body[i]].angular_velocity) * arm[i] : 0.0;
        for (int k = 0; k < 3 && first >= 0; ++k) {
            g->per_impulse[first + 3 + k] = body_inverse_mass(v, body[i]);
        }
        for (int k = 0; k < 3 && spin >= 0; ++k) {
            g->per_impulse[spin + k] = fmax(g->per_impulse[spin + k], by_spin);
        }
    }
    for (int k = 0; k < ode_impulses(v); ++k) {
        g->per_impulse[layout->impulse[contact] + k] = k < 3 ? 1.0 : arm[2 - k / 3];
    }
    for (int i = layout->dissipated; i < layout->size; ++i) {
        g->per_impulse[i] += speeds;
    }
    return speeds;
}

/* Notes the rounding of a contact, and adds to `square` the stiffness that each of its bodies feels, times
 * the body's admittance at the point of contact [1/s^2]. */
static void note_contact(struct general *g, const struct scene_instant *at, int contact,
                         double square[SCENE_BODIES])
{
    const struct scene_values *v = g->ode.values;
    const int body[2] = {contact_source(contact), contact_destination(contact)};
    const bool turns = scene_turns(v);
    const double apart = vec3_norm(at->separation[contact]);
    const double arm[2] = {turns ? vec3_norm(at->turning.source_arm[contact]) : apart,
                           turns ? vec3_norm(at->turning.destination_arm[contact]) : apart};
    const double speeds = note_impulse(g, at, contact, body, arm);
    const double by[2] = {normal_admittance(at, contact, 0), normal_admittance(at, contact, 1)};
    const bool is_felt = by[0] + by[1] > 0.0;
    const double stiffness = is_felt ? fabs(slopes_at(at, contact).by_gap) : 0.0;
    struct general_island *island = &g->island[g->ode.layout.island[contact]];
    struct general_rounding *rounding = &g->rounding[contact];
    *rounding = (struct general_rounding){.place = ROUNDING_OF_GAP * rounding_of_gap(at, contact),
                                          .spring = stiffness,
                                          .momentum = is_felt ? speeds / (by[0] + by[1]) : 0.0,
                                          .force = fabs(at->normal_force[contact])};
    for (int i = 0; i < 2; ++i) {
        const bool tips = SCENE_ANY_TIPPING && g->ode.layout.spin[body[i]] >= 0 && body_tips(v, body[i]);
        rounding->place += tips ? ROUNDING_OF_STATES * arm[i] : 0.0; /* of the orientation */
        square[body[i]] += stiffness * by[i];
    }
    if (!is_felt) { /* where neither body moves or turns, no error of a speed contains the force's rounding */
        island->friction = fmax(island->friction, rounding_of_force(at, contact));
    }
    if (SCENE_ANY_FRICTION) {
        note_friction(g, at, contact, body, arm, speeds);
    }
}

/* Notes, at the start of a step, the rounding of contacts and islands, the frequencies of the islands, and
 * the largest error allowed in each state. */
static void note_errors(struct general *g)
{
    double square[SCENE_BODIES] = {0.0};
    g->touching = 0;
    memset(g->island, 0, (size_t)g->ode.layout.groups * sizeof *g->island);
    for (int i = 0; i < g->ode.layout.size; ++i) {
        g->per_impulse[i] = 0.0;
        g->largest_error[i] = (double)INFINITY;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(g->state, j)) { /* bodies apart feel no rounding of their gap, however large */
            note_contact(g, &g->at_start, j, square);
            g->touching += 1;
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(g->state, j)) {
            double *of = &g->island[g->ode.layout.island[j]].frequency;
            *of = fmax(*of, sqrt(square[contact_source(j)] + square[contact_destination(j)]));
        }
    }
}

/* Returns the fastest decay [1/s] of the motions in touch, by dashpots and by friction, and of springs of
 * friction. */
static double fastest_decay_at(const struct general *g, const struct scene_instant *at)
{
    const struct scene_values *v = g->ode.values;
    double most = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!contact_transmits(g->state, j)) {
            continue;
        }
        const double by_normal = normal_admittance(at, j, 0) + normal_admittance(at, j, 1);
        most = fmax(most, fabs(slopes_at(at, j).by_rate) * by_normal);
        for (int i = 0; i < contact_opposed(v, j); ++i) {
            const struct opposed_state o = opposed_of(at, j, i);
            const struct friction_state rubbing = turning_rubbing(at, j, i);
            struct friction_slopes by;
            struct vec3 force = {0.0, 0.0, 0.0};
            (void)friction_missed(&o.law, o.regime, rubbing, &force, false, 1.0, &by);
            most = fmax(most, friction_spring_drive_of(&o.law, o.regime, rubbing).decay);
            const struct vec3 slope = {by.by_slip[0].x, by.by_slip[1].y, by.by_slip[2].z};
            most = fmax(most, vec3_max_abs(slope) * opposed_admittance(at, j, i));
        }
    }
    return most;
}

/* Whether a contact transmits a force under Hertz's law, whose spring bends at the touch. */
static bool force_bends(const struct general *g, int contact)
{
    const struct contact_law law = scene_contact_law(g->state, contact);
    return SCENE_ANY_HERTZ && contact_is_hertz(&law) && contact_transmits(g->state, contact);
}

static bool any_force_bends(const struct general *g)
{
    bool any = false;
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        any = any || force_bends(g, j);
    }
    return any;
}

/* Returns the time since the touch of a contact under Hertz's law; INFINITY: it is long past its touch, or
 * opens. A contact that began with an overlap touched earlier, at its present speed. */
static double since_touch(const struct general *g, int contact)
{
    const struct contact_geometry *now = &g->at_start.geometry[contact];
    return force_bends(g, contact) && now->gap_rate < 0.0
               ? fmax(g->step.start - g->state->contact[contact].record.touch_clock,
                      fmax(-now->gap, 0.0) / -now->gap_rate)
               : (double)INFINITY;
}

/* Begins steps at the state `y`. */
static void general_begin(struct general *g, double clock, const double *y)
{
    radau_step_begin(&g->step, clock, y);
    ode_instant(&g->ode, clock, g->step.y, &g->at_start);
    note_errors(g);
    g->fastest_decay = general_rubs(g) ? fastest_decay_at(g, &g->at_start) : 0.0;
    if (!(g->plan.longest > 0.0 && isfinite(g->plan.longest))) {
        g->plan.longest = length_of_springs(g);
    }
}

/* Solves the stages from the guess that goes on from the last step. */
static bool try_to_solve(struct general *g, const struct radau_stages *stages, double length)
{
    struct radau_step *p = &g->step;
    radau_step_guess_on(p, stages, length);
    general_set_weights(g);
    return node_forces_solve(g, newton_share(g),
                             p->problem.turns || radau_step_goes_on(p) ? NULL : general_set_weights);
}

/* Whether a state decays within the step so fast that the polynomial does not follow it. */
static bool is_stiff(const struct general *g)
{
    return general_rubs(g) && g->step.length * g->fastest_decay > LEAST_STIFF;
}

/* Rolling ends within a step if the fastest decay at its stages is less than this part of that at its start.
 * The slip then bends between the last nodes, and the Chebyshev coefficients decrease as if it did not. The
 * error at the end is then taken to be at least the error within. */
static const double END_OF_ROLLING = 0.3;

/* Completes a step whose stages are solved. Returns its largest error, divided by the error allowed. */
static double finish_step(struct general *g)
{
    struct radau_step *p = &g->step;
    g->is_sampled = false;
    radau_step_finish(p);
    const struct radau_error error = radau_step_error(p);
    g->error_within = error.within;
    g->error_is_noise = p->problem.turns && !(error.at_end < NOISE_OF_DECREASE * error.within);
    g->error_at_end = fmax(error.at_end, g->within_share * error.within);
    g->error_of_rolling = 0.0;
    if (general_rubs(g) && g->error_at_end <= 1.0) {
        const double decay = fastest_decay_at(g, &g->at_stage[p->stages->stages - 1]);
        g->error_of_rolling = decay < END_OF_ROLLING * g->fastest_decay ? error.within : 0.0;
    }
    return fmax(g->error_at_end, g->error_of_rolling);
}

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

/* A step ends before the centre by this part of the way there, because a stage in the centre has no n. The
 * next step begins a hundred times nearer, so that few such steps lead there. */
static const double BEFORE_CENTRE = 0.01;
enum { OFFSET_FROM_CENTRE = OPPOSED }; /* stands beside enum opposed in note_bend */

/* Returns the time after the start of the step below which a time is rounding of the clock [s]. */
static double clock_rounding(const struct general *g)
{
    return 64.0 * DBL_EPSILON * fabs(g->step.start);
}

/* Returns the impulse that a step misses where a motion passes zero that friction opposes [N s, N m s], at a
 * part of the step and with the change `rate` of this motion in a whole step [m/s, rad/s]. The impulse is
 * less near the ends of the step, where a polynomial fits the longer piece. */
static double missed_by_friction(const struct general *g, const struct scene_instant *at, int contact,
                                 int motion, double part, double rate)
{
    const struct friction_law law = scene_friction_law(g->state, contact, motion);
    const int s = g->step.stages->stages;
    const double end = fmin(part, 1.0 - part);
    const double share = fmin(MISSED_AT_BEND / (s * s * s), end * end * end);
    const double slips = law.kind == FRICTION_REGULARIZED ? rate / law.slip_velocity : 0.0;
    const double limit = friction_limit(&law, FRICTION_SLIDING, at->normal_force[contact]);
    return 0.5 * limit * slips * slips * g->step.length * share;
}

/* Returns the impulse that a step misses where n reverses in the centre, at a part of the step [N s]. Radau
 * quadrature of a jump misses less than the jump divided by the number of stages (computed), and before the
 * first stage the time up to the jump. */
static double missed_at_centre(const struct general *g, const struct scene_instant *at, int contact,
                               double part)
{
    const struct contact_shape shape = scene_contact_shape_at(at, contact);
    const double jump = contact_is_plane(&shape) ? 0.0 : 2.0 * fabs(at->normal_force[contact]);
    return jump * g->step.length * fmin(part, 1.0 / g->step.stages->stages);
}

/* Notes the part of the step at which a vector is least between the last sample and the one at a place, if
 * the step misses more of an impulse there than the error allowed. The vector is a motion that friction
 * opposes, or the offset from the centre. A vector that does not reach zero is smooth, with singularities at
 * complex times; the convergence of Radau quadrature follows from their distance. */
CONTACT_COLD static void note_bend(struct general *g, const struct scene_instant *at, int contact, int motion,
                                   int place, struct vec3 last, struct vec3 now)
{
    const struct radau_step *p = &g->step;
    const struct vec3 change = vec3_sub(now, last);
    const double back = -vec3_dot(last, change) / vec3_dot(change, change);
    const double from = place > 1 ? p->stages->node[place - 2] : 0.0;
    const double lasts = p->stages->node[place - 1] - from;
    const double rate = vec3_norm(change) / lasts;
    const double part = (from + lasts * back) * (motion == OFFSET_FROM_CENTRE ? 1.0 - BEFORE_CENTRE : 1.0);
    const double missed = motion == OFFSET_FROM_CENTRE
                              ? missed_at_centre(g, at, contact, part)
                              : missed_by_friction(g, at, contact, motion, part, rate);
    if (!(missed > 0.0)) {
        return;
    }
    const double away = 2.0 * vec3_norm(vec3_axpy(last, back, change)) / rate; /* in halves of the step */
    const double resolved = pow(away + sqrt(1.0 + away * away), 2.0 * p->stages->stages - 1.0);
    const int impulse =
        g->ode.layout.impulse[contact] + (motion == OPPOSED_SLIP || motion == OFFSET_FROM_CENTRE ? 0 : 6);
    if (missed * p->weight[impulse] > resolved && part * p->length > clock_rounding(g)) {
        g->bend = fmin(g->bend, part);
    }
}

/* Notes the bends of a contact's force between the last sample and this one. */
static void note_bends(struct general *g, const struct scene_instant *at, int contact, int place)
{
    const struct scene_instant *before = place > 1 ? &g->at_stage[place - 2] : &g->at_start;
    const struct vec3 from = before->geometry[contact].offset;
    const struct vec3 to = at->geometry[contact].offset;
    const bool rubs = SCENE_ANY_FRICTION && g->step.problem.turns;
    for (int i = 0; rubs && i < contact_opposed(g->ode.values, contact); ++i) {
        const struct vec3 slip = turning_rubbing(at, contact, i).slip;
        const struct vec3 last = g->slip[contact][i];
        const double both = vec3_dot(last, slip);
        g->slip[contact][i] = slip;
        if (place > 0 && both < vec3_dot(last, last) && both < vec3_dot(slip, slip)) {
            note_bend(g, at, contact, i, place, last, slip);
        }
    }
    if (SCENE_ANY_CURVED && vec3_dot(from, to) < 0.0) {
        note_bend(g, at, contact, OFFSET_FROM_CENTRE, place, from, to);
    }
}

/* Samples the event functions at an instant. */
static void sample_events_at(struct general *g, const struct scene_instant *at, int place)
{
    double *events = g->events[place];
    ode_events_at(&g->ode, at, events);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!g->ode.layout.met[j]) {
            continue;
        }
        g->loads[place][j][GENERAL_FORCE] = at->normal_force[j];
        g->loads[place][j][GENERAL_DEPTH] = -at->geometry[j].gap;
        if (contact_transmits(g->state, j)) {
            note_bends(g, at, j, place);
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
    if (g->is_sampled) {
        return;
    }
    g->is_sampled = true;
    g->bend = (double)INFINITY;
    memset(g->event_size, 0, sizeof g->event_size);
    sample_events_at(g, &g->at_start, 0);
    for (int i = 0; i < p->stages->stages; ++i) {
        sample_events_at(g, &g->at_stage[i], i + 1);
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

/* Returns an event function at a part of the step, for the state given by the polynomial of the states. */
static double event_at(struct general *g, int event, double part)
{
    const struct radau_step *p = &g->step;
    double events[ODE_EVENTS];
    radau_step_at(p, part, g->y);
    ode_events(&g->ode, p->start + part * p->length, g->y, events);
    return events[event];
}

/* Returns an event function at a place of the step. */
static double event_within(struct general *g, int event, double place)
{
    return event_at(g, event, radau_part(g->step.stages, place));
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
 * is above zero there, the dip is an error of the polynomial, and false is returned. So is a dip of the gap
 * between a touch and the first sample, because springs take longer to part the bodies again. */
static bool enclose_dip(struct general *g, int event, const double *of, double from, double ends[2])
{
    const struct radau_stages *stages = g->step.stages;
    const int count = stages->stages + 1;
    double dip[RADAU_MOST_STAGES + 1];
    int after = 0;
    while (after + 1 < stages->stages && stages->place[after] <= from) {
        after += 1;
    }
    if (after == 0 && event % ODE_EVENTS_EACH == (int)ODE_EVENT_GAP &&
        g->state->contact[event / ODE_EVENTS_EACH].record.touch_clock == g->step.start) {
        return false;
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

/* Returns the clock of the first release under Hertz's law that the polynomial shows within the step, or
 * INFINITY. The bend of the force there makes the step inaccurate, but hardly moves the release. */
static double release_within(struct general *g)
{
    double first = (double)INFINITY;
    sample_events(g);
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        if (force_bends(g, j)) {
            const double place = fall_within(g, ODE_EVENTS_EACH * j + (int)ODE_EVENT_GAP, first);
            first = place > 0.0 ? fmin(first, place) : first;
        }
    }
    return first < (double)INFINITY ? g->step.start + radau_part(g->step.stages, first) * g->step.length
                                    : first;
}

/* Returns the factor of the next length. With s stages the error at the end goes as length to the power
 * 2 s - 1, and the error within as length to the power s. */
static double factor_of(const struct general *g, double error, const struct radau_stages *stages)
{
    if (!(error < (double)INFINITY)) {
        return general_rubs(g) ? SOLVABLE_PART : 0.4;
    }
    const double power = 1.0 / (2.0 * stages->stages - 1.0);
    const double at_end = g->error_at_end;
    const double of_rolling = SAFETY * pow(fmax(g->error_of_rolling, 1e-100), -1.0 / stages->stages);
    if (g->error_is_noise && (at_end < NOISE_OF_ERROR || at_end > 1.0)) {
        return fmin(at_end > 1.0 ? SHRINKAGE : of_rolling, GROWTH);
    }
    const double factor = fmin(SAFETY * pow(fmax(at_end, 1e-100), -power), of_rolling);
    return fmin(fmax(factor, SHRINKAGE), GROWTH);
}

/* Returns the largest ratio of the next step's length to that of a step which took so many iterations for the
 * forces. A step that took many is near the length at which they fail. The ratios are chosen, not derived: F4
 * of the report with 997 steps takes 8 % fewer instructions with them, other problems as many on average. */
static double growth_by_iterations(int iterations)
{
    static const double GROWTH_AFTER[] = {4.0, 4.0, 4.0, 4.0, 2.0, 1.5, 1.1, 1.1};
    return iterations < 8 ? GROWTH_AFTER[iterations] : 0.8;
}

/* An attempt at a step has a length [s], a number of stages, and an error, divided by the error allowed. */
struct attempt {
    double length, error;
    const struct radau_stages *stages;
};

/*
 * Forces under Hertz's law go with the power 3/2 of the time since the touch and of the time to the release.
 * A step from the touch and one to the release have a pace that makes these powers polynomials
 * (math/node_tables.h). A step that begins soon after a touch, or ends soon before a release, is at most
 * BENDS_APART times as long as the time between: the Chebyshev coefficients then fall by 1/3 each.
 */
#define BENDS_APART 3.0

/* A touch that is nearer to the start of a step than this part of its length does not matter: the impulse in
 * between is the power 5/2 of this part, 3e-13, of that in the step. */
static const double NO_IMPULSE = 1e-5;

/* Whether the step begins at a touch. A touch shortly before limits its length. */
static bool is_at_touch(const struct general *g, double *length)
{
    bool found = false;
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        const double since = since_touch(g, j);
        if (since <= fmax(NO_IMPULSE * *length, clock_rounding(g))) {
            found = true;
        } else {
            *length = fmin(*length, BENDS_APART * since);
        }
    }
    return found;
}

/* Returns the next attempt at a step, with its length and its method. The step lasts `limit` [s] at most. The
 * attempt has the pace to a release if it lasts up to there; `ahead` is the time to the release [s]. */
static struct attempt plan_attempt(const struct general *g, double limit, double ahead)
{
    struct attempt next = {.length = fmin(limit, g->plan.longest), .error = (double)INFINITY};
    const bool at_touch = is_at_touch(g, &next.length);
    if (at_touch) {
        next.length = fmin(next.length, 0.5 * ahead);
        next.stages = &radau_stages_touch;
        return next;
    }
    if (next.length >= ahead / (1.0 + RADAU_REST)) {
        next.length = ahead / (1.0 + RADAU_REST);
        next.stages = &radau_stages_release;
        return next;
    }
    next.length = fmin(next.length, BENDS_APART / (1.0 + BENDS_APART) * ahead);
    next.stages = next.length <= REACH_OF_FOUR * g->plan.longest ? &radau_stages_4
                                                                 : stages_of_long_step(g, next.length);
    return next;
}

/* Returns an attempt with fewer stages than `wanted` if its unknowns have no room otherwise. */
static struct attempt fit_attempt(const struct general *g, struct attempt wanted)
{
    const int most = node_forces_stages(g, wanted.length);
    if (most >= wanted.stages->stages) {
        return wanted;
    }
    wanted.stages = most >= radau_stages_8.stages ? &radau_stages_8 : &radau_stages_4;
    wanted.length = fmin(wanted.length, reach_of(wanted.stages) * g->plan.longest);
    return wanted;
}

/* Returns the clock of the first release after the end of the step, by the gaps and gap rates at the end. It
 * is accurate where the step ends close to the release. INFINITY: no contact opens at the end. */
static double release_after(const struct general *g)
{
    const struct scene_instant *at = &g->at_stage[g->step.stages->stages - 1];
    const double end = g->step.start + g->step.length;
    double least = (double)INFINITY;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_geometry *now = &at->geometry[j];
        if (force_bends(g, j) && now->gap < 0.0 && now->gap_rate > 0.0) {
            least = fmin(least, end - now->gap / now->gap_rate);
        }
    }
    return least;
}

/* Returns the time from the start of the step to the release under Hertz's law that a solved attempt shows
 * within the step or after its end [s]. INFINITY: no contact opens, or it opens at the start. */
static double time_to_release(struct general *g)
{
    const double time = fmin(release_within(g), release_after(g)) - g->step.start;
    return time > clock_rounding(g) ? time : (double)INFINITY;
}

/* Returns the error, divided by the error allowed, of a step with a release before its second stage: the
 * stages then hardly show the impulse before the release. */
static double error_before_stages(const struct general *g, double release)
{
    const struct radau_step *p = &g->step;
    double error = 0.0;
    for (int j = 0; SCENE_ANY_HERTZ && release < p->stages->node[1] * p->length && j < SCENE_CONTACTS; ++j) {
        if (force_bends(g, j)) {
            const double impulse = release * g->at_start.normal_force[j];
            error = fmax(error, impulse * p->weight[g->ode.layout.impulse[j]]);
        }
    }
    return error;
}

/* Shortens g->plan.longest after the attempt `now` has been rejected. */
static void shorten(struct general *g, const struct attempt *now)
{
    const double factor = factor_of(g, now->error, now->stages);
    g->plan.longest = fmin(now->length / reach_of(now->stages) * factor, 0.9 * g->plan.longest);
}

/* Behind a touch an accurate step is longer than one from the touch by this factor. */
static const double AFTER_TOUCH = 2.0;

/* Returns the factor of the next length if the ratio of the length to the accurate length goes on as from the
 * last step to this one (the predictive controller of Gustafsson, 1994). Where bodies rub, steps towards a
 * singularity, such as the end of a slip, become shorter by the same ratio again and again. INFINITY: the
 * steps do not become shorter, and the ratio of their errors may be that of rounding. */
static double factor_of_trend(const struct general *g, const struct attempt *now)
{
    if (!general_rubs(g) || !(now->length < g->plan.last_length)) {
        return (double)INFINITY;
    }
    const double worse = now->error * now->error / g->plan.last_error;
    const double factor = SAFETY * now->length / g->plan.last_length;
    return fmax(factor * pow(worse, -1.0 / (2.0 * now->stages->stages - 1.0)), SHRINKAGE);
}

/* Sets g->plan.longest for the next step after the attempt `now` has been accepted. A step that an event, the
 * end of the motion, a touch or a release has shortened says little about the longest step. */
static void lengthen(struct general *g, const struct attempt *now)
{
    const double paced = now->stages->pace == RADAU_FROM_TOUCH ? AFTER_TOUCH : 1.0;
    const double of_error = factor_of(g, now->error, now->stages);
    const bool is_shortened = now->length < g->plan.longest && (any_force_bends(g) || !(of_error < GROWTH));
    const double factor = is_shortened ? of_error : fmin(of_error, factor_of_trend(g, now));
    const double next = now->length / reach_of(now->stages) * paced * factor;
    g->plan.last_length = now->length;
    g->plan.last_error = fmax(now->error, 1e-100);
    if (is_shortened) {
        g->plan.longest = fmax(next, g->plan.longest);
    } else {
        g->plan.longest = fmin(next, GROWTH * fmax(g->plan.longest, now->length));
        if (general_rubs(g)) {
            g->plan.longest = fmin(g->plan.longest, growth_by_iterations(g->step.iterations) * now->length);
        }
    }
    g->plan.longest = fmin(g->plan.longest, fmax(g->plan.solvable, now->length));
    g->plan.solvable *= g->step.iterations <= EASY_ITERATIONS ? EASY_GROWTH : SOLVABLE_GROWTH;
}

/* Near a release the last Chebyshev coefficients decrease more slowly than those of an oscillation. The error
 * at the end is then at least this share of the error within. The share is chosen: impacts with elastic
 * friction are as accurate with it as with steps that all end before a release. */
static const double SHARE_AT_RELEASE = 0.1;

/* Makes one accurate step of at most `limit` [s] in g->step. Returns false with a message where no step is
 * accurate enough, and false where the `budget` of steps is used up. A step longer than `left` [s] is
 * accurate within as well, because outputs are read there. */
static bool make_accurate_step(struct general *g, double limit, double left, long *budget)
{
    double release = (double)INFINITY; /* time to it, by the last solved attempt [s] */
    for (;;) {
        if (*budget <= 0) {
            return false;
        }
        struct attempt now = fit_attempt(g, plan_attempt(g, limit, release));
        g->within_share = now.length > left       ? g->read_share
                          : g->step.problem.turns ? fmin(0.1 * g->read_share, WITHIN_SHARE)
                                                  : WITHIN_SHARE;
        const bool solved = try_to_solve(g, now.stages, now.length);
        if (solved) {
            now.error = finish_step(g);
            release = any_force_bends(g) ? time_to_release(g) : (double)INFINITY;
            if (now.stages->pace != RADAU_TO_RELEASE && release < BENDS_APART * now.length) {
                g->error_at_end = fmax(g->error_at_end, SHARE_AT_RELEASE * g->error_within);
                g->error_at_end = fmax(g->error_at_end, error_before_stages(g, release));
                now.error = fmax(now.error, g->error_at_end);
            }
        }
        if (now.error <= 1.0) {
            lengthen(g, &now);
            *budget -= 1;
            return true;
        }
        if (general_rubs(g) && !(now.error < (double)INFINITY)) {
            g->plan.solvable = SOLVABLE_PART * now.length;
        }
        g->rejected += 1;
        shorten(g, &now);
        if (!(g->step.start + g->plan.longest > g->step.start) || g->plan.longest < 1e-18 * limit) {
            snprintf(g->message, INTEGRATOR_MESSAGE_SIZE,
                     "no step of the general segment is accurate enough from here on");
            return false;
        }
    }
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
    const double apart = 0.02 * part;
    const double before = event_at(g, event, part - apart);
    return (event_at(g, event, part) - before) / (apart * g->step.length);
}

/* Estimates the time from a part of the step to the event [s] by the rate of the event function. */
static double missing_to(struct general *g, int event, double rate, double part)
{
    return rate < 0.0 ? -event_at(g, event, part) / rate : 0.0;
}

/* Returns the part of the step at which an event lies that is close to `part`. The rate is right to a few
 * hundredths, so that each move leaves a few hundredths of the distance. The last move leaves only rounding
 * of the gap, so that bodies whose contact ends do not overlap. */
static double part_of_event(struct general *g, int event, double rate, double part)
{
    const struct radau_step *p = &g->step;
    for (int k = 0; k < MOST_MOVES; ++k) {
        const double missing = missing_to(g, event, rate, part);
        if (fabs(missing) <= DBL_EPSILON * fabs(p->start + part * p->length)) {
            break;
        }
        part += fmin(fmax(missing / p->length, -fmin(CLOSE, part)), CLOSE);
    }
    return part;
}

/* Makes the step again with another length, with its polynomial as guess, and looks for the first event on
 * the new one. Returns false where the iteration does not converge or the error is too large. A stiff step is
 * judged by its error within as well, because the longer step had not resolved the slip at the new end. */
static bool look_again(struct general *g, double length, struct general_event *found)
{
    radau_step_guess_on(&g->step, g->step.stages, length);
    if (!node_forces_solve(g, newton_share(g), NULL)) {
        return false;
    }
    const double error = finish_step(g);
    if (!((is_stiff(g) ? fmax(error, g->error_within) : error) <= 1.0)) {
        return false;
    }
    *found = general_first_event(g);
    return true;
}

/* Locates the event `found`, by a shorter step that ends there if need be. Where the shorter step shows that
 * the event comes later, the step ends before the event and `found` becomes "no event". Returns false where
 * no step is accurate enough.
 *
 * Where the polynomial is not accurate enough between its ends, a shorter step is made that ends at the
 * event. The event is located again on the shorter step's polynomial until both agree. A shorter step without
 * an event is made longer by what its end misses, because the next long step would only find the same event
 * and end before it again. Where no such step can be made, because friction has no direction where
 * the normal force ends, a step of half the length comes first. A stiff step is made again in any case,
 * because its polynomial may reach F_n < 0 and reverse the slip. */
static bool locate_event(struct general *g, struct general_event *found)
{
    for (int i = 0; i < MOST_TRIALS && found->event >= 0; ++i) {
        const double rate = rate_at(g, found->event, found->part);
        const int event = found->event;
        double length = g->step.length * found->part;
        const double accurate = g->step.problem.turns ? ACCURATE_WITHIN : 1.0;
        if (!(g->error_within > accurate) && !is_stiff(g)) {
            found->part = part_of_event(g, event, rate, found->part);
            return true;
        }
        if (!look_again(g, length, found)) {
            if (!look_again(g, 0.5 * length, found)) {
                return false;
            }
            continue;
        }
        double missing = missing_to(g, event, rate, 1.0);
        for (int k = 0;
             k < MOST_MOVES && found->event < 0 && missing > CLOSE * length && missing < 0.1 * length; ++k) {
            length += missing;
            if (!look_again(g, length, found)) {
                return false;
            }
            missing = missing_to(g, event, rate, 1.0);
        }
        const bool is_first =
            found->event < 0 || found->part >= 1.0 - CLOSE; /* on the shorter step's polynomial */
        if (is_first && fabs(missing) <= CLOSE * length) {
            *found = (struct general_event){part_of_event(g, event, rate, 1.0), event};
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
 * what is known. The scene itself is evaluated at each such top of the polynomial, so that an error of the
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
    double rest = most; /* from the last top on */
    for (int i = 0; i < count && rest > known; ++i) {
        const struct bernstein_fall fall = bernstein_first_fall(slope, count - 1, 0.0);
        struct scene_instant at;
        if (!(fall.low < (double)INFINITY)) {
            break;
        }
        const double top = bernstein_root(slope, count - 1, fall);
        from += top * (ends[1] - from);
        bernstein_restrict(of, count, top, 1.0);
        if (of[0] > known) {
            const double part = radau_part(p->stages, from);
            radau_step_at(p, part, g->y);
            ode_instant(&g->ode, p->start + part * p->length, g->y, &at);
            contact_peaks_note(&g->state->contact[contact].peaks, at.normal_force[contact],
                               -at.geometry[contact].gap);
        }
        rest = largest_coefficient(of, count);
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
    const double by_gap = fabs(slopes_at(at, contact).by_gap);
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

/* Moves the scene to a clock within the last step; serves as `move` of a scene_output. */
static void move_along_step(void *memory, double clock, struct scene_state *q)
{
    struct general *g = memory;
    const struct radau_step *p = &g->step;
    radau_step_at(p, fmin((clock - p->start) / p->length, 1.0), g->y);
    ode_unpack(&g->ode, q, g->y);
}

/* A step of twelve stages lasts five radians at most. Its parts are shorter than half an oscillation. */
static void look_for_peaks(struct general *g, struct scene_state *q, const struct scene_instant *at,
                           int contact, double from)
{
    const struct radau_step *p = &g->step;
    const double first = fmax(from - p->start, 0.0) / p->length;
    const double last = fmin((q->clock - p->start) / p->length, 1.0);
    const int parts = (int)ceil((last - first) * p->stages->stages / 3);
    const double ends[2] = {radau_place(p->stages, first), radau_place(p->stages, last)};
    if (!search_tops(g, at, contact, ends)) {
        struct scene_output output = {.state = q, .contact = contact, .move = move_along_step, .mover = g};
        output.output.worth_a_search = fmax(g->relative, dense_output_worth_a_search(q->v));
        scene_output_note_peaks(&output, from, q->clock, parts, &q->contact[contact].peaks);
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
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && g->ode.layout.body[i] < 0) {
            const struct vec3 velocity = flight_body_at(q, i, start).velocity;
            q->external_work += flight_work(q, i, velocity, start, clock - start);
        }
        if (SCENE_ANY_ROTATION && body_turns_freely(v, i) && g->ode.layout.spin[i] < 0) {
            flight_turn(q, i, clock);
        }
    }
}

/* Moves the scene along the step to a clock within it or at its end, and notes the peaks up to that clock. */
static void general_follow(struct general *g, struct scene_state *q, double clock)
{
    const struct general_end *end = &g->end;
    const double from = q->clock;
    radau_step_at(&g->step, clock == end->clock ? end->event.part : (clock - g->step.start) / g->step.length,
                  g->y);
    ode_unpack(&g->ode, q, g->y);
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

/* Returns the problem of the states of g->ode.layout. */
static struct radau_problem problem_of(struct general *g, const struct scene_values *v)
{
    const struct ode_layout *layout = &g->ode.layout;
    struct radau_problem problem = {.context = &g->ode,
                                    .size = layout->size,
                                    .coupled = layout->coupled,
                                    .integrals = layout->integrals,
                                    .turns = scene_turns(v),
                                    .unknowns = node_forces_unknowns(v),
                                    .place = g->place,
                                    .speed = g->speed,
                                    .rates = ode_rates};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        for (int k = 0; k < 3 && layout->body[i] >= 0; ++k) {
            g->place[problem.paired] = layout->body[i] + k;
            g->speed[problem.paired] = layout->body[i] + 3 + k;
            problem.paired += 1;
        }
    }
    return problem;
}

bool general_open(struct general **slot, const struct scene_values *v, const struct integrator_memory *memory,
                  char *message)
{
    struct general trial;
    trial.ode.layout = ode_layout_of(v, NULL);
    const struct radau_problem wanted = problem_of(&trial, v);
    const int size = wanted.size;
    const size_t own = (sizeof(struct general) + 15) / 16 * 16;
    const size_t nodes = (node_forces_memory() + 15) / 16 * 16;
    const size_t rows = 5 * (size_t)size * sizeof(double);
    const size_t bytes = own + nodes + rows + radau_step_memory(&wanted);
    if (*slot == NULL || (*slot)->bytes < bytes) {
        struct general *made = memory->allocate(1, bytes);
        if (made == NULL) {
            snprintf(message, INTEGRATOR_MESSAGE_SIZE, "the integrator's memory could not be had");
            return false;
        }
        general_close(slot);
        *slot = made;
        made->bytes = bytes;
        made->release = memory->release;
    }
    struct general *g = *slot;
    g->nodes = (char *)g + own;
    g->y = (double *)(void *)((char *)g + own + nodes);
    g->size_of = g->y + size;
    g->end_size = g->size_of + size;
    g->per_impulse = g->end_size + size;
    g->largest_error = g->per_impulse + size;
    g->steps = g->largest_error + size;
    g->message = message;
    return true;
}

void general_close(struct general **slot)
{
    if (*slot) {
        (*slot)->release(*slot);
        *slot = NULL;
    }
}

/* Makes the segment work on q and its values. */
static void general_attach(struct general *g, struct scene_state *q)
{
    const struct scene_values *v = q->v;
    g->ode.values = v;
    g->ode.state = g->state = q;
    g->ode.layout = ode_layout_of(v, q);
    g->ode.flight = flight_body_at;
    const struct radau_problem problem = problem_of(g, v);
    radau_step_place(&g->step, &problem, g->steps);
    g->relative = fmax(TOLERANCE_SHARE * solver_relative_tolerance(v), LEAST_TOLERANCE);
    g->absolute = TOLERANCE_SHARE * solver_absolute_tolerance(v);
    g->read_share = fmin(g->relative / (READ_PART * solver_relative_tolerance(v)), 1.0);
    g->plan = q->plan;
}

/* Sets the offsets of the event functions at the present. */
static void general_set_events(struct general *g)
{
    struct scene_instant at;
    ode_leave_centres(g->state);
    scene_now(g->state, &at);
    ode_begin(&g->ode, &at, g->relative, g->absolute);
}

/* Prepares a step that starts from `q`. */
static void general_start(struct general *g, struct scene_state *q)
{
    general_attach(g, q);
    g->plan.solvable = (double)INFINITY;
    g->plan.last_length = 0.0;
    g->step.known_length = 0.0;
    memset(g->peaks, 0, sizeof g->peaks); /* a saved state holds all of these peaks, of no former run */
    general_set_events(g);
    ode_pack(&g->ode, g->y);
    general_begin(g, q->clock, g->y);
    if (SCENE_ANY_HERTZ) {
        g->plan.longest = fmin(g->plan.longest, length_of_impacts(&g->at_start));
    }
}

/* Stores the step in the state of motion, because it goes on beyond a communication point: its polynomial
 * gives the motion at later points. */
static void general_keep_step(const struct general *g, struct scene_state *q)
{
    const struct radau_step *p = &g->step;
    struct unfinished_step *kept = &q->unfinished;
    const size_t bytes = (size_t)g->ode.layout.size * sizeof(double);
    kept->start = p->start;
    kept->length = p->length;
    kept->end = g->end.clock;
    kept->end_part = g->end.event.part;
    kept->stages = p->stages->stages;
    kept->pace = (int32_t)p->stages->pace;
    kept->event = g->end.event.event;
    memcpy(kept->at_start, p->y, bytes);
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
    const size_t bytes = (size_t)g->ode.layout.size * sizeof(double);
    g->end = (struct general_end){kept->end, {kept->end_part, kept->event}};
    memcpy(g->step.weight, kept->weight, bytes);
    memcpy(g->peaks, kept->peaks, sizeof g->peaks);
    radau_step_take_over(&g->step, kept->start, kept->length, kept->at_start,
                         radau_stages_of(kept->stages, (enum radau_pace)kept->pace), kept->chebyshev[0],
                         ODE_MOST_STATES);
    return true;
}

/* Moves the scene along the step that `q` stores to a clock before its end. */
static void follow_stored(struct general *g, struct scene_state *q, double clock)
{
    general_follow(g, q, clock);
    q->unfinished.present = clock;
    q->integrator_fresh = 0;
}

void general_follow_kept(struct general *g, struct scene_state *q, double noted, double clock)
{
    q->clock = q->unfinished.present;
    if (general_take_up(g, q)) {
        q->clock = noted;
        follow_stored(g, q, clock);
    }
}

/* Ends the advance by an event at the present. A step over a quiet motion spans many oscillations of the
 * springs. A contact that begins, ends or changes its law excites these oscillations, and a step of twice
 * length_of_springs follows them. */
static enum advance_result end_by_event(struct general *g, struct scene_state *q, struct advance *step,
                                        int event)
{
    if (event % ODE_EVENTS_EACH <= (int)ODE_EVENT_LAW) {
        g->plan.longest = fmin(g->plan.longest, 2.0 * length_of_springs(g));
    }
    const enum advance_result result = advance_to_event(step, q, event);
    if (step->regime == REGIME_APART) {
        projection_end_contact(q, step->contact, g->relative, g->absolute);
    }
    q->contact[step->contact].schedule.dead_band_clock = q->clock * (1.0 + 16.0 * DBL_EPSILON);
    return result;
}

/* Makes a step up to its end or its first event. Where no step can be made to end at the event, a step of
 * half that length is made first. The length is halved until the event is within rounding of the clock. */
static enum advance_result make_step(struct general *g, struct scene_state *q, struct advance *step)
{
    struct general_end *end = &g->end;
    const double left = step->clock_end - q->clock;
    /* a step reaches beyond the end, to be read there, only where rounding allows the tolerance */
    const bool reads = g->relative <= solver_relative_tolerance(g->ode.values);
    const double most = reads ? fmax(step->clock_limit - q->clock, left) : left;
    double longest = (double)INFINITY;
    double known = 0.0; /* g->plan.longest of a step that a bend has shortened */
    if (SCENE_ANY_FRICTION && g->step.problem.turns) {
        g->plan.longest = fmin(g->plan.longest, length_of_sliding(g));
    }
    for (;;) {
        if (!make_accurate_step(g, fmin(most, longest), left, &step->budget)) {
            return step->budget > 0 ? ADVANCE_FAILED : ADVANCE_STEP_LIMIT;
        }
        const struct general_event first = general_first_event(g);
        const double until = first.part * g->step.length;
        if (g->bend < first.part) { /* the step shall end at the bend */
            known = fmax(known, g->plan.longest);
            longest = g->bend * g->step.length;
            g->rejected += 1;
            continue;
        }
        g->plan.longest = fmax(g->plan.longest, known);
        end->event = first;
        if (locate_event(g, &end->event)) {
            end->event.part = end->event.event < 0 ? 1.0 : end->event.part;
            end->clock = end->event.event < 0 && g->step.length == left
                             ? step->clock_end
                             : q->clock + end->event.part * g->step.length;
            return ADVANCE_REACHED;
        }
        ode_pack(&g->ode, g->y);
        general_begin(g, q->clock, g->y);
        if (!(q->clock + 0.5 * until > q->clock)) {
            return end_by_event(g, q, step, first.event);
        }
        longest = 0.5 * until;
        step->budget += 1; /* this step is not counted: the length is halved fifty times at most */
    }
}

/* Moves the scene to the end of the step. Where no event ends it, the next step begins there. */
static enum advance_result end_step(struct general *g, struct scene_state *q, struct advance *step)
{
    const struct general_end *end = &g->end;
    general_follow(g, q, end->clock);
    if (end->event.event >= 0) {
        return end_by_event(g, q, step, end->event.event);
    }
    if (q->clock < step->clock_end) {
        radau_step_at(&g->step, end->event.part, g->y);
        g->y[g->ode.layout.dissipated + 1] = q->external_work; /* with that of fly_others */
        general_begin(g, q->clock, g->y);
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
            general_follow(g, q, step->clock_end);
            general_keep_step(g, q);
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
            follow_stored(g, q, step->clock_end);
            return ADVANCE_REACHED;
        }
        general_set_events(g); /* the last call has stored a step, which ends here */
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
    q->plan = g->plan;
    advance_spend(step, 0, EVALUATION_WORK * (long)g->step.evaluations);
    counter_add(&q->counters.force_evaluations, g->step.evaluations);
    counter_add(&q->counters.rejected_steps, g->rejected);
    return result;
}
