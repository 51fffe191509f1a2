"""A Mitsuba scene as plain nodes, and the folders that it may name files in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...errors import SceneError
from .files import is_file, is_folder, named_file, regular_file

MAX_DEPTH = 60
"""Of plugins in plugins, as written; twice that by references."""


@dataclass(eq=False)
class Node:
    """A plugin of the scene: what it is, its values and the plugins inside it, in order.

    `name` is the role it plays for its parent. Reading a value marks it as read, so that what
    was left out can be told in the end.
    """

    tag: str
    kind: str
    name: str = ""
    id: str = ""
    values: dict[str, Any] = field(default_factory=dict)
    children: list[Node] = field(default_factory=list)
    read: set[str] = field(default_factory=set)

    def get(self, name: str, default: Any = None) -> Any:
        """The value called `name`."""
        self.read.add(name)
        return self.values.get(name, default)

    def child(self, name: str) -> Node | None:
        """The plugin that plays the role `name`."""
        return next((c for c in self.children if c.name == name), None)

    def all(self, tag: str) -> list[Node]:
        """The plugins of one kind of thing."""
        return [c for c in self.children if c.tag == tag]

    def first(self, tag: str) -> Node | None:
        """The first plugin of one kind of thing, if any."""
        return next(iter(self.all(tag)), None)

    def __str__(self) -> str:
        return f"{self.tag} '{self.id}' ({self.kind})" if self.id else f"{self.tag} ({self.kind})"


@dataclass
class Folders:
    """Where a scene looks for the files that it names: its own folder, and search paths before it.

    `skipped` are search paths that are no folders, or that the scene may not name.
    """

    own: Path
    search: list[Path] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, path: Path) -> Folders:
        """Those of the scene at `path`. Raises SceneError where there is no such file."""
        return cls(regular_file(path).resolve().parent)

    def find(self, name: str, where: object) -> Path:
        """The first file of that name; where none exists, what it would be beside the scene.

        Raises SceneError for a name that scenes may not use, `files.named_file`.
        """
        # The search path that was named last comes first. From one of them a name may lead where
        # it may not, and from the next to the file.
        for folder in self.search:
            try:
                path = named_file(name, where, folder, self.own)
            except SceneError:
                continue
            if is_file(path):
                return path
        path = named_file(name, where, self.own)
        # A file that is nowhere may lie where the scene was not looked for.
        if self.skipped and not is_file(path):
            raise SceneError(
                f"'{name}' is not in its folder, and its search path '{self.skipped[0]}' is no "
                "folder, or none that it may name",
                where=self.own,
                remedy="Check the path; AIRLIGHT_ROOT, where it is set, lies around it.",
            )
        return path

    def add(self, name: str, path: Path) -> None:
        """Look in the folder `name`, as the file `path` says in a <path>, before all others.

        What is no folder is skipped, and remembered as such.
        """
        # It is no error: the files may lie in another folder.
        try:
            folder = named_file(name, path, path.resolve().parent, self.own)
        except SceneError:
            self.skipped.append(name)
            return
        if is_folder(folder):
            self.search.insert(0, folder)
        else:
            self.skipped.append(name)


def refuse_cycles(scene: Node) -> None:
    """Raise SceneError where references make a node contain itself."""

    def visit(node: Node, above: tuple[int, ...]) -> None:
        # Nodes in another role share their list of children: that is what makes them the same.
        if id(node.children) in above:
            raise SceneError(f"{node} contains itself")
        if len(above) > 2 * MAX_DEPTH:
            raise SceneError("references are chained too deep")
        # A node without a cycle below it is searched once, however many refer to it.
        key = id(node.children)
        if key in done:
            return
        for child in node.children:
            visit(child, (*above, key))
        done.add(key)

    done: set[int] = set()
    visit(scene, ())


def walk(node: Node) -> Iterator[Node]:
    """Every node below `node`, each once."""
    seen: set[int] = set()
    stack = [node]
    while stack:
        here = stack.pop()
        if id(here.read) not in seen:
            seen.add(id(here.read))
            yield here
            stack.extend(here.children)
