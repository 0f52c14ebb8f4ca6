"""FMUs of another maker, in C: one that is sound, and the same with one thing broken, of FMI 2.0 and 3.0

file = foreign_fmu(folder, 3, DoStep="abort();")     # what functions do besides what they must
broken(folder, 2, "wrong token")                     # one of BROKEN"""

import subprocess
import zipfile
from pathlib import Path

import fmpy

from contact_fmus.checking.trial import wanted

TOKEN = "{1}"
HEADER, SAVING = '<?xml version="1.0" encoding="UTF-8"?>', "canGetAndSetFMU"
STEPS = 'modelIdentifier="Other" canHandleVariableCommunicationStepSize="true"'
XML = {
    2: f"""{HEADER}<fmiModelDescription fmiVersion="2.0" modelName="Other" guid="{TOKEN}">
<CoSimulation {STEPS} {SAVING}state="true"/><ModelVariables>
<ScalarVariable name="m[1,2]" valueReference="0" causality="output" initial="calculated"><Real/>
</ScalarVariable><ScalarVariable name="label" valueReference="1" causality="parameter" variability="fixed">
<String start="a"/></ScalarVariable></ModelVariables><ModelStructure><Outputs><Unknown index="1"/></Outputs>
<InitialUnknowns><Unknown index="1"/></InitialUnknowns></ModelStructure></fmiModelDescription>""",
    3: f"""{HEADER}<fmiModelDescription fmiVersion="3.0" modelName="Other" instantiationToken="{TOKEN}">
<CoSimulation {STEPS} {SAVING}State="true"/><ModelVariables>
<Float64 name="time" valueReference="9" causality="independent" variability="continuous"/>
<Float64 name="m[1,2]" valueReference="0" causality="output" initial="calculated"/>
<String name="label" valueReference="1" causality="parameter" variability="fixed"><Start value="a"/></String>
</ModelVariables><ModelStructure><Output valueReference="0"/><InitialUnknown valueReference="0"/>
</ModelStructure></fmiModelDescription>""",
}
PLATFORM = {2: fmpy.platform, 3: fmpy.platform_tuple}
HEAD = """#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
static double now, kept;
typedef void logging2(void *, const char *, int, const char *, const char *, ...);
typedef void logging3(void *, int, const char *, const char *);
static logging2 *say2;
static logging3 *say3;
static void say(const char *text)
{
    if (say2) say2(NULL, "Other", 3, "logStatusError", text);
    if (say3) say3(NULL, 3, "logStatusError", text);
}
"""
REFS = "void *c, const unsigned *refs, size_t n, double *values"
# Of both versions: what stands between the brackets, what the function does
FUNCTIONS = {
    2: {"Instantiate": (
            "const char *name, int kind, const char *token, const char *place, void **back, int a, int b",
            f'say2 = (logging2 *)back[0]; return strcmp(token, "{TOKEN}") ? NULL : &now;'),
        "GetReal": (REFS, ""), "DoStep": ("void *c, double t, double h, int last", "now = t + h;")},
    3: {"InstantiateCoSimulation": (
            "const char *name, const char *token, const char *place, bool visible, bool logs, bool events,"
            " bool early, const unsigned *refs, size_t n, void *mine, logging3 *log, void *update",
            f'say3 = log; return strcmp(token, "{TOKEN}") ? NULL : &now;'),
        "GetFloat64": (f"{REFS}, size_t count", ""), "DoStep": (
            "void *c, double t, double h, bool last, bool *event, bool *end, bool *early, double *reached",
            "now = t + h; *event = *end = *early = false; *reached = now;")},
}  # fmt: skip
for number, state in ((2, "FMUstate"), (3, "FMUState")):
    FUNCTIONS[number] |= {f"Get{state}": ("void *c, void **state", "kept = now; *state = &kept;")}
    FUNCTIONS[number] |= {f"Set{state}": ("void *c, void *state", "now = kept;")}
    FUNCTIONS[number] |= {f"Free{state}": ("void *c, void **state", "*state = NULL;")}
# What FMI 3.0 calls otherwise
NAMES3 = {"Instantiate": "InstantiateCoSimulation", "GetReal": "GetFloat64"}
NAMES3 |= {"GetStatus": "GetOutputDerivatives"}
NAMES3 |= {f"{verb}FMUstate": f"{verb}FMUState" for verb in ("Get", "Set", "Free")}
VALUE = "for (size_t i = 0; i < n; ++i) values[i] = now;"


