"""What a person at the viewer has chosen: the scene as it is now, technique, settings, look."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...display.presenter import Look
from ...scene.checks import Vec3
from ...scene.environment import Environment
from ...scene.lights import Light
from ...scene.medium import Medium
from ...scene.scene import Scene
from ...scene.studio import NAME as STUDIO
from ...scene.sun_sky import Sky, followed, with_sky, without_sun
from ...scene.volume import Volume
from .controls import Turn, turned_direction
from .slices import Slice, Sliced, transferred

_UP = (0.0, 1.0, 0.0)


@dataclass
class ViewState:
    """The panel and the controls write it, the session draws it.

    `settings` by technique lie over what the scene file says. `light` is the one that a drag turns,
    `picked` the one that shows its handles, -1 for none. `time_s` is where the scene's animation
    stands. `message` is what went wrong last, `notice` what went well. `compared`: another
    technique, whose image is right of the `split`, a share of the width; empty for none.
    `own_environment`: the scene's map, while another is shown. `sliced`: by number of volume, how
    its grid is looked at.
    """

    scene: Scene
    technique: str = "auto"
    settings: dict[str, dict[str, Any]] = field(default_factory=dict)
    look: Look = field(default_factory=Look)
    light: int = 0
    picked: int = -1
    message: str = ""
    notice: str = ""
    shows_times: bool = False
    time_s: float = 0.0
    is_playing: bool = False
    compared: str = ""
    split: float = 0.5
    own_environment: Environment | None = None
    sliced: dict[int, Sliced] = field(default_factory=dict)
    _moved: tuple[tuple[int, float], Scene] | None = None
    _uncut: Scene | None = None
    _sliced_now: dict[int, tuple[Volume, Sliced, Sliced]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.show(self.scene)

    def show(self, scene: Scene) -> None:
        """Another scene than before, as its file has it."""
        # The time begins again, and what belongs to the scene's files with it.
        self.scene, self.time_s = scene, 0.0
        environment = scene.environment
        is_map = environment is not None and environment.map is not None and not environment.sky
        self.own_environment = environment if is_map else None
        self.sliced = {
            i: Sliced.of(v, v.density) for i, v in enumerate(scene.volumes) if v.density is not None
        }

    def begin(self, scene: Scene, look: Look) -> None:
        """Another scene altogether; the technique stays, its settings go."""
        self.show(scene)
        self.settings, self.light, self.picked, self.look = {}, 0, -1, look
        self.message = self.notice = ""

    def take(self, before: Scene, after: Scene) -> None:
        """What the scene's file changed from `before` to `after`; what was changed here stays."""
        # Fields that the file did not change keep what a hand set here.
        scene = reloaded(self.scene, before, after)
        if not same(before.volumes, after.volumes) or not same(
            before.environment, after.environment
        ):
            time_s = self.time_s
            self.show(scene)
            self.time_s = time_s
        self.scene = scene
        self.message, self.notice = "", "the scene file was read again"
        if after.camera != before.camera:
            self.look = replace(self.look, exposure_stops=after.camera.exposure_stops)

    @property
    def chosen_settings(self) -> dict[str, Any]:
        """Of the chosen technique, beside what the scene file says."""
        return self.settings.get(self.technique, {})

    def play(self, spent_s: float) -> None:
        """Let the animation go on, round from its end to its start."""
        animation = self.scene.animation
        if self.is_playing and animation is not None:
            # Time goes round within the animation's span.
            span = animation.last_s - animation.start_s
            self.time_s = animation.start_s + (self.time_s + spent_s - animation.start_s) % span

    def moved(self) -> Scene:
        """The scene as its animation has it now; the same value until scene or time change."""
        # One value for each moment, so that a frame sees what did not change.
        key = (id(self.scene), self.time_s)
        if self._moved is None or self._moved[0] != key:
            still = self.scene.animation is None
            self._uncut = self.scene if still else self.scene.at(self.time_s)
            self._moved = (key, self._uncut if still else self._cut(self._uncut))
        return self._moved[1]

    def sliced_now(self, index: int) -> Sliced:
        """The grid of a volume as it is at this moment, and how it is looked at."""
        own, begun = self.sliced[index], self.scene.volumes[index]
        self.moved()
        assert self._uncut is not None
        volume = self._uncut.volumes[index]
        # What does not move is as it was loaded.
        if volume.density is None or volume.density is begun.density:
            return own
        # One for each moment and view, as its chart is drawn once.
        known = self._sliced_now.get(index)
        if known is None or known[0] is not volume or known[1] is not own:
            known = self._sliced_now[index] = volume, own, own.now(volume, volume.density)
        return known[2]

    def _cut(self, scene: Scene) -> Scene:
        """The scene with the densities of this moment through their transfer functions."""
        if all(sliced.view.is_plain for sliced in self.sliced.values()):
            return scene
        # Densities that the animation has made at this moment get their transfer function here.
        volumes = list(scene.volumes)
        for index, sliced in self.sliced.items():
            density = volumes[index].density
            is_own = density is not self.scene.volumes[index].density
            if density is not None and is_own and not sliced.view.is_plain:
                cut = transferred(density, sliced.view, sliced.top)
                volumes[index] = replace(volumes[index], density=cut)
        return replace(scene, volumes=tuple(volumes))

    def set_light(self, index: int, light: Light) -> None:
        """Replace one light by another of its kind."""
        lights = list(self.scene.lights)
        lights[index] = light
        self.scene = replace(self.scene, lights=tuple(lights))

    def set_volume(self, index: int, volume: Volume) -> None:
        """Replace one volume by another of the same grid."""
        volumes = list(self.scene.volumes)
        volumes[index] = volume
        self.scene = replace(self.scene, volumes=tuple(volumes))

    def put_slice(self, index: int, view: Slice) -> None:
        """Look at a grid otherwise; where other densities than before count, it changes."""
        before, after = self.sliced[index], self.sliced[index].seen(view)
        self.sliced = {**self.sliced, index: after}
        # Only limits change the grid; the plane and its colours change the chart.
        if (before.view.low, before.view.high) != (view.low, view.high):
            volume = self.scene.volumes[index]
            density = transferred(after.density, view, after.top)
            self.set_volume(index, replace(volume, density=density))

    def put_environment(self, environment: Environment | None) -> None:
        """What is around the scene; the sun of a computed sky goes with that."""
        had = self.scene.environment
        # A computed sky's sun is the last light, and goes with it.
        if had is not None and had.sky is not None:
            self.scene = without_sun(self.scene)
        if environment is not None and environment.map is not None and environment.sky is None:
            self.own_environment = environment
        self.scene = replace(self.scene, environment=environment)

    def put_sky(self, sky: Sky) -> None:
        """A computed sky with its sun, which a drag turns from now on; exposed by the image."""
        had = self.scene.environment is not None and self.scene.environment.sky is not None
        self.scene = with_sky(self.scene, sky)
        self.light = len(self.scene.lights) - 1
        if not had:
            self.look = replace(self.look, exposure_stops=None)

    def settle_sky(self) -> None:
        """Compute the sky for its sun, where that was turned since."""
        self.scene = followed(self.scene)

    def turn_light(self, turn: Turn) -> None:
        """Turn the chosen light's direction; a point light moves around the scene."""
        lights = self.scene.lights
        if turn == Turn(0.0, 0.0) or not lights:
            return
        index = min(self.light, len(lights) - 1)
        light: Any = lights[index]
        if not light.is_aimed:
            # What is not aimed goes about the middle of the scene.
            low, high = self.scene.bounds
            centre = (low + high) / 2.0
            offset = np.subtract(light.position, centre)
            if np.linalg.norm(offset) > 1e-6:
                offset = turned_direction(offset, _UP, turn.azimuth_deg, turn.elevation_deg)
            self.set_light(index, light.changed("position", tuple(centre + offset)))
            return
        # The hand turns where the light comes from, not where it goes.
        source = turned_direction(
            np.negative(light.direction), _UP, turn.azimuth_deg, turn.elevation_deg
        )
        self.set_light(index, light.changed("direction", tuple(-source)))


