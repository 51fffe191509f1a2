"""Reduced images of media at full size, guided by the density along the ray of each pixel.

Where the transmittances of neighbouring texels differ, the ray of the pixel is marched through the
density alone, with the steps of the march itself, and the light is scaled to its opacity: thin
wisps and edges are as sharp as at full resolution. Source: Elek2014 section 4.4, which guides a
joint bilateral upsampling (Kopf2007) of its grids by the density. differs: the same for the
marched image; the grids are marched with the full density anyway.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.fullscreen import FullscreenPass
from ...gpu.memory import Texture
from ...gpu.slots import texture, uniform
from ..gpu_media import GpuMedia
from ..march.kernel import MarchParams
from ..march.march import March, MarchTargets
from ..rays import RayParams, Rays


class GuidedUpsample(FullscreenPass):
    """Full-size light and transmittance <- reduced ones, their rays, depth and the media."""

    targets = ("rgba32float", "rgba32float")
    file = "guided.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (
            uniform("rays", RayParams),
            uniform("march", MarchParams),
            texture("depth", "2d", "depth"),
            texture("picked", "2d", "unfilterable-float"),
            texture("reduced", "2d", "unfilterable-float"),
            texture("passed", "2d", "unfilterable-float"),
            *media.medium_slots,
        )
        self._media = media
        super().__init__(gpu, generated=media.medium_wgsl)

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        march: March,
        depth: Texture,
        reduced: MarchTargets,
        targets: tuple[Texture, Texture],
    ) -> None:
        """Fill `targets` from what `march` wrote last into `reduced`, over `rays`."""
        # The ray of a pixel takes the steps of the march.
        assert march.params is not None
        self.draw(
            commands,
            targets,
            rays=rays.params,
            march=march.params,
            depth=depth,
            picked=rays.picked,
            reduced=reduced.scattered,
            passed=reduced.transmittance,
            **self._media.medium_bound,
        )
