"""Tries files whose paths come line by line, and answers each with a line of JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from airlight.errors import AirlightError
from airlight.rendering import render
from airlight.scene.io import load

SIZE = (48, 27)


def tried(path: Path) -> dict[str, Any]:
    """What comes of a file: an image, or a refusal's words; any other error is a find."""
    try:
        scene = load(path)
        if not (scene.meshes or scene.volumes or scene.medium):
            return {"outcome": "empty", "words": "", "warnings": list(scene.warnings)}
        image = render(scene, "direct", SIZE, samples=1)
    except AirlightError as error:
        return {"outcome": "refused", "words": str(error), "warnings": []}
    except Exception as error:
        return {"outcome": "find", "words": f"{type(error).__name__}: {error}", "warnings": []}
    seen = image.radiance
    is_image = bool(np.isfinite(seen).all() and float(np.ptp(seen)) > 0.0)
    return {
        "outcome": "image" if is_image else "blank",
        "words": "",
        "warnings": list(scene.warnings),
    }


def main() -> None:
    """Answer until there are no more lines."""
    for line in sys.stdin:
        print(json.dumps(tried(Path(line.rstrip("\n")))), flush=True)


if __name__ == "__main__":
    main()
