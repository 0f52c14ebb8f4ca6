#include "touch/island.h"

#include <float.h>
#include <string.h>

#include "flight/flight.h"
#include "math/compiler.h"
#include "math/nodes.h"
#include "math/polynomial.h"
#include "scene/evaluate.h"

#if SCENE_HAS_ISLANDS

static inline void put(struct two_way *to, int i, double value)
{
    to->row[i] = value;
    to->back[TAYLOR_ORDER - i] = value;
}

/* Returns coefficient i of the product of a series and another one. Coefficients that are not known yet are
 * zero. Four sums, of every fourth term each, need not wait for each other. */
static inline double product(const double *a, const struct two_way *b, int i)
{
    const double *back = b->back + (TAYLOR_ORDER - i);
    double2 sum[2 * PARTS];
    memset(sum, 0, sizeof sum);
    for (int k = 0; k <= i; k += 2 * PARTS * LANES) {
        for (int l = 0; l < 2 * PARTS; ++l) {
            sum[l] += double2_at(a, k + l * LANES) * double2_at(back, k + l * LANES);
        }
    }
    for (int l = 0; l < PARTS; ++l) {
        sum[l] += sum[l + PARTS];
    }
    return parts_together(sum);
}

/* Sets `of` to coefficients i of the products of the series a, b and c with another one. One loop for all
 * three products costs less than three loops. */
static inline void three_products(const double *a, const double *b, const double *c,
                                  const struct two_way *with, int i, double of[3])
{
    const double *back = with->back + (TAYLOR_ORDER - i);
    double2 first[PARTS];
    double2 second[PARTS];
    double2 third[PARTS];
    memset(first, 0, sizeof first);
    memset(second, 0, sizeof second);
    memset(third, 0, sizeof third);
    for (int k = 0; k <= i; k += LANES) {
        const double2 factor = double2_at(back, k);
        first[part(k)] += double2_at(a, k) * factor;
        second[part(k)] += double2_at(b, k) * factor;
        third[part(k)] += double2_at(c, k) * factor;
    }
    of[0] = parts_together(first);
    of[1] = parts_together(second);
    of[2] = parts_together(third);
}

/* Returns coefficient i of the series times the pace. */
static inline double paced(const struct island *s, const double *a, int i)
{
    return s->paced_by < 0 ? a[i] : product(a, &s->pace, i);
}

bool island_may_be(const struct scene_values *v, const struct scene_state *q)
{
    int touching = 0;
    for (int j = 0; j < SCENE_CONTACTS && !scene_turns(v); ++j) {
        touching += contact_pushes(v, q, j) ? 1 : 0;
    }
    return touching > 0 && touching <= ISLAND_MOST;
}

/* The error of a series, divided by the whole: a few roundings. A larger error would save few steps, and weak
 * forces that grow within a step would be lost. */
static const double ACCURACY = 1e-15;

/* Whether the series know the shape: a sphere, a plane, or a cylinder whose ends are not met. */
static bool knows_shape(const struct scene_values *v, const struct contact_shape *shape, int contact)
{
    return !contact_is_zoned(shape) && !contact_is_circle(shape) && !scene_ends_suddenly(v, contact) &&
           !body_is_compound(contact_source(contact)) && !body_is_compound(contact_destination(contact));
}

/* A dashpot faster than the spring by this factor makes decays that are much faster than the motion. */
static const double MOST_DAMPED = 4.0;

/* Sets the rates of a contact in touch at the start, and the depth that it will reach. An impact without
 * damping under Hertz's law reaches delta^(5/2) = 5/4 v^2 m / k. */
static void put_timescales(struct island_row *r, double by_mass)
{
    const double k = r->k * by_mass;
    const double rate = r->rate[0];
    r->deepest = fmax(-r->gap[0], 0.0);
    if (!r->is_hertz) {
        r->spring = sqrt(k);
        r->dashpot = r->c * by_mass;
        return;
    }
    r->deepest = fmax(r->deepest, pow(1.25 * rate * rate / k, 0.4));
    r->spring = sqrt(1.5 * k * sqrt(r->deepest));
    r->dashpot = k * r->c * r->deepest * sqrt(r->deepest);
}

static int add_body(struct island *s, const struct scene_values *v, int body)
{
    if (s->index[body] == 0 && body_is_free(v, body)) {
        s->index[body] = s->bodies;
        memset(&s->body[s->bodies], 0, sizeof s->body[0]);
        s->body[s->bodies].body = body;
        s->body[s->bodies].by_mass = body_inverse_mass(v, body);
        s->bodies += 1;
    }
    return s->index[body];
}

