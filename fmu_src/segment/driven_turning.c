#include "segment/driven_turning.h"

#include <float.h>

#include "scene/free_bodies.h"
#include "scene/onset.h"
#include "scene/rounding.h"
#include "segment/driven_panel.h"
#include "segment/relative_path.h"
#include "segment/scene_output.h"
#include "segment/tumbling_touch.h"

#if SCENE_ANY_TURNING

/* How closely a panel and its two halves must agree, relative to what they are summed up of. The halves are a
 * thousand times better. */
static const double PANELS_AGREE = 1e-12;
/* The same relative to the whole span: kinks and jumps of the law are not located, they end in panels so
 * short that this is all they are. */
static const double KINKS_AGREE = 1e-14;

/* One contact over a span. */
struct driven_span {
    struct driven_contact c;
    struct driven_panel total; /* its size: of the contact so far; its spring: the present one */
    double sum[DRIVEN_TERMS];
    bool elastic;
    long *budget;
};

/* ---- Friction of the moment ---- */

#if SCENE_ANY_FRICTION

/* The least event function, and which. */
enum driven_event { DRIVEN_STICK, DRIVEN_CAP, DRIVEN_LIFT };

struct driven_margin {
    double value; /* [N], or [m/s] */
    double scale; /* of what the value is a difference */
    enum driven_event event;
};

static struct driven_margin margin_at(const struct driven_span *s, double clock, struct vec3 spring)
{
    const int j = s->c.contact;
    struct scene_instant at;
    driven_instant(&s->c, clock, spring, &at);
    const struct friction_law law = scene_friction_law(s->c.v, s->c.q, j);
    const enum friction_regime regime = (enum friction_regime)s->c.q->contact[j].friction_regime;
    const struct friction_state rubbing = turning_rubbing(&s->c.q->turning, &at, j);
    const double rate = turning_normal_force_rate(s->c.v, s->c.q, clock, &at, j);
    const double force = fabs(at.normal_force[j]);
    const bool by_speed = law.damping == 0.0 && regime != FRICTION_STICKING;
    const double stick = friction_stick_event(&law, regime, rubbing, rate);
    const double cap = friction_cap_event(&law, regime, at.normal_force[j]);
    const double lift = friction_lift_event(&law, regime, at.normal_force[j]);
    struct driven_margin least = {stick, by_speed ? vec3_norm(rubbing.slip) : law.static_coefficient * force,
                                  DRIVEN_STICK};
    if (cap < 0.0 && cap < least.value) {
        least = (struct driven_margin){cap, law.coefficient * force, DRIVEN_CAP};
    }
    if (lift < 0.0 && !(least.value < 0.0)) {
        least = (struct driven_margin){lift, force, DRIVEN_LIFT};
    }
    return least;
}

/* Where no force tells how long the spring is: of the source's radius. */
static const double FIRST_LENGTH = 1e-4;

/* Of sliding without a dashpot the state is the spring's direction; it begins with that of the slip. */
static struct vec3 first_spring(const struct driven_contact *c, const struct friction_law *law,
                                const struct scene_instant *at)
{
    const struct vec3 slip = at->turning.slip[c->contact];
    const double speed = vec3_norm(slip);
    if (law->damping > 0.0 || !(speed > 0.0)) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    const double limit = friction_limit(law, FRICTION_SLIDING, at->normal_force[c->contact]);
    const double length = fmin(limit, law->largest) / law->stiffness;
    const double least = FIRST_LENGTH * body_radius(c->v, contact_source(c->contact));
    return vec3_scale(fmax(length, least) / speed, slip);
}

