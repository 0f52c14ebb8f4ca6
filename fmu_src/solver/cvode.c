#include "solver/cvode.h"

#if SCENE_ANY_FREE

#include <cvode/cvode.h>
#include <float.h>

#include "dynamics/energy.h"
#include "dynamics/flight.h"
#include "dynamics/projection.h"
#include "dynamics/resolution.h"
#include "solver/cvode_memory.h"

/* In contact the direction may turn by at most this angle [rad] in one internal step: parting and touching again within a
 * step would need it to turn by more. Near the centre, where it turns fast, parting is as far away as the bodies are pressed in. */
static const double LARGEST_TURN = 0.1;

/* The time in which the direction of a contact turns that far, or in which bodies move by that part of the depth, or of the source's
 * radius where they approach unforeseen [s]. Speeds up to sqrt(w^2 + 4 a d) are reached within a turn around a body. */
static double largest_step_of(const struct scene_values *v, const struct motion *q,
                              const struct system_instant *at, int contact)
{
    const int source = contact_source(contact);
    const double distance = at->geometry[contact].distance;
    const struct vec3 pull = vec3_sub(path_at(q->path[source].force, 3, q->clock),
                                      path_at(q->path[contact_destination(contact)].force, 3, q->clock));
    const double a = vec3_norm(gravity(v)) + vec3_norm(pull) / body_mass(v, source);
    const double speed = sqrt(vec3_dot(at->rate[contact], at->rate[contact]) + 4.0 * a * distance);
    const double length =
        contact_transmits(q, contact) ? fmax(distance, -at->geometry[contact].gap) : body_radius(v, source);
    return LARGEST_TURN * length / speed;
}

/* Bound on the internal step [s]; 0: none. */
static double largest_step(const struct scene_values *v, const struct motion *q,
                           const struct system_instant *at)
{
    double bound = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j) || contact_is_coupled(v, q, j)) {
            const double step = largest_step_of(v, q, at, j);
            bound = step > 0.0 && isfinite(step) && (bound == 0.0 || step < bound) ? step : bound;
        }
    }
    return bound;
}

/* What the lightest free body would have of momentum with that energy: sqrt(2 m E) [N s]. */
static double momentum_scale(const struct scene_values *v, double energy)
{
    double lightest = (double)INFINITY;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        lightest = body_is_free(v, i) ? fmin(lightest, body_mass(v, i)) : lightest;
    }
    return sqrt(2.0 * lightest * energy);
}

/* What the local error of one internal step may take of the tolerance: the errors of some hundred steps of a contact add
 * up, BDF's all with the sign of its damping. Chosen so that at 1e-10 the energy balance after the 63 impacts of a ball in
 * a cylinder (scripts/scenarios/p3b_bouncing_in_cylinder.toml) closes to better than 1e-9 of its largest term. */
static double tolerance_share(enum solver_method method)
{
    return method == SOLVER_METHOD_CVODE_ADAMS ? 0.02 : 0.005;
}

/* See resolution_armour. Twice the gap's resolution: the start itself may be off by one. */
static void arm_roots(struct cvode_problem *p, const struct system_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double tolerated = p->relative * vec3_norm(at->rate[j]) + p->absolute;
        p->gap_armour[j] = 2.0 * resolution_of_gap(p->values, at, j);
        p->margin_armour[j] = resolution_armour(p->values, p->motion, at, j, tolerated);
    }
}

/* Relative acceleration by all but the contact itself. */
static struct vec3 pull_of_others(const struct scene_values *v, const struct system_instant *at, int contact)
{
    const struct vec3 all =
        vec3_sub(at->acceleration[contact_destination(contact)], at->acceleration[contact_source(contact)]);
    return vec3_axpy(all, system_inverse_mass(v, contact), at->source_force[contact]);
}

/* From where the centres meet, d = 0, n is where the motion leads. At rest it is where other contacts push: the contact's own force
 * follows c, so that no other direction lasts. */
static void leave_centres(const struct scene_values *v, struct motion *q)
{
    struct system_instant at;
    system_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (at.geometry[j].degenerate) {
            const struct contact_shape shape = system_shape(v, q, j);
            struct vec3 n = q->contact[j].normal;
            n = contact_is_coupled(v, q, j) ? contact_way_out(&shape, pull_of_others(v, &at, j), n) : n;
            q->contact[j].normal = contact_way_out(&shape, at.rate[j], n);
        }
    }
}

/* Starts CVODE from the motion, whose clock has just been set to zero. */
static bool restart(struct cvode *c, const struct scene_values *v, struct motion *q)
{
    struct system_instant at;
    leave_centres(v, q);
    system_now(v, q, &at);
    c->problem.relative = tolerance_share(c->method) * solver_relative_tolerance(v);
    c->problem.absolute = tolerance_share(c->method) * solver_absolute_tolerance(v);
    c->problem.energy_scale = energy_kinetic_of(v, &at) + energy_stored(v, q, &at);
    c->problem.momentum_scale = momentum_scale(v, c->problem.energy_scale);
    arm_roots(&c->problem, &at);
    cvode_pack(&c->problem, c->y);
    c->steps = c->evaluations = c->rejected = 0;
    q->integrator_fresh = 0;
    c->longest_step = largest_step(v, q, &at);
    return CVodeReInit(c->memory, q->clock, c->y) == CV_SUCCESS &&
           CVodeSetMaxStep(c->memory, c->longest_step) == CV_SUCCESS;
}

