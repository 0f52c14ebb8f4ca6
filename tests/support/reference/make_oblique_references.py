"""Makes the ends in scripts/contact_fmus/stability/oblique_references.json anew, where the atlas's oblique
scenes stand, by the Taylor integrator in 40 digits, with how much these depend on the last digits of what is
given:

    PYTHONPATH=tests .venv/bin/python -m support.reference.make_oblique_references     # some minutes
"""

import json
from concurrent.futures import ProcessPoolExecutor

from contact_fmus.stability.motions import FILE
from support.reference.make_references import reference_of

FOUND = ("onsets", "steady", "displacement", "velocity", "contact.last_onset_time", "condition")
ROWS = json.loads(FILE.read_text(encoding="utf-8"))


def scene(number):
    return tuple(ROWS[number][key] for key in ("shape", "values", "end"))


def entry(number):
    found = reference_of((scene, (number,)))
    return ROWS[number] | {key: found[key] for key in FOUND}


def main():
    with ProcessPoolExecutor(2) as pool:
        lines = ",\n".join(json.dumps(row) for row in pool.map(entry, range(len(ROWS))))
    FILE.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