/* Friction begins at an instant, its spring at rest. */
static void start_friction(const struct driven_contact *c, double clock)
{
    const int j = c->contact;
    struct scene_instant at;
    const struct friction_law law = scene_friction_law(c->v, c->q, j);
    const struct vec3 none = {0.0, 0.0, 0.0};
    c->q->contact[j].friction_regime = (int32_t)FRICTION_STICKING;
    driven_instant(c, clock, none, &at);
    if (!contact_rubs_elastically(c->v, j)) {
        return;
    }
    const double rate = turning_normal_force_rate(c->v, c->q, clock, &at, j);
    const enum friction_regime next =
        friction_onset_regime(&law, at.normal_force[j], rate, at.turning.slip[j]);
    const bool slides = next == FRICTION_SLIDING || next == FRICTION_CAPPED;
    c->q->contact[j].friction_regime = (int32_t)next;
    c->q->turning.spring[j] = slides ? first_spring(c, &law, &at) : none;
}

/* The regime and the spring after an event at an instant; what sticks again keeps the spring that sliding
 * had. */
static void take_driven_event(const struct driven_span *s, double clock, struct vec3 spring,
                              enum driven_event event)
{
    const int j = s->c.contact;
    int32_t *regime = &s->c.q->contact[j].friction_regime;
    struct scene_instant at;
    driven_instant(&s->c, clock, spring, &at);
    const struct friction_law law = scene_friction_law(s->c.v, s->c.q, j);
    const enum friction_regime before = (enum friction_regime) * regime;
    if (event == DRIVEN_LIFT && before == FRICTION_LIFTED) {
        start_friction(&s->c, clock);
    } else if (event == DRIVEN_LIFT) {
        *regime = (int32_t)FRICTION_LIFTED;
        s->c.q->turning.spring[j] = vec3_make(0.0, 0.0, 0.0);
    } else if (event == DRIVEN_STICK && before != FRICTION_STICKING) {
        s->c.q->turning.spring[j] = friction_spring(&law, before, turning_rubbing(&s->c.q->turning, &at, j));
        *regime = (int32_t)FRICTION_STICKING;
    } else {
        *regime = (int32_t)friction_sliding_regime(&law, at.normal_force[j]);
    }
}

/* The part of what an event function is a difference of that is rounding. */
static const double MARGIN_ROUNDING = 1e-13;

static void begin_driven_friction(const struct scene_values *v, struct scene_state *q, double clock,
                                  int contact)
{
    const struct driven_contact c = {v, q, contact};
    q->turning.spring[contact] = vec3_make(0.0, 0.0, 0.0);
    if (contact_rubs(v, contact)) {
        start_friction(&c, clock);
    }
}

static void end_driven_friction(struct scene_state *q, int contact)
{
    q->turning.spring[contact] = vec3_make(0.0, 0.0, 0.0);
    q->contact[contact].friction_regime = (int32_t)FRICTION_STICKING;
}

static struct vec3 spring_now(const struct scene_state *q, int contact)
{
    return q->turning.spring[contact];
}

/* Of elastic friction after inputs have jumped: the spring lies across the new normal, and one event at most
 * follows. */
static void settle_spring(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    const struct driven_span s = {.c = {v, q, contact}, .elastic = true};
    driven_instant(&s.c, q->clock, q->turning.spring[contact], &at);
    const struct vec3 n = at.geometry[contact].normal;
    const struct vec3 spring = q->turning.spring[contact];
    q->turning.spring[contact] = vec3_axpy(spring, -vec3_dot(spring, n), n);
    const struct driven_margin margin = margin_at(&s, q->clock, q->turning.spring[contact]);
    if (margin.value < -MARGIN_ROUNDING * margin.scale) {
        take_driven_event(&s, q->clock, q->turning.spring[contact], margin.event);
    }
}

#else

static void begin_driven_friction(const struct scene_values *v, struct scene_state *q, double clock,
                                  int contact)
{
    (void)v, (void)q, (void)clock, (void)contact;
}

static void end_driven_friction(struct scene_state *q, int contact)
{
    (void)q, (void)contact;
}

static struct vec3 spring_now(const struct scene_state *q, int contact)
{
    (void)q, (void)contact;
    return vec3_make(0.0, 0.0, 0.0);
}

#endif

/* ---- Within a contact ---- */

