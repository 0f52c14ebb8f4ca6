/*
 * A contact that presses, as a power series of time.
 *
 * Without the contact force the separation of a pair would follow the polynomial C(t), its rate W(t) (approach.h). With it
 * c = C + r, w = W + r', and m_red r'' = side F_n n with 1/m_red the sum of the free bodies' inverse masses. F_n and n follow
 * from c and w by products, a square root and quotients, so the series of r is had coefficient by coefficient. Momentum
 * is exact: the bodies leave their flights by -r m_red/m_s and +r m_red/m_d, and the impulse on the source is -m_red r'.
 *
 * Series variable s = time / unit, dimensionless.
 */
#ifndef CONTACT_PRESS_H
#define CONTACT_PRESS_H

#include "contact/series.h"
#include "dynamics/approach.h"

#if SCENE_ANY_FREE

struct press {
    struct vec3_series r;       /* deviation of the separation from flight [m] */
    double gap[SERIES_TERMS];   /* g [m] */
    double rate[SERIES_TERMS];  /* g' as the law sees it [m/s] */
    double force[SERIES_TERMS]; /* F_n [N] */
    double unit;                /* [s] */
    double reduced_mass;        /* m_red [kg] */
    double step;                /* the sums are exact to rounding up to this s */
};

/* The series from the present instant `at`, taken at q->clock, for a contact in a pressing or receding regime. */
void press_make(struct press *p, const struct scene_values *v, const struct motion *q,
                const struct system_instant *at, int contact);

/* Moves the pair of bodies to `s`, with impulse, dissipated energy and external work. */
void press_advance(const struct press *p, const struct scene_values *v, struct motion *q, int contact,
                   double s);

#endif
#endif
