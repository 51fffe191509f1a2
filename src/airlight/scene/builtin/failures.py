"""What light on a lattice is bad at: the failure cases of Billeter2012 Fig. 6."""

from __future__ import annotations

from typing import Any

from ..camera import Camera
from ..lights import SpotLight
from ..medium import Medium, extinction_and_albedo
from ..mesh import Mesh
from ..scene import Scene
from .patch import lambert, placed_at
from .solids import box, shell

HALL_M = (8.0, 4.0, 6.0)
"""Inside, x y z; with 32 cells along x a cell is 0.28 m."""
BOARD_M = 0.02
_SHELL_M = 0.2
_SIGMA_S = 0.06
_LAMP = (-3.2, 2.6, 0.0)


def bleeding() -> Scene:
    """A thin board lit hard from its far side: its near side glows with light that bleeds.

    It stands aslant to the cells, which stops less than a board along them.
    """
    return _hall("bleeding", _spot(9.0, 14.0), _behind(), turned_deg=30.0, grey=0.2)


def pinpoint() -> Scene:
    """A strong light on a spot smaller than a cell: a blocky glow around it."""
    return _hall("pinpoint", _spot(1.6, 2.2), _before())


def one_iteration() -> Scene:
    """Light that moved by one cell only: the cells themselves show."""
    settings = {"lpv-scatter": {"iterations": 1, "acceleration": "none"}}
    return _hall("one-iteration", _spot(9.0, 14.0), _before(), settings)


def _hall(
    name: str,
    lamp: SpotLight,
    camera: Camera,
    settings: dict[str, dict[str, Any]] | None = None,
    *,
    turned_deg: float = 0.0,
    grey: float = 0.5,
) -> Scene:
    sigma_t, albedo = extinction_and_albedo(_SIGMA_S, 0.0)
    # No bounds: the hall is closed, and the paper's scheme knows none.
    medium = Medium(sigma_t, albedo)
    return Scene(
        name=name,
        meshes=(*_walls(grey), _board(turned_deg)),
        lights=(lamp,),
        camera=camera,
        medium=medium,
        settings=settings or {},
    )


def _spot(inner_deg: float, outer_deg: float) -> SpotLight:
    """From beside the left wall onto the board's left side, all of its light on the board."""
    aim = (0.0 - _LAMP[0], 1.5 - _LAMP[1], 0.0)
    # A narrower cone is as much brighter, so that all of them send about the same power.
    power = 6000.0 / (outer_deg * outer_deg)
    color = (power * 1.0, power * 0.9, power * 0.75)
    return SpotLight(_LAMP, aim, color, inner_deg, outer_deg)


def _behind() -> Camera:
    """The board's dark side."""
    return Camera((3.4, 1.7, 1.2), (0.0, 1.4, 0.0), fov_y_deg=50.0, exposure_stops=None)


def _before() -> Camera:
    """Its lit side, from beside the lamp."""
    return Camera((-3.4, 1.7, 1.4), (0.0, 1.4, -0.2), fov_y_deg=50.0, exposure_stops=None)


def _walls(reflectance: float) -> tuple[Mesh, ...]:
    """Six slabs around the hall."""
    x, y, z = HALL_M[0] / 2.0, HALL_M[1], HALL_M[2] / 2.0
    slabs = shell((-x, 0.0, -z), (x, y, z), _SHELL_M)
    grey = lambert("grey", (reflectance,) * 3)
    return tuple(mesh for slab in slabs for mesh in grey.meshes(slab, "wall"))


def _board(turned_deg: float) -> Mesh:
    """2.4 x 2.4 m, thinner than a tenth of a cell, upright on the floor across the hall."""
    body = box((-0.5 * BOARD_M, 0.0, -1.2), (0.5 * BOARD_M, 2.4, 1.2))
    return lambert("board", (0.8,) * 3).meshes(
        body, "board", [placed_at(0.0, 0.0, 0.0, turned_deg)]
    )[0]
