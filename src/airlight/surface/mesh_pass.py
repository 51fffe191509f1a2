"""The base of every pass over the scene's meshes: one pipeline per kind of material."""

from __future__ import annotations

from typing import Any, ClassVar

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.raster import RasterPipeline
from ..gpu.slots import Slot, sampler, storage, texture
from .geometry import Draw, GpuScene, InstanceData, MaterialData

MESH_SLOTS: tuple[Slot, ...] = (
    storage("instances", InstanceData), storage("materials", MaterialData)
)  # fmt: skip
MATERIAL_SLOTS: tuple[Slot, ...] = tuple(
    slot
    for name in ("base_color", "metallic_roughness", "normal", "emission")
    for slot in (texture(f"{name}_map"), sampler(f"{name}_sampler"))
)
VERTEX_BUFFERS: tuple[dict[str, Any], ...] = (
    {"array_stride": 12, "step_mode": "vertex", "attributes": [
        {"shader_location": 0, "offset": 0, "format": "float32x3"}]},
    {"array_stride": 24, "step_mode": "vertex", "attributes": [
        {"shader_location": 1, "offset": 0, "format": "snorm16x4"},
        {"shader_location": 2, "offset": 8, "format": "float32x2"},
        {"shader_location": 3, "offset": 16, "format": "float16x4"}]},
)  # fmt: skip


class MeshPipeline(RasterPipeline):
    """Subclass it with `slots` (its uniform first, then MESH_SLOTS), targets and depth.

    `fragment` is the entry point for opaque materials; cut-out ones set the override
    `IS_CUTOUT`, which discards by alpha.
    """

    second_slots = MATERIAL_SLOTS
    vertex_buffers = VERTEX_BUFFERS
    depth = "depth32float"
    opaque_fragment: ClassVar[str] = "fragment"

    def __init__(self, gpu: Gpu, *, is_cutout: bool, cull: str) -> None:
        self.fragment_entry = "fragment" if is_cutout else self.opaque_fragment  # type: ignore[misc]
        super().__init__(gpu, constants={"IS_CUTOUT": int(is_cutout)}, cull=cull)


class MeshPass:
    """The up to four pipelines (cut-out or not, two-sided or not) of one `MeshPipeline`."""

    def __init__(self, gpu: Gpu, kind: type[MeshPipeline]) -> None:
        self.gpu, self.kind = gpu, kind
        self._pipelines: dict[tuple[bool, bool], MeshPipeline] = {}

    def draw(
        self, commands: Commands, encoder: Any, scene: GpuScene, draws: list[Draw], params: Any
    ) -> None:
        """Draw into an open render pass; `params` is the pass's uniform."""
        encoder.set_vertex_buffer(0, scene.positions.handle)
        encoder.set_vertex_buffer(1, scene.vertices.handle)
        encoder.set_index_buffer(scene.indices.handle, "uint32")
        shared = {"params": params, "instances": scene.instances, "materials": scene.materials}
        active: MeshPipeline | None = None
        textures: Any = None
        for draw in draws:
            pipeline = self._pipeline(draw)
            if pipeline is not active:
                encoder.set_pipeline(pipeline.pipeline)
                pipeline.bindings.bind(commands, encoder, 0, shared)
                active, textures = pipeline, None
            if draw.textures is not textures and pipeline.second is not None:
                pipeline.second.bind(commands, encoder, 1, draw.textures)
                textures = draw.textures
            encoder.draw_indexed(
                draw.index_count,
                draw.instance_count,
                draw.first_index,
                draw.base_vertex,
                draw.first_instance,
            )

    def _pipeline(self, draw: Draw) -> MeshPipeline:
        key = (draw.material.alpha_cutoff > 0.0, draw.material.two_sided)
        if key not in self._pipelines:
            cull = "none" if key[1] else "back"
            self._pipelines[key] = self.kind(self.gpu, is_cutout=key[0], cull=cull)
        return self._pipelines[key]
