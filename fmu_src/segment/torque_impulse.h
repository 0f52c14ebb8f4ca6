/*
 * The impulse of the torque on a destination where nothing turns or rubs: then c x F, with F the force on the
 * source, for the source's lever arm is along it. With c = C + r, F = -m_red r'' (contact_pair.h)
 *
 *   integral of c x F = -m_red ([C x r' - C' x r + r x r'] + integral of C'' x r)
 *
 * r is along n. So of C only the part along the axis counts at the side of a cylinder, that across n at a
 * plane and at a cap, and r x r' counts at a rim alone. Towards a sphere there is no torque.
 */
#ifndef CONTACT_SEGMENT_TORQUE_IMPULSE_H
#define CONTACT_SEGMENT_TORQUE_IMPULSE_H

#include "segment/segment.h"

/* The motion since the start of a segment, at s. */
typedef struct pair_change pair_changer(const void *motion, double s);

/* Over [0, s], at which `change` is [N m s]. */
struct vec3 torque_impulse(struct segment *p, pair_changer *changer, const struct pair_change *change,
                           double s);

#endif
