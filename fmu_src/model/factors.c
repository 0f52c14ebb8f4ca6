/* The penalty factors that the parameters describe. */
#include "contact/factors.h"
#include "contact/hertz_stiffness.h"
#include "model/state.h"

static struct contact_material material_of(const struct scene_values *v, int body)
{
    return (struct contact_material){body_youngs_modulus(v, body), body_poissons_ratio(v, body)};
}

/* k_h of Hertz's theory, or the user's. */
static double hertz_stiffness_of(const struct scene_values *v, const struct scene_state *q, int contact)
{
    if (!scene_is_hertz(v, contact) || contact_penalty_control(v, contact) != PENALTY_CONTROL_AUTOMATIC) {
        return contact_hertz_stiffness(v, contact);
    }
    const struct contact_shape shape = scene_whole_shape(v, q, contact); /* one for all zones: of the side */
    return hertz_stiffness(&shape, hertz_modulus(material_of(v, contact_source(contact)),
                                                 material_of(v, contact_destination(contact))));
}

static struct contact_factors factors_of(const struct scene_values *v, const struct scene_state *q,
                                         int contact)
{
    return (struct contact_factors){
        .law = scene_is_hertz(v, contact) ? LAW_HERTZ : LAW_LINEAR,
        .hertz_stiffness = hertz_stiffness_of(v, q, contact),
        .hunt_crossley_factor = contact_hunt_crossley_factor(v, contact),
        .method = (enum method)contact_method(v, contact),
        .penalty_control = (enum penalty_control)contact_penalty_control(v, contact),
        .viscous_control = (enum viscous_control)contact_viscous_control(v, contact),
        .multiplier = contact_penalty_multiplier(v, contact),
        .penalty_factor = contact_penalty_factor(v, contact),
        .characteristic_time = contact_characteristic_time(v, contact),
        .viscous_penalty_factor = contact_viscous_penalty_factor(v, contact),
        .reference_modulus = contact_reference_modulus(v, contact),
        .restitution = contact_restitution(v, contact),
        .inverse_mass = scene_inverse_mass(v, contact)};
}

struct contact_coefficients model_factors(const struct scene_values *v, const struct scene_state *q,
                                          int contact)
{
    const struct contact_factors factors = factors_of(v, q, contact);
    const struct contact_law law = contact_law_of(&factors, (enum dashpot)contact_dashpot(v, contact),
                                                  q->contact[contact].parameters.diagonal);
    return contact_factors_of(&law);
}

struct contact_law model_law_slope(const struct model *m, int contact, double diagonal_slope)
{
    const struct contact_factors factors = factors_of(&m->state.values, &m->state.motion, contact);
    return contact_law_slope(&factors, m->state.motion.contact[contact].parameters.factors, diagonal_slope);
}
