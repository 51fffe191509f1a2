"""The base of every pass over the scene's meshes: one pipeline per kind of material."""

from __future__ import annotations

from typing import Any, ClassVar

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, mat4x4f
from ..gpu.memory import Buffer
from ..gpu.raster import RasterPipeline
from ..gpu.slots import Slot, sampler, storage, texture
from .draws import MAPS, Draw
from .geometry import GpuScene
from .instances import InstanceData
from .materials import MaterialData

MESH_SLOTS: tuple[Slot, ...] = (storage("materials", MaterialData),)
MATERIAL_SLOTS: tuple[Slot, ...] = tuple(
    slot for name in MAPS for slot in (texture(f"{name}_map"), sampler(f"{name}_sampler"))
)


def _of_instances(fields: dict[str, tuple[str, int, int]]) -> dict[str, Any]:
    """A vertex buffer layout of `InstanceData`.

    `fields` by name: vertex format, number of columns, location of the first.
    """
    # A matrix is as many attributes as it has columns, 16 bytes each.
    offsets: Any = InstanceData.dtype.fields
    attributes = [
        {"shader_location": location + i, "offset": offsets[name][1] + 16 * i, "format": form}
        for name, (form, columns, location) in fields.items()
        for i in range(columns)
    ]
    return {
        "array_stride": InstanceData.dtype.itemsize,
        "step_mode": "instance",
        "attributes": attributes,
    }


_TRANSFORM = {"world_from_object": ("float32x4", 4, 4)}
VERTEX_BUFFERS: tuple[dict[str, Any], ...] = (
    {
        "array_stride": 12,
        "step_mode": "vertex",
        "attributes": [{"shader_location": 0, "offset": 0, "format": "float32x3"}],
    },
    {
        "array_stride": 24,
        "step_mode": "vertex",
        "attributes": [
            {"shader_location": 1, "offset": 0, "format": "snorm16x4"},
            {"shader_location": 2, "offset": 8, "format": "float32x2"},
            {"shader_location": 3, "offset": 16, "format": "float16x4"},
        ],
    },
    _of_instances(
        {
            **_TRANSFORM,
            "normal_from_object": ("float32x3", 3, 8),
            "material": ("uint32", 1, 11),
            "size": ("float32", 1, 12),
        }
    ),
)
INSTANCE_TRANSFORMS = _of_instances(_TRANSFORM)
_RECORDED = 64  # views whose recorded draws are cached


_VERTEX = """
//! use mesh_vertex
@vertex fn vertex(in: VertexIn, at: InstanceTransform) -> VertexOut {
    return transformed_vertex(in, at, params.clip_from_world);
}
"""


class ViewParams(Struct):
    """The view that is drawn, of passes that ask for nothing else."""

    clip_from_world = mat4x4f()


class MeshPipeline(RasterPipeline):
    """One pipeline of a pass; subclasses give `slots` (the uniform first), targets, depth.

    `maps` are those that the shader reads. Materials with holes, and translucent ones, set the
    override `IS_CUTOUT`, which discards where `is_hole` of `wgsl/mesh.wgsl` says so.
    """

    second_slots = MATERIAL_SLOTS
    vertex_buffers = VERTEX_BUFFERS
    vertices: ClassVar[str] = _VERTEX  # WGSL; empty where the file has its own
    depth = "depth32float"
    maps: ClassVar[tuple[str, ...]] = MAPS

    def __init__(
        self,
        gpu: Gpu,
        *,
        is_cutout: bool,
        cull: str,
        maps: frozenset[str],
        front_face: str,
        has_map_transform: bool,
    ) -> None:
        # The shader's overrides: which maps there are, if they are transformed, if there are holes.
        constants = {f"HAS_{name.upper()}_MAP": float(name in maps) for name in self.maps}
        if self.maps:
            constants["HAS_MAP_TRANSFORM"] = float(has_map_transform)
        if self.second_slots:
            constants["IS_CUTOUT"] = float(is_cutout)
        super().__init__(
            gpu, constants=constants, cull=cull, front_face=front_face, generated=self.vertices
        )
        self._groups: dict[int, tuple[Any, Any]] = {}

    def vertices_of(self, scene: GpuScene) -> tuple[Buffer, ...]:
        """The buffers of `vertex_buffers`, in their order."""
        return (scene.vertices.positions, scene.vertices.vertices, scene.instances)

    def indices_of(self, scene: GpuScene) -> Buffer:
        """The index buffer."""
        return scene.vertices.indices

    def bind_textures(self, commands: Commands, encoder: Any, draw: Draw) -> None:
        """Set the material's bind group; each set of textures has one."""
        if self.second is None:
            return

        # Found by identity: the textures are stored beside, so that no others get their id.
        found = self._groups.get(id(draw.textures))
        if found is None:
            group = self.second.make(draw.textures.bound, commands.arena)
            found = self._groups[id(draw.textures)] = (group, draw.textures)
        encoder.set_bind_group(1, found[0])


class DepthPipeline(MeshPipeline):
    """Depth of opaque materials; subclasses give `slots`, the first called `params`."""

    second_slots = ()
    vertex_buffers = (VERTEX_BUFFERS[0], INSTANCE_TRANSFORMS)
    vertices = ""
    fragment_entry = ""
    maps = ()
    file = "shadow_opaque.wgsl"

    def vertices_of(self, scene: GpuScene) -> tuple[Buffer, ...]:
        """Positions and instances alone."""
        return (scene.vertices.positions, scene.instances)


