"""A forked child of a process that used the driver: told so at once, and ends by itself."""

from __future__ import annotations

import os

import pytest

from airlight.gpu import process

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
FORK = """
import os, sys, warnings
from airlight.gpu.device import Gpu, adapters, open_gpu
# Python says so from 3.12 on wherever the driver has threads; what happens then is tested here.
warnings.filterwarnings('ignore', '.*multi-threaded, use of fork', DeprecationWarning)
def fork(work):
    '''What `work` says in a forked child, which then ends as a Python program does.'''
    sys.stdout.flush()
    pid = os.fork()
    if pid:
        print(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
        return
    for task in work:
        try:
            print(task())
        except al.DeviceError as error:
            print(type(error).__name__, error)
    sys.exit(3)
"""
REFUSED = (
    "DeviceError this process was forked from one that had used the graphics driver, and a fork "
    'has none of its threads. Start such processes afresh: multiprocessing.get_context("spawn")'
)


def test_after_a_frame_a_child_is_refused_whatever_it_asks(child):
    said = child(
        FORK
        + """
renderer = made()
before = renderer.frame().radiance
texture = renderer.view.gbuffer.albedo
asked = [open_gpu, adapters, made, renderer.frame, renderer.gpu.wait, texture.read,
         renderer.meshes.vertices.positions.read, renderer.timed_passes,
         lambda: renderer.resize((8, 8)), lambda: al.render(scene, size=(8, 8)),
         lambda: Gpu(renderer.gpu.info, "cpu")]
fork(asked)
print(np.array_equal(renderer.frame().radiance, before))
"""
    )
    assert said == [*[REFUSED] * 11, "3", "True"]


def test_a_child_gives_nothing_back_and_its_parent_goes_on(child):
    said = child(
        FORK
        + """
with made() as renderer:
    before = renderer.frame().radiance
    fork([renderer.close, renderer.close, lambda: globals().pop("renderer") and None])
    print(np.array_equal(renderer.frame().radiance, before))
"""
    )
    assert said == ["None", "None", "None", "3", "True"]


@pytest.mark.parametrize(
    ("first", "then"), [("", "True"), ("adapters()", REFUSED), ("open_gpu()", REFUSED)]
)
def test_the_driver_makes_the_difference_and_imports_do_not(child, first, then):
    said = child(f"{FORK}\n{first}\nfork([lambda: bool(made().frame().radiance.any())])")
    assert said == [then, "3"]


def test_a_fork_while_another_thread_opens_the_device_is_refused(child):
    said = child(
        FORK
        + """
import threading
from airlight.gpu import device
begun, go_on = threading.Event(), threading.Event()
enumerate_adapters = device.wgpu.gpu.enumerate_adapters_sync
def slow():
    begun.set()
    go_on.wait()
    return enumerate_adapters()
device.wgpu.gpu.enumerate_adapters_sync = slow
thread = threading.Thread(target=open_gpu)
thread.start()
begun.wait()
fork([open_gpu, made])
go_on.set()
thread.join()
print(bool(made().frame().radiance.any()))
"""
    )
    assert said == [REFUSED, REFUSED, "3", "True"]


def test_a_pool_of_forked_workers_is_refused_and_one_of_spawned_is_not(child, tmp_path):
    worker = tmp_path / "worker.py"
    worker.write_text(
        "import airlight as al\n"
        "def work(scene):\n"
        "    try:\n"
        "        return bool(al.render(scene, 'direct', (8, 8), samples=1).radiance.any())\n"
        "    except al.DeviceError as error:\n"
        "        return f'{type(error).__name__} {error}'\n"
    )
    said = child(f"""
    import multiprocessing, sys
    sys.path.insert(0, {str(tmp_path)!r})
    from worker import work
    made().frame()
    for kind in ("fork", "spawn"):
        with multiprocessing.get_context(kind).Pool(1) as pool:
            print(pool.apply(work, [scene]))
    """)
    assert [line for line in said if "DeprecationWarning" not in line] == [REFUSED, "True"]


def test_the_process_that_uses_the_driver_is_not_forked(gpu):
    process.enter_driver()
    assert not process.is_forked()
