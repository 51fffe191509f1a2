"""Real-time light transport in air: fog, smoke, clouds and indirect light, on any GPU or none.

>>> import airlight as al
>>> image = al.render(al.scenes.cornell(), technique="lpv", size=(640, 360))
>>> image.save("cornell.png")

load, scenes      a scene: from a file, or one that ships
with_defaults     a camera that frames it, and daylight, where a scene has none
render, Renderer  a picture of it; or many, with the scene kept on the device
export_lattice    the light that was solved, as arrays for other programs
reference         the same scene by unbiased path tracing, and how far apart two pictures are
Scene, Mesh, ...  what scenes are made of
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .errors import (
    AirlightError,
    DeviceError,
    OutputError,
    ReferenceFailure,
    SceneError,
    SettingsError,
)
from .scene import (
    Camera,
    DirectionalLight,
    Environment,
    Geometry,
    Light,
    Material,
    Medium,
    Mesh,
    PointLight,
    PointLights,
    Scene,
    SpotLight,
    Texture,
    Volume,
)
from .scene.image import Image
from .scene.io import load, with_defaults

if TYPE_CHECKING:
    from . import reference
    from .app.view_notebook import view
    from .exports.light_field import LightField
    from .exports.solved import export_lattice
    from .rendering import Renderer, render
    from .scene import builtin as scenes

__version__ = "0.1.0"

# Imported on first use: the graphics library and the path tracer take their time.
_LATER = {
    "render": ("airlight.rendering", "render"),
    "Renderer": ("airlight.rendering", "Renderer"),
    "LightField": ("airlight.exports.light_field", "LightField"),
    "export_lattice": ("airlight.exports.solved", "export_lattice"),
    "scenes": ("airlight.scene.builtin", ""),
    "reference": ("airlight.reference", ""),
    "view": ("airlight.app.view_notebook", "view"),
}

__all__ = [
    "AirlightError",
    "Camera",
    "DeviceError",
    "DirectionalLight",
    "Environment",
    "Geometry",
    "Image",
    "Light",
    "LightField",
    "Material",
    "Medium",
    "Mesh",
    "OutputError",
    "PointLight",
    "PointLights",
    "ReferenceFailure",
    "Renderer",
    "Scene",
    "SceneError",
    "SettingsError",
    "SpotLight",
    "Texture",
    "Volume",
    "export_lattice",
    "load",
    "reference",
    "render",
    "scenes",
    "view",
    "with_defaults",
]


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'airlight' has no attribute '{name}'")
    module, attribute = _LATER[name]
    imported = importlib.import_module(module)
    value = getattr(imported, attribute) if attribute else imported
    globals()[name] = value
    return value
