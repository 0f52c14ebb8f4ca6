#include "integrator/phases.h"

#include <float.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "flight/flight.h"
#include "integrator/cvode.h"
#include "integrator/general.h"
#include "integrator/prediction.h"
#include "prescribed/prescribed.h"
#include "scene/evaluate.h"
#include "touch/chain.h"
#include "touch/island.h"
#include "touch/rubbing.h"

/* A phase of contact pairs consists of one of these. */
enum phase_form {
    PHASE_OF_SEGMENTS, /* of pairs that share no free body */
    PHASE_OF_CHAIN,    /* all contacts in touch are a row (touch/chain.h) */
    PHASE_OF_ISLAND    /* all contacts in touch have one power series (touch/island.h) */
};

/*
 * In a phase of contact pairs all pairs that are in contact advance together, each by one segment, or all of
 * them by a chain or a power series. The phase ends at the first terminal event, the first end of a segment,
 * or the first passage of a centre. It may reach beyond the communication point. Its motion follows from
 * struct phase_start alone: communication points within the phase only read it, and a restored state makes
 * the segments again, bit by bit.
 */
struct pair_phase {
    struct segment segment[SCENE_CONTACTS];
    enum phase_form form;
    struct chain chain;
    struct island *island; /* behind this struct, where there may be one */
    double longest, time;  /* limit and length of the phase [s] */
    long work;             /* in the units of struct advance */
    int terminal;          /* the contact with a terminal event at the phase's end; -1: none */
    enum contact_regime next;
    bool lifts;                   /* whether the sign of that contact's force changes, and with it friction */
    struct phase_start made_from; /* the start that the segments were made from; its `end` 0: none */
};

bool integrator_open(struct integrator *s, const struct scene_values *v,
                     const struct integrator_memory *memory)
{
    s->message[0] = '\0';
    if (s->pairs == NULL) {
        s->pairs = memory->allocate(1, sizeof *s->pairs + (SCENE_HAS_ISLANDS ? sizeof *s->pairs->island : 0));
        s->release = memory->release;
        if (s->pairs == NULL) {
            snprintf(s->message, sizeof s->message, "the integrator's memory could not be had");
            return false;
        }
        s->pairs->island = SCENE_HAS_ISLANDS ? (void *)(s->pairs + 1) : NULL;
    }
    if (!scene_uses_ode(v) || (scene_is_force_element(v) && !scene_turns(v))) {
        return true;
    }
#if SCENE_HAS_GENERAL
    if (solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN) {
        return general_open(&s->general, v, memory, s->message);
    }
#endif
#ifdef CONTACT_WITH_CVODE
    return cvode_open(&s->cvode, v, memory, s->message);
#else
    (void)memory;
    snprintf(s->message, sizeof s->message, "this FMU has no CVODE");
    return solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN;
#endif
}

void integrator_close(struct integrator *s)
{
#if SCENE_HAS_GENERAL
    if (s->general != NULL) {
        general_close(&s->general);
    }
#endif
#ifdef CONTACT_WITH_CVODE
    cvode_close(&s->cvode);
#endif
    if (s->pairs != NULL) {
        s->release(s->pairs);
        s->pairs = NULL;
    }
}

/* Returns the present instant without accelerations and forces. It is computed once and then reused. */
static const struct scene_instant *advance_now(struct advance *step, const struct scene_state *q)
{
    if (!step->is_now) {
        scene_kinematics_now(q, &step->now);
        step->is_now = true;
    }
    return &step->now;
}

/* The horizon is at most the longer of LONGEST_HORIZON [s] and HORIZON_GROWTH times the time since the phase
 * began. Over so long a time a path of degree four becomes so long that bodies measure 1e-72 of it; the
 * fourth power of this size is still above underflow. */
static const double LONGEST_HORIZON = 1e18;
static const double HORIZON_GROWTH = 1e3;

/* A search reaches this many times as far as the flight has come, so that a flight of many short steps is
 * searched a few times only. The factor is no integer, because a search that ends at a communication point
 * serves one step less. With 16.5 P2 takes 3 % fewer instructions in 997 steps than with 8.5. A search for
 * the next impact of a pair reaches as many times as far as the last flight lasted, because flights between
 * impacts are often of one order of magnitude. Where an axis turns or the destination is a torus, searches
 * cost in proportion to the time that they look ahead, and do not reach so far. */
static const double SEARCH_GROWTH = 16.5;

/* Notes for every contact when its regime changes next; does nothing before the horizon is reached. The
 * search reaches at least to the end of the step. Where the step begins at an impact, at a new input or at
 * the start (step->passed = 0), the last flight does not count: a run of one step would not use it. */
