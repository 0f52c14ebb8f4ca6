#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "contact/law.h"
#include "math/compiler.h"
#include "math/series.h"

bool contact_is_hertz(const struct contact_law *law)
{
    return CONTACT_ANY_HERTZ && law->law == LAW_HERTZ;
}

bool contact_has_events(const struct contact_law *law)
{
    return law->damping > 0.0 && law->dashpot != DASHPOT_UNCLAMPED;
}

bool contact_is_elastic(const struct contact_law *law)
{
    return !(law->damping > 0.0);
}

bool contact_may_pull(const struct contact_law *law)
{
    return law->dashpot == DASHPOT_UNCLAMPED && !contact_is_elastic(law);
}

double contact_linear_force(struct contact_coefficients linear, double gap, double gap_rate)
{
    return -(linear.k * gap + linear.c * gap_rate);
}

/* Returns delta^(3/2) [m^1.5] with delta = -g, or zero for g >= 0. */
static double three_halves(double gap)
{
    return gap < 0.0 ? -gap * sqrt(-gap) : 0.0;
}

/* Sets the Taylor coefficients 0..order of the spring's force per stiffness: of -g, or under Hertz's law of
 * delta^(3/2), which is zero where the path begins at g >= 0. */
static void put_spring_terms(const struct contact_law *law, const double *gap, int order,
                             double spring[TAYLOR_TERMS])
{
    double depth[TAYLOR_TERMS];
    for (int i = 0; i <= order; ++i) {
        depth[i] = -gap[i];
        spring[i] = !contact_is_hertz(law) ? depth[i]
                    : depth[0] > 0.0       ? taylor_power(depth, 1.5, spring, i)
                                           : 0.0;
    }
}

double hertz_modulus(struct contact_material source, struct contact_material destination)
{
    const double nu_s = source.poissons_ratio;
    const double nu_d = destination.poissons_ratio;
    return 1.0 / ((1.0 - nu_s) * (1.0 + nu_s) / source.youngs_modulus +
                  (1.0 - nu_d) * (1.0 + nu_d) / destination.youngs_modulus);
}

double mindlin_ratio(struct contact_material source, struct contact_material destination)
{
    const double nu_s = source.poissons_ratio;
    const double nu_d = destination.poissons_ratio;
    return 2.0 /
           (hertz_modulus(source, destination) * ((2.0 - nu_s) * (1.0 + nu_s) / source.youngs_modulus +
                                                  (2.0 - nu_d) * (1.0 + nu_d) / destination.youngs_modulus));
}

/* Whether a condition is unmet at x. The condition is met at every x above some threshold. */
typedef bool unmet_condition(double x, double wanted);

/* Returns the threshold in [0, high] above which the condition is met, to rounding, by some sixty bisections.
 * A method with derivatives would lose digits where two branches of a formula meet. */
static double first_met(unmet_condition *unmet, double wanted, double high)
{
    double low = 0.0;
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high)) {
            return middle;
        }
        *(unmet(middle, wanted) ? &low : &high) = middle;
    }
}

/* The complete elliptic integrals K and E as k = K and part = (K - E)/(e^2 K). The difference K - E itself
 * would cancel for a nearly circular contact, where e = 0. */
struct elliptic {
    double k, part;
};

/*
 * Computes k and part for the ratio k' of the semi-axes by the arithmetic-geometric mean (agm) of 1 and k'. K
 * is pi / (2 agm); (K - E)/K is the sum of 2^(n-1) c_n^2, where c_0 = e and c_n is half the difference of the
 * preceding means, so that c_1^2 / e^2 = (1 - k')/(4 (1 + k')). Source: Abramowitz and Stegun, 17.6.
 */
