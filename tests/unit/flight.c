/* Flight in closed form against the integrals written out in long double. */
#include "flight/flight.h"

#include <float.h>

#include "check.h"
#include "long_vec3.h"
#include "random.h"
#include "scene/present.h"
#include "scene_model.h"

static void random_flight(struct random *r, struct model *m)
{
    *m = scene_model();
    scene_put_vector(m->state.values.world.gravity, random_vector(r, 10.0));
    for (int i = 0; i < SCENE_BODIES; ++i) {
        const struct vec3 centre = {20.0 * i, 0.0, 0.0};
        scene_start_free(m, i, centre, random_vector(r, 1.0));
        m->state.values.body[i].mass = random_between(r, 0.1, 10.0);
    }
    model_prepare(m);
    for (int i = 0; i < SCENE_BODIES; ++i) {
        for (int k = 0; k < 3; ++k) {
            m->state.motion.path[i].force[k] = random_vector(r, 3.0);
        }
    }
}

/* A free body at a clock: v = v0 + g t + (F0 t + F1 t^2 / 2 + F2 t^3 / 3) / m, and its integral. */
struct flown {
    struct long_vec3 moved, velocity;
};

static struct flown fly(const struct model *m, const struct scene_state *start, int body, long double t)
{
    const struct vec3 *force = start->path[body].force;
    const long double mass = m->state.values.body[body].mass;
    const double *g = m->state.values.world.gravity;
    const struct long_vec3 acceleration = {g[0], g[1], g[2]};
    struct flown at = {{0.0L, 0.0L, 0.0L}, long_of(start->body[body].velocity)};
    at.moved = long_axpy(at.moved, t, at.velocity);
    at.velocity = long_axpy(at.velocity, t, acceleration);
    at.moved = long_axpy(at.moved, t * t / 2.0L, acceleration);
    long double power = t;
    for (int k = 0; k < 3; ++k) {
        at.velocity = long_axpy(at.velocity, power / ((k + 1) * mass), long_of(force[k]));
        power *= t;
        at.moved = long_axpy(at.moved, power / ((k + 1) * (k + 2) * mass), long_of(force[k]));
    }
    return at;
}

/* The work of the forces by Simpson's rule on many segments. */
static long double work_by_sampling(const struct model *m, const struct scene_state *start, double end)
{
    enum { PIECES = 256 };
    long double sum = 0.0L;
    for (int n = 0; n <= 2 * PIECES; ++n) {
        const long double t = (long double)end * n / (2 * PIECES);
        const long double weight = n == 0 || n == 2 * PIECES ? 1.0L : n % 2 == 1 ? 4.0L : 2.0L;
        for (int i = 0; i < SCENE_BODIES; ++i) {
            const struct vec3 *force = start->path[i].force;
            struct long_vec3 total = long_axpy(long_of(force[0]), t, long_of(force[1]));
            total = long_axpy(total, t * t, long_of(force[2]));
            sum += weight * long_dot(total, fly(m, start, i, t).velocity);
        }
    }
    return sum * end / (6.0L * PIECES);
}

static void check_vector(const char *name, struct vec3 got, struct long_vec3 expected, long double tolerance)
{
    CHECK_CLOSE(name, got.x, expected.x, tolerance);
    CHECK_CLOSE(name, got.y, expected.y, tolerance);
    CHECK_CLOSE(name, got.z, expected.z, tolerance);
}

/* Kinetic and potential energy less the work of the forces. */
static double balance(const struct model *m)
{
    struct scene_instant at;
    scene_now(&m->state.values, &m->state.motion, &at);
    return energy_kinetic_of(&m->state.values, &at) + energy_potential_of(&m->state.values, &at) -
           m->state.motion.external_work;
}

static void a_flight_is_the_integral_of_its_forces(void)
{
    struct random r = {71};
    for (int n = 0; n < 2000; ++n) {
        struct model m;
        random_flight(&r, &m);
        struct scene_state *q = &m.state.motion;
        const struct scene_state start = *q;
        const double before = balance(&m);
        const double end = random_between(&r, 0.0, 1.0);
        CHECK(flight_is_free(q));
        flight_advance(&m.state.values, q, end);
        CHECK(q->clock == end);
        /* Accelerations reach (3 * 3 N / 0.1 kg + 10 m/s^2) along each axis. */
        const double noise = 16.0 * DBL_EPSILON * 100.0;
        for (int i = 0; i < SCENE_BODIES; ++i) {
            const struct flown expected = fly(&m, &start, i, end);
            check_vector("moved", q->body[i].moved, expected.moved, noise);
            check_vector("v", q->body[i].velocity, expected.velocity, noise);
        }
        /* Power below 27 N * 150 m/s; Simpson's error h^4 / 2880 of its fourth derivative is below 1e-9 of
         * that. */
        CHECK_CLOSE("work of the forces", q->external_work, work_by_sampling(&m, &start, end), 4e-6);
        CHECK_CLOSE("energy balance", balance(&m), before, noise * 500.0);
    }
}

