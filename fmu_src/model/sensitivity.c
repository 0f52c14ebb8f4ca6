/* This file computes derivatives of outputs with respect to time and with respect to inputs. Both are Taylor
 * coefficients along a path (scene_jet.h). */
#include <math.h>

#include "model/state.h"
#include "scene/evaluate.h"
#include "scene/scene_jet.h"

/* The point about which outputs are differentiated, and a path through it. */
struct linear_model {
    struct scene_state settled; /* memory for the state of `at` where it is a copy */
    struct scene_instant at;
    struct scene_jet along;
};

/* Sets the point at the present instant. Returns false where the inputs cannot be taken over. */
static bool open_linear_model(struct model *m, struct linear_model *l)
{
    const bool taken = model_update_outputs(m, OUTPUTS_ALL);
    if (taken) {
        motion_shown(&m->state.motion, &l->settled, &l->at);
    }
    return taken;
}

/* Sets a multiple of the derivative of a variable along the path, whose outputs have the `terms`. No input
 * changes a state at once. */
static enum model_status put_derivative(const struct model *m, const struct linear_model *l,
                                        const struct scene_values *terms, const struct variable *variable,
                                        double times, double *value)
{
    const bool is_rate = variable->causality == VARIABLE_RATE;
    *value = times * (is_rate ? model_exchange_rate(&l->at, &l->along, variable)
                      : variable->causality >= VARIABLE_STATE ? 0.0
                                                              : variable_value(variable, terms));
    return isfinite(*value)
               ? MODEL_OK
               : model_report(m, MODEL_DISCARD,
                              "A derivative of %s is beyond the range of numbers (allowed: finite).",
                              variable->name);
}

enum model_status model_get_output_derivatives(struct model *m, const struct variable_list *outputs,
                                               const int *orders, double *values)
{
    enum model_status status = MODEL_OK;
    size_t place = 0;
    struct linear_model l;
    struct scene_values terms[JET_TERMS];
    if (!open_linear_model(m, &l)) {
        return model_refuse_inputs(m);
    }
    jet_in_time(&l.at, &l.along);
    for (int order = 1; order < JET_TERMS; ++order) {
        output_terms(m, &l.at, &l.along, order, &terms[order]);
    }
    for (const struct variable *one = NULL;
         status == MODEL_OK && (one = next_variable(outputs, one, &place)) != NULL;) {
        /* a derivative is the Taylor coefficient times order!, which is the order for 1 and 2 */
        const int order = orders[place - 1];
        status = put_derivative(m, &l, &terms[order], one, order, values++);
    }
    return status;
}

/* Puts the change of the axis of a body of prescribed rotation by a change of the input axis. */
static void move_axis(const struct scene_instant *at, int body, int component, double change,
                      struct scene_jet *along)
{
    const double length = vec3_norm(body_prescribed_axis(at->v, body));
    const struct vec3 e = quaternion_third_axis(at->turning.body[body].orientation);
    struct vec3 by = {0.0, 0.0, 0.0};
    *vec3_part(&by, component) = change / length;
    by = vec3_axpy(by, -vec3_dot(by, e), e);
    const struct quaternion turned = quaternion_rate(at->turning.body[body].orientation, vec3_cross(e, by));
    along->orientation[body][1] = quaternion_axpy(along->orientation[body][1], 1.0, turned);
}

/* Moves one known along the path. An input has an effect only where it is in use: the motion inputs of a
 * prescribed body, the force and torque on a free one. A state of Model Exchange may be a known too. */
static void move_inputs(const struct scene_instant *at, const struct variable *known, double change,
                        struct scene_jet *along)
{
    const int i = known->element;
    const bool turns = SCENE_ANY_ROTATION && body_turn_is_prescribed(at->v, i);
    struct vec3 *moved = NULL;
    if (known->causality == VARIABLE_STATE) {
        model_exchange_move(at, known, change, along);
    } else if (known->row == ROW_body_external_force) {
        moved = body_is_free(at->v, i) ? &along->force[i] : NULL;
    } else if (known->row == ROW_body_external_torque) {
        moved = body_turns_freely(at->v, i) ? &along->torque[i] : NULL;
    } else if (known->row == ROW_body_prescribed_displacement) {
        moved = body_is_prescribed(at->v, i) ? &along->displacement[i][1] : NULL;
    } else if (known->row == ROW_body_prescribed_velocity) {
        moved = body_is_prescribed(at->v, i) ? &along->velocity[i][1] : NULL;
    } else if (turns && known->row == ROW_body_prescribed_angular_velocity) {
        moved = &along->angular_velocity[i][1];
    } else if (turns && known->row == ROW_body_prescribed_axis) {
        move_axis(at, i, known->component, change, along);
    } else if (SCENE_ANY_COMPOUND && turns && known->row == ROW_body_prescribed_orientation) {
        turning_jet_move_orientation(at, i, body_prescribed_orientation(at->v, i), known->component, change,
                                     along);
    }
    if (moved != NULL) {
        *vec3_part(moved, known->component) += change;
    }
}