def structure(state: ViewState) -> tuple[Any, ...]:
    """What a renderer is made for: another structure needs another renderer."""
    scene = state.scene
    chosen = {**scene.settings.get(state.technique, {}), **state.chosen_settings}
    # What a renderer cannot follow: technique, settings, meshes, kinds of things.
    return (
        state.technique,
        repr(sorted(chosen.items())),
        id(scene.meshes),
        tuple(light.fixed for light in scene.lights),
        scene.medium and scene.medium.endless,
        tuple((v.shape, id(v.density), v.bounds) for v in scene.volumes),
        scene.environment is None,
        _map_of(scene),
    )


def boxes(state: ViewState) -> tuple[Any, ...]:
    """The sizes and boxes that the volumes' grids have now: a sequence's files have their own."""
    grids = [(v.density, v.bounds) for v in state.moved().volumes]
    return tuple(density is not None and (density.shape, box) for density, box in grids)


def _map_of(scene: Scene) -> Any:
    """What of the environment's map a renderer is made for: computed ones may change."""
    environment = scene.environment
    if environment is None or environment.map is None:
        return 0
    is_computed = environment.sky is not None or environment.source == STUDIO
    return environment.map.shape if is_computed else id(environment.map)


def reloaded(now: Scene, before: Scene, after: Scene) -> Scene:
    """`now`, edited since it was loaded as `before`, with what the file changed to `after`."""
    changes = {
        f.name: getattr(after, f.name)
        for f in dataclasses.fields(Scene)
        if not same(getattr(before, f.name), getattr(after, f.name))
    }
    return replace(now, **changes) if changes else now


def same(a: Any, b: Any) -> bool:
    """Whether two scene values mean the same, arrays and parts included."""
    # Most parts are the same object, which spares comparing arrays of gigabytes.
    if a is b:
        return True
    # By what they hold, part by part.
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return a.shape == b.shape and bool(np.array_equal(a, b))
    if dataclasses.is_dataclass(a) and not isinstance(a, type):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a))
    if isinstance(a, Mapping):
        return a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    return bool(a == b)


def fog_for(scene: Scene) -> Medium:
    """Thin white fog through which a tenth of the light is lost across the scene."""
    low, high = scene.bounds
    sigma = 0.1 / max(float(np.linalg.norm(high - low)), 1e-6)
    return Medium((sigma, sigma, sigma))


def source_angles_deg(direction: Vec3) -> tuple[float, float]:
    """(azimuth, elevation) of where light that travels in `direction` comes from.

    Azimuth 0 is +Z, 90 is +X.
    """
    x, y, z = np.negative(direction)
    return float(np.degrees(np.arctan2(x, z))), float(np.degrees(np.arcsin(np.clip(y, -1, 1))))


def line_angles_deg(direction: Vec3) -> tuple[float, float]:
    """(azimuth, elevation) of a line: of its end that is above the horizon."""
    x, y, z = direction
    return source_angles_deg((x, y, z) if y < 0.0 else (-x, -y, -z))


def travel_from(azimuth_deg: float, elevation_deg: float) -> Vec3:
    """The direction of light that comes from there."""
    a, e = np.radians(azimuth_deg), np.radians(elevation_deg)
    source = (np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e))
    x, y, z = (-float(v) for v in source)
    return (x, y, z)
