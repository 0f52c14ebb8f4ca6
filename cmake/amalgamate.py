"""The sources folder of an FMU: python amalgamate.py UNITS SCENE_FOLDER FMU_SRC FMI_HEADERS 2|3 OUTPUT

All files of UNITS, one path a line, become one C file, contact.c, that needs nothing beside it but scene.h,
the FMI headers and the C library; the text at its top says what may be defined.
"""

import re
import sys
from pathlib import Path

from prune import pruned, pruned_header

INCLUDE = re.compile(r'^#include ([<"])([^>"]+)[>"].*\n', re.MULTILINE)
# A string, which may look like a comment inside, or a comment.
COMMENT = re.compile(r'"(?:[^"\\\n]|\\.)*"|/\*.*?\*/', re.DOTALL)
# What lets a header be taken twice, as no header is here
GUARD = re.compile(r"^#ifndef (\w+_H)\n#define \1\n(.*)^#endif[^\n]*\n\Z", re.MULTILINE | re.DOTALL)
# Written as tabs, which take less room in an FMU
INDENT = re.compile(r"^(?: {4})+", re.MULTILINE)
BUILD_DESCRIPTION = """\
<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{name}" description="C11, the C library and its mathematics (-lm)">
    <SourceFileSet language="C11">
      <SourceFile name="contact.c"/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""
HEAD = """\
/*
 * {name}: the whole model and its FMI {fmi}.0 functions as one file, which the build joins of
 * all sources, without their comments and what this scene does not need. Beside it: scene.h, what this scene
 * holds, and the headers of FMI.
 *
 *   cc -std=c11 -O2 -shared -fPIC -o {name}.so contact.c -lm
 *
 * CONTACT_WITH_CVODE   takes the CVODE methods from SUNDIALS 6.4 or later, with
 *                      -lsundials_cvode -lsundials_nvecserial; without it solver.method is event_driven only
 * CONTACT_PLAIN_C      uses nothing that C11 does not have
 */
{definitions}{libraries}
/* A compiler that fuses a*b+c into one rounding gives other digits than the libraries in the FMU. */
#if defined __clang__ || defined _MSC_VER
#pragma STDC FP_CONTRACT OFF
#elif defined __GNUC__ && defined __FP_FAST_FMA
#pragma GCC optimize("fp-contract=off")
#endif

#include "fmi{fmi}Functions.h"

/* Some scenes do not call all functions, or leave out what needs a parameter or a variable. */
#if defined __GNUC__ || defined __clang__
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#endif

/* Only the functions of FMI are seen from outside. */
#if defined __GNUC__ && !defined _WIN32
#pragma GCC visibility push(hidden)
#endif
"""
TAIL = """
#if defined __GNUC__ && !defined _WIN32
#pragma GCC visibility pop
#endif
"""


def with_notice(text):
    """A header of FMI with its licence and no other comment: the standard explains the functions"""
    notice = next(found[0] for found in COMMENT.finditer(text) if "Copyright" in found[0])
    licence = "/*\n   " + notice[notice.index("Copyright") :] + "\n"
    return licence + without_comments(text)


class Amalgamation:
    """Files one after another, each header at the place where the first asks for it"""

    def __init__(self, source, scene, fmi):
        self.source = source
        self.scene = scene
        self.fmi_headers = f"fmi{fmi}"
        self.seen = set()
        self.libraries = set()

    def text(self, file):
        """The file with its headers; C's own are only noted"""
        self.seen.add(file)
        content = GUARD.sub(r"\2", file.read_text(encoding="utf-8"))
        return INCLUDE.sub(lambda found: self.included(*found.groups(), file), content)

    def included(self, mark, name, file):
        if name == "scene.h":
            return self.of_scene()
        if "/" not in name and name.startswith(self.fmi_headers):
            return ""  # at the top
        if mark == "<" and "/" not in name:
            self.libraries.add(name)
            return ""
        if mark == "<":
            return f"#include <{name}>\n"  # SUNDIALS
        header = (self.source if "/" in name else file.parent) / name
        return "" if header in self.seen else self.text(header)

    def of_scene(self):
        """scene.h is a file of its own, behind the headers that it asks for"""
        header = self.scene / "scene.h"
        if header in self.seen:
            return ""
        self.seen.add(header)
        wanted = [
            self.included(*found, header) for found in INCLUDE.findall(header.read_text(encoding="utf-8"))
        ]
        return "".join(wanted) + '#include "scene.h"\n'


def without_comments(text):
    """A third of the size; whoever reads the model reads the project's files"""
    text = COMMENT.sub(lambda found: found[0] if found[0][0] == '"' else " ", text)
    lines = (line.rstrip() for line in text.split("\n"))
    return "\n".join(line for line in lines if line) + "\n"


def amalgamated(units, source, scene, fmi):
    """The text of contact.c"""
    about = (scene / "scene.cmake").read_text(encoding="utf-8")
    one = Amalgamation(source, scene, fmi)
    cvode = [unit for unit in units if unit.stem == "cvode"]
    body = "".join(one.text(unit) for unit in units if unit not in cvode)
    if cvode:
        # Last, since what they include is there only where CVODE is.
        with_it = "".join(one.text(unit) for unit in cvode)
        body += f"\n#ifdef CONTACT_WITH_CVODE\n{with_it}\n#endif\n"
    # What the contact folder, which knows no scene, hears of it.
    parts = (
        "CYLINDER SKEW CAPS PLANE TORUS COMPOUND CURVED HERTZ PRESCRIBED RESTITUTION ROTATION ROLLING MINDLIN"
    )
    has = {f"CONTACT_ANY_{part}": f"set(SCENE_HAS_{part} ON)" in about for part in parts.split()}
    name = re.search(r'SCENE_NAME "(\w+)"', about)[1]
    head = HEAD.format(
        name=name,
        fmi=fmi,
        definitions="".join(
            f"#define {macro} {value:d}\n" for macro, value in {"CONTACT_PARTS": 1, **has}.items()
        ),
        libraries="".join(f"#include <{library}>\n" for library in sorted(one.libraries)),
    )
    header = (scene / "scene.h").read_text(encoding="utf-8")
    text = pruned(without_comments(body), header, [macro for macro, value in has.items() if not value])
    return name, head + INDENT.sub(lambda found: len(found[0]) // 4 * "\t", text) + TAIL


def main(units, scene, source, headers, fmi, output):
    """Writes contact.c, scene.h, the FMI headers and buildDescription.xml"""
    files = [Path(line) for line in Path(units).read_text(encoding="utf-8").split("\n") if line]
    scene, headers, output = Path(scene), Path(headers), Path(output)
    name, text = amalgamated(files, Path(source).resolve(), scene, fmi)
    output.mkdir(parents=True, exist_ok=True)
    (output / "contact.c").write_text(text, encoding="utf-8")
    header = without_comments(INCLUDE.sub("", (scene / "scene.h").read_text("utf-8")))
    (output / "scene.h").write_text(pruned_header(header, text), encoding="utf-8")
    (output / "buildDescription.xml").write_text(BUILD_DESCRIPTION.format(name=name), encoding="utf-8")
    for header in sorted(headers.glob(f"fmi{fmi}*.h")):
        (output / header.name).write_text(with_notice(header.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except OSError as error:
        sys.exit(f"amalgamate: {error}")
