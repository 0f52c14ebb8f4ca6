#include "touch/expansion.h"

#include <math.h>
#include <string.h>

#include "contact/shape.h"
#include "math/compiler.h"
#include "math/nodes.h"

/* These properties of the series are constants of its code. One contact then costs a fifth less, and contacts
 * along one axis under Hertz's law a tenth. */
struct expansion_kind {
    int axes;
    bool is_paced, is_alone; /* alone: one contact in the frame of a pair, which pushes body 1 only */
};

static inline int axis_of(struct expansion_kind kind, const struct expansion *s, int a)
{
    return kind.is_alone ? a : s->along[a];
}

static inline int expansion_rows(struct expansion_kind kind, const struct expansion *s)
{
    return kind.is_alone ? 1 : s->rows;
}

/* Whether the u of row n is the pace. */
static inline bool gives_pace(struct expansion_kind kind, const struct expansion *s, int n)
{
    return SCENE_ANY_HERTZ && kind.is_paced && (kind.is_alone || n == s->paced_by);
}

/* Returns coefficient i of the series times the pace. */
static inline double paced(struct expansion_kind kind, const struct expansion *s, const double *a, int i)
{
    return kind.is_paced ? taylor_product(a, &s->pace, i) : a[i];
}

/* Sets coefficient i of the powers of time. Without a pace time is s, and each power has one coefficient. */
static void put_time(struct expansion_kind kind, struct expansion *s, int i)
{
    for (int p = 2; p <= s->degree; ++p) {
        if (kind.is_paced || i == p) {
            taylor_put(&s->power_of_time[p], i,
                       taylor_product(s->power_of_time[1].row, &s->power_of_time[p - 1], i));
        }
    }
}

/* Returns coefficient i of a polynomial of time along an axis, less its value at the start. Most
 * are of degree two at most. */
static inline double flown_term(struct expansion_kind kind, const struct expansion *s, const double *of,
                                int degree, int k, int i)
{
    if (!kind.is_paced) {
        return i > 0 && i <= degree ? of[EXPANSION_AXES * i + k] * s->power_of_time[i].row[i] : 0.0;
    }
    double sum = of[EXPANSION_AXES + k] * s->power_of_time[1].row[i] +
                 of[2 * EXPANSION_AXES + k] * s->power_of_time[2].row[i];
    for (int p = 3; p <= degree; ++p) {
        sum += of[EXPANSION_AXES * p + k] * s->power_of_time[p].row[i];
    }
    return sum;
}

static inline double separation_term(struct expansion_kind kind, const struct expansion *s,
                                     const double *flown, const int end[2], int k, int i)
{
    return flown_term(kind, s, flown, s->degree, k, i) + s->body[kind.is_alone ? 1 : end[1]].moved[k][i] -
           (kind.is_alone ? 0.0 : s->body[end[0]].moved[k][i]);
}

/* Changes f from coefficient i of c to coefficient i of f at a rim: the nearest point of the circle moves,
 * unless the motion is in a plane through the axis. */
static void put_nearest(struct expansion_rim *rim, int axes, int i, double f[EXPANSION_AXES])
{
    f[1] += i == 0 ? rim->half_height : 0.0;
    rim->axial[i] = -f[1];
    if (axes == 2) {
        f[0] -= i == 0 ? rim->radius : 0.0;
        rim->radial[i] = f[0];
        return;
    }
    rim->across[0][i] = f[0];
    rim->across[1][i] = f[2];
    rim->rho_squared[i] = taylor_multiply(rim->across[0], rim->across[0], i) +
                          taylor_multiply(rim->across[1], rim->across[1], i);
    rim->rho[i] = 0.0;
    rim->rho[i] =
        i == 0 ? sqrt(rim->rho_squared[0]) : 0.5 * taylor_divide(rim->rho_squared, rim->rho, rim->rho, i);
    for (int j = 0; j < 2; ++j) {
        rim->a[j][i] = taylor_divide(rim->across[j], rim->rho, rim->a[j], i);
        f[2 * j] -= rim->radius * rim->a[j][i];
    }
    rim->radial[i] = rim->rho[i] - (i == 0 ? rim->radius : 0.0);
}

