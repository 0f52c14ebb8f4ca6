#include <float.h>
#include <string.h>

#include "flight/flight.h"
#include "math/compiler.h"
#include "scene/evaluate.h"
#include "touch/expansion.h"
#include "touch/pair.h"

/* Adds a body's part of the force and the momentum that do external work. Returns whether the work of the
 * motion along n alone has a constant path; the path across a plane's normal does no work. */
static bool add_work(struct contact_pair *p, const struct scene_state *q, int body, double sign)
{
    const bool is_free = body_is_free(q->v, body);
    const double factor = sign * p->reduced_mass * (is_free ? body_inverse_mass(q->v, body) : -1.0);
    const struct vec3 *given = is_free ? q->path[body].force : q->path[body].velocity;
    struct vec3 path[3];
    if ((!is_free && !body_is_prescribed(q->v, body)) || path_rests(given)) {
        return true;
    }
    memcpy(path, given, sizeof path);
    path_shift(path, 3, q->clock);
    struct vec3 *sum = is_free ? p->force : p->momentum;
    for (int i = 0; i < 3; ++i) {
        sum[i] = vec3_axpy(sum[i], factor, path[i]);
        if (!is_free && i > 0) {
            p->force[i - 1] = vec3_axpy(p->force[i - 1], -i * factor, path[i]);
        }
    }
    return vec3_is_zero(flight_part_that_counts(&p->shape, p->normal, path[1])) &&
           vec3_is_zero(flight_part_that_counts(&p->shape, p->normal, path[2]));
}

/* n is undefined at d = 0 and becomes the direction of motion; c, which is rounding there, is set along n. At
 * rest n keeps its direction, unless the relative acceleration outweighs the contact force along n and gives
 * n its own direction. */
static void leave_centre(struct contact_pair *p, const struct contact_geometry *geometry)
{
    const double reach = contact_reach(&p->shape);
    struct vec3 acceleration = contact_across(&p->shape, vec3_scale(2.0, p->flight.c[2]));
    if (!(p->coefficients.k * reach / p->reduced_mass + vec3_dot(p->normal, acceleration) < 0.0)) {
        acceleration = vec3_make(0.0, 0.0, 0.0);
    }
    p->normal = singularity_escape(&p->shape, p->flight.c[1], acceleration, p->normal);
    p->distance = fmax(reach + p->gap, 2.0 * DBL_EPSILON * reach);
    p->gap = p->distance - reach;
    p->rounded = vec3_axpy(vec3_scale(p->distance, p->normal), -1.0, geometry->offset);
    p->flight.c[0] = vec3_add(p->flight.c[0], p->rounded);
}

/* Whether the prescribed velocity differs from the derivative of the prescribed displacement by more than
 * rounding. */
static bool path_contradicts(const struct scene_state *q, int body)
{
    if (!body_is_prescribed(q->v, body)) {
        return false;
    }
    struct body_path path = q->path[body];
    path_shift(path.displacement, 4, q->clock);
    path_shift(path.velocity, 3, q->clock);
    for (int i = 0; i < 3; ++i) {
        const struct vec3 rate = vec3_scale(i + 1, path.displacement[i + 1]);
        const double size = vec3_max_abs(rate) + vec3_max_abs(path.velocity[i]);
        if (vec3_max_abs(vec3_sub(path.velocity[i], rate)) > 16.0 * DBL_EPSILON * size) {
            return true;
        }
    }
    return false;
}

void pair_make(struct contact_pair *p, const struct scene_instant *at, int contact)
{
    const struct scene_state *q = at->q;
    const struct contact_geometry *geometry = &at->geometry[contact];
    p->shape = scene_contact_shape(q, contact);
    p->law = scene_contact_law(q, contact);
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    const struct contact_coefficients factors = contact_factors_of(&p->law, regime);
    const struct contact_slopes slopes =
        contact_force_slopes(&p->law, regime, geometry->gap, geometry->gap_rate);
    p->coefficients = (struct contact_coefficients){-slopes.by_gap, -slopes.by_rate};
    p->hertz_stiffness = contact_is_hertz(&p->law) ? factors.k : 0.0;
    p->chi = contact_is_hertz(&p->law) ? factors.c : 0.0;
    p->flight = separation_path_of(at, q->clock, contact);
    p->normal = geometry->normal;
    p->distance = geometry->distance;
    p->gap = geometry->gap;
    const double shorter = p->shape.side * p->gap - (geometry->distance - contact_reach(&p->shape));
    p->rounded = vec3_scale(shorter, p->normal);
    p->rate_rounding = rounding_of_rate(at, contact);
    p->reduced_mass = 1.0 / scene_inverse_mass(at->v, contact);
    const bool is_at_centre = singularity_is_reached(at, contact, &p->shape);
    if (is_at_centre) {
        leave_centre(p, geometry);
    }
    const bool is_carried = !is_at_centre && scene_rate_is_known(at, contact);
    const double along = vec3_dot(p->normal, contact_across(&p->shape, p->flight.w[0]));
    p->rate = is_carried ? geometry->gap_rate : p->shape.side * along;
    p->rate_is_known = is_carried || p->rate == 0.0;
    /* with w corrected so that side n.w is g', all formulas see one rate */
    p->rate_rounded = vec3_scale(p->shape.side * p->rate - along, p->normal);
    p->flight.c[1] = vec3_add(p->flight.c[1], p->rate_rounded);
    p->flight.w[0] = vec3_add(p->flight.w[0], p->rate_rounded);
    p->has_mismatch =
        path_contradicts(q, contact_source(contact)) || path_contradicts(q, contact_destination(contact));
    memset(p->force, 0, sizeof p->force);
    memset(p->momentum, 0, sizeof p->momentum);
    const bool by_source = add_work(p, q, contact_source(contact), -1.0);
    const bool by_destination = add_work(p, q, contact_destination(contact), 1.0);
    p->is_head_on = by_source && by_destination && flight_is_head_on(&p->shape, &p->flight, p->normal);
}

