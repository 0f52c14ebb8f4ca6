#include "plan.h"

#include <math.h>

#include "scene.h"

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
    }
    if (host_variable(ROW_body_finite_length, body, 0) != NULL) {
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

/* The law and what it takes its factors from. These bytes came after all others: inputs without them have the
 * linear law with the damping chosen above. */
static void choose_law(fmi2Component c, struct bytes *b, int contact)
{
    const bool hertz = bytes_choice(b, 2) == 1;
    (void)host_set_real(c, ROW_contact_restitution, contact, 0, bytes_choice(b, 4) ? bytes_part(b) : 0.0);
    if (bytes_choice(b, 3) == 2) {
        (void)host_set_integer(c, ROW_contact_viscous_control, contact, 3);
    }
    if (!hertz) {
        return;
    }
    (void)host_set_integer(c, ROW_contact_law, contact, 2);
    (void)host_set_integer(c, ROW_contact_penalty_control, contact, 2 - (int)bytes_choice(b, 2));
    (void)host_set_real(c, ROW_contact_hertz_stiffness, contact, 0, bytes_power(b, 2.0, 12.0));
    (void)host_set_real(c, ROW_contact_hunt_crossley_factor, contact, 0, bytes_power(b, -4.0, 3.0));
    for (int i = 0; i < SCENE_BODIES; ++i) {
        (void)host_set_real(c, ROW_body_youngs_modulus, i, 0, bytes_power(b, 5.0, 13.0));
        (void)host_set_real(c, ROW_body_poissons_ratio, i, 0, bytes_between(b, -0.9, 0.5));
    }
}

/* How a body turns; an infinite cylinder needs an inertia of its own. */
static void choose_rotation(fmi2Component c, struct bytes *b, struct plan *plan, int body)
{
    const int rotation = 1 + (int)bytes_choice(b, 3);
    double vector[3];
    if (rotation == 1 || host_variable(ROW_body_rotation, body, 0) == NULL) {
        return;
    }
    (void)host_set_integer(c, ROW_body_rotation, body, rotation);
    any_vector(b, -2.0, 2.0, vector);
    set_vector(c, rotation == 2 ? ROW_body_prescribed_angular_velocity : ROW_body_initial_angular_velocity,
               body, vector);
    const double axial = bytes_power(b, -5.0, 3.0);
    (void)host_set_integer(c, ROW_body_inertia_control, body, 1 + (int)bytes_choice(b, 2));
    (void)host_set_real(c, ROW_body_axial_inertia, body, 0, axial);
    (void)host_set_real(c, ROW_body_transverse_inertia, body, 0, axial * bytes_power(b, -0.3, 2.0));
    plan->pushed = plan->pushed || rotation == 2;
    plan->free = plan->free || rotation == 3;
    if (bytes_choice(b, 4) == 3) {
        any_vector(b, -3.0, 2.0, vector);
        set_vector(c, ROW_body_external_torque, body, vector);
        plan->pushed = true;
    }
}

static void choose_friction(fmi2Component c, struct bytes *b, int contact)
{
    const int friction = 1 + (int)bytes_choice(b, 3);
    const double coefficient = bytes_between(b, 0.0, 1.5);
    if (friction == 1) {
        return;
    }
    (void)host_set_integer(c, ROW_contact_friction, contact, friction);
    (void)host_set_real(c, ROW_contact_friction_coefficient, contact, 0, coefficient);
    (void)host_set_real(c, ROW_contact_static_friction_coefficient, contact, 0,
                        coefficient * (1.0 + (bytes_choice(b, 2) ? bytes_part(b) : 0.0)));
    (void)host_set_integer(c, ROW_contact_slip_velocity_control, contact, 1 + (int)bytes_choice(b, 2));
    (void)host_set_real(c, ROW_contact_characteristic_slip_velocity, contact, 0, bytes_power(b, -6.0, 1.0));
    (void)host_set_real(c, ROW_contact_tangential_stiffness, contact, 0, bytes_power(b, 1.0, 9.0));
    (void)host_set_real(c, ROW_contact_tangential_damping, contact, 0,
                        bytes_choice(b, 2) ? bytes_power(b, -2.0, 4.0) : 0.0);
    if (bytes_choice(b, 4) == 3) {
        (void)host_set_real(c, ROW_contact_maximum_friction_force, contact, 0, bytes_power(b, -3.0, 5.0));
    }
}

/* Rows of a resistance: the choice, coefficient, characteristic rate, stiffness and damping. */
static const int RESISTANCES[2][5] = {
    {ROW_contact_rolling, ROW_contact_rolling_coefficient, ROW_contact_characteristic_rolling_rate,
     ROW_contact_rolling_stiffness, ROW_contact_rolling_damping},
    {ROW_contact_spinning, ROW_contact_spinning_coefficient, ROW_contact_characteristic_spinning_rate,
     ROW_contact_spinning_stiffness, ROW_contact_spinning_damping}};

static void choose_resistance(fmi2Component c, struct bytes *b, int contact, const int row[5])
{
    const int resistance = 1 + (int)bytes_choice(b, 3);
    if (resistance == 1 || host_variable(row[0], contact, 0) == NULL) {
        return;
    }
    (void)host_set_integer(c, row[0], contact, resistance);
    (void)host_set_real(c, row[1], contact, 0, bytes_between(b, 0.0, 1.5));
    (void)host_set_real(c, row[2], contact, 0, bytes_power(b, -4.0, 2.0));
    (void)host_set_real(c, row[3], contact, 0, bytes_power(b, -2.0, 6.0));
    (void)host_set_real(c, row[4], contact, 0, bytes_choice(b, 2) ? bytes_power(b, -4.0, 2.0) : 0.0);
}

static void choose_tangential_law(fmi2Component c, struct bytes *b, int contact)
{
    if (bytes_choice(b, 2) && host_integer(c, ROW_contact_law, contact) == 2) {
        (void)host_set_integer(c, ROW_contact_tangential_law, contact, 2);
        (void)host_set_real(c, ROW_contact_tangential_ratio, contact, 0, bytes_power(b, -2.0, 1.0));
    }
}

struct plan plan_choose(fmi2Component c, struct bytes *b)
{
    struct plan plan = {.method = 1 + (int)bytes_choice(b, 3)};
    double gravity[3];
    plan.end = bytes_power(b, -3.0, 1.0);
    plan.steps = 1 + (int)bytes_choice(b, PLAN_STEPS);
    plan.other_steps = 1 + (int)bytes_choice(b, PLAN_STEPS);
    (void)host_set_integer(c, ROW_solver_method, 0, plan.method);
    (void)host_set_integer(c, ROW_solver_max_internal_steps, 0, PLAN_INTERNAL_STEPS);
    choose_places(c, b, &plan);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        choose_body(c, b, &plan, i);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        choose_contact(c, b, j);
    }
    any_vector(b, -2.0, 2.0, gravity);
    set_vector(c, ROW_gravity, 0, gravity);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        choose_law(c, b, j);
    }
    /* These came last: inputs without them have bodies that do not turn, and no friction. */
    for (int i = 0; i < SCENE_BODIES; ++i) {
        choose_rotation(c, b, &plan, i);
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        choose_friction(c, b, j);
    }
    /* These came after those: inputs without them have a constant tangential stiffness and no resistance. */
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        choose_tangential_law(c, b, j);
    }
    for (int k = 0; k < 2 * SCENE_CONTACTS; ++k) {
        choose_resistance(c, b, k / 2, RESISTANCES[k % 2]);
    }
    return plan;
}

