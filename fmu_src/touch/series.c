#include <float.h>
#include <string.h>

#include "math/nodes.h"
#include "touch/segment.h"

/* A contact pair by power series, under either law and at any place (touch/expansion.h). A series is exact to
 * its accuracy over a few radians of the contact's oscillation. */

/* Number of coefficients that are made before the rest, to recognize quasi-static motion by them. */
enum { SERIES_FIRST = 7 };

/* Whether the series is one by u, under Hertz's law. */
static inline bool goes_by_u(const struct pair_series *p)
{
    return SCENE_ANY_HERTZ && p->terms.paced_by == 0;
}

/* Returns the series of u [sqrt(m)], or of g [m]. */
static inline const double *opened_of(const struct pair_series *p)
{
    return goes_by_u(p) ? p->terms.pace.row : p->row.gap;
}

/* Returns the unit of s [s]. It is one radian of the contact's oscillation, one decay time of its damping,
 * or the time of passage, whichever is shortest. In the time of passage d changes by its own size, at the
 * present speed or from rest under load and contact force. Under Hertz's law the rates are taken at the
 * penetration to come. The unit's order of magnitude suffices to keep the coefficients within the range of
 * numbers. */
static double unit_of(const struct pair_series *p, bool by_root)
{
    const struct contact_pair *from = p->from;
    double passage = 0.0;
    if (p->flight->dimensions > 1) {
        const double force = fabs(from->coefficients.k * from->gap) / from->reduced_mass;
        const double acceleration = force + 2.0 * vec3_norm(from->flight.c[2]);
        passage = fmax(vec3_norm(from->flight.w[0]) / from->distance, sqrt(acceleration / from->distance));
    }
    double spring = sqrt(from->coefficients.k / from->reduced_mass);
    double dashpot = from->coefficients.c / from->reduced_mass;
    double root = 1.0;
    if (SCENE_ANY_HERTZ && by_root) {
        const double k = from->hertz_stiffness / from->reduced_mass;
        const double depth = hertz_depth_to_come(from, pair_gap_derivative(from));
        root = sqrt(depth);
        spring = sqrt(1.5 * k * root);
        dashpot = k * from->chi * depth * root;
    }
    const double unit = 1.0 / (fmax(spring, fmax(dashpot, passage)) * root);
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
}

/* Makes the first SERIES_FIRST coefficients. `by_root` is allowed only under Hertz's law with g <= 0, and not
 * from rest at g = 0, where time does not advance with s. */
static void begin_series(struct pair_series *p, const struct contact_pair *from,
                         const struct frame_flight *flight, bool by_root)
{
    struct expansion_row *r = &p->row;
    const bool at_rim = contact_is_circle(&from->shape);
    p->from = from;
    p->flight = flight;
    memset(&p->terms, 0, sizeof p->terms);
    memset(r, 0, sizeof *r);
    memset(&p->body[1], 0, sizeof p->body[1]); /* body 0 does not move */
    p->terms.rows = 1;
    p->terms.row = r;
    p->terms.body = p->body;
    p->terms.is_framed = true;
    p->terms.axes = p->flight->dimensions;
    p->terms.degree = p->flight->degree;
    p->terms.paced_by = by_root ? 0 : -1;
    p->terms.unit = unit_of(p, by_root);
    taylor_put(&p->terms.pace, 0, by_root ? sqrt(fmax(-from->gap, 0.0)) : 1.0);
    p->body[1].by_mass = 1.0 / from->reduced_mass;
    r->side = from->shape.side;
    r->is_hertz = by_root;
    r->k = by_root ? from->hertz_stiffness : from->coefficients.k;
    r->c = by_root ? from->chi : from->coefficients.c;
    r->by_distance = 1.0 / from->distance;
    r->gap[0] = from->gap;
    memcpy(r->flown, p->flight->c, sizeof p->flight->c);
    memcpy(r->flown_rate, p->flight->w, sizeof p->flight->w);
    for (int j = 0; j < FRAME; ++j) {
        /* Away from a rim, n at the start is the first direction of the frame, without rounding. */
        const double along = j == 0 ? 1.0 : 0.0;
        taylor_put(&r->n[j], 0, at_rim ? vec3_dot(p->flight->frame[j], from->normal) : along);
    }
    r->rate[0] = from->rate;
    if (CONTACT_ANY_CIRCLE && at_rim) {
        p->rim.radius = from->shape.solid.radius;
        p->rim.half_height = from->shape.solid.half_height;
        r->rim = &p->rim;
    }
    for (int i = 0; SCENE_ANY_PRESCRIBED && from->has_mismatch && i < SEPARATION_DEGREE; ++i) {
        for (int j = 0; j < FRAME; ++j) {
            p->mismatch[FRAME * i + j] = (i + 1) * p->flight->c[i + 1][j] - p->flight->w[i][j];
        }
        r->mismatch = p->mismatch;
    }
    expansion_make(&p->terms, 0, SERIES_FIRST);
}

