/* The outputs of the present instant: what the model shows, computed from the motion and nothing else. */
#include <math.h>

#include "model/state.h"
#include "scene/energy.h"
#include "segment/flight.h"

static void put_body(struct scene_values *v, int body, struct vec3 displacement, struct vec3 velocity)
{
    put_body_displacement(v, body, displacement);
    put_body_position(v, body, vec3_add(body_center(v, body), displacement));
    put_body_velocity(v, body, velocity);
}

/* x_dst - r_d n for a sphere; for a cylinder the point of its wall nearest to the source: x_src + rho - r_d
 * n. */
static struct vec3 contact_point_of(const struct scene_values *v, const struct scene_instant *at, int contact)
{
    const int source = contact_source(contact);
    const struct contact_geometry *g = &at->geometry[contact];
    const struct vec3 centre = vec3_add(body_center(v, source), at->displacement[source]);
    const double reach = g->distance - body_radius(v, contact_destination(contact));
    return vec3_axpy(centre, reach, g->normal);
}

static void put_force(struct scene_values *v, int contact, double normal_force, struct vec3 source_force)
{
    put_contact_normal_force(v, contact, normal_force);
    put_contact_source_force(v, contact, source_force);
    put_contact_destination_force(v, contact, vec3_scale(-1.0, source_force));
}

/* Numbers within their ranges can still multiply to more than a double holds: these functions return a sum
 * that is finite only if all outputs of theirs are. */
static double put_contact(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                          int contact)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct contact_state *state = &q->contact[contact];
    const struct contact_geometry *g = &at->geometry[contact];
    const enum contact_regime regime = (enum contact_regime)state->regime;
    const bool within = scene_within_extents(&shape, g);
    const double force = contact_normal_force_of(&law, regime, g->gap, g->gap_rate);
    const struct contact_coefficients factors = contact_coefficients_of(&law, REGIME_COMPRESSION);
    put_contact_effective_penalty_factor(v, contact, factors.k);
    put_contact_effective_viscous_penalty_factor(v, contact, factors.c);
    put_contact_diagonal(v, contact, state->diagonal);
    put_contact_gap(v, contact, within ? g->gap : contact_gap_beyond_ends(v, contact));
    put_contact_gap_rate(v, contact, within ? g->gap_rate : 0.0);
    put_contact_distance(v, contact, g->distance);
    put_contact_direction(v, contact, contact_direction_of(&shape, g));
    put_contact_point(v, contact, contact_point_of(v, at, contact));
    put_contact_active(v, contact, regime != REGIME_APART);
    put_contact_within_extents(v, contact, within);
    put_force(v, contact, force, vec3_scale(-shape.side * force, g->normal));
    return force + g->distance + g->gap_rate + factors.k + factors.c;
}

#if SCENE_ANY_FREE
/* Divided, not scaled by 1/window, which is infinite for steps of less than 1e-308 s. */
static struct vec3 mean_of(struct vec3 impulse, double window)
{
    return window > 0.0 ? vec3_make(impulse.x / window, impulse.y / window, impulse.z / window)
                        : vec3_make(0.0, 0.0, 0.0);
}

static double put_history(struct scene_values *v, const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    const struct vec3 impulse = vec3_sub(state->impulse, state->impulse_mark);
    const bool touching = state->regime != REGIME_APART;
    const struct vec3 mean = mean_of(impulse, q->step_length);
    put_contact_mean_force(v, contact, mean);
    put_contact_peak_force(v, contact, state->peak_force);
    put_contact_peak_penetration(v, contact, state->peak_penetration);
    put_contact_onsets(v, contact, state->onsets);
    put_contact_last_onset_time(v, contact, state->onset_time);
    put_contact_last_duration(v, contact, touching ? q->clock - state->touch_clock : state->last_duration);
    return mean.x + mean.y + mean.z + state->peak_force;
}

