"""Uploads that renderers share: made once, released with the last lease, safe across threads."""

from __future__ import annotations

import gc
import threading
import time

import pytest

from airlight.gpu.memory import Buffer
from airlight.gpu.uploads import Uploads


@pytest.fixture
def uploads(gpu):
    return Uploads(gpu)


def made(scope):
    return Buffer(scope, "upload", 4096)


def test_one_upload_is_made_for_a_key_and_goes_with_its_last_lease(gpu, uploads):
    before, scopes = gpu.allocated_bytes, [gpu.scope() for _ in range(3)]
    leases = [uploads.lease(scope, "key", made) for scope in scopes]
    other = uploads.lease(scopes[0], "other", made)
    assert leases[0].value is leases[1].value is leases[2].value is not other.value
    assert gpu.allocated_bytes == before + 2 * 4096
    scopes[0].release()
    scopes[0].release()  # once more does nothing
    assert gpu.allocated_bytes == before + 4096
    assert leases[1].value.handle is not None
    leases[1].release()
    scopes[1].release()  # which has ended already
    assert gpu.allocated_bytes == before + 4096
    scopes[2].release()
    assert (gpu.allocated_bytes, len(uploads)) == (before, 0)
    again = uploads.lease(scopes[0], "key", made)
    assert again.value.handle is not None
    again.release()


def test_what_nobody_refers_to_any_more_is_counted(gpu, uploads):
    before, scope = gpu.allocated_bytes, gpu.scope()
    kept = uploads.lease(scope, "key", made)
    uploads.lease(scope, "key", made)
    gc.collect()
    assert gpu.allocated_bytes == before + 4096
    assert kept.claim()  # nobody else has it
    del kept
    gc.collect()
    assert (gpu.allocated_bytes, len(uploads)) == (before, 0)


def test_a_lease_can_be_dropped_while_the_table_is_in_use(gpu, uploads):
    scope = gpu.scope()
    leases = [uploads.lease(scope, "key", made)]
    with uploads._lock:  # as where garbage is collected in the midst of a method
        leases.clear()
        gc.collect()
    uploads.lease(scope, "other", made).release()
    assert len(uploads) == 0


def test_only_what_is_nobody_elses_can_be_claimed(gpu, uploads):
    scope = gpu.scope()
    one, two = (uploads.lease(scope, "key", made) for _ in range(2))
    assert not one.claim()
    two.release()
    assert one.claim()
    assert one.claim()
    # Who asks now gets another.
    three = uploads.lease(scope, "key", made)
    assert three.value is not one.value
    one.release()
    assert one.value.handle is None
    assert three.value.handle is not None
    scope.release()


def test_what_fails_is_tried_again_and_leaves_no_memory(gpu, uploads):
    before, scope = gpu.allocated_bytes, gpu.scope()

    def failing(inner):
        made(inner)
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        uploads.lease(scope, "key", failing)
    assert (gpu.allocated_bytes, len(uploads)) == (before, 0)
    assert uploads.lease(scope, "key", made).value.handle is not None
    scope.release()


def test_threads_that_ask_at_once_share_one(gpu, uploads):
    count, values, scope = [], [], gpu.scope()

    def slow(inner):
        count.append(1)
        time.sleep(0.05)
        return made(inner)

    def ask():
        for _ in range(20):
            lease = uploads.lease(scope, "key", slow)
            values.append(lease.value.handle is not None)
            lease.release()

    before = gpu.allocated_bytes
    kept = uploads.lease(scope, "key", slow)
    threads = [threading.Thread(target=ask) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(count) == 1
    assert values == [True] * 120
    kept.release()
    assert (gpu.allocated_bytes, len(uploads)) == (before, 0)
