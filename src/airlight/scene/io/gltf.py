"""glTF 2.0 and GLB: meshes, materials, punctual lights, the first camera, and what moves them.

Photometric units are read as radiometric ones, WATTS_PER_LUMEN = 1: a candela is a W sr^-1, a
lux a W m^-2, and an emissive strength a W m^-2 sr^-1, so that lights and emissive surfaces keep
their proportion; exposure sets the rest.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ...maths.transforms import triple
from ..animation import Animation
from ..animation.rig import Part, Rig
from ..camera import Camera
from ..checks import F64
from ..lights import DirectionalLight, Light, PointLight, SpotLight
from ..material import Material
from ..mesh import Mesh
from ..scene import Scene
from .gltf_animation import read_clips
from .gltf_buffers import Buffers, read_container
from .gltf_camera import placed_camera
from .gltf_compressed import DRACO
from .gltf_deform import Deforms
from .gltf_extensions import check_extensions, instances
from .gltf_frames import brought_together
from .gltf_json import Item
from .gltf_losses import losses
from .gltf_material import Materials, PlacedMaterial
from .gltf_mesh import Primitive, read_primitive, read_surface
from .gltf_nodes import Node, read_nodes, scene_roots, skeleton, world_matrices
from .gltf_schema import schema_doubts
from .gltf_tangents import Tangents, read_tangents
from .gltf_variants import listed_variants

WATTS_PER_LUMEN = 1.0


def load_gltf(path: Path, variant: str | None = None) -> Scene:
    """Read a .gltf or .glb file into a scene; Camera() where it has no camera.

    `variant` is the name of the material variant to show. Raises SceneError naming the file and
    the place in it, such as accessors[3].
    """
    file = read_gltf(path)
    file.materials.choose(variant)
    return file.scene()


def read_gltf(path: Path) -> GltfFile:
    """The parsed file, whose nodes can be placed at will. Raises SceneError."""
    document, binary = read_container(path)
    warnings = [*check_extensions(document), *schema_doubts(document), *losses(document)]
    return GltfFile(document, Buffers(document, binary), warnings)


def variant_names(path: Path) -> tuple[str, ...]:
    """The material variants of a .gltf or .glb file. Raises SceneError."""
    return listed_variants(read_container(path)[0])


class GltfFile:
    """A document with its buffers. Geometry is read once and shared by its instances."""

    def __init__(self, document: Item, buffers: Buffers, warnings: Sequence[str] = ()) -> None:
        self.document = document
        self.buffers = buffers
        self.nodes: tuple[Node, ...] = read_nodes(document)
        self.roots = scene_roots(document, self.nodes)
        self.materials = Materials(document, buffers)
        self.warnings: list[str] = list(warnings)
        self._meshes = document.items("meshes")
        self._geometries: dict[tuple[Any, ...], tuple[Primitive, Material | None] | None] = {}
        self._deforms = Deforms(document, buffers)

    def world(self) -> dict[int, F64]:
        """world_from_node of the scene's nodes, as the file places them."""
        return world_matrices(self.nodes, self.roots, [n.local_matrix() for n in self.nodes])

    def scene(self) -> Scene:
        """Everything the file shows, as its nodes stand; its first animation, where it has one."""
        world = self.world()
        # Meshes come first, because the rig that moves them refers to their places.
        placed = self._placed(world)
        if not placed:
            raise SceneError("it has no triangles", where=self.document.file)
        camera = self.camera(world)
        # Skins and morphs are shown at rest only once the rig has applied them.
        rig = self._rig(world, placed, has_camera=camera is not None)
        scene = Scene(
            meshes=tuple(mesh for mesh, _ in placed),
            lights=tuple(light for _, light in self.lights(world)),
            camera=camera or Camera(),
            name=self.document.file.stem,
            warnings=tuple(dict.fromkeys(self.warnings + self.materials.warnings)),
            animation=Animation((rig,)) if rig.clips else None,
        )
        return rig.at_rest(scene) if any(part.shape for part in rig.parts) else scene

    def meshes(self, world: dict[int, F64]) -> tuple[Mesh, ...]:
        """All primitives, placed by `world`, without skins and morph targets."""
        return tuple(mesh for mesh, _ in self._placed(world))

    def _placed(self, world: dict[int, F64]) -> list[tuple[Mesh, Part]]:
        """Every primitive, and what moves it."""
        return [
            placed
            for k, matrix in world.items()
            if self.nodes[k].item.has("mesh")
            for placed in self._node_meshes(k, matrix)
        ]

    def _node_meshes(self, k: int, matrix: F64) -> list[tuple[Mesh, Part]]:
        node = self.nodes[k].item
        mesh = self._meshes[node.index("mesh", self._meshes, "meshes")]
        name = node.text("name") or mesh.text("name") or mesh.place
        # Each primitive is a mesh of its own here, with its own material.
        placed = []
        for primitive in mesh.items("primitives"):
            made = self._geometry(primitive, self.materials.of(primitive))
            if made is None:
                continue
            read, material = made
            shape = self._deforms.shape(node, primitive, read)
            weights = None
            if shape is not None and shape.morph is not None:
                weights = self._deforms.weights(node, mesh, len(shape.morph.positions))
            for local in instances(node, self.buffers):
                # What moves for itself is not shared with other nodes.
                geometry = read.geometry if shape is None else replace(read.geometry)
                place = matrix if local is None else matrix @ local
                part = Part(k, shape, weights, local)
                placed.append((Mesh(geometry, material, place, name), part))
        return placed

    def _geometry(
        self, primitive: Item, placed: PlacedMaterial
    ) -> tuple[Primitive, Material] | None:
        """A primitive's triangles and what they wear; None for points and lines."""
        # Instances share a geometry, and so does a primitive in two materials of the same frame.
        key = (primitive.place, placed.frame.key, id(placed) if placed.apart else 0)
        if key not in self._geometries:
            # Without the decoder, what the file holds uncompressed stands in, with a warning.
            if primitive.child("extensions").has(DRACO) and not self.buffers.decompress(primitive):
                self._warn(
                    primitive,
                    f"{DRACO} needs the package DracoPy (pip install 'airlight[gltf]'): what the "
                    "file holds uncompressed is shown",
                )
            self._geometries[key] = self._read(primitive, placed)
            if self._geometries[key] is None:
                self._warn(primitive, "points and lines are left out")
        read = self._geometries[key]
        if read is None:
            return None
        return read[0], read[1] or placed.material

    def _read(
        self, primitive: Item, placed: PlacedMaterial
    ) -> tuple[Primitive, Material | None] | None:
        """A primitive, and a material made for it where its images lie by several coordinates."""
        read = read_primitive(primitive, self.buffers, placed.frame)
        if read is None:
            return None
        for k in placed.uv_sets:
            if not primitive.child("attributes").has(f"TEXCOORD_{k}"):
                self._warn(
                    primitive, f"it has no TEXCOORD_{k}, by which images of its material lie"
                )
        tangents = Tangents()
        if placed.material.normal_texture is not None:
            tangents = read_tangents(primitive, self.buffers, read, placed.material.normal_texture)
        if tangents.problem:
            self._warn(primitive, tangents.problem)
        if not placed.apart:
            return read.with_tangents(tangents.values), None
        # The others' images are drawn again in one set, on the triangles of this primitive, hence a
        # material for it.
        sets = {use.uv_set for use in placed.apart.values()}
        surface = read_surface(primitive, self.buffers, sets)
        has_tangents = tangents.values is not None
        brought = brought_together(
            placed.material, placed.apart, surface, has_tangents=has_tangents
        )
        for problem in brought.problems:
            self._warn(primitive, f"of material '{placed.material.name}': {problem}")
        again = read_primitive(primitive, self.buffers, brought.uvs) or read
        return again.with_tangents(tangents.values), brought.material

    def _rig(
        self, world: dict[int, F64], placed: list[tuple[Mesh, Part]], *, has_camera: bool
    ) -> Rig:
        """What moves with the file's nodes."""
        # A joint that no scene node leads to has no place in the world, and its vertices would
        # collapse.
        parts = tuple(part for _, part in placed)
        for part in parts:
            joints = part.shape.skin.joints if part.shape and part.shape.skin else ()
            for joint in joints:
                if int(joint) not in world:
                    raise self.nodes[int(joint)].item.error("is a joint outside of the scene")
        # Clips may animate weights, whose number is not in the clip but in the mesh.
        targets = {part.node: len(part.weights) for part in parts if part.weights is not None}
        rest = dict.fromkeys(world, np.eye(4))
        return Rig(
            skeleton=skeleton(self.nodes, self.roots),
            parts=parts,
            lights=self.lights(rest),
            camera=self._hung_camera(rest) if has_camera else None,
            clips=read_clips(self.document, self.buffers, targets, self.warnings),
        )

    def _hung_camera(self, rest: dict[int, F64]) -> tuple[int, Camera] | None:
        for k, matrix in rest.items():
            camera = self.camera({k: matrix})
            if camera is not None:
                return k, camera
        return None

    def lights(self, world: dict[int, F64]) -> tuple[tuple[int, Light], ...]:
        """(node, light) of the KHR_lights_punctual lights, placed by the nodes' matrices."""
        listed = self.document.at("extensions", "KHR_lights_punctual").items("lights")
        return tuple(
            (k, light)
            for k, matrix in world.items()
            if (light := self._light(self.nodes[k].item, listed, matrix)) is not None
        )

    def _light(self, node: Item, listed: Sequence[Item], matrix: F64) -> Light | None:
        hung = node.at("extensions", "KHR_lights_punctual")
        if not hung.has("light"):
            return None
        light = listed[hung.index("light", listed, "lights")]
        if light.has("range"):
            # A range only bounds the cost of a light; light itself falls off without an end.
            self._warn(light, "its range is left out: it lights as far as it reaches")
        # Watts from lumens, by channel; it shines along its node's -Z.
        strength = light.number("intensity", 1.0) * WATTS_PER_LUMEN
        red, green, blue = (
            max(c * strength, 0.0) for c in light.floats("color", 3, (1.0, 1.0, 1.0))
        )
        position, direction = triple(matrix[:3, 3]), triple(-matrix[:3, 2])
        # Of the three types only the spot has a cone.
        kind = light.text("type")
        if kind == "directional":
            return DirectionalLight(direction=direction, irradiance=(red, green, blue))
        if kind == "point":
            return PointLight(position=position, intensity=(red, green, blue))
        if kind != "spot":
            raise light.error(f"has the unknown type '{kind}'")
        inner, outer = _cone_deg(light.child("spot"))
        return SpotLight(position, direction, (red, green, blue), inner, outer)

    def camera(self, world: dict[int, F64]) -> Camera | None:
        """The first perspective camera of the scene."""
        cameras = self.document.items("cameras")
        # The first node that holds one of a kind that we have.
        for k, matrix in world.items():
            node = self.nodes[k].item
            if not node.has("camera"):
                continue
            item = cameras[node.index("camera", cameras, "cameras")]
            doubts: list[str] = []
            camera = placed_camera(item, matrix, doubts)
            for doubt in doubts:
                self._warn(item, doubt)
            if camera is not None:
                return camera
        return None

    def _warn(self, item: Item, problem: str) -> None:
        self.warnings.append(f"{self.document.file}: {item.place}: {problem}")


def _cone_deg(spot: Item) -> tuple[float, float]:
    """Inner and outer half angle; the file has radians."""
    inner = math.degrees(spot.number("innerConeAngle", 0.0))
    outer = math.degrees(spot.number("outerConeAngle", math.pi / 4.0))
    outer = float(np.clip(outer, 0.1, 89.0))
    return float(np.clip(inner, 0.0, outer)), outer
