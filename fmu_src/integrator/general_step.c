/* This file makes one step of the general segment: its length, the errors allowed, Newton's method. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "integrator/general_step.h"
#include "integrator/node_forces.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

/* Length of a first step in radians of the fastest oscillation. An impact takes pi radians with a linear
 * spring, and four with Hertz's law. */
static const double FIRST_STEP = 4.0;

/* Length of a first step that begins at a touch under Hertz's law, in the same radians. A step from the touch
 * is accurate over a third of the impact. */
static const double FIRST_STEP_FROM_TOUCH = 1.3;

double general_length_of_springs(const struct general *g)
{
    const struct radau_step *p = &g->step;
    double square = 0.0;
    for (int i = 0; i < p->problem.paired; ++i) {
        double sum = 0.0; /* effect of all positions on one speed [1/s^2] */
        for (int j = 0; j < p->problem.paired; ++j) {
            sum += fabs(radau_slope_of(p, p->problem.speed[i], p->problem.place[j]));
        }
        square = fmax(square, sum);
    }
    return square > 0.0 ? FIRST_STEP / sqrt(square) : (double)INFINITY;
}

/* The stiffness of Hertz's spring grows with the square root of the penetration. From this part of the
 * largest penetration on, general_length_of_springs and the error of a step show the stiffness well
 * enough. */
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
    const struct contact_coefficients factors = contact_factors_of(&law);
    const double k = factors.k * per_mass;
    const double chi = regime == REGIME_COMPRESSION ? factors.c : 0.0;
    const struct contact_geometry *g = &at->geometry[contact];
    const double load = scene_pressing_acceleration(at->q->clock, at, contact);
    const double depth = depth_to_come(k, chi, fabs(g->gap_rate), load);
    if (!(-g->gap < DEEP * depth) || g->gap_rate > 0.0) {
        return (double)INFINITY;
    }
    const double spring = sqrt(1.5 * k * sqrt(depth));
    const double dashpot = k * chi * depth * sqrt(depth);
    return FIRST_STEP_FROM_TOUCH / fmax(spring, dashpot);
}

double general_length_of_impacts(const struct scene_instant *at)
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

/* An opposed motion of a contact (contact/friction.h). */
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
                                  turning_rubbing(&at->q->turning, at, contact, part).slip,
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

double general_length_of_sliding(const struct general *g)
{
    const struct scene_values *v = g->ode.values;
    const struct scene_state *q = g->state;
    struct scene_instant at;
    struct scene_jet along;
    double least = (double)INFINITY;
    bool known = false;
    scene_evaluate(q, q->clock, q->body, &q->turning, NULL, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int count = q->contact[j].regime == REGIME_APART ? 0 : contact_opposed(v, j);
        for (int i = 0; i < count; ++i) {
            const struct opposed_state opposed = opposed_of(&at, j, i);
            const struct opposed_state *o = &opposed;
            if (o->law.kind != FRICTION_REGULARIZED ||
                !(vec3_norm(o->slip) > SLIP_AFTER * o->law.slip_velocity + SLIP_ROUNDING * o->size)) {
                continue;
            }
            if (!known) {
                jet_of_motion(&at, NULL, &along);
                known = true;
            }
            const struct turning_jet *jet = &along.turning[j];
            const struct vec3 *slip = jet->motion[OPPOSED_SLIP];
            least = fmin(least, i == OPPOSED_SLIP ? length_of_opposed(o, g->relative, slip[0], slip)
                                                  : length_of_opposed(o, g->relative, o->slip, jet->spin));
        }
    }
    return fmax(least, SLIP_SHORTEST * fmax(q->clock, 1.0));
}

/* The functions that follow set the errors allowed in a step of the general segment. */

/* Rounding of a difference of states, such as the slip, divided by their size; see rounding_of_rate. */
static const double ROUNDING_OF_STATES = 8.0 * DBL_EPSILON;

/* Returns the rounding in the rate of a state [its unit/s], where `left` numbers the states without
 * positions. It comes from the rounding of gaps through the springs, and from the rounding of these
 * states. */
static double rounding_of_rates(const struct general *g, int left)
{
    const struct radau_step *p = &g->step;
    double by_places = 0.0;
    double by_others = 0.0;
    for (int j = 0; j < p->problem.paired; ++j) {
        by_places += fabs(radau_slope_of(p, p->other[left], p->problem.place[j]));
    }
    for (int j = 0; j < p->others; ++j) {
        by_others += fabs(radau_slope_of(p, p->other[left], p->other[j])) * g->size_of[p->other[j]];
    }
    return by_places * g->rounding[p->group_of[left]].place + ROUNDING_OF_STATES * by_others;
}

