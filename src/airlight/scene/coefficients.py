"""Coefficients of a volume that differ from voxel to voxel, and the media that they add up to.

Extinction, scattering and absorption of overlapping media add up. So a volume whose coefficients
vary in colour is a sum of parts, each of which is one density grid times constant coefficients, as
all other volumes are: nothing else has to know of it. Sums stay sums where grids are filtered or
averaged into cells, so that every level keeps the optical depth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import SceneError
from ..maths.colour import in_rgb
from ..maths.mixtures import mixed
from ..maths.transforms import triple
from . import checks
from .checks import F32, F64, Rgb
from .emission import Emission
from .medium import mean_cosine

if TYPE_CHECKING:
    from .scene import Scene
    from .volume import Volume

_ALIKE = 1e-3
"""Of channels: those that differ by less have one density."""
_STEP = 0.5
"""Mean cosines of two phase functions whose mixture stands for one between them."""


def coefficient_grid(
    values: Any, name: str, shape: tuple[int, ...], *, low: float, high: float
) -> F32:
    """A grid (z, y, x) or (z, y, x, 3) as (z, y, x, 3), each value in low..high.

    Raises SceneError, where its voxels are not those of the density, `shape`.
    """
    # One channel stands for three of the same.
    grid = checks.grid(values, name, signed=True)
    if grid.shape[:3] != shape:
        have, want = (" x ".join(map(str, s[::-1])) for s in (grid.shape[:3], shape))
        raise SceneError(f"{name} has {have} voxels, the volume's density has {want}")
    least, most = float(grid.min()), float(grid.max())
    if least < low or most > high:
        off = least if least < low else most
        raise SceneError(f"{name} must lie in [{low:g}, {high:g}], it has {off:g}")
    return in_rgb(grid)


def density_and_tint(sigma: F32) -> tuple[F32, F32 | None]:
    """(z, y, x) and (z, y, x, 3) in 0..1 whose product is `sigma`; no tint where it is grey."""
    if sigma.ndim == 3 or float(np.ptp(sigma, axis=-1).max(initial=0.0)) == 0.0:
        return np.ascontiguousarray(sigma if sigma.ndim == 3 else sigma[..., 0]), None
    density = sigma.max(axis=-1)
    tint = np.divide(sigma, density[..., None], where=density[..., None] > 0.0, out=None)
    tint[density <= 0.0] = 1.0
    return density, tint


def scale_density_tint(sigma: F32) -> tuple[Rgb, F32, F32 | None]:
    """Colour, density and tint whose product is `sigma` (z, y, x, 3).

    There is no tint where its channels are one density's, to a thousandth of the largest.
    """
    # Per channel the largest value is the colour; the channels' shapes remain.
    top = sigma.reshape(-1, 3).max(axis=0)
    shares = sigma / np.maximum(top, 1e-30)
    # A channel of nothing takes the shape of the others, so that it needs no tint.
    shares[..., top <= 0.0] = shares.max(axis=-1, keepdims=True)
    if float(np.ptp(shares, axis=-1).max()) <= _ALIKE:
        return triple(top), np.ascontiguousarray(shares[..., int(np.argmax(top))]), None
    return triple(top), *density_and_tint(shares)


def as_grids(given: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of a Volume from coefficients by name, each a number, a colour or a grid.

    `given`: sigma_s and sigma_a, or sigma_t and albedo, m^-1, and g. Raises SceneError.
    """
    # One pair of coefficients or the other.
    names = [name for name, value in given.items() if value is not None]
    pairs = (("sigma_t", "albedo"), ("sigma_s", "sigma_a"))
    has_t, has_s = (any(name in names for name in pair) for pair in pairs)
    if has_t == has_s:
        raise SceneError("a volume has either sigma_s and sigma_a, or sigma_t and albedo")
    # All coefficients on the grid's voxels, in three colours.
    grids = [name for name in names if checks.dimensions(given[name]) >= 3]
    if not grids:
        raise SceneError("no coefficient is a grid", remedy="Use shape = 'box', or a density.")
    shape = np.shape(given[grids[0]])[:3]
    full = {name: _filled(given[name], name, shape) for name in names}
    # The mean cosine stays a number where it is one, so that it needs no mixture.
    g = {"g_grid": full["g"]} if checks.dimensions(given["g"]) >= 3 else {"g": given["g"]}
    # sigma_t = density times tint; albedo = sigma_s / sigma_t, where anything is.
    if has_t:
        density, tint = density_and_tint(full["sigma_t"])
        own = given["albedo"] if given["albedo"] is not None else 1.0
        is_grid = checks.dimensions(own) >= 3
        albedo = (
            {"albedo_grid": full["albedo"]} if is_grid else {"albedo": checks.rgb(own, "albedo")}
        )
    else:
        # What is not given is zero; without any extinction there is no albedo either.
        nothing = np.zeros((*shape, 3), np.float32)
        sigma_s = full.get("sigma_s", nothing)
        sigma_t = sigma_s + full.get("sigma_a", nothing)
        density, tint = density_and_tint(sigma_t)
        ratio = np.divide(sigma_s, sigma_t, where=sigma_t > 0.0, out=np.zeros_like(sigma_t))
        albedo = {"albedo_grid": ratio}
    return {"sigma_t": (1.0, 1.0, 1.0), "density": density, "tint": tint, **albedo, **g}


