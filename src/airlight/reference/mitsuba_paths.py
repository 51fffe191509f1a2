"""A volumetric path tracer that tells its light apart, written in Mitsuba's Python.

Only the child process imports this module: it needs a Mitsuba variant already set, and a
compiled one (llvm), since Dr.Jit traces this code once and compiles it.

Every contribution has n scattering events (reflections and in-air scatterings alike, glossy
ones too) between the emitter and the eye, and a first event as seen from the eye:
    n = 0                      emission seen directly          -> direct
    n = 1, at a surface        direct light                    -> direct
    n = 2, first at a surface  exactly one more event          -> one_bounce (part of indirect)
    n > 1, first at a surface  all further light               -> indirect
    n = 1, in the air          single scattering               -> single_scatter
    n > 1, first in the air    multiple scattering             -> multiple_scatter
direct + indirect + single_scatter + multiple_scatter is the whole image.
transmittance is exp(-optical depth) from the eye to the first surface, or to infinity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .mitsuba_brdf import dr, mi, plugin_class
from .mitsuba_steps import (
    Vertex,
    emitted,
    flown,
    sampled_bsdf,
    sampled_light,
    sampled_phase,
    transmittance,
)

PATH_LAYERS = (
    "direct",
    "one_bounce",
    "indirect",
    "single_scatter",
    "multiple_scatter",
    "transmittance",
)
RUSSIAN_ROULETTE_DEPTH = 5


@dataclass(frozen=True)
class Options:
    """What the integrator may leave out: code that is not traced costs nothing."""

    max_depth: int
    hide_environment: bool
    has_media: bool
    has_masks: bool


def register() -> None:
    """Make the integrator known as `airlight_layers` to the variant that is set."""
    made = plugin_class(LayeredPaths, mi.SamplingIntegrator)
    mi.register_integrator("airlight_layers", made)


class LayeredPaths:
    """The integrator: methods for `plugin_class`."""

    def __init__(self, props: Any) -> None:
        mi.SamplingIntegrator.__init__(self, props)
        limit = props.get("max_depth", -1)
        self.options = Options(
            max_depth=2**31 if limit < 0 else limit,
            hide_environment=props.get("hide_environment", False),
            has_media=props.get("has_media", True),
            has_masks=props.get("has_masks", True),
        )

    def aov_names(self) -> list[str]:
        """The names of the layers' channels."""
        return [f"{layer}.{c}" for layer in PATH_LAYERS for c in "RGB"]

    def sample(
        self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
    ) -> Any:
        """The image and all layers, along rays from the eye."""
        # Transmittance has a walk of its own; without media or masks it is 1.
        eye = mi.Ray3f(ray)
        inside = mi.MediumPtr(medium)
        here = mi.Bool(active)
        through = mi.Spectrum(1)
        if self.options.has_media or self.options.has_masks:
            through = transmittance(scene, sampler, eye, inside, here, to_surface=True)
        found = trace(scene, sampler, eye, inside, here, self.options)

        # Layers without one_bounce, which is a part of indirect, add up to the image.
        direct, _, indirect, single, multiple = found
        layers = (*found, through)
        total = direct + indirect + single + multiple
        return total, mi.Bool(True), [layer[k] for layer in layers for k in range(3)]

    def to_string(self) -> str:
        """As Mitsuba prints it."""
        return "LayeredPaths[]"


