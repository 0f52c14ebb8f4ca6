/*
 * A contact that turns or rubs while all motion is given, over a panel of time in which it touches: impulses
 * and energies by Gauss-Legendre quadrature; the spring of elastic friction by collocation at the same nodes,
 * which has order ten there.
 */
#ifndef CONTACT_SEGMENT_DRIVEN_PANEL_H
#define CONTACT_SEGMENT_DRIVEN_PANEL_H

#include "math/gauss.h"
#include "scene/turning_motion.h"

#if SCENE_ANY_TURNING

/* Where the integrals are: impulse of the force on the source [N s], of the torques on source and destination
 * [N m s]; energies that the normal law dissipates, that friction takes, that is supplied [J]. The event
 * function of the law is integrated only to tell whether the panel resolves it: it may change where no force
 * acts. */
enum {
    DRIVEN_FORCE = 0,
    DRIVEN_SOURCE_TORQUE = 3,
    DRIVEN_DESTINATION_TORQUE = 6,
    DRIVEN_DISSIPATED = 9,
    DRIVEN_FRICTION,
    DRIVEN_WORK,
    DRIVEN_EVENT,
    DRIVEN_TERMS
};

/* One contact whose motion is given; q serves as working memory: its spring is that of the last instant that
 * was looked at. */
struct driven_contact {
    const struct scene_values *v;
    struct scene_state *q;
    int contact;
};

struct driven_panel {
    double from, to;           /* clocks [s] */
    double sum[DRIVEN_TERMS];  /* the integrals */
    double size[DRIVEN_TERMS]; /* of what they are summed up */
    struct vec3 spring;        /* xi at the end [m] */
    double slipped;            /* the path of the slip [m] */
    struct {
        double clock;
        struct vec3 spring, slip, normal;
    } node[GAUSS_NODES];
};

/* The instant of a contact in its present regimes, whose formulas are smooth beyond their ends too. */
void driven_instant(const struct driven_contact *c, double clock, struct vec3 spring,
                    struct scene_instant *at);

/* False where the spring is not found: the panel is too long for it. `graded`: see gauss.h. */
bool driven_panel_make(const struct driven_contact *c, double from, double to, struct vec3 spring,
                       bool graded, struct driven_panel *panel);

#endif
#endif
