#include "segment/scene_output.h"

#include "math/gauss.h"
#include "scene/free_bodies.h"
#include "scene/scene_jet.h"

static void put_terms(double of[3], const double term[JET_TERMS])
{
    of[0] = term[0];
    of[1] = term[1];
    of[2] = 2.0 * term[2];
}

static void scene_at(const struct scene_output *o, double clock, struct scene_state *q,
                     struct scene_instant *at)
{
    scene_state_look(o->state, q);
    q->clock = clock;
    if (o->move) {
        o->move(o->mover, clock, q);
    }
    scene_evaluate(o->values, q, clock, free_bodies_now(q), at);
}

/* A dense_output_sampler; its variable is the clock. */
static void sample_scene(const void *output, double clock, struct pair_sample *sample)
{
    const struct scene_output *o = output;
    struct scene_state q;
    struct scene_instant at;
    struct scene_jet along;
    scene_at(o, clock, &q, &at);
    jet_of_motion(o->values, &q, &at, &along);
    const struct contact_jet *jet = &along.contact[o->contact];
    put_terms(sample->of[PAIR_GAP], jet->gap);
    put_terms(sample->of[PAIR_GAP_RATE], jet->gap_rate);
    put_terms(sample->of[PAIR_FORCE], jet->normal_force);
}

/* In the centre of solid bodies n reverses, and the force of a dashpot with it: it is largest right before or
 * right after. There the gap, which falls at `low` and rises at `high`, is least. */
static void note_at_centre(const struct scene_output *o, double low, double high, struct contact_peaks *peaks)
{
    struct pair_sample at;
    for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high)) {
        sample_scene(o, middle, &at);
        contact_peaks_note(peaks, at.of[PAIR_FORCE][0], -at.of[PAIR_GAP][0]);
        *(at.of[PAIR_GAP][1] < 0.0 ? &low : &high) = middle;
    }
}

/* Whether the motion may have come through the centre: the bodies overlap by more than half the distance at
 * which they touch, and approach no more. */
static bool may_pass_centre(const struct scene_output *o, const struct pair_sample *before,
                            const struct pair_sample *after)
{
    const struct contact_shape shape = scene_contact_shape(o->values, o->state, o->contact);
    return shape.side > 0 && -2.0 * after->of[PAIR_GAP][0] > contact_reach(&shape) &&
           before->of[PAIR_GAP][1] < 0.0 && after->of[PAIR_GAP][1] > 0.0;
}

void scene_output_note_peaks(struct scene_output *o, double from, double to, int parts,
                             struct contact_peaks *peaks)
{
    static const struct event_function force = {PAIR_FORCE, 1.0, 0.0};
    static const struct event_function penetration = {PAIR_GAP, -1.0, 0.0};
    struct dense_output *w = &o->output;
    w->sampler = sample_scene;
    w->segment = o;
    if (w->count == 0) {
        dense_output_add(w, from);
    }
    for (int i = 1; i <= parts; ++i) {
        const double place = i < parts ? from + (to - from) * i / parts : to;
        if (place > w->s[w->count - 1]) {
            dense_output_add(w, place);
        }
    }
    const int last = w->count - 1;
    for (int i = 0; i < last; ++i) {
        if (may_pass_centre(o, &w->at[i], &w->at[i + 1])) {
            note_at_centre(o, w->s[i], w->s[i + 1], peaks);
        }
    }
    peaks->penetration = dense_output_largest(w, &penetration, w->s[last], &w->at[last], peaks->penetration);
    peaks->force = dense_output_largest(w, &force, w->s[last], &w->at[last], peaks->force);
    w->s[0] = w->s[last];
    w->at[0] = w->at[last];
    w->count = 1;
}

#if SCENE_HAS_TORQUES && SCENE_ANY_FREE
void scene_output_add_torque(const struct scene_output *o, double from, double to, int panels,
                             struct scene_state *q)
{
    struct vec3 *sum = &q->contact[o->contact].torques.destination_impulse;
    const double half = 0.5 * (to - from) / panels;
    if (scene_turns(o->values) || body_shape(contact_destination(o->contact)) == SHAPE_SPHERE) {
        return;
    }
    for (int i = 0; i < panels * GAUSS_NODES; ++i) {
        struct scene_state then;
        struct scene_instant at;
        const int node = i % GAUSS_NODES;
        const int panel = i / GAUSS_NODES;
        scene_at(o, from + half * (2.0 * panel + 1.0 + GAUSS_NODE[node]), &then, &at);
        *sum = vec3_axpy(*sum, half * GAUSS_WEIGHT[node], scene_torque_of_force(&at, o->contact));
    }
}
#else
void scene_output_add_torque(const struct scene_output *o, double from, double to, int panels,
                             struct scene_state *q)
{
    (void)o, (void)from, (void)to, (void)panels, (void)q;
}
#endif
