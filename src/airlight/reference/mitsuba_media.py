"""Media and density volumes as Mitsuba media behind invisible (`null`) boundaries.

Mitsuba knows one medium per point. A volume inside the scene's medium therefore carries the sum
of both: sigma_t = medium + volume, exactly; the albedo and the mix of their phase functions are
ratios, exact where the two are alike or the volume is of constant density, else interpolated
between voxels.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

import numpy as np

from ..maths.transforms import triple
from ..maths.voxels import ratio
from ..scene.checks import F32, F64
from ..scene.coefficients import albedo_of, shares_by_g, sigma_t_of
from ..scene.medium import Medium, medium_box
from ..scene.scene import Scene
from ..scene.volume import Volume
from .mitsuba_boundary import (
    EDGE_MARGIN,
    boundary,
    ellipsoid,
    holds,
    is_inside,
    refuse_crossings,
    world_from_cube,
    world_from_volume_cube,
)
from .mitsuba_files import FileStore, write_vol
from .mitsuba_xml import (
    add_matrix,
    add_number,
    add_rgb,
    add_text,
    add_truth,
    plugin,
)

AIR = "air"


@dataclass
class Media:
    """What a scene's media are written as. `camera_id`: the medium around the camera, or ""."""

    mediums: list[Element] = field(default_factory=list)
    boundaries: list[Element] = field(default_factory=list)
    camera_id: str = ""
    is_colored: bool = False  # extinction differs between channels


def has_media(scene: Scene) -> bool:
    """Whether light can be scattered or absorbed between surfaces."""
    air = () if scene.medium is None else (scene.medium,)
    return any(max(medium.sigma_t) > 0.0 for medium in (*air, *scene.volumes))


def scene_media(scene: Scene, files: FileStore, notes: list[str]) -> Media:
    """All media of the scene. Raises ReferenceFailure where two of them cross."""
    # Media without extinction scatter nothing, and would only cost boundaries.
    media = Media()
    volumes = [volume for volume in scene.volumes if max(volume.sigma_t) > 0.0]
    air = scene.medium if scene.medium and max(scene.medium.sigma_t) > 0.0 else None
    medium_extent = medium_bounds(scene) if air else None
    refuse_crossings(volumes, medium_extent)
    eye = np.array(scene.camera.position)
    # A camera inside a medium must be told so: no boundary lies before it.
    if air and medium_extent is not None:
        media.mediums.append(_homogeneous(AIR, _coefficients(air)))
        media.boundaries.append(boundary(world_from_cube(*medium_extent), AIR, ""))
        media.is_colored = np.ptp(air.sigma_t) > 0.0
        if np.all(eye > medium_extent[0]) and np.all(eye < medium_extent[1]):
            media.camera_id = AIR

    # Volumes lie in the medium or apart from it: an overlap of any other kind was refused.
    for index, volume in enumerate(volumes):
        name = f"volume_{index}"
        inside_medium = medium_extent is not None and is_inside(volume, medium_extent)
        _add_volume(media, volume, name, air if inside_medium else None, files, notes)
        if holds(volume, eye):
            media.camera_id = name
    return media


def medium_bounds(scene: Scene) -> tuple[F64, F64]:
    """The box of the scene's homogeneous medium, metres, a hair larger than said."""
    # Said bounds grow a hair, lest the box's faces lie in those of surfaces.
    assert scene.medium is not None
    if scene.medium.bounds is not None:
        low, high = (np.array(corner) for corner in scene.medium.bounds)
        grow = EDGE_MARGIN * float(np.linalg.norm(high - low))
        return low - grow, high + grow
    return medium_box(scene.medium, *scene.bounds, scene.camera.position)


@dataclass(frozen=True)
class _Coefficients:
    sigma_t: F64  # (3,) m^-1
    albedo: F64  # (3,)
    g: float


def _coefficients(of: Medium | Volume) -> _Coefficients:
    return _Coefficients(np.array(of.sigma_t), np.array(of.albedo), float(np.mean(of.g)))


def _add_volume(
    media: Media,
    volume: Volume,
    name: str,
    air: Medium | None,
    files: FileStore,
    notes: list[str],
) -> None:
    if volume.detail > 0.0:
        notes.append(f"volume {volume.source or name}: its procedural detail is left out")
    # One medium holds at each point, so a volume in the air has the air's coefficients added.
    own = _coefficients(volume)
    around = _coefficients(air) if air else None
    if volume.density is None:
        medium = _constant_volume(name, own, around, notes)
    else:
        medium = _grid_volume(name, volume, own, around, files, notes)
    media.mediums.append(medium)
    exterior = AIR if air else ""
    # Drawn in a little, because its walls may lie on those of meshes or of other media.
    inset = world_from_volume_cube(volume, 1.0 - 2.0 * EDGE_MARGIN)
    if volume.shape == "sphere":
        media.boundaries.append(ellipsoid(inset, name, exterior, files, notes))
    else:
        media.boundaries.append(boundary(inset, name, exterior))
    # Colour decides on the integrator: one that samples distances for all channels at once pays
    # off.
    is_tinted = volume.tint is not None or bool(np.ptp(own.sigma_t) > 0.0)
    media.is_colored = media.is_colored or is_tinted


