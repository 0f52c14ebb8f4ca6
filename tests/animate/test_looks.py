"""What a page shows is told apart: names, shadows, colours, labels of axes, and stripes of what turns."""

import json
import tomllib

import numpy as np
import pytest

from contact_fmus.__main__ import main
from contact_fmus.animate.page import main as animate
from contact_fmus.fmu.contact_fmu import ContactFmu
from contact_fmus.fmu.files import repository
from support.pinhole import Camera

NAMES = """(() => {
  const overlay = contactAnimation.overlay, write = overlay.write, places = {};
  overlay.write = (text, x, y) => (places[text] = [x, y]);
  overlay.draw();
  overlay.write = write;
  return places;
})()"""
# Of each chart: its title, the limits of its axis and the labels of its ticks
AXES = """(() => {
  const pen = CanvasRenderingContext2D.prototype, fill = pen.fillText;
  const found = contactPlot.all.map((chart) => {
    const labels = [];
    pen.fillText = function (text) {
      if (this.textAlign === "right" && !text.includes("[")) labels.push(text);
    };
    chart.draw();
    return { limits: chart.limits, bent: chart.bent, labels };
  });
  pen.fillText = fill;
  return found;
})()"""
FRAME = 16  # pixels that the edge and the round corners of the picture take
STILL = "getComputedStyle(document.documentElement).getPropertyValue('--still').trim()"


def covered(page, body):
    """Where the body alone is, as a picture of true and false"""
    page.run(f"contactAnimation.drawFlat({json.dumps([body])})")
    found = page.stage()[:, :, 0] > 127
    page.run("contactAnimation.drawAgain()")
    inner = np.zeros_like(found)
    inner[FRAME:-FRAME, FRAME:-FRAME] = True
    return found & inner


@pytest.mark.parametrize("view", ["fit", "x y"])
def test_the_name_of_a_plane_stands_on_it(view, opened):
    page = opened("SpherePlane", width=900, height=800)
    page.run(f"[...document.querySelectorAll('.views button')].find((b) => b.innerText === '{view}').click()")
    page.wait_for(f"'destination' in {NAMES}")  # a busy browser may not have drawn yet
    x, y = page.run(NAMES)["destination"]
    assert covered(page, "destination")[int(y), int(x)]


def test_a_shadow_lies_below_the_ball(opened):
    page = opened("SpherePlane", width=900, height=800)
    page.run("document.querySelector('[data-is=trails]').click(); contactAnimation.seek(0.2)")
    camera, picture = Camera(page.run("contactAnimation.camera()")), page.stage()
    light = []
    for x in (0.05, 0.3):  # m beside what is below the middle of the ball; its radius is 0.1 m
        column, row = camera.project(np.array([x, 0.03, 0.0]))[0]
        light.append(np.sum(picture[int(row) - 1 : int(row) + 2, int(column) - 1 : int(column) + 2]))
    assert light[0] < 0.9 * light[1]


@pytest.mark.parametrize("case", ["SphereCylinder", "ForceElement"])
def test_an_infinite_cylinder_leaves_room_in_the_picture(case, opened):
    cylinder = covered(opened(case, width=1200, height=800), "destination")
    assert 0.05 < np.mean(cylinder) < 0.5
    assert not cylinder[:, FRAME].any() and not cylinder[:, -FRAME - 1].any()


def test_bodies_that_could_move_have_colours_of_their_own(opened):
    page = opened("ForceElement", width=900, height=700)
    colors = page.run("contactAnimation.world.bodies.map((b) => '#' + b.materials[0].color.getHexString())")
    assert len({*colors, page.run(STILL)}) == 3
    still = opened("SphereCylinder", width=900, height=700)
    of_floor = still.run("'#' + contactAnimation.world.bodies[1].materials[0].color.getHexString()")
    assert of_floor == still.run(STILL)


