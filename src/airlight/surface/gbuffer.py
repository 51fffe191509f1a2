"""What the camera sees: depth, base colour, normal, emission and the material's parameters."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, mat4x4f
from ..gpu.memory import Texture
from ..gpu.slots import uniform
from ..maths.transforms import F64
from .geometry import GpuScene
from .mesh_pass import MESH_SLOTS, MeshPass, MeshPipeline


class CameraParams(Struct):
    """Where the camera is."""

    clip_from_world = mat4x4f()


class _GBufferPipeline(MeshPipeline):
    slots = (uniform("params", CameraParams), *MESH_SLOTS)
    targets = ("rgba16float", "rgba16float", "rgba16float")
    file = "gbuffer.wgsl"


class GBuffer:
    """Textures of the size of the picture: reversed infinite depth, 0 where nothing is.

    albedo   rgb base colour, a metallic
    normal   xyz world, facing the camera; w roughness
    emission rgb W m^-2 sr^-1, a specular
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self.gpu, self._pass = gpu, MeshPass(gpu, _GBufferPipeline)
        self._make_textures(size)

    def _make_textures(self, size: tuple[int, int]) -> None:
        self.size, gpu = size, self.gpu
        self.depth = Texture(gpu, "depth", size, "depth32float", target=True)
        self.albedo = Texture(gpu, "albedo", size, "rgba16float", target=True)
        self.normal = Texture(gpu, "normal", size, "rgba16float", target=True)
        self.emission = Texture(gpu, "emission", size, "rgba16float", target=True)

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels."""
        self.release()
        self._make_textures(size)

    def encode(self, commands: Commands, scene: GpuScene, clip_from_world: F64) -> None:
        """Rasterise the scene as seen through `clip_from_world`."""
        colors = [
            {"view": t.resource, "load_op": "clear", "store_op": "store",
             "clear_value": (0, 0, 0, 0)}
            for t in (self.albedo, self.normal, self.emission)
        ]  # fmt: skip
        depth = {"view": self.depth.resource, "depth_load_op": "clear",
                 "depth_store_op": "store", "depth_clear_value": 0.0}  # fmt: skip
        with commands.render(
            "g-buffer", color_attachments=colors, depth_stencil_attachment=depth
        ) as encoder:
            self._pass.draw(
                commands,
                encoder,
                scene,
                scene.visible(clip_from_world),
                CameraParams(clip_from_world=clip_from_world),
            )

    def release(self) -> None:
        """Give the memory back."""
        for texture in (self.depth, self.albedo, self.normal, self.emission):
            texture.release()