static inline void look_ahead(struct scene_state *q, double remaining, struct advance *step)
{
    if (q->horizon_clock > q->clock) {
        return;
    }
    const struct scene_instant *at = advance_now(step, q);
    const bool knows = SCENE_CONTACTS == 1 && step->passed > 0.0 && !contact_advances(q->v, 0);
    const double known = knows ? larger(q->clock, q->last_flight) : q->clock;
    double horizon =
        fmin(larger(remaining, SEARCH_GROWTH * known), larger(LONGEST_HORIZON, HORIZON_GROWTH * q->clock));
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        const struct prediction found = prediction_of(at, j, horizon, step->budget);
        horizon = found.searched;
        advance_spend(step, found.evaluations, found.evaluations);
        q->contact[j].schedule.change_clock = q->clock + found.next.after;
        q->contact[j].schedule.change_regime = (int32_t)found.next.regime;
        q->contact[j].schedule.change_gap = found.next.gap;
        q->contact[j].schedule.passes_centre = found.next.passes_centre;
    }
    q->horizon_clock = q->clock + horizon;
}

/* Puts the free bodies to their places in flight at a clock. */
static void put_flown(void *unused, double clock, struct scene_state *q)
{
    (void)unused;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        if (body_is_free(q->v, i)) {
            q->body[i] = flight_body_at(q, i, clock);
        }
    }
}

/* The search for the least gap of a separating contact divides its flight into so many parts. */
enum { RELEASED_PARTS = 16 };

/* Notes the peak penetration of separating contacts with a prescribed body. Such a contact may close further,
 * where the prescribed displacement does not agree with the prescribed velocity. */
static void note_depth_of_released(struct scene_state *q, struct advance *step)
{
    for (int j = 0; SCENE_ANY_PRESCRIBED && j < SCENE_CONTACTS; ++j) {
        const bool led =
            body_is_prescribed(q->v, contact_source(j)) || body_is_prescribed(q->v, contact_destination(j));
        if (led && q->contact[j].regime == REGIME_SEPARATING && !contact_advances(q->v, j)) {
            struct contact_peaks peaks = {0.0, 0.0};
            struct scene_output output = {.state = q, .contact = j, .move = put_flown};
            scene_output_note_peaks(&output, q->clock, step->clock_end, RELEASED_PARTS, &peaks);
            struct scene_instant now;
            scene_kinematics_now(q, &now);
            if (peaks.penetration > rounding_of_gap(&now, j) - now.geometry[j].gap) {
                contact_peaks_note(&q->contact[j].peaks, 0.0, peaks.penetration);
            }
        }
    }
}

/* Returns the error allowed in a segment [m]. It is a thousandth of the tolerances, because impacts amplify
 * errors. Near the centre it is reduced in proportion to the distance d, because an error e perpendicular to
 * the normal n turns n by the angle e / d. It is never below rounding. */
static double tolerance_of(const struct scene_instant *at, int contact)
{
    const struct contact_shape shape = scene_contact_shape(at->q, contact);
    const double reach = contact_reach(&shape);
    const double distance = contact_is_plane(&shape) ? reach : at->geometry[contact].distance;
    const double size = fmax(distance, reach);
    const double asked = solver_relative_tolerance(at->v) * size + solver_absolute_tolerance(at->v);
    return fmax(1e-3 * asked * (distance / size), 8.0 * DBL_EPSILON * size);
}

/* Whether segments can be made for the contact pairs: neither turning nor rubbing prevents them, and no free
 * body takes part in two contacts that transmit forces. others_apart_for sees to it that no other contact
 * begins: the gap of such a contact must change no faster than its separation, so that a bound of the speeds
 * shows how long it stays apart, and nothing that turns may change the gap. */
static bool pairs_are_alone(const struct scene_instant *at)
{
    const struct scene_state *q = at->q;
    for (int j = 0; SCENE_ANY_TURNING && scene_turns(q->v) && j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(q, j) && !rubbing_is_solvable(at, j)) {
            return false;
        }
    }
    for (int j = 0; SCENE_CONTACTS > 1 && j < SCENE_CONTACTS; ++j) {
        const bool turns = contact_tips(q->v, j) || body_is_compound(contact_source(j)) ||
                           body_is_compound(contact_destination(j));
        if (contact_is_coupled(q, j) && (contact_transmits(q, j) || turns)) {
            return false;
        }
    }
    return true;
}

/* Whether the general segment keeps a step that may go on beyond the present. */
static bool keeps_step(const struct scene_state *q)
{
    return SCENE_HAS_GENERAL && !q->integrator_fresh && solver_method(q->v) == SOLVER_METHOD_EVENT_DRIVEN &&
           scene_keeps_steps(q->v);
}

/* Whether the importer moves or turns a body. */
static bool is_led(const struct scene_values *v, int body)
{
    return body_is_prescribed(v, body) || body_turn_is_prescribed(v, body);
}

/* Returns the part of a relative velocity or acceleration that can change the gap of a contact: the part
 * along a plane's normal or across a cylinder's axis; the whole where the axis tilts or a zone may change. */
