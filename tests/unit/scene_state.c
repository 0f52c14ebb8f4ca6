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
    q.v = &v;
    const int count = 1000000;
    for (int i = 0; i < count; ++i) {
        q.clock = segment;
        scene_rebase(&q);
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
        struct vec3 path[4], shifted[4];
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