def test_what_turns_and_rubs_has_charts_and_energies_differ_in_colour(opened):
    page = opened("GolfersDilemma", width=900, height=700)
    titles = page.run("[...document.querySelectorAll('figcaption b')].map((one) => one.textContent)")
    for wanted in ("angular velocity of source [rad/s]", "friction force, size", "slip velocity, size"):
        assert [title for title in titles if title.startswith(wanted)] != [], titles
    looks = "[...document.querySelectorAll('.chart:last-child .legend i')].map((one) => one.style.borderTop)"
    energies = page.run(looks)
    assert len(set(energies)) == len(energies) >= 6
    assert "friction" not in " ".join(
        opened("BallInShell").run("[...document.querySelectorAll('b')].map((one) => one.textContent)")
    )


@pytest.mark.parametrize("case", ["GolfersDilemma", "Turntable", "SpinningBall", "Bowling"])
def test_an_axis_shows_no_rounding_and_its_labels_differ(case, shown, tmp_path):
    file = tmp_path / "plot.html"
    assert main(["plot", case, "-o", str(file)]) == 0
    page = shown(file, "!!window.contactPlot", width=900, height=900)
    axes = page.run(AXES)
    assert len(axes) >= 4
    for axis in axes:
        low, high = axis["limits"]
        assert high - low >= 1e-6 * max(abs(low), abs(high))
        assert len(set(axis["labels"])) == len(axis["labels"]) >= 2
    page.run("contactPlot.setRange(contactPlot.whole[1] * 0.5, contactPlot.whole[1] * 0.5003)")
    assert all(len(set(axis["labels"])) == len(axis["labels"]) for axis in page.run(AXES))


def pictures(page, times):
    """What the page shows at these times"""
    found = []
    for time in times:
        page.drawn(time)
        found.append(page.picture().astype(int))
    return found


def changed(one, other):
    """Part of the pixels that differ by more than shading does."""
    return float(np.mean(np.max(np.abs(one - other), axis=2) > 24))


def test_a_table_that_turns_is_seen_to_turn(opened):
    """By an eighth of a turn light and dark change places; by a quarter they are where they were."""
    table = opened("Turntable", width=700, height=500)
    eighth = np.pi / 4 / 3.0
    first, turned, again = pictures(table, (0.0, eighth, 2 * eighth))
    assert changed(first, turned) > 0.2
    assert changed(first, again) < 0.5 * changed(first, turned)


def test_a_floor_that_stands_still_keeps_its_looks(opened):
    """The ball alone moves over it, and turns."""
    first, later = pictures(opened("SpinningBall", width=700, height=500), (0.0, 0.1))
    assert 0.0 < changed(first, later) < 0.2


# Every sphere is drawn where an independent camera sees the place that an independent run gives it.

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
    for deed in ("seek(0.3)", "world.follow('source')", "seek(0.3)"):
        page.run(f"contactAnimation.{deed}")
    camera = Camera(page.run("contactAnimation.camera()"))
    middle, pixels = discs(page, ["source"])["source"]
    size = page.run("[contactAnimation.camera().width, contactAnimation.camera().height]")
    assert np.linalg.norm(middle - 0.5 * np.array(size)) < PIXELS
    distance = np.linalg.norm(np.array(camera.position) - page.run("contactAnimation.camera().target"))
    radius = 0.001 if fmu == "SphereCylinder" else 0.1
    assert pixels == pytest.approx(np.pi * (camera.focus * radius / distance) ** 2, rel=0.1)
    assert pixels > 2000


# An animation plays, dwells on contacts, and does what mouse, fingers and keys ask.

# A busy machine is not waited for by the clock, but by what it has drawn.
TEN_FRAMES = """new Promise((done) => {
  let left = 10;
  const next = () => (left-- > 0 ? requestAnimationFrame(next) : done());
  next();
})"""


@pytest.mark.parametrize("case", ["BallInShell", "BallOffRoller", "ThreeBalls", "free_pair"])
def test_it_plays_until_it_is_told_to_pause(case, opened, browser):
    page = opened(case, width=900, height=700)
    page.run("contactAnimation.play()")
    before, frames = page.run("contactAnimation.time"), page.run("contactAnimation.frames")
    page.wait_for(f"contactAnimation.time !== {before!r} && contactAnimation.frames > {frames}")
    page.run("contactAnimation.pause()")
    before = page.run("contactAnimation.time")
    page.run(TEN_FRAMES)
    assert page.run("contactAnimation.time") == before


