"""What lighting asks of media: the transmittance between a light and a surface."""

from __future__ import annotations

from typing import Protocol

from ..lattice.inject import LightAttenuation


class Attenuation(LightAttenuation, Protocol):
    """Media as a pass binds them: media.gpu_media.GpuMedia."""

    @property
    def is_one_box(self) -> bool:
        """Whether all there is is one homogeneous box."""
