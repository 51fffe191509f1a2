"""Emitters and their samples on the device, and the views of the samples' shadow maps.

A sample of a surface sees a hemisphere: three faces of a cube that stands on its corner, the
normal its diagonal, each widened over half of the faces beside it. One that sends to all sides
sees a cube.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..gpu.layout import Struct, f32, pack_array, u32, vec2f, vec3f
from ..maths.sampling import orthonormal_frame
from ..maths.transforms import box_corners
from ..scene.checks import F64
from ..surface.light_views import LightView
from .emitter import Emitter, Sample
from .segments import Segment
from .shapes import MOST_CORNERS

HEMISPHERE_SPAN, CUBE_SPAN = 3.0, 2.0
"""Width of a view at distance 1 along its axis; a hemisphere's goes from -2 to 1."""
_BORDER = 2.5
"""Texels of a map around that: as far as points are moved off their surfaces, and a filter's."""
_NEAREST = 2e-4  # of the farthest


class EmitterData(Struct):
    """One emitter, as shaders see it; its corners lie in a table of their own."""

    radiance = vec3f("W m^-2 sr^-1")
    kind = u32("0 polygon, 1 sphere, 2 samples alone")
    centre = vec3f("m")
    radius = f32("m, of a sphere, or around a polygon")
    normal = vec3f("of a polygon's glowing side")
    corner_count = u32()
    axis = vec3f("of a spot")
    cos_inner = f32()
    cos_outer = f32("below -1: no spot")
    first_sample = u32()
    sample_count = u32()
    row = u32("of the first light that stands for it where media are asked")
    depth = vec2f("in its maps: x less y, m, over the distance along the view's axis")
    nearest = f32("m^2, squares of distances from the samples of a flat one are no smaller")
    row_count = u32("of those lights")
    is_medium = u32("1: a medium that glows, which mirrored rays meet")


class SampleData(Struct):
    """One sample with the frame of its views."""

    position = vec3f("m")
    front = f32()
    normal = vec3f()
    even = f32()
    color = vec3f("W sr^-1 along the normal")
    nearest = f32("m^2, squares of distances are no smaller")
    x = vec3f("axes of the views")
    first_view = u32()
    y = vec3f()
    is_cube = u32()
    z = vec3f()
    brightness = f32("W sr^-1, the mean of the colour's channels")
    half = vec3f("m, along the axes: of the segment that the sample stands for; 0 of none")
    width = f32("m, half of what the segment is across")
    middle = vec3f("m, of the segment from the position, along the axes")
    tube = f32("how much of `even` it sends as a cylinder does")
    offset = vec3f("m, from the emitter's first sample, along the first one's axes")
    depth_scale = f32("as the emitter's `depth`, where not all samples have the same")
    depth_offset = f32("m")


def _nearest(sample: Sample) -> float:
    """m^2: squares of distances from a sample are no smaller."""
    return max(sample.light.extent**2, 1e-8)


class CornerData(Struct):
    """One corner of a polygon."""

    position = vec3f("m")


def frame(sample: Sample) -> F64:
    """Axes (3, 3), rows, of a sample's views: those of the world, or about its normal."""
    # A cube's axes are the world's; a hemisphere's stand about its normal.
    if sample.is_cube:
        return np.eye(3)
    normal = np.array(sample.light.direction)
    side, up = orthonormal_frame(normal)
    # Three axes at right angles, alike inclined to the normal: the corner of a cube.
    turn = 2.0 * np.pi * np.arange(3)[:, None] / 3.0
    axes = normal / np.sqrt(3.0) + np.sqrt(2.0 / 3.0) * (np.cos(turn) * side + np.sin(turn) * up)
    return np.asarray(axes)


def reach(emitter: Emitter, low: F64, high: F64) -> tuple[float, float]:
    """Near and far planes, m, of the views of an emitter's samples over the box low..high.

    What is nearer than a sample's own `near` does not shadow it: see `planes`.
    """
    # As far as any corner of the box is from any sample.
    positions = np.array([sample.light.position for sample in emitter.samples])
    apart = box_corners(low, high)[:, None] - positions
    far = float(np.linalg.norm(apart, axis=-1).max()) * 1.01
    return _NEAREST * far, far


def planes(sample: Sample, near: float, far: float) -> tuple[float, float]:
    """Near and far planes, m, of one sample's views, of an emitter with these."""
    return max(near, sample.near), max(far, 2.0 * sample.near)


def depth_terms(near: float, far: float) -> tuple[float, float]:
    """Depth in a map is the first less the second, m, over the distance along a face's axis."""
    gain = far / (far - near)
    return gain, gain * near


def map_spans(resolution: int) -> tuple[float, float]:
    """Widths of maps `resolution` texels wide, of a hemisphere and a cube, with their borders."""
    # On small maps the border is an eighth of the width at most.
    kept = 1.0 - 2.0 * min(_BORDER / resolution, 0.125)
    return HEMISPHERE_SPAN / kept, CUBE_SPAN / kept