static void put_law(struct island_row *r, const struct scene_values *v, const struct scene_state *q,
                    const struct scene_instant *at, double tolerated)
{
    const struct contact_law law = scene_contact_law(v, q, r->contact);
    const struct contact_geometry *g = &at->geometry[r->contact];
    const enum contact_regime regime = (enum contact_regime)q->contact[r->contact].regime;
    r->is_hertz = contact_is_hertz(&law);
    const struct contact_coefficients of =
        r->is_hertz ? contact_factors_of(&law) : contact_coefficients_of(&law, regime);
    r->k = of.k;
    r->c = r->is_hertz && regime == REGIME_RESTITUTION ? 0.0 : of.c;
    r->by_gap = r->by_rate = r->margin = 0.0;
    if (contact_has_events(&law)) {
        const struct contact_slopes slopes = contact_event_slopes(&law, regime, g->gap, g->gap_rate);
        r->by_gap = slopes.by_gap;
        r->by_rate = slopes.by_rate;
        r->margin = contact_event(&law, regime, g->gap, g->gap_rate) +
                    rounding_margin_offset(v, q, at, r->contact, tolerated);
    }
}

static bool add_touching(struct island *s, const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at, int contact)
{
    struct island_row *r = &s->row[s->rows];
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_shape shape = scene_contact_shape(v, q, contact);
    const int bodies[2] = {contact_source(contact), contact_destination(contact)};
    if (g->degenerate || !knows_shape(v, &shape, contact) || !flight_is_steady(v, q, bodies[0]) ||
        !flight_is_steady(v, q, bodies[1])) {
        return false;
    }
    memset(r, 0, sizeof *r);
    r->contact = contact;
    r->side = shape.side;
    r->is_straight = contact_is_plane(&shape);
    vec3_to(contact_is_cylinder(&shape) ? shape.axis : vec3_make(0.0, 0.0, 0.0), r->axis);
    const struct separation_path flight = separation_path_of(v, q, at, q->clock, contact);
    const int degree = path_degree(flight.c, SEPARATION_DEGREE + 1);
    s->degree = degree > s->degree ? degree : s->degree;
    memcpy(r->flown, flight.c, sizeof r->flown);
    memcpy(r->flown_rate, flight.w, sizeof flight.w);
    put_law(r, v, q, at, ACCURACY * vec3_norm(at->rate[contact]));
    r->gap[0] = g->gap;
    r->by_distance = 1.0 / g->distance;
    r->passage = r->is_straight ? 0.0 : vec3_norm(at->rate[contact]) * r->by_distance;
    r->rate[0] = g->gap_rate;
    put_timescales(r, scene_inverse_mass(v, contact));
    for (int k = 0; k < ISLAND_AXES; ++k) {
        put(&r->n[k], 0, vec3_get(g->normal, k));
    }
    r->offset = fmax(g->gap, 0.0) + rounding_of_gap(v, at, contact);
    for (int end = 0; end < 2; ++end) {
        r->end[end] = add_body(s, v, bodies[end]);
    }
    s->rows += 1;
    return true;
}

/* Returns the part of a vector across the axis of a cylinder; the vector itself for other shapes. */
static struct vec3 part_across(const struct island_row *r, struct vec3 a)
{
    return vec3_axpy(a, -vec3_dot(a, vec3_from(r->axis)), vec3_from(r->axis));
}

/* Whether a contact may exert a torque about its destination's centre. */
static bool has_lever(const struct island_row *r)
{
    return SCENE_HAS_TORQUES && body_has_axis(contact_destination(r->contact));
}

/* Finds the axes of the world along which contact forces act. Where there is one axis, no normal turns. */
static void find_axes(struct island *s)
{
    s->axes = 0;
    for (int k = 0; k < ISLAND_AXES; ++k) {
        bool lives = false;
        for (int i = 0; i < s->rows; ++i) {
            const struct island_row *r = &s->row[i];
            lives = lives || r->n[k].row[0] != 0.0;
            for (int p = 1; p <= SEPARATION_DEGREE; ++p) {
                const double flown = vec3_get(part_across(r, vec3_from(r->flown + ISLAND_AXES * p)), k);
                lives = lives || (!r->is_straight && flown != 0.0);
            }
        }
        if (lives) {
            s->axis[s->axes++] = k;
        }
    }
    for (int i = 0; i < s->rows; ++i) {
        s->row[i].is_straight = s->row[i].is_straight || s->axes == 1;
    }
}

/* Sets g'' of the contacts in touch at the start. */
static void find_bends(struct island *s, const struct scene_values *v, const struct scene_state *q,
                       const struct scene_instant *at)
{
    struct scene_instant now = *at;
    scene_forces(v, q, q->clock, &now);
    for (int i = 0; i < s->rows; ++i) {
        struct island_row *r = &s->row[i];
        const struct contact_geometry *g = &at->geometry[r->contact];
        const struct contact_shape shape = scene_contact_shape(v, q, r->contact);
        const struct vec3 w = at->rate[r->contact];
        const struct vec3 a = vec3_sub(now.acceleration[contact_destination(r->contact)],
                                       now.acceleration[contact_source(r->contact)]);
        const double turning = r->is_straight ? 0.0 : contact_turning_rate(&shape, g, w, w) * r->by_distance;
        r->bend = r->side * (vec3_dot(g->normal, a) + turning);
    }
}

