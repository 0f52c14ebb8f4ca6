#include "scene/energy.h"

#include "scene/turning.h"

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

#if SCENE_ANY_TURNING
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
#if SCENE_ANY_FRICTION
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_rubs_elastically(v, j) && q->contact[j].regime != (int32_t)REGIME_APART) {
            const struct friction_law law = scene_friction_law(v, q, j);
            const struct friction_state rubbing = {at->normal_force[j], at->turning.slip[j],
                                                   q->turning.spring[j]};
            sum += friction_stored_energy(&law, (enum friction_regime)q->contact[j].friction_regime, rubbing);
        }
    }
#else
    (void)v, (void)q, (void)at;
#endif
    return sum;
}
#endif

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
