"""`airlight sequence`: the same frames alone, together, after a kill, and on a farm."""

from __future__ import annotations

import errno
import json
import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from airlight.app.cli import run
from airlight.app.sequence.frames import FrameMaker
from airlight.app.sequence.plan import Plan

SCENE = """
[camera]
position = [0, 1, 4]
target = [0, 0.5, 0]
{exposure}
key = [{{ time_s = 0, position = [0, 1, 4] }}, {{ time_s = 1, position = [2, 1, 3] }}]
[[mesh]]
shape = "quad"
scale = 4
[[mesh]]
shape = "box"
translate = [0, 0.5, 0]
key = [{{ time_s = 0, rotate_deg = [0, 0, 0] }}, {{ time_s = 1, rotate_deg = [0, 90, 0] }}]
[[light]]
type = "directional"
direction = [0.5, -1, -0.3]
irradiance = 5
[animation]
fps = 10
"""
SMALL = [
    "-t",
    "direct",
    "--size",
    "24x16",
    "--samples",
    "1",
    "-D",
    "resolution=8",
    "-q",
    "-D",
    "shadow_resolution=64",
    "-D",
    "surfels=500",
]


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "turn.toml"
    path.write_text(SCENE.format(exposure="exposure_stops = 0"))
    return path


def sequence(scene, output, *more):
    return run(["sequence", str(scene), "-o", str(output), *SMALL, *more])


def frames(folder):
    return {file.name: file.read_bytes() for file in sorted(folder.glob("frame-*"))}


def test_frames_are_the_same_alone_and_together(gpu, scene, tmp_path, capsys):
    assert sequence(scene, tmp_path / "all") == 0
    assert capsys.readouterr().out == f"{tmp_path / 'all'}\n"
    whole = frames(tmp_path / "all")
    assert list(whole) == [f"frame-{k:05d}.png" for k in range(10)]
    assert len(set(whole.values())) == 10
    assert sequence(scene, tmp_path / "one", "--frames", "7-7") == 0
    assert frames(tmp_path / "one") == {"frame-00007.png": whole["frame-00007.png"]}
    told = json.loads((tmp_path / "all" / "sequence.json").read_text())
    assert told["asked"]["technique"] == "direct" and told["devices"] == [gpu.info.name]
    # Going on with another part of the same sequence is going on.
    assert sequence(scene, tmp_path / "one", "--frames", "3-6", "--resume") == 0
    assert frames(tmp_path / "one").items() < whole.items()


def test_exr_frames_keep_their_layers_and_their_bits(gpu, scene, tmp_path):
    from airlight.scene.io import exr

    options = ["--format", "exr", "--layers", "--frames"]
    assert sequence(scene, tmp_path / "a", *options, "0-1") == 0
    assert sequence(scene, tmp_path / "b", *options, "1-1") == 0
    one = frames(tmp_path / "b")["frame-00001.exr"]
    assert frames(tmp_path / "a")["frame-00001.exr"] == one
    assert exr.read_rgb(tmp_path / "a" / "frame-00001.exr").shape == (16, 24, 3)


@pytest.mark.needs("av")
def test_a_video_resumes_and_is_known_when_it_is_done(gpu, scene, tmp_path, monkeypatch, capsys):
    import av

    output = tmp_path / "turn.mp4"
    made = []
    save = FrameMaker.save
    monkeypatch.setattr(
        FrameMaker, "save", lambda self, k, path: made.append(k) or save(self, k, path)
    )
    assert sequence(scene, output, "--keep-frames") == 0
    assert made == [*range(10)] and len(frames(tmp_path / "turn.mp4.frames")) == 10
    with av.open(str(output)) as container:
        assert sum(1 for _ in container.decode(video=0)) == 10
    made.clear()
    stamp = output.stat().st_mtime_ns
    assert sequence(scene, output, "--resume") == 0
    assert made == [] and output.stat().st_mtime_ns == stamp
    assert not (tmp_path / "turn.mp4.frames").exists()
    scene.write_text(SCENE.format(exposure="exposure_stops = 1"))
    assert sequence(scene, output, "--resume") == 0  # another scene: recomputed
    assert made == [*range(10)] and output.stat().st_mtime_ns > stamp


