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

Free paths are sampled by delta tracking with a channel drawn per step, weighted by the mean
density over the channels (one-sample balance heuristic); light is sampled by ratio tracking,
in closed form where the medium is homogeneous.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .mitsuba_brdf import dr, mi, plugin_class

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
        eye = mi.Ray3f(ray)
        inside = mi.MediumPtr(medium)
        here = mi.Bool(active)
        through = mi.Spectrum(1)
        if self.options.has_media or self.options.has_masks:
            through = transmittance(scene, sampler, eye, inside, here, to_surface=True)
        found = trace(scene, sampler, eye, inside, here, self.options)
        direct, _, indirect, single, multiple = found
        layers = (*found, through)
        total = direct + indirect + single + multiple
        return total, mi.Bool(True), [layer[k] for layer in layers for k in range(3)]

    def to_string(self) -> str:
        """As Mitsuba prints it."""
        return "LayeredPaths[]"


def mis_weight(pdf: Any, other: Any) -> Any:
    """Power heuristic."""
    a, b = dr.square(pdf), dr.square(other)
    return dr.select(pdf > 0.0, a / (a + b), 0.0)


def pick_channel(sampler: Any, active: Any) -> Any:
    """A channel 0..2 per ray, each as likely."""
    return mi.UInt32(dr.minimum(3.0 * sampler.next_1d(active), 2.0))


@dataclass(frozen=True)
class Vertex:
    """Where paths are: at `si` those `on_surface`; at `mei`, in `medium`, those it `scatters`."""

    si: Any
    mei: Any
    bsdf: Any
    medium: Any
    on_surface: Any
    scatters: Any


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
    q = dr.minimum(dr.max(throughput), 0.95)
    is_asked = events > RUSSIAN_ROULETTE_DEPTH
    survives = (sampler.next_1d(active) < q) | ~is_asked
    throughput = dr.select(is_asked, throughput * dr.rcp(q), throughput)
    return active & survives & dr.any(throughput != 0.0), throughput


def flown(
    sampler: Any, ray: Any, medium: Any, si: Any, throughput: Any, active: Any
) -> tuple[Any, Any, Any, Any]:
    """Where rays collide in media before `si`, which do, which of those scatter; throughput."""
    throughput = mi.Spectrum(throughput)
    in_medium = active & (medium != None)  # noqa: E711 (an array of pointers)
    channel = pick_channel(sampler, in_medium)
    mei = medium.sample_interaction(ray, sampler.next_1d(in_medium), channel, in_medium)
    mei.t[in_medium & (si.t < mei.t)] = dr.inf
    tr, pdf = medium.transmittance_eval_pdf(mei, si, in_medium)
    density = dr.mean(pdf)
    throughput[in_medium] *= dr.select(density > 0.0, tr / density, 0.0)

    # A collision is real or null.
    collides = in_medium & mei.is_valid()
    real_share = dr.mean(mei.sigma_t / mei.combined_extinction)
    is_real = sampler.next_1d(collides) < real_share
    scatters, passes = collides & is_real, collides & ~is_real
    throughput[scatters] *= mei.sigma_s / real_share
    throughput[passes] *= mei.sigma_n / (1.0 - real_share)
    return mei, collides, scatters, throughput


def emitted(scene: Any, si: Any, came: tuple[Any, Any, Any], throughput: Any, shines: Any) -> Any:
    """What reaches the eye of the emission that rays meet at `si`.

    `came`: the vertex before, how likely it sent the ray, sr^-1, and whether nowhere else.
    """
    last, last_pdf, last_delta = came
    emitter = si.emitter(scene, shines)
    shines = shines & (emitter != None)  # noqa: E711
    ds = mi.DirectionSample3f(scene, si, last)
    light_pdf = scene.pdf_emitter_direction(last, ds, shines & ~last_delta)
    weight = dr.select(last_delta, 1.0, mis_weight(last_pdf, light_pdf))
    return dr.select(shines, throughput * emitter.eval(si, shines) * weight, 0.0)


