"""Noise goes, edges and energy stay; without the package one sentence says how to get it."""

from __future__ import annotations

import builtins
from typing import Any

import numpy as np
import pytest

from airlight.app import cli
from airlight.errors import SettingsError
from airlight.scene.image import Image

SIZE = (64, 96)


def noisy_checker(seed: int = 5) -> tuple[Image, np.ndarray]:
    """Squares of two albedos in even light, and the same with the noise of few samples."""
    rows, columns = np.indices(SIZE) // 12
    albedo = np.where((rows + columns) % 2, 0.8, 0.2)[..., None] * np.ones(3)
    truth = (5.0 * albedo).astype(np.float32)
    noise = np.random.default_rng(seed).gamma(4.0, 0.25, (*SIZE, 1))
    guides = {
        "albedo": albedo.astype(np.float32),
        "normal": np.tile(np.float32([0, 0, 1]), (*SIZE, 1)),
    }
    indirect = (truth * noise).astype(np.float32)
    direct = np.full((*SIZE, 3), 2.0, np.float32)
    image = Image(indirect + direct, {"indirect": indirect, "direct": direct, **guides})
    return image, truth + 2.0


@pytest.mark.needs("pyoidn")
def test_noise_goes_and_edges_stay() -> None:
    image, truth = noisy_checker()
    made = image.denoised()
    before, after = (np.abs(x.radiance - truth).mean() for x in (image, made))
    assert after < 0.2 * before
    assert made.radiance.sum() == pytest.approx(image.radiance.sum(), rel=0.01)
    # The step between two squares is as high as it was.
    step = np.abs(np.diff(made.radiance[6, :, 0])).max()
    assert step == pytest.approx(3.0, rel=0.15)
    # The layers of light still sum to the image; all others are as they were.
    light = made.layers["indirect"] + made.layers["direct"]
    np.testing.assert_allclose(light, made.radiance, atol=1e-5)
    for name in ("albedo", "direct"):
        assert made.layers[name] is image.layers[name]


@pytest.mark.needs("pyoidn")
def test_an_image_without_layers_and_with_bad_pixels() -> None:
    image, truth = noisy_checker()
    values = image.radiance.copy()
    values[3, 4] = np.nan
    made = Image(values, exposure_stops=1.5).denoised()
    assert np.isfinite(made.radiance).all()
    assert np.abs(made.radiance - truth).mean() < 0.5 * np.abs(image.radiance - truth).mean()
    assert made.exposure_stops == 1.5
    direct = Image(image.layers["direct"], {"direct": image.layers["direct"]})
    assert direct.denoised() is direct
    black = Image(np.zeros((4, 4, 3), np.float32))
    assert not black.denoised().radiance.any()


@pytest.mark.needs("pyoidn")
def test_render_denoises(gpu: Any, tmp_path: Any) -> None:
    path = tmp_path / "a.png"
    words = ["render", "builtin:cornell", "-o", str(path), "--size", "32x18", "--samples", "1"]
    assert cli.run([*words, "-q", "--denoise"]) == 0
    assert path.stat().st_size > 0


def test_without_the_package_one_sentence_says_what_to_install(
    gpu: Any, tmp_path: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    real = builtins.__import__

    def no_oidn(name: str, *rest: Any, **more: Any) -> Any:
        if name.split(".")[0] == "pyoidn":
            raise ModuleNotFoundError("No module named 'pyoidn'")
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", no_oidn)
    with pytest.raises(SettingsError, match=r"airlight\[denoise\]"):
        noisy_checker()[0].denoised()
    path = tmp_path / "a.png"
    # Said before the image is rendered.
    assert cli.run(["render", "builtin:cornell", "-o", str(path), "-q", "--denoise"]) == 2
    assert "pip install 'airlight[denoise]'" in capsys.readouterr().err
    assert not path.exists()
