"""Blockers: the visibility and the reflectance of the faces between cells.

Each surfel's area, projected on the three axes and split by the side it faces, is summed around the
lattice's corners. A propagation step across a face is blocked by the area that faces it, averaged
over the face's four corners (NumPy twin: maths.lattice6.blocked_shares).

differs: Kaplanyan2010 section 3.2 stores blockers as spherical harmonics, as which a full wall lets
16 to 22% of the light through.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3u
from ..gpu.memory import Buffer, Texture, buffer_of
from ..gpu.slots import Slot, image, storage, texture, uniform
from ..scene.lights import DirectionalLight
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.instances import InstanceData
from .placement import LatticeParams, Placement
from .rooms import Rooms
from .surfels import SurfelData, follow, mean_reflectances, sealed, surfels, turned

_CORNER_VALUES = 67  # as in wgsl/blocker_sums.wgsl
UNITS = 2.0**16
"""Fixed-point units per fully covered cell face."""


BLOCKER_SLOTS: tuple[Slot, ...] = tuple(
    texture(f"lattice_{name}", "3d") for name in ("visibility_a", "visibility_b", "walls")
)
"""Of passes that use `wgsl/open_line.wgsl` or `wgsl/lattice.wgsl`; `Blockers.bound` binds them."""
SURFACE_BLOCKER_SLOTS: tuple[Slot, ...] = (*BLOCKER_SLOTS, texture("lattice_planes", "3d"))
"""Of passes that use `wgsl/surface_coordinates.wgsl`; `Blockers.surface_bound` binds them."""


class BlockerParams(Struct):
    """How many corners there are and how area becomes integers."""

    count = vec3u("cells")
    surfel_count = u32()
    units = f32("fixed-point units per fully covered face")
    first_row = u32("where its cells begin along y of the textures")


class _SumSurfels(ComputePass):
    slots = (
        uniform("params", BlockerParams),
        uniform("lattice", LatticeParams),
        storage("surfels", SurfelData),
        storage("instances", InstanceData),
        storage("sums", "atomic<i32>", "read_write"),
    )
    workgroup = (256, 1, 1)
    in_bands = True
    file = "blockers.wgsl"


class _WallEnds(ComputePass):
    slots = (
        uniform("params", BlockerParams),
        storage("sums", "i32", "read"),
        storage("ends", "vec2u", "read_write"),
    )
    workgroup = (32, 8, 1)
    in_bands = True
    file = "wall_ends.wgsl"


class _FaceVisibility(ComputePass):
    slots = (
        uniform("params", BlockerParams),
        storage("sums", "i32", "read"),
        storage("ends", "vec2u"),
        storage("faces", "vec4u", "read_write"),
        storage("face_visibility", "vec2u", "read_write"),
        image("visibility_a", "rgba8unorm", "3d"),
        image("visibility_b", "rgba8unorm", "3d"),
        image("walls", "rgba8snorm", "3d"),
        image("planes", "rgba16float", "3d"),
    )
    workgroup = (32, 8, 1)
    in_bands = True
    file = "face_visibility.wgsl"


class Blockers:
    """Visibility and reflectance of all cell faces, recomputed only where the geometry moved.

    `faces` holds eight u32 per cell, all unorm8: for the six outgoing hops the reflected share
    (rgb) and the blocked share (a), then the visibility of the six incoming hops.
    `face_visibility` is the last two words alone. The textures `visibility_a` and `visibility_b`
    hold the visibility of each of a cell's six faces in both directions, so that lookups do not
    interpolate across a wall. `walls` says how far, in cells, the walls that were counted on a
    cell's three low faces really are from them: readers warp lattice coordinates by it
    (wgsl/lattice_space), so that a point before a wall is never looked up behind it. `planes` holds
    the plane of the oblique surface that a cell is near (wgsl/oblique_plane).
    """

    count: int
    version: int
    """Raised by `note_change`."""
    surfels: Buffer
    visibility_a: Texture
    visibility_b: Texture
    walls: Texture
    planes: Texture

    def __init__(
        self,
        gpu: Gpu,
        scene: Scene,
        meshes: GpuScene,
        placement: Placement,
        count: int,
        *,
        size: tuple[int, int, int] | None = None,
        owner: Blockers | None = None,
    ) -> None:
        """`count` surfels. `size`: of textures that nested lattices share (cells; the lattice's
        own if not given); `owner`: the one of them that owns textures and surfels.
        """
        self.placement, self.meshes, self._owner = placement, meshes, owner or self
        self.version = self._turns = 0
        # Nested lattices share surfels and textures; each has its own faces.
        if owner is None:
            self._sample(gpu, scene, count)
            self._make_textures(gpu, size or placement.count)
        else:
            self.count, self.surfels, self.walls = owner.count, owner.surfels, owner.walls
            self.visibility_a, self.visibility_b = owner.visibility_a, owner.visibility_b
            self.planes = owner.planes

        # Sums stand around corners, one more than cells on each axis; faces belong to cells.
        self.corners = int(np.prod([n + 1 for n in placement.count]))
        self.sums = Buffer(gpu, "blocker sums", self.corners * _CORNER_VALUES * 4)
        self.ends = Buffer(gpu, "wall ends", placement.cells * 8)
        self.faces = Buffer(gpu, "cell faces", placement.cells * 32)
        self.face_visibility = Buffer(gpu, "face_visibility", placement.cells * 8)
        self._sum = _SumSurfels(gpu)
        self._end, self._open = _WallEnds(gpu), _FaceVisibility(gpu)
        self._made: tuple[int, int, Placement] | None = None

    @property
    def reflectances(self) -> NDArray[np.float32]:
        """The bihemispherical albedo of each instance: the mean of its surfels and channels."""
        return mean_reflectances(self._owner._samples, len(self.meshes.order))

    @property
    def rooms(self) -> Rooms:
        """The closed bodies among the meshes."""
        return self._owner._rooms

    def _sample(self, gpu: Gpu, scene: Scene, count: int) -> None:
        # A body that the camera enters on its way is a room from the beginning.
        eyes = scene.animation.eyes(scene) if scene.animation else []
        self._rooms = Rooms(self.meshes.current, np.array([*eyes, *_inside(scene)], np.float64))

        # Surfels stay on their triangles for good; only which of their sides block changes.
        order = self.meshes.order
        samples = surfels(scene.meshes, order, count, self._rooms.sides)
        # A body that holds some of these points and not all is a wall between them: it is sealed.
        samples = sealed(samples, order, scene.meshes, self._rooms.walls)
        self.count = len(samples)
        self.surfels = buffer_of(gpu, "surfels", samples)
        self._samples, self._followed = samples, self.meshes.original

    def _make_textures(self, gpu: Gpu, size: tuple[int, int, int]) -> None:
        def made(name: str, format: str) -> Texture:
            return Texture(gpu, name, size, format, dimension="3d", written=True)

        self.visibility_a = made("face visibility xy", "rgba8unorm")
        self.visibility_b = made("face visibility z", "rgba8unorm")
        self.walls = made("walls", "rgba8snorm")
        self.planes = made("oblique planes", "rgba16float")

    def move_to(self, placement: Placement) -> None:
        """Move the lattice, which has as many cells as before, at the next `encode`."""
        self.placement = placement

    def find_rooms(self, scene: Scene) -> None:
        """Let bodies that hold the eye or a local light of `scene` block with both sides.

        Those that hold some of these points and not all block wholly, but for their materials.
        Of nested lattices the largest one does it for all, before any of them is encoded.
        """
        before = self._rooms.sides
        if self._rooms.update(self.meshes.current, _inside(scene)):
            # Surfels are turned, not sampled again: each stays where it was drawn.
            order, meshes = self.meshes.order, self.meshes.original
            samples = turned(self._samples, order, meshes, before, self._rooms.sides)
            self._samples = sealed(samples, order, meshes, self._rooms.walls)
            self.surfels.write(self._samples)
            # They lie on the original vertices again; `follow_vertices` moves them on.
            self._followed, self._turns = self.meshes.original, self._turns + 1

    def encode(self, commands: Commands) -> bool:
        """Update the faces; returns whether anything changed."""
        # Fading borders do not count: blockers know nothing of them.
        made = (self.meshes.version, self._owner._turns, replace(self.placement, fade=None))
        if self._made == made:
            return False
        self._made = made
        # Area around corners, then what of it faces each hop.
        self.clear(commands)
        self.sum_meshes(commands)
        self.open(commands)
        return True

    def clear(self, commands: Commands) -> None:
        """Remove all blockers."""
        commands.encoder.clear_buffer(self.sums.handle)

    def sum_meshes(self, commands: Commands) -> None:
        """Add the surfels of all meshes to the sums around the corners."""
        self.follow_vertices()
        self._sum.dispatch(
            commands,
            (self.count,),
            params=self._params(),
            lattice=self.placement.params(),
            surfels=self.surfels,
            instances=self.meshes.instances,
            sums=self.sums,
        )

    def open(self, commands: Commands) -> None:
        """Compute visibility, reflectance and wall offsets of all faces from the sums."""
        self.note_change()
        count, params = self.placement.count, self._params()
        self._end.dispatch(commands, count, params=params, sums=self.sums, ends=self.ends)
        self._open.dispatch(
            commands,
            count,
            params=params,
            sums=self.sums,
            ends=self.ends,
            faces=self.faces,
            face_visibility=self.face_visibility,
            visibility_a=self.visibility_a,
            visibility_b=self.visibility_b,
            walls=self.walls,
            planes=self.planes,
        )

    def note_change(self) -> None:
        """Raise the version; whoever recomputes faces calls it."""
        self.version += 1

    def _params(self) -> BlockerParams:
        return BlockerParams(
            count=self.placement.count,
            surfel_count=self.count,
            units=UNITS,
            first_row=self.placement.first_row,
        )

    def follow_vertices(self) -> None:
        """Move the surfels of meshes whose vertices moved; nested lattices share the owner's."""
        meshes = self.meshes

        # The samples of creation, at the same barycentric coordinates on this frame's vertices.
        if self._owner is not self:
            return
        pairs = zip(self._followed, meshes.current, strict=True)
        if any(before.geometry is not now.geometry for before, now in pairs):
            moved = follow(self._samples, meshes.order, meshes.original, meshes.current)
            self.surfels.write(moved)
        self._followed = meshes.current

    @property
    def bound(self) -> dict[str, Texture]:
        """By the names of BLOCKER_SLOTS."""
        return {
            "lattice_visibility_a": self.visibility_a,
            "lattice_visibility_b": self.visibility_b,
            "lattice_walls": self.walls,
        }

    @property
    def surface_bound(self) -> dict[str, Texture]:
        """By the names of SURFACE_BLOCKER_SLOTS."""
        return {**self.bound, "lattice_planes": self.planes}


def _inside(scene: Scene) -> NDArray[np.float64]:
    """The positions (n, 3) of the eye and of lights, metres; infinite of distant ones."""
    # Distant lights and the sky are outside of every body.
    local = [x.position for x in scene.lights if not isinstance(x, DirectionalLight)]
    has_distant = len(local) < len(scene.lights) or scene.environment is not None
    distant = [(np.inf,) * 3] * has_distant
    return np.array([scene.camera.position, *local, *distant], np.float64)
