/* Generated from the scene file and variables.toml by modelDescription/generate.py: what this FMU contains. */
{% macro parameters(accessor) -%}
{% if accessor.owner != "world" %}, int {{ accessor.owner }}{% endif %}
{%- endmacro %}
{% macro body(accessor, writes) %}
{
{% if not accessor.uses_values %}
    (void)v;
{% endif %}
{% if accessor.owner != "world" and not accessor.uses_index %}
    (void){{ accessor.owner }};
{% endif %}
{% if writes and not accessor.uses_values %}
    (void)value;
{% endif %}
{% for branch in accessor.branches if branch.statements or branch.condition %}
{% if branch.condition %}
    if ({{ branch.condition }}) {
{% for statement in branch.statements %}
        {{ statement }}
{% endfor %}
{% if writes %}
        return;
{% endif %}
    }
{% else %}
{% for statement in branch.statements %}
    {{ statement }}
{% endfor %}
{% endif %}
{% endfor %}
}
{% endmacro %}
#ifndef SCENE_H
#define SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include "contact/choices.h"
#include "math/quaternion.h"
#include "math/vec3.h"

#define SCENE_NAME "{{ scene.name }}"
#define SCENE_GUID "{{ guid }}"
#define SCENE_TOKEN "{{ token }}" /* the instantiation token of FMI 3.0 */
#define SCENE_HASH {{ hash }} /* the first 32 bits of SCENE_GUID */
#define SCENE_BODIES {{ scene.bodies | length }}
#define SCENE_CONTACTS {{ scene.contacts | length }}
#define SCENE_REFERENCES {{ near_references }} /* one more than the largest within the blocks */
#define SCENE_VARIABLES {{ variables | length }}
#define SCENE_STATES {{ positions.states | length }} /* continuous states, for an integrator outside */
#define SCENE_INDICATORS {{ positions.indicators | length }} /* event indicators */
#define SCENE_ANY_FREE {{ any_free | int }}       /* may any body be free or turn freely? else there is no solver */
#define SCENE_ANY_PRESCRIBED {{ any_prescribed | int }} /* may any body's motion be prescribed? */
#define SCENE_ANY_PRESCRIBED_CONTACT {{ any_prescribed_contact | int }} /* may neither body of a contact be free? */
#define SCENE_ANY_CYLINDER {{ any_cylinder | int }}
#define SCENE_ANY_LINEAR {{ any_linear | int }} /* may the law of any contact be linear? */
#define SCENE_ANY_HERTZ {{ any_hertz | int }}  /* may it be Hertz's? */
#define SCENE_ANY_RESTITUTION {{ any_restitution | int }} /* may damping be given by a coefficient of restitution? */
#define SCENE_ANY_CAPS {{ any_caps | int }} /* may the ends of any cylinder be capped? */
#define SCENE_ANY_SKEW {{ any_skew | int }} /* may the axes of any two cylinders be skew? */
#define SCENE_ANY_ZONES {{ (any_caps or any_skew) | int }} /* may any contact be divided into zones? */
#define SCENE_ANY_PLANE {{ (any_plane or any_caps or any_skew) | int }} /* caps are planes to who touches them, as the face of skew axes is */
#define SCENE_ANY_CURVED {{ any_curved | int }} /* may any contact be with a sphere or a cylinder, not a plane? */
#define SCENE_ANY_ROTATION {{ any_rotation | int }}   /* may any body turn? */
#define SCENE_ANY_FREE_ROTATION {{ any_free_rotation | int }} /* by Euler's equations? */
#define SCENE_ANY_FRICTION {{ (any_friction or any_rolling) | int }}   /* may there be friction, or resistance to rolling or spinning? */
#define SCENE_ANY_ROLLING {{ any_rolling | int }} /* the latter? */
#define SCENE_ANY_ELASTIC_FRICTION {{ any_elastic_friction | int }} /* with tangential springs? */
#define SCENE_ANY_MINDLIN {{ any_mindlin | int }} /* whose stiffness follows the normal one? */
#define SCENE_ANY_ELASTIC_ROLLING {{ any_elastic_rolling | int }} /* with springs of rolling or spinning? */
#define SCENE_ANY_SPRINGS {{ (any_elastic_friction or any_elastic_rolling) | int }} /* either? */
#define SCENE_ANY_TORUS {{ any_torus | int }}
#define SCENE_ANY_COMPOUND {{ any_compound | int }}
#define SCENE_ANY_ADVANCEMENT {{ (any_rotation or any_torus or any_skew or any_compound) | int }} /* may only that find a touch? */
#define SCENE_ANY_AXIS {{ (any_cylinder or any_plane or any_torus) | int }}    /* has any shape an axis? */
/* may a contact see how any body is turned? */
#define SCENE_ANY_TIPPING {{ (any_cylinder or any_plane or any_torus or any_compound) | int }}
#define SCENE_ANY_KEPT_AXIS {{ (scene.bodies | selectattr("keeps_axis") | list | length > 0) | int }} /* body_keeps_axis? */
#define SCENE_ANY_ENDS {{ (any_cylinder or any_torus) | int }}    /* may a shape end suddenly? */
#define SCENE_ANY_ENDLESS {{ any_endless | int }} /* may any contact be without ends along an axis, or with caps? */
#define SCENE_ANY_TURNING {{ (any_turning or any_torus or any_skew) | int }}    /* either, or what has no closed form without them */
{% set lever = any_turning and (any_cylinder or any_plane or any_caps or any_torus or any_compound) %}
#define SCENE_HAS_TORQUES {{ lever | int }} /* may a normal force have a torque? never about a sphere's centre */
#define SCENE_HAS_CVODE {{ has_cvode | int }} /* may CVODE be needed? else SUNDIALS is not linked */
#define SCENE_HAS_CHAINS {{ (scene.contacts | length > 1 and any_linear and any_free) | int }} /* may contacts be a chain? */
#define SCENE_HAS_ISLANDS {{ (scene.contacts | length > 1 and any_free) | int }} /* may contacts share a free body? */
#define SCENE_HAS_GENERAL {{ has_general | int }} /* may event_driven need the general segment? */

