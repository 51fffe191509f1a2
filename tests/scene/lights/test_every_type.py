"""What every type of light says of itself, held to its scene file, its checks and its shader."""

from __future__ import annotations

import ast
import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest

import airlight
from airlight.errors import SceneError
from airlight.gpu.source import LIBRARIES
from airlight.scene import Medium, Scene
from airlight.scene.io import load
from airlight.scene.io.toml_text import scene_text
from airlight.scene.lights import TYPES, area, directional, point, sample, spot

EXAMPLES = {
    "directional": directional.DirectionalLight((1, -2, 0.5), (3, 2, 1)),
    "point": point.PointLight((1, 2, 3), (4, 5, 6), radius=0.25),
    "spot": spot.SpotLight((0, 1, 0), (0, 0, -2), 7, inner_deg=15, outer_deg=40),
    "area": area.AreaLight((0, 1, 0), (1, 2, 3), "disk", radius=0.3, two_sided=True),
}
ON_DEVICE = {
    **{type(light).__name__: light for light in EXAMPLES.values() if not light.is_sampled},
    "LightSample": sample.LightSample((0, 1, 0), (0, -1, 0), (1, 2, 3), even=0.1),
}
each = pytest.mark.parametrize("light", EXAMPLES.values(), ids=list(EXAMPLES))


def test_every_type_has_an_example_here():
    assert {name: type(light) for name, light in EXAMPLES.items()} == TYPES


@each
def test_keys_describe_the_fields(light):
    """In their order, required where Python asks for them, with the same defaults."""
    own = dataclasses.fields(light)
    assert [key.name for key in light.keys] == [field.name for field in own]
    for key, field in zip(light.keys, own, strict=True):
        assert key.required == (field.default is dataclasses.MISSING)
        if not key.required:
            written = ast.literal_eval(key.default.capitalize())
            np.testing.assert_array_equal(written, field.default)
    assert sum(key.stands_for == "strength" for key in light.keys) == 1


@each
def test_a_scene_file_gives_the_light_back(light, tmp_path):
    path = tmp_path / "scene.toml"
    dark = Scene(medium=Medium((1.0, 1.0, 1.0)))
    lit = dataclasses.replace(dark, lights=(light,))
    path.write_text(scene_text(lit, dark, "builtin:none", tmp_path))
    assert load(path).lights == (light,)


@each
def test_python_is_held_to_the_checks_of_files(light):
    name = light.strength_name()
    with pytest.raises(SceneError, match=rf"light {name} = .* is negative"):
        light.changed(name, -1.0)


@each
def test_a_turn_and_its_inverse_give_the_light_back(light):
    turn = np.array([[0, 0, 1, 2], [0, 1, 0, -3], [-1, 0, 0, 5], [0, 0, 0, 1]], np.float64)
    there = light.moved(turn)
    back = there.moved(np.linalg.inv(turn))
    assert there != light
    for field in dataclasses.fields(light):
        value = getattr(light, field.name)
        if not isinstance(value, str):
            np.testing.assert_allclose(getattr(back, field.name), value, atol=1e-12)


@each
def test_a_change_in_the_viewer_is_a_light_again(light):
    """Also where two fields must agree: a narrower spot has a narrower core."""
    for key, control in light.controls():
        now = getattr(light, key.name)
        if control.widget in ("choice", "flag"):
            others = [c for c in control.choices if c != now] or [not now]
            assert all(getattr(light.changed(key.name, x), key.name) == x for x in others)
            continue
        half = 0.5 * np.asarray(now)
        value = tuple(half.tolist()) if half.ndim else float(half)
        changed = getattr(light.changed(key.name, value), key.name)
        wanted = half / np.linalg.norm(half) if key.stands_for == "direction" else half
        np.testing.assert_allclose(changed, wanted)
    assert "strength" in [key.stands_for for key, _ in light.controls()]


def test_shaders_know_the_same_kinds():
    text = (LIBRARIES[1] / "light_kinds.wgsl").read_text()
    known = {name: int(kind) for name, kind in re.findall(r"const LIGHT_(\w+) = (\d+)u;", text)}
    own = {name.replace("Light", "").upper(): light.kind for name, light in ON_DEVICE.items()}
    assert known == own


@pytest.mark.parametrize("light", ON_DEVICE.values(), ids=list(ON_DEVICE))
def test_no_direction_outside_the_cone_is_lit(light):
    cosine = np.linspace(-1.0, 1.0, 401)
    lit = light.sent_share(cosine) > 0.0
    if light.cone is not None:
        assert not lit[cosine < np.cos(np.radians(light.cone[1]))].any()
    assert lit[-1]


ROOT = Path(airlight.__file__).parent
ASK_FOR_A_TYPE = {
    "area/sources.py": "surfaces of area lights, balls about points",
    "pop/light/table.py": "what `as_point` gives: points and spots",
    "scatter/forward_textures.py": "lights without extent",
    "scene/light_shapes.py": "the surfaces of area lights",
}
"""Others ask `LightType`; only whether a light is directional may be asked anywhere."""


def asks(path: Path) -> bool:
    """Whether a module asks a light whether it is a point, spot, area light or a sample."""
    calls = (n for n in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(n, ast.Call))
    return any(
        ast.unparse(call.func) == "isinstance"
        and re.search(r"\b(Point|Spot|Area)Light\b|\bLightSample\b", ast.unparse(call.args[1]))
        for call in calls
    )


def test_nobody_else_asks_which_type_a_light_is_of():
    found = {path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*.py") if asks(path)}
    assert found == ASK_FOR_A_TYPE.keys()
