"""Lines and circles that imgui draws for us: the marks over the image, and the pad of the sky."""

from __future__ import annotations

import itertools

from imgui_bundle import imgui

from .gizmos import Mark
from .gui_theme import ACCENT, GROUND
from .widgets import sky_angles_deg, sky_place

_PAD_PX = 96.0


def sky_pad(label: str, angles: tuple[float, float]) -> tuple[bool, tuple[float, float]]:
    """A pad that is the sky seen from below the ground, north up; and the angles."""
    azimuth, elevation = angles
    # The pad: a button that nothing is drawn of, with the sky over it.
    corner = imgui.get_cursor_screen_pos()
    imgui.invisible_button(f"{label} pad", (_PAD_PX, _PAD_PX))
    radius = _PAD_PX / 2.0
    centre = (corner.x + radius, corner.y + radius)
    # A quick hand lets go in the frame in which it arrives.
    is_dragged = imgui.is_item_active() or imgui.is_item_deactivated()
    if is_dragged:
        mouse = imgui.get_io().mouse_pos
        x, y = (mouse.x - centre[0]) / radius, (mouse.y - centre[1]) / radius
        azimuth, elevation = sky_angles_deg(x, y)
    _pad(centre, radius, azimuth, elevation)
    # Beside it both angles as numbers.
    imgui.same_line()
    imgui.begin_group()
    imgui.text(label.partition("##")[0])
    imgui.push_item_width(80.0)
    turned, azimuth = imgui.drag_float("azimuth", azimuth, 0.5, -180.0, 180.0, "%.1f")
    raised, elevation = imgui.drag_float("elevation", elevation, 0.5, -90.0, 90.0, "%.1f")
    imgui.pop_item_width()
    imgui.end_group()
    return is_dragged or turned or raised, (azimuth, elevation)


def _pad(centre: tuple[float, float], radius: float, azimuth: float, elevation: float) -> None:
    draw = imgui.get_window_draw_list()
    # The sky's disk, rings at every 30 degrees, and the light's dot.
    draw.add_circle_filled(centre, radius, _packed((0.16, 0.19, 0.24)), 48)
    for share in (1.0, 2.0 / 3.0, 1.0 / 3.0):
        draw.add_circle(centre, radius * share, _packed((0.36, 0.40, 0.46)), 48)
    x, y = sky_place(azimuth, elevation) * radius
    draw.add_circle_filled((centre[0] + x, centre[1] + y), 6.0, _packed(ACCENT[:3]), 24)


def _packed(rgb: tuple[float, ...], alpha: float = 1.0) -> int:
    """A colour as imgui's draw lists take it: alpha, blue, green, red."""
    r, g, b = (round(255.0 * min(max(c, 0.0), 1.0)) for c in rgb)
    return round(255.0 * alpha) << 24 | b << 16 | g << 8 | r


def draw_marks(marks: tuple[Mark, ...], left: float) -> None:
    """The marks of lights over the image, which begins at `left`; each with a dark border."""
    draw = imgui.get_background_draw_list()
    for mark in marks:
        points = [(left + x, y) for x, y in mark.points]
        # A dark border under each mark, so that it shows before every image.
        bright, dark = _packed(mark.colour), _packed(GROUND[:3], 0.7)
        if mark.kind == "text":
            _text(points[0], mark, bright, dark)
        elif mark.kind == "line":
            for one, two in itertools.pairwise(points):
                draw.add_line(one, two, dark, mark.width + 2.0)
            for one, two in itertools.pairwise(points):
                draw.add_line(one, two, bright, mark.width)
        else:
            draw.add_circle_filled(points[0], mark.width + 1.5, dark, 24)
            draw.add_circle_filled(points[0], mark.width, bright, 24)


def _text(at: tuple[float, float], mark: Mark, bright: int, dark: int) -> None:
    """The text of a mark on a dark ground; its base line is at `at`."""
    draw, size = imgui.get_background_draw_list(), imgui.calc_text_size(mark.text)
    left, top = at[0] - (size.x if mark.ends_here else 0.0), at[1] - 0.8 * size.y
    low, high = (left - 4.0, top - 2.0), (left + size.x + 4.0, top + size.y + 2.0)
    draw.add_rect_filled(low, high, dark, 4.0)
    draw.add_text((left, top), bright, mark.text)
