"""docs/sweep.md: every key and option is there, and its study and its Python lines run"""

import re
import sys

from contact_fmus.options import commands
from contact_fmus.sweep import store, study
from support.programs import checked
from support.sources import ROOT
from support.sweeps import read, run_here, write_study

PAGE = (ROOT / "docs" / "sweep.md").read_text(encoding="utf-8")


def block(language):
    return re.search(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)[1]


def test_every_word_of_a_study_is_explained():
    words = {*study.REDUCTIONS, *study.METHODS, *study.GRID, *study.SAMPLED, *store.STATUSES, "choices"}
    words |= {
        "title", "fmu", "start_time", "stop_time", "step", "steps", "tolerance", "count", "seed", "method",
    }  # fmt: skip
    assert sorted(word for word in words if not re.search(rf"[`{{ ]{word}\b", PAGE)) == []
    assert sorted(word for word in study.DISTRIBUTIONS if word not in PAGE and word != "uniform") == []


def test_every_option_is_explained():
    options = {n for names in commands()["sweep"]["options"] for n in names.split() if n.startswith("--")}
    assert sorted(options - {"--help", "--output", "--json"} - set(re.findall(r"--[a-z]+", PAGE))) == []


def test_its_study_and_its_python_lines_run(tmp_path, capsys):
    found = read(write_study(tmp_path, block("toml")))
    samples_, rows = found.samples(), run_here(found)[1]
    assert (samples_.runs, rows.status.tolist()) == (200, [0] * 200)
    made = store.Store(tmp_path / "results" / "bounces", found)
    made.open(resume=False)
    made.write(store.make_table(found, made.schema, samples_.values(0, 200), rows), 0)
    made.merge()
    made.close()
    script = tmp_path / "read.py"
    script.write_text(block("python"))
    told = checked([sys.executable, script], cwd=tmp_path)
    assert "unclamped" in told
    assert told.rstrip().endswith("b'm'")


def test_the_studies_of_scripts_make_sense():
    files = sorted((ROOT / "scripts" / "studies").glob("*.toml"))
    assert files
    for file in files:
        assert run_here(read(file), count=20)[1].status.tolist() == [0] * 20
