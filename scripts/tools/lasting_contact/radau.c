#include "radau.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_ITERATIONS = 40 };

/* Where the iteration stops: a few roundings. Where it cannot get there it may stop once it no longer gets
 * nearer. */
static const double CONVERGED = 1e-15;
static const double STALLED = 1e-11;

typedef double stages[RADAU_STAGES][LOCAL_UNKNOWNS];

/* lambda / h - J, factorised */
struct system {
    int unknowns;
    double complex lu[LOCAL_UNKNOWNS][LOCAL_UNKNOWNS];
    int pivot[LOCAL_UNKNOWNS];
};

static void factorise(struct system *m)
{
    for (int k = 0; k < m->unknowns; ++k) {
        int best = k;
        for (int i = k + 1; i < m->unknowns; ++i) {
            best = cabs(m->lu[i][k]) > cabs(m->lu[best][k]) ? i : best;
        }
        m->pivot[k] = best;
        for (int j = 0; j < m->unknowns; ++j) {
            const double complex swapped = m->lu[k][j];
            m->lu[k][j] = m->lu[best][j];
            m->lu[best][j] = swapped;
        }
        for (int i = k + 1; i < m->unknowns; ++i) {
            m->lu[i][k] /= m->lu[k][k];
            for (int j = k + 1; j < m->unknowns; ++j) {
                m->lu[i][j] -= m->lu[i][k] * m->lu[k][j];
            }
        }
    }
}

/* Rows were swapped as wholes, so all swaps come first. */
static void solve(const struct system *m, double complex *b)
{
    for (int k = 0; k < m->unknowns; ++k) {
        const double complex swapped = b[k];
        b[k] = b[m->pivot[k]];
        b[m->pivot[k]] = swapped;
    }
    for (int k = 0; k < m->unknowns; ++k) {
        for (int i = k + 1; i < m->unknowns; ++i) {
            b[i] -= m->lu[i][k] * b[k];
        }
    }
    for (int k = m->unknowns - 1; k >= 0; --k) {
        b[k] /= m->lu[k][k];
        for (int i = 0; i < k; ++i) {
            b[i] -= m->lu[i][k] * b[k];
        }
    }
}

/* Once in a step, with J at its start */
static void prepare(const struct radau_table *t, const struct local *local, const struct problem *p,
                    const double *y, double h, struct system *m)
{
    double j[LOCAL_UNKNOWNS][LOCAL_UNKNOWNS] = {{0.0}};
    local->jacobian(p, y, j);
    for (int e = 0; e < t->systems; ++e) {
        m[e].unknowns = local->unknowns;
        for (int i = 0; i < local->unknowns; ++i) {
            for (int k = 0; k < local->unknowns; ++k) {
                m[e].lu[i][k] = (i == k ? t->lambda[e] / h : 0.0) - j[i][k];
            }
        }
        factorise(&m[e]);
    }
}

/* What is missing in Z / h = A F(y + Z), times A^-1 */
static void residual(const struct radau_table *t, const struct local *local, const struct problem *p,
                     const double *y, double h, stages z, stages missing)
{
    for (int i = 0; i < t->stages; ++i) {
        double at[LOCAL_UNKNOWNS];
        for (int k = 0; k < local->unknowns; ++k) {
            at[k] = y[k] + z[i][k];
        }
        local->rates(p, at, missing[i]);
        for (int j = 0; j < t->stages; ++j) {
            const double factor = t->inverse[i][j] / h;
            for (int k = 0; k < local->unknowns; ++k) {
                missing[i][k] -= factor * z[j][k];
            }
        }
    }
}

/* Returns the largest change. */
static double correct(const struct radau_table *t, const struct system *m, stages missing, stages z)
{
    double largest = 0.0;
    double complex w[RADAU_SYSTEMS][LOCAL_UNKNOWNS];
    for (int e = 0; e < t->systems; ++e) {
        for (int k = 0; k < m->unknowns; ++k) {
            w[e][k] = 0.0;
            for (int j = 0; j < t->stages; ++j) {
                w[e][k] += t->covectors[e][j] * missing[j][k];
            }
        }
        solve(&m[e], w[e]);
    }
    for (int i = 0; i < t->stages; ++i) {
        for (int k = 0; k < m->unknowns; ++k) {
            double change = 0.0;
            for (int e = 0; e < t->systems; ++e) {
                change += t->weight[e] * (creal(t->vectors[i][e]) * creal(w[e][k]) -
                                          cimag(t->vectors[i][e]) * cimag(w[e][k]));
            }
            z[i][k] += change;
            largest = fmax(largest, fabs(change));
        }
    }
    return largest;
}

static bool step(const struct radau_table *t, const struct local *local, const struct problem *p, double *y,
                 double h, struct outcome *out)
{
    struct system m[RADAU_SYSTEMS] = {{.unknowns = 0}};
    stages z = {{0.0}};
    prepare(t, local, p, y, h, m);
    out->factorisings += t->systems;
    double before = (double)INFINITY;
    for (int i = 0; i < MAX_ITERATIONS; ++i) {
        stages missing;
        residual(t, local, p, y, h, z, missing);
        const double change = correct(t, m, missing, z);
        out->iterations += 1;
        out->evaluations += t->stages;
        out->solves += t->systems;
        const double contraction = change / before;
        const double left = contraction < 1.0 ? change * contraction / (1.0 - contraction) : change;
        if ((i > 0 && left <= CONVERGED) || change <= CONVERGED ||
            (contraction >= 0.5 && change <= STALLED)) {
            for (int k = 0; k < local->unknowns; ++k) {
                y[k] += z[t->stages - 1][k];
            }
            return true;
        }
        before = change;
    }
    return false;
}

bool radau_run(const struct radau_table *t, const struct local *local, const struct problem *p,
               struct outcome *out)
{
    const double h = p->end / p->steps;
    double y[LOCAL_UNKNOWNS];
    memset(out, 0, sizeof *out);
    local->start(y);
    for (int i = 0; i < p->steps; ++i) {
        if (!step(t, local, p, y, h, out)) {
            return false;
        }
    }
    local->position(p, y, &out->x, &out->z);
    return isfinite(out->x + out->z);
}

static bool read_numbers(double *to, int count)
{
    for (int i = 0; i < count; ++i) {
        if (scanf("%lf", &to[i]) != 1) { /* NOLINT(cert-err34-c) */
            return false;
        }
    }
    return true;
}

static bool read_complex(double complex *to, int count)
{
    for (int i = 0; i < count; ++i) {
        double part[2];
        if (!read_numbers(part, 2)) {
            return false;
        }
        memcpy(&to[i], part, sizeof part);
    }
    return true;
}

bool radau_read(struct radau_table *t)
{
    memset(t, 0, sizeof *t);
    if (scanf("%d %d", &t->stages, &t->systems) != 2 || t->stages > RADAU_STAGES ||
        t->systems > RADAU_SYSTEMS) {
        return false;
    }
    bool read = read_numbers(t->weight, t->systems) && read_complex(t->lambda, t->systems);
    for (int i = 0; i < t->stages; ++i) {
        read = read && read_numbers(t->inverse[i], t->stages) && read_complex(t->vectors[i], t->systems);
    }
    for (int e = 0; e < t->systems; ++e) {
        read = read && read_complex(t->covectors[e], t->stages);
    }
    return read;
}