/* Returns how far the nearest zero of the depth is in time, which may be complex [s], by delta, delta' and
 * delta''. */
static double time_from_zero(const struct island_row *r)
{
    const double depth = fmax(-r->gap[0], 0.0);
    const double rate = r->rate[0];
    const double square = rate * rate + 2.0 * depth * r->bend;
    return square >= 0.0 ? 2.0 * depth / (fabs(rate) + sqrt(square)) : sqrt(2.0 * depth / -r->bend);
}

/* The depth is nearly linear in time between its zero and the start, and u analytic, if delta delta'' is at
 * most this part of delta'^2. It is 0.7 of a contact that another one has pushed from rest at the touch. */
static const double NEARLY_LINEAR = 0.4;

/* Chooses the row whose u is the pace, and the unit of s. Returns false where a dashpot is too fast, or where
 * a contact under Hertz's law starts at the touch at rest: time does not go on with s there. */
static bool choose_pace(struct island *s)
{
    double fastest = 0.0;
    double least = (double)INFINITY;
    double root = 1.0;
    s->paced_by = -1;
    for (int i = 0; i < s->rows; ++i) {
        const struct island_row *r = &s->row[i];
        const double depth = fmax(-r->gap[0], 0.0);
        const double rate = r->rate[0];
        if (r->dashpot > MOST_DAMPED * r->spring || (r->is_hertz && depth == 0.0 && rate == 0.0)) {
            return false;
        }
        fastest = fmax(fmax(fastest, r->passage), fmax(r->spring, r->dashpot));
        const bool may_pace =
            SCENE_ANY_HERTZ && r->is_hertz && -r->bend * depth <= NEARLY_LINEAR * rate * rate;
        if (may_pace && time_from_zero(r) < least) {
            least = time_from_zero(r);
            s->paced_by = i;
            root = sqrt(r->deepest);
        }
    }
    s->unit = 1.0 / (fastest * root);
    return isfinite(s->unit) && s->unit > 0.0;
}

/* Sets coefficient i of the powers of time. */
static void put_time(struct island *s, int i)
{
    for (int p = 2; p <= s->degree; ++p) {
        put(&s->power_of_time[p], i,
            s->paced_by < 0 ? (i == p ? s->power_of_time[p - 1].row[p - 1] * s->unit : 0.0)
                            : product(s->power_of_time[1].row, &s->power_of_time[p - 1], i));
    }
}

/* Returns coefficient i of a polynomial of time along an axis of the world, less its value at the start. Most
 * are of degree two at most. */
static inline double flown_term(const struct island *s, const double *of, int degree, int k, int i)
{
    double sum = of[ISLAND_AXES + k] * s->power_of_time[1].row[i] +
                 of[2 * ISLAND_AXES + k] * s->power_of_time[2].row[i];
    for (int p = 3; p <= degree; ++p) {
        sum += of[ISLAND_AXES * p + k] * s->power_of_time[p].row[i];
    }
    return sum;
}

/* Returns coefficient i of a separation along an axis, i > 0. */
static inline double separation_term(const struct island *s, const double *flown, const int end[2], int k,
                                     int i)
{
    return flown_term(s, flown, s->degree, k, i) + s->body[end[1]].moved[k][i] - s->body[end[0]].moved[k][i];
}

/* Sets coefficient i of the separation and its rate, of n and of g'. Notes the part of the push that lower
 * coefficients make. */
static void put_motion(const struct island *s, struct island_row *r, int i)
{
    double c[ISLAND_AXES];
    double speed = 0.0;
    for (int a = 0; a < s->axes; ++a) {
        const int k = s->axis[a];
        const double rate = flown_term(s, r->flown_rate, s->degree - 1, k, i) +
                            s->body[r->end[1]].rate[k][i] - s->body[r->end[0]].rate[k][i];
        r->rate_of_c[k][i] = rate + (i == 0 ? r->flown_rate[k] : 0.0);
        speed += r->n[k].row[0] * rate;
    }
    if (i > 0 && !r->is_straight) {
        double along = 0.0;
        for (int a = 0; a < s->axes; ++a) {
            const int k = s->axis[a];
            c[k] = separation_term(s, r->flown, r->end, k, i);
            along += c[k] * r->axis[k];
        }
        r->d[i] = r->side * r->gap[i];
        speed = 0.0;
        for (int a = 0; a < s->axes; ++a) {
            const int k = s->axis[a];
            double lower[3]; /* the products' parts by lower coefficients of n */
            three_products(r->d, r->rate_of_c[k], r->impulse, &r->n[k], i, lower);
            const double n = (c[k] - along * r->axis[k] - lower[0]) * r->by_distance;
            put(&r->n[k], i, n);
            speed += lower[1] + r->rate_of_c[k][0] * n;
            r->lower_push[k] = lower[2] + r->impulse[0] * n;
        }
    }
    r->rate[i] = i > 0 ? r->side * speed : r->rate[0]; /* the start is known */
}

