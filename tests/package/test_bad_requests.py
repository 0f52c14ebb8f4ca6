"""A bad request gets one sentence on stderr and the status that docs/commands.md names, and no traceback."""

import json
import re
import sys
import zipfile

import pytest

from contact_fmus.__main__ import COMMANDS
from contact_fmus.building.command import scene_text
from contact_fmus.fmu.files import fmu_file
from support.foreign import XML, foreign_fmu, packed
from support.programs import environment, finished

# A model exchange FMU, and an FMI 3.0 one, as other vendors make them
MODEL_EXCHANGE = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Other" guid="{1}" numberOfEventIndicators="0">
  <ModelExchange modelIdentifier="Other"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="0" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>"""
FMI_3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Other" instantiationToken="1">
  <CoSimulation modelIdentifier="Other"/>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>"""


def one_sentence(told):
    return told.count("\n") == 1 and "Traceback" not in told and len(told) < 1200


STUDY = """
fmu = "SphereSphere"
experiment.stop_time = 1.0
vary."source.radius" = [0.1, 0.2]
outputs = { height = "source.position[3]" }
"""
WRONG = {
    "unknown command": (["buidl"], "did you mean 'build'"),
    "run: no such file": (["run", "nowhere.fmu"], "nowhere.fmu"),
    "run: no such name": (["run", "SphereSpher"], "did you mean 'SphereSphere'"),
    "run: no archive": (["run", "text.fmu"], "not a ZIP archive"),
    "run: an archive": (["run", "empty.fmu"], "no modelDescription.xml"),
    "run: a scene": (["run", "scene.toml"], "contact-fmus build"),
    "run: a folder": (["run", "folder.fmu"], "folder.fmu"),
    "run: unknown variable": (["run", "SphereSphere", "--set", "contact.dashpt=unclamped"],
        "contact.dashpot"),
    "run: unknown item": (["run", "SphereSphere", "--set", "contact.dashpot=unclamp"],
        "did you mean 'unclamped'"),
    "run: no number": (["run", "SphereSphere", "--set", "source.radius=big"], "a number in m, not 'big'"),
    "run: nan": (["run", "SphereSphere", "--set", "source.radius=nan"], "not 'nan'"),
    "run: half a vector": (["run", "SphereSphere", "--set", "gravity=0,0"], "takes 3 numbers"),
    "run: no truth": (["run", "SphereCylinder", "--set", "destination.finite_length=2"], "true or false"),
    "run: pinned": (["run", "BouncingBall", "--set", "contact.law=hertz"],
        "BouncingBall.fmu has contact.law pinned to linear; SpherePlane has it open"),
    "run: left out": (["run", "fmi3/BouncingBall", "--set", "contact.friction_coefficient=1"],
        "SpherePlane has it open"),
    "run: no value": (["run", "SphereSphere", "--set", "source.radius"], "NAME=VALUE"),
    "run: an output": (["run", "SphereSphere", "--set", "contact.gap=1"], "of kind output"),
    "run: out of range": (["run", "SphereSphere", "--set", "source.radius=-1"], "allowed: 1e-150"),
    "run: contradiction": (["run", "SphereSphere", "--set", "contact.location=inside", "--set",
        "source.radius=2"], "source.radius"),
    "run: tolerance": (["run", "SphereSphere", "--tolerance", "1e5"],
        "the tolerance 100000 is refused (allowed: 1e-14 .. 0.01, as solver.relative_tolerance)"),
    "run: stop": (["run", "SphereSphere", "--stop", "-1"], "greater than 0"),
    "run: step": (["run", "SphereSphere", "--step", "1e-300"], "--step"),
    "run: csv": (["run", "SphereSphere", "--stop", "0.01", "--csv", "nowhere/out.csv"], "nowhere/out.csv"),
    "run: csv is a folder": (["run", "SphereSphere", "--csv", "folder.fmu"], "this is a folder"),
    "run: plot": (["run", "SphereSphere", "--stop", "1e9", "--plot", "x.xyz"], "none of the formats"),
    "run: no name": (["run", ""], "an empty name"),
    "run: a study": (["run", "study.toml"], "contact-fmus sweep"),
    "run: scenario": (["run", "broken.toml"], "broken.toml"),
    "plot: a scene": (["plot", "scene.toml"], "contact-fmus build"),
    "plot: text": (["plot", "words.csv", "--variables", "x"], "column x holds text"),
    "plot: no such variable": (["plot", "BallInShell", "--variables", "contact.gp"],
        "did you mean 'contact.gap'"),
    "plot: unknown format": (["plot", "BallInShell", "-o", "picture.pnk"], "did you mean '.png'"),
    "animate: unknown format": (["animate", "BallInShell", "-o", "page.htm"], "did you mean '.html'"),
    "animate: another kind": (["animate", "picture.png"], "a result (.csv)"),
    "build: no such file": (["build", "nowhere.toml"], "nowhere.toml"),
    "build: no toml": (["build", "text.fmu"], "text.fmu"),
    "build: an FMU": (["build", "text.fmu"], "text.fmu: this is an FMU; a scene (.toml) is needed"),
    "build: a body's name": (["build", "sub/bad.toml"],
        "build: sub/bad.toml: [[body]] 1: 'name' is 'a b', not a name (allowed: small letters and digits,"),
    "build: binary": (["build", "bytes.toml"], "bytes.toml"),
    "build: no compiler": (["build", "scene.toml", "--compiler", "nocc"], "nocc: not found"),
    "build: no such platform": (["build", "scene.toml", "--platforms", "amiga"], "there is no 'amiga'"),
    "build: no SUNDIALS": (["build", "scene.toml", "--sundials-source", "folder.fmu"], "src/cvode"),
    "new: plane": (["new", "X", "--shape", "plane", "--inside"], "a plane has no inside"),
    "new: scene": (["new", "X", "--scene", "cradle", "--inside"], "it is a whole scene"),
    "new: name": (["new", "3x"], "'3x'"),
    "new: exists": (["new", "scene"], "--force"),
    "new: pinned": (["new", "X", "--pinned", "contact.dashpot=no"],
        "new: X.toml: [pinned]: 'contact.dashpot' is 'no' (allowed: non_adhesive"),
    "new: folder": (["new", "X", "--output", "text.fmu"], "text.fmu"),
    "check: no such file": (["check", "nowhere.fmu"], "nowhere.fmu"),
    "check: a folder": (["check", "folder.fmu"], "this is a folder"),
    "check: no archive": (["check", "text.fmu"], "not a ZIP archive"),
    "check: an archive": (["check", "empty.fmu"], "no modelDescription.xml"),
    "importers: no such file": (["importers", "nowhere.fmu"], "nowhere.fmu: there is no such file"),
    "scenarios": (["scenarios", "nowhere.toml"], "nowhere.toml"),
    "scenarios: no such name": (["scenarios", "restitutio"], "did you mean 'restitution'"),
    "scenarios: binary": (["scenarios", "bytes.toml"], "this is no text"),
    "picture: kind": (["picture", "restitution", "--output", "x.xyz"], "none of the formats"),
    "sweep: no such name": (["sweep", "head_on_bounce"], "did you mean 'head_on_bounces'?"),
    "sweep: a file": (["sweep", "study.toml", "-o", "text.fmu"], "a folder is needed"),
    "sweep: plot": (["sweep", "study.toml", "--plot", "x.xyz"], "none of the formats"),
    "sweep: column": (["sweep", "study.toml", "--plot", "--x", "hight"], "did you mean 'height'"),
    "picture": (["picture", "nowhere.toml", "--output", "x.png"], "nowhere.toml"),
    "page": (["page", "--output", "folder.fmu"], "folder.fmu"),
    "bench: another build": (["bench", "--against", "folder.fmu"], "folder.fmu"),
    "stability": (["stability", "--output", "text.fmu"], "text.fmu"),
    "report": (["report", "--output", "text.fmu"], "text.fmu"),
    "beyond": (["stability", "--beyond", "one", "two"], "one"),
}  # fmt: skip
DRAWN = {
    "no such name": (["BallInShel"], "did you mean 'BallInShell'"),
    "no such file": (["nowhere.csv"], "nowhere.csv: there is no such file"),
    "no such parameter": (["BallInShell", "--set", "source.radios=1"], "source.radius"),
    "a refused value": (["BallInShell", "--set", "source.radius=-1"], "radius"),
    "no value": (["BallInShell", "--set", "source.radius"], "NAME=VALUE"),
    "time runs backwards": (["BallInShell", "--stop", "-1"], "--stop"),
    "not a result": (["text.csv"], "first column is not 'time'"),
    "one row": (["row.csv"], "two are needed"),
    "not an FMU": (["text.fmu"], "no FMU"),
    "not a scenario": (["broken.toml"], "broken.toml"),
}
for one in ("plot", "animate"):
    WRONG |= {f"{one}: {case}": ([one, *words], told) for case, (words, told) in DRAWN.items()}


