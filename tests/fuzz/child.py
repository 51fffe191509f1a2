"""Many inputs in one process of limited memory: what the fuzzer starts, and nobody else.

It takes loader, seed, first number and count from its command line. Each number is written to
stdout as it begins, so that the parent knows which one killed it; failures follow as lines of JSON.
"""

from __future__ import annotations

import json
import resource
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

MEMORY_BYTES = 3 << 30
"""Address space beyond what the process has once airlight is imported."""


def limit_memory() -> None:
    """This process may take no more than MEMORY_BYTES from here on; said once, it stays."""
    if resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY:
        return
    held = 0
    statm = Path("/proc/self/statm")
    if statm.exists():
        held = int(statm.read_text().split()[0]) * resource.getpagesize()
    most = held + MEMORY_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def main(loader: str, seed: int, first: int, count: int) -> None:
    """Try inputs `first` to `first + count` of a loader."""
    from .targets import case
    from .trial import Ground

    with tempfile.TemporaryDirectory() as folder:
        ground = Ground(Path(folder))
        limit_memory()
        out = sys.stdout
        for number in range(first, first + count):
            out.write(f"{number}\n")
            out.flush()
            failure = ground.attempt(case(loader, seed, number))
            if failure is not None:
                out.write(json.dumps({"number": number, **asdict(failure)}) + "\n")
                out.flush()
                if failure.kind in ("memory", "time"):
                    return  # what it left behind would be blamed on those after it


if __name__ == "__main__":
    main(sys.argv[1], *(int(word) for word in sys.argv[2:5]))
