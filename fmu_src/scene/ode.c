#include <float.h>
#include <math.h>
#include <string.h>

#include "contact/slopes.h"
#include "scene/evaluate.h"
#include "scene/ode.h"
#include "scene/scene_jet.h"

enum { BODY_STATES = 6 };

/* Returns the index in y of the next `count` states; returns -1 where they are not wanted. */
static int take_states(bool wanted, int count, struct ode_layout *layout)
{
    layout->size += wanted ? count : 0;
    return wanted ? layout->size - count : -1;
}

/* Whether a body that touches nothing flies by a closed form of the clock, and a contact that is apart does
 * not see how the body is turned. */
static bool flies_unseen(const struct scene_state *q, int body, int contact)
{
    if (!body_turns_freely(q->v, body)) {
        return true;
    }
    return !body_is_compound(body) && path_rests(q->path[body].torque) &&
           !(body_tips(q->v, body) && contact_is_coupled(q, contact));
}

/* Sets which bodies have states: all that move where `q` is NULL, else those in contact. */
static void find_bodies(const struct scene_values *v, const struct scene_state *q, bool has[SCENE_BODIES])
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        has[i] = body_moves_freely(v, i) && (SCENE_CONTACTS == 1 || q == NULL);
    }
    for (int k = 0; SCENE_CONTACTS > 1 && q != NULL && k < 2 * SCENE_CONTACTS; ++k) {
        const int j = k / 2;
        const int body = k % 2 == 0 ? contact_source(j) : contact_destination(j);
        const bool apart = q->contact[j].regime == (int32_t)REGIME_APART;
        has[body] = has[body] || (body_moves_freely(v, body) && !(apart && flies_unseen(q, body, j)));
    }
}

/* Writes the number of the group of each body to `of_body`, and that of each contact to layout->island. A
 * group is an island, whose contacts share free bodies, or a single body that belongs to no island. */
static void find_groups(const struct scene_state *q, int of_body[SCENE_BODIES], struct ode_layout *layout)
{
    if (SCENE_CONTACTS == 1 || q == NULL) {
        layout->groups = 1;
        memset(of_body, 0, SCENE_BODIES * sizeof *of_body);
        memset(layout->island, 0, sizeof layout->island);
        return;
    }
    const struct islands islands = scene_islands(q);
    layout->groups = islands.count;
    memset(of_body, -1, SCENE_BODIES * sizeof *of_body);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        layout->island[j] = islands.of[j];
        for (int end = 0; end < 2 && islands.of[j] >= 0; ++end) {
            of_body[end == 0 ? contact_source(j) : contact_destination(j)] = islands.of[j];
        }
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        of_body[i] = of_body[i] < 0 ? layout->groups++ : of_body[i];
    }
}

struct ode_layout ode_layout_of(const struct scene_values *v, const struct scene_state *q)
{
    struct ode_layout layout;
    int of_body[SCENE_BODIES];
    bool has[SCENE_BODIES];
    layout.size = 0;
    find_bodies(v, q, has);
    find_groups(q, of_body, &layout);
    memset(layout.spring, -1, sizeof layout.spring);
    memset(layout.spin, -1, sizeof layout.spin);
    for (int group = 0; group < layout.groups; ++group) { /* the states on which rates of others depend */
        for (int i = 0; i < SCENE_BODIES; ++i) {
            if (of_body[i] == group) {
                layout.body[i] = take_states(has[i] && body_is_free(v, i), BODY_STATES, &layout);
                layout.spin[i] = take_states(has[i] && body_turns_freely(v, i), 3, &layout);
                layout.orientation[i] = take_states(layout.spin[i] >= 0 && body_tips(v, i), 4, &layout);
            }
        }
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            for (int i = 0; layout.island[j] == group && i < OPPOSED; ++i) {
                layout.spring[j][i] = take_states(contact_has_spring(v, j, i), 3, &layout);
            }
        }
        layout.group_end[group] = layout.size;
    }
    layout.coupled = layout.size;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout.spin[i] >= 0 && !body_tips(v, i)) {
            layout.orientation[i] = take_states(true, 4, &layout);
        }
    }
    layout.integrals = layout.size;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        layout.met[j] = SCENE_CONTACTS == 1 || q == NULL || q->contact[j].regime != (int32_t)REGIME_APART ||
                        has[contact_source(j)] || has[contact_destination(j)];
        layout.impulse[j] = take_states(layout.met[j], ode_impulses(v), &layout);
    }
    layout.dissipated = take_states(true, scene_turns(v) ? 3 : 2, &layout);
    return layout;
}

/* Reads the rotation of a body from y, whose orientation may have any length. The orientation of a body that
 * does not tip is read only if `all` are wanted. */
