"""`airlight compare`: techniques beside an unbiased reference.

reference  rendered once, then cached -> judging  each technique rendered and scored -> result
-> images  differences and FLIP maps -> page, style  one HTML file; cli: the command
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
