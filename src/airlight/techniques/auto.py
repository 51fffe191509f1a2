"""The technique `auto`: the recipe whose solvers suit a scene.

surfaces  without media `lpv`; with media `lpv-scatter`, whose lattice holds reflected and scattered
          light
volumes   `pop`: a solver for the light of each volume, marched as a source. Light that surfaces
          reflect into a volume comes from the lattice, which the volume attenuates and adds to
          (`volumes`). Up to sixteen that are alike share a grid there. Volumes are part of the
          lattice's medium instead where there are more, or more than four in fog or of unlike
          colours or phase functions (or eight parts of volumes of many colours), or where a box or
          ball keeps much of a local light from the room: single scattering is exact there. (A thick
          ball in the Cornell box: the relative L2 error of its light is .21, with pop .33. For
          density grids pop is the better one, .27 against .55.) In fog, whose lattice holds light
          in air anyhow, they are part of it where its cells resolve them and no local light is
          near: fog and volumes exchange all their light then, and a frame takes .6 of the time.
          (Smoke around a point light has .74 of its multiple scattering there, .95 with pop.)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..lighting.lattice_box import lattice_axes, lattice_box
from ..maths.transforms import F64
from ..pop.settings import MOST_ALONE
from ..scene.coefficients import grouped
from ..scene.lights import DirectionalLight
from ..scene.scene import Scene
from ..scene.volume import Volume

_MOST_PARTS = 8  # of volumes on grids of their own: every path of the ordinates stores each
_MOST_MERGED = 16  # volumes on one grid, beyond which it costs more than the lattice
_ALIKE = 0.1  # of albedo and g, and of the ratios of extinctions
_CELLS = 30  # along the longest side of surfaces and media
_ACROSS = 2.0  # cells, to be safe: puffs of .7 and 1.4 in open air have .95 to .99 of their light
_DEEPEST = 10.0  # reduced optical depth of a cell: 20 is still right, 40 has 1.17 of the light
# Of the room's cross section, from which on a volume's shade on surfaces counts.
_SHADED_SHARE = 0.05


def recipe_for(scene: Scene) -> str:
    """The name of the recipe that `auto` takes for a scene."""
    # Light propagation volumes without media; else one lattice for all, or grids of volumes.
    if scene.medium is None and not scene.volumes:
        return "lpv"
    if not scene.volumes or _are_many(scene) or _shades_a_room(scene):
        return "lpv-scatter"
    if scene.medium is None:
        return "lpv with pop"
    return "lpv-scatter" if _are_resolved(scene) else "lpv-scatter with pop"


def _are_resolved(scene: Scene) -> bool:
    """Whether cells of the lattice, as it is by default, say enough of each volume."""
    # Along the walls, and volumes along their own boxes: however the scene is turned.
    low, high = lattice_box(scene, (), in_medium=True, axes=lattice_axes(scene))
    cell = float((high - low).max()) / _CELLS
    return all(
        _is_resolved(volume, cell) and not _has_local_light(scene, volume, cell)
        for volume in scene.volumes
    )


def _is_resolved(volume: Volume, cell: float) -> bool:
    """Whether cells of so many metres are small beside a volume, and not too dense for one."""
    # What scatters forwards fills a cell less, by similarity theory.
    kept = (1.0 - w * g for w, g in zip(volume.albedo, volume.g, strict=True))
    densest = 1.0 if volume.density is None else float(volume.density.max(initial=0.0))
    depth = max(t * k for t, k in zip(volume.sigma_t, kept, strict=True)) * densest * cell
    low, high = np.array(volume.bounds)
    return depth <= _DEEPEST and float(((high - low) * _scale(volume)).min()) >= _ACROSS * cell


def _scale(volume: Volume) -> F64:
    """Metres of the world per metre along each axis of a volume's own box, (3,)."""
    return np.asarray(np.linalg.norm(volume.world_from_volume[:3, :3], axis=0))


def _has_local_light(scene: Scene, volume: Volume, cell: float) -> bool:
    """Whether what falls off faster than cells resolve is scattered in it: its own light, too."""
    if volume.emission is not None:
        return True
    local = [x.position for x in scene.lights if not isinstance(x, DirectionalLight)]
    places = [np.reshape(local, (-1, 3)), *(group.positions for group in scene.light_groups)]
    # Within two cells of its box, along that.
    inverse = np.linalg.inv(volume.world_from_volume)
    own = np.concatenate(places) @ inverse[:3, :3].T + inverse[:3, 3]
    low, high = np.array(volume.bounds)
    margin = _ACROSS * cell / _scale(volume)
    return bool(((own > low - margin) & (own < high + margin)).all(axis=1).any())


def _are_many(scene: Scene) -> bool:
    """Whether volumes, or the parts of which those of many colours are sums, are too many."""
    count = len(grouped(scene.volumes))
    # Each on a grid of its own: every path stores a depth for each of their parts.
    if count <= MOST_ALONE:
        return len(scene.volumes) > _MOST_PARTS
    # On a shared grid: few enough, alike, and not in fog.
    return scene.medium is not None or count > _MOST_MERGED or not _are_alike(scene.volumes)


def _are_alike(volumes: Sequence[Volume]) -> bool:
    """Whether means of their coefficients say enough of each, where they share a grid."""
    # Colours as ratios of extinctions: how dense a volume is does not matter.
    sigma_t = np.array([volume.sigma_t for volume in volumes])
    tint = sigma_t / np.maximum(sigma_t.max(axis=1, keepdims=True), 1e-30)
    kinds = np.hstack([tint, [(*volume.albedo, *volume.g) for volume in volumes]])
    return bool(np.ptp(kinds, axis=0).max() <= _ALIKE)


def _shades_a_room(scene: Scene) -> bool:
    """Whether a volume keeps more than a few percent of the local lights' light from surfaces.

    Density grids do not count where the lattice is `lpv`'s, which attenuates its lights by them.
    """
    if all(isinstance(light, DirectionalLight) for light in scene.lights) or not scene.meshes:
        return False
    # What one of them blocks, beside the section of the room: along the walls, as for cells.
    low, high = lattice_box(scene, (), axes=lattice_axes(scene))
    room = _section(high - low)
    shapes = [v for v in scene.volumes if scene.medium is not None or v.density is None]
    return any(_shading(volume) > _SHADED_SHARE * room for volume in shapes)


def _shading(volume: Volume) -> float:
    """Roughly what a volume blocks, m^2: its mean cross section times 1 - transmittance."""
    low, high = np.array(volume.bounds)
    size = (high - low) * _scale(volume)
    # About the optical depth through its middle.
    density = 1.0 if volume.density is None else float(volume.density.mean())
    depth = max(volume.sigma_t) * density * float(np.cbrt(np.prod(size)))
    return _section(size) * -float(np.expm1(-depth))


def _section(size: F64) -> float:
    """The mean area of a box's sides, m^2, from its size, m."""
    x, y, z = size
    return float(x * y + y * z + z * x) / 3.0
