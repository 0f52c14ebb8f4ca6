#include "touch/island.h"

#include <string.h>

#include "flight/flight.h"
#include "math/nodes.h"
#include "math/polynomial.h"
#include "scene/evaluate.h"
#include "touch/pair.h"

#if SCENE_HAS_ISLANDS

/* This is the error of a series, divided by the whole: a few roundings. A larger error would save few steps,
 * and weak forces that grow within a step would be lost. */
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
static void put_timescales(struct expansion_row *r, double by_mass)
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
        s->index[body] = s->terms.bodies;
        s->body[s->terms.bodies++] =
            (struct expansion_body){.body = body, .by_mass = body_inverse_mass(v, body)};
    }
    return s->index[body];
}

static void put_law(struct expansion_row *r, const struct scene_instant *at, double tolerated)
{
    const struct contact_law law = scene_contact_law(at->q, r->contact);
    const struct contact_geometry *g = &at->geometry[r->contact];
    const enum contact_regime regime = (enum contact_regime)at->q->contact[r->contact].regime;
    r->is_hertz = contact_is_hertz(&law);
    const struct contact_coefficients of = contact_factors_of(&law, regime);
    r->k = of.k;
    r->c = of.c;
    r->by_gap = r->by_rate = r->margin = 0.0;
    if (contact_has_events(&law)) {
        const struct contact_slopes slopes = contact_event_slopes(&law, regime);
        r->by_gap = slopes.by_gap;
        r->by_rate = slopes.by_rate;
        r->margin = contact_event(&law, regime, g->gap, g->gap_rate) +
                    rounding_margin_offset(at, r->contact, tolerated);
    }
}

static bool add_touching(struct island *s, const struct scene_instant *at, int contact)
{
    struct expansion_row *r = &s->terms.row[s->terms.rows];
    const struct contact_geometry *g = &at->geometry[contact];
    const struct contact_shape shape = scene_contact_shape(at->q, contact);
    const int bodies[2] = {contact_source(contact), contact_destination(contact)};
    if (s->terms.rows == ISLAND_MOST || g->degenerate || !knows_shape(at->v, &shape, contact) ||
        !flight_is_steady(at->q, bodies[0]) || !flight_is_steady(at->q, bodies[1])) {
        return false;
    }
    memset(r, 0, sizeof *r);
    r->contact = contact;
    r->side = shape.side;
    r->is_straight = contact_is_plane(&shape);
    vec3_to(contact_is_cylinder(&shape) ? shape.axis : vec3_make(0.0, 0.0, 0.0), r->axis);
    const struct separation_path flight = separation_path_of(at, at->q->clock, contact);
    const int degree = path_degree(flight.c, SEPARATION_DEGREE + 1);
    s->terms.degree = degree > s->terms.degree ? degree : s->terms.degree;
    memcpy(r->flown, flight.c, sizeof r->flown);
    memcpy(r->flown_rate, flight.w, sizeof flight.w);
    put_law(r, at, ACCURACY * vec3_norm(at->rate[contact]));
    r->gap[0] = g->gap;
    r->by_distance = 1.0 / g->distance;
    r->passage = r->is_straight ? 0.0 : vec3_norm(at->rate[contact]) * r->by_distance;
    r->rate[0] = g->gap_rate;
    put_timescales(r, scene_inverse_mass(at->v, contact));
    for (int k = 0; k < EXPANSION_AXES; ++k) {
        taylor_put(&r->n[k], 0, vec3_get(g->normal, k));
        s->lives[k] = s->lives[k] || vec3_get(g->normal, k) != 0.0;
        for (int p = 1; p <= degree && !r->is_straight; ++p) {
            s->lives[k] = s->lives[k] || vec3_get(contact_across(&shape, flight.c[p]), k) != 0.0;
        }
    }
    r->offset = fmax(g->gap, 0.0) + rounding_of_gap(at, contact);
    for (int end = 0; end < 2; ++end) {
        r->end[end] = add_body(s, at->v, bodies[end]);
    }
    s->terms.rows += 1;
    return true;
}