/* Every row of variables.toml, whether this scene has it or not. */
enum variable_row {
{% for row in rows %}
    ROW_{{ row.c_name }},
{% endfor %}
    ROW_COUNT
};

/* Is the row a variable of this FMU, for one body or contact at least? */
{% for row in rows %}
#define HAS_{{ row.c_name }} {{ present[row.key] | int }}
{% endfor %}
{% for struct in structs %}

struct scene_{{ struct.owner }}_values {
{% for member in struct.members %}
    {{ member }}
{% endfor %}
};
{% endfor %}

/* The values of all variables, without padding: equal values are equal bytes. */
struct scene_values {
    struct scene_body_values body[SCENE_BODIES];
    struct scene_contact_values contact[SCENE_CONTACTS];
    struct scene_world_values world;
};

_Static_assert(sizeof(struct scene_values) == {{ value_bytes }}, "padding in struct scene_values");

/* All start values; zero for what the FMU computes. */
void scene_start(struct scene_values *v);

/* Names, for messages. */
static inline const char *scene_body_name(int body)
{
    static const char *const names[SCENE_BODIES] = { {%- for b in scene.bodies %}"{{ b.name }}"{{ ", " if not loop.last }}{% endfor -%} };
    return names[body];
}

static inline const char *scene_contact_name(int contact)
{
    static const char *const names[SCENE_CONTACTS] = { {%- for c in scene.contacts %}"{{ c.name }}"{{ ", " if not loop.last }}{% endfor -%} };
    return names[contact];
}

static inline enum shape body_shape(int body)
{
{% set first = "sphere" if scene.bodies | selectattr("shape", "equalto", "sphere") | list else scene.bodies[0].shape %}
{% set others = scene.bodies | rejectattr("shape", "equalto", first) | list %}
{% if not others %}
    (void)body;
    return SHAPE_{{ first | upper }};
{% else %}
    switch (body) {
{% for shape in others | map(attribute="shape") | unique %}
{% for b in others if b.shape == shape %}
    case {{ scene.bodies.index(b) }}: /* {{ b.name }} */
{% endfor %}
        return SHAPE_{{ shape | upper }};
{% endfor %}
    default:
        return SHAPE_{{ first | upper }};
    }
{% endif %}
}

