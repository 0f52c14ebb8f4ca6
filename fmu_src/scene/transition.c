#include <float.h>

#include "scene/evaluate.h"
#include "scene/ode.h"
#include "scene/transition.h"

/* Rounding bounds by which a margin is raised. The margin may be wrong by one bound on either side of a
 * change, so that two bounds are needed; four leave room. */
static const double MARGIN_ROUNDINGS = 4.0;

static double touch_event(const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(at->q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    double rounding = rounding_of_gap(at, contact);
    if (SCENE_ANY_ENDS && isfinite(shape.half_length)) {
        rounding = fmax(rounding, rounding_of_axial(at, contact, &shape));
    }
    const double margin = fmax(g->gap, scene_beyond_ends(&shape, g));
    const bool apart = at->q->contact[contact].regime == (int32_t)REGIME_APART;
    return (apart ? margin : -margin) + MARGIN_ROUNDINGS * rounding;
}

static double law_event(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    if (regime == REGIME_APART || !contact_has_events(&law)) {
        return (double)INFINITY;
    }
    const struct contact_geometry *g = &at->geometry[contact];
    const double tolerated =
        solver_relative_tolerance(at->v) * vec3_norm(at->rate[contact]) + solver_absolute_tolerance(at->v);
    const double rounding = rounding_of_event(at, contact, tolerated);
    const double event = contact_event(&law, regime, g->gap, g->gap_rate) + MARGIN_ROUNDINGS * rounding;
    /* with an approach-only dashpot the event function is a gap rate; 1 of Hertz's law counts as 1 N */
    return law.dashpot == DASHPOT_APPROACH_ONLY ? law.damping * event : event;
}

/* Returns the error of an opposed motion that the solver's tolerances allow [m/s, rad/s]. */
static double tolerated_motion(const struct scene_instant *at, int contact, int part)
{
    const double size =
        part == OPPOSED_SLIP ? vec3_norm(at->turning.slip[contact]) : turning_spin_size(at, contact);
    return solver_relative_tolerance(at->v) * size + solver_absolute_tolerance(at->v);
}

/* Returns the value of an event function of scene/ode.h. The value is positive within the present regimes,
 * and INFINITY where the contact has no such event. The function raises the value by its rounding error and
 * by the errors that the tolerance allows in speeds: it falls below zero only beyond doubt. */
static double raised_event(const struct scene_instant *at, int contact, enum ode_event event)
{
    double offset[ODE_EVENTS_EACH];
    double events[ODE_EVENTS_EACH];
    if (event == ODE_EVENT_GAP) {
        return touch_event(at, contact);
    }
    if (event == ODE_EVENT_LAW) {
        return law_event(at, contact);
    }
    if ((int)event == (int)ODE_EVENT_ZONE) {
        return zones_margin(at, contact) + MARGIN_ROUNDINGS * rounding_of_gap(at, contact);
    }
    if (!contact_rubs(at->v, contact) || !contact_transmits(at->q, contact)) {
        return (double)INFINITY;
    }
    turning_friction_events(at, contact, tolerated_motion(at, contact, OPPOSED_SLIP),
                            solver_relative_tolerance(at->v), solver_absolute_tolerance(at->v), offset,
                            events);
    return events[event];
}

double regime_margin(const struct scene_instant *at, int contact, enum ode_event event)
{
    const struct contact_state *state = &at->q->contact[contact];
    const int32_t friction = state->friction_regime[ode_event_part(event)];
    const bool is_beyond = event == ODE_EVENT_GAP              ? state->regime != (int32_t)REGIME_APART
                           : event == ODE_EVENT_LAW            ? state->regime != (int32_t)REGIME_COMPRESSION
                           : (int)event == (int)ODE_EVENT_ZONE ? false
                           : event == ODE_EVENT_CAP            ? friction == (int32_t)FRICTION_CAPPED
                           : event == ODE_EVENT_LIFT           ? friction == (int32_t)FRICTION_LIFTED
                                                               : friction != (int32_t)FRICTION_STICKING;
    const double raised = raised_event(at, contact, event);
    return !(raised < (double)INFINITY) ? 1.0 : is_beyond ? -raised : raised;
}

int regime_event(const struct scene_instant *at, int contact)
{
    for (int event = 0; event < ODE_EVENTS_EACH; ++event) {
        const double raised = raised_event(at, contact, (enum ode_event)event);
        const bool is_friction = event > ODE_EVENT_LAW && event != ODE_EVENT_ZONE;
        /* at zero force friction has just begun */
        if (raised < 0.0 || (raised == 0.0 && !(is_friction && at->normal_force[contact] <= 0.0))) {
            return event;
        }
    }
    return -1;
}

/* An opposed motion of a contact (contact/friction.h), whose regime and spring change with events. */
struct rubbed {
    struct scene_state *q;
    int contact, part;
    struct friction_law law;
    int32_t *regime; /* enum friction_regime */
    struct vec3 *spring;
};

static struct rubbed rubbed_of(struct scene_state *q, int contact, int part)
{
    return (struct rubbed){q,
                           contact,
                           part,
                           scene_friction_law(q, contact, part),
                           &q->contact[contact].friction_regime[part],
                           &q->turning.spring[contact][part]};
}

/* Whether the dashpot pulls. The sign of contact_push decides this, as it decides the lift event, so that
 * friction which is lifted has an event that ends its regime. A law whose factors are all zero lifts friction
 * too, until a factor changes: a spring of mere rounding would otherwise give sliding its direction. */
static bool is_lifted(const struct rubbed *r, const struct scene_instant *at)
{
    const struct contact_law law = scene_contact_law(r->q, r->contact);
    const struct contact_geometry *g = &at->geometry[r->contact];
    const bool pulls = contact_may_pull(&law) && contact_push(&law, g->gap, g->gap_rate) < 0.0;
    return pulls || contact_push(&law, -1.0, -1.0) == 0.0;
}

/* Ends friction and relaxes its spring. The energy of the spring counts as dissipated from now on
 * (energy.friction). */
static void end_friction(const struct rubbed *r)
{
    *r->regime = (int32_t)FRICTION_LIFTED;
    *r->spring = vec3_make(0.0, 0.0, 0.0);
}

/* Lifts friction while the dashpot pulls, or would pull if it were not clipped. A spring with a dashpot
 * relaxes through it, as where a contact slides with L = 0; another one is at rest at once. */
static void lift_friction(const struct rubbed *r)
{
    *r->regime = (int32_t)FRICTION_LIFTED;
    if (!(r->law.damping > 0.0)) {
        *r->spring = vec3_make(0.0, 0.0, 0.0);
    }
}

/*
 * Returns the larger of two depths [m]: where the normal spring has stored the energy of the approach, as at
 * the deepest point of an impact, and where it has stored half the work of the load, as in a ball set down.
 * The energy stored at a depth is proportional to its square under the linear law, and to its power 5/2 under
 * Hertz's law. The result is zero where neither body is free or nothing is stored.
 */
static double impact_depth(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const double per_mass = scene_inverse_mass(at->v, contact);
    const double at_one_metre = contact_stored_energy(&law, REGIME_COMPRESSION, -1.0);
    const double rate = at->geometry[contact].gap_rate;
    if (!(per_mass > 0.0) || !(at_one_metre > 0.0)) {
        return 0.0;
    }
    const double part = 0.5 * rate * rate / (per_mass * at_one_metre);
    const double load = scene_pressing_acceleration(at, contact) / (per_mass * at_one_metre);
    const double power = contact_is_hertz(&law) ? 2.5 : 2.0;
    return fmax(pow(part, 1.0 / power), pow(0.5 * load, 1.0 / (power - 1.0)));
}

/* Changes all opposed motions of a contact, since the normal force lifts them together. */
static void change_all(struct scene_state *q, int contact, void (*change)(const struct rubbed *))
{
    for (int i = 0; i < contact_opposed(q->v, contact); ++i) {
        const struct rubbed r = rubbed_of(q, contact, i);
        change(&r);
    }
}

/* Length of a friction spring as a fraction of the source's radius, and angle of another spring in radians,
 * where no force but that of rounding gives it. */
static const double TYPICAL_LENGTH = 1e-4;

/* Returns the spring of a contact that begins to slide along `along` without a dashpot. Only the direction of
 * this spring has a meaning. The length does not matter for the force; it is so large that errors of the
 * spring are small beside it. */
static struct vec3 direction_to_slide(const struct rubbed *r, const struct scene_instant *at,
                                      struct vec3 along)
{
    const struct friction_law *law = &r->law;
    const double size = vec3_norm(along);
    const double depth = fmax(-at->geometry[r->contact].gap, impact_depth(at, r->contact));
    const struct contact_law normal = scene_contact_law(r->q, r->contact);
    const double spring_force = -contact_stored_slope(&normal, REGIME_COMPRESSION, -depth);
    const double force = fmax(at->normal_force[r->contact], spring_force);
    const double length = fmin(law->coefficient * force, law->largest) / friction_stiffness(law, depth);
    const double unit = r->part == OPPOSED_SLIP ? contact_source_radius(r->q->v, r->contact) : 1.0;
    const bool is_known = length > 0.0 && depth > rounding_of_gap(at, r->contact);
    const double typical = is_known ? length : TYPICAL_LENGTH * unit;
    return size > 0.0 ? vec3_scale(typical / size, along) : along;
}

/* Returns F_n at an onset [N]. A force that rounding and the tolerance of speeds explain counts as zero; the
 * rates then decide which regime follows. */
static double onset_force(const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    const double by_rate = contact_force_slopes(&law, regime, g->gap, g->gap_rate).by_rate;
    const double error =
        rounding_of_force(at, contact) + fabs(by_rate) * tolerated_motion(at, contact, OPPOSED_SLIP);
    const double force = at->normal_force[contact];
    return force > MARGIN_ROUNDINGS * error ? force : 0.0;
}

/* Replaces the instant of a Hertzian contact that is at rest at its touch by one a moment later, when the
 * load has pressed the bodies together by the rounding of the gap. F_n and the spring's part of F* grow from
 * rest with powers of time that only the velocities of that moment tell. The places of free bodies stay as
 * they are. */
static void leave_rest(const struct rubbed *r, struct scene_instant *at)
{
    const struct scene_state *q = r->q;
    const double press = scene_pressing_acceleration(at, r->contact);
    const double speed = sqrt(2.0 * rounding_of_gap(at, r->contact) * press); /* [m/s] */
    if (!(fabs(at->geometry[r->contact].gap_rate) < speed)) {
        return;
    }
    const double moment = speed / press;
    const struct scene_instant rest = *at;
    scene_place_bodies(q, q->clock + moment, at);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        struct vec3 *omega = &at->turning.body[i].angular_velocity;
        if (body_is_free(q->v, i)) {
            const struct vec3 velocity = vec3_axpy(rest.velocity[i], moment, rest.acceleration[i]);
            scene_place_body((struct body_state){rest.moved[i], velocity}, i, at);
        }
        if (body_turns_freely(q->v, i)) {
            *omega = vec3_axpy(*omega, moment, turning_acceleration(&rest, i));
        }
    }
    scene_meet(NULL, at);
    scene_forces(NULL, at);
}

