/* The force law against DESIGN's formulas, on a grid of depth, rate, factors, dashpot and regime. */
#include "contact/law.h"

#include <float.h>

#include "check.h"
#include "random.h"

static const double GAPS[] = {-1e-12, -1e-6, -3e-4, -0.02, -1.0, -50.0, 0.0, 1e-9, 2.0};
static const double RATES[] = {-300.0, -1.0, -1e-3, -1e-9, -0.0, 0.0, 1e-9, 1e-3, 0.5, 40.0};
static const double FACTORS[] = {0.0, 1.0, 1e3, 1e8};
static const enum dashpot DASHPOTS[] = {DASHPOT_NON_ADHESIVE, DASHPOT_UNCLAMPED, DASHPOT_APPROACH_ONLY};

enum { GAP_COUNT = 9, RATE_COUNT = 10, FACTOR_COUNT = 4, DASHPOT_COUNT = 3 };

typedef void law_claim(const struct contact_law *law, double gap, double rate);

/* Stiffness 0 is viscous only, damping 0 the undamped penalty method. */
static void on_the_grid(law_claim *claim)
{
    const int total = GAP_COUNT * RATE_COUNT * FACTOR_COUNT * FACTOR_COUNT * DASHPOT_COUNT;
    for (int i = 0; i < total; ++i) {
        int rest = i / GAP_COUNT;
        const double gap = GAPS[i % GAP_COUNT];
        const double rate = RATES[rest % RATE_COUNT];
        rest /= RATE_COUNT;
        const struct contact_law law = {FACTORS[rest % FACTOR_COUNT],
                                        FACTORS[rest / FACTOR_COUNT % FACTOR_COUNT],
                                        DASHPOTS[rest / FACTOR_COUNT / FACTOR_COUNT], LAW_LINEAR};
        claim(&law, gap, rate);
    }
}

/* F_n as DESIGN has it: spring and dashpot, then what the dashpot's kind does to them. */
static long double design_force(const struct contact_law *law, double gap, double rate, bool within)
{
    if (gap >= 0.0 || !within) {
        return 0.0L;
    }
    const long double spring = -(long double)law->stiffness * gap;
    const long double viscous = -(long double)law->damping * rate;
    switch (law->dashpot) {
    case DASHPOT_NON_ADHESIVE:
        return spring + viscous > 0.0L ? spring + viscous : 0.0L;
    case DASHPOT_APPROACH_ONLY:
        return rate < 0.0 ? spring + viscous : spring;
    case DASHPOT_UNCLAMPED:
    default:
        return spring + viscous;
    }
}

static double law_force(const struct contact_law *law, double gap, double rate, bool within)
{
    return contact_normal_force_of(law, contact_regime_of(law, gap, rate, within), gap, rate);
}

static double force_rounding(const struct contact_law *law, double gap, double rate)
{
    return 2.0 * DBL_EPSILON * (fabs(law->stiffness * gap) + fabs(law->damping * rate));
}

/* F_n = -(k g + c g') with the regime's constants. */
static void check_coefficients(const struct contact_law *law, double gap, double rate)
{
    const enum contact_regime regime = contact_regime_of(law, gap, rate, true);
    const struct contact_coefficients coefficients = contact_coefficients_of(law, regime);
    CHECK_CLOSE("-(k g + c g')", -(coefficients.k * gap + coefficients.c * rate),
                design_force(law, gap, rate, true), force_rounding(law, gap, rate));
}

static void a_regimes_constants_give_its_force(void)
{
    on_the_grid(check_coefficients);
}

/* Whether a regime still holds is the sign of its event function. */
static void check_event(const struct contact_law *law, double gap, double rate)
{
    if (gap >= 0.0) {
        return;
    }
    const enum contact_regime regime = contact_regime_of(law, gap, rate, true);
    CHECK(regime != REGIME_APART);
    if (law->damping == 0.0 || law->dashpot == DASHPOT_UNCLAMPED) {
        CHECK(regime == REGIME_COMPRESSION);
    }
    const bool compression = contact_event(law, REGIME_COMPRESSION, gap, rate) > 0.0;
    CHECK(compression == (regime == REGIME_COMPRESSION));
    if (law->dashpot == DASHPOT_APPROACH_ONLY && law->damping > 0.0 && rate != 0.0) {
        const bool restitution = contact_event(law, REGIME_RESTITUTION, gap, rate) > 0.0;
        CHECK(restitution == (regime == REGIME_RESTITUTION));
    }
    if (law->dashpot == DASHPOT_NON_ADHESIVE && law->damping > 0.0 && regime == REGIME_SEPARATING) {
        CHECK(contact_event(law, REGIME_SEPARATING, gap, rate) >= 0.0);
    } else if (law->dashpot == DASHPOT_NON_ADHESIVE && law->damping > 0.0) {
        CHECK(contact_event(law, REGIME_SEPARATING, gap, rate) < 0.0);
    }
    CHECK(contact_event(law, REGIME_APART, gap, rate) > 0.0);
}

static void a_regime_lasts_while_its_event_function_is_positive(void)
{
    on_the_grid(check_event);
}

