/*
 * Random parameters, run to the end. What is not refused has to give finite values, an energy balance that stays, no energy
 * out of nothing, and, by the event-driven method, the same motion for another communication step. A step may be discarded
 * where its work is not done in solver.max_internal_steps; it must not fail.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bytes.h"
#include "host.h"
#include "scene.h"

enum { MOST_INTERNAL_STEPS = 2000, MOST_STEPS = 12, EVENT_DRIVEN = 1 };

/* Parts of the energies or lengths that occurred; the solver is asked for 1e-9, and for 1e-12 m and m/s. */
static const double DRIFT_EVENT_DRIVEN = 1e-5, DRIFT_CVODE = 1e-2, MOTION = 1e-4, SMALL = 1e-8;
static const double ABSOLUTE = 1e-12; /* m/s, m */

struct plan {
    int method, steps, other_steps;
    double end;
    bool free;      /* some body moves by itself; else energies are sums over samples of the inputs */
    bool pushed;    /* the importer does work */
    bool has_ends;  /* a finite cylinder: a run may depend on the last digit of where it passes the end */
    bool balanced;  /* an unstable rest at the start: which way it is left may be rounding's choice */
    double longest; /* the longest radius or distance there is [m] */
    double driven;  /* the fastest that the importer moves a body [m/s] */
};

struct outcome {
    bool whole;      /* no step was discarded */
    int onsets;      /* of all contacts */
    double farthest; /* an upper bound of the way a body went [m] */
    double position[SCENE_BODIES][3];
};

struct balance {
    double total, mechanical, size;
};

static void set_vector(fmi2Component c, int row, int element, const double value[3])
{
    for (int k = 0; k < 3; ++k) {
        (void)host_set_real(c, row, element, k, value[k]);
    }
}

/* A direction: an axis of the world, or any. */
static void any_direction(struct bytes *b, double direction[3])
{
    const unsigned axis = bytes_choice(b, 5);
    double size = 0.0;
    for (unsigned k = 0; k < 3; ++k) {
        direction[k] = axis < 3 ? (axis == k) : bytes_between(b, -1.0, 1.0);
        size += direction[k] * direction[k];
    }
    for (int k = 0; k < 3; ++k) {
        direction[k] = size > 1e-6 ? direction[k] / sqrt(size) : (double)(k == 0);
    }
}

static void any_vector(struct bytes *b, double low, double high, double vector[3])
{
    any_direction(b, vector);
    const double size = bytes_choice(b, 3) ? bytes_power(b, low, high) : 0.0;
    for (int k = 0; k < 3; ++k) {
        vector[k] *= size;
    }
}

/* Radii, and each body next to the one before: apart, touching, overlapping, one inside the other. */
static void choose_places(fmi2Component c, struct bytes *b, struct plan *plan)
{
    double centre[3] = {0.0, 0.0, 0.0}, before = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const double radius = bytes_power(b, -2.0, 1.0);
        double direction[3];
        any_direction(b, direction);
        const double gap =
            radius * (bytes_choice(b, 4) ? bytes_power(b, -4.0, 0.5) : -bytes_power(b, -9.0, -0.5));
        const bool inside = bytes_choice(b, 3) == 2;
        const double distance = inside ? fmax(fabs(radius - before) - gap, 0.0) : radius + before + gap;
        for (int k = 0; k < 3 && i > 0; ++k) {
            centre[k] += distance * direction[k];
        }
        (void)host_set_real(c, ROW_body_radius, i, 0, radius);
        set_vector(c, ROW_body_center, i, centre);
        plan->longest = fmax(plan->longest, fmax(radius, distance));
        before = radius;
    }
}

static void choose_body(fmi2Component c, struct bytes *b, struct plan *plan, int body)
{
    static const int motions[] = {3, 1, 3, 2, 3};
    double vector[3];
    const int motion = motions[bytes_choice(b, 5)];
    (void)host_set_integer(c, ROW_body_motion, body, motion);
    (void)host_set_real(c, ROW_body_mass, body, 0, bytes_power(b, -3.0, 3.0));
    any_vector(b, -3.0, 2.0, vector);
    set_vector(c, motion == 2 ? ROW_body_prescribed_velocity : ROW_body_initial_velocity, body, vector);
    plan->pushed = plan->pushed || motion == 2;
    for (int k = 0; k < 3 && motion == 2; ++k) {
        plan->driven = fmax(plan->driven, fabs(vector[k]));
    }
    plan->free = plan->free || motion == 3;
    if (bytes_choice(b, 4) == 3) {
        any_vector(b, -2.0, 3.0, vector);
        set_vector(c, ROW_body_external_force, body, vector);
        plan->pushed = true;
    }
    if (host_variable(ROW_body_axis, body, 0) != NULL) {
        any_direction(b, vector);
        set_vector(c, ROW_body_axis, body, vector);
        plan->has_ends = bytes_choice(b, 3) == 2;
        (void)host_set_integer(c, ROW_body_finite_length, body, plan->has_ends);
        (void)host_set_real(c, ROW_body_length, body, 0, bytes_power(b, -1.0, 2.0));
    }
}