def test_it_dwells_on_a_contact_unless_told_not_to(opened):
    page = opened("BallInShell")
    rate = "(contactAnimation.seek({0}), contactAnimation.playback.rate())"
    shown = "contactAnimation.playback.toShown(0.304838) - contactAnimation.playback.toShown(0.301681)"
    assert page.run(rate.format(0.2)) == pytest.approx(1.0)  # of a run of 3 s: real time
    assert page.run(rate.format(0.3032)) < 0.01
    assert page.run(shown) > 1.0  # s, for a contact of 3.2 ms
    page.run("document.querySelector('[data-is=slow]').click()")
    assert page.run(rate.format(0.3032)) == pytest.approx(1.0)
    assert page.run(shown) == pytest.approx(0.0032, rel=0.05)


def test_the_next_contact_is_one_press_away(opened):
    page = opened("BallInShell")
    page.run("contactAnimation.seek(0.4); document.querySelector('[data-is=after]').click()")
    assert 0.49 < page.run("contactAnimation.time") < 0.4971456
    page.run("document.querySelector('[data-is=before]').click()")
    assert 0.29 < page.run("contactAnimation.time") < 0.3016808


def test_forces_are_arrows_from_the_contact(opened):
    page = opened("BallInShell")
    arrows = "contactAnimation.world.contacts[0].forces.map((one) => one.arrow.arrow.visible)"
    value = "contactAnimation.world.contacts[0].forces[0].value"
    page.run("contactAnimation.seek(0.2)")
    assert page.run(arrows) == [False, False]
    page.run("contactAnimation.seek(0.303)")
    assert page.run(arrows) == [True, True]
    assert page.run(value) > 2000  # N; the chart of the force says 2.4 kN
    page.run("document.querySelector('[data-is=forces]').click(); contactAnimation.seek(0.303)")
    assert page.run(arrows) == [False, False]


def direction(page):
    camera = page.run("contactAnimation.camera()")
    apart = np.array(camera["position"]) - camera["target"]
    return apart / np.linalg.norm(apart), float(np.linalg.norm(apart))


def middle(page):
    x, y = page.run(
        "(r => [r.left + 0.5 * r.width, r.top + 0.5 * r.height])"
        "(document.querySelector('.stage').getBoundingClientRect())"
    )
    return x, y


def settled(page, browser):
    page.run(TEN_FRAMES)
    return direction(page)


def test_the_mouse_turns_and_zooms(opened, browser):
    page = opened("BallInShell", width=900, height=700)
    (before, far), (x, y) = direction(page), middle(page)
    page.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    for way in (50, 100, 150):
        page.mouse("mouseMoved", x + way, y + 20, button="left", buttons=1)
    page.mouse("mouseReleased", x + 150, y + 20, button="left", clickCount=1)
    after, same = settled(page, browser)
    assert before @ after < 0.9
    assert same == pytest.approx(far)
    page.mouse("mouseWheel", x, y, deltaX=0, deltaY=-300)
    assert settled(page, browser)[1] < 0.95 * far


def test_fingers_turn_and_zoom(opened, browser):
    page = opened("BallInShell", width=500, height=800)
    (before, far), (x, y) = direction(page), middle(page)
    page.touch("touchStart", [(x, y)])
    for way in (40, 80, 120):
        page.touch("touchMove", [(x + way, y)])
    page.touch("touchEnd", [])
    after, _ = settled(page, browser)
    assert before @ after < 0.9
    page.touch("touchStart", [(x - 30, y), (x + 30, y)])
    for way in (40, 60, 80):
        page.touch("touchMove", [(x - way, y), (x + way, y)])
    page.touch("touchEnd", [])
    assert settled(page, browser)[1] < 0.8 * far


@pytest.mark.parametrize("dark", [False, True])
def test_a_narrow_window_shows_all_of_it(opened, dark):
    page = opened("free_pair", width=500, height=800, dark=dark)
    assert page.run("document.documentElement.scrollWidth") <= 500
    places = "[...document.querySelectorAll('main *')].map((one) => one.getBoundingClientRect())"
    sides = page.run(f"{places}.map((one) => [one.left, one.right])")
    assert all(left >= 0 and right <= 500 for left, right in sides)
    light = np.mean(page.picture())
    assert light < 80 if dark else light > 180
