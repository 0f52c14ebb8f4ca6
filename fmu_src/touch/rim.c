#include <float.h>

#include "math/compiler.h"
#include "math/polynomial.h"
#include "touch/hertz.h"
#include "touch/pair.h"
#include "touch/rim.h"
#include "touch/segment.h"

/* The unit of a series at a rim. */

/* One radian of the spring, one decay time of the dashpot, or the passage, whichever is shortest: [s], or
 * [s/sqrt(m)] by the root of the penetration. The order of magnitude is enough. */
static double rim_unit_of(const struct contact_pair *from, bool by_root);

/* The time in which the pair passes the rim, at its speed, or under load and force from rest [s]. */
static double passage_of_rim(const struct contact_pair *from)
{
    const double size = from->distance; /* less than rho in the zone, or the circle is small beside both */
    const double force = fabs(from->coefficients.k * from->gap) / from->reduced_mass;
    const double acceleration = force + 2.0 * vec3_norm(from->flight.c[2]);
    return fmin(size / vec3_norm(from->flight.w[0]), sqrt(size / acceleration));
}

#if SCENE_ANY_HERTZ
/* Under Hertz's law at the deepest that speed, load and penetration lead to (as in hertz.c). */
static double hertz_unit_at_rim(const struct contact_pair *from)
{
    const double k = from->hertz_stiffness / from->reduced_mass;
    const double depth = pair_hertz_depth_to_come(from, pair_gap_derivative(from));
    const double root = sqrt(depth);
    const double radian = 1.0 / fmax(sqrt(1.5 * k * root), k * from->chi * depth * root);
    return fmin(passage_of_rim(from), radian) / root;
}
#else
static double hertz_unit_at_rim(const struct contact_pair *from)
{
    (void)from;
    return 1.0;
}
#endif

static double rim_unit_of(const struct contact_pair *from, bool by_root)
{
    double unit = passage_of_rim(from);
    if (by_root) {
        unit = hertz_unit_at_rim(from);
    } else if (from->coefficients.k > 0.0 || from->coefficients.c > 0.0) {
        unit = fmin(unit, fmin(sqrt(from->reduced_mass / from->coefficients.k),
                               from->reduced_mass / from->coefficients.c));
    }
    return isfinite(unit) && unit > 0.0 ? unit : 1.0;
}

/* Everything that the recurrence needs besides the results. */
struct rim_recurrence {
    double speed[TAYLOR_TERMS];                        /* dt/ds over the unit: u or one */
    double power[SEPARATION_DEGREE + 1][TAYLOR_TERMS]; /* t^k */
    struct taylor_vec3 across;                         /* c across the axis [m] */
    struct taylor_vec3 w, c_rate;                      /* rate as the law sees it; that of c [m/s] */
    struct taylor_vec3 a, n;
    double along[TAYLOR_TERMS]; /* c.e [m] */
    double rho_squared[TAYLOR_TERMS], rho[TAYLOR_TERMS];
    double d_squared[TAYLOR_TERMS], d[TAYLOR_TERMS];
    double cosine[TAYLOR_TERMS], sine[TAYLOR_TERMS]; /* dr / d, dz / d */
    double opening[TAYLOR_TERMS];                    /* dg/dt [m/s] */
    double square[TAYLOR_TERMS];                     /* u^2 */
    double damped[TAYLOR_TERMS];                     /* 1 + chi delta' */
    double drag[TAYLOR_TERMS];                       /* less what a spring alone pushes with [N] */
    double drag_power[TAYLOR_TERMS];                 /* [W] */
    double impulse[TAYLOR_TERMS];                    /* F_n dt/ds over the unit */
    int degree;                                      /* of C */
    bool by_root;
};

static struct vec3 rim_product(const double *a, const struct taylor_vec3 *b, int order)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i <= order; ++i) {
        sum = vec3_axpy(sum, a[i], b->at[order - i]);
    }
    return sum;
}

