/* When a contact that transmits a force ends: a ball on a wall under a load that presses it, from the deepest
 * point of its swing on. */
#include "touch/terminal_event.h"

#include <float.h>

#include "check.h"
#include "random.h"
#include "scene_model.h"

static const double LOAD = 10.0; /* acceleration towards the wall [m/s^2] */

struct swing {
    struct model model;
    struct segment segment;
    double depth; /* at which spring and load are in balance [m] */
    double rate;  /* of the spring [1/s] */
};

/* gap = -depth (1 + (1 + more) cos(rate t)): at the top of the swing the gap is more times the depth. */
static void make_swing(struct swing *w, double stiffness, double damping, enum dashpot dashpot, double more)
{
    w->model = scene_model();
    struct scene_values *v = &w->model.state.values;
    struct scene_state *q = &w->model.state.motion;
    v->body[DESTINATION].motion = MOTION_FIXED;
    v->contact[0].location = LOCATION_OUTSIDE;
    v->contact[0].dashpot = dashpot;
    v->contact[0].penalty_factor = stiffness;
    v->contact[0].viscous_penalty_factor = damping;
    scene_put(v->world.gravity, -LOAD, 0.0, 0.0);
    w->rate = sqrt(stiffness / v->body[SOURCE].mass);
    w->depth = LOAD / (w->rate * w->rate);
    const double reach = v->body[SOURCE].radius + v->body[DESTINATION].radius;
    const double gap = -(2.0 + more) * w->depth;
    scene_start_free(&w->model, SOURCE, vec3_make(reach + gap, 0.0, 0.0), vec3_make(0.0, 0.0, 0.0));
    model_prepare(&w->model);
    q->contact[0].regime = (int32_t)REGIME_COMPRESSION;
    q->contact[0].physics.accumulated_gap = gap;
    struct scene_instant at;
    scene_now(v, q, &at);
    CHECK(segment_make(&w->segment, v, q, &at, 0, 1.0, 1e-15));
}

static struct pair_sample sample_of(const struct swing *w, double s)
{
    struct pair_sample sample;
    w->segment.output.sampler(w->segment.output.segment, s, &sample);
    return sample;
}

static void a_swing_that_throws_the_ball_off_ends_at_a_gap_of_zero(void)
{
    for (int k = 0; k < 8; ++k) {
        struct swing w;
        const double more = 1e-4 * pow(4.0, k);
        make_swing(&w, 1e6, 0.0, DASHPOT_UNCLAMPED, more);
        const struct terminal_event terminal = terminal_event_first(&w.segment);
        const long double expected = acosl(-1.0L / (1.0L + more)) / w.rate;
        CHECK(terminal.regime == REGIME_APART);
        CHECK_CLOSE("time", terminal.s * w.segment.unit, expected, 1e-11L / w.rate / sqrt(more));
        CHECK_CLOSE("gap", sample_of(&w, terminal.s).of[PAIR_GAP][0], 0.0L, 8.0L * DBL_EPSILON * w.depth);
    }
}

/* Hardly faster than standing still: in contact until the gap is wider than its rounding. */
static void a_swing_that_hardly_lifts_the_ball_is_held_until_the_gap_is_sure(void)
{
    for (int k = 0; k < 4; ++k) {
        struct swing w;
        make_swing(&w, 1e6, 0.0, DASHPOT_UNCLAMPED, 4e-7 / (1 << k));
        const struct terminal_event terminal = terminal_event_first(&w.segment);
        const double slack = terminal_event_gap_tolerance(&w.segment);
        CHECK_CLOSE("slack", slack, 2.0L * w.segment.gap_rounding, 0.0L);
        CHECK(terminal.regime == REGIME_APART && terminal.s < w.segment.end);
        CHECK_CLOSE("gap", sample_of(&w, terminal.s).of[PAIR_GAP][0], slack, 0.01L * slack);
        CHECK(sample_of(&w, terminal.s).of[PAIR_GAP_RATE][0] > 0.0);
    }
}