/* Adds rounding to the errors allowed. A force made by rounding acts for at most one radian of the
 * oscillation or one decay time. The errors allowed in a speed and in an impulse are at least the changes by
 * such a force. A force through the centre of a body has a torque that is rounding, and the error allowed in
 * a spin is at least what it changes. Each island counts by itself: a far body must not loosen the others. */
static void allow_rounding(struct general *g)
{
    struct radau_step *p = &g->step;
    double spring[ODE_MOST_GROUPS] = {0.0};   /* largest derivative of an acceleration by a place [1/s^2] */
    double fastest[ODE_MOST_GROUPS];          /* radians or decay times in a second [1/s] */
    double impulse[ODE_MOST_GROUPS];          /* of a force made by rounding [N s] */
    double rounding[ODE_MOST_STATES] = {0.0}; /* of the states without positions */
    double most = 0.0;
    for (int i = 0; i < p->problem.paired; ++i) {
        double *of_group = spring + p->group_of[p->speed_among[i]];
        *of_group = fmax(*of_group, fabs(radau_slope_of(p, p->problem.speed[i], p->problem.place[i])));
    }
    for (int i = 0; i < p->problem.groups; ++i) {
        const struct general_rounding *of = &g->rounding[i];
        fastest[i] = fmax(sqrt(spring[i]), 1.0 / p->length);
        impulse[i] = p->length * of->friction + of->mass * (spring[i] / fastest[i]) * of->place;
        most = fmax(most, impulse[i]);
    }
    for (int i = 0; i < p->others; ++i) {
        const struct general_rounding *of = &g->rounding[p->group_of[i]];
        const double decay = fabs(radau_slope_of(p, p->other[i], p->other[i]));
        const double through_centre = ROUNDING_OF_STATES * (of->momentum + p->length * of->force);
        rounding[i] = fmax(rounding_of_rates(g, i) / fmax(fastest[p->group_of[i]], decay),
                           through_centre * g->per_impulse[p->other[i]]);
    }
    for (int j = 0; j < p->problem.paired; ++j) {
        const int i = p->group_of[p->speed_among[j]];
        double *of_speed = rounding + p->speed_among[j];
        *of_speed = fmax(*of_speed, spring[i] / fastest[i] * g->rounding[i].place);
    }
    for (int i = 0; i < p->others; ++i) {
        double *weight = p->weight + p->other[i];
        const double allowed = fmin(1.0 / *weight, g->largest_error[p->other[i]]);
        *weight = 1.0 / (allowed + rounding[i]);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int first = g->ode.layout.impulse[j];
        const int count = g->ode.layout.island[j] < 0 ? 0 : ode_impulses(g->ode.values);
        for (int i = first; i < first + count; ++i) {
            const double by = impulse[g->ode.layout.island[j]] * g->per_impulse[i];
            p->weight[i] = 1.0 / (1.0 / p->weight[i] + by);
        }
    }
    for (int i = g->ode.layout.dissipated; i < g->size; ++i) {
        p->weight[i] = 1.0 / (1.0 / p->weight[i] + most * g->per_impulse[i]);
    }
}

/* The size of a state is the larger of its sizes at the start and at the end of the guess. Where bodies turn,
 * the errors allowed include rounding. */
void general_set_weights(struct general *g)
{
    struct radau_step *p = &g->step;
    memcpy(g->y, p->y, (size_t)g->size * sizeof *g->y);
    radau_step_stage(p, p->stages->stages - 1, g->y);
    ode_nominal(&g->ode, p->y, g->size_of);
    ode_nominal(&g->ode, g->y, g->end_size);
    for (int i = 0; i < g->size; ++i) {
        p->weight[i] = 1.0 / (g->relative * fmax(g->size_of[i], g->end_size[i]) + g->absolute);
    }
    allow_rounding(g);
}

/* The functions that follow make one step of the general segment: its stages, its length, its error. */

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

/* Factor of the error within a step: the error at its end may be a thousandth of the tolerance (general.c),
 * the error before the end may be all of the tolerance where bodies turn, ten times that where outputs are
 * read (read_share). Elsewhere it may be a tenth: that costs 2 % more steps and brings the peaks of forces a
 * digit. A tolerance near rounding allows an error at the end of LEAST_TOLERANCE, and within the step nowhere
 * more than a hundred times as much. */