static struct vec3 closing_part(const struct scene_instant *at, int contact, struct vec3 a)
{
    const struct contact_shape shape = scene_contact_shape(at->q, contact);
    const bool turns = contact_tips(at->v, contact) || contact_is_zoned(&shape);
    return turns ? a : flight_part_that_counts(&shape, shape.axis, a);
}

/* Whether a contact acts on the closing part of its bodies' motion alone: it does not rub, and no other
 * contact that transmits a force shares a free body with it. */
static bool acts_one_way(const struct scene_instant *at, int contact)
{
    return !contact_rubs(at->v, contact) && !contact_is_coupled(at->q, contact);
}

/* Returns how much of a push by one contact can change the gap of another one; a rounding at least. */
static double part_that_closes(const struct scene_instant *at, int pushing, int contact)
{
    const struct contact_shape shape = scene_contact_shape(at->q, pushing);
    const bool is_along = contact_is_plane(&shape) && !contact_is_zoned(&shape) &&
                          !contact_tips(at->v, pushing) && acts_one_way(at, pushing);
    return is_along ? fmax(vec3_norm(closing_part(at, contact, shape.axis)), DBL_EPSILON) : 1.0;
}

/* Returns a bound of the mean speed at which a contact that transmits a force takes its bodies off their
 * flight, against each other, within a time from now [m/s]. A law stores the energy E and dissipates, so that
 * S = sqrt(|w|^2 + 2 E / m_red) grows by no more than the acceleration without the contact's force. Only the
 * closing parts of w and of the acceleration count where the contact acts one way (acts_one_way). Friction
 * may also make motion of rotation: E counts the energy of rotation where the contact rubs. The rate w of the
 * separation is at most S, and that of the flight is too. INFINITY stands for a body that the importer moves,
 * whose velocity may contradict its displacement, or turns. */
static double deviation_speed_at_most(const struct scene_instant *at, int contact, double time)
{
    if (is_led(at->v, contact_source(contact)) || is_led(at->v, contact_destination(contact))) {
        return (double)INFINITY;
    }
    const struct separation_path flight = separation_path_of(at, at->q->clock, contact);
    const struct contact_law law = scene_contact_law(at->q, contact);
    double stored = contact_stored_energy(&law, (enum contact_regime)at->q->contact[contact].regime,
                                          at->geometry[contact].gap);
    for (int end = 0; contact_rubs(at->v, contact) && end < 2; ++end) {
        const int body = end == 0 ? contact_source(contact) : contact_destination(contact);
        stored += body_turns_freely(at->v, body)
                      ? body_rotational_energy(at->v, body, &at->q->turning.body[body])
                      : 0.0;
    }
    const bool is_whole = !acts_one_way(at, contact);
    double acceleration = 0.0;
    for (int i = SEPARATION_DEGREE; i > 1; --i) {
        const struct vec3 part = is_whole ? flight.c[i] : closing_part(at, contact, flight.c[i]);
        acceleration = acceleration * time + i * (i - 1) * vec3_norm(part);
    }
    const struct vec3 rate = is_whole ? flight.w[0] : closing_part(at, contact, flight.w[0]);
    const double start = vec3_dot(rate, rate) + 2.0 * stored * scene_inverse_mass(at->v, contact);
    return 2.0 * (sqrt(start) + acceleration * time);
}

/* Returns a bound of the mean speed at which the bodies of a contact that is apart approach each other within
 * a time from now, while other contacts act on them [m/s]. */
static double approach_at_most(const struct scene_instant *at, int contact, double time)
{
    struct separation_path flight = separation_path_of(at, at->q->clock, contact);
    for (int i = 1; i <= SEPARATION_DEGREE; ++i) {
        flight.c[i] = closing_part(at, contact, flight.c[i]);
    }
    double speed = path_size(flight.c + 1, SEPARATION_DEGREE, time);
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        for (int end = 0; contact_transmits(at->q, j) && end < 2; ++end) {
            const int body = end == 0 ? contact_source(j) : contact_destination(j);
            if (body_is_free(at->v, body) &&
                (body == contact_source(contact) || body == contact_destination(contact))) {
                const double share = 1.0 / (body_mass(at->v, body) * scene_inverse_mass(at->v, j));
                speed += share * part_that_closes(at, j, contact) * deviation_speed_at_most(at, j, time);
            }
        }
    }
    return speed;
}

/* Bodies come no nearer than this part of the source's radius while a bound of their speed tells that they
 * stay apart. Bodies that are not twice as far are left to the general segment, which finds where they touch:
 * else such phases would become shorter without end. */
static const double NEARBY = 1e-3;

/* Returns a time for which contacts that are apart stay so while other contacts act on their bodies [s]; 0
 * where one is too near or a body is prescribed. No gap changes faster than the closing part of the
 * separation. The gaps of a chain do not count; NULL: there is none. */