/* Returns the part of the vector `across` that is perpendicular to n and turns n; zero at a plane. */
static struct vec3 pair_tangential(const struct contact_pair *p, struct vec3 across)
{
    if (contact_is_plane(&p->shape)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    return vec3_axpy(across, -vec3_dot(p->normal, across), p->normal);
}

double pair_gap_derivative(const struct contact_pair *p)
{
    if (!SCENE_ANY_PRESCRIBED || !p->has_mismatch) {
        return p->rate;
    }
    const struct vec3 mismatch = vec3_sub(p->flight.w[0], p->flight.c[1]);
    return p->rate - p->shape.side * vec3_dot(p->normal, contact_across(&p->shape, mismatch));
}

double pair_pressing_load(const struct contact_pair *p)
{
    const double distance = fmax(p->distance, 0.5 * contact_reach(&p->shape));
    const struct vec3 across = pair_tangential(p, contact_across(&p->shape, p->flight.c[1]));
    double turning = vec3_dot(across, across);
    if (contact_is_circle(&p->shape)) {
        const struct contact_geometry at =
            contact_geometry_at(&p->shape, p->flight.c[0], p->flight.c[1], p->normal);
        turning = contact_turning_rate(&p->shape, &at, p->flight.c[1]);
    }
    return -p->shape.side * (turning / distance + 2.0 * vec3_dot(p->normal, p->flight.c[2]));
}

double pair_load(const struct contact_pair *p)
{
    return p->reduced_mass * fabs(pair_pressing_load(p));
}

struct vec3 pair_aside(const struct contact_pair *p, struct vec3 a)
{
    if (contact_is_plane(&p->shape)) {
        return contact_across_plane(p->normal, a);
    }
    return contact_is_cylinder(&p->shape) ? vec3_scale(vec3_dot(p->shape.axis, a), p->shape.axis)
                                          : vec3_make(0.0, 0.0, 0.0);
}

/* Sets the velocity that both bodies share, without its part aside: that of the body that is not free, or of
 * the centre of mass. common[i] is the coefficient of time^i, and zero at the call. */
static void put_common_velocity(const struct contact_pair *p, const struct scene_state *q,
                                const int ends[PAIR_BODIES], struct vec3 common[2])
{
    const struct scene_values *v = q->v;
    const bool both = body_is_free(v, ends[0]) && body_is_free(v, ends[1]);
    const double inverse_mass = both ? 1.0 / (body_mass(v, ends[0]) + body_mass(v, ends[1])) : 0.0;
    common[1] = both ? gravity(v) : common[1];
    for (int end = 0; end < PAIR_BODIES; ++end) {
        const struct body_path *path = &q->path[ends[end]];
        if (body_is_prescribed(v, ends[end])) {
            common[0] = path_at(path->velocity, 3, q->clock);
            common[1] = path_slope(path->velocity, q->clock);
        } else if (both) {
            const double part = body_mass(v, ends[end]) * inverse_mass;
            common[0] = vec3_axpy(common[0], part, q->body[ends[end]].velocity);
            common[1] = vec3_axpy(common[1], inverse_mass, path_at(path->force, 3, q->clock));
        }
    }
    common[0] = flight_part_that_counts(&p->shape, p->normal, common[0]);
    common[1] = flight_part_that_counts(&p->shape, p->normal, common[1]);
}

/* Moves a body of a head-on contact. Along n the body follows the common velocity of both bodies and takes
 * its share of the change of the separation; aside (pair_aside) it flies. A difference of two flights would
 * lose the digits of bodies that rest against each other for long. */
static void move_head_on(const struct contact_pair *p, const struct pair_change *change,
                         struct scene_state *q, int body, double share, const struct vec3 common[2])
{
    struct body_state *state = &q->body[body];
    const double side = p->shape.side;
    struct free_flight f = free_flight_of(q, body, q->clock, state->velocity);
    for (int i = 0; i < f.terms; ++i) {
        f.velocity[i] = pair_aside(p, f.velocity[i]);
    }
    const struct vec3 apart = vec3_axpy(p->rounded, side * (change->gap - p->gap), p->normal);
    const struct vec3 moved = vec3_axpy(flight_displacement(common, 2, change->time), share, apart);
    if (!path_rests(f.force)) {
        q->external_work += flight_work_along(&f, change->time) + vec3_dot(f.force[0], moved);
    }
    const struct vec3 flown = flight_displacement(f.velocity, f.terms, change->time);
    const struct vec3 together = path_at(common, 2, change->time);
    state->moved = vec3_add(state->moved, vec3_add(flown, moved));
    state->velocity = vec3_add(path_at(f.velocity, f.terms, change->time),
                               vec3_axpy(together, share * side * change->gap_rate, p->normal));
}

/* The external work that is due to r is found by parts, so that an oscillation of r' need not be resolved:
 * force.r' = (force.r)' - force'.r. Head-on the forces are those on free bodies, see move_head_on. In lasting
 * contact the velocity of the flight and the deviation from it nearly cancel: the bound of the rounding of g'
 * takes the sizes of both. */
void pair_apply(const struct contact_pair *p, const struct pair_change *change,
                const struct vec3 moment[PAIR_MOMENTS], struct scene_state *q, int contact)
{
    double speeds = 0.0; /* of both bodies after the change [m/s] */
    struct contact_state *state = &q->contact[contact];
    const int ends[PAIR_BODIES] = {contact_source(contact), contact_destination(contact)};
    const struct vec3 rounded = vec3_axpy(p->rounded, change->time, p->rate_rounded);
    const struct vec3 r = vec3_add(change->r, rounded);
    const struct vec3 r_rate = vec3_add(change->r_rate, p->rate_rounded);
    struct vec3 common[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    if (change->head_on) {
        put_common_velocity(p, q, ends, common);
    }
    for (int end = 0; end < PAIR_BODIES; ++end) {
        const bool is_free = body_is_free(q->v, ends[end]);
        const double share =
            is_free ? (end == 0 ? -1.0 : 1.0) * p->reduced_mass / body_mass(q->v, ends[end]) : 0.0;
        if (is_free && change->head_on) {
            move_head_on(p, change, q, ends[end], share, common);
        } else if (is_free) {
            flight_deviate(q, ends[end], change->time, vec3_scale(share, r), vec3_scale(share, r_rate));
        }
        if (is_free) {
            speeds += vec3_norm(q->body[ends[end]].velocity);
        } else if (body_is_prescribed(q->v, ends[end])) {
            speeds += vec3_norm(path_at(q->path[ends[end]].velocity, 3, q->clock));
        }
    }
    double work = vec3_dot(path_at(p->momentum, 3, change->time), change->r_rate);
    if (!change->head_on) {
        work = work + vec3_dot(path_at(p->force, 3, change->time), change->r) -
               vec3_dot(p->force[1], moment[0]) - 2.0 * vec3_dot(p->force[2], moment[1]);
    }
    q->external_work += work;
    q->dissipated += change->dissipated;
    state->physics.impulse.force = vec3_axpy(state->physics.impulse.force, -p->reduced_mass, change->r_rate);
    state->physics.accumulated_gap = change->gap;
    state->physics.rate_rounding = 16.0 * DBL_EPSILON * (speeds + vec3_norm(change->r_rate));
}

/* A component perpendicular to the plane of motion is rounding if it is below this fraction of the others. */
static const double OUT_OF_PLANE = 8.0 * DBL_EPSILON;

/* The projection of a vector along the normal leaves rounding, whose direction is arbitrary. Where a second
 * projection leaves less than this part of a unit vector, that vector is such rounding. */
static const double MOSTLY_NORMAL = 0.5;

/* Returns the first tangential direction in which the flight moves; zero where the motion is head-on. */
static struct vec3 tangent_of(const struct contact_pair *from)
{
    for (int i = 0; i < 2 * from->flight.degree; ++i) {
        const struct vec3 *row = i % 2 == 0 ? &from->flight.c[i / 2 + 1] : &from->flight.w[i / 2];
        const struct vec3 across = contact_across(&from->shape, *row);
        const struct vec3 along = pair_tangential(from, across);
        if (!vec3_is_zero(along) && !vec3_is_zero(vec3_cross(from->normal, across))) {
            const struct vec3 direction = vec3_scale(1.0 / vec3_norm(along), along);
            const struct vec3 tangent = pair_tangential(from, direction);
            const double left = vec3_norm(tangent);
            if (left > MOSTLY_NORMAL) {
                return vec3_scale(1.0 / left, tangent);
            }
        }
    }
    return vec3_make(0.0, 0.0, 0.0);
}

/* Puts one coefficient into the frame. Returns whether the coefficient has a part out of the plane of
 * motion. */
static bool put_in_frame(const struct frame_flight *flight, struct vec3 a, double out[FRAME])
{
    for (int j = 0; j < FRAME; ++j) {
        out[j] = vec3_dot(flight->frame[j], a);
    }
    return fabs(out[2]) > OUT_OF_PLANE * (fabs(out[0]) + fabs(out[1]));
}

void frame_flight_make(struct frame_flight *flight, const struct contact_pair *from)
{
    *flight = (struct frame_flight){.frame = {from->normal, tangent_of(from)},
                                    .degree = from->flight.degree,
                                    .c = {{from->distance, 0.0, 0.0}}};
    const bool at_rim = contact_is_circle(&from->shape);
    bool leaves_plane = false;
    flight->head_on = vec3_is_zero(flight->frame[1]);
    flight->frame[2] = vec3_cross(flight->frame[0], flight->frame[1]);
    if (at_rim) {
        const struct contact_solid *solid = &from->shape.solid;
        flight->rim =
            rim_start_of(from->shape.axis, solid->radius, solid->half_height, from->flight.c[0],
                         contact_reach(&from->shape) + from->shape.side * from->gap, from->flight.c[1]);
        memcpy(flight->frame, flight->rim.frame, sizeof flight->frame);
        (void)put_in_frame(flight, from->flight.c[0], flight->c[0]);
    }
    for (int i = 1; i <= flight->degree; ++i) {
        const struct vec3 c = contact_across(&from->shape, from->flight.c[i]);
        const struct vec3 w = contact_across(&from->shape, from->flight.w[i - 1]);
        leaves_plane = put_in_frame(flight, c, flight->c[i]) || leaves_plane;
        leaves_plane = put_in_frame(flight, w, flight->w[i - 1]) || leaves_plane;
    }
    flight->dimensions = !at_rim && flight->head_on ? 1 : leaves_plane ? 3 : 2;
}

/* This is the lowest damped frequency treated as an oscillation [radians per s], at 0.97 of critical damping.
 * A lower one decays below rounding within one period. */
static const double LOWEST_FREQUENCY = 0.25;

static double along_normal(const struct contact_pair *from, int degree)
{
    return from->shape.side * vec3_dot(from->normal, contact_across(&from->shape, from->flight.c[degree]));
}

bool pair_oscillation_make(struct pair_oscillation *p, const struct contact_pair *from)
{
    const bool has_spring = from->coefficients.k > 0.0;
    const double dashpot = from->coefficients.c / from->reduced_mass;
    p->from = from;
    p->rate = has_spring ? sqrt(from->coefficients.k / from->reduced_mass) : dashpot;
    if (!(p->rate > 0.0)) {
        return false;
    }
    p->dynamic_stiffness = from->reduced_mass * p->rate * p->rate;
    p->load = 2.0 * along_normal(from, 2) / (p->rate * p->rate);
    p->equilibrium = has_spring ? p->load : 0.0;
    const double y = from->gap - p->equilibrium;
    const double y_rate = pair_gap_derivative(from) / p->rate;
    p->free = has_spring ? free_oscillation_of(dashpot / p->rate, y, y_rate)
                         : free_oscillation_of_dashpot(y, y_rate, p->load);
    p->omega_d = p->free.omega_d < LOWEST_FREQUENCY ? 0.0 : p->free.omega_d;
    p->amplitude = has_spring ? oscillator_envelope_of(&p->free.oscillator, y, y_rate).amplitude
                              : fabs(y) + fabs(p->free.by_faster); /* a weak dashpot's parts nearly cancel */
    return fabs(p->equilibrium) + p->amplitude <
           (contact_may_reach_centre(&from->shape) ? contact_reach(&from->shape) : DBL_MAX);
}

/* Sets the gap and its first derivatives by s, and the changes of gap and rate since the start, which would
 * lose digits as differences. */
static inline void motion_at(const struct pair_oscillation *p, double s, double grown[2],
                             double gap[1 + FREE_OSCILLATION_DERIVATIVES])
{
    const struct oscillator_increment since = free_oscillation_since(&p->free, s);
    grown[0] = since.x;
    grown[1] = since.x_rate;
    const double g = p->from->gap + since.x;
    const double rate = p->free.y_rate + since.x_rate;
    if (p->omega_d > 0.0) {
        const double damping_rate = p->free.oscillator.damping_rate;
        gap[0] = g;
        gap[1] = rate;
        gap[2] = -damping_rate * rate - (p->free.y + since.x);
        gap[3] = -damping_rate * gap[2] - rate;
        gap[4] = -damping_rate * gap[3] - gap[2];
        return;
    }
    free_oscillation_at(&p->free, s, gap);
    /* y or y' that has decayed far is more accurate than its start value plus the increment */
    gap[0] = 2.0 * fabs(gap[0]) < fabs(p->free.y) ? p->equilibrium + gap[0] : g;
    gap[1] = 2.0 * fabs(gap[1]) < fabs(p->free.y_rate) ? gap[1] : rate;
}

/* y' = exp(-damping_rate s / 2) (y_rate cos + sideways sin) of omega_d s. */
double pair_oscillation_first_extremum(const struct pair_oscillation *p)
{
    const double sideways =
        -(p->free.y + 0.5 * p->free.oscillator.damping_rate * p->free.y_rate) / p->omega_d;
    const double angle = p->free.y_rate == 0.0  ? PI
                         : p->free.y_rate < 0.0 ? atan2(-p->free.y_rate, sideways)
                                                : atan2(p->free.y_rate, -sideways);
    return angle / p->omega_d;
}

/* Returns the envelope of the part of a quantity that an oscillation y makes. The variable s of y is
 * `per_time` [1/s] times the time. */
static struct oscillator_envelope envelope_of(const struct contact_pair *from, enum pair_quantity quantity,
                                              const struct oscillator *o, double per_time, double y,
                                              double y_rate)
{
    const double bend = -o->damping_rate * y_rate - o->omega2 * y;
    const double k = from->coefficients.k;
    const double c = from->coefficients.c * per_time;
    const double start[] = {y, per_time * y_rate, k * y + c * y_rate};
    const double rate[] = {y_rate, per_time * bend, k * y_rate + c * bend};
    return oscillator_envelope_of(o, start[quantity], rate[quantity]);
}

bool pair_oscillation_stays_positive(const struct pair_oscillation *p, const struct event_function *what)
{
    const double k = p->from->coefficients.k;
    const double still[] = {p->equilibrium, 0.0, -k * p->equilibrium};
    const struct free_oscillation *y = &p->free;
    double amplitude = p->amplitude; /* of the gap */
    if (what->quantity != PAIR_GAP) {
        amplitude = envelope_of(p->from, what->quantity, &y->oscillator, p->rate, y->y, y->y_rate).amplitude;
    }
    /* without a spring the gap drifts */
    return k > 0.0 && amplitude < what->factor * still[what->quantity] + what->offset;
}

/* Sets a sample by the gap and its first derivatives. Computes the force of a decay as F_n = m_red (g'' -
 * side n.A), because the forces of spring and dashpot nearly cancel. */
static inline void sample_of_gap(const struct pair_oscillation *p,
                                 const double gap[1 + FREE_OSCILLATION_DERIVATIVES],
                                 struct pair_sample *sample)
{
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP][i] = gap[i];
        sample->of[PAIR_GAP_RATE][i] = p->rate * gap[i + 1];
        sample->of[PAIR_FORCE][i] =
            p->omega_d > 0.0
                ? contact_linear_force(p->from->coefficients, gap[i], sample->of[PAIR_GAP_RATE][i])
                : p->dynamic_stiffness * (gap[i + 2] - (i == 0 ? p->load : 0.0));
    }
}

