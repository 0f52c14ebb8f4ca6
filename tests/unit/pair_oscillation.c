/* A head-on contact in closed form: against the oscillator in long double, and what it must keep. */
#include "math/compiler.h"
#include "touch/pair.h"

#include <complex.h>
#include <float.h>

#include "check.h"
#include "compressed_model.h"
#include "random.h"

/* Two balls, one free to fall on the other along x under a steady force; gap and speed at the start. */
static struct model head_on(struct random *r, double damping_rate)
{
    struct model m = scene_model();
    struct scene_values *v = &m.state.values;
    const double reach = v->body[SOURCE].radius + v->body[DESTINATION].radius;
    v->contact[0].location = LOCATION_OUTSIDE;
    v->contact[0].dashpot = DASHPOT_UNCLAMPED;
    v->contact[0].viscous_penalty_factor = damping_rate;
    v->body[SOURCE].mass = random_between(r, 0.2, 5.0);
    v->body[DESTINATION].mass = random_between(r, 0.2, 5.0);
    scene_put(v->body[SOURCE].external_force, random_between(r, -2000.0, 500.0), 0.0, 0.0);
    scene_start_free(&m, SOURCE, vec3_make(reach - random_between(r, 0.0, 1e-3), 0.0, 0.0),
                     vec3_make(random_between(r, -2.0, 2.0), 0.0, 0.0));
    scene_start_free(&m, DESTINATION, vec3_make(0.0, 0.0, 0.0),
                     vec3_make(random_between(r, -2.0, 2.0), 0.0, 0.0));
    compressed_begin(&m);
    return m;
}

/* Up to 0.95 of critical damping [N s/m], then about and beyond it. */
static double random_damping(struct random *r, int k)
{
    return k % 2 == 0 ? random_between(r, 0.0, 600.0) : 600.0 * random_power(r, 0.0, 2.0);
}

/* g and g' at a time, from m_red g'' = -(p_n g + p_nv g') + m_red acceleration. */
struct expected {
    long double gap, rate;
};

static struct expected oscillator_at(const struct contact_pair *from, long double t)
{
    const long double decay = from->coefficients.c / (2.0L * from->reduced_mass);
    const long double omega2 = (long double)from->coefficients.k / from->reduced_mass;
    const long double complex extremum = csqrtl(omega2 - decay * decay);
    const long double equilibrium = -2.0L * from->flight.c[2].x / omega2; /* n = -x */
    const long double y = from->gap - equilibrium;
    const long double y_rate = -(long double)from->flight.c[1].x;
    const long double shrink = expl(-decay * t);
    const long double sine = shrink * creall(csinl(extremum * t) / extremum);
    const long double cosine = shrink * creall(ccosl(extremum * t));
    return (struct expected){equilibrium + y * cosine + (y_rate + decay * y) * sine,
                             y_rate * cosine - (omega2 * y + decay * y_rate) * sine};
}

static void the_gap_is_that_of_a_loaded_damped_oscillator(void)
{
    struct random r = {17};
    for (int k = 0; k < 4000; ++k) {
        const struct model m = head_on(&r, random_damping(&r, k));
        const struct contact_pair from = pair_of(&m);
        struct pair_oscillation p;
        struct pair_sample at;
        CHECK(pair_oscillation_make(&p, &from));
        const double s = random_between(&r, 0.0, 10.0);
        const struct expected is = oscillator_at(&from, s / (long double)p.rate);
        pair_oscillation_sample(&p, s, &at);
        /* Forces of 2 kN on 1e6 N/m and speeds of 4 m/s at 500 rad/s or more: 1e-2 m; radians round to 10
         * DBL_EPSILON. */
        CHECK_CLOSE("gap", at.of[PAIR_GAP][0], is.gap, 32.0L * DBL_EPSILON * 1e-2L);
        CHECK_CLOSE("rate", at.of[PAIR_GAP_RATE][0], is.rate, 32.0L * DBL_EPSILON * 1e-2L * p.rate);
        CHECK_CLOSE("force", at.of[PAIR_FORCE][0],
                    -(from.coefficients.k * is.gap + from.coefficients.c * is.rate),
                    64.0L * DBL_EPSILON * 1e-2L * from.coefficients.k);
        const double step = 1e-4 / (1.0 + p.oscillator.damping_rate);
        struct pair_sample later;
        pair_oscillation_sample(&p, s + step, &later);
        for (int i = 0; i <= PAIR_FORCE; ++i) { /* the others are those of a rim */
            const double *a = at.of[i], *b = later.of[i];
            /* Third derivatives are of the values' size, per radian or decay of the faster rate. */
            CHECK_CLOSE("slope", (b[0] - a[0]) / step, a[1] + 0.5 * step * a[2],
                        step * step * (1.0 + p.oscillator.damping_rate) *
                                (fabs(a[0]) + fabs(a[1]) + fabs(a[2])) +
                            1e-7 * fabs(a[0]) + 1e-12);
        }
    }
}

