"""`airlight bench`: what frames cost, where, and how that grows.

    cli -> each part measures: frames, child, growth, pop, kernel, rays -> numbers -> tables, JSON

frames  scenes in steady state, per stage      child   the first image, in a process of its own
growth  cells, lights, triangles, ...          pop     the stages of Elek2014
kernel  propagation beside hand-written C      rays    what a ray costs
tables  all of it for a terminal or a page     cli     which of it is measured
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