def sampled_light(
    scene: Any,
    sampler: Any,
    at: Vertex,
    throughput: Any,
    allowed: Any,
    has_media: bool,
    is_filtered: bool,
) -> Any:
    """What reaches the eye of a light that is sampled from vertices, where that is `allowed`.

    `is_filtered`: surfaces and media let some of it pass.
    """
    si, mei = at.si, at.mei
    smooth = mi.has_flag(at.bsdf.flags(), mi.BSDFFlags.Smooth)
    lit_surface, lit_medium = at.on_surface & smooth & allowed, at.scatters & allowed
    here = dr.zeros(mi.Interaction3f)
    here[lit_surface] = si
    here[lit_medium] = mei
    asked = lit_surface | lit_medium
    light, to_light = scene.sample_emitter_direction(here, sampler.next_2d(asked), False, asked)
    lit = asked & (light.pdf != 0.0)

    # How much of it arrives.
    to_shadow, seen = here.spawn_ray_to(light.p), mi.Spectrum(1)
    if is_filtered:
        medium = mi.MediumPtr(at.medium)
        medium[lit_surface & si.is_medium_transition()] = si.target_medium(light.d)
        seen = transmittance(scene, sampler, to_shadow, medium, lit, to_surface=False)
    else:
        lit &= ~scene.ray_test(to_shadow, lit)

    # What the vertex sends on of it.
    local = si.to_local(light.d)
    f, vertex_pdf = at.bsdf.eval_pdf(mi.BSDFContext(), si, local, lit_surface)
    if has_media:
        context = mi.PhaseFunctionContext(sampler)
        phase = phase_of(at.medium, at.scatters)
        f_medium, pdf_medium = phase.eval_pdf(context, mei, light.d, lit_medium)
        f = dr.select(lit_surface, f, f_medium)
        vertex_pdf = dr.select(lit_surface, vertex_pdf, pdf_medium)
    weight = dr.select(light.delta, 1.0, mis_weight(light.pdf, vertex_pdf))
    return dr.select(lit, throughput * f * weight * to_light * seen, 0.0)


def phase_of(medium: Any, scatters: Any) -> Any:
    """The phase functions of media where paths scatter, none elsewhere."""
    phase = medium.phase_function()
    phase[~scatters] = dr.zeros(mi.PhaseFunctionPtr)
    return phase


def sampled_phase(sampler: Any, medium: Any, mei: Any, scatters: Any) -> tuple[Any, Any, Any]:
    """Where paths that scatter go on, with their weights and how likely that was, sr^-1."""
    phase, context = phase_of(medium, scatters), mi.PhaseFunctionContext(sampler)
    chance, place = sampler.next_1d(scatters), sampler.next_2d(scatters)
    found: tuple[Any, Any, Any] = phase.sample(context, mei, chance, place, scatters)
    return found


def sampled_bsdf(sampler: Any, bsdf: Any, si: Any, on_surface: Any) -> tuple[Any, Any, Any]:
    """How paths on surfaces go on, with their weights, and which do not just pass."""
    chance, place = sampler.next_1d(on_surface), sampler.next_2d(on_surface)
    bs, weight = bsdf.sample(mi.BSDFContext(), si, chance, place, on_surface)
    return bs, weight, on_surface & ~mi.has_flag(bs.sampled_type, mi.BSDFFlags.Null)


@dr.syntax  # type: ignore[untyped-decorator]
def transmittance(
    scene: Any, sampler: Any, ray: Any, medium: Any, active: Any, *, to_surface: bool
) -> Any:
    """Along `ray`: `to_surface` as far as the first surface, else to its end and 0 behind one."""
    ray = mi.Ray3f(ray)
    medium = mi.MediumPtr(medium)
    active = mi.Bool(active)
    T = mi.Spectrum(1)
    while active:
        si = scene.ray_intersect(ray, active)
        in_medium = active & (medium != None)  # noqa: E711
        channel = pick_channel(sampler, in_medium)
        mei = medium.sample_interaction(ray, sampler.next_1d(in_medium), channel, in_medium)
        mei.t[in_medium & (si.t < mei.t)] = dr.inf

        # Homogeneous: the whole segment at once. Else ratio tracking with a grey majorant.
        whole = in_medium & medium.is_homogeneous()
        mei.t[whole] = dr.minimum(si.t, ray.maxt)
        tr, _ = medium.transmittance_eval_pdf(mei, si, whole)
        T[whole] *= tr
        mei.t[whole] = dr.inf
        collides = in_medium & mei.is_valid()
        T[collides] *= mei.sigma_n / mei.combined_extinction

        on_surface = active & ~collides & si.is_valid()
        bsdf = si.bsdf(ray)
        opening = bsdf.eval_null_transmission(si, on_surface)
        closed = on_surface & (dr.max(opening) == 0.0)
        if dr.hint(to_surface, mode="scalar"):
            T[on_surface & ~closed] *= opening
        else:
            T[on_surface] *= opening
        medium[on_surface & si.is_medium_transition()] = si.target_medium(ray.d)
        travelled = dr.select(collides, mei.t, si.t)
        left = ray.maxt - travelled
        ray[collides] = mei.spawn_ray(ray.d)
        ray[on_surface] = si.spawn_ray(ray.d)
        ray.maxt = left
        active &= (collides | (on_surface & ~closed)) & (left > 0.0) & (dr.max(T) > 0.0)
    return T