/* Begins friction with a spring at rest. */
static void begin_friction(const struct rubbed *r)
{
    struct scene_instant at;
    end_friction(r);
    scene_now(r->q, &at);
    const double force = onset_force(&at, r->contact);
    if (force == 0.0 && scene_is_hertz(r->q->v, r->contact)) {
        leave_rest(r, &at);
    }
    struct friction_state rubbing = turning_rubbing(&at, r->contact, r->part);
    rubbing.normal_force = force;
    const double size =
        r->part == OPPOSED_SLIP ? vec3_norm(at.rate[r->contact]) : turning_spin_size(&at, r->contact);
    if (r->law.damping == 0.0 && vec3_norm(rubbing.slip) <= 8.0 * DBL_EPSILON * size) {
        rubbing.slip = vec3_make(0.0, 0.0, 0.0); /* rounding gives sliding friction no direction */
    }
    const enum friction_regime next =
        friction_onset_regime(&r->law, rubbing, turning_normal_force_rate(&at, r->contact));
    *r->regime = (int32_t)next;
    if (r->law.kind == FRICTION_ELASTIC && r->law.damping == 0.0 && next != FRICTION_STICKING) {
        *r->spring = direction_to_slide(r, &at, rubbing.slip);
    }
}

/* Lets a contact slide that has slid up to now or, if it `breaks`, that has stuck. It sticks where the slip
 * no longer stretches the spring. Sliding ends so after a corner of the law, from where on the force falls
 * more slowly or rises, and after a prescribed velocity has jumped. A contact without a dashpot that breaks
 * away sticks again at once with mu_s > mu, where the spring jumps back, and where errors have put F* beyond
 * its limit although F* falls. */
