"""A density grid on its own as a scene, or several that follow each other: something to look at
before any scene file is written.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ..animation.animation import DEFAULT_FPS
from ..checks import F32, F64, MOST, Bounds
from ..emission import Emission
from ..scene import Scene
from ..volume import IDENTITY, Volume
from .coefficient_files import colours_of
from .dense_grid import Optics
from .emission_files import on_one_grid, told_beside
from .grid_series import series_name
from .grid_times import in_time
from .ledger import note_read
from .volume_times import Series, with_times
from .volumes import (
    NOWHERE,
    UPRIGHT_SUFFIXES,
    GridValues,
    VolumeGrid,
    grid_names,
    read_values,
    read_volume,
)

DEPTH = 6.0
"""Optical depth through the denser parts, of the coefficient that is chosen for a bare grid."""
ALBEDO = 0.9
FLAME = 20.0
"""W m^-2 sr^-1 of the brightest flames of a bare grid, a tenth of its length deep."""
HOTTEST_K = 1900.0
"""What temperatures end at that are in no kelvin: a flame of wood."""
ORANGE = (1.0, 0.25, 0.02)
FLAMES = ("temperature", "flame", "flames", "heat", "fire")
"""Names of grids of what glows."""
_COOLEST_K = 600.0
FPS = 12.0
"""Times of a NetCDF or zarr file that a bare grid shows in a second."""
_LOOKED_AT = 5  # files of a series that are read to choose the one that is shown at rest
DENSITY = "density"
"""The grid, or the channel, that nobody asked for by name."""


def load_volume_scene(file: Path, keys: Mapping[str, Any] | None = None) -> Scene:
    """The grid in `file` as whitish smoke; no light, no camera. Raises SceneError.

    `keys` are up, scale, grid, channels and sequence_fps, as a [[volume]] has them; of grids with
    several times that follow each other the scene is a sequence. Unless its units say how dense
    density 1 is, sigma_t is chosen for the grid as it stands then, and a warning says so; what
    units say is per metre whatever the scale. Where the file has flames or temperatures, too, it is
    a fire.
    """
    keys = keys or {}
    scene, grid = _shown(file, keys)
    fps = keys.get("sequence_fps", FPS)
    series = Series((file,), file.name, fps, -(grid.time or 0) / fps)
    return with_times(scene, series, grid, keys, keys_of(scene.volumes[0], file))


def load_series_scene(
    files: tuple[Path, ...], named: Path, keys: Mapping[str, Any] | None = None
) -> Scene:
    """The grids in `files`, which the folder or pattern `named` names, one after the other.

    As `load_volume_scene`; at rest the scene shows the fullest of a few, and what is chosen is
    chosen for that one. Raises SceneError.
    """
    keys = keys or {}
    note_read(*files)  # those, too, that are read later
    scene, grid = _shown(_fullest(files, keys), keys)
    files, times, told = in_time(files)
    # Files that say when they are come from simulations, as those do that hold their times.
    usual = FPS if times or files[0].suffix.lower() in UPRIGHT_SUFFIXES else DEFAULT_FPS
    fps = keys.get("sequence_fps", usual)
    scene = replace(scene, name=series_name(named), warnings=(*scene.warnings, *told))
    beside = keys_of(scene.volumes[0], Path(scene.volumes[0].source))
    return with_times(scene, Series(files, str(named), fps), grid, keys, beside)


def _fullest(files: tuple[Path, ...], keys: Mapping[str, Any]) -> Path:
    """Of a few of the files, evenly through them, the one that holds most."""
    wanted = np.round(np.linspace(0, len(files) - 1, min(_LOOKED_AT, len(files)))).astype(int)
    held: dict[Path, float] = {}
    for file in (files[k] for k in wanted):
        grid = read_volume(file, keys.get("grid", DENSITY), keys.get("channels", DENSITY))
        size = np.prod(_sides_m(grid.bounds, grid.world_from_volume))
        held[file] = float(grid.density.mean(dtype=np.float64) * size)
    return max(held, key=lambda file: held[file])


def _shown(file: Path, keys: Mapping[str, Any]) -> tuple[Scene, VolumeGrid]:
    """One file's grid as a static scene, and that grid."""
    # A scene file's functions, which this module must not need to be loaded.
    from .toml_meshes import world_from_mesh
    from .upright import upright_from_grid

    name, channels = keys.get("grid", DENSITY), keys.get("channels", DENSITY)
    read = read_volume(file, name, channels)
    upright, said = upright_from_grid(keys, read, file, is_bare=True)
    matrix = world_from_mesh(keys, file.name) @ upright
    grid, emission, told = _with_emission(read, file, matrix, name)
    volume, chosen = grid_volume(grid, file, matrix, name)
    shown = replace(volume, emission=emission)
    scene = Scene(volumes=(shown,), name=file.stem, warnings=(*told, *chosen, *said))
    return scene, grid


