/*
 * The slip u of a sphere on a plane obeys u' = -mu kappa F_n (1 - exp(-u/v_0)), where kappa = 1/m + r^2/I is
 * the inverse mass seen along the plane. Its direction never changes. With the impulse p of F_n
 *
 *   u = v_0 ln(1 + (exp(u_0/v_0) - 1) exp(-mu kappa p / v_0))        for any F_n(t)
 *
 * and friction has the impulse -(u_0 - u) / kappa along the slip. So speeds, energies and impulses follow
 * from p. Places and rotation follow from integrals of the speed lost, u_0 - u = mu kappa p while u is far
 * above v_0, which the normal motion gives in closed form. The other parts are integrated by quadrature
 * (travel below).
 */
#include "touch/rubbing.h"

#include <float.h>
#include <stdlib.h>

#include "math/rotor.h"
#include "scene/evaluate.h"

/* Slip of this many v_0 or more has the full friction force: exp(-37) is below half a rounding of 1. */
static const double FULL_FRICTION = 37.0;

/* Roundings of a velocity in the slip of a sphere that rolls. */
static const double ROLLING_ROUNDINGS = 8.0;

/* A load along the plane is zero if it is below this part of all loads: a slanted normal is rounded. */
static const double LOAD_ROUNDING = 8.0 * DBL_EPSILON;

/* Whether no load acts along the plane on the relative motion, now and later. */
static bool loads_are_normal(const struct scene_state *q, int contact)
{
    const int ends[PAIR_BODIES] = {contact_source(contact), contact_destination(contact)};
    const struct vec3 normal = q->contact[contact].parameters.axis;
    for (int i = 0; i < 3; ++i) {
        struct vec3 load = {0.0, 0.0, 0.0}; /* the coefficient of time^i in C'' */
        double size = 0.0;
        for (int end = 0; end < PAIR_BODIES; ++end) {
            const struct body_path *path = &q->path[ends[end]];
            const double sign = end == 0 ? -1.0 : 1.0;
            if (body_is_free(q->v, ends[end])) {
                const struct vec3 by = vec3_scale(1.0 / body_mass(q->v, ends[end]), path->force[i]);
                const struct vec3 field = i == 0 ? gravity(q->v) : vec3_make(0.0, 0.0, 0.0);
                load = vec3_axpy(vec3_axpy(load, sign, by), sign, field);
                size += vec3_max_abs(by) + vec3_max_abs(field);
            } else if (body_is_prescribed(q->v, ends[end]) && i < 2) {
                load = vec3_axpy(load, sign * (i + 1), path->velocity[i + 1]);
                size += (i + 1) * vec3_max_abs(path->velocity[i + 1]);
            }
        }
        if (!(vec3_max_abs(contact_across_plane(normal, load)) <= LOAD_ROUNDING * size)) {
            return false;
        }
    }
    return true;
}

bool rubbing_is_solvable(const struct scene_instant *at, int contact)
{
    const struct scene_state *q = at->q;
    const struct scene_values *v = at->v;
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    if (contact_tips(v, contact) || body_is_compound(source) || body_is_compound(destination) ||
        !(scene_inverse_mass(v, contact) > 0.0) || scene_ends_suddenly(v, contact)) {
        return false;
    }
    if (contact_has_skew_axes(v, contact)) { /* the normal force turns cylinders that can turn */
        return abs(q->contact[contact].zone) == SKEW_FACE && !contact_rubs(v, contact) &&
               !body_turns(v, source) && !body_turns(v, destination);
    }
    if (!contact_rubs(v, contact)) {
        return true;
    }
    if (contact_resists(v, contact)) {
        return false;
    }
    return body_shape(destination) == SHAPE_PLANE && !contact_has_springs(v, contact) &&
           q->contact[contact].friction_regime[OPPOSED_SLIP] != (int32_t)FRICTION_CAPPED &&
           body_is_free(v, source) && !body_turn_is_prescribed(v, source) &&
           path_rests(q->path[source].torque) && loads_are_normal(q, contact);
}

