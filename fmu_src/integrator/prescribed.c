#include "integrator/advance.h"

#include <float.h>

#include "integrator/prediction.h"
#include "math/nodes.h"
#include "scene/dense_output.h"
#include "scene/evaluate.h"
#include "scene/present.h"

/* Impulses, dissipated energy, external work; after these, which decide on the panels, impulses of the torque
 * on a destination that has an axis. */
enum { DECIDING = 3 * SCENE_CONTACTS + 2, TERMS = DECIDING + (SCENE_HAS_TORQUES ? 3 * SCENE_CONTACTS : 0) };

/* Over a panel, and how large their integrands are. */
struct panel {
    double sum[TERMS];
    double size[TERMS];
};

static bool is_driven(const struct scene_values *v, const struct scene_state *q, int contact)
{
    return contact_is_driven(v, contact) && q->contact[contact].regime != REGIME_APART;
}

static void powers(const struct scene_values *v, const struct scene_state *q, double clock, double out[TERMS])
{
    struct scene_instant at;
    scene_evaluate(v, q, clock, q->body, &at);
    for (int k = 0; k < TERMS; ++k) {
        out[k] = 0.0;
    }
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (is_driven(v, q, j)) {
            out[3 * j] = at.source_force[j].x;
            out[3 * j + 1] = at.source_force[j].y;
            out[3 * j + 2] = at.source_force[j].z;
            out[DECIDING - 2] += energy_dissipated_power_of(v, q, &at, j);
            out[DECIDING - 1] += scene_driving_power(v, &at, j);
        }
        if (TERMS > DECIDING && is_driven(v, q, j)) {
            const struct vec3 torque = scene_torque_of_force(&at, j);
            out[DECIDING + 3 * j] = torque.x;
            out[DECIDING + 3 * j + 1] = torque.y;
            out[DECIDING + 3 * j + 2] = torque.z;
        }
    }
}

/* Near the touch Hertz's force goes with the power 3/2 of time: a panel at one end of which the depth is less
 * than this part of the depth in its middle is graded (nodes.h). Elsewhere equal steps converge faster. */
static const double SHALLOW = 0.1;

static bool is_shallow(const struct scene_values *v, const struct scene_state *q, double clock, double middle,
                       int contact)
{
    struct scene_instant at[2];
    scene_evaluate(v, q, clock, q->body, &at[0]);
    scene_evaluate(v, q, middle, q->body, &at[1]);
    return at[0].geometry[contact].gap > SHALLOW * at[1].geometry[contact].gap;
}

static bool wants_grading(const struct scene_values *v, const struct scene_state *q, double from, double to)
{
    for (int j = 0; SCENE_ANY_HERTZ && j < SCENE_CONTACTS; ++j) {
        const double middle = 0.5 * (from + to);
        if (is_driven(v, q, j) && scene_is_hertz(v, j) &&
            (is_shallow(v, q, from, middle, j) || is_shallow(v, q, to, middle, j))) {
            return true;
        }
    }
    return false;
}

static struct panel integrate(const struct scene_values *v, struct scene_state *q, double from, double to)
{
    struct panel result = {{0.0}, {0.0}};
    const double half = 0.5 * (to - from);
    const bool graded = wants_grading(v, q, from, to);
    for (int i = 0; i < GAUSS_NODES; ++i) {
        double value[TERMS];
        const struct gauss_place place = gauss_place(i, graded);
        const double weight = half * GAUSS_WEIGHT[i] * place.factor;
        powers(v, q, from + half * place.at, value);
        for (int k = 0; k < TERMS; ++k) {
            result.sum[k] += weight * value[k];
            result.size[k] += weight * fabs(value[k]);
        }
    }
    counter_add(&q->counters.force_evaluations, GAUSS_NODES);
    return result;
}

/* No agreement can be asked for below. */
static double force_rounding(const struct scene_values *v, const struct scene_state *q,
                             const struct scene_instant *at)
{
    double noise = 0.0;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        noise += is_driven(v, q, j) ? rounding_of_force(v, q, at, j) : 0.0;
    }
    return noise;
}

static double largest_speed(const struct scene_values *v, const struct scene_instant *at)
{
    double speed = 0.0;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        speed = body_is_prescribed(v, i) ? fmax(speed, vec3_norm(at->velocity[i])) : speed;
    }
    return speed;
}

/* `at`: the instants at both ends. Near the centre n may be rounding at one of them; the error bound of the
 * other then holds for nearly all of the panel. */
static bool agree(const struct scene_values *v, const struct scene_state *q, const struct panel *whole,
                  const struct panel *left, const struct panel *right, const struct scene_instant at[2],
                  double width)
{
    const double noise = width * fmin(force_rounding(v, q, &at[0]), force_rounding(v, q, &at[1]));
    const double speed = fmax(largest_speed(v, &at[0]), largest_speed(v, &at[1]));
    const double tolerance = solver_relative_tolerance(v);
    for (int k = 0; k < DECIDING; ++k) {
        const double difference = fabs(left->sum[k] + right->sum[k] - whole->sum[k]);
        const double floor = k < DECIDING - 2 ? noise : noise * 2.0 * speed;
        if (!(difference <= tolerance * (left->size[k] + right->size[k]) + floor + DBL_MIN)) {
            return false;
        }
    }
    return true;
}

