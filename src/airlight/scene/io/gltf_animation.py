"""The animations of a glTF file as clips (specification, section 3.11)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...errors import SceneError
from ..animation.curve import Curve
from ..animation.rig import Clip
from ..checks import F64
from .gltf_buffers import Buffers
from .gltf_json import Item

_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}
_BETWEEN = {"LINEAR": "linear", "STEP": "step", "CUBICSPLINE": "cubic"}


def read_clips(
    document: Item, buffers: Buffers, targets: Mapping[int, int], warnings: list[str]
) -> tuple[Clip, ...]:
    """All animations that move something; `targets` is the number of morph targets by node.

    Raises SceneError.
    """
    nodes = document.items("nodes")
    clips = []
    for number, item in enumerate(document.items("animations"), start=1):
        channels: dict[tuple[int, str], Curve] = {}
        weights: dict[int, Curve] = {}
        samplers = item.items("samplers")
        # Channels move nodes, or the weights of their morph targets.
        for channel in item.items("channels"):
            target = channel.child("target")
            # An extension may have a target of its own, without a node.
            if not target.has("node"):
                continue
            node, path = target.index("node", nodes, "nodes"), target.text("path")
            sampler = samplers[channel.index("sampler", samplers, "samplers")]
            if path in _WIDTHS:
                channels[node, path] = _curve(sampler, buffers, path)
            elif path == "weights" and targets.get(node):
                weights[node] = _curve(sampler, buffers, path, targets[node])
            elif path != "weights":
                warnings.append(f"{document.file}: {target.place}: '{path}' is not animated")
        if channels or weights:
            clips.append(Clip(item.text("name") or f"animation {number}", channels, weights))
    return tuple(clips)


def _curve(sampler: Item, buffers: Buffers, path: str, targets: int = 0) -> Curve:
    kind = sampler.text("interpolation", "LINEAR")
    if kind not in _BETWEEN:
        raise sampler.error(f"has the unknown interpolation '{kind}'")
    # Each key has a value for each morph target, and cubic ones a tangent before and after it.
    width = 1 if path == "weights" else _WIDTHS[path]
    times = buffers.array(sampler, "input", width=1)[:, 0].astype(np.float64)
    values = buffers.array(sampler, "output", width=width).astype(np.float64)
    per_key = (3 if kind == "CUBICSPLINE" else 1) * (targets if path == "weights" else 1)
    if len(values) != len(times) * per_key:
        raise sampler.error(f"has {len(values)} values for {len(times)} keyframes")
    return _checked(sampler, kind, path, times, values)


def _checked(sampler: Item, kind: str, path: str, times: F64, values: F64) -> Curve:
    between = _BETWEEN[kind]
    # Axes: keys, (tangent, value, tangent) of cubic ones, components.
    shape = (len(times), 3, -1) if kind == "CUBICSPLINE" else (len(times), -1)
    values = values.reshape(shape)
    # Quaternions turn along the sphere; cubic ones are normalised after blending, as their tangents
    # are no rotations.
    if path == "rotation":
        between = {"linear": "slerp", "cubic": "cubic-rotation"}.get(between, between)
        if kind != "CUBICSPLINE":
            length = np.linalg.norm(values, axis=1, keepdims=True)
            still = np.array([0.0, 0.0, 0.0, 1.0])
            values = np.where(length > 0.0, values / np.maximum(length, 1e-30), still)
    try:
        return Curve(times, values, between)
    except SceneError as error:
        raise sampler.error(error.problem) from None
