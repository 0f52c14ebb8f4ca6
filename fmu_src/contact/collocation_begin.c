/* How a collocated step begins: its frame, what acts at the nodes, the first guess. */
#include <float.h>
#include <string.h>

#include "contact/collocation.h"

/* So much of a product with the frame's vectors is rounding. */
static const double FRAME_ROUNDING = 4.0 * DBL_EPSILON;

static struct vec3 in_frame(const struct collocation *p, struct vec3 a)
{
    return vec3_make(vec3_dot(p->frame[0], a), vec3_dot(p->frame[1], a), vec3_dot(p->frame[2], a));
}

/* The direction of `a` across n, where it has one; twice, as the first time leaves rounding of a long `a`. */
static bool direction_across(struct vec3 n, struct vec3 a, struct vec3 *direction)
{
    struct vec3 across = vec3_axpy(a, -vec3_dot(n, a), n);
    if (!(vec3_max_abs(across) > FRAME_ROUNDING * vec3_max_abs(a))) {
        return false;
    }
    across = vec3_scale(1.0 / vec3_norm(across), across);
    across = vec3_axpy(across, -vec3_dot(n, across), n);
    *direction = vec3_scale(1.0 / vec3_norm(across), across);
    return true;
}

static void set_frame(struct collocation *p)
{
    const struct collocation_problem *from = &p->from;
    const struct vec3 n = from->normal;
    struct vec3 along = {0.0, 0.0, 0.0};
    bool found = direction_across(n, from->rate, &along);
    for (int i = 0; i < COLLOCATION_PULL_TERMS && !found; ++i) {
        found = direction_across(n, from->pull[i], &along);
    }
    p->frame[0] = n;
    p->frame[1] = along;
    p->frame[2] = vec3_cross(n, along);
}

/* Whether a vector is in the plane of the first two but for rounding, which is then taken away. */
static bool flatten(struct vec3 *a)
{
    if (fabs(a->z) > FRAME_ROUNDING * (fabs(a->x) + fabs(a->y))) {
        return false;
    }
    a->z = 0.0;
    return true;
}

/* n and H stay: the motion is along the normal and so is the pull. */
static bool is_straight(const struct collocation_problem *from)
{
    double across = vec3_max_abs(vec3_cross(from->normal, from->rate));
    for (int i = 0; i < COLLOCATION_PULL_TERMS; ++i) {
        across = fmax(across, vec3_max_abs(vec3_cross(from->normal, from->pull[i])));
    }
    return !(across > 0.0);
}

static void put_problem_in_frame(struct collocation *p)
{
    p->rate = in_frame(p, p->from.rate);
    p->rate.x = p->from.radial;
    p->planar = flatten(&p->rate);
    for (int i = 0; i < COLLOCATION_PULL_TERMS; ++i) {
        p->pull[i] = in_frame(p, p->from.pull[i]);
        p->planar = flatten(&p->pull[i]) && p->planar;
    }
    for (int i = 0; i < COLLOCATION_LEAD_TERMS && p->from.leads; ++i) {
        p->lead[i] = in_frame(p, p->from.lead[i]);
    }
    p->momentum = vec3_scale(p->distance, vec3_make(0.0, -p->rate.z, p->rate.y));
}

static double load_at_start(const struct collocation *p)
{
    const double lead = p->from.leads ? p->from.damping * p->lead[0].x : 0.0;
    return vec3_dot(p->momentum, p->momentum) / (p->distance * p->distance * p->distance) + p->pull[0].x -
           lead;
}

void collocation_begin(struct collocation *p, const struct collocation_problem *from, double step,
                       enum collocation_kind kind, const struct lobatto *nodes)
{
    p->from = *from;
    p->nodes = nodes;
    p->kind = kind;
    p->half = 0.5 * step;
    p->distance = from->reach + from->excess;
    p->straight = is_straight(from);
    p->turned = p->spun = vec3_make(0.0, 0.0, 0.0);
    p->sweeps = 0;
    set_frame(p);
    put_problem_in_frame(p);
    p->oscillator = (struct oscillator){from->square * p->half * p->half, from->damping * p->half};
    memset(p->slow, 0, sizeof p->slow);
    memset(p->led, 0, sizeof p->led);
    p->terms = 1;
    p->slow[0] = kind == COLLOCATION_CREEPING ? from->excess : load_at_start(p) / from->square;
    p->y = from->excess - p->slow[0];
    p->y_rate = p->half * p->rate.x;
}