/* Sets f to its coefficient i: the vector along n, of length d. */
static void put_pointer(struct expansion_kind kind, const struct expansion *s, struct expansion_row *r, int i,
                        double f[EXPANSION_AXES])
{
    double along = 0.0;
    for (int a = 0; a < kind.axes; ++a) {
        const int k = axis_of(kind, s, a);
        f[k] = i == 0 ? r->flown[k] : separation_term(kind, s, r->flown, r->end, k, i);
        along += CONTACT_ANY_CYLINDER ? f[k] * r->axis[k] : 0.0;
    }
    for (int a = 0; CONTACT_ANY_CYLINDER && a < kind.axes && !kind.is_alone; ++a) {
        const int k = axis_of(kind, s, a);
        f[k] -= along * r->axis[k];
    }
    if (CONTACT_ANY_CIRCLE && r->rim != NULL) {
        put_nearest(r->rim, kind.axes, i, f);
    }
}

/* Sets coefficient i > 0 of n, and the part of the push (push_bodies) that follows from lower coefficients of
 * n and of the impulse. Returns coefficient i of n.w. One loop for all products costs less than one for each,
 * because they share factors. */
static inline double put_normal(struct expansion_kind kind, const struct expansion *s,
                                struct expansion_row *r, int i, const double f[EXPANSION_AXES])
{
    double2 n[EXPANSION_AXES][PARTS];
    double2 push[EXPANSION_AXES][PARTS];
    double2 speed[PARTS];
    memset(n, 0, sizeof n);
    memset(push, 0, sizeof push);
    memset(speed, 0, sizeof speed);
    r->d[i] = r->side * r->gap[i];
    for (int k = 1; k <= i; k += LANES) {
        const double2 d = double2_at(r->d, k);
        const double2 impulse = double2_at(r->impulse, k);
        for (int a = 0; a < kind.axes; ++a) {
            const int j = axis_of(kind, s, a);
            const double2 normal = double2_at(r->n[j].back + (TAYLOR_ORDER - i), k);
            n[a][part(k)] += d * normal;
            push[a][part(k)] += impulse * normal;
            speed[part(k)] += double2_at(r->rate_of_c[j], k) * normal;
        }
    }
    double sum = parts_together(speed);
    for (int a = 0; a < kind.axes; ++a) {
        const int k = axis_of(kind, s, a);
        const double normal = (f[k] - parts_together(n[a])) * r->by_distance;
        taylor_put(&r->n[k], i, normal);
        sum += r->rate_of_c[k][0] * normal;
        r->lower_push[k] = parts_together(push[a]) + r->impulse[0] * normal;
    }
    return sum;
}

/* Sets coefficient i of w, of n and of g'. */
static void put_motion(struct expansion_kind kind, const struct expansion *s, struct expansion_row *r, int i)
{
    double f[EXPANSION_AXES] = {0.0};
    double speed = 0.0;
    for (int a = 0; a < kind.axes; ++a) {
        const int k = axis_of(kind, s, a);
        const double rate = flown_term(kind, s, r->flown_rate, s->degree - 1, k, i) +
                            s->body[kind.is_alone ? 1 : r->end[1]].rate[k][i] -
                            (kind.is_alone ? 0.0 : s->body[r->end[0]].rate[k][i]);
        r->rate_of_c[k][i] = rate + (i == 0 ? r->flown_rate[k] : 0.0);
        speed += r->n[k].row[0] * rate;
    }
    if (kind.axes > 1 && (kind.is_alone || !r->is_straight)) {
        put_pointer(kind, s, r, i, f);
        speed = i > 0 ? put_normal(kind, s, r, i, f) : speed;
    }
    r->rate[i] = i > 0 ? r->side * speed : r->rate[0]; /* the start is known */
}

