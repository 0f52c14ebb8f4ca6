#include <float.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "contact/shape.h"
#include "flight/relative_path.h"
#include "flight/zone_path.h"
#include "math/polynomial.h"
#include "scene/evaluate.h"

#if SCENE_ANY_ZONES

static struct vec3 zone_path_at(const struct separation_path *path, double time)
{
    return path_at(path->c, SEPARATION_DEGREE + 1, time);
}

double zone_path_rounding(const struct contact_solid *solid, const struct separation_path *path)
{
    return 8.0 * DBL_EPSILON * (vec3_norm(path->c[0]) + solid->radius + solid->half_height);
}

/* Returns rho^2 - (offset + slope z)^2 [scale^2]; a root is a crossing of a cone about the axis. */
static struct polynomial edge_cone(const struct relative_path *path, double offset, double slope)
{
    const struct polynomial rho2 = relative_path_distance_squared(path);
    struct polynomial line = {{offset}, path->axial.degree};
    for (int i = 0; i <= line.degree; ++i) {
        line.a[i] += slope * path->axial.a[i];
    }
    const struct polynomial square = polynomial_multiply(&line, &line);
    return polynomial_add(&rho2, -1.0, &square);
}

/* Returns c.e + offset [scale]; a root is a crossing of a plane across the axis e. */
static struct polynomial edge_plane(const struct relative_path *path, double offset)
{
    struct polynomial height = path->axial;
    height.a[0] += offset;
    return height;
}

/* Returns the path relative to an endless cylinder about the axis of the solid. */
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

/* Sets a sorted superset of the times at which a path passes from one zone to another, as fractions of the
 * horizon. Returns their number. */
enum { ZONE_EDGES = 4 * POLYNOMIAL_MAX_DEGREE };
static int zone_edges(const struct contact_solid *solid, const struct separation_path *path, double horizon,
                      double edges[ZONE_EDGES])
{
    const struct relative_path along = solid_path(solid, path, horizon);
    const double h = solid->half_height / along.scale;
    const double r = solid->radius / along.scale;
    int count = 0;
    for (int end = -1; end <= 1; end += 2) {
        const struct polynomial cap = edge_plane(&along, end * h); /* roots are passages of z = +-h */
        const struct polynomial ridge = edge_cone(&along, r - h, end);
        count = polynomial_add_sign_changes(&cap, edges, count);
        count = polynomial_add_sign_changes(&ridge, edges, count);
    }
    const struct polynomial middle = edge_plane(&along, 0.0);
    const struct polynomial wall = edge_cone(&along, r, 0.0); /* roots are passages of rho = r_d */
    count = polynomial_add_sign_changes(&middle, edges, count);
    return polynomial_add_sign_changes(&wall, edges, count);
}

/* A distance of the centre from edges of zones [m], positive within them. */
typedef double zone_margin(const struct contact_solid *solid, struct vec3 c);

/* Number of places that are tried between two edges. An edge polynomial has degree eight at most, so it
 * touches zero without a change of sign at four places at most, as where a path turns back just at an edge.
 * One of five places is clear of the edge. */
enum { CLEAR_PLACES = 5 };

/* Returns the place among CLEAR_PLACES that is farthest from an edge. */
static double zone_clear_place(const struct contact_solid *solid, const struct separation_path *path,
                               double horizon, double from, double to, zone_margin *margin)
{
    double clearest = 0.5 * (from + to);
    double most = -1.0;
    for (int i = 1; i <= CLEAR_PLACES; ++i) {
        const double place = from + (to - from) * i / (CLEAR_PLACES + 1);
        const double clear = fabs(margin(solid, zone_path_at(path, place * horizon)));
        if (clear > most) {
            most = clear;
            clearest = place;
        }
    }
    return clearest;
}

