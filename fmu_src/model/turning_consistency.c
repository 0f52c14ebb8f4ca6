/* What is refused of bodies that turn at the end of initialization. */
#include "model/shortest.h"
#include "model/state.h"

#if SCENE_ANY_FREE_ROTATION
/* A body of positive density everywhere has at least half of its axial moment across its axis. */
static enum model_status check_inertia(struct model *m, int body)
{
    const struct scene_values *v = &m->state.values;
    const char *name = scene_body_name(body);
    const bool is_cylinder = body_shape(body) == SHAPE_CYLINDER;
    if (body_inertia_control(v, body) == INERTIA_CONTROL_AUTOMATIC) {
        return !is_cylinder || body_finite_length(v, body)
                   ? MODEL_OK
                   : model_report(m, MODEL_ERROR,
                                  "%s.inertia_control = automatic contradicts %s.finite_length = false: an "
                                  "infinite cylinder has no inertia of its own (allowed: user_defined, or "
                                  "%s.finite_length = true).",
                                  name, name, name);
    }
    const double axial = body_axial_inertia(v, body);
    const double transverse = body_transverse_inertia(v, body);
    return !is_cylinder || transverse >= 0.5 * axial
               ? MODEL_OK
               : model_report(
                     m, MODEL_ERROR,
                     "%s.transverse_inertia = %s kg m^2 contradicts %s.axial_inertia = %s kg m^2: no "
                     "body has so little (allowed: half of axial_inertia at least).",
                     name, shortest_digits(transverse).text, name, shortest_digits(axial).text);
}

static enum model_status check_free_rotation(struct model *m, int body)
{
    const char *name = scene_body_name(body);
    const enum shape shape = body_shape(body);
    if (!body_turns_freely(&m->state.values, body)) {
        return MODEL_OK;
    }
    return shape == SHAPE_PLANE
               ? model_report(m, MODEL_ERROR,
                              "%s.rotation = free contradicts its shape: a plane has no inertia (allowed: "
                              "none, prescribed).",
                              name)
               : check_inertia(m, body);
}
#endif

#if SCENE_ANY_ROTATION
enum model_status model_check_rotation(struct model *m, int body)
{
    const struct scene_values *v = &m->state.values;
    const char *name = scene_body_name(body);
    if (body_shape(body) != SHAPE_SPHERE && body_turn_is_prescribed(v, body) &&
        vec3_is_zero(body_prescribed_axis(v, body))) {
        return model_report(
            m, MODEL_ERROR,
            "%s.prescribed_axis[1], %s.prescribed_axis[2], %s.prescribed_axis[3] = 0, 0, 0 has "
            "no direction (allowed: at least one component other than zero).",
            name, name, name);
    }
#if SCENE_ANY_FREE_ROTATION
    return check_free_rotation(m, body);
#else
    return MODEL_OK;
#endif
}
#endif