class MeshPass:
    """The pipelines of one kind of pass: one per variant of its shader that materials need.

    `opaque`: a simpler pipeline for materials that are whole. `culls`: whether it looks through
    culled backs, as cameras do; lights meet them, but for those that let light out.
    """

    def __init__(
        self,
        gpu: Gpu,
        kind: type[MeshPipeline],
        *,
        opaque: type[MeshPipeline] | None = None,
        culls: bool = False,
    ) -> None:
        self.gpu, self.kind, self.opaque, self._culls = gpu, kind, opaque or kind, culls
        self._pipelines: dict[tuple[Any, ...], MeshPipeline] = {}
        self._recorded: dict[tuple[int, ...], tuple[Any, tuple[Any, ...]]] = {}

    def draw(
        self,
        commands: Commands,
        encoder: Any,
        scene: GpuScene,
        draws: list[Draw],
        params: Any,
        **bound: Any,
    ) -> None:
        """Draw into an open render pass; `params` is the uniform, `bound` further slots.

        The second time that the same list `draws` comes with the same resources, the draws are
        recorded; from then on the recording is replayed.
        """
        if not draws:
            return
        if commands.tally is not None:
            self._count(commands, scene, draws)
        shared = {"params": params, "materials": scene.materials, **bound}
        # What is in the key by its id is stored beside it, so that nothing else gets that id.
        kept = (draws, commands, scene.instances, *bound.values())
        key = (commands.put(params), scene.replaced, *map(id, kept))

        # The first time: encoded as it is, and remembered in place of the oldest.
        if key not in self._recorded:
            if len(self._recorded) >= _RECORDED:
                self._recorded.pop(next(iter(self._recorded)))
            self._recorded[key] = (None, kept)
            self._encode(commands, encoder, scene, draws, shared)
            return
        # The second time: recorded as a bundle, whose replay costs no Python for each draw.
        bundle = self._recorded[key][0]
        if bundle is None:
            recorder = self.gpu.device.create_render_bundle_encoder(
                label=self.kind.__name__,
                color_formats=list(self.kind.targets),
                depth_stencil_format=self.kind.depth,
            )
            self._encode(commands, recorder, scene, draws, shared)
            self.gpu.check_alive()  # wgpu-native ends the process where a lost device finishes one
            bundle = recorder.finish(label=self.kind.__name__)
            self._recorded[key] = (bundle, kept)
        encoder.execute_bundles([bundle])

    def _encode(
        self,
        commands: Commands,
        encoder: Any,
        scene: GpuScene,
        draws: list[Draw],
        shared: dict[str, Any],
    ) -> None:
        """Encode the draws into a render pass, or into a recording."""
        active: MeshPipeline | None = None
        textures: Any = None
        # Pipelines and textures are set where they change.
        for draw in draws:
            pipeline = self._pipeline(draw)
            if pipeline is not active:
                encoder.set_pipeline(pipeline.pipeline)
                encoder.set_index_buffer(pipeline.indices_of(scene).handle, "uint32")
                for slot, buffer in enumerate(pipeline.vertices_of(scene)):
                    encoder.set_vertex_buffer(slot, buffer.handle)
                pipeline.bindings.bind(commands, encoder, 0, shared)
                active, textures = pipeline, None
            if draw.textures is not textures:
                pipeline.bind_textures(commands, encoder, draw)
                textures = draw.textures
            encoder.draw_indexed(
                draw.index_count,
                draw.instance_count,
                draw.first_index,
                draw.base_vertex,
                draw.first_instance,
            )

    def _count(self, commands: Commands, scene: GpuScene, draws: list[Draw]) -> None:
        """Count vertices and the buffers that they read, for the tally of a stage."""
        # Each pipeline's buffers count once, vertices as often as they are drawn.
        assert commands.tally is not None
        read: list[Buffer] = []
        for pipeline in {id(p): p for p in map(self._pipeline, draws)}.values():
            read += (*pipeline.vertices_of(scene), pipeline.indices_of(scene))
        commands.tally.bound(commands.stage_name, read)
        vertices = sum(draw.index_count * draw.instance_count for draw in draws)
        commands.tally.ran(commands.stage_name, vertices)

    def _pipeline(self, draw: Draw) -> MeshPipeline:
        # What a pipeline depends on.
        is_cutout = draw.material.alpha_cutoff > 0.0 or draw.material.is_translucent
        m = draw.material
        is_culled = m.is_culled if self._culls else m.lets_light_out
        kind = self.kind if is_cutout else self.opaque
        maps = draw.maps & frozenset(kind.maps)
        has_map_transform = draw.has_map_transform and bool(maps)
        # A pipeline for each kind of draw, made when one comes first.
        key = (is_cutout, is_culled, draw.is_mirrored, maps, has_map_transform)
        if key not in self._pipelines:
            # Mirrored meshes wind the other way.
            cull = "back" if is_culled else "none"
            self._pipelines[key] = kind(
                self.gpu,
                is_cutout=is_cutout,
                cull=cull,
                maps=maps,
                has_map_transform=has_map_transform,
                front_face="cw" if draw.is_mirrored else "ccw",
            )
        return self._pipelines[key]
