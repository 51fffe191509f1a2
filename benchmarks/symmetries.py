"""How much images change where they must not: `python benchmarks/symmetries.py SCENE.toml ...`

Each scene is drawn as it is, then with what no light can notice: its lattice shifted by tenths of a
cell, its triangles cut, turned over or in another order, its meshes split, the whole scene turned
or tilted; and with other numbers of cells, which should change little. Prints, for each, the energy
of the image and of its indirect light, and the relative L2 of both, beside the scene as it is.
`--truth` takes arrays of path-traced layers, named `scene__layer` (one .npz), for L2 beside those.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import airlight as al
from airlight.lighting.lattice_box import lattice_axes, lattice_box
from airlight.maths.transforms import box_along
from airlight.scene.material import Material
from airlight.scene.medium import filled_box
from airlight.scene.mesh import Geometry, Mesh
from airlight.scene.placing import moved_camera, moved_point, moved_vector
from airlight.scene.scene import Scene

SIZE = (96, 54)
LAYERS = ("radiance", "indirect", "multiple_scatter")
CELLS = (32, 48, 64, 96)
Drawn = dict[str, np.ndarray]


# ---- The same scene, otherwise written ----------------------------------------------------------


def settled(scene: Scene) -> Scene:
    """The scene with a medium that stays where it is when the rest is turned."""
    medium = scene.medium
    if medium is None or medium.bounds is not None or medium.endless:
        return scene
    low, high = filled_box(*scene.bounds, scene.camera.position)
    box = (tuple(map(float, low)), tuple(map(float, high)))
    return dataclasses.replace(scene, medium=dataclasses.replace(medium, bounds=box))


def placed(scene: Scene, matrix: np.ndarray, about_y_deg: float | None) -> Scene | None:
    """The scene through a rigid `matrix`; None where a map or a medium's box cannot follow."""
    if scene.medium is not None and about_y_deg not in (90.0,):
        return None
    environment = scene.environment
    if environment is not None and environment.map is not None:
        if about_y_deg is None:
            return None
        degrees = environment.rotation_deg + about_y_deg
        environment = dataclasses.replace(environment, rotation_deg=degrees)
    medium = scene.medium
    if medium is not None and medium.bounds is not None:
        low, high = box_along(matrix[:3, :3], *map(np.array, medium.bounds))
        box = (tuple(map(float, low)), tuple(map(float, high)))
        medium = dataclasses.replace(medium, bounds=box)
    return dataclasses.replace(
        scene,
        meshes=tuple(
            dataclasses.replace(m, world_from_object=matrix @ m.world_from_object)
            for m in scene.meshes
        ),
        lights=tuple(_placed_light(light, matrix) for light in scene.lights),
        volumes=tuple(
            dataclasses.replace(v, world_from_volume=matrix @ v.world_from_volume)
            for v in scene.volumes
        ),
        environment=environment,
        medium=medium,
        camera=moved_camera(scene.camera, matrix),
    )


def _placed_light(light: Any, matrix: np.ndarray) -> Any:
    moved = {
        name: move(getattr(light, name), matrix)
        for name, move in (
            ("position", moved_point),
            ("direction", moved_vector),
            ("up", moved_vector),
        )
        if hasattr(light, name)
    }
    return dataclasses.replace(light, **moved)


def turned(scene: Scene, degrees: float) -> Scene | None:
    """The scene turned about +Y."""
    return placed(scene, _rotation((0.0, 1.0, 0.0), degrees), degrees)


def tilted(scene: Scene) -> Scene | None:
    """The scene turned about an axis that is none of the world's."""
    return placed(scene, _rotation((0.48, 0.6, 0.64), 33.0), None)


def _rotation(axis: tuple[float, float, float], degrees: float) -> np.ndarray:
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return matrix


def of_meshes(scene: Scene, change: Callable[[Mesh], tuple[Mesh, ...]]) -> Scene:
    """The scene with the meshes that `change` makes of each."""
    return dataclasses.replace(scene, meshes=tuple(new for m in scene.meshes for new in change(m)))


def cut(mesh: Mesh) -> tuple[Mesh, ...]:
    """Each triangle cut in two from a corner to the opposite edge's middle, and these again."""
    geometry = mesh.geometry
    for corner in (0, 1):
        geometry = _cut_once(geometry, corner)
    return (dataclasses.replace(mesh, geometry=geometry),)


def _cut_once(geometry: Geometry, corner: int) -> Geometry:
    a, b, c = np.roll(geometry.indices, -corner, axis=1).T
    count = len(geometry.positions)
    middle = np.arange(len(a), dtype=np.uint32) + np.uint32(count)

    def with_middles(values: np.ndarray | None) -> np.ndarray | None:
        return None if values is None else np.concatenate([values, 0.5 * (values[b] + values[c])])

    indices = np.concatenate([np.stack([a, b, middle], 1), np.stack([a, middle, c], 1)])
    arrays = (geometry.normals, geometry.uvs, geometry.colors)
    return Geometry(
        with_middles(geometry.positions), indices, *(with_middles(values) for values in arrays)
    )


def split(mesh: Mesh) -> tuple[Mesh, ...]:
    """Two meshes, each with every other triangle."""
    if len(mesh.geometry.indices) < 2:
        return (mesh,)
    return tuple(_of_triangles(mesh, slice(first, None, 2)) for first in (0, 1))


def shuffled(mesh: Mesh) -> tuple[Mesh, ...]:
    """The triangles in another order."""
    order = np.random.default_rng(7).permutation(len(mesh.geometry.indices))
    return (_of_triangles(mesh, order),)