def _constant_volume(
    name: str, own: _Coefficients, around: _Coefficients | None, notes: list[str]
) -> Element:
    if around is None:
        return _homogeneous(name, own)
    # Two media in one place: extinctions add up, the albedo is weighted by them, phase functions by
    # scattering.
    sigma_t = own.sigma_t + around.sigma_t
    own_s, around_s = own.sigma_t * own.albedo, around.sigma_t * around.albedo
    albedo = (own_s + around_s) / np.maximum(sigma_t, 1e-30)
    weight = float(np.mean(own_s / np.maximum(own_s + around_s, 1e-30)))
    medium = _homogeneous(name, _Coefficients(sigma_t, albedo, own.g), with_phase=False)

    # Where the two phase functions differ, a blend by what each scatters.
    if own.g == around.g:
        medium.append(_phase(own.g))
    else:
        medium.append(blend := plugin("phase", "blendphase"))
        add_number(blend, "weight", weight)
        blend.extend([_phase(around.g, "phase_0"), _phase(own.g, "phase_1")])
        if np.ptp(own_s / np.maximum(own_s + around_s, 1e-30)) > 1e-6:
            notes.append(f"{name}: its phase function's share is the mean of the channels")
    return medium


def _grid_volume(
    name: str,
    volume: Volume,
    own: _Coefficients,
    around: _Coefficients | None,
    files: FileStore,
    notes: list[str],
) -> Element:
    """A heterogeneous medium. Grids are written at absolute scale, m^-1."""
    # Extinctions add up where a medium lies around the volume.
    own_t = sigma_t_of(volume)
    medium = plugin("medium", "heterogeneous", id=name)
    sigma_t = own_t if around is None else own_t + around.sigma_t.astype(np.float32)
    _add_grid(medium, "sigma_t", sigma_t, volume, files)
    add_truth(medium, "has_spectral_extinction", bool(np.ptp(sigma_t, axis=-1).max() > 0.0))
    own_s = np.asarray(own_t * albedo_of(volume))
    around_s = np.zeros(3, np.float32)
    if around is not None:
        around_s = (around.sigma_t * around.albedo).astype(np.float32)
    # The albedo, and the phase functions that scattering is mixed of.
    is_one_albedo = around is None or np.array_equal(own.albedo, around.albedo)
    if volume.albedo_grid is None and is_one_albedo:
        add_rgb(medium, "albedo", triple(own.albedo))
    else:
        albedo = ratio(own_s + around_s, sigma_t).astype(np.float32)
        _add_grid(medium, "albedo", albedo, volume, files)
        if around is not None:
            notes.append(f"{name} in air of another albedo: its albedo is interpolated by voxel")
    # Each phase function's share of what scatters, voxel by voxel.
    parts: list[tuple[float, F32]] = [
        (float(np.mean(g)), np.asarray(own_s * part, np.float32))
        for g, part in shares_by_g(volume, own_t)
    ]
    if around is not None and {g for g, _ in parts} != {around.g}:
        parts.insert(0, (around.g, np.broadcast_to(around_s, own_s.shape)))
        notes.append(f"{name} in air of another g: their phase functions are mixed by voxel")
    medium.append(_mixed_phase(parts, volume, files))
    return medium


def _mixed_phase(
    parts: list[tuple[float, F32]], volume: Volume, files: FileStore, name: str = ""
) -> Element:
    """Phase functions of mean cosines, by the scattering that has each, of which files hold shares.

    Mitsuba mixes two at a time: the last with the mixture of those before it.
    """
    # Each blend holds the share of its last part; the others blend among themselves.
    *before, (g, last) = parts
    if not before:
        return _phase(g, name)
    blend = plugin("phase", "blendphase", name)
    whole = sum((s for _, s in before), start=last)
    weight = ratio(last, whole).mean(axis=-1).astype(np.float32)
    _add_grid(blend, "weight", weight, volume, files)
    blend.extend([_mixed_phase(before, volume, files, "phase_0"), _phase(g, "phase_1")])
    return blend


def _add_grid(parent: Element, name: str, values: F32, volume: Volume, files: FileStore) -> None:
    """A grid over the volume's placed bounds; one channel where all are equal."""
    # One channel where colours are equal: a file of a third of the size.
    if values.ndim == 4 and np.ptp(values, axis=-1).max() == 0.0:
        values = values[..., 0]
    key = ("grid", files.identity(values))
    filename = files.once(key, name, "vol", lambda path: write_vol(path, values, volume.bounds))
    node = plugin("volume", "gridvolume", name)
    add_text(node, "filename", filename)
    add_matrix(node, "to_world", world_from_volume_cube(volume, 1.0) @ _CUBE_FROM_UNIT)
    parent.append(node)


# Mitsuba's grid fills [0, 1]^3, its cube [-1, 1]^3.
_CUBE_FROM_UNIT = np.array([[2.0, 0, 0, -1], [0, 2, 0, -1], [0, 0, 2, -1], [0, 0, 0, 1]])


def _homogeneous(name: str, values: _Coefficients, *, with_phase: bool = True) -> Element:
    # Coefficients relative to the largest: Mitsuba scales them by one number.
    medium = plugin("medium", "homogeneous", id=name)
    top = float(values.sigma_t.max())
    add_rgb(medium, "sigma_t", triple(values.sigma_t / top))
    add_number(medium, "scale", top)
    add_rgb(medium, "albedo", triple(values.albedo))
    add_truth(medium, "has_spectral_extinction", bool(np.ptp(values.sigma_t) > 0.0))
    if with_phase:
        medium.append(_phase(values.g))
    return medium


def _phase(g: float, name: str = "") -> Element:
    if g == 0.0:
        return plugin("phase", "isotropic", name)
    node = plugin("phase", "hg", name)
    add_number(node, "g", g)
    return node