/* CVODE takes the length of its first step from how far it is asked to go; where that is beyond all proportion to the
 * contact it is asked to go there in legs. */
static double end_of_leg(const struct cvode *c, double clock, double clock_end)
{
    const double leg = 1e4 * c->longest_step;
    return leg > 0.0 ? fmin(clock_end, clock + leg) : clock_end;
}

static void book_counters(struct cvode *c, struct motion *q, struct advance *step)
{
    long steps = 0, evaluations = 0, failures = 0, convergence_failures = 0;
    CVodeGetNumSteps(c->memory, &steps);
    CVodeGetNumRhsEvals(c->memory, &evaluations);
    CVodeGetNumErrTestFails(c->memory, &failures);
    CVodeGetNumNonlinSolvConvFails(c->memory, &convergence_failures);
    failures += convergence_failures;
    step->budget -= steps - c->steps;
    counter_add(&q->counters.steps, steps - c->steps);
    counter_add(&q->counters.force_evaluations, evaluations - c->evaluations);
    counter_add(&q->counters.rejected_steps, failures - c->rejected);
    c->steps = steps;
    c->evaluations = evaluations;
    c->rejected = failures;
}

/* CVODE places a root within 100 roundings of its time and step; four times that is beyond doubt in the new regime. */
static double settled_clock(struct cvode *c, double clock)
{
    double step = 0.0;
    CVodeGetLastStep(c->memory, &step);
    return clock + 400.0 * DBL_EPSILON * (clock + step);
}

/* The regime behind root 0: apart where there was contact, and the other way round. */
static enum contact_regime regime_beyond(const struct scene_values *v, const struct motion *q, int contact)
{
    if (q->contact[contact].regime != REGIME_APART) {
        return REGIME_APART;
    }
    struct system_instant at;
    system_now(v, q, &at);
    const struct contact_law law = system_law(v, q, contact);
    const double gap = fmin(at.geometry[contact].gap, -DBL_MIN);
    return contact_regime_of(&law, gap, at.geometry[contact].gap_rate, true);
}

/* Which contact leaves its regime at the root just found; false when the root is only a peak. */
static bool root_event(struct cvode *c, const struct scene_values *v, const struct motion *q,
                       struct advance *step)
{
    int found[CVODE_ROOTS];
    CVodeGetRootInfo(c->memory, found);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int *roots = found + CVODE_ROOTS_EACH * j;
        step->contact = j;
        if (roots[0]) {
            step->regime = regime_beyond(v, q, j);
            return true;
        }
        if (roots[1]) {
            const struct contact_law law = system_law(v, q, j);
            step->regime = contact_regime_after(&law, (enum contact_regime)q->contact[j].regime);
            return true;
        }
    }
    return false;
}

/* What the integrator's error left at an event is put right where that can be done exactly. */
static void tidy_event(struct cvode *c, const struct scene_values *v, struct motion *q,
                       const struct advance *step)
{
    struct system_instant at;
    system_now(v, q, &at);
    const bool at_gap = fabs(at.geometry[step->contact].gap) <= 4.0 * c->problem.gap_armour[step->contact];
    if (step->regime == REGIME_APART && at_gap) {
        projection_close_gap(v, q, step->contact);
    }
    projection_restore_energy(v, q, step->contact);
    q->contact[step->contact].settled_clock = settled_clock(c, q->clock);
}

enum advance_result cvode_advance(struct cvode *c, const struct scene_values *v, struct motion *q,
                                  struct advance *step)
{
    /* CVODE must not look beyond the next closed-form change, nor beyond where one has been looked for. */
    double stop = q->horizon_clock;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        stop = fmin(stop, q->contact[j].change_clock);
    }
    c->problem.values = v;
    c->problem.motion = q;
    if (q->integrator_fresh && !restart(c, v, q)) {
        return ADVANCE_FAILED;
    }
    CVodeSetStopTime(c->memory, stop);
    for (;;) {
        double clock = q->clock;
        CVodeSetMaxNumSteps(c->memory, step->budget);
        const int flag = CVode(c->memory, end_of_leg(c, clock, step->clock_end), c->y, &clock, CV_NORMAL);
        book_counters(c, q, step);
        if (flag == CV_TOO_CLOSE) { /* a last digit of the clock: nothing moves */
            q->clock = step->clock_end;
            return ADVANCE_REACHED;
        }
        if (flag < 0 && flag != CV_TOO_MUCH_WORK) {
            return ADVANCE_FAILED;
        }
        cvode_unpack(v, q, c->y);
        q->clock = clock;
        if (flag == CV_TOO_MUCH_WORK) {
            return ADVANCE_STEP_LIMIT;
        }
        flight_restore(v, q);
        if (flag == CV_ROOT_RETURN && root_event(c, v, q, step)) {
            tidy_event(c, v, q, step);
            return ADVANCE_EVENT;
        }
        if (flag == CV_TSTOP_RETURN || q->clock >= step->clock_end) {
            return ADVANCE_REACHED;
        }
        struct system_instant at;
        system_now(v, q, &at);
        event_note_peaks(q, &at);
        /* A return costs a step of the budget, so that roots that are no events come to an end. */
        if (--step->budget <= 0) {
            return ADVANCE_STEP_LIMIT;
        }
    }
}

#endif
