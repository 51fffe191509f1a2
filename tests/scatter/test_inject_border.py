"""Light that comes into a lattice from an endless medium around it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, Texture, buffer_of
from airlight.lattice.placement import Placement
from airlight.maths.half_space import plane_light, plane_radiance
from airlight.media.gpu_media import GpuMedia
from airlight.scatter.inject_border import (
    LEVELS,
    ROWS,
    TURNS,
    InjectBorder,
    Outside,
    incoming_light,
    levels,
)
from airlight.scene import DirectionalLight, Medium, Scene

SUN = DirectionalLight((0.0, -1.0, 0.0), (4.0, 2.0, 1.0))
AIR = Medium(0.2, (0.9, 0.8, 0.0), endless=True)
TOP = 10.0
# So small that it takes nothing from the light that goes through it.
SMALL = Placement((-0.03, 5.0, -0.02), 0.01, (6, 8, 4))
DEPTH = 0.2 * (TOP - 5.04)


class Found:
    """What comes into the cells of SMALL, (3, Z, Y, X, 4), their walls all `open_share` open."""

    def __init__(self, gpu, commands, owned, open_share: float, reflectance: float | None) -> None:
        air = owned(GpuMedia(gpu, Scene(medium=AIR), light_count=0))
        air.update(commands, Scene(medium=AIR), np.full(3, -1.0), np.array([1.0, TOP, 1.0]))
        border = owned(InjectBorder(gpu, SMALL, air))
        white = buffer_of(gpu, "colours", np.full(SMALL.cells, 0x00FFFFFF, np.uint32))
        owned(white)
        border.find(
            commands,
            Outside(AIR, TOP, (SUN,)),
            (SMALL, SMALL),
            SimpleNamespace(bound=_walls(gpu, owned, open_share)),
            None if reflectance is None else white,
            is_new=True,
        )
        cells, base = (owned(Buffer(gpu, n, 3 * SMALL.cells * 16)) for n in ("cells", "base"))
        for buffer in (cells, base):
            buffer.write(np.zeros((3 * SMALL.cells, 4), np.float32))
        border.encode(commands, cells, base)
        commands.submit()
        self.power, self.track, self.walls_get = (
            np.asarray(b.read(), np.float64).reshape(3, 4, 8, 6, 4)
            for b in (cells, border.beams, border.surface_beams)
        )


def _walls(gpu, owned, open_share: float) -> dict[str, Texture]:
    textures = {}
    for name in ("visibility_a", "visibility_b", "walls"):
        kind = "rgba8snorm" if name == "walls" else "rgba8unorm"
        texture = owned(Texture(gpu, name, SMALL.count, kind, dimension="3d"))
        byte = np.int8(0) if name == "walls" else np.uint8(round(255 * open_share))
        texture.write(np.full((4, 8, 6, 4), byte))
        textures[f"lattice_{name}"] = texture
    return textures


def test_rows_are_what_an_eye_sees_of_the_half_space():
    table = incoming_light(AIR, [SUN]).reshape(LEVELS, ROWS, 4)
    light = plane_light(0.9, np.array([1.0]), np.array([4.0]))
    share = 0.975 * 20 / (ROWS - 1)
    seen = plane_radiance(light, np.array([share / (1.0 - share)]), levels()[:, 0])
    np.testing.assert_allclose(table[:, 20, 0], seen[0])
    assert (table[..., 2] == 0.0).all()  # nothing scatters, nothing comes in scattered
    assert TURNS * levels()[:, 1].sum() == pytest.approx(4.0 * np.pi)


def test_a_small_open_lattice_holds_the_half_spaces_light(gpu, commands, owned):
    found = Found(gpu, commands, owned, 1.0, None)
    volume = SMALL.cell**3
    light = plane_light(0.9, np.array([1.0]), np.array([4.0]))
    fluence = np.interp(DEPTH, light.depth, light.scattered)
    np.testing.assert_allclose(found.track[0, ..., 0] / volume, fluence, rtol=0.02)
    flux = np.interp(DEPTH, light.depth, light.flux)
    np.testing.assert_allclose(-found.track[0, ..., 2] / volume, flux, rtol=0.03, atol=0.02)
    np.testing.assert_allclose(found.power[0, ..., 0], 0.18 * found.track[0, ..., 0], rtol=1e-4)
    assert (found.power[..., 1:] == 0.0).all() and (found.power[2] == 0.0).all()
    # Without walls what they would get is the same on the mean.
    even = found.walls_get[0, ..., 0] / found.track[0, ..., 0]
    np.testing.assert_allclose(even, 1.0, atol=0.05)


def test_closed_cells_get_none_but_at_the_border(gpu, commands, owned):
    """The border's own cells lie open to the outside; walls between turn back what they get."""
    found = Found(gpu, commands, owned, 0.0, 1.0)
    lit = found.track[0, ..., 0] > 0.0
    assert not lit[1:-1, 1:-1, 1:-1].any() and lit[0].all() and lit[:, 0].all()
    scattered = 0.18 * found.track[0, ..., 0]
    assert (found.power[0][lit][:, 0] > scattered[lit]).all()
    # The low x side's cell: light comes in towards +x, and goes back towards -x.
    assert found.track[0, 2, 4, 0, 1] > 0.0 > found.power[0, 2, 4, 0, 1]