/* Coefficient i of a polynomial of time of `terms` coefficients. Where t = unit s, only t^i has one. */
static struct vec3 rim_along_time(const struct rim_recurrence *z, const struct vec3 *coefficients, int terms,
                                  int i)
{
    struct vec3 sum = {0.0, 0.0, 0.0};
    if (!z->by_root) {
        return i < terms ? vec3_axpy(sum, z->power[i][i], coefficients[i]) : sum;
    }
    for (int k = 0; k < terms; ++k) {
        sum = vec3_axpy(sum, z->power[k][i], coefficients[k]);
    }
    return sum;
}

static int rim_degree_of(const struct separation_path *flight)
{
    int degree = 1;
    for (int i = 2; i <= SEPARATION_DEGREE; ++i) {
        const bool counts = !vec3_is_zero(flight->c[i]) || !vec3_is_zero(flight->w[i - 1]);
        degree = counts ? i : degree;
    }
    return degree;
}

/* Coefficient i of the powers of time. */
static void rim_powers_of_time(const struct rim_series *p, struct rim_recurrence *z, int i)
{
    if (!p->by_root) {
        if (i <= z->degree) {
            z->power[i][i] = i == 0 ? 1.0 : z->power[i - 1][i - 1] * p->time[1];
        }
        return;
    }
    z->power[0][i] = i == 0 ? 1.0 : 0.0;
    z->power[1][i] = p->time[i];
    for (int k = 2; k <= z->degree; ++k) {
        z->power[k][i] = taylor_multiply(z->power[k - 1], p->time, i);
    }
}

/* Coefficient i of c, w and of where that is. */
static void rim_place(struct rim_series *p, struct rim_recurrence *z, int i)
{
    const struct contact_pair *from = p->from;
    const struct vec3 e = from->shape.axis;
    rim_powers_of_time(p, z, i);
    const struct vec3 c = vec3_add(rim_along_time(z, from->flight.c, z->degree + 1, i), p->r.at[i]);
    z->w.at[i] = vec3_add(rim_along_time(z, from->flight.w, z->degree, i), p->r_rate.at[i]);
    z->c_rate.at[i] = z->w.at[i];
    if (from->has_mismatch) {
        struct vec3 slope[SEPARATION_DEGREE];
        for (int k = 0; k < z->degree; ++k) {
            slope[k] = vec3_scale(k + 1, from->flight.c[k + 1]);
        }
        z->c_rate.at[i] = vec3_add(rim_along_time(z, slope, z->degree, i), p->r_rate.at[i]);
    }
    z->along[i] = vec3_dot(c, e);
    z->across.at[i] = vec3_axpy(c, -z->along[i], e);
}

/* Coefficient i of n and of both rates of the gap. */
static void rim_geometry(struct rim_series *p, struct rim_recurrence *z, int i)
{
    const struct contact_pair *from = p->from;
    const struct contact_solid *solid = &from->shape.solid;
    z->rho_squared[i] = taylor_dot(&z->across, &z->across, i);
    z->rho[i] = taylor_root(z->rho_squared, z->rho, i);
    z->a.at[i] = taylor_divide_vec3(&z->across, z->rho, &z->a, i);
    p->radial[i] = z->rho[i] - (i == 0 ? solid->radius : 0.0);
    p->axial[i] = -z->along[i] - (i == 0 ? solid->half_height : 0.0);
    z->d_squared[i] = taylor_multiply(p->radial, p->radial, i) + taylor_multiply(p->axial, p->axial, i);
    z->d[i] = taylor_root(z->d_squared, z->d, i);
    z->cosine[i] = taylor_divide(p->radial, z->d, z->cosine, i);
    z->sine[i] = taylor_divide(p->axial, z->d, z->sine, i);
    z->n.at[i] = vec3_axpy(rim_product(z->cosine, &z->a, i), -z->sine[i], from->shape.axis);
    const bool is_carried = i == 0 && !isnan(from->carried_rate);
    p->rate[i] = is_carried ? from->carried_rate : taylor_dot(&z->n, &z->w, i);
    z->opening[i] = !from->has_mismatch ? p->rate[i]
                    : is_carried        ? pair_gap_derivative(from)
                                        : taylor_dot(&z->n, &z->c_rate, i);
}

