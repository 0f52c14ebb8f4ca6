"""Scene files that repeat bodies and contacts say what the file with all of them written out says."""

import json
import re

import pytest

from support.generator.generated import parse_xml, refused, run, texts_in

BODIES = """
name = "Several"
title = "Three balls, two pegs and a wall"
description = "For tests."

[groups]
solid = ["peg[*]", "wall"]
all = ["ball[*]", "lone"]

[[body]]
name = "ball[{i}]"
shape = "sphere"
count = 3

[[body]]
name = "lone"
shape = "sphere"

[[body]]
name = "peg[{i}]"
shape = "cylinder"
count = 2

[[body]]
name = "wall"
shape = "plane"

[[contact]]
name = "chain_{i}"
source = "ball[{i}]"
destination = "ball[{i+1}]"
count = 2

[[contact]]
name = "near[{i},{j}]"
source = "all"
destination = "solid"

[[contact]]
name = "last"
source = "lone"
destination = "ball[3]"

[start]
"ball[2].mass" = 7.0
"ball[{i}].mass" = 2.0
"ball[{i}].radius" = [0.1, "20 cm", 0.3]
"ball[{i}].center" = [[0, 0, 1], [0, 0, 2], [0, 0, 3]]
"ball[{i}].initial_velocity" = [0, 0, -1]
"near[{i},{j}].penalty_factor" = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]

[pinned]
"peg[{i}].motion" = "fixed"
"ball[{i}].rotation" = ["none", "prescribed"]
"chain_{i}.law" = "linear"

[leave_out]
outputs = ["ball[{i}].velocity", "chain_{i}"]
"""
BALLS, LONE = ["ball[1]", "ball[2]", "ball[3]"], ["lone"]
SOLID = {"peg[1]": "cylinder", "peg[2]": "cylinder", "wall": "plane"}


def written_out() -> str:
    """The same scene without a `count`, a group or a `{i}`."""
    shapes = dict.fromkeys(BALLS + LONE, "sphere") | SOLID
    pairs = {"chain_1": ("ball[1]", "ball[2]"), "chain_2": ("ball[2]", "ball[3]")}
    pairs |= {
        f"near[{i},{j}]": (ball, solid)
        for i, ball in enumerate(BALLS + LONE, 1)
        for j, solid in enumerate(SOLID, 1)
    }
    pairs["last"] = ("lone", "ball[3]")
    lines = ['name = "Several"', 'title = "Three balls, two pegs and a wall"', 'description = "For tests."']
    lines += [f'[[body]]\nname = "{name}"\nshape = "{shape}"' for name, shape in shapes.items()]
    lines += [
        f'[[contact]]\nname = "{name}"\nsource = "{source}"\ndestination = "{destination}"'
        for name, (source, destination) in pairs.items()
    ]
    lines.append("[start]")
    for i, ball in enumerate(BALLS):
        lines.append(f'"{ball}.mass" = {(2.0, 7.0, 2.0)[i]}')
        lines.append(f'"{ball}.radius" = {(0.1, 0.2, 0.3)[i]}')
        lines.append(f'"{ball}.center" = [0, 0, {i + 1}]\n"{ball}.initial_velocity" = [0, 0, -1]')
    near = [name for name in pairs if name.startswith("near")]
    lines += [f'"{name}.penalty_factor" = {k}' for k, name in enumerate(near, 1)]
    lines += ["[pinned]", '"peg[1].motion" = "fixed"', '"peg[2].motion" = "fixed"']
    lines += [f'"{ball}.rotation" = ["none", "prescribed"]' for ball in BALLS]
    lines += ['"chain_1.law" = "linear"', '"chain_2.law" = "linear"', "[leave_out]"]
    lines.append(f"outputs = {json.dumps([f'{ball}.velocity' for ball in BALLS] + ['chain_1', 'chain_2'])}")
    return "\n".join(lines)


def made(text, folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "Several.toml").write_text(text, encoding="utf-8")
    assert run("--scene", folder / "Several.toml", "--output", folder / "out").returncode == 0
    return texts_in(folder / "out")


def without_references(files):
    plain = {name: dict(row, reference=0) for name, row in parse_xml(files["modelDescription.xml"]).items()}
    return plain, files["resources/scene.json"], files["terminals2/terminalsAndIcons.xml"]