static bool has_direction(const struct scene_values *v, const struct scene_instant *at, int contact)
{
    const struct contact_geometry *g = &at->geometry[contact];
    if (body_shape(contact_destination(contact)) == SHAPE_PLANE) {
        return true;
    }
    return !g->degenerate && g->distance > rounding_of_gap(v, at, contact);
}

/* cos of the largest rotation of n over a panel, 0.5 rad, which five nodes resolve. Without it a panel could
 * end just beyond the closest approach of the centres, where n reverses between the nodes. A panel that
 * begins or ends in the centre, where n has no meaning, lies on one side of it. */
static const double LARGEST_ANGLE_COSINE = 0.88;

static bool normal_turns_little(const struct scene_values *v, const struct scene_state *q,
                                const struct scene_instant at[2])
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (is_driven(v, q, j) && has_direction(v, &at[0], j) && has_direction(v, &at[1], j) &&
            vec3_dot(at[0].geometry[j].normal, at[1].geometry[j].normal) < LARGEST_ANGLE_COSINE) {
            return false;
        }
    }
    return true;
}

static void add_panel(struct scene_state *q, const struct panel *panel)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const double *sum = panel->sum + 3 * j;
        q->contact[j].physics.impulse =
            vec3_add(q->contact[j].physics.impulse, vec3_make(sum[0], sum[1], sum[2]));
        if (SCENE_HAS_TORQUES) {
            const double *torque = panel->sum + DECIDING + 3 * j;
            q->contact[j].torques.destination_impulse = vec3_add(q->contact[j].torques.destination_impulse,
                                                                 vec3_make(torque[0], torque[1], torque[2]));
        }
    }
    q->dissipated += panel->sum[DECIDING - 2];
    q->external_work += panel->sum[DECIDING - 1];
}

/* The quadrature resolves a panel by five nodes each half: no quantity has two extrema within a quarter. */
enum { PARTS = 4 };

static void note_peaks_between(const struct scene_values *v, struct scene_state *q, double from, double to)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (is_driven(v, q, j)) {
            struct scene_output output = {.values = v, .state = q, .contact = j};
            scene_output_note_peaks(&output, from, to, PARTS, &q->contact[j].peaks);
            counter_add(&q->counters.force_evaluations, PARTS + 1);
        }
    }
}

static bool any_is_driven(const struct scene_values *v, const struct scene_state *q)
{
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (is_driven(v, q, j)) {
            return true;
        }
    }
    return false;
}

/* How deep they come, whatever the law says meanwhile: a force that is zero has no panels that would show
 * it. */
static void note_depth(const struct scene_values *v, struct scene_state *q, double until)
{
    struct scene_instant at;
    scene_kinematics_now(v, q, &at);
    for (int j = 0; until > q->clock && j < SCENE_CONTACTS; ++j) {
        if (is_driven(v, q, j)) {
            regime_change_note_depth(v, q, &at, j, until);
        }
    }
}

/* So many panels at most between two changes of a regime, some tenths of a second; some dozens are usual. */
static const long MOST_PANELS = 20000;

static double integrate_until(const struct scene_values *v, struct scene_state *q, double end, long *budget)
{
    double clock = q->clock;
    double width = end - clock;
    for (long panels = 0; clock < end; ++panels) {
        if ((*budget)-- <= 0 || panels == MOST_PANELS) {
            return clock;
        }
        const double to = clock + width < end ? clock + width : end;
        const double middle = 0.5 * (clock + to);
        const bool divides = middle > clock && middle < to;
        struct scene_instant at[2];
        scene_evaluate(v, q, clock, q->body, &at[0]);
        scene_evaluate(v, q, to, q->body, &at[1]);
        if (divides && !normal_turns_little(v, q, at)) {
            width *= 0.5;
            continue;
        }
        const struct panel whole = integrate(v, q, clock, to);
        const struct panel left = integrate(v, q, clock, middle);
        const struct panel right = integrate(v, q, middle, to);
        if (divides && !agree(v, q, &whole, &left, &right, at, to - clock)) {
            width *= 0.5;
            continue;
        }
        add_panel(q, &left);
        add_panel(q, &right);
        note_peaks_between(v, q, clock, to);
        clock = to;
        width *= 2.0;
    }
    return clock;
}

double prescribed_integrate(const struct scene_values *v, struct scene_state *q, double end, long *budget)
{
    if (!any_is_driven(v, q)) {
        return end;
    }
    const double reached = integrate_until(v, q, end, budget);
    note_depth(v, q, reached);
    return reached;
}

enum advance_result prescribed_advance(const struct scene_values *v, struct scene_state *q,
                                       struct advance *step)
{
    q->clock = prescribed_integrate(v, q, step->clock_end, &step->budget);
    return q->clock < step->clock_end ? ADVANCE_STEP_LIMIT : ADVANCE_REACHED;
}
