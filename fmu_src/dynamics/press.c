#include "dynamics/press.h"

#if SCENE_ANY_FREE

#include <string.h>

#include "dynamics/flight.h"

static struct press_work work_on(const struct press *p, const struct scene_values *v, const struct motion *q,
                                 int body, double sign)
{
    struct press_work work = {.order = 0};
    const struct body_path *path = &q->path[body];
    if (body_is_free(v, body)) {
        memcpy(work.path, path->force, sizeof work.path);
        work.factor = sign * p->reduced_mass / body_mass(v, body);
        work.order = 1;
    } else if (body_is_prescribed(v, body)) {
        memcpy(work.path, path->velocity, sizeof work.path);
        work.factor = -sign * p->reduced_mass;
        work.order = 2;
    }
    path_shift(work.path, 3, q->clock);
    return work;
}

void press_make(struct press *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact)
{
    const struct contact_geometry *geometry = &at->geometry[contact];
    p->shape = system_shape(v, q, contact);
    p->law = system_law(v, q, contact);
    p->by = contact_coefficients_of(&p->law, (enum contact_regime)q->contact[contact].regime);
    p->flight = separation_of(v, q, at, q->clock, contact);
    p->normal = geometry->normal;
    p->distance = geometry->distance;
    p->gap = geometry->gap;
    p->rounded = p->shape.side * p->gap - (geometry->distance - contact_reach(&p->shape));
    p->reduced_mass = 1.0 / system_inverse_mass(v, contact);
    p->work[0] = work_on(p, v, q, contact_source(contact), -1.0);
    p->work[1] = work_on(p, v, q, contact_destination(contact), 1.0);
}

struct vec3 press_across(const struct press *p, struct vec3 c)
{
    return contact_across(&p->shape, c);
}

struct vec3 press_along(const struct press *p, struct vec3 across)
{
    return vec3_axpy(across, -vec3_dot(p->normal, across), p->normal);
}

double press_load(const struct press *p)
{
    const struct vec3 across = press_along(p, press_across(p, p->flight.c[1]));
    return p->reduced_mass *
           fabs(vec3_dot(across, across) / p->distance + 2.0 * vec3_dot(p->normal, p->flight.c[2]));
}

static void move_body(const struct scene_values *v, struct motion *q, int body, double time, struct vec3 r,
                      struct vec3 r_rate)
{
    struct vec3 force[3];
    flight_force(q, body, q->clock, force);
    if (!vec3_is_zero(force[0]) || !vec3_is_zero(force[1]) || !vec3_is_zero(force[2])) {
        q->external_work += flight_work(v, body, q->body[body], force, time);
    }
    const struct body_state flown = flight_from(v, body, q->body[body], force, time);
    q->body[body].moved = vec3_add(flown.moved, r);
    q->body[body].velocity = vec3_add(flown.velocity, r_rate);
}

void press_apply(const struct press *p, const struct press_change *change, const struct scene_values *v,
                 struct motion *q, int contact)
{
    struct contact_state *state = &q->contact[contact];
    const int ends[PRESS_ENDS] = {contact_source(contact), contact_destination(contact)};
    const struct vec3 r = vec3_axpy(change->r, p->rounded, p->normal);
    for (int end = 0; end < PRESS_ENDS; ++end) {
        q->external_work += p->work[end].factor * change->work[end];
        if (body_is_free(v, ends[end])) {
            const double share = (end == 0 ? -1.0 : 1.0) * p->reduced_mass / body_mass(v, ends[end]);
            move_body(v, q, ends[end], change->time, vec3_scale(share, r), vec3_scale(share, change->r_rate));
        }
    }
    q->dissipated += change->dissipated;
    state->impulse = vec3_axpy(state->impulse, -p->reduced_mass, change->r_rate);
    state->carried_gap = change->gap;
}

#endif