static void read_turn(const struct scene_ode *ode, const double *y, int body, bool all,
                      struct body_turn *turn)
{
    const int orientation = ode->layout.orientation[body];
    const struct vec3 spin = vec3_from(y + ode->layout.spin[body]);
    const bool tips = orientation < ode->layout.coupled;
    if (all || tips) {
        turn->orientation = quaternion_unit(quaternion_from(y + orientation));
    }
    turn->angular_velocity = tips ? body_rotation_of(ode->values, body, turn->orientation, spin)
                                  : body_part_that_turns(ode->values, body, spin);
}

/* Sets the sizes of the components of a vector in y to its length, or to `least` if this is larger. */
static void set_size(const double *y, int index, double least, double *sizes)
{
    for (int k = 0; index >= 0 && k < 3; ++k) {
        sizes[index + k] = fmax(vec3_norm(vec3_from(y + index)), least);
    }
}

/* Sets the event functions of friction without offsets. */
static void friction_events(const struct scene_instant *at, int contact, const struct turning_laws *laws,
                            double *out)
{
    if (!SCENE_ANY_FRICTION) {
        return; /* `out` has no room for events of friction */
    }
    const bool sticks = contact_has_springs(at->v, contact);
    const double force_rate = sticks ? turning_normal_force_rate(at, contact) : 0.0;
    for (int i = 0; i < contact_opposed(at->v, contact); ++i) {
        const struct friction_state rubbing = turning_rubbing(at, contact, i);
        out[ode_stick_event(i)] =
            friction_stick_event(&laws->rubbing[i], laws->rubbing_regime[i], rubbing, force_rate);
        if (i == OPPOSED_SLIP) {
            out[ODE_EVENT_CAP] = friction_cap_event(&laws->rubbing[i], laws->rubbing_regime[i], rubbing);
        }
    }
    if (contact_may_pull(&laws->normal)) {
        const struct contact_geometry *g = &at->geometry[contact];
        const double push = contact_push(&laws->normal, g->gap, g->gap_rate);
        out[ODE_EVENT_LIFT] = laws->rubbing_regime[OPPOSED_SLIP] == FRICTION_LIFTED ? -push : push;
    }
}

/* Sets the events of the gap and the law. Closed forms foresee all changes of a contact that is apart, and
 * where nothing turns the passage of a cylinder's end, unless another contact acts on its bodies.
 *
 * A contact ends where its depth falls through zero. Between the ends of a cylinder, at the axial position
 * z [m], the depth is multiplied by (h^2 - z^2) / (2 h^2) with h = L/2. The minimum of the depth and of the
 * distance from the ends would have a corner, which the polynomial of a long step cannot follow. */
static void contact_events(const struct scene_ode *ode, const struct scene_instant *at, int contact,
                           double out[ODE_EVENTS_EACH])
{
    const double *offset = ode->offset[contact];
    const enum contact_regime regime = (enum contact_regime)ode->state->contact[contact].regime;
    const bool is_coupled = contact_is_coupled(ode->state, contact);
    const struct contact_geometry *g = &at->geometry[contact];
    if (!is_coupled && !contact_pushes(ode->state, contact)) {
        return;
    }
    const bool has_ends = SCENE_ANY_ENDS && (is_coupled || scene_turns(ode->values));
    const double half = has_ends ? scene_whole_shape(ode->state, contact).half_length : (double)INFINITY;
    const double z = SCENE_ANY_ENDS ? fabs(g->axial) : 0.0;
    if (regime == REGIME_APART) {
        out[ODE_EVENT_GAP] = offset[ODE_EVENT_GAP] + fmax(g->gap, z - half);
    } else {
        const struct contact_law law = scene_contact_law(ode->state, contact);
        const double depth = offset[ODE_EVENT_GAP] - g->gap;
        const double within = (half - z) * 0.5 * (1.0 + z / half);
        out[ODE_EVENT_GAP] = isfinite(half) ? depth * (offset[ODE_EVENT_GAP] + within) / half : depth;
        out[ODE_EVENT_LAW] = offset[ODE_EVENT_LAW] + contact_event(&law, regime, g->gap, g->gap_rate);
    }
}

