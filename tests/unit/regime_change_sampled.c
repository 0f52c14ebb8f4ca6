/* When the regime of a contact changes first, against dense sampling of random motions in long double. */
#include "integrator/prediction.h"

#include "check.h"
#include "flight/flight.h"
#include "long_vec3.h"
#include "random.h"
#include "scene_model.h"

static struct regime_change find(const struct model *m, double horizon)
{
    struct scene_instant at;
    scene_now(&m->state.values, &m->state.motion, &at);
    return next_regime_change(&m->state.values, &m->state.motion, &at, m->state.motion.clock, 0, horizon);
}

/* The regime that DESIGN gives for a separation, and how near to a boundary it is (in gap, axial place or
 * force). */
struct judged {
    enum contact_regime regime;
    bool doubtful;
};

static struct judged judge(const struct model *m, struct long_vec3 c, struct long_vec3 w)
{
    const struct contact_shape shape = scene_contact_shape(&m->state.values, &m->state.motion, 0);
    const struct contact_law law = scene_contact_law(&m->state.values, &m->state.motion, 0);
    const struct long_geometry g = long_geometry_at(&shape, c, w);
    const long double beyond = fabsl(g.axial) - shape.half_length;
    const long double acceleration = law.stiffness * g.gap + law.damping * g.gap_rate;
    const long double near = 1e-9L;
    struct judged at = {REGIME_COMPRESSION, fabsl(g.gap) < near || fabsl(beyond) < near};
    if (g.gap >= 0.0L || beyond > 0.0L) {
        at.regime = REGIME_APART;
    } else if (law.damping > 0.0 && law.dashpot == DASHPOT_NON_ADHESIVE) {
        at.regime = acceleration >= 0.0L ? REGIME_SEPARATING : REGIME_COMPRESSION;
        at.doubtful = at.doubtful || fabsl(acceleration) < near * (law.stiffness + law.damping);
    } else if (law.damping > 0.0 && law.dashpot == DASHPOT_APPROACH_ONLY) {
        at.regime = g.gap_rate >= 0.0L ? REGIME_RESTITUTION : REGIME_COMPRESSION;
        at.doubtful = at.doubtful || fabsl(g.gap_rate) < near;
    }
    return at;
}

/* The separation without contact forces at clock t: polynomials of each body, written out. */
static struct judged judge_at(const struct model *m, long double t)
{
    struct long_vec3 c = {0.0L, 0.0L, 0.0L};
    struct long_vec3 w = c;
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct scene_body_values *body = &m->state.values.body[i];
        const struct body_path *path = &m->state.motion.path[i];
        const long double sign = i == DESTINATION ? 1.0L : -1.0L;
        const double *g = m->state.values.world.gravity;
        const struct long_vec3 acceleration = {g[0], g[1], g[2]};
        c = long_axpy(c, sign, (struct long_vec3){body->center[0], body->center[1], body->center[2]});
        if (body->motion == MOTION_PRESCRIBED) {
            for (int k = 0; k < 4; ++k) {
                c = long_axpy(c, sign * powl(t, k), long_of(path->displacement[k]));
                w = k < 3 ? long_axpy(w, sign * powl(t, k), long_of(path->velocity[k])) : w;
            }
        } else if (body->motion == MOTION_FREE) {
            const struct long_vec3 v = long_of(m->state.motion.origin[i].velocity);
            c = long_axpy(long_axpy(c, sign * t, v), sign * t * t / 2.0L, acceleration);
            w = long_axpy(long_axpy(w, sign, v), sign * t, acceleration);
            for (int k = 0; k < 3; ++k) {
                const long double by = sign * powl(t, k + 1) / ((k + 1) * body->mass);
                w = long_axpy(w, by, long_of(path->force[k]));
                c = long_axpy(c, by * t / (k + 2), long_of(path->force[k]));
            }
        }
    }
    return judge(m, c, w);
}

