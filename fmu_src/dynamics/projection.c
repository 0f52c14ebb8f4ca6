#include "dynamics/projection.h"

#if SCENE_ANY_FREE

#include "dynamics/energy.h"

double projection_balance(const struct scene_values *v, const struct motion *q,
                          const struct system_instant *at)
{
    double sum = energy_kinetic_of(v, at) + energy_stored(v, q, at) + q->dissipated - q->external_work;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            sum -= body_mass(v, i) * vec3_dot(gravity(v), at->displacement[i]);
        }
    }
    return sum;
}

void projection_close_gap(const struct scene_values *v, struct motion *q, int contact)
{
    struct system_instant at;
    system_now(v, q, &at);
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct contact_shape shape = system_shape(v, q, contact);
    /* g = side (d - reach): the separation has to grow by -side g along n. */
    const struct vec3 grow =
        vec3_scale(-shape.side * at.geometry[contact].gap / system_inverse_mass(v, contact),
                   at.geometry[contact].normal);
    q->body[source].moved = vec3_axpy(q->body[source].moved, -body_inverse_mass(v, source), grow);
    q->body[destination].moved =
        vec3_axpy(q->body[destination].moved, body_inverse_mass(v, destination), grow);
}

/* An impulse j along the normal, positive where it speeds the bodies apart, changes the balance by
 * j g' + j^2 (1/m_s + 1/m_d) / 2, prescribed bodies' work included. */
static double impulse_for(double missing, double gap_rate, double by_both)
{
    const double square = gap_rate * gap_rate + 2.0 * missing * by_both;
    return square > 0.0 ? 2.0 * missing / (gap_rate + copysign(sqrt(square), gap_rate)) : 0.0;
}

/* The integrator's error is a small part of the energy; anything larger is not to be explained by it. */
static const double LARGEST_CORRECTION = 1e-3;

void projection_restore_energy(const struct scene_values *v, struct motion *q, int contact)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (system_law(v, q, j).damping > 0.0) {
            return;
        }
    }
    struct system_instant at;
    system_now(v, q, &at);
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const double by_both = system_inverse_mass(v, contact);
    if (!(by_both > 0.0)) {
        return;
    }
    const double gap_rate = at.geometry[contact].gap_rate;
    const double missing = q->phase_energy - projection_balance(v, q, &at);
    if (!(fabs(missing) <= LARGEST_CORRECTION * 0.5 * gap_rate * gap_rate / by_both)) {
        return;
    }
    const struct contact_shape shape = system_shape(v, q, contact);
    const double j = shape.side * impulse_for(missing, gap_rate, by_both);
    const struct vec3 n = at.geometry[contact].normal;
    q->body[source].velocity = vec3_axpy(q->body[source].velocity, -j * body_inverse_mass(v, source), n);
    q->body[destination].velocity =
        vec3_axpy(q->body[destination].velocity, j * body_inverse_mass(v, destination), n);
    q->contact[contact].impulse = vec3_axpy(q->contact[contact].impulse, -j, n);
    if (body_is_prescribed(v, source)) {
        q->external_work += j * vec3_dot(n, at.velocity[source]);
    }
    if (body_is_prescribed(v, destination)) {
        q->external_work -= j * vec3_dot(n, at.velocity[destination]);
    }
}

#endif
