#include "segment/zone_path.h"

#include <float.h>

#include "contact/zone.h"
#include "segment/flight_candidates.h"

#if SCENE_ANY_CAPS

static struct vec3 zone_path_at(const struct separation_path *path, double time)
{
    return path_at(path->c, SEPARATION_DEGREE + 1, time);
}

double zone_path_rounding(const struct contact_solid *solid, const struct separation_path *path)
{
    return 8.0 * DBL_EPSILON * (vec3_norm(path->c[0]) + solid->radius + solid->half_height);
}

/* The path from a time on. */
static struct separation_path zone_path_from(const struct separation_path *path, double time)
{
    struct separation_path from = *path;
    path_shift(from.c, SEPARATION_DEGREE + 1, time);
    return from;
}

/* The first time > 0 at which gap + n.(c(t) - c(0)) falls through zero; INFINITY: not within `left`. */
static double plane_touch(const struct separation_path *path, struct vec3 n, double gap, double left)
{
    struct polynomial along = {{gap}, SEPARATION_DEGREE};
    double power = 1.0;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        power *= left;
        along.a[i] = power * vec3_dot(n, path->c[i]);
    }
    while (along.degree > 0 && along.a[along.degree] == 0.0) {
        along.degree -= 1;
    }
    double roots[POLYNOMIAL_MAX_DEGREE];
    return polynomial_sign_changes(&along, roots) > 0 ? left * roots[0] : (double)INFINITY;
}

/* A quadratic path is solved as such: exact however short the time is beside the horizon. */
static double steady_touch(const struct separation_path *path, struct vec3 n, double gap, double left)
{
    const double speed = vec3_dot(n, path->c[1]);
    const double bend = vec3_dot(n, path->c[2]);
    const double square = speed * speed - 4.0 * bend * gap;
    double time = (double)INFINITY;
    if (speed < 0.0 && square >= 0.0) {
        time = 2.0 * gap / (-speed + sqrt(square));
    } else if (bend < 0.0) {
        time = (speed + sqrt(square)) / (-2.0 * bend);
    }
    return time <= left ? time : (double)INFINITY;
}

/* Near a touch that is a graze the steps grow no longer than the rounding of the gap asks for. */
enum { TOUCH_STEPS = 10000 };

double zone_path_first_touch(const struct contact_shape *shape, const struct separation_path *path,
                             double gap, double settled, double horizon)
{
    const struct vec3 none = {0.0, 0.0, 0.0};
    const bool is_steady = vec3_is_zero(path->c[3]) && vec3_is_zero(path->c[4]);
    const double better_by = gap - contact_geometry_at(shape, path->c[0], path->c[1], none).gap;
    double time = settled;
    for (int i = 0; i < TOUCH_STEPS && time <= horizon; ++i) {
        const struct separation_path from = zone_path_from(path, time);
        const struct contact_geometry at = contact_geometry_at(shape, from.c[0], from.c[1], none);
        const double above = at.gap + better_by;
        if (!(above > 0.0)) {
            return time;
        }
        const double left = horizon - time;
        const double step = is_steady ? steady_touch(&from, at.normal, above, left)
                                      : plane_touch(&from, at.normal, above, left);
        if (!(step < (double)INFINITY)) {
            return (double)INFINITY;
        }
        const bool closes = vec3_dot(at.normal, from.c[1]) < 0.0;
        const double before = time;
        time += step;
        if (!(time > before) || (closes && above <= zone_path_rounding(&shape->solid, &from))) {
            return time; /* another step would know no more */
        }
    }
    return (double)INFINITY;
}

/* rho^2 - (radius + sign z - height)^2 and the like: rho^2 = (offset + slope z)^2, in the path's unit. */
static struct polynomial edge_cone(const struct relative_path *path, double offset, double slope)
{
    const struct polynomial rho2 = relative_path_distance_squared(path);
    struct polynomial line = {{offset}, path->axial.degree};
    for (int i = 0; i <= line.degree; ++i) {
        line.a[i] += slope * path->axial.a[i];
    }
    while (line.degree > 0 && line.a[line.degree] == 0.0) {
        line.degree -= 1;
    }
    const struct polynomial square = polynomial_multiply(&line, &line);
    return polynomial_add(&rho2, -1.0, &square);
}

static struct polynomial edge_plane(const struct relative_path *path, double offset)
{
    struct polynomial height = path->axial;
    height.a[0] += offset;
    return height;
}