void turning_friction_events(const struct scene_instant *at, int contact, double tolerated, double relative,
                             double absolute, double offset[ODE_EVENTS_EACH], double events[ODE_EVENTS_EACH])
{
    if (!SCENE_ANY_FRICTION) {
        return;
    }
    const struct turning_laws laws = turning_laws_of(at->q, contact);
    const double force = at->normal_force[contact];
    const struct contact_geometry *g = &at->geometry[contact];
    const double by_rate = contact_force_slopes(&laws.normal, laws.regime, g->gap, g->gap_rate).by_rate;
    const double of_force = rounding_of_force(at, contact);
    const double rounding = 8.0 * DBL_EPSILON * fabs(force) + of_force + fabs(by_rate) * tolerated;
    for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
        events[i] = 1.0;
    }
    memset(offset + ODE_EVENT_STICK, 0, (ODE_EVENT_ZONE - ODE_EVENT_STICK) * sizeof *offset);
    for (int i = 0; i < contact_opposed(at->v, contact); ++i) {
        const struct friction_law *law = &laws.rubbing[i];
        const double limit = fabs(friction_limit(law, laws.rubbing_regime[i], force));
        const double of_limit = law->static_coefficient * of_force + 8.0 * DBL_EPSILON * limit; /* [N] */
        const double of_motion =
            i == OPPOSED_SLIP ? tolerated : relative * turning_spin_size(at, contact) + absolute;
        const bool is_force = friction_compares_forces(law, laws.rubbing_regime[i]);
        offset[ode_stick_event(i)] = 2.0 * (is_force ? law->damping * of_motion + of_limit : of_motion);
    }
    offset[ODE_EVENT_CAP] = laws.rubbing_regime[OPPOSED_SLIP] == FRICTION_STICKING
                                ? offset[ODE_EVENT_STICK]
                                : 2.0 * laws.rubbing[OPPOSED_SLIP].coefficient * rounding;
    /* the error of contact_push, which is F_n, or its factor under Hertz's law */
    offset[ODE_EVENT_LIFT] =
        2.0 *
        (contact_is_hertz(&laws.normal) ? 8.0 * DBL_EPSILON + laws.normal.damping * tolerated : rounding);
    friction_events(at, contact, &laws, events);
    for (int i = ODE_EVENT_STICK; i < ODE_EVENT_ZONE; ++i) {
        events[i] += offset[i];
    }
}

/* Where the bodies are at relative rest, n takes the direction of the acceleration by other contacts. No
 * other direction persists, because the contact's own force acts along c. */
void ode_leave_centres(struct scene_state *q)
{
    if (!SCENE_ANY_CURVED) {
        return;
    }
    struct scene_instant at;
    const struct vec3 none = {0.0, 0.0, 0.0};
    scene_now(q, &at);
    for (int k = 0; k < 2 * SCENE_CONTACTS; ++k) { /* in the first round by velocities only */
        const int j = k % SCENE_CONTACTS;
        const bool loaded = k >= SCENE_CONTACTS;
        if (at.geometry[j].degenerate && (!loaded || contact_is_coupled(q, j))) {
            const struct contact_shape shape = scene_contact_shape(q, j);
            scene_now(q, &at); /* the direction of one contact changes the forces on the next */
            const struct vec3 all =
                vec3_sub(at.acceleration[contact_destination(j)], at.acceleration[contact_source(j)]);
            const struct vec3 by_others = /* [m/s^2] */
                loaded ? vec3_axpy(all, scene_inverse_mass(q->v, j), at.source_force[j]) : none;
            q->contact[j].physics.normal =
                singularity_escape(&shape, at.rate[j], by_others, q->contact[j].physics.normal);
        }
    }
}

/* The gap's offset is twice its rounding bound, because the gap at the start may itself be wrong by one
 * bound. rounding_margin_offset (scene/evaluate.h) gives the reasons for the law's offset. */
void ode_begin(struct scene_ode *ode, const struct scene_instant *at, double relative, double absolute)
{
    const struct scene_values *v = ode->values;
    const struct scene_energies energy = scene_energies_of(at);
    double lightest = (double)INFINITY; /* mass of a body that moves or turns freely [kg] */
    for (int i = 0; i < SCENE_BODIES; ++i) {
        lightest = body_moves_freely(v, i) ? fmin(lightest, body_mass(v, i)) : lightest;
    }
    ode->energy_scale = energy.kinetic + energy.stored + energy.rotational;
    ode->momentum_scale =
        sqrt(2.0 * lightest * ode->energy_scale); /* the lightest body has it with all energy */
    memset(ode->offset, 0, sizeof ode->offset);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double tolerated = relative * vec3_norm(at->rate[j]) + absolute;
        double *offset = ode->offset[j];
        offset[ODE_EVENT_GAP] = 2.0 * rounding_of_gap(at, j);
        offset[ODE_EVENT_LAW] = rounding_margin_offset(at, j, tolerated);
        if (SCENE_ANY_ZONES) {
            const double outside = fmax(-zones_margin(at, j), 0.0);
            offset[ODE_EVENT_ZONE] = offset[ODE_EVENT_GAP] + 2.0 * outside;
        }
        if (SCENE_ANY_FRICTION && contact_rubs(v, j) && contact_transmits(ode->state, j)) {
            double events[ODE_EVENTS_EACH];
            turning_friction_events(at, j, tolerated, relative, absolute, offset, events);
            for (int i = ODE_EVENT_STICK; i < ODE_EVENT_ZONE; ++i) { /* each event starts above zero */
                offset[i] += 2.0 * fmax(-events[i], 0.0);
            }
        }
    }
}