static struct elliptic elliptic_of(double ratio)
{
    double a = 0.5 * (1.0 + ratio);
    double b = sqrt(ratio);
    double difference = 0.5 * (1.0 - ratio);
    double square = 0.25 * (1.0 - ratio) / (1.0 + ratio); /* c_n^2 / e^2 */
    double part = 0.5 + square;
    for (double power = 2.0; difference > DBL_EPSILON * a; power *= 2.0) {
        const double shrinks = 0.5 * (a - b) / difference; /* c_(n+1) / c_n */
        square *= shrinks * shrinks;
        part += power * square;
        difference = 0.5 * (a - b);
        const double mean = 0.5 * (a + b);
        b = sqrt(a * b);
        a = mean;
    }
    return (struct elliptic){0.5 * PI / a, part};
}

/* Whether the ratio k' gives a value of A / B below the wanted one; A / B rises with k'. */
static bool is_too_oblong(double ratio, double curvature_ratio)
{
    const double part = elliptic_of(ratio).part;
    return ratio * ratio * part < curvature_ratio * (1.0 - part);
}

/* Returns k_h [N/m^1.5] from E* [Pa] and the coefficients 0 < A <= B [1/m] of the surfaces' distance. */
CONTACT_COLD static double hertz_elliptic_stiffness(double modulus, double a, double b)
{
    if (!(a < b)) {
        return 4.0 / 3.0 * modulus / sqrt(2.0 * a);
    }
    const struct elliptic at = elliptic_of(first_met(is_too_oblong, a / b, 1.0));
    return 2.0 / 3.0 * PI * modulus * sqrt(at.part / a) / at.k;
}

/* Returns the stiffness of two cylinders whose axes meet at an angle with this sine. The curvatures 1/r_s and
 * 1/r_d at this angle give A + B = (1/r_s + 1/r_d)/2 and A B = sine^2/(4 r_s r_d) (K. L. Johnson, Contact
 * Mechanics, 1985, eq. 4.4), and A = (A B)/B is accurate for axes that are nearly parallel too. */
static double hertz_crossed_stiffness(double modulus, double r_s, double r_d, double sine)
{
    const double sum = 0.5 * (1.0 / r_s + 1.0 / r_d);
    const double apart = 0.5 * (1.0 / r_s - 1.0 / r_d);
    const double product = 0.25 * sine * sine / (r_s * r_d);
    const double cosine2 = (1.0 - sine) * (1.0 + sine);
    const double b = 0.5 * (sum + sqrt(apart * apart + cosine2 / (r_s * r_d)));
    return hertz_elliptic_stiffness(modulus, fmin(product / b, b), b);
}

double hertz_stiffness(const struct contact_shape *shape, double modulus)
{
    const double r_s = shape->source_radius;
    const double r_d = shape->other_radius;
    const double alone = 0.5 / r_s; /* both A and B on a plane, one of them along a cylinder [1/m] */
    if (contact_is_skew(shape)) {
        return hertz_crossed_stiffness(modulus, r_s, r_d, contact_skew_frame(&shape->solid)->sine);
    }
    /* the coefficient is half of 1/r_s + 1/r_d outside, half of 1/r_s - 1/r_d inside */
    const double curved = contact_is_plane(shape) ? alone : 0.5 * (r_d + shape->side * r_s) / r_s / r_d;
    double along = contact_is_cylinder(shape) ? alone : curved;
    if (contact_is_torus(shape)) { /* the tube's middle line is curved at the bottom of a race */
        const double inward = shape->solid.race;
        along = alone - 0.5 * shape->side * inward / (shape->solid.radius - inward * r_d);
    }
    return hertz_elliptic_stiffness(modulus, fmin(along, curved), fmax(along, curved));
}

/*
 * The damping that gives a free head-on impact the coefficient of restitution e: the speed after the impact
 * divided by the speed before. In a free impact no force but the contact force acts on the bodies. The
 * damping is computed once, when the contact is prepared.
 */

/*
 * This is the least coefficient of restitution of the linear law with a non-adhesive or an approach-only
 * dashpot; a smaller one counts as this, because only an infinite dashpot would give 0. A ball that leaves
 * with a millionth of its speed rises by 1e-12 of its drop height.
 */