static double others_apart_for(const struct scene_instant *at, const struct chain *chain, double longest)
{
    double time = longest;
    for (int j = 0; SCENE_CONTACTS > 1 && j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(at->q, j) || !contact_is_coupled(at->q, j) ||
            (SCENE_HAS_CHAINS && chain != NULL && chain->has[j])) {
            continue;
        }
        const double least = NEARBY * contact_source_radius(at->v, j);
        const double room = at->geometry[j].gap - least;
        if (!(room > least)) {
            return 0.0;
        }
        time = fmin(time, room / approach_at_most(at, j, 0.0));
        while (time > 0.0 && time * approach_at_most(at, j, time) > room) {
            time *= 0.5;
        }
    }
    return time;
}

/* A segment that lasts at least this part of the time asked for ends there within rounding. Such a segment
 * does not shorten the segments of the other pairs. */
static const double ALL_OF_IT = 1.0 - 4.0 * DBL_EPSILON;

static bool add_pair(struct pair_phase *all, const struct scene_instant *at, int contact)
{
    struct segment *p = &all->segment[contact];
    const double longest =
        all->time > 0.0 ? all->time : all->longest; /* the segment of another pair may end earlier */
    if (!segment_make(p, at, contact, longest, tolerance_of(at, contact))) {
        return false;
    }
    if (SCENE_ANY_FRICTION && p->rubs && !rubbing_allows(p, at->q, contact)) {
        return false;
    }
    all->work += p->work; /* also of segments that are made again */
    const double end = segment_time(p, p->end);
    const double terminal = p->terminal.s <= p->end ? segment_time(p, p->terminal.s) : (double)INFINITY;
    const double latest = all->terminal < 0 ? all->time / ALL_OF_IT : all->time;
    if (p->terminal.s <= p->end && terminal < latest) {
        all->time = terminal;
        all->terminal = contact;
        all->next = p->terminal.regime;
        all->lifts = SCENE_ANY_FRICTION && p->terminal.lifts;
    } else if (end < all->time && end < longest * ALL_OF_IT) {
        all->time = end;
        all->terminal = -1;
    }
    return true;
}

/* Begins to make a phase of one form. Until an end is found, the phase lasts as long as it may. */
static void begin_form(struct pair_phase *all, enum phase_form form, double longest)
{
    all->form = form;
    all->longest = all->time = longest;
    all->work = 0;
    all->terminal = -1;
    all->lifts = false;
}

/* Makes the chain, up to the time for which the contacts outside it stay apart. */
static bool make_chain(struct pair_phase *all, const struct scene_instant *at, double longest)
{
    if (!SCENE_HAS_CHAINS || !chain_make(&all->chain, at)) {
        return false;
    }
    struct chain *c = &all->chain;
    begin_form(all, PHASE_OF_CHAIN, others_apart_for(at, c, longest));
    if (!(all->longest > 0.0)) {
        return false;
    }
    chain_find_end(c, all->longest);
    all->time = c->end;
    /* the work is that of the modes, and of the search for events and peaks in each radian of the fastest */
    all->work = 4 * c->touching + (long)(c->end * c->fastest * (1.0 + 0.25 * c->rows));
    if (c->terminal >= 0) {
        all->terminal = c->contact[c->terminal];
        all->next = contact_transmits(at->q, all->terminal) ? REGIME_APART : REGIME_COMPRESSION;
    }
    return true;
}

/* Makes the power series of all contacts in touch. */
static bool make_island(struct pair_phase *all, const struct scene_instant *at, double longest)
{
    double quiet = (double)INFINITY;
    if (!SCENE_HAS_ISLANDS || scene_turns(at->q->v)) {
        return false;
    }
    struct island *s = all->island;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        if (contact_transmits(at->q, j)) {
            quiet = fmin(quiet, tolerance_of(at, j));
        }
    }
    if (!island_make(s, at, longest, quiet)) {
        return false;
    }
    begin_form(all, PHASE_OF_ISLAND, longest);
    all->work = 4 + 4L * s->terms.rows;
    all->time = s->terminal < 0 && s->time >= longest * ALL_OF_IT ? longest : fmin(s->time, longest);
    all->terminal = s->terminal;
    all->next = s->next;
    return true;
}

/* Makes the segments of all pairs, as long as contacts that are apart stay so. Where one pair shortens the
 * phase, the segments made before are made again, because a segment is most accurate at its own end. */
static bool make_segments(struct pair_phase *all, const struct scene_instant *at, double longest)
{
    if (!pairs_are_alone(at)) {
        return false;
    }
    begin_form(all, PHASE_OF_SEGMENTS, others_apart_for(at, NULL, longest));
    if (!(all->longest > 0.0)) {
        return false;
    }
    for (double before = (double)INFINITY; all->time < before;) {
        before = SCENE_CONTACTS > 1 ? all->time : 0.0;
        for (int j = 0; j < SCENE_CONTACTS; ++j) {
            if (contact_pushes(at->q, j) && j != all->terminal && !add_pair(all, at, j)) {
                return false;
            }
        }
    }
    return true;
}

