"""What a shader binds, declared once: the bind-group layout and the WGSL declaration."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import wgpu

from .device import Gpu
from .layout import Struct

FILTERED = "rgba16float"
"""The format of images of light that shaders filter: half floats, which all devices filter."""
Dimension = Literal["2d", "2d-array", "3d", "cube"]


@dataclass(frozen=True)
class Slot:
    """One binding: its name, what the layout says and what the WGSL says."""

    name: str
    declaration: str
    layout: dict[str, Any]
    struct: type[Struct] | None = None
    is_dynamic: bool = False
    formats: frozenset[str] = field(default_factory=frozenset)

    @property
    def first(self) -> str:
        """WGSL of the first of a slot's structs: of a storage buffer, or of a `rows.table`."""
        return f"row_of_{self.name}(0u)" if "texture" in self.layout else f"{self.name}[0]"


def uniform(name: str, struct: type[Struct]) -> Slot:
    """Parameters, written per dispatch into the frame's uniform arena."""
    return Slot(
        name,
        f"var<uniform> {name}: {struct.__name__};",
        {
            "buffer": {
                "type": "uniform",
                "has_dynamic_offset": True,
                "min_binding_size": struct.dtype.itemsize,
            }
        },
        struct=struct,
        is_dynamic=True,
    )


def on_device(slots: tuple[Slot, ...], gpu: Gpu) -> tuple[Slot, ...]:
    """The same slots for a device: buffers and uniforms as it reads them."""
    # CPU adapters read uniforms from storage.
    return on_cpu_adapter(slots) if gpu.has_uniforms_in_storage else slots


def on_cpu_adapter(slots: tuple[Slot, ...]) -> tuple[Slot, ...]:
    """The same slots for a CPU adapter, their uniforms read-only storage.

    Mesa's lavapipe clones a shader that branches on uniforms at every dispatch, to inline their
    values, and keeps the clones (4 MB an image): storage buffers it leaves alone.
    """
    return tuple(_from_storage(slot) if slot.is_dynamic else slot for slot in slots)


def _from_storage(slot: Slot) -> Slot:
    # The same parameters under another kind of buffer.
    buffer = {**slot.layout["buffer"], "type": "read-only-storage"}
    declaration = slot.declaration.replace("var<uniform>", "var<storage, read>")
    return replace(slot, declaration=declaration, layout={**slot.layout, "buffer": buffer})


def storage(
    name: str, element: str | type[Struct], access: Literal["read", "read_write"] = "read"
) -> Slot:
    """A storage buffer: a run of `element`s (a WGSL type, or a Struct)."""
    kind = "read-only-storage" if access == "read" else "storage"
    struct = None if isinstance(element, str) else element
    text = element if isinstance(element, str) else element.__name__
    return Slot(
        name,
        f"var<storage, {access}> {name}: array<{text}>;",
        {"buffer": {"type": kind}},
        struct=struct,
    )


_SAMPLE_WGSL = {"float": "f32", "unfilterable-float": "f32", "uint": "u32", "sint": "i32"}


def texture(name: str, dimension: Dimension = "2d", sample: str = "float") -> Slot:
    """A sampled texture; `sample` is float, unfilterable-float, depth, uint or sint."""
    # Depth textures have types of their own in WGSL.
    wgsl_dimension = dimension.replace("-", "_")
    if sample == "depth":
        declaration = f"var {name}: texture_depth_{wgsl_dimension};"
    else:
        declaration = f"var {name}: texture_{wgsl_dimension}<{_SAMPLE_WGSL[sample]}>;"
    layout = {"texture": {"sample_type": sample, "view_dimension": dimension}}
    return Slot(name, declaration, layout)


def sampler(name: str, kind: str = "filtering") -> Slot:
    """A sampler; `kind` is filtering, non-filtering or comparison."""
    wgsl = "sampler_comparison" if kind == "comparison" else "sampler"
    return Slot(name, f"var {name}: {wgsl};", {"sampler": {"type": kind}})


def image(name: str, format: str, dimension: Dimension = "2d") -> Slot:
    """A storage texture that is written."""
    wgsl_dimension = dimension.replace("-", "_")
    return Slot(
        name,
        f"var {name}: texture_storage_{wgsl_dimension}<{format}, write>;",
        {
            "storage_texture": {
                "access": "write-only",
                "format": format,
                "view_dimension": dimension,
            }
        },
    )


def declarations(slots: tuple[Slot, ...], group: int = 0) -> str:
    """The WGSL of all structs and bindings of one bind group."""
    # A struct that several slots have is declared once.
    structs: dict[str, str] = {}
    for slot in slots:
        if slot.struct is not None:
            structs[slot.struct.__name__] = slot.struct.wgsl
    lines = [
        f"@group({group}) @binding({index}) {slot.declaration}" for index, slot in enumerate(slots)
    ]
    return "".join(structs.values()) + "\n".join(lines) + "\n"


def bind_group_layout(device: Any, slots: tuple[Slot, ...], *, compute: bool, label: str) -> Any:
    """The WebGPU layout of `slots`."""
    # WebGPU forbids writes from vertex shaders; whatever else is bound may be read from both.
    stages = (
        wgpu.ShaderStage.COMPUTE if compute else wgpu.ShaderStage.VERTEX | wgpu.ShaderStage.FRAGMENT
    )
    entries = []
    for index, slot in enumerate(slots):
        writes = "storage_texture" in slot.layout or (
            slot.layout.get("buffer", {}).get("type") == "storage"
        )
        visible = wgpu.ShaderStage.FRAGMENT if writes and not compute else stages
        entries.append({"binding": index, "visibility": visible, **slot.layout})
    return device.create_bind_group_layout(label=label, entries=entries)
