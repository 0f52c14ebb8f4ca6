/* A contact by Hertz's law: its series against closed forms and against what they must keep, and the slow
 * motion against the series. */
#include "touch/hertz.h"
#include "touch/hertz_slow.h"

#include <float.h>

#include "check.h"
#include "compressed_model.h"
#include "random.h"

static const double FINE = 8.0 * DBL_EPSILON;

/* A ball at a cylinder along z, outside. */
static struct model touching(double stiffness, double chi)
{
    struct model m = scene_model();
    struct scene_values *v = &m.state.values;
    v->body[DESTINATION].motion = MOTION_FIXED;
    v->contact[0].location = LOCATION_OUTSIDE;
    v->contact[0].dashpot = DASHPOT_UNCLAMPED;
    v->contact[0].law = LAW_HERTZ;
    v->contact[0].method = chi > 0.0 ? METHOD_PENALTY_DYNAMIC : METHOD_PENALTY;
    v->contact[0].hertz_stiffness = stiffness;
    v->contact[0].hunt_crossley_factor = chi;
    v->contact[0].viscous_control = VISCOUS_CONTROL_USER_DEFINED;
    return m;
}

/* Advances by one series, to its end or to the release; whether that was it. */
static bool advance(struct model *m)
{
    const struct contact_pair from = pair_of(m);
    struct pair_hertz p;
    pair_hertz_make(&p, &from, FINE);
    const double parting = pair_hertz_parting(p.root, p.step);
    const struct pair_change change = pair_hertz_change(&p, fmin(parting, p.step));
    pair_apply(&from, &change, &m->state.values, &m->state.motion, 0);
    m->state.motion.clock += change.time;
    return parting <= p.step;
}

/* |v'| = |v|; duration 2.943275184 delta_max / v, delta_max = (5 m v^2 / (4 k))^(2/5): Landau and
 * Lifshitz, Theory of Elasticity, section 9. */
static void an_impact_lasts_as_hertz_says(void)
{
    for (int i = 0; i < 9; ++i) {
        const double stiffness = pow(10.0, 5.0 + i);
        const double speed = pow(10.0, i % 5 - 4.0);
        struct model m = touching(stiffness, 0.0);
        const double reach = m.state.values.body[SOURCE].radius + m.state.values.body[DESTINATION].radius;
        const double mass = m.state.values.body[SOURCE].mass;
        int steps = 1;
        scene_start_free(&m, SOURCE, vec3_make(reach, 0.0, 0.0), vec3_make(-speed, 0.0, 0.0));
        compressed_begin(&m);
        m.state.motion.contact[0].physics.accumulated_gap = 0.0;
        while (!advance(&m) && steps < 100) {
            steps += 1;
        }
        const long double deepest = powl(1.25L * mass * speed * speed / stiffness, 0.4L);
        const long double duration =
            2.0L * deepest / speed * sqrtl(acosl(-1.0L)) * tgammal(1.4L) / tgammal(0.9L);
        CHECK(steps < 20);
        CHECK_CLOSE("speed", m.state.motion.body[SOURCE].velocity.x, speed, 1e-14L * speed);
        CHECK_CLOSE("duration", m.state.motion.clock, duration, 1e-14L * duration);
    }
}

static struct model random_hertz_pair(struct random *r, double chi)
{
    struct model m = touching(pow(10.0, random_between(r, 5.0, 9.0)), chi);
    struct scene_values *v = &m.state.values;
    const double reach = v->body[SOURCE].radius + v->body[DESTINATION].radius;
    v->body[DESTINATION].mass = random_between(r, 0.2, 5.0);
    scene_put_vector(v->world.gravity, random_vector(r, 20.0));
    scene_put_vector(v->body[SOURCE].external_force, random_vector(r, 50.0));
    scene_start_free(&m, SOURCE, vec3_make(reach - random_between(r, 1e-5, 1e-3), 0.0, 0.1),
                     random_vector(r, 3.0));
    scene_start_free(&m, DESTINATION, vec3_make(0.0, 0.0, 0.0), random_vector(r, 3.0));
    compressed_begin(&m);
    return m;
}

static void a_series_keeps_momentum_and_energy(void)
{
    struct random r = {11};
    for (int k = 0; k < 200; ++k) {
        struct model m = random_hertz_pair(&r, k % 2 == 0 ? 0.0 : random_between(&r, 0.0, 0.5));
        const struct scene_values *v = &m.state.values;
        const struct vec3 before = m.state.motion.body[SOURCE].velocity;
        const double energy = balance(&m);
        (void)advance(&m);
        const double t = m.state.motion.clock;
        const struct vec3 acceleration =
            vec3_axpy(gravity(v), 1.0 / v->body[SOURCE].mass, body_external_force(v, SOURCE));
        const struct vec3 gained =
            vec3_sub(m.state.motion.body[SOURCE].velocity, vec3_axpy(before, t, acceleration));
        CHECK(t > 0.0);
        CHECK_CLOSE("impulse", v->body[SOURCE].mass * gained.x, m.state.motion.contact[0].physics.impulse.x,
                    1e-13L);
        CHECK_CLOSE("impulse", v->body[SOURCE].mass * gained.y, m.state.motion.contact[0].physics.impulse.y,
                    1e-13L);
        /* kinetic energy alone reaches 100 J here; 256 roundings of it */
        CHECK_CLOSE("balance", balance(&m), energy, 256.0L * DBL_EPSILON * 100.0L);
    }
}

/* A ball that slides in a cylinder, damped: series up to where the oscillation has died away, then one
 * slow step against series over the same time. */
