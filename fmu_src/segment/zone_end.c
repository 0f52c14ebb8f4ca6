#include "segment/zone_end.h"

#include "contact/zone.h"
#include "segment/zone_path.h"

#if SCENE_ANY_CAPS

/* Where the centre is no longer beyond the side, or the cap, as far as `beyond` says at the start [m]: a
 * segment is right to its tolerance there. It may be within a face up to `rounding` outside. */
static double end_of_rim_by(const struct segment *p, enum pair_quantity quantity, double beyond,
                            double rounding)
{
    const double missing = beyond - p->output.at[0].of[quantity][0];
    const struct event_function margin = {quantity, 1.0, fmax(missing, 0.0) - rounding};
    return dense_output_first_event(&p->output, &margin);
}

static double end_at_rim(const struct segment *p)
{
    const struct contact_solid *solid = &p->pair.shape.solid;
    const double rounding = zone_path_rounding(solid, &p->pair.flight);
    const struct solid_place place = contact_place_at(solid, p->pair.flight.c[0]);
    return fmin(end_of_rim_by(p, PAIR_RADIAL, place.radial, rounding),
                end_of_rim_by(p, PAIR_AXIAL, place.axial, rounding));
}

/* The force has no part along the side, nor across the axis at a cap: the centre leaves either by its flight,
 * whose edges are roots of polynomials. */
static double end_of_face(const struct segment *p, double end)
{
    const double time = zone_path_leaves_face(&p->pair.shape.solid, &p->pair.flight, segment_time(p, end));
    return time < (double)INFINITY ? segment_place(p, time) : (double)INFINITY;
}

/* How far a centre within the solid is from where another face is nearest [m]: its depth is known by the gap,
 * and how far it is from the other face by its flight. Positive outside the solid. */
static double depth_margin(const struct segment *p, double s)
{
    struct pair_sample at;
    p->output.sampler(p->output.segment, s, &at);
    const double depth = at.of[PAIR_GAP][0] + p->pair.shape.source_radius;
    const struct solid_place place = contact_place_at(
        &p->pair.shape.solid, path_at(p->pair.flight.c, SEPARATION_DEGREE + 1, segment_time(p, s)));
    if (depth > 0.0) {
        return depth;
    }
    return p->pair.shape.solid.zone == ZONE_SIDE
               ? depth - place.axial
               : fmin(depth - place.radial, p->pair.shape.solid.half_height + depth);
}

/* Places at which that is looked at. A centre comes so deep in soft contact only, which a segment follows for
 * a few radians. */
enum { DEPTHS = 64, DEPTH_HALVINGS = 100 };

static double end_by_depth(const struct segment *p, double end)
{
    const double beyond = -zone_path_rounding(&p->pair.shape.solid, &p->pair.flight);
    double low = 0.0;
    for (int i = 1; i <= DEPTHS; ++i) {
        double high = end * i / DEPTHS;
        if (depth_margin(p, high) < beyond) {
            for (int k = 0; k < DEPTH_HALVINGS && depth_margin(p, low) > beyond; ++k) {
                const double middle = 0.5 * (low + high);
                *(depth_margin(p, middle) < beyond ? &high : &low) = middle;
            }
            return high;
        }
        low = high;
    }
    return (double)INFINITY;
}

/* Between two samples a quantity may have one extremum larger than both, but less than four times as large
 * (terminal_event.c). */
static bool may_be_inside(const struct segment *p)
{
    double deepest = 0.0;
    for (int i = 0; i < p->output.count; ++i) {
        deepest = fmax(deepest, fabs(p->output.at[i].of[PAIR_GAP][0]));
    }
    return 4.0 * deepest >= p->pair.shape.source_radius;
}

void zone_end_note(struct segment *p)
{
    p->leaves_zone = false;
    if (!contact_is_capped(&p->pair.shape)) {
        return;
    }
    const double end = fmin(p->end, p->terminal.s);
    double s;
    if (contact_is_rim(&p->pair.shape)) {
        s = end_at_rim(p);
    } else {
        s = end_of_face(p, end);
        if (may_be_inside(p)) {
            s = fmin(s, end_by_depth(p, fmin(s, end)));
        }
    }
    if (s <= p->end && s < p->terminal.s) {
        p->terminal.s = s;
        p->terminal.regime = p->regime;
        p->leaves_zone = true;
    }
}

#endif
