#include "scene/scene_jet.h"

#include <string.h>

void jet_of_contacts(const struct scene_values *v, const struct scene_state *q,
                     const struct scene_instant *at, struct scene_jet *along)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_shape shape = scene_contact_shape(v, q, j);
        const struct contact_law law = scene_contact_law(v, q, j);
        const enum contact_regime regime = (enum contact_regime)q->contact[j].regime;
        struct vec3 c[JET_TERMS];
        struct vec3 w[JET_TERMS];
        for (int i = 0; i < JET_TERMS; ++i) {
            c[i] = vec3_sub(along->displacement[contact_destination(j)][i],
                            along->displacement[contact_source(j)][i]);
            w[i] =
                vec3_sub(along->velocity[contact_destination(j)][i], along->velocity[contact_source(j)][i]);
        }
        contact_jet_make(&shape, &at->geometry[j], c, w, &law, &along->law_slope[j], regime,
                         &along->contact[j]);
    }
}

#if SCENE_ANY_FREE
/* d/dt of a path of three coefficients. */
static struct vec3 path_slope(const struct vec3 *path, double clock)
{
    return vec3_axpy(path[1], 2.0 * clock, path[2]);
}

/* Half the jerk of a free body: the acceleration changes with the external force and the contact forces. */
static struct vec3 half_jerk(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_jet *along, int body)
{
    struct vec3 force = path_slope(q->path[body].force, q->clock);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct vec3 source_force = along->contact[j].source_force[1];
        const int sign = (contact_source(j) == body) - (contact_destination(j) == body);
        force = vec3_axpy(force, sign, source_force);
    }
    return vec3_scale(0.5 / body_mass(v, body), force);
}

/* Power of the external forces on free bodies, and of whatever moves the prescribed ones against the
 * contacts. */
static double external_power(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_jet *along, int order)
{
    double power = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const struct vec3 *path = q->path[i].force;
            const struct vec3 force[2] = {path_at(path, 3, q->clock), path_slope(path, q->clock)};
            power += jet_dot(force, along->velocity[i], order);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct vec3 *force = along->contact[j].source_force;
        if (body_is_prescribed(v, contact_source(j))) {
            power -= jet_dot(force, along->velocity[contact_source(j)], order);
        }
        if (body_is_prescribed(v, contact_destination(j))) {
            power += jet_dot(force, along->velocity[contact_destination(j)], order);
        }
    }
    return power;
}

static double dissipated_power(const struct scene_values *v, const struct scene_state *q,
                               const struct scene_jet *along, int order)
{
    double power = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_jet *contact = &along->contact[j];
        const struct contact_law law = scene_contact_law(v, q, j);
        power += contact_dissipated_term(&law, (enum contact_regime)q->contact[j].regime,
                                         contact->normal_force, contact->gap, contact->gap_rate, order);
    }
    return power;
}
#endif

void jet_in_time(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                 struct scene_jet *along)
{
    memset(along, 0, sizeof *along);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        along->displacement[i][0] = at->displacement[i];
        along->displacement[i][1] = at->velocity[i];
        along->displacement[i][2] = vec3_scale(0.5, at->acceleration[i]);
        along->velocity[i][0] = at->velocity[i];
        along->velocity[i][1] = at->acceleration[i];
        along->velocity[i][2] = q->path[i].velocity[2];
    }
#if SCENE_ANY_FREE
    jet_of_contacts(v, q, at, along);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            along->velocity[i][2] = half_jerk(v, q, along, i);
        }
    }
#endif
    jet_of_contacts(v, q, at, along);
#if SCENE_ANY_FREE
    for (int i = 1; i < JET_TERMS; ++i) {
        along->dissipated[i] = dissipated_power(v, q, along, i - 1) / i;
        along->external_work[i] = external_power(v, q, along, i - 1) / i;
    }
#endif
}

#if SCENE_ANY_FREE
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
#endif
