"""A canvas to draw into (a window, a browser's image, a notebook's), and imgui on it."""

from __future__ import annotations

from typing import Any

from .device import Gpu


class CanvasSurface:
    """A rendercanvas canvas, set up for `gpu`. `format` is what its textures have."""

    def __init__(self, gpu: Gpu, canvas: Any) -> None:
        self.canvas = canvas
        self.context: Any = canvas.get_wgpu_context()
        preferred = self.context.get_preferred_format(gpu.device.adapter)
        self.format = self._configured(gpu, preferred)

    def _configured(self, gpu: Gpu, preferred: str) -> str:
        # Our images are encoded already; a plain format takes them as they are.
        plain = preferred.removesuffix("-srgb")
        for format in dict.fromkeys((plain, preferred)):
            try:
                self.context.configure(device=gpu.device, format=format)
            except (ValueError, RuntimeError):
                continue
            return format
        raise RuntimeError(f"no texture format for {type(self.canvas).__name__}")

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels; a side is 0 while the window is folded to nothing."""
        width, height = self.canvas.get_physical_size()
        return int(width), int(height)

    def view(self) -> Any:
        """The texture of the coming frame, as a target."""
        return self.context.get_current_texture().create_view()


def imgui_overlay(gpu: Gpu, canvas: Any) -> Any:
    """Draws an imgui panel onto the canvas's frame and takes the events that are the panel's.

    Raises ImportError without imgui-bundle.
    """
    from wgpu.utils.imgui import ImguiRenderer

    return ImguiRenderer(gpu.device, canvas)
