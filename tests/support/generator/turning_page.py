"""What the documentation page of a scene says of bodies that turn and contacts that rub."""

from .generated import CATALOGUE, describe, scene_file


def _allowed(scene, choice):
    """Returns the items that a choice of the pair may have, by the scene file: one if pinned, some or all."""
    group = "body" if choice.startswith(("source", "destination")) else "contact"
    row = CATALOGUE["variable"][f"{group}.{choice.partition('.')[2]}"]
    items = scene_file(scene).get("pinned", {}).get(choice, list(CATALOGUE["type"][row["type"]]["items"]))
    return {items} if isinstance(items, str) else set(items)


def assert_the_page_explains_turning(page, scene):
    """Rotation, torques, friction and what they store, each where the scene may have it and nowhere else."""
    rotations = [_allowed(scene, f"{body}.rotation") for body in ("source", "destination")]
    source, destination = (body["shape"] for body in scene_file(scene)["body"])
    tips = destination != "sphere" and source != "cylinder"
    free = ["free" in rotations[0], "free" in rotations[1] and destination != "plane"]
    of = {shape for shape, turns in zip((source, destination), free, strict=True) if turns}
    prescribed = any("prescribed" in rotation for rotation in rotations)
    friction = _allowed(scene, "contact.friction") - {"none"}
    turns, moves = any(free) or prescribed, "energy.total" in describe(scene)
    resists = "contact.rolling" in describe(scene)
    yields = "contact.rolling_stiffness" in describe(scene)
    springs = "elastic" in friction or yields
    assert ("<h3>Rotation</h3>" in page) == turns
    assert ("is the unit quaternion" in page) == turns
    assert ("(Newton and Euler)" in page) == any(free)
    assert ("which turns\nwith it" in page) == (free[1] and tips)
    for shape in ("sphere", "cylinder", "torus"):
        assert (f"{shape} <i>I</i><sub>a</sub> =" in page) == (shape in of), shape
    assert ("keeps its axis" in page) == (source == "cylinder" and any(free))
    assert ("A body of prescribed rotation goes on" in page) == prescribed
    assert ("Its axis turns with it" in page) == ("prescribed" in rotations[1] and tips)
    assert ("<h3>Slip and torques</h3>" in page) == (turns or bool(friction))
    assert ("Contact is without friction" in page) == (not friction)
    assert ("regularized: <i>F</i><sub>t</sub>" in page) == ("regularized" in friction)
    assert ("elastic: <i>F</i>*" in page) == ("elastic" in friction)
    assert ("<i>E</i><sub>r</sub> = " in page) == (any(free) and moves)
    assert ("<i>E</i><sub>t</sub> = " in page) == (springs and moves)
    assert ("Power dissipated by friction" in page) == ((bool(friction) or resists) and moves)
    assert ("<h3>Resistance to rolling" in page) == resists
    assert ("elastic: <i>M</i>*" in page) == yields
    states = {name.partition("[")[0].rpartition(".")[2] for name in describe(scene)}
    for state in (
        *("orientation_state", "angular_velocity_state", "spring_state", "friction_state"),
        *("rolling_spring_state", "spinning_spring_state"),
    ):
        assert (f"<code>{state}</code>" in page) == (state in states), state
    assert ("the spring of elastic friction is never drawn" in page) == ("elastic" in friction and not moves)
