"""Layers to a surface: against the host's tone mapping, and what each look shows."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.display.presenter import Look, Presenter, layer_names
from airlight.errors import SettingsError
from airlight.gpu.commands import Commands
from airlight.gpu.memory import Texture
from airlight.lighting.view import View
from airlight.maths.colour import srgb_encode
from airlight.maths.tone import TONE_CURVES, auto_exposure, display_srgb8
from airlight.rendering import Renderer
from airlight.scene import Camera, Mesh, Scene
from airlight.scene.builtin.solids import box
from small_viewer import SETTINGS

SIZE = (20, 12)


def layer(gpu, pixels: np.ndarray) -> Texture:
    made = Texture(gpu, "layer", SIZE, "rgba32float", target=True, written=True)
    made.write(np.dstack([pixels, np.ones(pixels.shape[:2])]).astype(np.float32))
    return made


def radiance(seed: int, stops: float = 3.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.exp2(rng.uniform(-stops, stops, (SIZE[1], SIZE[0], 3)))


class Screen:
    """A presenter of SIZE onto an offscreen surface, and what it shows."""

    def __init__(self, gpu, format: str = "rgba8unorm", size: tuple[int, int] = SIZE) -> None:
        self.commands, self.view = Commands(gpu), View(gpu, SIZE)
        self.presenter = Presenter(gpu, SIZE, format)
        self.surface = Texture(gpu, "surface", size, format, target=True)

    def shown(self, samples: list[dict[str, Texture]], look: Look) -> np.ndarray:
        for index, images in enumerate(samples):
            self.presenter.take(self.commands, images, self.view, look, index)
        self.presenter.tone(self.commands, look)
        self.presenter.show(self.commands, self.surface)
        self.commands.submit()
        if self.surface.format.endswith("srgb"):  # read what the plain twin of the format holds
            return self.presenter._tone.shown.read()[..., :3].astype(int)
        return self.surface.read()[..., :3].astype(int)


@pytest.mark.parametrize("curve", list(TONE_CURVES))
def test_the_image_is_the_hosts(gpu, curve):
    a, b = radiance(1), radiance(2)
    images = {"direct": layer(gpu, a), "indirect": layer(gpu, b), "transmittance": layer(gpu, a)}
    shown = Screen(gpu).shown([images], Look(exposure_stops=-1.0, curve=curve))
    wanted = display_srgb8((a + b).astype(np.float32), -1.0, curve, dither=True)
    off = np.abs(shown - wanted.astype(int))
    assert off.max() <= 1
    # The same dither: without it half of them would differ. Devices may round .1 of a level early
    # or late (WebGPU leaves it open, Direct3D allows .6 of a level in all).
    assert off.mean() < 0.1


def test_one_layer_and_the_raw_ones(gpu):
    a, b = radiance(3), radiance(4, stops=0.0) * 0.25
    images = {"direct": layer(gpu, a), "transmittance": layer(gpu, b)}
    assert layer_names(images) == (
        "image",
        "direct",
        "transmittance",
        "albedo",
        "normal",
        "depth",
    )
    screen = Screen(gpu)
    direct = screen.shown([images], Look("direct", curve="none"))
    assert np.abs(direct - display_srgb8(a, 0.0, "none", dither=True).astype(int)).max() <= 1
    # Transmittance is no radiance: neither exposure nor curve touch it.
    raw = screen.shown([images], Look("transmittance", exposure_stops=5.0))
    assert np.abs(raw - display_srgb8(b, 0.0, "none").astype(int)).max() <= 1
    assert np.all(screen.shown([images], Look("depth")) == 0)  # nothing drawn: infinitely far


@pytest.mark.parametrize("target_m", [4.0, 0.25])
def test_the_depth_layer_says_how_far_surfaces_are(gpu, target_m):
    # A wall 4 m away, a box before its left half 2 m away; the near plane follows the target.
    meshes = Mesh(box((-20, -20, -5), (20, 20, -4))), Mesh(box((-10, -20, -3), (0, 20, -2)))
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -target_m))
    screen = Screen(gpu)
    with Renderer(Scene(meshes, camera=camera), "direct", SIZE, settings=SETTINGS) as r:
        r.frame()
        screen.view = r.view
        shown = screen.shown([{}], Look("depth", reach_m=2.0))
    # 1 / (1 + distance / reach), encoded as sRGB.
    for distance_m, pixels in ((2.0, shown[:, :9]), (4.0, shown[:, 11:])):
        wanted = float(srgb_encode(np.array(1.0 / (1.0 + distance_m / 2.0)))) * 255.0
        assert np.abs(pixels - wanted).max() <= 1.0


def test_samples_are_averaged_and_index_0_restarts(gpu):
    parts = [radiance(seed) for seed in range(3)]
    screen, look = Screen(gpu), Look(curve="none", exposure_stops=-3.0)
    screen.shown([{"direct": layer(gpu, parts[0] * 100.0)}], look)
    shown = screen.shown([{"direct": layer(gpu, part)} for part in parts], look)
    wanted = display_srgb8(np.mean(parts, axis=0), -3.0, "none", dither=True)
    assert np.abs(shown - wanted.astype(int)).max() <= 1


def test_metered_exposure_is_the_hosts(gpu):
    # A lamp that must not decide, and black that does not count.
    bright = radiance(5) * 40.0
    bright[0, 0], bright[1:3, :4] = 1e6, 0.0
    screen = Screen(gpu)
    screen.shown([{"direct": layer(gpu, bright)}], Look(exposure_stops=None))
    metered = float(screen.presenter._meter.stops.read()[0])
    assert metered == pytest.approx(auto_exposure(bright), abs=0.1)


def test_a_black_image_is_metered_as_is(gpu):
    screen = Screen(gpu)
    black = {"direct": layer(gpu, np.zeros((SIZE[1], SIZE[0], 3)))}
    shown = screen.shown([black], Look(exposure_stops=None))
    assert screen.presenter._meter.stops.read()[0] == 0.0
    assert shown.max() == 0


def test_not_a_number_stays_one_pixel(gpu):
    pixels = np.full((SIZE[1], SIZE[0], 3), 0.5)
    pixels[3, 4] = np.nan
    shown = Screen(gpu).shown([{"direct": layer(gpu, pixels)}], Look(curve="none"))
    assert shown[3, 4].tolist() == [0, 0, 0]
    others = np.delete(shown.reshape(-1, 3), 3 * SIZE[0] + 4, axis=0)
    assert np.all((others == 187) | (others == 188))  # .5 is encoded as 187.5


def test_a_surface_of_another_size_is_filled(gpu):
    pixels = np.zeros((SIZE[1], SIZE[0], 3))
    pixels[:, SIZE[0] // 2 :] = 1.0
    shown = Screen(gpu, size=(40, 36)).shown([{"direct": layer(gpu, pixels)}], Look(curve="none"))
    assert shown.shape == (36, 40, 3)
    assert shown[:, :18].max() == 0
    assert shown[:, 22:].min() == 255


def test_a_surface_that_encodes_gets_linear_values(gpu):
    pixels = np.full((SIZE[1], SIZE[0], 3), 0.5)
    screen = Screen(gpu, "rgba8unorm-srgb")
    screen.shown([{"direct": layer(gpu, pixels)}], Look(curve="none"))
    stored = screen.surface.read()[..., :3]  # the encoded bytes
    assert np.abs(stored.astype(int) - 188).max() <= 1


def test_an_unknown_curve_and_too_many_layers_are_refused(gpu):
    black = layer(gpu, np.zeros((SIZE[1], SIZE[0], 3)))
    with pytest.raises(SettingsError, match="unknown tone curve 'agz'"):
        Screen(gpu).shown([{"direct": black}], Look(curve="agz"))
    with pytest.raises(SettingsError, match="5 layers"):
        Screen(gpu).shown([{f"layer{i}": black for i in range(5)}], Look())
