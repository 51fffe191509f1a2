"""Which settings of a technique make the image of a still view finer."""

from __future__ import annotations

from typing import Any

from ...lattice.placement import fitted
from ...lighting.lattice_box import lattice_axes, lattice_box
from ...media.settings import MediaSettings
from ...scene.scene import Scene

_MOST_CELLS = {True: 64**3, False: 96**3}  # by whether the driver is software
_RATIOS = (2.0, 1.5)  # cells along a side
_MARCHED = ("march_resolution", "shaft_resolution", "march")


def finer_settings(now: Any, scene: Scene, *, is_cpu: bool) -> dict[str, Any]:
    """What to change of the technique's settings `now` for the finest image of `scene`.

    Empty where it can do no better than it does.
    """
    finer: dict[str, Any] = {
        name: "full" for name in _MARCHED if getattr(now, name, "full") != "full"
    }
    # A view at rest is a still.
    has_air = scene.medium is not None or scene.volumes
    if getattr(now, "gather", "") == "still" and scene.meshes and not has_air:
        finer["gather"] = "always"
    # Where light propagates, more cells are no better (docs/accuracy.md, larger lattices).
    if not hasattr(now, "occlusion") and (scene.meshes and scene.environment):
        finer |= _larger(now, scene, _MOST_CELLS[is_cpu])
    return finer


def _larger(now: Any, scene: Scene, most_cells: int) -> dict[str, int]:
    """A lattice of more cells for the sky's light, if that is not too large."""
    # The lattice that the technique would have, with more cells along each side.
    axes = lattice_axes(scene, follows_walls=now.follow_walls)
    low, high = lattice_box(scene, now.bounds, in_medium=isinstance(now, MediaSettings), axes=axes)
    for ratio in _RATIOS:
        cells = int(now.resolution * ratio)
        if fitted(low, high, cells).cells <= most_cells:
            return {"resolution": cells}
    return {}
