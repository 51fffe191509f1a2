"""What is allowed but hardly meant: said as a warning, with what to do about it."""

from __future__ import annotations

import numpy as np

from ..camera import view_directions
from ..checks import F64
from ..medium import medium_box
from ..scene import Scene
from .probe import Probe

THICK = 6.0
"""Optical depths of fog through which 0.25 % of the light comes."""
_OPEN = 0.1
"""Of the view: so much of the sky shows an edge."""
_SEEN = 0.1
"""Of the light before the sky that fog takes: so much is seen to end."""


def doubts(scene: Scene) -> tuple[str, ...]:
    """A line for everything that is probably a mistake; most often lengths that are not metres."""
    return tuple(line for line in (_thick_fog(scene) or _fog_edge(scene),) if line)


def _fog_edge(scene: Scene) -> str:
    """Whether the sky shows where fog ends that nobody has given an end."""
    medium = scene.medium
    if medium is None or medium.bounds is not None or medium.top is not None or not scene.meshes:
        return ""
    low, high = (np.asarray(corner, np.float64) for corner in scene.bounds)
    eye = np.array(scene.camera.position)
    box = medium_box(medium, low, high, eye)
    # Of an endless one the top alone can be seen, from above.
    if medium.endless:
        above_m = float(eye[1] - box[1][1])
        if above_m < 0.0:
            return ""
        return (
            f"the camera is {above_m:.3g} m above the fog, which ends at a height of "
            f"{box[1][1]:.3g} m, a quarter above the scene: top in [medium] says where"
        )
    depth = max(medium.sigma_t) * _lengths_to_sky(scene, eye, box)
    if len(depth) == 0 or float((1.0 - np.exp(-depth)).mean()) < _SEEN:
        return ""
    return (
        "fog without bounds ends with the box of the scene and the camera, in an edge before the "
        "sky: endless = true in [medium] lets it go on"
    )


def _lengths_to_sky(scene: Scene, eye: F64, box: tuple[F64, F64]) -> F64:
    """How far rays from the eye within the box go in it, metres, of those that meet no surface.

    None where hardly any of the view meets none.
    """
    directions = view_directions(scene.camera, 16, 9)
    eyes = np.tile(eye, (len(directions), 1))
    struck = np.isfinite(Probe.of(scene).cast(eyes, directions).distance)
    if struck.mean() > 1.0 - _OPEN:
        return np.zeros(0)
    with np.errstate(divide="ignore"):
        to_faces = (np.where(directions > 0.0, box[1], box[0]) - eye) / directions
    lengths: F64 = to_faces.min(axis=1)[~struck]
    return lengths


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
