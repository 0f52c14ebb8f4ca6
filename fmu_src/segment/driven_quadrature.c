#include "segment/driven_quadrature.h"

#include <float.h>

#include "math/root.h"
#include "scene/free_bodies.h"
#include "scene/rounding.h"
#include "segment/driven_regime.h"
#include "segment/scene_output.h"

#if SCENE_ANY_TURNING

/* How closely a panel and its two halves must agree, relative to what they are summed up of. The halves are a
 * thousand times better. */
static const double PANELS_AGREE = 1e-12;
/* The same relative to the whole span: where the normal reverses in the centre the force jumps, which is not
 * located but ends in panels so short that this is all they are. */
static const double JUMPS_AGREE = 1e-14;
/* How closely the integral of the law's event function must agree: so that its changes of sign show at the
 * nodes. */
static const double EVENTS_AGREE = 1e-6;

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

/* cos of the largest rotation of n between an end of a panel and the node next to it, 0.5 rad. Where it turns
 * further it may reverse, in the centre. */
static const double LARGEST_TURN_COSINE = 0.88;

#if SCENE_ANY_FRICTION
/* In characteristic slip velocities: so fast a slip leaves nothing of exp(-|v_t|/v_0); the change of the slip
 * within which an interpolation follows that; so slow that friction is proportional to the slip. */
static const double SATURATED = 40.0, FOLLOWED = 2.0, PROPORTIONAL = 1e-6;

/* Regularized friction reverses with the slip within a layer that ends with exp(-|v_t|/v_0) and has a corner
 * of its slope in the middle. */
static bool sees_layer(const struct driven_span *s, struct vec3 slip, struct vec3 next)
{
    const double unit = scene_friction_law(s->c.v, s->c.q, s->c.contact).slip_velocity;
    const double speed = vec3_norm(slip);
    if (s->elastic || !contact_rubs(s->c.v, s->c.contact)) {
        return true;
    }
    if (vec3_dot(slip, next) < 0.0) {
        return fmax(speed, vec3_norm(next)) <= PROPORTIONAL * unit;
    }
    return speed > SATURATED * unit || vec3_norm(vec3_sub(next, slip)) <= FOLLOWED * unit;
}
#else
static bool sees_layer(const struct driven_span *s, struct vec3 slip, struct vec3 next)
{
    (void)s, (void)slip, (void)next;
    return true;
}
#endif

/* Whether the nodes see what may happen on the way from an end of a panel to the first of them. Where the
 * bodies are concentric, to rounding, n has no meaning. */
static bool sees_end(const struct driven_span *s, const struct driven_panel *panel, double end, int node)
{
    struct scene_instant at;
    const int j = s->c.contact;
    driven_instant(&s->c, end, panel->spring, &at);
    const struct contact_geometry *g = &at.geometry[j];
    const bool has_direction = !g->degenerate && fabs(g->distance) > rounding_of_gap(s->c.v, &at, j);
    const double cosine = vec3_dot(g->normal, panel->node[node].normal);
    return (!has_direction || cosine > LARGEST_TURN_COSINE) &&
           sees_layer(s, at.turning.slip[j], panel->node[node].slip);
}

static bool sees_ends(const struct driven_span *s, const struct driven_panel *panel)
{
    return sees_end(s, panel, panel->from, 0) && sees_end(s, panel, panel->to, GAUSS_NODES - 1);
}

static bool panels_agree(const struct driven_span *s, const struct driven_panel *whole,
                         const struct driven_panel *left, const struct driven_panel *right)
{
    const double noise = rounding_part(s, whole);
    for (int k = 0; k < DRIVEN_TERMS; ++k) {
        const double size = left->size[k] + right->size[k];
        const double part = k == DRIVEN_EVENT ? EVENTS_AGREE : PANELS_AGREE + noise;
        const double allowed = part * size + JUMPS_AGREE * s->total.size[k] + DBL_MIN;
        if (!(fabs(left->sum[k] + right->sum[k] - whole->sum[k]) <= allowed)) {
            return false;
        }
    }
    const double way = vec3_norm(right->spring) + left->slipped + right->slipped;
    return (!s->elastic ||
            vec3_norm(vec3_sub(right->spring, whole->spring)) <= 4.0 * PANELS_AGREE * way + DBL_MIN) &&
           sees_ends(s, left) && sees_ends(s, right);
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
    struct scene_output output = {.values = s->c.v, .state = s->c.q, .contact = s->c.contact};
    scene_output_note_peaks(&output, panel->from, panel->to, PANEL_PARTS,
                            &s->c.q->contact[s->c.contact].peaks);
    driven_instant(&s->c, panel->to, panel->spring, &at);
    const struct vec3 n = at.geometry[s->c.contact].normal;
    s->total.spring = vec3_axpy(panel->spring, -vec3_dot(panel->spring, n), n);
    counter_add(&s->c.q->counters.force_evaluations, GAUSS_NODES);
}

/* A place of a panel, and the event functions there. */
struct driven_place {
    double clock;
    struct driven_margins at;
};

/* Of both halves of a panel: the start, the nodes and the end. */
enum { PANEL_PLACES = 2 * GAUSS_NODES + 2 };

