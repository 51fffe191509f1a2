"""Files are written whole, into their places and nowhere else, or the reason is said."""

from __future__ import annotations

import os
import socket
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from airlight.errors import OutputError
from airlight.scene.io.ledger import note_read, recorded
from airlight.scene.io.writing import check_target, whole_file

posix = pytest.mark.skipif(os.name != "posix", reason="devices, owners and modes of POSIX")
not_root = pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere"
)


def write(path: Path, content: bytes = b"new") -> None:
    with whole_file(path) as part:
        part.write_bytes(content)


def test_a_file_appears_whole(tmp_path):
    path = tmp_path / "a.png"
    with whole_file(path) as part:
        part.write_bytes(b"new")
        assert not path.exists()
        assert part.suffix == ".png"
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(b"old")
    full = pytest.raises(OutputError, match=r"cannot be written \(No space left on device\)")
    with full, whole_file(path) as part:
        part.write_bytes(b"ne")
        raise OSError(28, "No space left on device")
    with pytest.raises(KeyError), whole_file(path):
        raise KeyError
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_places_that_cannot_be_written(tmp_path):
    absent = pytest.raises(OutputError, match=r"does not exist\. Create it first\.")
    with absent, whole_file(tmp_path / "no" / "a.png"):
        pass
    with pytest.raises(OutputError, match="this is a folder"), whole_file(tmp_path):
        pass


@not_root
def test_a_folder_without_permission(tmp_path):
    tmp_path.chmod(0o500)
    try:
        refused = pytest.raises(OutputError, match="Choose another folder")
        with refused, whole_file(tmp_path / "a.png"):
            pass
    finally:
        tmp_path.chmod(0o700)


@posix
def test_permissions_are_those_of_the_file_that_is_replaced(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(b"old")
    path.chmod(0o640)
    write(path)
    assert path.read_bytes() == b"new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    fresh = tmp_path / "b.png"
    write(fresh)
    beside = tmp_path / "c.png"
    beside.touch()
    assert fresh.stat().st_mode == beside.stat().st_mode  # the user's own umask


@not_root
def test_a_write_protected_file_is_left_alone(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(b"old")
    path.chmod(0o444)
    with pytest.raises(OutputError, match="write-protected"):
        write(path)
    assert path.read_bytes() == b"old"


@posix
def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "there").mkdir()
    real, link = tmp_path / "there" / "real.png", tmp_path / "link.png"
    link.symlink_to(real)
    write(link, b"1")  # through a link to nothing, too
    write(link, b"2")
    assert link.is_symlink()
    assert real.read_bytes() == b"2"
    assert list((tmp_path / "there").iterdir()) == [real]
    loop = tmp_path / "loop.png"
    loop.symlink_to(loop)
    with pytest.raises(OutputError, match="cannot be written"):
        write(loop)
    (tmp_path / "lost.png").symlink_to(tmp_path / "no" / "a.png")
    with pytest.raises(OutputError, match=r"the folder '.*no' does not exist"):
        write(tmp_path / "lost.png")


@pytest.mark.parametrize("length", [200, 250, 255])
def test_names_as_long_as_they_can_be(tmp_path, length):
    path = tmp_path / ("x" * (length - 4) + ".png")
    write(path)
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    write(tmp_path / ("a." + "y" * (length - 2)))


@pytest.mark.parametrize("name", ["x" * 252 + ".png", "x" * 296 + ".png", "x" * 9000, "a\0b"])
def test_names_that_are_too_long_or_none(tmp_path, name):
    with pytest.raises(OutputError, match="cannot be written"):
        check_target(tmp_path / name)
    with pytest.raises(OutputError, match="cannot be written"):
        write(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@posix
def test_pipes_sockets_and_disks_are_refused_and_stay(tmp_path):
    pipe = tmp_path / "pipe.png"
    os.mkfifo(pipe)
    with pytest.raises(OutputError, match=r"this is a pipe, not a file\. Name a file, /dev/null"):
        write(pipe)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    with socket.socket(socket.AF_UNIX) as bound:
        folder = os.open(tmp_path, os.O_RDONLY)
        bound.bind(f"/proc/self/fd/{folder}/s" if sys.platform == "linux" else str(tmp_path / "s"))
        os.close(folder)
        with pytest.raises(OutputError, match="this is a socket"):
            write(tmp_path / "s")


@posix
def test_devices_and_descriptors_are_written_through(tmp_path, monkeypatch):
    write(Path("/dev/null"))
    link = tmp_path / "null.png"
    link.symlink_to("/dev/null")
    check_target(link)
    write(link)
    assert stat.S_ISCHR(link.stat().st_mode)
    if Path("/dev/full").exists():
        with pytest.raises(OutputError, match=r"/dev/full: cannot be written \(No space left"):
            write(Path("/dev/full"))
    reading, writing = os.pipe()
    write(Path(f"/dev/fd/{writing}"), b"through")
    os.close(writing)
    with os.fdopen(reading, "rb") as stream:
        assert stream.read() == b"through"


@posix
def test_standard_output_comes_in_order_with_what_was_said(tmp_path):
    code = (
        "from pathlib import Path; from airlight.scene.io.writing import whole_file\n"
        "print('before')\n"
        "with whole_file(Path('/dev/stdout')) as part: part.write_text('it\\n')\n"
        "print('after')"
    )
    with (tmp_path / "out").open("wb") as out:
        subprocess.run([sys.executable, "-c", code], stdout=out, check=True)
    assert (tmp_path / "out").read_text() == "before\nit\nafter\n"


@posix
def test_a_stale_or_foreign_part_is_not_followed(tmp_path):
    victim = tmp_path / "victim"
    victim.write_bytes(b"mine")
    (tmp_path / f".a.{os.getpid()}.part.png").symlink_to(victim)
    write(tmp_path / "a.png")
    assert victim.read_bytes() == b"mine"


@posix
def test_a_disk_that_fills_while_writing_leaves_the_old_file(tmp_path):
    import resource

    path = tmp_path / "a.bin"
    path.write_bytes(b"old")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, hard))
    try:
        with pytest.raises(OutputError, match=r"a\.bin: cannot be written \(File too large\)"):
            write(path, bytes(2 << 20))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_what_was_read_is_not_written(tmp_path):
    path = tmp_path / "a.exr"
    path.write_bytes(b"old")
    with recorded():
        note_read(path)
        for refused in (check_target, write):
            with pytest.raises(OutputError, match="the command reads this file"):
                refused(path)
    assert path.read_bytes() == b"old"
    write(path)  # outside it is a program's own affair
