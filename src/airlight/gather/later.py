"""What later segments of paths bring, shared by paths whose first segments met the same place.

It changes slowly along surfaces, and each path finds it by luck: the few patches that lights shine
on. So an image of a scene adds it up in cells of surfaces, of a table by a hash (Binder2019), over
all of its samples, and a point takes for each of its rays the mean of the cell that this has met.
What rays of a length below a cell's met counts their own, the shorter the more.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u, vec3f
from ..gpu.memory import Buffer
from ..gpu.slots import storage, texture, uniform
from ..lighting.view import View
from ..surface.hits import Hits
from .paths import Paths
from .points import Points
from .sums import PointSums, Sums
from .thinning import counts

SHARE = 1.0 / 32.0
"""Of the distance to the eye, how wide a cell is; rounded up to a power of two, m."""
WORDS, SLOTS = 8, 1 << 17
"""Of the table: a cell of so many words has a slot."""
_LAYOUT = f"const SLOTS = {SLOTS}u;\nconst WORDS = {WORDS}u;\n"


class LaterParams(Struct):
    """The rays of a batch, and how large cells are."""

    reduced = vec2u("points")
    rays = u32("of a point")
    first_ray = u32()
    eye = vec3f("m")
    share = f32("of the distance to the eye that cells are wide")
    later = u32("rays of a point that have later segments")
    counts = f32("how many paths each of them counts for")


class UnitParams(Struct):
    """How many paths there are."""

    paths = u32()


class _Unit(ComputePass):
    slots = (
        uniform("params", UnitParams),
        storage("paths", "vec4f"),
        storage("unit", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "later_unit.wgsl"


class _Cells(ComputePass):
    slots = (
        uniform("params", LaterParams),
        texture("hit_positions", "2d", "unfilterable-float"),
        texture("hit_normals", "2d", "unfilterable-float"),
        storage("paths", "vec4f"),
        storage("passed", "vec4f"),
        storage("unit", "f32"),
        storage("cells", "atomic<u32>", "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "later_cells.wgsl"


class _LaterSums(ComputePass):
    slots = (
        uniform("params", LaterParams),
        texture("starts", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        texture("hit_positions", "2d", "unfilterable-float"),
        texture("hit_normals", "2d", "unfilterable-float"),
        storage("paths", "vec4f"),
        storage("passed", "vec4f"),
        storage("unit", "f32"),
        storage("cells", "u32"),
        storage("far", "f32"),
        storage("sums", PointSums, "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "later_sums.wgsl"


class LaterLight:
    """The light of later segments, by cells of what first ones met."""

    def __init__(self, gpu: Gpu, points: Points, batch: int, rays: int) -> None:
        """`batch`: rays of each of the `points` at once, of so many `rays` in a sample."""
        self._points, self._rays = points, rays
        self.passed = Buffer(gpu, "what first segments pass", 16 * points.count * batch)
        """Of each path of a batch what its first segment lets by, for how many it counts."""
        self._table = Buffer(gpu, "later light", 4 * WORDS * SLOTS)
        self._unit = Buffer(gpu, "unit of later light", 16)
        self._find_unit = _Unit(gpu)
        self._add, self._sum = (made(gpu, generated=_LAYOUT) for made in (_Cells, _LaterSums))

    def begin(self, commands: Commands) -> None:
        """Forget all light, since what is lit or where it is seen from is other now."""
        for buffer in (self._table, self._unit):
            commands.encoder.clear_buffer(buffer.handle)

    def encode(
        self,
        commands: Commands,
        view: View,
        paths: Paths,
        hits: Hits,
        numbers: range,
        later: int,
        sums: Sums,
    ) -> None:
        """Add what later segments of the rays of these `numbers` found to the `sums` of points.

        `hits`: of their first segments. `later`: rays of each point that have later ones.
        """
        points, reduced = self._points, self._points.reduced
        params = LaterParams(
            reduced=reduced,
            rays=len(numbers),
            first_ray=numbers.start,
            eye=view.eye,
            share=SHARE,
            later=later,
            counts=counts(0, self._rays),
        )
        met = {"hit_positions": hits.positions, "hit_normals": hits.normal}
        bound = {"params": params, "paths": paths.buffer, "passed": self.passed, "unit": self._unit}
        # Paths add their light to cells, then points take that of the cells that they see.
        if later:
            self._find_unit.dispatch(
                commands,
                (64,),
                params=UnitParams(paths=points.count * later),
                paths=paths.buffer,
                unit=self._unit,
            )
            self._add.dispatch(
                commands, (reduced[0], reduced[1] * later), **bound, **met, cells=self._table
            )
        self._sum.dispatch(
            commands,
            reduced,
            **bound,
            **met,
            starts=points.starts,
            normals=points.normals,
            cells=self._table,
            far=sums.far.buffer,
            sums=sums.buffer,
        )
