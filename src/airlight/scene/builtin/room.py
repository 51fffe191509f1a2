"""A furnished room with one window, the sun on its floor before a coloured wall."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..camera import Camera
from ..checks import Rgb, Vec3
from ..lights import DirectionalLight
from ..material import Material
from ..medium import Medium, extinction_and_albedo
from ..mesh import Mesh
from ..scene import Scene
from . import fabric, foliage, furniture, room_shell, stone, wood
from .patch import Finish, placed_at
from .rod import curtain_rod
from .sky import clear_sky
from .solids import rounded_box

SUN_TRAVEL: Vec3 = (0.76, -0.40, -0.27)
SUN_IRRADIANCE: Rgb = (30.0, 26.0, 20.0)
WALL_COLOR: Rgb = (0.58, 0.17, 0.085)


def room(*, seed: int = 3) -> Scene:
    """A closed room, 5.2 x 2.7 x 4.6 m, walls 0.2 m thick; sun and sky through one window.

    A sofa before a red wall, table, chairs, plant, and a shelf of 22 mm boards (a lattice's
    light leaks through those first). About 15,000 triangles. `seed` varies wood and books.
    """
    rng = np.random.default_rng(seed)
    timber = wood.timber(rng)
    return Scene(
        name="room",
        meshes=(
            *_shell(rng),
            *_sitting(rng, timber),
            *_dining(timber),
            *_reading(rng, timber),
            *_window(rng),
            *_plant(rng),
        ),
        lights=(DirectionalLight(SUN_TRAVEL, SUN_IRRADIANCE),),
        environment=clear_sky(SUN_TRAVEL),
        camera=Camera((2.25, 1.55, 2.3), (-0.75, 0.85, -0.85), fov_y_deg=58.0, exposure_stops=0.7),
    )


def foggy_room(*, sigma_s: float = 0.12, g: float = 0.0, seed: int = 3) -> Scene:
    """The room filled with white fog that scatters `sigma_s` per metre."""
    sigma_t, albedo = extinction_and_albedo(sigma_s, 0.0)
    medium = Medium(sigma_t, albedo, (g, g, g), (room_shell.LOW_M, room_shell.HIGH_M))
    return replace(room(seed=seed), name="foggy-room", medium=medium)


def _paint(name: str, color: Rgb, roughness: float = 0.6) -> Finish:
    return Finish(Material(name=name, base_color=color, roughness=roughness, two_sided=False))


def _shell(rng: np.random.Generator) -> tuple[Mesh, ...]:
    white = stone.plaster(rng, (0.74, 0.72, 0.68))
    red = stone.plaster(rng, WALL_COLOR)
    return (
        *wood.boards(rng, (0.52, 0.34, 0.20)).meshes(room_shell.floor_slab(), "floor"),
        *white.meshes(room_shell.plain_walls(), "walls"),
        *red.meshes(room_shell.colored_wall(), "coloured wall"),
        *_paint("white paint", (0.72, 0.71, 0.68)).meshes(room_shell.skirting(), "skirting"),
    )


def _sitting(rng: np.random.Generator, timber: Finish) -> tuple[Mesh, ...]:
    cloths = fabric.woven(rng, {"slate": (0.16, 0.22, 0.26), "wool": (0.55, 0.50, 0.40)})
    # Sofa, rug, and a picture above them.
    upholstery, feet = furniture.sofa()
    at = [placed_at(-0.75, 0.0, -1.45)]
    frame, canvas = furniture.picture_frame(0.9, 0.6)
    hung = [placed_at(-0.75, 1.65, room_shell.LOW_M[2])]
    rug = rounded_box((-0.95, 0.0, -0.70), (0.95, 0.012, 0.70), 0.005)
    return (
        *cloths["slate"].meshes(upholstery, "sofa", at),
        *timber.meshes(feet, "sofa feet", at),
        *cloths["wool"].meshes(rug, "rug", [placed_at(-0.75, 0.0, -0.35)]),
        *timber.meshes(frame, "picture frame", hung),
        *_paint("canvas", (0.12, 0.22, 0.34), 0.8).meshes(canvas, "picture", hung),
    )


def _dining(timber: Finish) -> tuple[Mesh, ...]:
    # Table, chairs turned towards it, and a lamp over it.
    at = placed_at(-1.15, 0.0, 1.55, 80.0)
    seats = [
        at @ placed_at(-0.32, 0.0, 0.56, 172.0),
        at @ placed_at(0.34, 0.0, 0.52, 185.0),
        at @ placed_at(0.95, 0.0, 0.05, -84.0),
    ]
    glaze = _paint("glaze", (0.10, 0.26, 0.30), 0.25)
    metal = Finish(
        Material(name="steel", base_color=(0.56, 0.57, 0.58), roughness=0.35, metallic=1.0)
    )
    return (
        *timber.meshes(furniture.table(), "table", [at]),
        *timber.meshes(furniture.chair(), "chair", seats),
        *glaze.meshes(furniture.vase(), "vase", [at @ placed_at(0.1, 0.74, 0.05)]),
        *metal.meshes(furniture.lamp_shade(), "lamp", [placed_at(-1.15, 2.7, 1.55)]),
    )


def _reading(rng: np.random.Generator, timber: Finish) -> tuple[Mesh, ...]:
    at = [placed_at(1.55, 0.0, -1.80)]
    # Books by binding, one mesh for each colour.
    piles = furniture.books(rng, len(_BINDINGS))
    bound = [
        mesh
        for (name, color), pile in zip(_BINDINGS.items(), piles, strict=False)
        for mesh in _paint(name, color, 0.7).meshes(pile, "books", at)
    ]
    return (*timber.meshes(furniture.shelf(), "shelf", at), *bound)


_BINDINGS: dict[str, Rgb] = {
    "ochre": (0.52, 0.33, 0.08),
    "bottle green": (0.04, 0.16, 0.08),
    "oxblood": (0.30, 0.04, 0.035),
    "navy": (0.04, 0.07, 0.20),
    "ivory": (0.66, 0.60, 0.47),
}


def _window(rng: np.random.Generator) -> tuple[Mesh, ...]:
    linen = fabric.woven(rng, {"linen": (0.70, 0.64, 0.52)})["linen"]
    # A curtain hangs on both sides of the opening, from a rod before the wall.
    (_, head), (near, far) = room_shell.WINDOW_Y_M, room_shell.WINDOW_Z_M
    x, top = room_shell.LOW_M[0] + 0.16, head + 0.12
    cloth = fabric.drape(0.52, top - 0.04, rng, pleats=4.5, cells=(48, 18))
    sides = [placed_at(x, top, z, 90.0) for z in (near - 0.22, far + 0.22)]
    rail = curtain_rod(far - near + 1.1, 0.15)
    bronze = Finish(
        Material(name="bronze", base_color=(0.45, 0.29, 0.13), roughness=0.4, metallic=1.0)
    )
    return (
        *_paint("white paint", (0.72, 0.71, 0.68)).meshes(room_shell.window_frame(), "window"),
        *linen.meshes(cloth, "curtain", sides),
        *bronze.meshes(rail, "curtain rod", [placed_at(x, top + 0.02, (near + far) / 2, 90.0)]),
    )


def _plant(rng: np.random.Generator) -> tuple[Mesh, ...]:
    # The atrium's plant, at 62 % of its size.
    at = [placed_at(-2.15, 0.0, -1.60, 30.0, 0.62)]
    leaves = foliage.fronds(rng, count=22)
    return (
        *stone.terracotta(rng).meshes(foliage.pot(), "pot", at),
        *foliage.SOIL.meshes(foliage.soil(), "soil", at),
        *foliage.frond_finish(rng).meshes(leaves, "plant", [at[0] @ placed_at(0, 0.62, 0)]),
    )