void pair_oscillation_sample(const void *pair_oscillation, double s, struct pair_sample *sample)
{
    double gap[1 + FREE_OSCILLATION_DERIVATIVES];
    double grown[2];
    motion_at(pair_oscillation, s, grown, gap);
    sample_of_gap(pair_oscillation, gap, sample);
}

void pair_oscillation_sample_extremum(const struct pair_oscillation *p, double s, bool deepest,
                                      struct pair_sample *sample)
{
    const double damping_rate = p->free.oscillator.damping_rate;
    const double shrunk = damping_rate > 0.0 ? p->omega_d * exp(-0.5 * damping_rate * s) : 1.0;
    const double y = deepest ? -shrunk * p->amplitude : shrunk * p->amplitude;
    if (2.0 * fabs(p->equilibrium + y) < fabs(y)) { /* the sum loses digits, which tell whether bodies part */
        pair_oscillation_sample(p, s, sample);
        return;
    }
    const double gap[1 + FREE_OSCILLATION_DERIVATIVES] = {p->equilibrium + y, 0.0, -y, damping_rate * y};
    sample_of_gap(p, gap, sample);
}

struct pair_change pair_change_along_normal(const struct contact_pair *from, double time, double r,
                                            double r_rate, double gap)
{
    return (struct pair_change){.time = time,
                                .r = vec3_scale(from->shape.side * r, from->normal),
                                .r_rate = vec3_scale(from->shape.side * r_rate, from->normal),
                                .gap = gap};
}

