"""What a file left out: a camera that frames the scene, and light to see it by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..camera import Camera
from ..checks import F64
from ..lights import PointLight
from ..limits import check_extent
from ..scene import Scene
from ..studio import incident_stops, studio_light
from .daylight import OPEN_SHARE, sun_and_sky, sun_for
from .dense_part import air_beside, dense_box
from .framing import Room, find_room, framing_box, framing_camera
from .outline import outline
from .probe import Probe

LIGHT_RADIANCE = 8.0
"""W m^-2 sr^-1. Surfaces that emit less (screens, dials) do not count as a scene's light: beside
a sky of 1 to 4 they would hardly show."""


def with_default_camera(scene: Scene, probe: Callable[[], Probe] | None = None) -> Scene:
    """The scene with a camera that shows it well; the one it had is replaced.

    It is exposed by the image: who gave no camera has not said how bright the scene is.
    `probe` gives the probe of the scene, for those who have it already.
    """
    # Smoke and clouds are framed by where they are; rays would find no surface of theirs.
    check_extent(scene)
    is_air = scene.volumes and not scene.meshes
    framed = framing_box(*dense_box(scene)) if is_air else _framed(scene, _probe(scene, probe))
    return replace(scene, camera=replace(framed, exposure_stops=None))


def with_default_lights(
    scene: Scene,
    probe: Callable[[], Probe] | None = None,
    *,
    is_scene_file: bool = False,
    is_exposed: bool = False,
) -> Scene:
    """The scene, with light where it has none of its own: a studio around things in the open, a sun
    and a sky for rooms and for air alone.

    Lights and an environment are light; what emits is, too, in a scene file (`is_scene_file`),
    whose author says what he wants. Of a bare model it is where it lights a room with at least
    LIGHT_RADIANCE: a glowing part of something that stands in the open is seen by other light.

    The light is placed for the scene's camera (for a framing one where it is the default). What
    that sees is exposed by the light that falls on it, in rooms by the image, unless `is_exposed`
    says that somebody chose an exposure.
    A closed room, which no sun enters, gets a lamp under its ceiling too. `probe` gives the probe
    of the scene, for those who have it already. What was added is in the scene's warnings where
    something might have been meant to be the light.
    """
    # A scene with light of its own stays as it is.
    if scene.lights or scene.light_groups or scene.environment is not None:
        return scene
    if any(volume.is_emissive for volume in scene.volumes):
        return scene  # fire is seen by its own light
    # Emissive surfaces of a scene file are its light, even a dim one, which gets a warning.
    brightest = max((max(m.material.emission) for m in scene.meshes), default=0.0)
    if is_scene_file and brightest > 0.0:
        return scene if brightest >= LIGHT_RADIANCE else _told_dim(scene, brightest)
    # What the scene looks like from within decides where its sun stands.
    probed = _probe(scene, probe)
    room = find_room(probed)
    if brightest >= LIGHT_RADIANCE and room is not None:
        return scene
    camera = _framed(scene, probed) if scene.camera == Camera() else scene.camera
    towards_sun, lit_share = sun_for(probed, camera)
    # In the open light falls on all that is seen; into a room it has to find its way.
    if room is None and lit_share >= OPEN_SHARE and (scene.meshes or scene.volumes):
        lit = _in_the_open(scene, camera, towards_sun, brightest)
    else:
        lit = _in_daylight(scene, room, camera, (towards_sun, lit_share), brightest)
    # An exposure that somebody chose stays; one of 0 was for no light at all.
    is_chosen = is_exposed or scene.camera.exposure_stops not in (0.0, None)
    return replace(lit, camera=scene.camera) if is_chosen else lit


def _told_dim(scene: Scene, brightest: float) -> Scene:
    line = f"emissive surfaces are its only light, and dim (radiance {brightest:g}): add a "
    return replace(scene, warnings=(*scene.warnings, line + "[[light]] or an [environment]"))


def _in_the_open(scene: Scene, camera: Camera, towards_light: F64, brightest: float) -> Scene:
    """Things stand in a studio, air is seen before the sky; exposed by what falls on them."""
    key, around = (studio_light if scene.meshes else sun_and_sky)(towards_light)
    stops = incident_stops(key, around, np.subtract(camera.position, camera.target))
    told = _said(brightest, "a studio's light was", has_room=False)
    return replace(
        scene,
        lights=(key,),
        environment=around,
        warnings=(*scene.warnings, *told),
        camera=replace(scene.camera, exposure_stops=stops),
    )


def _in_daylight(
    scene: Scene, room: Room | None, camera: Camera, sun: tuple[F64, float], brightest: float
) -> Scene:
    """A sun and its sky, exposed by the image; a closed room, which they cannot reach, is lit from
    within, too. `sun`: the unit vector towards it, and the share of the view that it lights."""
    towards_sun, lit_share = sun
    light, sky = sun_and_sky(towards_sun)
    lamps = _lamp(room, camera) if room is not None and lit_share == 0.0 else ()
    told = _said(brightest, "a default sun and sky were", has_room=room is not None)
    if lamps:
        told += ("no daylight gets into this closed room: a lamp was hung under its ceiling",)
    return replace(
        scene,
        lights=(light, *lamps),
        environment=sky,
        warnings=(*scene.warnings, *told),
        camera=replace(scene.camera, exposure_stops=None),
    )


def _said(brightest: float, added: str, *, has_room: bool) -> tuple[str, ...]:
    """Why surfaces that emit, at most `brightest`, were not taken for the scene's light."""
    if brightest <= 0.0:
        return ()
    why = "light no room"
    if has_room or brightest < LIGHT_RADIANCE:
        why = f"are dim (radiance {brightest:g})"
    return (f"its emissive surfaces {why}: {added} added",)


def _framed(scene: Scene, probed: Probe) -> Camera:
    points = outline(scene)
    return framing_camera(probed, np.concatenate([points, air_beside(scene, points)]))


def _probe(scene: Scene, known: Callable[[], Probe] | None) -> Probe:
    return known() if known else Probe.of(scene)


def _lamp(room: Room, camera: Camera) -> tuple[PointLight, ...]:
    """A lamp that gives the floor of the room about 10 W m^-2; none for a camera outside of it."""
    # The room of a camera outside is open to daylight, or not what is looked at.
    eye = np.array(camera.position)
    if not ((room.low <= eye) & (eye <= room.high)).all():
        return ()
    # Under the middle of the ceiling, at 85 % of the height; E = I / h^2 on the floor below.
    x, _, z = (float(v) for v in (room.low + room.high) / 2.0)
    height = float(room.size[1])
    intensity = 10.0 * (0.85 * height) ** 2
    warm = (intensity, 0.9 * intensity, 0.75 * intensity)
    return (PointLight(position=(x, float(room.low[1]) + 0.85 * height, z), intensity=warm),)
