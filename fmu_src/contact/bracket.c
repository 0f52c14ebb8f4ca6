#include "contact/bracket.h"

#include <float.h>
#include <math.h>

double bracket_root(bracket_function *f, const void *data, double low, double high)
{
    double value;
    double slope;
    f(data, low, &value, &slope);
    const double rising = value < 0.0 ? 1.0 : -1.0;
    double s = 0.5 * (low + high);
    /* Bisection alone would need about 1100 halvings to reach the smallest double, Newton a handful of steps. */
    for (int i = 0; i < 1200; ++i) {
        f(data, s, &value, &slope);
        if (value == 0.0) {
            return s;
        }
        if (rising * value < 0.0) {
            low = s;
        } else {
            high = s;
        }
        double next = s - value / slope;
        if (fabs(next - s) <= DBL_EPSILON * s) {
            return s; /* and not on to the other end of the bracket, where s is its new end */
        }
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        if (next <= low || next >= high) {
            return next;
        }
        s = next;
    }
    return s;
}
