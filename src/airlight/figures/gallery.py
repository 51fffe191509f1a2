"""The gallery: one HTML file with every figure that a folder holds, its numbers and its command.

Images are in the page itself, so that it can be sent to someone; each leads to its full size.
"""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path
from typing import Any

import PIL.Image

from ..app.compare.style import CSS
from ..errors import SceneError
from ..scene.io.files import read_bytes, read_text
from ..scene.io.writing import whole_file
from .registry import FIGURES, Figure

PAGE = "index.html"
_WIDEST_PX = 1600  # of an image in the page
_MOST_VALUES = 12  # of a list in a table
_STYLE = """
article { margin: 2.5rem 0; } article img { width: 100%; height: auto; display: block; }
article h3 { margin: 0 0 .3rem; } td { text-align: left; } td, th { vertical-align: top; }
code { overflow-wrap: anywhere; }
nav a { margin-right: 1rem; white-space: nowrap; }
"""
PAPERS = {
    "Kaplanyan2010": "Kaplanyan and Dachsbacher 2010: cascaded light propagation volumes",
    "Billeter2012": "Billeter, Sintorn and Assarsson 2012: multiple scattering on a lattice",
    "Elek2014": "Elek et al. 2014: principal-ordinates propagation",
    "": "Ours",
}
"""Heading by the key of docs/references.bib that a figure stands beside."""


def write_gallery(folder: Path) -> Path:
    """Write `folder`/index.html over the figures drawn there; returns its path.

    Raises OutputError, SceneError for a figure's file that is broken.
    """
    path = folder / PAGE
    with whole_file(path) as part:
        part.write_text(page(folder), encoding="utf-8")
    return path


def page(folder: Path) -> str:
    """The page as HTML text. Raises SceneError."""
    # Figures that are drawn, by paper, and the names of the missing ones.
    drawn = {name: told for name in FIGURES if (told := _told(folder, name))}
    links = "".join(f'<a href="#{name}">{escape(name)}</a> ' for name in drawn)
    sections = "".join(_section(paper, title, drawn, folder) for paper, title in PAPERS.items())
    missing = [name for name in FIGURES if name not in drawn]
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>airlight: figures</title>\n<style>{CSS}{_STYLE}</style>\n</head>\n<body>\n<main>\n"
        "<h1>Figures of the papers, ours</h1>"
        f"<p>{len(drawn)} of {len(FIGURES)} figures, each with the numbers behind it and the "
        f"command that draws it again.</p><nav>{links}</nav>{sections}{_missing(missing)}"
        "</main>\n</body>\n</html>\n"
    )


def _told(folder: Path, name: str) -> dict[str, Any] | None:
    """What NAME.json says, or None where the figure is not there."""
    # A figure is there when its numbers and its image are.
    path = folder / f"{name}.json"
    if not path.is_file() or not path.with_suffix(".png").is_file():
        return None
    try:
        told = json.loads(read_text(path))
        told["numbers"].items()
    except (SceneError, ValueError, KeyError, TypeError, AttributeError):
        raise SceneError(
            "not the numbers of a figure", where=path, remedy=f"Draw {name} again."
        ) from None
    return dict(told)


def _section(paper: str, title: str, drawn: Mapping[str, Any], folder: Path) -> str:
    own = [
        _article(name, FIGURES[name], told, folder)
        for name, told in drawn.items()
        if FIGURES[name].source.partition(" ")[0] == paper
    ]
    return f"<h2>{escape(title)}</h2>{''.join(own)}" if own else ""


def _article(name: str, known: Figure, told: Mapping[str, Any], folder: Path) -> str:
    # Numbers as rows of a table, folded under the image.
    image = folder / f"{name}.png"
    beside = f"Beside {escape(known.source)}. " if known.source else ""
    rows = "".join(
        f'<tr><th scope="row">{escape(key)}</th><td>{escape(value)}</td></tr>'
        for key, value in _rows(told["numbers"])
    )
    shows = escape(known.shows)
    return (
        f'<article id="{name}"><h3>{escape(name)}: {shows}</h3>'
        f'<a href="{image.name}"><img src="{_data_url(image)}" alt="{shows}"></a>'
        f'<p class="faint">{beside}Drawn by <code>{escape(str(told.get("command", "")))}</code>; '
        f'numbers in <a href="{name}.json">{name}.json</a>.</p>'
        f'<details><summary>Numbers</summary><div class="scroll" tabindex="0"><table><tbody>{rows}'
        "</tbody></table></div></details></article>"
    )


def _rows(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """(dotted key, value) of nested mappings; long lists are cut."""
    # Mappings and lists of mappings are followed, all else is a value.
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _rows(inner, f"{path} \N{RIGHTWARDS ARROW} {key}" if path else str(key))
    elif isinstance(value, list) and value and isinstance(value[0], Mapping):
        for index, inner in enumerate(value):
            yield from _rows(inner, f"{path} {index + 1}")
    else:
        yield path, _short(value)


def _short(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list):
        more = f" \N{HORIZONTAL ELLIPSIS} ({len(value)})" if len(value) > _MOST_VALUES else ""
        return ", ".join(_short(v) for v in value[:_MOST_VALUES]) + more
    return str(value)


def _missing(names: list[str]) -> str:
    if not names:
        return ""
    words = escape(" ".join(names))
    return f"<h2>Not drawn here yet</h2><p><code>airlight figure {words} -o .</code></p>"


def _data_url(path: Path) -> str:
    """The image as JPEG, no wider than _WIDEST_PX. Raises SceneError."""
    try:
        with PIL.Image.open(io.BytesIO(read_bytes(path))) as opened:
            image = opened.convert("RGB")
    except OSError as error:
        raise SceneError(f"not a readable image ({error})", where=path) from None
    image.thumbnail((_WIDEST_PX, 100 * _WIDEST_PX))
    held = io.BytesIO()
    image.save(held, "JPEG", quality=90, subsampling=0)
    return f"data:image/jpeg;base64,{base64.b64encode(held.getvalue()).decode('ascii')}"
