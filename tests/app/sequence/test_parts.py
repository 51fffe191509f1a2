"""What a sequence is asked to be, the folder it is in, its progress and its video."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys

import numpy as np
import PIL.Image
import pytest

from airlight.app.sequence.folder import FrameFolder, sweep_video
from airlight.app.sequence.plan import Plan, digest, frame_span
from airlight.app.sequence.progress import Lines, counted
from airlight.errors import OutputError, SettingsError
from airlight.scene import Scene
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.tracks import CameraTrack
from airlight.scene.io.ledger import note_read, recorded


def moving(start_s=0.0, end_s=2.5, fps=24.0):
    track = CameraTrack({"fov_y_deg": Curve(np.array([0.0, 9.0]), np.array([[40.0], [50.0]]))})
    return Scene(animation=Animation((track,), start_s=start_s, end_s=end_s, fps=fps), name="trip")


def plan_of(scene, first=0, last=3, **more):
    start, fps, *_ = frame_span(scene, None, None, None, None)
    return Plan("direct", (8, 4), start, fps, first, last, **more)


@pytest.mark.parametrize(
    ("frames", "start", "end", "fps", "expected"),
    [
        (None, None, None, None, (0.0, 24.0, 0, 59)),  # 2.5 s; the frame at its end is not shown
        (None, None, None, 10.0, (0.0, 10.0, 0, 24)),
        (None, 1.0, None, 10.0, (1.0, 10.0, 0, 14)),
        (None, 0.0, 0.25, 10.0, (0.0, 10.0, 0, 2)),
        (None, 0.0, 0.01, 10.0, (0.0, 10.0, 0, 0)),
        ("60", None, None, 30.0, (0.0, 30.0, 0, 59)),
        ("100", None, None, None, (0.0, 24.0, 0, 99)),
        ("10-20", None, None, None, (0.0, 24.0, 10, 20)),
        ("7-7", None, 1.0, None, (0.0, 24.0, 7, 7)),
    ],
)
def test_frames_are_counted_from_the_start(frames, start, end, fps, expected):
    assert frame_span(moving(), frames, start, end, fps) == expected


@pytest.mark.parametrize(
    ("frames", "start", "end", "message"),
    [
        ("ten", None, None, "--frames 'ten' is neither a number nor written as A-B"),
        ("0", None, None, "--frames 0 asks for nothing"),
        ("9-3", None, None, "--frames 9-3 runs backwards"),
        ("3", None, 1.0, "--frames and --end both say where it ends. Use one, or --frames A-B."),
        ("0-99", None, 1.0, "--frames 0-99 goes beyond the last frame, 23"),
        (None, 3.0, None, "the end at 2.5 s is not after the start at 3 s"),
        ("2000000", None, None, "2000000 frames are too many. At most 1000000."),
    ],
)
def test_impossible_frames_are_refused(frames, start, end, message):
    with pytest.raises(SettingsError) as caught:
        frame_span(moving(), frames, start, end, None)
    assert str(caught.value) == message


def test_a_scene_where_nothing_moves_is_refused():
    with pytest.raises(SettingsError, match=r"nothing moves in 'scene'\. Add keyframes to its"):
        frame_span(Scene(), None, None, None, None)


def test_what_is_asked_leaves_out_which_frames():
    scene = moving()
    asked = plan_of(scene).asked(scene)
    assert plan_of(scene, 2, 9).asked(scene) == asked
    assert plan_of(scene, samples=2).asked(scene) != asked
    assert plan_of(scene, settings={"resolution": 4}).asked(scene) != asked
    assert plan_of(moving(fps=25.0)).asked(moving(fps=25.0))["scene"] != asked["scene"]
    assert json.loads(json.dumps(asked)) == asked
    assert digest(asked) == digest(dict(reversed(asked.items())))


ASKED = {"scene": "abc", "technique": "lpv", "size": (8, 4)}


def opened(path, *, resume=False, **changes):
    folder = FrameFolder(path)
    folder.open({**ASKED, **changes}, resume=resume)
    return folder


def frame_in(folder, plan, frame):
    """The bytes of an image that is now among the frames."""
    path = folder.file(plan, frame)
    PIL.Image.fromarray(np.zeros((4, 8, 3), np.uint8)).save(path)
    return path.read_bytes()


def test_a_folder_knows_what_is_missing_and_drops_what_is_half_written(tmp_path):
    plan = plan_of(moving())
    folder = opened(tmp_path / "out")
    assert folder.missing(plan) == [0, 1, 2, 3]
    frame_in(folder, plan, 1)
    folder.file(plan, 2).touch()  # empty: lost by a crash of the machine
    folder.file(plan, 3).write_bytes(frame_in(folder, plan, 0)[:-7])  # cut off by someone
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    half = folder.path / f".frame-00003.{gone.pid}.part.png"
    half.write_bytes(b"pict")
    own = folder.path / f".frame-00002.{os.getpid()}.part.png"
    own.touch()
    other = folder.path / "notes.txt"
    other.touch()
    assert opened(tmp_path / "out", resume=True).missing(plan) == [2, 3]
    assert own.exists() and other.exists()
    assert half.exists() == (os.name != "posix")


@pytest.mark.skipif(os.name != "posix", reason="whether a process lives is not known")
def test_half_videos_of_killed_runs_go_and_others_stay(tmp_path):
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    half = tmp_path / f".a.{gone.pid}.part.mp4"
    others = {f".a.{os.getpid()}.part.mp4", f".b.{gone.pid}.part.mp4", "a.mp4", "a.1.part.mp4"}
    for name in (half.name, *others):
        (tmp_path / name).touch()
    sweep_video(tmp_path / "a.mp4")
    assert {file.name for file in tmp_path.iterdir()} == others


def test_a_folder_without_frames_is_begun_again(tmp_path):
    opened(tmp_path / "out")
    assert opened(tmp_path / "out", technique="pop").manifest["asked"]["technique"] == "pop"


@pytest.mark.parametrize(
    ("prepare", "changes", "resume", "message"),
    [
        (
            None,
            {},
            False,
            ": holds a sequence already (1 frames). Go on with it by --resume, or "
            "choose another folder.",
        ),
        (
            None,
            {"technique": "pop"},
            True,
            ': holds another sequence: its technique is "lpv", '
            'here it is "pop". Choose another folder, or delete '
            "this one.",
        ),
        (
            None,
            {"scene": "abd"},
            True,
            ": holds another sequence: the scene, or a file it names, "
            "has changed. Choose another folder, or delete this one.",
        ),
        (
            "damage",
            {},
            True,
            "/sequence.json: is damaged. Choose another folder, or delete this one.",
        ),
        (
            "remove",
            {},
            True,
            ": holds frame-00001.png, but no sequence.json that says what it "
            "shows. Choose another folder, or delete this one.",
        ),
    ],
)
def test_sequences_never_mix(tmp_path, prepare, changes, resume, message):
    path = tmp_path / "out"
    folder = opened(path)
    frame_in(folder, plan_of(moving()), 1)
    if prepare == "damage":
        (path / "sequence.json").write_text('{"asked": ')
    elif prepare == "remove":
        (path / "sequence.json").unlink()
    with pytest.raises(OutputError) as caught:
        opened(path, resume=resume, **changes)
    assert str(caught.value) == f"{path}{message}"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "7",
        '{"asked": []}',
        '{"asked": {}, "devices": [1]}',
        "[" * 100_000,
        '{"asked": {}, "devices": 3}',
        '{"asked": {}, "metered_stops": "far"}',
        "9" * 5000,
        '{"asked": {}, "metered_stops": NaN}',
        '{"asked": {}, "metered_stops": 1e99}',
        "\xff",
    ],
)
def test_a_damaged_manifest_is_one_message(tmp_path, text):
    path = tmp_path / "out"
    path.mkdir()
    (path / "sequence.json").write_text(text, encoding="latin-1")
    with pytest.raises(OutputError, match=r"sequence\.json: is damaged\. Choose another folder"):
        opened(path, resume=True)
    assert (path / "sequence.json").read_text(encoding="latin-1") == text


def test_a_manifest_without_end_is_not_waited_for_nor_shown(tmp_path):
    path = tmp_path / "out"
    path.mkdir()
    if hasattr(os, "mkfifo"):
        os.mkfifo(path / "sequence.json")
        with pytest.raises(OutputError, match="is damaged"):
            opened(path, resume=True)
        (path / "sequence.json").unlink()
    long = {"asked": {**ASKED, "technique": "x" * 10_000}}
    (path / "sequence.json").write_text(json.dumps(long))
    with pytest.raises(OutputError) as caught:
        opened(path, resume=True)
    assert len(str(caught.value)) < 500


def test_clearing_up_leaves_what_is_not_ours(tmp_path):
    plan = plan_of(moving())
    folder = opened(tmp_path / "out.mp4.frames")
    frame_in(folder, plan, 0)
    (folder.path / "notes.txt").touch()
    folder.clear()
    assert [file.name for file in folder.path.iterdir()] == ["notes.txt"]
    (folder.path / "notes.txt").unlink()
    folder.clear()
    assert not folder.path.exists()
    folder.clear()


def test_a_frame_that_is_an_input_is_no_output(tmp_path):
    plan = plan_of(moving())
    folder = opened(tmp_path / "out")
    folder.file(plan, 2).write_bytes(b"someone's texture")
    with recorded():
        note_read(folder.file(plan, 2))
        with pytest.raises(OutputError, match=r"frame-00002\.png: the command reads this file"):
            folder.missing(plan)


def test_folders_that_cannot_be_are_refused(tmp_path, monkeypatch):
    with pytest.raises(OutputError, match=r"the folder '.*no' does not exist\. Create it first"):
        opened(tmp_path / "no" / "out")
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="is a file, not a folder for frames"):
        opened(tmp_path / "file")
    with pytest.raises(OutputError, match="cannot be made"):
        opened(tmp_path / ("x" * 300))

    def denied(*args, **named):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.mkdir", denied)
    with pytest.raises(OutputError, match=r"out: cannot be made \(Permission denied\)"):
        opened(tmp_path / "out")


def test_lines_say_how_long_it_will_take(capsys):
    now = [0.0]
    lines = Lines("frames", 10, 2, lambda: now[0])
    for second in (4.0, 6.0, 15.0, 16.0, 100.0, 101.0, 102.0, 4000.0):
        now[0] = second
        lines.count()
    assert capsys.readouterr().err.splitlines() == [
        "2 of 10 frames were there",
        "3 of 10 frames, 28 s left",
        "5 of 10 frames, 25 s left",
        "7 of 10 frames, 1 min 0 s left",
        "10 of 10 frames in 1 h 6 min",
    ]


def test_progress_can_be_quiet_and_has_a_bar_on_terminals(capsys, monkeypatch):
    with counted("frames", 2, quiet=True) as count:
        count()
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    with counted("frames", 2) as count:
        count()
        count()


def write_frames(folder, count, size=(31, 18)):
    """Images of one grey each, with a red corner."""
    files = []
    for k in range(count):
        pixels = np.full((size[1], size[0], 3), 40 * k + 30, np.uint8)
        pixels[:8, :8] = (200, 30, 40)
        files.append(folder / f"{k}.png")
        PIL.Image.fromarray(pixels).save(files[-1])
    return files


@pytest.mark.needs("av")
def test_a_video_shows_every_frame_in_its_colours(tmp_path):
    import av

    from airlight.app.sequence.video import video_comment, write_video

    path, shares = tmp_path / "out.mp4", []
    write_video(write_frames(tmp_path, 5), 12.5, path, "told", shares.append)
    assert shares == [0.2, 0.4, 0.6, 0.8, 1.0]
    assert video_comment(path) == "told"
    assert not list(tmp_path.glob(".*"))
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert (stream.width, stream.height) == (32, 18)  # sides are even
        assert float(stream.average_rate) == 12.5
        assert stream.codec_context.color_range == 1 and stream.codec_context.colorspace == 1
        shown = [
            frame.to_ndarray(format="rgb24", src_colorspace=1) for frame in container.decode(stream)
        ]
    assert len(shown) == 5
    for k, pixels in enumerate(shown):
        assert abs(int(pixels[14, 20, 1]) - (40 * k + 30)) <= 3
        np.testing.assert_allclose(pixels[3, 3], (200, 30, 40), atol=14)


@pytest.mark.needs("av")
def test_a_video_of_broken_frames_is_refused_whole(tmp_path):
    from airlight.app.sequence.video import video_comment, write_video

    files = write_frames(tmp_path, 3)
    files[1].write_bytes(files[1].read_bytes()[:60])
    with pytest.raises(OutputError, match=r"1\.png: is not a whole image .* by --resume"):
        write_video(files, 24.0, tmp_path / "out.mp4", "")
    assert not (tmp_path / "out.mp4").exists() and not list(tmp_path.glob(".*"))
    assert video_comment(tmp_path / "out.mp4") == "" == video_comment(files[0])


@pytest.mark.parametrize(
    ("package", "check", "given", "message"),
    [
        (
            "av",
            "airlight.app.sequence.video:check_video",
            (),
            "videos need the package 'av'. pip install 'airlight[video]', or give a folder for "
            "frames.",
        ),
        (
            "distributed",
            "airlight.app.sequence.farm:check_farm",
            ("tcp://127.0.0.1:8786",),
            "--farm needs the package 'distributed'. pip install 'airlight[farm]'.",
        ),
    ],
)
def test_missing_packages_are_named(monkeypatch, package, check, given, message):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *a: None if name == package else find(name, *a)
    )
    module, _, name = check.partition(":")
    with pytest.raises(SettingsError) as caught:
        getattr(importlib.import_module(module), name)(*given)
    assert str(caught.value) == message


_VIDEO_UNDER_A_LIMIT = """
import resource, sys
from pathlib import Path
from airlight.app.sequence.video import write_video
from airlight.errors import OutputError
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
try:
    write_video([Path(name) for name in sys.argv[3:]], 24.0, Path(sys.argv[2]), "told")
except OutputError as error:
    print(error)
"""


@pytest.mark.needs("av")
@pytest.mark.skipif(os.name != "posix", reason="RLIMIT_FSIZE")
@pytest.mark.parametrize("limit", [0, 9000])
def test_a_disk_that_fills_under_a_video_leaves_the_old_one(tmp_path, limit):
    files = []
    for k in range(4):
        files.append(tmp_path / f"{k}.png")
        noise = np.random.default_rng(k).integers(0, 256, (48, 64, 3), np.uint8)
        PIL.Image.fromarray(noise).save(files[-1])
    (tmp_path / "out").mkdir()
    path = tmp_path / "out" / "a.mp4"
    path.write_bytes(b"the old one")
    done = subprocess.run(
        [sys.executable, "-c", _VIDEO_UNDER_A_LIMIT, str(limit), str(path), *map(str, files)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == (
        f"{path}: the video cannot be written (File too large). The frames are kept; check the "
        "free space, and go on by --resume.\n"
    )
    assert [file.name for file in path.parent.iterdir()] == ["a.mp4"]
    assert path.read_bytes() == b"the old one"
