"""`./run fuzz`: damaged inputs for every loader, for as long as it is given."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from time import monotonic

from .finds import BATCH, Run, explore, keep, make_small, repeat, told
from .targets import LOADERS


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the fuzzer and return its exit code: 1 where something was found."""
    options = _parser().parse_args(arguments)
    loaders = options.loader or list(LOADERS)
    if options.only is not None:
        return _again(loaders[0], options.seed, options.only, options.keep)
    began = monotonic()
    until = began + 60.0 * options.minutes
    runs = [Run(loader, options.seed, tried=options.first) for loader in loaders]
    while monotonic() < until and (
        options.inputs is None or _tried(runs, options) < options.inputs
    ):
        for run in runs:  # interleaved, so that all get their share of the time
            explore(run, BATCH, until)
    for run in runs:
        print(f"{run.loader}: {run.tried - options.first} inputs, {len(run.finds)} finds")
    finds = [find for run in runs for find in run.finds.values()]
    for find in finds:
        make_small(find)
        print(told(find), flush=True)
        if options.keep:
            keep(find, options.keep)
    seconds = monotonic() - began
    print(f"{_tried(runs, options)} inputs in {seconds:.0f} s: {len(finds)} finds")
    return 1 if finds else 0


def _tried(runs: list[Run], options: argparse.Namespace) -> int:
    return sum(run.tried - int(options.first) for run in runs)


def _again(loader: str, seed: int, number: int, folder: Path | None) -> int:
    made, failure = repeat(loader, seed, number)
    for name, raw in made.files.items():
        print(f"{name} ({len(raw)} bytes): {raw[:400]!r}")
    if folder:
        from .finds import Find

        if failure:
            keep(Find(loader, seed, failure, [number], made), folder)
    print(f"opened by {made.how}: {made.main}")
    if failure is None:
        print("it went as it should")
        return 0
    print(f"{failure.kind} in {failure.where or 'the process'}\n{failure.text}")
    return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="./run fuzz", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="another one gives other inputs")
    parser.add_argument("--minutes", type=float, default=1.0, help="how long to go on")
    parser.add_argument("--inputs", type=int, help="how many to try in all, at most")
    parser.add_argument("--first", type=int, default=0, help="the number to begin with")
    parser.add_argument(
        "--loader",
        action="append",
        choices=list(LOADERS),
        metavar="NAME",
        help=f"only this one, or these: {', '.join(LOADERS)}",
    )
    parser.add_argument("--only", type=int, metavar="NUMBER", help="one input again")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="write what fails below it")
    return parser


if __name__ == "__main__":
    sys.exit(main())