/* Sets coefficient i of the depth. The pace's own gap is -u^2. */
static void put_depth(const struct island *s, struct island_row *r, bool is_pace, int i)
{
    if (is_pace) {
        r->depth[i] = product(s->pace.row, &s->pace, i);
        r->gap[i] = i == 0 ? r->gap[0] : -r->depth[i];
    } else if (r->is_hertz) {
        r->depth[i] = i == 0 ? fmax(-r->gap[0], 0.0) : -r->gap[i];
    }
}

/* Sets coefficient i of p = delta^(3/2) and of the dashpot's part of the force under Hertz's law. A contact
 * in touch has delta p' = 3/2 delta' p; where one begins as the pace does, delta goes with s^2. */
static void put_power(const struct island *s, struct island_row *r, bool is_pace, int i)
{
    double lower[3] = {0.0}; /* the products' parts by lower coefficients of p */
    double power = i == 0 ? r->depth[0] * sqrt(r->depth[0]) : 0.0;
    const bool follows = !is_pace && r->depth[0] > 0.0 && i > 0;
    r->slope[i] = i * r->depth[i];
    if (follows && r->c > 0.0) {
        three_products(r->slope, r->depth, r->rate, &r->power, i, lower);
    } else if (follows) {
        lower[0] = product(r->slope, &r->power, i);
        lower[1] = product(r->depth, &r->power, i);
    }
    if (follows) {
        power = (2.5 * lower[0] - i * lower[1]) / (i * r->depth[0]);
    } else if (is_pace) {
        power = product(r->depth, &s->pace, i);
    } else if (i >= 3) {
        power = taylor_power(r->depth + 2, 1.5, r->power.row + 3, i - 3);
    }
    put(&r->power, i, power);
    if (r->c > 0.0) {
        const double dragged = follows ? lower[2] + r->rate[0] * power : product(r->rate, &r->power, i);
        r->drag[i] = r->k * r->c * dragged;
    }
}

static void put_force(const struct island *s, struct island_row *r, bool is_pace, int i)
{
    if (SCENE_ANY_HERTZ && r->is_hertz) {
        put_power(s, r, is_pace, i);
        r->force[i] = r->k * r->power.row[i] - r->drag[i];
    } else {
        r->drag[i] = r->c * r->rate[i];
        r->force[i] = -r->k * r->gap[i] - r->drag[i];
    }
    r->impulse[i] = paced(s, r->force, i);
}

/* Sets coefficient i + 1 of what a contact integrates, and its part of the rates of its bodies. */
static void push_bodies(struct island *s, struct island_row *r, int i)
{
    struct island_body *source = &s->body[r->end[0]];
    struct island_body *destination = &s->body[r->end[1]];
    const double unit = s->unit / (i + 1) * r->side;
    for (int a = 0; a < s->axes; ++a) {
        const int k = s->axis[a];
        const double pushed = unit * (r->impulse[i] * r->n[k].row[0] + r->lower_push[k]);
        r->pushed[k][i + 1] = pushed;
        source->rate[k][i + 1] -= pushed * source->by_mass;
        destination->rate[k][i + 1] += pushed * destination->by_mass;
    }
}

/* Sets coefficient i + 1 of time, bodies and gaps. A gap whose normal does not turn follows from the places
 * of its bodies, where the pace makes its integral a product. */
static void put_integrals(struct island *s, int i)
{
    const double unit = s->unit / (i + 1);
    put(&s->power_of_time[1], i + 1, unit * s->pace.row[i]);
    put_time(s, i + 1);
    for (int n = 0; n < s->rows; ++n) {
        push_bodies(s, &s->row[n], i);
    }
    for (int b = 1; b < s->bodies; ++b) {
        for (int a = 0; a < s->axes; ++a) {
            s->body[b].moved[s->axis[a]][i + 1] = unit * paced(s, s->body[b].rate[s->axis[a]], i);
        }
    }
    for (int n = 0; n < s->rows; ++n) {
        struct island_row *r = &s->row[n];
        if (n == s->paced_by) {
            put(&s->pace, i + 1, -0.5 * unit * r->rate[i]);
        } else if (s->paced_by < 0 || !r->is_straight) {
            r->gap[i + 1] = unit * paced(s, r->rate, i);
        } else {
            double moved = 0.0;
            for (int a = 0; a < s->axes; ++a) {
                const int k = s->axis[a];
                moved += r->n[k].row[0] * separation_term(s, r->flown, r->end, k, i + 1);
            }
            r->gap[i + 1] = r->side * moved;
        }
    }
}

