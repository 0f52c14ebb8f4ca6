/* Falls through zero and largest values of motions in closed form. */
#include "scene/dense_output.h"
#include "math/compiler.h"

#include <float.h>

#include "check.h"
#include "random.h"

/* Every quantity a wave of its own: size sin(rate s + phase). */
struct waves {
    double size[PAIR_QUANTITIES], rate[PAIR_QUANTITIES], phase[PAIR_QUANTITIES];
};

static void sample_waves(const void *waves, double s, struct pair_sample *sample)
{
    const struct waves *w = waves;
    for (int i = 0; i < PAIR_QUANTITIES; ++i) {
        const double at = w->rate[i] * s + w->phase[i];
        sample->of[i][0] = w->size[i] * sin(at);
        sample->of[i][1] = w->size[i] * w->rate[i] * cos(at);
        sample->of[i][2] = -w->size[i] * w->rate[i] * w->rate[i] * sin(at);
    }
}

/* Samples at the places that are in w->s already. */
static void sample_all(struct dense_output *w)
{
    const int count = w->count;
    for (w->count = 0; w->count < count;) {
        dense_output_add(w, w->s[w->count]);
    }
}

/* Places at most `widest` apart, the first at zero or later. */
static struct dense_output random_output(struct random *r, dense_output_sampler *sampler, const void *segment,
                                         double widest)
{
    struct dense_output w = {.sampler = sampler, .segment = segment, .latest_s = -1.0};
    w.count = 2 + random_index(r, DENSE_OUTPUT_POINTS - 1);
    w.s[0] = random_index(r, 2) == 0 ? 0.0 : random_between(r, 0.0, 1.0);
    for (int i = 1; i < w.count; ++i) {
        w.s[i] = w.s[i - 1] + random_between(r, 0.01, 1.0) * widest;
    }
    sample_all(&w);
    return w;
}

/* Two turns are half a period of the wave apart: places are closer. */
static struct dense_output random_waves(struct random *r, struct waves *waves)
{
    double fastest = 0.0;
    for (int i = 0; i < PAIR_QUANTITIES; ++i) {
        waves->size[i] = random_power(r, -6.0, 6.0);
        waves->rate[i] = random_between(r, 0.2, 3.0);
        waves->phase[i] = random_between(r, -PI, PI);
        fastest = fmax(fastest, waves->rate[i]);
    }
    return random_output(r, sample_waves, waves, 0.95 * PI / fastest);
}

/* factor quantity + offset as one wave: sin(at) + level > 0, with `at` at the first place. */
struct watched_wave {
    struct event_function what;
    double at, rate, level, size;
};

static struct watched_wave random_event_function(struct random *r, const struct waves *waves,
                                                 const struct dense_output *w, double highest)
{
    const int i = random_index(r, PAIR_QUANTITIES);
    const double level = random_between(r, -highest, highest);
    const double factor = random_sign(r) * random_between(r, 0.5, 2.0);
    const double turned = factor > 0.0 ? 0.0 : PI;
    const double size = fabs(factor) * waves->size[i];
    return (struct watched_wave){{(enum pair_quantity)i, factor, level * size},
                                 waves->rate[i] * w->s[0] + waves->phase[i] + turned,
                                 waves->rate[i],
                                 level,
                                 size};
}

/* The first at which the sine is one, from `at` on. */
static double expected_crest(double at)
{
    const double extremum = 2.0 * PI;
    return 0.5 * PI + extremum * ceil((at - 0.5 * PI) / extremum);
}

/* sin(at) = -level on the way down: at = half a period + asin(level), and turns of it. What begins below has
 * fallen already, unless it is above before the second place. */
static double expected_fall(const struct watched_wave *wave, const struct dense_output *w)
{
    const double second = wave->at + wave->rate * (w->s[1] - w->s[0]);
    const double crest = expected_crest(wave->at);
    const double highest = crest <= second ? 1.0 : sin(second);
    if (sin(wave->at) + wave->level <= 0.0 && highest + wave->level <= 0.0) {
        return w->s[0];
    }
    if (fabs(wave->level) >= 1.0) {
        return (double)INFINITY;
    }
    double at = PI + asin(wave->level);
    at += 2.0 * PI * ceil((wave->at - at) / (2.0 * PI));
    const double s = w->s[0] + (at - wave->at) / wave->rate;
    return s <= w->s[w->count - 1] ? s : (double)INFINITY;
}

TEST(the_first_fall_of_a_wave_is_found)
{
    struct random r = {1};
    int fallen = 0, begun = 0, none = 0;
    for (int k = 0; k < 20000; ++k) {
        struct waves waves;
        struct dense_output w = random_waves(&r, &waves);
        const struct watched_wave wave = random_event_function(&r, &waves, &w, 1.3);
        const double expected = expected_fall(&wave, &w);
        const double got = dense_output_first_event(&w, &wave.what);
        /* asin is as sensitive as the fall is flat */
        const double flat = sqrt(fmax(1.0 - wave.level * wave.level, 1e-8));
        CHECK_CLOSE("fall", got, expected, 64.0L * DBL_EPSILON * (1.0 + expected) / flat);
        fallen += expected < (double)INFINITY && expected > w.s[0];
        begun += expected == w.s[0];
        none += !(expected < (double)INFINITY);
    }
    CHECK(fallen > 2000 && begun > 2000 && none > 2000);
}