def test_exposure_auto_is_that_of_a_camera_that_leaves_it_to_the_image(gpu, scene, tmp_path):
    frames = {}
    for name, exposure, words in (
        ("said", "exposure_stops = 0", []),
        ("asked", "exposure_stops = 0", ["--exposure", "auto"]),
        ("left", 'exposure_stops = "auto"', []),
    ):
        scene.write_text(SCENE.format(exposure=exposure))
        assert sequence(scene, tmp_path / name, "--frames", "1", *words) == 0
        frames[name] = (tmp_path / name / "frame-00000.png").read_bytes()
    assert frames["asked"] == frames["left"] != frames["said"]


def test_exposure_is_metered_once(gpu, scene, tmp_path):
    from dataclasses import replace

    from airlight.app.sequence.frames import metered_stops
    from airlight.scene.io import load

    loaded = load(scene)
    plan = Plan("direct", (24, 16), 0.0, 10.0, 0, 9, settings={"surfels": "500"}, samples=1)
    assert metered_stops(plan, loaded) is None
    metered = replace(loaded, camera=replace(loaded.camera, exposure_stops=None))
    stops = metered_stops(plan, metered)
    assert metered_stops(replace(plan, first=5), metered) == stops
    assert metered_stops(replace(plan, exposure_stops=1.0), metered) is None
    with closing(FrameMaker(replace(plan, exposure_stops=stops), metered)) as maker:
        assert {maker.image(frame).exposure_stops for frame in (0, 9)} == {stops}


def test_a_full_disk_loses_nothing(gpu, scene, tmp_path, monkeypatch, capsys):
    save, left = PIL.Image.Image.save, [3]

    def full(self, *args, **named):
        left[0] -= 1
        if left[0] < 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        return save(self, *args, **named)

    monkeypatch.setattr(PIL.Image.Image, "save", full)
    assert sequence(scene, tmp_path / "out") == 2
    error = capsys.readouterr().err
    assert error.splitlines()[-1] == (
        f"error: {tmp_path / 'out' / 'frame-00003.png'}: cannot be written (No space left on "
        "device). Choose another folder, or check its permissions and free space. What was made "
        "stays: --resume goes on."
    )
    assert len(frames(tmp_path / "out")) == 3 and not list((tmp_path / "out").glob(".*"))
    monkeypatch.undo()
    assert sequence(scene, tmp_path / "out", "--resume") == 0
    assert len(frames(tmp_path / "out")) == 10


@pytest.mark.skipif(os.name != "posix", reason="kill -9")
def test_a_killed_run_goes_on_where_it_was(gpu, scene, tmp_path):
    output = tmp_path / "out"
    command = [sys.executable, "-m", "airlight", "sequence", str(scene), "-o", str(output), *SMALL]
    child = subprocess.Popen([*command, "--fps", "60"])
    while child.poll() is None and len(frames(output)) < 4:
        time.sleep(0.005)
    child.send_signal(signal.SIGKILL)
    child.wait()
    done = frames(output)
    assert 4 <= len(done) < 60
    # As if it had been killed between writing a frame and naming it.
    (output / f".frame-00050.{child.pid}.part.png").write_bytes(b"half")
    assert sequence(scene, output, "--fps", "60") == 2
    assert sequence(scene, output, "--fps", "60", "--resume") == 0
    resumed = frames(output)
    assert list(resumed) == [f"frame-{k:05d}.png" for k in range(60)]
    assert done.items() <= resumed.items()
    assert not list(output.glob(".*"))
    assert sequence(scene, tmp_path / "whole", "--fps", "60") == 0
    assert frames(tmp_path / "whole") == resumed


