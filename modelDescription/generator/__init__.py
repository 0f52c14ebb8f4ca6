"""Scene file + variables.toml -> modelDescription.xml, C table, documentation page and icon of an FMU.

Reading order: catalogue (variables.toml), scene (the scene file), resolve (which variables the scene has),
start (what no FMU would start with), c_code and page (what the templates need), emit (the files). Beside them
stand icon (model.png) and guide (docs/scenes.md); advice and names hold what errors say.
"""
