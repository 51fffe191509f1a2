"""A two-storey atrium around an open court; stands in for the Sponza the papers use.

Ten column bays by four around a court of 18.6 x 6.6 m, galleries 3.6 m deep, 12.6 m high.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from ..camera import Camera
from ..checks import F64, Rgb, Vec3
from ..lights import DirectionalLight
from ..material import Material
from ..medium import Medium, extinction_and_albedo
from ..mesh import Geometry, Mesh
from ..scene import Scene
from . import arcade, atrium_shell, columns, fabric, foliage, stone
from .arcade import BAY_M, STOREY_M
from .atrium_shell import AXIS_X_M, AXIS_Z_M, INNER_X_M
from .patch import Finish, merged, moved, placed_at
from .relief import lion_shield
from .rod import curtain_rod
from .sky import clear_sky

SUN_TRAVEL: Vec3 = (0.26, -0.88, 0.36)
SUN_IRRADIANCE: Rgb = (30.0, 27.0, 22.0)

CLOTH_COLORS: dict[str, Rgb] = {
    "red": (0.54, 0.045, 0.035),
    "green": (0.055, 0.27, 0.07),
    "blue": (0.05, 0.11, 0.46),
}

BRONZE = Finish(Material(name="bronze", base_color=(0.45, 0.29, 0.13), roughness=0.4, metallic=1))
WATER = Finish(Material(name="water", base_color=(0.02, 0.035, 0.035), roughness=0.08))

_FLOORS = (0.0, STOREY_M)


def atrium(*, seed: int = 7) -> Scene:
    """Two storeys of arches around an open court, drapes, plants, a fountain; sun and sky.

    About 260,000 triangles, instances counted each. `seed` varies stone, cloth and plants.
    """
    # Parts draw from one generator in turn, so their order is part of the scene.
    rng = np.random.default_rng(seed)
    carved = stone.carved_limestone(rng)
    meshes = (
        *_shell(rng, carved),
        *_arcades(rng, carved),
        *_columns(carved),
        *_drapes(rng),
        *_plants(rng),
        *_props(carved),
    )
    return Scene(
        name="atrium",
        meshes=meshes,
        lights=(DirectionalLight(SUN_TRAVEL, SUN_IRRADIANCE),),
        environment=clear_sky(SUN_TRAVEL),
        camera=Camera(
            position=(-8.6, 1.7, -1.1),
            target=(1.0, 3.05, 0.25),
            fov_y_deg=60.0,
            exposure_stops=0.0,
        ),
    )


def atrium_fog(*, sigma_s: float = 0.03, g: float = 0.0, seed: int = 7) -> Scene:
    """The atrium filled with thin, white haze; `sigma_s` scattering per metre."""
    sigma_t, albedo = extinction_and_albedo(sigma_s, 0.0)
    clear = atrium(seed=seed)
    return replace(clear, name="atrium-fog", medium=Medium(sigma_t, albedo=albedo, g=(g, g, g)))


def bay_places(floor_m: float) -> list[F64]:
    """Where the 22 bays of a storey stand: +z of each into the court."""
    long_x = (np.arange(8) - 3.5) * BAY_M
    short_z = (np.arange(3) - 1.0) * BAY_M
    return _ring(long_x, short_z, floor_m)


def column_places(floor_m: float) -> list[F64]:
    """Where the 18 columns of a storey stand, between the bays."""
    return _ring((np.arange(7) - 3.0) * BAY_M, (np.arange(2) - 0.5) * BAY_M, floor_m)


def corner_places(floor_m: float) -> list[F64]:
    """The court's corners, each seen from both arcades that meet there: eight."""
    return _ring((-AXIS_X_M, AXIS_X_M), (-AXIS_Z_M, AXIS_Z_M), floor_m)


def _ring(long_x: Iterable[float], short_z: Iterable[float], floor_m: float) -> list[F64]:
    # The long sides, then the short ones, each turned into the court.
    xs, zs = [float(x) for x in long_x], [float(z) for z in short_z]
    return [
        *(placed_at(x, floor_m, -AXIS_Z_M) for x in xs),
        *(placed_at(x, floor_m, AXIS_Z_M, 180.0) for x in xs),
        *(placed_at(-AXIS_X_M, floor_m, z, 90.0) for z in zs),
        *(placed_at(AXIS_X_M, floor_m, z, -90.0) for z in zs),
    ]


def _both(places: Callable[[float], list[F64]]) -> list[F64]:
    return [place for floor in _FLOORS for place in places(floor)]


def _shell(rng: np.random.Generator, carved: Finish) -> tuple[Mesh, ...]:
    # Walls and floors in stone of their own, mouldings in the carved one.
    here, above = placed_at(0, 0, 0), placed_at(0, STOREY_M, 0)
    blocks = stone.limestone_blocks(rng)
    tiles = stone.diamond_tiles(rng)
    return (
        *blocks.meshes(atrium_shell.outer_walls(), "outer walls"),
        *blocks.meshes(arcade.arch_wall(), "arcade wall", _both(bay_places)),
        *stone.paving(rng).meshes(atrium_shell.court_floor(), "court floor"),
        *tiles.meshes(atrium_shell.gallery_floor(0.0), "gallery floor", [here, above]),
        *carved.meshes(atrium_shell.skirting(), "skirting", [here, above]),
        *carved.meshes(atrium_shell.string_course(), "string course"),
        *carved.meshes(atrium_shell.cornice(), "cornice"),
    )


