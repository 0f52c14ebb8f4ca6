/* Hertz's law with Hunt and Crossley's damping, and the stiffness of Hertz's theory. */
#include <float.h>

#include "check.h"
#include "contact/law.h"
#include "math/series.h"
#include "random.h"

static const enum dashpot DASHPOTS[] = {DASHPOT_NON_ADHESIVE, DASHPOT_UNCLAMPED, DASHPOT_APPROACH_ONLY};

/* F_n as DESIGN has it. */
static long double design_force(const struct contact_law *law, double gap, double rate)
{
    const long double depth = -(long double)gap;
    if (depth <= 0.0L) {
        return 0.0L;
    }
    const bool damped = law->dashpot != DASHPOT_APPROACH_ONLY || rate < 0.0;
    const long double factor = damped ? 1.0L - (long double)law->damping * rate : 1.0L;
    const bool clipped = law->dashpot == DASHPOT_NON_ADHESIVE && factor < 0.0L;
    return clipped ? 0.0L : law->stiffness * depth * sqrtl(depth) * factor;
}

static void the_force_is_that_of_the_design_and_its_slopes_are_its_differences(void)
{
    struct random r = {5};
    for (int i = 0; i < 30000; ++i) {
        const struct contact_law law = {random_power(&r, -6.0, 13.0), random_power(&r, -9.0, 6.0),
                                        DASHPOTS[i % 3], LAW_HERTZ};
        const double gap = -random_power(&r, -15.0, 1.0);
        const double rate = random_sign(&r) * random_power(&r, -9.0, 3.0);
        const enum contact_regime regime = contact_regime_of(&law, gap, rate, true);
        const double force = contact_normal_force_of(&law, regime, gap, rate);
        const double spring = law.stiffness * pow(-gap, 1.5);
        const double size = spring * (1.0 + law.damping * fabs(rate));
        CHECK_CLOSE("F_n", force, design_force(&law, gap, rate), 4.0 * DBL_EPSILON * size);
        CHECK_CLOSE("beyond the ends", contact_force(&law, REGIME_APART, gap, rate), 0.0, 0.0);
        CHECK_CLOSE("apart", contact_force(&law, REGIME_COMPRESSION, -gap, rate), 0.0, 0.0);
        CHECK(force >= 0.0 || law.dashpot == DASHPOT_UNCLAMPED);
        /* by central differences of a part h, with errors of h^2 */
        const struct contact_slopes slopes = contact_force_slopes(&law, regime, gap, rate);
        const double h = 1e-5;
        const double by_gap = (contact_force(&law, regime, gap * (1.0 + h), rate) -
                               contact_force(&law, regime, gap * (1.0 - h), rate)) /
                              (2.0 * h * gap);
        const double by_rate = (contact_force(&law, regime, gap, rate * (1.0 + h)) -
                                contact_force(&law, regime, gap, rate * (1.0 - h))) /
                               (2.0 * h * rate);
        CHECK_CLOSE("dF/dg", slopes.by_gap, by_gap, 1e-9 * size / -gap);
        CHECK_CLOSE("dF/dg'", slopes.by_rate, by_rate, 1e-9 * size / fabs(rate));
        const double energy = contact_stored_energy(&law, regime, gap);
        CHECK_CLOSE("E_c", energy, 0.4L * law.stiffness * powl(-(long double)gap, 2.5L),
                    8.0 * DBL_EPSILON * energy);
        CHECK_CLOSE("dE/dg", contact_stored_slope(&law, regime, gap), -spring, 8.0 * DBL_EPSILON * spring);
        CHECK_CLOSE("d2E/dg2", contact_stored_bend(&law, regime, gap), 1.5 * spring / -gap,
                    8.0 * DBL_EPSILON * spring / -gap);
        CHECK_CLOSE("power", contact_dissipated_power(&law, regime, force, gap, rate),
                    -((long double)force - spring) * rate, 8.0 * DBL_EPSILON * size * fabs(rate));
    }
}

/* Along g = -(1 + s)^2: delta^(3/2) = (1 + s)^3, delta^(5/2) = (1 + s)^5; g' = -2 - 2 s, k = 2 + s, chi = 3 -
 * s. */
