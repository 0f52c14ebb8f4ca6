/* Under Hertz's law: how long bodies at the touch hardly feel each other, and how contact ends. */
#include <float.h>

#include "segment/kinds.h"
#include "segment/terminal_event.h"

/* A contact force of this part of the load is none. */
static const double NO_FORCE = 0.5 * DBL_EPSILON;

/* Halvings of a step at most: from the longest to the shortest that double precision tells apart. */
enum { HALVINGS = 1100 };

/* Bounds of penetration [m] and relative acceleration [m/s^2] after a time without contact force. */
struct coasting {
    double depth, acceleration;
};

static struct coasting coasting_to(const struct contact_pair *from, double time)
{
    const struct vec3 *c = from->flight.c;
    const double load = pair_load(from) / from->reduced_mass;
    const double cubic = vec3_norm(c[3]) * time;
    const double quartic = vec3_norm(c[4]) * time * time;
    const double speed = fabs(pair_gap_derivative(from));
    return (struct coasting){fmax(-from->gap, 0.0) + time * (speed + time * (0.5 * load + cubic + quartic)),
                             load + 6.0 * cubic + 12.0 * quartic};
}

double hertz_pressing_load(const struct contact_pair *from)
{
    return -from->shape.side *
           (pair_turning(from, from->distance) + 2.0 * vec3_dot(from->normal, from->flight.c[2]));
}

/* Whether bodies that part at this speed come back before it has brought them apart by the depth at which the
 * force is nothing beside the load. An oscillation that touches zero is to have no events on rounding. */
static bool hardly_parts(const struct contact_pair *from, double speed)
{
    const double load = hertz_pressing_load(from);
    return load > 0.0 && speed * speed <= 2.0 * load * pair_hertz_depth_under(from, NO_FORCE * load);
}

/*
 * At rest at the touch, or nearly so, u = sqrt(delta) is no variable to begin with. For how long the
 * contact's force stays nothing beside the load [s]; 0 where it is not, or where the bodies move on their
 * own.
 */
double hertz_coasting_time(const struct segment *p)
{
    const struct contact_pair *from = &p->pair;
    const double load = pair_load(from) / from->reduced_mass;
    const double depth = pair_hertz_depth_under(from, NO_FORCE * load);
    const double speed = pair_gap_derivative(from);
    if (!(-from->gap <= depth && speed * speed <= 2.0 * load * depth)) {
        return 0.0;
    }
    double time = p->longest;
    for (int i = 0; i < HALVINGS && time > 0.0; ++i) {
        const struct coasting then = coasting_to(from, time);
        /* four: penetration, speed and load bring one depth each, and the force is a little more than
         * proportional */
        if (then.depth <= 4.0 * pair_hertz_depth_under(from, NO_FORCE * then.acceleration)) {
            return time;
        }
        time *= 0.5;
    }
    return time;
}

void hertz_find_terminal_event(struct segment *p, double parting)
{
    const int last = p->output.count - 1;
    if (parting > 0.0 && parting <= p->end &&
        hardly_parts(&p->pair, p->output.at[last].of[PAIR_GAP_RATE][0])) {
        parting = (double)INFINITY;
    }
    const struct terminal_event parts = {parting, {PAIR_GAP, -1.0, 0.0}, REGIME_APART};
    p->terminal = parts;
    if (terminal_event_by_law(p)) {
        const struct event_function margin = terminal_event_margin(p);
        const double s = dense_output_first_event(&p->output, &margin);
        if (s < parting) {
            p->terminal = (struct terminal_event){s, margin, contact_regime_after(&p->pair.law, p->regime)};
        }
    }
}