/* The slip at the start of a segment, and what friction makes of it. */
struct slide {
    const struct segment *segment;
    struct vec3 arm;      /* from the source's centre to its surface, along the normal [m] */
    struct vec3 along;    /* direction of the slip, unit */
    double slip;          /* u_0 [m/s] */
    double unit;          /* v_0 [m/s] */
    double admittance;    /* kappa [1/kg] */
    double per_impulse;   /* mu kappa / v_0 [1/(N s)]; 0 where no friction acts */
    struct vec3 rotation; /* angular velocity of the source [rad/s] */
    struct vec3 spun;     /* its change per speed lost [rad/m]; zero where the source does not turn freely */
};

static struct slide slide_of(const struct segment *p, const struct scene_state *q, int contact)
{
    const struct contact_pair *pair = &p->pair;
    const int source = contact_source(contact);
    const bool turns = body_turns_freely(q->v, source);
    const struct friction_law law = scene_friction_law(q, contact, OPPOSED_SLIP);
    struct slide f = {.segment = p, .unit = law.slip_velocity};
    f.arm = vec3_scale(pair->shape.side * pair->shape.source_radius, pair->normal);
    f.rotation = turns ? q->turning.body[source].angular_velocity : f.rotation;
    const struct vec3 rolled = vec3_cross(f.rotation, f.arm);
    const struct vec3 slip = contact_across_plane(pair->normal, vec3_sub(rolled, pair->flight.w[0]));
    const double rounding =
        ROLLING_ROUNDINGS * DBL_EPSILON *
        (vec3_norm(rolled) + vec3_norm(q->body[source].velocity) + vec3_norm(pair->flight.w[0]));
    f.slip = vec3_norm(slip);
    f.admittance = scene_inverse_mass(q->v, contact);
    const double per_inertia = turns ? 1.0 / body_inertia_of(q->v, source).x : 0.0;
    f.admittance += per_inertia * vec3_dot(f.arm, f.arm);
    if (!(f.slip > rounding)) { /* it rolls */
        f.slip = 0.0;
        return f;
    }
    f.along = vec3_scale(1.0 / f.slip, slip);
    f.spun = vec3_scale(-per_inertia / f.admittance, vec3_cross(f.arm, f.along));
    if (q->contact[contact].friction_regime[OPPOSED_SLIP] != (int32_t)FRICTION_LIFTED) {
        f.per_impulse = law.coefficient * f.admittance / f.unit;
    }
    return f;
}

/*
 * Returns the speed lost, u_0 - u [m/s], and writes u, after an impulse p of the normal force [N s]. With x_0
 * = u_0/v_0, z = mu kappa p / v_0 and x = x_0 - z
 *
 *   u / v_0         = max(x, 0) + log1p((1 - exp(-z)) exp(-x))    x > 0, or
 *                     log1p((1 - exp(-x_0)) exp(x))                otherwise
 *   (u_0 - u) / v_0 = -log1p(-(1 - exp(-x_0)) (1 - exp(-z)))       while this product is below 1/2
 *
 * Nothing overflows, and sums have terms of one sign.
 */
static double speed_lost(const struct slide *f, double impulse, double *slip)
{
    const double start = f->slip / f->unit;
    const double z = f->per_impulse * impulse;
    const double x = start - z;
    const double more = x > 0.0 ? log1p(-expm1(-z) * exp(-x)) : log1p(-expm1(-start) * exp(x));
    const double product = expm1(-start) * expm1(-z);
    *slip = f->unit * (fmax(x, 0.0) + more);
    if (product < 0.5) {
        return -f->unit * log1p(-product);
    }
    return f->unit * (x > 0.0 ? z - more : start - more);
}

/* Returns the impulse of the normal force up to s [N s], and writes the motion of the pair at s. */
static double impulse_at(const struct slide *f, double s, struct pair_change *change)
{
    const struct contact_pair *pair = &f->segment->pair;
    *change = segment_change(f->segment, s);
    return pair->shape.side * pair->reduced_mass * vec3_dot(pair->normal, change->r_rate);
}