static void slide(const struct rubbed *r, bool breaks)
{
    struct scene_instant at;
    const struct friction_law *law = &r->law;
    const bool turns = breaks && law->damping == 0.0; /* the spring turns into the direction of sliding */
    scene_now(r->q, &at);
    if (breaks && is_lifted(r, &at)) {
        change_all(r->q, r->contact, lift_friction);
        return;
    }
    /* where nothing pulls, a normal force that is not above zero is rounding or about to grow */
    const double force = at.normal_force[r->contact];
    const enum friction_regime next = force > 0.0 ? friction_sliding_regime(law, force) : FRICTION_SLIDING;
    *r->regime = (int32_t)next;
    scene_now(r->q, &at);
    const struct friction_state rubbing = turning_rubbing(&at, r->contact, r->part);
    /* the error of the motion does not explain a stick event below this */
    const bool is_exact = !breaks || law->static_coefficient > law->coefficient;
    const double least = is_exact ? 0.0 : -tolerated_motion(&at, r->contact, r->part);
    if ((turns || !breaks) &&
        friction_stick_event(law, next, rubbing, turning_normal_force_rate(&at, r->contact)) < least) {
        *r->spring = friction_spring(law, next, rubbing); /* this spring holds the friction force */
        *r->regime = (int32_t)FRICTION_STICKING;
    } else if (turns) {
        *r->spring = direction_to_slide(r, &at, rubbing.spring);
    }
}

