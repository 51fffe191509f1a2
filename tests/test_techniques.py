"""Techniques by name, and their settings from the scene and from the caller."""

from __future__ import annotations

import dataclasses

import pytest

from airlight.errors import SettingsError, nearest
from airlight.lighting.kit import Context
from airlight.scene import Scene
from airlight.techniques import TECHNIQUES, make_technique, technique_settings


def _context(scene: Scene) -> Context:
    """Without a device: settings are checked before one is used."""
    return Context(None, scene, None, (64, 48))  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(TECHNIQUES))
def test_every_technique_has_settings_with_defaults_and_help(name):
    settings = technique_settings(name)
    settings()
    for field in dataclasses.fields(settings):
        assert field.metadata["help"], field.name


def test_the_promised_names_are_there():
    promised = {"direct", "single", "lpv", "lpv-march", "lpv-sum", "lpv-scatter", "pop", "auto"}
    assert promised <= set(TECHNIQUES)


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("lpw", "Did you mean 'lpv'?"),
        ("dirct", "Did you mean 'direct'?"),
        ("zzz", nearest("zzz", TECHNIQUES)),
    ],
)
def test_an_unknown_technique_is_refused(name, remedy):
    with pytest.raises(SettingsError) as caught:
        technique_settings(name)
    assert str(caught.value) == f"unknown technique '{name}'. {remedy}"


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"iteration": 3},
            "technique lpv: unknown setting 'iteration'. Did you mean 'iterations'?",
        ),
        (
            {"iterations": -1},
            "technique lpv: setting iterations = -1 is out of range. It goes from 0 to 1024.",
        ),
        (
            {"iterations": "many"},
            "technique lpv: setting iterations = 'many' is not a whole number",
        ),
        (
            {"resolution": 3},
            "technique lpv: setting resolution = 3 is out of range. It goes from 4 to 256.",
        ),
        (
            {"scheme": "dom"},
            "technique lpv: setting scheme = 'dom' is unknown. Choose from centroid, paper.",
        ),
        ({"occlusion": "maybe"}, "technique lpv: setting occlusion = 'maybe' is not true or false"),
    ],
)
def test_bad_settings_are_refused_before_anything_is_made(values, message):
    with pytest.raises(SettingsError) as caught:
        make_technique(_context(Scene()), "lpv", values)
    assert str(caught.value) == message


def test_a_bad_setting_of_the_scene_file_is_refused_too():
    scene = Scene(settings={"lpv": {"resolutoin": 8}})
    with pytest.raises(SettingsError, match="unknown setting 'resolutoin'"):
        make_technique(_context(scene), "lpv", {})