/* Serves as a root_function: how many v_0 the slip is above that of full friction. */
static void above_full_friction(const void *slide, double s, double *value, double *slope)
{
    const struct slide *f = slide;
    struct pair_change change;
    struct pair_sample at;
    f->segment->output.sampler(f->segment->output.segment, s, &at);
    *value = f->slip / f->unit - FULL_FRICTION - f->per_impulse * impulse_at(f, s, &change);
    *slope = -f->per_impulse * at.of[PAIR_FORCE][0] * segment_pace(f->segment, s);
}

/* Returns the end of full friction, in [0, end]. */
static double end_of_full_friction(const struct slide *f, double end)
{
    struct root_bracket_end low = {.s = 0.0};
    struct root_bracket_end high = {.s = end};
    above_full_friction(f, low.s, &low.value, &low.slope);
    above_full_friction(f, high.s, &high.value, &high.slope);
    if (!(low.value > 0.0) || high.value >= 0.0) {
        return low.value > 0.0 ? end : 0.0;
    }
    return root_between(above_full_friction, f, low, high);
}

enum { MOMENTS = PAIR_MOMENTS + 1 };

/* The way of a slide: moments of the speed lost, integrals of t^k (u_0 - u) [m s^k], and the rotation. */
struct travel {
    double time; /* the way is known up to this time [s] */
    double lost[MOMENTS];
    struct body_turn turn;
};

enum { LAST_NODE = LOBATTO_MAX - 1 }; /* of the twelve Lobatto nodes of a panel */

/* This struct holds values at the nodes of one panel of s. */
struct way_panel {
    nodal_values time, pace; /* t [s]; its derivative on [-1, 1] */
    nodal_values lost, slip; /* u_0 - u, u [m/s] */
};

/* Sets a panel and returns an estimate of the error that its polynomials make in places [m]. */
static double way_panel_make(struct way_panel *panel, const struct slide *f, double from, double length)
{
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        const double s = from + 0.5 * length * nodal_place(i);
        struct pair_change change;
        const double impulse = impulse_at(f, s, &change);
        panel->time[i] = change.time;
        panel->pace[i] = 0.5 * length * segment_pace(f->segment, s);
        panel->lost[i] = speed_lost(f, impulse, &panel->slip[i]);
    }
    const double fastest = f->slip + vec3_norm(f->rotation) * vec3_norm(f->arm);
    return nodal_tail(panel->slip) * (panel->time[LAST_NODE] - panel->time[0]) +
           nodal_tail(panel->time) * fastest;
}

/* This is the number of sweeps of Picard's iteration: a panel turns by a radian at most, and each sweep k
 * divides the error by some 2 k. The iteration ends where it changes less than a rounding. */
enum { MOST_PICARD_SWEEPS = 24 };
static const double MOST_TURN = 1.0;

/* Rotates over a panel by q' = (0, omega) q / 2 with omega = rotation + spun (u_0 - u), collocated at the
 * nodes. */
static void turn_over(const struct way_panel *panel, const struct slide *f, struct travel *way)
{
    double start[4];
    nodal_values rate[4];
    nodal_values grown[4] = {{0.0}};
    double change = 1.0;
    quaternion_to(way->turn.orientation, start);
    for (int sweep = 0; sweep < MOST_PICARD_SWEEPS && change >= DBL_EPSILON; ++sweep) {
        for (int i = 0; i < LOBATTO_MAX; ++i) {
            const struct vec3 omega = vec3_axpy(f->rotation, panel->lost[i], f->spun);
            double now[4];
            for (int k = 0; k < 4; ++k) {
                now[k] = start[k] + grown[k][i];
            }
            quaternion_to(quaternion_rate(quaternion_from(now), omega), now);
            for (int k = 0; k < 4; ++k) {
                rate[k][i] = panel->pace[i] * now[k];
            }
        }
        change = 0.0;
        for (int k = 0; k < 4; ++k) {
            change = fmax(change, nodal_integrate(rate[k], grown[k]));
        }
    }
    for (int k = 0; k < 4; ++k) {
        start[k] += grown[k][LAST_NODE];
    }
    way->turn.orientation = quaternion_unit(quaternion_from(start));
    way->turn.angular_velocity = vec3_axpy(f->rotation, panel->lost[LAST_NODE], f->spun);
}

