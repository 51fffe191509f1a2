"""USD scenes (.usd, .usda, .usdc, .usdz) by the extra `usd` (usd-core, OpenUSD's own library).

Read: meshes and the schema's simple shapes, GeomSubsets, instances, point instancers, variants as
selected, skeletons and blend shapes in their first pose, UsdPreviewSurface with images, UsdLux
lights and domes, cameras, OpenVDB volumes, the up axis and metersPerUnit. Places of prims move;
what else moves stands as it does at the first time; `usd_losses` says what is asked for and not
read.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ...maths.closing import surface_area
from ..animation import Animation
from ..camera import Camera
from ..checks import F64
from ..environment import Environment
from ..lights import Light
from ..mesh import Geometry, Mesh
from ..scene import Scene
from ..volume import Volume
from .images import read_radiance
from .usd_lights import cone_losses, dome, glowing, usd_camera, usd_light
from .usd_losses import UsdLosses
from .usd_material import UsdMaterials
from .usd_mesh import is_shape, prim_geometries
from .usd_motion import STILL, Place, UsdMotion
from .usd_skel import is_posed, pose
from .usd_stage import opened_stage, refused_by_usd, resolved_asset, told_by_usd
from .usd_volume import UsdVolumes

_MOST_INSTANCES = 100_000
_HIDDEN = ("proxy", "guide")
_UPRIGHT: F64 = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)


def load_usd(path: Path) -> Scene:
    """What a USD file shows. Raises SceneError.

    What had to be approximated or replaced is in the scene's warnings.
    """
    with told_by_usd() as told, refused_by_usd():
        reader = _Reader(path)
        reader.warnings += told()
        return reader.scene()


class _Reader:
    """A stage on its way to a scene."""

    def __init__(self, path: Path) -> None:
        self._path, self._folder = path, path.parent.resolve()
        self.warnings: list[str] = []
        self._stage = stage = opened_stage(path)
        from pxr import Usd, UsdGeom

        # A moving stage is read as it is at its first time.
        self._time = Usd.TimeCode.EarliestTime()
        if stage.HasAuthoredTimeCodeRange():
            self._time = Usd.TimeCode(stage.GetStartTimeCode())
        pose(stage, self._time)
        self._losses = UsdLosses(self._time)
        # From the stage's unit and upwards axis to metres and +Y.
        self._metres = float(UsdGeom.LinearUnits.centimeters)
        if stage.HasAuthoredMetadata("metersPerUnit"):  # Blender's are floats, not doubles
            self._metres = float(stage.GetMetadata("metersPerUnit"))
        if not 0.0 < self._metres < 1e9:
            raise SceneError(f"its metersPerUnit {self._metres} is no length")
        self._root = np.diag([self._metres] * 3 + [1.0])
        if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
            self._root = self._root @ _UPRIGHT
        # Caches for the whole stage, and what is found on the way.
        self._places = UsdGeom.XformCache(self._time)
        self._materials = UsdMaterials(self._folder, self._time)
        self._volume_reader = UsdVolumes(stage, self._folder, self._time, self.warnings)
        self._shapes: dict[str, list[tuple[Geometry, str]]] = {}
        self._motion = UsdMotion(stage, self._root, self._time)
        self._meshes: list[tuple[Place, Mesh]] = []
        self._lights: list[tuple[Place, Light]] = []
        self._volumes: list[Volume] = []
        self._environment: Environment | None = None
        self._camera: tuple[Place, Camera] | None = None

    def scene(self) -> Scene:
        """Everything that the stage shows."""
        self._walk(self._stage.GetPseudoRoot(), self._root)
        if not self._meshes and not self._volumes:
            raise SceneError("it has no triangles and no volumes", where=self._path)
        rig = self._motion.rig([p for p, _ in self._meshes], self._lights, self._camera)
        lost = (self._losses, self._materials)
        told = dict.fromkeys(
            [*self.warnings, *lost[0].texts(), *lost[1].warnings, *self._motion.warnings]
        )
        return Scene(
            meshes=tuple(mesh for _, mesh in self._meshes),
            lights=tuple(light for _, light in self._lights),
            environment=self._environment,
            camera=self._camera[1] if self._camera else Camera(),
            animation=Animation((rig,)) if rig else None,
            volumes=tuple(self._volumes),
            name=self._path.stem,
            warnings=tuple(f"{self._path}: {text}" for text in told),
        )

    def _walk(self, top: Any, root: F64) -> None:
        """All that is below a prim and seen; `root` comes after the prims' own places."""
        from pxr import Usd, UsdGeom

        # Prims of instances are visited as well, as proxies of their prototypes'.
        visited = iter(Usd.PrimRange(top, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
        for prim in visited:
            if self._is_hidden(prim):
                self._losses.look_hidden(prim)
                visited.PruneChildren()
                continue
            self._losses.look(prim, moves=root is self._root)
            if prim.IsA(UsdGeom.PointInstancer):
                # Prototypes below an instancer are shown at its places only.
                visited.PruneChildren()
                self._instances(prim, root)
            elif prim.IsA(UsdGeom.Boundable) or prim.IsA(UsdGeom.Xformable):
                self._take(prim, root)

    def _is_hidden(self, prim: Any) -> bool:
        from pxr import UsdGeom

        if not prim.IsA(UsdGeom.Imageable):
            return False
        imageable = UsdGeom.Imageable(prim)
        is_seen = imageable.GetVisibilityAttr().Get(self._time) != UsdGeom.Tokens.invisible
        return not is_seen or imageable.GetPurposeAttr().Get(self._time) in _HIDDEN

    def _take(self, prim: Any, root: F64) -> None:
        """A mesh, a light, a camera or a volume."""
        from pxr import UsdGeom, UsdLux, UsdVol

        # USD multiplies row vectors, hence the transposed matrix.
        world = root @ np.array(self._places.GetLocalToWorldTransform(prim)).T
        if not np.isfinite(world).all():
            raise SceneError(f"'{prim.GetPath()}': its place is no finite number")
        # Places that an instancer gives do not move.
        place = Place(STILL, world)
        if root is self._root:
            place = self._motion.place(prim, world)
        # A volume is a gprim, too, and a light is told by its API, whatever its type.
        if prim.IsA(UsdGeom.Gprim) and not prim.IsA(UsdVol.Volume):
            self._gprim(prim, place)
        elif prim.IsA(UsdVol.Volume):
            self._motion.left_still(prim)
            volume = self._volume_reader.of(prim, world)
            self._volumes += [volume] if volume is not None else []
        elif prim.IsA(UsdLux.DomeLight) or prim.GetTypeName() == "DomeLight_1":
            self._motion.left_still(prim)
            self._dome(prim, world)
        elif prim.HasAPI(UsdLux.LightAPI):
            light = usd_light(prim, world, self._time)
            if light is None:
                self.warnings.append(f"'{prim.GetPath()}': a {prim.GetTypeName()} is left out")
            else:
                self._lights.append((place, light))
                told = cone_losses(prim, self._time) if prim.HasAPI(UsdLux.ShapingAPI) else ()
                self.warnings += [f"'{prim.GetPath()}': {text}" for text in told]
        elif prim.IsA(UsdGeom.Camera):
            if self._camera is not None:
                self.warnings.append("it has several cameras: the first perspective one is used")
                return
            try:
                self._camera = place, usd_camera(prim, world, self._time, self._metres)
            except SceneError as error:
                self.warnings.append(f"'{prim.GetPath()}': {error.problem}: it is left out")

    def _gprim(self, prim: Any, place: Place) -> None:
        from pxr import UsdLux

        if not is_shape(prim):
            self.warnings.append(f"'{prim.GetPath()}': a {prim.GetTypeName()} is left out")
            return
        # Instances share a prototype's geometry, which is read once.
        prototype = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        key = str(prototype.GetPath())
        if key not in self._shapes:
            self._note(prim)
            found = prim_geometries(prim, self._time, self._materials.uv_name)
            # By name: each instance has subsets of its own, and perhaps other materials.
            self._shapes[key] = [
                (geometry, "" if bound == prim else bound.GetName()) for geometry, bound in found
            ]
        shapes = self._shapes[key]
        is_light = prim.HasAPI(UsdLux.LightAPI)
        area_m2 = sum(_area(geometry, place.world) for geometry, _ in shapes) if is_light else 0.0
        for geometry, name in shapes:
            bound = prim.GetChild(name) if name else prim
            material = self._materials.of(bound, has_colors=geometry.colors is not None)
            if is_light:
                material = glowing(material, prim, area_m2, self._time)
            mesh = Mesh(geometry, material, place.world, str(prim.GetPath()))
            self._meshes.append((place, mesh))

    def _note(self, prim: Any) -> None:
        """What of a mesh is shown otherwise than it asks for."""
        if prim.HasRelationship("skel:skeleton") and not is_posed(prim):
            self.warnings.append(f"'{prim.GetPath()}': its skeleton is left out: it stands at rest")

    def _instances(self, prim: Any, root: F64) -> None:
        """The prototypes of a point instancer at each of its places."""
        from pxr import UsdGeom

        instancer = UsdGeom.PointInstancer(prim)
        prototypes = instancer.GetPrototypesRel().GetForwardedTargets()
        which = instancer.GetProtoIndicesAttr().Get(self._time)
        self._motion.left_still(prim)
        if not prototypes or which is None or not len(which):
            return
        if len(which) > _MOST_INSTANCES:
            raise SceneError(f"'{prim.GetPath()}' has {len(which):,} instances, too many")
        places = instancer.ComputeInstanceTransformsAtTime(
            self._time, self._time, UsdGeom.PointInstancer.IncludeProtoXform
        )
        mask = instancer.ComputeMaskAtTime(self._time)
        world = root @ np.array(self._places.GetLocalToWorldTransform(prim)).T
        # Masked places are left out of the list of transforms.
        kept = [k for k in range(len(which)) if not mask or mask[k]]
        for place, k in zip(places, kept, strict=len(places) == len(kept)):
            if 0 <= which[k] < len(prototypes):
                top = self._stage.GetPrimAtPath(prototypes[which[k]])
                # From the prototype's own place to the instance's.
                own = np.array(self._places.GetLocalToWorldTransform(top)).T
                self._walk(top, world @ np.array(place).T @ np.linalg.inv(own))

    def _dome(self, prim: Any, world: F64) -> None:
        attribute = prim.GetAttribute("inputs:texture:file")
        value = attribute.Get(self._time) if attribute else None
        image = None
        # The image is named from the layer that sets it, which may lie elsewhere.
        if value is not None and value.path:
            stack = attribute.GetPropertyStack(self._time)
            resolved = resolved_asset(stack[0].layer, str(value.path), self._folder)
            if resolved and Path(resolved).is_file():
                image = read_radiance(Path(resolved), self.warnings)
            else:
                self.warnings.append(f"'{prim.GetPath()}': its image '{value.path}' is missing")
        if self._environment is not None:
            self.warnings.append(f"'{prim.GetPath()}': of several domes the first is used")
            return
        self._environment, is_tilted = dome(prim, world, self._time, image)
        if is_tilted:
            self.warnings.append(f"'{prim.GetPath()}': a tilted dome is taken upright")


def _area(geometry: Geometry, world: F64) -> float:
    """Of a geometry that `world` (4, 4) places, m^2."""
    placed = geometry.positions @ world[:3, :3].T
    return surface_area(placed, geometry.indices.astype(np.int64))