static void put_place(const struct driven_span *s, double clock, struct vec3 spring,
                      struct driven_place *place)
{
    place->clock = clock;
    driven_margins_at(&s->c, clock, spring, &place->at);
}

/* An event function without a spring, for root_lowest. */
struct driven_dip {
    const struct driven_span *span;
    int event;
};

static void driven_event_at(const void *data, double clock, double *value, double *slope)
{
    const struct driven_dip *dip = data;
    struct driven_margins at;
    driven_margins_at(&dip->span->c, clock, dip->span->total.spring, &at);
    *value = at.value[dip->event];
    *slope = (double)NAN; /* not needed */
}

/* Whether one of those falls below zero between three places, and to where from the first. */
static bool finds_dip(const struct driven_span *s, const struct driven_place place[3], double *after)
{
    for (int event = 0; event < DRIVEN_STICK; ++event) {
        const struct driven_dip dip = {s, event};
        struct root_place of[3];
        for (int i = 0; i < 3; ++i) {
            of[i] = (struct root_place){place[i].clock, place[i].at.value[event]};
        }
        if (root_may_dip(of)) {
            struct driven_margins low;
            *after = root_lowest(driven_event_at, &dip, of);
            driven_margins_at(&s->c, *after, s->total.spring, &low);
            if (low.value[event] < -low.noise[event]) {
                return true;
            }
        }
    }
    return false;
}

/* The first two places of both halves of a panel between which a regime ends; false: none. */
static bool finds_event(const struct driven_span *s, const struct driven_panel *left,
                        const struct driven_panel *right, struct driven_place *start, double *before,
                        double *after)
{
    struct driven_place place[PANEL_PLACES];
    int count = 1;
    put_place(s, left->from, s->total.spring, &place[0]);
    for (int i = 0; i < 2 * GAUSS_NODES; ++i) {
        const struct driven_panel *half = i < GAUSS_NODES ? left : right;
        put_place(s, half->node[i % GAUSS_NODES].clock, half->node[i % GAUSS_NODES].spring, &place[count++]);
    }
    put_place(s, right->to, right->spring, &place[count++]);
    *start = place[0];
    for (int i = 1; i < count; ++i) {
        *before = place[i - 1].clock;
        *after = place[i].clock;
        if (driven_event_passed(&place[i].at, &start->at) != DRIVEN_EVENTS) {
            return true;
        }
        if (i + 1 < count && finds_dip(s, &place[i - 1], after)) {
            return true;
        }
    }
    return false;
}

/* Halves the bracket of an event that is between `before` and `after` until the clock is known to rounding;
 * the panel that ends there, just past the event, and which event it is. */
static bool panel_to_event(const struct driven_span *s, const struct driven_place *start, double before,
                           double after, struct driven_panel *panel, enum driven_event *event)
{
    const struct vec3 first = s->total.spring;
    struct driven_margins now;
    panel->spring = first;
    while (after - before > 4.0 * DBL_EPSILON * fabs(after)) {
        const double middle = 0.5 * (before + after);
        if (!(middle > before && middle < after) ||
            (s->elastic && !make_panel(s, start->clock, middle, first, panel))) {
            break;
        }
        driven_margins_at(&s->c, middle, panel->spring, &now);
        *(driven_event_passed(&now, &start->at) != DRIVEN_EVENTS ? &after : &before) = middle;
    }
    if (!make_panel(s, start->clock, after, first, panel)) {
        return false;
    }
    driven_margins_at(&s->c, after, panel->spring, &now);
    *event = driven_event_passed(&now, &start->at);
    return *event != DRIVEN_EVENTS;
}

/* Where an event ends a regime in one of two panels: integrates up to it and changes the regime. Returns
 * whether there is one. */
static bool passes_event(struct driven_span *s, const struct driven_panel *left,
                         const struct driven_panel *right, double *clock)
{
    struct driven_panel panel;
    struct driven_place start;
    double before;
    double after;
    enum driven_event event;
    const struct contact_law law = scene_contact_law(s->c.v, s->c.q, s->c.contact);
    if (!(contact_has_events(&law) || contact_rubs(s->c.v, s->c.contact)) ||
        !finds_event(s, left, right, &start, &before, &after) ||
        !panel_to_event(s, &start, before, after, &panel, &event)) {
        return false;
    }
    add_driven_panel(s, &panel);
    driven_take_event(&s->c, panel.to, s->total.spring, event);
    s->total.spring = driven_spring(s->c.q, s->c.contact);
    counter_add(&s->c.q->counters.events, 1);
    *clock = panel.to;
    return true;
}

bool driven_integrate(struct driven_span *s, double from, double end)
{
    double clock = from;
    double width = end - from;
    while (clock < end) {
        *s->panels -= s->panel_cost;
        if (*s->panels < 0) {
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
        if (divides && (!made || !panels_agree(s, &whole, &left, &right))) {
            width = 0.5 * (to - clock);
            continue;
        }
        width *= 2.0;
        if (made && divides && passes_event(s, &left, &right, &clock)) {
            continue;
        }
        if (made) { /* else one rounding of the clock, in which no force adds up to anything */
            add_driven_panel(s, &left);
            add_driven_panel(s, &right);
        }
        clock = to;
    }
    return true;
}

#endif