static void choose_contact(fmi2Component c, struct bytes *b, int contact)
{
    const bool dynamic = bytes_choice(b, 3) != 0;
    const int control = dynamic ? 1 + (int)bytes_choice(b, 3) : 2 - (int)bytes_choice(b, 2);
    (void)host_set_integer(c, ROW_contact_method, contact, dynamic ? 2 : 1);
    (void)host_set_integer(c, ROW_contact_penalty_control, contact, control);
    (void)host_set_integer(c, ROW_contact_viscous_control, contact, 2 - (int)bytes_choice(b, 2));
    (void)host_set_integer(c, ROW_contact_dashpot, contact, 1 + (int)bytes_choice(b, 3));
    (void)host_set_real(c, ROW_contact_penalty_factor, contact, 0, bytes_power(b, 1.0, 9.0));
    (void)host_set_real(c, ROW_contact_viscous_penalty_factor, contact, 0, bytes_power(b, -1.0, 4.0));
    (void)host_set_real(c, ROW_contact_characteristic_time, contact, 0, bytes_power(b, -6.0, -1.0));
    (void)host_set_real(c, ROW_contact_reference_modulus, contact, 0, bytes_power(b, 3.0, 11.0));
}

static struct plan choose(fmi2Component c, struct bytes *b)
{
    struct plan plan = {.method = 1 + (int)bytes_choice(b, 3)};
    double gravity[3];
    plan.end = bytes_power(b, -3.0, 1.0);
    plan.steps = 1 + (int)bytes_choice(b, MOST_STEPS);
    plan.other_steps = 1 + (int)bytes_choice(b, MOST_STEPS);
    (void)host_set_integer(c, ROW_solver_method, 0, plan.method);
    (void)host_set_integer(c, ROW_solver_max_internal_steps, 0, MOST_INTERNAL_STEPS);
    choose_places(c, b, &plan);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        choose_body(c, b, &plan, i);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        choose_contact(c, b, j);
    }
    any_vector(b, -2.0, 2.0, gravity);
    set_vector(c, ROW_gravity, 0, gravity);
    return plan;
}

/* The energy of motions that tolerances leave to chance; a driven body does work against them. */
static double negligible(fmi2Component c, const struct plan *plan)
{
    double mass = 0.0, stiffness = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        mass += host_real(c, ROW_body_mass, i, 0);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        stiffness += host_real(c, ROW_contact_effective_penalty_factor, j, 0);
    }
    return (mass + stiffness) * SMALL * SMALL + mass * plan->driven * ABSOLUTE;
}

/* What contacts may have stored and given back since the last communication point. */
static double stored_between(fmi2Component c)
{
    double sum = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        sum += host_real(c, ROW_contact_peak_force, j, 0) * host_real(c, ROW_contact_peak_penetration, j, 0);
    }
    return sum;
}

static struct balance weigh(fmi2Component c, const struct plan *plan)
{
    const double kinetic = host_real(c, ROW_energy_kinetic, 0, 0);
    const double potential = host_real(c, ROW_energy_potential, 0, 0);
    const double contact = host_real(c, ROW_energy_contact, 0, 0);
    const double dissipated = host_real(c, ROW_energy_dissipated, 0, 0);
    const double work = host_real(c, ROW_energy_external_work, 0, 0);
    return (struct balance){.total = host_real(c, ROW_energy_total, 0, 0),
                            .mechanical = kinetic + potential + contact,
                            .size = fabs(kinetic) + fabs(potential) + fabs(contact) + fabs(dissipated) +
                                    fabs(work) + stored_between(c) + negligible(c, plan)};
}

