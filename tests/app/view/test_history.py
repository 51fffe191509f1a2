"""Undo and redo go through what was noted when a hand came to rest."""

from __future__ import annotations

from dataclasses import replace

from airlight.app.view.history import History
from airlight.app.view.state import ViewState
from airlight.scene.builtin.cornell import cornell


def changed(state: ViewState, name: str) -> None:
    state.scene = replace(state.scene, name=name)


def test_changes_are_taken_back_one_by_one_and_come_again():
    state = ViewState(cornell())
    first, history = state.scene, History(state)
    changed(state, "one")
    history.note(state)
    history.note(state)  # nothing new
    state.technique, state.settings = "direct", {"direct": {"resolution": 8}}
    history.undo(state)  # notes by itself what no rest has noted
    assert (state.technique, state.scene.name, state.settings) == ("auto", "one", {})
    history.undo(state)
    assert state.scene is first
    assert not history.can_undo
    history.undo(state)
    assert state.scene is first
    history.redo(state)
    history.redo(state)
    assert (state.technique, state.settings) == ("direct", {"direct": {"resolution": 8}})
    assert not history.can_redo


def test_another_change_forgets_what_was_taken_back():
    state = ViewState(cornell())
    history = History(state)
    changed(state, "one")
    history.note(state)
    history.undo(state)
    changed(state, "two")
    history.note(state)
    assert not history.can_redo
    history.undo(state)
    history.redo(state)
    assert state.scene.name == "two"


def test_which_light_is_chosen_is_no_change():
    state = ViewState(cornell())
    history = History(state)
    state.light = state.picked = 3
    history.note(state)
    assert not history.can_undo


def test_settings_that_were_kept_are_not_those_that_change():
    state = ViewState(cornell(), settings={"auto": {"resolution": 8}})
    history = History(state)
    state.settings["auto"]["resolution"] = 16
    history.note(state)
    history.undo(state)
    assert state.settings["auto"] == {"resolution": 8}
