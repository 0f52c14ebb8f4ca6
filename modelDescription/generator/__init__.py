"""Scene file + variables.toml -> modelDescription.xml, C table and documentation page of an FMU.

Reading order: catalogue (variables.toml), scene (the scene file), resolve (which variables the scene has),
c_code and page (what the templates need), emit (the files).
"""