/* Coefficient i of the gap and the force. */
static void rim_force(struct rim_series *p, struct rim_recurrence *z, int i)
{
    const struct contact_pair *from = p->from;
    if (!p->by_root) {
        p->gap[i] = i == 0 ? from->gap : z->d[i];
        if (i == 1 && !isnan(from->carried_rate)) { /* d from c moves by the rounding of velocities */
            p->gap[1] = p->unit * pair_gap_derivative(from);
        }
        p->force[i] = contact_linear_force(from->coefficients, p->gap[i], p->rate[i]);
        return;
    }
    z->square[i] = taylor_multiply(p->root, p->root, i);
    p->gap[i] = -z->square[i];
    p->cube[i] = taylor_multiply(z->square, p->root, i);
    z->damped[i] = (i == 0 ? 1.0 : 0.0) - from->chi * p->rate[i];
    p->force[i] = from->hertz_stiffness * taylor_multiply(p->cube, z->damped, i);
}

/* Coefficient i of the dissipated power: c g'^2, or -(F_n - k_h u^3) g' dt/ds. */
static void rim_loss(struct rim_series *p, struct rim_recurrence *z, int i)
{
    const struct contact_pair *from = p->from;
    if (!p->damps) {
        return;
    }
    z->drag[i] =
        p->by_root ? from->hertz_stiffness * p->cube[i] - p->force[i] : from->coefficients.c * p->rate[i];
    z->drag_power[i] = taylor_multiply(z->drag, p->rate, i);
    p->lost[i] = p->by_root ? taylor_multiply(z->drag_power, p->root, i) : z->drag_power[i];
}

/* Coefficient i of everything, then i + 1 of what is integrated. */
static void rim_coefficient(struct rim_series *p, struct rim_recurrence *z, int i)
{
    z->speed[i] = p->by_root ? p->root[i] : i == 0 ? 1.0 : 0.0;
    rim_place(p, z, i);
    rim_geometry(p, z, i);
    rim_force(p, z, i);
    rim_loss(p, z, i);
    if (i + 1 == TAYLOR_TERMS) {
        return;
    }
    z->impulse[i] = p->by_root ? taylor_multiply(z->speed, p->force, i) : p->force[i];
    const double unit = p->unit / (i + 1);
    p->time[i + 1] = unit * z->speed[i];
    p->root[i + 1] = -0.5 * unit * z->opening[i];
    p->r.at[i + 1] = vec3_scale(unit, p->by_root ? rim_product(z->speed, &p->r_rate, i) : p->r_rate.at[i]);
    p->r_rate.at[i + 1] = vec3_scale(unit / p->from->reduced_mass, rim_product(z->impulse, &z->n, i));
}

/* The largest of the first coefficients, the size of a quantity within the step. */
static double size_of_series(const double *a, int first, int count)
{
    double size = 0.0;
    for (int i = first; i < count; ++i) {
        size = fmax(size, fabs(a[i]));
    }
    return size;
}

static double size_of_vectors(const struct taylor_vec3 *a, int first, int count)
{
    double size = 0.0;
    for (int i = first; i < count; ++i) {
        size = fmax(size, vec3_norm(a->at[i]));
    }
    return size;
}

/* So many of the last coefficients are looked at: from the touch on every fifth one is other than zero. */
enum { RIM_LAST = 5 };

/* Longest step [units]: terms that are left out may have vanished below the range of numbers. */
static const double LONGEST_RIM = 16.0;

/* Sizes that terms are compared with. */
struct rim_sizes {
    double speed, root;
};

static struct rim_sizes rim_sizes_of(const struct rim_series *p, int terms)
{
    return (struct rim_sizes){fmax(fabs(p->rate[0]), size_of_vectors(&p->r_rate, 1, terms)),
                              size_of_series(p->root, 0, 3)};
}

