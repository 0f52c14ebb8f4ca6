/*
 * The first touch with an axis that turns, against a search of another kind: halving of intervals that a
 * bound of the speed alone cannot clear, with the axis by Rodrigues' formula in long double.
 */
#include "flight/tumbling.h"

#include <float.h>

#include "check.h"
#include "random.h"

struct long_vec3 {
    long double x, y, z;
};

/* A scene of the test: the axis goes round `direction` by `rate`. */
struct tumble {
    struct tumbling_path path;
    struct vec3 direction, axis;
    double rate;
    enum tumbling_change change;
};

static long double dot(struct long_vec3 a, struct long_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct long_vec3 cross(struct long_vec3 a, struct long_vec3 b)
{
    return (struct long_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static struct long_vec3 longer(struct vec3 a)
{
    return (struct long_vec3){a.x, a.y, a.z};
}

static struct long_vec3 separation(const struct tumble *t, long double time)
{
    struct long_vec3 c = {0.0L, 0.0L, 0.0L};
    for (int i = TUMBLING_TERMS - 1; i >= 0; --i) {
        const struct vec3 a = t->path.c[i];
        c = (struct long_vec3){c.x * time + a.x, c.y * time + a.y, c.z * time + a.z};
    }
    return c;
}

/* What is looked for: the largest of gap and way beyond the ends; of a parting the opposite. */
static long double height(const struct tumble *t, long double time)
{
    const struct contact_shape *shape = &t->path.shape;
    const struct long_vec3 u = longer(t->direction);
    const struct long_vec3 e = longer(t->axis);
    const struct long_vec3 once = cross(u, e);
    const struct long_vec3 twice = cross(u, once);
    const long double s = sinl(t->rate * time);
    const long double half = sinl(0.5L * t->rate * time);
    const long double k = 2.0L * half * half;
    const struct long_vec3 axis = {e.x + s * once.x + k * twice.x, e.y + s * once.y + k * twice.y,
                                   e.z + s * once.z + k * twice.z};
    const struct long_vec3 c = separation(t, time);
    const long double along = dot(c, axis);
    long double gap = -along - shape->source_radius;
    long double beyond = -INFINITY;
    if (shape->destination == SHAPE_CYLINDER) {
        const struct long_vec3 across = cross(c, axis);
        gap = shape->side *
              (sqrtl(dot(across, across)) - (shape->other_radius + shape->side * shape->source_radius));
        beyond = fabsl(along) - shape->half_length;
    }
    if (shape->solid.half_height > 0.0) {
        /* from the solid: across, along, or from the rim; inside to the nearest face */
        const long double radial = gap + shape->source_radius;
        const long double axial = fabsl(along) - shape->solid.half_height;
        const long double nearer = radial > axial ? radial : axial;
        gap = (radial > 0.0L && axial > 0.0L ? hypotl(radial, axial) : nearer) - shape->source_radius;
        beyond = -INFINITY;
    }
    const long double highest = gap > beyond ? gap : beyond;
    return t->change == TUMBLING_TOUCH ? highest : -highest;
}

/* The speed of the separation in the frame of the axis, at most. */
static long double fastest(const struct tumble *t, long double from, long double to)
{
    long double separated = 0.0L;
    long double speed = 0.0L;
    long double power = 1.0L;
    const long double latest = fabsl(from) > fabsl(to) ? fabsl(from) : fabsl(to);
    for (int i = 0; i < TUMBLING_TERMS; ++i) {
        separated += vec3_norm(t->path.c[i]) * power;
        speed += i + 1 < TUMBLING_TERMS ? (i + 1) * vec3_norm(t->path.c[i + 1]) * power : 0.0L;
        power *= latest;
    }
    return speed + t->rate * separated;
}

/* The first time at which the height may be negative, to 1e-13 of its speed; INFINITY: none. */
static long double first_below(const struct tumble *t, long double from, long double to, long double speed)
{
    const long double middle = 0.5L * (from + to);
    if (height(t, middle) > speed * (to - middle)) {
        return INFINITY;
    }
    if (to - from < 1e-13L / speed) {
        return middle;
    }
    const long double left = first_below(t, from, middle, speed);
    return left < INFINITY ? left : first_below(t, middle, to, speed);
}

enum { KINDS = 5, HOLLOW = 2, PLANE = 3, CAPPED = 4 };

/* A cylinder with and without ends, a hollow one, a plane, a capped cylinder; the ball flies at it or is in
 * it. */
static struct tumble random_tumble(struct random *r, enum tumbling_change change, int kind)
{
    struct tumble t = {.change = change, .rate = random_power(r, -1.0, 1.0)};
    struct contact_shape *shape = &t.path.shape;
    shape->source_radius = random_power(r, -2.0, -0.5);
    shape->destination = kind == PLANE ? SHAPE_PLANE : SHAPE_CYLINDER;
    shape->side = kind == HOLLOW ? -1 : 1;
    shape->other_radius = kind == PLANE ? 0.0 : random_between(r, 0.4, 1.0);
    shape->half_length = kind == 0 || kind == HOLLOW ? random_between(r, 0.3, 2.0) : (double)INFINITY;
    t.direction = random_direction(r);
    t.axis = random_direction(r);
    shape->axis = t.axis;
    if (kind == CAPPED) {
        shape->solid = (struct contact_solid){t.axis, shape->other_radius, random_between(r, 0.3, 2.0), 0};
    }
    const struct vec3 rate = vec3_scale(t.rate, t.direction);
    t.path.axis = axis_motion_driven(t.axis, &rate, 1);
    t.path.rounding = 1e-15;
    t.path.c[0] = random_vector(r, 3.0);
    t.path.c[1] = vec3_axpy(vec3_scale(-random_between(r, 0.3, 2.0), t.path.c[0]), 0.3, random_direction(r));
    t.path.c[2] = random_index(r, 2) == 0 ? vec3_make(0.0, 0.0, 0.0) : random_vector(r, 1.0);
    for (int i = 3; random_index(r, 4) == 0 && i < TUMBLING_TERMS; ++i) {
        t.path.c[i] = random_vector(r, 0.3);
    }
    return t;
}

static void check_against_halving(struct tumble *t, double horizon)
{
    const long double speed = fastest(t, 0.0L, horizon);
    if (height(t, 0.0L) < 1e-9L) {
        return; /* it has changed at the start */
    }
    const long double expected = first_below(t, 0.0L, horizon, speed);
    const struct tumbling_result found = tumbling_first(&t->path, t->change, horizon, 1000000);
    if (found.after < (double)INFINITY) {
        CHECK_CLOSE("height then", height(t, found.after), 0.0L, 4e-14L * (1.0L + speed));
        CHECK(height(t, found.after + 1e-7L) < 1e-9L);
    } else {
        CHECK(found.searched == horizon);
    }
    if (expected < INFINITY && height(t, expected + 1e-7L) < 0.0L) {
        CHECK_CLOSE("time", found.after, expected, 1e-9L);
    } else if (found.after < expected) {
        CHECK(height(t, found.after) > -1e-12L); /* it grazes */
    }
}

static void the_first_touch_is_that_of_halving(void)
{
    struct random r = {1};
    for (int i = 0; i < 500; ++i) {
        struct tumble t = random_tumble(&r, TUMBLING_TOUCH, i % KINDS);
        check_against_halving(&t, 3.0);
    }
}

static void the_first_parting_is_that_of_halving(void)
{
    struct random r = {2};
    for (int i = 0; i < 500; ++i) {
        struct tumble t = random_tumble(&r, TUMBLING_PARTING, i % KINDS);
        t.path.c[0] = vec3_scale(0.1, t.path.c[0]);
        check_against_halving(&t, 3.0);
    }
}

int main(void)
{
    CHECK_TEST(the_first_touch_is_that_of_halving);
    CHECK_TEST(the_first_parting_is_that_of_halving);
    return check_summary("tumbling_touch");
}