static const double WITHIN_SHARE = 1e-2;

/* Length of a step of four stages, divided by the length of an equally accurate step of eight. The
 * oscillation y'' = -y has an error of 1e-12 after steps of 0.18 and 2 radians (measured). */
static const double REACH_OF_FOUR = 0.09;

/* Limits of the growth and shrinkage from one step to the next. */
static const double GROWTH = 4.0;
static const double SHRINKAGE = 0.15;

/* A small error by decay before the first stage grows with a low power of the step's length; START_POWER is
 * the inverse of that power. A large error comes from a decay much faster than the step; the next length is
 * at least START_SHRINKAGE times the last. */
static const double START_SHRINKAGE = 0.05;
static const double START_POWER = 1.0 / 6.0;

/* Chebyshev coefficients that do not decrease are noise, as in the slip of friction whose v_0 is hardly more
 * than the rounding of velocities. A small error of noise says nothing about longer steps. */
static const double NOISE_OF_ERROR = 0.1;
static const double NOISE_OF_DECREASE = 0.1;

/* The next step is shorter by this factor than the error would allow. */
static const double SAFETY = 0.9;

/* A step of three to six radians of the springs, here in general_length_of_springs, may span an impact. */
static const double SPANS_IMPACT[2] = {0.8, 1.5};

/* Returns the stages of a long step. Twelve follow an impact in one step, where eight take four steps and
 * 60 % more instructions. Elsewhere eight take fewer, because Newton's method limits the steps as much as
 * their error does: F2 to F4 of the report and the rollers take 20 to 40 % fewer so at 1e-9. In steps that
 * are read within, twelve would save F3 a quarter and cost F2 and the rollers 10 to 60 %. */
static const struct radau_stages *stages_of_long_step(const struct general *g, double length)
{
    const double radians = length / general_length_of_springs(g);
    const bool spans = radians >= SPANS_IMPACT[0] && radians <= SPANS_IMPACT[1];
    return spans ? &radau_stages_12 : &radau_stages_8;
}

/* Returns the length of an accurate step of these stages, divided by the length of a long one. */
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
    const double part = sqrt(solver_relative_tolerance(g->ode.values)) / general_newton_share(g);
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
        const struct opposed_state opposed = opposed_of(at, contact, i);
        const struct opposed_state *o = &opposed;
        const double v_0 = o->law.slip_velocity;
        const bool slips = i == OPPOSED_SLIP;
        if (o->law.kind != FRICTION_REGULARIZED) {
            continue;
        }
        for (int k = 0; k < 2; ++k) {
            if (!(vec3_norm(o->slip) > SATURATED_SLIP * v_0)) {
                limit_errors_of_slip(g, slips ? v_0 : arm[k] * v_0, body[k], arm[k]);
            }
        }
        const double limit = friction_limit(&o->law, o->regime, at->normal_force[contact]);
        const double rounding = rounding_of_friction(&o->law, limit, slips ? speeds : o->size);
        double *largest = &g->rounding[g->ode.layout.island[contact]].friction;
        *largest = fmax(*largest, slips ? rounding : rounding / arm[0]);
    }
}

/* Notes by how much a unit impulse of a contact changes each integral: the impulses of the force by one,
 * those of the torques by their arms [m], the energies by the speeds [m/s]. A spin changes by as much as an
 * impulse across the arm would change it. */
