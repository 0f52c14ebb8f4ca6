/* Generated from the scene file and variables.toml by modelDescription/generate.py: the table of variables. */
#include <stddef.h>
#include <string.h>

#include "model/variable.h"
#include "scene.h"

_Static_assert(sizeof(struct scene_values) <= VARIABLE_OFFSET, "an offset does not fit beside its bits");

const int scene_variable_count = SCENE_VARIABLES;

/* Name, min, max, value reference, offset, row, type, causality, body or contact, component, length,
 * reinit, tunable. */
const struct variable scene_variables[SCENE_VARIABLES] = {
{% for line in table %}
    {{ line }}
{% endfor %}
};

const struct variable *const scene_tolerance = {{ "NULL" if tolerance is none else "&scene_variables[%d]" % tolerance }};

/* Position in the table, counted from 1, of each value reference{% if far_references %}; those behind the blocks, from {{ far_references }}
 * on, follow those within{% endif %}. */
static const uint16_t position_of[] = {
{% for reference, position in references %}
    [{{ reference }}] = {{ position }},
{% endfor %}
};

/* All value references within the blocks; those of no Real variable are left zero. */
const uint32_t scene_reals[SCENE_REFERENCES] = {
{% for line in reals %}
    {{ line }}
{% endfor %}
};

const char *scene_idle(const struct scene_values *v, int position)
{
    (void)v;
    switch (position) {
{% for idle in idles %}
{% for position in idle.positions %}
    case {{ position }}:
{% endfor %}
        return {{ idle.read }} ? NULL : "{{ idle.choices }}";
{% endfor %}
    default:
        return NULL;
    }
}

const char *scene_refusal(const struct scene_values *v, double numbers[2])
{
    (void)v, (void)numbers;
{% for condition, compared, text in refusals %}
    if ({{ condition }}) {
{% for number in compared %}
        numbers[{{ loop.index0 }}] = {{ number }};
{% endfor %}
        return "{{ text }}.";
    }
{% endfor %}
    return NULL;
}

{% for name, places in positions.items() %}
const uint16_t scene_{{ name }}[] = { {{- places | join(", ") or "0" -}} };
{% endfor %}
const double scene_state_nominals[] = { {{- nominals | join(", ") or "0.0" -}} };

const struct variable *scene_variable(uint32_t reference)
{
{% if far_references %}
    const bool is_far = reference >= {{ far_references }};
    if (!is_far && reference >= SCENE_REFERENCES) {
        return NULL;
    }
    reference -= is_far ? {{ far_references }} - SCENE_REFERENCES : 0;
{% endif %}
    if (reference >= sizeof position_of / sizeof position_of[0] || position_of[reference] == 0) {
        return NULL;
    }
    return &scene_variables[position_of[reference] - 1];
}

void scene_start(struct scene_values *v)
{
    memset(v, 0, sizeof *v);
{% for statement in start_statements %}
    {{ statement }}
{% endfor %}
}
