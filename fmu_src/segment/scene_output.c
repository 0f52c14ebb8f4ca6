#include "segment/scene_output.h"

#include "scene/free_bodies.h"
#include "scene/scene_jet.h"
#include "segment/dense_output.h"

/* The scene at a clock; q becomes its state. */
static void scene_output_at(const struct scene_output *o, double clock, struct scene_state *q,
                            struct scene_instant *at)
{
    *q = *o->state;
    q->clock = clock;
    if (o->move) {
        o->move(o->mover, clock, q);
    }
    scene_evaluate(o->values, q, clock, free_bodies_now(q), at);
}

static void put_terms(double of[3], const double term[JET_TERMS])
{
    of[0] = term[0];
    of[1] = term[1];
    of[2] = 2.0 * term[2];
}

/* A dense_output_sampler; its variable is the clock. */
static void sample_scene(const void *output, double clock, struct pair_sample *sample)
{
    const struct scene_output *o = output;
    struct scene_state q;
    struct scene_instant at;
    struct scene_jet along;
    scene_output_at(o, clock, &q, &at);
    jet_of_motion(o->values, &q, &at, &along);
    const struct contact_jet *jet = &along.contact[o->contact];
    put_terms(sample->of[PAIR_GAP], jet->gap);
    put_terms(sample->of[PAIR_GAP_RATE], jet->gap_rate);
    put_terms(sample->of[PAIR_FORCE], jet->normal_force);
}

static struct vec3 normal_at(const struct scene_output *o, double clock)
{
    struct scene_state q;
    struct scene_instant at;
    scene_output_at(o, clock, &q, &at);
    return at.geometry[o->contact].normal;
}

static void note_scene_at(const struct scene_output *o, double clock, struct contact_peaks *peaks)
{
    struct scene_state q;
    struct scene_instant at;
    scene_output_at(o, clock, &q, &at);
    contact_peaks_note(peaks, at.normal_force[o->contact], -at.geometry[o->contact].gap);
}

/* In the centre of solid bodies n reverses, and the force of a dashpot with it: it is largest right before or
 * right after. */
static void note_at_centre(const struct scene_output *o, double from, double to, struct contact_peaks *peaks)
{
    const struct vec3 normal = normal_at(o, from);
    if (!(vec3_dot(normal, normal_at(o, to)) < 0.0)) {
        return;
    }
    for (double middle = 0.5 * (from + to); middle > from && middle < to; middle = 0.5 * (from + to)) {
        const bool is_before = vec3_dot(normal, normal_at(o, middle)) >= 0.0;
        from = is_before ? middle : from;
        to = is_before ? to : middle;
    }
    note_scene_at(o, from, peaks);
    note_scene_at(o, to, peaks);
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
        if (w->at[i].of[PAIR_GAP][1] < 0.0 && w->at[i + 1].of[PAIR_GAP][1] > 0.0) {
            note_at_centre(o, w->s[i], w->s[i + 1], peaks);
        }
    }
    peaks->penetration = dense_output_largest(w, &penetration, w->s[last], &w->at[last], peaks->penetration);
    peaks->force = dense_output_largest(w, &force, w->s[last], &w->at[last], peaks->force);
    w->s[0] = w->s[last];
    w->at[0] = w->at[last];
    w->count = 1;
}