static double put_world(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at)
{
    const double kinetic = energy_kinetic_of(v, at);
    const double potential = energy_potential_of(v, at);
    const double stored = energy_stored(v, q, at);
    put_energy_kinetic(v, kinetic);
    put_energy_potential(v, potential);
    put_energy_contact(v, stored);
    put_energy_dissipated(v, q->dissipated);
    put_energy_external_work(v, q->external_work);
    const double total = kinetic + potential + stored + q->dissipated - q->external_work;
    put_energy_total(v, total);
    put_solver_steps(v, q->counters.steps);
    put_solver_force_evaluations(v, q->counters.force_evaluations);
    put_solver_events(v, q->counters.events);
    put_solver_rejected_steps(v, q->counters.rejected_steps);
    put_solver_fallbacks(v, q->counters.fallbacks);
    return total;
}
#endif

static void warn_of_missing_direction(struct model *m, const struct scene_instant *at)
{
    struct scene_state *q = &m->state.motion;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (at->geometry[j].degenerate && q->contact[j].regime != REGIME_APART && !q->contact[j].warned) {
            q->contact[j].warned = 1;
            const struct vec3 n = at->geometry[j].normal;
            model_report(
                m, MODEL_WARNING,
                "%s.distance = 0 at %.17g s: the overlapping bodies have no defined normal; the direction "
                "(%g, %g, %g) is used (allowed: distance > 0). Given once.",
                scene_contact_name(j), scene_time(q), n.x, n.y, n.z);
        }
    }
}

static void update_body(struct scene_values *v, const struct scene_state *q, int body)
{
    const struct body_instant at = scene_body_now(v, q, body);
    put_body(v, body, at.displacement, at.velocity);
}

static void update_bodies(struct model *m)
{
    struct scene_values *v = &m->state.values;
#if SCENE_ANY_FREE
    flight_catch_up(v, &m->state.motion);
#endif
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (m->outputs == OUTPUTS_NONE || body_is_free(v, i) || body_is_prescribed(v, i)) {
            update_body(v, &m->state.motion, i);
        }
    }
    m->outputs = OUTPUTS_BODIES;
}

#if SCENE_ANY_FREE
#if SCENE_ANY_PRESCRIBED
/* Apart from model_foresee_reading, which need not save registers for it. */
__attribute__((noinline)) static void show_prescribed(struct scene_values *v, const struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_prescribed(v, i)) {
            update_body(v, q, i);
        }
    }
}
#endif

void model_foresee_reading(struct model *m, double clock)
{
    struct scene_values *v = &m->state.values;
    const struct scene_state *q = &m->state.motion;
    m->outputs = OUTPUTS_BODIES;
    bool all_shown = true;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const struct body_state at = flight_unforced_at(v, q, i, clock);
            put_body(v, i, vec3_add(q->origin[i].displacement, at.moved), at.velocity);
        } else if (body_is_prescribed(v, i)) {
            all_shown = false;
        }
    }
#if SCENE_ANY_PRESCRIBED
    if (!all_shown) {
        show_prescribed(v, q);
    }
#else
    (void)all_shown;
#endif
}
#endif

static void update_all(struct model *m)
{
    struct scene_values *v = &m->state.values;
    struct scene_state *q = &m->state.motion;
    struct scene_instant at;
    double sum = 0.0;
    scene_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (scene_is_force_element(v)) {
            q->contact[j].regime = (int32_t)scene_regime(v, q, &at, j);
        }
        q->contact[j].normal = at.geometry[j].normal;
        sum += put_contact(v, q, &at, j);
#if SCENE_ANY_FREE
        sum += put_history(v, q, j);
#endif
    }
#if SCENE_ANY_FREE
    sum += put_world(v, q, &at);
#endif
    warn_of_missing_direction(m, &at);
    /* What is no number has to be looked at one by one. */
    m->outputs = isfinite(sum) ? OUTPUTS_ALL : OUTPUTS_BODIES;
}

bool model_update_outputs(struct model *m, enum outputs wanted)
{
    if (m->outputs >= wanted) {
        return true;
    }
    if (!m->state.initialized) {
        model_prepare(m);
    } else if (!model_apply_inputs(m)) {
        return false;
    }
    update_bodies(m);
    /* Bodies that overlap may have to be warned of, whatever is asked. */
    if (wanted > OUTPUTS_BODIES || scene_is_force_element(&m->state.values) ||
        !scene_is_apart(&m->state.motion)) {
        update_all(m);
    }
    return true;
}
