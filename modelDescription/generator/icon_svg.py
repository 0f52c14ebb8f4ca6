"""The icon of an FMU as SVG: the same picture as model.png, for tools that scale it."""

import math

from .icon import DESTINATION, FORCE, HEAD, LINE, SIZE, SOURCE, View
from .start import Start


def draw_svg(start: Start) -> str:
    """The SVG, of the layers of icon.View"""
    view = View(start)
    sources = {contact.source for contact in view.scene.contacts}
    others = [body for body in range(len(view.at)) if body not in sources]
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {SIZE} {SIZE}">',
        f"<title>{_escaped(view.scene.title)}</title>",
        *(_body(view, body, *DESTINATION) for body in others),
        *_force(view),
        *(_body(view, body, *SOURCE) for body in sorted(sources)),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _color(rgb: tuple[int, int, int]) -> str:
    return "#" + "".join(f"{value:02x}" for value in rgb)


def _body(view: View, body: int, fill: tuple, line: tuple) -> str:
    (x, y), radius = view.at[body], view.radius[body]
    hollow = view.is_hollow(body)
    width = 2 * LINE if hollow else LINE
    style = f'fill="{"none" if hollow else _color(fill)}" stroke="{_color(line)}" stroke-width="{width:g}"'
    floor = view.half_space(body)
    if floor:
        _, (nx, ny) = floor
        turn = math.degrees(math.atan2(nx, -ny))  # from upwards
        return (
            f'<rect x="{-2 * SIZE}" y="{width / 2:.2f}" width="{4 * SIZE}" height="{2 * SIZE}" '
            f'transform="translate({x:.2f} {y:.2f}) rotate({turn:.2f})" {style}/>'
        )
    if view.start.is_torus(body):
        middles, radius = view.tube(body)
        circle = f'r="{radius - width / 2:.2f}" {style}/>'
        return "\n".join(f'<circle cx="{px:.2f}" cy="{py:.2f}" {circle}' for px, py in middles)
    if view.parts(body):
        return "\n".join(
            f'<circle cx="{px:.2f}" cy="{py:.2f}" r="{r - width / 2:.2f}" {style}/>'
            for (px, py), r in view.parts(body)
        )
    side = view.side_view(body)
    inner = radius - width / 2  # the outline lies inside the edge
    if side is None:
        return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{inner:.2f}" {style}/>'
    (dx, dy), half = side
    turn = math.degrees(math.atan2(dy, dx))
    return (
        f'<rect x="{-half:.2f}" y="{-inner:.2f}" width="{2 * half:.2f}" height="{2 * inner:.2f}" '
        f'transform="translate({x:.2f} {y:.2f}) rotate({turn:.2f})" {style}/>'
    )


def _force(view: View) -> list[str]:
    """A shaft of 4 pixels and a head of 14 across, as on the PNG"""
    (x, y), (tip_x, tip_y), (dx, dy) = view.arrow()
    neck = (tip_x - (HEAD - 2.0) * dx, tip_y - (HEAD - 2.0) * dy)
    base = (tip_x - HEAD * dx, tip_y - HEAD * dy)
    left, right = (base[0] - 7.0 * dy, base[1] + 7.0 * dx), (base[0] + 7.0 * dy, base[1] - 7.0 * dx)
    corners = " ".join(f"{px:.2f},{py:.2f}" for px, py in ((tip_x, tip_y), left, right))
    return [
        f'<line x1="{x:.2f}" y1="{y:.2f}" x2="{neck[0]:.2f}" y2="{neck[1]:.2f}" '
        f'stroke="{_color(FORCE)}" stroke-width="4"/>',
        f'<polygon points="{corners}" fill="{_color(FORCE)}"/>',
    ]
