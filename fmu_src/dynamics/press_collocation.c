#include "dynamics/press_collocation.h"

#if SCENE_ANY_FREE

/* A: second derivative of C. E = W - C'. Both across a cylinder's axis. */
static void set_paths(const struct press *p, struct collocation_problem *problem)
{
    for (int i = 0; i < COLLOCATION_PULL_TERMS; ++i) {
        problem->pull[i] = vec3_scale((i + 1) * (i + 2), press_across(p, p->flight.c[i + 2]));
    }
    for (int i = 0; i < COLLOCATION_LEAD_TERMS; ++i) {
        const struct vec3 lead = vec3_axpy(p->flight.w[i], -(i + 1), p->flight.c[i + 1]);
        problem->lead[i] = press_across(p, lead);
        problem->leads = problem->leads || vec3_max_abs(lead) > 0.0;
    }
}

struct press_outlook press_outlook_of(const struct press *p)
{
    struct press_outlook out = {.turning = 0.0};
    struct collocation_problem *problem = &out.problem;
    problem->normal = p->normal;
    problem->rate = press_across(p, p->flight.c[1]);
    problem->reach = contact_reach(&p->shape);
    problem->excess = p->shape.side * p->gap;
    problem->square = p->by.k / p->reduced_mass;
    problem->damping = p->by.c / p->reduced_mass;
    set_paths(p, problem);
    const double d = problem->reach + problem->excess;
    const struct vec3 along = press_along(p, problem->rate);
    const double radial = p->shape.side * press_closing(p);
    problem->radial = radial;
    const double load = vec3_dot(along, along) / d + vec3_dot(p->normal, problem->pull[0]) -
                        problem->damping * vec3_dot(p->normal, problem->lead[0]);
    const struct oscillator oscillator = {problem->square, problem->damping};
    out.distance = d;
    out.rate_along = vec3_norm(along) / d;
    out.turning = out.rate_along + sqrt(vec3_norm(problem->pull[0]) / d);
    out.rates = oscillator_rates_of(&oscillator);
    out.load_depth = -p->shape.side * load / problem->square;
    out.swings = 4.0 * problem->square > problem->damping * problem->damping;
    out.oscillation =
        oscillator_envelope_of(&oscillator, problem->excess - load / problem->square, radial).amplitude;
    return out;
}

/* |A| at its largest, seen at the start, the middle and the end of the step [m/s^2]. */
static double largest_pull(const struct vec3 pull[COLLOCATION_PULL_TERMS], double step)
{
    double largest = vec3_norm(pull[0]);
    for (int i = 1; i <= 2; ++i) {
        largest = fmax(largest, vec3_norm(path_at(pull, COLLOCATION_PULL_TERMS, 0.5 * i * step)));
    }
    return largest;
}

double press_turning_within(const struct press_outlook *outlook, double step)
{
    const struct vec3 *pull = outlook->problem.pull;
    if (vec3_is_zero(pull[1]) && vec3_is_zero(pull[2])) {
        return outlook->turning;
    }
    return outlook->rate_along + sqrt(largest_pull(pull, step) / outlook->distance);
}

/* Radians in a step are an estimate: a tenth more is as good. */
static const double RADIANS_MORE = 1.1;

/* Each leaves at most half of the step's logarithm that is too much: a step of 1e6 times the length needs eight. */
enum { STEP_TRIALS = 12 };

double press_step_within(const struct press_outlook *outlook, double longest, double radians)
{
    double step = fmin(longest, radians / outlook->turning);
    for (int i = 0; i < STEP_TRIALS; ++i) {
        const double turning = press_turning_within(outlook, step);
        if (step * turning <= RADIANS_MORE * radians) {
            break;
        }
        /* What is looked for lies between the step and radians / turning. The rate grows with a power of the step
         * between 0 and 1, so that the geometric mean is nearer to it than either. */
        step = sqrt(step * (radians / turning));
    }
    return step;
}

bool press_collocation_make(struct press_collocation *p, const struct press *from,
                            const struct press_outlook *outlook, double step, enum collocation_kind kind,
                            const struct lobatto *nodes, double tolerance)
{
    p->from = from;
    return collocation_make(&p->step, &outlook->problem, step, kind, nodes, tolerance);
}

/* F_n = -(k g + c g'). */
static void add_force(const struct press *from, struct press_sample *sample)
{
    for (int i = 0; i < 3; ++i) {
        sample->of[PRESS_FORCE][i] =
            -(from->by.k * sample->of[PRESS_GAP][i] + from->by.c * sample->of[PRESS_RATE][i]);
    }
}

/* Spring and dashpot nearly cancel: the force by what it does. */
static void add_creeping_force(const struct press_collocation *p, double s, struct press_sample *sample)
{
    const double factor = p->from->shape.side * p->from->reduced_mass / (p->step.half * p->step.half);
    double push[3];
    collocation_creeping_push(&p->step, s, push);
    for (int i = 0; i < 3; ++i) {
        sample->of[PRESS_FORCE][i] = factor * push[i];
    }
}

