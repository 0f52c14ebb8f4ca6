/*
 * Hertz's force with the damping of Hunt and Crossley, for law.c.
 *
 *   F_n = k_h delta^(3/2) (1 + chi delta'),   delta = -g, zero for g >= 0
 *
 * k_h [N/m^1.5] is the stiffness, chi [s/m] the factor of the damping; 0 where a regime has none.
 * Source: K. H. Hunt, F. R. E. Crossley, Journal of Applied Mechanics 42 (1975) 440.
 */
#ifndef CONTACT_CONTACT_HERTZ_LAW_H
#define CONTACT_CONTACT_HERTZ_LAW_H

struct hertz_law {
    double stiffness; /* k_h [N/m^1.5] */
    double damping;   /* chi [s/m] */
};

/* F_n [N] and its derivatives with respect to g and g'. */
double hertz_force(struct hertz_law law, double gap, double gap_rate);
double hertz_force_by_gap(struct hertz_law law, double gap, double gap_rate);
double hertz_force_by_rate(struct hertz_law law, double gap);

/* 2/5 k_h delta^(5/2) [J] and its first two derivatives with respect to g. */
double hertz_energy(double stiffness, double gap);
double hertz_energy_slope(double stiffness, double gap);
double hertz_energy_bend(double stiffness, double gap);

/* Coefficients `order` of F_n, of the energy and of the spring's part of the force along a path, from
 * coefficients 0..order of g and g'; zero where the path begins at g >= 0. */
double hertz_force_term(struct hertz_law law, const double *gap, const double *gap_rate, int order);
double hertz_energy_term(double stiffness, const double *gap, int order);
double hertz_spring_term(double stiffness, const double *gap, int order);

#endif