/* Whether a cylinder touches a cylinder with a parallel axis: it turns about its own axis only. */
static inline bool body_keeps_axis(int body)
{
{% set kept = scene.bodies | selectattr("keeps_axis") | list %}
{% set among = kept | length < scene.bodies | length %}
    (void)body;
    return {% if not kept %}false{% elif not among %}true{% else %}{% for b in kept %}{{ " || " if not loop.first }}body == {{ scene.bodies.index(b) }}{% endfor %}{% endif %};
}
{% for role in ("source", "destination") %}

static inline int contact_{{ role }}(int contact)
{
{% if scene.contacts | length == 1 %}
    (void)contact;
    return {{ scene.contacts | map(attribute=role) | first }};
{% else %}
    static const int body[SCENE_CONTACTS] = { {{- scene.contacts | map(attribute=role) | join(", ") -}} };
    return body[contact];
{% endif %}
}
{% endfor %}

{% if scene.contacts | length > 1 %}
/* The contacts of a body, ended by -1. */
static inline const int16_t *body_contacts(int body)
{
    static const int first[SCENE_BODIES] = { {{- contacts_of_bodies.first | join(", ") -}} };
    static const int16_t contacts[] = { {{- contacts_of_bodies.contacts | join(", ") -}} };
    return contacts + first[body];
}

{% endif %}
/* Parameters and inputs; a constant where the scene pins the value or does not need it. */
{% for accessor in readers %}

static inline {{ accessor.result }} {{ accessor.name }}(const struct scene_values *v{{ parameters(accessor) }})
{{- "\n" }}{{ body(accessor, false) }}
{%- endfor %}

/* The spheres that meet in a contact. A part of a compound body is a sphere; its radius [m] and its centre in
 * the body's frame [m] are constants. Any other body has its centre at zero. */
{% for role in ("source", "destination") %}

static inline double contact_{{ role }}_radius(const struct scene_values *v, int contact)
{
{% set parts = scene.contacts | selectattr(role ~ "_part") | list | length %}
{% if parts %}
    static const double radius[SCENE_CONTACTS] = {
{%- for one in scene.contacts %}{{ (one[role ~ "_part"].radius if one[role ~ "_part"] else 0.0) | number }}{{ ", " if not loop.last }}{% endfor -%}
    };
{% endif %}
{% if parts == scene.contacts | length %}
    (void)v;
    return radius[contact];
{% else %}
    return {{ "radius[contact] > 0.0 ? radius[contact] : " if parts }}body_radius(v, contact_{{ role }}(contact));
{% endif %}
}

static inline struct vec3 contact_{{ role }}_part(int contact)
{
{% if any_compound %}
    static const struct vec3 part[SCENE_CONTACTS] = {
{%- for one in scene.contacts %}{% set part = one[role ~ "_part"] %}{ {{- (part.center if part else (0.0, 0.0, 0.0)) | map("number") | join(", ") -}} }{{ ", " if not loop.last }}{% endfor -%}
    };
    return part[contact];
{% else %}
    (void)contact;
    return vec3_make(0.0, 0.0, 0.0);
{% endif %}
}
{% endfor %}

/* A part of a compound body is met as a sphere. */
static inline enum shape contact_destination_shape(int contact)
{
    const enum shape shape = body_shape(contact_destination(contact));
    return SCENE_ANY_COMPOUND && shape == SHAPE_COMPOUND ? SHAPE_SPHERE : shape;
}

/* What the FMU computes; nothing happens where the scene has no such variable. */
{% for accessor in writers %}

static inline void {{ accessor.name }}(struct scene_values *v{{ parameters(accessor) }}, {{ accessor.result }} value)
{{- "\n" }}{{ body(accessor, true) }}
{%- endfor %}

#endif