/* The dissipated energy follows from the oscillator's energy balance: p_nv g'^2 = -(m g'^2 / 2 + p_n (g -
 * equilibrium)^2 / 2)', or without a spring -(m g'^2 / 2 - side m n.A g)'. */
struct pair_change pair_oscillation_advance(const void *pair_oscillation, double s)
{
    const struct pair_oscillation *p = pair_oscillation;
    const struct contact_pair *from = p->from;
    const double time = s / p->rate;
    const double fall = 2.0 * along_normal(from, 2) * time;
    double grown[2];
    double gap[1 + FREE_OSCILLATION_DERIVATIVES];
    motion_at(p, s, grown, gap);
    const double r = grown[0] - (p->free.y_rate * s + 0.5 * fall * time);
    const double r_rate = p->rate * grown[1] - fall;
    struct pair_change change = pair_change_along_normal(from, time, r, r_rate, gap[0]);
    change.head_on = true;
    change.gap_rate = p->rate * gap[1];
    if (from->coefficients.c > 0.0) {
        const bool has_spring = from->coefficients.k > 0.0;
        const double by_place = grown[0] * (has_spring ? 2.0 * p->free.y + grown[0] : -2.0 * p->load);
        const double by_rate = grown[1] * (2.0 * p->free.y_rate + grown[1]);
        change.dissipated = -0.5 * p->dynamic_stiffness * (by_rate + by_place);
    }
    return change;
}