#define RESTITUTION_LEAST 1e-6

/*
 * This is the least coefficient of restitution of Hertz's law; a smaller one counts as this. Near it chi v is
 * about 1/e, or 2/e^2 with an approach-only dashpot, and an integration takes steps in proportion to chi v:
 * some ten thousand at 2e6. The rebound then keeps a millionth of the kinetic energy.
 */
#define RESTITUTION_LEAST_HERTZ 1e-3

/* Whether h(zeta) of restitution_damping_ratio is below `loss`; h rises from 0 without bound. */
static bool loses_less(double ratio, double loss)
{
    const double square = (1.0 - ratio) * (1.0 + ratio);
    const double h = square == 0.0  ? 1.0
                     : square > 0.0 ? ratio * acos(ratio) / sqrt(square)
                                    : ratio * acosh(ratio) / sqrt(-square);
    return h < loss;
}

/*
 * Returns the damping ratio zeta = p_nv / (2 sqrt(p_n m_red)) of the linear law for e in [0, 1].
 *
 *   unclamped       contact ends at g = 0:      e = exp(-pi zeta / sqrt(1 - zeta^2)); e = 0: zeta = 1
 *   non-adhesive    contact ends at F_n = 0:    e = exp(-2 h(zeta))
 *   approach-only   the spring alone returns:   e = exp(-h(zeta))
 *
 *   h(cos t) = t cot t up to critical damping, h(cosh t) = t coth t beyond.
 *
 * Source: the oscillator x'' + 2 zeta x' + x = 0 starts at x = 0 with x' = 1. Its largest x is exp(-h); the
 * spring alone turns this x into a return speed of exp(-h). With the dashpot the force ends where x + 2 zeta
 * x' = 0, and the oscillator leaves there with x' = -exp(-2 h). Both branches of T. Schwager, T. Poeschel,
 * Granular Matter 9 (2007) 465, are in this one formula.
 */
double restitution_damping_ratio(double restitution, enum dashpot dashpot)
{
    if (dashpot == DASHPOT_UNCLAMPED) {
        const double loss = 0.0 - log(restitution); /* the subtraction from 0.0 avoids a negative zero */
        return restitution > 0.0 ? loss / sqrt(PI * PI + loss * loss) : 1.0;
    }
    const double loss = 0.0 - log(fmax(restitution, RESTITUTION_LEAST));
    const double h = dashpot == DASHPOT_NON_ADHESIVE ? 0.5 * loss : loss;
    /* h(cosh t) = t coth t >= t bounds the damping ratio: cosh t <= cosh h < exp h */
    return h > 0.0 ? first_met(loses_less, h, exp(h)) : 0.0;
}

/* Largest y for which a power series replaces the formulas with logarithms, which lose digits at small y. */
static const double SMALL = 0.5;

/* Returns (ln(1 + x) - x + x^2/2) / x^3 = 1/3 - x/4 + x^2/5 - ... for |x| <= SMALL. The terms after x^60 are
 * less than the rounding. */
static double logarithm_rest(double x)
{
    double sum = 0.0;
    for (int i = 60; i >= 0; --i) {
        sum = 1.0 / (i + 3) - x * sum;
    }
    return sum;
}

/* Whether y = chi v is too small for the coefficient of restitution e with full damping: ln((1 + y)/(1 - e
 * y)) < y (1 + e). Both sides are divided by y^2 (1 + e) where y is small. */
static bool dissipates_too_little(double y, double e)
{
    if (y <= SMALL) {
        return y * (logarithm_rest(y) + e * e * e * logarithm_rest(-e * y)) < 0.5 * (1.0 - e) * (1.0 + e);
    }
    return log1p(y) - log1p(-e * y) < y * (1.0 + e);
}

/* Whether y = chi v is too small for the coefficient of restitution e with an approach-only dashpot: e^2 <
 * 2 (y - ln(1 + y))/y^2. */
