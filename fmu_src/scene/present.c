#include <float.h>
#include <stdlib.h>

#include "contact/shape.h"
#include "scene/evaluate.h"
#include "scene/present.h"
#include "scene/scene_state.h"

/* A distance below this part of the bodies' size is none. */
static const double CENTRE = 1e-9;

bool singularity_is_reached(const struct scene_values *v, const struct scene_instant *at, int contact,
                            const struct contact_shape *shape)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const double reach = contact_reach(shape);
    if (g->degenerate || !contact_may_reach_centre(shape)) {
        return g->degenerate;
    }
    return reach + g->gap <= 16.0 * DBL_EPSILON * reach ||
           (g->distance <= CENTRE * reach && g->distance <= rounding_of_gap(v, at, contact));
}

struct vec3 singularity_escape(const struct contact_shape *shape, struct vec3 rate, struct vec3 acceleration,
                               struct vec3 held)
{
    const struct vec3 at_rest = contact_escape_direction(shape, acceleration, held);
    return contact_escape_direction(shape, rate, at_rest);
}

void zones_follow(struct scene_state *q, const struct scene_instant *at, int contact)
{
    struct contact_state *state = &q->contact[contact];
    if (state->regime == (int32_t)REGIME_APART) {
        state->zone = 0;
    } else if (SCENE_ANY_CAPS && state->zone == 0) {
        state->zone = at->geometry[contact].zone;
    }
}

/* The rate of the separation as the destination's axis sees it, which may turn. */
static struct vec3 rate_by_axis(const struct scene_values *v, const struct scene_instant *at, int contact)
{
    if (scene_turns(v)) {
        const struct vec3 spin = at->turning.body[contact_destination(contact)].angular_velocity;
        return vec3_sub(at->rate[contact], vec3_cross(spin, at->separation[contact]));
    }
    return at->rate[contact];
}

static bool is_at_rim(int zone)
{
    return abs(zone) == ZONE_RIM;
}

bool zones_pass(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                int contact)
{
    const int zone = q->contact[contact].zone;
    if (!SCENE_ANY_CAPS || zone == 0) {
        return false;
    }
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    const struct vec3 c = at->separation[contact];
    const double rounding = fmax(rounding_of_gap(v, at, contact), fabs(zones_margin(v, q, at, contact)));
    const int next = contact_zone_next(&shape.solid, zone, c, rate_by_axis(v, at, contact), rounding);
    const struct solid_place place = contact_place_at(&shape.solid, c);
    q->contact[contact].zone = next;
    return !(is_at_rim(zone) || is_at_rim(next)) || fmax(fabs(place.radial), fabs(place.axial)) <= rounding;
}

void zones_settle(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                  int contact)
{
    if (SCENE_ANY_CAPS && zones_margin(v, q, at, contact) < -rounding_of_gap(v, at, contact)) {
        const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
        const struct solid_place place = contact_place_at(&shape.solid, at->separation[contact]);
        q->contact[contact].zone = contact_zone_by(&place);
    }
}

double zones_margin(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                    int contact)
{
    const int zone = q->contact[contact].zone;
    if (!SCENE_ANY_CAPS || zone == 0) {
        return NO_ZONE_MARGIN;
    }
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    return contact_zone_margin(&shape.solid, zone, at->separation[contact]);
}

enum zone zones_shown(const struct scene_values *v, const struct scene_state *q,
                      const struct scene_instant *at, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    if (state->regime == (int32_t)REGIME_APART) {
        return ZONE_NONE;
    }
    const struct contact_shape shape = scene_contact_shape_at(v, q, at, contact);
    return contact_is_capped(&shape) ? (enum zone)abs(at->geometry[contact].zone) : ZONE_SIDE;
}

void scene_kinematics_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics(v, q, q->clock, q->body, at);
    if (SCENE_ANY_FREE) {
        scene_put_known_gaps(v, q, at);
    }
}