/* Begins friction, or goes on with a spring that has not relaxed. */
static void end_lifting(const struct rubbed *r)
{
    if (vec3_max_abs(*r->spring) > 0.0) {
        slide(r, false);
    } else {
        begin_friction(r);
    }
}

/* Puts friction into the regime that the present normal force asks for. */
static void reconsider(const struct rubbed *r)
{
    struct scene_instant at;
    const enum friction_regime regime = (enum friction_regime) * r->regime;
    scene_now(r->q, &at);
    if (is_lifted(r, &at)) {
        lift_friction(r);
    } else if (regime == FRICTION_LIFTED) {
        end_lifting(r);
    } else if (regime == FRICTION_STICKING) {
        const struct friction_state rubbing = turning_rubbing(&at, r->contact, r->part);
        if (friction_stick_event(&r->law, regime, rubbing, 0.0) < 0.0 ||
            friction_cap_event(&r->law, regime, rubbing) < 0.0) {
            slide(r, true);
        }
    } else {
        slide(r, false);
    }
}

/* Sets friction after a contact has left the regime `before`. Where the force begins, friction begins with a
 * spring at rest, and sticks if sticking persists. Where the force ends, friction ends, and the energy in its
 * spring is dissipated. Else friction goes on in the regime that the new force asks for. */
static void take_regime_of_law(struct scene_state *q, int contact, enum contact_regime before)
{
    const enum contact_regime now = (enum contact_regime)q->contact[contact].regime;
    for (int i = 0; i < contact_opposed(q->v, contact); ++i) {
        const struct rubbed r = rubbed_of(q, contact, i);
        if (now == REGIME_APART || before == REGIME_APART) {
            end_friction(&r);
        }
        if (now == REGIME_SEPARATING) {
            lift_friction(&r);
        } else if (now != REGIME_APART) {
            reconsider(&r);
        }
    }
}

