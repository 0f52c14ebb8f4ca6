/* Time keeping and the moving origin of the clock. */
#include "scene/scene_state.h"

#include <float.h>

#include "check.h"
#include "long_vec3.h"
#include "random.h"
#include "scene_model.h"

static struct scene_values one_free_one_prescribed(void)
{
    struct scene_values v = scene_model().state.values;
    v.body[SOURCE].motion = MOTION_FREE;
    v.body[DESTINATION].motion = MOTION_PRESCRIBED;
    return v;
}

static void check_time_after_many_rebases(double start, double segment)
{
    const struct scene_values v = one_free_one_prescribed();
    struct scene_state q;
    memset(&q, 0, sizeof q);
    q.base = start;
    const int count = 1000000;
    for (int i = 0; i < count; ++i) {
        q.clock = segment;
        scene_rebase(&v, &q);
    }
    const long double passed = count * (long double)segment;
    /* Each rebase rounds base_tail + clock, which is no larger than the last bit of base and a segment. */
    const long double noise = count * (long double)DBL_EPSILON * (segment + DBL_EPSILON * fabs(start));
    const long double kept = ((long double)q.base - start) + q.base_tail;
    CHECK_CLOSE("base + base_tail", kept, passed, noise);
    CHECK_CLOSE("scene_time", scene_time(&q) - (long double)start, passed,
                noise + 0.5L * DBL_EPSILON * fabs(q.base));
    const double end = (double)(start + passed) + segment;
    CHECK_CLOSE("scene_remaining", scene_remaining(&q, end), (end - (long double)start) - passed,
                noise + DBL_EPSILON * (segment + DBL_EPSILON * fabs(start)));
    CHECK(fabs(q.base_tail) <= 0.5 * DBL_EPSILON * fabs(q.base));
}

TEST(a_million_rebases_keep_time_to_rounding)
{
    check_time_after_many_rebases(0.0, 1e-7);
    check_time_after_many_rebases(1.0, 1e-7);
    check_time_after_many_rebases(1e5, 1e-7);
    check_time_after_many_rebases(-3e7, 1e-7);
    check_time_after_many_rebases(1e5, 1e-13); /* far below the last bit of base */
}

TEST(the_present_time_counts_the_clock)
{
    struct scene_state q;
    memset(&q, 0, sizeof q);
    q.base = 1e9;
    q.clock = 0.25;
    q.base_tail = 1e-9;
    CHECK_CLOSE("scene_time", scene_time(&q), 1e9L + 0.25L, 1e-7);
    CHECK_CLOSE("scene_remaining", scene_remaining(&q, 1e9 + 0.5), 0.25L - 1e-9L, DBL_EPSILON);
}

static struct long_vec3 long_path(const struct vec3 *coefficients, int count, long double clock)
{
    struct long_vec3 value = {0.0L, 0.0L, 0.0L};
    for (int i = count - 1; i >= 0; --i) {
        value = long_axpy(long_of(coefficients[i]), clock, value);
    }
    return value;
}

TEST(a_shifted_path_is_the_same_path)
{
    struct random r = {61};
    for (int i = 0; i < 20000; ++i) {
        struct vec3 path[4];
        struct vec3 shifted[4];
        const int count = 1 + random_index(&r, 4);
        for (int k = 0; k < 4; ++k) {
            path[k] = random_vector(&r, 1.0);
            shifted[k] = path[k];
        }
        const double by = random_between(&r, -2.0, 2.0);
        path_shift(shifted, count, by);
        const double clock = random_between(&r, -2.0, 2.0);
        /* Sums of at most 4 terms below 4^3. */
        const double noise = 256.0 * 4.0 * DBL_EPSILON;
        CHECK_VECTOR("path", path_at(path, count, clock), long_path(path, count, clock), noise);
        CHECK_VECTOR("shifted path", path_at(shifted, count, clock),
                     long_path(path, count, (long double)by + clock), noise);
        for (int k = count; k < 4; ++k) {
            CHECK(memcmp(&shifted[k], &path[k], sizeof path[k]) == 0);
        }
    }
}

