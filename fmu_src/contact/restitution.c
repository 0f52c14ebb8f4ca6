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
