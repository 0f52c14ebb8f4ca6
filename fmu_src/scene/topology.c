#include "scene/topology.h"

#include <stddef.h>
#include <string.h>

bool body_is_free(const struct scene_values *v, int body)
{
    return SCENE_ANY_FREE && body_motion(v, body) == MOTION_FREE;
}

bool body_is_prescribed(const struct scene_values *v, int body)
{
    return SCENE_ANY_PRESCRIBED && body_motion(v, body) == MOTION_PRESCRIBED;
}

bool body_turns_freely(const struct scene_values *v, int body)
{
    return SCENE_ANY_FREE_ROTATION && body_rotation(v, body) == ROTATION_FREE;
}

bool body_turn_is_prescribed(const struct scene_values *v, int body)
{
    return SCENE_ANY_ROTATION && body_rotation(v, body) == ROTATION_PRESCRIBED;
}

bool body_turns(const struct scene_values *v, int body)
{
    return SCENE_ANY_ROTATION && body_rotation(v, body) != ROTATION_NONE;
}

bool contact_rubs(const struct scene_values *v, int contact)
{
    return SCENE_ANY_FRICTION && contact_friction(v, contact) != FRICTION_NONE;
}

bool contact_rubs_elastically(const struct scene_values *v, int contact)
{
    return SCENE_ANY_ELASTIC_FRICTION && contact_friction(v, contact) == FRICTION_ELASTIC;
}

bool contact_turns_or_rubs(const struct scene_values *v, int contact)
{
    return body_turns(v, contact_source(contact)) || body_turns(v, contact_destination(contact)) ||
           contact_rubs(v, contact);
}

/* All choices are none where the bits of all of them together are those of none: asked for so often that no
 * branch is spent on each. */
bool scene_turns(const struct scene_values *v)
{
    _Static_assert((int)ROTATION_NONE == 1 && (int)FRICTION_NONE == 1, "another choice has another bit");
    int choices = 1;
#if SCENE_ANY_FRICTION
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        choices |= contact_friction(v, j);
    }
#endif
#if SCENE_ANY_ROTATION
    for (int i = 0; i < SCENE_BODIES; ++i) {
        choices |= body_rotation(v, i);
    }
#endif
    (void)v;
    return choices != 1;
}

void scene_state_copy(const struct scene_values *v, const struct scene_state *from, struct scene_state *to)
{
#if SCENE_ANY_TURNING
    if (!scene_turns(v)) {
        memcpy(to, from, offsetof(struct scene_state, turning));
        return;
    }
#endif
    (void)v;
    *to = *from;
}

bool contact_is_driven(const struct scene_values *v, int contact)
{
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    return !body_is_free(v, source) && !body_is_free(v, destination) && !body_turns_freely(v, source) &&
           !body_turns_freely(v, destination);
}

bool scene_is_force_element(const struct scene_values *v)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) || body_turns_freely(v, i)) {
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
    return solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN || scene_shares_free_body(v) || scene_turns(v);
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
    const bool source_moves = body_is_free(v, source) || body_turns_freely(v, source);
    const bool destination_moves = body_is_free(v, destination) || body_turns_freely(v, destination);
    return (source_moves && body_is_loaded(q, source, contact)) ||
           (destination_moves && body_is_loaded(q, destination, contact));
#else
    (void)v, (void)q, (void)contact;
    return false;
#endif
}

bool contact_is_foreseen(const struct scene_values *v, const struct scene_state *q, int contact)
{
    return !scene_turns(v) || ((!contact_transmits(q, contact) || contact_is_driven(v, contact)) &&
                               !contact_is_coupled(v, q, contact));
}