/* Near the touch Hertz's force goes with the power 3/2 of time (prescribed.c). */
static bool wants_graded(const struct driven_span *s, double from, double to)
{
    const double shallow = 0.1;
    const double clock[3] = {from, 0.5 * (from + to), to};
    double gap[3];
    if (!scene_is_hertz(s->c.v, s->c.contact)) {
        return false;
    }
    for (int i = 0; i < 3; ++i) {
        struct scene_instant at;
        scene_kinematics(s->c.v, s->c.q, clock[i], free_bodies_now(s->c.q), &at);
        gap[i] = at.geometry[s->c.contact].gap;
    }
    return fmax(gap[0], gap[2]) > shallow * gap[1];
}

static bool make_panel(const struct driven_span *s, double from, double to, struct vec3 spring,
                       struct driven_panel *panel)
{
    return driven_panel_make(&s->c, from, to, spring, wants_graded(s, from, to), panel);
}

/* Of the force, in time; what else is integrated has it times arms and speeds. */
static double rounding_part(const struct driven_span *s, const struct driven_panel *panel)
{
    struct scene_instant at;
    driven_instant(&s->c, panel->to, panel->spring, &at);
    const double noise = rounding_of_force(s->c.v, s->c.q, &at, s->c.contact) * (panel->to - panel->from);
    return panel->size[DRIVEN_FORCE] > 0.0 ? fmin(noise / panel->size[DRIVEN_FORCE], 1.0) : 1.0;
}

/* A contact's law at an instant: its regime, and whether friction is capped or lifted; forces within `floor`
 * of zero are none [N]. */
static int law_at(const struct driven_span *s, double clock, struct vec3 spring, double floor)
{
    struct scene_instant at;
    driven_instant(&s->c, clock, spring, &at);
    int key = 4 * s->c.q->contact[s->c.contact].regime;
#if SCENE_ANY_FRICTION
    if (!s->elastic && at.normal_force[s->c.contact] < -floor) {
        key += 1;
    } else if (s->c.q->contact[s->c.contact].friction_regime == (int32_t)FRICTION_CAPPED) {
        key += 2;
    }
#else
    (void)floor;
#endif
    return key;
}

/* Whether one law holds over a panel: a corner of it near an end would hide between the nodes. */
static bool is_of_one_law(const struct driven_span *s, const struct driven_panel *panel)
{
    const double floor = 1e-9 * panel->size[DRIVEN_FORCE] / (panel->to - panel->from);
    const int first = law_at(s, panel->from, panel->node[0].spring, floor);
    for (int i = 0; i < GAUSS_NODES; ++i) {
        if (law_at(s, panel->node[i].clock, panel->node[i].spring, floor) != first) {
            return false;
        }
    }
    return law_at(s, panel->to, panel->spring, floor) == first;
}

/* A panel with a corner may be that part of the whole: its error is the square of it. */
static const double CORNER_PART = 1e-7;

static bool panels_agree(const struct driven_span *s, const struct driven_panel *whole,
                         const struct driven_panel *left, const struct driven_panel *right)
{
    const double noise = rounding_part(s, whole);
    for (int k = 0; k < DRIVEN_TERMS; ++k) {
        const double size = left->size[k] + right->size[k];
        const double allowed = (PANELS_AGREE + noise) * size + KINKS_AGREE * s->total.size[k] + DBL_MIN;
        if (!(fabs(left->sum[k] + right->sum[k] - whole->sum[k]) <= allowed)) {
            return false;
        }
    }
    const double way = vec3_norm(right->spring) + left->slipped + right->slipped;
    return !s->elastic ||
           vec3_norm(vec3_sub(right->spring, whole->spring)) <= 4.0 * PANELS_AGREE * way + DBL_MIN;
}

/* The quadrature resolves a panel by five nodes each half: no quantity has two extrema within a quarter. */
enum { PANEL_PARTS = 4 };