static void note_contact(struct general *g, const struct scene_instant *at, int contact)
{
    const struct scene_values *v = g->ode.values;
    const int body[2] = {contact_source(contact), contact_destination(contact)};
    const bool turns = scene_turns(v);
    const double apart = vec3_norm(at->separation[contact]);
    const double arm[2] = {turns ? vec3_norm(at->turning.source_arm[contact]) : apart,
                           turns ? vec3_norm(at->turning.destination_arm[contact]) : apart};
    const double by_mass = scene_inverse_mass(v, contact);
    double *impulses = g->per_impulse + g->ode.layout.impulse[contact];
    struct general_rounding *rounding = &g->rounding[g->ode.layout.island[contact]];
    double speeds = 0.0;
    for (int i = 0; i < 2; ++i) {
        const int spin = g->ode.layout.spin[body[i]];
        speeds += vec3_norm(at->velocity[body[i]]);
        speeds += turns ? vec3_norm(at->turning.body[body[i]].angular_velocity) * arm[i] : 0.0;
        for (int k = spin; k >= 0 && k < spin + 3; ++k) {
            g->per_impulse[k] = fmax(g->per_impulse[k], arm[i] / body_inertia_of(v, body[i]).x);
        }
    }
    for (int k = 0; k < ode_impulses(v); ++k) {
        impulses[k] = k < 3 ? 1.0 : arm[k / 3 - 1];
    }
    for (int i = g->ode.layout.dissipated; i < g->size; ++i) {
        g->per_impulse[i] += speeds;
    }
    const double mass = by_mass > 0.0 ? 1.0 / by_mass : 0.0;
    rounding->mass = fmax(rounding->mass, mass);
    rounding->momentum = fmax(rounding->momentum, mass * speeds);
    rounding->force = fmax(rounding->force, fabs(at->normal_force[contact]));
    if (!(mass > 0.0)) { /* no speed shows the spring */
        rounding->friction = fmax(rounding->friction, rounding_of_force(at, contact));
    }
    if (SCENE_ANY_FRICTION) {
        note_friction(g, at, contact, body, arm, speeds);
    }
}

/* Returns F_n / (m_red d) of a contact, or zero where n does not turn. */
static double swing_of(const struct general *g, const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape_at(at, contact);
    const struct contact_geometry *geometry = &at->geometry[contact];
    return contact_turns(&shape, geometry)
               ? fabs(at->normal_force[contact]) * scene_inverse_mass(g->ode.values, contact) /
                     geometry->distance
               : 0.0;
}

/* Notes, at the start of a step, the rounding of gaps [m] and of friction, the largest error allowed in each
 * state, and how fast bodies may swing. */
static void note_errors(struct general *g)
{
    struct scene_instant at;
    ode_instant(&g->ode, g->step.start, g->step.y, &at);
    memset(g->rounding, 0, (size_t)g->ode.layout.groups * sizeof *g->rounding);
    for (int i = 0; i < g->size; ++i) {
        g->per_impulse[i] = 0.0;
        g->largest_error[i] = (double)INFINITY;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(g->state, j)) { /* bodies apart feel no rounding of their gap, however large */
            const double of_gap = ROUNDING_OF_GAP * rounding_of_gap(&at, j);
            double *largest = &g->rounding[g->ode.layout.island[j]].place;
            *largest = fmax(*largest, of_gap);
            note_contact(g, &at, j);
            g->swing[j] = swing_of(g, &at, j);
        }
    }
}

/* Returns the fastest decay of a state that is no position [1/s], by slopes at the start or at the end. */
static double fastest_decay_of(const struct radau_step *p, const double *slopes)
{
    double most = 0.0;
    for (int i = 0; i < p->others; ++i) {
        most = fmax(most, fabs(slopes[p->other[i] * (p->problem.coupled + 1)]));
    }
    return most;
}

bool general_force_bends(const struct general *g, int contact)
{
    const struct contact_law law = scene_contact_law(g->state, contact);
    return SCENE_ANY_HERTZ && contact_is_hertz(&law) && contact_transmits(g->state, contact);
}

static bool any_force_bends(const struct general *g)
{
    bool any = false;
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        any = any || general_force_bends(g, j);
    }
    return any;
}

/* Notes the time since each touch under Hertz's law. A contact that began with an overlap touched earlier, at
 * its present speed; one that opens is long past its touch. */
static void note_touches(struct general *g)
{
    struct scene_instant at;
    const bool any = any_force_bends(g);
    if (any) {
        ode_instant(&g->ode, g->step.start, g->step.y, &at);
    }
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        g->since_touch[j] = (double)INFINITY;
        if (any && general_force_bends(g, j) && at.geometry[j].gap_rate < 0.0) {
            const double since = g->step.start - g->state->contact[j].record.touch_clock;
            const struct contact_geometry *now = &at.geometry[j];
            g->since_touch[j] = fmax(since, fmax(-now->gap, 0.0) / -now->gap_rate);
        }
    }
}

void general_begin(struct general *g, double clock, const double *y)
{
    radau_step_begin(&g->step, clock, y);
    note_touches(g);
    g->fastest_decay = fastest_decay_of(&g->step, g->step.slopes);
    note_errors(g);
    if (!(g->longest > 0.0)) {
        g->longest = general_length_of_springs(g);
    }
}

