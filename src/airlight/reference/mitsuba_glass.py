"""airlight's thin glass, written in Mitsuba's Python: the reflection model beside what passes.

A surface without thickness (KHR_materials_transmission) mirrors by Fresnel's term; of the rest
`transmission` (times 1 - metallic) goes straight on, tinted by the base colour, and the rest is
reflected as `mitsuba_brdf` says. Only the child process imports this module.
"""

from __future__ import annotations

from typing import Any

from .mitsuba_brdf import GltfReflection, dr, lobe, mi, plugin_class

PLUGIN = "airlight_glass"


def register() -> None:
    """Make the model known as `airlight_glass` to the variant that is set."""
    mi.register_bsdf(PLUGIN, plugin_class(ThinGlass, mi.BSDF))


class ThinGlass(GltfReflection):
    """Thin glass as a BSDF: methods for `plugin_class`."""

    def __init__(self, props: Any) -> None:
        GltfReflection.__init__(self, props)
        self.transmission = props.get("transmission", 1.0)
        self.two_sided = props.get("two_sided", True)
        kinds = (*self._kinds(), mi.BSDFFlags.Null)
        self._set_lobes(kinds, mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide)

    def sample(
        self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True
    ) -> tuple[Any, Any]:
        """Straight on as often as light passes; else a direction of one of the other lobes."""
        # Either goes on straight, or one of the two reflecting lobes is chosen by its share.
        surface, wi = self._surface(si, active), self._towards(si.wi)
        passed = self.eval_null_transmission(si, active)
        p = dr.mean(passed)
        goes_on = sample1 < p
        glossy = (sample1 - p) < surface.glossy_share(wi) * (1.0 - p)
        up = surface.sampled(wi, glossy, sample2)
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = dr.select(goes_on, -si.wi, self._mirrored(up, si.wi))
        bs.eta = 1.0
        component, reflected = lobe(glossy)
        bs.sampled_type = dr.select(goes_on, mi.UInt32(+mi.BSDFFlags.Null), reflected)
        bs.sampled_component = dr.select(goes_on, mi.UInt32(2), component)
        # Passing is weighted by colour over chance, a lobe by what all lobes give there.
        value, pdf = self.eval_pdf(ctx, si, bs.wo, active)
        bs.pdf = dr.select(goes_on, p, pdf)
        weight = dr.select(goes_on, passed / p, value / pdf)
        return bs, dr.select(active & (bs.pdf > 0.0), weight, 0.0)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> tuple[Any, Any]:
        """Of what is reflected."""
        # Reflection is seen from the side that `wi` is on: the sheet is lit alike from both.
        surface, wi = self._surface(si, active), self._towards(si.wi)
        out = self._mirrored(wo, si.wi)
        above = active & (out.z > 0.0) & self._is_there(si)
        value = surface.reflection(wi, out) * out.z

        # Lobes are drawn as often as light does not pass.
        reflected = 1.0 - dr.mean(self.eval_null_transmission(si, active))
        pdf = surface.pdf(wi, out) * reflected
        return dr.select(above, value, 0.0), dr.select(above, pdf, 0.0)

    def eval_null_transmission(self, si: Any, active: Any = True) -> Any:
        """What goes straight on: what Fresnel's term leaves, tinted."""
        # Schlick's term on the sheet's F0, of one face alone.
        f0 = 0.04 * self.specular
        x = dr.clip(1.0 - dr.abs(mi.Frame3f.cos_theta(si.wi)), 0.0, 1.0)
        mirrored = f0 + (dr.minimum(50.0 * f0, 1.0) - f0) * (dr.square(dr.square(x)) * x)
        tint = self.base_color.eval(si, active)
        passed = self._passing(si, active) * (1.0 - mirrored) * tint

        # A one-sided sheet seen from behind is not there: all light passes.
        return dr.select(self._is_there(si), passed, 1.0)

    def _passing(self, si: Any, active: Any) -> Any:
        return self.transmission * (1.0 - self.metallic.eval_1(si, active))

    def _is_there(self, si: Any) -> Any:
        return (si.wi.z > 0.0) | self.two_sided

    def _towards(self, wi: Any) -> Any:
        return mi.Vector3f(wi.x, wi.y, dr.abs(wi.z))

    def _mirrored(self, d: Any, wi: Any) -> Any:
        """A direction as seen from the side that `wi` is on."""
        return mi.Vector3f(d.x, d.y, dr.select(wi.z > 0.0, d.z, -d.z))
