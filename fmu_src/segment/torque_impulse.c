#include "segment/torque_impulse.h"

#include <string.h>

#include "math/compiler.h"
#include "math/gauss.h"

#if SCENE_HAS_TORQUES

/* What counts of C, at most; its second derivative: polynomials of time. */
struct lever {
    struct vec3 c[SEPARATION_DEGREE + 1];
    struct vec3 bend[SEPARATION_DEGREE - 1];
};

/* Whether the relative acceleration of the flight varies. */
static bool varies(const struct vec3 c[SEPARATION_DEGREE + 1])
{
    return !vec3_is_zero(c[3]) || !vec3_is_zero(c[4]);
}

/* C x r' - C' x r at a time. */
static inline struct vec3 boundary_terms(const struct vec3 c[SEPARATION_DEGREE + 1], bool vary,
                                         const struct pair_change *change)
{
    const double t = change->time;
    struct vec3 at = vec3_axpy(c[1], t, c[2]);
    struct vec3 rate = vec3_axpy(c[1], 2.0 * t, c[2]);
    if (vary) {
        at = vec3_axpy(vec3_axpy(at, t * t, c[3]), t * t * t, c[4]);
        rate = vec3_axpy(vec3_axpy(rate, 3.0 * t * t, c[3]), 4.0 * t * t * t, c[4]);
    }
    at = vec3_axpy(c[0], t, at);
    return vec3_sub(vec3_cross(at, change->r_rate), vec3_cross(rate, change->r));
}

/*
 * The integrals of t^j rho over a head-on motion in closed form, where r = side rho n and m_red rho'' = F_n =
 * -k g - c g'. With G_j that of t^j (g - g(0))
 *
 *   k (G_j + g(0) t^(j+1)/(j+1)) = -m_red I_j - c J_j,   without a spring 0 = m_red I_(j+1) + c J_(j+1)
 *   I_j = t^j rho' - j t^(j-1) rho + j (j-1) M_(j-2),    J_j = t^j (g - g(0)) - j G_(j-1)
 *
 * and rho = g less the gap of the flight.
 */
static void head_on_moments(const struct contact_pair *p, const struct pair_change *change,
                            double moment[SEPARATION_DEGREE - 1])
{
    const double k = p->coefficients.k;
    const double c = p->coefficients.c;
    const double t = change->time;
    const double grown = change->gap - p->gap;
    const double rho = p->shape.side * vec3_dot(p->normal, change->r);
    const double rho_rate = p->shape.side * vec3_dot(p->normal, change->r_rate);
    double before = 0.0; /* G_(j-1) */
    double power = 1.0;  /* t^j */
    for (int j = 0; j < SEPARATION_DEGREE - 1; ++j) {
        const double second = j < 2 ? 0.0 : moment[j - 2];
        const double inertia =
            power * rho_rate - (j > 0 ? j * (power / t) * rho : 0.0) + j * (j - 1) * second;
        const double next =
            power * t * rho_rate - (j + 1) * power * rho + (j > 0 ? (j + 1) * j * moment[j - 1] : 0.0);
        const double damped = power * grown - j * before;
        const double of_gap =
            k > 0.0 ? -(p->reduced_mass * inertia + c * damped) / k - p->gap * power * t / (j + 1)
                    : (power * t * grown + p->reduced_mass / c * next) / (j + 1);
        double flown = 0.0;
        for (int i = SEPARATION_DEGREE; i > 0; --i) {
            flown = t * (flown + p->shape.side * vec3_dot(p->normal, p->flight.c[i]) / (i + j + 1));
        }
        moment[j] = of_gap - power * t * flown;
        before = of_gap;
        power *= t;
    }
}

static struct vec3 head_on(const struct contact_pair *p, const struct lever *lever,
                           const struct pair_change *change)
{
    double moment[SEPARATION_DEGREE - 1];
    struct vec3 sum = {0.0, 0.0, 0.0};
    head_on_moments(p, change, moment);
    for (int j = 0; j < SEPARATION_DEGREE - 1; ++j) {
        sum = vec3_axpy(sum, p->shape.side * moment[j], vec3_cross(lever->bend[j], p->normal));
    }
    return sum;
}

/* The motion of an impact is smooth but for the power 7/2 of time at its ends. */
enum { PANELS = 8 };

static struct vec3 by_quadrature(struct segment *p, pair_changer *changer, const struct lever *lever,
                                 double time)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    const double half = 0.5 * time / PANELS;
    for (int i = 0; i < PANELS * GAUSS_NODES; ++i) {
        const struct gauss_place place = gauss_place(i % GAUSS_NODES, true);
        const int panel = i / GAUSS_NODES;
        const double t = half * (2.0 * panel + place.at);
        const struct pair_change then = changer(&p->as, segment_place(p, t));
        const struct vec3 bend = path_at(lever->bend, SEPARATION_DEGREE - 1, t);
        const double weight = half * GAUSS_WEIGHT[i % GAUSS_NODES] * place.factor;
        sum = vec3_axpy(sum, weight, vec3_cross(bend, then.r));
    }
    return sum;
}

