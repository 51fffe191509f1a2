"""The light along the paths of each gather point, added up by how far it comes."""

from __future__ import annotations

from dataclasses import replace

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u, vec3f
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import Slot, image, storage, texture, uniform
from ..lighting.view import View
from .far import Far
from .paths import Paths
from .points import Points


class PointSums(Struct):
    """What the rays of a point found, summed over them.

    Light of surfaces is of three kinds, `near`, `far` and `later`, since light from afar, and what
    near surfaces reflect of it, are alike at more of a point's neighbours than what lights shine on
    near surfaces. Of these two a point takes the mean radiance of many neighbours, times the share
    of rays that its closer ones send so far.
    """

    near = vec3f("W m^-2 sr^-1, radiance that first segments found at near surfaces")
    far_share = f32("rays that met far surfaces, shared as `near` is")
    near_flux = vec3f("where it comes from: `flux_along` times its luminance")
    open = f32("share of the hemisphere that near occluders leave")
    far = vec3f("W m^-2 sr^-1, radiance of far surfaces")
    far_rays = f32("that met such")
    far_flux = vec3f()
    far_inverse_m = f32("m^-1, inverse lengths of those rays")
    later = vec3f("W m^-2 sr^-1, radiance that later segments brought to near surfaces")
    later_rays = f32("that met near surfaces")
    later_flux = vec3f()
    far_begins = f32("m^-1, inverse length at which far begins; no sum")
    sky = vec3f("W m^-2 sr^-1, radiance of the environment")
    sky_variance = f32("before filters the sum of its luminance squared")
    sky_flux = vec3f()
    frames = f32("before this one, in the means of `History`; no sum")
    squares = vec3f("m^-1, `nearness` of what rays met: its squares")
    met_rays = f32("that met surfaces")
    products = vec3f("m^-1, its products")
    brightest = f32(
        "luminance of the ray that found most, by its first segment or by all later ones; no sum"
    )
    sides = vec3f("m^-1, normals that rays met over their lengths")


class SumParams(Struct):
    """Which rays are added; sums begin with ray number `begun`."""

    reduced = vec2u("points")
    rays = u32("of a point")
    first_ray = u32()
    begun = u32()
    texel = f32("m, how wide a texel is one metre away")


class _Sums(ComputePass):
    slots = (
        uniform("params", SumParams),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        storage("paths", "vec4f", "read_write"),
        storage("passed", "vec4f", "read_write"),
        storage("met", "u32"),
        storage("far", "f32"),
        storage("sums", PointSums, "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "sums.wgsl"


def sums_image(gpu: Gpu, label: str, points: Points) -> Texture:
    """An image of `PointSums`: a texel for each point, a layer for each row of four floats.

    Whoever reads those of many neighbours takes them from here: CPU adapters read a row of a buffer
    word by word, in four to seven times the time of a texel.
    """
    layers = PointSums.dtype.itemsize // 16
    size = (*points.reduced, layers)
    return Texture(gpu, label, size, "rgba32float", dimension="2d-array", written=True)


def read_sums(name: str) -> Slot:
    """The slot of a `sums_image` that is read by `sums_at`."""
    return replace(texture(name, "2d-array", "unfilterable-float"), struct=PointSums)


def written_sums() -> Slot:
    """The slot of a `sums_image` that `store_sums` writes."""
    return replace(image("sums_after", "rgba32float", "2d-array"), struct=PointSums)


class Sums:
    """`PointSums` for each point of a view."""

    def __init__(self, gpu: Gpu, points: Points) -> None:
        self._points, self.far = points, Far(gpu, points)
        self._pass = _Sums(gpu)
        self.buffer = Buffer(gpu, "gathered sums", PointSums.dtype.itemsize * points.count)

    def encode(
        self,
        commands: Commands,
        view: View,
        paths: Paths,
        passed: Buffer,
        numbers: range,
        sample: range,
    ) -> None:
        """Add what the first segments of the `paths` of the rays of these `numbers` found.

        `sample`: the numbers of all rays of this sample of the image. The paths go on without it.
        """
        # Where far begins is found once for all batches of a sample.
        if numbers.start == sample.start:
            self.far.encode(commands, view)
        self._pass.dispatch(
            commands,
            self._points.reduced,
            params=self._params(view, numbers, sample),
            places=self._points.places,
            normals=self._points.normals,
            paths=paths.buffer,
            passed=passed,
            met=paths.met,
            far=self.far.buffer,
            sums=self.buffer,
        )

    def _params(self, view: View, numbers: range, sample: range) -> SumParams:
        return SumParams(
            reduced=self._points.reduced,
            rays=len(numbers),
            first_ray=numbers.start,
            begun=sample.start,
            texel=self._points.texel_m(view),
        )
