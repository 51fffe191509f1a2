"""A session draws onto any surface: progressively, through errors, and after edits."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from airlight.app.view.controls import Turn
from airlight.app.view.renderers import COARSER_SAMPLES
from airlight.app.view.save import Saver
from airlight.app.view.session import Session
from airlight.errors import SettingsError
from airlight.gpu.memory import Texture
from airlight.lpv.solver import LpvSolver
from airlight.maths.tone import auto_exposure, display_srgb8
from airlight.rendering import Renderer
from airlight.scene import Medium
from airlight.scene.animation import Animation
from airlight.scene.io import load
from airlight.scene.io.images import load_image
from airlight.scene.placing import camera_at
from small_viewer import SETTINGS as SMALL

SIZE = (48, 28)
SCENE = """
[camera]
position = [1.5, 1.4, 3.2]
target = [0, 0.4, 0]
[[mesh]]
shape = "box"
translate = [0, 0.5, 0]
base_color = [0.8, 0.3, 0.2]
[[light]]
type = "directional"
direction = [0.4, -1, -0.3]
irradiance = [3, 2.8, 2.5]
[environment]
radiance = 0.3
"""


class Screen:
    """A session on an offscreen surface, its clock in our hands."""

    def __init__(self, gpu, session: Session) -> None:
        self.session, self.now = session, 0.0
        self.surface = Texture(gpu, "surface", SIZE, "rgba8unorm", target=True)
        session.attach("rgba8unorm")
        self.frame()  # says that it is preparing
        session.wait()

    def frame(self, seconds: float = 0.01) -> bool:
        self.now += seconds
        return self.session.frame(self.surface.resource, SIZE, self.now)

    @property
    def pixels(self) -> np.ndarray:
        return self.surface.read()[..., :3].astype(int)

    def settle(self, frames: int = 3) -> np.ndarray:
        for _ in range(frames):
            self.frame(0.5)
            self.session.wait()
        return self.pixels


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture
def screen(gpu, scene_file):
    session = Session(load(scene_file), source=str(scene_file), technique="direct", settings=SMALL)
    made = Screen(gpu, session)
    yield made
    session.close()


def test_coarse_then_fine_and_then_it_rests(screen):
    assert screen.frame()
    coarse = screen.session.renderer.size
    assert coarse[0] <= SIZE[0]
    screen.session.quality.samples = 3
    screen.session.quality._moving_ms = 1.0  # a quick machine
    assert screen.frame(0.5)
    assert screen.session.renderer.size == SIZE
    wants_more = [screen.frame(0.1) for _ in range(4)]
    assert wants_more[-1] is False
    assert screen.pixels.max() > 100


def test_a_drag_changes_the_image_and_the_sun_its_shadow(screen):
    before = screen.settle()
    controls = screen.session.controls
    controls.handle({"event_type": "pointer_down", "x": 10, "y": 10, "button": 1})
    controls.handle({"event_type": "pointer_move", "x": 18, "y": 10})
    controls.handle({"event_type": "pointer_up", "button": 1})
    turned = screen.settle()
    assert np.abs(turned - before).mean() > 2.0
    controls.turn = Turn(120.0, -20.0)
    sunny = screen.settle()
    assert np.abs(sunny - turned).mean() > 1.0
    light = screen.session.state.scene.lights[0]
    assert np.linalg.norm(light.direction) == pytest.approx(1.0)


def test_solving_is_skipped_while_only_the_camera_moves(screen):
    screen.settle()
    solved = []
    technique = screen.session.renderer.technique
    inner = technique.solve
    technique.solve = lambda *a, **named: (solved.append(1), inner(*a, **named))
    screen.session.controls.camera = replace(screen.session.controls.camera, fov_y_deg=40.0)
    screen.settle()
    assert not solved
    screen.session.state.turn_light(Turn(1.0, 0.0))
    screen.settle()
    # on a CPU adapter coarsely while a hand turns it, then whole
    assert len(solved) == (2 if screen.session.renderer.gpu.is_cpu else 1)


def test_exposure_and_curve_only_tone_map_again(screen):
    before = screen.settle()
    state = screen.session.state
    drawn = screen.session._seen
    state.look = replace(state.look, exposure_stops=2.0)
    screen.session.quality._done = screen.session.quality.samples  # resting
    screen.frame()
    assert screen.session._seen is drawn
    assert screen.pixels.mean() > before.mean() + 10


def test_a_broken_edit_says_so_and_keeps_the_image(screen, scene_file):
    before = screen.settle()
    scene_file.write_text(SCENE.replace("irradiance", "iradiance"))
    screen.session.reload()
    assert "iradiance" in screen.session.state.message
    assert "irradiance" in screen.session.state.message  # the nearest known name
    assert np.abs(screen.settle() - before).mean() < 1.0  # only refined a little more
    scene_file.write_text(SCENE.replace("[0.8, 0.3, 0.2]", "[0.1, 0.1, 0.9]"))
    screen.session.reload()
    blue = screen.settle()
    assert screen.session.state.message == ""
    box = before[..., 0] > before[..., 2] + 30
    assert box.any()
    assert (blue[box][:, 2] > blue[box][:, 0] + 20).mean() > 0.8


def test_an_edit_keeps_what_was_changed_by_hand(screen, scene_file):
    screen.settle()
    session = screen.session
    session.state.turn_light(Turn(40.0, 0.0))
    light, camera = session.state.scene.lights[0], session.controls.camera
    scene_file.write_text(SCENE.replace("radiance = 0.3", "radiance = 0.6"))
    session.reload()
    assert session.state.scene.environment.radiance == (0.6, 0.6, 0.6)
    assert session.state.scene.lights[0] is light
    assert session.controls.camera is camera
    scene_file.write_text(SCENE.replace("target = [0, 0.4, 0]", "target = [0, 0.9, 0]"))
    session.reload()
    assert session.controls.camera.target == (0.0, 0.9, 0.0)


def test_a_refused_setting_says_so_and_the_old_renderer_goes_on(screen):
    screen.settle()
    before = screen.session.renderer
    screen.session.state.settings["direct"] = {**SMALL, "bounds": "1,2"}
    shown = screen.settle()
    assert "setting bounds has 2 numbers" in screen.session.state.message
    assert screen.session.renderer is before
    assert shown.max() > 100
    screen.session.state.settings["direct"] = {**SMALL, "resolution": 9}
    screen.settle()
    assert screen.session.state.message == ""
    assert screen.session.renderer is not before


def test_fog_can_be_added_thickened_and_taken_away(gpu, scene_file):
    session = Session(load(scene_file), technique="single", settings=SMALL)
    screen = Screen(gpu, session)
    clear = screen.settle(2)
    from airlight.app.view.state import fog_for

    session.state.scene = replace(session.state.scene, medium=fog_for(session.state.scene))
    thin = screen.settle(2)
    fog = session.state.scene.medium
    session.state.scene = replace(session.state.scene, medium=replace(fog, sigma_t=(2, 2, 2)))
    thick = screen.settle(2)
    assert session.state.message == ""
    assert np.abs(thin - clear).mean() < np.abs(thick - clear).mean()
    session.close()


@pytest.mark.slow
def test_a_camera_far_out_in_fog_gets_lattices_that_reach_to_it(gpu, scene_file):
    scene = replace(load(scene_file), medium=Medium((0.05,) * 3))
    settings = {**SMALL, "gather": "off"}
    session = Session(scene, source=str(scene_file), technique="lpv-scatter", settings=settings)
    made = Screen(gpu, session)
    try:
        made.settle(3)
        first = session.renderer
        session.controls.camera = camera_at(scene.camera, (1.4, 1.3, 3.0))
        made.settle(2)
        assert session.renderer is first
        away = camera_at(scene.camera, (9.0, 6.0, 20.0))
        session.controls.camera = away
        made.settle(3)
        assert session.renderer is not first
        assert session.renderer.made_for.reach.beyond(replace(scene, camera=away)) is None
        # Back again, it stays.
        larger, session.controls.camera = session.renderer, scene.camera
        made.settle(3)
        assert session.renderer is larger
    finally:
        session.close()


def test_times_of_passes_are_measured_when_wanted(screen):
    screen.settle()
    assert screen.session.times_ms == {}
    screen.session.state.shows_times = True
    screen.settle(1)
    assert {"g-buffer", "lighting", "combine"} <= screen.session.times_ms.keys()


def test_images_and_scenes_are_saved_under_new_names(screen, tmp_path):
    screen.settle()
    screen.session.state.look = replace(screen.session.state.look, exposure_stops=1.0)
    screen.session.state.turn_light(Turn(15.0, 0.0))
    copied: list[str] = []
    saver = Saver(screen.session, tmp_path, copied.append)
    first, second = saver.save_image(".exr"), saver.save_image(".exr")
    assert (first.name, second.name) == ("scene-view-0001.exr", "scene-view-0002.exr")
    image = load_image(first)
    assert image.radiance.shape == (SIZE[1], SIZE[0], 3)
    assert "direct" in image.layers
    assert saver.save_image(".png").stat().st_size > 100
    again = load(saver.save_scene())
    assert again.camera.exposure_stops == 1.0
    assert again.lights[0].direction == pytest.approx(
        screen.session.state.scene.lights[0].direction, rel=1e-5
    )
    assert again.settings["direct"]["resolution"] == 8
    saver.copy_scene()
    assert copied and copied[0].startswith("[camera]")
    assert "clipboard" in screen.session.state.notice


def test_a_folder_that_cannot_be_written_is_said(screen, tmp_path):
    saver = Saver(screen.session, tmp_path / "missing")
    screen.settle(1)
    assert saver.save_image(".png") is None
    assert "missing" in screen.session.state.message
    screen.session.state.message = ""
    assert saver.save_scene() is None
    assert "missing" in screen.session.state.message


def test_an_unknown_technique_is_refused_at_once(scene_file):
    with pytest.raises(SettingsError, match="unknown technique 'lvp'"):
        Session(load(scene_file), technique="lvp")


def test_time_moves_what_the_scene_moves(gpu, scene_file):
    scene = load(scene_file)
    turning = Animation((Turning(),), end_s=2.0)
    session = Session(replace(scene, animation=turning), technique="direct", settings=SMALL)
    screen = Screen(gpu, session)
    before = screen.settle(2)
    session.state.time_s = 1.0
    moved = screen.settle(2)
    assert np.abs(moved - before).mean() > 1.0
    assert session.scene_now().lights[0].direction[0] == pytest.approx(-np.sqrt(0.5))
    session.state.is_playing = True
    assert screen.frame(0.1) and screen.frame(0.25)
    assert session.state.time_s == pytest.approx(1.25)
    for _ in range(4):
        screen.frame(0.25)
    assert session.state.time_s == pytest.approx(0.25)  # round
    session.close()


def test_grids_of_a_sequence_that_grow_are_drawn_in_their_boxes(gpu, tmp_path):
    sizes = ((4, 2, 4), (4, 8, 4))
    for k, (x, y, z) in enumerate(sizes):
        bounds = ((-1, 0, -1), (1, y / 4, 1))
        np.savez(tmp_path / f"s{k}.npz", density=np.ones((z, y, x), np.float32), bounds=bounds)
    volume = '[[volume]]\nsequence = "s*.npz"\nsequence_fps = 1\nsigma_t = 8\n'
    (tmp_path / "scene.toml").write_text(SCENE + volume)
    session = Session(load(tmp_path / "scene.toml"), technique="single", settings=SMALL)
    screen = Screen(gpu, session)
    before = screen.settle(2)
    old = session.renderer
    session.state.time_s = 1.0
    moved = screen.settle(2)
    assert session.state.message == ""
    assert session.renderer is not old
    assert session.renderer.scene.volumes[0].bounds[1][1] == 2.0
    assert np.abs(moved - before).mean() > 1.0
    session.close()


class Turning:
    """A sun that goes from over the right to over the left shoulder in two seconds."""

    end_s = 2.0

    def apply(self, scene, time_s):
        side = np.sqrt(0.5) * (1.0 if time_s < 0.5 else -1.0)
        sun = replace(scene.lights[0], direction=(side, -np.sqrt(0.5), 0.0))
        return replace(scene, lights=(sun,))


def test_the_old_image_stays_live_while_another_renderer_is_made(screen):
    before, session = screen.settle(), screen.session
    old = session.renderer
    session.state.settings["direct"] = {**SMALL, "resolution": 10}
    held = session._turns._device
    with held:  # so that the new one cannot be done before it was looked at
        screen.frame(0.5)
        assert session.state.notice == "rebuilding ..."
        session.controls.camera = replace(session.controls.camera, fov_y_deg=25.0)
        screen.frame(0.5)
        screen.frame(0.5)
        assert session.renderer is old
        assert np.abs(screen.pixels - before).mean() > 2.0  # it follows the camera
    session.wait()
    screen.frame(0.5)
    assert session.state.notice == ""
    assert session.renderer is not old


def test_a_wish_taken_back_keeps_the_renderer(screen):
    screen.settle()
    session, old = screen.session, screen.session.renderer
    session.state.settings["direct"] = {**SMALL, "resolution": 10}
    screen.frame(0.5)
    session.state.settings["direct"] = dict(SMALL)
    screen.settle()
    assert session.renderer is old
    assert session.state.notice == ""


def test_a_still_view_ends_with_the_finest_image_and_moving_goes_back(gpu, scene_file):
    fog = Medium((0.3, 0.3, 0.3))
    session = Session(replace(load(scene_file), medium=fog), technique="single", settings=SMALL)
    screen = Screen(gpu, session)
    end = time.monotonic() + 240.0
    while session.share < 1.0 or session.has_news():
        assert time.monotonic() < end
        if not screen.frame(0.3):
            time.sleep(0.02)
    assert session.fine.is_shown
    assert not session.has_news()
    assert session.status == "refining   64 of 64"
    shown = screen.pixels
    with Renderer(
        session.scene_now(),
        "single",
        SIZE,
        settings={
            **SMALL,
            "march_resolution": "full",
            "shaft_resolution": "full",
            "resolution": 16,
        },
    ) as renderer:
        image = renderer.frame(samples=64)
    expected = display_srgb8(image.radiance, 0.0, "agx", dither=True).astype(int)
    assert np.abs(shown - expected).mean() < 0.5
    saved = session.image(samples=64)
    assert np.abs(saved.radiance - image.radiance).max() < 1e-5 * image.radiance.max()
    session.controls.camera = replace(session.controls.camera, fov_y_deg=25.0)
    screen.frame(0.01)
    assert not session.fine.is_shown
    assert np.abs(screen.pixels - shown).mean() > 2.0
    session.close()


def test_a_lost_device_is_said_in_the_panel_and_ends_the_viewer(child, scene_file):
    said = child(f"""
    from airlight.app.view.session import Session
    from airlight.gpu.memory import Texture
    from airlight.scene.io import load
    session = Session(load({str(scene_file)!r}), technique="direct", settings=small)
    surface = Texture(session.gpu, "surface", (16, 16), "rgba8unorm", target=True)
    session.attach("rgba8unorm")
    for now_s in (0.0, 0.1, 0.2):
        session.frame(surface.resource, (16, 16), now_s)
        session.wait()
    session.gpu.device.destroy()
    session.state.look = __import__("dataclasses").replace(session.state.look, layer="direct")
    try:
        session.frame(surface.resource, (16, 16), 0.3)
    except al.DeviceError as error:
        print("raised", str(error).partition(":")[0])
    print("said", session.state.message.partition(":")[0])
    session.close()
    """)
    assert said == ["raised the device was lost", "said the device was lost"]


@pytest.mark.slow
def test_renderers_are_made_while_frames_are_drawn_and_are_the_same(child, scene_file):
    said = child(f"""
    from airlight.app.view.session import Session
    from airlight.gpu.memory import Texture
    from airlight.scene.io import load
    session = Session(load({str(scene_file)!r}), technique="direct", settings=small)
    surface = Texture(session.gpu, "surface", (16, 16), "rgba8unorm", target=True)
    session.attach("rgba8unorm")
    now_s, images, other = 0.0, {{}}, made()
    for turn in range(4):
        session.state.technique = ("direct", "lpv")[turn % 2]
        while True:
            now_s += 0.1
            session.frame(surface.resource, (16, 16), now_s)
            other.frame()  # beside the viewer's, and the one that it makes
            if not session._making.is_under_way:
                break
        images.setdefault(session.state.technique, []).append(session.image(2).radiance)
    for name, found in images.items():
        print(name, len(found), all(np.array_equal(one, found[0]) for one in found))
    print(session.state.message or "well")
    session.close()
    """)
    assert said == ["direct 2 True", "lpv 2 True", "well"]


@pytest.mark.parametrize("is_refused", [False, True])
def test_on_a_slow_machine_a_view_at_rest_ends_at_full_size(screen, monkeypatch, is_refused):
    """Frames at full size take three seconds by the clock: those that move are coarser, then full
    ones come in the background, and in their place where memory is short."""
    if not screen.session.gpu.is_cpu:
        pytest.skip("a GPU's views at rest are drawn at full size at once")
    if is_refused:
        monkeypatch.setattr("airlight.app.view.fine.MOST_BYTES", 1 << 10)
    session, drew, said = screen.session, [], set()
    draw, clock = session._draw, [0.0]

    def slow(plan):
        draw(plan)
        drew.append(plan.size)
        clock[0] += 3.0 * plan.size[0] * plan.size[1] / (SIZE[0] * SIZE[1])

    monkeypatch.setattr(session, "_draw", slow)
    monkeypatch.setattr("airlight.app.view.session.time.perf_counter", lambda: clock[0])
    session.quality.samples = 6
    screen.frame()
    end = time.monotonic() + 120.0
    wants_more = True
    while wants_more or not (session.fine.is_shown or session.renderer.size == SIZE):
        wants_more = screen.frame(0.5)
        assert time.monotonic() < end
        said.add(session.status.split("   ")[0])
    coarser = [size for size in drew if size[0] < SIZE[0]]
    assert coarser and coarser == sorted(coarser)  # at rest never coarser than before
    assert is_refused or "full resolution follows ..." in said
    if is_refused:
        assert drew[-session.quality.samples :] == [SIZE] * session.quality.samples
        assert "no finer image" in session.fine.message
        assert session.share == 1.0
    else:
        assert drew == coarser
        assert session.fine.shown[0].size == SIZE


def test_another_size_of_the_window_has_a_finest_image_of_its_own(screen):
    session, end = screen.session, time.monotonic() + 120.0
    session.quality.samples = COARSER_SAMPLES  # as where a finer image follows
    while not session.fine.is_shown:
        screen.frame(0.5)
        assert time.monotonic() < end
    size = (SIZE[0] // 2, SIZE[1])
    other = Texture(session.gpu, "surface", size, "rgba8unorm", target=True)
    session.frame(other.resource, size, screen.now + 0.5)
    assert not session.fine.is_shown  # it would be squeezed into the new shape
    now = screen.now
    while not session.fine.is_shown:
        now += 0.5
        session.frame(other.resource, size, now)
        assert time.monotonic() < end
    assert session.fine.shown[0].size == size


def test_the_first_image_is_coarse_and_says_how_far_it_is(gpu, scene_file):
    session = Session(load(scene_file), source=str(scene_file), technique="direct", settings=SMALL)
    surface = Texture(gpu, "surface", SIZE, "rgba8unorm", target=True)
    session.attach("rgba8unorm")
    try:
        assert session.frame(surface.resource, SIZE, 0.0) is False
        said = session.progress
        assert said.startswith("0 s: ")
        session._making._task._begun_s -= 7.0
        assert session.has_news()  # so that the panel is drawn again
        session.frame(surface.resource, SIZE, 0.1)
        assert session.progress.startswith("7 s: ") or session.renderer
        session.wait()
        assert session.renderer.size == session.quality.coarse(SIZE)
        assert session.renderer.size < SIZE or not gpu.is_cpu
        session.frame(surface.resource, SIZE, 0.2)
        assert session.progress == ""
        assert surface.read()[..., :3].max() > 50
    finally:
        session.close()


def test_fog_that_hides_everything_is_said_while_it_does(screen):
    session = screen.session
    assert session.doubts == ()
    session.state.scene = replace(session.state.scene, medium=Medium(sigma_t=9.0))
    (line,) = session.doubts
    assert "nothing else will be seen" in line
    session.state.scene = replace(session.state.scene, medium=Medium(sigma_t=0.01))
    assert session.doubts == ()


def test_the_first_image_is_one_of_direct_light_and_is_followed_by_the_techniques(gpu, scene_file):
    session = Session(load(scene_file), technique="lpv", settings=SMALL)
    screen = Screen(gpu, session)
    screen.frame()
    assert session.renderer.technique.name == "direct"
    preview = screen.pixels
    assert preview.std() > 5.0
    assert session.state.notice == "preparing ..."  # the technique's own
    session.wait()
    screen.settle()
    assert session.renderer.technique.name == "lpv"
    # On a GPU the first image is sharp: .45.
    assert np.abs(screen.pixels - preview).mean() > (1.0 if gpu.is_cpu else 0.2)
    session.close()


def test_two_techniques_beside_each_other(gpu, scene_file):
    session = Session(load(scene_file), technique="direct", settings=SMALL)
    session.state.settings["lpv"] = dict(SMALL)
    screen = Screen(gpu, session)
    screen.frame()
    session.quality._moving_ms = 1.0  # a quick machine
    alone = screen.settle(6)
    session.state.compared, session.state.split = "lpv", 0.5
    end = time.monotonic() + 60.0
    while session.compared.samples < 1:
        screen.frame(0.5)
        assert time.monotonic() < end
    screen.frame()
    assert session.is_divided
    assert session.compared_names == ("direct", "lpv")
    assert "lpv: " in session.status
    assert " of 64" in session.status
    beside = screen.pixels
    half = SIZE[0] // 2
    left = np.abs(beside[:, : half - 1] - alone[:, : half - 1])
    assert left.mean() < 0.5  # edges, as samples come
    assert (beside[:, half] == 240).all()  # the line
    right = np.abs(beside[:, half + 2 :] - alone[:, half + 2 :])
    assert right.mean() > max(1.0, 3.0 * left.mean())  # indirect light
    session.state.compared = ""
    screen.frame()
    assert not session.is_divided
    assert np.abs(screen.pixels - alone).mean() < 0.5
    session.close()


def test_beside_a_slow_image_the_other_one_comes_when_that_is_sharp_and_then_first(gpu, scene_file):
    session = Session(load(scene_file), technique="lpv", settings=SMALL)
    session.state.compared = "direct"
    screen = Screen(gpu, session)
    # A slow machine: the own image is coarse at rest, and refined in the background.
    session.quality.took = lambda ms, plan: None
    session.quality._moving_ms, session.quality.scale = 400.0, 2.0
    seen = []

    def until(is_so) -> None:
        end = time.monotonic() + 60.0
        while not is_so():
            screen.frame(0.5)
            seen.append((session.fine.is_shown, session.compared.samples, session.fine.samples))
            assert time.monotonic() < end
            time.sleep(0.01)

    until(lambda: session.compared.samples >= 1)
    assert not any(samples for is_sharp, samples, _ in seen if not is_sharp)
    until(lambda: session.fine.samples >= 3)
    # Neither runs away: samples of the other wait for those of the own one.
    assert all(samples <= fine + 3 for _, samples, fine in seen)
    # Both end with all their samples, at full resolution.
    assert session.compared._shot.size == session.fine._shot.size == SIZE
    session.close()


def test_the_compared_image_is_as_fine_as_the_own_one(gpu, scene_file):
    foggy = replace(load(scene_file), medium=Medium((0.05, 0.05, 0.05)))
    session = Session(foggy, technique="direct", settings=SMALL)
    assert session._finer("lpv-scatter")["march_resolution"] == "full"
    session.close()


def test_moving_frames_gather_on_quick_devices_alone(gpu, scene_file):
    session = Session(load(scene_file), technique="lpv", settings=SMALL)
    session._gathers_moving, session.quality.scale = True, 1.0  # as on a GPU
    session.quality.took = lambda ms, plan: None  # which is quick, whatever else runs here
    screen = Screen(gpu, session)
    screen.settle()
    stages = timed_stages(screen)
    assert {"gather rays", "gather history"} <= stages
    # Images that had to become coarse to stay quick are fine again, and of the lattice.
    session.quality.scale = 1.6
    timed_stages(screen)
    assert session.quality.scale == 1.0
    screen.frame(0.5)
    session.wait()
    assert "gather rays" not in timed_stages(screen)
    assert session.state.message == ""
    session.close()


def test_who_asks_for_no_gather_has_none(gpu, scene_file):
    session = Session(load(scene_file), technique="lpv", settings={**SMALL, "gather": "off"})
    session._gathers_moving = True
    screen = Screen(gpu, session)
    screen.settle()
    assert "gather rays" not in timed_stages(screen)
    session.close()


def timed_stages(screen: Screen) -> set[str]:
    """The stages of a frame whose camera has moved."""
    session = screen.session
    session.state.shows_times = True
    camera = session.controls.camera
    session.controls.camera = replace(camera, fov_y_deg=camera.fov_y_deg + 1.0)
    screen.frame()
    return set(session.renderer.commands.stage_ms)


def test_a_moving_image_that_stays_has_its_exposure_at_once(screen, monkeypatch):
    """Where stills are too slow for a hand the last moving image stays: metered as it is."""
    session = screen.session
    session.state.look = replace(session.state.look, exposure_stops=None)
    screen.settle()
    meter = session._shown._presenter._meter
    before = float(meter.stops.read()[0])
    # At the side of the box that lies in shade, and nothing else.
    camera = replace(session.controls.camera, position=(1.0, 0.5, 0.0), target=(0.0, 0.5, 0.0))
    session.controls.camera = camera
    monkeypatch.setattr(session.quality, "took", lambda ms, plan: None)
    session.quality.still_scale, session.quality._moving_ms = 8.0, 900.0  # stills take too long
    screen.frame(0.01)
    drew, draw = [], session._draw
    monkeypatch.setattr(session, "_draw", lambda plan: (drew.append(plan), draw(plan)))
    screen.frame(0.5)
    assert drew == []
    assert session.quality.is_coarse
    assert session.quality.is_done
    image = session._shown._presenter._combine.image.read()[..., :3]
    expected = auto_exposure(image)
    assert abs(expected - before) > 0.5
    assert float(meter.stops.read()[0]) == pytest.approx(expected, abs=0.1)


def test_light_is_solved_once_for_all_images_of_a_view(gpu, scene_file, monkeypatch):
    """The finest image shows what the frames' renderer has solved, before and after a change."""
    solved: list[str] = []
    inner = LpvSolver._fill
    monkeypatch.setattr(LpvSolver, "_fill", lambda *a: (solved.append("lpv"), inner(*a)))
    settings = {**SMALL, "gather_rays": 2, "map_resolution": 32}
    session = Session(load(scene_file), technique="lpv", settings=settings)
    screen = Screen(gpu, session)
    screen.settle()
    for turn in range(2):
        end = time.monotonic() + 240.0
        while not session.fine.samples:
            assert time.monotonic() < end
            if not screen.frame(0.3):
                time.sleep(0.02)
        assert len(solved) == 1 + turn
        session.state.scene = replace(
            session.state.scene, lights=tuple(map(brighter, session.state.scene.lights))
        )
        screen.frame(0.3)
    saved = session.image(samples=2)
    with Renderer(session.scene_now(), "lpv", SIZE, settings=settings) as alone:
        assert np.array_equal(saved.radiance, alone.frame(samples=2).radiance)
    session.close()


def brighter(light):
    return replace(light, irradiance=tuple(2.0 * x for x in light.irradiance))