/* From extremum to extremum the gap goes from its deepest to its widest and back; there the sample is the one
 * of any place. */
static void at_its_extrema_the_gap_stands(void)
{
    struct random r = {23};
    for (int k = 0; k < 2000; ++k) {
        const struct model m = head_on(&r, k % 2 == 0 ? 0.0 : random_between(&r, 0.0, 600.0));
        const struct contact_pair from = pair_of(&m);
        struct pair_oscillation p;
        CHECK(pair_oscillation_make(&p, &from));
        bool deepest = pair_oscillation_closes(&p);
        CHECK(deepest == (from.flight.c[1].x > 0.0)); /* n = -x */
        double extremum = pair_oscillation_first_extremum(&p);
        CHECK(extremum > 0.0 && extremum <= (1.0 + 4.0 * DBL_EPSILON) * PI / p.omega_d);
        for (int i = 0; i < 3; ++i, extremum += PI / p.omega_d, deepest = !deepest) {
            struct pair_sample at, there;
            pair_oscillation_sample(&p, extremum, &at);
            pair_oscillation_sample_extremum(&p, extremum, deepest, &there);
            for (int j = 0; j <= PAIR_FORCE; ++j) { /* the others are those of a rim */
                const double size = j == PAIR_GAP        ? 1.0
                                    : j == PAIR_GAP_RATE ? p.rate
                                                         : from.coefficients.k + from.coefficients.c * p.rate;
                for (int n = 0; n < 3; ++n) {
                    CHECK_CLOSE("at a turn", there.of[j][n], at.of[j][n], 64.0L * DBL_EPSILON * 1e-2L * size);
                }
            }
        }
    }
}

static void a_step_keeps_momentum_and_energy(void)
{
    struct random r = {18};
    for (int k = 0; k < 2000; ++k) {
        struct model m = head_on(&r, random_damping(&r, k));
        struct scene_state *q = &m.state.motion;
        const struct scene_values *v = &m.state.values;
        const double before = q->body[SOURCE].velocity.x;
        const double energy = balance(&m);
        const struct contact_pair from = pair_of(&m);
        struct pair_oscillation p;
        CHECK(pair_oscillation_make(&p, &from));
        const struct pair_change change = pair_oscillation_change(&p, random_between(&r, 0.0, 10.0));
        pair_apply(&from, &change, v, q, 0);
        q->clock += change.time;
        const double acceleration = body_external_force(v, SOURCE).x / v->body[SOURCE].mass;
        const double gained = q->body[SOURCE].velocity.x - before - q->clock * acceleration;
        CHECK_CLOSE("impulse", v->body[SOURCE].mass * gained, q->contact[0].physics.impulse.x, 1e-13L);
        CHECK_CLOSE("balance", balance(&m), energy, 256.0L * DBL_EPSILON * 100.0L);
    }
}

static void other_motion_is_refused(void)
{
    struct random r = {19};
    for (int k = 0; k < 5; ++k) {
        struct model m = head_on(&r, 0.0);
        struct contact_pair from = pair_of(&m);
        struct pair_oscillation p;
        CHECK(pair_oscillation_make(&p, &from));
        switch (k) {
        case 0:
            from.flight.c[1].y += 1e-12; /* a swerve */
            from.flight.w[0].y += 1e-12;
            break;
        case 1:
            from.flight.c[3].x = 1.0; /* an acceleration that changes */
            from.flight.w[2].x = 3.0;
            break;
        case 2:
            from.flight.w[0].x += 1e-3; /* a velocity that is not that of the displacement */
            break;
        case 3:
            from.work[0].path[1].x = 1.0;
            break;
        default:
            from.coefficients.k = from.coefficients.c = 0.0; /* no force */
            break;
        }
        CHECK(!(pair_is_head_on(&from) && pair_oscillation_make(&p, &from)));
    }
}