void scene_now(const struct scene_values *v, const struct scene_state *q, struct scene_instant *at)
{
    scene_kinematics_now(v, q, at);
    scene_forces(v, q, q->clock, at);
}

/* Bounds of the rounding error: positions at different times may be off to either side. */
static const double END_ROUNDINGS = 4.0;

bool scene_shown_within(const struct scene_values *v, const struct scene_state *q,
                        const struct scene_instant *at, int contact, const struct contact_shape *shape)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const bool within = scene_within_extents(shape, g);
    if (!SCENE_ANY_CYLINDER || !isfinite(shape->half_length) ||
        fabs(scene_beyond_ends(shape, g)) > END_ROUNDINGS * rounding_of_axial(v, at, contact, shape)) {
        return within;
    }
    const bool overlaps = g->gap < -rounding_of_gap(v, at, contact);
    return q->contact[contact].regime != (int32_t)REGIME_APART || (within && !overlaps);
}

/* By the law alone, of a contact with this gap, within the destination's extents or not. */
static enum contact_regime regime_by_law(const struct scene_values *v, const struct scene_state *q,
                                         const struct scene_instant *at, int contact, double gap, bool within)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    double rate = g->gap_rate;
    if (singularity_is_reached(v, at, contact, &shape)) {
        const struct vec3 w = at->rate[contact];
        const struct vec3 none = {0.0, 0.0, 0.0};
        rate = shape.side * vec3_dot(singularity_escape(&shape, w, none, none), w);
    }
    return contact_regime_of(&law, gap, rate, within);
}

enum contact_regime scene_regime(const struct scene_values *v, const struct scene_state *q,
                                 const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    return regime_by_law(v, q, at, contact, g->gap, scene_within_extents(&shape, g));
}

enum contact_regime scene_regime_of_touching(const struct scene_values *v, const struct scene_state *q,
                                             const struct scene_instant *at, int contact)
{
    const double gap = fmin(at->geometry[contact].gap, -DBL_MIN); /* rounding may show none */
    return regime_by_law(v, q, at, contact, gap, true);
}

/* The square of the speed at the touch by motion and stored energy alone [m^2/s^2]. */
static double own_speed_squared(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(v, q, contact);
    const double stored = contact_stored_energy(&law, REGIME_COMPRESSION, g->gap);
    return g->gap_rate * g->gap_rate + 2.0 * stored * scene_inverse_mass(v, contact);
}

/*
 * The speed of the onset [m/s]. A load m a presses m x'' = m a - k x^(3/2) from rest to its largest speed
 * where both balance, x_0 = (m a/k)^(2/3), v^2/2 = a x_0 - (2/5) (k/m) x_0^(5/2) = (3/5) a x_0.
 */
static double onset_speed(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at, int contact)
{
    const double per_mass = scene_inverse_mass(v, contact);
    const double speed_squared = own_speed_squared(v, q, at, contact);
    if (!(per_mass > 0.0)) {
        return sqrt(speed_squared);
    }
    const struct contact_law law = scene_contact_law(v, q, contact);
    struct scene_instant apart = *at;
    scene_forces(v, q, q->clock, &apart); /* the contact has no force yet */
    const double a = scene_pressing_acceleration(v, q, q->clock, &apart, contact);
    const double depth = cbrt(pow(a / (contact_factors_of(&law).k * per_mass), 2.0));
    return sqrt(fmax(speed_squared, 1.2 * a * depth));
}

enum contact_regime onset_take_damping(const struct scene_values *v, struct scene_state *q,
                                       const struct scene_instant *at, int contact, enum contact_regime next)
{
    struct contact_state *state = &q->contact[contact];
    if (next == REGIME_APART || state->regime != (int32_t)REGIME_APART) {
        return next;
    }
    const double damping = state->parameters.factors.c / onset_speed(v, q, at, contact);
    state->onset_damping = isfinite(damping) ? damping : 0.0;
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const enum contact_regime deep = scene_regime(v, q, at, contact);
    return deep != REGIME_APART ? deep : contact_regime_of(&law, -DBL_MIN, g->gap_rate, true);
}