/* An oscillation counts as forgotten after this many decay times: exp(-40) of it is below rounding. */
static const double DIED = 40.0;

/* Returns how many radians the contact oscillates in a time [s] before it has died away; 0 beyond critical
 * damping, and at a touch under Hertz's law. */
static double radians_in(const struct segment *p, double time)
{
    const double rate = sqrt(fmax(p->pair.coefficients.k, 0.0) / p->pair.reduced_mass);
    const double decay = 0.5 * p->pair.coefficients.c / p->pair.reduced_mass;
    return decay < rate ? fmin(time, DIED / decay) * rate : 0.0;
}

/* This is the longest first panel [radians of the contact's oscillation], so that no panel misses an
 * oscillation. */
static const double LONGEST_PANEL = 4.0;

/* A panel whose error is this part of the one allowed is followed by one twice as long: twelve nodes then
 * make 2^12 times the error. */
static const double TWICE_AS_LONG = 1.0 / 4096.0;

/* Roundings of the slip that the error of a panel contains. */
static const double PANEL_ROUNDINGS = 64.0;

/* A way shorter than this part of a rounding of the radius does not move a sphere. */
static const double BELOW_ROUNDING = 0.01;

/*
 * Integrates the way from one s to another by panels, or until the slip no longer matters for places. Panels
 * are halved until their error is below the segment's tolerance. `turning`: the axis of rotation changes, so
 * that the panels integrate the rotation too.
 */
static void travel_on(const struct slide *f, double from, double to, double length, bool turning,
                      struct travel *way)
{
    const double radius = f->segment->pair.shape.source_radius;
    const double whole = segment_time(f->segment, to);
    const double allowed = fmax(f->segment->tolerance, PANEL_ROUNDINGS * DBL_EPSILON * f->slip * whole);
    const double spin = vec3_norm(f->rotation) + f->slip * vec3_norm(f->spun);
    while (from < to) {
        struct way_panel panel;
        length = fmin(length, to - from);
        const double error = way_panel_make(&panel, f, from, length);
        const double time = panel.time[LAST_NODE] - panel.time[0];
        if ((!(error <= allowed) || (turning && spin * time > MOST_TURN)) && from + 0.5 * length > from) {
            length *= 0.5;
            continue;
        }
        for (int i = 0; i < LOBATTO_MAX; ++i) {
            double part = nodal_weight(i) * panel.pace[i] * panel.lost[i];
            for (int k = 0; k < MOMENTS; ++k) {
                way->lost[k] += part;
                part *= panel.time[i];
            }
        }
        if (turning) {
            turn_over(&panel, f, way);
        }
        way->time = panel.time[LAST_NODE];
        from = from + length < to ? from + length : to;
        length *= error <= TWICE_AS_LONG * allowed ? 2.0 : 1.0;
        const double slip = panel.slip[LAST_NODE];
        if (slip < f->unit && slip * (whole - way->time) <= BELOW_ROUNDING * DBL_EPSILON * radius) {
            return;
        }
    }
}

/* Whether friction turns the axis of rotation, so that the rotation has no closed form. A rotation about the
 * integral of omega would be wrong by some |omega x omega'| t^3 / 12 [rad], where omega' t = lost spun. */
static bool axis_turns(const struct slide *f, double lost, double time)
{
    const struct vec3 across = vec3_cross(f->rotation, f->spun);
    return lost * vec3_norm(across) * time * time > DBL_EPSILON;
}

