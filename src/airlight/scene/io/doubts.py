"""What is allowed but hardly meant: said as a warning, with what to do about it."""

from __future__ import annotations

import numpy as np

from ..scene import Scene

THICK = 6.0
"""Optical depths of fog through which 0.25 % of the light comes."""


def doubts(scene: Scene) -> tuple[str, ...]:
    """A line for everything that is probably a mistake; most often lengths that are not metres."""
    return tuple(line for line in (_thick_fog(scene),) if line)


def _thick_fog(scene: Scene) -> str:
    """Whether fog hides a scene that is seen from outside: up to its middle."""
    if scene.medium is None or not scene.meshes:
        return ""
    eye = np.array(scene.camera.position)
    low, high = (np.asarray(corner, np.float64) for corner in scene.bounds)
    if np.all((low <= eye) & (eye <= high)):
        return ""
    way = float(np.linalg.norm(0.5 * (low + high) - eye))
    if scene.medium.bounds is not None:
        first, last = (np.array(corner) for corner in scene.medium.bounds)
        way = min(way, float(np.linalg.norm(last - first)))
    depth = min(scene.medium.sigma_t) * way
    if depth <= THICK:
        return ""
    return (
        f"the camera looks through {way:.0f} m of fog, {depth:.0f} optical depths: nothing else "
        "will be seen. Lengths are metres: scale the mesh, or lower sigma_t"
    )