/*
 * The moments M_j, integrals of t^j rho, in closed form: r = side rho n and m_red rho'' = F_n = -k g - c g',
 * where rho is g less the gap of the flight. G_j is the integral of t^j (g - g(0)), I_j that of t^j rho'',
 * and J_j that of t^j g'. The first equation holds with a spring, the second one without a spring:
 *
 *   k (G_j + g(0) t^(j+1)/(j+1)) = -m_red I_j - c J_j,   0 = m_red I_(j+1) + c J_(j+1)
 *   I_j = t^j rho' - j t^(j-1) rho + j (j-1) M_(j-2),    J_j = t^j (g - g(0)) - j G_(j-1)
 */
void pair_oscillation_moments(const void *pair_oscillation, double s, const struct pair_change *change,
                              int count, struct vec3 *moment)
{
    const struct contact_pair *p = ((const struct pair_oscillation *)pair_oscillation)->from;
    double of[PAIR_MOMENTS];
    (void)s;
    const double k = p->coefficients.k;
    const double c = p->coefficients.c;
    const double t = change->time;
    const double grown = change->gap - p->gap;
    const double rho = p->shape.side * vec3_dot(p->normal, change->r);
    const double rho_rate = p->shape.side * vec3_dot(p->normal, change->r_rate);
    double before = 0.0;       /* G_(j-1) */
    double power = 1.0;        /* t^j */
    double inertia = rho_rate; /* I_j */
    for (int j = 0; j < count; ++j) {
        const double next = /* I_(j+1) */
            power * t * rho_rate - (j + 1) * power * rho + (j > 0 ? (j + 1) * j * of[j - 1] : 0.0);
        const double damped = power * grown - j * before;
        const double of_gap =
            k > 0.0 ? -(p->reduced_mass * inertia + c * damped) / k - p->gap * power * t / (j + 1)
                    : (power * t * grown + p->reduced_mass / c * next) / (j + 1);
        const double flown = t * (along_normal(p, 1) / (j + 2) + t * along_normal(p, 2) / (j + 3));
        of[j] = of_gap - power * t * flown;
        moment[j] = vec3_scale(p->shape.side * of[j], p->normal);
        before = of_gap;
        inertia = next;
        power *= t;
    }
}