static void make_terms(struct island *s)
{
    for (int i = 0; i < TAYLOR_ORDER; ++i) {
        for (int n = 0; n < s->rows; ++n) {
            struct island_row *r = &s->row[n];
            put_depth(s, r, n == s->paced_by, i);
            put_motion(s, r, i);
            put_force(s, r, n == s->paced_by, i);
        }
        put_integrals(s, i);
    }
}

/* An oscillation smaller than this part of the largest depth is left to the general segment. A step of that
 * segment is longer than a series, and few iterations follow a small oscillation. By this rule the bearing of
 * the report takes 92 million instructions at a tolerance of 1e-9; without the rule it takes 132 million. */
static const double SMALL_OSCILLATION = 2e-3;

/* Whether no contact oscillates by more than `quiet` [m] or SMALL_OSCILLATION. The amplitude is that which
 * the spring, or the dashpot where it is faster, gives to the present g' and g''. */
static bool is_quiet(const struct island *s, double quiet)
{
    double amplitude = 0.0;
    double deepest = 0.0;
    for (int i = 0; i < s->rows; ++i) {
        const struct island_row *r = &s->row[i];
        const double fast = fmax(r->spring, r->dashpot);
        amplitude = fmax(amplitude, fabs(r->bend) / (fast * fast) + fabs(r->rate[0]) / fast);
        deepest = fmax(deepest, -r->gap[0]);
    }
    return amplitude <= fmax(quiet, SMALL_OSCILLATION * deepest);
}

/* The first coefficients give the size of the whole, since s is of order one. In an impact from the touch the
 * push begins with the power 5 of s. */
enum { SCALE_TERMS = 8 };

/* Returns the s at which the first omitted terms, divided by the whole, are ACCURACY (Jorba and Zou). */
static double reliable_end(const struct island *s)
{
    double opened = 0.0;
    double pushed = 0.0;
    double pace = 0.0;
    double growth = -(double)INFINITY; /* minus the binary logarithm of the radius of convergence */
    for (int n = 0; n < s->rows; ++n) {
        for (int i = 0; i < SCALE_TERMS; ++i) {
            pace = larger(fabs(s->pace.row[i]), pace);
            opened = larger(fabs(s->row[n].gap[i]), opened);
            for (int k = 0; k < ISLAND_AXES; ++k) {
                pushed = larger(fabs(s->row[n].pushed[k][i]), pushed);
            }
        }
    }
    for (int i = TAYLOR_ORDER - 3; i < TAYLOR_TERMS; ++i) {
        double part = fabs(s->pace.row[i]) / pace;
        for (int n = 0; n < s->rows; ++n) {
            part = larger(fabs(s->row[n].gap[i]) / opened, part);
            for (int k = 0; k < ISLAND_AXES; ++k) {
                part = larger(fabs(s->row[n].pushed[k][i]) / pushed, part);
            }
        }
        growth = larger(log2(part) / i, growth);
    }
    return exp2(log2(ACCURACY) / TAYLOR_TERMS - growth);
}

/* The series of delta^(3/2) differs from the power of that of delta by at most this part of the largest
 * force. Beyond the radius of convergence the difference is of the size of the force itself. */
static const double AGREEMENT = 1e-13;

/* Whether the series of the forces converge at a place, by the law. The last coefficients do not tell, where
 * they become small before they grow. */
static bool agrees(const struct island *s, double place)
{
    double largest = 0.0;
    double worst = 0.0;
    for (int n = 0; n < s->rows; ++n) {
        const struct island_row *r = &s->row[n];
        largest = fmax(largest, fmax(fabs(r->force[0]), fabs(taylor_at(r->force, TAYLOR_TERMS, place))));
        if (SCENE_ANY_HERTZ && r->is_hertz && n != s->paced_by) {
            const double depth = fmax(taylor_at(r->depth, TAYLOR_TERMS, place), 0.0);
            const double power = taylor_at(r->power.row, TAYLOR_TERMS, place);
            worst = fmax(worst, r->k * fabs(power - depth * sqrt(depth)));
        }
    }
    return worst <= AGREEMENT * largest;
}

/* A series that does not converge at its end is shortened by this factor. */
static const double SHORTENING = 0.9;
enum { MOST_SHORTENINGS = 80 };

/* Ends the series at s where a contact changes its regime there and before the present end. */
static void note_change(struct island *s, double at, int contact, enum contact_regime next)
{
    if (at < s->end) {
        s->end = at;
        s->terminal = contact;
        s->next = next;
    }
}

