#include "segment/rim_unit.h"

#include "segment/pair_hertz.h"

/* The time in which the pair passes the rim, at its speed, or under load and force from rest [s]. */
static double passage_of_rim(const struct contact_pair *from)
{
    const double size = from->distance; /* less than rho in the zone, or the circle is small beside both */
    const double force = fabs(from->coefficients.k * from->gap) / from->reduced_mass;
    const double acceleration = force + 2.0 * vec3_norm(from->flight.c[2]);
    return fmin(size / vec3_norm(from->flight.w[0]), sqrt(size / acceleration));
}

#if SCENE_ANY_HERTZ
/* Under Hertz's law at the deepest that speed, load and penetration lead to (as in hertz_series.c). */
static double hertz_unit_at_rim(const struct contact_pair *from)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double depth = pair_hertz_depth_to_come(from, pair_gap_derivative(from));
    const double root = sqrt(depth);
    const double radian = 1.0 / fmax(sqrt(1.5 * k * root), k * from->chi * depth * root);
    return fmin(passage_of_rim(from), radian) / root;
}
#else
static double hertz_unit_at_rim(const struct contact_pair *from)
{
    (void)from;
    return 1.0;
}
#endif

double rim_unit_of(const struct contact_pair *from, bool by_root)
{
    double unit = passage_of_rim(from);
    if (by_root) {
        unit = hertz_unit_at_rim(from);
    } else if (from->coefficients.k > 0.0 || from->coefficients.c > 0.0) {
        unit = fmin(unit, fmin(sqrt(from->reduced_mass / from->coefficients.k),
                               from->reduced_mass / from->coefficients.c));
    }
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
}
