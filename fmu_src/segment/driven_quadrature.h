/*
 * Impulses and energies of a contact that turns or rubs while all motion is given, over the time in which it
 * touches: quadratures (driven_panel.h) whose panels are halved until halves and whole agree; where elastic
 * friction sticks or slides is located.
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
    bool elastic;
    long *budget;
};

/* From one clock to another, between which the bodies touch. False: `budget` panels were not enough. */
bool driven_integrate(struct driven_span *s, double from, double end);

#endif
#endif
