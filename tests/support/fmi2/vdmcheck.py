"""VDMCheck2, the formal model of the FMI 2.0 standard, on FMUs or model descriptions.

    PYTHONPATH=tests python -m support.fmi2.vdmcheck build/fmus/*.fmu

Maven brings the programs (vdmcheck/pom.xml) into <build>/vdmcheck once. The models find different faults."""

import fcntl
import hashlib
import os
import subprocess
import sys
from pathlib import Path

POM = Path(__file__).resolve().parent / "vdmcheck" / "pom.xml"
BUILD = Path(os.environ.get("CONTACT_BUILD", POM.parents[4] / "build"))
MODELS = ("rule-model", "static-model")

# As VDMCheck2's own script calls it; both models define this function. Absent files are nil.
EXPRESSION = "isValidFMIConfigurations(modelDescription, buildDescription, terminalsAndIcons)"
# A run lasts a second: start quickly rather than optimize.
JAVA = ("java", "-Xmx1g", "-XX:+UseSerialGC", "-XX:TieredStopAtLevel=1")


def prepare(folder=BUILD / "vdmcheck"):
    """Returns the folder with programs and models, filled by Maven when pom.xml is newer to it."""
    folder = Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    stamp = folder / "pom.sha256"
    wanted = hashlib.sha256(POM.read_bytes()).hexdigest()
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not stamp.exists() or stamp.read_text() != wanted:
            command = ["mvn", "-B", "-ntp", "-q", "-f", str(POM), f"-Dfolder={folder}", "package"]
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            if run.returncode:
                raise RuntimeError(f"{' '.join(command)} failed:\n{run.stdout}{run.stderr}")
            stamp.write_text(wanted)
    return folder


def check(file, model, folder=None):
    """Returns what VDMCheck2 says about the FMU or description by one of MODELS, or nothing."""
    folder = folder or prepare()
    sources = [
        f"fmi2-{model}",
        *sorted(str(rules) for rules in (folder / f"fmi2-{model}").glob("Rules/*.adoc")),
    ]
    command = [
        *JAVA, "-Dvdmj.parser.merge_comments=true",
        "-Dfmureader.noschema=true",  # the schema has a test of its own
        "-Dfmureader.xsd=fmi2schema/fmi2.xsd",
        *("-cp", os.pathsep.join(str(jar) for jar in sorted((folder / "jars").glob("*.jar")))),
        *("com.fujitsu.vdmj.VDMJ", "-vdmsl", "-q", "-annotations", "-e", EXPRESSION), *sources,
        str(Path(file).resolve()),
    ]  # fmt: skip
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    # Its exit code is 0 either way. The verdict is the last line, complaints come before it.
    said = (run.stdout + run.stderr).split("\n")
    said = [line for line in said if line.strip()]
    return [] if said == ["true"] else said or [f"VDMJ said nothing, exit code {run.returncode}"]


def main(files):
    complaints = 0
    for file in files:
        for model in MODELS:
            said = check(file, model)
            complaints += bool(said)
            print(f"{file}: {model}: {'nothing to report' if not said else ''}")
            for line in said:
                print(f"    {line}")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