/* Goes the way of a full slide, on which u_0 - u = mu kappa p with p = m_red rho', where r = side rho n: the
 * integral of t^k rho' is t^k rho less k times moment k - 1 of rho. */
static void slide_fully(const struct slide *f, double to, double length, bool turning, struct travel *way)
{
    const struct contact_pair *pair = &f->segment->pair;
    const double by = f->unit * f->per_impulse * pair->reduced_mass * pair->shape.side;
    const struct pair_change change = segment_change(f->segment, to);
    struct vec3 moment[PAIR_MOMENTS];
    segment_moments(f->segment, to, &change, PAIR_MOMENTS, moment);
    if (turning) {
        travel_on(f, 0.0, to, length, turning, way);
    }
    struct vec3 powered = change.r; /* t^k r */
    for (int k = 0; k < MOMENTS; ++k) {
        const struct vec3 along = k > 0 ? vec3_axpy(powered, -k, moment[k - 1]) : powered;
        way->lost[k] = by * vec3_dot(pair->normal, along);
        powered = vec3_scale(change.time, powered);
    }
    way->time = change.time;
}

/* Returns the way up to s. */
static struct travel travel_to(const struct slide *f, double s, const struct pair_change *end, double lost,
                               struct body_turn turn)
{
    struct travel way = {.turn = turn};
    const bool turning = axis_turns(f, lost, end->time);
    if (f->per_impulse > 0.0) {
        const double full = end_of_full_friction(f, s);
        const double length = s * fmin(1.0, LONGEST_PANEL / radians_in(f->segment, end->time));
        if (full > 0.0) {
            slide_fully(f, full, length, turning, &way);
        }
        travel_on(f, full, s, length, turning, &way);
    }
    /* what is left is rolling, or slip without friction */
    double power = 1.0;
    double before = 1.0;
    for (int k = 0; k < MOMENTS; ++k) {
        power *= end->time;
        before *= way.time;
        way.lost[k] += lost * (power - before) / (k + 1);
    }
    const double left = turning ? end->time - way.time : end->time;
    if (!turning && left > 0.0) {
        way.turn.angular_velocity = vec3_axpy(f->rotation, way.lost[0] / left, f->spun);
    }
    const struct rotor rotor = rotor_from(way.turn, 1.0, 1.0);
    way.turn = rotor_at(&rotor, left);
    way.turn.angular_velocity = vec3_axpy(f->rotation, lost, f->spun);
    return way;
}

/* Returns what friction adds to the integral of c x F, the impulse of the torque on the destination. Friction
 * moves c by q, so that with the flight C and the motion r without friction
 *
 *   integral of c x q'' + q x r'' = integral of C x q'' + [r x q' + q x r'] */
static struct vec3 lever_of_friction(const struct slide *f, const struct travel *way,
                                     const struct pair_change *end, double lost)
{
    const struct contact_pair *pair = &f->segment->pair;
    const struct pair_change slid = {
        .time = end->time, .r = vec3_scale(-way->lost[0], f->along), .r_rate = vec3_scale(-lost, f->along)};
    struct vec3 moment[PAIR_MOMENTS];
    double power = 1.0;
    /* the integral of t^j q is that of (t_end^(j+1) - t^(j+1)) q' / (j + 1) */
    for (int j = 0; j < PAIR_MOMENTS; ++j) {
        power *= end->time;
        moment[j] = vec3_scale((way->lost[j + 1] - power * way->lost[0]) / (j + 1), f->along);
    }
    const struct vec3 by_flight = segment_lever(pair, &slid, moment, pair->flight.c);
    const struct vec3 by_segment = vec3_add(vec3_cross(end->r, slid.r_rate), vec3_cross(slid.r, end->r_rate));
    return vec3_scale(1.0 / f->admittance, vec3_add(by_flight, by_segment));
}