/* Coefficient i as a part of the whole. */
static double rim_part(const struct rim_series *p, const struct rim_recurrence *z,
                       const struct rim_sizes *whole, int i)
{
    double part = fmax(vec3_norm(z->n.at[i]), fabs(z->d[i]) / p->from->distance);
    part = whole->speed > 0.0 ? fmax(part, vec3_norm(p->r_rate.at[i]) / whole->speed) : part;
    return p->by_root && whole->root > 0.0 ? fmax(part, fabs(p->root[i]) / whole->root) : part;
}

/* Jorba and Zou: the step at which the last terms are a rounding of the whole. */
static double rim_reliable_step(const struct rim_series *p, const struct rim_recurrence *z)
{
    const struct rim_sizes whole = rim_sizes_of(p, TAYLOR_TERMS);
    double radius = (double)INFINITY;
    for (int i = TAYLOR_TERMS - RIM_LAST; i < TAYLOR_TERMS; ++i) {
        radius = fmin(radius, pow(rim_part(p, z, &whole, i), -1.0 / i));
    }
    return fmin(LONGEST_RIM, radius * pow(0.5 * DBL_EPSILON, 1.0 / TAYLOR_TERMS));
}

/* Numbers of terms for shorter steps. The part of the radius of convergence in which they suffice is the
 * power -53 / terms of two (rim_reliable_step), rounded down. They are tried up to the length [units] in
 * which they would for the sine; for a step that is longer, all are made. */
static const struct {
    int terms;
    double part, longest;
} short_series[] = {{12, 0.0468, 0.16}, {16, 0.1006, 0.5}, {20, 0.159, 1.02}, {23, 0.202, 1.55}};
enum { SHORT_SERIES = sizeof short_series / sizeof short_series[0] };

/* Whether the first terms suffice up to s, the last of them being as small as rim_reliable_step asks. */
static bool terms_suffice(const struct rim_series *p, const struct rim_recurrence *z, int terms, double part,
                          double s)
{
    const struct rim_sizes whole = rim_sizes_of(p, terms);
    double power = pow(s / part, terms - RIM_LAST);
    for (int i = terms - RIM_LAST; i < terms; ++i) {
        if (!(rim_part(p, z, &whole, i) * power <= 1.0)) {
            return false;
        }
        power *= s / part;
    }
    return true;
}

/* The series up to s of as few terms as suffice. Returns false where all are made. */
static bool make_short_series(struct rim_series *p, struct rim_recurrence *z, double s)
{
    int made = 0;
    for (int k = 0; k < SHORT_SERIES; ++k) {
        if (s > short_series[k].longest) {
            continue;
        }
        for (; made < short_series[k].terms; ++made) {
            rim_coefficient(p, z, made);
        }
        if (terms_suffice(p, z, made, short_series[k].part, s)) {
            p->terms = made;
            p->step = s;
            return true;
        }
    }
    for (; made < TAYLOR_TERMS; ++made) {
        rim_coefficient(p, z, made);
    }
    p->terms = TAYLOR_TERMS;
    return false;
}

void rim_series_make(struct rim_series *p, const struct contact_pair *from, bool by_root, double longest)
{
    struct rim_recurrence z = {.degree = rim_degree_of(&from->flight), .by_root = by_root};
    p->from = from;
    p->by_root = by_root;
    p->damps = (by_root ? from->chi : from->coefficients.c) > 0.0;
    p->unit = rim_unit_of(from, by_root);
    p->time[0] = 0.0;
    p->root[0] = sqrt(fmax(-from->gap, 0.0));
    p->r.at[0] = p->r_rate.at[0] = vec3_make(0.0, 0.0, 0.0);
    /* by u, how far s goes within a time is known only afterwards */
    if (!make_short_series(p, &z, by_root ? (double)INFINITY : longest / p->unit)) {
        p->step = rim_reliable_step(p, &z);
    }
}

/* What a series of the rim says at a place. */

double rim_series_time(const struct rim_series *p, double s)
{
    return p->by_root ? taylor_at(p->time, TAYLOR_TERMS, s) : p->unit * s;
}

struct rim_time_left {
    const struct rim_series *of;
    double time;
};