/* Returns coefficient i of dg/dt. */
static double opening(struct expansion_kind kind, const struct expansion *s, const struct expansion_row *r,
                      int i)
{
    double sum = r->rate[i];
    for (int p = 0; SCENE_ANY_PRESCRIBED && r->mismatch != NULL && p < s->degree; ++p) {
        for (int a = 0; a < kind.axes; ++a) {
            const int k = axis_of(kind, s, a);
            const double power =
                p == 0 ? r->n[k].row[i] : taylor_product(s->power_of_time[p].row, &r->n[k], i);
            sum += r->side * r->mismatch[EXPANSION_AXES * p + k] * power;
        }
    }
    return sum;
}

/* Sets coefficient i of the depth. The contact that sets the pace u has the gap -u^2. */
static void put_depth(struct expansion_kind kind, const struct expansion *s, struct expansion_row *r,
                      bool is_pace, int i)
{
    if (is_pace) {
        taylor_put(&r->depth, i, taylor_product(s->pace.row, &s->pace, i));
        r->gap[i] = i == 0 ? r->gap[0] : -r->depth.row[i];
    } else if (!kind.is_alone && r->is_hertz) {
        r->depth.row[i] = i == 0 ? fmax(-r->gap[0], 0.0) : -r->gap[i];
    }
}

/* Returns coefficient `order` > 0 of p = a^(3/2) from a p' = 3/2 a' p. In `back` stand coefficients order,
 * order - 1 ... of p; the first one is zero so far. */
static inline double power_term(const double *a, const double *back, int order)
{
    const double first[] = {-order, 2.5 - order};
    double2 weight = double2_at(first, 0);
    double2 sum[PARTS];
    memset(sum, 0, sizeof sum);
    for (int k = 0; k <= order; k += LANES) {
        sum[part(k)] += weight * double2_at(a, k) * double2_at(back, k);
        weight += LANES * 2.5;
    }
    return parts_together(sum) / (order * a[0]);
}

/* Sets coefficient i of p = delta^(3/2), and returns that of the force under Hertz's law. Both have the pace
 * as a factor where a contact is alone. Where one begins as the pace does, delta goes with s^2. */
static double put_power(struct expansion_kind kind, const struct expansion *s, struct expansion_row *r,
                        bool is_pace, int i)
{
    const bool begins = !(r->depth.row[0] > 0.0);
    const double *a = r->depth.row + (begins ? 2 : 0);
    const int order = begins ? i - 3 : i;
    double power = 0.0;
    if (is_pace) {
        power = taylor_product(r->depth.row, kind.is_alone ? &r->depth : &s->pace, i);
    } else if (order == 0) {
        power = a[0] * sqrt(a[0]);
    } else if (order > 0) {
        power = power_term(a, r->power.back + (TAYLOR_ORDER - i), order);
    }
    taylor_put(&r->power, i, power);
    return r->k * (power - (r->c > 0.0 ? r->c * taylor_product(r->rate, &r->power, i) : 0.0));
}

static inline void put_force(struct expansion_kind kind, const struct expansion *s, struct expansion_row *r,
                             bool is_pace, int i)
{
    const bool is_hertz = SCENE_ANY_HERTZ && (kind.is_alone ? kind.is_paced : r->is_hertz);
    r->force[i] = is_hertz ? put_power(kind, s, r, is_pace, i) : -r->k * r->gap[i] - r->c * r->rate[i];
    r->impulse[i] = kind.is_alone ? r->force[i] : paced(kind, s, r->force, i);
}