/* Makes a phase of at most `longest` [s]: a chain or an island of contacts that act on each other, or the
 * segments of pairs while all other contacts of their bodies stay apart. */
static bool make_phase(struct pair_phase *all, const struct scene_instant *at, double longest)
{
    bool coupled = false; /* whether contacts act on each other through free bodies */
    for (int j = 0; SCENE_HAS_ISLANDS && !coupled && j < SCENE_CONTACTS; ++j) {
        coupled = contact_is_coupled(at->q, j);
    }
    return (coupled && make_chain(all, at, longest)) || make_segments(all, at, longest) ||
           (coupled && make_island(all, at, longest));
}

/* Integrates the prescribed contacts to the clock `end`; returns the clock reached. */
static double integrate_prescribed(struct scene_state *q, double end, struct advance *step)
{
    const long before = step->budget;
    const double reached = prescribed_integrate(q, end, &step->budget);
    advance_spend(step, 0, PANEL_WORK * (before - step->budget));
    return reached;
}

/* Turns the bodies on which no friction acts for a time from now, and adds the external work on bodies on
 * which no contact force acts. */
static void fly_bodies(struct scene_state *q, double time, double clock)
{
    for (int i = 0; (SCENE_ANY_ROTATION || SCENE_CONTACTS > 1) && i < SCENE_BODIES; ++i) {
        bool turns = SCENE_ANY_ROTATION && body_turns_freely(q->v, i);
        for (int j = 0; turns && j < SCENE_CONTACTS; ++j) {
            turns = !(contact_source(j) == i && contact_transmits(q, j) && contact_rubs(q->v, j));
        }
        if (turns) {
            flight_turn(q, i, clock);
        }
        if (SCENE_CONTACTS > 1 && body_is_free(q->v, i) && !body_is_loaded(q, i, -1)) {
            q->external_work += flight_work(q, i, q->body[i].velocity, q->clock, time);
        }
    }
}

/* Copies `size` bytes of the present to `kept`, or back. */
static void keep(void *present, void *kept, size_t size, bool back)
{
    memcpy(back ? present : kept, back ? kept : present, size);
}

/* Keeps what a phase changes from its start on, or moves the scene back to that start. */
static inline void keep_start(struct scene_state *q, bool back)
{
    struct phase_start *start = &q->phase;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        keep(&q->contact[j].physics, &start->contact[j], sizeof start->contact[j], back);
    }
    keep(q->body, start->body, sizeof q->body, back);
    keep(q->turning.body, start->turn, sizeof start->turn, back);
    keep(&q->dissipated, &start->dissipated, sizeof q->dissipated, back);
    keep(&q->external_work, &start->external_work, sizeof q->external_work, back);
    keep(&q->friction_energy, &start->friction_energy, sizeof q->friction_energy, back);
    keep(&q->counters, &start->counters, sizeof q->counters, back);
}

/* Moves the scene to a clock within the phase, and notes the peaks since the clock `noted`. A phase of zero
 * length moves nothing, because a segment starts at the present state to its tolerance only. */
static void follow_pairs(struct pair_phase *all, struct scene_state *q, double noted, double clock)
{
    const double time = clock == q->phase.end ? all->time : clock - q->phase.clock;
    const double from = noted - q->phase.clock;
    if (q->phase.followed > q->phase.clock) {
        keep_start(q, true);
        q->clock = q->phase.clock;
    }
    const double stored = flight_stored_energy(q, false);
    if (SCENE_HAS_ISLANDS && all->form != PHASE_OF_SEGMENTS && time > 0.0) {
        if (SCENE_HAS_CHAINS && all->form == PHASE_OF_CHAIN) {
            chain_advance(&all->chain, from, time, q);
        } else {
            island_advance(all->island, from, time, q);
        }
        counter_add(&q->counters.steps, 1);
        counter_add(&q->counters.force_evaluations, 1);
    }
    for (int j = 0; all->form == PHASE_OF_SEGMENTS && time > 0.0 && j < SCENE_CONTACTS; ++j) {
        if (contact_pushes(q, j)) {
            struct segment *p = &all->segment[j];
            const bool is_shortened = j == all->terminal || time < segment_time(p, p->end);
            const double s = is_shortened ? segment_place(p, time) : p->end;
            const double since = fmin(segment_place(p, from), s);
            if (SCENE_ANY_FRICTION && p->rubs) {
                rubbing_advance(p, since, s, q, j);
            } else {
                segment_advance(p, since, s, q, j);
            }
            counter_add(&q->counters.steps, 1);
            counter_add(&q->counters.force_evaluations, 1);
        }
    }
    if (time > 0.0) {
        fly_bodies(q, time, clock);
        q->clock = clock;
        flight_restore(q);
    }
    q->dissipated += stored - flight_stored_energy(q, false);
    q->phase.followed = clock;
}

