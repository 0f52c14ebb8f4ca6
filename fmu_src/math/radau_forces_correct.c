/* Corrections of the states by the system of the forces (math/radau_forces.c). */
#include <string.h>

#include "math/radau_rows.h"

/* Changes of the states left, of tipping ones by the others too: A of the residual; h A of the speeds. */
static void change_without_forces(struct radau_step *p)
{
    const struct radau_forces *to = &p->forces;
    const int s = p->stages->stages;
    const int n = p->problem.coupled;
    const int m = p->others;
    const int t = p->problem.tipping;
    const int width = p->width;
    const int places = radau_padded(p->problem.paired);
    const double *once = p->stages->integral;
    for (int i = 0; i < s; ++i) {
        radau_combine(to->change + i * width, once + i * s, s, p->residual, width, width);
    }
    for (int i = 0; i < s; ++i) {
        for (int r = 0; r < t; ++r) {
            to->row[i * t + r] =
                p->length * radau_product(to->own + (i * t + r) * n, to->change + i * width, m);
        }
        memset(to->moved + i * places, 0, (size_t)places * sizeof *to->moved);
        for (int k = 0; k < p->problem.paired; ++k) {
            to->moved[i * places + k] = p->length * to->change[i * width + p->speed_among[k]];
        }
    }
    for (int i = 0; i < s; ++i) {
        for (int r = 0; r < t; ++r) {
            for (int j = 0; j < s; ++j) {
                to->change[i * width + m - t + r] += once[i * s + j] * to->row[j * t + r];
            }
        }
        radau_combine(to->places + i * places, once + i * s, s, to->moved, places, places);
    }
}

/* By how much the forces at a stage change with those. */
static void put_changes_of_forces(struct radau_step *p, int stage, double *side)
{
    const struct radau_forces *to = &p->forces;
    const int n = p->problem.coupled;
    const int f = p->problem.forces;
    const int m = p->others;
    const int wide = radau_padded_forces(&p->problem);
    const double *of = to->of + stage * n * wide;
    const double *change = to->change + stage * p->width;
    const double *places = to->places + stage * radau_padded(p->problem.paired);
    for (int g = 0; g < f; ++g) {
        double sum = 0.0;
        for (int k = 0; k < m; ++k) {
            sum += of[k * wide + g] * change[k];
        }
        for (int k = 0; k < p->problem.paired; ++k) {
            sum += of[(m + k) * wide + g] * places[k];
        }
        side[g] = sum;
    }
}

void radau_forces_correct(struct radau_step *p)
{
    const struct radau_forces *to = &p->forces;
    const int s = p->stages->stages;
    const int n = p->problem.coupled;
    const int f = p->problem.forces;
    const int m = p->others;
    const int t = p->problem.tipping;
    const int width = p->width;
    change_without_forces(p);
    for (int i = 0; i < s; ++i) {
        put_changes_of_forces(p, i, to->side + i * f);
    }
    to->side[s * f] = 0.0;
    dense_lu_solve(p->all, to->side);
    for (int i = 0; i < s; ++i) {
        double *moved = to->moved + i * width;
        memset(moved, 0, (size_t)width * sizeof *moved);
        for (int g = 0; g < f; ++g) {
            const double *by = to->by + (i * f + g) * n;
            const double change = p->length * to->side[i * f + g];
            for (int k = 0; k < m; ++k) {
                moved[k] += by[k] * change;
            }
        }
    }
    for (int i = 0; i < s; ++i) {
        radau_combine(p->re, p->stages->integral + i * s, s, to->moved, width, width);
        for (int k = 0; k < m; ++k) {
            p->side[i * m + k] = to->change[i * width + k] + p->re[k];
        }
        for (int j = 0; j < s && t > 0; ++j) {
            const double *tips = to->tips + (i * s + j) * t * f;
            for (int r = 0; r < t; ++r) {
                p->side[i * m + m - t + r] += radau_product(tips + r * f, to->side + j * f, f);
            }
        }
    }
}