/* Pressed bodies that a pull may turn about each other, as a pendulum stands on its head: exp(20)
 * roundings and more of it; or bodies in one another's centre. */
static bool is_balanced(fmi2Component c, const struct plan *plan, int contact)
{
    if (body_shape(contact_destination(contact)) == SHAPE_PLANE) { /* whose normal is the same everywhere */
        return false;
    }
    const double distance = host_real(c, ROW_contact_distance, contact, 0);
    double pull = host_length(c, ROW_gravity, 0);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        pull += host_length(c, ROW_body_external_force, i) / host_real(c, ROW_body_mass, i, 0);
    }
    return distance <= PLAN_SMALL * plan->longest ||
           (host_integer(c, ROW_contact_onsets, contact) > 0 && plan->end * sqrt(pull / distance) > 20.0);
}

static bool creeps(fmi2Component c, int contact)
{
    const double stiffness = host_real(c, ROW_contact_effective_penalty_factor, contact, 0);
    const double damping = host_real(c, ROW_contact_effective_viscous_penalty_factor, contact, 0);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (damping * damping > 4.0 * stiffness * host_real(c, ROW_body_mass, i, 0)) {
            return true;
        }
    }
    return false;
}

void plan_look(fmi2Component c, struct plan *plan)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        plan->balanced = plan->balanced || is_balanced(c, plan, j);
        plan->creeps = plan->creeps || creeps(c, j);
    }
}
