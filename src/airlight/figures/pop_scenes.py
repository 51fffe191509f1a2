"""What the figures of Elek2014 show, made of what ships: media alone before a bright map."""

from __future__ import annotations

import dataclasses
import statistics
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..app.compare.images import heat
from ..maths.colour import luminance
from ..maths.transforms import triple
from ..scene.builtin import cloud, smoke
from ..scene.builtin.milk import BOUNDS as MILK_BOUNDS
from ..scene.builtin.milk import knot_density
from ..scene.camera import Camera
from ..scene.checks import F32, Rgb, Vec3
from ..scene.image import Image
from ..scene.scene import Scene
from ..scene.volume import Volume
from .panels import TIMED_FRAMES, Request, away, mean_light, rendered, renderer
from .pop_court import courtyard
from .truths import averaged

PLUME_M = 10.0  # Elek2014 Fig. 11
PLUME_SCATTERING: Rgb = (2.9, 3.6, 4.2)
PLUME_ABSORPTION: Rgb = (3.4, 3.35, 3.4)
MILK_SCATTERING: Rgb = (0.91, 1.07, 1.25)  # m^-1; Fig. 8
MILK_M, MILK_DENSER = 4.0, 4.0  # a knot is thinner than the dragon
EXPOSURE_STOPS = -1.2
QUICK_POP: Mapping[str, Any] = {"ordinates": 6, "grid": 6, "solver_steps": 8, "march_steps": 32}
_CLEAR, _BLOCK_PX = 0.98, 4
_MOST, _DAZZLING = 0.8, 4.0
_SPP_SHARE = 2  # of a path-traced panel's samples: air costs many scatterings a path


def plume(g: float = 0.9) -> Scene:
    """Smoke, 10 m across with the coefficients of Fig. 11, before the courtyard."""
    # The builtin smoke scaled to the figure's size.
    volume = smoke().volumes[0]
    (x0, y0, z0), (x1, y1, z1) = volume.bounds
    scale = PLUME_M / (y1 - y0)
    low = (scale * x0, -0.5 * PLUME_M, scale * z0)
    high = (scale * x1, 0.5 * PLUME_M, scale * z1)

    # The paper's coefficients in place of its own.
    extinction = np.add(PLUME_SCATTERING, PLUME_ABSORPTION)
    albedo = np.divide(PLUME_SCATTERING, extinction)
    made = Volume(
        triple(extinction),
        volume.density,
        bounds=(low, high),
        albedo=triple(albedo),
        g=(g,) * 3,
        source="plume",
    )
    camera = _camera((1.5, 0.3, 14.0), 42.0)
    return Scene(name="plume", camera=camera, volumes=(made,), environment=courtyard())


def white_plume(g: float) -> Scene:
    """The same smoke without absorption."""
    scene = plume(g)
    made = dataclasses.replace(scene.volumes[0], sigma_t=PLUME_SCATTERING, albedo=(1.0,) * 3)
    return dataclasses.replace(scene, volumes=(made,), name="white plume")


def slab(g: float) -> Scene:
    """A thin strongly scattering slab before the courtyard (Fig. 6)."""
    made = Volume(
        (3.0,) * 3,
        shape="box",
        bounds=((-1.6, -0.9, -0.25), (1.6, 0.9, 0.25)),
        g=(g,) * 3,
        source="slab",
    )
    camera = _camera((0.0, 0.0, 3.2), 40.0)
    return Scene(name="slab", camera=camera, volumes=(made,), environment=courtyard())


def milk(position: Vec3 = (1.5, 2.0, 7.0)) -> Scene:
    """The builtin knot, 4 m across, of milk with the coefficients of Fig. 8, albedo 0.9993."""
    # The knot stands for the paper's dragon, thinner and so denser.
    density, (low, high) = knot_density(), np.array(MILK_BOUNDS)
    scale = MILK_M / (high - low).max()
    half = 0.5 * scale * (high - low)
    made = Volume(
        triple(MILK_DENSER * np.array(MILK_SCATTERING)),
        density,
        bounds=(triple(-half), triple(half)),
        albedo=(0.9993,) * 3,
        g=(0.95,) * 3,
        source="milk",
    )
    camera = _camera(position, 30.0)
    return Scene(name="milk", camera=camera, volumes=(made,), environment=courtyard())


def _camera(position: Vec3, fov_y_deg: float) -> Camera:
    return Camera(position, (0.0, 0.0, 0.0), fov_y_deg=fov_y_deg, exposure_stops=EXPOSURE_STOPS)


def clouds(g: float) -> Scene:
    """The builtin cloud with another phase function, lit from the eye's side (Fig. 15)."""
    scene = cloud()
    made = dataclasses.replace(scene.volumes[0], g=(g,) * 3)
    camera = Camera((6.0, 2.0, 84.0), (0.0, 46.0, 0.0), fov_y_deg=42.0, exposure_stops=-1.5)
    return dataclasses.replace(scene, volumes=(made,), camera=camera)


def turned(scene: Scene, degrees: float) -> Scene:
    """Under its map turned about +Y."""
    assert scene.environment is not None
    sky = dataclasses.replace(scene.environment, rotation_deg=degrees)
    return dataclasses.replace(scene, environment=sky)


def drawn(request: Request, scene: Scene, settings: Mapping[str, Any] | None = None) -> Image:
    """A panel by `pop`. Raises SettingsError, DeviceError."""
    quick = QUICK_POP if request.quick else {}
    return rendered(request, scene, {**(settings or {}), **quick}, technique="pop")


