"""Results that are costly to compute, cached on disk between runs.

A cache that cannot be written costs its user a warning and the same work next time, never the
result. (`env.cache_folder` refuses a name that leads nowhere, AIRLIGHT_CACHE=~nobody, before that.)
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..errors import OutputError

_REMEDY = "Set AIRLIGHT_CACHE to a folder that can be written."


def keep(path: Path, what: str, write: Callable[[Path], None]) -> str:
    """Have `write(part)` create the file at `path` in the cache, whole or not at all.

    Returns an empty text, or a warning that names `what` is not cached, and why.
    """
    from ..scene.io.writing import whole_file

    # A cache is a help: what keeps it from being written becomes a warning.
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as part:
            write(part)
    except (OSError, OutputError) as error:
        said = error.problem if isinstance(error, OutputError) else error.strerror or error
        return f"{what} is not kept for the next time: {path}: {said}. {_REMEDY}"
    return ""