/* Makes the segments of a phase anew where those in memory belong to another phase. */
static bool restore_pairs(struct pair_phase *all, const struct scene_state *q)
{
    if (memcmp(&all->made_from, &q->phase, offsetof(struct phase_start, followed)) == 0) {
        return true;
    }
    struct scene_state start;
    struct scene_instant at;
    scene_state_copy(q, &start);
    keep_start(&start, true);
    start.clock = start.phase.clock;
    scene_kinematics_now(&start, &at);
    all->made_from = q->phase;
    return make_phase(all, &at, q->phase.longest);
}

/* Returns the length [s] beyond which a longer phase does harm: each reading of it would cost more, or the
 * places of a deep contact, as the sum of a long flight and of what nearly cancels it, would be rounded
 * more. */
static double harmless_time(const struct pair_phase *all, const struct scene_state *q)
{
    double time = (double)INFINITY;
    for (int j = 0; all->form == PHASE_OF_SEGMENTS && j < SCENE_CONTACTS; ++j) {
        const struct segment *p = &all->segment[j];
        if (contact_pushes(q, j)) {
            time = segment_is_deep(p)              ? 0.0
                   : SCENE_ANY_FRICTION && p->rubs ? fmin(time, rubbing_short_until(p, q, j))
                                                   : time;
        }
    }
    return time;
}

/* Begins a phase up to the clock `until`, or earlier. Returns false where that fails. */
static bool begin_pairs(struct pair_phase *all, struct scene_state *q, double until, struct advance *step)
{
    const double asked = until - q->clock;
    if (until > step->clock_end) {
        step->is_now = false; /* the instant is computed as restore_pairs computes it */
    }
    const struct scene_instant *at = advance_now(step, q);
    all->made_from.end = 0.0;
    if (!make_phase(all, at, asked)) {
        return false;
    }
    until = all->longest < asked ? q->clock + all->longest : until;
    const double harmless = until > step->clock_end ? harmless_time(all, q) : (double)INFINITY;
    if (q->clock + harmless < until) {
        until = fmax(q->clock + harmless, step->clock_end);
        if (!make_segments(all, at, until - q->clock)) {
            return false;
        }
    }
    q->phase.clock = q->phase.followed = q->clock;
    q->phase.end = all->time < all->longest ? q->clock + all->time : until;
    if (q->phase.end > step->clock_end) { /* else nothing returns to the start */
        q->phase.longest = all->longest;
        keep_start(q, false);
        all->made_from = q->phase;
    }
    advance_spend(step, 1, all->work);
    return true;
}

/* Returns the clock up to which a phase that begins now may reach [s]. It reaches beyond the end of the
 * communication step, up to what is foreseen, but only in proportion to `passed` [s], a time in which no
 * input has changed. What reaches beyond the next communication point would be wasted where an input changes
 * at every point, and so would what reaches beyond the only step of a run. */
static double unforeseen_until(const struct scene_state *q, double passed)
{
    double until = q->clock + HORIZON_GROWTH * passed;
    for (int j = 0; j < SCENE_CONTACTS; ++j) {
        /* a segment shows every change of its contact but the passage of a cylinder's end; nothing foresees
         * changes where bodies turn and a contact acts on them */
        const bool foreseen = contact_pushes(q, j) ? !scene_turns(q->v) && scene_ends_suddenly(q->v, j)
                                                   : !scene_turns(q->v) || !contact_is_coupled(q, j);
        until = fmin(until, q->contact[j].schedule.change_clock);
        until = foreseen ? fmin(until, q->horizon_clock) : until;
        if (SCENE_ANY_PRESCRIBED_CONTACT && contact_is_prescribed(q->v, j)) {
            until = q->clock; /* its quadrature cannot be returned to its start */
        }
    }
    return until;
}