static struct vec3 polynomial_of_time(const struct vec3 *a, int terms, double t)
{
    struct vec3 sum = a[terms - 1];
    for (int i = terms - 2; i >= 0; --i) {
        sum = vec3_axpy(a[i], t, sum);
    }
    return sum;
}

/* The first guess: x under the load as it begins, n and H to second and first order. */
static void guess(struct collocation *p, double half)
{
    const struct vec3 n = {1.0, 0.0, 0.0};
    const double per_square = 1.0 / (p->distance * p->distance);
    const struct vec3 spin = vec3_scale(p->distance, vec3_cross(n, p->pull[0]));
    const struct vec3 turn = vec3_scale(per_square, vec3_cross(p->momentum, n));
    const struct vec3 bend =
        vec3_scale(0.5 * per_square, vec3_add(vec3_cross(spin, n), vec3_cross(p->momentum, turn)));
    for (int i = 0; i < p->nodes->points; ++i) {
        const double t = half * (1.0 + p->nodes->node[i]);
        row_put_vec3(&p->h, i, vec3_scale(t, spin));
        row_put_vec3(&p->n, i, vec3_scale(t, vec3_axpy(turn, t, bend)));
        p->x[i] = p->slow[0];
    }
}

/* y at the nodes into x, or out of it. */
static void add_oscillation_at_nodes(struct collocation *p, double sign)
{
    for (int i = 0; i < p->nodes->points; ++i) {
        p->x[i] += sign * (p->y * p->y_of_y[i] + p->y_rate * p->y_of_rate[i]);
    }
}

/* What is known goes on to nodes that lie later by a part of the time; x without y. */
static void move_on(struct collocation *p, double part)
{
    add_oscillation_at_nodes(p, -1.0);
    for (int i = 0; i < p->nodes->points && !p->straight; ++i) {
        const double later = part * (1.0 + p->nodes->node[i]);
        p->h.z[i] += later * p->h_rate.z[i];
        p->n.x[i] += later * p->n_rate.x[i];
        p->n.y[i] += later * p->n_rate.y[i];
        if (!p->planar) {
            p->h.x[i] += later * p->h_rate.x[i];
            p->h.y[i] += later * p->h_rate.y[i];
            p->n.z[i] += later * p->n_rate.z[i];
        }
    }
}

static void fill_nodes(struct collocation *p)
{
    const bool steady = !p->from.leads && vec3_is_zero(p->pull[1]) && vec3_is_zero(p->pull[2]);
    for (int i = 0; i < p->nodes->points && steady; ++i) {
        row_put_vec3(&p->pull_at, i, p->pull[0]);
        row_put_vec3(&p->drive_at, i, p->pull[0]);
    }
    for (int i = 0; i < p->nodes->points && !steady; ++i) {
        const double t = p->half * (1.0 + p->nodes->node[i]);
        const struct vec3 pull = polynomial_of_time(p->pull, COLLOCATION_PULL_TERMS, t);
        struct vec3 drive = pull;
        if (p->from.leads) {
            const struct vec3 lead = polynomial_of_time(p->lead, COLLOCATION_LEAD_TERMS, t);
            row_put_vec3(&p->lead_at, i, vec3_scale(p->half, lead));
            drive = vec3_axpy(pull, -p->from.damping, lead);
        }
        row_put_vec3(&p->pull_at, i, pull);
        row_put_vec3(&p->drive_at, i, drive);
    }
}

void collocation_size(struct collocation *p, double step)
{
    const bool resolved = p->kind == COLLOCATION_RESOLVED;
    const double longer = 0.5 * step / p->half;
    if (p->sweeps == 0) {
        guess(p, 0.5 * step);
    } else if (resolved) {
        move_on(p, longer - 1.0);
    }
    p->y_rate *= longer;
    p->half = 0.5 * step;
    p->terms = p->nodes->points;
    p->oscillator = (struct oscillator){p->from.square * p->half * p->half, p->from.damping * p->half};
    fill_nodes(p);
    if (resolved) {
        oscillator_basis_about_one(&p->oscillator, p->nodes->node, p->nodes->points, p->y_of_y, p->y_of_rate);
        add_oscillation_at_nodes(p, 1.0);
    }
}