/* Copies `count` numbers of the state into y, or from y into the state. */
static void copy_numbers(bool packs, double *y, void *state, size_t count)
{
    memcpy(packs ? y : state, packs ? state : y, count * sizeof *y);
}

/* Copies states into y or from y: all but the rotations, which y holds in another form than q. */
static void copy_states(const struct scene_ode *ode, bool packs, struct scene_state *q, double *y)
{
    const struct ode_layout *layout = &ode->layout;
    const size_t impulses = (size_t)ode_impulses(ode->values);
    const size_t energies = (size_t)(layout->size - layout->dissipated); /* q holds them one after another */
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout->body[i] >= 0) {
            copy_numbers(packs, y + layout->body[i], &q->body[i], BODY_STATES);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        for (int i = 0; i < OPPOSED; ++i) {
            if (layout->spring[j][i] >= 0) {
                copy_numbers(packs, y + layout->spring[j][i], &q->turning.spring[j][i], 3);
            }
        }
        if (layout->met[j]) {
            copy_numbers(packs, y + layout->impulse[j], &q->contact[j].physics.impulse, impulses);
        }
    }
    copy_numbers(packs, y + layout->dissipated, &q->dissipated, energies);
}

void ode_pack(const struct scene_ode *ode, double *y)
{
    const struct ode_layout *layout = &ode->layout;
    copy_states(ode, true, (struct scene_state *)ode->state, y);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (SCENE_ANY_ROTATION && layout->spin[i] >= 0) {
            const struct body_turn *turn = &ode->state->turning.body[i];
            vec3_to(body_spin_of(ode->values, i, turn), y + layout->spin[i]);
            quaternion_to(turn->orientation, y + layout->orientation[i]);
        }
    }
}

void ode_unpack(const struct scene_ode *ode, struct scene_state *q, const double *y)
{
    copy_states(ode, false, q, (double *)y);
    for (int i = 0; SCENE_ANY_ROTATION && i < SCENE_BODIES; ++i) {
        if (ode->layout.spin[i] >= 0) {
            read_turn(ode, y, i, true, &q->turning.body[i]);
        }
    }
}

void ode_other_motion(const struct scene_ode *ode, double clock, struct scene_instant *at)
{
    scene_place_bodies(ode->state, clock, at);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (ode->layout.body[i] < 0 && body_is_free(ode->values, i)) {
            scene_place_body(ode->flight(ode->state, i, clock), i, at);
        }
    }
}

void ode_contact_motion(const struct scene_ode *ode, const double *y, bool all, struct scene_instant *at)
{
    bool touching[SCENE_CONTACTS];
    const struct ode_layout *layout = &ode->layout;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout->body[i] >= 0) {
            const double *state = y + layout->body[i];
            scene_place_body((struct body_state){vec3_from(state), vec3_from(state + 3)}, i, at);
        }
        if (SCENE_ANY_ROTATION && layout->spin[i] >= 0) {
            read_turn(ode, y, i, false, &at->turning.body[i]); /* no contact sees how a sphere is turned */
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        touching[j] = layout->island[j] >= 0;
        for (int i = 0; SCENE_ANY_SPRINGS && i < OPPOSED; ++i) {
            if (layout->spring[j][i] >= 0) {
                at->turning.spring[j][i] = vec3_from(y + layout->spring[j][i]);
            }
        }
    }
    scene_meet(all ? layout->met : touching, at);
}

void ode_instant(const struct scene_ode *ode, double clock, const double *y, struct scene_instant *at)
{
    ode_other_motion(ode, clock, at);
    ode_contact_motion(ode, y, true, at);
    scene_forces(ode->layout.met, at);
}

void ode_rates_without_contact(const struct scene_ode *ode, double clock, double *rates)
{
    const struct scene_values *v = ode->values;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (ode->layout.body[i] >= 0) {
            const struct vec3 force = path_at(ode->state->path[i].force, 3, clock);
            vec3_to(vec3_axpy(gravity(v), 1.0 / body_mass(v, i), force), rates + ode->layout.body[i] + 3);
        }
        if (ode->layout.spin[i] >= 0) {
            const struct vec3 torque = path_at(ode->state->path[i].torque, 3, clock);
            vec3_to(vec3_scale(1.0 / body_inertia_of(v, i).x, torque), rates + ode->layout.spin[i]);
        }
    }
}

