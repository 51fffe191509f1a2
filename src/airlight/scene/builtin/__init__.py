"""Procedural scenes that ship: nothing to download, the same on every machine.

    atrium       two storeys of arches around a sunlit court, drapes, plants, a fountain
    atrium-fog   the atrium in thin haze
    cornell      the Cornell box under a wide spot light (or point, or area)
    haze-box     the Cornell box full of haze
    room         a furnished room with the sun in its window
    foggy-room   the room full of fog
    wall-floor   a lit wall over a floor, for form factors
    bleeding, pinpoint, one-iteration    what light on a lattice is bad at
    smoke        a plume of smoke, animated
    fire         a fire of logs with its smoke at night, animated
    cloud        a cumulus cloud
    milk         a knot of milk: a mesh voxelised into a dense medium

A module for each: atrium (arcade, atrium_shell, columns, relief, rod), room (room_shell,
furniture), wall_floor, failures (the three that are bad), smoke and fire (eddies), and those of
their own name. They stand on parts of three kinds: textures (stone, wood, fabric, foliage, sky;
images: as 8 bits, and finishes of them), shapes (patch, solids, profile and what is made of them)
and noise.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...errors import SceneError, nearest, within_memory
from ..scene import Scene
from .atrium import atrium, atrium_fog
from .cloud import cloud
from .cornell import cornell, cornell_area, haze_box
from .failures import bleeding, one_iteration, pinpoint
from .fire import fire
from .milk import milk
from .room import foggy_room, room
from .smoke import smoke
from .wall_floor import wall_floor

__all__ = [
    "BUILTIN",
    "atrium",
    "atrium_fog",
    "bleeding",
    "builtin_scene",
    "cloud",
    "cornell",
    "cornell_area",
    "fire",
    "foggy_room",
    "haze_box",
    "milk",
    "one_iteration",
    "pinpoint",
    "room",
    "smoke",
    "wall_floor",
]

BUILTIN: dict[str, Callable[..., Scene]] = {
    "atrium": atrium,
    "atrium-fog": atrium_fog,
    "cornell": cornell,
    "cornell-area": cornell_area,
    "haze-box": haze_box,
    "room": room,
    "foggy-room": foggy_room,
    "wall-floor": wall_floor,
    "bleeding": bleeding,
    "pinpoint": pinpoint,
    "one-iteration": one_iteration,
    "smoke": smoke,
    "fire": fire,
    "cloud": cloud,
    "milk": milk,
}
"""Scene by name; the first line of each function's docstring says what it shows."""


def builtin_scene(name: str, **options: Any) -> Scene:
    """The shipped scene called `name`, with its function's options.

    Raises SceneError for an unknown name (naming the nearest) or option, and without memory for it.
    """
    if name not in BUILTIN:
        raise SceneError(f"there is no builtin scene '{name}'", remedy=nearest(name, BUILTIN))
    # A scene's options are the keyword arguments of its function.
    make = BUILTIN[name]
    known = (make.__kwdefaults__ or {}).keys()
    for option in options:
        if option not in known:
            raise SceneError(
                f"builtin scene '{name}' has no option '{option}'", remedy=nearest(option, known)
            )
    where = f"builtin:{name}"
    with within_memory("the scene", where=where, remedy="Free some memory.", kind=SceneError):
        return make(**options)
