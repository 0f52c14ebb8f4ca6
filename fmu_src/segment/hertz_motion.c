#include <float.h>

#include "segment/hertz_recurrence.h"
#include "segment/kinds.h"
#include "segment/terminal_event.h"

/* A contact force of this part of the load is none. */
static const double NO_FORCE = 0.5 * DBL_EPSILON;

/* Places at which a segment is sampled: it is a third of the radius of convergence at most, so that between
 * two of them no quantity has two extrema. */
enum { PLACES = 3 };

/* What the last terms of a series may be, as a part of the whole: the tolerance of a segment, no less than
 * some roundings, and no more than keeps energies closed to 1e-10 over thousands of segments; or a hundredth
 * of that tolerance where it is more, up to what keeps them closed to 1e-10 over an impact. */
static const double FINEST = 8.0 * DBL_EPSILON;
static const double FINE = 1e-13;
static const double PART_OF_COARSE = 0.01;
static const double COARSEST = 1e-11;

static double series_accuracy(const struct segment *p)
{
    const double asked = p->tolerance / fmax(p->pair.distance, contact_reach(&p->pair.shape));
    return fmax(fmin(fmax(asked, FINEST), FINE), fmin(PART_OF_COARSE * asked, COARSEST));
}

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

bool hertz_applies(const struct segment *p)
{
    return contact_is_hertz(&p->pair.law);
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

bool hertz_make(struct segment *p)
{
    struct pair_hertz *made = &p->as.hertz;
    struct hertz_recurrence z;
    const double coasting = hertz_coasting_time(p);
    if (coasting > 0.0) {
        p->longest = coasting;
        p->may_be_slow = false;
        return false;
    }
    pair_hertz_begin(made, &z, &p->pair);
    if (p->may_be_slow && hertz_is_slow(p)) {
        return false;
    }
    p->may_be_slow = false;
    pair_hertz_complete(made, &z, series_accuracy(p));
    p->unit = made->unit;
    double parting = pair_hertz_parting(made->root, made->step);
    p->end = fmin(made->step, parting > 0.0 ? parting : made->step);
    if (parting > 0.0 && pair_hertz_time(made, p->end) > p->longest) {
        p->end = pair_hertz_place(made, p->longest, p->end);
        parting = p->end < parting ? (double)INFINITY : parting;
    }
    for (int i = 0; i < PLACES; ++i) {
        dense_output_add(&p->output, p->end * i / (PLACES - 1));
    }
    hertz_find_terminal_event(p, parting);
    return true;
}

bool hertz_elastic_applies(const struct segment *p)
{
    return contact_is_hertz(&p->pair.law) && p->pair.chi == 0.0;
}

bool hertz_elastic_segment_make(struct segment *p)
{
    struct hertz_elastic *made = &p->as.hertz_elastic;
    if (!hertz_elastic_make(made, &p->pair)) {
        return false;
    }
    const bool parts = made->end_time <= p->longest;
    p->clear_of_centre = true;
    p->end = parts ? made->end : hertz_elastic_place(made, p->longest);
    p->unit = hertz_elastic_time(made, p->end) / p->end;
    dense_output_add(&p->output, 0.0);
    if (made->start < 0.0 && -made->start < p->end) { /* the deepest place, where each has one extremum */
        dense_output_add(&p->output, -made->start);
    }
    dense_output_add(&p->output, p->end);
    hertz_find_terminal_event(p, parts ? p->end : (double)INFINITY);
    return p->end > 0.0;
}
