"""Path-traced panels: half a panel's size, without grain in images, scored as they are."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np

from ..app.compare.reference import Reference, reference_for
from ..maths.colour import luminance
from ..scene.checks import F32
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Request

SPARK = 4.0
"""Of its neighbours' median: a pixel that has more is a spark, of few paths that carry much."""
ALONE = 4.0
"""Neighbours alike, itself one of them: a pixel that has fewer shows an edge."""
_MEDIAN_PX = 3
_SKY_M = 1e4


def traced(request: Request, scene: Scene) -> Reference:
    """All layers by path tracing, at half the size where that is whole: a quarter of the time.

    A truth without layers is told to `request.warn`. Raises ReferenceFailure.
    """
    # A quarter of the pixels and of the time; ours are averaged to as many.
    width, height = request.size
    halves = width % 2 == 0 and height % 2 == 0
    size = (width // 2, height // 2) if halves else request.size
    truth = reference_for(scene, size, request.reference_spp, report=request.report)
    if not truth.has_layers:
        request.warn(truth.notes[0])
    if truth.not_cached:
        request.warn(truth.not_cached)
    return truth


def truth_of(request: Request, scene: Scene) -> Reference | None:
    """The same; None with --quick."""
    return None if request.quick else traced(request, scene)


def noise_l2(truth: Reference, layer: str) -> float:
    """The relative L2 that a perfect image of a layer would score because the truth is noisy."""
    light, variance = (truth.image.layers[layer + end] for end in ("", "_variance"))
    each = variance if variance.ndim == light.ndim else variance[..., None]
    noise = float(np.sqrt(np.broadcast_to(each, light.shape).sum()))
    return noise / max(float(np.linalg.norm(light)), 1e-30)


def told_of(truth: Reference) -> str:
    """A caption: its size and samples, and whether grain is gone."""
    height, width = truth.image.radiance.shape[:2]
    caption = f"path traced, {width}x{height}, {truth.spp} samples"
    return f"{caption}, smoothed" if truth.has_layers else caption


def averaged(pixels: F32, truth: F32) -> F32:
    """(H, W) or (H, W, 3), averaged over the pixels of a truth of half that size."""
    height, width = truth.shape[:2]
    if pixels.shape[:2] == (height, width):
        return pixels

    # Means of squares of four pixels.
    blocks = pixels.reshape(height, 2, width, 2, *pixels.shape[2:])
    return np.asarray(blocks.mean(axis=(1, 3), dtype=np.float64), np.float32)


def as_large_as(image: Image, truth: F32) -> Image:
    """The image and its layers, averaged alike."""
    layers = {name: averaged(pixels, truth) for name, pixels in image.layers.items()}
    return dataclasses.replace(image, radiance=averaged(image.radiance, truth), layers=layers)


def without_noise(truth: Reference, guide: Image) -> F32:
    """The truth's radiance; what has no sharp edges in the air, smoothed over surfaces.

    As it was traced where the truth has no layers: shafts and shadows must keep their edges.
    """
    # Indirect and scattered light has no sharp edges of its own; direct light keeps its.
    radiance, layers = truth.image.radiance, truth.image.layers
    if not truth.has_layers:
        return radiance
    grainy = layers["indirect"] + layers["multiple_scatter"]
    return np.asarray(radiance - grainy + smoothed(grainy, guide), np.float32)


def smoothed(light: F32, guide: Image, radius_px: int = 4) -> F32:
    """A path tracer's light without its grain, for images alone: scores take it as it is.

    The mean (H, W, 3) over pixels near by that show the same surface in `guide`, by its normals
    and depths. What sparks have beyond `SPARK` is spread so wide that they leave no mark.
    """
    if "normal" not in guide.layers or "depth" not in guide.layers:
        return light
    rim = radius_px * (radius_px + 1)  # what is beyond a border is as what is at it

    def rimmed(pixels: F32) -> F32:
        width = ((rim, rim), (rim, rim), (0, 0))[: pixels.ndim]
        return np.asarray(np.pad(pixels, width, mode="edge"), np.float32)

    # A border for neighbours beyond the image, as wide as they are looked for.
    small = as_large_as(guide, light)
    layers = {name: rimmed(small.layers[name]) for name in ("normal", "depth")}
    light = rimmed(light)
    guide = Image(light, layers)

    # Light without sparks is averaged closely, that of sparks widely.
    even = np.asarray(light * _kept(light, guide)[..., None], np.float32)
    wide = _mean(_mean(light - even, guide, radius_px, 1), guide, radius_px, radius_px)
    whole = _mean(even, guide, radius_px, 1) + wide
    return np.asarray(whole[rim:-rim, rim:-rim], np.float32)


def _kept(colours: F32, guide: Image) -> F32:
    """(H, W): how much of each pixel's light (H, W, 3) is no spark's."""
    # The neighbours that show the same surface, sorted by their light.
    light = luminance(colours)
    around = [
        np.where(alike[..., 0] > 0.5, np.roll(light, shift, (0, 1)), np.inf)
        for shift, alike in _neighbours(guide, _MEDIAN_PX, 1)
    ]
    ordered = np.sort(np.stack(around), axis=0)

    # A pixel keeps what is within so many times their median.
    middle = (np.isfinite(ordered).sum(axis=0, keepdims=True) - 1) // 2
    median = np.take_along_axis(ordered, np.maximum(middle, 0), axis=0)[0]
    limit = SPARK * np.where(np.isfinite(median), median, 0.0)
    return np.asarray(np.minimum(1.0, limit / np.maximum(light, 1e-20)), np.float32)


def _mean(light: F32, guide: Image, radius_px: int, step_px: int) -> F32:
    """Over neighbours alike, those far off counting less; pixels on edges, like none, over all."""
    # With the guide, and without it for pixels that no neighbour is like.
    total, plain = np.zeros_like(light), np.zeros_like(light)
    weights, all_weights = np.zeros((*light.shape[:2], 1), np.float32), 0.0
    for shift, alike in _neighbours(guide, radius_px, step_px):
        far = (shift[0] ** 2 + shift[1] ** 2) / (radius_px * step_px) ** 2
        near, moved = float(np.exp(-1.5 * far)), np.roll(light, shift, (0, 1))
        total += np.float32(near) * alike * moved
        plain += np.float32(near) * moved
        weights += np.float32(near) * alike
        all_weights += near
    guided = total / np.maximum(weights, 1e-20)
    return np.asarray(np.where(weights < ALONE, plain / all_weights, guided), np.float32)


def _neighbours(
    guide: Image, radius_px: int, step_px: int
) -> Iterator[tuple[tuple[int, int], F32]]:
    """Shifts, and how far (H, W, 1), 0 to 1, the pixel so shifted shows the same surface."""
    # Normals and depths tell surfaces apart; the sky is like itself alone.
    normal = guide.layers["normal"]
    depth = np.minimum(guide.layers["depth"], _SKY_M)[..., None]
    is_sky = (depth >= _SKY_M).astype(np.float32)
    steps = range(-radius_px * step_px, radius_px * step_px + 1, step_px)
    for shift in ((y, x) for y in steps for x in steps):
        apart = np.abs(np.roll(depth, shift, (0, 1)) / depth - 1.0)
        level = np.sum(normal * np.roll(normal, shift, (0, 1)), axis=-1, keepdims=True)
        alike = np.clip(np.maximum(level, is_sky), 0.0, 1.0) ** 16
        reach = 0.03 * (1.0 + np.hypot(*shift))  # floors seen aslant get deeper by the pixel
        yield shift, np.asarray(alike * (apart < reach), np.float32)