def test_a_scene_that_repeats_is_the_scene_written_out(tmp_path):
    one, other = made(BODIES, tmp_path / "one"), made(written_out(), tmp_path / "other")
    assert without_references(one) == without_references(other)
    start = re.search(r"void scene_start[\s\S]*", one["scene_variables.c"])[0]
    assert start == re.search(r"void scene_start[\s\S]*", other["scene_variables.c"])[0]


def test_a_larger_count_changes_no_value_reference(tmp_path):
    """Of bodies, of pairs of two groups and of pairs within a group"""
    pairs = 'name = "pair[{i},{j}]"\nsource = "ball[*]"\ndestination = "ball[*]"\n'
    text = re.sub(r'name = "chain_\{i\}"[\s\S]*?count = 2\n', pairs, BODIES)
    text = re.sub(r"\n.*(chain|radius|center|near\[\{i\},\{j\}\]\.penalty).*", "", text)
    more = text.replace("count = 3", "count = 5").replace("count = 2", "count = 4")
    files = [made(text, tmp_path / "before"), made(more, tmp_path / "after")]
    entries = [parse_xml(one["modelDescription.xml"]).items() for one in files]
    before, after = ({name: entry["reference"] for name, entry in of_one} for of_one in entries)
    assert "pair[4,5].gap" in after.keys() - before.keys()
    # Those of other places in their groups apart
    kept = [name for name in before if not re.match(r"near\[\d,3\]|near\[4", name)]
    assert [after[name] for name in kept] == [before[name] for name in kept]
    assert len(set(after.values())) == len(after)


BAD = {
    "count of none": ("count = 3", "count = 0", ["[[body]] 1: 'count' is 0", "1 to 1000"]),
    "count that is no number": ("count = 3", "count = true", ["[[body]] 1: 'count' is True", "1 to 1000"]),
    "count of a body without a number": ('"ball[{i}]"', '"ball"',
        ["[[body]] 1: 'name' is 'ball'", "ball[{i}]"]),
    "number without a count": ("count = 3\n", "", ["[[body]] 1", "'ball[{i}]' without a count"]),
    "more than a thousand bodies": ("count = 3", "count = 999", ["[[body]] 3", "makes 1002", "at most 1000"]),
    "more than a thousand pairs": ("count = 3", "count = 400",
        ["[[contact]] 2", "makes 1205", "at most 1000"]),
    "an empty group": ('"peg[*]", "wall"', "", ["[groups]: group 'solid' is empty", "one or more"]),
    "a group of nobody": ('"all"\n', '"stone[*]"\n', ["[[contact]] 2: group 'stone[*]' is empty", "ball[1]"]),
    "a group with a stranger": ('"wall"]', '"moon"]',
        ["[groups]: 'moon' of group 'solid' is no body", "lone"]),
    "a group named as a body": ("solid =", "wall =", ["[groups]: 'wall' is the name of a body"]),
    "a pair twice": ('"ball[3]"\n', '"wall"\n',
        ["[[contact]] 3", "'wall' and source 'lone'", "[[contact]] 2"]),
    "a pair twice in one table": ('"ball[{i}]"\ndestination = "ball[{i+1}]"',
        '"ball[1]"\ndestination = "ball[3]"', ["[[contact]] 1",
        "'ball[3]' and source 'ball[1]' are already those of [[contact]] 1", "each pair once"]),
    "pairs of one name": ('"near[{i},{j}]"', '"near[{i}]"', ["[[contact]] 2", "'near[1]' is already"]),
    "pairs without a number": ('"near[{i},{j}]"', '"near"', ["[[contact]] 2: 'name' is 'near'", "near[{i}]"]),
    "beyond the last": ("count = 2\n\n[[contact]]", "count = 3\n\n[[contact]]", ["'ball[4]' is no body"]),
    "values for others": ("0.3]\n", "0.3, 0.4]\n", ["[start]: 'ball[{i}].radius' has 4 values", "3, or one"]),
    "values of a stranger": ('"peg[{i}].m', '"pig[{i}].m',
        ["[pinned]: 'pig[{i}].motion'", "allowed: ball[{i}]"]),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_a_bad_repetition_is_refused_in_one_line(tmp_path, case):
    old, new, says = BAD[case]
    assert old in BODIES
    (tmp_path / "Several.toml").write_text(BODIES.replace(old, new, 1), encoding="utf-8")
    refused(run("--scene", tmp_path / "Several.toml", "--output", tmp_path), "Several.toml: ", *says)
