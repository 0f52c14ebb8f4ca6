"""recipe/recipe.yaml says of the conda package what pyproject.toml and the build say"""

import re
import tomllib

import yaml

from support.sources import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
TEXT = (ROOT / "recipe" / "recipe.yaml").read_text()
RECIPE = yaml.safe_load(TEXT)


def names(requirements):
    return {re.match(r"[\w-]+", one)[0] for one in requirements}


def test_the_recipe_has_the_version_and_the_sundials_of_the_build():
    version = re.search(r"contact_fmus VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert RECIPE["context"]["version"] == version
    commit = re.search(
        r"contact_sundials_commit (\w+)\) # v([0-9.]+)", (ROOT / "cmake/ContactSundials.cmake").read_text()
    )
    assert (RECIPE["source"][1]["rev"], RECIPE["context"]["sundials"]) == commit.groups()


def test_the_recipe_wants_what_the_package_wants():
    python = f"python {PROJECT['project']['requires-python']}"
    wanted = {python, *(one.replace(">=", " >=") for one in PROJECT["project"]["dependencies"])}
    assert set(RECIPE["requirements"]["run"]) == wanted
    building = {one for part in ("build", "host") for one in RECIPE["requirements"][part]}
    assert names(PROJECT["build-system"]["requires"]) <= names(one for one in building if "$" not in one)
    assert RECIPE["about"]["license"] == PROJECT["project"]["license"]
    assert all((ROOT / file).is_file() for file in RECIPE["about"]["license_file"])