/* Puts the spring of a sliding motion at the length that carries the present friction force, and lets it
 * stick. */
static void stick(const struct rubbed *r, const struct scene_instant *at)
{
    *r->spring = friction_spring(&r->law, (enum friction_regime) * r->regime,
                                 turning_rubbing(at, r->contact, r->part));
    *r->regime = (int32_t)FRICTION_STICKING;
}

void turning_take_event(struct scene_state *q, int contact, enum ode_event event)
{
    const struct rubbed r = rubbed_of(q, contact, ode_event_part(event));
    const enum friction_regime regime = (enum friction_regime) * r.regime;
    const bool sticks = event == ode_stick_event(r.part);
    if (regime == FRICTION_STICKING && (sticks || event == ODE_EVENT_CAP)) {
        slide(&r, true);
    } else if (sticks) {
        struct scene_instant at;
        scene_now(q, &at);
        stick(&r, &at);
    } else if (event == ODE_EVENT_CAP) {
        *r.regime = (int32_t)(regime == FRICTION_CAPPED ? FRICTION_SLIDING : FRICTION_CAPPED);
    } else {
        change_all(q, contact, regime == FRICTION_LIFTED ? end_lifting : lift_friction);
    }
}

void transition_set_regime(struct scene_state *q, int contact, enum contact_regime regime)
{
    struct contact_state *state = &q->contact[contact];
    const enum contact_regime before = (enum contact_regime)state->regime;
    state->regime = (int32_t)regime;
    if (SCENE_ANY_FREE && before == REGIME_APART && regime != REGIME_APART) {
        counter_add(&state->record.onsets, 1);
        state->record.onset_time = scene_time(q);
        state->record.touch_clock = q->clock;
        state->physics.force_error = 0.0;
    } else if (SCENE_ANY_FREE && before != REGIME_APART && regime == REGIME_APART) {
        state->record.last_duration = q->clock - state->record.touch_clock;
    }
    if (contact_rubs(q->v, contact)) {
        take_regime_of_law(q, contact, before);
    }
}

/* Returns the gap at a change of regime [m]. Where contact ends by the gap, the gap is at least zero.
 * Where an integrator has found a touch, the gap is zero; a foreseen touch has the gap of its prediction.
 * A gap that differs from zero or from the predicted one by more than rounding stays as it is. Where contact
 * ends, this rounding is at least 64 roundings of the distance that the bodies have covered relative to each
 * other in the phase, which has `lasted` so many seconds. Earlier phases of the contact count by the
 * penetration. */
static double gap_at_change(const struct scene_instant *at, int contact, enum contact_regime regime,
                            double lasted)
{
    const double gap = at->geometry[contact].gap;
    const struct contact_state *state = &at->q->contact[contact];
    const bool ends = regime == REGIME_APART;
    const bool is_found = state->regime == (int32_t)REGIME_APART && !scene_gap_is_accumulated(at, contact);
    const double meant = is_found ? 0.0 : ends ? fmax(gap, 0.0) : gap;
    if (meant == gap) {
        return meant;
    }
    const double way = vec3_norm(at->rate[contact]) * lasted + state->peaks.penetration;
    const double rounding = fmax(rounding_of_gap(at, contact), ends ? 64.0 * DBL_EPSILON * way : 0.0);
    return fabs(gap) > rounding ? gap : meant;
}

/* Begins a phase of motion: forgets foreseen changes and notes the energy to be kept. */
static void begin_phase(struct scene_state *q, const struct scene_instant *at)
{
    q->horizon_clock = -(double)INFINITY;
    q->phase_energy = scene_uses_ode(at->v) ? projection_balance(at) : 0.0;
}

/* Raises the peaks of the communication step to the values of the instant, and notes the normals, which serve
 * later where the distance d is zero. */
CONTACT_FLATTEN static void note_instant(struct scene_state *q, const struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct contact_state *state = &q->contact[j];
        if (state->regime != REGIME_APART) {
            contact_peaks_note(&state->peaks, scene_outward_force(at, j), -at->geometry[j].gap);
        }
        if (SCENE_ANY_FREE) {
            state->physics.normal = at->geometry[j].normal;
        }
    }
}

