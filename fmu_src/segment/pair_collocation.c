#include "segment/pair_collocation.h"

static void add_force(const struct contact_pair *from, struct pair_sample *sample)
{
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_FORCE][i] =
            contact_linear_force(from->coefficients, sample->of[PAIR_GAP][i], sample->of[PAIR_GAP_RATE][i]);
    }
}

/* Spring and dashpot forces nearly cancel: the force from the acceleration that it causes. */
static void add_overdamped_force(const struct pair_collocation *p, double s, struct pair_sample *sample)
{
    const double factor = p->from->shape.side * p->from->reduced_mass / (p->step.half * p->step.half);
    double push[3];
    collocation_overdamped_push(&p->step, s, push);
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_FORCE][i] = factor * push[i];
    }
}

static void fill_sample(const struct pair_collocation *p, const double x[4], double s,
                        struct pair_sample *sample)
{
    const double side = p->from->shape.side;
    const double per_time = side / p->step.half;
    double normal_mismatch[3] = {0.0, 0.0, 0.0};
    if (p->step.from.has_mismatch) {
        collocation_mismatch(&p->step, s, normal_mismatch);
    }
    for (int i = 0; i < 3; ++i) {
        sample->of[PAIR_GAP][i] = side * x[i];
        sample->of[PAIR_GAP_RATE][i] = per_time * (x[i + 1] + normal_mismatch[i]);
    }
#if SCENE_ANY_CAPS
    if (p->step.from.at_rim) {
        collocation_edges(&p->step, s, x, sample->of[PAIR_RADIAL], sample->of[PAIR_AXIAL]);
    }
#endif
    if (p->step.kind == COLLOCATION_OVERDAMPED) {
        add_overdamped_force(p, s, sample);
    } else {
        add_force(p->from, sample);
    }
}

void pair_collocation_sample(const void *pair_collocation, double s, struct pair_sample *sample)
{
    const struct pair_collocation *p = pair_collocation;
    double x[4];
    collocation_deviation(&p->step, s, x);
    fill_sample(p, x, s, sample);
}

void pair_collocation_sample_node(const struct pair_collocation *p, int node, struct pair_sample *sample)
{
    double x[4];
    collocation_deviation_at_node(&p->step, node, x);
    fill_sample(p, x, 1.0 + p->step.nodes->node[node], sample);
}

/* y, its rate and its force all solve the oscillator's equation. */
void pair_free_oscillation(const struct pair_collocation *p, enum pair_quantity quantity, double *start,
                           double *rate)
{
    const struct oscillator *o = &p->step.result.oscillator;
    const double half = p->step.half;
    const double y = p->step.result.y;
    const double y_rate = p->step.result.y_rate;
    const double bend = -o->damping_rate * y_rate - o->omega2 * y;
    const double k = p->from->coefficients.k;
    const double c = p->from->coefficients.c / half;
    *start = quantity == PAIR_GAP ? y : quantity == PAIR_GAP_RATE ? y_rate / half : k * y + c * y_rate;
    *rate = quantity == PAIR_GAP ? y_rate : quantity == PAIR_GAP_RATE ? bend / half : k * y_rate + c * bend;
}

struct oscillator_envelope pair_envelope_of(const struct pair_collocation *p, enum pair_quantity quantity)
{
    double start;
    double rate;
    pair_free_oscillation(p, quantity, &start, &rate);
    return oscillator_envelope_of(&p->step.result.oscillator, start, rate);
}

void pair_collocation_sample_averaged(const void *pair_collocation, double s, struct pair_sample *sample)
{
    const struct pair_collocation *p = pair_collocation;
    double x[4];
    collocation_averaged_deviation(&p->step, s, x);
    fill_sample(p, x, s, sample);
}

void pair_lower_bound_from(const struct pair_lower_bound *bound, const struct oscillator_envelope *envelope,
                           double s, const struct pair_sample *slow, double *value, double *slope)
{
    const double still = envelope->decay_rate > 0.0 ? envelope->amplitude * exp(-envelope->decay_rate * s)
                                                    : envelope->amplitude;
    *value = bound->factor * slow->of[bound->quantity][0] + bound->offset - still;
    *slope = bound->factor * slow->of[bound->quantity][1] + envelope->decay_rate * still;
}

void pair_lower_bound_at(const void *pair_lower_bound, double s, double *value, double *slope)
{
    const struct pair_lower_bound *bound = pair_lower_bound;
    const struct oscillator_envelope envelope = pair_envelope_of(bound->of, bound->quantity);
    struct pair_sample slow;
    pair_collocation_sample_averaged(bound->of, s, &slow);
    pair_lower_bound_from(bound, &envelope, s, &slow, value, slope);
}

/* Integrated by parts, so that the oscillation of r' and r'' need not be resolved: (path r)' = path' r + path
 * r', and once more. The remaining integrand is path' or path'', linear in time, times r = c - c(0) - (C -
 * C(0)). */
static double work_by_parts(const struct pair_collocation *p, const struct pair_work *work,
                            const struct pair_change *change, double s)
{
    const double t = change->time;
    const struct vec3 path = path_at(work->path, 3, t);
    const struct vec3 slope = vec3_axpy(work->path[1], 2.0 * t, work->path[2]);
    struct vec3 weight[2] = {work->path[1], vec3_scale(2.0, work->path[2])};
    if (work->order == 0) {
        return 0.0;
    }
    double boundary = vec3_dot(path, change->r);
    double sign = -1.0;
    if (work->order == 2) {
        boundary = vec3_dot(path, change->r_rate) - vec3_dot(slope, change->r);
        sign = 1.0;
        weight[0] = weight[1];
        weight[1] = vec3_make(0.0, 0.0, 0.0);
    }
    if (!(vec3_max_abs(weight[0]) + vec3_max_abs(weight[1]) > 0.0)) {
        return boundary;
    }
    /* C - C(0) has degree four, the weight one: five Gauss-Legendre nodes would be more than enough; term by
     * term it is exact. */
    double flown = 0.0;
    double power = t;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = p->felt[i - 1];
        power *= t;
        flown += power * (vec3_dot(weight[0], c) / (i + 1) + t * vec3_dot(weight[1], c) / (i + 2));
    }
    return boundary + sign * (collocation_moment(&p->step, weight, s) - flown);
}

struct pair_change pair_collocation_change(const void *pair_collocation, double s)
{
    const struct pair_collocation *p = pair_collocation;
    const struct contact_pair *from = p->from;
    const struct collocation_change step = collocation_change_at(&p->step, s);
    struct pair_change change = {.time = p->step.half * s, .r = step.moved, .r_rate = step.gained};
    double power = 1.0;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = p->felt[i - 1];
        if (i > 1) {
            change.r_rate = vec3_axpy(change.r_rate, -i * power, c);
        }
        power *= change.time;
        change.r = vec3_axpy(change.r, -power, c);
    }
    change.gap = from->shape.side * step.deviation;
    if (from->coefficients.c > 0.0) {
        change.dissipated = from->reduced_mass * collocation_dissipated(&p->step, s);
    }
    for (int end = 0; end < PAIR_BODIES; ++end) {
        change.work[end] = work_by_parts(p, &from->work[end], &change, s);
    }
    return change;
}
