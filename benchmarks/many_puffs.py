"""What many volumes cost by what changes: `python benchmarks/many_puffs.py [COUNT]`

Puffs of smoke of 24^3 voxels over a floor, in the sun and a sky, either apart from each other or
all in one place (`--together`). Prints the processor time of a first frame with its shaders, of a
new light, of one puff that moved and of a new view, and with `--passes` what each stage takes.
"""

from __future__ import annotations

import argparse
import dataclasses
import time
from typing import Any

import numpy as np

import airlight as al

VOXELS = 24
SIZE = (96, 54)
SPACING_M = 0.8
REPEATS = 3


def lumpy_ball() -> np.ndarray:
    """A density (z, y, x) that some smooth noise eats into."""
    axis = (np.arange(VOXELS) + 0.5) / VOXELS * 2 - 1
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    waves = np.random.default_rng(5).normal(0.0, 4.0, (12, 3))
    lumps = sum(np.sin(a * x + b * y + c * z + 3 * a) for a, b, c in waves) / 12
    return np.clip(2.0 - 2.5 * np.sqrt(x * x + y * y + z * z) + 1.5 * lumps, 0, 1)


def placed(index: int, across: int, *, together: bool, rng: np.random.Generator) -> np.ndarray:
    """4x4: turned about the vertical, stretched, in a square of its own or in the one place."""
    angle = rng.uniform(0, 2 * np.pi)
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) * rng.uniform(0.2, 0.35, 3)
    centre = rng.uniform((-0.2, 0.5, -0.2), (0.2, 1.2, 0.2))
    if not together:
        square = np.array(divmod(index, across)) - 0.5 * (across - 1)
        centre[[2, 0]] += SPACING_M * square
    matrix[:3, 3] = centre
    return matrix


def puffs(count: int, *, together: bool) -> al.Scene:
    """So many puffs over a floor."""
    rng, density = np.random.default_rng(1), lumpy_ball()
    across = int(np.ceil(np.sqrt(count)))
    half = 1.0 + 0.5 * SPACING_M * across
    corners = np.array([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]])
    floor = al.Geometry(corners.astype(np.float32), np.array([[0, 2, 1], [0, 3, 2]], np.uint32))
    return al.Scene(
        meshes=(al.Mesh(floor, al.Material(base_color=(0.15, 0.14, 0.12))),),
        volumes=tuple(
            al.Volume(
                sigma_t=8.0,
                albedo=0.95,
                g=0.3,
                density=density,
                world_from_volume=placed(i, across, together=together, rng=rng),
            )
            for i in range(count)
        ),
        lights=(al.DirectionalLight(direction=(0.6, -0.7, -0.4), irradiance=(6.0, 5.4, 4.5)),),
        environment=al.Environment(radiance=(0.12, 0.19, 0.32)),
        camera=al.Camera(position=(0.0, 0.8 * half, 2.2 * half), target=(0.0, 0.4, 0.0)),
    )


def spent(made: al.Renderer, **changed: Any) -> tuple[float, al.Image | None]:
    """Seconds of processor time of a frame, and its image."""
    before = time.process_time()
    image = made.frame(**changed)
    return time.process_time() - before, image


def changes(scene: al.Scene, k: int) -> dict[str, dict[str, object]]:
    """The k-th of each kind of change to the scene."""
    sun, eye = scene.lights[0], scene.camera
    to_world = np.array(scene.volumes[0].world_from_volume)
    to_world[:3, 3] += 0.05 * (k + 1)
    moved = dataclasses.replace(scene.volumes[0], world_from_volume=to_world)
    turned = dataclasses.replace(sun, direction=(0.6 - 0.02 * (k + 1), -0.7, -0.4))
    x, y, z = eye.position
    return {
        "new light": {"lights": (turned,)},
        "one moved": {"volumes": (moved, *scene.volumes[1:])},
        "new view": {"camera": dataclasses.replace(eye, position=(x + 0.1 * (k + 1), y, z))},
    }


def main() -> None:
    """Measure one scene."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("count", type=int, nargs="?", default=100)
    parser.add_argument("--technique", default="lpv-scatter")
    parser.add_argument("--together", action="store_true", help="all in one place")
    parser.add_argument("--passes", action="store_true", help="what each stage takes, ms")
    parser.add_argument("--save", help="the first frame, an image file")
    asked = parser.parse_args()
    scene = puffs(asked.count, together=asked.together)

    with al.Renderer(scene, asked.technique, SIZE) as made:
        seconds, image = spent(made)
        print(f"first frame {seconds:6.2f} s")
        if asked.save and image:
            image.save(asked.save)
        # The first change of a kind compiles what it alone needs.
        for name in changes(scene, 0):
            times = [spent(made, **changes(scene, k)[name])[0] for k in range(REPEATS)]
            print(f"{name:11s} {np.median(times):6.2f} s")
            if asked.passes:
                made.commands.is_timed, made.commands.stage_ms = True, {}
                made.frame(**changes(scene, REPEATS)[name])
                stages = sorted(made.commands.stage_ms.items(), key=lambda x: -x[1])
                print("   ", ", ".join(f"{stage} {ms:.0f}" for stage, ms in stages if ms >= 5))
                made.commands.is_timed = False


if __name__ == "__main__":
    main()
