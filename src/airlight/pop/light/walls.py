"""Surfaces between the cells of a medium, found by rays from the middle of each cell to the next.

Diffuse light ends at them as it does at the border of the medium's box, but for what they reflect.
Behind that border, too, surfaces reflect, as far out as the middle of a next cell would be.
differs: Elek2014 lets light propagate from cell to cell as if nothing stood there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Buffer, buffer_of
from ...gpu.slots import storage, uniform
from ...rays.rays import RAY_SLOTS, RayScene
from ...scene.mesh import world_boxes
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams
from .visibility import Surfaces


class _Positions(ComputePass):
    slots = (
        uniform("params", MediumParams),
        *RAY_SLOTS,
        storage("reflectances", "f32"),
        storage("positions", "u32", "read_write"),
    )
    workgroup = (64, 1, 1)
    in_bands = True
    file = "wall_positions.wgsl"


class _Faces(ComputePass):
    slots = (
        uniform("params", MediumParams),
        storage("positions", "u32"),
        storage("walls", "u32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "wall_faces.wgsl"


class Walls:
    """Fills `Diffuse.walls` where meshes reach into a medium's box, once until either moves."""

    def __init__(self, medium: GridMedium) -> None:
        self._medium = medium
        self._faces = _Faces(medium.gpu)
        self._positions = Buffer(medium.gpu, "positions of walls", 12 * medium.cells)
        # Pipelines of rays, by their constants.
        self._passes: dict[tuple[Any, ...], _Positions] = {}
        self._reflectances: Buffer | None = None
        # The meshes that they were found among, and what was there when those were last looked for.
        self._made: tuple[Any, ...] = ()
        self._seen: tuple[Any, ...] = ()
        self._is_clear = True

    def encode(
        self, commands: Commands, params: MediumParams, surfaces: Surfaces, walls: Buffer
    ) -> bool:
        """Fill `walls`, two u32 per cell, as `wgsl/walls.wgsl` reads them; whether they changed."""
        # Meshes elsewhere move, and emission flickers, without another wall.
        at = self._medium.placement
        placed = (at.world_from_medium.tobytes(), at.extent.tobytes())
        if (surfaces.meshes.version, *placed) == self._seen:
            return False
        self._seen = (surfaces.meshes.version, *placed)
        crossing = self._crossing(surfaces)
        if (crossing, *placed) == self._made:
            return False
        self._made = (crossing, *placed)
        # Without a mesh near the box all faces are open.
        if not crossing:
            return self._clear(walls)
        # Rays find the surfaces, then each cell learns of its six faces.
        with commands.stage("pop walls"):
            self._reflectances = self._reflectances or buffer_of(
                self._medium.gpu, "reflectance of instances", surfaces.blockers.reflectances
            )
            self._trace(commands, params, surfaces.rays.of_frame(commands))
            self._faces.dispatch(
                commands,
                (self._medium.cells,),
                params=params,
                positions=self._positions,
                walls=walls,
            )
        self._is_clear = False
        return True

    def _trace(self, commands: Commands, params: MediumParams, scene: RayScene) -> None:
        """Find the first surface on the path from each cell to the next along x, y and z."""
        # Translucent surfaces close nothing.
        is_whole = float(self._medium.level == 0)
        constants = {**scene.constants, "RAYS_MEET_TRANSLUCENT": 0.0, "IS_WHOLE": is_whole}
        key = tuple(constants.items())
        if key not in self._passes:
            self._passes[key] = _Positions(self._medium.gpu, constants=constants)
        self._passes[key].dispatch(
            commands,
            (self._medium.cells,),
            params=params,
            **scene.bound,
            reflectances=self._reflectances,
            positions=self._positions,
        )

    def _crossing(self, surfaces: Surfaces) -> tuple[tuple[Any, ...], ...]:
        """The meshes near the medium's box: number, geometry, where it is."""
        meshes = surfaces.meshes.current
        if not (surfaces.meshes.draws and meshes):
            return ()
        # The medium's box may be turned: compared is the box along the world's axes around it.
        placement = self._medium.placement
        corners = np.array(np.meshgrid(*[(0.0, 1.0)] * 3)).reshape(3, 8).T * placement.extent
        corners += np.where(corners > 0.0, 0.5, -0.5) * placement.cell
        placed = (
            corners @ placement.world_from_medium[:3, :3].T + placement.world_from_medium[:3, 3]
        )
        # A mesh is named by all that a wall depends on: equal answers mean that no wall moved.
        boxes = world_boxes(meshes)
        meets = (boxes[:, 0] <= placed.max(axis=0)) & (boxes[:, 1] >= placed.min(axis=0))
        return tuple(
            (int(i), meshes[i].geometry, meshes[i].world_from_object.tobytes())
            for i in np.flatnonzero(meets.all(axis=1))
        )

    def _clear(self, walls: Buffer) -> bool:
        """Open all faces; returns whether any was closed."""
        # Without surfaces no face is closed, which is written once.
        was_clear, self._is_clear = self._is_clear, True
        if not was_clear:
            walls.write(np.zeros(2 * self._medium.cells, np.uint32))
        return not was_clear