def library(folder: Path, version: int, **bodies: str | None) -> bytes:
    """`bodies`: by FMI 2.0's names what functions do first; None leaves one out"""
    bodies = {"GetReal": VALUE} | bodies
    bodies = {NAMES3.get(name, name) if version == 3 else name: text for name, text in bodies.items()}
    lines = [HEAD]
    for full in wanted(str(version), "coSimulation"):
        name = full[4:]
        takes, does = FUNCTIONS[version].get(name, ("", ""))
        if name in bodies and bodies[name] is None:
            continue
        kind, end = "int", "return 0;"
        if name.startswith("Instantiate"):
            kind, end = "void *", "return NULL;"
        elif name in ("GetVersion", "GetTypesPlatform"):
            kind, end = (
                "const char *",
                f'return "{version}.0";' if name == "GetVersion" else 'return "default";',
            )
        lines.append(f"{kind} {full}({takes}) {{ {bodies.get(name) or ''} {does} {end} }}")
    source, made = folder / "other.c", folder / "Other.so"
    source.write_text("\n".join(lines))
    subprocess.run(["gcc", "-shared", "-fPIC", "-w", "-o", made, source], check=True)
    return made.read_bytes()


def packed(folder: Path, members: dict[str, str | bytes]) -> Path:
    file = folder / "Other.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        for name, text in members.items():
            archive.writestr(name, text)
    return file


def foreign_fmu(folder: Path, version: int = 2, **bodies: str | None) -> Path:
    binary = f"binaries/{PLATFORM[version]}/Other.so"
    return packed(folder, {"modelDescription.xml": XML[version], binary: library(folder, version, **bodies)})


def _changed(folder: Path, version: int, **changes) -> Path:
    """`description`: of the XML; `binary`: of the name, or None for none; `content`: of the library"""
    whole = {"modelDescription.xml": changes.get("description", lambda text: text)(XML[version])}
    if (place := changes.get("binary", "binaries/{platform}/Other.so")) is not None:
        content = changes.get("content") or library(folder, version)
        whole[place.format(platform=PLATFORM[version])] = content
    return packed(folder, whole)


def _damaged(folder: Path, version: int) -> Path:
    """Changes a byte of the stored library, so that its checksum does not agree."""
    file = foreign_fmu(folder, version)
    content = bytearray(file.read_bytes())
    content[content.index(b"\x7fELF") + 100] ^= 0xFF
    file.write_bytes(content)
    return file


def _bodies(**bodies):
    return lambda folder, version: foreign_fmu(folder, version, **bodies)


def _files(**changes):
    return lambda folder, version: _changed(folder, version, **changes)


NEVER = 'say("the axis of an infinite body has no inertia"); return 3;'
# How it is made, which check finds it, words that say what it is
BROKEN = {
    "no binary at all": (_files(binary=None), "binaries", "neither binaries nor sources"),
    "a missing binary": (_files(binary="binaries/{platform}/Else.so"), "binaries", "Other.so is missing"),
    "a library of another kind": (_files(content=b"MZ" + bytes(100)), "binaries", "is no library for"),
    "a wrong token": (_files(description=lambda text: text.replace(TOKEN, "{2}")), "run", "Instantiate"),
    "XML that does not end": (_files(description=lambda text: text[:-40]), "description", "line"),
    "XML against the schema": (_files(description=lambda text: text.replace('causality="output"',
        'causality="outputs"')), "description", "outputs"),
    "a crash in a step": (_bodies(DoStep="abort();"), "run", "signal SIGABRT"),
    "a fault of memory in a step": (_bodies(DoStep="*(volatile int *)8 = 1;"), "run", "signal SIGSEGV"),
    "the process's end": (_bodies(DoStep="exit(0);"), "run", "ended its process"),
    "a hang in a step": (_bodies(DoStep="for (volatile int k = 0;;) k = 1;"), "run", "not done after"),
    "a missing function": (_bodies(GetStatus=None), "exports", "does not export fmi"),
    "a number that is none": (_bodies(GetReal="now = 0.0 / 0.0;" + VALUE), "run", "m[1,2] is not finite"),
    "a state that does not restore": (_bodies(SetFMUstate="return 0;"), "state", "right after the state was"),
    "a refused step": (_bodies(DoStep='say("too steep"); return 3;'), "run", "too steep"),
    "a refused start": (_bodies(ExitInitializationMode=NEVER), "run", "an infinite body has no inertia"),
    "a damaged member": (_damaged, "archive", "checksum"),
}  # fmt: skip