@dr.syntax  # type: ignore[untyped-decorator]
def trace(scene: Any, sampler: Any, ray: Any, medium: Any, active: Any, options: Options) -> Any:
    """The first five of PATH_LAYERS along one path per ray; see the module."""
    # Dr.Jit's loops carry local variables, and would try to write into `options`.
    max_depth, hide_environment = options.max_depth, options.hide_environment
    has_media, has_masks = options.has_media, options.has_masks
    ray, medium, active = mi.Ray3f(ray), mi.MediumPtr(medium), mi.Bool(active)
    layers = no_light()
    throughput, events, medium_first = mi.Spectrum(1), mi.UInt32(0), mi.Bool(False)
    last, last_pdf, last_delta = dr.zeros(mi.Interaction3f), mi.Float(1), mi.Bool(True)

    while active:
        active, throughput = roulette(sampler, throughput, events, active)

        # Free flight to the nearer of a collision and a surface.
        si = scene.ray_intersect(ray, active)
        mei, collides, scatters = dr.zeros(mi.MediumInteraction3f), mi.Bool(False), mi.Bool(False)
        if dr.hint(has_media, mode="scalar"):
            mei, collides, scatters, throughput = flown(
                sampler, ray, medium, si, throughput, active
            )
            ray[collides & ~scatters] = mei.spawn_ray(ray.d)

        # Emission where the ray ends.
        shines = active & ~collides
        if dr.hint(hide_environment, mode="scalar"):
            shines &= si.is_valid() | (events > 0)
        found = emitted(scene, si, (last, last_pdf, last_delta), throughput, shines)
        layers = credited(layers, events, medium_first, found)

        # Light sampled from this vertex: one event more.
        on_surface = active & ~collides & si.is_valid()
        bsdf = si.bsdf(ray)
        found = sampled_light(
            scene, sampler, Vertex(si, mei, bsdf, medium, on_surface, scatters), throughput,
            events + 1 < max_depth, has_media, has_media or has_masks,
        )  # fmt: skip
        medium_first |= scatters & (events == 0)
        layers = credited(layers, events + 1, medium_first, found)

        # Onward: the phase function, or the surface.
        if dr.hint(has_media, mode="scalar"):
            wo, phase_weight, last_pdf[scatters] = sampled_phase(sampler, medium, mei, scatters)
            throughput[scatters] *= phase_weight
            ray[scatters], last[scatters], last_delta[scatters] = mei.spawn_ray(wo), mei, False
        bs, bsdf_weight, reflects = sampled_bsdf(sampler, bsdf, si, on_surface)
        throughput[on_surface] *= bsdf_weight
        ray[on_surface] = si.spawn_ray(si.to_world(bs.wo))
        medium[on_surface & si.is_medium_transition()] = si.target_medium(ray.d)
        last[reflects], last_pdf[reflects] = si, bs.pdf
        last_delta[reflects] = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
        events[scatters | reflects] += 1
        active &= (collides | on_surface) & (events < max_depth)

    return layers


def no_light() -> tuple[Any, ...]:
    """The first five of PATH_LAYERS, black."""
    return tuple(mi.Spectrum(0) for _ in PATH_LAYERS[:5])


def credited(layers: tuple[Any, ...], events: Any, in_medium: Any, found: Any) -> tuple[Any, ...]:
    """The layers with light `found` after so many events, the first of them in a medium or not."""
    direct, one, indirect, single, multiple = layers
    return (
        direct + dr.select((events < 2) & ~in_medium, found, 0.0),
        one + dr.select((events == 2) & ~in_medium, found, 0.0),
        indirect + dr.select((events > 1) & ~in_medium, found, 0.0),
        single + dr.select((events == 1) & in_medium, found, 0.0),
        multiple + dr.select((events > 1) & in_medium, found, 0.0),
    )


def roulette(sampler: Any, throughput: Any, events: Any, active: Any) -> tuple[Any, Any]:
    """Which paths are still `active`, and their throughput, of weights near one."""
    # Paths survive by their brightest channel, and those that do carry the rest's weight.
    q = dr.minimum(dr.max(throughput), 0.95)
    is_asked = events > RUSSIAN_ROULETTE_DEPTH
    survives = (sampler.next_1d(active) < q) | ~is_asked
    throughput = dr.select(is_asked, throughput * dr.rcp(q), throughput)
    return active & survives & dr.any(throughput != 0.0), throughput
