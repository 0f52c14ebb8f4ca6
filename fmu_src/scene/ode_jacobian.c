#include "scene/ode.h"

#include <string.h>

#include "contact/jacobian.h"
#include "scene/turning_ode.h"

/* Dense, by columns. */
struct matrix {
    double *at;
    int rows;
};

static double *entry(struct matrix m, int row, int column)
{
    return m.at + column * m.rows + row;
}

static void add_block(struct matrix jacobian, int row, int column, double factor, double block[3][3])
{
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            *entry(jacobian, row + i, column + j) += factor * block[i][j];
        }
    }
}

static void add_row(struct matrix jacobian, int row, int column, double factor, struct vec3 entries)
{
    *entry(jacobian, row, column) += factor * entries.x;
    *entry(jacobian, row, column + 1) += factor * entries.y;
    *entry(jacobian, row, column + 2) += factor * entries.z;
}

/* a^T M */
static struct vec3 left_product(struct vec3 a, double m[3][3])
{
    return vec3_make(a.x * m[0][0] + a.y * m[1][0] + a.z * m[2][0],
                     a.x * m[0][1] + a.y * m[1][1] + a.z * m[2][1],
                     a.x * m[0][2] + a.y * m[1][2] + a.z * m[2][2]);
}

/* Everything that depends on the state of `body` (sign -1: source, +1: destination) through contact j. */
static void contact_columns(struct matrix jacobian, const struct scene_ode *ode,
                            const struct scene_instant *at, int j, int body, double sign,
                            struct contact_jacobian *gradient)
{
    const struct scene_values *v = ode->values;
    const int ends[2] = {contact_source(j), contact_destination(j)};
    const int column = ode_body(v, body);
    const int work = ode_dissipated(v) + 1;
    for (int end = 0; end < 2; ++end) {
        const double on_end = end == 0 ? 1.0 : -1.0; /* the destination gets the opposite force */
        if (body_is_free(v, ends[end])) {
            const int row = ode_body(v, ends[end]) + 3;
            const double factor = sign * on_end / body_mass(v, ends[end]);
            add_block(jacobian, row, column, factor, gradient->by_separation);
            add_block(jacobian, row, column + 3, factor, gradient->by_rate);
        } else if (body_is_prescribed(v, ends[end])) {
            const struct vec3 speed = at->velocity[ends[end]];
            add_row(jacobian, work, column, -sign * on_end, left_product(speed, gradient->by_separation));
            add_row(jacobian, work, column + 3, -sign * on_end, left_product(speed, gradient->by_rate));
        }
    }
    add_block(jacobian, ode_impulse(v, j), column, sign, gradient->by_separation);
    add_block(jacobian, ode_impulse(v, j), column + 3, sign, gradient->by_rate);
    add_row(jacobian, ode_dissipated(v), column, sign, gradient->power_by_separation);
    add_row(jacobian, ode_dissipated(v), column + 3, sign, gradient->power_by_rate);
}

void ode_jacobian(const struct scene_ode *ode, double clock, const double *y, double *columns)
{
    const struct scene_values *v = ode->values;
    const struct matrix jacobian = {columns, ode_size(v)};
#if SCENE_ANY_TURNING
    if (scene_turns(v)) {
        turning_jacobian(ode, clock, y, ode_size(v), columns);
        return;
    }
#endif
    struct scene_instant at;
    ode_instant(ode, clock, y, &at);
    memset(columns, 0, (size_t)jacobian.rows * (size_t)jacobian.rows * sizeof *columns);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(v, i)) {
            const int index = ode_body(v, i);
            for (int k = 0; k < 3; ++k) {
                *entry(jacobian, index + k, index + 3 + k) = 1.0;
            }
            add_row(jacobian, ode_dissipated(v) + 1, index + 3, 1.0,
                    path_at(ode->state->path[i].force, 3, clock));
        }
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const enum contact_regime regime = (enum contact_regime)ode->state->contact[j].regime;
        if (regime == REGIME_APART) {
            continue;
        }
        const struct contact_shape shape = scene_contact_shape(v, ode->state, j);
        const struct contact_law law = scene_contact_law(v, ode->state, j);
        struct contact_jacobian gradient =
            contact_jacobian_at(&shape, &at.geometry[j], at.rate[j], &law, regime);
        if (body_is_free(v, contact_source(j))) {
            contact_columns(jacobian, ode, &at, j, contact_source(j), -1.0, &gradient);
        }
        if (body_is_free(v, contact_destination(j))) {
            contact_columns(jacobian, ode, &at, j, contact_destination(j), 1.0, &gradient);
        }
    }
}

void ode_coupled_jacobian(const struct scene_ode *ode, double clock, const double *y, double *columns)
{
    double whole[ODE_MOST_STATES * ODE_MOST_STATES];
    const int size = ode_size(ode->values);
    const int coupled = ode_coupled(ode->values);
#if SCENE_ANY_TURNING
    if (scene_turns(ode->values)) {
        turning_jacobian(ode, clock, y, coupled, columns);
        return;
    }
#endif
    ode_jacobian(ode, clock, y, whole);
    for (int j = 0; j < coupled; ++j) {
        memcpy(columns + j * coupled, whole + j * size, (size_t)coupled * sizeof *columns);
    }
}

void ode_split_jacobian(const struct scene_ode *ode, double clock, const double *y, double *columns,
                        double *by_forces, double *of_forces)
{
#if SCENE_ANY_TURNING
    turning_split_jacobian(ode, clock, y, columns, by_forces, of_forces);
#else
    (void)ode, (void)clock, (void)y, (void)columns, (void)by_forces, (void)of_forces;
#endif
}