def _filled(value: Any, name: str, shape: tuple[int, ...]) -> F32:
    """A coefficient in every voxel, (z, y, x, 3)."""
    if checks.dimensions(value) >= 3:
        low, high = (-0.9999, 0.9999) if name == "g" else (0.0, checks.MOST)
        return coefficient_grid(value, name, shape, low=low, high=high)
    rgb = mean_cosine(value) if name == "g" else checks.rgb(value, name)
    return np.ascontiguousarray(np.broadcast_to(np.array(rgb, np.float32), (*shape, 3)))


def sigma_t_of(volume: Volume) -> F32:
    """Extinction (z, y, x, 3), m^-1, of a volume with a grid."""
    assert volume.density is not None
    sigma_t = volume.density[..., None] * np.array(volume.sigma_t, np.float32)
    return sigma_t if volume.tint is None else np.asarray(sigma_t * volume.tint)


def albedo_of(volume: Volume) -> F32:
    """Albedo (3,) or (z, y, x, 3)."""
    albedo = np.array(volume.albedo, np.float32)
    return albedo if volume.albedo_grid is None else np.asarray(albedo * volume.albedo_grid)


def shares_by_g(volume: Volume, sigma_t: F32) -> list[tuple[Rgb, F32 | float]]:
    """Phase functions of constant g, with the share of every voxel (z, y, x, 3) that has each.

    A voxel's phase function is the mixture of two of them whose mean cosine is its own. `sigma_t`:
    where there is anything.
    """
    grid = volume.g_grid
    if grid is None:
        return [(volume.g, 1.0)]
    # Only what is there counts for how far apart mean cosines lie.
    is_some = sigma_t > 0.0
    low = [_extreme(grid[..., c][is_some[..., c]], min) for c in range(3)]
    high = [_extreme(grid[..., c][is_some[..., c]], max) for c in range(3)]
    span = np.subtract(high, low)
    # As many phase functions as keep neighbours within _STEP; one where all are alike.
    pieces = max(1, int(np.ceil(float(span.max()) / _STEP - 1e-6))) if span.max() > 1e-6 else 0
    if pieces == 0:
        return [(triple(low), 1.0)]
    # Where a voxel's g is between the first and the last, in steps: hats that add up to 1.
    at = (grid - np.array(low, np.float32)) / np.maximum(span / pieces, 1e-9).astype(np.float32)
    parts: list[tuple[Rgb, F32 | float]] = []
    for k in range(pieces + 1):
        hat = np.clip(1.0 - np.abs(np.clip(at, 0.0, pieces) - k), 0.0, 1.0).astype(np.float32)
        parts.append((triple(np.array(low) + span * k / pieces), hat))
    return parts