static void random_body(struct random *r, struct model *m, int body, enum motion_kind motion)
{
    struct scene_body_values *values = &m->state.values.body[body];
    values->motion = (int32_t)motion;
    values->mass = random_between(r, 0.5, 2.0);
    scene_put_vector(values->center, random_vector(r, 1.0));
    scene_put_vector(values->initial_velocity, random_vector(r, 1.0));
}

static void random_paths(struct random *r, struct scene_state *q)
{
    for (int i = 0; i < SCENE_BODIES; ++i) {
        struct body_path *path = &q->path[i];
        for (int k = 0; k < 3; ++k) {
            path->force[k] = random_vector(r, 1.0);
            path->velocity[k] = random_vector(r, 1.0);
            path->displacement[k + 1] = vec3_scale(1.0 / (k + 1), path->velocity[k]);
        }
    }
}

static struct model random_scene(struct random *r)
{
    struct model m = scene_model();
    scene_put_vector(m.state.values.world.gravity, random_vector(r, 1.0));
    const bool prescribed = random_index(r, 3) == 0;
    random_body(r, &m, SOURCE, prescribed ? MOTION_PRESCRIBED : MOTION_FREE);
    random_body(r, &m, DESTINATION,
                prescribed ? MOTION_PRESCRIBED : (enum motion_kind)(1 + random_index(r, 3)));
    m.state.values.body[SOURCE].radius = random_between(r, 0.05, 0.4);
    scene_put_vector(m.state.values.body[DESTINATION].axis, random_vector(r, 2.0));
    m.state.values.body[DESTINATION].finite_length = random_index(r, 2);
    m.state.values.body[DESTINATION].length = random_between(r, 0.2, 2.0);
    m.state.values.contact[0].dashpot = 1 + random_index(r, 3);
    m.state.values.contact[0].penalty_factor = random_between(r, 0.1, 10.0);
    m.state.values.contact[0].viscous_penalty_factor = random_between(r, 0.1, 10.0);
    model_prepare(&m);
    random_paths(r, &m.state.motion);
    /* The present is not the origin of the clock. */
    const double clock = random_index(r, 2) * random_between(r, 0.0, 0.3);
    flight_advance(&m.state.values, &m.state.motion, clock);
    m.state.motion.contact[0].regime = (int32_t)judge_at(&m, clock).regime;
    return m;
}

/* Nothing changes before the next change, and just after it the regime is the one foretold. */
static int check_by_sampling(const struct model *m, double horizon)
{
    enum { SAMPLES = 1000 };
    const enum contact_regime present = (enum contact_regime)m->state.motion.contact[0].regime;
    const struct regime_change next = find(m, horizon);
    const long double now = m->state.motion.clock;
    const long double until = isinf(next.after) ? horizon : next.after;
    for (int i = 0; i <= SAMPLES; ++i) {
        const struct judged at = judge_at(m, now + until * i / SAMPLES);
        CHECK(at.doubtful || at.regime == present);
    }
    if (isinf(next.after)) {
        return 0;
    }
    CHECK(next.after > 0.0 && next.after <= horizon);
    CHECK(next.regime != present);
    /* The new regime may be short; look for it where sampling is beyond doubt. */
    long double wait = 1e-9L;
    struct judged at = judge_at(m, now + next.after + wait);
    while (at.doubtful && wait < 1e-3L) {
        wait *= 2.0L;
        at = judge_at(m, now + next.after + wait);
    }
    CHECK(at.doubtful || at.regime == next.regime);
    return at.doubtful ? 0 : 1;
}

TEST(no_change_is_missed_and_none_is_invented)
{
    struct random r = {81};
    int changes = 0;
    for (int n = 0; n < 8000; ++n) {
        const struct model m = random_scene(&r);
        const enum contact_regime present = (enum contact_regime)m.state.motion.contact[0].regime;
        const bool given = present == REGIME_APART || present == REGIME_SEPARATING ||
                           scene_is_force_element(&m.state.values);
        if (given && !judge_at(&m, m.state.motion.clock).doubtful) {
            changes += check_by_sampling(&m, random_power(&r, -1.0, 1.0));
        }
    }
    CHECK(changes > 1000);
}
