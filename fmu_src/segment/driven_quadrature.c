#include "segment/driven_quadrature.h"

#include <float.h>

#include "scene/free_bodies.h"
#include "scene/rounding.h"
#include "segment/driven_friction.h"
#include "segment/scene_output.h"

#if SCENE_ANY_TURNING

/* How closely a panel and its two halves must agree, relative to what they are summed up of. The halves are a
 * thousand times better. */
static const double PANELS_AGREE = 1e-12;
/* The same relative to the whole span: kinks and jumps of the law are not located, they end in panels so
 * short that this is all they are. */
static const double KINKS_AGREE = 1e-14;

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
            driven_margin_at(&s->c, *after, at_end ? panel->spring : panel->node[i].spring);
        if (driven_margin_is_below(margin, floor)) {
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
        const struct driven_margin margin = driven_margin_at(&s->c, middle, panel->spring);
        if (driven_margin_is_below(margin, floor)) {
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
    const double floor = driven_margin_at(&s->c, left->from, s->total.spring).value;
    if (!finds_event(s, left, floor, &before, &after) && !finds_event(s, right, floor, &before, &after)) {
        return false;
    }
    if (!panel_to_event(s, left->from, before, after, floor, &panel)) {
        return false;
    }
    add_driven_panel(s, &panel);
    const struct driven_margin margin = driven_margin_at(&s->c, panel.to, s->total.spring);
    driven_take_event(&s->c, panel.to, s->total.spring, margin.event);
    s->total.spring = driven_spring(s->c.q, s->c.contact);
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

bool driven_integrate(struct driven_span *s, double from, double end)
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
        if (!made) { /* one rounding of the clock, in which no force adds up to anything */
            clock = to;
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

#endif
