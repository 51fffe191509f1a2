"""What a pass binds to send rays: rows of nodes, of triangles and of instances (words, masks)."""

from __future__ import annotations

from ..gpu.rows import rows
from ..gpu.slots import Slot

RAY_SLOTS: tuple[Slot, ...] = (rows("ray_nodes"), rows("ray_triangles"), rows("ray_instances"))
"""What a pass with `//! use rays` binds beside its own; `RayScene.bound` are the values."""