static bool returns_too_fast(double y, double e)
{
    if (y <= SMALL) {
        return 2.0 * y * logarithm_rest(y) < (1.0 - e) * (1.0 + e);
    }
    return e * e < 2.0 * (y - log1p(y)) / y / y;
}

/*
 * Returns the number y = chi v [1] of Hunt and Crossley's law for e in [0, 1], with the approach speed v at
 * the onset of contact. The number depends neither on the spring's stiffness nor on its exponent.
 *
 *   full damping    y (1 + e) = ln((1 + y)/(1 - e y)); the force then never pulls: unclamped is non-adhesive
 *   approach-only   e^2 = 2 (y - ln(1 + y))/y^2
 *
 * Source: the energy E of the spring and the approach speed v obey v dv/dE = -(1 + chi v)/m. This equation is
 * integrated from the touch to the deepest point, which gives E = (m/chi^2)(y - ln(1 + y)), and back.
 * Marhefka and Orin, IEEE Transactions on Systems, Man, and Cybernetics A 29 (1999) 566.
 */
double restitution_hunt_crossley(double restitution, enum dashpot dashpot)
{
    const double e = fmax(restitution, RESTITUTION_LEAST_HERTZ);
    if (e >= 1.0) {
        return 0.0;
    }
    /* upper bounds of y: 1/e because 1 - e y > 0, and 2/e^2 because 2 (y - ln(1 + y))/y^2 < 2/y */
    return dashpot == DASHPOT_APPROACH_ONLY ? first_met(returns_too_fast, e, 2.0 / (e * e))
                                            : first_met(dissipates_too_little, e, 1.0 / e);
}

struct contact_coefficients contact_factors_of(const struct contact_law *law, enum contact_regime regime)
{
    const bool pushes = regime == REGIME_COMPRESSION || regime == REGIME_RESTITUTION;
    return (struct contact_coefficients){pushes ? law->stiffness : 0.0,
                                         regime == REGIME_COMPRESSION ? law->damping : 0.0};
}

enum contact_regime contact_regime_of(const struct contact_law *law, double gap, double gap_rate, bool within)
{
    if (!(gap < 0.0) || !within) {
        return REGIME_APART;
    }
    const bool has_left = contact_event(law, REGIME_COMPRESSION, gap, gap_rate) <= 0.0;
    return has_left ? contact_regime_after(law, REGIME_COMPRESSION) : REGIME_COMPRESSION;
}

double contact_force(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate)
{
    const struct contact_coefficients at = contact_factors_of(law, regime);
    if (at.k == 0.0 && at.c == 0.0) {
        return 0.0;
    }
    return contact_is_hertz(law) ? at.k * three_halves(gap) * (1.0 - at.c * gap_rate)
                                 : contact_linear_force(at, gap, gap_rate);
}

struct contact_slopes contact_force_slopes(const struct contact_law *law, enum contact_regime regime,
                                           double gap, double gap_rate)
{
    const struct contact_coefficients at = contact_factors_of(law, regime);
    if (!contact_is_hertz(law)) {
        return (struct contact_slopes){-at.k, -at.c};
    }
    const double spring = gap < 0.0 ? -1.5 * at.k * sqrt(-gap) : 0.0;
    return (struct contact_slopes){spring * (1.0 - at.c * gap_rate), -at.k * three_halves(gap) * at.c};
}

/* Along the path a change of k_h scales the whole force of Hertz's law, a change of chi only its viscous
 * part. */
double contact_force_term(const struct contact_law *law, const struct contact_law *change,
                          enum contact_regime regime, const double *gap, const double *gap_rate, int order)
{
    const struct contact_coefficients at = contact_factors_of(law, regime);
    const struct contact_coefficients slope = contact_factors_of(change, regime);
    double spring[TAYLOR_TERMS];
    if (!contact_is_hertz(law)) {
        const double force = contact_linear_force(at, gap[order], gap_rate[order]);
        return order > 0 ? force + contact_linear_force(slope, gap[order - 1], gap_rate[order - 1]) : force;
    }
    put_spring_terms(law, gap, order, spring);
    double force = at.k * (spring[order] - at.c * taylor_multiply(spring, gap_rate, order));
    if (order > 0) {
        const double viscous = taylor_multiply(spring, gap_rate, order - 1);
        force += slope.k * (spring[order - 1] - at.c * viscous) - at.k * slope.c * viscous;
    }
    return force;
}

