"""What a file left out: a camera that frames the scene, and light to see it by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ..camera import Camera
from ..lights import PointLight
from ..scene import Scene
from .daylight import sun_and_sky, sun_for
from .framing import find_room, framing_box, framing_camera
from .probe import Probe

LAMP_RADIANCE = 8.0
"""W m^-2 sr^-1. Surfaces that emit less (screens, dials) do not count as a scene's light: beside
a sky of 1 to 4 they would hardly show."""


def with_default_camera(scene: Scene, probe: Callable[[], Probe] | None = None) -> Scene:
    """The scene with a camera that shows it well; the one it had is replaced.

    It is exposed by the picture: who gave no camera has not said how bright the scene is.
    `probe` gives the probe of the scene, for those who have it already.
    """
    is_air = scene.volumes and not scene.meshes
    framed = framing_box(*scene.bounds) if is_air else framing_camera(_probe(scene, probe))
    return replace(scene, camera=replace(framed, exposure_stops=None))


def with_default_lights(scene: Scene, probe: Callable[[], Probe] | None = None) -> Scene:
    """The scene, with a sun and a sky where nothing in it shines.

    Lights, an environment, or a surface that emits at least LAMP_RADIANCE count as shining.
    The sun is placed for the scene's camera (for a framing one where it is the default).
    A closed room, which no sun enters, gets a lamp under its ceiling too.
    `probe` gives the probe of the scene, for those who have it already.
    """
    if scene.lights or scene.light_groups or scene.environment is not None:
        return scene
    brightest = max((max(m.material.emission) for m in scene.meshes), default=0.0)
    if brightest >= LAMP_RADIANCE:
        return scene
    warnings = scene.warnings
    if brightest > 0.0:
        warnings += (
            f"its emissive surfaces are dim (radiance {brightest:g}): "
            "a default sun and sky were added",
        )
    probed = _probe(scene, probe)
    camera = framing_camera(probed) if scene.camera == Camera() else scene.camera
    towards_sun, lit_share = sun_for(probed, camera)
    sun, sky = sun_and_sky(towards_sun)
    lamps = _lamp(probed) if lit_share == 0.0 else ()
    if lamps:
        warnings += ("no daylight gets into this closed room: a lamp was hung under its ceiling",)
    return replace(scene, lights=(sun, *lamps), environment=sky, warnings=warnings)


def _probe(scene: Scene, known: Callable[[], Probe] | None) -> Probe:
    return known() if known else Probe.of(scene)


def _lamp(probe: Probe) -> tuple[PointLight, ...]:
    """A lamp that gives the floor of the room about 10 W m^-2, or none outside a room."""
    room = find_room(probe)
    if room is None:
        return ()
    x, _, z = (float(v) for v in (room.low + room.high) / 2.0)
    height = float(room.size[1])
    intensity = 10.0 * (0.85 * height) ** 2
    warm = (intensity, 0.9 * intensity, 0.75 * intensity)
    return (PointLight(position=(x, float(room.low[1]) + 0.85 * height, z), intensity=warm),)