/* Returns the time of the first edge after which the margin is below zero by more than rounding [s]. */
static double zone_first_end(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon, const double *edges, int count, zone_margin *margin)
{
    double from = 0.0;
    for (int i = 0; i <= count; ++i) {
        const double to = i < count ? edges[i] : 1.0;
        if (to > from) {
            const double place = zone_clear_place(solid, path, horizon, from, to, margin);
            const struct separation_path then = {.c = {zone_path_at(path, place * horizon)}};
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

/* Returns the distance of the centre from the outer edge of a side, a cap or the face of skew cylinders [m],
 * whatever the depth. */
static double face_margin(const struct contact_solid *solid, struct vec3 c)
{
    if (SCENE_ANY_SKEW && abs(solid->zone) == SKEW_FACE) {
        const struct skew_face face = contact_skew_face(solid);
        return fmin(face.half[0] - fabs(vec3_dot(c, face.across[0])),
                    face.half[1] - fabs(vec3_dot(c, face.across[1])));
    }
    const struct solid_place place = contact_place_at(solid, c);
    return solid->zone == ZONE_SIDE ? -place.axial : -place.radial;
}

double zone_path_end(const struct contact_solid *solid, const struct separation_path *path, double horizon)
{
    double edges[ZONE_EDGES];
    const int count = zone_edges(solid, path, horizon, edges);
    return zone_first_end(solid, path, horizon, edges, count, whole_margin);
}

/* Whether the path is too short to reach the outer edge. */
static bool stays_on_face(const struct contact_solid *solid, const struct separation_path *path,
                          double horizon)
{
    return face_margin(solid, path->c[0]) > horizon * path_size(path->c + 1, SEPARATION_DEGREE, horizon);
}

/* Adds where the path crosses the edges of the face of skew cylinders, as fractions of the horizon. */
static int add_edges_of_skew(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon, double *edges)
{
    const struct skew_face face = contact_skew_face(solid);
    int count = 0;
    for (int i = 0; i < 4; ++i) {
        struct polynomial edge = {.degree = SEPARATION_DEGREE};
        double power = 1.0;
        for (int k = 0; k <= SEPARATION_DEGREE; ++k) {
            edge.a[k] = power * vec3_dot(path->c[k], face.across[i / 2]);
            power *= horizon;
        }
        edge.a[0] += i % 2 == 0 ? face.half[i / 2] : -face.half[i / 2];
        if (isfinite(face.half[i / 2])) {
            count = polynomial_add_sign_changes(&edge, edges, count);
        }
    }
    return count;
}

double zone_path_leaves_face(const struct contact_solid *solid, const struct separation_path *path,
                             double horizon)
{
    double edges[ZONE_EDGES];
    int count = 0;
    if (stays_on_face(solid, path, horizon)) {
        return (double)INFINITY;
    }
    if (SCENE_ANY_SKEW && abs(solid->zone) == SKEW_FACE) {
        count = add_edges_of_skew(solid, path, horizon, edges);
        return zone_first_end(solid, path, horizon, edges, count, face_margin);
    }
    const struct relative_path along = solid_path(solid, path, horizon);
    if (solid->zone == ZONE_SIDE) {
        for (int end = -1; end <= 1; end += 2) {
            const struct polynomial cap = edge_plane(&along, end * solid->half_height / along.scale);
            count = polynomial_add_sign_changes(&cap, edges, count);
        }
    } else {
        const struct polynomial wall = edge_cone(&along, solid->radius / along.scale, 0.0);
        count = polynomial_add_sign_changes(&wall, edges, count);
    }
    return zone_first_end(solid, path, horizon, edges, count, face_margin);
}

#endif

#if SCENE_ANY_FREE && SCENE_ANY_CAPS

/* Returns the path with its time origin moved to `time`. */
static struct separation_path zone_path_from(const struct separation_path *path, double time)
{
    struct separation_path from = *path;
    path_shift(from.c, SEPARATION_DEGREE + 1, time);
    return from;
}

/* Returns the first t > 0 [s] at which gap + n.(c(t) - c(0)) falls through zero, or INFINITY after `left`. */
static double plane_touch(const struct separation_path *path, struct vec3 n, double gap, double left)
{
    struct polynomial along = {{gap}, SEPARATION_DEGREE};
    double power = 1.0;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        power *= left;
        along.a[i] = power * vec3_dot(n, path->c[i]);
    }
    double roots[POLYNOMIAL_MAX_DEGREE];
    return polynomial_sign_changes(&along, roots) > 0 ? left * roots[0] : (double)INFINITY;
}

/* Largest number of steps. Near a graze the steps become as short as the rounding of the gap. */
enum { TOUCH_STEPS = 10000, GRAZE_EVALUATIONS = 10000 };

/* Returns the time of the first touch after `settled` [s]; INFINITY: no touch within the horizon [s]. `gap`
 * is the gap at the start [m], which may have more digits than the positions. */
static double zone_path_first_touch(const struct contact_shape *shape, const struct separation_path *path,
                                    double gap, double settled, double horizon)
{
    const struct vec3 none = {0.0, 0.0, 0.0};
    const double better_by = gap - contact_geometry_at(shape, path->c[0], path->c[1], none).gap;
    double time = settled;
    for (int i = 0; i < TOUCH_STEPS && time <= horizon; ++i) {
        const struct separation_path from = zone_path_from(path, time);
        const struct contact_geometry at = contact_geometry_at(shape, from.c[0], from.c[1], none);
        const double above = at.gap + better_by;
        if (!(above > 0.0)) {
            return time;
        }
        const double step = plane_touch(&from, at.normal, above, horizon - time);
        if (!(step < (double)INFINITY)) {
            return (double)INFINITY;
        }
        const bool closes = vec3_dot(at.normal, from.c[1]) < 0.0;
        const double before = time;
        time += step;
        if (!(time > before) || (closes && above <= zone_path_rounding(&shape->solid, &from))) {
            return time; /* another step would be smaller than rounding */
        }
    }
    return (double)INFINITY;
}

/* Largest number of trials: a gap that stays at zero may come within rounding more than once. */
enum { TRIALS = 1000 };

/* How bodies go on that touch within rounding. */
struct meeting {
    bool is_clear; /* the first two derivatives of the gap tell it */
    bool closes;   /* in this case: they penetrate now */
    double rising; /* else a time after which the gap exceeds rounding, or has returned from a hop [s] */
};

/* Tells how bodies go on that touch within a rounding bound `noise` [m]. The first derivative of the gap
 * decides, if the other derivatives change the gap by less than `noise` in the time in which the first one
 * changes it by four times that. Otherwise the sign of the second derivative decides, because the bodies may
 * hop or graze each other by less than rounding. The gap is convex: the turning of n adds up to |c'|^2 / d to
 * n.c''. */
static struct meeting meeting_of(const struct contact_shape *shape, const struct separation_path *path,
                                 double noise)
{
    const struct vec3 *c = path->c;
    const struct contact_geometry at = contact_geometry_at(shape, c[0], c[1], vec3_make(0.0, 0.0, 0.0));
    const double speed = vec3_dot(at.normal, c[1]);
    const double bend = vec3_dot(at.normal, c[2]);
    const double turning = 0.5 * vec3_dot(c[1], c[1]) / at.distance;
    const double by_speed = 4.0 * noise / fabs(speed);
    if ((vec3_norm(c[2]) + turning) * by_speed * by_speed < noise) {
        return (struct meeting){true, speed < 0.0, by_speed};
    }
    const double by_bend = sqrt(4.0 * noise / fmin(fabs(bend), fabs(bend + turning)));
    const double rest = (vec3_norm(c[3]) + vec3_norm(c[4]) * by_bend) * by_bend * by_bend * by_bend;
    const bool is_clear = bend * (bend + turning) > 0.0 && rest < noise;
    return bend < 0.0 ? (struct meeting){is_clear, !(speed > 0.0), fmax(-speed / bend, 0.0)}
                      : (struct meeting){is_clear, false, by_bend};
}

/* Returns the time after `settled` at which bodies that may graze each other touch by more than rounding
 * [s]. */
static double touch_after_graze(const struct contact_shape *shape, const struct separation_path *path,
                                double noise, double settled, double horizon)
{
    const struct separation_path from = zone_path_from(path, settled);
    struct advancement_path along = {
        .shape = *shape, .axis = axis_motion_fixed(shape->axis), .rounding = noise};
    memcpy(along.c, from.c, sizeof along.c);
    return settled + advancement_first(&along, ADVANCEMENT_TOUCH, horizon - settled, GRAZE_EVALUATIONS).after;
}

double zone_change_touch(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon)
{
    const struct contact_shape shape = scene_whole_shape(v, q, contact);
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    const double noise = rounding_of_gap(v, at, contact);
    double time = fmax(0.0, q->contact[contact].schedule.dead_band_clock - clock);
    bool near = fabs(at->geometry[contact].gap) <= noise;
    for (int i = 0; i < TRIALS && time <= horizon; ++i) {
        if (near) {
            const struct separation_path from = zone_path_from(&path, time);
            const struct meeting meeting = meeting_of(&shape, &from, noise);
            if (!meeting.is_clear) {
                return touch_after_graze(&shape, &path, noise, time, horizon);
            }
            if (meeting.closes) {
                return time;
            }
            time += meeting.rising;
        }
        time = zone_path_first_touch(&shape, &path, at->geometry[contact].gap, time, horizon);
        near = true;
    }
    return (double)INFINITY;
}

#endif