struct scene_powers ode_powers(const struct scene_ode *ode, const struct scene_instant *at)
{
    struct scene_powers sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (ode->layout.body[i] >= 0) {
            sum.external += vec3_dot(path_at(ode->state->path[i].force, 3, at->clock), at->velocity[i]);
        }
        if (ode->layout.spin[i] >= 0) {
            const struct vec3 torque = path_at(ode->state->path[i].torque, 3, at->clock);
            sum.external += vec3_dot(torque, at->turning.body[i].angular_velocity);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (ode->layout.met[j]) {
            const struct scene_powers of = scene_powers_of_contact(at, j);
            sum.dissipated += of.dissipated;
            sum.external += of.external;
            sum.friction += of.friction;
        }
    }
    return sum;
}

void ode_rates_at(const struct scene_ode *ode, const double *y, const struct scene_instant *at, double *rates)
{
    const struct scene_values *v = ode->values;
    const struct ode_layout *layout = &ode->layout;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout->body[i] >= 0) {
            vec3_to(at->velocity[i], rates + layout->body[i]);
            vec3_to(at->acceleration[i], rates + layout->body[i] + 3);
        }
        if (SCENE_ANY_ROTATION && layout->spin[i] >= 0) {
            const struct vec3 torque = turning_torque_on(at, i);
            const struct quaternion orientation = quaternion_from(y + layout->orientation[i]);
            vec3_to(vec3_scale(1.0 / body_inertia_of(v, i).x, torque), rates + layout->spin[i]);
            quaternion_to(quaternion_rate(orientation, at->turning.body[i].angular_velocity),
                          rates + layout->orientation[i]);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (!layout->met[j]) {
            continue;
        }
        const struct contact_impulses impulse_rates = scene_impulse_rates(at, j);
        memcpy(rates + layout->impulse[j], &impulse_rates, (size_t)ode_impulses(v) * sizeof *rates);
        for (int i = 0; SCENE_ANY_SPRINGS && i < OPPOSED; ++i) {
            if (layout->spring[j][i] >= 0) {
                vec3_to(turning_spring_rate(at, j, i), rates + layout->spring[j][i]);
            }
        }
    }
    const struct scene_powers power = ode_powers(ode, at);
    memcpy(rates + layout->dissipated, &power, (size_t)(layout->size - layout->dissipated) * sizeof *rates);
}

void ode_rates(const void *scene_ode, double clock, const double *y, double *rates)
{
    struct scene_instant at;
    ode_instant(scene_ode, clock, y, &at);
    ode_rates_at(scene_ode, y, &at, rates);
}

/* An orientation has the size 1. An impulse of torque has at least the size of momentum_scale at the lever
 * arm of the source. */
void ode_nominal(const struct scene_ode *ode, const double *y, double *sizes)
{
    const struct ode_layout *layout = &ode->layout;
    const int impulses = ode_impulses(ode->values);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (layout->body[i] >= 0) {
            set_size(y, layout->body[i], 0.0, sizes);
            set_size(y, layout->body[i] + 3, 0.0, sizes);
        }
        if (layout->spin[i] >= 0) {
            set_size(y, layout->spin[i], 0.0, sizes);
            quaternion_to((struct quaternion){1.0, 1.0, 1.0, 1.0}, sizes + layout->orientation[i]);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double lever = contact_source_radius(ode->values, j) + vec3_norm(contact_source_part(j));
        for (int i = 0; i < OPPOSED; ++i) {
            set_size(y, layout->spring[j][i], 0.0, sizes);
        }
        for (int k = 0; layout->met[j] && k < impulses; k += 3) {
            const double least = k == 0 ? ode->momentum_scale : lever * ode->momentum_scale;
            set_size(y, layout->impulse[j] + k, least, sizes);
        }
    }
    for (int i = layout->dissipated; i < layout->size; ++i) {
        sizes[i] = fmax(fabs(y[i]), ode->energy_scale);
    }
}

/* The Jacobian is the sum of what each contact adds, by the jets of the contact along changes of the states
 * of its bodies and springs. */

struct linearization {
    const struct scene_ode *ode;
    const double *y;
    double *columns;         /* [layout.size][layout.size] */
    struct scene_instant at; /* at y */
    struct scene_jet along;  /* the path, along one state */
};

/* Adds what the change along the path does to a contact, and by it to the rates of its bodies and springs, to
 * a column. */
