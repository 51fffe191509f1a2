"""Everything that is done otherwise on CPU adapters than on GPUs, each with a name of its own.

A CPU adapter runs invocations as lanes of vectors, reads slowly, and shades blocks of pixels for
each triangle; a GPU has thousands of threads and caches. `CodePaths` lists what follows from that:
whoever has two ways asks one of its fields (`gpu.paths`), so that a search for a field's name finds
all that it selects, and nothing else depends on the kind of adapter. AIRLIGHT_PATHS turns all of
them on or off at once, so that both kinds can be run, and held to each other, on one adapter. What
is true of the adapter itself (that its timestamps mean nothing, that a viewer has to be coarse
while it moves) asks `AdapterInfo.is_cpu`.

Each field earns its place: without it, a frame that people draw takes a tenth more processor time
on a CPU adapter, or memory grows (docs/decisions.md has the table).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .. import env
from ..errors import SettingsError

Paths = Literal["gpu", "cpu"]
SWITCH = "AIRLIGHT_PATHS"
_KNOWN = ("auto", "gpu", "cpu")


@dataclass(frozen=True)
class CodePaths:
    """What a device does, each as far as its features and limits allow.

    row_lanes            kernels of both stencils whose lanes share rows of cells: `gpu.lanes`,
                         `lpv/propagate_rows.wgsl`, `scatter/propagate_rows.wgsl`
    visibility_buffer    triangle ids first, then each pixel's surface once, of maps in one buffer:
                         `surface.visibility_buffer`, `packed_maps`, `triangle_table`, `provoking`
    stored_screens       full-screen passes are compute passes that store: `gpu.stored`
    flat_interpolants    full-screen triangles interpolate uniforms, flat: `gpu.interpolants`
    stored_uniforms      uniforms are bound as storage buffers: `gpu.slots`
    listed_gloss         glossy pixels are listed and traced apart: `lighting.glossy_pixels`
    occlusion_samples    slices of the hemisphere of screen-space occlusion, and steps on each side
                         of one: `lighting.occlusion`
    uploaded_at_once     bytes that are handed over at once; before the next part the host submits,
                         and so waits, on CPU adapters, until all before it is done: `gpu.memory`
    """

    name: Paths
    row_lanes: bool
    visibility_buffer: bool
    stored_screens: bool
    flat_interpolants: bool
    stored_uniforms: bool
    listed_gloss: bool
    occlusion_samples: tuple[int, int]
    uploaded_at_once: int


GPU_PATHS = CodePaths(
    "gpu",
    row_lanes=False,
    visibility_buffer=False,
    stored_screens=True,
    flat_interpolants=False,
    stored_uniforms=False,
    listed_gloss=False,
    occlusion_samples=(3, 6),
    uploaded_at_once=8 << 20,
)
CPU_PATHS = CodePaths(
    "cpu",
    row_lanes=True,
    visibility_buffer=True,
    stored_screens=False,
    flat_interpolants=True,
    stored_uniforms=True,
    listed_gloss=True,
    occlusion_samples=(2, 4),
    uploaded_at_once=64 << 20,  # copied in some 25 ms
)


def chosen_paths(wanted: str | None = None, *, is_cpu: bool) -> CodePaths:
    """The code paths for `wanted` (auto, gpu or cpu; AIRLIGHT_PATHS if None) on an adapter.

    auto: those made for the adapter, by whether it `is_cpu`. Raises SettingsError for another word.
    """
    # A word of the caller's, or the environment's.
    text = env.value(SWITCH) if wanted is None else wanted
    key = text.lower()
    if key not in _KNOWN:
        raise SettingsError(
            f"there are no paths '{text}'",
            where=SWITCH if wanted is None else "paths",
            remedy="Use auto (those made for the adapter), gpu or cpu",
        )
    if key == "auto":
        return CPU_PATHS if is_cpu else GPU_PATHS
    return CPU_PATHS if key == "cpu" else GPU_PATHS
