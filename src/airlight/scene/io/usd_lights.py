"""UsdLux lights, domes and UsdGeom cameras as airlight's own."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import SceneError
from ...maths.blackbody import xyz
from ...maths.transforms import triple
from ..camera import Camera, film_of
from ..checks import F64, Vec3
from ..environment import Environment
from ..lights import AreaLight, DirectionalLight, Light, PointLight, SpotLight
from ..material import Material

_RGB_FROM_XYZ = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)
_SMALL_M = 1e-6
_CONE_DEG = (0.1, 89.0)  # half angles that spot lights have


def strength(light: Any, time: Any) -> F64:
    """Radiance before `normalize`: intensity 2^exposure colour; taken as W m^-2 sr^-1."""
    # A black body's colour tints the light and leaves its luminance.
    color = np.array(light.GetColorAttr().Get(time), float)
    if light.GetEnableColorTemperatureAttr().Get(time):
        kelvin = float(np.clip(light.GetColorTemperatureAttr().Get(time), 1000.0, 10000.0))
        rgb = np.maximum(_RGB_FROM_XYZ @ np.asarray(xyz(kelvin)), 0.0)
        color = color * rgb / (rgb @ (0.2126, 0.7152, 0.0722))
    scale = light.GetIntensityAttr().Get(time) * 2.0 ** light.GetExposureAttr().Get(time)
    return np.asarray(np.maximum(color * scale, 0.0), np.float64)


def usd_light(prim: Any, world: F64, time: Any) -> Light | None:
    """A light placed by `world` (4, 4), metres; None for kinds that airlight has not.

    Raises SceneError for numbers that are none.
    """
    from pxr import UsdLux

    api = UsdLux.LightAPI(prim)
    radiance, is_whole = strength(api, time), bool(api.GetNormalizeAttr().Get(time))
    if not np.isfinite(radiance).all():
        raise SceneError(f"'{prim.GetPath()}': its light is no finite number")
    # Lights shine along their -Z; the placement's scale stretches their sizes.
    position, ahead, up = triple(world[:3, 3]), _unit(-world[:3, 2]), _unit(world[:3, 1])
    wide, high, deep = (float(n) for n in np.linalg.norm(world[:3, :3], axis=0))
    # Each kind in its own unit. A normalised light gives its whole power, whatever its size.
    if prim.IsA(UsdLux.DistantLight):
        half = math.radians(float(UsdLux.DistantLight(prim).GetAngleAttr().Get(time))) / 2.0
        solid = 1.0 if is_whole or half <= 0.0 else math.pi * math.sin(half) ** 2
        return DirectionalLight(direction=ahead, irradiance=triple(radiance * solid))
    if prim.IsA(UsdLux.RectLight):
        rect = UsdLux.RectLight(prim)
        size = (rect.GetWidthAttr().Get(time) * wide, rect.GetHeightAttr().Get(time) * high)
        radiance = radiance / max(size[0] * size[1], 1e-12) if is_whole else radiance
        return AreaLight(position, triple(radiance), "rectangle", ahead, up, size=_lengths(size))
    if prim.IsA(UsdLux.DiskLight):
        radius = UsdLux.DiskLight(prim).GetRadiusAttr().Get(time) * math.sqrt(wide * high)
        radiance = radiance / max(math.pi * radius**2, 1e-12) if is_whole else radiance
        return AreaLight(
            position, triple(radiance), "disk", ahead, up, radius=max(radius, _SMALL_M)
        )
    if not prim.IsA(UsdLux.SphereLight):
        return None
    # A sphere is a spot where its shaping cuts it to a cone, a point where it is told to be one.
    sphere = UsdLux.SphereLight(prim)
    radius = sphere.GetRadiusAttr().Get(time) * (wide * high * deep) ** (1.0 / 3.0)
    # From afar a sphere has the intensity pi r^2 times its radiance, 1 / (4 pi r^2) of a whole.
    intensity = triple(radiance / 4.0 if is_whole else radiance * math.pi * radius**2)
    is_point = radius <= _SMALL_M or bool(sphere.GetTreatAsPointAttr().Get(time))
    cone = cone_of(prim, time)
    if cone is not None:
        return SpotLight(position, ahead, intensity, *cone, radius=0.0 if is_point else radius)
    # One too small to see is a point.
    if is_point:
        return PointLight(position, intensity)
    radiance = radiance / (4.0 * math.pi * radius**2) if is_whole else radiance
    return AreaLight(position, triple(radiance), "sphere", radius=radius)


def cone_of(prim: Any, time: Any) -> tuple[float, float] | None:
    """The half angles, degrees, that a light's shaping lights in full and at all; None without.

    It fades over the share `softness` of the outer one.
    """
    from pxr import UsdLux

    if not prim.HasAPI(UsdLux.ShapingAPI):
        return None
    shaping = UsdLux.ShapingAPI(prim)
    outer = shaping.GetShapingConeAngleAttr().Get(time)
    softness = shaping.GetShapingConeSoftnessAttr().Get(time) or 0.0
    # At 90 degrees, its fallback, nothing is cut off.
    if outer is None or not math.isfinite(outer) or outer >= 90.0:
        return None
    outer = float(np.clip(outer, *_CONE_DEG))
    share = 1.0 - float(np.clip(softness, 0.0, 1.0)) if math.isfinite(softness) else 1.0
    return min(outer * share, outer), outer


def cone_losses(prim: Any, time: Any) -> list[str]:
    """What a light's shaping asks for that `cone_of` does not give."""
    from pxr import UsdLux

    shaping = UsdLux.ShapingAPI(prim)
    angle, softness = shaping.GetShapingConeAngleAttr(), shaping.GetShapingConeSoftnessAttr()
    outer, soft = angle.Get(time), softness.Get(time)
    told = []
    low, high = _CONE_DEG
    # At 180 degrees a cone is all round; what is not written is the fallback, and says nothing.
    if angle.HasAuthoredValue() and outer is not None and not outer >= 180.0:
        whole = f"cones of 90 degrees and more light all around: it is {outer:g}"
        if not outer < 90.0:
            told.append(f"{angle.GetName()}: {whole}")
        elif not low <= outer <= high:
            nearest = low if outer < low else high
            told.append(f"{angle.GetName()} is {outer:g}, taken as {nearest:g} degrees")
    if soft is not None and not 0.0 <= soft <= 1.0:
        taken = "1" if soft > 1.0 else "0"
        told.append(f"{softness.GetName()} is {soft:g}, taken as {taken}: it is a share")
    return told