static void add_contact(struct linearization *l, int contact, int column)
{
    const struct scene_values *v = l->ode->values;
    const struct ode_layout *layout = &l->ode->layout;
    const struct turning_jet *turning = &l->along.turning[contact];
    const struct vec3 force = l->along.contact[contact].source_force[1];
    double *rates = l->columns + column * layout->size;
    for (int end = 0; end < 2; ++end) {
        const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
        if (layout->body[body] >= 0) {
            vec3_add_to((end == 0 ? 1.0 : -1.0) / body_mass(v, body), force, rates + layout->body[body] + 3);
        }
        if (SCENE_ANY_ROTATION && layout->spin[body] >= 0) {
            const struct vec3 *torque = end == 0 ? turning->source_torque : turning->destination_torque;
            vec3_add_to(1.0 / body_inertia_of(v, body).x, body_part_that_turns(v, body, torque[1]),
                        rates + layout->spin[body]);
        }
    }
    for (int i = 0; SCENE_ANY_SPRINGS && i < OPPOSED; ++i) {
        if (layout->spring[contact][i] >= 0) {
            vec3_add_to(1.0, turning_jet_spring_change(&l->at, &l->along, contact, i),
                        rates + layout->spring[contact][i]);
        }
    }
    const struct scene_powers power = jet_powers_of_contact(l->at.q, &l->along, contact, 1);
    double *impulse = rates + layout->impulse[contact];
    vec3_add_to(1.0, force, impulse);
    if (scene_turns(v)) {
        vec3_add_to(1.0, turning->destination_torque[1], impulse + 3);
        vec3_add_to(1.0, turning->source_torque[1], impulse + 6);
        rates[layout->dissipated + 2] += power.friction;
    } else if (SCENE_HAS_TORQUES) {
        vec3_add_to(1.0, vec3_cross(l->at.separation[contact], force), impulse + 3);
    }
    rates[layout->dissipated] += power.dissipated;
    rates[layout->dissipated + 1] += power.external;
}

/* Changes state k of a body's rotation along the path: a component of L / I_1, or of the orientation in y, a
 * quaternion of any length, at constant L / I_1. As the body turns by a vector r, its angular velocity
 * omega = M L / I_1 changes by r x omega - M (r x L / I_1). Writes the change of the orientation's rate. */
static void change_turn(struct linearization *l, int body, int k, double *rates)
{
    const struct scene_values *v = l->ode->values;
    const struct ode_layout *layout = &l->ode->layout;
    const struct body_turn *turn = &l->at.turning.body[body];
    const struct quaternion given = quaternion_from(l->y + layout->orientation[body]);
    struct vec3 *change = &l->along.angular_velocity[body][1];
    *change = body_rotation_of(v, body, turn->orientation, vec3_make(k == 0, k == 1, k == 2));
    if (k >= 3) {
        turning_jet_move_orientation(&l->at, body, given, k - 3, 1.0, &l->along);
        const struct quaternion back = quaternion_inverse(turn->orientation);
        const struct vec3 r =
            vec3_scale(2.0, quaternion_vector(quaternion_product(l->along.orientation[body][1], back)));
        const struct vec3 spin = vec3_from(l->y + layout->spin[body]);
        const struct vec3 turned = body_part_that_turns(v, body, vec3_cross(r, turn->angular_velocity));
        *change = vec3_sub(turned, body_rotation_of(v, body, turn->orientation, vec3_cross(r, spin)));
    }
    const struct quaternion by = {k == 3, k == 4, k == 5, k == 6};
    const struct quaternion own = quaternion_rate(by, turn->angular_velocity);
    quaternion_to(quaternion_axpy(quaternion_rate(given, *change), 1.0, own),
                  rates + layout->orientation[body]);
}

/* Adds the columns of a body: place, velocity, L / I_1 and orientation. */
static void add_columns_of_body(struct linearization *l, int body)
{
    const struct ode_layout *layout = &l->ode->layout;
    struct scene_jet *along = &l->along;
    for (int k = 0; k < BODY_STATES + 7; ++k) {
        const int first = k < BODY_STATES ? layout->body[body] : layout->spin[body];
        if (first < 0) {
            continue;
        }
        const int column =
            k < BODY_STATES + 3 ? first + k % BODY_STATES : layout->orientation[body] + k - BODY_STATES - 3;
        double *rates = l->columns + column * layout->size;
        if (SCENE_ANY_ROTATION && k >= BODY_STATES) {
            change_turn(l, body, k - BODY_STATES, rates);
        } else {
            *vec3_part(k < 3 ? &along->displacement[body][1] : &along->velocity[body][1], k % 3) = 1.0;
            rates[first + k % 3] = k < 3 ? 0.0 : 1.0; /* the rate of a place is a velocity */
        }
        for (int j = 0; j < SCENE_CONTACTS && column < layout->coupled; ++j) {
            if (l->ode->state->contact[j].regime != (int32_t)REGIME_APART &&
                (contact_source(j) == body || contact_destination(j) == body)) {
                jet_of_contact(&l->at, j, scene_turns(l->ode->values), along);
                add_contact(l, j, column);
            }
        }
        along->displacement[body][1] = along->velocity[body][1] = along->angular_velocity[body][1] =
            vec3_make(0.0, 0.0, 0.0);
        along->orientation[body][1] = (struct quaternion){0.0, 0.0, 0.0, 0.0};
    }
}

