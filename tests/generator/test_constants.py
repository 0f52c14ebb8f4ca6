"""Tables of constants in the C code are what their script writes."""

import subprocess
import sys

from support.generator.generated import ROOT


def test_the_tables_of_nodes_are_those_of_their_script():
    script = ROOT / "scripts" / "tools" / "make_nodes.py"
    written = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True).stdout
    assert written == (ROOT / "fmu_src" / "math" / "node_tables.c").read_text()