static void regimes_change_where_the_design_says(void)
{
    const struct contact_law clipped = {8.0, 2.0, DASHPOT_NON_ADHESIVE, LAW_LINEAR};
    CHECK(contact_regime_of(&clipped, 0.0, -1.0, true) == REGIME_APART);
    CHECK(contact_regime_of(&clipped, -0.0, -1.0, true) == REGIME_APART);
    CHECK(contact_regime_of(&clipped, (double)NAN, -1.0, true) == REGIME_APART);
    CHECK(contact_regime_of(&clipped, -DBL_TRUE_MIN, -1.0, true) == REGIME_COMPRESSION);
    CHECK(contact_regime_of(&clipped, -0.25, 0.0, false) == REGIME_APART);
    /* 8 g + 2 g' = 0 without rounding */
    CHECK(contact_regime_of(&clipped, -0.25, 1.0, true) == REGIME_SEPARATING);
    CHECK(contact_regime_of(&clipped, -0.25, nextafter(1.0, 2.0), true) == REGIME_SEPARATING);
    CHECK(contact_regime_of(&clipped, -0.25, nextafter(1.0, 0.0), true) == REGIME_COMPRESSION);
    const struct contact_law approach = {8.0, 2.0, DASHPOT_APPROACH_ONLY, LAW_LINEAR};
    CHECK(contact_regime_of(&approach, -0.25, 0.0, true) == REGIME_RESTITUTION);
    CHECK(contact_regime_of(&approach, -0.25, -0.0, true) == REGIME_RESTITUTION);
    CHECK(contact_regime_of(&approach, -0.25, -DBL_TRUE_MIN, true) == REGIME_COMPRESSION);
    const struct contact_law tensile = {8.0, 2.0, DASHPOT_UNCLAMPED, LAW_LINEAR};
    CHECK_CLOSE("unclamped pull", law_force(&tensile, -0.25, 3.0, true), -4.0, 0.0);
    /* A clipped force stays at zero when the regime is a little behind the motion. */
    CHECK_CLOSE("clip", contact_normal_force_of(&clipped, REGIME_COMPRESSION, -0.25, 3.0), 0.0, 0.0);
}

/* Of functions linear in g and g': the slopes give every difference. */
static void check_slopes(const struct contact_law *law, double gap, double rate)
{
    const double other_gap = -0.75, other_rate = 0.5;
    for (int i = REGIME_APART; i <= REGIME_SEPARATING; ++i) {
        const enum contact_regime regime = (enum contact_regime)i;
        const struct contact_slopes force = contact_force_slopes(law, regime, gap, rate);
        const struct contact_slopes event = contact_event_slopes(law, regime, gap, rate);
        const double noise =
            2.0 * (force_rounding(law, gap, rate) + force_rounding(law, other_gap, other_rate)) +
            DBL_EPSILON * fabs(rate);
        CHECK_CLOSE("force",
                    contact_force(law, regime, gap, rate) - contact_force(law, regime, other_gap, other_rate),
                    force.by_gap * (gap - other_gap) + force.by_rate * (rate - other_rate), noise);
        CHECK_CLOSE("event",
                    contact_event(law, regime, gap, rate) - contact_event(law, regime, other_gap, other_rate),
                    event.by_gap * (gap - other_gap) + event.by_rate * (rate - other_rate), noise);
        const double step = contact_stored_slope(law, regime, gap) - contact_stored_slope(law, regime, -0.75);
        CHECK_CLOSE("dE_c/dg", step, contact_stored_bend(law, regime, gap) * (gap + 0.75), noise);
    }
}

static void the_slopes_are_those_of_force_event_and_energy(void)
{
    on_the_grid(check_slopes);
}

/* Along g = -1 + s / 2 - s^2, g' = s + 2 s^2, with p_n = 8 + 3 s and p_nv = 2 - s. */
static void the_terms_are_those_of_the_products(void)
{
    const struct contact_law law = {8.0, 2.0, DASHPOT_UNCLAMPED, LAW_LINEAR};
    const struct contact_law change = {3.0, -1.0, DASHPOT_UNCLAMPED, LAW_LINEAR};
    const double gap[3] = {-1.0, 0.5, -1.0}, rate[3] = {0.0, 1.0, 2.0};
    const double force[3] = {8.0, -3.0, 3.5}, stored[3] = {4.0, -2.5, 7.5}, lost[3] = {0.0, 0.0, -1.0};
    double made[3];
    for (int i = 0; i < 3; ++i) {
        made[i] = contact_force_term(&law, &change, REGIME_COMPRESSION, gap, rate, i);
        CHECK_CLOSE("force", made[i], force[i], 0.0);
        CHECK_CLOSE("E_c", contact_stored_term(&law, &change, REGIME_COMPRESSION, gap, i), stored[i], 0.0);
        CHECK_CLOSE("constant", contact_force_term(&law, NULL, REGIME_COMPRESSION, gap, rate, i),
                    -(8.0 * gap[i] + 2.0 * rate[i]), 0.0);
        CHECK_CLOSE("power", contact_dissipated_term(&law, REGIME_COMPRESSION, made, gap, rate, i), lost[i],
                    0.0);
        CHECK_CLOSE("apart", contact_stored_term(&law, &change, REGIME_APART, gap, i), 0.0, 0.0);
    }
}

int main(void)
{
    CHECK_TEST(a_regimes_constants_give_its_force);
    CHECK_TEST(a_regime_lasts_while_its_event_function_is_positive);
    CHECK_TEST(regimes_change_where_the_design_says);
    CHECK_TEST(the_slopes_are_those_of_force_event_and_energy);
    CHECK_TEST(the_terms_are_those_of_the_products);
    return check_summary("law");
}
