"""What a pass binds to send rays: textures whose rows `rows` writes and wgsl/ray_rows.wgsl reads."""

from __future__ import annotations

from ..gpu.slots import Slot, texture

RAY_SLOTS: tuple[Slot, ...] = (
    texture("ray_nodes", "2d", "uint"),
    texture("ray_triangles", "2d", "uint"),
    texture("ray_instances", "2d", "uint"),
)
"""What a pass with `//! use rays` binds beside its own; `RayScene.bound` are the values."""
