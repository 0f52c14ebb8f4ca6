#include "integrator/cvode_problem.h"

#include <sunmatrix/sunmatrix_dense.h>

#include "contact/jacobian.h"
#include "scene/energy.h"

enum { BODY_STATES = 6 };

/* Index in y of what a free body has moved; its v follows. */
static int body_index(const struct scene_values *v, int body)
{
    int index = 0;
    for (int i = 0; i < body; ++i) {
        index += body_is_free(v, i) ? BODY_STATES : 0;
    }
    return index;
}

static int impulse_index(const struct scene_values *v, int contact)
{
    return body_index(v, SCENE_BODIES) + 3 * contact;
}

static int dissipated_index(const struct scene_values *v)
{
    return impulse_index(v, SCENE_CONTACTS);
}

int cvode_problem_size(const struct scene_values *v)
{
    return dissipated_index(v) + 2;
}

static struct vec3 vec3_from(const double *data)
{
    return vec3_make(data[0], data[1], data[2]);
}

static void vec3_to(struct vec3 a, double *data)
{
    data[0] = a.x;
    data[1] = a.y;
    data[2] = a.z;
}

static void unpack_bodies(const struct scene_values *v, const double *y,
                          struct body_state bodies[SCENE_BODIES])
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const double *at = y + body_index(v, i);
            bodies[i] = (struct body_state){vec3_from(at), vec3_from(at + 3)};
        }
    }
}

void cvode_pack(const struct cvode_problem *p, N_Vector y)
{
    const struct scene_state *q = p->state;
    double *data = NV_DATA_S(y);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(p->values, i)) {
            vec3_to(q->body[i].moved, data + body_index(p->values, i));
            vec3_to(q->body[i].velocity, data + body_index(p->values, i) + 3);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        vec3_to(q->contact[j].impulse, data + impulse_index(p->values, j));
    }
    data[dissipated_index(p->values)] = q->dissipated;
    data[dissipated_index(p->values) + 1] = q->external_work;
}

void cvode_unpack(const struct scene_values *v, struct scene_state *q, N_Vector y)
{
    const double *data = NV_DATA_S(y);
    unpack_bodies(v, data, q->body);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        q->contact[j].impulse = vec3_from(data + impulse_index(v, j));
    }
    q->dissipated = data[dissipated_index(v)];
    q->external_work = data[dissipated_index(v) + 1];
}

static void evaluate(const struct cvode_problem *p, double clock, N_Vector y, struct scene_instant *at)
{
    struct body_state bodies[SCENE_BODIES];
    unpack_bodies(p->values, NV_DATA_S(y), bodies);
    scene_evaluate(p->values, p->state, clock, bodies, at);
}

int cvode_rhs(double clock, N_Vector y, N_Vector rate, void *problem)
{
    const struct cvode_problem *p = problem;
    const struct scene_values *v = p->values;
    struct scene_instant at;
    evaluate(p, clock, y, &at);
    double *out = NV_DATA_S(rate);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            vec3_to(at.velocity[i], out + body_index(v, i));
            vec3_to(at.acceleration[i], out + body_index(v, i) + 3);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        vec3_to(at.source_force[j], out + impulse_index(v, j));
    }
    out[dissipated_index(v)] = energy_dissipated_power(v, p->state, &at);
    out[dissipated_index(v) + 1] = scene_external_power(v, p->state, clock, &at);
    return 0;
}

static void add_block(SUNMatrix jacobian, int row, int column, double factor, double block[3][3])
{
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            SM_ELEMENT_D(jacobian, row + i, column + j) += factor * block[i][j];
        }
    }
}

static void add_row(SUNMatrix jacobian, int row, int column, double factor, struct vec3 entries)
{
    SM_ELEMENT_D(jacobian, row, column) += factor * entries.x;
    SM_ELEMENT_D(jacobian, row, column + 1) += factor * entries.y;
    SM_ELEMENT_D(jacobian, row, column + 2) += factor * entries.z;
}

/* a^T M */
static struct vec3 left_product(struct vec3 a, double m[3][3])
{
    return vec3_make(a.x * m[0][0] + a.y * m[1][0] + a.z * m[2][0],
                     a.x * m[0][1] + a.y * m[1][1] + a.z * m[2][1],
                     a.x * m[0][2] + a.y * m[1][2] + a.z * m[2][2]);
}

/* Everything that depends on the state of `body` (sign -1: source, +1: destination) through contact j. */
static void contact_columns(SUNMatrix jacobian, const struct cvode_problem *p, const struct scene_instant *at,
                            int j, int body, double sign, struct contact_jacobian *gradient)
{
    const struct scene_values *v = p->values;
    const int ends[2] = {contact_source(j), contact_destination(j)};
    const int column = body_index(v, body);
    const int work = dissipated_index(v) + 1;
    for (int end = 0; end < 2; ++end) {
        const double on_end = end == 0 ? 1.0 : -1.0; /* the destination gets the opposite force */
        if (body_is_free(v, ends[end])) {
            const int row = body_index(v, ends[end]) + 3;
            const double factor = sign * on_end / body_mass(v, ends[end]);
            add_block(jacobian, row, column, factor, gradient->by_separation);
            add_block(jacobian, row, column + 3, factor, gradient->by_rate);
        } else if (body_is_prescribed(v, ends[end])) {
            const struct vec3 speed = at->velocity[ends[end]];
            add_row(jacobian, work, column, -sign * on_end, left_product(speed, gradient->by_separation));
            add_row(jacobian, work, column + 3, -sign * on_end, left_product(speed, gradient->by_rate));
        }
    }
    add_block(jacobian, impulse_index(v, j), column, sign, gradient->by_separation);
    add_block(jacobian, impulse_index(v, j), column + 3, sign, gradient->by_rate);
    add_row(jacobian, dissipated_index(v), column, sign, gradient->power_by_separation);
    add_row(jacobian, dissipated_index(v), column + 3, sign, gradient->power_by_rate);
}

