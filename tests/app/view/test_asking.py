"""The dialog for a file: what is chosen is opened once, a dialog that was shut opens nothing."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from airlight.app.view.asking import Asking, has_dialogs


class Dialog:
    def __init__(self, names: list[str]) -> None:
        self.names, self.is_ready = names, False

    def ready(self, _: int) -> bool:
        return self.is_ready

    def result(self) -> list[str]:
        return self.names


class Dialogs:
    def __init__(self, names: list[str]) -> None:
        self.made, self._names = [], names

    def open_file(self, title: str, folder: str, filters: list[str]) -> Dialog:
        assert "*.toml" in filters[1] and "*.hdr" in filters[1]
        self.made.append(Dialog(self._names))
        return self.made[-1]


def test_what_is_chosen_is_opened_once():
    dialogs, opened = Dialogs(["a.toml"]), []
    asking = Asking(dialogs, opened.append)
    assert not asking.taken()
    asking.ask()
    asking.ask()  # it is open
    assert not asking.taken()
    dialogs.made[0].is_ready = True
    assert asking.taken()
    assert not asking.taken()
    assert (opened, len(dialogs.made)) == (["a.toml"], 1)


def test_a_dialog_that_was_shut_opens_nothing_and_may_open_again():
    dialogs, opened = Dialogs([]), []
    asking = Asking(dialogs, opened.append)
    asking.ask()
    dialogs.made[0].is_ready = True
    assert not asking.taken()
    asking.ask()
    assert (opened, len(dialogs.made)) == ([], 2)


def test_a_library_that_can_be_asked_is_asked():
    for is_so in (True, False):
        settings = SimpleNamespace(available=lambda is_so=is_so: is_so)
        assert has_dialogs(SimpleNamespace(settings=settings)) is is_so


@pytest.mark.parametrize(
    ("platform", "programs", "there"),
    [("linux", (), False), ("linux", ("kdialog",), True), ("win32", (), True)],
)
def test_one_that_cannot_be_asked_needs_a_program_of_the_desktop(
    monkeypatch, platform, programs, there
):
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setattr("shutil.which", lambda name: name if name in programs else None)
    assert has_dialogs(SimpleNamespace()) is there