def glowing(material: Material, prim: Any, area_m2: float, time: Any) -> Material:
    """The material of a mesh that is a light, of this area in the world.

    A material that glows itself tints the light, unless the light says that it does not.
    """
    from pxr import UsdLux

    api = UsdLux.LightAPI(prim)
    radiance = strength(api, time)
    if not np.isfinite(radiance).all():
        raise SceneError(f"'{prim.GetPath()}': its light is no finite number")
    if api.GetNormalizeAttr().Get(time):
        radiance = radiance / max(area_m2, 1e-12)
    mode = str(prim.GetAttribute("light:materialSyncMode").Get(time) or "materialGlowTintsLight")
    if mode == "materialGlowTintsLight" and material.is_emissive:
        return replace(material, emission=triple(radiance * np.array(material.emission)))
    glow: dict[str, Any] = {"emission": triple(radiance), "emission_texture": None}
    # A surface that answers no light is black but for what it sends.
    if mode == "noMaterialResponse":
        glow |= {"base_color": (0.0, 0.0, 0.0), "base_color_texture": None, "specular": 0.0}
    return replace(material, **glow)


def dome(prim: Any, world: F64, time: Any, image: Any) -> tuple[Environment, bool]:
    """The environment of a DomeLight with its map `image` or None, and whether it was tilted."""
    from pxr import UsdLux

    radiance = strength(UsdLux.LightAPI(prim), time)
    # A map turns about the vertical axis alone.
    pole, ahead = _unit(world[:3, 1]), world[:3, 2]
    yaw = math.degrees(math.atan2(ahead[0], ahead[2]))
    if image is None:
        return Environment(radiance=triple(radiance)), False
    tinted = np.asarray(image * radiance.astype(np.float32), np.float32)
    return Environment(map=tinted, rotation_deg=yaw), pole[1] < 0.99


def usd_camera(prim: Any, world: F64, time: Any, metres: float) -> Camera:
    """A perspective camera placed by `world`; `metres`: a unit of the stage.

    Raises SceneError for one that airlight has not, or that sees nothing.
    """
    from pxr import Gf, UsdGeom

    camera = UsdGeom.Camera(prim)
    seen = camera.GetCamera(time)
    if seen.projection != Gf.Camera.Perspective:
        raise SceneError("only perspective cameras are used")
    # Its view is between its film and its lens, so both have a size.
    lens = {"focalLength": seen.focalLength, "verticalAperture": seen.verticalAperture}
    for name, length in lens.items():
        if not 0.0 < length < math.inf:
            raise SceneError(f"{name} is {length:g}, which sees nothing")
    fov = float(np.clip(seen.GetFieldOfView(Gf.Camera.FOVVertical), 0.1, 179.0))
    # USD's cameras look along -Z.
    ahead, f_stop = _unit(-world[:3, 2]), float(seen.fStop)
    focus = float(seen.focusDistance) * metres
    # A focal length is in tenths of the stage's unit.
    aperture = 0.1 * float(seen.focalLength) * metres / f_stop if f_stop > 0.0 else 0.0
    return Camera(
        position=triple(world[:3, 3]),
        target=triple(world[:3, 3] + np.array(ahead)),
        up=_unit(world[:3, 1]),
        fov_y_deg=fov,
        film_px=film_of(float(seen.aspectRatio)),
        exposure_stops=None,
        aperture_m=aperture if focus > 0.0 else 0.0,
        focus_m=focus if focus > 0.0 and aperture > 0.0 else None,
    )


def _lengths(size: tuple[float, float]) -> tuple[float, float]:
    return max(size[0], _SMALL_M), max(size[1], _SMALL_M)


def _unit(v: Any) -> Vec3:
    return triple(np.asarray(v) / max(float(np.linalg.norm(v)), 1e-30))