/* As works (contact_pair.h), which segments integrate exactly: e_k.(C'' x r) = (e_k x C'').r, and by parts
 * the integral of W.r is that of P.r' less P.r at the end, with P' = -W. */
static struct vec3 as_works(struct segment *p, pair_changer *changer, const struct lever *lever,
                            const struct pair_change *change, double s)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k += PAIR_BODIES) {
        struct pair_work *work = p->pair.work;
        for (int i = 0; i < PAIR_BODIES; ++i) {
            struct vec3 unit = {0.0, 0.0, 0.0};
            vec3_set(&unit, (k + i) % 3, 1.0);
            work[i] = (struct pair_work){.order = 1, .factor = 0.0};
            work[i].path[1] = vec3_scale(-1.0, vec3_cross(unit, lever->bend[0]));
            work[i].path[2] = vec3_scale(-0.5, vec3_cross(unit, lever->bend[1]));
        }
        const struct pair_change then = changer(&p->as, s);
        for (int i = 0; i < PAIR_BODIES && k + i < 3; ++i) {
            const struct vec3 path = path_at(work[i].path, 3, change->time);
            vec3_set(&sum, k + i, then.work[i] - vec3_dot(path, change->r));
        }
    }
    return sum;
}

static CONTACT_NOINLINE struct vec3 of_bend(struct segment *p, pair_changer *changer, struct lever *lever,
                                            const struct pair_change *change, double s)
{
    for (int i = 2; i <= SEPARATION_DEGREE; ++i) {
        lever->bend[i - 2] = vec3_scale(i * (i - 1), lever->c[i]);
    }
    if (p->kind == SEGMENT_CLOSED_FORM) {
        return head_on(&p->pair, lever, change);
    }
    bool by_nodes = !vec3_is_zero(lever->bend[2]); /* a path has three coefficients */
#if SCENE_ANY_HERTZ
    by_nodes = by_nodes || p->kind == SEGMENT_HERTZ_ELASTIC;
#endif
    return by_nodes ? by_quadrature(p, changer, lever, change->time) : as_works(p, changer, lever, change, s);
}

/* Along the axis of a cylinder's side. */
static CONTACT_NOINLINE struct vec3 at_side(struct segment *p, pair_changer *changer,
                                            const struct pair_change *change, double s,
                                            const double along[SEPARATION_DEGREE + 1])
{
    struct lever lever;
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) {
        lever.c[i] = vec3_scale(along[i], p->pair.shape.axis);
    }
    const bool vary = along[3] != 0.0 || along[4] != 0.0;
    const bool bends = along[2] != 0.0 || vary;
    const struct vec3 sum = boundary_terms(lever.c, vary, change);
    return bends ? vec3_add(sum, of_bend(p, changer, &lever, change, s)) : sum;
}

/* At a plane, a cap or a rim. The part of C along n is in no product with r but by rounding; where C'' has no
 * other part there is nothing to integrate. */
static struct vec3 at_face(struct segment *p, pair_changer *changer, const struct pair_change *change,
                           double s)
{
    struct vec3 c[SEPARATION_DEGREE + 1];
    const bool is_rim = contact_is_rim(&p->pair.shape);
    for (int i = 0; i <= SEPARATION_DEGREE; ++i) { /* of bodies at rest C along n is a flight, however far */
        const struct vec3 flight = p->pair.flight.c[i];
        c[i] = is_rim ? flight : contact_across_plane(p->pair.normal, flight);
    }
    const bool vary = varies(c);
    bool bends = vary || !vec3_is_zero(vec3_cross(c[2], p->pair.normal));
    struct vec3 sum = boundary_terms(c, vary, change);
    if (is_rim) {
        sum = vec3_add(sum, vec3_cross(change->r, change->r_rate));
        bends = true;
    }
    if (bends) {
        struct lever lever;
        memcpy(lever.c, c, sizeof lever.c);
        sum = vec3_add(sum, of_bend(p, changer, &lever, change, s));
    }
    return sum;
}

struct vec3 torque_impulse(struct segment *p, pair_changer *changer, const struct pair_change *change,
                           double s)
{
    const struct contact_pair *pair = &p->pair;
    struct vec3 sum = {0.0, 0.0, 0.0};
    if (!(change->time > 0.0)) {
        return sum;
    }
    if (contact_is_plane(&pair->shape) || contact_is_rim(&pair->shape)) {
        sum = at_face(p, changer, change, s);
    } else if (contact_is_cylinder(&pair->shape)) {
        double along[SEPARATION_DEGREE + 1] = {pair->axial}; /* c[0] may lack it */
        bool acts = pair->axial != 0.0;
        for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
            along[i] = vec3_dot(pair->shape.axis, pair->flight.c[i]);
            acts = acts || along[i] != 0.0;
        }
        sum = acts ? at_side(p, changer, change, s, along) : sum;
    }
    return vec3_scale(-pair->reduced_mass, sum);
}

#endif
