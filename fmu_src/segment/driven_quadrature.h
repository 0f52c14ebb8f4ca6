/*
 * Impulses and energies of a contact that turns or rubs while all motion is given, over the time in which it
 * touches: quadratures (driven_panel.h) of smooth formulas, whose panels are halved until halves and whole
 * agree, from one change of a regime (driven_regime.h) to the next, which is located.
 */
#ifndef CONTACT_SEGMENT_DRIVEN_QUADRATURE_H
#define CONTACT_SEGMENT_DRIVEN_QUADRATURE_H

#include "segment/driven_panel.h"

#if SCENE_ANY_TURNING

/* One contact over a span. */
struct driven_span {
    struct driven_contact c;
    struct driven_panel total; /* its size: of the contact so far; its spring: the present one */
    double sum[DRIVEN_TERMS];
    bool elastic;               /* friction has a spring */
    long *panels, *evaluations; /* that are left, of the quadrature and of the search for touches */
    long panel_cost;            /* in panels of bodies that do not turn about changing directions */
};

/* From one clock to another, between which the bodies touch. False: no panels are left. */
bool driven_integrate(struct driven_span *s, double from, double end);

#endif
#endif
