"""What lighting asks of media: the transmittance between a light and a surface."""

from __future__ import annotations

from typing import Any, Protocol

from ..gpu.slots import Slot


class Attenuation(Protocol):
    """Media as a pass binds them: media.gpu_media.GpuMedia."""

    slots: tuple[Slot, ...]
    wgsl: str

    @property
    def bound(self) -> dict[str, Any]:
        """The resources, by slot name."""

    @property
    def is_one_box(self) -> bool:
        """Whether all there is is one homogeneous box."""
