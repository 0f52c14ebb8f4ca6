"""Tables of constants in the C code are what their scripts write."""

import subprocess
import sys

from support.generator.generated import ROOT


def test_the_tables_of_nodes_are_those_of_their_script():
    script = ROOT / "scripts" / "tools" / "make_lobatto.py"
    tables = (ROOT / "fmu_src" / "math" / "node_tables.c").read_text()
    for arguments in ([], ["radau"]):
        command = [sys.executable, script, *arguments]
        written = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        constants = written.partition('#include "math/node_tables.h"\n')[2].strip()
        assert len(constants) > 1000
        assert constants in tables