def flipped(mesh: Mesh) -> tuple[Mesh, ...]:
    """Two-sided triangles seen from behind."""
    if not mesh.material.two_sided:
        return (mesh,)
    geometry = mesh.geometry
    over = dataclasses.replace(
        geometry, indices=geometry.indices[:, ::-1], normals=-geometry.normals
    )
    return (dataclasses.replace(mesh, geometry=over),)


def _of_triangles(mesh: Mesh, chosen: Any) -> Mesh:
    kept = dataclasses.replace(mesh.geometry, indices=mesh.geometry.indices[chosen])
    return dataclasses.replace(mesh, geometry=kept)


def rewritten(scene: Scene) -> Iterator[tuple[str, Scene | None]]:
    """Names, and the scene in other words."""
    yield "cut", of_meshes(scene, cut)
    yield "split", of_meshes(scene, split)
    yield "flip", of_meshes(scene, flipped)
    yield (
        "order",
        dataclasses.replace(
            of_meshes(scene, shuffled), meshes=of_meshes(scene, shuffled).meshes[::-1]
        ),
    )
    yield "turn 90", turned(scene, 90.0)
    yield "turn 37", turned(scene, 37.0)
    yield "tilt", tilted(scene)


# ---- Lattices elsewhere ------------------------------------------------------------------------


def shifted(scene: Scene, cells: int, tenths: int) -> Scene:
    """The scene with two black specks so far outside that its lattice lies elsewhere.

    They stand at the corners of a box a cell larger than what the scene fills, along the lattice's
    axes, moved by that many tenths of a cell.
    """
    axes = np.array(lattice_axes(scene))
    low, high = lattice_box(scene, in_medium=True, axes=axes_of(axes))
    cell = float(np.max(np.subtract(high, low))) / (cells - 4)
    by = 0.1 * tenths * cell * np.array((1.0, 0.6, 0.3))
    corners = np.array((low - cell + by, high + cell + by))
    speck = 1e-4 * cell * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    inwards = np.array([[[1.0]], [[-1.0]]])
    positions = (corners[:, None, :] + inwards * speck).reshape(6, 3) @ axes
    specks = Geometry(positions.astype(np.float32), np.arange(6, dtype=np.uint32).reshape(2, 3))
    black = Material(base_color=(0.0, 0.0, 0.0), specular=0.0)
    return dataclasses.replace(scene, meshes=(*scene.meshes, Mesh(specks, black, name="specks")))


def axes_of(turn: np.ndarray) -> Any:
    """Three rows as tuples."""
    return tuple(tuple(map(float, row)) for row in turn)


# ---- Drawing and telling ------------------------------------------------------------------------


def drawn(scene: Scene, technique: str, **settings: Any) -> Drawn:
    """The layers of a still."""
    image = al.render(scene, technique=technique, size=SIZE, settings=settings)
    found = {"radiance": image.radiance}
    return found | {k: image.layers[k] for k in LAYERS[1:] if k in image.layers}


def l2(image: np.ndarray, truth: np.ndarray) -> float:
    """Relative L2, both clamped at the truth's 99.5th percentile."""
    cap = np.percentile(truth, 99.5)
    image, truth = np.minimum(image, cap), np.minimum(truth, cap)
    return float(np.sqrt(((image - truth) ** 2).sum() / max((truth**2).sum(), 1e-30)))


def told(name: str, image: Drawn, base: Drawn, truth: Drawn) -> dict[str, Any]:
    """Energy and L2 of each layer beside the scene as it is, and L2 beside the truth."""
    row: dict[str, Any] = {"what": name}
    for layer in LAYERS:
        if layer in image and layer in base and base[layer].sum() > 0.01 * base["radiance"].sum():
            energy = float(image[layer].sum() / base[layer].sum())
            row[layer] = [round(energy, 4), round(l2(image[layer], base[layer]), 4)]
            if layer in truth:
                against = float(image[layer].sum() / truth[layer].sum())
                row[layer] += [round(against, 4), round(l2(image[layer], truth[layer]), 4)]
    return row


def measure(path: Path, options: argparse.Namespace, truth: Drawn) -> Iterator[dict[str, Any]]:
    """A row for each variant of one scene."""
    scene = settled(al.load(path))
    base = drawn(scene, options.technique)
    yield told("as it is", base, base, truth)
    if "words" in options.what:
        for name, other in rewritten(scene):
            if other is not None:
                yield told(name, drawn(other, options.technique), base, truth)
    if "shift" in options.what:
        first = drawn(shifted(scene, 32, 0), options.technique)
        yield told("shift .0", first, base, truth)
        for tenths in (1, 2, 3, 5, 7):
            image = drawn(shifted(scene, 32, tenths), options.technique)
            yield told(f"shift .{tenths}", image, first, truth)
    if "cells" in options.what:
        for cells in CELLS:
            image = drawn(scene, options.technique, resolution=cells)
            yield told(f"{cells} cells", image, base, truth)


def main() -> int:
    """Print a line of JSON for each scene and variant."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--technique", default="auto")
    parser.add_argument("--what", nargs="+", default=["words", "shift", "cells"])
    parser.add_argument("--truth", type=Path)
    options = parser.parse_args()
    for path in options.scenes:
        truth: Drawn = {}
        if options.truth:
            with np.load(options.truth) as kept:
                start = f"{path.stem}__"
                names = [k for k in kept.files if k.startswith(start)]
                truth = {k.removeprefix(start): kept[k].astype(np.float64) for k in names}
        for row in measure(path, options, truth):
            print(json.dumps({"scene": path.stem, **row}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
