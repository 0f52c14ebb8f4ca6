#include "segment/kinds.h"

#if SCENE_ANY_CAPS

/* A step is a fifth of the radius of convergence at most (TAYLOR_ORDER); within a quarter of it no quantity
 * of the contact has two extrema. */
enum { PLACES_AT_RIM = 5 };

bool rim_applies(const struct segment *p)
{
    return contact_is_rim(&p->pair.shape);
}

#if SCENE_ANY_HERTZ
/* Whether the series goes by u; at rest at the touch it cannot, for a while (p->longest). */
static bool goes_by_root(struct segment *p)
{
    if (!contact_is_hertz(&p->pair.law)) {
        return false;
    }
    const double coasting = hertz_coasting_time(p);
    p->longest = coasting > 0.0 ? coasting : p->longest;
    return !(coasting > 0.0);
}

/* Whether it is for the slow kind to make. */
static bool is_slow_at_rim(struct segment *p)
{
    const struct rim_series *made = &p->as.rim;
    p->may_be_slow = p->may_be_slow && made->by_root && hertz_is_slow(p, made->root, made->unit);
    return p->may_be_slow;
}

static double parting_at_rim(const struct rim_series *made)
{
    return made->by_root ? pair_hertz_parting(made->root, made->step) : (double)INFINITY;
}

static void note_parting(struct segment *p, double parting)
{
    if (p->as.rim.by_root) {
        hertz_find_terminal_event(p, parting <= p->end ? parting : (double)INFINITY);
    }
}
#else
static bool goes_by_root(struct segment *p)
{
    (void)p;
    return false;
}

static bool is_slow_at_rim(struct segment *p)
{
    (void)p;
    return false;
}

static double parting_at_rim(const struct rim_series *made)
{
    (void)made;
    return (double)INFINITY;
}

static void note_parting(struct segment *p, double parting)
{
    (void)p, (void)parting;
}
#endif

bool rim_make(struct segment *p)
{
    struct rim_series *made = &p->as.rim;
    const bool by_root = goes_by_root(p); /* may shorten p->longest */
    rim_series_make(made, &p->pair, by_root, p->longest);
    if (is_slow_at_rim(p)) {
        return false;
    }
    p->unit = made->unit;
    const double parting = parting_at_rim(made);
    p->end = fmin(made->step, parting > 0.0 ? parting : made->step);
    if (parting > 0.0 && rim_series_time(made, p->end) > p->longest) {
        p->end = rim_series_place(made, p->longest, p->end);
    }
    for (int i = 0; i < PLACES_AT_RIM; ++i) {
        dense_output_add(&p->output, p->end * i / (PLACES_AT_RIM - 1));
    }
    note_parting(p, parting);
    return true;
}

#endif
