"""Runs a WGSL library function over arrays, to hold it against its NumPy namesake."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.errors import DeviceError

Evaluate = Callable[..., np.ndarray]

_SCALARS = {"f": "f32", "i": "i32", "u": "u32"}
_DTYPES: dict[str, Any] = {"f": np.float32, "i": np.int32, "u": np.uint32}
_KERNEL = """
//! use {library}
@group(0) @binding(0) var<storage, read> words: array<u32>;
@group(0) @binding(1) var<storage, read_write> results: array<u32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    let i = id.x;
    if (i >= {count}u) {{ return; }}
    let r = {call};
{stores}
}}
"""


def _loaded(kind: str, offset: int, stride: int) -> str:
    return f"bitcast<{_SCALARS[kind]}>(words[i * {stride}u + {offset}u])"


def _argument(shape: tuple[int, ...], kind: str, offset: int, stride: int) -> str:
    """The WGSL expression that reads one argument of row i."""
    if shape == ():
        return _loaded(kind, offset, stride)
    if len(shape) == 1:
        parts = ", ".join(_loaded(kind, offset + k, stride) for k in range(shape[0]))
        return f"vec{shape[0]}{kind}({parts})"
    size = int(np.prod(shape[1:]))
    parts = ", ".join(
        _argument(shape[1:], kind, offset + k * size, stride) for k in range(shape[0])
    )
    return f"array<vec{shape[1]}{kind}, {shape[0]}>({parts})"


# WGSL type -> (what reads its parts off `r`, NumPy's type of a part, shape of a row)
_RETURNS: dict[str, tuple[list[str], Any, tuple[int, ...]]] = {
    "f32": (["r"], np.float32, ()),
    "u32": (["r"], np.uint32, ()),
}
for _n in (2, 3):
    _columns = [f"r[{c}].{k}" for c in range(_n) for k in "xyz"]
    _RETURNS[f"mat{_n}x3f"] = (_columns, np.float32, (_n, 3))
for _n in (2, 3, 4):
    for _kind, _dtype in _DTYPES.items():
        _RETURNS[f"vec{_n}{_kind}"] = ([f"r.{k}" for k in "xyzw"[:_n]], _dtype, (_n,))


def _kernel(library: str, name: str, args: list[np.ndarray], parts: list[str]) -> str:
    sizes = [int(np.prod(a.shape[1:])) for a in args]
    offsets = np.concatenate([[0], np.cumsum(sizes)]).tolist()
    call = ", ".join(
        _argument(a.shape[1:], a.dtype.kind, o, offsets[-1])
        for a, o in zip(args, offsets, strict=False)
    )
    stores = "\n".join(
        f"    results[i * {len(parts)}u + {k}u] = bitcast<u32>({part});"
        for k, part in enumerate(parts)
    )
    return _KERNEL.format(
        library=library, count=len(args[0]), call=f"{name}({call})", stores=stores
    )


@pytest.fixture(scope="session")
def wgsl() -> Evaluate:
    """wgsl("phase", "henyey_greenstein", mu, g, returns="f32") -> array, one row per invocation.

    Arguments are arrays of equal first length (or numbers): float becomes f32, int i32, uint u32;
    a second axis of 2 to 4 a vector, a third an array of vectors.
    """
    from airlight.gpu.device import open_gpu

    try:
        gpu = open_gpu()
    except DeviceError as error:
        pytest.skip(f"no graphics device: {error}")

    def evaluate(library: str, name: str, *values: Any, returns: str = "f32") -> np.ndarray:
        count = max(np.asarray(v).shape[0] if np.ndim(v) else 1 for v in values)
        args = [np.asarray(v) if np.ndim(v) else np.full(count, v) for v in values]
        args = [a.astype(_DTYPES[a.dtype.kind]) for a in args]
        packed = np.concatenate([a.reshape(count, -1).view(np.uint32) for a in args], axis=1)
        parts, dtype, row = _RETURNS[returns]
        kernel = _kernel(library, name, args, parts)
        words = _run(gpu, name, kernel, packed, count * len(parts))
        return np.asarray(words.view(dtype).reshape(count, *row))

    return evaluate


def _run(gpu: Any, name: str, kernel: str, packed: np.ndarray, result_words: int) -> np.ndarray:
    """The u32 words that `kernel` writes for the words it is given."""
    from airlight.gpu.memory import Buffer, buffer_of
    from airlight.gpu.source import Source, compile_wgsl

    source = Source()
    source.add(kernel, f"twin of {name}")
    given, result = buffer_of(gpu, "words", packed), Buffer(gpu, "results", 4 * result_words)
    module = compile_wgsl(gpu.device, source, name)
    pipeline = gpu.device.create_compute_pipeline(
        layout="auto", compute={"module": module, "entry_point": "main"}
    )
    entries = [{"binding": k, "resource": b.resource} for k, b in enumerate((given, result))]
    layout = pipeline.get_bind_group_layout(0)
    group = gpu.device.create_bind_group(layout=layout, entries=entries)
    encoder = gpu.device.create_command_encoder()
    step = encoder.begin_compute_pass()
    step.set_pipeline(pipeline)
    step.set_bind_group(0, group)
    step.dispatch_workgroups(-(-len(packed) // 64))
    step.end()
    gpu.queue.submit([encoder.finish()])
    words = result.read(np.uint32)[:result_words].copy()
    given.release()
    result.release()
    return np.asarray(words)
