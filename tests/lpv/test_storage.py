"""Lattices in fewer bytes, back from the device."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, buffer_of
from airlight.lpv.storage import FORMATS, STORAGES, Pack

VALUES = 600


def test_the_names_are_those_of_the_formats():
    assert tuple(FORMATS) == STORAGES
    assert [FORMATS[name].nbytes for name in STORAGES] == [16, 8, 4]


def test_half_floats_keep_eleven_bits_at_any_brightness(gpu, commands, owned):
    rng = np.random.default_rng(1)
    for brightness in (1e-7, 1.0, 3e6):
        light = (rng.normal(size=(VALUES, 4)) * brightness).astype(np.float32)
        pack = owned(Pack(gpu, "float16"))
        stored = owned(Buffer(gpu, "stored", VALUES * 8))
        pack.encode(commands, owned(buffer_of(gpu, "light", light)), stored, VALUES)
        commands.submit()
        scale = pack.range.read()[0]
        assert np.log2(scale) == round(np.log2(scale))
        back = stored.read(np.float16).astype(np.float64).reshape(-1, 4) / scale
        np.testing.assert_allclose(back, light, rtol=2.0**-11, atol=1e-7 * brightness)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_bytes_keep_six_percent_of_a_over_five_decades(gpu, commands, owned, sign):
    light = np.zeros((VALUES, 4), np.float32)
    light[:, 0] = sign * np.geomspace(1.0, 1e-5, VALUES)
    light[:, 1] = 1.5 * light[:, 0]
    pack = owned(Pack(gpu, "8bit"))
    stored = owned(Buffer(gpu, "stored", VALUES * 4))
    pack.encode(commands, owned(buffer_of(gpu, "light", light)), stored, VALUES)
    commands.submit()
    codes = stored.read(np.int8).reshape(-1, 4).astype(np.float64) / 127.0
    place = (np.abs(codes[:, 0]) - 1 / 127) / (1 - 1 / 127)
    back = np.sign(codes[:, 0]) * 2.0 ** (-18.0 + 22.0 * place) / pack.range.read()[0]
    np.testing.assert_allclose(back, light[:, 0], rtol=0.065)
    np.testing.assert_allclose(3.0 * codes[:, 1], 1.5, atol=0.02)
