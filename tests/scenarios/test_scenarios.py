"""Every scenario of scripts/scenarios on the FMUs just built; and a wrong expectation does fail"""

from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from contact_fmus.running import scenarios as command
from contact_fmus.running.scenarios import run_scenario, write_report
from contact_fmus.scenarios.claims import Outcome
from contact_fmus.scenarios.experiment import Claim

FOLDER = Path(__file__).resolve().parents[2] / "scripts" / "scenarios"
SHIPPED = sorted(FOLDER.glob("*.toml"))


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_every_claim_of_the_scenario_holds_in_every_run(file):
    result = run_scenario(file)
    assert result.failures == []
    assert result.results
    broken = [(r.variant.label, r.claim.text, r.outcome, r.error) for r in result.results if not r.holds]
    assert broken == []


def test_a_run_writes_its_plot_and_a_page_that_shows_it(tmp_path, capsys):
    assert command.run([str(FOLDER / "force_element.toml"), "--output", str(tmp_path)]) == 0
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert page.index('src="plots/force_element.png"') < page.index('id="claims"')  # a picture comes first
    assert (tmp_path / "plots" / "force_element.png").stat().st_size > 10_000
    assert '<a href="#force_element">' in page and "1 scenarios, " not in page
    assert " 0 runs failed. Made " in " ".join(page.split())
    assert "does not show, so bodies that seem to overlap may be apart" in page
    assert "0 do not hold" in capsys.readouterr().out


def test_the_page_typesets_formulas_and_stands_alone(tmp_path):
    results = [run_scenario(FOLDER / "contact_duration.toml")]
    page = etree.HTML(write_report(results, tmp_path).read_text(encoding="utf-8"))
    assert page.xpath("//td/sub/text()")[0] == "n"
    assert "$" not in page.xpath("string(//body)")
    assert page.xpath("//link | //script | //iframe | //@src[starts-with(., 'http')]") == []
    for link in page.xpath("//nav//a/@href"):
        assert page.xpath(f"//*[@id='{link[1:]}']"), link


def test_a_wrong_expectation_fails_and_the_exit_status_says_so(tmp_path, capsys):
    text = (FOLDER / "ball_on_sphere.toml").read_text(encoding="utf-8")
    file = tmp_path / "wrong.toml"
    file.write_text(text.replace("1.202543835278544", "1.202544"), encoding="utf-8")
    assert command.run([str(file), "--no-plots", "--output", str(tmp_path)]) == 0  # within 1e-6 m
    file.write_text(text.replace("1.202543835278544", "1.202546"), encoding="utf-8")
    assert command.run([str(file), "--no-plots", "--output", str(tmp_path)]) == 1
    assert "3 do not hold" in capsys.readouterr().out


@pytest.mark.parametrize(("old", "new", "message"), [
    ('"contact.dashpot" = "unclamped"', '"contact.dashpots" = "unclamped"', "no variable 'contact.dashpots'"),
    ('"contact.dashpot" = "unclamped"', '"contact.dashpot" = "soft"', "one of non_adhesive, unclamped"),
    ('"source.center" = [0.03, 0.04, 1.1]', '"source.radius" = -1.0', "source.radius"),
    ('fmu = "BallOnSphere"', 'fmu = "BallOnCone"', "BallOnCone.fmu does not exist"),
])  # fmt: skip
def test_what_the_fmu_refuses_is_reported_with_the_run_and_fails(old, new, message, tmp_path, capsys):
    text = (FOLDER / "ball_on_sphere.toml").read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "wrong.toml"
    file.write_text(text.replace(old, new), encoding="utf-8")
    assert command.run([str(file), "--no-plots", "--output", str(tmp_path)]) == 1
    out = " ".join(capsys.readouterr().out.split())
    assert "FAILED wrong (cvode_bdf):" in out
    assert message in out


def test_nan_never_passes():
    claim = Claim("final_value", "", 1e300, False)
    assert not Outcome(np.nan, 0.0, "m").holds(claim)
    assert not Outcome([0.0, np.nan], [0.0, 0.0], "m").holds(claim)
    assert Outcome([0.0, 1.0], [0.0, 0.0], "m").holds(claim)