/* With 2 v dv = d(v^2), and chi v given. */
double onset_damping_slope(const struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at, int contact, double gap_slope, double rate_slope)
{
    const struct contact_state *state = &q->contact[contact];
    if (!scene_damps_by_onset(v, contact) || state->regime == (int32_t)REGIME_APART ||
        !(state->onset_damping > 0.0)) {
        return 0.0;
    }
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_law law = scene_contact_law(v, q, contact);
    const double speed = state->parameters.factors.c / state->onset_damping;
    const double by_load = 1e-9; /* own speed smaller by more than this part: the load's counts */
    if (own_speed_squared(v, q, at, contact) < (1.0 - by_load) * speed * speed) {
        return 0.0;
    }
    const double stored_slope = contact_stored_slope(&law, REGIME_COMPRESSION, g->gap);
    const double half = g->gap_rate * rate_slope + stored_slope * scene_inverse_mass(v, contact) * gap_slope;
    return -state->onset_damping * half / (speed * speed);
}

/* Moving the origin of the clock to the present. */

/* base + base_tail += clock, by Knuth's two-sum, so that base_tail holds the rounding error exactly. */
static void advance_base(struct scene_state *q)
{
    const double add = q->base_tail + q->clock;
    const double sum = q->base + add;
    const double shadow = sum - q->base;
    q->base_tail = (q->base - (sum - shadow)) + (add - shadow);
    q->base = sum;
    q->clock = 0.0;
}

/* The input paths of a body: those its motion follows. */
static void shift_paths(const struct scene_values *v, struct scene_state *q, int body)
{
    struct body_path *path = &q->path[body];
    if (body_is_prescribed(v, body)) {
        path_shift(path->displacement, 4, q->clock);
        path_shift(path->velocity, 3, q->clock);
    } else if (body_is_free(v, body)) {
        path_shift(path->force, 3, q->clock);
    }
}

/* And those that it turns by. */
static void shift_turning_paths(const struct scene_values *v, struct scene_state *q, int body)
{
    struct body_path *path = &q->path[body];
    if (body_turn_is_prescribed(v, body)) {
        path_shift(path->angular_velocity, 3, q->clock);
        path_shift(path->axis, 3, q->clock);
    } else if (body_turns_freely(v, body)) {
        path_shift(path->torque, 3, q->clock);
    }
}

/* The origins of free bodies become the places where they are. */
static void shift_origins(struct scene_state *q)
{
    q->deferrable_clock = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        q->origin[i].displacement = vec3_add(q->origin[i].displacement, q->body[i].moved);
        q->origin[i].velocity = q->body[i].velocity;
        q->body[i].moved = vec3_make(0.0, 0.0, 0.0);
    }
}

/* The clocks kept of contacts are shifted with the clock. */
static void shift_clocks(struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].record.touch_clock -= q->clock;
        q->contact[j].schedule.change_clock -= q->clock;
        q->contact[j].schedule.dead_band_clock -= q->clock;
        if (q->contact[j].regime == REGIME_APART || q->contact[j].regime == REGIME_SEPARATING) {
            /* Not known where it has flown on to, unless that was foreseen. */
            q->contact[j].physics.accumulated_gap =
                q->contact[j].schedule.change_clock == 0.0 ? q->contact[j].schedule.change_gap : DBL_MAX;
        }
    }
    q->horizon_clock -= q->clock;
}

void scene_rebase(const struct scene_values *v, struct scene_state *q)
{
    const bool turns = scene_turns(v);
    q->integrator_fresh = 1;
    if (SCENE_ANY_FREE) {
        shift_origins(q);
    }
    if (turns) {
        turning_rebase(v, q);
    }
    if (q->clock == 0.0) {
        return;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        shift_paths(v, q, i);
    }
    for (int i = 0; turns && i < SCENE_BODIES; ++i) {
        shift_turning_paths(v, q, i);
    }
    if (SCENE_ANY_FREE) {
        shift_clocks(q);
    }
    advance_base(q);
}

