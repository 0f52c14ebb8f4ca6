#include <float.h>

#include "flight/relative_path.h"
#include "flight/zone_path.h"
#include "math/compiler.h"
#include "math/nodes.h"
#include "prescribed/driven.h"
#include "prescribed/given.h"
#include "scene/dense_output.h"
#include "scene/evaluate.h"
#include "scene/present.h"

/*
 * The force of a contact while all motion is given, between two places of a communication step next to each
 * other at which its law may change: a quadrature whose panels are halved until halves and whole agree.
 */

/* So many panels of a step may be halved. A pass of the centres at a distance of 1e-16 takes about a hundred;
 * a step has at most some dozen such places. */
enum { HALVINGS = 4096 };

/* One contact over a step, s in [0, 1]. */
struct given_step {
    const struct scene_values *v;
    struct scene_state *q; /* its regime is the one that is looked at */
    int contact;
    double length; /* of the step [s] */
    int halvings;  /* that are left */
};

static struct contact_state *given_contact(const struct given_step *step);

/* At s; bodies and contacts. */
static void given_instant(const struct given_step *step, double s, struct scene_instant *at);

/* The regime, the mean force and the peaks between two places next to each other at which the law may change,
 * or the gap has an extreme. */
static void given_integrate_between(struct given_step *step, double from, double to);

/* How closely a panel and its two halves must agree, relative to the size of what is integrated. The rule is
 * of degree nine, so the halves are a thousand times better than the panel: rounding is all that is left. */
static const double AGREEMENT = 1e-13;

static struct contact_state *given_contact(const struct given_step *step)
{
    return &step->q->contact[step->contact];
}

/* Called from many places: one copy is enough. */
CONTACT_NOINLINE void given_instant(const struct given_step *step, double s, struct scene_instant *at)
{
    scene_evaluate(step->v, step->q, step->q->clock + s * step->length, 0, at);
}

/* The quadrature resolves a panel by five nodes each half: no quantity has two extrema within a quarter. */
enum { PARTS = 4 };

static void note_peaks_between(const struct given_step *step, double from, double to)
{
    const double start = step->q->clock;
    struct scene_output output = {.values = step->v, .state = step->q, .contact = step->contact};
    scene_output_note_peaks(&output, start + from * step->length, start + to * step->length, PARTS,
                            &given_contact(step)->peaks);
}

/* The integrals of the force over a panel, of its torque on the destination and of its size. */
struct panel {
    struct vec3 sum, torque;
    double size;
};

/* As in prescribed.c: near the touch Hertz's force goes with the power 3/2 of time. */
static const double SHALLOW = 0.1;

static bool wants_grading(const struct given_step *step, double from, double to)
{
    const double places[3] = {from, 0.5 * (from + to), to};
    double gap[3];
    if (!scene_is_hertz(step->v, step->contact)) {
        return false;
    }
    for (int i = 0; i < 3; ++i) {
        struct scene_instant at;
        given_instant(step, places[i], &at);
        gap[i] = at.geometry[step->contact].gap;
    }
    return fmax(gap[0], gap[2]) > SHALLOW * gap[1];
}

CONTACT_NOINLINE static struct panel panel_of(const struct given_step *step, double from, double to)
{
    struct panel panel = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0};
    const double half = 0.5 * (to - from);
    const bool graded = wants_grading(step, from, to);
    for (int i = 0; i < GAUSS_NODES; ++i) {
        struct scene_instant at;
        const struct gauss_place place = gauss_place(i, graded);
        const double weight = half * GAUSS_WEIGHT[i] * place.factor;
        given_instant(step, from + half * place.at, &at);
        panel.sum = vec3_axpy(panel.sum, weight, at.source_force[step->contact]);
        if (SCENE_HAS_TORQUES) {
            panel.torque = vec3_axpy(panel.torque, weight, scene_torque_of_force(&at, step->contact));
        }
        panel.size += weight * fabs(at.normal_force[step->contact]);
    }
    return panel;
}

/* Near the centre n may be rounding at one end of a panel: the bound of the other then holds for nearly all
 * of it. */
static double rounding_between(const struct given_step *step, double from, double to)
{
    struct scene_instant ends[2];
    given_instant(step, from, &ends[0]);
    given_instant(step, to, &ends[1]);
    return (to - from) * fmin(rounding_of_force(step->v, step->q, &ends[0], step->contact),
                              rounding_of_force(step->v, step->q, &ends[1], step->contact));
}

