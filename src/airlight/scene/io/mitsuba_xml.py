"""Mitsuba's XML as a tree of plain nodes: includes, defaults, parameters and references solved.

The file is not trusted: a document type (where entities would be declared) is refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree import ElementTree

from ...errors import SceneError, nearest
from .files import read_bytes
from .mitsuba_nodes import MAX_DEPTH, Folders, Node, refuse_cycles
from .mitsuba_values import VALUE_TAGS, parse_value

MAX_INCLUDES = 64
MOST_EXPANDED = 1 << 24
"""Characters that parameters put into a scene, all together."""
OBJECT_TAGS = frozenset(
    (
        "bsdf",
        "emitter",
        "film",
        "include",
        "integrator",
        "medium",
        "phase",
        "rfilter",
        "sampler",
        "scene",
        "sensor",
        "shape",
        "texture",
        "volume",
    )
)


MOST_AHEAD = 100_000
"""Elements of a file that are searched for defaults further on."""
A_PART = "A part of a scene is read by the file that includes it."


@dataclass
class _Reader:
    """What holds for the whole scene while its files are read."""

    path: Path
    folders: Folders
    parameters: dict[str, str]
    asked: set[str] = field(default_factory=set)
    nodes: dict[str, Node] = field(default_factory=dict)
    references: list[tuple[Node, int, str, Path]] = field(default_factory=list)
    includes: int = 0
    expanded: int = 0
    has_looked_ahead: bool = False


def read_tree(path: Path, parameters: Mapping[str, str]) -> tuple[Node, Folders]:
    """The scene's root node, and the folders that it looks for files in.

    `parameters` are values of $names, which win over the file's defaults. Raises SceneError for XML
    that is broken, dangerous or refers to what is not there, and for a parameter that it has not.
    """
    reader = _Reader(path, Folders.of(path), dict(parameters))
    root = _parse(path)
    if root.tag != "scene":
        raise SceneError(f"this is XML, but its root is <{root.tag}>, not <scene>", where=path)
    scene = Node("scene", "scene")
    _fill(scene, root, reader, path, 0)
    _refuse_unasked(parameters, reader, path)
    _solve_references(reader)
    refuse_cycles(scene)
    return scene, reader.folders


def _refuse_unasked(given: Mapping[str, str], reader: _Reader, path: Path) -> None:
    """Raise SceneError for a parameter that was given and that nothing in the scene asks for."""
    for name in given:
        if name not in reader.asked:
            raise SceneError(
                f"no ${name} stands in the scene, and a parameter gives it a value",
                where=path,
                remedy=nearest(name, reader.asked) if reader.asked else "It has no parameters.",
            )


class _Builder(ElementTree.TreeBuilder):
    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        raise SceneError("a document type (<!DOCTYPE ...>) is refused", remedy="Remove it.")


def _parse(path: Path) -> ElementTree.Element:
    parser = ElementTree.XMLParser(target=_Builder())
    try:
        parser.feed(read_bytes(path))
        root = parser.close()
    except SceneError as error:
        raise SceneError(error.problem, where=error.where or path, remedy=error.remedy) from None
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise SceneError(f"not readable XML ({error})", where=path) from None
    assert isinstance(root, ElementTree.Element)
    return root


def _fill(
    node: Node, element: ElementTree.Element, reader: _Reader, path: Path, depth: int
) -> None:
    """Read the children of `element` into `node`."""
    # Depth is bounded before Python's own recursion is.
    if depth > MAX_DEPTH:
        raise SceneError(f"elements are nested more than {MAX_DEPTH} deep", where=path)
    for child in element:
        _set_parameters(child, reader, path)
        tag, attributes = child.tag, child.attrib
        # What stands for something else: defaults, other files, references.
        if tag == "default":
            name = attributes.get("name", "")
            reader.parameters.setdefault(name, attributes.get("value", ""))
            reader.asked.add(name)
        elif tag == "include":
            _include(node, attributes.get("filename", ""), reader, path, depth)
        elif tag in ("ref", "alias"):
            _refer(node, tag, attributes, reader, path)
        # Values and plugins of this node.
        elif tag in VALUE_TAGS:
            name = _snake(attributes.get("name", ""))
            node.values[name] = parse_value(child, path)
        elif tag in OBJECT_TAGS:
            node.children.append(_object(child, reader, path, depth))
        elif tag == "path":
            reader.folders.add(attributes.get("value", ""), path)
        else:
            known = [*OBJECT_TAGS, *VALUE_TAGS, "default", "include", "path", "ref"]
            raise SceneError(
                f"<{tag}> is no element of a scene", where=path, remedy=nearest(str(tag), known)
            )


def _object(child: ElementTree.Element, reader: _Reader, path: Path, depth: int) -> Node:
    attributes = child.attrib
    made = Node(
        tag=child.tag,
        kind=attributes.get("type", "").lower(),  # where letters' case does not count for files
        name=_snake(attributes.get("name", "")),
        id=attributes.get("id", ""),
    )
    if not made.kind:
        raise SceneError(f"<{child.tag}> without a type", where=path)
    # Ids are known only behind an element, so that none can refer to itself.
    _fill(made, child, reader, path, depth + 1)
    if made.id:
        if made.id in reader.nodes:
            raise SceneError(f"two elements have the id '{made.id}'", where=path)
        reader.nodes[made.id] = made
    return made


def _include(node: Node, name: str, reader: _Reader, path: Path, depth: int) -> None:
    """The contents of another file's <scene>, or its one other element, put here."""
    # Files that include each other twice would double at each level: their number is bounded.
    reader.includes += 1
    if reader.includes > MAX_INCLUDES:
        raise SceneError(f"more than {MAX_INCLUDES} files are included", where=path)
    target = reader.folders.find(name, path)
    root = _parse(target)
    # A file may hold one element that is no scene.
    if root.tag != "scene":
        holder = ElementTree.Element("scene")
        holder.append(root)
        root = holder
    _fill(node, root, reader, target, depth + 1)