@pytest.mark.parametrize("case", WRONG)
def test_a_bad_request_ends_in_one_sentence_and_status_2(case, ask, tmp_path):
    (tmp_path / "text.fmu").write_text("this is no FMU")
    (tmp_path / "folder.fmu").mkdir()
    (tmp_path / "bytes.toml").write_bytes(bytes(range(256)))
    (tmp_path / "broken.toml").write_text("title = \n")
    (tmp_path / "words.csv").write_text("time,x\n0,1\n1,high\n")
    (tmp_path / "text.csv").write_text("no table, no archive")
    (tmp_path / "row.csv").write_text("time,contact.gap\n0,1\n")
    (tmp_path / "picture.png").write_bytes(b"\x89PNG")
    (tmp_path / "study.toml").write_text(STUDY)
    packed(tmp_path, {"readme.txt": "nothing"}).rename(tmp_path / "empty.fmu")
    text = scene_text("scene", None, "sphere", False, [])
    (tmp_path / "scene.toml").write_text(text)
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "bad.toml").write_text(text.replace('name = "ball"', 'name = "a b"'))
    arguments, words = WRONG[case]
    status, told, _ = ask(*arguments)
    assert status == 2, told
    if arguments[0] in ("plot", "animate"):
        told = re.sub("; scenarios: .*", "", told)  # as many as there are
    assert one_sentence(told) and words in told, told
    assert told.startswith(f"contact-fmus {arguments[0]}: ") or case == "unknown command", told


