"""Beside discrete ordinates with harmonics, and Monte Carlo (Elek2014 Fig. 11)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..maths.delta_beam import MediumGrid
from ..maths.medium import ray_box_interval
from ..maths.voxels import box_averaged, trilinear
from ..scene.camera import view_directions
from ..scene.checks import F32, F64
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_scenes import drawn, errors, off, plume, scattered_errors, traced

POP: Mapping[str, Mapping[str, Any]] = {
    "POP, 64 ordinates of 20^3": {},
    "POP, 125 ordinates of 32^3": {"ordinates": 125, "grid": 32},
    "POP split, 64 of 20^3": {"scheme": "split"},
}
BANDS = (5, 10)
SHDOM_CELLS = (14, 28, 14)  # about 20^3 of the plume
_STEPS = 96


def draw(request: Request) -> Drawn:
    """The plume of Fig. 11: ours, the baseline with its prefilter and without, and the truth."""
    # Ours by numbers of ordinates and cells, and by the other scheme.
    scene = plume()
    truth = traced(request, scene)
    images: dict[str, Image] = {}
    for index, (name, settings) in enumerate(POP.items()):
        if request.quick and index:
            continue
        request.report(name, index / len(POP))
        images[name] = drawn(request, scene, settings)

    # What lies behind the smoke is ours for the baseline, too.
    first = next(iter(images.values()))
    shown = {name: image.radiance for name, image in images.items()}
    behind = first.radiance - first.layers["scattered"]
    for bands in BANDS[: 1 if request.quick else 2]:
        for prefilter in (True, False):
            name = f"SHDOM, {bands} bands, {'smoothed' if prefilter else 'as it rings'}"
            request.report(name, 0.8)
            light = by_shdom(scene, request.size, bands, prefilter=prefilter)
            shown[name] = (behind + light).astype(np.float32)

    # Errors of whole images, and of the scattered light alone.
    through = first.layers["transmittance"]
    numbers = {
        name: {
            "whole": errors(p, truth),
            "scattered": scattered_errors(p - behind, behind, through, truth),
        }
        for name, p in shown.items()
    }

    # Ours and the truth in one row, the baseline in another.
    stops = exposure_of(scene, first.radiance)
    captions = {k: f"{k}{off(numbers[k])}" for k in shown}
    ours = [(captions[k], v) for k, v in shown.items() if k in images]
    if truth is not None:
        ours.append(("Monte Carlo", truth.radiance))
    theirs = [(captions[k], v) for k, v in shown.items() if k not in images]
    rows = [("", exposed(ours, stops)), ("", exposed(theirs, stops))]
    return Drawn(sheet(request, "A plume beside SHDOM and Monte Carlo", rows), numbers)


def medium_of(scene: Scene, count: tuple[int, int, int]) -> MediumGrid:
    """The first volume (not turned) on `count` = (x, y, z) cells, its corner at 0."""
    volume = scene.volumes[0]
    assert volume.density is not None

    # Twice as fine for rays as for the solver.
    low, high = np.asarray(volume.bounds)
    x, y, z = count
    fine = box_averaged(volume.density, (2 * x, 2 * y, 2 * z))
    coarse = fine.reshape(z, 2, y, 2, x, 2).mean(axis=(1, 3, 5))
    optics = (np.array(v) for v in (volume.sigma_t, volume.albedo, volume.g))
    return MediumGrid(high - low, coarse, fine, *optics)


def by_shdom(scene: Scene, size: tuple[int, int], bands: int, *, prefilter: bool) -> F32:
    """Light that the plume scatters to the camera, W m^-2 sr^-1."""
    from ..reference.shdom import environment_series, solve

    assert scene.environment is not None
    assert scene.environment.map is not None

    # The medium on the baseline's cells, under the map's series.
    medium = medium_of(scene, SHDOM_CELLS)
    sky = scene.environment.map.astype(np.float64)
    done = solve(medium, environment_series(sky, bands, prefilter=prefilter), bands)

    # Its light towards the eye, marched as ours is.
    eye = np.array(scene.camera.position) - np.asarray(scene.volumes[0].bounds)[0]
    away = eye - medium.centres
    towards = away / np.linalg.norm(away, axis=-1, keepdims=True)
    return marched(scene, medium, done.emission(towards), size)


def marched(scene: Scene, medium: MediumGrid, emission: F64, size: tuple[int, int]) -> F32:
    """In-scattered radiance per unit sigma_s (z, y, x, 3), marched front to back on the host."""
    # Rays in the box's own coordinates, from where they enter it.
    volume = scene.volumes[0]
    camera, (width, height) = scene.camera, size
    direction = view_directions(camera, width, height, width / height).reshape(height, width, 3)
    low = np.asarray(volume.bounds)[0]
    start = np.broadcast_to(np.array(camera.position) - low, direction.shape)
    t0, t1 = ray_box_interval(start, direction, np.zeros(3), medium.extent)
    t0 = np.maximum(t0, 0.0)
    dt = np.maximum(t1 - t0, 0.0) / _STEPS
    assert volume.density is not None
    voxels = np.array(volume.density.shape[::-1]) / medium.extent

    # Front to back: each step's share of the source, behind what lies before it.
    total, passed = np.zeros(direction.shape), np.ones(direction.shape)
    for k in range(_STEPS):
        p = start + (t0 + (k + 0.5) * dt)[..., None] * direction
        rho = trilinear(volume.density.astype(np.float64), p * voxels)
        through = np.exp(-rho[..., None] * medium.sigma_t * dt[..., None])
        at = p / medium.cell
        light = np.stack([trilinear(emission[..., c], at) for c in range(3)], axis=-1)
        total += passed * (1.0 - through) * medium.albedo * light
        passed = passed * through
    return total.astype(np.float32)
