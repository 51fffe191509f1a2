"""Which code paths a device takes, apart from what its adapter is.

A CPU adapter runs invocations as lanes of vectors, reads slowly and rasterises slowly; a GPU has
thousands of threads and caches. Kernels are laid out for the one or for the other, and some choices
(numbers of samples, sizes of images, formats) follow. Each choice asks `Gpu.takes_cpu_paths`, so
that both paths can be run, and held to each other, on one adapter. What is true of the adapter
itself (that its timestamps mean nothing, that a viewer has to be coarse while it moves) asks
`AdapterInfo.is_cpu`.
"""

from __future__ import annotations

from typing import Literal, cast

from .. import env
from ..errors import SettingsError

Paths = Literal["gpu", "cpu"]
SWITCH = "AIRLIGHT_PATHS"
_KNOWN = ("auto", "gpu", "cpu")


def chosen_paths(wanted: str | None = None, *, is_cpu: bool) -> Paths:
    """The code paths for `wanted` (auto, gpu or cpu; AIRLIGHT_PATHS if None) on an adapter.

    auto: those made for the adapter, by whether it `is_cpu`. Raises SettingsError for another word.
    """
    text = env.value(SWITCH) if wanted is None else wanted
    key = text.lower()
    if key not in _KNOWN:
        raise SettingsError(
            f"there are no paths '{text}'",
            where=SWITCH if wanted is None else "paths",
            remedy="Use auto (those made for the adapter), gpu or cpu",
        )
    if key == "auto":
        return "cpu" if is_cpu else "gpu"
    return cast(Paths, key)
