/* In which zone of a capped cylinder a contact is (zone.h): set when it begins, changed at the zone's edges,
 * forgotten when it ends. In scenes without capped cylinders nothing happens. */
#ifndef CONTACT_SCENE_ZONES_H
#define CONTACT_SCENE_ZONES_H

#include "scene/evaluate.h"

/* Margin [m] of a contact that has no zone. */
#define NO_ZONE_MARGIN 1.0

#if SCENE_ANY_CAPS

/* After a regime has been set at the instant: the zone that is met then, or none without contact. */
void zones_follow(struct scene_state *q, const struct scene_instant *at, int contact);

/* The contact passes into the next zone. */
void zones_pass(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                int contact);

/* The zone that is met at the instant, where that is another by more than rounding. */
void zones_settle(const struct scene_values *v, struct scene_state *q, const struct scene_instant *at,
                  int contact);

/* How far the source's centre is within the edges of the zone [m]. */
double zones_margin(const struct scene_values *v, const struct scene_state *q, const struct scene_instant *at,
                    int contact);

/* As users see it, at the instant. */
enum zone zones_shown(const struct scene_values *v, const struct scene_state *q,
                      const struct scene_instant *at, int contact);

#else

static inline void zones_follow(struct scene_state *q, const struct scene_instant *at, int contact)
{
    (void)q, (void)at, (void)contact;
}

static inline void zones_pass(const struct scene_values *v, struct scene_state *q,
                              const struct scene_instant *at, int contact)
{
    (void)v, (void)q, (void)at, (void)contact;
}

static inline void zones_settle(const struct scene_values *v, struct scene_state *q,
                                const struct scene_instant *at, int contact)
{
    (void)v, (void)q, (void)at, (void)contact;
}

static inline double zones_margin(const struct scene_values *v, const struct scene_state *q,
                                  const struct scene_instant *at, int contact)
{
    (void)v, (void)q, (void)at, (void)contact;
    return NO_ZONE_MARGIN;
}

static inline enum zone zones_shown(const struct scene_values *v, const struct scene_state *q,
                                    const struct scene_instant *at, int contact)
{
    (void)v, (void)at;
    return q->contact[contact].regime == (int32_t)REGIME_APART ? ZONE_NONE : ZONE_SIDE;
}

#endif
#endif