/* Solves the stages from the guess that goes on from the last step. */
static bool try_to_solve(struct general *g, const struct radau_stages *stages, double length)
{
    struct radau_step *p = &g->step;
    radau_step_guess_on(p, stages, length);
    general_set_weights(g);
    return node_forces_solve(g, general_newton_share(g),
                             p->problem.turns || radau_step_goes_on(p) ? NULL : general_set_weights);
}

bool general_is_stiff(const struct general *g)
{
    return general_rubs(g) && g->step.length * g->fastest_decay > LEAST_STIFF;
}

/* Rolling ends within a step if the fastest decay at its stages is less than this part of that at its start.
 * The slip then bends between the last nodes, and the Chebyshev coefficients decrease as if it did not. The
 * error at the end is then taken to be at least the error within. */
static const double END_OF_ROLLING = 0.3;

/* If no state decays by this number of powers of e within the step, no motion dies away before the first
 * stage. The defect of the polynomial at the start is then that of an oscillation, and the error at the end
 * contains its effect. */
static const double LEAST_DECAY = 1.0;

double general_finish_step(struct general *g)
{
    struct radau_step *p = &g->step;
    g->is_sampled = false;
    radau_step_finish(p);
    const struct radau_error error = radau_step_error(p);
    g->error_within = error.within;
    g->error_is_noise = p->problem.turns && !(error.at_end < NOISE_OF_DECREASE * error.within);
    g->error_at_end = fmax(error.at_end, g->within_share * error.within);
    g->error_of_start = g->error_of_rolling = 0.0;
    if (general_rubs(g) && g->error_at_end <= 1.0) { /* radau_step_start_error also sets end_slopes */
        const double of_start = g->within_share * radau_step_start_error(p);
        g->error_of_start = p->length * g->fastest_decay > LEAST_DECAY ? of_start : 0.0;
        const bool ends = fastest_decay_of(p, p->end_slopes) < END_OF_ROLLING * g->fastest_decay;
        g->error_of_rolling = ends ? error.within : 0.0;
    }
    return fmax(fmax(g->error_at_end, g->error_of_rolling), g->error_of_start);
}

/* Returns the factor of the next length. With s stages the error at the end goes as length to the power
 * 2 s - 1, and the error within as length to the power s. */
static double factor_of(const struct general *g, double error, const struct radau_stages *stages)
{
    if (!(error < (double)INFINITY)) {
        return general_rubs(g) ? SOLVABLE_PART : 0.4;
    }
    const double start = SAFETY * pow(fmax(g->error_of_start, 1e-100), -START_POWER);
    const double longest = fmin(fmax(start, START_SHRINKAGE), GROWTH);
    const double power = 1.0 / (2.0 * stages->stages - 1.0);
    const double at_end = g->error_at_end;
    const double of_rolling = SAFETY * pow(fmax(g->error_of_rolling, 1e-100), -1.0 / stages->stages);
    if (g->error_is_noise && (at_end < NOISE_OF_ERROR || at_end > 1.0)) {
        return fmin(at_end > 1.0 ? SHRINKAGE : of_rolling, longest);
    }
    const double factor = fmin(SAFETY * pow(fmax(at_end, 1e-100), -power), of_rolling);
    return fmin(fmax(factor, SHRINKAGE), longest);
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

/* A step is made again if it is longer than this number of times that it leaves before the release. The
 * number exceeds BENDS_APART, because the clock of the release becomes better known in each trial. */
static const double MUCH_TOO_NEAR = 2.0 * BENDS_APART;

/* A touch or a release that is nearer to the start of a step than this part of its length does not matter:
 * the impulse in between is the power 5/2 of this part, 3e-13, of that in the step. */
static const double NO_IMPULSE = 1e-5;

/* The clock of a release is known well enough if the last two estimates differ by less than this part of the
 * time that the step to the release leaves before it. */
static const double RELEASE_KNOWN = 0.1;

/* The last step before a release is longer than the time to it by this factor, so that the release is found
 * within it. */
static const double BEYOND_RELEASE = 1.02;

/* A step is tried for at most so many other clocks of the release. After that the error alone decides whether
 * the step is accepted, so that the search ends. */
enum { RELEASE_TRIES = 16 };

/* Returns the time after the start of the step below which a time is rounding of the clock [s]. */
static double clock_rounding(const struct general *g)
{
    return 64.0 * DBL_EPSILON * fabs(g->step.start);
}

/* Returns the number of steps to a release that are made one after the other. Hertz's force leaves the power
 * 5/2 of RADAU_REST, 3e-8, of its impulse for the last piece. A tangential force whose stiffness follows the
 * depth goes with the root of the time to the release, and one step would leave the power 3/2. */
static int release_steps(const struct general *g)
{
    int steps = 1;
    for (int j = 0; SCENE_ANY_MINDLIN && j < SCENE_CONTACTS; ++j) {
        steps = contact_transmits(g->state, j) && scene_stiffens(g->ode.values, j) ? 2 : steps;
    }
    return steps;
}

/* Whether the step begins where the steps to the release have ended, so that only the last piece is left. */
static bool is_at_release(const struct general *g)
{
    return g->steps_to_release > 0 && g->steps_to_release >= release_steps(g) &&
           g->release_clock - g->step.start <= 2.0 * g->release_rest;
}

static void forget_release(struct general *g)
{
    g->release_clock = (double)INFINITY;
    g->release_rest = 0.0;
    g->steps_to_release = 0;
}

/* Whether the step begins at a touch. A touch shortly before limits its length. */
static bool is_at_touch(const struct general *g, double *length)
{
    bool found = false;
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        if (g->since_touch[j] <= fmax(NO_IMPULSE * *length, clock_rounding(g))) {
            found = true;
        } else {
            *length = fmin(*length, BENDS_APART * g->since_touch[j]);
        }
    }
    return found;
}

