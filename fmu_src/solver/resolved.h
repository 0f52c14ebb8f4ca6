/* Collocated steps whose nodes see the oscillation: impacts. */
#ifndef CONTACT_RESOLVED_H
#define CONTACT_RESOLVED_H

#include "solver/piece.h"

#if SCENE_ANY_FREE

/* Below critical damping; up to the contact's end where one is in sight. p->press, regime, resolution and tolerance are set. */
bool resolved_piece(struct piece *p, const struct press_outlook *outlook, double longest);

#endif
#endif