/* By a dashpot alone, from rest, to a drift or against one: g' decays to the drift, F_n is what balances the
 * load. */
static void a_dashpot_alone_is_a_drift(void)
{
    struct random r = {21};
    for (int k = 0; k < 2000; ++k) {
        struct model m = head_on(&r, random_power(&r, 3.0, 8.0));
        m.state.values.contact[0].penalty_control = PENALTY_CONTROL_VISCOUS_ONLY;
        compressed_begin(&m);
        struct scene_state *q = &m.state.motion;
        const struct scene_values *v = &m.state.values;
        const double energy = balance(&m);
        const struct contact_pair from = pair_of(&m);
        struct pair_oscillation p;
        CHECK(from.coefficients.k == 0.0 && pair_oscillation_make(&p, &from));
        const double longest = fmin(pair_oscillation_longest(&p), 1e3);
        const double s = longest * random_power(&r, -6.0, 0.0);
        const long double t = s / (long double)p.rate;
        const long double decay = from.coefficients.c / (long double)from.reduced_mass;
        const long double acceleration = -2.0L * from.flight.c[2].x; /* n = -x */
        const long double drift = acceleration / decay;
        const long double less = -(long double)from.flight.c[1].x - drift;
        const long double rate = drift + less * expl(-decay * t);
        const long double gap = from.gap + drift * t - less * expm1l(-decay * t) / decay;
        struct pair_sample at;
        pair_oscillation_sample(&p, s, &at);
        CHECK_CLOSE("gap", at.of[PAIR_GAP][0], gap, 32.0L * DBL_EPSILON * (fabsl(gap) + 1e-3L));
        CHECK_CLOSE("rate", at.of[PAIR_GAP_RATE][0], rate, 32.0L * DBL_EPSILON * (1.0L + s) * 4.0L);
        CHECK_CLOSE("force", at.of[PAIR_FORCE][0], -from.coefficients.c * rate,
                    32.0L * DBL_EPSILON * (1.0L + s) * 4.0L * from.coefficients.c);
        const struct pair_change change = pair_oscillation_change(&p, s);
        pair_apply(&from, &change, v, q, 0);
        q->clock += change.time;
        CHECK_CLOSE("balance", balance(&m), energy,
                    256.0L * DBL_EPSILON * (100.0L + 2000.0L * q->clock * (4.0L + 1e4L * q->clock)));
    }
}

static void what_is_said_to_last_lasts(void)
{
    struct random r = {20};
    int kept = 0;
    for (int k = 0; k < 5000; ++k) {
        const struct model m = head_on(&r, random_damping(&r, k));
        struct contact_pair from = pair_of(&m);
        struct pair_oscillation p;
        from.flight.c[1] = vec3_scale(0.1, from.flight.c[1]);
        from.flight.w[0] = from.flight.c[1];
        CHECK(pair_oscillation_make(&p, &from));
        const bool overlaps = pair_oscillation_stays_above(&p, PAIR_GAP, -1.0, 0.0);
        const bool presses = pair_oscillation_stays_above(&p, PAIR_FORCE, 1.0, 0.0);
        kept += overlaps && presses;
        for (int i = 0; i < 100; ++i) {
            struct pair_sample at;
            pair_oscillation_sample(&p, 0.2 * i, &at);
            CHECK(!overlaps || at.of[PAIR_GAP][0] < 0.0);
            CHECK(!presses || at.of[PAIR_FORCE][0] > 0.0);
        }
    }
    CHECK(kept > 100);
}

int main(void)
{
    CHECK_TEST(the_gap_is_that_of_a_loaded_damped_oscillator);
    CHECK_TEST(at_its_extrema_the_gap_stands);
    CHECK_TEST(a_step_keeps_momentum_and_energy);
    CHECK_TEST(other_motion_is_refused);
    CHECK_TEST(a_dashpot_alone_is_a_drift);
    CHECK_TEST(what_is_said_to_last_lasts);
    return check_summary("pair_oscillation");
}
