#include "scene/projection.h"

#include <float.h>

#include "scene/present.h"

static bool path_rests(const struct vec3 *coefficients, int count)
{
    return path_is_steady(coefficients, count) && vec3_is_zero(coefficients[0]);
}

/* Whether nothing but gravity and contacts works on a body. A prescribed one rests, by both of its inputs. */
static bool body_is_undriven(const struct scene_values *v, const struct scene_state *q, int body)
{
    const struct body_path *path = &q->path[body];
    if (body_is_prescribed(v, body)) {
        return path_is_steady(path->displacement, 4) && path_rests(path->velocity, 3);
    }
    return !body_is_free(v, body) || path_rests(path->force, 3);
}

/* Whether a contact keeps the energy of its relative motion, and no other contact acts. What turns has more
 * energy than that. */
static bool keeps_energy(const struct scene_values *v, const struct scene_state *q, int contact)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (scene_turns(v) || contact_transmits(q, j) != (j == contact)) {
            return false;
        }
    }
    const struct contact_law law = scene_contact_law(v, q, contact);
    return contact_is_elastic(&law) && scene_inverse_mass(v, contact) > 0.0 &&
           body_is_undriven(v, q, contact_source(contact)) &&
           body_is_undriven(v, q, contact_destination(contact));
}

/* The terms of the energy of a contact's relative motion [J]. */
struct relative_energy {
    double kinetic, stored, potential;
};

/* Two free bodies fall together: gravity does not change their relative motion. */
static struct relative_energy relative_energy_of(const struct scene_values *v, const struct scene_state *q,
                                                 const struct scene_instant *at, int contact)
{
    const struct contact_law law = scene_contact_law(v, q, contact);
    const double mass = 1.0 / scene_inverse_mass(v, contact);
    const bool source_is_free = body_is_free(v, contact_source(contact));
    const bool destination_is_free = body_is_free(v, contact_destination(contact));
    struct relative_energy energy = {
        .kinetic = 0.5 * mass * vec3_dot(at->rate[contact], at->rate[contact]),
        .stored = contact_stored_energy(&law, (enum contact_regime)q->contact[contact].regime,
                                        at->geometry[contact].gap)};
    if (source_is_free != destination_is_free) {
        const int body = source_is_free ? contact_source(contact) : contact_destination(contact);
        energy.potential = -mass * vec3_dot(gravity(v), at->displacement[body]);
    }
    return energy;
}

double projection_balance(const struct scene_values *v, const struct scene_state *q,
                          const struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (keeps_energy(v, q, j)) {
            const struct relative_energy energy = relative_energy_of(v, q, at, j);
            return energy.kinetic + energy.stored + energy.potential;
        }
    }
    return 0.0;
}

void projection_close_gap(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    scene_now(v, q, &at);
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    /* g = side (d - reach): the separation has to grow by -side g along n. */
    const struct vec3 grow = vec3_scale(
        -shape.side * at.geometry[contact].gap / scene_inverse_mass(v, contact), at.geometry[contact].normal);
    q->body[source].moved = vec3_axpy(q->body[source].moved, -body_inverse_mass(v, source), grow);
    q->body[destination].moved =
        vec3_axpy(q->body[destination].moved, body_inverse_mass(v, destination), grow);
}

/* An impulse j along the normal, positive where it speeds the bodies apart, changes the energy of the
 * relative motion by j g' + j^2 (1/m_s + 1/m_d) / 2. */
static double impulse_for(double missing, double gap_rate, double by_both)
{
    const double square = gap_rate * gap_rate + 2.0 * missing * by_both;
    return square > 0.0 ? 2.0 * missing / (gap_rate + copysign(sqrt(square), gap_rate)) : 0.0;
}

/* Largest correction, in parts of the energy: an integrator's error is less, so more must have another
 * cause. */
static const double LARGEST_CORRECTION = 1e-3;

/* A contact takes some thousand internal steps at the smallest tolerance. The errors of so many steps may add
 * up. */
static const double MOST_STEPS = 1e4;

/* Whether `missing` is what an integrator that is off by `tolerated` [m/s] and by rounding in each step may
 * leave of the energy, and more than rounding makes of its terms. */
static bool is_integration_error(double missing, const struct relative_energy *energy, double mass,
                                 double gap_rate, double speed, double tolerated)
{
    const double terms = energy->kinetic + energy->stored + fabs(energy->potential);
    const double explained = mass * fabs(gap_rate) * MOST_STEPS * (tolerated + 8.0 * DBL_EPSILON * speed);
    return fabs(missing) > 64.0 * DBL_EPSILON * terms &&
           fabs(missing) <= fmin(explained, LARGEST_CORRECTION * 0.5 * mass * gap_rate * gap_rate);
}

void projection_restore_energy(const struct scene_values *v, struct scene_state *q, int contact,
                               double tolerated)
{
    if (!keeps_energy(v, q, contact)) {
        return;
    }
    struct scene_instant at;
    scene_now(v, q, &at);
    const int source = contact_source(contact);
    const int destination = contact_destination(contact);
    const double by_both = scene_inverse_mass(v, contact);
    const double gap_rate = at.geometry[contact].gap_rate;
    const struct relative_energy energy = relative_energy_of(v, q, &at, contact);
    const double missing = q->phase_energy - (energy.kinetic + energy.stored + energy.potential);
    if (!is_integration_error(missing, &energy, 1.0 / by_both, gap_rate, vec3_norm(at.rate[contact]),
                              tolerated)) {
        return;
    }
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const double j = shape.side * impulse_for(missing, gap_rate, by_both);
    const struct vec3 n = at.geometry[contact].normal;
    q->body[source].velocity = vec3_axpy(q->body[source].velocity, -j * body_inverse_mass(v, source), n);
    q->body[destination].velocity =
        vec3_axpy(q->body[destination].velocity, j * body_inverse_mass(v, destination), n);
    q->contact[contact].physics.impulse = vec3_axpy(q->contact[contact].physics.impulse, -j, n);
}