static void a_flight_in_many_steps_ends_with_the_same_bits(void)
{
    struct random r = {72};
    for (int n = 0; n < 500; ++n) {
        struct model m;
        random_flight(&r, &m);
        struct scene_state whole = m.state.motion;
        struct scene_state parts = m.state.motion;
        flight_advance(&m.state.values, &whole, 1.0);
        for (int i = 1; i <= 37; ++i) {
            flight_advance(&m.state.values, &parts, i / 37.0);
        }
        CHECK(memcmp(whole.body, parts.body, sizeof whole.body) == 0);
        CHECK_CLOSE("work", parts.external_work, whole.external_work,
                    64.0 * DBL_EPSILON * (fabs(whole.external_work) + 5000.0));
    }
}

/* Separating bodies overlap without a force: what the spring holds is given up to the dashpot. */
static void a_separating_contact_loses_its_stored_energy(void)
{
    struct model m = scene_model();
    m.state.values.contact[0].location = LOCATION_OUTSIDE;
    m.state.values.contact[0].penalty_factor = 1000.0;
    m.state.values.contact[0].viscous_penalty_factor = 500.0;
    scene_start_free(&m, SOURCE, vec3_make(0.5, 0.0, 0.0), vec3_make(2.0, 0.0, 0.0));
    model_prepare(&m);
    struct scene_state *q = &m.state.motion;
    CHECK(q->contact[0].regime == REGIME_SEPARATING);
    CHECK(flight_is_free(q));
    flight_advance(&m.state.values, q, 0.025);
    /* g from 0.5 - 0.6 to 0.55 - 0.6 */
    CHECK_CLOSE("dissipated", q->dissipated, 0.5L * 1000.0L * (0.01L - 0.0025L), 1e-13);
    q->contact[0].regime = REGIME_COMPRESSION;
    CHECK(!flight_is_free(q));
    q->contact[0].regime = REGIME_RESTITUTION;
    CHECK(!flight_is_free(q));
}

static void only_the_axial_part_of_a_loaded_body_is_put_back(void)
{
    struct random r = {73};
    for (int n = 0; n < 500; ++n) {
        struct model m;
        random_flight(&r, &m);
        m.state.values.body[DESTINATION].finite_length = 1;
        const struct vec3 axis = random_direction(&r);
        struct scene_state *q = &m.state.motion;
        q->contact[0].parameters.axis = axis;
        q->contact[0].regime = REGIME_COMPRESSION;
        q->clock = random_between(&r, 0.0, 1.0);
        const struct scene_state start = *q;
        for (int i = 0; i < SCENE_BODIES; ++i) {
            q->body[i] = (struct body_state){random_vector(&r, 1.0), random_vector(&r, 1.0)};
        }
        const struct scene_state off = *q;
        flight_restore(&m.state.values, q);
        for (int i = 0; i < SCENE_BODIES; ++i) {
            const struct flown exact = fly(&m, &start, i, q->clock);
            const struct long_vec3 e = long_of(axis);
            const double noise = 1e-12; /* motions of about 100 m, as above */
            CHECK_CLOSE("axial u", vec3_dot(q->body[i].moved, axis), long_dot(exact.moved, e), noise);
            CHECK_CLOSE("axial v", vec3_dot(q->body[i].velocity, axis), long_dot(exact.velocity, e), noise);
            const struct vec3 change = vec3_sub(q->body[i].moved, off.body[i].moved);
            const struct vec3 across = vec3_axpy(change, -vec3_dot(change, axis), axis);
            CHECK_CLOSE("change across the axis", vec3_norm(across), 0.0, noise);
        }
    }
}

int main(void)
{
    CHECK_TEST(a_flight_is_the_integral_of_its_forces);
    CHECK_TEST(a_flight_in_many_steps_ends_with_the_same_bits);
    CHECK_TEST(a_separating_contact_loses_its_stored_energy);
    CHECK_TEST(only_the_axial_part_of_a_loaded_body_is_put_back);
    return check_summary("flight");
}
