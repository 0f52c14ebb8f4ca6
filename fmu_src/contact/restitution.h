/*
 * The damping that gives a free head-on impact a coefficient of restitution e, the speed after it over the
 * speed before. Free: no other force acts on either body meanwhile. Found once, when a contact is prepared.
 */
#ifndef CONTACT_CONTACT_RESTITUTION_H
#define CONTACT_CONTACT_RESTITUTION_H

#include "contact/choices.h"
#include "math/compiler.h"

/*
 * Smaller coefficients count as this one where none but an infinite dashpot would give 0: with all dashpots
 * but the unclamped linear one. A ball that leaves with a millionth of its speed rises by 1e-12 of its drop.
 */
#define RESTITUTION_LEAST 1e-6

/*
 * The same of Hunt and Crossley's law. Its chi v is 1/e, with the approach-only dashpot 2/e^2, and
 * integration costs steps in proportion: 2e6 take some ten thousand. A millionth of the energy is left then.
 */
#define RESTITUTION_LEAST_HERTZ 1e-3

/*
 * The damping ratio zeta = p_nv / (2 sqrt(p_n m_red)) of the linear law for e in [0, 1].
 *
 *   unclamped       contact ends at g = 0:      e = exp(-pi zeta / sqrt(1 - zeta^2)); e = 0: zeta = 1
 *   non-adhesive    contact ends at F_n = 0:    e = exp(-2 h(zeta))
 *   approach-only   the spring alone returns:   e = exp(-h(zeta))
 *
 *   h(cos t) = t cot t up to critical damping, h(cosh t) = t coth t beyond.
 *
 * Source: the oscillator x'' + 2 zeta x' + x = 0 from x = 0, x' = 1. Its largest x is exp(-h), and the spring
 * alone turns that into a speed of the same number. It returns through x + 2 zeta x' = 0, where the force
 * ends, with x' = -exp(-2 h): T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465, in one formula.
 */
CONTACT_COLD double restitution_damping_ratio(double restitution, enum dashpot dashpot);

/*
 * The number y = chi v of Hunt and Crossley's law, with the speed v of the onset, for e in [0, 1]; it does
 * not depend on the spring, nor on the exponent of its force.
 *
 *   full damping    y (1 + e) = ln((1 + y)/(1 - e y)); the force then never pulls: unclamped is non-adhesive
 *   approach-only   e^2 = 2 (y - ln(1 + y))/y^2
 *
 * Source: with the energy E of the spring for a state of motion, v dv/dE = -(1 + chi v)/m; both are its
 * integrals from the touch to the deepest point, E = (m/chi^2)(y - ln(1 + y)), and back. Marhefka and Orin,
 * IEEE Transactions on Systems, Man, and Cybernetics A 29 (1999) 566.
 */
CONTACT_COLD double restitution_hunt_crossley(double restitution, enum dashpot dashpot);

#endif
