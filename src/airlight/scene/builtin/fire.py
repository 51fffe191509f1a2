"""A fire of logs at night, with its smoke, animated: the only light there is."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from ..animation import Animation
from ..animation.density import MadeDensity, VolumeTrack
from ..camera import Camera
from ..checks import F32, Bounds, number
from ..emission import Emission
from ..environment import Environment
from ..material import Material
from ..mesh import Mesh
from ..scene import Scene
from ..volume import Volume
from . import stone
from .eddies import Eddies, cell_centres
from .noise import smoothstep
from .patch import Finish, moved, placed_at
from .profile import profile, revolved
from .smoke import court
from .solids import rounded_box

SHAPE = (64, 128, 64)
"""Cells of the grids, (z, y, x): 2.5 cm each."""
BOUNDS: Bounds = ((-0.8, 0.12, -0.8), (0.8, 3.32, 0.8))
FLAME_M = 1.25
"""How high the longest flames reach above the logs."""
BED_M = 0.30
"""Radius of the bed that they rise from."""
COOLEST_K, HOTTEST_K = 1000.0, 1900.0
"""At the rim of a flame, and in its middle: those of burning wood, whose soot glows."""
_RISE_M_S = 1.7
_EDDIES = Eddies(box_m=(1.2, 2.4, 1.2), cells=(96, 192, 96), largest=(4, 8, 4))
_TRACE_STEPS = 10


def fire(*, time: float = 0.0, seed: int = 4) -> Scene:
    """A fire of logs in a ring of stones at night; it burns with time, seconds.

    `time` is when it is shown; `scene.at` moves it on from there or anywhere. Grids of
    64 x 128 x 64 over 1.6 x 3.2 x 1.6 m: temperatures, whose soot glows as black bodies do, and
    smoke of extinction 3 per metre at density 1, albedo 0.6, g 0.4. Raises SceneError for a time
    that is not a number.
    """
    now = number(time, "time")
    volume = Volume(
        sigma_t=(3.0, 3.0, 3.0),
        density=soot(now, seed),
        bounds=BOUNDS,
        albedo=(0.6, 0.6, 0.6),
        g=(0.4, 0.4, 0.4),
        source="builtin fire",
        emission=Emission((0.12, 0.12, 0.12), temperature=temperature(now, seed)),
    )
    burning = MadeDensity(partial(soot, seed=seed), make_emission=partial(temperature, seed=seed))
    return Scene(
        name="fire",
        meshes=(*court(seed), *_hearth(seed)),
        environment=Environment(radiance=(0.004, 0.006, 0.011)),
        camera=Camera((1.3, 1.35, 4.6), (0.0, 1.0, 0.0), fov_y_deg=42.0, exposure_stops=1.0),
        volumes=(volume,),
        animation=Animation((VolumeTrack(0, burning),)),
    )


def soot(time: float, seed: int) -> F32:
    """Density (z, y, x) in [0, 1] of soot in the flames and of the smoke above, at `time`, s."""
    return _burnt(time, seed)[0]


def temperature(time: float, seed: int) -> F32:
    """Kelvin (z, y, x) at `time` in seconds; 0 where nothing burns."""
    return _burnt(time, seed)[1]


@lru_cache(maxsize=2)
def _burnt(time: float, seed: int) -> tuple[F32, F32]:
    """Soot and temperature, as `smoke.plume_density` follows the gas back to where it came from.

    Flames narrow as the gas speeds up, and end in tongues where the fuel is used up, sooner at
    their rims; what they leave is smoke, which widens and thins by the air that it takes in.
    """
    points = cell_centres(BOUNDS, SHAPE)
    height = points[:, 1] - np.float32(BOUNDS[0][1])
    necked = BED_M * (1.0 - 0.35 * smoothstep(0.0, 0.7, height))
    # Only cells near the column are followed.
    radius = (necked + 0.16 * np.maximum(height - 0.5, 0.0)).astype(np.float32)
    near = np.hypot(points[:, 0], points[:, 2]) < 2.6 * radius
    points, height, radius = points[near], height[near], radius[near]
    # Eddies ride upwards with the gas, and shake it the longer it has risen.
    eddies, texture = _EDDIES.fields(seed)
    ride = np.array([0.05, _RISE_M_S, -0.04], np.float32) * np.float32(time)
    here = points - ride
    # What the eddies did while the gas rose is undone in even steps of time.
    step_s = (height / (_RISE_M_S * _TRACE_STEPS)).astype(np.float32)
    for _ in range(_TRACE_STEPS):
        speed = 0.12 + 0.34 * np.minimum(height, 1.0)
        here = here - _EDDIES.look_up(eddies, here) * (speed * step_s)[:, None]
    start = here + ride
    rho = (np.hypot(start[:, 0], start[:, 2]) / radius).astype(np.float32)
    puff = _EDDIES.look_up(texture[..., None], here)[:, 0]
    # How much burns: in the column over the bed, until the fuel ends.
    used = height / np.float32(FLAME_M) + 0.35 * rho - 0.30 * puff
    burning = smoothstep(1.05, 0.35, rho - 0.22 * puff) * smoothstep(1.0, 0.45, used)
    burning *= smoothstep(-0.02, 0.10, height)
    # Smoke begins where the fuel ends, thinner the wider the column has become.
    smoky = smoothstep(1.1, 0.4, rho + 0.14 * puff) * smoothstep(0.45, 1.1, used)
    smoky *= 0.5 * (BED_M / (BED_M + radius)) * (1.0 + 0.4 * puff)
    smoky *= smoothstep(3.2, 2.5, height)
    # Both fade before the grid's sides, where they would end in a plane.
    edge = np.float32(BOUNDS[1][0]) - np.abs(points[:, ::2]).max(axis=1)
    rim = smoothstep(0.03, 0.20, edge)
    # Soot glows in the flames as well, so that these have some density.
    grids = np.zeros((2, int(np.prod(SHAPE))), np.float32)
    grids[0][near] = np.clip((smoky + 0.15 * burning) * rim, 0.0, 1.0)
    hot = COOLEST_K + (HOTTEST_K - COOLEST_K) * np.sqrt(burning * rim)
    # Cells where hardly anything burns have no temperature.
    grids[1][near] = np.where(burning * rim > 0.002, hot, 0.0)
    made = grids.reshape(2, *SHAPE)
    made.flags.writeable = False
    return made[0], made[1]


def _hearth(seed: int) -> tuple[Mesh, ...]:
    """A ring of stones, and logs that lean together in it."""
    rng = np.random.default_rng(seed + 1)
    finish = stone.limestone_blocks(rng, size_px=256)
    sooty = replace(finish, material=replace(finish.material, base_color=(0.45, 0.42, 0.4)))
    # Stones around, each as nature left it, then five logs that lean together.
    angles = np.arange(11) * (360.0 / 11) + rng.uniform(-6.0, 6.0, 11)
    stones = []
    for angle, wide, tall in zip(
        angles, rng.uniform(0.2, 0.3, 11), rng.uniform(0.1, 0.17, 11), strict=True
    ):
        block = rounded_box((-0.09, 0.0, -0.5 * wide), (0.09, tall, 0.5 * wide), 0.04)
        turn = np.radians(angle)
        x, z = 0.62 * np.cos(turn), 0.62 * np.sin(turn)
        stones.append(moved(block, placed_at(float(x), 0.0, float(z), float(-angle))))
    meshes = [sooty.meshes(one, f"stone {k}") for k, one in enumerate(stones)]
    bark = Material(name="charred bark", base_color=(0.06, 0.045, 0.035), roughness=0.9)
    # A log is turned about its axis, with flat ends.
    log = revolved(profile([(0.0, 0.0), (0.055, 0.0), (0.06, 0.4), (0.05, 0.75), (0.0, 0.75)]), 14)
    leaning = [moved(log, _leaning(72.0 * k + 20.0)) for k in range(5)]
    meshes += [Finish(bark).meshes(one, f"log {k}") for k, one in enumerate(leaning)]
    return tuple(mesh for group in meshes for mesh in group)


def _leaning(turn_deg: float) -> np.ndarray:
    """(4, 4): a log whose foot stands 0.42 m out, and whose head leans over the middle."""
    # Tilted about its foot, then turned with it about the fire's axis.
    tilt, turn = np.radians(62.0), np.radians(turn_deg)
    lean = np.eye(4)
    lean[:3, :3] = [
        [np.cos(tilt), -np.sin(tilt), 0.0],
        [np.sin(tilt), np.cos(tilt), 0.0],
        [0.0, 0.0, 1.0],
    ]
    lean[:3, 3] = (0.44, 0.04, 0.0)
    about = np.eye(4)
    c, s = np.cos(turn), np.sin(turn)
    about[:3, :3] = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    return np.asarray(about @ lean)
