/*
 * A contact that turns or rubs while all motion is given, over a panel of time in which it touches: impulses
 * and energies by Gauss-Legendre quadrature; the spring of elastic friction by collocation at the same nodes,
 * which has order ten there.
 */
#ifndef CONTACT_PRESCRIBED_DRIVEN_H
#define CONTACT_PRESCRIBED_DRIVEN_H

#include "math/nodes.h"
#include "scene/evaluate.h"

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

/* False where the spring is not found: the panel is too long for it. `graded`: see nodes.h. */
bool driven_panel_make(const struct driven_contact *c, double from, double to, struct vec3 spring,
                       bool graded, struct driven_panel *panel);

/*
 * The regimes of a contact that turns or rubs while its motion is given, of its law and of friction: which
 * they are as it begins, the event functions that end them, and what follows each event. Between two events
 * nothing changes them, so that all forces are smooth there.
 */

/* The law's event (contact/law.h); friction ends or begins under a dashpot that pulls, reaches its largest
 * force or leaves it, sticks or breaks away (contact/friction.h). */
enum driven_event { DRIVEN_LAW, DRIVEN_LIFT, DRIVEN_CAP, DRIVEN_STICK, DRIVEN_EVENTS };

/* Event functions, positive within the regimes, and what rounding makes of them. */
struct driven_margins {
    double value[DRIVEN_EVENTS];
    double noise[DRIVEN_EVENTS];
};

void driven_margins_at(const struct driven_contact *c, double clock, struct vec3 spring,
                       struct driven_margins *margins);

/* The first event whose function is below zero by more than rounding, of friction below what it was at
 * `start`
 * too; DRIVEN_EVENTS: none is. */
enum driven_event driven_event_passed(const struct driven_margins *now, const struct driven_margins *start);

/* The regimes and the spring after an event at an instant; what sticks again keeps the spring that sliding
 * had. */
void driven_take_event(const struct driven_contact *c, double clock, struct vec3 spring,
                       enum driven_event event);

/* The regimes from the touch on, and after the parting. */
void driven_begin(const struct driven_contact *c, double clock);
void driven_end(const struct driven_contact *c);

/* Puts the regimes to what the present asks for: at the start, and after inputs have jumped. */
void driven_turning_settle(const struct scene_values *v, struct scene_state *q, int contact);

/* Of contacts that touch: after inputs have jumped the springs lie across the new normals. */
void driven_lay_springs(const struct scene_values *v, struct scene_state *q);

/* xi, zero in scenes without friction [m]. */
struct vec3 driven_spring(const struct scene_state *q, int contact);

/*
 * Contacts that turn or rub over a span of time in which all motion is given: neither body is free or turns
 * freely. No touch is missed (tumbling.h). Within a contact impulses and energies are quadratures
 *.
 */

/* So many panels a step may take: about a second. A contact takes some dozens. */
enum { DRIVEN_PANELS = 20000 };

/* Over `length` seconds from the present. Regimes and spring of q become those at the end; impulses, or means
 * in scenes without free bodies, peaks, energies and onsets are booked. False, q being undefined: so many
 * panels, or what a search for touches may take, were not enough. */
bool driven_turning_over(const struct scene_values *v, struct scene_state *q, double length, long panels);

#endif
