"""What a built package says of itself: README.md with links that lead somewhere from anywhere.

    AIRLIGHT_URL=https://github.com/OWNER/airlight python -m build

On a package index the README stands alone, where `docs/install.md` leads nowhere. With
AIRLIGHT_URL, the address of the repository, its links and images become absolute and the project
has its URLs; without it (installing from a clone) both stay as they are.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_LINK = re.compile(r"(?P<image>!?)\[(?P<text>[^\]]*)\]\((?!https?:|mailto:|#)(?P<path>[^)\s]+)\)")


def absolute(text: str, url: str) -> str:
    """Markdown with links to files of the repository at `url` in the place of relative ones."""

    def led(link: re.Match[str]) -> str:
        view = "raw" if link["image"] else "blob"
        return f"{link['image']}[{link['text']}]({url}/{view}/HEAD/{link['path']})"

    return _LINK.sub(led, text)


def urls(url: str) -> dict[str, str]:
    """The project's URLs, as a package index lists them."""
    return {
        "Repository": url,
        "Documentation": f"{url}/blob/HEAD/docs/index.md",
        "Changelog": f"{url}/blob/HEAD/CHANGELOG.md",
        "Issues": f"{url}/issues",
    }


class AirlightMetadata(MetadataHookInterface):
    """Fills in `readme` and `urls` of pyproject.toml."""

    def update(self, metadata: dict[str, Any]) -> None:
        """hatchling calls it with the table [project]."""
        url = os.environ.get("AIRLIGHT_URL", "").rstrip("/")
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        readme = absolute(text, url) if url else text
        metadata["readme"] = {"content-type": "text/markdown", "text": readme}
        if url:
            metadata["urls"] = urls(url)
