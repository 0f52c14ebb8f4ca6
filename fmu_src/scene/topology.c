#include "scene/topology.h"

bool body_is_free(const struct scene_values *v, int body)
{
    return SCENE_ANY_FREE && body_motion(v, body) == MOTION_FREE;
}

bool body_is_prescribed(const struct scene_values *v, int body)
{
    return SCENE_ANY_PRESCRIBED && body_motion(v, body) == MOTION_PRESCRIBED;
}

bool contact_is_driven(const struct scene_values *v, int contact)
{
    return !body_is_free(v, contact_source(contact)) && !body_is_free(v, contact_destination(contact));
}

bool scene_is_force_element(const struct scene_values *v)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            return false;
        }
    }
    return true;
}

static int contacts_of(int body)
{
    int count = 0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        count += contact_source(j) == body || contact_destination(j) == body;
    }
    return count;
}

bool scene_shares_free_body(const struct scene_values *v)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && contacts_of(i) > 1) {
            return true;
        }
    }
    return false;
}

bool scene_uses_ode(const struct scene_values *v)
{
    return solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN || scene_shares_free_body(v);
}

bool contact_transmits(const struct scene_state *q, int contact)
{
    return q->contact[contact].regime == REGIME_COMPRESSION ||
           q->contact[contact].regime == REGIME_RESTITUTION;
}

bool scene_is_apart(const struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime != REGIME_APART) {
            return false;
        }
    }
    return true;
}

bool body_is_loaded(const struct scene_state *q, int body, int except)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const bool touches = contact_source(j) == body || contact_destination(j) == body;
        if (j != except && touches && contact_transmits(q, j)) {
            return true;
        }
    }
    return false;
}

bool contact_is_coupled(const struct scene_values *v, const struct scene_state *q, int contact)
{
#if SCENE_CONTACTS > 1
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    return (body_is_free(v, source) && body_is_loaded(q, source, contact)) ||
           (body_is_free(v, destination) && body_is_loaded(q, destination, contact));
#else
    (void)v, (void)q, (void)contact;
    return false;
#endif
}