/* Advances the contact pairs phase by phase, together with the prescribed contacts. */
static enum advance_result advance_pairs(struct integrator *s, struct scene_state *q, struct advance *step)
{
    struct pair_phase *all = s->pairs;
    while (q->clock < step->clock_end) {
        if (advance_is_spent(step)) {
            return ADVANCE_STEP_LIMIT;
        }
        const bool made =
            q->phase.end > q->clock
                ? restore_pairs(all, q)
                : begin_pairs(all, q, fmax(step->clock_end, unforeseen_until(q, step->passed)), step);
        if (!made) {
            return ADVANCE_FAILED;
        }
        q->integrator_fresh = 1;
        double reached = q->phase.end;
        if (SCENE_ANY_PRESCRIBED_CONTACT && SCENE_CONTACTS > 1) {
            reached = integrate_prescribed(q, q->phase.end, step);
        }
        const bool whole = !(reached < q->phase.end);
        if (!whole) { /* the budget ends the phase early */
            all->time = reached - q->clock;
            all->terminal = -1;
            q->phase.end = reached;
        }
        const bool ends = !(step->clock_end < q->phase.end);
        step->is_now = false;
        follow_pairs(all, q, q->clock, ends ? q->phase.end : step->clock_end);
        if (!ends) {
            return ADVANCE_REACHED;
        }
        q->phase.end = 0.0;
        if (!whole) {
            return ADVANCE_STEP_LIMIT;
        }
        if (all->terminal >= 0) {
            step->contact = all->terminal;
            step->regime = all->next;
            step->event = all->lifts ? ODE_EVENT_LIFT : ODE_EVENT_GAP;
            return ADVANCE_EVENT;
        }
    }
    return ADVANCE_REACHED;
}

/* The phases of motion stand in order of preference. One that applies may give up where the motion is too
 * hard for it (ADVANCE_FAILED). The next one that applies then goes on from there. */
static enum advance_result advance_phase(struct integrator *s, struct scene_state *q, struct advance *step)
{
    const struct scene_values *v = q->v;
    enum advance_result result = ADVANCE_FAILED;
    if (!(step->clock_end > q->clock)) {
        return ADVANCE_REACHED;
    }
    s->message[0] = '\0';
    if (SCENE_ANY_PRESCRIBED_CONTACT && scene_is_force_element(v) && !scene_turns(v)) {
        q->clock = integrate_prescribed(q, step->clock_end, step);
        return q->clock < step->clock_end ? ADVANCE_STEP_LIMIT : ADVANCE_REACHED;
    }
    if (flight_is_free(q)) {
        if (SCENE_CONTACTS > 1 && !scene_turns(v)) {
            q->integrator_fresh = 1; /* no step of the general segment goes on */
        }
        note_depth_of_released(q, step);
        flight_advance(q, step->clock_end);
        return ADVANCE_REACHED;
    }
    /* a kept step of the general segment that reaches beyond the present precedes a new island */
    const bool goes_on = keeps_step(q) && q->unfinished.present == q->clock && q->unfinished.end > q->clock;
    if (solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN &&
        (!goes_on || pairs_are_alone(advance_now(step, q)))) {
        result = advance_pairs(s, q, step);
    }
#if SCENE_HAS_GENERAL
    if (result == ADVANCE_FAILED && solver_method(v) == SOLVER_METHOD_EVENT_DRIVEN && scene_uses_ode(v)) {
        counter_add(&q->counters.fallbacks, 1);
        /* A step of the general segment that goes on beyond the communication point must be more accurate.
         * Right after a touch that costs more than it saves. */
        const double passed = fmax(q->clock + scene_remaining(q, step->start), 0.0);
        step->clock_limit = fmax(step->clock_end, unforeseen_until(q, passed));
        result = general_advance(s->general, q, step);
    }
#endif
#ifdef CONTACT_WITH_CVODE
    if (result == ADVANCE_FAILED && solver_method(v) != SOLVER_METHOD_EVENT_DRIVEN) {
        result = cvode_advance(s->cvode, q, step);
    }
#endif
    if (result == ADVANCE_FAILED && s->message[0] == '\0') {
        snprintf(s->message, sizeof s->message, "no segment of the motion can be made from here");
    }
    return result;
}

/* Takes the event that ended a phase; returns whether a contact begins or ends by it. */
static bool take_event(struct scene_state *q, struct advance *step)
{
    const int32_t *regime = &q->contact[step->contact].regime;
    const bool touched = *regime != (int32_t)REGIME_APART;
    transition_take_event(q, step->contact, step->event, step->regime, &step->now);
    step->is_now = true;
    return touched != (*regime != (int32_t)REGIME_APART);
}

/* Returns the end of the step [s] after a contact has begun or ended. The caller's at_event may read the
 * outputs and end the step earlier. It is not called at the start, so that every step advances. */
static double end_after_event(const struct step_request *request, struct scene_state *q, double start,
                              double end_time)
{
    const double time = scene_time(q);
    if (request->at_event == NULL || !(time > start)) {
        return end_time;
    }
    q->step_length = time - start;
    return fmin(end_time, request->at_event(request->context, end_time));
}

/* If more changes of regimes than this happen at one instant, they are taken to be endless. So many changes
 * take some hundredths of a second to compute. */
enum { MOST_AT_ONCE = 10000 };

