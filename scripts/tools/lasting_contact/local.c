#include "local.h"

#include <string.h>

#include "math/vec3.h"

enum { FORCE, MOMENTUM, TURN, SPIN, NORMAL = 2, WHIRL = 5 };

static const struct vec3 PULL = {0.0, 0.0, -GRAVITY};

static double distance_of(const struct problem *p, const double *y)
{
    return RADIUS + y[FORCE] / p->penalty;
}

/* Of f and q, for the load of the spring [N] */
static void radial_rates(const struct problem *p, const double *y, double load, double *rate)
{
    rate[FORCE] = p->omega * y[MOMENTUM];
    rate[MOMENTUM] = p->omega * (load - y[FORCE] - p->viscous / p->root * y[MOMENTUM]);
}

static void plane_start(double *y)
{
    y[FORCE] = y[MOMENTUM] = y[SPIN] = 0.0;
    y[TURN] = ANGLE;
}

static void plane_rates(const struct problem *p, const double *y, double *rate)
{
    const double r = distance_of(p, y);
    radial_rates(p, y, MASS * (r * y[SPIN] * y[SPIN] + GRAVITY * cos(y[TURN])), rate);
    rate[TURN] = y[SPIN];
    rate[SPIN] = -(2.0 * y[MOMENTUM] / p->root * y[SPIN] + GRAVITY * sin(y[TURN])) / r;
}

static void plane_jacobian(const struct problem *p, const double *y, double (*j)[LOCAL_UNKNOWNS])
{
    const double r = distance_of(p, y);
    const double sine = GRAVITY * sin(y[TURN]);
    j[FORCE][MOMENTUM] = p->omega;
    j[MOMENTUM][FORCE] = p->omega * (MASS * y[SPIN] * y[SPIN] / p->penalty - 1.0);
    j[MOMENTUM][MOMENTUM] = -p->omega * p->viscous / p->root;
    j[MOMENTUM][TURN] = -p->omega * MASS * sine;
    j[MOMENTUM][SPIN] = p->omega * MASS * 2.0 * r * y[SPIN];
    j[TURN][SPIN] = 1.0;
    j[SPIN][FORCE] = (2.0 * y[MOMENTUM] / p->root * y[SPIN] + sine) / (r * r * p->penalty);
    j[SPIN][MOMENTUM] = -2.0 * y[SPIN] / (r * p->root);
    j[SPIN][TURN] = -GRAVITY * cos(y[TURN]) / r;
    j[SPIN][SPIN] = -2.0 * y[MOMENTUM] / (p->root * r);
}

static void plane_position(const struct problem *p, const double *y, double *x, double *z)
{
    *x = distance_of(p, y) * sin(y[TURN]);
    *z = -distance_of(p, y) * cos(y[TURN]);
}

static struct vec3 vector_at(const double *y, int first)
{
    return vec3_make(y[first], y[first + 1], y[first + 2]);
}

static void put_vector(double *y, int first, struct vec3 a)
{
    y[first] = a.x;
    y[first + 1] = a.y;
    y[first + 2] = a.z;
}

static void space_start(double *y)
{
    memset(y, 0, LOCAL_UNKNOWNS * sizeof *y);
    put_vector(y, NORMAL, vec3_make(sin(ANGLE), 0.0, -cos(ANGLE)));
}

static void space_rates(const struct problem *p, const double *y, double *rate)
{
    const double d = distance_of(p, y);
    const struct vec3 n = vector_at(y, NORMAL);
    const struct vec3 h = vector_at(y, WHIRL);
    radial_rates(p, y, MASS * (vec3_dot(h, h) / (d * d * d) + vec3_dot(n, PULL)), rate);
    put_vector(rate, NORMAL, vec3_scale(1.0 / (d * d), vec3_cross(h, n)));
    put_vector(rate, WHIRL, vec3_scale(d, vec3_cross(n, PULL)));
}

/* factor a x ... from `column` on */
static void put_cross(double (*j)[LOCAL_UNKNOWNS], int row, int column, double factor, struct vec3 a)
{
    j[row][column + 1] = -factor * a.z;
    j[row][column + 2] = factor * a.y;
    j[row + 1][column] = factor * a.z;
    j[row + 1][column + 2] = -factor * a.x;
    j[row + 2][column] = -factor * a.y;
    j[row + 2][column + 1] = factor * a.x;
}

static void space_jacobian(const struct problem *p, const double *y, double (*j)[LOCAL_UNKNOWNS])
{
    const double d = distance_of(p, y);
    const struct vec3 n = vector_at(y, NORMAL);
    const struct vec3 h = vector_at(y, WHIRL);
    const struct vec3 turning = vec3_scale(-2.0 / (d * d * d * p->penalty), vec3_cross(h, n));
    const struct vec3 spinning = vec3_scale(1.0 / p->penalty, vec3_cross(n, PULL));
    j[FORCE][MOMENTUM] = p->omega;
    j[MOMENTUM][FORCE] = p->omega * (-3.0 * MASS * vec3_dot(h, h) / (d * d * d * d * p->penalty) - 1.0);
    j[MOMENTUM][MOMENTUM] = -p->omega * p->viscous / p->root;
    put_vector(j[MOMENTUM], NORMAL, vec3_scale(p->omega * MASS, PULL));
    put_vector(j[MOMENTUM], WHIRL, vec3_scale(p->omega * MASS * 2.0 / (d * d * d), h));
    put_cross(j, NORMAL, NORMAL, 1.0 / (d * d), h);
    put_cross(j, NORMAL, WHIRL, -1.0 / (d * d), n);
    put_cross(j, WHIRL, NORMAL, -d, PULL);
    const double by_turning[] = {turning.x, turning.y, turning.z};
    const double by_spinning[] = {spinning.x, spinning.y, spinning.z};
    for (int i = 0; i < 3; ++i) {
        j[NORMAL + i][FORCE] = by_turning[i];
        j[WHIRL + i][FORCE] = by_spinning[i];
    }
}

static void space_position(const struct problem *p, const double *y, double *x, double *z)
{
    const struct vec3 n = vector_at(y, NORMAL);
    const double scale = distance_of(p, y) / vec3_norm(n);
    *x = scale * n.x;
    *z = scale * n.z;
}

const struct local local_plane = {4, plane_start, plane_rates, plane_jacobian, plane_position};
const struct local local_space = {8, space_start, space_rates, space_jacobian, space_position};