def parts_of(volume: Volume) -> tuple[Volume, ...]:
    """Volumes of constant coefficients that add up to one; itself where its own are constant.

    Parts with one and the same g have one and the same `part_of`. What the volume emits, its first
    part does.
    """
    if not volume.has_coefficient_grids or volume.density is None:
        return (volume,)
    # Media with constant coefficients add up: sigma_s and sigma_a of the parts sum to the
    # volume's.
    shape, own = volume.density.shape, sigma_t_of(volume)
    sigma_s = np.asarray(own * albedo_of(volume))
    absorbing = np.maximum(own - sigma_s, 0.0)
    plain = replace(volume, tint=None, albedo_grid=None, g_grid=None, emission=None)
    made: list[Volume] = []
    # For each g, as few materials as the voxels are mixtures of.
    for g, of_g in shares_by_g(volume, own):
        rows = np.concatenate([sigma_s * of_g, absorbing * of_g], axis=-1).reshape(-1, 6)
        group = object()
        shares, materials = mixed(rows)
        for share, material in zip(shares.T, materials, strict=True):
            # A density of at most 1; the coefficients take up the rest.
            peak = float(share.max())
            s, a = material[:3] * peak, material[3:] * peak
            t = s + a
            made.append(
                replace(
                    plain,
                    sigma_t=triple(t),
                    density=np.ascontiguousarray((share / peak).reshape(shape)),
                    albedo=triple(np.minimum(s / np.maximum(t, 1e-30), 1.0)),
                    g=g,
                    part_of=group,
                )
            )
    if not made:
        made.append(replace(plain, part_of=object()))
    # Emission is the volume's once.
    if volume.emission is not None:
        made[0] = replace(made[0], emission=_by_voxel(volume.emission, volume.density))
    # Read-only arrays stay the same object in later values, which caches go by.
    for part in made:
        assert part.density is not None
        part.density.flags.writeable = False
    return tuple(made)


def in_parts(scene: Scene) -> Scene:
    """The scene with every volume in its parts; the very same where no volume has any."""
    if not any(volume.has_coefficient_grids for volume in scene.volumes):
        return scene
    return replace(scene, volumes=tuple(p for v in scene.volumes for p in v.parts))


ALIKE = 0.1
"""Of `traits`: volumes in which none differs by more are of one kind."""


def traits(volume: Volume) -> F64:
    """Ratios of extinctions, albedo and g (9,): what tells kinds of media apart."""
    sigma_t = np.asarray(volume.sigma_t)
    tint = sigma_t / max(float(sigma_t.max()), 1e-30)
    return np.concatenate([tint, volume.albedo, volume.g])


def parts_alike(one: Volume, other: Volume) -> bool:
    """Whether two volumes have as many parts, which are of the same kinds, one by one."""
    if not (one.has_coefficient_grids or other.has_coefficient_grids):
        return True
    if len(one.parts) != len(other.parts):
        return False
    pairs = zip(one.parts, other.parts, strict=True)
    return all(float(np.abs(traits(a) - traits(b)).max()) <= ALIKE for a, b in pairs)


def grouped(volumes: Sequence[Volume]) -> list[tuple[Volume, ...]]:
    """Volumes with those that are parts of the same one, and have the same g, together."""
    groups: list[list[Volume]] = []
    # Parts of one volume follow each other, as `in_parts` puts them.
    for volume in volumes:
        if groups and volume.part_of is not None and volume.part_of is groups[-1][0].part_of:
            groups[-1].append(volume)
        else:
            groups.append([volume])
    return [tuple(group) for group in groups]


def _by_voxel(emission: Emission, density: F32) -> Emission:
    """The same whatever the density is of what it belongs to."""
    return emission if emission.size is not None else replace(emission, grid=density)


def _extreme(values: F32, of: Any) -> float:
    return float(of(values.min(), values.max())) if values.size else 0.0