@pytest.mark.parametrize("name", COMMANDS)
def test_an_unknown_option_is_refused_by_every_command(name, ask):
    status, told, _ = ask(name, "--no-such-option")
    assert (status, one_sentence(told)) == (2, True), told


def test_an_fmu_of_another_kind_says_what_is_needed(ask, tmp_path):
    for xml, words in ((MODEL_EXCHANGE, "co-simulation is needed"), (FMI_3, "its library cannot be loaded")):
        file = packed(tmp_path, {"modelDescription.xml": xml})
        status, told, _ = ask("run", file)
        assert (status, one_sentence(told)) == (2, True) and words in told, told
    status, told, _ = ask("run", file, "--model-exchange")
    assert (status, one_sentence(told)) == (2, True) and "FMI 2.0 or 3.0 model exchange is needed" in told


def test_an_fmu_without_a_library_or_with_a_broken_one_is_named(ask, tmp_path):
    for members in ({}, {"binaries/linux64/Other.so": "no library"}):
        status, told, _ = ask("run", packed(tmp_path, {"modelDescription.xml": XML[2]} | members))
        assert (status, one_sentence(told)) == (2, True) and "cannot be loaded" in told, told


def test_an_fmu_of_another_vendor_runs_and_is_checked(ask, tmp_path):
    file = foreign_fmu(tmp_path)
    status, _, told = ask("run", file, "--stop", "2", "--step", "0.5", "--json")
    assert (status, json.loads(told)["values"]) == (0, {"m[1,2]": 2.0})
    status, told, out = ask("check", file)
    assert status == 0, out