/* F_n = k_h u^3 q with q = 1 - chi g'. */
void pair_hertz_force(const struct contact_pair *from, const double u[3], const double rate[3],
                      double force[3])
{
    const double k = from->hertz_stiffness;
    const double q[3] = {1.0 - from->chi * rate[0], -from->chi * rate[1], -from->chi * rate[2]};
    const double square = u[0] * u[0];
    const double cube = square * u[0];
    force[0] = k * cube * q[0];
    force[1] = k * (3.0 * square * u[1] * q[0] + cube * q[1]);
    force[2] = k * ((6.0 * u[0] * u[1] * u[1] + 3.0 * square * u[2]) * q[0] + 6.0 * square * u[1] * q[1] +
                    cube * q[2]);
}

/* Samples a step, with the oscillation y or without it. The force of an overdamped step follows from the
 * acceleration, because the forces of spring and dashpot nearly cancel. */
static void sample_step(const struct pair_collocation *p, double s, bool with_y, struct pair_sample *sample)
{
    double averaged[4];
    double y[4] = {0.0};
    if (with_y) {
        collocation_deviation(&p->step, s, averaged, y);
    } else {
        nodal_derivatives(p->step.result.slow, s, averaged);
    }
    const double side = p->from->shape.side;
    const double per_time = side / p->step.half;
    double x[4];
    for (int i = 0; i < 4; ++i) {
        x[i] = averaged[i] + y[i];
    }
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP][i] = side * x[i];
        sample->of[PAIR_GAP_RATE][i] = per_time * x[i + 1];
    }
    if (SCENE_ANY_CAPS && contact_is_rim(&p->from->shape)) {
        collocation_edges(&p->step, s, averaged, y, sample->of[PAIR_RADIAL], sample->of[PAIR_AXIAL]);
    }
    if (SCENE_ANY_HERTZ && p->from->hertz_stiffness > 0.0) {
        double u[3] = {sqrt(fmax(-side * x[0], 0.0))};
        u[1] = -0.5 * side * x[1] / u[0];
        u[2] = -(0.5 * side * x[2] + u[1] * u[1]) / u[0];
        pair_hertz_force(p->from, u, sample->of[PAIR_GAP_RATE], sample->of[PAIR_FORCE]);
        return;
    }
    const bool is_overdamped = p->step.kind == COLLOCATION_OVERDAMPED;
    double push[3];
    if (is_overdamped) {
        collocation_overdamped_push(&p->step, s, push);
    }
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_FORCE][i] = is_overdamped
                                        ? per_time / p->step.half * p->from->reduced_mass * push[i]
                                        : contact_linear_force(p->from->coefficients, sample->of[PAIR_GAP][i],
                                                               sample->of[PAIR_GAP_RATE][i]);
    }
}

