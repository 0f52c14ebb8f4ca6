#include "contact/hertz_stiffness.h"

#include <float.h>
#include <math.h>

#include "math/pi.h"

double hertz_modulus(struct contact_material source, struct contact_material destination)
{
    const double nu_s = source.poissons_ratio;
    const double nu_d = destination.poissons_ratio;
    return 1.0 / ((1.0 - nu_s) * (1.0 + nu_s) / source.youngs_modulus +
                  (1.0 - nu_d) * (1.0 + nu_d) / destination.youngs_modulus);
}

/* K, and (K - E)/(e^2 K) without the differences in it, which cancel in a contact that is nearly a circle. */
struct elliptic {
    double k, part;
};

/*
 * By the arithmetic-geometric mean of 1 and k': K = pi / (2 agm), (K - E)/K = sum of 2^(n-1) c_n^2 with c_0 =
 * e, c_n half the difference of the means before; c_1^2 / e^2 = (1 - k')/(4 (1 + k')). Source: Abramowitz and
 * Stegun, 17.6.
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

/* k' for A / B, which rises with it: bisection to rounding. */
static double axis_ratio_of(double curvature_ratio)
{
    double low = 0.0;
    double high = 1.0;
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high)) {
            return middle;
        }
        const double part = elliptic_of(middle).part;
        if (middle * middle * part < curvature_ratio * (1.0 - part)) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

double hertz_elliptic_stiffness(double modulus, double a, double b)
{
    if (!(a < b)) {
        return 4.0 / 3.0 * modulus / sqrt(2.0 * a);
    }
    const struct elliptic at = elliptic_of(axis_ratio_of(a / b));
    return 2.0 / 3.0 * PI * modulus * sqrt(at.part / a) / at.k;
}

double hertz_stiffness(const struct contact_shape *shape, double modulus)
{
    const double r_s = shape->source_radius;
    const double r_d = shape->other_radius;
    const double alone = 0.5 / r_s; /* on a plane, and along a cylinder */
    if (contact_is_plane(shape)) {
        return hertz_elliptic_stiffness(modulus, alone, alone);
    }
    /* 1/r_s + 1/r_d outside, 1/r_s - 1/r_d inside, halved */
    const double curved = 0.5 * (r_d + shape->side * r_s) / r_s / r_d;
    const double along = contact_is_cylinder(shape) ? alone : curved;
    return hertz_elliptic_stiffness(modulus, fmin(along, curved), fmax(along, curved));
}

/* In a hollow body that is larger by a ninth the relative radius is already ten times that of the source. */
static const double CONFORMING = 0.9;

bool hertz_is_conforming(const struct contact_shape *shape)
{
    return shape->side < 0 && shape->source_radius > CONFORMING * shape->other_radius;
}
