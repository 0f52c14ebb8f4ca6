"""Tables of constants in the C code are what their scripts write."""

import subprocess
import sys

from support.generator.generated import ROOT


def test_the_tables_of_nodes_are_those_of_their_script():
    script = ROOT / "scripts" / "tools" / "make_lobatto.py"
    for arguments, file in (([], "node_tables.c"), (["radau"], "node_tables.c")):
        written = subprocess.run([sys.executable, script, *arguments], capture_output=True, check=True).stdout
        assert written == (ROOT / "fmu_src" / "math" / file).read_bytes()
