"""The files of FMI's cross check, for three FMUs by one command, in both versions"""

import fmpy
import numpy as np
import pandas
import pytest

NAMES = ("BouncingBall", "BallInShell", "ForceElement")


@pytest.mark.parametrize("before, version", [("", "2.0"), ("fmi3/", "3.0")])
def test_one_command_writes_what_the_cross_check_asks_of_three_fmus(ask, tmp_path, before, version):
    status, told, out = ask("compatibility", *(before + name for name in NAMES), "-o", "all")
    assert (status, told) == (0, ""), told
    assert out.splitlines() == [f"all/{version}/{name}" for name in NAMES]
    for name in NAMES:
        folder = tmp_path / "all" / version / name
        wanted = {f"{name}{end}" for end in (".fmu", "_cc.csv", "_in.csv", "_ref.csv", "_ref.opt")} | {
            "ReadMe.txt"
        }
        assert {file.name for file in folder.iterdir()} == wanted
        pairs = (line.split(",") for line in (folder / f"{name}_ref.opt").read_text().splitlines())
        options = {key: float(value) for key, value in pairs}
        own, other = (pandas.read_csv(folder / f"{name}_{kind}.csv") for kind in ("ref", "cc"))
        assert (folder / f"{name}_ref.csv").read_text().startswith('"time","')
        assert list(own.columns) == list(other.columns)
        assert other["time"].iloc[-1] == own["time"].iloc[-1] == options["StopTime"]
        # fmpy adds its clock up, so that its steps end rounding beside those of the project's run.
        last = [table["contact.gap"].iloc[-1] for table in (own, other)]
        assert last[0] == pytest.approx(last[1], abs=1e-9)
        assert np.all(np.diff(pandas.read_csv(folder / f"{name}_in.csv")["time"]) >= 0.0)
        assert f"FMI {version}, Co-Simulation" in (folder / "ReadMe.txt").read_text()


def test_the_fmu_itself_is_beside_them(ask, tmp_path):
    status, told, _ = ask("compatibility", "BouncingBall", "-o", "one")
    assert (status, told) == (0, "")
    copy = tmp_path / "one" / "2.0" / "BouncingBall" / "BouncingBall.fmu"
    assert fmpy.read_model_description(str(copy)).modelName == "BouncingBall"
