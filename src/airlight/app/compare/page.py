"""The comparison as one HTML file that holds everything, and as one sheet of images."""

from __future__ import annotations

import math
from collections.abc import Iterable
from html import escape

from ...maths.arrays import U8
from ...reference.metrics import Metrics
from .images import FULL_DIFFERENCE, Row, contact_sheet, data_url
from .result import Comparison, LayerView, Outcome, Panel
from .style import CSS, SCRIPT

SCORES = (
    ("relMSE", "relmse"),
    ("black image", "black"),
    ("noise floor", "noise_floor"),
    ("relative L2", "relative_l2"),
    ("energy ratio", "energy_ratio"),
    ("signed error", "signed_error"),
    ("PSNR dB", "psnr_db"),
    ("SSIM", "ssim"),
    ("FLIP", "flip"),
    ("HDR-FLIP", "hdr_flip"),
)
DASH = "\N{EN DASH}"


def page(comparison: Comparison) -> str:
    """The page as HTML text, UTF-8."""
    c = comparison
    body = [
        f"<h1>{escape(c.scene)}</h1>",
        _facts(c),
        _failures(c.outcomes),
        _summary(c),
        _legend(c),
        *(_layer(view) for view in c.views),
        _reproduce(c),
    ]
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>airlight compare: {escape(c.scene)}</title>\n<style>{CSS}</style>\n</head>\n"
        f"<body>\n<main>\n{''.join(body)}\n</main>\n<script>{SCRIPT}</script>\n</body>\n</html>\n"
    )


def sheet(comparison: Comparison) -> U8:
    """Reference, image, signed difference and FLIP map of each technique and layer."""
    rows: list[Row] = []
    for view in comparison.views:
        rows += [(view.title, _sheet_row(view, panel)) for panel in view.panels] or [
            (view.title, [("reference", view.reference)])
        ]
    c = comparison
    title = f"{c.scene}, {c.size[0]}x{c.size[1]}, reference {c.reference.spp} spp"
    return contact_sheet(title, rows)


def _sheet_row(view: LayerView, panel: Panel) -> list[tuple[str, U8 | None]]:
    scores = f"relMSE {number(panel.metrics.relmse)}, energy {number(panel.metrics.energy_ratio)}"
    return [
        ("reference", view.reference),
        (f"{panel.technique}: {scores}", panel.image),
        ("green too bright, red too dark", panel.signed),
        (f"FLIP {number(panel.metrics.flip)}", panel.flip),
    ]


def number(value: float | None, digits: int = 3) -> str:
    """Three digits that matter, or a dash for a score that could not be taken."""
    # NaN is the score that could not be taken.
    if value is None or value != value:
        return DASH
    if abs(value) in (0.0, float("inf")):
        return "0" if value == 0.0 else "\N{INFINITY}"
    # Decimals where they are readable, else an exponent.
    if 1e-3 <= abs(value) < 1e4:
        return f"{value:#.{digits}g}".rstrip(".")
    return f"{value:.{digits - 1}e}"


def seconds(value: float | None) -> str:
    """A time in the unit a person would choose."""
    if value is None:
        return DASH
    if value < 1.0:
        return f"{number(1000.0 * value)} ms"
    return f"{number(value)} s" if value < 120.0 else f"{number(value / 60.0)} min"


def _facts(c: Comparison) -> str:
    # What all scores rest on: the reference, its noise, and the exposure.
    r = c.reference
    facts = {
        "size": f"{c.size[0]} x {c.size[1]}",
        "reference": f"Mitsuba 3, {r.spp} samples a pixel in {seconds(r.seconds)}"
        + (" (cached by an earlier run)" if r.is_from_cache else ""),
        "noise floor": f"relMSE {number(r.floor)}",
        "exposure": f"{c.stops:+.2f} stops",
        **c.about,
    }
    items = "".join(
        f"<div><dt>{escape(k)}</dt><dd>{escape(v)}</dd></div>" for k, v in facts.items()
    )
    notes = "".join(f'<p class="faint">Reference: {escape(note)}.</p>' for note in r.notes)
    return f'<dl class="facts">{items}</dl>{notes}'


def _failures(outcomes: Iterable[Outcome]) -> str:
    return "".join(
        f'<div class="failed"><b>{escape(o.technique)}</b> made no image: {escape(o.error)}</div>'
        for o in outcomes
        if o.error
    )


