"""Materials as shaders see them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from airlight.scene import Material, Texture
from airlight.surface.materials import differ_in_emission_alone, material_fields, uv_transform


def test_fields_are_the_materials_own() -> None:
    material = Material(base_color=(0.1, 0.2, 0.3), roughness=0.4, emission=2.0)
    fields = material_fields(material)
    assert fields["base_color"] == (0.1, 0.2, 0.3)
    assert fields["emission"] == (2.0, 2.0, 2.0)
    texture = Texture(np.zeros((1, 1, 4), np.uint8), scale=(2.0, 3.0), offset=(0.5, 0.25))
    assert uv_transform(texture) == (2.0, 3.0, 0.5, 0.25)
    assert uv_transform(None) == (1.0, 1.0, 0.0, 0.0)


def test_what_may_change_from_frame_to_frame() -> None:
    material = Material(emission=1.0)
    assert differ_in_emission_alone(replace(material, emission=3.0, name="lamp"), material)
    assert not differ_in_emission_alone(replace(material, roughness=0.5), material)