/* Collects the axes along which contact forces act. Where there is one axis, no normal turns. */
static void find_axes(struct island *s)
{
    for (int k = 0; k < EXPANSION_AXES; ++k) {
        if (s->lives[k]) {
            s->terms.along[s->terms.axes++] = k;
        }
    }
    for (int i = 0; i < s->terms.rows; ++i) {
        s->terms.row[i].is_straight = s->terms.row[i].is_straight || s->terms.axes == 1;
    }
}

/* Sets g'' of the contacts in touch at the start. */
static void find_bends(struct island *s, const struct scene_instant *at)
{
    struct scene_instant now = *at;
    scene_forces(NULL, &now);
    for (int i = 0; i < s->terms.rows; ++i) {
        s->terms.row[i].bend = scene_gap_acceleration(&now, s->terms.row[i].contact);
    }
}

/* Returns how far the nearest zero of the depth is in time, which may be complex [s], by delta, delta' and
 * delta''. */
static double time_from_zero(const struct expansion_row *r)
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
    s->terms.paced_by = -1;
    for (int i = 0; i < s->terms.rows; ++i) {
        const struct expansion_row *r = &s->terms.row[i];
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
            s->terms.paced_by = i;
            root = sqrt(r->deepest);
        }
    }
    s->terms.unit = 1.0 / (fastest * root);
    return isfinite(s->terms.unit) && s->terms.unit > 0.0;
}

/* An oscillation smaller than this part of the largest depth is left to the general segment. A step of that
 * segment is longer than a series, and few iterations follow a small oscillation. By this rule the bearing of
 * the report takes 72 million instructions at a tolerance of 1e-9; without the rule it takes 104 million. */
static const double SMALL_OSCILLATION = 2e-3;

/* Whether no contact oscillates by more than `quiet` [m] or SMALL_OSCILLATION. The amplitude is that which
 * the spring, or the dashpot where it is faster, gives to the present g' and g''. */