static void fill_sample(const struct press_collocation *p, const double x[4], double s,
                        struct press_sample *sample)
{
    const double side = p->from->shape.side;
    const double per_time = side / p->step.half;
    double led[3] = {0.0, 0.0, 0.0};
    if (p->step.from.leads) {
        collocation_lead(&p->step, s, led);
    }
    for (int i = 0; i < 3; ++i) {
        sample->of[PRESS_GAP][i] = side * x[i];
        sample->of[PRESS_RATE][i] = per_time * (x[i + 1] + led[i]);
    }
    if (p->step.kind == COLLOCATION_CREEPING) {
        add_creeping_force(p, s, sample);
    } else {
        add_force(p->from, sample);
    }
}

void press_collocation_sample(const void *press_collocation, double s, struct press_sample *sample)
{
    const struct press_collocation *p = press_collocation;
    double x[4];
    collocation_excess(&p->step, s, x);
    fill_sample(p, x, s, sample);
}

void press_collocation_sample_node(const struct press_collocation *p, int node, struct press_sample *sample)
{
    double x[4];
    collocation_excess_at_node(&p->step, node, x);
    fill_sample(p, x, 1.0 + p->step.nodes->node[node], sample);
}

/* What the oscillation alone brings to a quantity: y, its rate and its force all solve the oscillator's equation. */
struct oscillator_envelope press_envelope_of(const struct press_collocation *p, enum press_quantity quantity)
{
    const struct oscillator *o = &p->step.oscillator;
    const double half = p->step.half;
    const double y = p->step.y;
    const double rate = p->step.y_rate;
    const double bend = -o->damping * rate - o->square * y;
    const double k = p->from->by.k;
    const double c = p->from->by.c / half;
    switch (quantity) {
    case PRESS_RATE:
        return oscillator_envelope_of(o, rate / half, bend / half);
    case PRESS_FORCE:
        return oscillator_envelope_of(o, k * y + c * rate, k * rate + c * bend);
    default:
        return oscillator_envelope_of(o, y, rate);
    }
}

void press_collocation_sample_slow(const struct press_collocation *p, double s, struct press_sample *sample)
{
    double x[4];
    collocation_slow_excess(&p->step, s, x);
    fill_sample(p, x, s, sample);
}

void press_reserve_from(const struct press_reserve *reserve, const struct oscillator_envelope *envelope,
                        double s, const struct press_sample *slow, double *value, double *slope)
{
    const double still =
        envelope->decay > 0.0 ? envelope->amplitude * exp(-envelope->decay * s) : envelope->amplitude;
    *value = reserve->factor * slow->of[reserve->quantity][0] + reserve->offset - still;
    *slope = reserve->factor * slow->of[reserve->quantity][1] + envelope->decay * still;
}

void press_reserve_at(const void *press_reserve, double s, double *value, double *slope)
{
    const struct press_reserve *reserve = press_reserve;
    const struct oscillator_envelope envelope = press_envelope_of(reserve->of, reserve->quantity);
    struct press_sample slow;
    press_collocation_sample_slow(reserve->of, s, &slow);
    press_reserve_from(reserve, &envelope, s, &slow, value, slope);
}

/* By parts, so that the oscillation of r' and r'' need not be seen: (path r)' = path' r + path r', and again. What is left
 * under the integral is path' or path'', linear in time, times r = c - c(0) - (C - C(0)). */
static double work_by_parts(const struct press_collocation *p, const struct press_work *work,
                            const struct press_change *change, double s)
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
    /* C - C(0) has degree four, the weight one: five Gauss-Legendre nodes would be more than enough; term by term it is exact. */
    double flown = 0.0;
    double power = t;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = press_across(p->from, p->from->flight.c[i]);
        power *= t;
        flown += power * (vec3_dot(weight[0], c) / (i + 1) + t * vec3_dot(weight[1], c) / (i + 2));
    }
    return boundary + sign * (collocation_moment(&p->step, weight, s) - flown);
}

struct press_change press_collocation_change(const struct press_collocation *p, double s)
{
    const struct press *from = p->from;
    const struct collocation_change step = collocation_change_at(&p->step, s);
    struct press_change change = {.time = p->step.half * s, .r = step.moved, .r_rate = step.gained};
    double power = 1.0;
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        const struct vec3 c = press_across(from, from->flight.c[i]);
        if (i > 1) {
            change.r_rate = vec3_axpy(change.r_rate, -i * power, c);
        }
        power *= change.time;
        change.r = vec3_axpy(change.r, -power, c);
    }
    change.gap = from->shape.side * step.excess;
    if (from->by.c > 0.0) {
        change.dissipated = from->reduced_mass * collocation_dissipated(&p->step, s);
    }
    for (int end = 0; end < PRESS_ENDS; ++end) {
        change.work[end] = work_by_parts(p, &from->work[end], &change, s);
    }
    return change;
}

#endif