/* Finds where the contacts in touch end or change their regimes. */
static void find_changes(struct island *s, const struct scene_values *v, const struct scene_state *q)
{
    double of[TAYLOR_TERMS];
    for (int n = 0; n < s->rows; ++n) {
        const struct island_row *r = &s->row[n];
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            of[i] = n == s->paced_by ? s->pace.row[i] : (i == 0 ? r->offset : 0.0) - r->gap[i];
        }
        const bool parts_now = n == s->paced_by && of[0] == 0.0 && r->rate[0] > 0.0;
        note_change(s, parts_now ? 0.0 : taylor_first_fall(of, TAYLOR_TERMS, s->end), r->contact,
                    REGIME_APART);
        if (r->margin > 0.0) {
            const struct contact_law law = scene_contact_law(v, q, r->contact);
            for (int i = 0; i < TAYLOR_TERMS; ++i) {
                of[i] = i == 0 ? r->margin : r->by_gap * r->gap[i] + r->by_rate * r->rate[i];
            }
            note_change(s, taylor_first_fall(of, TAYLOR_TERMS, s->end), r->contact,
                        contact_regime_after(&law, (enum contact_regime)q->contact[r->contact].regime));
        }
    }
}

static inline double island_time_at(const struct island *s, double place)
{
    return taylor_at(s->power_of_time[1].row, TAYLOR_TERMS, place);
}

/* Adds the powers of time up to a degree. */
static void add_powers(struct island *s, int degree)
{
    for (int p = s->degree + 1; p <= degree; ++p) {
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            put(&s->power_of_time[p], i, product(s->power_of_time[1].row, &s->power_of_time[p - 1], i));
        }
        s->degree = p;
    }
}

/* Returns a bound of how far the contacts take a body off its flight within the series. */
static double farthest(const struct island *s, const struct island_body *body)
{
    double sum = 0.0;
    for (int a = 0; a < s->axes; ++a) {
        double length = 0.0;
        for (int i = TAYLOR_ORDER; i > 0; --i) {
            length = s->end * (length + fabs(body->moved[s->axis[a]][i]));
        }
        sum += length;
    }
    return sum;
}

/* Returns a bound of the change of a separation within the series. */
static double separation_within(const struct island *s, const struct separation_path *flight,
                                const int end[2])
{
    const double time = island_time_at(s, s->end);
    return time * path_size(flight->c + 1, SEPARATION_DEGREE, time) + farthest(s, &s->body[end[0]]) +
           farthest(s, &s->body[end[1]]);
}

/* Returns where bodies that are apart touch within the series. The path along the normal at the start gives
 * the gap of a plane, and a lower bound of it outside other shapes. Their series whose root is sought is
 * side (d^2 - reach^2) = g (2 reach + side g). */
static double touch_within(const struct island *s, const struct contact_shape *shape,
                           const struct separation_path *flight, const struct contact_geometry *g,
                           double offset, const int end[2])
{
    double of[TAYLOR_TERMS] = {g->gap + offset};
    double flown[ISLAND_FLOWN];
    struct two_way path[ISLAND_AXES] = {{{0.0}, {0.0}}};
    bool moves[ISLAND_AXES] = {false};
    const bool is_flat = contact_is_plane(shape);
    const struct vec3 axis = contact_is_cylinder(shape) ? shape->axis : vec3_make(0.0, 0.0, 0.0);
    const struct vec3 start = vec3_axpy(flight->c[0], -vec3_dot(flight->c[0], axis), axis);
    memcpy(flown, flight->c, sizeof flown);
    for (int i = 1; i < TAYLOR_TERMS; ++i) {
        double c[ISLAND_AXES];
        for (int k = 0; k < ISLAND_AXES; ++k) {
            c[k] = separation_term(s, flown, end, k, i);
        }
        const struct vec3 across = vec3_axpy(vec3_from(c), -vec3_dot(vec3_from(c), axis), axis);
        of[i] = shape->side * vec3_dot(g->normal, across);
        for (int k = 0; k < ISLAND_AXES && !is_flat; ++k) {
            put(&path[k], i, vec3_get(across, k));
            moves[k] = moves[k] || path[k].row[i] != 0.0;
        }
    }
    const double linear = is_flat || shape->side > 0.0 ? taylor_first_fall(of, TAYLOR_TERMS, s->end) : 0.0;
    if (is_flat || linear == (double)INFINITY) {
        return linear;
    }
    of[0] *= 2.0 * contact_reach(shape) + shape->side * of[0];
    for (int i = 1; i < TAYLOR_TERMS; ++i) {
        of[i] = 0.0;
        for (int k = 0; k < ISLAND_AXES; ++k) {
            const double square = moves[k] ? product(path[k].row, &path[k], i) : 0.0;
            of[i] += shape->side * (2.0 * vec3_get(start, k) * path[k].row[i] + square);
        }
    }
    return taylor_first_fall(of, TAYLOR_TERMS, s->end);
}

/* The end is halved at most so often for a contact that might begin and whose shape is not known. */
enum { MOST_HALVINGS = 6 };

