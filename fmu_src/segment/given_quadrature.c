#include "segment/given_quadrature.h"

#include <float.h>

#include "math/compiler.h"
#include "math/gauss.h"
#include "scene/rounding.h"
#include "segment/scene_output.h"

/* How closely a panel and its two halves must agree, relative to the size of what is integrated. The rule is
 * of degree nine, so the halves are a thousand times better than the panel: rounding is all that is left. */
static const double AGREEMENT = 1e-13;

struct contact_state *given_contact(const struct given_step *step)
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
#if SCENE_HAS_TORQUES
        struct vec3 *torque = &given_contact(step)->torques.destination_mean;
        *torque = vec3_add(*torque, vec3_add(left.torque, right.torque));
#endif
        note_peaks_between(step, from, to);
        from = to;
        width *= 2.0;
    }
}

void given_integrate_between(struct given_step *step, double from, double to)
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
