#include "touch/rim.h"

struct rim_start rim_start_of(struct vec3 axis, double radius, double half_height, struct vec3 c,
                              double distance, struct vec3 rate)
{
    const double along = vec3_dot(c, axis);
    const struct vec3 across = vec3_axpy(c, -along, axis);
    const double rho = vec3_norm(across);
    const struct vec3 outward = vec3_scale(1.0 / rho, across);
    struct rim_start start = {.frame = {outward, axis, vec3_cross(axis, outward)},
                              .radius = radius,
                              .distance = distance,
                              .tilt = atan2(-along - half_height, rho - radius)};
    start.cosine = cos(start.tilt);
    start.sine = sin(start.tilt);
    start.rho = radius + distance * start.cosine;
    start.azimuth_momentum = start.rho * vec3_dot(start.frame[2], rate);
    start.tilt_momentum =
        -distance * (start.sine * vec3_dot(outward, rate) + start.cosine * vec3_dot(axis, rate));
    return start;
}

/* In a plane motion one of the angles rests. */
struct rim_angles rim_angles_of(const struct rim_start *start, double turned, double tilted)
{
    struct rim_angles by = {start->cosine, start->sine, 1.0, 0.0};
    if (tilted != 0.0) {
        by.cosine = cos(start->tilt + tilted);
        by.sine = sin(start->tilt + tilted);
    }
    if (turned != 0.0) {
        by.turned_cosine = cos(turned);
        by.turned_sine = sin(turned);
    }
    return by;
}

struct rim_state rim_state_of(const struct rim_start *start, const double change[4], double grown,
                              struct rim_angles by)
{
    const double d = start->distance + grown;
    return (struct rim_state){.d = d,
                              .rho = start->radius + d * by.cosine,
                              .azimuth_momentum = start->azimuth_momentum + change[2],
                              .tilt_momentum = start->tilt_momentum + change[3],
                              .grown = grown,
                              .by = by};
}

struct rim_slopes rim_slopes_at(const struct rim_state *at, struct vec3 acceleration)
{
    const struct rim_angles *by = &at->by; /* the angles turn the acceleration into its parts along a, b */
    const double outward = by->turned_cosine * acceleration.x + by->turned_sine * acceleration.z;
    const double around = by->turned_cosine * acceleration.z - by->turned_sine * acceleration.x;
    const double c = at->by.cosine;
    const double s = at->by.sine;
    const double spin = at->azimuth_momentum / (at->rho * at->rho);
    const double tilting = at->tilt_momentum / (at->d * at->d);
    const double push = at->rho * spin * spin + outward;
    return (struct rim_slopes){.azimuth = spin,
                               .tilt = tilting,
                               .azimuth_momentum = at->rho * around,
                               .tilt_momentum = -at->d * (s * push + c * acceleration.y),
                               .load = at->d * tilting * tilting + c * push - s * acceleration.y};
}

void rim_slopes_by_distance(const struct rim_state *at, struct vec3 acceleration, double slopes[4])
{
    const struct rim_slopes here = rim_slopes_at(at, acceleration);
    const double c = at->by.cosine;
    slopes[0] = -2.0 * here.azimuth * c / at->rho;
    slopes[1] = -2.0 * here.tilt / at->d;
    slopes[2] = c * here.azimuth_momentum / at->rho;
    slopes[3] = here.tilt_momentum / at->d + 3.0 * at->d * at->by.sine * c * here.azimuth * here.azimuth;
}

struct vec3 rim_normal(const struct rim_state *at)
{
    const double c = at->by.cosine;
    return vec3_make(c * at->by.turned_cosine, -at->by.sine, c * at->by.turned_sine);
}

/* c = d n + r_d a. */
struct vec3 rim_moved(const struct rim_start *start, const struct rim_state *at)
{
    const struct vec3 n = rim_normal(at);
    const double d = start->distance;
    return vec3_make(
        at->grown * n.x + d * (n.x - start->cosine) + start->radius * (at->by.turned_cosine - 1.0),
        at->grown * n.y + d * (n.y + start->sine), at->d * n.z + start->radius * at->by.turned_sine);
}

struct vec3 rim_gained(const struct rim_start *start, const struct rim_state *at, double before,
                       double radial)
{
    const double along = start->tilt_momentum / start->distance; /* speeds at the start and now */
    const double around = start->azimuth_momentum / start->rho;
    const double along_now = at->tilt_momentum / at->d;
    const double around_now = at->azimuth_momentum / at->rho;
    const double c = at->by.cosine;
    const double s = at->by.sine;
    const double outward = radial * c - along_now * s;
    return vec3_make(outward * at->by.turned_cosine - around_now * at->by.turned_sine -
                         (before * start->cosine - along * start->sine),
                     before * start->sine + along * start->cosine - (radial * s + along_now * c),
                     outward * at->by.turned_sine + around_now * at->by.turned_cosine - around);
}
