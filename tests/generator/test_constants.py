"""Tables of constants in the C code are what their scripts write."""

import subprocess
import sys

from support.generator.generated import ROOT


def test_the_lobatto_tables_are_those_of_their_script():
    script = ROOT / "scripts" / "tools" / "make_lobatto.py"
    written = subprocess.run([sys.executable, script], capture_output=True, check=True).stdout
    assert written == (ROOT / "fmu_src" / "math" / "lobatto.c").read_bytes()
