"""`airlight sequence`: a moving scene as frames or as a video.

plan -> frames  which frames, and when; one of them as an image
-> folder, video  stored whole or not at all; whole: which are there already
farm, scheduler  frames on a dask cluster       progress  how long it will take
cli  the command and its options
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
