"""The G-buffer of translucent surfaces, peeled a layer at a time from the eye (Everitt2001).

Of each pixel a layer has the nearest translucent surface behind that of the layer before, as far as
the first solid surface.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ..gpu.memory import Texture
from ..gpu.raster import color_attachments, depth_attachment
from ..gpu.slots import texture, uniform
from ..maths.transforms import F64
from .gbuffer import GBuffer
from .geometry import GpuScene
from .mesh_pass import MESH_SLOTS, MeshPass, MeshPipeline


class PeelParams(Struct):
    """The camera, and whether there is a layer before."""

    clip_from_world = mat4x4f()
    eye = vec3f("m")
    is_first = u32()
    unlit_radiance = f32("W m^-2 sr^-1")


class _Layer(MeshPipeline):
    slots = (
        uniform("params", PeelParams),
        texture("before", "2d", "depth"),
        texture("solid", "2d", "depth"),
        *MESH_SLOTS,
    )
    depth_compare = "greater-equal"
    targets = ("rgba16float", "rgba16float", "rgba16float", "rgba16float")
    file = "peeled.wgsl"


class PeeledGBuffer(GBuffer):
    """One layer, as a G-buffer: what of each surface is there, and what it takes away.

    taken  rgb of the light behind the surface the share that does not pass, a the share of the
           surface that is there; 0 where the layer has none
    """

    has_triangle_ids = False

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self._layer_pass = MeshPass(gpu, _Layer, culls=True)
        self._eye = (0.0, 0.0, 0.0)
        super().__init__(gpu, size)

    def _make_textures(self, size: tuple[int, int]) -> None:
        super()._make_textures(size)
        gpu = self._sized
        self.taken = Texture(gpu, "taken", size, "rgba16float", target=True)
        self._depths = (self.depth, Texture(gpu, "layer depth", size, "depth32float", target=True))
        self._solid: Texture | None = None
        self._index = 0

    def begin(self, solid: Texture, eye: tuple[float, float, float]) -> None:
        """The next layer is the first one before the surfaces whose depth is `solid`."""
        self._solid, self._eye, self._index = solid, eye, 0

    def encode(self, commands: Commands, scene: GpuScene, clip_from_world: F64) -> None:
        """Draw the next layer, and make it the one whose textures are bound."""
        self._rasterise(commands, scene, clip_from_world)
        self._index += 1

    def _rasterise(self, commands: Commands, scene: GpuScene, clip_from_world: F64) -> None:
        assert self._solid is not None, "begin comes first"
        # The layer before, and this one's, take turns in two textures.
        before, self.depth = self._depths[(self._index + 1) % 2], self._depths[self._index % 2]
        # The nearest fragments behind the layer before, in front of opaque surfaces.
        params = PeelParams(
            clip_from_world=clip_from_world,
            eye=self._eye,
            is_first=int(self._index == 0),
            unlit_radiance=self.unlit_radiance,
        )
        with commands.render(
            "layer",
            color_attachments=color_attachments((*self._targets, self.taken)),
            depth_stencil_attachment=depth_attachment(self.depth, 0.0),
        ) as encoder:
            draws = scene.translucent(clip_from_world)
            self._layer_pass.draw(
                commands, encoder, scene, draws, params, before=before, solid=self._solid
            )
