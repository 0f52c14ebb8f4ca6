/* The coefficients of a contact along a path, against the path itself followed in long double. */
#include "contact/slopes.h"

#include <float.h>

#include "check.h"
#include "long_vec3.h"
#include "random.h"

enum { QUANTITIES = 10 };

struct path {
    struct contact_shape shape;
    struct contact_law law, change;
    struct vec3 c[JET_TERMS], w[JET_TERMS];
};

static struct long_vec3 long_at(const struct vec3 *path, long double s)
{
    return long_axpy(long_axpy(long_of(path[0]), s, long_of(path[1])), s * s, long_of(path[2]));
}

/* Distance, gap, rate, force, normal, force on the source. */
static void follow(const struct path *p, long double s, long double value[QUANTITIES])
{
    const struct long_geometry g = long_geometry_at(&p->shape, long_at(p->c, s), long_at(p->w, s));
    const long double k = p->law.stiffness + s * p->change.stiffness;
    const long double c = p->law.damping + s * p->change.damping;
    const long double force = -(k * g.gap + c * g.gap_rate);
    const long double along = p->shape.side > 0 ? -force : force;
    const long double all[QUANTITIES] = {g.distance,         g.gap,
                                         g.gap_rate,         force,
                                         g.normal.x,         g.normal.y,
                                         g.normal.z,         along * g.normal.x,
                                         along * g.normal.y, along * g.normal.z};
    for (int i = 0; i < QUANTITIES; ++i) {
        value[i] = all[i];
    }
}

static void coefficients(const struct contact_jet *v, int order, double value[QUANTITIES])
{
    const double all[QUANTITIES] = {
        v->distance[order],       v->gap[order],           v->gap_rate[order], v->normal_force[order],
        v->normal[order].x,       v->normal[order].y,      v->normal[order].z, v->source_force[order].x,
        v->source_force[order].y, v->source_force[order].z};
    for (int i = 0; i < QUANTITIES; ++i) {
        value[i] = all[i];
    }
}

static struct contact_jet vary(const struct path *p)
{
    const struct vec3 fallback = {0.0, 0.0, -1.0};
    const struct contact_geometry at = contact_geometry_at(&p->shape, p->c[0], p->w[0], fallback);
    struct contact_jet result;
    contact_jet_make(&p->shape, &at, p->c, p->w, &p->law, &p->change, REGIME_COMPRESSION, &result);
    return result;
}

static struct path random_path(struct random *r)
{
    struct path p = {.shape = {.source_radius = random_between(r, 0.1, 1.0),
                               .half_length = (double)INFINITY,
                               .side = random_index(r, 2) == 0 ? 1 : -1,
                               .destination = (enum shape)random_index(r, 3)}};
    p.shape.other_radius = p.shape.source_radius + random_between(r, 0.1, 1.0);
    long_complete_shape(&p.shape, random_direction(r));
    p.law = (struct contact_law){random_between(r, 0.0, 2.0), random_between(r, 0.0, 2.0), DASHPOT_UNCLAMPED,
                                 LAW_LINEAR};
    p.change = (struct contact_law){random_between(r, -1.0, 1.0), random_between(r, -1.0, 1.0),
                                    DASHPOT_UNCLAMPED, LAW_LINEAR};
    for (int i = 0; i < JET_TERMS; ++i) {
        p.w[i] = random_vector(r, 1.0);
        p.c[i] = random_vector(r, 1.0);
    }
    while (long_geometry_at(&p.shape, long_of(p.c[0]), long_of(p.w[0])).distance < 0.3L) {
        p.c[0] = random_vector(r, 2.0);
    }
    return p;
}

/* f(s) +- f(-s) at s = h and 2 h: odd and even coefficients with an error of h^4 in the next but one. */
static void the_coefficients_are_those_of_the_path(void)
{
    struct random r = {31};
    const long double h = 1e-4L;
    /* h^4 times a coefficient of order six of quantities that grow by a factor of 1/0.3 an order and more. */
    const long double tolerance = 2e-9L;
    for (int i = 0; i < 5000; ++i) {
        const struct path p = random_path(&r);
        const struct contact_jet v = vary(&p);
        long double here[QUANTITIES], at[4][QUANTITIES];
        double given[JET_TERMS][QUANTITIES];
        follow(&p, 0.0L, here);
        follow(&p, h, at[0]);
        follow(&p, -h, at[1]);
        follow(&p, 2.0L * h, at[2]);
        follow(&p, -2.0L * h, at[3]);
        for (int order = 0; order < JET_TERMS; ++order) {
            coefficients(&v, order, given[order]);
        }
        for (int k = 0; k < QUANTITIES; ++k) {
            const long double odd = (8.0L * (at[0][k] - at[1][k]) - (at[2][k] - at[3][k])) / (12.0L * h);
            const long double even =
                (16.0L * (at[0][k] + at[1][k]) - (at[2][k] + at[3][k]) - 30.0L * here[k]) / (24.0L * h * h);
            CHECK_CLOSE("value", given[0][k], here[k], 1e-13L);
            CHECK_CLOSE("first", given[1][k], odd, tolerance);
            CHECK_CLOSE("second", given[2][k], even, tolerance);
        }
    }
}

static void where_no_direction_exists_it_is_held(void)
{
    const struct path p = {.shape = {.source_radius = 0.25,
                                     .other_radius = 0.75,
                                     .half_length = (double)INFINITY,
                                     .side = 1,
                                     .destination = SHAPE_SPHERE},
                           .law = {4.0, 0.5, DASHPOT_UNCLAMPED},
                           .c = {{0.0, 0.0, 0.0}, {1.0, 2.0, 3.0}, {0.5, 0.25, 0.125}},
                           .w = {{1.0, 2.0, 3.0}, {1.0, 0.5, 0.25}, {0.0, 0.0, 1.0}}};
    const struct contact_jet v = vary(&p);
    for (int order = 1; order < JET_TERMS; ++order) {
        CHECK(vec3_is_zero(v.normal[order]));
        CHECK_CLOSE("distance", v.distance[order], -p.c[order].z, 0.0);
        CHECK_CLOSE("gap rate", v.gap_rate[order], -p.w[order].z, 0.0);
        CHECK_CLOSE("force", v.normal_force[order], 4.0 * p.c[order].z + 0.5 * p.w[order].z, 0.0);
    }
}

int main(void)
{
    CHECK_TEST(the_coefficients_are_those_of_the_path);
    CHECK_TEST(where_no_direction_exists_it_is_held);
    return check_summary("variation");
}
