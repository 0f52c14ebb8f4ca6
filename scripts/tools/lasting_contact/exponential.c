#include "exponential.h"

#include <math.h>
#include <string.h>

#include "segment/collocation.h"

/* The error of a step's iteration [m]. */
static const double CONVERGED = 1e-13;

/* Radians of the oscillator from which on a step spans it, as in the FMU (segment/segment.h). */
static const double RESOLVED = 4.0;

bool exponential_run(const struct problem *p, struct outcome *out)
{
    const double h = p->end / p->steps;
    const enum collocation_kind kind = p->omega * h > RESOLVED ? COLLOCATION_AVERAGED : COLLOCATION_RESOLVED;
    struct vec3 c = vec3_make(RADIUS * sin(ANGLE), 0.0, -RADIUS * cos(ANGLE));
    struct vec3 rate = vec3_make(0.0, 0.0, 0.0);
    double deviation = 0.0;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < p->steps; ++i) {
        struct collocation_problem from = {.rate = rate,
                                           .reach = RADIUS,
                                           .deviation = deviation,
                                           .omega2 = p->penalty / MASS,
                                           .damping_rate = p->viscous / MASS,
                                           .acceleration = {{0.0, 0.0, -GRAVITY}}};
        struct collocation step;
        double x[4];
        const double d = vec3_norm(c);
        from.normal = vec3_scale(1.0 / d, c);
        from.radial = vec3_dot(from.normal, rate);
        if (!collocation_make(&step, &from, h, kind, &lobatto[LOBATTO_TWELVE], CONVERGED)) {
            return false;
        }
        out->iterations += step.work.sweeps;
        const struct collocation_change change = collocation_change_at(&step, 2.0);
        collocation_deviation(&step, 2.0, x);
        /* As pair_apply does: the centre takes on the distance that has been accumulated, so rounding does
         * not pile up. */
        c = vec3_axpy(vec3_add(c, change.moved), deviation - (d - RADIUS), from.normal);
        rate = vec3_add(rate, change.gained);
        deviation = x[0];
    }
    out->evaluations = lobatto[LOBATTO_TWELVE].points * out->iterations;
    out->x = c.x;
    out->z = c.z;
    return isfinite(c.x + c.z);
}
