"""The panel's section of the air: fog, volumes, and what is in their grids."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...scene.medium import Medium
from ...scene.scene import Scene
from ...scene.volume import Volume
from .scene_sections import scaled
from .slices import COLOURS, Axis, caption, fullest
from .state import ViewState, fog_for
from .widgets import Widget

_LEAST_SIGMA, _MOST_SIGMA = 1e-4, 1e3  # 1/m, in a scene of some metres
_LEAST_DEPTH, _MOST_DEPTH = 1e-2, 1e4  # mean free paths across a small or large scene
_ENDLESS = "It goes on sideways and downwards; else it fills the scene's box and the camera's place"
_TIP = "Bars: how often densities are, logarithmic. Line: as what they are rendered"


def air(state: ViewState) -> Iterator[Widget]:
    """Fog and volumes: how much, how white, how far forwards, and what is in a grid."""
    scene = state.scene

    def add(_: Any) -> None:
        state.scene = replace(state.scene, medium=fog_for(state.scene))

    def clear(_: Any) -> None:
        state.scene = replace(state.scene, medium=None)

    def put_fog(fog: Any) -> None:
        state.scene = replace(state.scene, medium=fog)

    ends = _extinctions(scene)
    # Fog fills the scene; volumes have a section each, with a slice where they are grids.
    if scene.medium is None:
        yield Widget("fog.add", "button", "add fog", None, add)
    else:
        yield from _scattering("fog", "fog: ", scene.medium, put_fog, ends)
        yield Widget("fog.endless", "flag", "fog without an end", *_endless(state), tip=_ENDLESS)
        yield Widget("fog.clear", "button", "no fog", None, clear)
    for index, volume in enumerate(scene.volumes):
        head = f"volume {index + 1}: " if len(scene.volumes) > 1 else "volume: "
        top = state.sliced[index].top if index in state.sliced else 1.0
        put_volume = _volume_putter(state, index)
        yield from _scattering(f"volume.{index}", head, volume, put_volume, ends, top)
        if volume.density is not None:
            yield from _slice(state, index)


def _endless(state: ViewState) -> tuple[bool, Callable[[Any], None]]:
    """Whether fog goes on around the scene, and what changes that: its top is above scene and
    camera then."""
    scene, fog = state.scene, state.scene.medium
    assert fog is not None

    def put(is_endless: Any) -> None:
        now = replace(fog, endless=False, top=None)
        if is_endless:
            low, high = (float(corner[1]) for corner in scene.bounds)
            top = max(high, scene.camera.position[1]) + 0.25 * (high - low)
            now = replace(now, bounds=None, endless=True, top=top)
        state.scene = replace(scene, medium=now)

    return fog.endless, put


def _volume_putter(state: ViewState, index: int) -> Callable[[Any], None]:
    return lambda volume: state.set_volume(index, volume)


def _extinctions(scene: Scene) -> tuple[float, float]:
    """The least and the most extinction to choose, 1/m: wider in small and in large scenes."""
    low, high = scene.bounds
    size_m = max(float(np.linalg.norm(high - low)), 1e-9)
    return min(_LEAST_SIGMA, _LEAST_DEPTH / size_m), max(_MOST_SIGMA, _MOST_DEPTH / size_m)


def _scattering(
    name: str,
    head: str,
    of: Medium | Volume,
    put: Callable[[Any], None],
    ends: tuple[float, float],
    top: float = 1.0,
) -> Iterator[Widget]:
    """How dense, how white and how far forwards a medium or a volume is; `top`: its most density.

    Of a grid the extinction is that of the densest voxel: what density 1 is depends on the file.
    """
    # The largest channel is the slider; a change scales all three, or makes grey of nothing.
    largest = max(*of.sigma_t, _LEAST_SIGMA * 1e-6)

    def thicken(sigma: float) -> None:
        even, now = max(of.sigma_t) <= 0.0, sigma / top
        put(replace(of, sigma_t=scaled(of.sigma_t, now / largest) if not even else (now,) * 3))

    def whiten(albedo: Any) -> None:
        put(replace(of, albedo=albedo))

    def point(g: float) -> None:
        put(replace(of, g=(g, g, g)))

    label = f"{head}extinction (1/m)"
    tip = "Of the densest voxel" if getattr(of, "density", None) is not None else ""
    value = largest * top
    yield Widget(f"{name}.sigma", "number", label, value, thicken, *ends, True, tip=tip)
    yield Widget(f"{name}.albedo", "colour", f"{head}albedo", of.albedo, whiten)
    yield Widget(f"{name}.g", "number", f"{head}g, back to forth", of.g[1], point, -0.98, 0.98)


def _slice(state: ViewState, index: int) -> Iterator[Widget]:
    """A plane through a grid in false colours, and which densities are shown and rendered."""
    own, sliced = state.sliced[index], state.sliced_now(index)
    view, top = sliced.view, sliced.top

    def put(**values: Any) -> None:
        state.put_slice(index, replace(view, **values))

    def key(name: str) -> str:
        return f"volume.{index}.slice.{name}"

    # Across another axis the plane lies where most is.
    def turn(axis: Axis) -> None:
        put(axis=axis, share=fullest(own.density, axis))

    yield Widget(key("axis"), "choice", "slice across", view.axis, turn, choices=tuple("xyz"))
    low, high = sliced.span
    yield Widget(
        key("share"),
        "number",
        f"at {view.axis} (m)",
        low + view.share * (high - low),
        lambda at: put(share=(at - low) / (high - low)),
        low,
        high,
    )
    maps = COLOURS
    colour = view.colours
    yield Widget(key("map"), "choice", "colours", colour, lambda v: put(colours=v), choices=maps)
    yield Widget(key("chart"), "chart", "", sliced.chart, tip=_TIP)
    said = caption(sliced, max(state.scene.volumes[index].sigma_t))
    yield Widget(key("caption"), "note", "", said)
    # Densities are shown in the grid's unit and stored as shares of its largest.
    tip = "Densities below are empty; those above are full"
    ends = (0.0, top)
    for name, label, share in ("low", "empty below", view.low), ("high", "full above", view.high):
        change = _share_of(top, name, put)
        yield Widget(key(name), "number", label, share * top, change, *ends, tip=tip, waits=True)


def _share_of(top: float, name: str, put: Callable[..., None]) -> Callable[[Any], None]:
    return lambda density: put(**{name: density / top})