void pair_collocation_sample(const void *pair_collocation, double s, struct pair_sample *sample)
{
    sample_step(pair_collocation, s, true, sample);
}

struct oscillator_envelope pair_collocation_envelope(const struct pair_collocation *p,
                                                     enum pair_quantity quantity)
{
    const struct collocation_result *by = &p->step.result;
    return envelope_of(p->from, quantity, &by->oscillator, 1.0 / p->step.half, by->y, by->y_rate);
}

void pair_collocation_sample_averaged(const void *pair_collocation, double s, struct pair_sample *sample)
{
    sample_step(pair_collocation, s, false, sample);
}

/* Returns the energy that the dashpot dissipates in a quasi-static step, the integral of its power k_h
 * delta^(3/2) chi delta'^2, by the nodes' quadrature [J]. */
static double quasi_static_dissipated(const struct pair_collocation *p, double s)
{
    double sum = 0.0;
    for (int i = 0; i < LOBATTO_MAX && p->from->chi > 0.0; ++i) {
        double weight;
        double x[4];
        nodal_derivatives(p->step.result.slow, expansion_node(i, s, &weight), x);
        const double depth = -p->from->shape.side * x[0];
        sum += weight * depth * sqrt(depth) * x[1] * x[1] / p->step.half;
    }
    return p->from->hertz_stiffness * p->from->chi * sum;
}

/* Turns a vector of the step's frame into the world. */
static struct vec3 step_in_world(const struct pair_collocation *p, struct vec3 a)
{
    const struct vec3 *frame = p->step.from.rim.frame;
    return vec3_axpy(vec3_axpy(vec3_scale(a.x, frame[0]), a.y, frame[1]), a.z, frame[2]);
}

struct pair_change pair_collocation_advance(const void *pair_collocation, double s)
{
    const struct pair_collocation *p = pair_collocation;
    const struct contact_pair *from = p->from;
    const struct collocation_change step = collocation_change_at(&p->step, s);
    const struct collocation_problem *start = &p->step.from;
    const double time = p->step.half * s;
    const struct vec3 r = vec3_axpy(step.moved, -time, path_at(start->flown, SEPARATION_DEGREE, time));
    const struct vec3 flown = flight_displacement(start->acceleration, COLLOCATION_ACCELERATION_TERMS, time);
    struct pair_change change = {.time = time,
                                 .r = step_in_world(p, r),
                                 .r_rate = step_in_world(p, vec3_sub(step.gained, flown)),
                                 .gap = from->shape.side * step.deviation};
    if (SCENE_ANY_HERTZ && p->from->hertz_stiffness > 0.0) {
        change.head_on = from->is_head_on;
        change.gap_rate = from->shape.side * step.rate / p->step.half;
        change.dissipated = quasi_static_dissipated(p, s);
    } else if (from->coefficients.c > 0.0) {
        change.dissipated = from->reduced_mass * collocation_dissipated(&p->step, s);
    }
    return change;
}

/* r is c - c(0) less C - C(0), whose moments follow term by term. */
void pair_collocation_moments(const void *pair_collocation, double s, const struct pair_change *change,
                              int count, struct vec3 *moment)
{
    const struct pair_collocation *p = pair_collocation;
    double power = change->time; /* t^(j + 1) */
    for (int j = 0; j < count; ++j) {
        double part = power;
        moment[j] = collocation_moment(&p->step, j, s);
        for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
            part *= change->time;
            moment[j] = vec3_axpy(moment[j], -part / (i + j + 1), p->step.from.flown[i - 1]);
        }
        moment[j] = step_in_world(p, moment[j]);
        power *= change->time;
    }
}

