"""Channel names and types in EXR files, read with OpenEXR alone."""

from __future__ import annotations

import numpy as np
import OpenEXR
import pytest

from airlight.errors import SceneError
from airlight.scene.image import Image
from airlight.scene.io import exr


def channels(path) -> dict[str, np.ndarray]:
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def image() -> Image:
    planes = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    return Image(
        radiance=planes * 1e5,
        layers={
            "direct": planes,
            "normal": planes,
            "depth": planes[..., 0] + 0.123456,
            "transmittance": planes[..., 1],
        },
    )


def test_names_that_compositing_programs_know(tmp_path):
    exr.write(image(), tmp_path / "a.exr", layers=True, half=False)
    found = channels(tmp_path / "a.exr")
    expected = "R G B direct.R direct.G direct.B normal.X normal.Y normal.Z depth.Z transmittance.Y"
    assert sorted(found) == sorted(expected.split())
    assert {pixels.dtype for pixels in found.values()} == {np.dtype(np.float32)}
    np.testing.assert_array_equal(found["direct.G"], image().layers["direct"][..., 1])
    with OpenEXR.File(str(tmp_path / "a.exr")) as file:
        assert file.header()["compression"] == OpenEXR.ZIP_COMPRESSION


def test_half_keeps_depth_whole_and_stays_finite(tmp_path):
    exr.write(image(), tmp_path / "a.exr", layers=True, half=True)
    found = channels(tmp_path / "a.exr")
    assert found["R"].dtype == np.float16
    assert np.isfinite(found["R"]).all()
    np.testing.assert_array_equal(found["depth.Z"], image().layers["depth"])


def test_grey_and_layerless_files(tmp_path):
    path = tmp_path / "a.exr"
    header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
    grey = np.ones((2, 3), dtype=np.float32)
    OpenEXR.File(header, {"Y": grey}).write(str(path))
    assert exr.read_rgb(path).shape == (2, 3, 3)
    OpenEXR.File(header, {"a.b": grey}).write(str(path))
    with pytest.raises(SceneError, match=r"it has no R, G, B channels, only a\.b"):
        exr.read_rgb(path)
    with pytest.raises(SceneError, match=r"it has no R, G, B channels, only a\.b"):
        exr.read(path)


def test_damaged_files(tmp_path, capfd):
    path = tmp_path / "a.exr"
    exr.write(image(), path, layers=True, half=False)
    raw = path.read_bytes()
    for part in (b"", b"hello", raw[:300], raw[: len(raw) - 40]):
        path.write_bytes(part)
        with pytest.raises(SceneError, match=r"a\.exr: not a readable EXR file"):
            exr.read(path)
    capfd.readouterr()