static void rim_time_left_at(const void *rim_time_left, double s, double *value, double *slope)
{
    const struct rim_time_left *left = rim_time_left;
    *value = rim_series_time(left->of, s) - left->time;
    *slope = left->of->unit * taylor_at(left->of->root, TAYLOR_TERMS, s);
}

double rim_series_place(const struct rim_series *p, double time, double end)
{
    if (!p->by_root) {
        return time / p->unit;
    }
    const struct rim_time_left left = {p, time};
    const struct root_bracket_end low = {0.0, -time, p->time[1]};
    struct root_bracket_end high = {.s = end};
    rim_time_left_at(&left, end, &high.value, &high.slope);
    return high.value > 0.0 ? root_between(rim_time_left_at, &left, low, high) : end;
}

/* Value and two derivatives of two series, side by side. */
static void rim_two_at(const double *a, const double *b, int terms, double s, double of_a[3], double of_b[3])
{
#if CONTACT_GNU_C
    double2 value = {0.0};
    double2 slope = {0.0};
    double2 bend = {0.0}; /* half of it */
    for (int i = terms - 1; i >= 0; --i) {
        const double2 next = {a[i], b[i]};
        bend = bend * s + slope;
        slope = slope * s + value;
        value = value * s + next;
    }
    for (int j = 0; j < 2; ++j) {
        double *out = j == 0 ? of_a : of_b;
        out[0] = value[j];
        out[1] = slope[j];
        out[2] = 2.0 * bend[j];
    }
#else
    for (int j = 0; j < 2; ++j) {
        double *out = j == 0 ? of_a : of_b;
        out[0] = out[1] = out[2] = 0.0;
        for (int i = terms - 1; i >= 0; --i) {
            out[2] = out[2] * s + 2.0 * out[1];
            out[1] = out[1] * s + out[0];
            out[0] = out[0] * s + (j == 0 ? a : b)[i];
        }
    }
#endif
}

void rim_series_sample(const void *rim_series, double s, struct pair_sample *sample)
{
    const struct rim_series *p = rim_series;
    double u[3];
    rim_two_at(p->rate, p->force, p->terms, s, sample->of[PAIR_GAP_RATE], sample->of[PAIR_FORCE]);
    rim_two_at(p->radial, p->axial, p->terms, s, sample->of[PAIR_RADIAL], sample->of[PAIR_AXIAL]);
    rim_two_at(p->gap, p->by_root ? p->root : p->gap, p->terms, s, sample->of[PAIR_GAP], u);
    if (p->by_root) {
        sample->of[PAIR_GAP][0] = -u[0] * u[0];
        sample->of[PAIR_GAP][1] = -2.0 * u[0] * u[1];
        sample->of[PAIR_GAP][2] = -2.0 * (u[1] * u[1] + u[0] * u[2]);
    }
}

/* Adds those of along(s) t^k, `power` being t^k: where t = unit s, only coefficient k of it. */
static void add_along_time(const struct rim_series *p, const double *along, const double *power, int k,
                           double *sum)
{
    if (p->by_root && k > 0) {
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            sum[i] += taylor_multiply(along, power, i);
        }
        return;
    }
    for (int i = k; i < p->terms; ++i) {
        sum[i] += along[i - k] * power[k];
    }
}

/* From t^k to t^(k + 1). */
static void next_power_of_time(const struct rim_series *p, double *power, int k)
{
    double next[TAYLOR_TERMS];
    if (!p->by_root) {
        power[k + 1] = power[k] * p->time[1];
        return;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        next[i] = taylor_multiply(power, p->time, i);
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        power[i] = next[i];
    }
}

