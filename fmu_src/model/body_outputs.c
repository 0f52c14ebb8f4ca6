/* The outputs of the bodies. */
#include "model/state.h"

void model_show_body(struct scene_values *v, int body, struct vec3 displacement, struct vec3 velocity)
{
    put_body_displacement(v, body, displacement);
    put_body_position(v, body, vec3_add(body_center(v, body), displacement));
    put_body_velocity(v, body, velocity);
}

void model_show_body_now(struct scene_values *v, const struct scene_state *q, int body)
{
    const struct body_instant at = scene_body_now(v, q, body);
    model_show_body(v, body, at.displacement, at.velocity);
}
