"""Uploads that all renderers of a device share, found by keys that say what they are made of.

uploads  of one device; an upload is released with the last lease of it
lease    what one user of an upload holds; it ends with the scope of that user
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from .device import Gpu

T = TypeVar("T")


class _Upload:
    """Something on the device, in a scope of its own. `count`: of its leases."""

    def __init__(self, key: Hashable) -> None:
        self.key, self.count = key, 0
        self.making = threading.Lock()
        self.scope: Gpu | None = None
        self.value: Any = None


class Lease(Generic[T]):
    """The use of an upload. All its leases share `value`, which nobody may change."""

    def __init__(self, uploads: Uploads, upload: _Upload) -> None:
        self._uploads, self._upload = uploads, upload
        self._is_held = True

    @property
    def value(self) -> T:
        """The upload itself."""
        value: T = self._upload.value
        return value

    def claim(self) -> bool:
        """Make the upload this lease's own, which may then be changed; False where others use it.

        Nobody finds it from then on.
        """
        return self._uploads.forget(self._upload)

    def owned(self, scope: Gpu, make: Callable[[Gpu], T]) -> Lease[T]:
        """This lease, of what may then be changed; or, where others use the upload, one in its
        place of another that `make` makes and nobody finds."""
        if self.claim():
            return self
        self.release()
        return self._uploads.lease(scope, object(), make)

    def release(self) -> None:
        """End the use; once more it does nothing."""
        if self._is_held:
            self._is_held = False
            self._uploads.give_back(self._upload)

    def __del__(self) -> None:
        if self._is_held:
            self._uploads.drop(self._upload)


class Uploads:
    """The uploads of one device. A thread that asks for one that another makes waits for it."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._uploads: dict[Hashable, _Upload] = {}
        self._lock = threading.Lock()
        self._dropped: deque[_Upload] = deque()  # whose leases are gone without a release

    def __len__(self) -> int:
        return len(self._uploads)

    def lease(self, scope: Gpu, key: Hashable, make: Callable[[Gpu], T]) -> Lease[T]:
        """The upload of `key`, which `make` makes in the scope that it gets where there is none.

        `key` says all that it depends on. The lease ends with `scope`.
        """
        # Counted under the lock, so that nobody releases it before it is made.
        with self._lock:
            upload = self._uploads.setdefault(key, _Upload(key))
            upload.count += 1
        # Made outside of that lock: others may upload meanwhile, and only those of the same key
        # wait.
        lease: Lease[T] = Lease(self, upload)
        try:
            with upload.making:
                if upload.scope is None:
                    self._make(upload, make)
        except BaseException:
            lease.release()
            raise
        scope.own(lease)
        self._sweep()
        return lease

    def _make(self, upload: _Upload, make: Callable[[Gpu], Any]) -> None:
        made_in = self._gpu.scope()
        try:
            upload.value = make(made_in)
        except BaseException:
            made_in.release()
            raise
        upload.scope = made_in

    def forget(self, upload: _Upload) -> bool:
        """Find the upload no more, if it has one lease; returns whether it has."""
        with self._lock:
            if upload.count != 1:
                return False
            if self._uploads.get(upload.key) is upload:
                del self._uploads[upload.key]
            return True

    def give_back(self, upload: _Upload) -> None:
        """One lease less; after the last one the memory is given back at once."""
        with self._lock:
            is_last = self._less(upload)
        if is_last and upload.scope is not None:
            upload.scope.release()
        self._sweep()

    def drop(self, upload: _Upload) -> None:
        """One lease less, whose holder was forgotten. Never waits: a destructor calls it, perhaps
        in the midst of another method."""
        self._dropped.append(upload)
        self._sweep()

    def _less(self, upload: _Upload) -> bool:
        """Count one lease less; returns whether it was the last. Only under the lock."""
        upload.count -= 1
        if upload.count == 0 and self._uploads.get(upload.key) is upload:
            del self._uploads[upload.key]
        return upload.count == 0

    def _sweep(self) -> None:
        """Count the dropped uploads. Encoded commands may still need them: none is destroyed."""
        while self._dropped and self._lock.acquire(blocking=False):
            try:
                while self._dropped:
                    self._less(self._dropped.popleft())
            finally:
                self._lock.release()
