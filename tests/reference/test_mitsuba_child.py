"""What a child process can do wrong becomes one ReferenceFailure."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.errors import ReferenceFailure
from airlight.reference import mitsuba, mitsuba_child
from airlight.reference.mitsuba_child import LlvmFailure, run_job
from airlight.reference.mitsuba_process import Job, _Batches, read_job
from airlight.scene import Environment, Scene

pytestmark = pytest.mark.needs("mitsuba")


def job(folder: Path, body: str, **changes) -> Job:
    (folder / "scene.xml").write_text(f'<scene version="3.0.0">{body}</scene>')
    values = {
        "xml": str(folder / "scene.xml"),
        "result": str(folder / "result.npz"),
        "variant": "scalar_rgb",
        "layers": ("all",),
        "integrator": "path",
        "width": 4,
        "height": 4,
        "spp": 4,
        "seed": 0,
    }
    return Job(**{**values, **changes})


def test_a_job_survives_its_file(tmp_path: Path) -> None:
    written = job(tmp_path, "", hide_environment=True)
    written.write(tmp_path / "job.json")
    assert read_job(tmp_path / "job.json") == written


def test_a_refused_scene_gives_mitsubas_own_words(tmp_path: Path) -> None:
    body = (
        '<integrator type="path"><integer name="max_depth" value="$max_depth"/></integrator>'
        '<film type="hdrfilm"><integer name="width" value="$width"/>'
        '<integer name="height" value="$height"/></film><shape type="nonsense"/>'
    )
    with pytest.raises(ReferenceFailure) as caught:
        run_job(job(tmp_path, body), tmp_path, timeout_s=60, progress=None)
    assert str(caught.value).startswith("Mitsuba refused the scene: ")
    assert "nonsense" in str(caught.value)


def test_a_crash_is_told_with_its_signal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    crash = tmp_path / "crash" / "airlight" / "reference"
    crash.mkdir(parents=True)
    for folder in (crash, crash.parent):
        (folder / "__init__.py").touch()
    (crash / "mitsuba_process.py").write_text(
        "import os, sys\nprint('ready', flush=True)\nprint('last words', file=sys.stderr)\n"
        "sys.stderr.flush()\nos.abort()\n"
    )
    import os

    monkeypatch.setattr(
        mitsuba_child, "_environment", lambda: {**os.environ, "PYTHONPATH": str(tmp_path / "crash")}
    )
    with pytest.raises(ReferenceFailure) as caught:
        run_job(job(tmp_path, ""), tmp_path, timeout_s=60, progress=None)
    assert str(caught.value) == "Mitsuba crashed (SIGABRT): last words"

    # The same before it got ready, in a compiled variant, is LLVM's doing.
    process = crash / "mitsuba_process.py"
    process.write_text(process.read_text().replace("print('ready', flush=True)\n", ""))
    with pytest.raises(LlvmFailure, match="its LLVM does not work"):
        run_job(job(tmp_path, "", variant="llvm_ad_rgb"), tmp_path, timeout_s=60, progress=None)


def test_a_broken_llvm_falls_back_to_the_scalar_variant(monkeypatch: pytest.MonkeyPatch) -> None:
    real = mitsuba.run_job
    tried: list[str] = []

    def run(job: Job, *arguments, **options):
        tried.append(job.variant)
        if job.variant == "llvm_ad_rgb":
            raise LlvmFailure("it does not work")
        return real(job, *arguments, **options)

    monkeypatch.setattr(mitsuba, "run_job", run)
    monkeypatch.setattr(mitsuba, "choose_variant", lambda said: "llvm_ad_rgb")
    image = mitsuba.render(Scene(environment=Environment()), size=(4, 4), spp=4)
    assert tried == ["llvm_ad_rgb", "scalar_rgb"]
    assert image.stats["variant"] == "scalar_rgb"
    assert image.radiance.mean() == pytest.approx(1.0)


def test_samples_that_are_no_numbers_cost_their_batch(tmp_path: Path) -> None:
    """The mean is that of a pixel's other batches; what has none stays none."""
    sums = _Batches(job(tmp_path, ""))
    images = np.random.default_rng(1).random((4, 4, 4, 3), np.float32)
    images[2, 0, 1] = np.nan
    images[:, 3, 3, 0] = np.inf
    for image in images:
        sums._add({"all": image, "direct": image})
    found = sums.results()
    others = images[[0, 1, 3], 0, 1].astype(np.float64)
    np.testing.assert_allclose(found["all"][0, 1], others.mean(axis=0), rtol=1e-6)
    spread = others.var(axis=0, ddof=1) / 3.0
    np.testing.assert_allclose(found["direct.variance"][0, 1], spread, rtol=1e-5)
    np.testing.assert_allclose(found["all"][1], images[:, 1].mean(axis=0), rtol=1e-5)
    assert np.isnan(found["all"][3, 3]).all() and sums.left_out == 1