/* The integral of pair_work over [0, s]: of path(t).r_s ds, order 1, or of path(t).r'_s ds, order 2. */
static double rim_work(const struct rim_series *p, const struct pair_work *work, double s)
{
    const struct taylor_vec3 *of = work->order == 1 ? &p->r : &p->r_rate;
    double sum[TAYLOR_TERMS] = {0.0};
    double power[TAYLOR_TERMS] = {1.0};
    if (work->order == 0) {
        return 0.0;
    }
    int terms = 3; /* of the path that count: one where forces are steady */
    while (terms > 0 && vec3_is_zero(work->path[terms - 1])) {
        --terms;
    }
    for (int k = 0; k < terms; ++k) {
        double along[TAYLOR_TERMS] = {0.0}; /* of path[k] and the slope */
        for (int i = 0; i + 1 < p->terms; ++i) {
            along[i] = vec3_dot(work->path[k], vec3_scale(i + 1, of->at[i + 1]));
        }
        add_along_time(p, along, power, k, sum);
        if (k + 1 < terms) {
            next_power_of_time(p, power, k);
        }
    }
    return taylor_integral(sum, p->terms - 1, s);
}

struct pair_change rim_series_change(const void *rim_series, double s)
{
    const struct rim_series *p = rim_series;
    const double u = p->by_root ? taylor_at(p->root, p->terms, s) : 0.0;
    return (struct pair_change){
        .time = rim_series_time(p, s),
        .r = taylor_at_vec3(&p->r, p->terms, s),
        .r_rate = taylor_at_vec3(&p->r_rate, p->terms, s),
        .gap = p->by_root ? -u * u : taylor_at(p->gap, p->terms, s),
        .dissipated = p->damps ? p->unit * taylor_integral(p->lost, p->terms, s) : 0.0,
        .work = {rim_work(p, &p->from->work[0], s), rim_work(p, &p->from->work[1], s)}};
}

#if SCENE_ANY_CAPS

/* A step is a fifth of the radius of convergence at most (TAYLOR_ORDER); within a quarter of it no quantity
 * of the contact has two extrema. */
enum { PLACES_AT_RIM = 5 };

bool rim_applies(const struct segment *p)
{
    return contact_is_rim(&p->pair.shape);
}

#if SCENE_ANY_HERTZ
/* Whether the series goes by u; at rest at the touch it cannot, for a while (p->longest). */
static bool goes_by_root(struct segment *p)
{
    if (!contact_is_hertz(&p->pair.law)) {
        return false;
    }
    const double coasting = hertz_coasting_time(p);
    p->longest = coasting > 0.0 ? coasting : p->longest;
    return !(coasting > 0.0);
}

/* Whether it is for the slow kind to make. */
static bool is_slow_at_rim(struct segment *p)
{
    const struct rim_series *made = &p->as.rim;
    p->may_be_slow = p->may_be_slow && made->by_root && hertz_is_slow(p, made->root, made->unit);
    return p->may_be_slow;
}

static double parting_at_rim(const struct rim_series *made)
{
    return made->by_root ? pair_hertz_parting(made->root, made->step) : (double)INFINITY;
}

static void note_parting(struct segment *p, double parting)
{
    if (p->as.rim.by_root) {
        hertz_find_terminal_event(p, parting <= p->end ? parting : (double)INFINITY);
    }
}
#else
static bool goes_by_root(struct segment *p)
{
    (void)p;
    return false;
}

static bool is_slow_at_rim(struct segment *p)
{
    (void)p;
    return false;
}

static double parting_at_rim(const struct rim_series *made)
{
    (void)made;
    return (double)INFINITY;
}

static void note_parting(struct segment *p, double parting)
{
    (void)p, (void)parting;
}
#endif

bool rim_make(struct segment *p)
{
    struct rim_series *made = &p->as.rim;
    const bool by_root = goes_by_root(p); /* may shorten p->longest */
    rim_series_make(made, &p->pair, by_root, p->longest);
    if (is_slow_at_rim(p)) {
        return false;
    }
    p->unit = made->unit;
    const double parting = parting_at_rim(made);
    p->end = fmin(made->step, parting > 0.0 ? parting : made->step);
    if (parting > 0.0 && rim_series_time(made, p->end) > p->longest) {
        p->end = rim_series_place(made, p->longest, p->end);
    }
    for (int i = 0; i < PLACES_AT_RIM; ++i) {
        dense_output_add(&p->output, p->end * i / (PLACES_AT_RIM - 1));
    }
    note_parting(p, parting);
    return true;
}

#endif