static void add_driven_panel(struct driven_span *s, const struct driven_panel *panel)
{
    struct scene_instant at;
    for (int k = 0; k < DRIVEN_TERMS; ++k) {
        s->sum[k] += panel->sum[k];
        s->total.size[k] += panel->size[k];
    }
    driven_instant(&s->c, 0.5 * (panel->from + panel->to), panel->spring, &at);
    struct scene_output output = {.values = s->c.v, .state = s->c.q, .contact = s->c.contact};
    scene_output_note_peaks(&output, panel->from, panel->to, PANEL_PARTS,
                            &s->c.q->contact[s->c.contact].peaks);
    driven_instant(&s->c, panel->to, panel->spring, &at);
    const struct vec3 n = at.geometry[s->c.contact].normal;
    s->total.spring = vec3_axpy(panel->spring, -vec3_dot(panel->spring, n), n);
    counter_add(&s->c.q->counters.force_evaluations, GAUSS_NODES);
}

#if SCENE_ANY_ELASTIC_FRICTION

/* The first place of a panel at which the regime of friction has ended; false: none. */
static bool finds_event(const struct driven_span *s, const struct driven_panel *panel, double floor,
                        double *before, double *after)
{
    *before = panel->from;
    for (int i = 0; i <= GAUSS_NODES; ++i) {
        const bool at_end = i == GAUSS_NODES;
        *after = at_end ? panel->to : panel->node[i].clock;
        const struct driven_margin margin =
            margin_at(s, *after, at_end ? panel->spring : panel->node[i].spring);
        if (margin.value < fmin(floor, 0.0) - MARGIN_ROUNDING * margin.scale) {
            return true;
        }
        *before = *after;
    }
    return false;
}

/* Halves the bracket until the clock is known to rounding; the panel that ends there, just past the event. */
static bool panel_to_event(const struct driven_span *s, double from, double before, double after,
                           double floor, struct driven_panel *panel)
{
    const struct vec3 start = s->total.spring;
    while (after - before > 4.0 * DBL_EPSILON * fabs(after)) {
        const double middle = 0.5 * (before + after);
        if (middle <= before || middle >= after || !make_panel(s, from, middle, start, panel)) {
            break;
        }
        const struct driven_margin margin = margin_at(s, middle, panel->spring);
        if (margin.value < fmin(floor, 0.0) - MARGIN_ROUNDING * margin.scale) {
            after = middle;
        } else {
            before = middle;
        }
    }
    return make_panel(s, from, after, start, panel);
}

/* Where an event ends the regime of friction in one of two panels: integrates up to it and changes the
 * regime. Returns whether there is one. */
static bool passes_event(struct driven_span *s, const struct driven_panel *left,
                         const struct driven_panel *right, double *clock)
{
    double before = 0.0;
    double after = 0.0;
    struct driven_panel panel;
    const double floor = margin_at(s, left->from, s->total.spring).value;
    if (!finds_event(s, left, floor, &before, &after) && !finds_event(s, right, floor, &before, &after)) {
        return false;
    }
    if (!panel_to_event(s, left->from, before, after, floor, &panel)) {
        return false;
    }
    add_driven_panel(s, &panel);
    const struct driven_margin margin = margin_at(s, panel.to, s->total.spring);
    take_driven_event(s, panel.to, s->total.spring, margin.event);
    s->total.spring = spring_now(s->c.q, s->c.contact);
    counter_add(&s->c.q->counters.events, 1);
    *clock = panel.to;
    return true;
}

#else

static bool passes_event(struct driven_span *s, const struct driven_panel *left,
                         const struct driven_panel *right, double *clock)
{
    (void)s, (void)left, (void)right, (void)clock;
    return false;
}

#endif

/* From one clock to another, between which the bodies touch. */
static bool integrate_contact(struct driven_span *s, double from, double end)
{
    double clock = from;
    double width = end - from;
    while (clock < end) {
        if ((*s->budget)-- <= 0) {
            return false;
        }
        const double to = width < end - clock ? clock + width : end;
        const double middle = 0.5 * (clock + to);
        const bool divides = middle > clock && middle < to;
        struct driven_panel whole;
        struct driven_panel left;
        struct driven_panel right;
        const struct vec3 start = s->total.spring;
        const bool made = make_panel(s, clock, to, start, &whole) &&
                          make_panel(s, clock, middle, start, &left) &&
                          make_panel(s, middle, to, left.spring, &right);
        const bool small = made && whole.size[DRIVEN_FORCE] <= CORNER_PART * s->total.size[DRIVEN_FORCE];
        if (divides &&
            (!made || !panels_agree(s, &whole, &left, &right) || !(small || is_of_one_law(s, &whole)))) {
            width = 0.5 * (to - clock);
            continue;
        }
        if (s->elastic && divides && passes_event(s, &left, &right, &clock)) {
            continue;
        }
        add_driven_panel(s, &left);
        add_driven_panel(s, &right);
        clock = to;
        width *= 2.0;
    }
    return true;
}

