"""The steps of a path, written in Mitsuba's Python: flight, emission, lights, and how it goes on.

Only the child process imports this module, as `mitsuba_paths`.

Free paths are sampled by delta tracking with a channel drawn per step, weighted by the mean
density over the channels (one-sample balance heuristic); light is sampled by ratio tracking,
in closed form where the medium is homogeneous.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .mitsuba_brdf import dr, mi


def mis_weight(pdf: Any, other: Any) -> Any:
    """Power heuristic: pdf^2 / (pdf^2 + other^2)."""
    # By their ratio: squares of densities overflow, of a light seen along its own plane.
    return dr.select(pdf > 0.0, dr.rcp(1.0 + dr.square(other / pdf)), 0.0)


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


def flown(
    sampler: Any, ray: Any, medium: Any, si: Any, throughput: Any, active: Any
) -> tuple[Any, Any, Any, Any]:
    """Where rays collide in media before `si`, which do, which of those scatter; throughput."""
    # A tentative free flight by the majorant of the drawn channel; a surface before its end wins.
    throughput = mi.Spectrum(throughput)
    in_medium = active & (medium != None)  # noqa: E711 (an array of pointers)
    channel = pick_channel(sampler, in_medium)
    mei = medium.sample_interaction(ray, sampler.next_1d(in_medium), channel, in_medium)
    mei.t[in_medium & (si.t < mei.t)] = dr.inf

    # Its chance is the mean over channels, whichever was drawn.
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

    # Direct hits share their weight with emitter sampling, which could have found them too.
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
    # Vertices that can be lit: all but mirrors, in media wherever light scatters.
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

        # Surfaces let pass what they do: opaque ones end the walk, boundaries switch the medium.
        on_surface = active & ~collides & si.is_valid()
        bsdf = si.bsdf(ray)
        opening = bsdf.eval_null_transmission(si, on_surface)
        closed = on_surface & (dr.max(opening) == 0.0)
        if dr.hint(to_surface, mode="scalar"):
            T[on_surface & ~closed] *= opening
        else:
            T[on_surface] *= opening
        medium[on_surface & si.is_medium_transition()] = si.target_medium(ray.d)

        # On from the collision or the surface, with the distance that remains.
        travelled = dr.select(collides, mei.t, si.t)
        left = ray.maxt - travelled
        ray[collides] = mei.spawn_ray(ray.d)
        ray[on_surface] = si.spawn_ray(ray.d)
        ray.maxt = left
        active &= (collides | (on_surface & ~closed)) & (left > 0.0) & (dr.max(T) > 0.0)
    return T
