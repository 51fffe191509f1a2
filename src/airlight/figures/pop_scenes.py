"""What the figures of Elek2014 show, made of what ships: media alone before a bright map."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..app.compare_pictures import U8, shown
from ..scene.builtin import cloud, smoke
from ..scene.camera import Camera
from ..scene.checks import F32, Rgb, Vec3
from ..scene.environment import Environment
from ..scene.image import Image
from ..scene.scene import Scene
from ..scene.volume import Volume
from .panels import Request, mean_light, rendered

PLUME_M = 10.0  # Elek2014 Fig. 11
PLUME_SCATTERING: Rgb = (2.9, 3.6, 4.2)
PLUME_ABSORPTION: Rgb = (3.4, 3.35, 3.4)
MILK_SCATTERING: Rgb = (0.91, 1.07, 1.25)  # m^-1; Fig. 8
QUICK_POP: Mapping[str, Any] = {"ordinates": 6, "grid": 6, "solver_steps": 8, "march_steps": 32}
_SPP_SHARE = 4  # of a path-traced panel's samples: air costs many scatterings a path


def courtyard(height_px: int = 64) -> Environment:
    """A bright sky above dark walls, and the sun's glow in one window: high frequencies.

    Radiance 0.05 to 40 W m^-2 sr^-1.
    """
    v, u = np.meshgrid(
        (np.arange(height_px) + 0.5) / height_px,
        (np.arange(2 * height_px) + 0.5) / height_px - 1.0,
        indexing="ij",
    )  # fmt: skip
    wall = 0.34 + 0.08 * np.sign(np.sin(9.0 * np.pi * u))
    sky = np.array([2.2, 3.0, 4.4]) * (v < wall)[..., None]
    stone = np.array([0.22, 0.17, 0.12]) * (v >= wall)[..., None]
    light = sky + stone * (1.0 - 0.6 * v[..., None])
    for at, tall, colour in (
        ((-0.32, 0.45), (0.05, 0.09), (26.0, 20.0, 12.0)),
        ((0.42, 0.52), (0.04, 0.08), (14.0, 12.0, 9.0)),
        ((0.9, 0.42), (0.06, 0.06), (40.0, 34.0, 26.0)),
    ):
        window = (np.abs(u - at[0]) < tall[0]) & (np.abs(v - at[1]) < tall[1])
        light[window] = colour
    return Environment(map=light.astype(np.float32), source="courtyard")


def plume(g: float = 0.9) -> Scene:
    """Smoke, 10 m across with the coefficients of Fig. 11, before the courtyard."""
    volume = smoke().volumes[0]
    (x0, y0, z0), (x1, y1, z1) = volume.bounds
    scale = PLUME_M / (y1 - y0)
    low = (scale * x0, -0.5 * PLUME_M, scale * z0)
    high = (scale * x1, 0.5 * PLUME_M, scale * z1)
    extinction = np.add(PLUME_SCATTERING, PLUME_ABSORPTION)
    albedo = np.divide(PLUME_SCATTERING, extinction)
    made = Volume(
        _rgb(extinction), volume.density, bounds=(low, high), albedo=_rgb(albedo), g=(g,) * 3,
        source="plume",
    )  # fmt: skip
    camera = Camera((1.5, 0.3, 14.0), (0.0, 0.0, 0.0), fov_y_deg=42.0)
    return Scene(name="plume", camera=camera, volumes=(made,), environment=courtyard())


def white_plume(g: float, density: float = 1.0) -> Scene:
    """The same smoke without absorption; `density` thins it."""
    scene = plume(g)
    sigma = density * np.array(PLUME_SCATTERING)
    made = dataclasses.replace(scene.volumes[0], sigma_t=_rgb(sigma), albedo=(1.0,) * 3)
    return dataclasses.replace(scene, volumes=(made,), name="white plume")


def slab(g: float) -> Scene:
    """A thin strongly scattering slab before the courtyard (Fig. 6)."""
    made = Volume(
        (3.0,) * 3, shape="box", bounds=((-1.6, -0.9, -0.25), (1.6, 0.9, 0.25)), g=(g,) * 3,
        source="slab",
    )  # fmt: skip
    camera = Camera((0.0, 0.0, 3.2), (0.0, 0.0, 0.0), fov_y_deg=40.0)
    return Scene(name="slab", camera=camera, volumes=(made,), environment=courtyard())


def milk(position: Vec3 = (1.5, 2.0, 7.0)) -> Scene:
    """A knot of milk, albedo 0.9993 (Fig. 8), 4 m across."""
    side = 40
    at = (np.arange(side) + 0.5) / side * 2.4 - 1.2
    z, y, x = np.meshgrid(at, at, at, indexing="ij")
    t = np.linspace(0.0, 2.0 * np.pi, 160)
    ring = 0.62 + 0.26 * np.cos(3.0 * t)
    knot = np.stack(
        [ring * np.cos(2.0 * t), 0.4 * np.sin(3.0 * t), ring * np.sin(2.0 * t)], axis=-1
    )
    away = np.full(x.shape, np.inf)
    for px, py, pz in knot:
        away = np.minimum(away, (x - px) ** 2 + (y - py) ** 2 + (z - pz) ** 2)
    rho = np.clip((0.3 - np.sqrt(away)) / 0.08 + 0.5, 0.0, 1.0).astype(np.float32)
    sigma = 4.0 * np.array(MILK_SCATTERING)
    made = Volume(
        _rgb(sigma), rho, bounds=((-2.0,) * 3, (2.0,) * 3), albedo=(0.9993,) * 3, g=(0.95,) * 3,
        source="milk",
    )  # fmt: skip
    camera = Camera(position, (0.0, 0.0, 0.0), fov_y_deg=38.0)
    return Scene(name="milk", camera=camera, volumes=(made,), environment=courtyard())


def clouds(g: float) -> Scene:
    """The builtin cloud in its sun and sky, with another phase function (Fig. 15)."""
    scene = cloud()
    made = dataclasses.replace(scene.volumes[0], g=(g,) * 3)
    return dataclasses.replace(scene, volumes=(made,))


def turned(scene: Scene, degrees: float) -> Scene:
    """Under its map turned about +Y."""
    assert scene.environment is not None
    sky = dataclasses.replace(scene.environment, rotation_deg=degrees)
    return dataclasses.replace(scene, environment=sky)


def drawn(
    request: Request, scene: Scene, settings: Mapping[str, Any] | None = None, *,
    timed: bool = False,
) -> Image:  # fmt: skip
    """A panel by `pop`. Raises SettingsError, DeviceError."""
    quick = QUICK_POP if request.quick else {}
    return rendered(request, scene, {**(settings or {}), **quick}, technique="pop", timed=timed)


def traced(request: Request, scene: Scene) -> Image | None:
    """The same by Monte Carlo; None with --quick. Raises ReferenceFailure."""
    if request.quick:
        return None
    from ..reference import mitsuba

    spp = max(mitsuba.MIN_SPP, request.reference_spp // _SPP_SHARE)
    layers = mitsuba.render_layers(
        scene, ("all",), size=request.size, spp=spp, seed=0, timeout_s=3600.0,
        progress=lambda done: request.report("path tracing", done),
    )  # fmt: skip
    return layers["all"]


def errors(image: F32, truth: Image | None) -> dict[str, float]:
    """Energy ratio, relative L2, and the L2 that the truth's own noise makes."""
    if truth is None:
        return {"mean": mean_light(image)}
    noise = float(np.sqrt(truth.layers["variance"].sum() / np.sum(truth.radiance**2)))
    return {
        "energy_ratio": mean_light(image) / max(mean_light(truth.radiance), 1e-30),
        "relative_l2": away(image, truth.radiance),
        "noise_floor_l2": noise,
    }


def scores(image: Image, truth: Image | None) -> dict[str, dict[str, float]]:
    """`errors` of the whole picture, and of the light that media scatter: the picture behind hides
    them. What surfaces and map show through the media is taken from our own picture.
    """
    behind = image.radiance - image.layers["scattered"]
    alone = None
    if truth is not None:
        alone = Image(truth.radiance - behind, {"variance": truth.layers["variance"]})
    return {
        "whole": errors(image.radiance, truth),
        "scattered": errors(image.layers["scattered"], alone),
    }


def away(image: F32, other: F32) -> float:
    """Relative L2 of a picture from another."""
    return float(np.linalg.norm(image - other) / max(float(np.linalg.norm(other)), 1e-30))


def exposed_all(images: Mapping[str, F32 | None], stops: float) -> list[tuple[str, U8 | None]]:
    """Captioned pictures; None stays None."""
    return [(k, None if v is None else shown(v, stops)) for k, v in images.items()]


def _rgb(values: Any) -> Rgb:
    r, g, b = (float(v) for v in values)
    return (r, g, b)
