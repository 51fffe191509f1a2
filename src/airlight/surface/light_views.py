"""Projections of lights, fitted to the scene and stable under camera movement.

Depth is conventional: 0 near, 1 far. A directional light has one view, a spot light one, a point
light and a sample of a light with extent six.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..gpu.layout import Struct, f32, mat4x4f, u32, vec2f
from ..maths.transforms import (
    F64,
    box_corners,
    clip_from_view_orthographic,
    clip_from_view_perspective,
    transformed,
    triple,
    view_from_world,
)
from ..scene.lights import DirectionalLight, Light

Vec3 = tuple[float, float, float]
_CUBE = (  # forward, up: faces +x -x +y -y +z -z
    ((1, 0, 0), (0, -1, 0)),
    ((-1, 0, 0), (0, -1, 0)),
    ((0, 1, 0), (0, 0, 1)),
    ((0, -1, 0), (0, 0, -1)),
    ((0, 0, 1), (0, -1, 0)),
    ((0, 0, -1), (0, -1, 0)),
)


_LEAST_NEAR_M = 1e-9
"""Of near planes, which else are a thousandth of the far plane's distance."""
_WIDE_DEG = 50.0  # a single perspective would waste its texels on the axis


class LightViewData(Struct):
    """One view of a light, as shaders read it."""

    clip_from_world = mat4x4f()
    world_from_clip = mat4x4f()
    texel = vec2f("m where parallel, m at 1 m distance in perspective")
    is_perspective = u32()
    flux_unit = f32("W m^-2 or W sr^-1 that 1 stands for in the flux of its reflective map")


@dataclass(frozen=True, eq=False)
class LightView:
    """A square image of `resolution`^2 texels from a light."""

    clip_from_world: F64
    texel: tuple[float, float]
    is_perspective: bool
    light: int

    @property
    def fields(self) -> dict[str, object]:
        """The values of `LightViewData`."""
        return {
            "clip_from_world": self.clip_from_world,
            "world_from_clip": np.linalg.inv(self.clip_from_world),
            "texel": self.texel,
            "is_perspective": int(self.is_perspective),
            "flux_unit": 1.0,
        }


def widened(view: LightView, times: float) -> LightView:
    """The same view scaled to `times` the width and height, with larger texels.

    A smaller part of the map is then drawn, and shadows are coarser.
    """
    # Clip coordinates shrink, so the view holds more.
    wide = np.diag([1.0 / times, 1.0 / times, 1.0, 1.0]) @ view.clip_from_world
    texel = (view.texel[0] * times, view.texel[1] * times)
    return LightView(wide, texel, view.is_perspective, view.light)


def light_views(
    lights: Iterable[Light], low: F64, high: F64, resolution: int, *, turn_deg: float = 0.0
) -> list[LightView]:
    """The views of all lights over the box low..high (metres), in the lights' order.

    `turn_deg`: how far the texels of parallel light are turned about it. Else upright edges lie
    along columns of texels, which change all at once when the light moves.
    """
    views: list[LightView] = []

    # One view along parallel light or of a narrow cone, else a cube; none of sampled lights.
    for index, light in enumerate(lights):
        if isinstance(light, DirectionalLight):
            views.append(_parallel(light, index, (low, high), resolution, turn_deg))
        elif light.is_sampled:
            continue
        elif light.cone is not None and view_count(light) == 1:
            # A little wider than the cone, so that filtering at its rim meets texels.
            axis, half_angle_deg = light.cone
            axes, fov = (axis, (0.0, 1.0, 0.0)), np.radians(2.0 * half_angle_deg) * 1.01
            views.append(perspective(light.position, axes, fov, index, (low, high), resolution))
        else:
            views += _cube(light.position, index, (low, high), resolution, light.unshadowed_m)
    return views


def stale_layers(
    drawn: dict[int, tuple[int, bytes]], version: int, views: Iterable[LightView]
) -> list[int]:
    """The layers of maps that hold other views, or another version of the scene.

    They count as drawn from here on: `drawn` has what each layer was drawn from.
    """
    keys = {layer: (version, view.clip_from_world.tobytes()) for layer, view in enumerate(views)}
    stale = [layer for layer, key in keys.items() if drawn.get(layer) != key]
    drawn.update(keys)
    return stale


def view_count(light: Light) -> int:
    """The number of views of a light: six, as the faces of a cube, but for narrow cones."""
    if isinstance(light, DirectionalLight) or light.is_sampled:
        return 1
    return 6 if light.cone is None or light.cone[1] > _WIDE_DEG else 1


def _parallel(
    light: DirectionalLight, index: int, box: tuple[F64, F64], resolution: int, turn_deg: float
) -> LightView:
    # The box seen along the light, a little wider, lest its own faces be cut.
    low, high = triple(box[0]), triple(box[1])
    view, near, far = _extent_along(triple(light.direction), low, high, turn_deg)
    margin = 1e-3 * float(np.linalg.norm(far - near)) or 1e-6
    near, far = near - margin, far + margin
    # Whole texels of a grid fixed in the world, so that a growing box does not make edges crawl.
    texel = (far[:2] - near[:2]) / (resolution - 1)
    near[:2] = np.floor(near[:2] / texel) * texel
    far[:2] = near[:2] + texel * resolution
    clip = clip_from_view_orthographic(near, far) @ view
    return LightView(clip, (float(texel[0]), float(texel[1])), False, index)


@lru_cache(maxsize=64)
def _extent_along(direction: Vec3, low: Vec3, high: Vec3, turn_deg: float) -> tuple[F64, F64, F64]:
    """view_from_world of a directional light, turned about it, and the box low..high in that."""
    # A turn in the plane of the map moves no light, only the texels' rows.
    view = view_from_world((0.0, 0.0, 0.0), direction, (0.0, 1.0, 0.0))
    if turn_deg:
        cos, sin = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
        view[:2] = np.array([[cos, -sin], [sin, cos]]) @ view[:2]
    corners = transformed(box_corners(np.array(low), np.array(high)), view)
    return view, corners.min(axis=0), corners.max(axis=0)


def _cube(
    position: Vec3, index: int, box: tuple[F64, F64], resolution: int, least: Vec3
) -> list[LightView]:
    return [
        perspective(position, axes, 0.5 * np.pi, index, box, resolution, least[face // 2])
        for face, axes in enumerate(_CUBE)
    ]


def perspective(
    position: Vec3,
    axes: tuple[Vec3, Vec3],
    fov: float,
    index: int,
    box: tuple[F64, F64],
    resolution: int,
    least: float = 0.0,
) -> LightView:
    """The view of an angle `fov`, rad, whose depth goes as far as the box; `index`: its light.

    `axes`: where it looks, and what is up; `least`, m: what is nearer is not drawn.
    """
    # The depth range ends just behind the box's farthest corner.
    far = float(np.linalg.norm(box_corners(*box) - position, axis=1).max()) * 1.01
    near = max(1e-3 * far, _LEAST_NEAR_M, least)
    far = max(far, 2.0 * near)
    view = view_from_world(position, *axes)
    clip = clip_from_view_perspective(fov, near, far) @ view

    # At 1 m distance a map of this angle is 2 tan(fov / 2) wide.
    texel = 2.0 * float(np.tan(0.5 * fov)) / resolution
    return LightView(clip, (texel, texel), True, index)
