/* The zones of a capped cylinder: geometry and edges, against the distance from the solid in long double. */
#include <float.h>
#include <stdlib.h>

#include "capped_problem.h"
#include "check.h"

enum { CASES = 4000 };

static void geometry_is_the_distance_from_the_solid_at_every_scale(void)
{
    struct random r = {81};
    for (int i = 0; i < CASES; ++i) {
        const double scale = random_power(&r, -140.0, 140.0);
        struct problem p = random_problem(&r, scale);
        const struct vec3 w = random_vector(&r, 1.0);
        p.law = (struct contact_law){1.0, 0.0, DASHPOT_UNCLAMPED, LAW_LINEAR};
        long double expected[QUANTITIES];
        long_values(&p, long_of(p.c[0]), long_of(w), 0.0L, expected);
        const struct contact_geometry at = contact_geometry_at(&p.shape, p.c[0], w, FALLBACK);
        const long double noise = 16.0L * DBL_EPSILON * (vec3_norm(p.c[0]) + p.shape.source_radius);
        const long double turned = noise / scale;
        CHECK(at.zone == p.zone || (at.zone == ZONE_SIDE && p.zone == -ZONE_SIDE));
        CHECK_CLOSE("d", at.distance, expected[0], noise);
        CHECK_CLOSE("g", at.gap, expected[1], noise);
        CHECK_CLOSE("g'", at.gap_rate, expected[2], 4.0L * turned);
        CHECK_CLOSE("x of n", at.normal.x, expected[4], turned);
        CHECK_CLOSE("y of n", at.normal.y, expected[5], turned);
        CHECK_CLOSE("z of n", at.normal.z, expected[6], turned);
    }
}

/* Anywhere, inside the solid too: the margin is positive in the nearest zone only, and beyond the edge that
 * is passed lies the zone that contact_zone_after tells. */
static void the_margin_falls_through_zero_at_the_edge_to_the_next_zone(void)
{
    static const int ZONES[] = {ZONE_SIDE, ZONE_CAP, -ZONE_CAP, ZONE_RIM, -ZONE_RIM};
    struct random r = {85};
    int passed[5][5] = {{0}};
    for (int i = 0; i < 20 * CASES; ++i) {
        const struct contact_solid solid = {random_direction(&r), random_between(&r, 0.3, 1.0),
                                            random_between(&r, 0.3, 1.0), 0};
        const struct vec3 from = random_vector(&r, 1.5);
        const struct vec3 to = vec3_axpy(from, 0.02, random_direction(&r));
        int zone[2];
        for (int k = 0; k < 2; ++k) {
            const struct vec3 c = k == 0 ? from : to;
            const struct solid_place place = contact_place_at(&solid, c);
            int within = 0;
            zone[k] = 0;
            const int nearest = contact_zone_by(&place);
            for (int j = 0; j < 5; ++j) {
                const bool is_nearest =
                    abs(ZONES[j]) == ZONE_SIDE ? abs(nearest) == ZONE_SIDE : ZONES[j] == nearest;
                within += contact_zone_margin(&solid, ZONES[j], c) > 0.0;
                CHECK(is_nearest == (contact_zone_margin(&solid, ZONES[j], c) >= 0.0));
                zone[k] = is_nearest ? j : zone[k];
            }
            CHECK(within <= 1);
        }
        passed[zone[0]][zone[1]] += 1;
        const int after = contact_zone_after(&solid, ZONES[zone[0]], to);
        const int next = ZONES[zone[1]];
        /* a step may cut a corner, past a zone that it leaves again */
        CHECK(zone[0] == zone[1] || after == next || contact_zone_margin(&solid, after, to) > -0.02);
    }
    CHECK(passed[0][1] > 0 && passed[0][3] > 0 && passed[1][3] > 0);
    CHECK(passed[1][0] > 0 && passed[3][0] > 0 && passed[3][1] > 0 && passed[4][2] > 0);
}

/* Outside the solid g and n are the same from both sides of an edge, so that the force does not jump. */
static void gap_and_normal_are_continuous_at_the_edges(void)
{
    struct random r = {86};
    for (int i = 0; i < CASES; ++i) {
        struct problem p = random_problem(&r, 1.0);
        const bool to_cap = random_index(&r, 2) == 0;
        const struct vec3 up = p.shape.solid.axis;
        const struct vec3 outward = random_across(&r, up);
        const double away = random_between(&r, 0.1, 1.0);
        const double rho = p.shape.solid.radius + (to_cap ? 0.0 : away);
        const double z = p.shape.solid.half_height + (to_cap ? away : 0.0);
        const struct vec3 c = vec3_axpy(vec3_scale(-rho, outward), -z, up);
        const struct contact_shape rim = contact_shape_in(&p.shape, ZONE_RIM);
        const struct contact_shape face = contact_shape_in(&p.shape, to_cap ? ZONE_CAP : ZONE_SIDE);
        const struct contact_geometry a = contact_geometry_at(&rim, c, up, FALLBACK);
        const struct contact_geometry b = contact_geometry_at(&face, c, up, FALLBACK);
        CHECK_CLOSE("g", a.gap, b.gap, 32.0 * DBL_EPSILON);
        CHECK_CLOSE("g'", a.gap_rate, b.gap_rate, 64.0 * DBL_EPSILON / away);
        CHECK_CLOSE("n", vec3_max_abs(vec3_sub(a.normal, b.normal)), 0.0, 64.0 * DBL_EPSILON / away);
    }
}

int main(void)
{
    CHECK_TEST(geometry_is_the_distance_from_the_solid_at_every_scale);
    CHECK_TEST(the_margin_falls_through_zero_at_the_edge_to_the_next_zone);
    CHECK_TEST(gap_and_normal_are_continuous_at_the_edges);
    return check_summary("zone");
}
