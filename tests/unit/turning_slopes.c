/* Derivatives of a contact that turns and rubs, against central differences of the formulas in the header. */
#include "contact/slopes.h"

#include "check.h"
#include "random.h"

enum { PARTS = 18, OUTPUTS = 14, CASES = 300 };

struct problem {
    struct contact_shape shape; /* its axis is that of the motion */
    struct turning_laws laws;
    struct turning_motion motion;
};

static double *part(struct turning_motion *m, int index)
{
    struct vec3 *vectors[] = {&m->separation,           &m->rate, &m->source_rotation,
                              &m->destination_rotation, &m->axis, &m->spring};
    struct vec3 *a = vectors[index / 3];
    return index % 3 == 0 ? &a->x : index % 3 == 1 ? &a->y : &a->z;
}

static struct vec3 unit_of(struct vec3 a)
{
    return vec3_scale(1.0 / vec3_norm(a), a);
}

/* Of a zone of a capped cylinder: whether its end is the one that the axis points to. */
static double end_of(const struct problem *p)
{
    return contact_is_upside_down(&p->shape) ? -1.0 : 1.0;
}

static struct contact_geometry geometry_of(const struct problem *p)
{
    const struct turning_motion *m = &p->motion;
    struct contact_shape shape = p->shape;
    shape.axis = vec3_scale(end_of(p), m->axis);
    const struct vec3 seen = vec3_sub(m->rate, vec3_cross(m->destination_rotation, m->separation));
    return contact_geometry_at(&shape, m->separation, seen, vec3_make(0.0, 0.0, 1.0));
}

static struct vec3 along_normal_removed(struct vec3 a, struct vec3 n)
{
    return vec3_axpy(a, -vec3_dot(n, a), n);
}

/* n' by the turning of what the source sees. */
static struct vec3 normal_rate_of(const struct problem *p, const struct contact_geometry *g)
{
    const struct turning_motion *m = &p->motion;
    const struct vec3 carried = vec3_cross(m->destination_rotation, g->normal);
    const struct vec3 seen = vec3_sub(m->rate, vec3_cross(m->destination_rotation, m->separation));
    if (p->shape.destination == SHAPE_PLANE) {
        return carried;
    }
    struct vec3 across = along_normal_removed(seen, g->normal);
    if (p->shape.destination == SHAPE_RIM) { /* along the circle it turns by (rho - r_d)/rho less */
        const struct vec3 radius = along_normal_removed(m->separation, m->axis);
        const struct vec3 hoop = unit_of(vec3_cross(m->axis, radius));
        const double part = p->shape.solid.radius / vec3_norm(radius);
        across = vec3_axpy(across, -part * vec3_dot(hoop, seen), hoop);
    }
    if (p->shape.destination == SHAPE_CYLINDER) {
        across = along_normal_removed(across, m->axis);
    }
    return vec3_axpy(carried, 1.0 / g->distance, across);
}

/* Force, both torques, the spring's rate, both powers. */
static void outputs_of(const struct problem *p, double out[OUTPUTS])
{
    const struct turning_motion *m = &p->motion;
    const struct contact_geometry g = geometry_of(p);
    const struct contact_law *law = &p->laws.normal;
    const double normal_force = contact_force(law, p->laws.regime, g.gap, g.gap_rate);
    const struct vec3 arm = vec3_scale(p->shape.side * p->shape.source_radius, g.normal);
    const struct vec3 from_destination = vec3_sub(arm, m->separation);
    const struct vec3 relative =
        vec3_sub(vec3_cross(m->source_rotation, arm),
                 vec3_add(m->rate, vec3_cross(m->destination_rotation, from_destination)));
    const struct friction_state rubbing = {normal_force, along_normal_removed(relative, g.normal), m->spring};
    const struct vec3 friction = friction_force(&p->laws.friction, p->laws.friction_regime, rubbing);
    const struct vec3 force = vec3_axpy(friction, -p->shape.side * normal_force, g.normal);
    const struct vec3 rate = friction_spring_rate(&p->laws.friction, p->laws.friction_regime, rubbing);
    const struct vec3 vectors[] = {force, vec3_cross(arm, force),
                                   vec3_scale(-1.0, vec3_cross(from_destination, force)),
                                   vec3_axpy(rate, -vec3_dot(m->spring, normal_rate_of(p, &g)), g.normal)};
    for (int i = 0; i < 12; ++i) {
        out[i] = vec3_get(vectors[i / 3], i % 3);
    }
    out[12] = contact_dissipated_power(law, p->laws.regime, normal_force, g.gap, g.gap_rate);
    out[13] = -vec3_dot(friction, rubbing.slip);
}

static double output(const struct turning_change *d, int index)
{
    const struct vec3 vectors[] = {d->force, d->source_torque, d->destination_torque, d->spring_rate};
    return index < 12    ? vec3_get(vectors[index / 3], index % 3)
           : index == 12 ? d->dissipated_power
                         : d->friction_power;
}