/* ---- From touch to touch ---- */

static struct axis_motion axis_from(const struct driven_span *s, const struct scene_instant *at, double clock)
{
    const int destination = contact_destination(s->c.contact);
    const struct vec3 axis = at->turning.axis[s->c.contact];
#if SCENE_ANY_ROTATION
    if (body_turn_is_prescribed(s->c.v, destination) && body_shape(destination) != SHAPE_SPHERE) {
        struct body_path path = s->c.q->path[destination];
        path_shift(path.angular_velocity, 3, clock);
        path_shift(path.axis, 3, clock);
        return path.turn_follows == TURN_FOLLOWS_VELOCITY ? axis_motion_driven(axis, path.angular_velocity, 3)
                                                          : axis_motion_following(path.axis, 3);
    }
#else
    (void)destination, (void)clock;
#endif
    return axis_motion_fixed(axis);
}

/* The motion from a clock on. */
static struct tumbling_path path_from(const struct driven_span *s, double clock)
{
    struct scene_instant at;
    scene_kinematics(s->c.v, s->c.q, clock, free_bodies_now(s->c.q), &at);
    const struct separation_path separation = separation_path_of(s->c.v, s->c.q, &at, clock, s->c.contact);
    struct tumbling_path path = {.shape = scene_contact_shape_at(s->c.v, s->c.q, &at, s->c.contact),
                                 .axis = axis_from(s, &at, clock),
                                 .rounding = rounding_of_gap(s->c.v, &at, s->c.contact)};
    for (int i = 0; i < TUMBLING_TERMS; ++i) {
        path.c[i] = separation.c[i];
    }
    return path;
}

/* So many evaluations of the gap at most; some dozens are usual. */
static const long SEARCH_BUDGET = 1000000;

/* The clock of the next change, `end` where there is none. */
static double next_change(const struct driven_span *s, double clock, double end, enum tumbling_change change)
{
    const struct tumbling_path path = path_from(s, clock);
    const struct tumbling_result found = tumbling_first(&path, change, end - clock, SEARCH_BUDGET);
    return found.after < end - clock ? clock + found.after : end;
}

static void begin_contact(struct driven_span *s, double clock)
{
    const int j = s->c.contact;
    struct scene_state *q = s->c.q;
    struct scene_instant at;
    scene_kinematics(s->c.v, q, clock, free_bodies_now(q), &at);
    (void)onset_note(s->c.v, q, &at, j, scene_regime_of_touching(s->c.v, q, &at, j));
    q->contact[j].regime = (int32_t)scene_regime_of_touching(s->c.v, q, &at, j);
    begin_driven_friction(s->c.v, q, clock, j);
    s->total.spring = spring_now(q, j);
#if SCENE_ANY_FREE
    counter_add(&q->contact[j].record.onsets, 1);
    q->contact[j].record.onset_time = q->base + (q->base_tail + clock);
    q->contact[j].record.touch_clock = clock;
#endif
    counter_add(&q->counters.events, 1);
}

static void end_contact(struct driven_span *s, double clock)
{
    struct scene_state *q = s->c.q;
    const int j = s->c.contact;
    q->contact[j].regime = (int32_t)REGIME_APART;
    end_driven_friction(q, j);
#if SCENE_ANY_FREE
    q->contact[j].record.last_duration = clock - q->contact[j].record.touch_clock;
#else
    (void)clock;
#endif
    counter_add(&q->counters.events, 1);
}

