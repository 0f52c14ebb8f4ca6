"""An FMU that ends the process it runs in: that run has a row that says so, and the others have theirs"""

import subprocess
import zipfile

import pyarrow.parquet as pq
import pytest

from support.sources import BUILD, ROOT, fmi_headers
from support.sweeps import sweep

IDLE = ROOT / "scripts" / "tools" / "fmu_host" / "idle"
STUDY = """
outputs = { there = "position[1]" }
fmu = "crashing.fmu"
experiment.stop_time = 1.0
vary."position[1]" = [1.0, 2.0, 3.0]
"""


@pytest.fixture
def crashing(tmp_path):
    """Idle.fmu, but a step from position[1] = 2 aborts"""
    text = (IDLE / "idle_fmu.c").read_text()
    step = "    idle->time = currentCommunicationPoint"
    changed = text.replace(step, f"    if (idle->values[0] == 2.0) abort();\n{step}")
    assert changed != text
    (tmp_path / "crashing.c").write_text(changed)
    library = tmp_path / "Idle.so"
    sources = [tmp_path / "crashing.c", IDLE / "idle_absent.c"]
    options = ["-shared", "-fPIC", "-o", library, "-I", IDLE, "-isystem", fmi_headers()]
    subprocess.run(["gcc", *options, *sources, "-lm"], check=True)
    made = tmp_path / "crashing.fmu"
    with zipfile.ZipFile(BUILD / "Idle.fmu") as idle, zipfile.ZipFile(made, "w") as archive:
        for name in idle.namelist():
            content = library.read_bytes() if name.endswith("Idle.so") else idle.read(name)
            archive.writestr(name, content)
    return made


def test_a_run_that_ends_its_process_is_found_and_kept_as_a_row(tmp_path, crashing):
    study = crashing.with_name("study.toml")
    study.write_text(STUDY)
    said = sweep(study, "-o", tmp_path / "out", "--workers", "1")
    assert "3 runs (2 ok, 1 crash)" in said.stdout
    rows = pq.read_table(tmp_path / "out" / "results.parquet")
    assert rows["status"].to_pylist() == ["ok", "crash", "ok"]
    assert rows.column(2).to_pylist() == [1.0, None, 3.0]
    assert "ended" in rows["message"][1].as_py()
