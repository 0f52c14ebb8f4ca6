#include "segment/zone_change.h"

#include <stddef.h>

#include "contact/zone.h"
#include "math/taylor.h"
#include "scene/present.h"
#include "scene/rounding.h"
#include "segment/zone_path.h"

#if SCENE_ANY_CAPS

/* The distance from the axis less r_d, that along it less L / 2, and the gap, as Taylor series of time. The
 * square of a distance is a polynomial of degree eight: one whose terms are all zero stays as it is. */
enum { GAP_TERMS = 2 * SEPARATION_DEGREE + 1 };

struct gap_series {
    double radial[GAP_TERMS], axial[GAP_TERMS], gap[GAP_TERMS];
    double rounding; /* of the first terms [m] */
    /* A term of order i is rounding below `rounding` rate[i]^i: the inverse of the time in which the terms of
     * the path up to that order move it by its distance from what it turns about [1/s] */
    double rate[GAP_TERMS];
};

/* The first term that is more than rounding; 0 where none is, too. */
static int first_term(const struct gap_series *series, const double *terms)
{
    for (int i = 0; i < GAP_TERMS; ++i) {
        if (fabs(terms[i]) > series->rounding * pow(series->rate[i], i)) {
            return i;
        }
    }
    return 0;
}

/* The part across the axis is projected by itself, so that a path along the axis has none. */
static void put_solid_place(struct gap_series *series, const struct contact_solid *solid,
                            const struct separation_path *path)
{
    struct vec3 across[SEPARATION_DEGREE + 1];
    double square[GAP_TERMS] = {0.0};
    double rho[GAP_TERMS] = {0.0};
    const double up = vec3_dot(path->c[0], solid->axis) > 0.0 ? 1.0 : -1.0;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        const double along = vec3_dot(path->c[i], solid->axis);
        across[i] = vec3_axpy(path->c[i], -along, solid->axis);
        series->axial[i] = up * along - (i == 0 ? solid->half_height : 0.0);
    }
    for (int i = 0; i < GAP_TERMS; ++i) {
        for (int k = i > SEPARATION_DEGREE ? i - SEPARATION_DEGREE : 0; k <= i && k <= SEPARATION_DEGREE;
             ++k) {
            square[i] += vec3_dot(across[k], across[i - k]);
        }
        /* over the middle of a cap it is less than r_d, whatever follows */
        rho[i] = square[0] > 0.0 ? taylor_root(square, rho, i) : 0.0;
        series->radial[i] = rho[i] - (i == 0 ? solid->radius : 0.0);
    }
}

static void put_term_rates(struct gap_series *series, const struct separation_path *path, double distance)
{
    for (int i = 1; i < GAP_TERMS; ++i) {
        const double own = i <= SEPARATION_DEGREE ? pow(vec3_norm(path->c[i]) / distance, 1.0 / i) : 0.0;
        series->rate[i] = fmax(series->rate[i - 1], own);
    }
}

/* The gap in the zone into which the path goes, whichever it is in. */
static struct gap_series gap_series_of(const struct contact_shape *shape, const struct separation_path *path,
                                       double rounding)
{
    struct gap_series series = {.rounding = rounding};
    const struct contact_geometry at =
        contact_geometry_at(shape, path->c[0], path->c[1], vec3_make(0.0, 0.0, 0.0));
    put_solid_place(&series, &shape->solid, path);
    put_term_rates(&series, path, at.distance);
    const bool beyond_side = series.radial[first_term(&series, series.radial)] > 0.0;
    const bool beyond_cap = series.axial[first_term(&series, series.axial)] > 0.0;
    double square[GAP_TERMS];
    for (int i = 0; i < GAP_TERMS; ++i) {
        if (beyond_side && beyond_cap) {
            square[i] = taylor_multiply(series.radial, series.radial, i) +
                        taylor_multiply(series.axial, series.axial, i);
            series.gap[i] = taylor_root(square, series.gap, i);
        } else {
            series.gap[i] = beyond_cap ? series.axial[i] : series.radial[i];
        }
    }
    series.gap[0] = 0.0;
    return series;
}

/* How bodies that meet, to rounding, go on. */
struct meeting {
    bool closes; /* they overlap */
    /* else they stay met for so long: until the gap is more than rounding, or back at zero [s] */
    double leaving;
};

/* Positions tell the gap to `noise`. `known` points to a gap that is known better, as where a contact has
 * just ended: its sign and that of its rate then count however small they are, for a ball may hop by less
 * than rounding. */
static struct meeting meeting_of(const struct contact_shape *shape, const struct separation_path *path,
                                 double noise, const double *known)
{
    struct gap_series series = gap_series_of(shape, path, noise);
    int first = first_term(&series, series.gap);
    if (known && *known >= 0.0 && (*known > 0.0 || series.gap[1] > 0.0)) {
        series.gap[0] = *known;
        first = *known > 0.0 ? 0 : 1;
    }
    struct meeting meeting = {series.gap[first] < 0.0, (double)INFINITY};
    for (int i = 1; i < GAP_TERMS; ++i) {
        meeting.leaving = fmin(meeting.leaving, pow(noise / fabs(series.gap[i]), 1.0 / i));
    }
    if (meeting.leaving < (double)INFINITY) {
        struct polynomial hop = {{0.0}, GAP_TERMS - 1 - first};
        for (int i = first; i < GAP_TERMS; ++i) {
            hop.a[i - first] = series.gap[i] * pow(meeting.leaving, i) / noise;
        }
        double roots[POLYNOMIAL_MAX_DEGREE];
        meeting.leaving *= polynomial_sign_changes(&hop, roots) > 0 ? roots[0] : 1.0;
    }
    return meeting;
}

/* Rounding of a gap that stays at zero may be met more than once. */
enum { TRIALS = 1000 };

double zone_change_touch(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon)
{
    const struct contact_shape shape = scene_whole_shape(v, q, contact);
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    const double noise = rounding_of_gap(v, at, contact);
    const double *known = scene_gap_is_accumulated(q, at, contact) ? &at->geometry[contact].gap : NULL;
    double time = fmax(0.0, q->contact[contact].schedule.settled_clock - clock);
    bool near = fabs(at->geometry[contact].gap) <= noise;
    for (int i = 0; i < TRIALS && time <= horizon; ++i) {
        if (near) {
            struct separation_path from = path;
            path_shift(from.c, SEPARATION_DEGREE + 1, time);
            const struct meeting meeting = meeting_of(&shape, &from, noise, i == 0 ? known : NULL);
            if (meeting.closes) {
                return time;
            }
            if (!(meeting.leaving < horizon)) {
                return (double)INFINITY; /* they stay as they are */
            }
            time += meeting.leaving;
        }
        time = zone_path_first_touch(&shape, &path, at->geometry[contact].gap, time, horizon);
        near = true;
    }
    return (double)INFINITY;
}

double zone_change_after(const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, double clock, int contact, double horizon)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    return zone_path_end(&shape.solid, &path, horizon);
}

struct rim_change zone_change_at_rim(const struct scene_values *v, const struct scene_state *q,
                                     const struct scene_instant *at, double clock, int contact,
                                     double horizon)
{
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const struct contact_law law = scene_contact_law(v, q, contact);
    const struct separation_path path = separation_path_of(v, q, at, clock, contact);
    const enum contact_regime present = (enum contact_regime)q->contact[contact].regime;
    return rim_first_change(&shape, &law, &path, rounding_of_gap(v, at, contact), present, 0.0, horizon);
}

#endif