double contact_event(const struct contact_law *law, enum contact_regime regime, double gap, double gap_rate)
{
    if (regime == REGIME_APART || !contact_has_events(law)) {
        return 1.0;
    }
    const double within =
        law->dashpot == DASHPOT_APPROACH_ONLY ? -gap_rate : contact_push(law, gap, gap_rate);
    return regime == REGIME_COMPRESSION ? within : -within;
}

struct contact_slopes contact_event_slopes(const struct contact_law *law, enum contact_regime regime)
{
    const double sign = regime == REGIME_COMPRESSION ? 1.0 : -1.0;
    const bool by_rate_alone = law->dashpot == DASHPOT_APPROACH_ONLY || contact_is_hertz(law);
    if (regime == REGIME_APART || !contact_has_events(law)) {
        return (struct contact_slopes){0.0, 0.0};
    }
    return (struct contact_slopes){by_rate_alone ? 0.0 : -sign * law->stiffness,
                                   law->dashpot == DASHPOT_APPROACH_ONLY ? -sign : -sign * law->damping};
}

enum contact_regime contact_regime_after(const struct contact_law *law, enum contact_regime regime)
{
    if (regime != REGIME_COMPRESSION) {
        return REGIME_COMPRESSION;
    }
    return law->dashpot == DASHPOT_NON_ADHESIVE ? REGIME_SEPARATING : REGIME_RESTITUTION;
}

double contact_push(const struct contact_law *law, double gap, double gap_rate)
{
    return contact_is_hertz(law) ? 1.0 - law->damping * gap_rate
                                 : contact_force(law, REGIME_COMPRESSION, gap, gap_rate);
}

double contact_stored_energy(const struct contact_law *law, enum contact_regime regime, double gap)
{
    return regime == REGIME_APART  ? 0.0
           : contact_is_hertz(law) ? 0.4 * law->stiffness * three_halves(gap) * fmax(-gap, 0.0)
                                   : 0.5 * law->stiffness * gap * gap;
}

double contact_stored_slope(const struct contact_law *law, enum contact_regime regime, double gap)
{
    return regime == REGIME_APART ? 0.0 : -contact_force(law, REGIME_RESTITUTION, gap, 0.0);
}

/* The energy is half of the spring's force times the depth, 2/5 of it under Hertz's law. */
double contact_stored_term(const struct contact_law *law, const struct contact_law *change,
                           enum contact_regime regime, const double *gap, int order)
{
    const double part = contact_is_hertz(law) ? 0.4 : 0.5;
    double spring[TAYLOR_TERMS];
    put_spring_terms(law, gap, order, spring);
    const double changed = order > 0 ? change->stiffness * taylor_multiply(spring, gap, order - 1) : 0.0;
    const double energy = -part * (law->stiffness * taylor_multiply(spring, gap, order) + changed);
    return regime == REGIME_APART ? 0.0 : energy;
}

double contact_dissipated_term(const struct contact_law *law, enum contact_regime regime,
                               const double *normal_force, const double *gap, const double *gap_rate,
                               int order)
{
    double viscous[TAYLOR_TERMS]; /* F_n + dE_c/dg */
    double spring[TAYLOR_TERMS];
    put_spring_terms(law, gap, order, spring);
    for (int i = 0; i <= order; ++i) {
        viscous[i] = normal_force[i] - law->stiffness * spring[i];
    }
    return regime == REGIME_APART ? 0.0 : -taylor_multiply(viscous, gap_rate, order);
}
