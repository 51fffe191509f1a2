"""What is asked of a device: optional features, and limits above WebGPU's defaults.

Limits that nobody names would be the adapter's own, and code that needs more than another adapter
has would be noticed there only. So every limit is named: WebGPU's default, which all adapters have,
or the one in `_MORE`, as far as the adapter has it. Code that can do without asks `Gpu.limits` and
`Gpu.features`; with AIRLIGHT_LIMITS=default there is nothing but the defaults.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Literal, cast

from .. import env
from ..errors import SettingsError
from .code_paths import CodePaths

Asked = Literal["auto", "default"]
SWITCH = "AIRLIGHT_LIMITS"
_KNOWN = ("auto", "default")

FEATURES = (
    "float32-blendable",
    "timestamp-query",
    "subgroup",
    "shader-int64",
)
DEFAULT_LIMITS: Mapping[str, int] = {  # of the WebGPU specification, "Limits"
    "max-texture-dimension-1d": 8192,
    "max-texture-dimension-2d": 8192,
    "max-texture-dimension-3d": 2048,
    "max-texture-array-layers": 256,
    "max-bind-groups": 4,
    "max-bindings-per-bind-group": 1000,
    "max-dynamic-uniform-buffers-per-pipeline-layout": 8,
    "max-dynamic-storage-buffers-per-pipeline-layout": 4,
    "max-sampled-textures-per-shader-stage": 16,
    "max-samplers-per-shader-stage": 16,
    "max-storage-buffers-per-shader-stage": 8,
    "max-storage-textures-per-shader-stage": 4,
    "max-uniform-buffers-per-shader-stage": 12,
    "max-uniform-buffer-binding-size": 1 << 16,
    "max-storage-buffer-binding-size": 1 << 27,
    "max-vertex-buffers": 8,
    "max-buffer-size": 1 << 28,
    "max-vertex-attributes": 16,
    "max-vertex-buffer-array-stride": 2048,
    "max-inter-stage-shader-variables": 16,
    "max-color-attachments": 8,
    "max-color-attachment-bytes-per-sample": 32,
    "max-compute-workgroup-storage-size": 1 << 14,
    "max-compute-invocations-per-workgroup": 256,
    "max-compute-workgroup-size-x": 256,
    "max-compute-workgroup-size-y": 256,
    "max-compute-workgroup-size-z": 64,
    "max-compute-workgroups-per-dimension": 65535,
}
_MORE: Mapping[str, int] = {  # asked for where there is so much, used where it helps
    "max-texture-dimension-2d": 16384,
    "max-texture-array-layers": 2048,
    "max-sampled-textures-per-shader-stage": 48,
    "max-storage-buffer-binding-size": 1 << 30,
    "max-buffer-size": 1 << 30,
    "max-color-attachment-bytes-per-sample": 80,
    "max-storage-textures-per-shader-stage": 6,
    "max-storage-buffers-per-shader-stage": 10,
}
_UNIFORMS_IN_STORAGE: Mapping[str, int] = {  # see slots.on_cpu_adapter
    "max-storage-buffers-per-shader-stage": 18,
    "max-dynamic-storage-buffers-per-pipeline-layout": 8,
}
_INTERPOLATED: Mapping[str, int] = {  # what a triangle brings to its pixels, see interpolants.py
    "max-inter-stage-shader-variables": 31,
}


def chosen_asked(wanted: str | None = None) -> Asked:
    """What `wanted` asks for: auto or default; AIRLIGHT_LIMITS if None.

    Raises SettingsError for another word.
    """
    # A word of the caller's, or the environment's.
    text = env.value(SWITCH) if wanted is None else wanted
    if text.lower() not in _KNOWN:
        raise SettingsError(
            f"there are no limits '{text}'",
            where=SWITCH if wanted is None else "asked",
            remedy="Use auto (what makes it faster) or default (WebGPU's, without any feature)",
        )
    return cast(Asked, text.lower())


def asked_features(asked: Asked, there: Collection[str]) -> list[str]:
    """The optional features to request from an adapter that has those in `there`."""
    return [] if asked == "default" else [f for f in FEATURES if f in there]


def asked_limits(asked: Asked, paths: CodePaths, there: Mapping[str, int]) -> dict[str, int]:
    """The limits to request from an adapter that has those in `there`."""
    # WebGPU's defaults, raised where code paths make use of more, as far as the adapter goes.
    more: dict[str, int] = {} if asked == "default" else {**_MORE}
    if more and paths.stored_uniforms:
        more |= _UNIFORMS_IN_STORAGE
    if more and paths.flat_interpolants:
        more |= _INTERPOLATED
    wanted = {**DEFAULT_LIMITS, **more}
    return {name: min(value, there[name]) for name, value in wanted.items() if name in there}


def has_uniforms_in_storage(limits: Mapping[str, int]) -> bool:
    """Whether a device of these limits can bind every pass's parameters as storage buffers."""
    return all(limits[name] >= value for name, value in _UNIFORMS_IN_STORAGE.items())