static enum advance_result run_phases(struct integrator *s, struct scene_state *q, struct advance *step,
                                      const struct step_request *request)
{
    const double start = step->start;
    double end_time = request->end_time;
    double latest = -(double)INFINITY; /* time of the last event [s] */
    int at_once = 0;
    for (;;) {
        const double remaining = scene_remaining(q, end_time);
        if (!(remaining > 0.0)) {
            return ADVANCE_REACHED;
        }
        look_ahead(q, remaining, step);
        int next = 0; /* the contact whose predicted change comes first */
        for (int j = 1; j < SCENE_CONTACTS; ++j) {
            next = q->contact[j].schedule.change_clock < q->contact[next].schedule.change_clock ? j : next;
        }
        const double change = q->contact[next].schedule.change_clock;
        const double end = q->clock + remaining;
        step->clock_limit = fmin(change, q->horizon_clock);
        step->clock_end = fmin(end, step->clock_limit);
        enum advance_result result = advance_phase(s, q, step);
        step->is_now = false;
        if (result == ADVANCE_STEP_LIMIT && !advance_is_spent(step)) {
            return ADVANCE_STALLED; /* a quadrature has ended by a limit of its own */
        }
        if (result == ADVANCE_REACHED && step->clock_end >= change) {
            step->contact = next;
            step->regime = (enum contact_regime)q->contact[next].schedule.change_regime;
            step->event = ODE_EVENT_GAP;
            result = ADVANCE_EVENT;
        }
        if (result != ADVANCE_EVENT && (result != ADVANCE_REACHED || step->clock_end >= end)) {
            return result;
        }
        if (result == ADVANCE_EVENT && take_event(q, step)) {
            end_time = end_after_event(request, q, start, end_time);
        }
        at_once = scene_time(q) > latest ? 0 : at_once + 1;
        if (at_once == MOST_AT_ONCE) {
            return ADVANCE_STALLED;
        }
        latest = scene_time(q);
        /* An event counts as a step, so that the limit of steps ends any number of events. */
        advance_spend(step, 1, 1);
        if (advance_is_spent(step)) {
            return ADVANCE_STEP_LIMIT;
        }
    }
}

/* The limit of internal steps limits their work as well: each unit of work counts as a step in closed form.
 * The limit of work is at least this, the start value of the limit of steps, which takes about a second. */
static const long LEAST_WORK = 2000000;

/* Moves the scene along the present phase to a clock, and notes the peaks since the clock `noted`. */
static void follow_phase(struct integrator *s, struct scene_state *q, double noted, double clock)
{
    if (q->phase.end > 0.0) {
        if (restore_pairs(s->pairs, q)) { /* always, except where the state is forged */
            follow_pairs(s->pairs, q, noted, clock);
        }
        return;
    }
#if SCENE_HAS_GENERAL
    general_follow_kept(s->general, q, noted, clock);
#endif
}

void integrator_catch_up(struct integrator *s, struct scene_state *q, bool sums)
{
    const double clock = q->clock;
    if (!q->deferred || !(q->phase.end > 0.0 || keeps_step(q))) {
        flight_catch_up(q);
        return;
    }
    q->deferred = 0;
    q->clock = sums ? q->deferred_from : clock;
    if ((q->phase.end > 0.0 ? q->phase.followed : q->unfinished.present) < q->clock) {
        follow_phase(s, q, q->clock, q->clock);
    }
    if (sums) {
        struct scene_instant at;
        const double start = scene_time(q);
        (void)transition_begin_step(q, &at);
        follow_phase(s, q, q->clock, clock);
        q->step_length = scene_time(q) - start;
        transition_end_step(q);
    }
}

/* Returns the clock until which communication steps need only advance the clock. */
static double deferrable_until(const struct scene_state *q)
{
    if (q->phase.end > 0.0) {
        return flight_stays_finite(q, q->phase.end) ? q->phase.end : 0.0;
    }
    return keeps_step(q) ? q->unfinished.end : flight_deferrable_until(q);
}

enum advance_result integrator_run(struct integrator *s, struct scene_state *q,
                                   const struct step_request *request)
{
    const double start = scene_time(q);
    const long budget = solver_max_internal_steps(q->v);
    struct advance step;
    step.start = start;
    step.budget = budget;
    step.work = budget > LEAST_WORK ? budget : LEAST_WORK;
    integrator_catch_up(s, q, false);
    step.is_now = transition_begin_step(q, &step.now);
    step.passed = q->clock;
    if (solver_method(q->v) == SOLVER_METHOD_EVENT_DRIVEN && !scene_keeps_steps(q->v)) {
        q->integrator_fresh = 1; /* CVODE's history is in no saved state: each step does without it */
    }
    const enum advance_result result = run_phases(s, q, &step, request);
    q->step_length = scene_time(q) - start;
    transition_end_step(q);
    q->deferrable_clock =
        result == ADVANCE_REACHED && !scene_is_force_element(q->v) ? -deferrable_until(q) : 0.0;
    q->only_flies = !(q->phase.end > 0.0 || scene_turns(q->v) || (SCENE_CONTACTS > 1 && keeps_step(q)));
    return result;
}