static void the_terms_are_those_of_powers_of_a_square(void)
{
    const struct contact_law law = {2.0, 3.0, DASHPOT_UNCLAMPED, LAW_HERTZ};
    const struct contact_law change = {1.0, -1.0, DASHPOT_UNCLAMPED, LAW_HERTZ};
    const double gap[3] = {-1.0, -2.0, -1.0}, rate[3] = {-2.0, -2.0, 0.0};
    /* k (1 + s)^3 (1 + 2 chi (1 + s)): constant factors, then changing ones */
    const double constant[3] = {14.0, 54.0, 78.0}, changing[3] = {14.0, 57.0, 91.0};
    const double stored[3] = {0.8, 4.4, 10.0}; /* 0.4 (2 + s) (1 + s)^5 */
    double made[3];
    for (int i = 0; i < 3; ++i) {
        made[i] = contact_force_term(&law, NULL, REGIME_COMPRESSION, gap, rate, i);
        CHECK_CLOSE("force", made[i], constant[i], 1e-13);
        CHECK_CLOSE("stored", contact_stored_term(&law, &change, REGIME_COMPRESSION, gap, i), stored[i],
                    1e-13);
    }
    CHECK_CLOSE("changing", contact_force_term(&law, &change, REGIME_COMPRESSION, gap, rate, 1), changing[1],
                1e-13);
    /* -(F - 2 (1 + s)^3) g' = 24 (1 + s)^5 */
    const double lost[3] = {24.0, 120.0, 240.0};
    for (int i = 0; i < 3; ++i) {
        CHECK_CLOSE("power", contact_dissipated_term(&law, REGIME_COMPRESSION, made, gap, rate, i), lost[i],
                    1e-12);
    }
    const double depth[3] = {4.0, 4.0, 1.0};
    double power[TAYLOR_TERMS] = {0.0};
    const double cube[3] = {8.0, 12.0, 6.0};
    for (int i = 0; i < 3; ++i) {
        power[i] = taylor_power(depth, 1.5, power, i);
        CHECK_CLOSE("(2 + s)^3", power[i], cube[i], 1e-13);
    }
}

static void a_regime_ends_where_the_damping_would_pull(void)
{
    const struct contact_law law = {1e9, 4.0, DASHPOT_NON_ADHESIVE, LAW_HERTZ};
    CHECK(contact_regime_of(&law, -DBL_TRUE_MIN, 0.1, true) == REGIME_COMPRESSION);
    CHECK(contact_regime_of(&law, -1e-3, 0.25, true) == REGIME_SEPARATING);
    CHECK(contact_regime_of(&law, -1e-3, nextafter(0.25, 0.0), true) == REGIME_COMPRESSION);
    CHECK_CLOSE("compression", contact_event(&law, REGIME_COMPRESSION, -1e-3, 0.125), 0.5, 0.0);
    CHECK_CLOSE("separating", contact_event(&law, REGIME_SEPARATING, -1e-3, 0.5), 1.0, 0.0);
    const double gap[2] = {-1.0, 0.5}, rate[2] = {0.5, 2.0};
    CHECK_CLOSE("its value", contact_separating_event_term(&law, gap, rate, 0), 1.0, 0.0);
    CHECK_CLOSE("its slope", contact_separating_event_term(&law, gap, rate, 1), 8.0, 0.0);
    CHECK_CLOSE("by g'", contact_event_slopes(&law, REGIME_SEPARATING, -1.0, 0.5).by_rate, 4.0, 0.0);
    const struct contact_law undamped = {1e9, 0.0, DASHPOT_NON_ADHESIVE, LAW_HERTZ};
    CHECK(!contact_has_events(&undamped) && contact_is_elastic(&undamped));
}

/* T. A. Harris, Rolling Bearing Analysis (4th ed., 2001), table 6.1: F = (B - A)/(B + A) and delta*, with
 * delta = delta* (3 Q/(2 S E*))^(2/3) S/2, S = 2 (A + B). Four digits of delta*. */
static void elliptic_contacts_are_as_tabulated(void)
{
    static const double TABLE[][2] = {
        {0.1075, 0.9974},  {0.3204, 0.9761},  {0.5916, 0.9077},   {0.6716, 0.8733},   {0.7332, 0.8394},
        {0.7948, 0.7961},  {0.83495, 0.7602}, {0.87366, 0.7169},  {0.90999, 0.6636},  {0.93657, 0.6112},
        {0.95738, 0.5551}, {0.97290, 0.4960}, {0.983797, 0.4352}, {0.990902, 0.3745}, {0.995112, 0.3176}};
    for (int i = 0; i < 15; ++i) {
        const double f = TABLE[i][0];
        const double stiffness = hertz_elliptic_stiffness(2.0, 0.5 * (1.0 - f), 0.5 * (1.0 + f)); /* S = 2 */
        CHECK_CLOSE("delta*", pow(4.0 * 2.0 / 3.0 / stiffness, 2.0 / 3.0), TABLE[i][1], 1e-4);
    }
}

static struct contact_shape shape_of(enum shape destination, int side, double r_s, double r_d)
{
    return (struct contact_shape){.source_radius = r_s,
                                  .other_radius = r_d,
                                  .half_length = (double)INFINITY,
                                  .side = side,
                                  .destination = destination,
                                  .axis = {0.0, 0.0, 1.0}};
}