/* Finds where contacts that are apart begin. Returns false where one might that the series do not know. */
static bool find_touches(struct island *s, const struct scene_values *v, const struct scene_state *q,
                         const struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int end[2] = {s->index[contact_source(j)], s->index[contact_destination(j)]};
        if (contact_transmits(q, j) || !contact_is_coupled(v, q, j) || end[0] + end[1] == 0) {
            continue;
        }
        const struct contact_geometry *g = &at->geometry[j];
        const struct contact_shape shape = scene_contact_shape(v, q, j);
        const struct separation_path flight = separation_path_of(v, q, at, q->clock, j);
        const double offset = fmax(-g->gap, 0.0) + rounding_of_gap(v, at, j);
        const bool is_apart = q->contact[j].regime == (int32_t)REGIME_APART;
        bool may_touch = !(separation_within(s, &flight, end) < g->gap);
        if (is_apart && may_touch && knows_shape(v, &shape, j)) {
            add_powers(s, path_degree(flight.c, SEPARATION_DEGREE + 1));
            note_change(s, touch_within(s, &shape, &flight, g, offset, end), j, REGIME_COMPRESSION);
            continue;
        }
        for (int i = 0; may_touch && i < MOST_HALVINGS; ++i) {
            s->end *= 0.5;
            s->terminal = -1;
            may_touch = !(separation_within(s, &flight, end) < g->gap);
        }
        if (may_touch) {
            return false;
        }
    }
    return true;
}

/* Returns the s of a time since the start [s], at most s->end. */
static double place_of(const struct island *s, double time)
{
    double of[TAYLOR_TERMS];
    if (s->paced_by < 0) {
        return fmin(time / s->unit, s->end);
    }
    memcpy(of, s->power_of_time[1].row, sizeof of);
    of[0] = -time;
    return time < s->time ? root_in_bracket(taylor_root_function, of, 0.0, s->end) : s->end;
}

long island_work(const struct island *s)
{
    return 4 + 4L * s->rows;
}

bool island_make(struct island *s, const struct scene_values *v, const struct scene_state *q,
                 const struct scene_instant *at, double longest, double quiet)
{
    s->rows = 0;
    s->bodies = s->degree = 1;
    memset(s->index, 0, sizeof s->index);
    memset(&s->body[0], 0, sizeof s->body[0]);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_pushes(v, q, j) && !add_touching(s, v, q, at, j)) {
            return false;
        }
    }
    find_axes(s);
    find_bends(s, v, q, at);
    if (is_quiet(s, quiet) || !choose_pace(s)) {
        return false;
    }
    memset(&s->pace, 0, sizeof s->pace);
    memset(s->power_of_time, 0, sizeof s->power_of_time);
    put(&s->pace, 0, s->paced_by < 0 ? 1.0 : sqrt(fmax(-s->row[s->paced_by].gap[0], 0.0)));
    make_terms(s);
    s->end = reliable_end(s);
    s->terminal = -1;
    if (!(s->end > 0.0) || !isfinite(s->end)) {
        return false;
    }
    for (int i = 0; SCENE_ANY_HERTZ && !agrees(s, s->end); ++i) {
        s->end *= SHORTENING;
        if (i == MOST_SHORTENINGS) {
            return false;
        }
    }
    find_changes(s, v, q); /* before the time is asked for: it goes back beyond a zero of the pace */
    s->time = island_time_at(s, s->end);
    if (s->time > longest) {
        s->end = place_of(s, longest);
        s->terminal = -1;
    }
    if (!find_touches(s, v, q, at)) {
        return false;
    }
    s->time = island_time_at(s, s->end);
    return true;
}

/* In so many parts of a series a force or a depth has one maximum each. */
enum { ISLAND_PARTS = 4 };

/* At a touch and at a release the pace is zero, and with it the slope of every series. The slopes at both
 * ends are therefore taken inside, by this part of the way between the ends. A top that is nearer to an end
 * exceeds the value there by the square of this part. */
static const double INSIDE = 1e-6;

/* Returns the largest value of a series from one place to another. */
static double largest_within(const double *row, double from, double to)
{
    const double inside = INSIDE * (to - from);
    double slopes[TAYLOR_TERMS];
    double largest = fmax(taylor_at(row, TAYLOR_TERMS, from), taylor_at(row, TAYLOR_TERMS, to));
    for (int i = 0; i < TAYLOR_ORDER; ++i) {
        slopes[i] = (i + 1) * row[i + 1];
    }
    slopes[TAYLOR_ORDER] = 0.0;
    double start = from + inside;
    bool rises = taylor_at(slopes, TAYLOR_TERMS, start) > 0.0;
    for (int i = 1; i <= ISLAND_PARTS; ++i) {
        const double end = i < ISLAND_PARTS ? from + (to - from) * i / ISLAND_PARTS : to - inside;
        const double slope = taylor_at(slopes, TAYLOR_TERMS, end);
        if (rises && !(slope > 0.0)) {
            const double top = root_in_bracket(taylor_root_function, slopes, start, end);
            largest = fmax(largest, taylor_at(row, TAYLOR_TERMS, top));
        }
        rises = slope > 0.0;
        start = end;
    }
    return largest;
}