static bool agree(const struct given_step *step, const struct panel *whole, const struct panel *left,
                  const struct panel *right, double from, double to)
{
    const struct vec3 difference = vec3_sub(vec3_add(left->sum, right->sum), whole->sum);
    const double allowed = AGREEMENT * (left->size + right->size) + rounding_between(step, from, to);
    return vec3_max_abs(difference) <= allowed + DBL_MIN;
}

/* Within one regime. */
static void integrate_smooth(struct given_step *step, double from, double end)
{
    struct vec3 *mean = &given_contact(step)->mean_force;
    double width = end - from;
    while (from < end) {
        const double to = from + width < end ? from + width : end;
        const double middle = 0.5 * (from + to);
        const struct panel whole = panel_of(step, from, to);
        const struct panel left = panel_of(step, from, middle);
        const struct panel right = panel_of(step, middle, to);
        const bool divides = middle > from && middle < to && step->halvings > 0;
        if (divides && !agree(step, &whole, &left, &right, from, to)) {
            width = 0.5 * (to - from);
            step->halvings -= 1;
            continue;
        }
        *mean = vec3_add(*mean, vec3_add(left.sum, right.sum));
        if (SCENE_HAS_TORQUES) {
            struct vec3 *torque = &given_contact(step)->torques.destination_mean;
            *torque = vec3_add(*torque, vec3_add(left.torque, right.torque));
        }
        note_peaks_between(step, from, to);
        from = to;
        width *= 2.0;
    }
}

static void given_integrate_between(struct given_step *step, double from, double to)
{
    struct scene_instant at;
    given_instant(step, 0.5 * (from + to), &at);
    const enum contact_regime regime = scene_regime(step->v, step->q, &at, step->contact);
    given_contact(step)->regime = (int32_t)regime;
    if (regime == REGIME_APART) {
        return;
    }
    if (regime != REGIME_SEPARATING) {
        integrate_smooth(step, from, to);
    } else {
        note_peaks_between(step, from, to);
    }
}

/* The first of ascending places after one, 1 where there is none. */
static double first_after(const double *places, int count, double from)
{
    for (int i = 0; i < count; ++i) {
        if (places[i] > from) {
            return places[i];
        }
    }
    return 1.0;
}

/* Whether the bodies begin to touch between two such places, which gives the law its damping. */
static bool takes_damping(struct given_step *step, double from, double to)
{
    if (!scene_damps_by_onset(step->v, step->contact) ||
        given_contact(step)->regime != (int32_t)REGIME_APART) {
        return false;
    }
    struct scene_instant at;
    given_instant(step, 0.5 * (from + to), &at);
    const enum contact_regime next = scene_regime(step->v, step->q, &at, step->contact);
    given_instant(step, from, &at);
    given_contact(step)->regime = (int32_t)onset_note(step->v, step->q, &at, step->contact, next);
    return next != REGIME_APART;
}

/* A part of the step, within which the shape is smooth and has this path. */
static void integrate(struct given_step *step, const struct contact_shape *shape,
                      const struct relative_path *path, double from, double end)
{
    const struct extremes extremes = extremes_of(path);
    double events[MAX_CANDIDATES];
    int count = -1; /* the law's are not known */
    while (from < end) {
        if (count < 0) {
            const struct contact_law law = scene_contact_law(step->v, step->q, step->contact);
            count = candidates_of_all(path, &extremes, shape, &law, events);
        }
        const double next =
            fmin(first_after(events, count, from), first_after(extremes.at, extremes.count, from));
        const double to = fmin(next, end);
        if (takes_damping(step, from, to)) {
            count = -1;
        } else {
            given_integrate_between(step, from, to);
            from = to;
        }
    }
}

/* A path changes the regime at a rim a dozen times at most; what changes more often is rounding, and its
 * law is then looked at in the middle of what is left. */
enum { MOST_RIM_CHANGES = 100 };

/* A part of the step at a rim, from change to change of the regime. */
static void integrate_at_rim(struct given_step *step, const struct contact_shape *shape,
                             const struct separation_path *path, double from, double end)
{
    const double soon = 1e-9; /* of the part: a place right after its start */
    for (int changes = 0; from < end; ++changes) {
        struct scene_instant at;
        const struct contact_law law = scene_contact_law(step->v, step->q, step->contact);
        given_instant(step, from + soon * (end - from), &at);
        const enum contact_regime present = scene_regime(step->v, step->q, &at, step->contact);
        const struct rim_change change =
            rim_first_change(shape, &law, path, 0.0, present, from * step->length, end * step->length);
        const double to = changes < MOST_RIM_CHANGES ? fmin(change.time / step->length, end) : end;
        if (!(to > from)) {
            from += soon * (end - from);
        } else if (!takes_damping(step, from, to)) {
            given_integrate_between(step, from, to);
            from = to;
        }
    }
}

