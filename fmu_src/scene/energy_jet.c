#include "scene/energy_jet.h"

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
