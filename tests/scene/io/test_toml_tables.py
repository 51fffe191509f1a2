"""The tables agree with the scene values that they fill, and print themselves."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from airlight.scene import (
    AreaLight,
    Camera,
    DirectionalLight,
    Environment,
    Medium,
    PointLight,
    SpotLight,
    Volume,
)
from airlight.scene.io.toml_keys import KEYS, SEQUENCE_KEYS
from airlight.scene.io.toml_media_tables import MEDIUM, VOLUME
from airlight.scene.io.toml_page import schema_markdown
from airlight.scene.io.toml_tables import (
    CAMERA,
    ENVIRONMENT,
    LIGHT,
    TABLES,
)

NOT_FIELDS = {
    "file",
    "type",
    "sigma_s",
    "sigma_a",
    "grid",
    "sigma_t_grid",
    "sigma_s_grid",
    "sigma_a_grid",
    "albedo_grid",
    "g_grid",
    "emission_grid",
    "temperature_grid",
    "temperature_scale",
    "temperature_offset",
    "channels",
    "up",
    "between",
    "translate",
    "rotate_deg",
    "scale",
    "matrix",
    *(key.name for key in SEQUENCE_KEYS),
}
"""Keys that the loader turns into others."""


@pytest.mark.parametrize(
    ("keys", "value_class"),
    [
        (CAMERA.keys, Camera),
        (LIGHT.keys + LIGHT.variants["directional"], DirectionalLight),
        (LIGHT.keys + LIGHT.variants["point"], PointLight),
        (LIGHT.keys + LIGHT.variants["spot"], SpotLight),
        (LIGHT.keys + LIGHT.variants["area"], AreaLight),
        (ENVIRONMENT.keys, Environment),
        (MEDIUM.keys, Medium),
        (VOLUME.keys, Volume),
    ],
)
def test_every_key_is_a_field_and_says_its_true_default(keys, value_class):
    fields = {f.name: f for f in dataclasses.fields(value_class)}
    for key in keys:
        if key.name in NOT_FIELDS:
            continue
        default = fields[key.name].default
        if isinstance(default, (int, float)) and not isinstance(default, bool) and key.default:
            assert float(key.default) == default, key.name


def test_the_reference_names_every_key_of_every_table():
    page = schema_markdown()
    for table in (*TABLES, *KEYS.values()):
        assert f"## `{table.header}`" in page
        keys = [*table.keys, *(k for ks in (table.variants or {}).values() for k in ks)]
        for key in keys:
            assert f"| `{key.name}` | {key.kind.words} |" in page


def test_the_printed_reference_is_up_to_date():
    page = Path(__file__).parents[3] / "docs" / "scene-file.md"
    assert page.read_text(encoding="utf-8") == schema_markdown(), "print it with ./run docs"
