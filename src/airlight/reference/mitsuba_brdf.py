"""airlight's own reflection model, written in Mitsuba's Python.

Lambert plus GGX as in glTF 2.0, appendix B, so that a reference differs from airlight by light
transport alone. Only the child process imports this module, with a compiled (llvm) variant set;
elsewhere `principled` stands in for it.

f = (1 - F) (1 - metallic) base_color / pi + F D V: F is Schlick's, with F0 = 0.04 specular or
the metal's colour, D is GGX with alpha = roughness^2, V is Smith's height-correlated masking
and shadowing (Heitz 2014).
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

# Their stubs describe no variant in particular: what is written here is checked by running it.
dr: Any = import_module("drjit")
mi: Any = import_module("mitsuba")

PLUGIN = "airlight"
MIN_ALPHA = 0.002


def register() -> None:
    """Make the model known as `airlight` to the variant that is set."""
    mi.register_bsdf(PLUGIN, make_bsdf())


def make_bsdf() -> Any:
    """The BSDF class; made late (hence here), since its base belongs to the variant set."""

    class GltfReflection(mi.BSDF):  # type: ignore[misc]
        def __init__(self, props: Any) -> None:
            super().__init__(props)
            take_properties(self, props)
            front = mi.BSDFFlags.FrontSide
            self.m_components = [
                mi.BSDFFlags.DiffuseReflection | front,
                mi.BSDFFlags.GlossyReflection | front,
            ]
            self.m_flags = self.m_components[0] | self.m_components[1]

        def sample(
            self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True
        ) -> tuple[Any, Any]:
            surface = self._surface(si, active)
            glossy = sample1 < surface.glossy_share(si.wi)
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo = surface.sampled(si.wi, glossy, sample2)
            bs.eta = 1.0
            bs.sampled_component, bs.sampled_type = lobe(glossy)
            value, bs.pdf = self.eval_pdf(ctx, si, bs.wo, active)
            usable = active & (bs.pdf > 0.0)
            return bs, dr.select(usable, value / bs.pdf, 0.0)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
            surface = self._surface(si, active)
            above = active & (mi.Frame3f.cos_theta(si.wi) > 0.0) & (mi.Frame3f.cos_theta(wo) > 0.0)
            value = surface.reflection(si.wi, wo) * mi.Frame3f.cos_theta(wo)
            return dr.select(above, value, 0.0), dr.select(above, surface.pdf(si.wi, wo), 0.0)

        def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
            return self._surface(si, active).diffuse

        def _surface(self, si: Any, active: Any) -> Surface:
            return Surface(
                self.base_color.eval(si, active),
                self.roughness.eval_1(si, active),
                self.metallic.eval_1(si, active),
                self.specular,
            )

        def to_string(self) -> str:
            return "GltfReflection[]"

    return GltfReflection


def take_properties(bsdf: Any, props: Any) -> None:
    """Give a BSDF the properties that a material of glTF has."""
    bsdf.base_color = props.get_texture("base_color", 0.8)
    bsdf.roughness = props.get_texture("roughness", 1.0)
    bsdf.metallic = props.get_texture("metallic", 0.0)
    bsdf.specular = props.get("specular", 1.0)


def lobe(glossy: Any) -> tuple[Any, Any]:
    """The number and the kind of the glossy lobe, or of the diffuse one."""
    kinds = (mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.DiffuseReflection)
    number = dr.select(glossy, mi.UInt32(1), mi.UInt32(0))
    return number, dr.select(glossy, mi.UInt32(+kinds[0]), mi.UInt32(+kinds[1]))


class Surface:
    """The reflection model at one point: directions are local, z along the shading normal."""

    def __init__(self, base_color: Any, roughness: Any, metallic: Any, specular: float) -> None:
        self.diffuse = base_color * (1.0 - metallic)
        self.f0 = dr.lerp(mi.Spectrum(0.04 * specular), base_color, metallic)
        self.f90 = dr.clip(50.0 * dr.max(self.f0), 0.0, 1.0)
        self.alpha = dr.maximum(dr.square(roughness), MIN_ALPHA)
        self.microfacets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha)

    def fresnel(self, cosine: Any) -> Any:
        """Schlick's term."""
        x = dr.clip(1.0 - cosine, 0.0, 1.0)
        return self.f0 + (self.f90 - self.f0) * (dr.square(dr.square(x)) * x)

    def glossy_share(self, wi: Any) -> Any:
        """How often to sample the glossy lobe."""
        glossy = dr.mean(self.fresnel(mi.Frame3f.cos_theta(wi)))
        diffuse = dr.mean(self.diffuse)
        share = glossy / dr.maximum(glossy + diffuse, 1e-6)
        return dr.select(diffuse > 0.0, dr.clip(share, 0.1, 0.9), 1.0)

    def sampled(self, wi: Any, glossy: Any, sample: Any) -> Any:
        """A direction of the glossy lobe, or of the diffuse one."""
        normal, _ = self.microfacets.sample(wi, sample)
        scattered = mi.warp.square_to_cosine_hemisphere(sample)
        return dr.select(glossy, mi.reflect(wi, normal), scattered)

    def reflection(self, wi: Any, wo: Any) -> Any:
        """f, sr^-1."""
        half = dr.normalize(wi + wo)
        n_v, n_l = mi.Frame3f.cos_theta(wi), mi.Frame3f.cos_theta(wo)
        F = self.fresnel(dr.dot(wi, half))
        a2 = dr.square(self.alpha)
        D = a2 / (dr.pi * dr.square(dr.square(half.z) * (a2 - 1.0) + 1.0))
        masking = n_l * dr.sqrt(dr.square(n_v) * (1.0 - a2) + a2)
        shadowing = n_v * dr.sqrt(dr.square(n_l) * (1.0 - a2) + a2)
        V = 0.5 / dr.maximum(masking + shadowing, 1e-6)
        return (1.0 - F) * self.diffuse * dr.inv_pi + F * (D * V)

    def pdf(self, wi: Any, wo: Any) -> Any:
        """How likely `wo` is sampled, sr^-1."""
        half = dr.normalize(wi + wo)
        mirrored = self.microfacets.pdf(wi, half) / (4.0 * dr.abs(dr.dot(wo, half)))
        scattered = mi.warp.square_to_cosine_hemisphere_pdf(wo)
        return dr.lerp(scattered, mirrored, self.glossy_share(wi))
