/* What a series of the rim says at a place. */
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

/* Value and two derivatives. */
static void rim_series_at(const double *a, double s, double out[3])
{
    out[0] = out[1] = out[2] = 0.0;
    for (int i = TAYLOR_TERMS - 1; i >= 0; --i) {
        out[2] = out[2] * s + 2.0 * out[1];
        out[1] = out[1] * s + out[0];
        out[0] = out[0] * s + a[i];
    }
}

void rim_series_sample(const void *rim_series, double s, struct pair_sample *sample)
{
    const struct rim_series *p = rim_series;
    rim_series_at(p->gap, s, sample->of[PAIR_GAP]);
    rim_series_at(p->rate, s, sample->of[PAIR_GAP_RATE]);
    rim_series_at(p->force, s, sample->of[PAIR_FORCE]);
    rim_series_at(p->radial, s, sample->of[PAIR_RADIAL]);
    rim_series_at(p->axial, s, sample->of[PAIR_AXIAL]);
    if (p->by_root) {
        double u[3];
        rim_series_at(p->root, s, u);
        sample->of[PAIR_GAP][0] = -u[0] * u[0];
        sample->of[PAIR_GAP][1] = -2.0 * u[0] * u[1];
        sample->of[PAIR_GAP][2] = -2.0 * (u[1] * u[1] + u[0] * u[2]);
    }
}

/* The integral of pair_work over [0, s]: of path(t).r_s ds, order 1, or of path(t).r'_s ds, order 2. */
static double rim_work(const struct rim_series *p, const struct pair_work *work, double s)
{
    double sum[TAYLOR_TERMS] = {0.0};
    struct taylor_vec3 slope = {.at = {{0.0, 0.0, 0.0}}};
    const struct taylor_vec3 *of = work->order == 1 ? &p->r : &p->r_rate;
    double power[TAYLOR_TERMS] = {1.0};
    if (work->order == 0) {
        return 0.0;
    }
    for (int i = 0; i + 1 < TAYLOR_TERMS; ++i) {
        slope.at[i] = vec3_scale(i + 1, of->at[i + 1]);
    }
    int terms = 3; /* of the path that count: one where forces are steady */
    while (terms > 0 && vec3_is_zero(work->path[terms - 1])) {
        --terms;
    }
    for (int k = 0; k < terms; ++k) {
        double along[TAYLOR_TERMS];
        double next[TAYLOR_TERMS];
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            along[i] = vec3_dot(work->path[k], slope.at[i]);
            sum[i] += k == 0 ? along[i] : taylor_multiply(along, power, i);
        }
        if (k + 1 == terms) {
            break;
        }
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            next[i] = taylor_multiply(power, p->time, i);
        }
        for (int i = 0; i < TAYLOR_TERMS; ++i) {
            power[i] = next[i];
        }
    }
    return taylor_integral(sum, TAYLOR_ORDER, s);
}

/* The integral of c g'^2 dt, or of -(F_n - k_h u^3) g' dt, dt = unit ds or unit u ds. */
static double rim_dissipated(const struct rim_series *p, double s)
{
    double damped[TAYLOR_TERMS];
    double power[TAYLOR_TERMS];
    double by_s[TAYLOR_TERMS];
    const double factor = p->by_root ? p->from->chi : p->from->coefficients.c;
    if (!(factor > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        damped[i] = p->by_root ? p->from->hertz_stiffness * p->cube[i] - p->force[i] : factor * p->rate[i];
        power[i] = taylor_multiply(damped, p->rate, i);
    }
    for (int i = 0; i < TAYLOR_TERMS; ++i) {
        by_s[i] = p->by_root ? taylor_multiply(power, p->root, i) : power[i];
    }
    return p->unit * taylor_integral(by_s, TAYLOR_TERMS, s);
}

struct pair_change rim_series_change(const void *rim_series, double s)
{
    const struct rim_series *p = rim_series;
    const double u = p->by_root ? taylor_at(p->root, TAYLOR_TERMS, s) : 0.0;
    return (struct pair_change){
        .time = rim_series_time(p, s),
        .r = taylor_at_vec3(&p->r, TAYLOR_TERMS, s),
        .r_rate = taylor_at_vec3(&p->r_rate, TAYLOR_TERMS, s),
        .gap = p->by_root ? -u * u : taylor_at(p->gap, TAYLOR_TERMS, s),
        .dissipated = rim_dissipated(p, s),
        .work = {rim_work(p, &p->from->work[0], s), rim_work(p, &p->from->work[1], s)}};
}