/* Varies what follows from the start of the motion: the diagonals of the bounding boxes, the factors of the
 * laws, and the damping that depends on the onset of a contact, by the gap and gap rate there. */
static void vary_laws(const struct model *m, struct linear_model *l)
{
    const struct scene_values *v = &m->state.values;
    struct scene_jet *along = &l->along;
    jet_of_contacts(&l->at, NULL, false, along); /* how separations, gaps and gap rates change */
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct contact_jet *contact = &along->contact[j];
        (void)model_diagonal(v, j, l->at.separation[j], contact->separation[1], &along->diagonal_slope[j]);
        along->law_slope[j] = SCENE_ANY_HERTZ && scene_damps_by_onset(v, j)
                                  ? onset_law_slope(&l->at, j, contact->gap[1], contact->gap_rate[1])
                                  : model_law_slope(m, j, along->diagonal_slope[j]);
        if (SCENE_ANY_FRICTION && contact_slip_velocity_control(v, j) == SLIP_VELOCITY_CONTROL_AUTOMATIC) {
            /* prepare.c has this factor too */
            along->slip_velocity_slope[j] = 1e-3 * along->diagonal_slope[j];
        }
    }
}

/* Begins a path along which nothing changes yet. */
static void begin_path(const struct model *m, struct linear_model *l)
{
    jet_begin(&l->at, &l->along);
    if (SCENE_ANY_FRICTION && !m->host.exchange && scene_is_force_element(&m->state.values)) {
        l->along.spring_before = m->state.motion.turning.spring; /* a reading of outputs lays only a copy */
    }
}

/* Computes the changes of the unknowns along the path. Without seeds, `values` takes them one by one; with
 * seeds, *values grows by the sum of the changes, each times its seed. */
static enum model_status put_changes(const struct model *m, struct linear_model *l,
                                     const struct variable_list *unknowns, const double *seed, double *values)
{
    enum model_status status = MODEL_OK;
    size_t place = 0;
    struct scene_values terms;
    double change;
    if (!m->state.initialized) {
        vary_laws(m, l);
    }
    jet_of_contacts(&l->at, NULL, true, &l->along);
    if (SCENE_ANY_FREE && m->state.initialized && !m->host.exchange) {
        /* The jump of an input that moves a body does the work that changes the energy stored in contacts. */
        l->along.external_work[1] = jet_energies_of(l->at.q, &l->along, 1).stored;
    }
    output_terms(m, &l->at, &l->along, 1, &terms);
    for (const struct variable *one = NULL;
         status == MODEL_OK && (one = next_variable(unknowns, one, &place)) != NULL;) {
        status = put_derivative(m, l, &terms, one, 1.0, seed ? &change : values++);
        if (seed) {
            *values += *seed++ * change;
        }
    }
    return status;
}

/* The adjoint product finds the effect of each known in turn. That is cheap enough, because inputs are few
 * and the effect of one costs as much as reading all outputs. */
enum model_status model_product(struct model *m, const struct product *p)
{
    enum model_status status = MODEL_OK;
    const double *direction = p->seed;
    double *values = p->sensitivity;
    size_t place = 0;
    struct linear_model l;
    if (!open_linear_model(m, &l)) {
        return model_refuse_inputs(m);
    }
    begin_path(m, &l);
    for (const struct variable *known = NULL;
         status == MODEL_OK && (known = next_variable(&p->knowns, known, &place)) != NULL;) {
        move_inputs(&l.at, known, p->adjoint ? 1.0 : *direction++, &l.along);
        if (p->adjoint) {
            *values = 0.0;
            status = put_changes(m, &l, &p->unknowns, p->seed, values);
            if (status == MODEL_OK && !isfinite(*values++)) {
                status = model_report(m, MODEL_DISCARD,
                                      "An adjoint derivative with respect to %s is beyond the range of "
                                      "numbers (allowed: finite).",
                                      known->name);
            }
            begin_path(m, &l);
        }
    }
    return p->adjoint ? status : put_changes(m, &l, &p->unknowns, NULL, values);
}
