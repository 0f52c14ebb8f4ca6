/* The derivatives of the contact force against fourth-order differences of a force written anew in long
 * double. */
#include "contact/slopes.h"

#include <float.h>

#include "check.h"
#include "long_vec3.h"
#include "random.h"

/* What is differentiated: the three components of the force on the source, and the dissipated power. */
enum { FORCE_AND_POWER = 4 };

struct setting {
    struct contact_shape shape;
    struct contact_law law;
    enum contact_regime regime;
    struct vec3 c, w;
};

struct sample {
    long double value[FORCE_AND_POWER];
};

static struct sample evaluate(const struct setting *at, struct long_vec3 c, struct long_vec3 w)
{
    const struct long_geometry g = long_geometry_at(&at->shape, c, w);
    const long double spring = at->regime == REGIME_SEPARATING ? 0.0 : at->law.stiffness;
    const long double dashpot = at->regime == REGIME_COMPRESSION ? at->law.damping : 0.0;
    const long double force = -(spring * g.gap + dashpot * g.gap_rate);
    /* Away from the destination's surface: outside along -n, inside along +n. */
    const long double along = at->shape.side > 0 ? -force : force;
    return (struct sample){{along * g.normal.x, along * g.normal.y, along * g.normal.z,
                            -(force + at->law.stiffness * g.gap) * g.gap_rate}};
}

static struct sample evaluate_moved(const struct setting *at, int variable, long double by)
{
    struct long_vec3 c = long_of(at->c);
    struct long_vec3 w = long_of(at->w);
    long double *const components[6] = {&c.x, &c.y, &c.z, &w.x, &w.y, &w.z};
    *components[variable] += by;
    return evaluate(at, c, w);
}

/* (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / 12 h: the error is h^4 of the fifth derivative over 30. */
static struct sample difference(const struct setting *at, int variable)
{
    const long double h = 1e-4L;
    const struct sample near_up = evaluate_moved(at, variable, h);
    const struct sample near_down = evaluate_moved(at, variable, -h);
    const struct sample far_up = evaluate_moved(at, variable, 2.0L * h);
    const struct sample far_down = evaluate_moved(at, variable, -2.0L * h);
    struct sample slope;
    for (int i = 0; i < FORCE_AND_POWER; ++i) {
        slope.value[i] =
            (8.0L * (near_up.value[i] - near_down.value[i]) - far_up.value[i] + far_down.value[i]) /
            (12.0L * h);
    }
    return slope;
}

static struct contact_jacobian gradient_of(const struct setting *at)
{
    const struct vec3 fallback = {0.0, 0.0, -1.0};
    const struct contact_geometry g = contact_geometry_at(&at->shape, at->c, at->w, fallback);
    return contact_jacobian_at(&at->shape, &g, at->w, &at->law, at->regime);
}

/* Bodies of about a metre, the source's centre not close to the axis, where h would not be small. */
static struct setting random_setting(struct random *r)
{
    struct setting at = {.shape = {.source_radius = random_between(r, 0.1, 1.0),
                                   .half_length = (double)INFINITY,
                                   .side = random_index(r, 2) == 0 ? 1 : -1,
                                   .destination = (enum shape)random_index(r, 3)}};
    at.shape.other_radius = at.shape.source_radius + random_between(r, 0.1, 1.0);
    long_complete_shape(&at.shape, random_direction(r));
    /* With and without spring and dashpot, in every regime of contact. */
    at.law.stiffness = random_index(r, 4) == 0 ? 0.0 : random_between(r, 0.0, 2.0);
    at.law.damping = random_index(r, 3) == 0 ? 0.0 : random_between(r, 0.0, 2.0);
    at.law.dashpot = DASHPOT_UNCLAMPED;
    at.regime = (enum contact_regime)(REGIME_COMPRESSION + random_index(r, 3));
    at.w = random_vector(r, 1.0);
    struct long_geometry g;
    do {
        at.c = random_vector(r, 2.0);
        g = long_geometry_at(&at.shape, long_of(at.c), long_of(at.w));
    } while (g.distance < 0.3L);
    return at;
}

