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
    const double cosine = cos(start.tilt);
    const double sine = sin(start.tilt);
    start.rho = radius + distance * cosine;
    start.azimuth_momentum = start.rho * vec3_dot(start.frame[2], rate);
    start.tilt_momentum = -distance * (sine * vec3_dot(outward, rate) + cosine * vec3_dot(axis, rate));
    return start;
}

/* Returns the factor of the azimuth in the changes of rim_state_of, rho divided by d at the start. */
static double rim_scale(const struct rim_start *start)
{
    return start->rho / start->distance;
}

struct rim_state rim_state_of(const struct rim_start *start, const double change[4], double grown)
{
    const double scale = rim_scale(start);
    const double tilt = start->tilt + change[1];
    const double cosine = cos(tilt);
    const double d = start->distance + grown;
    struct rim_state at = {.d = d,
                           .rho = start->radius + d * cosine,
                           .azimuth = change[0] / scale,
                           .tilt = tilt,
                           .azimuth_momentum = start->azimuth_momentum + scale * change[2],
                           .tilt_momentum = start->tilt_momentum + change[3],
                           .grown = grown,
                           .tilted = change[1],
                           .cosine = cosine,
                           .sine = sin(tilt),
                           .turned_cosine = 1.0,
                           .turned_sine = 0.0};
    if (at.azimuth != 0.0) { /* the azimuth stays zero in a plane through the axis */
        at.turned_cosine = cos(at.azimuth);
        at.turned_sine = sin(at.azimuth);
    }
    return at;
}

void rim_change_rates(const struct rim_start *start, const struct rim_slopes *slopes, double rates[4])
{
    const double scale = rim_scale(start);
    rates[0] = scale * slopes->azimuth;
    rates[1] = slopes->tilt;
    rates[2] = slopes->azimuth_momentum / scale;
    rates[3] = slopes->tilt_momentum;
}

/* Components of a vector along a, b and e at a state. */
struct rim_parts {
    double outward, circumferential, axial;
};

static struct rim_parts rim_parts_of(const struct rim_state *at, struct vec3 a)
{
    const double c = at->turned_cosine;
    const double s = at->turned_sine;
    return (struct rim_parts){c * a.x + s * a.z, c * a.z - s * a.x, a.y};
}

struct rim_slopes rim_slopes_at(const struct rim_state *at, struct vec3 acceleration)
{
    const struct rim_parts a = rim_parts_of(at, acceleration);
    const double c = at->cosine;
    const double s = at->sine;
    const double spin = at->azimuth_momentum / (at->rho * at->rho);
    const double tilting = at->tilt_momentum / (at->d * at->d);
    const double push = at->rho * spin * spin + a.outward;
    return (struct rim_slopes){.azimuth = spin,
                               .tilt = tilting,
                               .azimuth_momentum = at->rho * a.circumferential,
                               .tilt_momentum = -at->d * (s * push + c * a.axial),
                               .load = at->d * tilting * tilting + c * push - s * a.axial};
}

void rim_slopes_by_distance(const struct rim_start *start, const struct rim_state *at,
                            struct vec3 acceleration, double slopes[4])
{
    const struct rim_slopes here = rim_slopes_at(at, acceleration);
    const double c = at->cosine;
    const struct rim_slopes by_distance = {.azimuth = -2.0 * here.azimuth * c / at->rho,
                                           .tilt = -2.0 * here.tilt / at->d,
                                           .azimuth_momentum = c * here.azimuth_momentum / at->rho,
                                           .tilt_momentum =
                                               here.tilt_momentum / at->d +
                                               3.0 * at->d * at->sine * c * here.azimuth * here.azimuth};
    rim_change_rates(start, &by_distance, slopes);
}

struct vec3 rim_normal(const struct rim_state *at)
{
    const double c = at->cosine;
    return vec3_make(c * at->turned_cosine, -at->sine, c * at->turned_sine);
}

/* Returns c - c(0) by differences of sines and cosines that lose no digits. */
struct vec3 rim_moved(const struct rim_start *start, const struct rim_state *at)
{
    const double half_angle = 0.5 * at->tilted;
    const double mean = start->tilt + half_angle;
    const double cosine_change = -2.0 * sin(mean) * sin(half_angle);
    const double sine_change = 2.0 * cos(mean) * sin(half_angle);
    const double outward = at->grown * at->cosine + start->distance * cosine_change;
    const double half_turn = sin(0.5 * at->azimuth);
    return vec3_make(outward * at->turned_cosine - 2.0 * start->rho * half_turn * half_turn,
                     -(at->grown * at->sine + start->distance * sine_change), at->rho * at->turned_sine);
}

struct vec3 rim_velocity(const struct rim_state *at, double radial)
{
    const double along = at->tilt_momentum / at->d;
    const double outward = radial * at->cosine - along * at->sine;
    const double circumferential = at->azimuth_momentum / at->rho;
    const double c = at->turned_cosine;
    const double s = at->turned_sine;
    return vec3_make(c * outward - s * circumferential, -(radial * at->sine + along * at->cosine),
                     s * outward + c * circumferential);
}

void rim_edges(const double tilt[3], double reach, double radial[3], double axial[3])
{
    const double c = reach * cos(tilt[0]);
    const double s = reach * sin(tilt[0]);
    radial[0] = c;
    radial[1] = -s * tilt[1];
    radial[2] = -c * tilt[1] * tilt[1] - s * tilt[2];
    axial[0] = s;
    axial[1] = c * tilt[1];
    axial[2] = c * tilt[2] - s * tilt[1] * tilt[1];
}