static void a_slow_step_agrees_with_series(void)
{
    const double stiffness[2] = {1e7, 1e9};
    for (int k = 0; k < 2; ++k) {
        struct model m = touching(stiffness[k], 100.0);
        struct scene_values *v = &m.state.values;
        const double reach = v->body[DESTINATION].radius - v->body[SOURCE].radius;
        v->contact[0].location = LOCATION_INSIDE;
        v->world.gravity[0] = -9.81;
        scene_start_free(&m, SOURCE, vec3_make(-reach, 0.0, 0.0), vec3_make(0.0, 0.5, 0.1));
        compressed_begin(&m);
        m.state.motion.contact[0].physics.accumulated_gap = -1e-6;
        while (m.state.motion.clock < 0.1) {
            (void)advance(&m);
        }
        struct model followed = m;
        const double start = m.state.motion.clock;
        const struct contact_pair from = pair_of(&m);
        struct hertz_slow p;
        while (followed.state.motion.clock < start + 0.05) {
            (void)advance(&followed);
        }
        const double step = followed.state.motion.clock - start;
        const bool is_made = slow_hertz_make(&p, &from, step, 1e-12, -from.gap * 1e-8);
        CHECK(is_made);
        if (is_made) {
            const struct pair_change change = slow_hertz_change(&p, 2.0);
            const double energy = balance(&m);
            pair_apply(&from, &change, v, &m.state.motion, 0);
            m.state.motion.clock += change.time;
            const struct vec3 off =
                vec3_sub(m.state.motion.body[SOURCE].moved, followed.state.motion.body[SOURCE].moved);
            const struct vec3 slip =
                vec3_sub(m.state.motion.body[SOURCE].velocity, followed.state.motion.body[SOURCE].velocity);
            CHECK_CLOSE("position", vec3_norm(off), 0.0, 1e-13L);
            CHECK_CLOSE("velocity", vec3_norm(slip), 0.0, 1e-11L);
            CHECK_CLOSE("balance", balance(&m), energy, 1e-13L);
        }
    }
}

/* Head-on under gravity, from a place within the impact: motion and force are those of the series, and the
 * slopes are those of the values. */
static void the_closed_form_is_the_series(void)
{
    struct random r = {14};
    int found = 0;
    for (int k = 0; k < 200; ++k) {
        struct model m = touching(pow(10.0, random_between(&r, 5.0, 9.0)), 0.0);
        struct scene_values *v = &m.state.values;
        const double reach = v->body[SOURCE].radius + v->body[DESTINATION].radius;
        v->world.gravity[0] = random_between(&r, -20.0, 20.0);
        scene_start_free(&m, SOURCE, vec3_make(reach - (k % 3) * 1e-5, 0.0, 0.0),
                         vec3_make(k % 2 == 0 ? -2.0 : random_between(&r, -3.0, 3.0), 0.0, 0.0));
        compressed_begin(&m);
        m.state.motion.contact[0].physics.accumulated_gap = -(k % 3) * 1e-5;
        const struct contact_pair from = pair_of(&m);
        struct hertz_elastic made;
        struct pair_hertz series;
        if (!(from.gap < 0.0 || k % 2 == 0) || !hertz_elastic_make(&made, &from)) {
            continue; /* no contact that begins, or hardly an impact */
        }
        found += 1;
        pair_hertz_make(&series, &from, FINE);
        const double s = 0.7 * fmin(series.step, pair_hertz_parting(series.root, series.step));
        const double time = pair_hertz_time(&series, s);
        const double place = hertz_elastic_place(&made, time);
        const struct pair_change change = hertz_elastic_change(&made, place);
        const struct pair_change by_series = pair_hertz_change(&series, s);
        struct pair_sample ours, theirs;
        hertz_elastic_sample(&made, place, &ours);
        pair_hertz_sample(&series, s, &theirs);
        CHECK_CLOSE("time", hertz_elastic_time(&made, place), time, 1e-14L * made.end_time);
        CHECK_CLOSE("gap", change.gap, by_series.gap, 1e-13L * made.deepest);
        CHECK_CLOSE("r", change.r.x, by_series.r.x, 1e-13L * made.deepest);
        CHECK_CLOSE("r'", change.r_rate.x, by_series.r_rate.x, 1e-12L);
        const double force = fabs(theirs.of[PAIR_FORCE][0]) + 1e-3;
        CHECK_CLOSE("force", ours.of[PAIR_FORCE][0], theirs.of[PAIR_FORCE][0], 1e-11L * force);
        for (int i = 0; i <= PAIR_FORCE; ++i) { /* slopes, as slopes in time */
            struct pair_sample later;
            const double h = 1e-5;
            hertz_elastic_sample(&made, place + h, &later);
            const double mean = 0.5 * (ours.of[i][1] + later.of[i][1]);
            const double curved = fabs(ours.of[i][2]) + fabs(ours.of[i][1]) + fabs(ours.of[i][0]);
            CHECK_CLOSE("slope", (later.of[i][0] - ours.of[i][0]) / h, mean, 1e-8L * curved);
            CHECK_CLOSE("bend", (later.of[i][1] - ours.of[i][1]) / h, 0.5 * (ours.of[i][2] + later.of[i][2]),
                        1e-6L * curved);
        }
    }
    CHECK(found > 120);
}

int main(void)
{
    CHECK_TEST(an_impact_lasts_as_hertz_says);
    CHECK_TEST(a_series_keeps_momentum_and_energy);
    CHECK_TEST(the_closed_form_is_the_series);
    CHECK_TEST(a_slow_step_agrees_with_series);
    return check_summary("pair_hertz");
}
