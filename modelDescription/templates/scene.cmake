# Generated from the scene file by modelDescription/generate.py.
set(SCENE_NAME "{{ scene.name }}")
set(SCENE_GUID "{{ guid }}")
set(SCENE_ANY_FREE {{ "ON" if any_free else "OFF" }})
set(SCENE_HAS_CVODE {{ "ON" if has_cvode else "OFF" }})
set(SCENE_HAS_CYLINDER {{ "ON" if any_cylinder else "OFF" }})
set(SCENE_HAS_HERTZ {{ "ON" if any_hertz else "OFF" }})
set(SCENE_HAS_RESTITUTION {{ "ON" if any_restitution else "OFF" }})
set(SCENE_HAS_PLANE {{ "ON" if any_plane else "OFF" }})
