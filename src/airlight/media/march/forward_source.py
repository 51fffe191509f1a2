"""Light that the reduced medium transmits, light by light, for marching.

Two bands cannot hold the lobe that a strong g makes of it. A texture holds how much of each light
arrives so in each cell of a lattice, and its scattering depth; marching looks up `fused_phase`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...gpu.rows import table
from ...gpu.slots import Slot, storage, texture
from ...maths.forward_phase import fused_table
from ...scene.checks import F32
from ...surface.light_table import LightData


def forward_slots() -> tuple[Slot, ...]:
    """What marching binds."""
    return (
        table("forward_table", LightData),
        texture("forward_lights", "3d"),
        texture("forward_blurred", "3d"),
        storage("fused", "vec4f"),
    )


def fused_rows(rows: Sequence[dict[str, Any]]) -> F32:
    """(mean cosines * DEPTHS * COSINES, 4): the tables of `fused` for the rows of GpuMedia, one
    for each `phase`."""
    # Media of one mean cosine share a table, and channels of one g are computed once.
    known: dict[float, Any] = {}
    tables = []
    for g in dict(sorted((row["phase"], row["g"]) for row in rows)).values():
        three = [known.setdefault(c, fused_table(c)) for c in map(float, g)]
        tables.append(np.stack([*three, np.zeros_like(three[0])], axis=-1).reshape(-1, 4))
    return np.concatenate(tables).astype(np.float32)


FORWARD_WGSL = "//! use forward_light\n"
NO_FORWARD_WGSL = "//! use no_forward_light\n"