/* From zone to zone of a capped cylinder. */
static void integrate_capped(struct given_step *step, const struct contact_shape *whole,
                             const struct separation_path *path)
{
    double edges[ZONE_EDGES];
    const int count = zone_path_edges(&whole->solid, path, step->length, edges);
    for (double from = 0.0; from < 1.0;) {
        const double to = first_after(edges, count, from);
        struct scene_instant at;
        given_instant(step, zone_path_between(&whole->solid, path, step->length, from, to), &at);
        const struct contact_shape shape = scene_shape_met(step->v, step->q, &at, step->contact);
        if (contact_is_rim(&shape)) {
            integrate_at_rim(step, &shape, path, from, to);
        } else {
            const struct contact_geometry now =
                contact_geometry_at(&shape, path->c[0], path->w[0], vec3_make(0.0, 0.0, 0.0));
            const struct relative_path along = relative_path_make(&shape, path, now.gap, step->length);
            integrate(step, &shape, &along, from, to);
        }
        from = to;
    }
}

static bool is_steady(const struct separation_path *path)
{
    return path_is_steady(path->c, SEPARATION_DEGREE + 1) && path_is_steady(path->w, SEPARATION_DEGREE);
}

/* On the destination, where nothing turns or rubs. */
static void put_mean_torque(struct contact_state *state, struct vec3 torque)
{
    if (SCENE_HAS_TORQUES) {
        state->torques.destination_mean = torque;
    }
}

void given_force_settle(const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    scene_kinematics_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (scene_turns(v)) {
            driven_turning_settle(v, q, j);
            continue;
        }
        q->contact[j].regime = (int32_t)onset_note(v, q, &at, j, scene_regime(v, q, &at, j));
    }
}

/* The force of an instant that lasts; returns it on the source. */
static struct vec3 note_present(const struct scene_values *v, struct scene_state *q, struct scene_instant *at,
                                int contact)
{
    struct contact_state *state = &q->contact[contact];
    state->peaks = (struct contact_peaks){0.0, 0.0};
    state->mean_force = vec3_make(0.0, 0.0, 0.0);
    put_mean_torque(state, state->mean_force);
    if (state->regime == REGIME_APART) {
        return vec3_make(0.0, 0.0, 0.0);
    }
    scene_forces(v, q, q->clock, at);
    contact_peaks_note(&state->peaks, at->normal_force[contact], -at->geometry[contact].gap);
    return at->source_force[contact];
}

/* Where something turns or rubs. */
static bool given_turning_over(const struct scene_values *v, struct scene_state *q, double length)
{
    const struct scene_state before = *q;
    given_force_begin(v, q);
    if (driven_turning_over(v, q, length, DRIVEN_PANELS)) {
        return true;
    }
    *q = before;
    return false;
}

bool given_force_over(const struct scene_values *v, struct scene_state *q, double length)
{
    if (scene_turns(v)) {
        return given_turning_over(v, q, length);
    }
    given_force_settle(v, q);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        struct scene_instant at;
        scene_kinematics_now(v, q, &at);
        const struct separation_path separation = separation_path_of(v, q, &at, q->clock, j);
        const struct vec3 present = note_present(v, q, &at, j);
        if (is_steady(&separation)) {
            q->contact[j].mean_force = present;
            at.source_force[j] = present;
            put_mean_torque(&q->contact[j], scene_torque_of_force(&at, j));
            continue;
        }
        const struct contact_shape shape = scene_contact_shape(v, q, j);
        struct given_step step = {v, q, j, length, HALVINGS};
        if (contact_is_capped(&shape)) {
            q->contact[j].peaks = (struct contact_peaks){0.0, 0.0};
            integrate_capped(&step, &shape, &separation);
            continue;
        }
        const struct relative_path path = relative_path_make(&shape, &separation, at.geometry[j].gap, length);
        if (candidates_least_gap(&path) < 0.0) {
            q->contact[j].peaks = (struct contact_peaks){0.0, 0.0};
            integrate(&step, &shape, &path, 0.0, 1.0);
        }
    }
    return true;
}

void given_force_begin(const struct scene_values *v, struct scene_state *q)
{
    struct scene_instant at;
    given_force_settle(v, q);
    scene_kinematics_now(v, q, &at);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        (void)note_present(v, q, &at, j);
    }
}
