"""Real-time light transport in air: fog, smoke, clouds and indirect light, on any GPU or none.

>>> import airlight as al
>>> image = al.render(al.scenes.cornell(), technique="lpv", size=(640, 360))
>>> image.save("cornell.png")

load, scenes      a scene: from a file, or one that ships
with_defaults     a camera that frames it, and light, where a scene has none
render, Renderer  an image of it; or many, with the scene kept on the device
export_lattice    the light that was solved, as arrays for other programs
light_field       the same of a Renderer's last frame, while lights and objects move
reference         the same scene by unbiased path tracing, and how far apart two images are
Scene, Mesh, ...  what scenes are made of
"""

from __future__ import annotations

import importlib

TYPE_CHECKING = False  # typing's own takes as long to import as all of this
if TYPE_CHECKING:
    from typing import Any

    from . import reference
    from .app.view.notebook import view
    from .errors import (
        AirlightError,
        DeviceError,
        OutputError,
        ReferenceFailure,
        SceneError,
        SettingsError,
    )
    from .exports.light_field import LightField
    from .exports.solved import export_lattice, light_field
    from .rendering import Renderer, render
    from .scene import (
        AreaLight,
        Camera,
        DirectionalLight,
        Emission,
        Environment,
        Geometry,
        Light,
        Material,
        Medium,
        Mesh,
        PointLight,
        PointLights,
        Scene,
        Sky,
        SpotLight,
        Texture,
        Volume,
        with_sky,
    )
    from .scene import builtin as scenes
    from .scene.image import Image
    from .scene.io import load, with_defaults

__version__ = "0.1.0"

__all__ = [
    "AirlightError",
    "AreaLight",
    "Camera",
    "DeviceError",
    "DirectionalLight",
    "Emission",
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
    "Sky",
    "SpotLight",
    "Texture",
    "Volume",
    "export_lattice",
    "light_field",
    "load",
    "reference",
    "render",
    "scenes",
    "view",
    "with_defaults",
    "with_sky",
]

# Everything is imported on first use, so that `import airlight` takes a moment and Ctrl-C is heard.
_HOMES = {
    "AirlightError": "errors",
    "DeviceError": "errors",
    "Image": "scene.image",
    "LightField": "exports.light_field",
    "OutputError": "errors",
    "ReferenceFailure": "errors",
    "Renderer": "rendering",
    "SceneError": "errors",
    "SettingsError": "errors",
    "export_lattice": "exports.solved",
    "light_field": "exports.solved",
    "load": "scene.io",
    "render": "rendering",
    "view": "app.view.notebook",
    "with_defaults": "scene.io",
}
"""Modules of public names; the others' is `scene`."""
_MODULES = {"reference": "reference", "scenes": "scene.builtin"}
"""Public names that are modules."""


def __getattr__(name: str) -> Any:
    if name in __all__ and name not in _MODULES:
        # Names by their home, modules by import; found once, they are globals.
        home = _HOMES.get(name, "scene")
        value = getattr(importlib.import_module(f"{__name__}.{home}"), name)
    else:
        value = _module(name)
    globals()[name] = value
    return value


def _module(name: str) -> Any:
    """A module of the package, as if it had been imported. Raises AttributeError."""
    import importlib.util

    # Private names stay private, and a name that is no module is no attribute.
    dotted = f"{__name__}.{_MODULES.get(name, name)}"
    if name.startswith("_") or importlib.util.find_spec(dotted) is None:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return importlib.import_module(dotted)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