def moving_ms(request: Request, scene: Scene, settings: Mapping[str, Any] | None = None) -> float:
    """The median of frames of `pop` under a turning map; were it still, nothing would be solved."""
    asked = {**(settings or {}), **(QUICK_POP if request.quick else {})}
    start = scene.environment.rotation_deg if scene.environment else 0.0
    with renderer(request, scene, asked, technique="pop") as made:
        for turn in range(1 + (1 if request.quick else TIMED_FRAMES)):
            made.scene = turned(scene, start + float(turn))
            made.frame(read=False)
        return statistics.median(made.frame_ms[1:])


def traced(request: Request, scene: Scene) -> Image | None:
    """The same by Monte Carlo, at half the size where that is whole; None with --quick.

    Raises ReferenceFailure.
    """
    if request.quick:
        return None
    from ..reference import mitsuba

    # Fewer samples than for surfaces: paths in media are long.
    spp = max(mitsuba.MIN_SPP, request.reference_spp // _SPP_SHARE)
    width, height = request.size
    halves = width % 2 == 0 and height % 2 == 0
    layers = mitsuba.render_layers(
        scene,
        ("all",),
        size=(width // 2, height // 2) if halves else request.size,
        spp=spp,
        seed=0,
        timeout_s=3600.0,
        progress=lambda done: request.report("path tracing", done),
    )
    return layers["all"]


def differences(images: Mapping[str, Image], best: Image) -> list[Any]:
    """Captioned maps of how far the scattered light of `images` is from that of `best`.

    Black where it is the same, white where it is off by half of what is bright in `best`.
    """
    # Only where the medium is: the background is the same in all.
    usual = luminance(best.layers["scattered"])
    is_air = best.layers["transmittance"].min(axis=-1) < _CLEAR
    bright = float(np.quantile(usual[is_air], _MOST)) if is_air.any() else 1.0
    cells = []

    # Off by half of what is bright is white.
    for name, image in images.items():
        light = image.layers["scattered"]
        error = np.abs(luminance(light) - usual) / max(0.5 * bright, 1e-30)
        caption = f"{name}: {away(light, best.layers['scattered']):.2f}"
        cells.append((caption, heat(error.astype(np.float32))))
    return cells


def errors(image: F32, truth: Image | None) -> dict[str, float]:
    """Energy ratio, relative L2, and the L2 that the truth's own noise makes."""
    # Without a truth only the mean can be told.
    if truth is None:
        return {"mean": mean_light(image)}
    noise = float(np.sqrt(truth.layers["variance"].sum() / np.sum(truth.radiance**2)))
    return {
        "energy_ratio": mean_light(image) / max(mean_light(truth.radiance), 1e-30),
        "relative_l2": away(averaged(image, truth.radiance), truth.radiance),
        "noise_floor_l2": noise,
    }


def scores(image: Image, truth: Image | None) -> dict[str, dict[str, float]]:
    """`errors` of the whole image, and of the light that media scatter: `scattered_errors`."""
    light = image.layers["scattered"]
    through = image.layers["transmittance"]
    return {
        "whole": errors(image.radiance, truth),
        "scattered": scattered_errors(light, image.radiance - light, through, truth),
    }


def scattered_errors(
    light: F32, behind: F32, through: F32, truth: Image | None
) -> dict[str, float]:
    """`errors` of scattered `light` over blocks of pixels, where less than all comes `through`.

    Blocks, because single pixels of Monte Carlo in air are noise. What surfaces and map show
    through the media, `behind`, is taken from our own image; blocks where that is a sun, four
    times brighter than what most of the air scatters, are left out: its noise would decide.
    """
    if truth is None:
        return errors(light, None)

    # Blocks of pixels that show the medium, without what lies behind it.
    is_air = averaged(through, truth.radiance).min(axis=-1, keepdims=True) < _CLEAR
    shown = averaged(behind, truth.radiance)
    seen = _in_blocks((truth.radiance - shown) * is_air)
    variance = np.divide(
        _in_blocks(truth.layers["variance"] * is_air), _BLOCK_PX**2, dtype=np.float32
    )

    # Blocks whose background outshines the medium say nothing of it.
    dazzling = _in_blocks(shown * is_air).max(axis=-1, keepdims=True)
    peaks = seen.max(axis=-1)[_in_blocks(is_air)[..., 0] > 0.0]
    kept = dazzling <= (_DAZZLING * np.quantile(peaks, _MOST) if peaks.size else 0.0)

    # Ours, masked as the truth is.
    mine = _in_blocks(averaged(light, truth.radiance) * is_air)
    return errors(mine * kept, Image(seen * kept, {"variance": variance * kept}))


def off(found: Mapping[str, Mapping[str, float]]) -> str:
    """What a caption says of `scores`: the error of scattered light, and what of it is noise.

    Nothing without a truth.
    """
    light = found["scattered"]
    if "relative_l2" not in light:
        return ""
    return f": off by {light['relative_l2']:.2f} (noise {light['noise_floor_l2']:.2f})"


def _in_blocks(image: F32) -> F32:
    """Means (rows, columns, 3) of squares of pixels; the remainder at the edges is cut off."""
    n = _BLOCK_PX
    height, width = (length // n for length in image.shape[:2])
    cut = image[: height * n, : width * n]
    means = cut.reshape(height, n, width, n, -1).mean(axis=(1, 3))
    return np.asarray(means, dtype=np.float32)
