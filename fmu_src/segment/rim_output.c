/* What a series of the rim says at a place. */
#include "math/compiler.h"
#include "math/root.h"
#include "segment/rim_series.h"

double rim_series_time(const struct rim_series *p, double s)
{
    return p->by_root ? taylor_at(p->time, TAYLOR_TERMS, s) : p->unit * s;
}

struct rim_time_left {
    const struct rim_series *of;
    double time;
};

static void rim_time_left_at(const void *rim_time_left, double s, double *value, double *slope)
{
    const struct rim_time_left *left = rim_time_left;
    *value = rim_series_time(left->of, s) - left->time;
    *slope = left->of->unit * taylor_at(left->of->root, TAYLOR_TERMS, s);
}

double rim_series_place(const struct rim_series *p, double time, double end)
{
    if (!p->by_root) {
        return time / p->unit;
    }
    const struct rim_time_left left = {p, time};
    const struct root_bracket_end low = {0.0, -time, p->time[1]};
    struct root_bracket_end high = {.s = end};
    rim_time_left_at(&left, end, &high.value, &high.slope);
    return high.value > 0.0 ? root_between(rim_time_left_at, &left, low, high) : end;
}

/* Value and two derivatives of two series, side by side. */
static void rim_two_at(const double *a, const double *b, int terms, double s, double of_a[3], double of_b[3])
{
#if CONTACT_GNU_C
    double2 value = {0.0};
    double2 slope = {0.0};
    double2 bend = {0.0}; /* half of it */
    for (int i = terms - 1; i >= 0; --i) {
        const double2 next = {a[i], b[i]};
        bend = bend * s + slope;
        slope = slope * s + value;
        value = value * s + next;
    }
    for (int j = 0; j < 2; ++j) {
        double *out = j == 0 ? of_a : of_b;
        out[0] = value[j];
        out[1] = slope[j];
        out[2] = 2.0 * bend[j];
    }
#else
    for (int j = 0; j < 2; ++j) {
        double *out = j == 0 ? of_a : of_b;
        out[0] = out[1] = out[2] = 0.0;
        for (int i = terms - 1; i >= 0; --i) {
            out[2] = out[2] * s + 2.0 * out[1];
            out[1] = out[1] * s + out[0];
            out[0] = out[0] * s + (j == 0 ? a : b)[i];
        }
    }
#endif
}

void rim_series_sample(const void *rim_series, double s, struct pair_sample *sample)
{
    const struct rim_series *p = rim_series;
    double u[3];
    rim_two_at(p->rate, p->force, p->terms, s, sample->of[PAIR_GAP_RATE], sample->of[PAIR_FORCE]);
    rim_two_at(p->radial, p->axial, p->terms, s, sample->of[PAIR_RADIAL], sample->of[PAIR_AXIAL]);
    rim_two_at(p->gap, p->by_root ? p->root : p->gap, p->terms, s, sample->of[PAIR_GAP], u);
    if (p->by_root) {
        sample->of[PAIR_GAP][0] = -u[0] * u[0];
        sample->of[PAIR_GAP][1] = -2.0 * u[0] * u[1];
        sample->of[PAIR_GAP][2] = -2.0 * (u[1] * u[1] + u[0] * u[2]);
    }
}

/* Adds those of along(s) t^k, `power` being t^k: where t = unit s, only coefficient k of it. */
static void add_along_time(const struct rim_series *p, const double *along, const double *power, int k,
                           double *sum)
{
    if (p->by_root && k > 0) {
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            sum[i] += taylor_multiply(along, power, i);
        }
        return;
    }
    for (int i = k; i < p->terms; ++i) {
        sum[i] += along[i - k] * power[k];
    }
}

/* From t^k to t^(k + 1). */
static void next_power_of_time(const struct rim_series *p, double *power, int k)
{
    double next[TAYLOR_TERMS];
    if (!p->by_root) {
        power[k + 1] = power[k] * p->time[1];
        return;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        next[i] = taylor_multiply(power, p->time, i);
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        power[i] = next[i];
    }
}

/* The integral of pair_work over [0, s]: of path(t).r_s ds, order 1, or of path(t).r'_s ds, order 2. */
static double rim_work(const struct rim_series *p, const struct pair_work *work, double s)
{
    const struct taylor_vec3 *of = work->order == 1 ? &p->r : &p->r_rate;
    double sum[TAYLOR_TERMS] = {0.0};
    double power[TAYLOR_TERMS] = {1.0};
    if (work->order == 0) {
        return 0.0;
    }
    int terms = 3; /* of the path that count: one where forces are steady */
    while (terms > 0 && vec3_is_zero(work->path[terms - 1])) {
        --terms;
    }
    for (int k = 0; k < terms; ++k) {
        double along[TAYLOR_TERMS] = {0.0}; /* of path[k] and the slope */
        for (int i = 0; i + 1 < p->terms; ++i) {
            along[i] = vec3_dot(work->path[k], vec3_scale(i + 1, of->at[i + 1]));
        }
        add_along_time(p, along, power, k, sum);
        if (k + 1 < terms) {
            next_power_of_time(p, power, k);
        }
    }
    return taylor_integral(sum, p->terms - 1, s);
}

struct pair_change rim_series_change(const void *rim_series, double s)
{
    const struct rim_series *p = rim_series;
    const double u = p->by_root ? taylor_at(p->root, p->terms, s) : 0.0;
    return (struct pair_change){
        .time = rim_series_time(p, s),
        .r = taylor_at_vec3(&p->r, p->terms, s),
        .r_rate = taylor_at_vec3(&p->r_rate, p->terms, s),
        .gap = p->by_root ? -u * u : taylor_at(p->gap, p->terms, s),
        .dissipated = p->damps ? p->unit * taylor_integral(p->lost, p->terms, s) : 0.0,
        .work = {rim_work(p, &p->from->work[0], s), rim_work(p, &p->from->work[1], s)}};
}
