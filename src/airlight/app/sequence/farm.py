"""Frames spread over the workers of a dask.distributed cluster.

Each worker makes whole frames with a renderer of its own, and sends back the bytes of their files;
this process writes them. What a worker was doing when it died is given to another. Workers need
airlight, and the files of a density sequence under the same paths; the rest of a scene is sent.
"""

from __future__ import annotations

import asyncio
import importlib.util
import logging
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from time import monotonic
from typing import TYPE_CHECKING, Any

from ...errors import AirlightError, SettingsError
from .frames import FrameMaker
from .plan import Plan
from .scheduler import check_address, check_scheduler, no_answer

if TYPE_CHECKING:
    from ...scene import Scene

ANSWER_S = 10.0
PATIENCE_S = 60.0  # without any worker
_POLL_S = 1.0


def check_farm(address: str) -> None:
    """Raise SettingsError where clusters, or this address, cannot be spoken to."""
    if importlib.util.find_spec("distributed") is None:
        raise SettingsError(
            "--farm needs the package 'distributed'", remedy="pip install 'airlight[farm]'."
        )
    check_address(address)


def farm_frames(
    address: str,
    plan: Plan,
    scene: Scene,
    frames: Sequence[int],
    take: Callable[[int, bytes, str, list[str]], None],
    *,
    answer_s: float = ANSWER_S,
    patience_s: float = PATIENCE_S,
) -> None:
    """Make `frames` on the cluster at `address`, each once.

    `take(frame, bytes, device, doubts)` gets them, in any order. Raises SettingsError where
    the cluster does not answer, is lost or has no workers, and what a frame's making raises.
    """
    with _client(address, answer_s) as client:
        # The scene is sent once, and shared by all frames.
        sent = client.submit(_Sent, plan, scene, pure=False)
        futures = {
            client.submit(_made, sent, frame, priority=-frame, pure=False): frame
            for frame in frames
        }
        # Frames are written as they come; what is not needed any more is cancelled.
        try:
            for future in _finished(client, set(futures), address, patience_s):
                take(futures.pop(future), *future.result())
                future.release()
        finally:
            client.cancel(list(futures))


@contextmanager
def _client(address: str, answer_s: float) -> Iterator[Any]:
    from distributed import Client
    from distributed.comm import CommClosedError

    _silence()
    # A scheduler that does not answer is told apart before the library's own client waits for it.
    check_scheduler(address, answer_s)
    try:
        # One that never connected would wait 20 s for its end, and print a traceback.
        held = type("Client", (Client,), {"__del__": lambda self: None})
        client = held(address, timeout=answer_s, set_as_default=False)
    except Exception:  # whatever a stranger's bytes raise within `distributed`
        raise no_answer(address) from None
    try:
        with client.as_current():
            yield client
    except (OSError, CommClosedError, asyncio.CancelledError, CancelledError):
        raise _gone(address) from None
    finally:
        with suppress(OSError, TimeoutError, CommClosedError):
            client.close(timeout=2)


def _silence() -> None:
    """Tracebacks of connections that broke are no news to a user: we say it in one line."""
    names = [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    for name in (*names, "distributed", "tornado.application", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _finished(client: Any, pending: set[Any], address: str, patience_s: float) -> Iterator[Any]:
    """Futures as they finish; gives up once there has been no worker for `patience_s`."""
    from distributed import wait

    alone_since: float | None = None
    while pending:
        # The wait is short, so that a lost cluster is noticed between frames.
        try:
            done, _ = wait(pending, timeout=_POLL_S, return_when="FIRST_COMPLETED")
        except TimeoutError:
            done = set()
        # Frames that are done are given on; one that is lost ends it.
        pending -= done
        for future in done:
            if future.status in ("cancelled", "lost"):
                raise _gone(address)
            _raise_ours(future, address)
            yield future
        if client.status not in ("running", "connecting"):
            raise _gone(address)
        # A cluster without workers finishes nothing: it has some time to get one.
        workers = client.scheduler_info(n_workers=-1).get("workers", {})
        if workers or done:
            alone_since = None
        elif alone_since is None:
            alone_since = monotonic()
        elif monotonic() - alone_since > patience_s:
            raise SettingsError(
                f"the cluster at {address} has no workers",
                remedy=f"Start one by `dask worker {address}`, and go on by --resume.",
            )


def _raise_ours(future: Any, address: str) -> None:
    """Raise what a frame's making raised, in one line."""
    if future.status != "error":
        return
    error = future.exception()
    if isinstance(error, AirlightError):
        raise error
    # What went wrong with a worker is told as what to do about it.
    kind = type(error).__name__
    if kind == "KilledWorker":
        raise SettingsError(
            f"a frame has killed several workers of the cluster at {address}",
            remedy="Give them more memory, or make the image smaller; go on by --resume.",
        )
    if isinstance(error, ImportError):
        raise SettingsError(
            f"the workers at {address} cannot import airlight ({error})",
            remedy="Install the same version there.",
        )
    raise error


def _gone(address: str) -> SettingsError:
    return SettingsError(
        f"the cluster at {address} is gone",
        remedy="Frames that came are kept: go on by --resume.",
    )


class _Sent:
    """What a worker needs to make frames; the renderer is made there, once per process."""

    def __init__(self, plan: Plan, scene: Scene) -> None:
        self.plan, self.scene = plan, scene


_LOCK = threading.Lock()
_MAKER: list[tuple[_Sent, FrameMaker]] = []


def _made(sent: _Sent, frame: int) -> tuple[bytes, str, list[str]]:
    """On a worker: a frame's file, the device that made it, doubts about it. One at a time."""
    # One renderer for each process, made again for another scene or plan.
    with _LOCK:
        if not _MAKER or _MAKER[0][0] is not sent:
            for _, old in _MAKER:
                old.close()
            _MAKER[:] = [(sent, FrameMaker(sent.plan, sent.scene))]
        maker = _MAKER[0][1]
        data, doubts = maker.encoded(frame), maker.doubts
        maker.doubts = []
        return data, maker.renderer.gpu.info.name, doubts
