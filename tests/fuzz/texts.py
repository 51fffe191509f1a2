"""TOML, JSON and XML: documents that can be damaged, and back to the text of a file.

Texts that no file can hold as they are, such as lone surrogates, are written as far as they go.
"""

from __future__ import annotations

import json
import math
from typing import Any
from xml.etree import ElementTree

ATTRIBUTES, CHILDREN, TAG = "attributes", "children", "tag"


def json_text(document: Any) -> bytes:
    """JSON, with NaN and Infinity where numbers are such."""
    return _bytes(json.dumps(document))


def toml_text(document: Any) -> bytes:
    """A TOML file of a table; what TOML has no word for (null) is left out."""
    if not isinstance(document, dict):
        return _bytes(_toml_value(document))
    lines, after = [], []
    for key, value in document.items():
        if isinstance(value, dict):
            after += [f"[{_toml_key(key)}]", *_toml_lines(value)]
        elif isinstance(value, list) and value and all(isinstance(v, dict) for v in value):
            for element in value:
                after += [f"[[{_toml_key(key)}]]", *_toml_lines(element)]
        elif value is not None:
            lines.append(f"{_toml_key(key)} = {_toml_value(value)}")
    return _bytes("\n".join([*lines, *after]) + "\n")


def _toml_lines(table: dict[str, Any]) -> list[str]:
    return [f"{_toml_key(k)} = {_toml_value(v)}" for k, v in table.items() if v is not None]


def _toml_key(key: str) -> str:
    is_bare = bool(key) and all(c.isascii() and (c.isalnum() or c in "-_") for c in key)
    return key if is_bare else json.dumps(key)


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        if math.isnan(value):
            return "nan"
        return repr(value) if math.isfinite(value) else ("inf" if value > 0 else "-inf")
    if isinstance(value, int):
        return str(value)
    if isinstance(value, str):
        return json.dumps(value).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        return "{" + ", ".join(_toml_lines(value)) + "}"
    return "[" + ", ".join(_toml_value(v) for v in value or () if v is not None) + "]"


def xml_document(text: bytes) -> dict[str, Any]:
    """An XML file as {tag, attributes, children}."""
    return _element_document(ElementTree.fromstring(text))


def _element_document(element: ElementTree.Element) -> dict[str, Any]:
    return {
        TAG: element.tag,
        ATTRIBUTES: dict(element.attrib),
        CHILDREN: [_element_document(child) for child in element],
    }


def xml_text(document: Any) -> bytes:
    """The file of such a document; what is no element any more stands there as text."""
    return _bytes(_xml(document))


def _xml(value: Any) -> str:
    if not isinstance(value, dict):
        return "".join(_xml(v) for v in value) if isinstance(value, list) else _escaped(value)
    tag = _escaped(value.get(TAG, "x"))
    attributes = value.get(ATTRIBUTES)
    pairs = attributes.items() if isinstance(attributes, dict) else ()
    written = "".join(f' {_escaped(k)}="{_escaped(v)}"' for k, v in pairs)
    known = (TAG, ATTRIBUTES, CHILDREN)
    inner = [value.get(CHILDREN), *(v for k, v in value.items() if k not in known)]
    return f"<{tag}{written}>{''.join(_xml(v) for v in inner if v is not None)}</{tag}>"


def _escaped(value: Any) -> str:
    text = str(value)
    for sign, name in (("&", "&amp;"), ("<", "&lt;"), ('"', "&quot;")):
        text = text.replace(sign, name)
    return text


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "replace")
