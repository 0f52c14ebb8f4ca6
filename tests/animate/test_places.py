"""Every sphere is drawn where an independent camera sees the place that an independent run gives it."""

import json
import tomllib

import numpy as np
import pytest

from contact_fmus.animate.page import main as animate
from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import repository
from support.pinhole import Camera

PIXELS = 2.0
SPHERES = {"BallInShell": ("source", "destination"), "BallOffRoller": ("source",), "SpherePlane": ("source",)}
SPHERES |= {"ThreeBalls": ("left", "middle", "right"), "free_pair": ("source", "destination")}
# s; one of each in the middle of a contact
TIMES = {"BallInShell": (0.0, 0.3032, 0.75, 1.7, 3.0), "BallOffRoller": (0.0, 0.2, 0.45, 0.7, 1.0)}
TIMES |= {"SpherePlane": (0.0, 0.4524, 0.9, 1.3, 2.0), "ThreeBalls": (0.0, 0.08, 0.1015, 0.3, 0.5)}
TIMES |= {"free_pair": (0.0, 0.1, 0.1412, 0.3, 0.5)}


def start_values(case):
    """Of the last run that the scenario draws; an FMU starts with its own"""
    if case != "free_pair":
        return {}
    file = repository() / "scripts" / "scenarios" / "free_pair.toml"
    scenario = tomllib.loads(file.read_text(encoding="utf-8"))
    return scenario["start"] | {name: values[-1] for name, values in scenario["vary"].items() if "." in name}


def places(fmu, case, times):
    """Centre and radius of each sphere at each time, from a run in steps of their differences"""
    with ContactFmu(fmu) as slave:
        slave.start(start_values(case), tolerance=1e-10)
        found = []
        for time in times:
            if time > slave.time:
                slave.step(time - slave.time)
            found.append({body: place(slave, body) for body in SPHERES[case]})
        return found


def place(slave, body):
    name = f"{body}.position" if f"{body}.position" in slave else f"{body}.center"
    return np.array(slave[name]), slave[f"{body}.radius"]


def discs(page, bodies):
    """Middle and area of each body in a screenshot in which it alone has its colour"""
    page.run(f"contactAnimation.drawFlat({json.dumps(bodies)})")
    rectangle = "document.querySelector('.stage canvas').getBoundingClientRect()"
    left, top, width, height = page.run(f"(r => [r.left, r.top, r.width, r.height])({rectangle})")
    page.drawn()
    picture = page.picture()[: int(top + height), : int(left + width)]
    found = {}
    for channel, body in enumerate(bodies):
        rows, columns = np.nonzero(picture[:, :, channel] > 127)
        inside = (rows >= top) & (columns >= left)
        # A pixel's middle is half a pixel from its edge.
        rows, columns = rows[inside] + 0.5 - top, columns[inside] + 0.5 - left
        found[body] = (np.array([columns.mean(), rows.mean()]) if len(rows) else None, len(rows))
    page.run("contactAnimation.drawAgain()")
    return found


@pytest.mark.parametrize("case", SPHERES)
def test_a_sphere_is_drawn_where_it_is(case, opened, sources):
    page = opened(case, width=900, height=900)
    expected = places(sources(case)[1], case, TIMES[case])
    for time, spheres in zip(TIMES[case], expected, strict=True):
        page.run(f"contactAnimation.seek({time})")
        camera = Camera(page.run("contactAnimation.camera()"))
        drawn = discs(page, list(spheres))
        for body, (center, radius) in spheres.items():
            told = page.run(f"contactAnimation.project({body!r})")
            assert np.linalg.norm([told["x"], told["y"]] - camera.project(center)[0]) < 0.1
            middle, area = camera.disc(center, radius)
            assert np.linalg.norm(drawn[body][0] - middle) < PIXELS, (time, body)
            assert drawn[body][1] == pytest.approx(area, rel=0.05), (time, body)


def test_a_wrong_place_is_noticed(opened):
    page = opened("ThreeBalls", width=900, height=900)
    page.run("contactAnimation.seek(0.3)")
    drawn = discs(page, ["left"])["left"][0]
    camera = Camera(page.run("contactAnimation.camera()"))
    wrong, _ = camera.disc(np.array([-0.1, 0.0, 0.0]), 0.1)
    assert np.linalg.norm(drawn - wrong) > 10 * PIXELS


# Of millimetres in a tube of 10 m; far from the origin and from each other
FAR = {
    "SphereCylinder": [*("source.radius=0.001", "source.center=[0.45,0,0.002]",
        "source.initial_velocity=[0.5,0,3]"), *("destination.finite_length=true", "destination.length=10")],
    "SphereSphere": ["source.center=[1e6,2e6,1000001]", "destination.center=[-3e5,0,1e6]"],
}  # fmt: skip


@pytest.mark.parametrize("fmu", FAR)
def test_a_ball_that_is_tiny_in_its_scene_is_whole_when_looked_at(fmu, shown, tmp_path):
    settings = [part for setting in FAR[fmu] for part in ("--set", setting)]
    file = tmp_path / "far.html"
    assert animate([fmu, *settings, "--stop", "0.4", "-o", str(file)]) == 0
    page = shown(file, width=900, height=700)
    page.run(
        "contactAnimation.seek(0.3); contactAnimation.world.follow('source'); contactAnimation.seek(0.3)"
    )
    camera = Camera(page.run("contactAnimation.camera()"))
    middle, pixels = discs(page, ["source"])["source"]
    size = page.run("[contactAnimation.camera().width, contactAnimation.camera().height]")
    assert np.linalg.norm(middle - 0.5 * np.array(size)) < PIXELS
    distance = np.linalg.norm(np.array(camera.position) - page.run("contactAnimation.camera().target"))
    radius = 0.001 if fmu == "SphereCylinder" else 0.1
    assert pixels == pytest.approx(np.pi * (camera.focus * radius / distance) ** 2, rel=0.1)
    assert pixels > 2000