/* Without a dashpot the force is largest where the contact is deepest. */
static void note_peaks_of_island(const struct island *s, double from, double to, struct scene_state *q)
{
    double depth[TAYLOR_TERMS];
    for (int n = 0; n < s->rows; ++n) {
        const struct island_row *r = &s->row[n];
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            depth[i] = -r->gap[i];
        }
        const double deepest = largest_within(depth, from, to);
        const double force = r->k * deepest * (r->is_hertz ? sqrt(fmax(deepest, 0.0)) : 1.0);
        contact_peaks_note(&q->contact[r->contact].peaks,
                           r->c > 0.0 ? largest_within(r->force, from, to) : force, deepest);
    }
}

/* Returns the vector of three series, of which only those along the axes of the island are not zero. */
static struct vec3 three_at(const struct island *s, const double (*rows)[TAYLOR_TERMS], double place)
{
    double of[ISLAND_AXES] = {0.0};
    for (int a = 0; a < s->axes; ++a) {
        of[s->axis[a]] = taylor_at(rows[s->axis[a]], TAYLOR_TERMS, place);
    }
    return vec3_from(of);
}

/* Returns c, which leads from the source to the destination, at a place. */
static struct vec3 island_separation_at(const struct island *s, const struct island_row *r, double place)
{
    const double time = island_time_at(s, place);
    struct vec3 c =
        vec3_sub(three_at(s, s->body[r->end[1]].moved, place), three_at(s, s->body[r->end[0]].moved, place));
    double power = 1.0;
    for (int p = 0; p <= s->degree; ++p) {
        c = vec3_axpy(c, power, vec3_from(r->flown + ISLAND_AXES * p));
        power *= time;
    }
    return c;
}

/* Adds what contacts sum up over a series: the energy that dashpots take [J], and the impulse of the torque
 * on a destination about its centre, the integral of c x F, where F acts on the source [N m s]. Products of
 * series have coefficients beyond the last one. Twelve nodes integrate them to rounding, because a series
 * ends at a fourth of its radius of convergence. */
static void island_sum_up(const struct island *s, double place, struct scene_state *q)
{
    const struct lobatto *nodes = &lobatto[LOBATTO_TWELVE];
    const int points = nodes->points;
    double dissipated = 0.0;
    bool any = false;
    for (int n = 0; n < s->rows; ++n) {
        any = any || s->row[n].c > 0.0 || has_lever(&s->row[n]);
    }
    for (int i = 0; any && i < points; ++i) {
        const double at = 0.5 * place * (1.0 + nodes->node[i]);
        const double weight = 0.5 * place * nodes->integral[i * points + points - 1];
        const double pace = s->unit * (s->paced_by < 0 ? 1.0 : taylor_at(s->pace.row, TAYLOR_TERMS, at));
        for (int n = 0; n < s->rows; ++n) {
            const struct island_row *r = &s->row[n];
            if (r->c > 0.0) {
                dissipated += weight * pace * taylor_at(r->drag, TAYLOR_TERMS, at) *
                              taylor_at(r->rate, TAYLOR_TERMS, at);
            }
            if (has_lever(r)) {
                double push[ISLAND_AXES] = {0.0};
                for (int a = 0; a < s->axes; ++a) {
                    double of[3];
                    taylor_derivatives(r->pushed[s->axis[a]], TAYLOR_TERMS, at, of);
                    push[s->axis[a]] = -of[1];
                }
                struct vec3 *sum = &q->contact[r->contact].torques.destination_impulse;
                *sum = vec3_axpy(*sum, weight, vec3_cross(island_separation_at(s, r, at), vec3_from(push)));
            }
        }
    }
    q->dissipated += dissipated;
}

void island_advance(const struct island *s, double from, double time, const struct scene_values *v,
                    struct scene_state *q)
{
    const double place = time < s->time ? place_of(s, time) : s->end;
    if (from < time) {
        note_peaks_of_island(s, from > 0.0 ? place_of(s, from) : 0.0, place, q);
    }
    for (int n = 0; n < s->rows; ++n) {
        const struct island_row *r = &s->row[n];
        struct contact_state *state = &q->contact[r->contact];
        state->physics.impulse = vec3_sub(state->physics.impulse, three_at(s, r->pushed, place));
        state->physics.accumulated_gap = taylor_at(r->gap, TAYLOR_TERMS, place);
        state->physics.rate_rounding = 0.0;
    }
    island_sum_up(s, place, q);
    for (int b = 1; b < s->bodies; ++b) {
        const struct island_body *body = &s->body[b];
        double rate[ISLAND_AXES] = {0.0};
        for (int a = 0; a < s->axes; ++a) {
            rate[s->axis[a]] = taylor_at(body->rate[s->axis[a]], TAYLOR_TERMS, place);
        }
        const struct vec3 moved = three_at(s, body->moved, place);
        q->external_work += vec3_dot(q->path[body->body].force[0], moved);
        flight_deviate(v, q, body->body, time, moved, vec3_from(rate));
    }
}

#endif