/* Sets the frame and the start of a collocated step, and the flight in this frame. A centre and the axis of a
 * cylinder are circles of radius zero about the direction across the plane in which n begins to turn; the
 * flight has no part out of this plane if that part is rounding. */
static void take_frame(struct pair_timescales *out, const struct contact_pair *p,
                       const struct frame_flight *flight)
{
    const bool at_rim = contact_is_circle(&p->shape);
    const double d = out->problem.reach + out->problem.deviation;
    out->problem.head_on = flight->head_on;
    for (int i = 0; i < SEPARATION_DEGREE; ++i) {
        const double *c = flight->c[i + 1];
        out->problem.flown[i] =
            at_rim ? vec3_from(c) : vec3_make(c[0], flight->dimensions > 2 ? c[2] : 0.0, c[1]);
    }
    for (int i = 0; i < COLLOCATION_ACCELERATION_TERMS; ++i) {
        out->problem.acceleration[i] = vec3_scale((i + 1) * (i + 2), out->problem.flown[i + 1]);
    }
    out->problem.rim =
        at_rim ? flight->rim
               : (struct rim_start){.frame = {flight->frame[0], flight->frame[2], flight->frame[1]},
                                    .distance = d,
                                    .rho = d,
                                    .cosine = 1.0,
                                    .azimuth_momentum = d * out->problem.flown[0].z,
                                    .tilt_momentum = -d * out->problem.flown[0].y};
}

void pair_timescales_make(struct pair_timescales *out, const struct contact_pair *p,
                          const struct frame_flight *flight)
{
    struct collocation_problem *problem = &out->problem;
    problem->deviation = p->shape.side * p->gap;
    problem->reach = contact_reach(&p->shape);
    if (contact_is_plane(&p->shape)) { /* the penetration may exceed the source's width: keep d > 0 */
        problem->reach = fmax(problem->reach, -2.0 * problem->deviation);
    }
    problem->omega2 = p->coefficients.k / p->reduced_mass;
    problem->damping_rate = p->coefficients.c / p->reduced_mass;
    problem->hertz = p->hertz_stiffness / p->reduced_mass;
    problem->chi = p->chi;
    problem->side = p->shape.side;
    problem->radial = p->shape.side * pair_gap_derivative(p);
    take_frame(out, p, flight);
    const double d = contact_is_plane(&p->shape) ? (double)INFINITY : problem->reach + problem->deviation;
    out->distance = d;
    out->rate_along = vec3_norm(pair_tangential(p, contact_across(&p->shape, p->flight.c[1]))) / d;
    out->tangential_rate = out->rate_along + sqrt(vec3_norm(problem->acceleration[0]) / d);
    const struct oscillator oscillator = {problem->omega2, problem->damping_rate};
    out->rates = oscillator_rates_of(&oscillator);
    out->equilibrium_depth = pair_pressing_load(p) / problem->omega2;
    const double from_equilibrium = problem->deviation + p->shape.side * out->equilibrium_depth;
    out->oscillation = oscillator_envelope_of(&oscillator, from_equilibrium, problem->radial).amplitude;
}

double pair_tangential_rate_within(const struct pair_timescales *scales, double step)
{
    const struct vec3 *acceleration = scales->problem.acceleration;
    double largest = vec3_norm(acceleration[0]);
    for (int i = 1; i <= 2; ++i) {
        largest =
            fmax(largest, vec3_norm(path_at(acceleration, COLLOCATION_ACCELERATION_TERMS, 0.5 * i * step)));
    }
    return scales->rate_along + sqrt(largest / scales->distance);
}

/* A step may exceed the radians asked for by this factor, because they are only an estimate. */
static const double RADIANS_MORE = 1.1;

double pair_step_within(const struct pair_timescales *scales, double longest, double radians)
{
    double step = fmin(longest, radians / scales->tangential_rate);
    while (step * pair_tangential_rate_within(scales, step) > RADIANS_MORE * radians) {
        step *= 0.5;
    }
    return step;
}

/* This struct holds a time that is subtracted, as the context of a root_function. */
struct time_left {
    time_function *time_of;
    const void *of;
    double time;
};

static void time_left_at(const void *time_left, double s, double *value, double *slope)
{
    const struct time_left *left = time_left;
    double time[3];
    left->time_of(left->of, s, time);
    *value = time[0] - left->time;
    *slope = time[1];
}

double pair_place_by(time_function *time_of, const void *of, double time, double end)
{
    const struct time_left left = {time_of, of, time};
    struct root_bracket_end low = {.s = 0.0};
    struct root_bracket_end high = {.s = end};
    time_left_at(&left, low.s, &low.value, &low.slope);
    time_left_at(&left, high.s, &high.value, &high.slope);
    return high.value > 0.0 ? root_between(time_left_at, &left, low, high) : end;
}