static double expected_largest(const struct watched_wave *wave, const struct dense_output *w,
                               const struct dense_range *range)
{
    const double first = wave->at + wave->rate * (range->from - w->s[0]);
    const double last = wave->at + wave->rate * (range->to - w->s[0]);
    const double crest = expected_crest(first);
    const double highest = crest <= last ? 1.0 : fmax(sin(first), sin(last));
    return wave->size * (highest + wave->level);
}

TEST(the_largest_value_of_a_wave_is_found_in_any_range)
{
    struct random r = {2};
    for (int k = 0; k < 20000; ++k) {
        struct waves waves;
        struct dense_output w = random_waves(&r, &waves);
        const struct watched_wave wave = random_event_function(&r, &waves, &w, 3.0);
        const double last = w.s[w.count - 1];
        struct dense_range range;
        range.to = k % 4 == 0 ? last : random_between(&r, w.s[0], last);
        range.from = k % 3 == 0 ? w.s[0] : random_between(&r, w.s[0], range.to);
        struct pair_sample first, last_sample;
        sample_waves(&waves, range.from, &first);
        sample_waves(&waves, range.to, &last_sample);
        range.first = &first;
        range.last = &last_sample;
        CHECK_CLOSE("largest", dense_output_largest(&w, &wave.what, &range, -(double)INFINITY).of[0],
                    expected_largest(&wave, &w, &range),
                    64.0L * DBL_EPSILON * wave.size * (1.0 + wave.rate * last));
    }
}

/* bend (s - middle)^2 + level, of the gap only. */
struct parabola {
    double middle, bend, level;
};

static void sample_parabola(const void *parabola, double s, struct pair_sample *sample)
{
    const struct parabola *p = parabola;
    const double from = s - p->middle;
    *sample = (struct pair_sample){
        .of[PAIR_GAP] = {p->bend * from * from + p->level, 2.0 * p->bend * from, 2.0 * p->bend}};
}

/* Seen at 0, `second` and 2. */
static double fall_seen_from(const struct parabola *p, double second)
{
    const struct event_function gap = {PAIR_GAP, 1.0, 0.0};
    struct dense_output w = {sample_parabola, p, .count = 3, .s = {0.0, second, 2.0}, .latest_s = -1.0};
    sample_all(&w);
    return dense_output_first_event(&w, &gap);
}

static double fall_of(const struct parabola *p)
{
    return fall_seen_from(p, 0.25);
}

/* Down and up again between two places, which see it by the slope alone. */
TEST(a_dip_between_two_places_is_seen_if_it_reaches_zero)
{
    for (int k = 1; k <= 12; ++k) {
        const double depth = pow(10.0, -k);
        const struct parabola through = {1.0, 1.0, -depth};
        const struct parabola above = {1.0, 1.0, depth};
        const struct parabola touching = {1.0, 1.0, 0.0};
        CHECK_CLOSE("fall", fall_of(&through), 1.0L - sqrtl(depth),
                    4.0L * DBL_EPSILON * (1.0L + 1.0L / sqrtl(depth)));
        CHECK(fall_of(&above) == (double)INFINITY);
        CHECK_CLOSE("touch", fall_of(&touching), 1.0L, 1e-7L);
    }
}

TEST(a_hump_between_two_places_is_seen_if_it_rises_above_zero)
{
    for (int k = 1; k <= 12; ++k) {
        const double height = pow(10.0, -k);
        const struct parabola above = {1.0, -1.0, height};
        const struct parabola below = {1.0, -1.0, -height};
        CHECK_CLOSE("fall", fall_seen_from(&above, 1.75), 1.0L + sqrtl(height),
                    4.0L * DBL_EPSILON * (1.0L + 1.0L / sqrtl(height)));
        CHECK(fall_seen_from(&below, 1.75) == 0.0);
        CHECK(fall_of(&above) == 0.0); /* below at the second place too */
    }
}

/* A contact begins at a gap of zero: it rises from there, or falls at once. */
TEST(what_begins_at_zero_falls_at_once_or_after_its_hump)
{
    const struct parabola rising = {0.75, -1.0, 0.5625};   /* s (1.5 - s) */
    const struct parabola sinking = {-0.75, -1.0, 0.5625}; /* -s (1.5 + s) */
    CHECK_CLOSE("after its hump", fall_of(&rising), 1.5L, 8.0L * DBL_EPSILON);
    CHECK(fall_of(&sinking) == 0.0);
}

TEST(a_fall_just_at_the_last_sample_belongs_to_the_segment)
{
    const struct parabola at_end = {0.0, -1.0, 4.0};
    const struct parabola later = {0.0, -1.0, 4.0 + 1e-12};
    CHECK_CLOSE("fall", fall_of(&at_end), 2.0L, 2.0L * DBL_EPSILON);
    CHECK(fall_of(&later) == (double)INFINITY);
}
