#include "dynamics/involved.h"

bool body_is_free(const struct scene_values *v, int body)
{
    return SCENE_ANY_FREE && body_motion(v, body) == MOTION_FREE;
}

bool body_is_prescribed(const struct scene_values *v, int body)
{
    return SCENE_ANY_PRESCRIBED && body_motion(v, body) == MOTION_PRESCRIBED;
}

bool contact_is_held(const struct scene_values *v, int contact)
{
    return !body_is_free(v, contact_source(contact)) && !body_is_free(v, contact_destination(contact));
}

bool system_is_force_element(const struct scene_values *v)
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

bool system_shares_free_body(const struct scene_values *v)
{
    for (int i = 0; SCENE_CONTACTS > 1 && i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i) && contacts_of(i) > 1) {
            return true;
        }
    }
    return false;
}

bool contact_transmits(const struct motion *q, int contact)
{
    return q->contact[contact].regime == REGIME_PRESSING || q->contact[contact].regime == REGIME_RECEDING;
}

bool system_is_apart(const struct motion *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (q->contact[j].regime != REGIME_APART) {
            return false;
        }
    }
    return true;
}

bool body_is_pressed(const struct motion *q, int body, int except)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const bool touches = contact_source(j) == body || contact_destination(j) == body;
        if (j != except && touches && contact_transmits(q, j)) {
            return true;
        }
    }
    return false;
}

bool contact_is_coupled(const struct scene_values *v, const struct motion *q, int contact)
{
#if SCENE_CONTACTS > 1
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    return (body_is_free(v, source) && body_is_pressed(q, source, contact)) ||
           (body_is_free(v, destination) && body_is_pressed(q, destination, contact));
#else
    (void)v, (void)q, (void)contact;
    return false;
#endif
}
