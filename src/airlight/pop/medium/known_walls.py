"""Where solvers of volumes know the walls: in their grids, and as far out as a next cell's middle.

Light that a volume sends to these walls and gets back is part of its own solution; what it sends to
walls farther off is not.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...maths.transforms import F64
from ...scene.coefficients import grouped
from ...scene.volume import Volume
from ..settings import PopSettings
from .kinds import GridPlan
from .merging import merged_volume
from .placement import placed


def known_walls(
    volumes: Sequence[Volume], plan: GridPlan, settings: PopSettings, margin_m: float
) -> list[F64]:
    """(4, 4) each: from the world to 0..1 in the boxes within which walls are known.

    They are `margin_m` wider on each side. `volumes`: those of `plan` as they are now.
    """
    # Hops from cell to cell know no walls.
    if settings.scheme != "delta-beam":
        return []
    if plan.kinds:
        wholes = [merged_volume([volumes[i] for i in kind]) for kind in plan.kinds]
    else:
        wholes = [parts[0] for parts in grouped(volumes)]
    boxes = []
    for whole in wholes:
        placement = placed(whole, settings.grid)
        wider = (0.5 * placement.cell + margin_m) / placement.extent
        fit = np.diag([*(1.0 / (1.0 + 2.0 * wider)), 1.0])
        fit[:3, 3] = wider / (1.0 + 2.0 * wider)
        boxes.append(fit @ placement.uvw_from_world)
    return boxes