double energy_kinetic_of(const struct scene_values *v, const struct scene_instant *at)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            sum += 0.5 * body_mass(v, i) * vec3_dot(at->velocity[i], at->velocity[i]);
        }
    }
    return sum;
}

double energy_potential_change(const struct scene_values *v, const struct scene_instant *at,
                               struct vec3 more_gravity)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const double centre = vec3_dot(more_gravity, body_center(v, i));
            sum -= body_mass(v, i) * (centre + vec3_dot(more_gravity, at->displacement[i]));
        }
    }
    return sum;
}

double energy_potential_of(const struct scene_values *v, const struct scene_instant *at)
{
    return energy_potential_change(v, at, gravity(v)); /* from none */
}

/* I_t omega^2/2 + (I_a - I_t) (omega.e)^2/2 */
double energy_rotational_of(const struct scene_values *v, const struct scene_instant *at)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_turns_freely(v, i)) {
            const struct body_inertia inertia = body_inertia_of(v, i);
            const struct body_turn *turn = &at->turning.body[i];
            const double axial = vec3_dot(turn->angular_velocity, quaternion_third_axis(turn->orientation));
            sum += 0.5 * inertia.transverse * vec3_dot(turn->angular_velocity, turn->angular_velocity) +
                   0.5 * (inertia.axial - inertia.transverse) * axial * axial;
        }
    }
    return sum;
}

double energy_tangential_of(const struct scene_values *v, const struct scene_state *q,
                            const struct scene_instant *at)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_rubs_elastically(v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
            const struct friction_law law = scene_friction_law(v, q, j);
            const struct friction_state rubbing = {at->normal_force[j], at->turning.slip[j],
                                                   q->turning.spring[j]};
            sum += friction_stored_energy(&law, (enum friction_regime)q->contact[j].friction_regime, rubbing);
        }
    }
    return sum;
}

double energy_stored(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const enum contact_regime regime = (enum contact_regime)q->contact[j].regime;
        if (regime != REGIME_APART) {
            const struct contact_law law = scene_contact_law(v, q, j);
            sum += contact_stored_energy(&law, regime, at->geometry[j].gap);
        }
    }
    return sum;
}

double energy_dissipated_power_of(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    return contact_dissipated_power(&law, (enum contact_regime)q->contact[contact].regime,
                                    at->normal_force[contact], g->gap, g->gap_rate);
}

double energy_dissipated_power(const struct scene_values *v, const struct scene_state *q,
                               const struct scene_instant *at)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += energy_dissipated_power_of(v, q, at, j);
    }
    return sum;
}

double jet_of_kinetic(const struct scene_values *v, const struct scene_jet *along, int order)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            sum += 0.5 * body_mass(v, i) * jet_dot(along->velocity[i], along->velocity[i], order);
        }
    }
    return sum;
}

double jet_of_potential(const struct scene_values *v, const struct scene_jet *along, int order)
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            sum -= body_mass(v, i) * vec3_dot(gravity(v), along->displacement[i][order]);
        }
    }
    return sum;
}

double jet_of_stored(const struct scene_values *v, const struct scene_state *q, const struct scene_jet *along,
                     int order)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_law law = scene_contact_law(v, q, j);
        sum += contact_stored_term(&law, &along->law_slope[j], (enum contact_regime)q->contact[j].regime,
                                   along->contact[j].gap, order);
    }
    return sum;
}

void present_body(struct scene_values *v, int body, struct vec3 displacement, struct vec3 velocity)
{
    put_body_displacement(v, body, displacement);
    put_body_position(v, body, vec3_add(body_center(v, body), displacement));
    put_body_velocity(v, body, velocity);
}

void present_body_now(struct scene_values *v, const struct scene_state *q, int body)
{
    const struct body_instant at = scene_body_now(v, q, body);
    present_body(v, body, at.displacement, at.velocity);
}