def keys_of(volume: Volume, file: Path) -> dict[str, Any]:
    """The keys of a [[volume]] that name the grids beside the density of a bare grid's `volume`."""
    keys: dict[str, Any] = {}
    emission = volume.emission
    if emission is not None and emission.temperature is not None:
        keys["temperature_grid"] = "temperature"
        keys["temperature_scale"] = emission.temperature_scale
    elif emission is not None and emission.grid is not None:
        keys["emission_grid"] = next(n for n in grid_names(file) if n in FLAMES)
    if volume.albedo_grid is not None:
        keys["albedo_grid"] = colours_of(file)
    return keys


def grid_volume(
    grid: VolumeGrid, file: Path, world_from_file: F64 = IDENTITY, name: str = DENSITY
) -> tuple[Volume, tuple[str, ...]]:
    """A grid as a medium of what its units say, or else as smoke, and what was chosen for it.

    `world_from_file` (4, 4) moves it; `name` is what it is called. Coefficients are per metre of
    the world.
    """
    # Units settle the optics; where there are none smoke is assumed, and said.
    colours, said = _colours(grid, file, name)
    matrix = world_from_file @ grid.world_from_volume
    optics = grid.optics or _chosen_optics(grid, matrix)
    volume = Volume(
        sigma_t=(optics.sigma_t,) * 3,
        density=grid.density,
        bounds=grid.bounds,
        albedo=(optics.albedo,) * 3,
        g=(optics.g,) * 3,
        world_from_volume=matrix,
        source=str(file),
        albedo_grid=colours,
    )
    chosen = f"{file.name} {optics.text}"
    if grid.optics:
        chosen = f"{file.name}: {optics.text}: sigma_t = {optics.sigma_t:g} m^-1, "
        chosen += f"albedo = {optics.albedo:g}, g = {optics.g}"
    # The size of a box that was assumed is told as it was before.
    is_moved = not np.array_equal(world_from_file, IDENTITY)
    told = (f"{t}, before it is placed" if is_moved and NOWHERE in t else t for t in grid.warnings)
    return volume, (*told, *said, chosen)


def _chosen_optics(grid: VolumeGrid, world_from_volume: F64) -> Optics:
    """Whitish smoke as deep as smoke is, for a grid that says nothing about light."""
    sigma_t = fitting_sigma_t(grid.density, grid.bounds, world_from_volume)
    if sigma_t > MOST:
        raise SceneError(
            f"its densities are too small to be seen: {float(grid.density.max()):g} at most",
            remedy="Write them in another unit, or give the grid a larger scale.",
        )
    text = (
        f"says nothing about light: sigma_t = {sigma_t:g} m^-1 and albedo = {ALBEDO} "
        "were chosen; a scene file with [[volume]] sets them"
    )
    return Optics(sigma_t, ALBEDO, 0.0, text)


def _with_emission(
    grid: VolumeGrid, file: Path, world_from_file: F64, density: str
) -> tuple[VolumeGrid, Emission | None, tuple[str, ...]]:
    """The grid on a box that holds its fire, the fire if there is one, and what was chosen for it.

    `density` is the grid's name, which is no fire then. The brightest path is as bright as FLAME;
    temperatures in units of their own end at HOTTEST_K.
    """
    # Where the units say that it is a cloud, temperatures are those of its air.
    name = None if grid.optics else next((n for n in grid_names(file) if n in FLAMES), None)
    if name is None or name == density:
        return grid, None, ()
    values = read_values(file, name, grid.time)
    return fire(told_beside(grid, values.warnings), values, name, file.name, world_from_file)