static struct scene_state random_motion(struct random *r)
{
    struct scene_state q;
    memset(&q, 0, sizeof q);
    q.base = random_between(r, -10.0, 10.0);
    q.clock = random_between(r, 0.0, 1.0);
    q.horizon_clock = q.clock + random_between(r, 0.0, 1.0);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        q.origin[i] = (struct body_origin){random_vector(r, 1.0), random_vector(r, 1.0)};
        q.body[i] = (struct body_state){random_vector(r, 1.0), random_vector(r, 1.0)};
        for (int k = 0; k < 4; ++k) {
            q.path[i].displacement[k] = random_vector(r, 1.0);
        }
        for (int k = 0; k < 3; ++k) {
            q.path[i].velocity[k] = random_vector(r, 1.0);
            q.path[i].force[k] = random_vector(r, 1.0);
        }
    }
    q.contact[0].record.touch_clock = random_between(r, -1.0, q.clock);
    q.contact[0].schedule.change_clock =
        random_index(r, 4) == 0 ? (double)INFINITY : random_between(r, 1.0, 2.0);
    q.contact[0].schedule.dead_band_clock = random_between(r, 0.0, 1.0);
    q.contact[0].record.onsets = 3;
    return q;
}

/* Components of equal size must not hide each other where a path is asked whether it is constant. */
TEST(a_path_moves_whatever_the_sizes_and_signs_of_its_components)
{
    for (int i = 0; i < 27; ++i) {
        const struct vec3 rate = vec3_make(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        for (int order = 1; order < 4; ++order) {
            struct vec3 path[4] = {{0.0, 0.0, 0.0}};
            path[order] = rate;
            path_shift(path, 4, 2.0);
            const struct long_vec3 nowhere = {0.0L, 0.0L, 0.0L};
            CHECK_VECTOR("shifted", path[0], long_axpy(nowhere, powl(2.0L, order), long_of(rate)), 0.0L);
        }
    }
}

static void check_body(const struct scene_state *before, const struct scene_state *after, int i, double later)
{
    const double noise = 64.0 * DBL_EPSILON;
    const struct long_vec3 u =
        long_axpy(long_of(before->origin[i].displacement), 1.0L, long_of(before->body[i].moved));
    CHECK_VECTOR("u", vec3_add(after->origin[i].displacement, after->body[i].moved), u, noise);
    CHECK_VECTOR("moved", after->body[i].moved, long_of(vec3_make(0.0, 0.0, 0.0)), 0.0);
    CHECK_VECTOR("v", after->body[i].velocity, long_of(before->body[i].velocity), 0.0);
    CHECK_VECTOR("v at clock 0", after->origin[i].velocity, long_of(before->body[i].velocity), 0.0);
    const long double clock = (long double)before->clock + later;
    const struct body_path *path = &after->path[i];
    if (i == DESTINATION) {
        CHECK_VECTOR("displacement path", path_at(path->displacement, 4, later),
                     long_path(before->path[i].displacement, 4, clock), noise);
        CHECK_VECTOR("velocity path", path_at(path->velocity, 3, later),
                     long_path(before->path[i].velocity, 3, clock), noise);
    } else {
        CHECK_VECTOR("force path", path_at(path->force, 3, later), long_path(before->path[i].force, 3, clock),
                     noise);
    }
}

TEST(a_rebase_changes_nothing_but_the_origin)
{
    const struct scene_values v = one_free_one_prescribed();
    struct random r = {62};
    for (int n = 0; n < 5000; ++n) {
        const struct scene_state before = random_motion(&r);
        struct scene_state after = before;
        const double later = random_between(&r, 0.0, 1.0);
        scene_rebase(&v, &after);
        CHECK(after.clock == 0.0);
        CHECK(after.integrator_fresh == 1);
        CHECK_CLOSE("time", scene_time(&after), scene_time(&before), 0.0);
        CHECK_CLOSE("time since the onset", after.clock - after.contact[0].record.touch_clock,
                    before.clock - before.contact[0].record.touch_clock, 2.0 * DBL_EPSILON);
        if (isinf(before.contact[0].schedule.change_clock)) {
            CHECK(isinf(after.contact[0].schedule.change_clock));
        } else {
            CHECK_CLOSE("time to the change", after.contact[0].schedule.change_clock,
                        before.contact[0].schedule.change_clock - before.clock, 4.0 * DBL_EPSILON);
        }
        CHECK_CLOSE("time to the horizon", after.horizon_clock, before.horizon_clock - before.clock,
                    2.0 * DBL_EPSILON);
        CHECK_CLOSE("time to the settled clock", after.contact[0].schedule.dead_band_clock,
                    before.contact[0].schedule.dead_band_clock - before.clock, 2.0 * DBL_EPSILON);
        CHECK(after.contact[0].record.onsets == 3);
        for (int i = 0; i < SCENE_BODIES; ++i) {
            check_body(&before, &after, i, later);
        }
        const struct scene_state once = after;
        scene_rebase(&v, &after);
        CHECK(memcmp(&once, &after, sizeof once) == 0);
    }
}