static struct problem random_problem(struct random *r, int i)
{
    static const enum shape SHAPES[] = {SHAPE_SPHERE, SHAPE_CYLINDER, SHAPE_PLANE, SHAPE_RIM};
    struct problem p;
    p.shape = (struct contact_shape){.source_radius = 0.2,
                                     .other_radius = 0.5,
                                     .half_length = (double)INFINITY,
                                     .side = 1,
                                     .destination = SHAPES[i / 2 % 4]};
    const bool is_hollow = p.shape.destination == SHAPE_SPHERE || p.shape.destination == SHAPE_CYLINDER;
    p.shape.side = is_hollow && i % 2 == 0 ? -1 : 1;
    p.shape.other_radius = is_hollow ? 0.5 : 0.0;
    const enum friction kind = i % 5 == 0 ? FRICTION_REGULARIZED : FRICTION_ELASTIC;
    p.laws.normal = (struct contact_law){80.0, i % 7 == 0 ? 0.0 : 3.0, DASHPOT_UNCLAMPED,
                                         i % 4 == 0 ? LAW_HERTZ : LAW_LINEAR};
    p.laws.friction = (struct friction_law){kind, 0.4, 0.5, 0.3, 2.0, 20.0, i % 11 < 6 ? 0.0 : 2.0};
    p.laws.regime = REGIME_COMPRESSION;
    p.laws.friction_regime =
        kind == FRICTION_REGULARIZED || i % 13 < 5 ? FRICTION_SLIDING : FRICTION_STICKING;
    const struct vec3 axis = unit_of(random_vector(r, 1.0));
    const struct vec3 n = unit_of(vec3_cross(axis, random_vector(r, 1.0)));
    const double distance = p.shape.side * (p.shape.side > 0 ? 0.6 : -0.4) * 1.0;
    p.motion.separation = vec3_axpy(vec3_scale(distance, n), random_between(r, -1.0, 1.0), axis);
    if (p.shape.destination == SHAPE_PLANE) {
        p.motion.separation = vec3_axpy(n, -0.15, axis);
    } else if (p.shape.destination == SHAPE_SPHERE) {
        p.motion.separation = vec3_scale(distance, n);
    }
    const double end = i % 2 == 0 ? -1.0 : 1.0;
    if (p.shape.destination == SHAPE_PLANE && i / 8 % 2 == 0) { /* a cap */
        p.shape.solid = (struct contact_solid){axis, 0.5, 0.3, (int)end * ZONE_CAP};
        p.shape.other_radius = 0.3;
        p.motion.separation = vec3_axpy(n, -0.45 * end, axis);
    }
    if (p.shape.destination == SHAPE_RIM) { /* 0.05 m into the source, between side and cap */
        const double angle = random_between(r, 0.2, 1.4);
        p.shape.solid = (struct contact_solid){axis, 0.5, 0.3, (int)end * ZONE_RIM};
        p.motion.separation =
            vec3_axpy(vec3_scale(0.5 + 0.15 * cos(angle), n), -end * (0.3 + 0.15 * sin(angle)), axis);
    }
    p.motion.rate = random_vector(r, 1.0);
    p.motion.source_rotation = random_vector(r, 3.0);
    p.motion.destination_rotation = random_vector(r, 3.0);
    p.motion.axis = axis;
    p.motion.spring = random_vector(r, 0.1);
    p.shape.axis = vec3_scale(end_of(&p), axis);
    return p;
}

/* The value at the motion moved by `offset` in one of its parts. An axis stays one to first order only: it is
 * moved across itself, as rotations move it. */
static void moved_outputs(const struct problem *p, const struct turning_motion *direction, double offset,
                          double out[OUTPUTS])
{
    struct problem moved = *p;
    struct turning_motion change = *direction;
    for (int i = 0; i < PARTS; ++i) {
        *part(&moved.motion, i) += offset * *part(&change, i);
    }
    moved.motion.axis = unit_of(moved.motion.axis);
    outputs_of(&moved, out);
}

static void derivatives_are_those_of_the_formulas(void)
{
    struct random r = {71};
    const double h = 2e-5;
    for (int i = 0; i < CASES; ++i) {
        const struct problem p = random_problem(&r, i);
        const struct contact_geometry g = geometry_of(&p);
        const struct turning_slopes s = turning_slopes_at(&p.shape, &g, &p.motion, &p.laws);
        for (int k = 0; k < PARTS; ++k) {
            struct turning_motion direction = {.separation = {0.0, 0.0, 0.0}};
            *part(&direction, k) = 1.0;
            direction.axis =
                vec3_axpy(direction.axis, -vec3_dot(direction.axis, p.motion.axis), p.motion.axis);
            const struct turning_change slope = turning_slopes_along(&s, &direction);
            double far[2][OUTPUTS], near[2][OUTPUTS];
            for (int side = 0; side < 2; ++side) {
                moved_outputs(&p, &direction, side == 0 ? -2.0 * h : 2.0 * h, far[side]);
                moved_outputs(&p, &direction, side == 0 ? -h : h, near[side]);
            }
            for (int j = 0; j < OUTPUTS; ++j) {
                const double difference =
                    (8.0 * (near[1][j] - near[0][j]) - (far[1][j] - far[0][j])) / (12.0 * h);
                /* h^4 times fifth derivatives of lengths of 0.1 m, and rounding */
                CHECK_CLOSE("slope", output(&slope, j), difference, 1e-7 * (10.0 + fabs(difference)));
            }
        }
    }
}

int main(void)
{
    CHECK_TEST(derivatives_are_those_of_the_formulas);
    return check_summary("turning_slopes");
}