static double component(const struct contact_jacobian *g, int row, int variable)
{
    const int column = variable % 3;
    if (row == 3) {
        return vec3_get(variable < 3 ? g->power_by_separation : g->power_by_rate, column);
    }
    return variable < 3 ? g->by_separation[row][column] : g->by_rate[row][column];
}

static void the_gradient_is_the_slope_of_the_force(void)
{
    struct random r = {21};
    /* h^4 / 30 times a fifth derivative of 5! times the values over d^5: 1e-16 / 30 * 120 * 10 / 0.3^5 at
     * most. */
    const double tolerance = 1e-10;
    for (int i = 0; i < 5000; ++i) {
        const struct setting at = random_setting(&r);
        const struct contact_jacobian g = gradient_of(&at);
        for (int variable = 0; variable < 6; ++variable) {
            const struct sample slope = difference(&at, variable);
            for (int row = 0; row < FORCE_AND_POWER; ++row) {
                CHECK_CLOSE(row < 3 ? "slope of the force" : "slope of the power",
                            component(&g, row, variable), slope.value[row], tolerance);
            }
        }
    }
}

/* A spring and dashpot along n pull back symmetrically, and d/dc of a central force is symmetric without
 * damping. */
static void the_matrices_are_symmetric_where_they_have_to_be(void)
{
    struct random r = {22};
    for (int i = 0; i < 5000; ++i) {
        struct setting at = random_setting(&r);
        at.law.damping = i % 2 == 0 ? 0.0 : at.law.damping;
        const struct contact_jacobian g = gradient_of(&at);
        for (int j = 0; j < 3; ++j) {
            const int k = (j + 1) % 3;
            CHECK_CLOSE("dF/dw", g.by_rate[j][k], g.by_rate[k][j], 8.0 * DBL_EPSILON);
            if (at.law.damping == 0.0) {
                CHECK_CLOSE("dF/dc", g.by_separation[j][k], g.by_separation[k][j], 128.0 * DBL_EPSILON);
            }
        }
    }
}

static void where_no_direction_exists_the_held_one_gives_a_spring_along_it(void)
{
    for (int side = -1; side <= 1; side += 2) {
        const struct setting at = {.shape = {.axis = {1.0, 0.0, 0.0},
                                             .source_radius = 0.25,
                                             .other_radius = 0.75,
                                             .half_length = (double)INFINITY,
                                             .side = side,
                                             .destination = SHAPE_CYLINDER},
                                   .law = {4.0, 0.5, DASHPOT_UNCLAMPED},
                                   .regime = REGIME_COMPRESSION,
                                   .c = {2.0, 0.0, 0.0},
                                   .w = {0.1, 0.2, 0.3}};
        const struct contact_jacobian g = gradient_of(&at);
        /* n = -z: F = (k g + c g') side n and g = side (n.c - reach), so dF_z/dc_z = k, whichever side. */
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 3; ++k) {
                const bool along = j == 2 && k == 2;
                CHECK_CLOSE("dF/dc", g.by_separation[j][k], along ? 4.0 : 0.0, 0.0);
                CHECK_CLOSE("dF/dw", g.by_rate[j][k], along ? 0.5 : 0.0, 0.0);
            }
        }
        CHECK_CLOSE("dP/dw_x", g.power_by_rate.x, 0.0, 0.0);
        /* P = c g'^2 and g' = -side w_z */
        CHECK_CLOSE("dP/dw_z", g.power_by_rate.z, 2.0 * 0.5 * 0.3, 4.0 * DBL_EPSILON);
    }
}

int main(void)
{
    CHECK_TEST(the_gradient_is_the_slope_of_the_force);
    CHECK_TEST(the_matrices_are_symmetric_where_they_have_to_be);
    CHECK_TEST(where_no_direction_exists_the_held_one_gives_a_spring_along_it);
    return check_summary("gradient");
}
