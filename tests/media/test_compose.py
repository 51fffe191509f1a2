"""out = surfaces * transmittance."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.media.compositing.compose import Compose

SIZE = (5, 3)


def test_layers_lie_behind_the_air(gpu: Gpu) -> None:
    rng = np.random.default_rng(4)
    names = ("direct", "indirect", "transmittance")
    values = {name: rng.random((3, 5, 4)).astype(np.float32) for name in names}
    textures = {name: Texture(gpu, name, SIZE, "rgba32float") for name in names}
    for name in names:
        textures[name].write(values[name])
    commands, compose = Commands(gpu), Compose(gpu, SIZE)
    compose.encode(commands, **textures)
    commands.submit()
    T = values["transmittance"][..., :3]
    direct, indirect = (values[n][..., :3] * T for n in ("direct", "indirect"))
    assert compose.direct.read()[..., :3] == pytest.approx(direct)
    assert compose.indirect.read()[..., :3] == pytest.approx(indirect)
    # Alpha says where surfaces are.
    assert compose.direct.read()[..., 3] == pytest.approx(values["direct"][..., 3])
