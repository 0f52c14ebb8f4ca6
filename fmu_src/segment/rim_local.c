#include "segment/rim_local.h"

#ifndef CONTACT_NO_CAPS

struct rim_start rim_start_of(struct vec3 axis, double radius, double half_height, struct vec3 c,
                              double distance, struct vec3 rate)
{
    const double along = vec3_dot(c, axis);
    const struct vec3 across = vec3_axpy(c, -along, axis);
    const double rho = vec3_norm(across);
    const struct vec3 outward = vec3_scale(1.0 / rho, across);
    struct rim_start start = {.frame = {outward, vec3_cross(axis, outward), axis},
                              .radius = radius,
                              .distance = distance,
                              .tilt = atan2(-along - half_height, rho - radius)};
    const double cosine = cos(start.tilt);
    const double sine = sin(start.tilt);
    start.rho = radius + distance * cosine;
    start.round = start.rho * vec3_dot(start.frame[1], rate);
    start.over = -distance * (sine * vec3_dot(outward, rate) + cosine * vec3_dot(axis, rate));
    return start;
}

/* The azimuth is scaled by it. */
static double rim_scale(const struct rim_start *start)
{
    return start->rho / start->distance;
}

struct rim_state rim_state_of(const struct rim_start *start, const double change[4], double grown)
{
    const double d = start->distance + grown;
    const double scale = rim_scale(start);
    const double tilt = start->tilt + change[1];
    return (struct rim_state){.d = d,
                              .rho = start->radius + d * cos(tilt),
                              .azimuth = change[0] / scale,
                              .tilt = tilt,
                              .round = start->round + scale * change[2],
                              .over = start->over + change[3],
                              .grown = grown,
                              .tilted = change[1]};
}

void rim_change_rates(const struct rim_start *start, const struct rim_slopes *slopes, double rates[4])
{
    const double scale = rim_scale(start);
    rates[0] = scale * slopes->azimuth;
    rates[1] = slopes->tilt;
    rates[2] = slopes->round / scale;
    rates[3] = slopes->over;
}

/* What a vector of the frame is along a, b and e at a state. */
struct rim_parts {
    double outward, hoop, axial;
};

static struct rim_parts rim_parts_of(const struct rim_state *at, struct vec3 a)
{
    const double c = cos(at->azimuth);
    const double s = sin(at->azimuth);
    return (struct rim_parts){c * a.x + s * a.y, c * a.y - s * a.x, a.z};
}

struct rim_slopes rim_slopes_at(const struct rim_state *at, struct vec3 acceleration)
{
    const struct rim_parts a = rim_parts_of(at, acceleration);
    const double c = cos(at->tilt);
    const double s = sin(at->tilt);
    const double spin = at->round / (at->rho * at->rho);
    const double tilting = at->over / (at->d * at->d);
    const double push = at->rho * spin * spin + a.outward;
    return (struct rim_slopes){.azimuth = spin,
                               .tilt = tilting,
                               .round = at->rho * a.hoop,
                               .over = -at->d * (s * push + c * a.axial),
                               .load = at->d * tilting * tilting + c * push - s * a.axial};
}

void rim_slopes_by_distance(const struct rim_start *start, const struct rim_state *at,
                            struct vec3 acceleration, double slopes[4])
{
    const struct rim_slopes here = rim_slopes_at(at, acceleration);
    const double c = cos(at->tilt);
    const struct rim_slopes by_distance = {.azimuth = -2.0 * here.azimuth * c / at->rho,
                                           .tilt = -2.0 * here.tilt / at->d,
                                           .round = c * here.round / at->rho,
                                           .over = here.over / at->d + 3.0 * at->d * sin(at->tilt) * c *
                                                                           here.azimuth * here.azimuth};
    rim_change_rates(start, &by_distance, slopes);
}

struct vec3 rim_normal(const struct rim_state *at)
{
    const double c = cos(at->tilt);
    return vec3_make(c * cos(at->azimuth), c * sin(at->azimuth), -sin(at->tilt));
}

/* By differences that keep their digits. */
struct vec3 rim_moved(const struct rim_start *start, const struct rim_state *at)
{
    const double half_angle = 0.5 * at->tilted;
    const double mean = start->tilt + half_angle;
    const double cosine_change = -2.0 * sin(mean) * sin(half_angle);
    const double sine_change = 2.0 * cos(mean) * sin(half_angle);
    const double outward = at->grown * cos(at->tilt) + start->distance * cosine_change;
    const double half_turn = sin(0.5 * at->azimuth);
    return vec3_make(outward * cos(at->azimuth) - 2.0 * start->rho * half_turn * half_turn,
                     at->rho * sin(at->azimuth),
                     -(at->grown * sin(at->tilt) + start->distance * sine_change));
}

struct vec3 rim_velocity(const struct rim_state *at, double radial)
{
    const double along = at->over / at->d;
    const double outward = radial * cos(at->tilt) - along * sin(at->tilt);
    const double hoop = at->round / at->rho;
    const double c = cos(at->azimuth);
    const double s = sin(at->azimuth);
    return vec3_make(c * outward - s * hoop, s * outward + c * hoop,
                     -(radial * sin(at->tilt) + along * cos(at->tilt)));
}

void rim_edges(const struct rim_state *at, const struct rim_slopes *slopes, double half, double d_rate,
               double reach, double radial[3], double axial[3])
{
    const double c = reach * cos(at->tilt);
    const double s = reach * sin(at->tilt);
    const double rate = half * slopes->tilt;
    const double bend = half * half * slopes->over / (at->d * at->d) - 2.0 * rate * d_rate / at->d;
    radial[0] = c;
    radial[1] = -s * rate;
    radial[2] = -c * rate * rate - s * bend;
    axial[0] = s;
    axial[1] = c * rate;
    axial[2] = c * bend - s * rate * rate;
}

#endif
