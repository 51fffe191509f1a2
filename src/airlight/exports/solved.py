"""The light field that a renderer has solved, read back from the device."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import SettingsError
from ..fields import LatticeSource
from ..gpu.memory import Texture
from ..lattice.placement import LatticeParams
from ..maths.arrays import F32, F64
from ..maths.transforms import triple
from ..pop.media import PopMedia
from ..pop.solver import PopSolver
from ..rendering import Renderer
from ..scene.scene import Scene
from ..scene.settings import given_settings
from ..techniques.technique import Technique
from .light_field import LatticeLight, LightField, VolumeLight

SOLVERS = ("lpv", "lpv-march", "lpv-sum", "lpv-scatter", "pop", "auto")
"""Techniques that solve a light field."""


def export_lattice(
    scene: Scene | str | Path,
    path: Any = None,
    *,
    technique: str = "auto",
    settings: Mapping[str, Any] | None = None,
    adapter: str = "auto",
) -> LightField:
    """Solve the light in `scene`, write it to `path` (.npz, .vdb or a folder) if given, return it.

    `settings` as in `airlight render -D`. Raises SettingsError for a technique that stores no
    light, DeviceError, OutputError.
    """
    if technique in ("direct", "single"):
        raise _no_light(technique)

    # One frame solves the light, also of rooms that the camera is not in; no pixel is read.
    settings = {"hidden_lights": True, **given_settings(settings)}
    with Renderer(scene, technique, (16, 16), settings=settings, adapter=adapter) as renderer:
        renderer.frame(read=False)
        field = light_field(renderer, technique)
    if path is not None:
        field.save(path)
    return field


def light_field(renderer: Renderer, technique: str = "") -> LightField:
    """The light that `renderer` solved for its last frame, as arrays.

    For light that changes: move something with `renderer.frame(lights=..., read=False)` and ask
    again; nothing is loaded or compiled a second time. `technique` is the name that the arrays'
    header has, the renderer's own by default. Lights that closed walls part from the renderer's
    camera are dark there, unless its settings have `hidden_lights`. Raises SettingsError where the
    technique stores no light.
    """
    used = renderer.technique
    volumes = _volume_lights(used, renderer)
    lattices = _lattices(used, np.array(renderer.origin))
    if not lattices and not volumes:
        raise _no_light(technique or used.name)
    return LightField(technique or used.name, renderer.scene.name, lattices, volumes)


def _no_light(technique: str) -> SettingsError:
    return SettingsError(
        f"technique '{technique}' keeps no light that could be exported",
        remedy=f"Choose from {', '.join(SOLVERS)}.",
    )


def _lattices(used: Technique, origin: F64) -> tuple[LatticeLight, ...]:
    """All lattices that surfaces read, the finest first, with what media scatter in them.

    `origin`: m in the world, of the device's positions.
    """
    if used.fields is None or used.fields.irradiance is None:
        return ()
    # Textures that all lattices share, read once.
    blockers, bound = used.kit.blockers, used.fields.irradiance.bound
    held = {
        "states": _bands(bound),
        "open": np.concatenate(
            [blockers.visibility_a.read(), blockers.visibility_b.read()[..., :2]], axis=-1
        ),
        "walls": blockers.walls.read(),
        "planes": blockers.planes.read(),
    }
    # Each lattice's own part of them.
    rows = bound["lattices"].read(LatticeParams.dtype)
    made = [_lattice_light(row, held, origin) for row in rows]
    if used.fields.scattered is None:
        return tuple(made)
    airs = _airs(used.fields.scattered)
    return tuple(replace(one, air=air) for one, air in zip(made, airs, strict=True))


def _lattice_light(record: Any, held: Mapping[str, Any], origin: F64) -> LatticeLight:
    cell, is_paper = float(record["cell"]), bool(record["is_paper"])
    first, (x, y, z) = int(record["first_row"]), (int(n) for n in record["count"])
    # Lattices share textures as large as the largest of them.
    states, openness, walls, planes = (
        held[k][:z, first : first + y, :x] for k in ("states", "open", "walls", "planes")
    )
    # Stored units to radiance, so that irradiance is pi (a - 2/3 b.n) to first order.
    scale = 1.0 / (cell**2 * float(record["power_scale"]))
    if is_paper:
        weights = scale * 4.0 / np.pi * np.array([1.0, 1.5, 1.5, 1.5])
    else:
        weights = scale * float(record["lookup_scale"]) * np.ones(4)
    # From the scene near its camera to the world: both are lengths along the lattice's axes.
    names = ("fade_low", "fade_low_width", "fade_high", "fade_high_width")
    fade = np.array([record[k] for k in names], np.float64)
    axes = np.array([record[f"axis_{k}"] for k in "xyz"], np.float64)
    fade[[0, 2]] += axes @ origin
    return LatticeLight(
        axes=axes,
        origin=triple(record["origin"] + axes @ origin),
        cell=cell,
        fade=fade,
        rule="linear" if is_paper else "lobe",
        surfaces=(states * weights).astype(np.float32),
        openness=(openness / 255.0).astype(np.float32),
        walls=np.maximum(walls[..., :3] / 127.0, -1.0).astype(np.float32),
        dead_ends=walls[..., 3].astype(np.uint8),
        planes=planes.astype(np.float32),
    )


def _airs(source: LatticeSource) -> list[F32]:
    """The radiance that media scatter, where the technique marches lattices, the finest first."""
    bands, largest = _bands(source.bound), source.placement
    weights = source.scale * np.array([1.0, *[source.direct] * 3])

    # A pass scales what it reads by its largest cells; finer cells have less area.
    found = []
    for placement in source.levels:
        # Lattices share textures, which hold the power of cells.
        (x, y, z), first = placement.count, placement.first_row
        own = bands[:z, first : first + y, :x] * weights * (largest.cell / placement.cell) ** 2
        found.append(own.astype(np.float32))
    return found


def _bands(bound: Mapping[str, Texture]) -> np.ndarray[Any, np.dtype[np.float32]]:
    """(Z, Y, X, 3, 4), stored units."""
    channels = [bound[f"lattice_{name}"].read() for name in ("red", "green", "blue")]
    return np.stack(channels, axis=-2).astype(np.float32)


def _volume_lights(used: Technique, renderer: Renderer) -> tuple[VolumeLight, ...]:
    media = used.find(PopMedia)
    solvers = media.solvers if media else ()
    eye, origin = triple(renderer.scene.camera.position), renderer.origin
    return tuple(VolumeLight(_scattered(s), _world_from_unit(s, origin), eye) for s in solvers)


def _world_from_unit(solver: PopSolver, origin: tuple[float, float, float]) -> F64:
    """Where the cells of a medium's grid are, in the world."""
    # The device's positions are near the camera; the world's origin lies elsewhere.
    placed = np.array(np.linalg.inv(solver.medium.placement.uvw_from_world), np.float64)
    placed[:3, 3] += origin
    return placed


def _scattered(solver: PopSolver) -> np.ndarray[Any, np.dtype[np.float32]]:
    """(Z, Y, X, 3): in-scattered radiance per unit scattering coefficient, W m^-2 sr^-1."""
    return (solver.emission.whole.read()[..., :3] * solver.scale).astype(np.float32)