static void check_balance(fmi2Component c, const struct plan *plan, const struct balance *start,
                          const struct balance *now, double size)
{
    const bool exact = plan->method == EVENT_DRIVEN && host_integer(c, ROW_solver_fallbacks, 0) == 0;
    const double allowed = size * (exact ? DRIFT_EVENT_DRIVEN : DRIFT_CVODE);
    CLAIM(fabs(now->total - start->total) <= allowed);
    CLAIM(plan->pushed || plan->has_ends || now->mechanical - start->mechanical <= allowed);
}

/* The run itself; `steps` equal communication steps. */
static struct outcome run(fmi2Component c, const struct plan *plan, int steps)
{
    struct outcome end = {.whole = true};
    const struct balance start = weigh(c, plan);
    double time = 0.0, size = start.size;
    host_read_all(c);
    for (int i = 0; i < steps && end.whole; ++i) {
        const fmi2Status status = fmi2DoStep(c, time, plan->end * (i + 1) / steps - time, fmi2True);
        CLAIM(status <= fmi2Discard || (status == fmi2Error && plan->method != EVENT_DRIVEN));
        end.whole = status <= fmi2Warning;
        CLAIM(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time) == fmi2OK);
        host_read_all(c);
        const struct balance now = weigh(c, plan);
        size = fmax(size, now.size);
        if (status <= fmi2Discard && plan->free) {
            check_balance(c, plan, &start, &now, size);
        }
        double fastest = 0.0;
        for (int body = 0; body < SCENE_BODIES; ++body) {
            fastest = fmax(fastest, host_length(c, ROW_body_velocity, body));
            for (int k = 0; k < 3; ++k) {
                end.position[body][k] = host_real(c, ROW_body_position, body, k);
            }
        }
        end.farthest += fastest * plan->end;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        end.onsets += host_integer(c, ROW_contact_onsets, j);
    }
    return end;
}

/* Pressed bodies that a pull may turn about each other, as a pendulum stands on its head: exp(20) roundings and more of it; or bodies
 * in one another's centre. */
static bool is_balanced(fmi2Component c, const struct plan *plan, int contact)
{
    const double distance = host_real(c, ROW_contact_distance, contact, 0);
    double pull = host_length(c, ROW_gravity, 0);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        pull += host_length(c, ROW_body_external_force, i) / host_real(c, ROW_body_mass, i, 0);
    }
    return distance <= SMALL * plan->longest ||
           (host_integer(c, ROW_contact_onsets, contact) > 0 && plan->end * sqrt(pull / distance) > 20.0);
}

static bool start_instance(fmi2Component c, const uint8_t *data, size_t size, struct plan *plan)
{
    struct bytes b = {data, size};
    *plan = choose(c, &b);
    fmi2Status status = fmi2SetupExperiment(c, fmi2True, 1e-9, 0.0, fmi2False, 0.0);
    CLAIM(status == fmi2OK);
    status = fmi2EnterInitializationMode(c);
    CLAIM(status == fmi2OK);
    status = fmi2ExitInitializationMode(c);
    CLAIM(status <= fmi2Warning || host.messages > 0);
    for (int j = 0; j < SCENE_CONTACTS && status <= fmi2Warning; ++j) {
        plan->balanced = plan->balanced || is_balanced(c, plan, j);
    }
    return status <= fmi2Warning;
}

/* Bounces of round bodies magnify every error; after two, what is left is still small. */
static void compare(const struct plan *plan, const struct outcome *a, const struct outcome *b)
{
    if (plan->method != EVENT_DRIVEN || plan->has_ends || plan->balanced || !a->whole || !b->whole ||
        a->onsets > 2 || b->onsets > 2) {
        return;
    }
    const double allowed = MOTION * (plan->longest + fmax(a->farthest, b->farthest)) + SMALL;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        for (int k = 0; k < 3; ++k) {
            CLAIM(fabs(a->position[i][k] - b->position[i][k]) <= allowed);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct plan plan;
    host_begin();
    fmi2Component c = host_instance();
    host.shown = c;
    if (start_instance(c, data, size, &plan)) {
        snprintf(host.note, sizeof host.note, "%.17g s in %d or %d steps", plan.end, plan.steps,
                 plan.other_steps);
        const struct outcome once = run(c, &plan, plan.steps);
        CLAIM(fmi2Reset(c) == fmi2OK);
        CLAIM(start_instance(c, data, size, &plan));
        const struct outcome again = run(c, &plan, plan.other_steps);
        compare(&plan, &once, &again);
    }
    fmi2FreeInstance(c);
    host_end();
    return 0;
}
