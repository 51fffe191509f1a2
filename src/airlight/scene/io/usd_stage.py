"""Opening a USD file with all of its layers, each of which follows the rule of `files.named_file`.

USD's own resolver opens whatever a layer names. So each layer is opened on its own first, without
composition, and what it would compose is looked up and checked, before the stage is opened. The
extra `usd` brings usd-core, OpenUSD's own library.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...errors import SceneError
from .files import check_named, named_file, regular_file
from .ledger import note_read

_MOST_LAYERS = 4096
_MOST_TEXTS, _LONGEST_TEXT = 20, 300
_DURING = re.compile(r" \(\w+ing [^()]*<0x[0-9a-f]+>\)$")
"""Of what the library says, during which work of its own."""
_CLIPS = ("clips", "clipSets")


@contextmanager
def told_by_usd() -> Iterator[Callable[[], list[str]]]:
    """What the library would write to stderr, instead as texts that a call gives."""
    try:
        from pxr import UsdUtils
    except ImportError:
        yield list
        return
    # The library's own delegate gathers what it would print.
    delegate = UsdUtils.CoalescingDiagnosticDelegate()

    def told() -> list[str]:
        found = [d.commentary.split("\n")[0] for d in delegate.TakeUncoalescedDiagnostics()]
        found = [_DURING.sub("", text) for text in found]
        return [text[:_LONGEST_TEXT] for text in found[:_MOST_TEXTS]]

    yield told
    told()


@contextmanager
def refused_by_usd() -> Iterator[None]:
    """What the library refuses, as one SceneError."""
    try:
        from pxr import Tf
    except ImportError:
        yield
        return
    try:
        yield
    except Tf.ErrorException as error:
        raise SceneError(f"is no readable USD ({_said(error)})") from None


def opened_stage(path: Path) -> Any:
    """The composed stage. Raises SceneError for what is no USD, or reaches out of its folder."""
    regular_file(path)
    try:
        from pxr import Sdf, Tf, Usd
    except ImportError:
        raise SceneError(
            "needs the package usd-core, which is not installed",
            remedy="Run: pip install 'airlight[usd]', or export glTF (.glb).",
        ) from None
    # Every layer that the first one names, before the library composes them.
    folder = path.parent.resolve()
    try:
        first = _layer(path.resolve(), Sdf)
        # What is still to be looked at, and what was seen: layers may name each other in a circle.
        todo, seen = [first], {first.identifier}
        while todo:
            for name in _named(todo.pop(), folder):
                layer = _opened_layer(name)
                if layer is not None and layer.identifier not in seen:
                    if len(seen) >= _MOST_LAYERS:
                        raise SceneError(f"has over {_MOST_LAYERS:,} layers")
                    seen.add(layer.identifier)
                    todo.append(layer)
        # The layers are within bounds: now the stage may compose them, with one over them that no
        # file has, for what is worked out from them.
        own = Sdf.Layer.CreateAnonymous()
        stage = Usd.Stage.Open(first, own, _resolver_context(path), Usd.Stage.LoadAll)
    except Tf.ErrorException as error:
        raise SceneError(f"is no readable USD ({_said(error)})") from None
    # Composition may bring in others still.
    for layer in stage.GetUsedLayers():
        if layer.realPath:
            _check_asset(layer.realPath, folder, layer.identifier)
    return stage


def _resolver_context(path: Path) -> Any:
    from pxr import Ar

    return Ar.GetResolver().CreateDefaultContextForAsset(str(path.resolve()))


def _opened_layer(name: str) -> Any:
    """A layer that another one names; None where the library cannot read it, as MaterialX without
    its plugin: the library leaves it out, too, and says so."""
    from pxr import Sdf, Tf

    try:
        return Sdf.Layer.FindOrOpen(name)
    except Tf.ErrorException:
        return None


def _layer(path: Path, sdf: Any) -> Any:
    layer = sdf.Layer.FindOrOpen(str(path))
    if layer is None:
        raise SceneError("is no readable USD")
    return layer


def _said(error: Exception) -> str:
    said = " ".join(str(error).split())
    quoted = re.search(r": '(.*)'", said)
    return (quoted[1] if quoted else said or type(error).__name__)[:200]


def _named(layer: Any, folder: Path) -> list[str]:
    """What a layer would compose, resolved and checked. Raises SceneError."""
    # Clips name files by templates that are no dependencies of a layer.
    layer.Traverse("/", lambda path: _refuse_clips(layer, path))
    found = []
    for asset in layer.GetCompositionAssetDependencies():
        resolved = resolved_asset(layer, asset, folder)
        if resolved:
            found.append(resolved)
    return found


def _refuse_clips(layer: Any, path: Any) -> None:
    spec = layer.GetPrimAtPath(path) if path.IsPrimPath() else None
    if spec is not None and any(spec.HasInfo(name) for name in _CLIPS):
        raise SceneError(f"'{path}' has value clips, which are not read", remedy="Flatten it.")


def resolved_asset(layer: Any, asset: str, folder: Path) -> str:
    """Where an asset that `layer` names lies; "" for none. `folder` is that of the stage.

    Raises SceneError for one that no scene may name.
    """
    from pxr import Ar, Sdf

    # Expressions are evaluated at composition, when it is too late to check them.
    if asset.startswith("`"):
        raise SceneError("names files by expressions, which are not read", remedy="Flatten it.")
    if not asset:
        return ""
    # Names are seen from the layer that holds them; one in a package is a part of that.
    start = Path(layer.realPath).parent if layer.realPath else folder
    named_file(_outer(asset), "", start, folder)
    written = Sdf.ComputeAssetPathRelativeToLayer(layer, asset)
    resolved = str(Ar.GetResolver().Resolve(written))
    # Programs on Windows write backslashes, which lead nowhere elsewhere.
    if not resolved and "\\" in asset:
        return resolved_asset(layer, asset.replace("\\", "/"), folder)
    # What does not resolve is checked as well: the library may look for it elsewhere.
    _check_asset(resolved or written, folder, asset, is_there=bool(resolved))
    return resolved


def _check_asset(path: str, folder: Path, asset: str, *, is_there: bool = True) -> None:
    """Raise SceneError where no scene may name a path of USD's, or where it is no regular file."""
    outer = folder / _outer(path)
    check_named(outer, asset, "", folder)
    # What is not there may be there when the scene is loaded again.
    if is_there:
        regular_file(outer)
    else:
        note_read(outer)


def _outer(path: str) -> str:
    """The file itself of a path into a package, such as a.usdz[b.png]."""
    from pxr import Ar

    while Ar.IsPackageRelativePath(path):
        path = Ar.SplitPackageRelativePathOuter(path)[0]
    return path
