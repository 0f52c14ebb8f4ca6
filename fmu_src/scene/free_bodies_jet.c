/* The jet of free bodies in time, and of what depends on it. */
#include "scene/free_bodies.h"
#include "scene/turning_jet.h"

/* d/dt of a path of three coefficients. */
static struct vec3 path_slope(const struct vec3 *path, double clock)
{
    return vec3_axpy(path[1], 2.0 * clock, path[2]);
}

struct vec3 free_bodies_half_jerk(const struct scene_values *v, const struct scene_jet *along, int body)
{
    struct vec3 force = along->force[body];
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct vec3 source_force = along->contact[j].source_force[1];
        const int sign = (contact_source(j) == body) - (contact_destination(j) == body);
        force = vec3_axpy(force, sign, source_force);
    }
    return vec3_scale(0.5 / body_mass(v, body), force);
}

double free_bodies_external_power(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_jet *along, int order)
{
    double power = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const struct vec3 force[2] = {path_at(q->path[i].force, 3, q->clock), along->force[i]};
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
#if SCENE_ANY_TURNING
    power += scene_turns(v) ? turning_jet_external_power(v, q, along, order) : 0.0;
#endif
    return power;
}

double free_bodies_dissipated_power(const struct scene_values *v, const struct scene_state *q,
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

bool free_bodies_put_jerk(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            along->force[i] = path_slope(q->path[i].force, q->clock);
            along->velocity[i][2] = free_bodies_half_jerk(v, along, i);
        }
    }
    return !scene_is_force_element(v);
}

void free_bodies_put_work(const struct scene_values *v, const struct scene_state *q, struct scene_jet *along)
{
    along->time[1] = 1.0;
    for (int i = 1; i < JET_TERMS; ++i) {
        along->dissipated[i] = free_bodies_dissipated_power(v, q, along, i - 1) / i;
        along->external_work[i] = free_bodies_external_power(v, q, along, i - 1) / i;
#if SCENE_ANY_TURNING
        along->friction[i] = turning_jet_friction_power(v, along, i - 1) / i;
#endif
    }
}