/* Sets coefficient i + 1 of what a contact integrates, and its part of the rates of its bodies. */
static inline void push_bodies(struct expansion_kind kind, struct expansion *s, struct expansion_row *r,
                               int i)
{
    struct expansion_body *source = &s->body[r->end[0]];
    struct expansion_body *destination = &s->body[kind.is_alone ? 1 : r->end[1]];
    const double unit = s->unit / (i + 1) * r->side;
    for (int a = 0; a < kind.axes; ++a) {
        const int k = axis_of(kind, s, a);
        const double pushed = unit * (r->impulse[i] * r->n[k].row[0] + r->lower_push[k]);
        r->pushed[k][i + 1] = pushed;
        destination->rate[k][i + 1] += pushed * destination->by_mass;
        if (!kind.is_alone) {
            source->rate[k][i + 1] -= pushed * source->by_mass;
        }
    }
}

/* Sets coefficient i + 1 of time, bodies and gaps. A gap whose normal does not turn follows from the places
 * of its bodies, where the pace makes its integral a product. */
static void put_integrals(struct expansion_kind kind, struct expansion *s, int i)
{
    const double unit = s->unit / (i + 1);
    taylor_put(&s->power_of_time[1], i + 1, unit * s->pace.row[i]);
    put_time(kind, s, i + 1);
    for (int n = 0; n < expansion_rows(kind, s); ++n) {
        push_bodies(kind, s, &s->row[n], i);
    }
    for (int b = 1; b < (kind.is_alone ? 2 : s->bodies); ++b) {
        for (int a = 0; a < kind.axes; ++a) {
            const int k = axis_of(kind, s, a);
            s->body[b].moved[k][i + 1] = unit * paced(kind, s, s->body[b].rate[k], i);
        }
    }
    for (int n = 0; n < expansion_rows(kind, s); ++n) {
        struct expansion_row *r = &s->row[n];
        if (gives_pace(kind, s, n)) {
            taylor_put(&s->pace, i + 1, -0.5 * unit * opening(kind, s, r, i));
        } else if (!kind.is_paced) {
            r->gap[i + 1] = unit * opening(kind, s, r, i);
        } else if (!r->is_straight) {
            r->gap[i + 1] = unit * paced(kind, s, r->rate, i);
        } else {
            double moved = 0.0;
            for (int a = 0; a < kind.axes; ++a) {
                const int k = axis_of(kind, s, a);
                moved += r->n[k].row[0] * separation_term(kind, s, r->flown, r->end, k, i + 1);
            }
            r->gap[i + 1] = r->side * moved;
        }
    }
}

static inline void make_orders(struct expansion_kind kind, struct expansion *s, int begin, int end)
{
    for (int i = begin; i < end; ++i) {
        for (int n = 0; n < expansion_rows(kind, s); ++n) {
            struct expansion_row *r = &s->row[n];
            put_depth(kind, s, r, gives_pace(kind, s, n), i);
            put_motion(kind, s, r, i);
            put_force(kind, s, r, gives_pace(kind, s, n), i);
        }
        if (i < TAYLOR_ORDER) {
            put_integrals(kind, s, i);
        }
    }
}

static inline void make_alone(struct expansion *s, int begin, int end, bool is_paced)
{
    if (s->axes == 1) {
        make_orders((struct expansion_kind){1, is_paced, true}, s, begin, end);
    } else if (s->axes == 2) {
        make_orders((struct expansion_kind){2, is_paced, true}, s, begin, end);
    } else {
        make_orders((struct expansion_kind){EXPANSION_AXES, is_paced, true}, s, begin, end);
    }
}

CONTACT_FLATTEN void expansion_make(struct expansion *s, int begin, int end)
{
    if (!s->is_framed && s->axes == 1) {
        make_orders((struct expansion_kind){1, s->paced_by >= 0, false}, s, begin, end);
    } else if (!s->is_framed) {
        make_orders((struct expansion_kind){s->axes, s->paced_by >= 0, false}, s, begin, end);
    } else if (s->paced_by >= 0) {
        make_alone(s, begin, end, true);
    } else {
        make_alone(s, begin, end, false);
    }
}