static bool is_quiet(const struct island *s, double quiet)
{
    double amplitude = 0.0;
    double deepest = 0.0;
    for (int i = 0; i < s->terms.rows; ++i) {
        const struct expansion_row *r = &s->terms.row[i];
        const double fast = fmax(r->spring, r->dashpot);
        amplitude = fmax(amplitude, fabs(r->bend) / (fast * fast) + fabs(r->rate[0]) / fast);
        deepest = fmax(deepest, -r->gap[0]);
    }
    return amplitude <= fmax(quiet, SMALL_OSCILLATION * deepest);
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
    for (int n = 0; n < s->terms.rows; ++n) {
        const struct expansion_row *r = &s->terms.row[n];
        largest = fmax(largest, fmax(fabs(r->force[0]), fabs(taylor_at(r->force, TAYLOR_TERMS, place))));
        if (SCENE_ANY_HERTZ && r->is_hertz && n != s->terms.paced_by) {
            const double depth = fmax(taylor_at(r->depth.row, TAYLOR_TERMS, place), 0.0);
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
static void find_changes(struct island *s, const struct scene_state *q)
{
    double of[TAYLOR_TERMS];
    for (int n = 0; n < s->terms.rows; ++n) {
        const struct expansion_row *r = &s->terms.row[n];
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            of[i] = n == s->terms.paced_by ? s->terms.pace.row[i] : (i == 0 ? r->offset : 0.0) - r->gap[i];
        }
        const bool parts_now = n == s->terms.paced_by && of[0] == 0.0 && r->rate[0] > 0.0;
        note_change(s, parts_now ? 0.0 : taylor_first_fall(of, TAYLOR_TERMS, s->end), r->contact,
                    REGIME_APART);
        if (r->margin > 0.0) {
            const struct contact_law law = scene_contact_law(q, r->contact);
            for (int i = 0; i < TAYLOR_TERMS; ++i) {
                of[i] = i == 0 ? r->margin : r->by_gap * r->gap[i] + r->by_rate * r->rate[i];
            }
            note_change(s, taylor_first_fall(of, TAYLOR_TERMS, s->end), r->contact,
                        contact_regime_after(&law, (enum contact_regime)q->contact[r->contact].regime));
        }
    }
}

/* Returns a bound of how far the contacts take a body off its flight within the series. */
static double farthest(const struct island *s, const struct expansion_body *body)
{
    double sum = 0.0;
    for (int a = 0; a < s->terms.axes; ++a) {
        double length = 0.0;
        for (int i = TAYLOR_ORDER; i > 0; --i) {
            length = s->end * (length + fabs(body->moved[s->terms.along[a]][i]));
        }
        sum += length;
    }
    return sum;
}

/* Returns a bound of the change of a separation within the series. */
static double separation_within(const struct island *s, const struct separation_path *flight,
                                const int end[2])
{
    const double time = expansion_time_at(&s->terms, s->end);
    return time * path_size(flight->c + 1, SEPARATION_DEGREE, time) + farthest(s, &s->terms.body[end[0]]) +
           farthest(s, &s->terms.body[end[1]]);
}

/* Returns where bodies that are apart touch within the series. The path along the normal at the start gives
 * the gap of a plane, and a lower bound of it outside other shapes. Their series whose root is sought is
 * side (d^2 - reach^2) = g (2 reach + side g). */
static double touch_within(const struct island *s, const struct contact_shape *shape,
                           const struct separation_path *flight, const struct contact_geometry *g,
                           double offset, const int end[2])
{
    double of[TAYLOR_TERMS] = {g->gap + offset};
    struct two_way path[EXPANSION_AXES] = {{{0.0}, {0.0}}};
    bool moves[EXPANSION_AXES] = {false};
    const bool is_flat = contact_is_plane(shape);
    const struct vec3 axis = contact_is_cylinder(shape) ? shape->axis : vec3_make(0.0, 0.0, 0.0);
    const struct vec3 start = vec3_axpy(flight->c[0], -vec3_dot(flight->c[0], axis), axis);
    for (int i = 1; i < TAYLOR_TERMS; ++i) {
        double moved[EXPANSION_AXES];
        for (int k = 0; k < EXPANSION_AXES; ++k) {
            moved[k] = s->body[end[1]].moved[k][i] - s->body[end[0]].moved[k][i];
        }
        struct vec3 c = vec3_from(moved);
        for (int p = 1; p <= s->terms.degree; ++p) {
            c = vec3_axpy(c, s->terms.power_of_time[p].row[i], flight->c[p]);
        }
        const struct vec3 across = vec3_axpy(c, -vec3_dot(c, axis), axis);
        of[i] = shape->side * vec3_dot(g->normal, across);
        for (int k = 0; k < EXPANSION_AXES && !is_flat; ++k) {
            taylor_put(&path[k], i, vec3_get(across, k));
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
        for (int k = 0; k < EXPANSION_AXES; ++k) {
            const double square = moves[k] ? taylor_product(path[k].row, &path[k], i) : 0.0;
            of[i] += shape->side * (2.0 * vec3_get(start, k) * path[k].row[i] + square);
        }
    }
    return taylor_first_fall(of, TAYLOR_TERMS, s->end);
}

/* The end is halved at most so often for a contact that might begin and whose shape is not known. */
enum { MOST_HALVINGS = 6 };

/* Finds where contacts that are apart begin. Returns false where one might that the series do not know. */
static bool find_touches(struct island *s, const struct scene_instant *at)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const int end[2] = {s->index[contact_source(j)], s->index[contact_destination(j)]};
        if (contact_transmits(at->q, j) || !contact_is_coupled(at->q, j) || end[0] + end[1] == 0) {
            continue;
        }
        const struct contact_geometry *g = &at->geometry[j];
        const struct contact_shape shape = scene_contact_shape(at->q, j);
        const struct separation_path flight = separation_path_of(at, at->q->clock, j);
        const double offset = fmax(-g->gap, 0.0) + rounding_of_gap(at, j);
        const bool is_apart = at->q->contact[j].regime == (int32_t)REGIME_APART;
        bool may_touch = !(separation_within(s, &flight, end) < g->gap);
        if (is_apart && may_touch && knows_shape(at->v, &shape, j)) {
            expansion_add_powers(&s->terms, path_degree(flight.c, SEPARATION_DEGREE + 1));
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
    return time < s->time ? pair_place_by(expansion_time, &s->terms, time, s->end) : s->end;
}

bool island_make(struct island *s, const struct scene_instant *at, double longest, double quiet)
{
    s->terms = (struct expansion){.row = s->row, .body = s->body, .bodies = 1, .degree = 1};
    s->body[0] = (struct expansion_body){.by_mass = 0.0};
    memset(s->index, 0, sizeof s->index);
    memset(s->lives, 0, sizeof s->lives);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_pushes(at->q, j) && !add_touching(s, at, j)) {
            return false;
        }
    }
    find_axes(s);
    find_bends(s, at);
    if (is_quiet(s, quiet) || !choose_pace(s)) {
        return false;
    }
    taylor_put(&s->terms.pace, 0,
               s->terms.paced_by < 0 ? 1.0 : sqrt(fmax(-s->terms.row[s->terms.paced_by].gap[0], 0.0)));
    expansion_make(&s->terms, 0, TAYLOR_ORDER);
    s->end = expansion_reliable(&s->terms, 0.0, 0.0, ACCURACY);
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
    find_changes(s, at->q); /* before the time is asked for: it goes back beyond a zero of the pace */
    s->time = expansion_time_at(&s->terms, s->end);
    if (s->time > longest) {
        s->end = place_of(s, longest);
        s->terminal = -1;
    }
    if (!find_touches(s, at)) {
        return false;
    }
    s->time = expansion_time_at(&s->terms, s->end);
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
    const struct power_sum slope_of = {slopes, TAYLOR_TERMS};
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
            const double top = root_in_bracket(power_sum_and_slope, &slope_of, start, end);
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
    for (int n = 0; n < s->terms.rows; ++n) {
        const struct expansion_row *r = &s->terms.row[n];
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
static struct vec3 three_at(const struct island *s, const taylor_row *rows, double place)
{
    double of[EXPANSION_AXES] = {0.0};
    for (int a = 0; a < s->terms.axes; ++a) {
        of[s->terms.along[a]] = taylor_at(rows[s->terms.along[a]], TAYLOR_TERMS, place);
    }
    return vec3_from(of);
}

/* Adds the impulse of the torque on a destination about its centre, the integral of c x F, where F acts on
 * the source [N m s]. */
static void add_island_torque(const struct island *s, const struct expansion_row *r, double place,
                              struct scene_state *q)
{
    struct vec3 *sum = &q->contact[r->contact].physics.impulse.destination_torque;
    for (int i = 0; i < LOBATTO_MAX; ++i) {
        double weight;
        double push[EXPANSION_AXES] = {0.0};
        const double at = expansion_node(i, place, &weight);
        for (int a = 0; a < s->terms.axes; ++a) {
            double of[3];
            taylor_derivatives(r->pushed[s->terms.along[a]], TAYLOR_TERMS, at, of);
            push[s->terms.along[a]] = -of[1];
        }
        const double time = expansion_time_at(&s->terms, at);
        const struct vec3 flown = path_at((const struct vec3 *)r->flown, SEPARATION_DEGREE + 1, time);
        const struct vec3 moved =
            vec3_sub(three_at(s, s->body[r->end[1]].moved, at), three_at(s, s->body[r->end[0]].moved, at));
        *sum = vec3_axpy(*sum, weight, vec3_cross(vec3_add(flown, moved), vec3_from(push)));
    }
}

void island_advance(const struct island *s, double from, double time, struct scene_state *q)
{
    const double place = place_of(s, time);
    if (from < time) {
        note_peaks_of_island(s, from > 0.0 ? place_of(s, from) : 0.0, place, q);
    }
    for (int n = 0; n < s->terms.rows; ++n) {
        const struct expansion_row *r = &s->terms.row[n];
        struct contact_state *state = &q->contact[r->contact];
        state->physics.impulse.force = vec3_sub(state->physics.impulse.force, three_at(s, r->pushed, place));
        state->physics.accumulated_gap = taylor_at(r->gap, TAYLOR_TERMS, place);
        state->physics.rate_rounding = 0.0;
        if (SCENE_HAS_TORQUES && body_has_axis(contact_destination(r->contact))) {
            add_island_torque(s, r, place, q);
        }
    }
    q->dissipated += expansion_dissipated(&s->terms, place);
    for (int b = 1; b < s->terms.bodies; ++b) {
        const struct expansion_body *body = &s->body[b];
        const struct vec3 moved = three_at(s, body->moved, place);
        q->external_work += vec3_dot(q->path[body->body].force[0], moved);
        flight_deviate(q, body->body, time, moved, three_at(s, body->rate, place));
    }
}

#endif
