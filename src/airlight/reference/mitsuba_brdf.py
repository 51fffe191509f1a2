"""airlight's own reflection model, written in Mitsuba's Python.

Lambert plus GGX as in glTF 2.0, appendix B, so that a reference differs from airlight by light
transport alone. Only the child process imports this module, with a compiled (llvm) variant set;
elsewhere `principled` stands in for it.

f = (1 - F) (1 - metallic) base_color / pi + F D V: F is Schlick's, with F0 = 0.04 specular or
the metal's colour, D is GGX with alpha = roughness^2, V is Smith's height-correlated masking
and shadowing (Heitz2014).
"""

from __future__ import annotations

from functools import reduce
from importlib import import_module
from operator import or_
from typing import Any

# Their stubs describe no variant in particular: what is written here is checked by running it.
dr: Any = import_module("drjit")
mi: Any = import_module("mitsuba")

PLUGIN = "airlight"
MIN_ALPHA = 0.002


def register() -> None:
    """Make the model known as `airlight` to the variant that is set."""
    mi.register_bsdf(PLUGIN, plugin_class(GltfReflection, mi.BSDF))


def plugin_class(methods: type, base: Any) -> Any:
    """The class of Mitsuba with these methods; `base` is the one of the variant that is set.

    So that a class can be written where no variant is set yet: its methods call `base` by name.
    """
    # Inherited methods first, so that a derived class overrides them.
    own: dict[str, Any] = {}
    for part in reversed(methods.__mro__[:-1]):
        own |= {k: v for k, v in vars(part).items() if k not in ("__dict__", "__weakref__")}
    return type(methods.__name__, (base,), own)


class GltfReflection:
    """The reflection model as a BSDF: methods for `plugin_class`."""

    def __init__(self, props: Any) -> None:
        mi.BSDF.__init__(self, props)
        self.base_color = props.get_texture("base_color", 0.8)
        self.roughness = props.get_texture("roughness", 1.0)
        self.metallic = props.get_texture("metallic", 0.0)
        self.specular = props.get("specular", 1.0)
        self._set_lobes(self._kinds(), mi.BSDFFlags.FrontSide)

    def _kinds(self) -> tuple[Any, ...]:
        """The lobes' kinds, in their order."""
        return (mi.BSDFFlags.DiffuseReflection, mi.BSDFFlags.GlossyReflection)

    def _set_lobes(self, kinds: tuple[Any, ...], sides: Any) -> None:
        self.m_components = [kind | sides for kind in kinds]
        self.m_flags = reduce(or_, self.m_components)

    def sample(
        self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True
    ) -> tuple[Any, Any]:
        """A direction of one of the lobes, and what it is worth."""
        # The lobe is chosen by its share, a direction drawn from it alone.
        surface = self._surface(si, active)
        glossy = sample1 < surface.glossy_share(si.wi)
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = surface.sampled(si.wi, glossy, sample2)
        bs.eta = 1.0
        bs.sampled_component, bs.sampled_type = lobe(glossy)

        # Value and density are those of both lobes, whichever of them drew the direction.
        value, bs.pdf = self.eval_pdf(ctx, si, bs.wo, active)
        usable = active & (bs.pdf > 0.0)
        return bs, dr.select(usable, value / bs.pdf, 0.0)

    def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """f times the cosine."""
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """How likely `wo` is sampled, sr^-1."""
        return self.eval_pdf(ctx, si, wo, active)[1]

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
        """Both."""
        surface = self._surface(si, active)
        above = active & (mi.Frame3f.cos_theta(si.wi) > 0.0) & (mi.Frame3f.cos_theta(wo) > 0.0)
        value = surface.reflection(si.wi, wo) * mi.Frame3f.cos_theta(wo)
        return dr.select(above, value, 0.0), dr.select(above, surface.pdf(si.wi, wo), 0.0)

    def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
        """The diffuse part's albedo."""
        return self._surface(si, active).diffuse

    def _surface(self, si: Any, active: Any) -> Surface:
        return Surface(
            self.base_color.eval(si, active) * (1.0 - self._passing(si, active)),
            self.roughness.eval_1(si, active),
            self.metallic.eval_1(si, active),
            self.specular,
        )

    def _passing(self, si: Any, active: Any) -> Any:
        """The share of light that goes on, of what is not mirrored."""
        return 0.0

    def to_string(self) -> str:
        """As Mitsuba prints it."""
        return f"{type(self).__name__}[]"


def lobe(glossy: Any) -> tuple[Any, Any]:
    """The number and the kind of the glossy lobe, or of the diffuse one."""
    kinds = (mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.DiffuseReflection)
    number = dr.select(glossy, mi.UInt32(1), mi.UInt32(0))
    return number, dr.select(glossy, mi.UInt32(+kinds[0]), mi.UInt32(+kinds[1]))


class Surface:
    """The reflection model at one point: directions are local, z along the shading normal."""

    def __init__(self, base_color: Any, roughness: Any, metallic: Any, specular: float) -> None:
        # glTF 2.0: a metal has its base colour as F0 and no diffuse part.
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

        # Both lobes keep a tenth at least, so that no weight explodes; black diffuse ones get none.
        return dr.select(diffuse > 0.0, dr.clip(share, 0.1, 0.9), 1.0)

    def sampled(self, wi: Any, glossy: Any, sample: Any) -> Any:
        """A direction of the glossy lobe, or of the diffuse one."""
        normal, _ = self.microfacets.sample(wi, sample)
        scattered = mi.warp.square_to_cosine_hemisphere(sample)
        return dr.select(glossy, mi.reflect(wi, normal), scattered)

    def reflection(self, wi: Any, wo: Any) -> Any:
        """f, sr^-1."""
        # Fresnel's term at the microfacet, F.
        half = dr.normalize(wi + wo)
        n_v, n_l = mi.Frame3f.cos_theta(wi), mi.Frame3f.cos_theta(wo)
        F = self.fresnel(dr.dot(wi, half))

        # GGX's distribution of normals, D.
        a2 = dr.square(self.alpha)
        D = a2 / (dr.pi * dr.square(dr.square(half.z) * (a2 - 1.0) + 1.0))

        # Smith's height-correlated masking and shadowing over 4 cos cos, V (Heitz2014).
        masking = n_l * dr.sqrt(dr.square(n_v) * (1.0 - a2) + a2)
        shadowing = n_v * dr.sqrt(dr.square(n_l) * (1.0 - a2) + a2)
        V = 0.5 / dr.maximum(masking + shadowing, 1e-6)

        # Diffuse light is what Fresnel's term leaves.
        return (1.0 - F) * self.diffuse * dr.inv_pi + F * (D * V)

    def pdf(self, wi: Any, wo: Any) -> Any:
        """How likely `wo` is sampled, sr^-1."""
        # A half vector's density becomes a direction's by the Jacobian of mirroring.
        half = dr.normalize(wi + wo)
        mirrored = self.microfacets.pdf(wi, half) / (4.0 * dr.abs(dr.dot(wo, half)))
        scattered = mi.warp.square_to_cosine_hemisphere_pdf(wo)
        return dr.lerp(scattered, mirrored, self.glossy_share(wi))