/* Adds what friction does to the bodies and to the books. */
static void apply(const struct slide *f, const struct travel *way, const struct pair_change *end, double lost,
                  double slip, struct scene_state *q, int contact)
{
    const int ends[PAIR_BODIES] = {contact_source(contact), contact_destination(contact)};
    struct contact_impulses *sum = &q->contact[contact].physics.impulse;
    const struct vec3 impulse = vec3_scale(-lost / f->admittance, f->along); /* on the source */
    const struct vec3 path = vec3_scale(-way->lost[0] / f->admittance, f->along);
    for (int end_of = 0; end_of < PAIR_BODIES; ++end_of) {
        const double share = (end_of == 0 ? 1.0 : -1.0) * body_inverse_mass(q->v, ends[end_of]);
        struct body_state *body = &q->body[ends[end_of]];
        body->velocity = vec3_axpy(body->velocity, share, impulse);
        body->moved = vec3_axpy(body->moved, share, path);
    }
    if (body_is_prescribed(q->v, ends[1])) { /* its speed along the plane is constant */
        q->external_work += vec3_dot(impulse, path_at(q->path[ends[1]].velocity, 3, q->clock));
    }
    const struct vec3 torque = vec3_cross(f->arm, impulse);
    q->friction_energy += 0.5 * lost * (f->slip + slip) / f->admittance;
    sum->force = vec3_add(sum->force, impulse);
    sum->source_torque = vec3_add(sum->source_torque, torque);
    sum->destination_torque =
        vec3_add(sum->destination_torque, vec3_sub(lever_of_friction(f, way, end, lost), torque));
}

void rubbing_advance(struct segment *p, double from, double s, struct scene_state *q, int contact)
{
    const int source = contact_source(contact);
    const struct slide f = slide_of(p, q, contact);
    struct body_turn *turn = &q->turning.body[source];
    struct pair_change end;
    double slip;
    const double lost = speed_lost(&f, impulse_at(&f, s, &end), &slip);
    const struct body_turn start = {turn->orientation, f.rotation};
    segment_advance(p, from, s, q, contact);
    const struct travel way = travel_to(&f, s, &end, lost, start);
    if (f.slip > 0.0) {
        apply(&f, &way, &end, lost, slip, q, contact);
    }
    if (body_turns_freely(q->v, source)) {
        *turn = way.turn;
    }
}

/* Most radians of the contact's oscillation that quadratures follow in one segment: some hundred panels. */
static const double MOST_RADIANS = 400.0;

/* Returns the s up to which a segment that ends at `end` needs no quadrature. */
static double closed_until(const struct slide *f, double end)
{
    if (!(f->per_impulse > 0.0)) {
        return end;
    }
    return axis_turns(f, f->slip, segment_time(f->segment, end)) ? 0.0 : end_of_full_friction(f, end);
}

bool rubbing_allows(struct segment *p, const struct scene_state *q, int contact)
{
    const struct friction_law law = scene_friction_law(q, contact, OPPOSED_SLIP);
    if (!(law.coefficient * segment_bound(p, PAIR_FORCE) < law.largest)) {
        return false;
    }
    const double end = fmin(p->end, p->terminal.s);
    const double time = segment_time(p, end);
    const double radians = radians_in(p, time);
    if (radians > MOST_RADIANS) {
        const struct slide f = slide_of(p, q, contact);
        const double until = segment_time(p, closed_until(&f, end)) + time * (MOST_RADIANS / radians);
        p->end = until < time ? segment_place(p, until) : p->end;
    }
    p->work += 1 + (int)fmin(radians, MOST_RADIANS);
    return true;
}

double rubbing_short_until(const struct segment *p, const struct scene_state *q, int contact)
{
    const struct slide f = slide_of(p, q, contact);
    const double end = fmin(p->end, p->terminal.s);
    const double time = segment_time(p, end);
    const double until = segment_time(p, closed_until(&f, end));
    const bool turns = f.per_impulse > 0.0 && axis_turns(&f, f.slip, time);
    return turns || radians_in(p, time - until) > LONGEST_PANEL ? until : (double)INFINITY;
}
