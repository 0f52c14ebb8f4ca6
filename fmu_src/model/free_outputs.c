/* The outputs that only integrated motion has, and their derivatives. */
#include "model/motion.h"
#include "scene/energy.h"
#include "scene/turning_jet.h"

/* Divided, not scaled by 1/window, which is infinite for steps of less than 1e-308 s. */
static struct vec3 mean_of(struct vec3 impulse, double window)
{
    return window > 0.0 ? vec3_make(impulse.x / window, impulse.y / window, impulse.z / window)
                        : vec3_make(0.0, 0.0, 0.0);
}

/* Part of a peak that rounding may change and that is still the same peak: what a contact's force is known to
 * (segment/peak_error.c). */
static const double KNOWN = 1e-6;

static bool peaks_are_known(const struct contact_state *state)
{
    return !(state->record.force_bound > state->peaks.force * (1.0 + KNOWN));
}

const char *motion_unknown(const struct model *m, const struct variable *variable)
{
    const bool is_peak =
        variable->row == ROW_contact_peak_force || variable->row == ROW_contact_peak_penetration;
    if (!is_peak || peaks_are_known(&m->state.motion.contact[variable->element])) {
        return NULL;
    }
    return "in a contact as stiff as this, rounding of gap and speed where it began makes more than 1e-6 of "
           "the "
           "peak (allowed: a smaller penalty factor, or, where the contact is damped, a later communication "
           "step; other outputs can be read)";
}

static double put_history(struct scene_values *v, const struct scene_state *q, int contact)
{
    const struct contact_state *state = &q->contact[contact];
    const struct vec3 impulse = vec3_sub(state->physics.impulse, state->record.impulse_mark);
    const bool touching = state->regime != REGIME_APART;
    const struct vec3 mean = mean_of(impulse, q->step_length);
    put_contact_mean_force(v, contact, mean);
#if SCENE_ANY_TURNING
    const struct contact_torques *torques = &state->torques;
    put_contact_mean_source_torque(
        v, contact, mean_of(vec3_sub(torques->source_impulse, torques->source_mark), q->step_length));
    put_contact_mean_destination_torque(
        v, contact,
        mean_of(vec3_sub(torques->destination_impulse, torques->destination_mark), q->step_length));
#endif
    put_contact_peak_force(v, contact, state->peaks.force);
    put_contact_peak_penetration(v, contact, state->peaks.penetration);
    put_contact_onsets(v, contact, state->record.onsets);
    put_contact_last_onset_time(v, contact, state->record.onset_time);
    put_contact_last_duration(v, contact,
                              touching ? q->clock - state->record.touch_clock : state->record.last_duration);
    const double known = peaks_are_known(state) ? 0.0 : (double)INFINITY;
    return mean.x + mean.y + mean.z + state->peaks.force + known;
}

/* Their sum. Nothing is added where nothing turns or rubs. */
static double put_turning_energies(struct scene_values *v, const struct scene_state *q,
                                   const struct scene_instant *at)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        const double rotational = energy_rotational_of(v, at);
        const double tangential = energy_tangential_of(v, q, at);
        put_energy_rotational(v, rotational);
        put_energy_tangential(v, tangential);
        put_energy_friction(v, q->friction_energy - tangential);
        return rotational + q->friction_energy;
    }
    put_energy_friction(v, q->friction_energy); /* zero but for what an integrator outside says */
    return q->friction_energy;
#else
    (void)v, (void)q, (void)at;
    return 0.0;
#endif
}

static double put_energies(struct scene_values *v, const struct scene_state *q,
                           const struct scene_instant *at)
{
    const double kinetic = energy_kinetic_of(v, at);
    const double potential = energy_potential_of(v, at);
    const double stored = energy_stored(v, q, at);
    put_energy_kinetic(v, kinetic);
    put_energy_potential(v, potential);
    put_energy_contact(v, stored);
    put_energy_dissipated(v, q->dissipated);
    put_energy_external_work(v, q->external_work);
    const double total =
        kinetic + potential + stored + q->dissipated - q->external_work + put_turning_energies(v, q, at);
    put_energy_total(v, total);
    put_solver_steps(v, q->counters.steps);
    put_solver_force_evaluations(v, q->counters.force_evaluations);
    put_solver_events(v, q->counters.events);
    put_solver_rejected_steps(v, q->counters.rejected_steps);
    put_solver_fallbacks(v, q->counters.fallbacks);
    return total;
}

const struct scene_state *motion_shown(const struct scene_values *v, const struct scene_state *q,
                                       struct scene_state *settled)
{
    (void)v, (void)settled;
    return q;
}

double motion_show(struct scene_values *v, const struct scene_state *q, const struct scene_instant *at)
{
    double sum = put_energies(v, q, at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += put_history(v, q, j);
    }
    return sum;
}

double motion_energy(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at)
{
    return scene_is_force_element(v)
               ? 0.0
               : energy_kinetic_of(v, at) + energy_potential_of(v, at) + energy_stored(v, q, at);
}

/* What turns and rubs has of the balance. */
static double turning_balance_term(const struct scene_values *v, const struct scene_jet *along, int order)
{
#if SCENE_ANY_TURNING
    return turning_jet_of_rotational(v, along, order) + along->friction[order];
#else
    (void)v, (void)along, (void)order;
    return 0.0;
#endif
}

static double energy_term(const struct model *m, const struct scene_jet *along, int row, int order)
{
    const struct scene_values *v = &m->state.values;
    const double kinetic = jet_of_kinetic(v, along, order);
    const double potential = jet_of_potential(v, along, order);
    const double stored = jet_of_stored(v, &m->state.motion, along, order);
    switch (row) {
    case ROW_energy_kinetic:
        return kinetic;
    case ROW_energy_potential:
        return potential;
    case ROW_energy_contact:
        return stored;
#if SCENE_ANY_TURNING
    case ROW_energy_rotational:
        return turning_jet_of_rotational(v, along, order);
    case ROW_energy_tangential:
        return turning_jet_of_tangential(v, &m->state.motion, along, order);
    case ROW_energy_friction:
        return along->friction[order] - turning_jet_of_tangential(v, &m->state.motion, along, order);
#endif
    case ROW_energy_dissipated:
        return along->dissipated[order];
    case ROW_energy_external_work:
        return along->external_work[order];
    case ROW_energy_total:
        return kinetic + potential + stored + along->dissipated[order] - along->external_work[order] +
               turning_balance_term(v, along, order);
    default:
        return 0.0;
    }
}

bool motion_jet(const struct model *m, const struct scene_instant *at, const struct scene_jet *along,
                const struct variable *variable, int order, double *term)
{
    const struct contact_state *contact = m->state.motion.contact;
    const int j = variable->element;
    switch (variable->row) {
    case ROW_energy_kinetic:
    case ROW_energy_potential:
    case ROW_energy_contact:
    case ROW_energy_dissipated:
    case ROW_energy_external_work:
    case ROW_energy_total:
    case ROW_energy_rotational:
    case ROW_energy_tangential:
    case ROW_energy_friction:
        *term = energy_term(m, along, variable->row, order);
        return true;
    case ROW_contact_last_duration: /* grows with the time while the bodies touch */
        *term = contact[j].regime != REGIME_APART ? along->time[order] : 0.0;
        return true;
    case ROW_contact_last_onset_time:
        *term = 0.0;
        return true;
    default:
        return motion_jet_of_step(m, at, along, variable, order, term);
    }
}

void motion_jet_of_work(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along)
{
    along->external_work[1] = jet_of_stored(v, q, along, 1);
}