/* Passes into the contact's next zone and returns the regime there. The known gap is kept unless n jumps. If
 * it does, the gap rate jumps too: positions give the gap, the law gives the regime for the new rate, and the
 * spring of elastic friction begins at rest on the new face. */
static enum contact_regime pass_zone(struct scene_state *q, struct scene_instant *at, int contact)
{
    struct contact_state *state = &q->contact[contact];
    const bool jumps = zones_pass(q, at, contact);
    state->physics.accumulated_gap = jumps ? DBL_MAX : state->physics.accumulated_gap;
    if (SCENE_ANY_ZONES) {
        scene_kinematics_now(q, at);
    }
    if (SCENE_ANY_FRICTION && jumps && contact_rubs(q->v, contact)) {
        change_all(q, contact, end_friction);
    }
    return jumps ? scene_regime(at, contact, true) : (enum contact_regime)state->regime;
}

/* Whether an opposed motion slides with a spring of which the state holds only the direction. */
static bool slides_without_dashpot(const struct rubbed *r)
{
    const enum friction_regime regime = (enum friction_regime) * r->regime;
    return contact_has_spring(r->q->v, r->contact, r->part) && contact_transmits(r->q, r->contact) &&
           !friction_compares_forces(&r->law, regime) && friction_has_spring(&r->law, regime);
}

void transition_stop_sliding(struct scene_state *q, const struct scene_instant *at, bool *stopped)
{
    for (int k = 0; SCENE_ANY_SPRINGS && k < SCENE_CONTACTS * OPPOSED; ++k) {
        const struct rubbed r = rubbed_of(q, k / OPPOSED, k % OPPOSED);
        stopped[k] = slides_without_dashpot(&r) && at->normal_force[r.contact] > 0.0;
        if (stopped[k]) {
            stick(&r, at);
        }
    }
}

/* A limit of friction that differs by no more than this fraction has not grown: the normal force has changed
 * by rounding. */
static const double SAME_LIMIT = 64.0 * DBL_EPSILON;

/* Lets an opposed motion that transition_stop_sliding has stopped slide on, unless its limit of friction has
 * grown. */
static void slide_on(const struct rubbed *r)
{
    struct scene_instant at;
    scene_now(r->q, &at);
    const struct friction_state rubbing = turning_rubbing(&at, r->contact, r->part);
    const double force = friction_stiffness(&r->law, rubbing.depth) * vec3_norm(rubbing.spring);
    const double limit =
        friction_limit(&r->law, friction_sliding_regime(&r->law, rubbing.normal_force), rubbing.normal_force);
    if (!(force < (1.0 - SAME_LIMIT) * limit)) {
        slide(r, true);
    }
}

void transition_hold_springs(struct scene_state *q, const bool *stopped)
{
    for (int k = 0; SCENE_ANY_SPRINGS && k < SCENE_CONTACTS * OPPOSED; ++k) {
        const struct rubbed r = rubbed_of(q, k / OPPOSED, k % OPPOSED);
        if (stopped && stopped[k] && *r.regime == (int32_t)FRICTION_STICKING) {
            slide_on(&r);
        }
        if (slides_without_dashpot(&r)) {
            struct scene_instant at;
            scene_now(q, &at);
            const struct friction_state rubbing = turning_rubbing(&at, r.contact, r.part);
            const double rate = turning_normal_force_rate(&at, r.contact);
            if (friction_stick_event(&r.law, (enum friction_regime) * r.regime, rubbing, rate) <
                -tolerated_motion(&at, r.contact, r.part)) {
                stick(&r, &at);
            }
        }
    }
}

/* Puts a contact into a new regime, or into its next zone, at the instant `at` of scene_kinematics_now. The
 * phase before has `lasted` so many seconds. */