def _refer(node: Node, tag: str, attributes: dict[str, str], reader: _Reader, path: Path) -> None:
    # An alias is another id for what is there already.
    target = attributes.get("id", "")
    if tag == "alias":
        if target not in reader.nodes:
            raise SceneError(f"alias of '{target}', which is nowhere", where=path)
        reader.nodes[attributes.get("as", "")] = reader.nodes[target]
        return
    # The place is kept; what stands there is known when all is read.
    holder = Node("ref", target, name=_snake(attributes.get("name", "")))
    node.children.append(holder)
    reader.references.append((node, len(node.children) - 1, target, path))


def _solve_references(reader: _Reader) -> None:
    for node, place, target, path in reader.references:
        found = reader.nodes.get(target)
        if found is None:
            known = nearest(target, reader.nodes)
            raise SceneError(
                f"it refers to '{target}', which is nowhere",
                where=path,
                remedy=f"{known} {A_PART}" if known else A_PART,
            )
        # Without a name of its own, the reference plays the role that the plugin has.
        name = node.children[place].name
        if name and name != found.name:
            # The same plugin in another role: it shares values, and what was read of them.
            found = replace(found, name=name)
        node.children[place] = found


def _set_parameters(element: ElementTree.Element, reader: _Reader, path: Path) -> None:
    """Put the parameters' values in place of $name, the longest name that fits first."""
    # Steps of a transform are not visited by themselves, so their attributes are filled here.
    for inner in element.iter() if element.tag == "transform" else (element,):
        for key, text in inner.attrib.items():
            if "$" in text:
                inner.attrib[key] = _with_values(text, reader, path)


def _with_values(text: str, reader: _Reader, path: Path, within: tuple[str, ...] = ()) -> str:
    """The text with values in place of $names; `within`: the parameters whose value it is part of.

    Defaults that were read in their turn hold no names any more. Those that stand further on, and
    what a person gives, may.
    """
    # Each part after a $ begins with a parameter's name.
    first, *rest = text.split("$")
    parts = [first]
    # The longest parameter that the text begins with is meant.
    lengths = sorted({len(name) for name in reader.parameters if name}, reverse=True)
    for part in rest:
        name = next((part[:n] for n in lengths if part[:n] in reader.parameters), None)
        # A default may stand further on, in a file that is included later.
        if name is None and not reader.has_looked_ahead:
            reader.has_looked_ahead = True
            for found, value in _defaults(reader.path, reader.folders, set()):
                reader.parameters.setdefault(found, value)
            return _with_values(text, reader, path, within)
        if name is None:
            asked = re.match(r"\w+", part)
            if asked:
                raise SceneError(
                    f"the parameter ${asked[0]} has no value",
                    where=path,
                    remedy=f"Give it one: --param {asked[0]}=VALUE, in Python "
                    f'parameters={{"{asked[0]}": ...}}, or in the file <default>.',
                )
            parts += ["$", part]
            continue
        reader.asked.add(name)
        if name in within or len(within) > MAX_DEPTH:
            chain = " -> ".join(f"${each}" for each in (*within, name)[:8])
            raise SceneError(
                f"the value of the parameter ${name} has no end: {chain}",
                where=path,
                remedy="Write a value that does not need itself.",
            )
        value = reader.parameters[name]
        if "$" in value:
            value = _with_values(value, reader, path, (*within, name))
        # Values may hold values, so their length could double with every line of the file.
        reader.expanded += len(value)
        if reader.expanded > MOST_EXPANDED:
            raise SceneError(
                f"its parameters expand to more than {MOST_EXPANDED:,} characters", where=path
            )
        parts += [value, part[len(name) :]]
    return "".join(parts)


def _defaults(path: Path, folders: Folders, seen: set[Path]) -> Iterator[tuple[str, str]]:
    """The defaults of a file and of those that it includes, in the order in which they are read.

    Each file is looked at once, and is then `seen`. What cannot be read is told where it is
    included.
    """
    seen.add(path)
    try:
        elements = list(_parse(path).iter())
    except SceneError:
        return
    for element in elements[:MOST_AHEAD]:
        if element.tag == "default" and element.get("name"):
            yield element.get("name", ""), element.get("value", "")
        elif element.tag == "include" and len(seen) < MAX_INCLUDES:
            with suppress(SceneError):
                target = folders.find(element.get("filename", ""), path)
                if target not in seen:
                    yield from _defaults(target, folders, seen)


def _snake(name: str) -> str:
    """toWorld -> to_world, as names were written before version 2."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()
