#include "scene/energy.h"

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