static void a_swing_that_lifts_the_ball_by_less_than_is_known_goes_on(void)
{
    struct swing w;
    make_swing(&w, 1e6, 0.0, DASHPOT_UNCLAMPED, 0.0);
    const double slack = terminal_event_gap_tolerance(&w.segment) / w.depth;
    make_swing(&w, 1e6, 0.0, DASHPOT_UNCLAMPED, 0.9 * slack);
    CHECK(terminal_event_first(&w.segment).s == (double)INFINITY);
    make_swing(&w, 1e6, 0.0, DASHPOT_UNCLAMPED, 1.1 * slack);
    CHECK(terminal_event_first(&w.segment).s < (double)INFINITY);
    make_swing(&w, 1e6, 0.0, DASHPOT_UNCLAMPED, -1e-3);
    CHECK(terminal_event_first(&w.segment).s == (double)INFINITY);
}

/* So stiff that the ball is compressed by less than positions resolve: a millionth of that is enough. */
static void the_slack_of_a_stiff_contact_is_a_part_of_its_penetration(void)
{
    struct swing w;
    make_swing(&w, 1e14, 0.0, DASHPOT_UNCLAMPED, 1e-3);
    CHECK(2.0 * w.segment.gap_rounding > 2e-6 * w.depth);
    CHECK_CLOSE("slack", terminal_event_gap_tolerance(&w.segment), 2.001e-6L * w.depth,
                1e-3L * 2e-6L * w.depth);
}

/* The force of a dashpot that would pull: noticed a hundred millionth of the load below zero, and neither
 * before nor much later. */
static void a_dashpot_that_would_pull_lets_go_a_little_below_zero(void)
{
    for (int k = 1; k < 8; ++k) {
        struct swing w;
        make_swing(&w, 1e6, 200.0 * k, DASHPOT_NON_ADHESIVE, 20.0);
        const struct terminal_event terminal = terminal_event_first(&w.segment);
        const double load = LOAD * w.model.state.values.body[SOURCE].mass;
        const double force = sample_of(&w, terminal.s).of[PAIR_FORCE][0];
        CHECK(terminal.regime == REGIME_SEPARATING && terminal_event_by_law(&w.segment));
        CHECK(force < -0.9e-8 * load && force > -2e-8 * load);
        CHECK(sample_of(&w, terminal.s).of[PAIR_GAP][0] < 0.0);
        make_swing(&w, 1e6, 200.0 * k, DASHPOT_UNCLAMPED, 20.0);
        CHECK(!terminal_event_by_law(&w.segment) && terminal_event_first(&w.segment).s > terminal.s);
        CHECK(terminal_event_first(&w.segment).regime == REGIME_APART);
    }
}

/* At rest in balance the force of a non-adhesive dashpot, and the rate that an approach-only one watches, are
 * rounding. */
static void a_ball_at_rest_stays_in_its_regime(void)
{
    const enum dashpot dashpots[3] = {DASHPOT_NON_ADHESIVE, DASHPOT_UNCLAMPED, DASHPOT_APPROACH_ONLY};
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) {
            struct swing w;
            make_swing(&w, pow(10.0, 5 + 3 * i), 1e3, dashpots[k], -1.0);
            CHECK(terminal_event_first(&w.segment).s == (double)INFINITY);
        }
    }
}

/* It begins at the deepest point, where the rate is zero and about to change its sign. */
static void a_dashpot_on_approach_only_stops_where_restitution_begins(void)
{
    struct swing w;
    make_swing(&w, 1e6, 500.0, DASHPOT_APPROACH_ONLY, 20.0);
    const struct terminal_event terminal = terminal_event_first(&w.segment);
    const struct pair_sample then = sample_of(&w, terminal.s);
    const double fastest = 21.0 * w.depth * w.rate;
    CHECK(terminal.regime == REGIME_RESTITUTION);
    CHECK(then.of[PAIR_GAP_RATE][0] > 0.0 && then.of[PAIR_GAP_RATE][0] < 1e-3 * fastest);
}

int main(void)
{
    CHECK_TEST(a_swing_that_throws_the_ball_off_ends_at_a_gap_of_zero);
    CHECK_TEST(a_swing_that_hardly_lifts_the_ball_is_held_until_the_gap_is_sure);
    CHECK_TEST(a_swing_that_lifts_the_ball_by_less_than_is_known_goes_on);
    CHECK_TEST(the_slack_of_a_stiff_contact_is_a_part_of_its_penetration);
    CHECK_TEST(a_dashpot_that_would_pull_lets_go_a_little_below_zero);
    CHECK_TEST(a_ball_at_rest_stays_in_its_regime);
    CHECK_TEST(a_dashpot_on_approach_only_stops_where_restitution_begins);
    return check_summary("ending");
}