/* What a finite cylinder's end or a jump leaves of the stored energy is dissipated. */
static double stored_at(const struct driven_span *s, double clock)
{
    struct scene_instant at;
    const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
    scene_kinematics(s->c.v, s->c.q, clock, free_bodies_now(s->c.q), &at);
    const double gap = fmin(at.geometry[s->c.contact].gap, 0.0);
    return contact_stored_energy(&law, REGIME_COMPRESSION, gap);
}

static bool span_over(struct driven_span *s, double end)
{
    struct scene_state *q = s->c.q;
    const int j = s->c.contact;
    double clock = q->clock;
    s->total.spring = spring_now(q, j);
    while (clock < end) {
        const bool touches = q->contact[j].regime != (int32_t)REGIME_APART;
        const double next = next_change(s, clock, end, touches ? TUMBLING_PARTING : TUMBLING_TOUCH);
        if (touches && !integrate_contact(s, clock, next)) {
            return false;
        }
        if (next < end && touches) {
            s->sum[DRIVEN_DISSIPATED] += stored_at(s, next);
            end_contact(s, next);
        } else if (next < end) {
            begin_contact(s, next);
            s->sum[DRIVEN_DISSIPATED] -= stored_at(s, next);
        }
        clock = next;
    }
    return true;
}

static struct vec3 vector_from(const double *a)
{
    return vec3_make(a[0], a[1], a[2]);
}

/* Of a span of this length [s]. */
static void book_span(const struct driven_span *s, double length)
{
    struct contact_state *state = &s->c.q->contact[s->c.contact];
    const struct vec3 force = vector_from(s->sum + DRIVEN_FORCE);
    const struct vec3 source = vector_from(s->sum + DRIVEN_SOURCE_TORQUE);
    const struct vec3 destination = vector_from(s->sum + DRIVEN_DESTINATION_TORQUE);
#if SCENE_ANY_FREE
    state->physics.impulse = vec3_add(state->physics.impulse, force);
    state->torques.source_impulse = vec3_add(state->torques.source_impulse, source);
    state->torques.destination_impulse = vec3_add(state->torques.destination_impulse, destination);
    s->c.q->dissipated += s->sum[DRIVEN_DISSIPATED];
    s->c.q->friction_energy += s->sum[DRIVEN_FRICTION];
    s->c.q->external_work += s->sum[DRIVEN_WORK];
    (void)length;
#else
    state->mean_force = vec3_scale(1.0 / length, force);
    state->torques.source_mean = vec3_scale(1.0 / length, source);
    state->torques.destination_mean = vec3_scale(1.0 / length, destination);
#endif
#if SCENE_ANY_FRICTION
    s->c.q->turning.spring[s->c.contact] = s->total.spring;
#endif
}

bool driven_turning_over(const struct scene_values *v, struct scene_state *q, double length, long *budget)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct driven_span s = {.c = {v, q, j}, .elastic = contact_rubs_elastically(v, j), .budget = budget};
        if (!contact_is_driven(v, j)) {
            continue;
        }
        if (!span_over(&s, q->clock + length)) {
            return false;
        }
        book_span(&s, length);
    }
    return true;
}

void driven_turning_settle(const struct scene_values *v, struct scene_state *q, int contact)
{
    struct scene_instant at;
    scene_kinematics(v, q, q->clock, free_bodies_now(q), &at);
    const bool touched = q->contact[contact].regime != (int32_t)REGIME_APART;
    const enum contact_regime regime = scene_regime(v, q, &at, contact);
    const enum contact_regime next = onset_note(v, q, &at, contact, regime);
    q->contact[contact].regime = (int32_t)next;
    if (next == REGIME_APART) {
        end_driven_friction(q, contact);
    } else if (!touched) {
        begin_driven_friction(v, q, q->clock, contact);
    } else {
#if SCENE_ANY_FRICTION
        if (contact_rubs_elastically(v, contact)) {
            settle_spring(v, q, contact);
        }
#endif
        driven_instant(&(struct driven_contact){v, q, contact}, q->clock, spring_now(q, contact), &at);
    }
}

#endif