/* Returns the next attempt at a step, with its length and its method. The step lasts `limit` [s] at most. */
static struct attempt plan_attempt(const struct general *g, double limit)
{
    struct attempt next = {.length = fmin(limit, g->longest), .error = (double)INFINITY};
    const double ahead = g->release_clock - g->step.start;
    const bool at_touch = is_at_touch(g, &next.length);
    if (at_touch) {
        next.length = fmin(next.length, 0.5 * ahead);
        next.stages = &radau_stages_touch;
        return next;
    }
    if (is_at_release(g)) {
        next.length = fmin(next.length, BEYOND_RELEASE * ahead);
    } else if (ahead < (double)INFINITY) {
        if (next.length >= ahead / (1.0 + RADAU_REST)) {
            next.length = ahead / (1.0 + RADAU_REST);
            next.stages = &radau_stages_release;
            return next;
        }
        next.length = fmin(next.length, BENDS_APART / (1.0 + BENDS_APART) * ahead);
    }
    next.stages =
        next.length <= REACH_OF_FOUR * g->longest ? &radau_stages_4 : stages_of_long_step(g, next.length);
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
    wanted.length = fmin(wanted.length, reach_of(wanted.stages) * g->longest);
    return wanted;
}

/* Returns the clock of the first release after the end of the step, by the gaps and gap rates at the end. It
 * is accurate where the step ends close to the release. INFINITY: no contact opens at the end. */
static double release_after(struct general *g)
{
    struct scene_instant at;
    const double end = g->step.start + g->step.length;
    double least = (double)INFINITY;
    memcpy(g->y, g->step.y, (size_t)g->size * sizeof *g->y);
    radau_step_stage(&g->step, g->step.stages->stages - 1, g->y);
    ode_instant(&g->ode, end, g->y, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_geometry *now = &at.geometry[j];
        if (general_force_bends(g, j) && now->gap < 0.0 && now->gap_rate > 0.0) {
            least = fmin(least, end - now->gap / now->gap_rate);
        }
    }
    return least;
}

/* Whether a solved attempt shows a release under Hertz's law that the attempt was not made for. The release
 * lies within the step, or so soon after its end that the step is too long. */
static bool finds_release(struct general *g, double (*release_within)(struct general *g))
{
    const double known = g->release_clock;
    const double end = g->step.start + g->step.length;
    if (!any_force_bends(g) || is_at_release(g)) {
        return false;
    }
    const double found = fmin(release_within(g), release_after(g));
    if (found - g->step.start <= fmax(NO_IMPULSE * g->step.length, clock_rounding(g))) {
        forget_release(g);
        return false;
    }
    const bool is_near = MUCH_TOO_NEAR * (found - end) < g->step.length;
    if (g->step.stages->pace == RADAU_TO_RELEASE) {
        g->release_rest = is_near ? RADAU_REST * g->step.length : 0.0;
        g->release_clock = found;
        return is_near && fabs(found - known) > RELEASE_KNOWN * g->release_rest;
    }
    g->release_clock = is_near ? found : known;
    return is_near;
}