static void round_contacts_have_the_relative_radius(void)
{
    const struct contact_material steel = {2.1e11, 0.3}, rubber = {1e7, 0.5};
    const double modulus = hertz_modulus(steel, rubber);
    CHECK_CLOSE("E*", modulus, 1.0L / (0.91L / 2.1e11L + 0.75L / 1e7L), 1e-15 * modulus);
    const struct contact_shape out = shape_of(SHAPE_SPHERE, 1, 0.1, 0.4),
                               in = shape_of(SHAPE_SPHERE, -1, 0.1, 0.4);
    CHECK_CLOSE("outside", hertz_stiffness(&out, 3.0), 4.0 * sqrt(0.04 / 0.5), 1e-15);
    CHECK_CLOSE("inside", hertz_stiffness(&in, 3.0), 4.0 * sqrt(0.04 / 0.3), 4e-15);
    /* a cylinder of no curvature is a plane, on either side */
    for (int side = -1; side <= 1; side += 2) {
        const struct contact_shape flat = shape_of(SHAPE_CYLINDER, side, 0.25, 1e18);
        CHECK_CLOSE("plane", hertz_stiffness(&flat, 3.0), 2.0, 1e-14);
    }
    const struct contact_shape tight = shape_of(SHAPE_CYLINDER, -1, 0.91, 1.0),
                               loose = shape_of(SHAPE_CYLINDER, -1, 0.89, 1.0);
    CHECK(hertz_is_conforming(&tight) && !hertz_is_conforming(&loose) && !hertz_is_conforming(&out));
    CHECK(hertz_stiffness(&tight, 3.0) > hertz_stiffness(&loose, 3.0));
}

/* Of full damping, zero at chi v = y: negative below it. In long double; infinite where e y reaches 1. */
static long double full_damping(long double y, long double e)
{
    return e * y < 1.0L ? log1pl(y) - log1pl(-e * y) - y * (1.0L + e) : (long double)INFINITY;
}

static void restitution_solves_its_equation(void)
{
    const long double part = 32.0L * DBL_EPSILON;
    for (int i = 1; i < 200; ++i) {
        const double e = i / 200.0;
        const long double y = restitution_hunt_crossley(e, DASHPOT_UNCLAMPED);
        const long double z = restitution_hunt_crossley(e, DASHPOT_APPROACH_ONLY);
        CHECK(full_damping(y * (1.0L - part), e) < 0.0L && full_damping(y * (1.0L + part), e) > 0.0L);
        CHECK_CLOSE("approach", 2.0L * (z - log1pl(z)) / z / z, (long double)e * e, 1e-15L);
        CHECK(restitution_hunt_crossley(e, DASHPOT_NON_ADHESIVE) == (double)y);
    }
    CHECK_CLOSE("1", restitution_hunt_crossley(1.0, DASHPOT_NON_ADHESIVE), 0.0, 0.0);
    CHECK(restitution_hunt_crossley(0.0, DASHPOT_NON_ADHESIVE) ==
          restitution_hunt_crossley(RESTITUTION_LEAST_HERTZ, DASHPOT_UNCLAMPED));
}

static void the_factors_follow_the_controls(void)
{
    struct contact_factors factors = {.law = LAW_HERTZ,
                                      .method = METHOD_PENALTY_DYNAMIC,
                                      .hertz_stiffness = 7e9,
                                      .hunt_crossley_factor = 0.3,
                                      .characteristic_time = 1e-3,
                                      .restitution = 0.5,
                                      .viscous_control = VISCOUS_CONTROL_USER_DEFINED};
    CHECK_CLOSE("k_h", contact_law_of(&factors, DASHPOT_UNCLAMPED, 2.0).stiffness, 7e9, 0.0);
    CHECK_CLOSE("chi", contact_law_of(&factors, DASHPOT_UNCLAMPED, 2.0).damping, 0.3, 0.0);
    factors.viscous_control = VISCOUS_CONTROL_AUTOMATIC;
    const struct contact_law law = contact_law_of(&factors, DASHPOT_UNCLAMPED, 2.0);
    CHECK_CLOSE("tau_n / diag", law.damping, 5e-4, 1e-19);
    CHECK_CLOSE("its slope", contact_law_slope(&factors, contact_factors_of(&law), 3.0).damping, -7.5e-4,
                1e-18);
    factors.method = METHOD_PENALTY;
    CHECK_CLOSE("undamped", contact_law_of(&factors, DASHPOT_UNCLAMPED, 2.0).damping, 0.0, 0.0);
}

int main(void)
{
    CHECK_TEST(the_force_is_that_of_the_design_and_its_slopes_are_its_differences);
    CHECK_TEST(the_terms_are_those_of_powers_of_a_square);
    CHECK_TEST(a_regime_ends_where_the_damping_would_pull);
    CHECK_TEST(elliptic_contacts_are_as_tabulated);
    CHECK_TEST(round_contacts_have_the_relative_radius);
    CHECK_TEST(restitution_solves_its_equation);
    CHECK_TEST(the_factors_follow_the_controls);
    return check_summary("hertz");
}
