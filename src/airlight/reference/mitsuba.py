"""The reference: any airlight scene rendered without bias by Mitsuba 3, whole or by layers.

    render          an image with a variance per pixel
    render_layers   direct, one_bounce, indirect, single_scatter, multiple_scatter,
                    transmittance, all: an image each
    write_mitsuba   the scene as Mitsuba XML

Layers are told apart by scattering events, the way mitsuba_paths says. With a libLLVM our own
integrator finds them all in one pass. Without one, scenes without media take them from
differences between Mitsuba's path length limits (noisier), and the layers of media are refused.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ReferenceFailure, SettingsError, nearest
from ..maths.tone import auto_exposure
from ..scene.checks import F32, instance, optional_function
from ..scene.image import Image, checked_size
from ..scene.nearby import Nearby, origin_near
from ..scene.scene import Scene
from .mitsuba_child import LlvmFailure, Progress, choose_variant, run_job
from .mitsuba_lights import has_glow
from .mitsuba_media import has_media
from .mitsuba_process import SCALAR_VARIANT, Job
from .mitsuba_scene import (
    VISIBLE_ENVIRONMENT,
    Exported,
    export,
    g_channels,
    with_grey_g,
    write_mitsuba,
)

__all__ = ["LAYERS", "MIN_SPP", "NoLayers", "render", "render_layers", "write_mitsuba"]

MEDIA_LAYERS = ("single_scatter", "multiple_scatter", "transmittance")
LAYERS = ("all", "direct", "one_bounce", "indirect", *MEDIA_LAYERS)
MIN_SPP = 4  # one sample in each of four batches: fewer give no variance
MAX_PX = 1 << 26


class NoLayers(ReferenceFailure):
    """Layers of a scene with media are asked for, and no libLLVM is there to tell them by."""


def render(
    scene: Scene,
    *,
    size: tuple[int, int] = (640, 360),
    spp: int = 256,
    layers: Sequence[str] = ("all",),
    max_depth: int | None = None,
    seed: int = 0,
    timeout_s: float = 3600.0,
    progress: Progress | None = None,
    variant: str = "auto",
) -> Image:
    """The scene's image, unbiased, `size` (width, height) pixels, `spp` samples a pixel.

    `radiance` is the whole image. layers["variance"] (H, W, 3) is the variance of its mean,
    from at least 4 independent batches; other `layers` are added by name: direct, one_bounce,
    indirect, and of media single_scatter, multiple_scatter, transmittance. `seed`: of the noise.
    `max_depth` limits a path's edges from emitter to eye: 1 emission, 2 one scattering event;
    None has no limit. `progress` is called with the share done. `variant`: a Mitsuba variant,
    llvm_ad_rgb or scalar_rgb; "auto" takes the first where a libLLVM is found.
    stats: spp (as rendered), seconds (of rendering), variant, integrator, noise_floor (root
    mean square of the standard error over the mean), approximations (a list of sentences).
    Raises ReferenceFailure: no Mitsuba, a scene it refuses, a crash, more than `timeout_s`.
    """
    # The whole image is rendered in any case, and once only where it is asked for by name, too.
    images = render_layers(
        scene,
        tuple(dict.fromkeys(("all", *layers))),
        size=size,
        spp=spp,
        max_depth=max_depth,
        seed=seed,
        timeout_s=timeout_s,
        progress=progress,
        variant=variant,
    )
    whole = images.pop("all")
    added = {name: image.radiance for name, image in images.items()}
    return replace(whole, layers={**whole.layers, **added})


def render_layers(
    scene: Scene,
    names: Sequence[str],
    *,
    size: tuple[int, int] = (640, 360),
    spp: int = 256,
    max_depth: int | None = None,
    seed: int = 0,
    timeout_s: float = 3600.0,
    progress: Progress | None = None,
    variant: str = "auto",
) -> dict[str, Image]:
    """An image for each of `names` (of LAYERS), each with its own layers["variance"].

    Parameters and errors as in `render`; `NoLayers` of a scene with media without a libLLVM.
    Scattering events are reflections (glossy ones too)
    and scatterings in the air; the first is the one nearest the eye:
    direct: none, or one at a surface. one_bounce: two, the first at a surface. indirect: two or
    more, the first at a surface. single_scatter: one, in the air. multiple_scatter: two or
    more, the first in the air. direct + indirect + single_scatter + multiple_scatter = all.
    """
    instance(scene, "what is path traced", Scene)
    optional_function(progress, "progress")
    size = _checked(names, size, spp, max_depth)
    scene = Nearby(origin_near(scene)).of(scene)  # Mitsuba's numbers are single precision, too
    request = _Request(tuple(names), size, spp, max_depth, seed, timeout_s, choose_variant(variant))
    try:
        parts = _render_channels(scene, request, progress)
    except LlvmFailure:
        if variant != "auto":
            raise
        parts = _render_channels(scene, replace(request, variant=SCALAR_VARIANT), progress)
    return {name: _image(name, parts, scene) for name in names}


@dataclass(frozen=True)
class _Request:
    names: tuple[str, ...]
    size: tuple[int, int]
    spp: int
    max_depth: int | None
    seed: int
    timeout_s: float
    variant: str


@dataclass(frozen=True)
class _Part:
    """What one child rendered."""

    arrays: dict[str, NDArray[Any]]
    variant: str
    integrator: str
    notes: tuple[str, ...]


def _checked(
    names: Sequence[str], size: tuple[int, int], spp: int, max_depth: int | None
) -> tuple[int, int]:
    """The size in pixels, where all of these can be rendered."""
    for name in names:
        if name not in LAYERS:
            raise SettingsError(f"unknown reference layer '{name}'", remedy=nearest(name, LAYERS))
    width, height = checked_size(size)
    if width * height > MAX_PX:
        raise SettingsError(f"reference size {width}x{height} is impossible")
    if isinstance(spp, bool) or not isinstance(spp, int):
        raise SettingsError(f"spp must be a whole number, not {spp!r}")
    if spp < MIN_SPP:
        raise SettingsError(
            f"spp = {spp} is too few",
            remedy=f"It takes {MIN_SPP} to know the noise.",
        )
    if max_depth is not None and max_depth < 1:
        raise SettingsError(f"max_depth = {max_depth} is too few", remedy="1 shows emission only.")
    return width, height


def _share(progress: Progress | None, index: int, count: int) -> Progress | None:
    if progress is None:
        return None
    return lambda done: progress((index + done) / count)


def _render_channels(scene: Scene, request: _Request, progress: Progress | None) -> list[_Part]:
    """One render, or one per colour channel where g differs between them."""
    channels = g_channels(scene)

    # A grey g scatters all colours alike: one render holds them.
    if len(channels) == 1:
        return [_render_once(scene, request, progress)]
    return [
        _render_once(with_grey_g(scene, c), request, _share(progress, c, len(channels)))
        for c in channels
    ]


def _render_once(scene: Scene, request: _Request, progress: Progress | None) -> _Part:
    # Layers of media need an integrator of our own, which takes forever where Python is
    # interpreted.
    if request.names != ("all",) and has_media(scene) and request.variant == SCALAR_VARIANT:
        raise NoLayers(
            "layers of a scene with media need Mitsuba's compiled variant, and no libLLVM 16 or "
            "newer is found",
            remedy="Install libLLVM 19, or name it in DRJIT_LIBLLVM_PATH.",
        )
    # Mitsuba runs in a process of its own: a crash there costs an exception here.
    with tempfile.TemporaryDirectory(prefix="airlight-mitsuba-") as name:
        folder = Path(name)
        exported = export(
            scene,
            folder,
            "scene",
            ".",
            size=request.size,
            spp=request.spp,
            knows_airlight=request.variant != SCALAR_VARIANT,
        )
        job = _job(scene, exported, request, folder)
        arrays = run_job(job, folder, timeout_s=request.timeout_s, progress=progress)
    # Without media nothing scatters in any, and everything passes: those layers are known.
    missing = [layer for layer in request.names if layer not in arrays]
    shape = (request.size[1], request.size[0], 3)
    for layer in missing:  # a scene without media
        arrays[layer] = np.full(shape, float(layer == "transmittance"), np.float32)
        arrays[f"{layer}.variance"] = np.zeros(shape, np.float32)
    notes = tuple(note for note in exported.notes if note != VISIBLE_ENVIRONMENT)
    if count := int(arrays["left_out"]):
        notes = (*notes, f"samples that are no numbers are left out, with their batch: {count} px")
    return _Part(arrays, job.variant, job.integrator, notes)


def _job(scene: Scene, exported: Exported, request: _Request, folder: Path) -> Job:
    # Mitsuba hides either all emitters or none; to hide the sky and show what glows takes our own
    # integrator.
    environment = scene.environment
    hide = environment is not None and not environment.visible
    glows = has_glow(scene)
    wants_layers = request.names != ("all",)
    compiled = request.variant != SCALAR_VARIANT
    ours = compiled and (wants_layers or (hide and glows))
    # Its own integrators tell no layers of media apart.
    names = request.names
    if not ours:
        names = tuple(name for name in names if name not in MEDIA_LAYERS)
    return Job(
        xml=str(folder / "scene.xml"),
        result=str(folder / "result.npz"),
        variant=request.variant,
        layers=names or ("all",),
        integrator="airlight_layers" if ours else exported.integrator,
        width=request.size[0],
        height=request.size[1],
        spp=request.spp,
        seed=request.seed,
        max_depth=-1 if request.max_depth is None else request.max_depth,
        hide_environment=hide,
        has_area_lights=glows,
        has_media=exported.has_media,
        has_masks=exported.has_masks,
    )


def _exposure(radiance: F32, scene: Scene) -> float:
    stops = scene.camera.exposure_stops
    return float(auto_exposure(radiance)) if stops is None else stops


def _image(name: str, parts: list[_Part], scene: Scene) -> Image:
    """One layer, its channels from the parts that rendered them."""

    def gathered(key: str) -> F32:
        if len(parts) == 1:
            return np.asarray(parts[0].arrays[key], dtype=np.float32)
        return np.stack([part.arrays[key][..., c] for c, part in enumerate(parts)], axis=-1)

    # Media of one phase function for each channel are rendered channel by channel.
    radiance, variance = gathered(name), gathered(f"{name}.variance")
    first = parts[0]

    # The noise as one number: the root mean square standard error over the mean.
    mean = float(radiance.mean(dtype=np.float64))
    error = float(np.sqrt(variance.mean(dtype=np.float64)))
    stats = {
        "spp": int(first.arrays["spp"]),
        "seconds": float(sum(part.arrays["seconds"] for part in parts)),
        "variant": first.variant,
        "integrator": first.integrator,
        "noise_floor": error / mean if mean > 0.0 else 0.0,
        "approximations": list(dict.fromkeys(note for part in parts for note in part.notes)),
    }
    return Image(
        radiance=radiance,
        layers={"variance": variance},
        exposure_stops=_exposure(radiance, scene),
        stats=stats,
    )
