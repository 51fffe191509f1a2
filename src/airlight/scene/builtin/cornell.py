"""The Cornell box."""

from __future__ import annotations

from dataclasses import replace

from ...errors import SceneError, nearest
from ..camera import Camera
from ..checks import Rgb
from ..lights import Light, PointLight, SpotLight
from ..material import Material
from ..medium import Medium, extinction_and_albedo
from ..mesh import Mesh
from ..scene import Scene
from .patch import Finish, lambert, merged, placed_at
from .solids import box, rectangle

WIDTH_M, HEIGHT_M, DEPTH_M = 5.56, 5.488, 5.592
"""The measured box of Cornell University, ten times enlarged: a room."""

WALL_M = 0.2

WHITE: Rgb = (0.73, 0.73, 0.73)
RED: Rgb = (0.63, 0.065, 0.05)
GREEN: Rgb = (0.14, 0.45, 0.091)

_LAMP_HALF_X, _LAMP_HALF_Z = 0.65, 0.525
_LAMP_INTENSITY: Rgb = (110.0, 92.0, 68.0)


def cornell(*, light: str = "spot") -> Scene:
    """The Cornell box, open towards the camera at +z: red left, green right, two white blocks.

    It stands on y = 0, 5.56 x 5.488 x 5.592 m inside, walls 0.2 m thick, all pure Lambert.
    `light` is "spot" (a wide cone under the ceiling's lamp panel), "point", or "area" (the
    panel glows: W m^-2 sr^-1 of the same intensity on its axis). No environment.
    Raises SceneError for another light.
    """
    # A point light under the panel; or None, and the panel itself glows.
    kinds: dict[str, Light | None] = {
        "spot": SpotLight((0.0, HEIGHT_M - 0.06, 0.0), (0.0, -1.0, 0.0), _LAMP_INTENSITY, 50, 75),
        "point": PointLight((0.0, HEIGHT_M - 0.5, 0.0), _LAMP_INTENSITY),
        "area": None,
    }
    if light not in kinds:
        raise SceneError(f"cornell light '{light}' is unknown", remedy=nearest(light, kinds))
    local = kinds[light]
    return Scene(
        name="cornell",
        meshes=(*_walls(), *_blocks(), _panel(glows=local is None)),
        lights=() if local is None else (local,),
        camera=Camera((0.0, 2.73, 10.8), (0.0, 2.73, 0.0), fov_y_deg=39.3),
    )


def cornell_area() -> Scene:
    """The Cornell box with its glowing panel: an area light, soft shadows."""
    return replace(cornell(light="area"), name="cornell-area")


def haze_box(*, light: str = "spot", sigma_s: float = 0.12, g: float = 0.0) -> Scene:
    """The Cornell box full of white haze that scatters `sigma_s` per metre.

    `light`: "spot", "point" or "area", as of `cornell`.
    """
    sigma_t, albedo = extinction_and_albedo(sigma_s, 0.0)
    x, z = WIDTH_M / 2.0, DEPTH_M / 2.0
    medium = Medium(sigma_t, albedo, (g, g, g), ((-x, 0.0, -z), (x, HEIGHT_M, z)))
    return replace(cornell(light=light), name="haze-box", medium=medium)


def _walls() -> tuple[Mesh, ...]:
    """Five slabs that meet without overlapping faces; each is closed."""
    x, y, z, t = WIDTH_M / 2.0, HEIGHT_M, DEPTH_M / 2.0, WALL_M
    # White are floor, ceiling and back, which reaches behind the side walls.
    slabs = merged(
        [
            box((-x, -t, -z), (x, 0.0, z)),
            box((-x, y, -z), (x, y + t, z)),
            box((-x - t, -t, -z - t), (x + t, y + t, -z)),
        ]
    )
    left = box((-x - t, -t, -z), (-x, y + t, z))
    right = box((x, -t, -z), (x + t, y + t, z))
    return (
        *lambert("white", WHITE).meshes(slabs, "walls"),
        *lambert("red", RED).meshes(left, "left wall"),
        *lambert("green", GREEN).meshes(right, "right wall"),
    )


def _blocks() -> tuple[Mesh, ...]:
    """The short block at the right and the tall one at the left, as measured."""
    white = lambert("white", WHITE)
    short = box((-0.83, 0.0, -0.83), (0.83, 1.65, 0.83))
    tall = box((-0.83, 0.0, -0.83), (0.83, 3.30, 0.83))
    return (
        *white.meshes(short, "short block", [placed_at(0.93, 0.0, 1.11, -16.6)]),
        *white.meshes(tall, "tall block", [placed_at(-0.90, 0.0, -0.72, 17.2)]),
    )


def _panel(*, glows: bool) -> Mesh:
    # A Lambert emitter's intensity on its axis is radiance times area: either light gives the same
    # there.
    area_m2 = 4.0 * _LAMP_HALF_X * _LAMP_HALF_Z
    r, g, b = _LAMP_INTENSITY
    emission = (r / area_m2, g / area_m2, b / area_m2) if glows else (0.0, 0.0, 0.0)
    sheet = rectangle(
        (-_LAMP_HALF_X, HEIGHT_M - 0.01, _LAMP_HALF_Z),
        (2.0 * _LAMP_HALF_X, 0.0, 0.0),
        (0.0, 0.0, -2.0 * _LAMP_HALF_Z),
    )
    material = Material(
        name="lamp panel",
        base_color=(0.78, 0.78, 0.78),
        specular=0.0,
        emission=emission,
        two_sided=False,
    )
    return Finish(material).meshes(sheet, "lamp panel")[0]