int cvode_jacobian(double clock, N_Vector y, N_Vector rate, SUNMatrix jacobian, void *problem,
                   N_Vector unused1, N_Vector unused2, N_Vector unused3)
{
    (void)rate, (void)unused1, (void)unused2, (void)unused3;
    const struct cvode_problem *p = problem;
    const struct scene_values *v = p->values;
    struct scene_instant at;
    evaluate(p, clock, y, &at);
    SUNMatZero(jacobian);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const int index = body_index(v, i);
            for (int k = 0; k < 3; ++k) {
                SM_ELEMENT_D(jacobian, index + k, index + 3 + k) = 1.0;
            }
            add_row(jacobian, dissipated_index(v) + 1, index + 3, 1.0,
                    path_at(p->state->path[i].force, 3, clock));
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const enum contact_regime regime = (enum contact_regime)p->state->contact[j].regime;
        if (regime == REGIME_APART) {
            continue;
        }
        const struct contact_shape shape = scene_contact_shape(v, p->state, j);
        const struct contact_law law = scene_contact_law(v, p->state, j);
        struct contact_jacobian gradient =
            contact_jacobian_at(&shape, &at.geometry[j], at.rate[j], &law, regime);
        if (body_is_free(v, contact_source(j))) {
            contact_columns(jacobian, p, &at, j, contact_source(j), -1.0, &gradient);
        }
        if (body_is_free(v, contact_destination(j))) {
            contact_columns(jacobian, p, &at, j, contact_destination(j), 1.0, &gradient);
        }
    }
    return 0;
}

/* Zero is returned as a tiny negative number: a contact that starts at g = 0 does not end at once, a root is
 * not found twice, and CVODE, which rejects functions that stay at zero, never sees one. 1e-100 is far below
 * any meaningful gap, rate or force and leaves room for the root finder's products and quotients. */
static double not_zero(double value)
{
    return fabs(value) < 1e-100 ? -1e-100 : value;
}

/* How far the source is beyond a cylinder's ends, negative within [m]; minus infinity without ends. */
static double beyond_ends(const struct contact_shape *shape, const struct contact_geometry *g)
{
    return SCENE_ANY_CYLINDER ? fabs(g->axial) - shape->half_length : -(double)INFINITY;
}

/* The event functions of a contact whose bodies are loaded by another contact, so that closed forms do not
 * foresee its changes. */
static void coupled_roots(const struct cvode_problem *p, const struct contact_shape *shape,
                          const struct contact_law *law, const struct contact_geometry *g, int j,
                          double out[4])
{
    const enum contact_regime regime = (enum contact_regime)p->state->contact[j].regime;
    if (regime == REGIME_APART) {
        out[0] = not_zero(p->gap_offset[j] + fmax(g->gap, beyond_ends(shape, g)));
    } else {
        out[0] = not_zero(p->gap_offset[j] - fmax(g->gap, beyond_ends(shape, g)));
    }
    if (regime == REGIME_SEPARATING) {
        out[1] = not_zero(p->margin_offset[j] + contact_event(law, regime, g->gap, g->gap_rate));
    }
}

int cvode_roots(double clock, N_Vector y, double *roots, void *problem)
{
    const struct cvode_problem *p = problem;
    struct scene_instant at;
    evaluate(p, clock, y, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        double *out = roots + CVODE_ROOTS_EACH * j;
        const enum contact_regime regime = (enum contact_regime)p->state->contact[j].regime;
        const struct contact_law law = scene_contact_law(p->values, p->state, j);
        const struct contact_geometry *g = &at.geometry[j];
        out[0] = out[1] = out[2] = out[3] = 1.0;
        if (contact_transmits(p->state, j)) {
            if (!contact_is_driven(p->values, j)) {
                out[0] = not_zero(p->gap_offset[j] - g->gap);
                out[1] = not_zero(p->margin_offset[j] + contact_event(&law, regime, g->gap, g->gap_rate));
            }
            out[2] = not_zero(-system_opening_rate(p->values, p->state, clock, &at, j));
            out[3] = not_zero(scene_force_rate(p->values, p->state, &at, j));
        }
        if (contact_is_coupled(p->values, p->state, j)) {
            const struct contact_shape shape = scene_contact_shape(p->values, p->state, j);
            coupled_roots(p, &shape, &law, g, j, out);
        }
    }
    return 0;
}

static void weigh(double *weights, double size, const struct cvode_problem *p, int count)
{
    for (int i = 0; i < count; ++i) {
        weights[i] = 1.0 / (p->relative * size + p->absolute);
    }
}

int cvode_weights(N_Vector y, N_Vector weights, void *problem)
{
    const struct cvode_problem *p = problem;
    const struct scene_values *v = p->values;
    const double *data = NV_DATA_S(y);
    double *out = NV_DATA_S(weights);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const int index = body_index(v, i);
            weigh(out + index, vec3_norm(vec3_from(data + index)), p, 3);
            weigh(out + index + 3, vec3_norm(vec3_from(data + index + 3)), p, 3);
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int index = impulse_index(v, j);
        weigh(out + index, fmax(vec3_norm(vec3_from(data + index)), p->momentum_scale), p, 3);
    }
    for (int i = dissipated_index(v); i < cvode_problem_size(v); ++i) {
        weigh(out + i, fmax(fabs(data[i]), p->energy_scale), p, 1);
    }
    return 0;
}
