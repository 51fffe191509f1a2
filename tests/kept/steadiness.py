"""How steady a lattice's light is: while cells are shifted, and while meshes are cut or flipped.

    python tests/kept/steadiness.py [SCENE ...] [--technique NAME] [--resolution 32 48 64 96]

None of it changes the scene, so that the energy of indirect light should hold. A line per scene:
its energy in ten lattices, each a tenth of a cell farther along all axes, over their mean; then,
over that of the first, with every mesh cut into two and with all triangles facing the other way
(of two-sided materials alone that is the same scene); then at other resolutions. SCENE: a builtin
one, or a scene file.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import airlight
from airlight.scene import Geometry, Mesh, Scene
from airlight.scene.along import bounds_along

SIZE = (96, 54)
SHIFTS = np.arange(10) / 10.0
_SEED = 1


@dataclass(frozen=True)
class Steadiness:
    """Energies of indirect light, each over another: `shifted` (10,) over their mean."""

    shifted: Sequence[float]
    cut: float
    flipped: float

    @property
    def spread(self) -> float:
        """How much more the brightest of the shifted lattices has than the darkest."""
        return max(self.shifted) / min(self.shifted) - 1.0


def energy(scene: Scene, technique: str, settings: dict[str, Any]) -> float:
    """The sum of the indirect layer."""
    image = airlight.render(scene, technique=technique, size=SIZE, settings=settings)
    return float(image.layers["indirect"].sum())


def shifted_bounds(scene: Scene, resolution: int, cells: float) -> tuple[float, ...]:
    """A lattice's `bounds` around the scene, that many cells farther along all axes."""
    low, high = bounds_along(scene, np.eye(3))
    cell = float((high - low).max()) / (resolution - 4)
    shift = cells * cell
    return (*(low - cell + shift).tolist(), *(high + cell + shift).tolist())


def cut(scene: Scene) -> Scene:
    """Every mesh as two, each of about half of its triangles."""
    rng, made = np.random.default_rng(_SEED), list[Mesh]()
    for mesh in scene.meshes:
        g = mesh.geometry
        is_first = rng.random(len(g.indices)) < 0.5
        parts = [g.indices[part] for part in (is_first, ~is_first) if part.any()]
        made += [replace(mesh, geometry=Geometry(g.positions, i, g.normals, g.uvs)) for i in parts]
    return replace(scene, meshes=tuple(made))


def flipped(scene: Scene) -> Scene:
    """Every triangle the other way round, with its normals."""

    def turned(g: Geometry) -> Geometry:
        indices = np.ascontiguousarray(g.indices[:, ::-1])
        return Geometry(g.positions, indices, -g.normals, g.uvs)

    return replace(
        scene, meshes=tuple(replace(m, geometry=turned(m.geometry)) for m in scene.meshes)
    )


def measure(scene: Scene, technique: str = "lpv", resolution: int = 32) -> Steadiness:
    """All of it for one scene whose walls stand along the world's axes."""

    def at(cells: float, seen: Scene = scene) -> float:
        bounds = shifted_bounds(scene, resolution, cells)
        return energy(seen, technique, {"bounds": bounds, "resolution": resolution})

    energies = np.array([at(float(cells)) for cells in SHIFTS])
    return Steadiness(
        (energies / energies.mean()).tolist(),
        at(0.0, cut(scene)) / energies[0],
        at(0.0, flipped(scene)) / energies[0],
    )


def main() -> None:
    """Print a line per scene."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scenes", nargs="*", default=["builtin:cornell", "builtin:room"])
    parser.add_argument("--technique", default="lpv")
    parser.add_argument("--resolution", type=int, nargs="+", default=[32])
    given = parser.parse_args()
    for name in given.scenes:
        scene = airlight.load(name)
        found = measure(scene, given.technique, given.resolution[0])
        shares = " ".join(f"{share:.3f}" for share in found.shifted)
        print(f"{name}: spread {found.spread:.3f} ({shares}), cut {found.cut:.3f}", end="")
        sizes = [energy(scene, given.technique, {"resolution": n}) for n in given.resolution]
        finer = ", ".join(
            f"{n} cells {e / sizes[0]:.3f}" for n, e in zip(given.resolution, sizes, strict=True)
        )
        print(f", flipped {found.flipped:.3f}; {finer}", flush=True)


if __name__ == "__main__":
    main()