def emitter_views(emitter: Emitter, low: F64, high: F64, resolution: int) -> list[LightView]:
    """The views of an emitter's samples, in the order of their layers."""
    near_far = reach(emitter, low, high)
    return [
        view
        for sample in emitter.samples
        for view in sample_views(sample, *planes(sample, *near_far), resolution)
    ]


def sample_views(sample: Sample, near: float, far: float, resolution: int) -> list[LightView]:
    """The views of a sample, in the order of their layers; `near`, `far`: their planes, m."""
    # Three faces of a cube whose corner points along the normal, or all six.
    axes, span = frame(sample), map_spans(resolution)[sample.is_cube]
    views = []
    for sign in (1.0, -1.0) if sample.is_cube else (1.0,):
        for k in range(3):
            forward, right, up = sign * axes[k], sign * axes[(k + 2) % 3], axes[(k + 1) % 3]
            rows = np.stack([right, up, forward])
            # From the world into the view: its axes as rows, the sample at the origin.
            moved = np.eye(4)
            moved[:3, :3] = rows
            moved[:3, 3] = -rows @ np.array(sample.light.position)
            views.append(
                LightView(
                    _clip(near, far, span, 0.0 if sample.is_cube else 0.5) @ moved,
                    (0.0, 0.0),
                    True,
                    0,
                )
            )
    return views


def _clip(near: float, far: float, span: float, shift: float) -> F64:
    """Clip space of (right, up, forward); twin: `sample_visibility` of wgsl/area_shadow.wgsl.

    At distance 1 a view is `span` wide, about -`shift` both ways.
    """
    # Perspective, moved aside where a view is of a hemisphere.
    scale = 2.0 / span
    gain, offset = depth_terms(near, far)
    return np.array(
        [
            [scale, 0.0, scale * shift, 0.0],
            [0.0, scale, scale * shift, 0.0],
            [0.0, 0.0, gain, -offset],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )


def emitter_rows(emitters: Sequence[Emitter], low: F64, high: F64) -> Any:
    """The table of `EmitterData`."""
    rows, first = [], 0
    for emitter in emitters:
        shape, spot = emitter.shape, emitter.spot
        # An emitter is a shape that sends, perhaps within a cone, and a run of its samples.
        corners = 0 if shape.corners is None else len(shape.corners)
        rows.append(
            {
                "radiance": shape.radiance,
                "kind": int(shape.kind),
                "centre": shape.centre,
                "radius": shape.radius,
                "normal": shape.normal,
                "corner_count": corners,
                "axis": spot.direction if spot else (0.0, 0.0, 0.0),
                "cos_inner": math.cos(math.radians(spot.inner_deg)) if spot else 0.0,
                "cos_outer": math.cos(math.radians(spot.outer_deg)) if spot else -2.0,
                "first_sample": first,
                "sample_count": len(emitter.samples),
                "row": emitter.row,
                "row_count": emitter.row_count,
                "is_medium": emitter.is_medium,
                "depth": depth_terms(*reach(emitter, low, high)),
                "nearest": float(np.mean([_nearest(s) for s in emitter.samples])),
            }
        )
        first += len(emitter.samples)
    return pack_array(EmitterData, rows)


def corner_rows(emitters: Sequence[Emitter]) -> Any:
    """MOST_CORNERS rows of `CornerData` for each emitter."""
    packed = np.zeros(max(1, MOST_CORNERS * len(emitters)), CornerData.dtype)
    for row, emitter in enumerate(emitters):
        # Corners fill the first of an emitter's rows.
        corners = emitter.shape.corners
        if corners is not None:
            first = row * MOST_CORNERS
            packed["position"][first : first + len(corners)] = corners
    return packed


def sample_rows(emitters: Sequence[Emitter], low: F64, high: F64) -> Any:
    """The table of `SampleData`, emitter by emitter."""
    rows, view = [], 0
    for emitter in emitters:
        # Each sample, where it is beside the first one of its emitter.
        first, near_far = emitter.samples[0], reach(emitter, low, high)
        for sample in emitter.samples:
            # Where it lies and sends, in axes of its own; what of it is a segment or a tube; and
            # how its map stores depth.
            light, axes = sample.light, frame(sample)
            segment = sample.segment or Segment(np.array(light.position), np.zeros(3), 0.0)
            scale, offset = depth_terms(*planes(sample, *near_far))
            rows.append(
                {
                    "position": light.position,
                    "front": light.front,
                    "normal": light.direction,
                    "even": light.even,
                    "color": light.intensity,
                    "nearest": _nearest(sample),
                    "x": axes[0],
                    "first_view": view,
                    "y": axes[1],
                    "is_cube": int(sample.is_cube),
                    "z": axes[2],
                    "brightness": sum(light.intensity) / 3.0,
                    "half": axes @ segment.half,
                    "width": segment.width,
                    "middle": axes @ (segment.middle - light.position),
                    "tube": segment.tube,
                    "offset": frame(first) @ np.subtract(light.position, first.light.position),
                    "depth_scale": scale,
                    "depth_offset": offset,
                }
            )
            view += 6 if sample.is_cube else 3
    return pack_array(SampleData, rows)