/* Shortens g->longest after the attempt `now` has been rejected. */
static void shorten(struct general *g, const struct attempt *now)
{
    const double factor = factor_of(g, now->error, now->stages);
    g->longest = fmin(now->length / reach_of(now->stages) * factor, 0.9 * g->longest);
}

/* Behind a touch an accurate step is longer than one from the touch by this factor. */
static const double AFTER_TOUCH = 2.0;

/* Returns the factor of the next length if the ratio of the length to the accurate length goes on as from the
 * last step to this one (the predictive controller of Gustafsson, 1994). Where bodies rub, steps towards a
 * singularity, such as the end of a slip, become shorter by the same ratio again and again. INFINITY: the
 * steps do not become shorter, and the ratio of their errors may be that of rounding. */
static double factor_of_trend(const struct general *g, const struct attempt *now)
{
    if (!general_rubs(g) || !(now->length < g->last_length)) {
        return (double)INFINITY;
    }
    const double worse = now->error * now->error / g->last_error;
    const double factor = SAFETY * now->length / g->last_length;
    return fmax(factor * pow(worse, -1.0 / (2.0 * now->stages->stages - 1.0)), SHRINKAGE);
}

/* Sets g->longest for the next step after the attempt `now` has been accepted. A step that an event, the end
 * of the motion, a touch or a release has shortened says little about the longest step. */
static void lengthen(struct general *g, const struct attempt *now)
{
    const double paced = now->stages->pace == RADAU_FROM_TOUCH ? AFTER_TOUCH : 1.0;
    const double of_error = factor_of(g, now->error, now->stages);
    const bool is_shortened = now->length < g->longest && (any_force_bends(g) || !(of_error < GROWTH));
    const double factor = is_shortened ? of_error : fmin(of_error, factor_of_trend(g, now));
    const double next = now->length / reach_of(now->stages) * paced * factor;
    g->last_length = now->length;
    g->last_error = fmax(now->error, 1e-100);
    if (is_shortened) {
        g->longest = fmax(next, g->longest);
    } else {
        g->longest = fmin(next, GROWTH * fmax(g->longest, now->length));
        if (general_rubs(g)) {
            g->longest = fmin(g->longest, growth_by_iterations(g->step.iterations) * now->length);
        }
    }
    g->longest = fmin(g->longest, fmax(g->solvable, now->length));
    g->solvable *= g->step.iterations <= EASY_ITERATIONS ? EASY_GROWTH : SOLVABLE_GROWTH;
}

bool general_step_make(struct general *g, double limit, double left, long *budget,
                       double (*release_within)(struct general *g))
{
    if (SCENE_ANY_HERTZ && !(g->release_clock - g->step.start > clock_rounding(g))) {
        forget_release(g);
    }
    for (int tries = 0;; ++tries) {
        if (*budget <= 0) {
            return false;
        }
        struct attempt now = fit_attempt(g, plan_attempt(g, limit));
        g->within_share = now.length > left       ? g->read_share
                          : g->step.problem.turns ? fmin(0.1 * g->read_share, WITHIN_SHARE)
                                                  : WITHIN_SHARE;
        const bool solved = try_to_solve(g, now.stages, now.length);
        if (solved) {
            now.error = general_finish_step(g);
            if (SCENE_ANY_HERTZ && tries < RELEASE_TRIES && finds_release(g, release_within)) {
                g->rejected += 1;
                continue; /* g->longest stays: steps behind the release may be as long as this attempt */
            }
        }
        if (now.error <= 1.0) {
            g->steps_to_release += now.stages->pace == RADAU_TO_RELEASE && g->release_rest > 0.0 ? 1 : 0;
            lengthen(g, &now);
            *budget -= 1;
            return true;
        }
        if (general_rubs(g) && !(now.error < (double)INFINITY)) {
            g->solvable = SOLVABLE_PART * now.length;
        }
        g->rejected += 1;
        shorten(g, &now);
        if (!(g->step.start + g->longest > g->step.start) || g->longest < 1e-18 * limit) {
            snprintf(g->message, INTEGRATOR_MESSAGE_SIZE,
                     "no step of the general segment is accurate enough from here on");
            return false;
        }
    }
}
