/*
 * Random parameters, run to the end. What is not refused has to give finite values, an energy balance that
 * stays, no energy out of nothing, and, by the event-driven method, the same motion for another
 * communication step. A step whose work solver.max_internal_steps ends may be discarded; it must not fail.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "plan.h"
#include "scene.h"

/* Parts of the energies or lengths that occurred; the solver is asked for 1e-9, and for 1e-12 m and m/s. */
static const double DRIFT_EVENT_DRIVEN = 1e-5, DRIFT_CVODE = 1e-2, MOTION = 1e-4;
static const double ABSOLUTE = 1e-12; /* m/s, m */

struct outcome {
    bool whole;      /* no step was discarded */
    int onsets;      /* of all contacts */
    int fallbacks;   /* how often CVODE took over */
    double farthest; /* an upper bound of the way a body went [m] */
    double position[SCENE_BODIES][3];
};

struct balance {
    double total, mechanical, size;
};

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
    return (mass + stiffness) * PLAN_SMALL * PLAN_SMALL + mass * plan->driven * ABSOLUTE;
}

/* Of the potential energy: by that of the places. */
static double weight_rounding(fmi2Component c)
{
    double weight = 0.0, size = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        weight += host_real(c, ROW_body_mass, i, 0) * host_length(c, ROW_gravity, 0);
        size += host_length(c, ROW_body_center, i) + host_real(c, ROW_body_radius, i, 0);
    }
    return 8.0 * DBL_EPSILON * size * weight;
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
    const double turning =
        host_real(c, ROW_energy_rotational, 0, 0) + host_real(c, ROW_energy_tangential, 0, 0);
    const double rubbed = host_real(c, ROW_energy_friction, 0, 0);
    return (struct balance){.total = host_real(c, ROW_energy_total, 0, 0),
                            .mechanical = kinetic + potential + contact + turning,
                            .size = fabs(kinetic) + fabs(potential) + fabs(contact) + fabs(dissipated) +
                                    fabs(work) + fabs(turning) + fabs(rubbed) + stored_between(c) +
                                    negligible(c, plan)};
}

static void check_balance(fmi2Component c, const struct plan *plan, const struct balance *start,
                          const struct balance *now, double size)
{
    const bool exact = plan->method == PLAN_EVENT_DRIVEN && host_integer(c, ROW_solver_fallbacks, 0) == 0;
    const double allowed = size * (exact ? DRIFT_EVENT_DRIVEN : DRIFT_CVODE) + weight_rounding(c);
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
        CLAIM(status <= fmi2Discard || (status == fmi2Error && plan->method != PLAN_EVENT_DRIVEN));
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
    end.fallbacks = host_integer(c, ROW_solver_fallbacks, 0);
    return end;
}

static bool start_instance(fmi2Component c, const uint8_t *data, size_t size, struct plan *plan)
{
    struct bytes b = {data, size};
    *plan = plan_choose(c, &b);
    fmi2Status status = fmi2SetupExperiment(c, fmi2True, 1e-9, 0.0, fmi2False, 0.0);
    CLAIM(status == fmi2OK);
    status = fmi2EnterInitializationMode(c);
    CLAIM(status == fmi2OK);
    status = fmi2ExitInitializationMode(c);
    CLAIM(status <= fmi2Warning || host.messages > 0);
    if (status <= fmi2Warning) {
        plan_look(c, plan);
    }
    return status <= fmi2Warning;
}

/* Bounces of round bodies magnify every error; after two, what is left is still small. */
static void compare(const struct plan *plan, const struct outcome *a, const struct outcome *b)
{
    if (plan->method != PLAN_EVENT_DRIVEN || plan->has_ends || plan->balanced || !a->whole || !b->whole ||
        a->onsets > 2 || b->onsets > 2 || (plan->creeps && (a->fallbacks > 0 || b->fallbacks > 0))) {
        return;
    }
    const double allowed = MOTION * (plan->longest + fmax(a->farthest, b->farthest)) + PLAN_SMALL;
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
        snprintf(claim_context.note, sizeof claim_context.note, "%.17g s in %d or %d steps", plan.end,
                 plan.steps, plan.other_steps);
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