/* Adds the columns of the springs of a contact. */
static void add_columns_of_springs(struct linearization *l, int contact)
{
    for (int k = 0; SCENE_ANY_SPRINGS && k < 3 * OPPOSED; ++k) {
        const int spring = l->ode->layout.spring[contact][k / 3];
        struct vec3 *input = &l->along.spring[contact][k / 3][1];
        if (spring >= 0) {
            *vec3_part(input, k % 3) = 1.0;
            jet_of_contact(&l->at, contact, true, &l->along);
            add_contact(l, contact, spring + k % 3);
            *input = vec3_make(0.0, 0.0, 0.0);
        }
    }
}

void ode_jacobian(const struct scene_ode *ode, double clock, const double *y, double *columns)
{
    struct linearization l = {.ode = ode, .y = y, .columns = columns};
    const size_t size = (size_t)ode->layout.size;
    memset(columns, 0, size * size * sizeof *columns);
    ode_instant(ode, clock, y, &l.at);
    jet_begin(&l.at, &l.along);
    l.along.terms = 2;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        add_columns_of_body(&l, i);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (ode->state->contact[j].regime != (int32_t)REGIME_APART) {
            add_columns_of_springs(&l, j);
        }
    }
}

/* A tiny negative number takes the place of an event function that is zero. A contact that starts at g = 0
 * then does not end at once, no root is found twice, and CVODE never sees a function that stays at zero,
 * which it rejects. This number is far below any meaningful gap, rate or force, and leaves room for the root
 * finder's products and quotients. */
static const double NOT_ZERO = 1e-100;

void ode_events_at(const struct scene_ode *ode, const struct scene_instant *at, double events[ODE_EVENTS])
{
    const struct scene_values *v = ode->values;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        double *out = events + ODE_EVENTS_EACH * j;
        for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
            out[i] = 1.0;
        }
        if (!ode->layout.met[j]) {
            continue;
        }
        contact_events(ode, at, j, out);
        if (SCENE_ANY_FRICTION && contact_rubs(v, j) && contact_transmits(ode->state, j)) {
            const struct turning_laws laws = turning_laws_of(at->q, j);
            friction_events(at, j, &laws, out);
        }
        if (SCENE_ANY_ZONES) {
            out[ODE_EVENT_ZONE] = zones_margin(at, j);
        }
        for (int i = 0; i < ODE_EVENTS_EACH; ++i) {
            out[i] += i > ODE_EVENT_LAW ? ode->offset[j][i] : 0.0;
            out[i] = fabs(out[i]) < NOT_ZERO ? -NOT_ZERO : out[i];
        }
    }
}

void ode_events(const struct scene_ode *ode, double clock, const double *y, double events[ODE_EVENTS])
{
    struct scene_instant at;
    ode_instant(ode, clock, y, &at);
    ode_events_at(ode, &at, events);
}

enum contact_regime ode_regime_after(const struct scene_state *q, int contact, int event)
{
    const enum contact_regime regime = (enum contact_regime)q->contact[contact].regime;
    if (event > ODE_EVENT_LAW) {
        return regime; /* friction changes, or the contact goes on in the next zone */
    }
    if (event == ODE_EVENT_LAW) {
        const struct contact_law law = scene_contact_law(q, contact);
        return contact_regime_after(&law, regime);
    }
    if (regime != REGIME_APART) {
        return REGIME_APART;
    }
    struct scene_instant at;
    scene_now(q, &at);
    return scene_regime(&at, contact, true);
}

int ode_event_passed(const struct scene_ode *ode, const double *y)
{
    const struct scene_state *q = ode->state;
    double events[ODE_EVENTS];
    struct scene_instant at;
    scene_now(q, &at);
    ode_events(ode, q->clock, y, events);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const bool leaves = (q->contact[j].regime == REGIME_APART) == (at.geometry[j].gap_rate < 0.0);
        if (events[ODE_EVENTS_EACH * j] < 0.0 && leaves) {
            return ODE_EVENTS_EACH * j;
        }
    }
    return -1;
}

