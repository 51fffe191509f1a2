"""What a comparison found: values only; `page` draws them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ...maths.arrays import U8
from ...reference import metrics_display
from ...reference.metrics import LAYERS, EqualTime, Metrics
from ...scene.checks import F32
from ...scene.image import Image
from .images import heat, shown, signed_map
from .reference import Reference

WHOLE = "whole"
TITLES = {
    WHOLE: "The whole image",
    "direct": "Direct light",
    "indirect": "Indirect light (all bounces)",
    "one_bounce": "Indirect light (one bounce)",
    "single_scatter": "Single scattering",
    "multiple_scatter": "Multiple scattering",
}


@dataclass(frozen=True, eq=False)
class Outcome:
    """One technique: its image and scores, or the `error` that kept it from making one.

    `seconds` is the rendering of the compared image, all its samples, on a warm device;
    `equal_time` is by relmse, `equal_time_l2` by the square of relative_l2.
    """

    technique: str
    command: str
    image: Image | None = None
    metrics: Metrics | None = None
    equal_time: EqualTime | None = None
    equal_time_l2: EqualTime | None = None
    seconds: float = 0.0
    error: str = ""

    def to_json(self) -> dict[str, Any]:
        """Plain values, without pixels."""
        return {
            "command": self.command,
            "error": self.error or None,
            "seconds": self.seconds,
            "metrics": None if self.metrics is None else self.metrics.to_json(),
            "equal_time": None if self.equal_time is None else self.equal_time.to_json(),
            "equal_time_l2": None if self.equal_time_l2 is None else self.equal_time_l2.to_json(),
            "stats": {} if self.image is None else dict(self.image.stats),
        }


@dataclass(frozen=True, eq=False)
class Panel:
    """One technique in one layer: its image, what is too bright or dark, its FLIP map."""

    technique: str
    metrics: Metrics
    image: U8
    signed: U8
    flip: U8 | None


@dataclass(frozen=True, eq=False)
class LayerView:
    """One layer: the reference and each technique that has it."""

    name: str
    reference: U8
    panels: tuple[Panel, ...]

    @property
    def title(self) -> str:
        """Its name in words."""
        return TITLES[self.name]


@dataclass(frozen=True, eq=False)
class Comparison:
    """All that the page, the sheet and the JSON are made of."""

    scene: str
    command: str
    size: tuple[int, int]
    samples: int
    stops: float
    reference: Reference
    outcomes: tuple[Outcome, ...]
    about: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def views(self) -> tuple[LayerView, ...]:
        """The layers that have light in the reference or in a technique, the whole first."""
        made = (self._view(name) for name in (WHOLE, *LAYERS))
        return tuple(view for view in made if view is not None)

    def _view(self, name: str) -> LayerView | None:
        # A layer that is black in all images says nothing, so it is left out.
        truth = _layer(self.reference.image, name)
        images = {o.technique: _layer(o.image, name) for o in self.outcomes if o.image is not None}
        lit = [a for a in (truth, *images.values()) if a is not None and a.any()]
        if truth is None or (not lit and name != WHOLE):
            return None
        # A panel for each technique that has the layer.
        panels = []
        for outcome in self.outcomes:
            layer = images.get(outcome.technique)
            metrics = outcome.metrics
            if layer is not None and metrics is not None:
                scores = metrics if name == WHOLE else metrics.layers[name]
                panels.append(self._panel(outcome.technique, scores, layer, truth))
        return LayerView(name, shown(truth, self.stops), tuple(panels))

    def _panel(self, technique: str, scores: Metrics, layer: F32, truth: F32) -> Panel:
        # Without the package of FLIP the panel has no map.
        try:
            flip = heat(metrics_display.flip_map(truth, layer, self.stops))
        except ImportError:
            flip = None
        image, signed = shown(layer, self.stops), signed_map(layer, truth, self.stops)
        return Panel(technique, scores, image, signed, flip)

    def to_json(self) -> dict[str, Any]:
        """Plain values, without pixels."""
        r = self.reference
        return {
            "scene": self.scene,
            "command": self.command,
            "size": list(self.size),
            "samples": self.samples,
            "exposure_stops": self.stops,
            "about": dict(self.about),
            "reference": {
                "renderer": "mitsuba",
                "spp": r.spp,
                "seconds": r.seconds,
                "timed_in_this_run": not r.is_from_cache,
                "noise_floor": r.floor,
                "notes": list(r.notes),
            },
            "techniques": {outcome.technique: outcome.to_json() for outcome in self.outcomes},
        }


def _layer(image: Image, name: str) -> F32 | None:
    return image.radiance if name == WHOLE else image.layers.get(name)
