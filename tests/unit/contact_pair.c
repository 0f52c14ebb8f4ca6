/* A contact that transmits a force as a series: one step of it against closed forms and against what it must
 * keep. */
#include "touch/pair.h"

#include <float.h>

#include "check.h"
#include "compressed_model.h"
#include "random.h"

/* A ball against a cylinder along z, outside, head-on along x: a linear oscillator of g. */
static struct model head_on(double speed, double damping)
{
    struct model m = scene_model();
    struct scene_values *v = &m.state.values;
    v->body[DESTINATION].motion = MOTION_FIXED;
    v->contact[0].location = LOCATION_OUTSIDE;
    v->contact[0].dashpot = DASHPOT_UNCLAMPED;
    v->contact[0].viscous_penalty_factor = damping;
    scene_start_free(&m, SOURCE, vec3_make(v->body[SOURCE].radius + v->body[DESTINATION].radius, 0.0, 0.0),
                     vec3_make(-speed, 0.0, 0.0));
    compressed_begin(&m);
    return m;
}

static void the_gap_is_that_of_a_damped_oscillator(void)
{
    const double speed = 1.5, stiffness = 1e6, mass = 1.0;
    for (int k = 0; k < 5; ++k) {
        const double damping = 400.0 * k;
        const struct model m = head_on(speed, damping);
        const struct contact_pair from = pair_of(&m);
        struct pair_taylor p;
        pair_taylor_make(&p, &from);
        const long double decay = damping / (2.0L * mass);
        const long double omega = sqrtl(stiffness / mass - decay * decay);
        CHECK(p.step * p.unit > 1.0 / sqrt(stiffness / mass));
        for (int i = 0; i <= 8; ++i) {
            const long double t = p.step * p.unit * i / 8.0L;
            const long double expected = -speed / omega * expl(-decay * t) * sinl(omega * t);
            CHECK_CLOSE("gap", taylor_at(p.gap, TAYLOR_TERMS, p.step * i / 8.0), expected,
                        8.0L * DBL_EPSILON);
        }
    }
}

static struct model random_pair(struct random *r)
{
    struct model m = head_on(1.0, random_between(r, 0.0, 2000.0));
    struct scene_values *v = &m.state.values;
    v->body[DESTINATION].mass = random_between(r, 0.2, 5.0);
    scene_put_vector(v->world.gravity, random_vector(r, 20.0));
    scene_put_vector(v->body[SOURCE].external_force, random_vector(r, 50.0));
    scene_start_free(&m, SOURCE, vec3_make(0.599, 0.0, 0.1), random_vector(r, 3.0));
    scene_start_free(&m, DESTINATION, vec3_make(0.0, 0.0, 0.0), random_vector(r, 3.0));
    compressed_begin(&m);
    return m;
}

static void a_step_keeps_momentum_and_energy(void)
{
    struct random r = {7};
    for (int k = 0; k < 200; ++k) {
        struct model m = random_pair(&r);
        struct scene_state *q = &m.state.motion;
        const struct scene_values *v = &m.state.values;
        const struct vec3 before = q->body[SOURCE].velocity;
        const double energy = balance(&m);
        const struct contact_pair from = pair_of(&m);
        struct pair_taylor p;
        pair_taylor_make(&p, &from);
        const struct pair_change change = pair_taylor_change(&p, p.step);
        pair_apply(&from, &change, v, q, 0);
        q->clock += change.time;
        const double t = q->clock;
        const struct vec3 acceleration =
            vec3_axpy(gravity(v), 1.0 / v->body[SOURCE].mass, body_external_force(v, SOURCE));
        const struct vec3 gained = vec3_sub(q->body[SOURCE].velocity, vec3_axpy(before, t, acceleration));
        CHECK_CLOSE("impulse", v->body[SOURCE].mass * gained.x, q->contact[0].physics.impulse.x, 1e-13L);
        CHECK_CLOSE("impulse", v->body[SOURCE].mass * gained.y, q->contact[0].physics.impulse.y, 1e-13L);
        /* Kinetic energy alone reaches 100 J here; 256 roundings of it. */
        CHECK_CLOSE("balance", balance(&m), energy, 256.0L * DBL_EPSILON * 100.0L);
    }
}

int main(void)
{
    CHECK_TEST(the_gap_is_that_of_a_damped_oscillator);
    CHECK_TEST(a_step_keeps_momentum_and_energy);
    return check_summary("press");
}