/* Whether only gravity and contacts do work on a body. A prescribed body must rest by both of its inputs,
 * displacement and velocity. */
static bool body_is_undriven(const struct scene_state *q, int body)
{
    const struct body_path *path = &q->path[body];
    if (body_is_prescribed(q->v, body)) {
        return path_is_steady(path->displacement, 4) && path_rests(path->velocity);
    }
    return !body_is_free(q->v, body) || path_rests(path->force);
}

/* Whether a contact keeps the energy of its relative motion, and no other contact acts. Bodies that turn do
 * not keep it: they exchange it with rotational energy. */
static bool keeps_energy(const struct scene_state *q, int contact)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (scene_turns(q->v) || contact_transmits(q, j) != (j == contact)) {
            return false;
        }
    }
    const struct contact_law law = scene_contact_law(q, contact);
    return contact_is_elastic(&law) && scene_inverse_mass(q->v, contact) > 0.0 &&
           body_is_undriven(q, contact_source(contact)) && body_is_undriven(q, contact_destination(contact));
}

/* Returns the energy of a contact's relative motion [J], and sets the sum of the sizes of its terms. The
 * potential counts only where one body is not free, because two free bodies fall together. */
static double relative_energy_of(const struct scene_instant *at, int contact, double *terms)
{
    const struct contact_law law = scene_contact_law(at->q, contact);
    const enum contact_regime regime = (enum contact_regime)at->q->contact[contact].regime;
    const double mass = 1.0 / scene_inverse_mass(at->v, contact);
    const bool source_is_free = body_is_free(at->v, contact_source(contact));
    const int body = source_is_free ? contact_source(contact) : contact_destination(contact);
    const bool is_common = source_is_free && body_is_free(at->v, contact_destination(contact));
    const double positive = 0.5 * mass * vec3_dot(at->rate[contact], at->rate[contact]) +
                            contact_stored_energy(&law, regime, at->geometry[contact].gap);
    const double potential = is_common ? 0.0 : -mass * vec3_dot(gravity(at->v), at->displacement[body]);
    *terms = positive + fabs(potential);
    return positive + potential;
}

double projection_balance(const struct scene_instant *at)
{
    double balance = 0.0;
    double terms;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        balance += keeps_energy(at->q, j) ? relative_energy_of(at, j, &terms) : 0.0; /* one at most */
    }
    return balance;
}

/* This is the largest correction of the energy as a fraction of the energy. An integrator's error is smaller,
 * so that a larger difference has another cause. */
static const double LARGEST_CORRECTION = 1e-3;

/* Number of steps whose errors may add up: a contact takes some thousand internal steps at the smallest
 * tolerance. */
static const double MOST_STEPS = 1e4;

/* Nothing is done where the errors and the rounding of all steps do not explain the difference of energy, or
 * where the rounding of its terms explains it. */
void projection_end_contact(struct scene_state *q, int contact, double relative, double absolute)
{
    if (!keeps_energy(q, contact)) {
        return;
    }
    struct scene_instant at;
    double terms;
    scene_now(q, &at);
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const double by_both = scene_inverse_mass(q->v, contact);
    const double gap_rate = at.geometry[contact].gap_rate;
    const double speed = vec3_norm(at.rate[contact]);
    const double missing = q->phase_energy - relative_energy_of(&at, contact, &terms);
    const double error = relative * speed + absolute + 8.0 * DBL_EPSILON * speed; /* of a step [m/s] */
    const double most = fmin(MOST_STEPS * error, LARGEST_CORRECTION * 0.5 * fabs(gap_rate));
    if (!(fabs(missing) > 64.0 * DBL_EPSILON * terms && fabs(missing) <= most * fabs(gap_rate) / by_both)) {
        return;
    }
    /* an impulse j that drives the bodies apart adds the energy j g' + j^2 (1/m_s + 1/m_d) / 2 */
    const double after = copysign(sqrt(gap_rate * gap_rate + 2.0 * missing * by_both), gap_rate);
    const double j = scene_contact_side(q, contact) * 2.0 * missing / (gap_rate + after); /* [N s] */
    const struct vec3 n = at.geometry[contact].normal;
    q->body[source].velocity = vec3_axpy(q->body[source].velocity, -j * body_inverse_mass(q->v, source), n);
    q->body[destination].velocity =
        vec3_axpy(q->body[destination].velocity, j * body_inverse_mass(q->v, destination), n);
    struct vec3 *impulse = &q->contact[contact].physics.impulse.force;
    *impulse = vec3_axpy(*impulse, -j, n);
}