def test_a_refused_step_ends_a_run_with_status_3_and_keeps_what_there_is(ask, tmp_path):
    file = foreign_fmu(tmp_path, DoStep="if (t > 0.9) return 3;")
    status, told, _ = ask("run", file, "--stop", "2", "--step", "0.5", "--csv", "kept.csv")
    assert (status, one_sentence(told)) == (3, True), told
    assert (tmp_path / "kept.csv").read_text().splitlines()[-1] == "1.0,1.0"


def test_a_full_disk_is_named_with_status_3(ask):
    status, told, _ = ask("run", "SphereSphere", "--stop", "0.01", "--csv", "/dev/full")
    assert (status, one_sentence(told)) == (3, True) and "/dev/full: No space left" in told, told


def test_a_damaged_copy_of_a_shipped_fmu_is_found_out(ask, tmp_path):
    damaged = tmp_path / "Damaged.fmu"
    with zipfile.ZipFile(fmu_file("ForceElement")) as whole, zipfile.ZipFile(damaged, "w") as part:
        for name in whole.namelist():
            data = whole.read(name)
            if name == "modelDescription.xml":
                data = data.replace(b'causality="output"', b'causality="outputs"')
            part.writestr(name.replace("ForceElement.so", "Force.so"), data)
    status, _, out = ask("check", damaged, "--json")
    found = {one["name"] for one in json.loads(out)["checks"] if one["outcome"] == "found"}
    assert status == 1 and {"description", "binaries", "exports", "run"} <= found, out


WITHOUT_EXTRAS = """
import sys
from importlib.machinery import PathFinder
from contact_fmus.__main__ import EXTRAS, main
class Bare(PathFinder):  # as PathFinder, but for the extras
    @classmethod
    def find_spec(cls, name, *where):
        return None if name.partition(".")[0] in EXTRAS else PathFinder.find_spec(name, *where)
sys.meta_path = [Bare if one is PathFinder else one for one in sys.meta_path]
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_tells_its_options_without_any_extra(name):
    run = finished([*[sys.executable, "-c", WITHOUT_EXTRAS, name], "--help"], env=environment())
    assert run.returncode == 0 and run.stderr == "" and f"usage: contact-fmus {name}" in run.stdout, run


def test_what_needs_an_extra_names_it_and_what_draws_nothing_needs_none(tmp_path):
    command = [sys.executable, "-c", WITHOUT_EXTRAS, "plot", "SphereSphere"]
    run = finished(command, env=environment())
    assert run.returncode == 2 and one_sentence(run.stderr) and "'contact-fmus[plot]'" in run.stderr, run
    command[3:] = ["scenarios", "ball_on_sphere", "--no-plots", "--output", tmp_path]
    run = finished(command, env=environment())
    assert (run.returncode, run.stderr) == (0, ""), run


def test_values_have_no_unit_1_and_no_sign_of_0(ask, tmp_path):
    _, _, out = ask("run", "BouncingBall", "--stop", "0.1")
    lines = [line.split() for line in out.splitlines()]
    assert ["contact.direction", "(0,", "0,", "-1)"] in lines and not re.search(r"-0[ ,)]", out), out
    _, _, out = ask("run", "BouncingBall", "--stop", "0.1", "--json", "--csv", "run.csv")
    for text in (out, (tmp_path / "run.csv").read_text()):
        assert not re.search(r"-0\.0[,}\s]", text) and "0.0," in text


def test_a_shipped_study_goes_by_its_name(ask):
    status, told, _ = ask("sweep", "head_on_bounces", "--plot", "--x", "nowhere")
    assert status == 2 and "nowhere" in told, told  # a column of the study that was read
