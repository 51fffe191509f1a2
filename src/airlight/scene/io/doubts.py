"""What is allowed but hardly meant: said as a warning, with what to do about it."""

from __future__ import annotations

import numpy as np

from ..camera import view_directions
from ..scene import Scene
from .probe import Probe

THICK = 6.0
"""Optical depths of fog through which 0.25 % of the light comes."""


def doubts(scene: Scene) -> tuple[str, ...]:
    """A line for everything that is probably a mistake; most often lengths that are not metres."""
    return tuple(line for line in (_thick_fog(scene),) if line)


def _thick_fog(scene: Scene) -> str:
    """Whether fog hides a scene: up to its middle from outside, up to what is near from inside."""
    if scene.medium is None or not scene.meshes:
        return ""
    eye = np.array(scene.camera.position)
    low, high = (np.asarray(corner, np.float64) for corner in scene.bounds)
    # How far the nearest thing is that the fog could hide.
    path_m = float(np.linalg.norm(0.5 * (low + high) - eye))
    # From inside, what is near counts: a camera in a hall may have its subject before it.
    if np.all((low <= eye) & (eye <= high)):
        most = float(np.linalg.norm(high - low))
        if min(scene.medium.sigma_t) * most <= THICK:
            return ""
        path_m = _nearest(scene, most)
    # Fog in a box is no thicker than the box's diagonal.
    if scene.medium.bounds is not None:
        first, last = (np.array(corner) for corner in scene.medium.bounds)
        path_m = min(path_m, float(np.linalg.norm(last - first)))
    # Its optical depth on that path.
    depth = min(scene.medium.sigma_t) * path_m
    if depth <= THICK:
        return ""
    return (
        f"the camera looks through {path_m:.3g} m of fog, {depth:.0f} optical depths: nothing else "
        "will be seen. Lengths are metres: scale the mesh, or lower sigma_t"
    )


def _nearest(scene: Scene, most: float) -> float:
    """How far away a twentieth of what the camera sees is at most, metres; `most` for the sky."""
    directions = view_directions(scene.camera, 16, 9)
    eyes = np.tile(scene.camera.position, (len(directions), 1))
    distance = Probe.of(scene).cast(np.asarray(eyes, np.float64), directions).distance
    return float(np.quantile(np.minimum(distance, most), 0.05))