def _table(head: Iterable[str], rows: Iterable[tuple[str, Iterable[str]]]) -> str:
    top = "".join(f'<th scope="col">{escape(h)}</th>' for h in head)
    body = "".join(
        f'<tr><th scope="row">{escape(name)}</th>'
        + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        + "</tr>"
        for name, cells in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="scores"><table>'
        f"<thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _summary(c: Comparison) -> str:
    done = [o for o in c.outcomes if o.metrics]
    if not done:
        return ""
    scores = ("relMSE", "black image", "direct only", "relative L2", "energy ratio", "FLIP")
    return (
        f"<h2>Summary</h2>{_table(('', *scores), [(o.technique, _summary_row(o)) for o in done])}"
        f"<h2>In equal time</h2>{_table(_TIME_HEAD, [(o.technique, _time_row(o)) for o in done])}"
        '<p class="faint">Mitsuba\'s columns follow from the 1/N law of its measured variance at '
        f"{c.reference.spp} samples, without its loading and compiling; a dash where the error is "
        f"within the reference's noise. A technique's time is that of all its {c.samples} jittered "
        "samples a pixel, on a warm device.</p>"
    )


_TIME_HEAD = (
    "",
    "time",
    "Mitsuba to this relMSE",
    "its relMSE in this time",
    "Mitsuba to this L2",
    "its L2 in this time",
)


def _summary_row(outcome: Outcome) -> tuple[str, ...]:
    m = outcome.metrics
    assert m is not None
    # Errors of a black image and of direct light alone show what a score is worth.
    beside = (number(other.relmse if other else None) for other in (m.black, m.direct_only))
    return (
        _relmse(m),
        *beside,
        *(number(m[key]) for key in ("relative_l2", "energy_ratio", "flip")),
    )


def _time_row(outcome: Outcome) -> tuple[str, ...]:
    by_relmse, by_l2 = outcome.equal_time, outcome.equal_time_l2
    assert by_relmse is not None
    assert by_l2 is not None
    # Error and time each way: how long a path tracer takes, and what it reaches in that time.
    return (
        seconds(outcome.seconds),
        seconds(by_relmse.seconds_to_match),
        number(by_relmse.error_at_time),
        seconds(by_l2.seconds_to_match),
        number(math.sqrt(by_l2.error_at_time)),
    )


def _relmse(metrics: Metrics) -> str:
    return number(metrics.relmse) + (" (within noise)" if metrics.within_noise else "")


def _legend(c: Comparison) -> str:
    epsilon = next((o.metrics.epsilon for o in c.outcomes if o.metrics), None)
    return (
        "<h2>How to read it</h2>"
        "<p>Hold a technique's image to see the reference in its place. Differences: "
        '<span class="swatch" style="background:var(--bright)"></span> too bright, '
        '<span class="swatch" style="background:var(--dark)"></span> too dark; full colour is '
        f"{FULL_DIFFERENCE:g} of the displayed range. All images share one exposure.</p>"
        '<p class="faint">relMSE is the mean of (I \N{MINUS SIGN} R)\N{SUPERSCRIPT TWO} / '
        f"(R\N{SUPERSCRIPT TWO} + {number(epsilon)}); the constant is 1e-4 of the squared mean "
        "luminance of the whole reference, for layers too. Pixels black in the reference and lit "
        "in the image weigh most in it; in relative L2, the root of the mean squared error over "
        "the mean square of the reference, bright pixels do. An error below twice the noise floor "
        "says nothing. PSNR, SSIM and FLIP see the exposed, clamped sRGB image.</p>"
    )


def _layer(view: LayerView) -> str:
    truth = f"truth-{view.name}"
    # One table of scores for the layer, a row of images for each technique.
    rows = [(p.technique, tuple(_score(p.metrics, key) for _, key in SCORES)) for p in view.panels]
    table = _table(("", *(name for name, _ in SCORES)), rows) if rows else ""
    panels = "".join(_panel(p, truth) for p in view.panels)
    reference = _figure(view.reference, "<b>reference</b>", "reference", f'id="{truth}"')
    lead = f'<div class="lead">{reference}{table}</div>'
    return f"<h2>{escape(view.title)}</h2>{lead}{panels}"


def _score(metrics: Metrics, key: str) -> str:
    if key == "relmse":
        return _relmse(metrics)
    value = metrics[key]
    return number(value.relmse if isinstance(value, Metrics) else value)


def _panel(panel: Panel, truth: str) -> str:
    name = escape(panel.technique)
    hold = f'data-truth="{truth}" tabindex="0" draggable="false"'
    figures = [
        _figure(panel.image, f"<b>{name}</b>, hold for the reference", name, hold),
        _figure(panel.signed, f"{name}: too bright, too dark", f"signed difference of {name}"),
    ]
    if panel.flip is not None:
        figures.append(_figure(panel.flip, f"{name}: FLIP", f"FLIP map of {name}"))
    return f'<div class="row">{"".join(figures)}</div>'


def _figure(pixels: U8, caption: str, alt: str, attributes: str = "") -> str:
    height, width = pixels.shape[:2]
    return (
        f'<figure><img src="{data_url(pixels)}" alt="{alt}" width="{width}" height="{height}" '
        f"{attributes}><figcaption>{caption}</figcaption></figure>"
    )


def _reproduce(c: Comparison) -> str:
    commands = "\n".join([c.command, *(o.command for o in c.outcomes)])
    return f"<h2>To reproduce</h2><pre>{escape(commands)}</pre>"