@pytest.mark.parametrize(
    ("output", "more", "message"),
    [
        ("out.mp4", ["--format", "exr"], "a video has no EXR frames. Give a folder for frames."),
        ("out", ["--layers"], "--layers needs --format exr"),
        (
            "out.avi",
            [],
            "out.avi: '.avi' is no kind of video that is written here. "
            "End it in .mp4, or give a folder.",
        ),
        ("out", ["--frames", "5-2"], "--frames 5-2 runs backwards"),
        ("out", ["-t", "lpw"], "unknown technique 'lpw'. Did you mean 'lpv'?"),
        ("no/out.mp4", [], "out.mp4: the folder '{tmp}/no' does not exist. Create it first."),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(scene, tmp_path, capsys, output, more, message):
    assert sequence(scene, tmp_path / output, *more) == 2
    assert capsys.readouterr().err.strip().endswith(message.replace("{tmp}", str(tmp_path)))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["turn.toml"]


FARM = pytest.param(["--farm", "tcp://127.0.0.1:1"], marks=pytest.mark.needs("distributed"))


@pytest.mark.parametrize("more", [["--resume"], FARM])
def test_frames_that_go_on_from_others_are_not_made_apart(scene, tmp_path, capsys, more):
    known = ["sequence", str(scene), "-o", str(tmp_path / "out"), "-t", "lpv", "--samples", "1"]
    known += ["-D", "gather=always", "-D", "gather_history=8", "-q", *more]
    assert run(known) == 2
    said = capsys.readouterr().err
    assert said.count("\n") <= 2 and "gather_history is 8" in said and "gather_history=0" in said
    assert not (tmp_path / "out").exists()


def test_scenes_that_do_not_move_are_refused(tmp_path, capsys):
    assert run(["sequence", "builtin:cornell", "-o", str(tmp_path / "out"), *SMALL]) == 2
    assert "nothing moves in 'cornell'" in capsys.readouterr().err


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


@pytest.mark.needs("distributed")
def test_a_farm_that_does_not_answer(gpu, scene, tmp_path, capsys, monkeypatch):
    farm_frames = "airlight.app.sequence.farm.farm_frames"
    from airlight.app.sequence import farm as sequence_farm

    quick = sequence_farm.farm_frames
    monkeypatch.setattr(farm_frames, lambda *given: quick(*given, answer_s=0.3))
    address = f"tcp://127.0.0.1:{free_port()}"
    assert sequence(scene, tmp_path / "out", "--farm", address) == 2
    assert capsys.readouterr().err.splitlines()[-1] == (
        f"error: no dask scheduler answers at {address}. Start one by `dask scheduler`, and "
        "workers by `dask worker ADDRESS`."
    )


class Farm:
    """A scheduler and workers, a process each."""

    def __init__(self, workers):
        self.address = f"tcp://127.0.0.1:{free_port()}"
        port = self.address.rpartition(":")[2]
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", port)
        self.workers = [self.add_worker() for _ in range(workers)]

    def _start(self, kind, *options):
        return subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{kind}", *options],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    def add_worker(self):
        return self._start(
            "worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard"
        )

    def close(self):
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture
def farm(request):
    started = Farm(request.param)
    yield started
    started.close()


def in_background(scene, output, *more):
    command = [sys.executable, "-m", "airlight", "sequence", str(scene), "-o", str(output)]
    return subprocess.Popen([*command, *SMALL, *more], stderr=subprocess.PIPE, text=True)


@pytest.mark.slow
@pytest.mark.needs("distributed")
@pytest.mark.parametrize("farm", [2], indirect=True)
def test_a_farm_makes_the_same_bits_and_survives_a_workers_death(gpu, farm, scene, tmp_path):
    output = tmp_path / "farmed"
    asked = ["--fps", "60", "--size", "96x64"]
    child = in_background(scene, output, "--farm", farm.address, *asked)
    while child.poll() is None and len(frames(output)) < 8:
        time.sleep(0.01)
    farm.workers[0].kill()
    assert child.wait() == 0, child.stderr.read()
    farmed = frames(output)
    assert list(farmed) == [f"frame-{k:05d}.png" for k in range(60)]
    assert sequence(scene, tmp_path / "here", *asked) == 0
    assert farmed == frames(tmp_path / "here")


@pytest.mark.slow
@pytest.mark.needs("distributed")
@pytest.mark.parametrize("farm", [1], indirect=True)
def test_a_farm_that_goes_away_leaves_its_frames(gpu, farm, scene, tmp_path):
    output = tmp_path / "farmed"
    child = in_background(scene, output, "--farm", farm.address, "--fps", "400")
    while child.poll() is None and len(frames(output)) < 8:
        time.sleep(0.01)
    farm.close()
    error = child.stderr.read()
    assert child.wait() == 2
    assert f"the cluster at {farm.address} is gone" in error
    assert "Traceback" not in error
    kept = frames(output)
    assert sequence(scene, output, "--fps", "400", "--frames", "0-19", "--resume") == 0
    assert kept.items() <= frames(output).items()


@pytest.mark.needs("distributed")
def test_errors_of_a_frame_come_through_a_farm(scene):
    from airlight.app.sequence.farm import _raise_ours
    from airlight.errors import AirlightError, SceneError, SettingsError

    class Failed:
        status = "error"

        def __init__(self, error):
            self._error = error

        def exception(self):
            return self._error

    killed = type("KilledWorker", (Exception,), {})("frame", None)
    for error, kind, message in [
        (SceneError("at 1 s: bad"), SceneError, "at 1 s: bad"),
        (ImportError("no airlight"), SettingsError, "cannot import airlight"),
        (killed, SettingsError, "a frame has killed several workers"),
    ]:
        with pytest.raises(kind, match=message):
            _raise_ours(Failed(error), "tcp://there:1")
    with pytest.raises(ZeroDivisionError) as caught:
        _raise_ours(Failed(ZeroDivisionError()), "tcp://there:1")
    assert not isinstance(caught.value, AirlightError)


def test_what_is_doubtful_of_farmed_frames_is_said_as_of_local_ones(
    gpu, scene, tmp_path, capsys, monkeypatch
):
    from airlight.app.sequence import farm as sequence_farm

    image = FrameMaker.image

    def doubtful(self, frame):
        made = image(self, frame)
        made.radiance[frame, 0] = np.nan
        return made

    def here(address, plan, scene, frames, take):
        sent = sequence_farm._Sent(plan, scene)
        for frame in reversed(frames):
            take(frame, *sequence_farm._made(sent, frame))
        sequence_farm._MAKER.pop()[1].close()

    monkeypatch.setattr(FrameMaker, "image", doubtful)
    assert sequence(scene, tmp_path / "local", "--frames", "2") == 0
    local = capsys.readouterr().err.splitlines()
    warned = [line for line in local if line.startswith("warning: ")]
    assert [line[:39] for line in warned] == [
        "warning: frame 0: 1 of 384 pixels are N",
        "warning: frame 1: 1 of 384 pixels are N",
    ]
    monkeypatch.setattr(sequence_farm, "farm_frames", here)
    monkeypatch.setattr(sequence_farm, "check_farm", lambda address: None)
    assert sequence(scene, tmp_path / "farmed", "--frames", "2", "--farm", "tcp://there:1") == 0
    assert capsys.readouterr().err.splitlines() == local


def test_a_worker_makes_frames_one_maker_for_all(gpu, scene):
    from airlight.app.sequence import farm as sequence_farm
    from airlight.scene.io import load

    plan = Plan("direct", (24, 16), 0.0, 10.0, 0, 9, settings={"surfels": "500"}, samples=1)
    sent = sequence_farm._Sent(plan, load(scene))
    data, device, _ = sequence_farm._made(sent, 3)
    (kept,) = sequence_farm._MAKER
    assert device == gpu.info.name and data == sequence_farm._made(sent, 3)[0]
    assert [kept] == sequence_farm._MAKER
    with closing(FrameMaker(plan, load(scene))) as maker:
        assert maker.encoded(3) == data
    kept[1].close()
    sequence_farm._MAKER.clear()
    assert not [p for p in Path.cwd().glob("frame*")]