void expansion_add_powers(struct expansion *s, int degree)
{
    if (degree > s->degree) {
        s->degree = degree;
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            put_time((struct expansion_kind){.is_paced = true}, s, i);
        }
    }
}

/* The first coefficients give the size of the whole, since s is of order one. In an impact from the touch the
 * push begins with the power 5 of s. */
enum { SCALE_TERMS = 8 };

/* Number of last coefficients that give the error: in a free impact from the touch only every fifth
 * coefficient of a series by u is not zero. */
enum { LAST_TERMS = 5 };

/* This is the longest step [units]. Without a force the series are finite sums, and if the unit is the time
 * of passage the last terms may underflow. */
static const double LONGEST_SERIES = 16.0;

double expansion_reliable(const struct expansion *s, double opened, double pushed, double accuracy)
{
    double pace = 0.0;
    double growth = -(double)INFINITY; /* minus the binary logarithm of the radius of convergence */
    for (int i = 0; i < SCALE_TERMS; ++i) {
        pace = larger(fabs(s->pace.row[i]), pace);
        for (int n = 0; n < s->rows; ++n) {
            opened = larger(fabs(s->row[n].gap[i]), opened);
            for (int k = 0; k < EXPANSION_AXES; ++k) {
                pushed = larger(fabs(s->row[n].pushed[k][i]), pushed);
            }
        }
    }
    for (int i = TAYLOR_TERMS - LAST_TERMS; i < TAYLOR_TERMS; ++i) {
        double part = larger(fabs(s->pace.row[i]) / pace, 0.0);
        for (int n = 0; n < s->rows; ++n) {
            const struct expansion_row *r = &s->row[n];
            part = n == s->paced_by ? part : larger(fabs(r->gap[i]) / opened, part);
            for (int k = 0; k < EXPANSION_AXES; ++k) {
                part = larger(fabs(r->n[k].row[i]), larger(fabs(r->pushed[k][i]) / pushed, part));
            }
        }
        growth = larger(log2(part) / i, growth);
    }
    return fmin(LONGEST_SERIES, exp2(log2(accuracy) / TAYLOR_TERMS - growth));
}

double expansion_time_at(const struct expansion *s, double place)
{
    return s->paced_by < 0 ? s->unit * place : taylor_at(s->power_of_time[1].row, TAYLOR_TERMS, place);
}

void expansion_time(const void *expansion, double place, double time[3])
{
    const struct expansion *s = expansion;
    time[0] = s->unit * place;
    time[1] = s->unit;
    if (s->paced_by >= 0) {
        taylor_derivatives(s->power_of_time[1].row, TAYLOR_TERMS, place, time);
    }
}

double expansion_node(int i, double place, double *weight)
{
    *weight = 0.5 * place * NODAL_RULE->integral[i * LOBATTO_MAX + LOBATTO_MAX - 1];
    return 0.5 * place * (1.0 + NODAL_RULE->node[i]);
}

double expansion_dissipated(const struct expansion *s, double place)
{
    double sum = 0.0;
    for (int n = 0; n < s->rows; ++n) {
        const struct expansion_row *r = &s->row[n];
        for (int i = 0; r->c > 0.0 && i < LOBATTO_MAX; ++i) {
            double weight;
            const double at = expansion_node(i, place, &weight);
            const double pace = s->paced_by < 0 ? 1.0 : taylor_at(s->pace.row, TAYLOR_TERMS, at);
            const double rate = taylor_at(r->rate, TAYLOR_TERMS, at);
            const double power = !r->is_hertz       ? 1.0
                                 : n == s->paced_by ? r->k * pace * pace * pace
                                                    : r->k * taylor_at(r->power.row, TAYLOR_TERMS, at);
            sum += weight * pace * r->c * power * rate * rate;
        }
    }
    return s->unit * sum;
}