static void change_regime(struct scene_state *q, int contact, enum contact_regime regime, double lasted,
                          struct scene_instant *at)
{
    if (q->contact[contact].regime == (int32_t)REGIME_APART) {
        q->last_flight = lasted;
    }
    note_instant(q, at);
    const double before = energy_stored(at);
    at->geometry[contact].gap = gap_at_change(at, contact, regime, lasted);
    q->contact[contact].physics.accumulated_gap = at->geometry[contact].gap;
    if (regime == (enum contact_regime)q->contact[contact].regime) {
        regime = pass_zone(q, at, contact);
    }
    transition_set_regime(q, contact, onset_note(q, at, contact, regime));
    zones_follow(q, at, contact);
    if (SCENE_CONTACTS > 1) {
        transition_hold_springs(q, NULL);
    }
    q->dissipated += before - energy_stored(at); /* what the stored energy loses by the change */
}

void transition_take_event(struct scene_state *q, int contact, int event, enum contact_regime regime,
                           struct scene_instant *at)
{
    const double lasted = q->clock;
    const bool is_friction = SCENE_ANY_FRICTION && event > ODE_EVENT_LAW && event != ODE_EVENT_ZONE;
    scene_rebase(q);
    if (is_friction) {
        turning_take_event(q, contact, (enum ode_event)event);
        if (SCENE_CONTACTS > 1) {
            transition_hold_springs(q, NULL);
        }
    }
    scene_kinematics_now(q, at);
    if (!is_friction) {
        change_regime(q, contact, regime, lasted, at);
    }
    counter_add(&q->counters.events, 1);
    begin_phase(q, at);
    note_instant(q, at);
}

void transition_settle_regimes(struct scene_state *q, double stored_before, bool starting)
{
    struct scene_instant at;
    scene_now(q, &at);
    for (int j = 0; SCENE_ANY_ZONES && j < SCENE_CONTACTS; ++j) {
        if (zones_margin(&at, j) < -rounding_of_gap(&at, j)) { /* the source faces another zone */
            (void)zones_pass(q, &at, j);
            scene_now(q, &at);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (starting || fabs(at.geometry[j].gap) > rounding_of_gap(&at, j)) {
            transition_set_regime(q, j, onset_note(q, &at, j, scene_regime(&at, j, false)));
            zones_follow(q, &at, j);
        }
    }
    if (!starting) {
        q->external_work += energy_stored(&at) - stored_before;
    }
    q->last_flight = 0.0;
    scene_rebase(q);
    begin_phase(q, &at);
}

void transition_take_law(struct scene_state *q, const bool *changed, double stored_before,
                         const bool *stopped)
{
    struct scene_instant at;
    scene_now(q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (changed[j] && q->contact[j].regime != REGIME_APART) {
            transition_set_regime(q, j, scene_regime(&at, j, true));
        }
    }
    transition_hold_springs(q, stopped);
    q->external_work += energy_stored(&at) - stored_before;
    begin_phase(q, &at);
}

void transition_mark_step(struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].record.impulse_mark = q->contact[j].physics.impulse;
        q->contact[j].record.force_bound = 0.0;
        q->contact[j].peaks = (struct contact_peaks){0.0, 0.0};
    }
}

/* Notes the present instant, and returns whether `at` is set. Bodies in flight need no forces for that. Where
 * bodies fly outside each other, n is defined everywhere and nothing is noted. */
static bool note_now(struct scene_state *q, struct scene_instant *at)
{
    bool touches = !SCENE_ANY_FREE;
    bool within = touches;
    for (int j = 0; SCENE_ANY_FREE && j < SCENE_CONTACTS; ++j) {
        touches = touches || q->contact[j].regime != (int32_t)REGIME_APART;
        within = within || scene_contact_side(q, j) < 0.0;
    }
    if (touches) {
        scene_now(q, at);
    } else if (within) {
        scene_kinematics_now(q, at);
    } else {
        return false;
    }
    note_instant(q, at);
    return true;
}

bool transition_begin_step(struct scene_state *q, struct scene_instant *at)
{
    q->step_length = 0.0;
    transition_mark_step(q);
    return note_now(q, at);
}

void transition_end_step(struct scene_state *q)
{
    struct scene_instant at;
    (void)note_now(q, &at);
}
