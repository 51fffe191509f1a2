"""A useful subset of Mitsuba 3's scenes. What is dropped or approximated is in `warnings`.

Read: obj, ply, serialized, cube, rectangle, sphere, disk and cylinder, instances of shape groups
and merged shapes; diffuse, (rough)conductor, (rough)plastic, principled, glass without thickness,
twosided, mask, normalmap and null; bitmap and checkerboard; point, spot, directional, area,
constant and envmap; homogeneous and heterogeneous media of constants and grids with isotropic or
Henyey-Greenstein scattering; the sensors perspective and thinlens; <default>, <path>, $parameters,
<include>, <ref>.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...errors import SceneError
from ..camera import Camera
from ..environment import Environment
from ..lights import Light
from ..material import SIDES, Material
from ..medium import FILL_MARGIN, medium_box
from ..mesh import Mesh
from ..scene import Scene
from .files import naming
from .mitsuba_bumps import has_bumps, on_mesh
from .mitsuba_camera import camera_of
from .mitsuba_emitters import emitter, with_emission
from .mitsuba_lights import area_light, is_back
from .mitsuba_materials import NoSurface, material
from .mitsuba_media import Held, held_medium, medium_and_volumes
from .mitsuba_nodes import Node, walk
from .mitsuba_shapes import shape_geometries
from .mitsuba_textures import Source
from .mitsuba_xml import A_PART, read_tree

# Values that say how to render, not what: leaving them out changes no image.
_HOW = frozenset(
    (
        "main_specular_sampling_rate",
        "clearcoat_sampling_rate",
        "sampling_weight",
        "accel",
        "diffuse_reflectance_sampling_rate",
        "near_clip",
        "far_clip",
        "mis_compensation",
        "format",
        "sample_emitters",
        "silhouette_sampling_weight",
        "max_value",
        "has_spectral_extinction",
    )
)
_HOW_TAGS = ("integrator", "sampler", "film", "rfilter", "scene")


@dataclass
class _Found:
    meshes: list[Mesh] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    environment: Environment | None = None
    held: list[Held] = field(default_factory=list)
    groups: dict[int, list[Mesh]] = field(default_factory=dict)


def load_mitsuba(path: Path, parameters: Mapping[str, str] | None = None) -> Scene:
    """Read a Mitsuba scene. What was dropped or approximated is in the scene's `warnings`.

    `parameters` are values of its $names, which win over its defaults. Raises SceneError for broken
    or dangerous XML, files that are missing or that no scene may name, and plugins that do not
    exist.
    """
    path = Path(path)
    try:
        with naming(path):
            tree, folders = read_tree(path, parameters or {})
            source = Source(path, folders)
            for name in folders.skipped:
                source.note(
                    f"the search path '{name}' is no folder that the scene may name, and nothing "
                    "is looked for in it"
                )
            scene = _scene(tree, source)
    except SceneError as error:
        # A part of a scene names files from the folder of the file that includes it.
        if error.problem != "file not found" or str(error.where) == str(path):
            raise
        told = SceneError(error.problem, where=error.where, remedy=f"{error.remedy} {A_PART}")
        raise told from None
    except (TypeError, AttributeError) as error:
        # A value of another kind than its place asks for: a vector as a field of view, say.
        raise SceneError(f"a value does not fit its place ({error})", where=path) from error
    return replace(scene, warnings=tuple(source.notes), name=path.stem)


def _scene(tree: Node, source: Source) -> Scene:
    # Everything that stands in the scene, in the file's order.
    found = _Found()
    for node in tree.children:
        if node.tag == "shape":
            _read_shape(node, found, source)
        elif node.tag == "emitter":
            _read_emitter(node, found, source)
    # Area emitters have been read with the shapes that refer to them, or not at all.
    for node in tree.children:
        if node.tag == "emitter" and node.kind == "area" and not node.read:
            source.note(f"{node} lights nothing: no shape refers to it")
            node.read.update(node.values)
    # The camera, and the medium that it stands in.
    sensors = tree.all("sensor")
    if len(sensors) > 1:
        source.note(f"{len(sensors)} sensors: the first one is used")
    camera = camera_of(sensors[0], source) if sensors else None
    around = next((c for c in sensors[0].children if c.tag == "medium"), None) if sensors else None
    medium, volumes = medium_and_volumes(found.held, around, source)
    # Mitsuba hides the environment by a switch of the integrator.
    integrator = tree.first("integrator")
    if integrator is not None and integrator.get("hide_emitters", False) and found.environment:
        found.environment = replace(found.environment, visible=False)
    # Say what was not read.
    _tell_unread(tree, source)
    scene = Scene(
        meshes=tuple(found.meshes),
        lights=tuple(found.lights),
        environment=found.environment,
        camera=camera or Camera(),
        medium=medium,
        volumes=volumes,
    )
    # Without a sensor the camera frames what there is.
    if camera is None:
        from .defaults import with_default_camera

        source.note("there is no sensor: the camera frames the scene")
        scene = with_default_camera(scene)
    return _with_filling_medium(scene)


def _with_filling_medium(scene: Scene) -> Scene:
    """A medium without bounds, which `reference.write_mitsuba` gave a box, without them again."""
    medium = scene.medium
    if medium is None or medium.bounds is None or not (scene.meshes or scene.volumes):
        return scene
    # Either kind is given a box by a rule: bounds that follow the rule are the writer's, others an
    # author's.
    filling = replace(medium, bounds=None)
    endless = replace(filling, endless=True, top=medium.bounds[1][1])
    for unbound in (filling, endless):
        box = np.array(medium_box(unbound, *scene.bounds, scene.camera.position))
        off = np.abs(np.array(medium.bounds) - box).max()
        if off < 0.1 * FILL_MARGIN * np.linalg.norm(box[1] - box[0]):
            return replace(scene, medium=unbound)
    return scene


def _read_shape(node: Node, found: _Found, source: Source) -> None:
    """Add what a shape is: a group by itself is nothing, each of its instances all of it."""
    if node.kind == "shapegroup":
        return
    if node.kind == "merge":
        for child in node.all("shape"):
            _read_shape(child, found, source)
        return
    if node.kind == "instance":
        _read_instance(node, found, source)
        return
    _read_surface(node, found, source)


def _read_instance(node: Node, found: _Found, source: Source) -> None:
    """Add the meshes of a group once more; they share geometries and materials."""
    group = node.first("shape")
    if group is None or group.kind != "shapegroup":
        raise SceneError(f"{node} has no shapegroup inside")
    # The group's meshes are read once, and placed once for each instance.
    key = group.element
    if key not in found.groups:
        own = _Found()
        for child in group.all("shape"):
            _read_shape(child, own, source)
        if own.lights or own.held:
            source.note(f"{group}: lights and media in it are left out")
        found.groups[key] = own.meshes
    to_world = np.asarray(node.get("to_world", np.eye(4)), np.float64)
    for mesh in found.groups[key]:
        placed = to_world @ mesh.world_from_object
        found.meshes.append(replace(mesh, world_from_object=placed, name=node.id or mesh.name))


def _read_surface(node: Node, found: _Found, source: Source) -> None:
    # The medium that the surface encloses.
    interior = next((c for c in node.all("medium") if c.name == "interior"), None)
    exterior = next((c for c in node.all("medium") if c.name == "exterior"), None)
    if interior is not None:
        found.held.append(held_medium(node, interior, exterior, source))
    if re.fullmatch(r"mesh_\d+_back", node.id) or is_back(node):
        return  # the other side of a glowing sheet, as reference/mitsuba_shapes.py writes it
    # Its material; a surface without one is the border of a medium alone.
    try:
        made = material(node.first("bsdf"), source)
    except NoSurface:
        node.read.update(node.values)
        return
    # A glowing rectangle, disk or sphere is an area light, all else a mesh.
    made = _glowing(node, made, source)
    light = area_light(node, made)
    if light is not None:
        found.lights.append(light)
        return
    is_bumpy = has_bumps(node)
    for part in shape_geometries(node, source):
        worn = on_mesh(made, part.geometry, part.world_from_object) if is_bumpy else made
        found.meshes.append(Mesh(part.geometry, worn, part.world_from_object, name=node.id))


def _glowing(node: Node, made: Material, source: Source) -> Material:
    light = node.first("emitter")
    if light is None:
        return made
    made = with_emission(made, light, source)
    if made.two_sided and not node.id.endswith("_front"):
        # Reflecting on both sides and glowing on one cannot be said: the glow decides.
        if max(made.base_color) > 0.0:
            source.note(f"{node} glows: its back, which reflects in Mitsuba, is black")
        made = replace(made, **SIDES["front"])
    return made


def _read_emitter(node: Node, found: _Found, source: Source) -> None:
    if node.kind == "area":
        return  # a definition: the shapes that refer to it glow
    light = emitter(node, source)
    if isinstance(light, Environment):
        if found.environment is not None:
            source.note(f"{node}: a second environment is left out")
            return
        found.environment = light
    elif light is not None:
        found.lights.append(light)


def _tell_unread(tree: Node, source: Source) -> None:
    """Every value that nobody asked for was left out of the scene: say so."""
    used = _used(tree)
    for node in used:
        left = sorted(set(node.values) - node.read - _HOW)
        if left and node.tag not in _HOW_TAGS:
            source.note(f"{node}: left out: {', '.join(left)}")


def _used(tree: Node) -> list[Node]:
    """Nodes below shapes, emitters and the first sensor; definitions nobody uses do not count."""
    roots = [c for c in tree.children if c.tag in ("shape", "emitter")] + tree.all("sensor")[:1]
    seen: dict[int, Node] = {}
    for root in roots:
        for node in walk(root):
            seen.setdefault(id(node.read), node)
    return list(seen.values())