def fire(
    grid: VolumeGrid, values: GridValues, name: str, label: str, world_from_file: F64 = IDENTITY
) -> tuple[VolumeGrid, Emission | None, tuple[str, ...]]:
    """The grid on a box that holds the flames or temperatures `values`, and what they emit.

    `name` is what they are called, "temperature" or another; `label` stands in what is told.
    """
    grown, found_values = on_one_grid(grid, values)
    if found_values.ndim != 3 or not float(found_values.max()) > 0.0:
        when = "" if grid.time is None else " at the time that is shown"
        return grid, None, (f"{label}: its grid '{name}' is no fire that is seen{when}",)
    # Temperatures in kelvin are taken as they are, others end at HOTTEST_K.
    scale = 1.0
    # Each kind of grid: kelvin, or flames of a colour in proportion to the values.
    if name == "temperature":
        hottest = float(found_values.max())
        scale = 1.0 if _COOLEST_K < hottest <= 1e4 else HOTTEST_K / hottest
        found = Emission(temperature=found_values, temperature_scale=scale)
    else:
        found = Emission(ORANGE, np.maximum(found_values, 0.0))
    assert found.values is not None
    longest_m = float(_sides_m(grown.bounds, world_from_file @ grown.world_from_volume).max())
    # So bright that a tenth of the box's longest side, at its peak, sends FLAME.
    strength = FLAME / max(found.peak * max(found.radiance) * 0.1 * longest_m, 1e-30)
    r, g, b = (float(f"{c * strength:.3g}") for c in found.radiance)
    keys = f'{"temperature" if name == "temperature" else "emission"}_grid = "{name}"'
    keys += f" with temperature_scale = {scale:g}" if scale != 1.0 else ""
    text = f"{label} has flames: {keys}, emission = {max(r, g, b):g} were chosen"
    return grown, replace(found, radiance=(r, g, b)), (text,)


def _colours(grid: VolumeGrid, file: Path, density: str) -> tuple[F32 | None, tuple[str, ...]]:
    """The file's colours, which ALBEDO is multiplied with, and what was chosen for them."""
    name = colours_of(file)
    if name is None or name == density:
        return None, ()
    # Colours are read on the density's own voxels.
    _, values = on_one_grid(grid, read_values(file, name, grid.time), grows=False)
    if values.ndim == 4 and values.shape[3] != 3:
        return None, (f"{file.name}: its grid '{name}' is no colour, and left out",)
    clipped = np.clip(values, 0.0, 1.0)
    text = f'{file.name} has colours: albedo_grid = "{name}", albedo = {ALBEDO} were chosen'
    if not np.array_equal(clipped, values):
        text += "; values outside of 0 to 1 were cut off"
    return clipped, (text,)


def _sides_m(bounds: Bounds, world_from_volume: F64) -> F64:
    """Lengths (3,) of a placed box's sides x, y, z, metres."""
    stretched = np.linalg.norm(world_from_volume[:3, :3], axis=0)
    return np.asarray(np.subtract(bounds[1], bounds[0]) * stretched)


def fitting_sigma_t(density: F32, bounds: Bounds, world_from_volume: F64 = IDENTITY) -> float:
    """sigma_t, m^-1 at density 1, that makes the denser parts DEPTH deep; two digits."""
    # The mean density along each axis times the box's side: optical depth over sigma_t.
    size = _sides_m(bounds, world_from_volume)[::-1]  # z, y, x
    depths = [
        float(np.percentile(density.mean(axis=axis, dtype=np.float64), 95)) * size[axis]
        for axis in range(3)
    ]
    deepest = max(depths)
    return float(f"{DEPTH / deepest:.2g}") if deepest > 0.0 else 1.0
