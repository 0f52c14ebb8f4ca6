#include "contact/restitution.h"

#include <math.h>
#include <stdbool.h>

#include "math/pi.h"

/* Whether a condition is still unmet at x; it is met from some place on. */
typedef bool restitution_condition(double x, double wanted);

/* That place to rounding, by bisection: some sixty halvings, and no derivative that would lose its digits
 * where two branches of a formula meet. */
static double first_met(restitution_condition *unmet, double wanted, double low, double high)
{
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high)) {
            return middle;
        }
        if (unmet(middle, wanted)) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/* h of the damping ratio; it rises from 0 without end. */
static double loss_of(double ratio)
{
    const double square = (1.0 - ratio) * (1.0 + ratio);
    if (square == 0.0) {
        return 1.0;
    }
    return square > 0.0 ? ratio * acos(ratio) / sqrt(square) : ratio * acosh(ratio) / sqrt(-square);
}

static bool loses_less(double ratio, double loss)
{
    return loss_of(ratio) < loss;
}

double restitution_damping_ratio(double restitution, enum dashpot dashpot)
{
    if (dashpot == DASHPOT_UNCLAMPED) {
        const double loss = 0.0 - log(restitution); /* no negative zero */
        return restitution > 0.0 ? loss / sqrt(PI * PI + loss * loss) : 1.0;
    }
    const double loss = 0.0 - log(fmax(restitution, RESTITUTION_LEAST));
    const double h = dashpot == DASHPOT_NON_ADHESIVE ? 0.5 * loss : loss;
    /* h(cosh t) = t coth t >= t, so that the ratio is at most cosh h < exp h. */
    return h > 0.0 ? first_met(loses_less, h, 0.0, exp(h)) : 0.0;
}

/* Below this the formulas with logarithms lose digits, and series stand for them. */
static const double SMALL = 0.5;

/* (ln(1 + x) - x + x^2/2) / x^3 = 1/3 - x/4 + x^2/5 - ... for |x| <= SMALL: 60 terms leave less than its
 * rounding. */
static double logarithm_rest(double x)
{
    double sum = 0.0;
    for (int i = 60; i >= 0; --i) {
        sum = 1.0 / (i + 3) - x * sum;
    }
    return sum;
}

/* ln((1 + y)/(1 - e y)) < y (1 + e), divided by y^2 (1 + e) where y is small. */
static bool dissipates_too_little(double y, double e)
{
    if (y <= SMALL) {
        return y * (logarithm_rest(y) + e * e * e * logarithm_rest(-e * y)) < 0.5 * (1.0 - e) * (1.0 + e);
    }
    return log1p(y) - log1p(-e * y) < y * (1.0 + e);
}

/* e^2 < 2 (y - ln(1 + y))/y^2 */
static bool returns_too_fast(double y, double e)
{
    if (y <= SMALL) {
        return 2.0 * y * logarithm_rest(y) < (1.0 - e) * (1.0 + e);
    }
    return e * e < 2.0 * (y - log1p(y)) / y / y;
}

double restitution_hunt_crossley(double restitution, enum dashpot dashpot)
{
    const double e = fmax(restitution, RESTITUTION_LEAST_HERTZ);
    if (e >= 1.0) {
        return 0.0;
    }
    /* 1 - e y > 0, or 2 (y - ln(1 + y))/y^2 < 2/y */
    return dashpot == DASHPOT_APPROACH_ONLY ? first_met(returns_too_fast, e, 0.0, 2.0 / (e * e))
                                            : first_met(dissipates_too_little, e, 0.0, 1.0 / e);
}