void series_sample(const void *pair_series, double s, struct pair_sample *sample)
{
    const struct pair_series *p = pair_series;
    double *gap = sample->of[PAIR_GAP];
    double *rate = sample->of[PAIR_GAP_RATE];
    taylor_derivatives(p->row.rate, TAYLOR_TERMS, s, rate);
    if (goes_by_u(p)) {
        double opened[3];
        taylor_derivatives(p->terms.pace.row, TAYLOR_TERMS, s, opened);
        gap[0] = -opened[0] * opened[0];
        gap[1] = -2.0 * opened[0] * opened[1];
        gap[2] = -2.0 * (opened[1] * opened[1] + opened[0] * opened[2]);
        pair_hertz_force(p->from, opened, rate, sample->of[PAIR_FORCE]);
    } else {
        gap[0] = taylor_at(p->row.gap, TAYLOR_TERMS, s);
        gap[1] = p->terms.unit * rate[0];
        gap[2] = p->terms.unit * rate[1];
        if (SCENE_ANY_PRESCRIBED && p->row.mismatch != NULL) {
            taylor_derivatives(p->row.gap, TAYLOR_TERMS, s, gap);
        }
        for (int i = 0; i < 3; ++i) {
            sample->of[PAIR_FORCE][i] = contact_linear_force(p->from->coefficients, gap[i], rate[i]);
        }
    }
    if (SCENE_ANY_CAPS && contact_is_rim(&p->from->shape)) {
        taylor_derivatives(p->rim.radial, TAYLOR_TERMS, s, sample->of[PAIR_RADIAL]);
        taylor_derivatives(p->rim.axial, TAYLOR_TERMS, s, sample->of[PAIR_AXIAL]);
    }
}

/* Returns a series of vectors at one s, in the world. */
static struct vec3 vector_at(const struct pair_series *p, const taylor_row *rows, double s)
{
    struct vec3 out = vec3_make(0.0, 0.0, 0.0);
    for (int j = 0; j < p->terms.axes; ++j) {
        out = vec3_axpy(out, taylor_at(rows[j], TAYLOR_TERMS, s), p->flight->frame[j]);
    }
    return out;
}

void series_moments(const void *pair_series, double s, const struct pair_change *change, int count,
                    struct vec3 *moment)
{
    const struct pair_series *p = pair_series;
    (void)change;
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        double weight;
        double time[3];
        const double at = expansion_node(i, s, &weight);
        const struct vec3 r = vector_at(p, p->body[1].moved, at);
        expansion_time(&p->terms, at, time);
        weight *= time[1];
        for (int j = 0; j < count; ++j) {
            moment[j] = vec3_axpy(moment[j], weight, r);
            weight *= time[0];
        }
    }
}

struct pair_change series_advance(const void *pair_series, double s)
{
    const struct pair_series *p = pair_series;
    const double opened = taylor_at(opened_of(p), TAYLOR_TERMS, s);
    return (struct pair_change){.time = expansion_time_at(&p->terms, s),
                                .r = vector_at(p, p->body[1].moved, s),
                                .r_rate = vector_at(p, p->body[1].rate, s),
                                .gap = goes_by_u(p) ? -opened * opened : opened,
                                .dissipated = expansion_dissipated(&p->terms, s)};
}

/* Numbers of samples of a segment, such that no quantity has two extrema between two samples. A series by u
 * is at most a third of its radius of convergence long. In a series by time the contact may oscillate or pass
 * the centre. */
enum { PLACES_BY_ROOT = 3, PLACES_BY_TIME = 5 };

/*
 * The accuracy of a series is the size of its last terms relative to the whole. For a series by time it is
 * ROUNDING, because one series takes most of a soft contact. For a series by u it is the segment's tolerance
 * between FINEST, some roundings, and FINE, with which energies balance to 1e-10 over thousands of segments.
 * Under a coarse tolerance it is PART_OF_COARSE times the tolerance, up to COARSEST, with which energies
 * balance to 1e-10 over an impact.
 */
static const double ROUNDING = 0.5 * DBL_EPSILON;
static const double FINEST = 8.0 * DBL_EPSILON;
static const double FINE = 1e-13;
static const double PART_OF_COARSE = 0.01;
static const double COARSEST = 1e-11;

bool series_make(struct segment *p)
{
    struct pair_series *made = &p->as.series;
    const bool is_hertz = contact_is_hertz(&p->pair.law);
    const double coasting = SCENE_ANY_HERTZ && is_hertz ? hertz_coasting_time(p) : 0.0;
    const bool by_root = is_hertz && !(coasting > 0.0); /* no series by u starts at rest at the touch */
    p->longest = coasting > 0.0 ? coasting : p->longest;
    p->work += SERIES_WORK;
    begin_series(made, &p->pair, &p->flight, by_root);
    const double *opened = opened_of(made);
    if (SCENE_ANY_HERTZ && by_root && p->may_be_quasi_static &&
        quasi_static_is_shown(p, opened, made->terms.unit)) {
        return false;
    }
    expansion_make(&made->terms, SERIES_FIRST, TAYLOR_TERMS);
    const double *rate = made->row.rate;
    const double speed = fmax(fabs(rate[0]), fmax(fabs(rate[1]), fabs(rate[2])));
    const double size = fmax(p->pair.distance, contact_reach(&p->pair.shape));
    const double asked = p->tolerance / size;
    const double by_u = fmax(fmin(fmax(asked, FINEST), FINE), fmin(PART_OF_COARSE * asked, COARSEST));
    const double step = expansion_reliable(&made->terms, by_root ? 0.0 : size, p->pair.reduced_mass * speed,
                                           by_root ? by_u : ROUNDING);
    if (SCENE_ANY_HERTZ && by_root) { /* the bodies part where u passes through zero */
        const bool opens = opened[0] == 0.0 && !(opened[1] > 0.0);
        p->parting = opens ? 0.0 : taylor_first_fall(opened, TAYLOR_TERMS, step);
    }
    p->end = p->parting > 0.0 ? fmin(step, p->parting) : step;
    if (p->parting != 0.0 && expansion_time_at(&made->terms, p->end) > p->longest) {
        p->end = pair_place_by(expansion_time, &made->terms, p->longest, p->end);
        p->parting = p->end < p->parting ? (double)INFINITY : p->parting;
    }
    const int places = by_root ? PLACES_BY_ROOT : PLACES_BY_TIME;
    for (int i = 0; i < places; ++i) {
        dense_output_add(&p->output, p->end * i / (places - 1));
    }
    return true;
}
