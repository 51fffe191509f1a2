"""What a page may say to the viewer: events whose values are what the viewer expects of them.

Whatever else comes is dropped: a malformed message must cost neither a traceback nor the session.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

LARGEST_SIDE_PX = 4096
_SERVERS_OWN = ("close", "_clients_change")  # a tab that closes must not end the session
_FARTHEST, _LONGEST_LIST, _LONGEST_TEXT = 1e9, 32, 64
_POINTER = ("x", "y")
_NEEDED = {
    "pointer_down": (*_POINTER, "button"),
    "pointer_up": (*_POINTER, "button"),
    "pointer_move": _POINTER,
    "pointer_enter": (),
    "pointer_leave": (),
    "double_click": _POINTER,
    "wheel": (*_POINTER, "dx", "dy"),
    "key_down": ("key",),
    "key_up": ("key",),
    "char": (),
    "_framefeedback": ("index", "timestamp"),
}


def believed(event: Any) -> dict[str, Any] | None:
    """An event from a page as far as it can be used, sizes within reason; else None."""
    # Messages without a type, and those that only the server may send, are dropped.
    if not isinstance(event, dict) or not isinstance(kind := event.get("type"), str):
        return None
    if kind in _SERVERS_OWN:
        return None
    if kind == "resize":
        return _resize(event)
    # What the event needs has to be there, and each value of its kind.
    if any(key not in event for key in _NEEDED.get(kind, ())):
        return None
    stamped = {"timestamp": 0.0, **event}
    return stamped if all(_is_kind(key, value) for key, value in stamped.items()) else None


def _resize(event: dict[str, Any]) -> dict[str, Any] | None:
    try:
        width, height = (int(event[key]) for key in ("pwidth", "pheight"))
        ratio = float(event["ratio"])
    except (KeyError, TypeError, ValueError, OverflowError):
        return None
    if width < 1 or height < 1 or not 0.1 <= ratio <= 10.0:
        return None  # a tab folded to nothing: the last size stays
    # Sizes beyond a large screen's are cut.
    return {
        **event,
        "pwidth": min(width, LARGEST_SIDE_PX),
        "pheight": min(height, LARGEST_SIDE_PX),
        "ratio": ratio,
    }


def _is_number(value: Any) -> bool:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return is_number and abs(value) <= _FARTHEST and math.isfinite(value)


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= _LONGEST_TEXT


def _is_list(value: Any, holds: Callable[[Any], bool]) -> bool:
    return isinstance(value, list) and len(value) <= _LONGEST_LIST and all(map(holds, value))


def _is_kind(key: str, value: Any) -> bool:
    """Whether a value is of the kind that its key has; keys that are not known may be anything."""
    # Times first, as they are larger than any other number; then kinds by key.
    if key in ("timestamp", "localtime"):  # milliseconds or seconds since 1970
        return isinstance(value, (int, float)) and abs(value) < 1e15
    if key in ("x", "y", "dx", "dy", "button", "index", "ntouches"):
        return _is_number(value)
    if key in ("key", "data", "char_str"):
        return _is_text(value)
    if key == "buttons":
        return _is_list(value, _is_number)
    if key == "modifiers":
        return _is_list(value, _is_text)
    if key == "touches":
        return isinstance(value, dict)
    return True
