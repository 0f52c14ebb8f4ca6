/* Where the states of the scene are in the vector y of its differential equations. */
#include "scene/turning_ode.h"

enum { BODY_STATES = 6 };

int ode_body(const struct scene_values *v, int body)
{
    int index = 0;
    for (int i = 0; i < body; ++i) {
        index += body_is_free(v, i) ? BODY_STATES : 0;
    }
    return index;
}

#if SCENE_ANY_TURNING

struct turning_layout turning_layout_of(const struct scene_values *v)
{
    struct turning_layout layout;
    int index = ode_body(v, SCENE_BODIES);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const bool turns = body_turns_freely(v, i);
        layout.spin[i] = turns ? index : -1;
        index += turns ? 3 : 0;
    }
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const bool tips = body_turns_freely(v, i) && body_shape(i) != SHAPE_SPHERE;
        layout.orientation[i] = tips ? index : -1;
        index += tips ? 4 : 0;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const bool springs = contact_rubs_elastically(v, j);
        layout.spring[j] = springs ? index : -1;
        index += springs ? 3 : 0;
    }
    layout.coupled = index;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const bool rolls = body_turns_freely(v, i) && body_shape(i) == SHAPE_SPHERE;
        layout.orientation[i] = rolls ? index : layout.orientation[i];
        index += rolls ? 4 : 0;
    }
    layout.integrals = index;
    return layout;
}

#endif

int ode_impulse(const struct scene_values *v, int contact)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        return turning_layout_of(v).integrals + TURNING_IMPULSES * contact;
    }
#endif
    return ode_body(v, SCENE_BODIES) + 3 * contact;
}

int ode_dissipated(const struct scene_values *v)
{
    return ode_impulse(v, SCENE_CONTACTS);
}

int ode_coupled(const struct scene_values *v)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        return turning_layout_of(v).coupled;
    }
#endif
    return ode_body(v, SCENE_BODIES);
}

int ode_integrals(const struct scene_values *v)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        return turning_layout_of(v).integrals;
    }
#endif
    return ode_body(v, SCENE_BODIES);
}

int ode_size(const struct scene_values *v)
{
    return ode_dissipated(v) + (scene_turns(v) ? 3 : 2);
}

int ode_forces(const struct scene_values *v)
{
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        const int forces = 3 * SCENE_CONTACTS;
        int left = turning_layout_of(v).coupled;
        for (int i = 0; i < SCENE_BODIES; ++i) {
            left -= body_is_free(v, i) ? 3 : 0;
        }
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            left = contact_rubs_elastically(v, j) ? 0 : left; /* springs couple, too */
        }
        return forces < left ? forces : 0;
    }
#endif
    (void)v;
    return 0;
}

int ode_tipping(const struct scene_values *v)
{
    int count = 0;
#if SCENE_ANY_TURNING
    const struct turning_layout layout = turning_layout_of(v);
    for (int i = 0; i < SCENE_BODIES && scene_turns(v); ++i) {
        count += layout.orientation[i] >= 0 && layout.orientation[i] < layout.coupled ? 4 : 0;
    }
#endif
    (void)v;
    return count;
}
