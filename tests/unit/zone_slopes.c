/* How the force in each zone of a capped cylinder changes with motion and with the law's factors, against
 * differences in long double. */
#include "capped_problem.h"
#include "check.h"
#include "contact/slopes.h"

enum { CASES = 4000, VARIABLES = 6 };

static const long double H = 1e-4L; /* of differences of fourth order, in lengths of 1 m */

static void give_law_and_path(struct random *r, struct problem *p)
{
    const enum contact_force_law law = random_index(r, 2) == 0 ? LAW_HERTZ : LAW_LINEAR;
    p->law = (struct contact_law){random_between(r, 0.5, 2.0), random_between(r, 0.0, 1.0), DASHPOT_UNCLAMPED,
                                  law};
    /* one factor of the two at a time: derivatives by both at once are none that an FMU gives */
    const bool is_stiffer = random_index(r, 2) == 0;
    const double grows = random_between(r, -1.0, 1.0);
    p->change =
        (struct contact_law){is_stiffer ? grows : 0.0, is_stiffer ? 0.0 : grows, DASHPOT_UNCLAMPED, law};
    for (int i = 0; i < JET_TERMS; ++i) {
        p->c[i] = i == 0 ? p->c[i] : random_vector(r, 0.3);
        p->w[i] = random_vector(r, 1.0);
    }
}

/* What moves with one of the six components of c and w, the seventh being the path's parameter. */
static void moved_values(const struct problem *p, int variable, long double by, long double out[QUANTITIES])
{
    struct long_vec3 c = long_of(p->c[0]);
    struct long_vec3 w = long_of(p->w[0]);
    long double *const components[VARIABLES] = {&c.x, &c.y, &c.z, &w.x, &w.y, &w.z};
    if (variable < VARIABLES) {
        *components[variable] += by;
    } else {
        c = long_axpy(long_axpy(c, by, long_of(p->c[1])), by * by, long_of(p->c[2]));
        w = long_axpy(long_axpy(w, by, long_of(p->w[1])), by * by, long_of(p->w[2]));
    }
    long_values(p, c, w, variable < VARIABLES ? 0.0L : by, out);
}

/* First and second coefficients by differences of fourth order. */
static void differences(const struct problem *p, int variable, long double out[2][QUANTITIES])
{
    long double here[QUANTITIES], at[4][QUANTITIES];
    moved_values(p, variable, 0.0L, here);
    moved_values(p, variable, H, at[0]);
    moved_values(p, variable, -H, at[1]);
    moved_values(p, variable, 2.0L * H, at[2]);
    moved_values(p, variable, -2.0L * H, at[3]);
    for (int i = 0; i < QUANTITIES; ++i) {
        out[0][i] = (8.0L * (at[0][i] - at[1][i]) - (at[2][i] - at[3][i])) / (12.0L * H);
        out[1][i] =
            (16.0L * (at[0][i] + at[1][i]) - (at[2][i] + at[3][i]) - 30.0L * here[i]) / (24.0L * H * H);
    }
}

static void the_gradient_is_the_slope_of_the_force_in_each_zone(void)
{
    struct random r = {82};
    for (int i = 0; i < CASES; ++i) {
        struct problem p = random_problem(&r, 1.0);
        give_law_and_path(&r, &p);
        const struct contact_shape in = contact_shape_in(&p.shape, p.zone);
        const struct contact_geometry at = contact_geometry_at(&in, p.c[0], p.w[0], FALLBACK);
        const struct contact_jacobian g = contact_jacobian_at(&in, &at, p.w[0], &p.law, REGIME_COMPRESSION);
        for (int variable = 0; variable < VARIABLES; ++variable) {
            long double slope[2][QUANTITIES];
            differences(&p, variable, slope);
            for (int row = 0; row < 3; ++row) {
                const double found =
                    variable < 3 ? g.by_separation[row][variable] : g.by_rate[row][variable - 3];
                /* H^4/30 of fifth derivatives: 120 over the fourth power of a depth of 0.02 m and more, of
                 * Hertz's force over its power 7/2 */
                CHECK_CLOSE("slope of the force", found, slope[0][7 + row], 1e-9L);
            }
        }
    }
}

static void the_coefficients_are_those_of_the_path_in_each_zone(void)
{
    struct random r = {83};
    for (int i = 0; i < CASES; ++i) {
        struct problem p = random_problem(&r, 1.0);
        give_law_and_path(&r, &p);
        const struct contact_shape in = contact_shape_in(&p.shape, p.zone);
        const struct contact_geometry at = contact_geometry_at(&in, p.c[0], p.w[0], FALLBACK);
        struct contact_jet v;
        contact_jet_make(&in, &at, p.c, p.w, &p.law, &p.change, REGIME_COMPRESSION, &v);
        long double slope[2][QUANTITIES];
        differences(&p, VARIABLES, slope);
        for (int order = 1; order < JET_TERMS; ++order) {
            const double found[QUANTITIES] = {
                v.distance[order],       v.gap[order],           v.gap_rate[order], v.normal_force[order],
                v.normal[order].x,       v.normal[order].y,      v.normal[order].z, v.source_force[order].x,
                v.source_force[order].y, v.source_force[order].z};
            for (int k = 0; k < QUANTITIES; ++k) {
                CHECK_CLOSE("coefficient", found[k], slope[order - 1][k], 2e-7L);
            }
        }
    }
}

static void the_distance_from_the_axis_goes_with_the_path(void)
{
    struct random r = {84};
    for (int i = 0; i < CASES; ++i) {
        struct problem p = random_problem(&r, 1.0);
        give_law_and_path(&r, &p);
        p.zone = ZONE_SIDE; /* d is rho there */
        double rho[3];
        const struct vec3 none = {0.0, 0.0, 0.0};
        const struct vec3 axis[JET_TERMS] = {p.shape.solid.axis, none, none};
        contact_axis_distance(p.c, axis, rho);
        const long double less = p.shape.solid.radius + p.shape.source_radius;
        if (rho[0] < 0.1) {
            continue;
        }
        long double here[QUANTITIES], slope[2][QUANTITIES];
        moved_values(&p, VARIABLES, 0.0L, here);
        differences(&p, VARIABLES, slope);
        CHECK_CLOSE("rho", rho[0], here[1] + less, 1e-14L);
        CHECK_CLOSE("rho'", rho[1], slope[0][0], 1e-9L);
        CHECK_CLOSE("rho''/2", rho[2], slope[1][0], 1e-9L);
    }
}

int main(void)
{
    CHECK_TEST(the_gradient_is_the_slope_of_the_force_in_each_zone);
    CHECK_TEST(the_coefficients_are_those_of_the_path_in_each_zone);
    CHECK_TEST(the_distance_from_the_axis_goes_with_the_path);
    return check_summary("zone_slopes");
}
