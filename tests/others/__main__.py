"""`./run others FOLDER [--write]`: try files of others, and compare with the list."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

from .trial import command, models, read_rows, tried, write_rows


def main() -> int:
    """1 where something came out otherwise than the list has it."""
    parser = argparse.ArgumentParser(prog="./run others", description=__doc__)
    parser.add_argument("folder", type=Path, help="with a clone OWNER+NAME of each repository")
    parser.add_argument("--write", action="store_true", help="take what comes out into the list")
    parser.add_argument("--only", default="", help="files whose place has this in it")
    asked = parser.parse_args()
    folder = asked.folder.resolve()
    known = {row.place: row for row in read_rows()}
    files = [(name, path) for name, path in models(folder) if asked.only in str(path)]
    changed, counts = 0, Counter[str]()
    for row in tried(folder, files, command()):
        before = known.get(row.place)
        counts[row.outcome] += 1
        known[row.place] = row
        if asked.write:  # as it goes: it may take an hour
            write_rows(known.values())
        if before is None or (before.outcome, before.words) != (row.outcome, row.words):
            changed += 1
            was = f" (was {before.outcome}: {before.words})" if before else " (new)"
            print(f"{row.place}: {row.outcome}: {row.words}{was}", flush=True)
    print(", ".join(f"{count} {outcome}" for outcome, count in counts.most_common()))
    return int(changed > 0 and not asked.write)


if __name__ == "__main__":
    sys.exit(main())
