"""untaken_branches.py COVERAGE.json: the lines of C code with a branch that nothing took, from gcovr's JSON

One line each: file, line number, how many of its branches were not taken, the source.
"""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main() -> None:
    report = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    untaken, branches = 0, 0
    for file in sorted(report["files"], key=lambda one: one["file"]):
        source = (ROOT / file["file"]).read_text(encoding="utf-8").splitlines()
        for line in file["lines"]:
            counts = [branch["count"] for branch in line["branches"]]
            branches += len(counts)
            missing = counts.count(0)
            untaken += missing
            if missing:
                text = source[line["line_number"] - 1].strip()
                print(f"{file['file']}:{line['line_number']}: {missing} of {len(counts)}: {text}")
    print(f"{untaken} of {branches} branches not taken: {100 - 100 * untaken / branches:.1f} % are")


if __name__ == "__main__":
    main()
