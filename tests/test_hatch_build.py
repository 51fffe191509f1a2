"""A built package's README stands alone: on a package index no link may need the repository."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from scripts import script

ROOT = Path(__file__).parents[1]
URL = "https://example.org/owner/airlight"

pytestmark = pytest.mark.needs("hatchling")


@pytest.fixture
def made(monkeypatch):
    """The table [project] as it is built, with the repository's address and without."""
    module = script(ROOT / "hatch_build.py")

    def make(url: str) -> dict:
        monkeypatch.setenv("AIRLIGHT_URL", url)
        metadata: dict = {}
        module.AirlightMetadata(str(ROOT), {}).update(metadata)
        return metadata

    return make


def test_links_are_absolute_and_lead_to_files_that_there_are(made):
    text = made(f"{URL}/")["readme"]["text"]
    targets = re.findall(r"\]\(([^)\s]+)\)", text)
    own = [target for target in targets if target.startswith(URL)]
    assert all(target.startswith(("https://", "#")) for target in targets)
    assert len(own) > 10
    for target in own:
        view, path = re.match(rf"{URL}/(raw|blob)/HEAD/([^#]+)", target).groups()
        assert (ROOT / path).exists(), target
        assert (view == "raw") == path.endswith(".jpg"), target


def test_without_an_address_nothing_is_invented(made):
    metadata = made("")
    assert metadata["readme"]["text"] == (ROOT / "README.md").read_text("utf-8")
    assert "urls" not in metadata
    assert set(made(URL)["urls"]) == {"Repository", "Documentation", "Changelog", "Issues"}