static int add_edges(const struct polynomial *p, double *edges, int count)
{
    double roots[POLYNOMIAL_MAX_DEGREE];
    const int found = polynomial_sign_changes(p, roots);
    for (int i = 0; i < found; ++i) {
        int at = count++;
        for (; at > 0 && edges[at - 1] > roots[i]; --at) {
            edges[at] = edges[at - 1];
        }
        edges[at] = roots[i];
    }
    return count;
}

static struct relative_path solid_path(const struct contact_solid *solid, const struct separation_path *path,
                                       double horizon)
{
    const struct contact_shape shape = {.axis = solid->axis,
                                        .other_radius = solid->radius,
                                        .half_length = (double)INFINITY,
                                        .side = 1,
                                        .destination = SHAPE_CYLINDER};
    struct separation_path across = *path;
    across.offset = contact_across(&shape, path->c[0]);
    return relative_path_make(&shape, &across, 0.0, horizon);
}

int zone_path_edges(const struct contact_solid *solid, const struct separation_path *path, double horizon,
                    double edges[ZONE_EDGES])
{
    const struct relative_path along = solid_path(solid, path, horizon);
    const double h = solid->half_height / along.scale;
    const double r = solid->radius / along.scale;
    int count = 0;
    for (int end = -1; end <= 1; end += 2) {
        const struct polynomial cap = edge_plane(&along, end * h); /* z = +-h */
        const struct polynomial ridge = edge_cone(&along, r - h, end);
        count = add_edges(&cap, edges, count);
        count = add_edges(&ridge, edges, count);
    }
    const struct polynomial middle = edge_plane(&along, 0.0);
    const struct polynomial wall = edge_cone(&along, r, 0.0); /* rho = r_d */
    count = add_edges(&middle, edges, count);
    return add_edges(&wall, edges, count);
}

typedef double zone_margin(const struct contact_solid *solid, struct vec3 c);

/* The first place among the edges after which the margin is below zero by more than rounding. */
static double zone_first_end(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon, const double *edges, int count, zone_margin *margin)
{
    double from = 0.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? edges[i] : 1.0;
        if (to > from) {
            const struct separation_path then = {.c = {zone_path_at(path, 0.5 * (from + to) * horizon)}};
            if (margin(solid, then.c[0]) < -zone_path_rounding(solid, &then)) {
                return from * horizon;
            }
        }
        from = to;
    }
    return (double)INFINITY;
}

static double whole_margin(const struct contact_solid *solid, struct vec3 c)
{
    return contact_zone_margin(solid, solid->zone, c);
}

/* Of side and cap, without regard to how deep the centre is. */
static double face_margin(const struct contact_solid *solid, struct vec3 c)
{
    const struct solid_place place = contact_place_at(solid, c);
    return solid->zone == ZONE_SIDE ? -place.axial : -place.radial;
}

double zone_path_end(const struct contact_solid *solid, const struct separation_path *path, double horizon)
{
    double edges[ZONE_EDGES];
    const int count = zone_path_edges(solid, path, horizon, edges);
    return zone_first_end(solid, path, horizon, edges, count, whole_margin);
}

/* Whether a path so short stays clear of the outer edge. */
static bool stays_on_face(const struct contact_solid *solid, const struct separation_path *path,
                          double horizon)
{
    double length = 0.0;
    for (int i = SEPARATION_DEGREE; i > 0; --i) {
        length = (length + vec3_norm(path->c[i])) * horizon;
    }
    return face_margin(solid, path->c[0]) > length;
}

double zone_path_leaves_face(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon)
{
    double edges[ZONE_EDGES];
    int count = 0;
    if (stays_on_face(solid, path, horizon)) {
        return (double)INFINITY;
    }
    const struct relative_path along = solid_path(solid, path, horizon);
    if (solid->zone == ZONE_SIDE) {
        for (int end = -1; end <= 1; end += 2) {
            const struct polynomial cap = edge_plane(&along, end * solid->half_height / along.scale);
            count = add_edges(&cap, edges, count);
        }
    } else {
        const struct polynomial wall = edge_cone(&along, solid->radius / along.scale, 0.0);
        count = add_edges(&wall, edges, count);
    }
    return zone_first_end(solid, path, horizon, edges, count, face_margin);
}

#endif