def _arcades(rng: np.random.Generator, carved: Finish) -> tuple[Mesh, ...]:
    lime = stone.plaster(rng)
    centre_z = arcade.OUTER_WALL_Z + arcade.GALLERY_M / 2.0
    # A vault spans a gallery and reaches a little into both of its walls.
    half_z = arcade.GALLERY_M / 2.0 + 0.05
    behind = placed_at(0.0, 0.0, centre_z)
    corner_x, corner_z = AXIS_X_M - centre_z, AXIS_Z_M - centre_z
    corners = [
        placed_at(sx * corner_x, y, sz * corner_z)
        for y in _FLOORS
        for sx in (-1, 1)
        for sz in (-1, 1)
    ]
    # Vaults over the bays and corners, a rib and a pilaster between two of them.
    bays, between, ends = _both(bay_places), _both(column_places), _both(corner_places)
    bay_vault = arcade.groin_vault(BAY_M / 2.0, half_z)
    return (
        *carved.meshes(merged([arcade.archivolt(), arcade.blind_arch()]), "archivolts", bays),
        *lime.meshes(bay_vault, "vault", [bay @ behind for bay in bays]),
        *lime.meshes(arcade.groin_vault(half_z, half_z), "corner vault", corners),
        *carved.meshes(_rib_and_pilaster(0.19), "rib", between),
        *carved.meshes(_rib_and_pilaster(0.40), "corner rib", ends),
        *carved.meshes(arcade.balustrade(), "balustrade", bay_places(STOREY_M)),
    )


def _columns(carved: Finish) -> tuple[Mesh, ...]:
    # Upper columns are thinner and twisted, and stand on pedestals.
    raised = placed_at(0.0, columns.PEDESTAL_M, 0.0)
    shaft = columns.column(columns.SPRING_M - columns.PEDESTAL_M, 0.21, twist_turns=0.35)
    upper = merged([columns.pedestal(0.36), moved(shaft, raised)])
    # A corner has one pier, though both arcades that meet there count it.
    piers = [place for floor in _FLOORS for place in corner_places(floor)[:4]]
    return (
        *carved.meshes(columns.column(columns.SPRING_M, 0.26), "column", column_places(0.0)),
        *carved.meshes(upper, "upper column", column_places(STOREY_M)),
        *carved.meshes(columns.pier(0.45, STOREY_M), "pier", piers),
    )


def _rib_and_pilaster(half_m: float) -> Geometry:
    """A gallery's transverse arch and the pilaster that carries it on the outer wall."""
    stand = placed_at(0.0, 0.0, arcade.OUTER_WALL_Z)
    return merged([arcade.transverse_rib(half_m), moved(columns.pilaster(half_m, 0.10), stand)])


def _drapes(rng: np.random.Generator) -> tuple[Mesh, ...]:
    cloths = fabric.woven(rng, CLOTH_COLORS)
    bays = bay_places(STOREY_M)
    hung = placed_at(0.0, columns.SPRING_M - 0.12, 0.76)
    colors = ("red", "green", "blue")
    meshes: list[Mesh] = []
    # Each colour hangs in every third of the draped bays, with folds of its own.
    for k, color in enumerate(colors):
        cloth = fabric.drape(1.85, 5.3, rng)
        places = [bays[bay] @ hung for n, bay in enumerate(_DRAPED) if n % len(colors) == k]
        meshes += cloths[color].meshes(cloth, f"{color} drape", places)
    # One rod for each drape.
    rods = [bays[bay] @ hung for bay in _DRAPED]
    return (*meshes, *BRONZE.meshes(curtain_rod(1.95, 0.46), "rod", rods))


_DRAPED = (1, 3, 4, 6, 14, 12, 11, 9)
"""Bays with a drape: four on each long side, facing each other in unlike colours."""


def _plants(rng: np.random.Generator) -> tuple[Mesh, ...]:
    # Each plant is turned by chance, and two shapes of bush suffice for them to look different.
    spots = [(x, z) for x in (-6.0, 1.2, 6.0) for z in (-2.55, 2.55)] + [(8.5, -2.3), (8.5, 2.3)]
    places = [placed_at(x, 0.0, z, float(rng.uniform(0, 360))) for x, z in spots]
    lifted = [place @ placed_at(0.0, 0.62, 0.0) for place in places]
    leaves = foliage.frond_finish(rng)
    bushes = (foliage.fronds(rng), foliage.fronds(rng, count=28, length_m=1.35))
    return (
        *stone.terracotta(rng).meshes(foliage.pot(), "pot", places),
        *foliage.SOIL.meshes(foliage.soil(), "soil", places),
        *leaves.meshes(bushes[0], "plant", lifted[::2]),
        *leaves.meshes(bushes[1], "plant", lifted[1::2]),
    )


def _props(carved: Finish) -> tuple[Mesh, ...]:
    basin, water = columns.fountain()
    middle = [placed_at(3.6, 0.0, 0.0)]
    shields = [
        placed_at(INNER_X_M, 2.9, 0.0, -90.0),
        placed_at(-INNER_X_M, 2.9, 0.0, 90.0),
    ]
    return (
        *carved.meshes(basin, "fountain", middle),
        *WATER.meshes(water, "water", middle),
        *carved.meshes(lion_shield(), "lion shield", shields),
    )
