"""What must hold between variables.toml, modelDescription.xml, C table and documentation page of a scene."""

import re

from support.generator.generated import CATALOGUE, parse_c, parse_page, parse_xml, row_of, whole


def expected(name: str, scene: dict) -> dict:
    """Returns what variables.toml and the scene file say of one scalar, worked out without the generator."""
    key, row = row_of(name, scene)
    kind = CATALOGUE["type"][row["type"]]
    component = int(name.rpartition("[")[2].rstrip("]")) - 1 if name.endswith("]") else 0
    owner = name.partition(".")[0]
    blocks = {table["name"]: table["block"] for kind in ("body", "contact") for table in scene[kind]}
    targets = {contact["destination"] for contact in scene["contact"]}
    hit_only = owner in targets - {contact["source"] for contact in scene["contact"]}
    start = row.get("start_destination", row.get("start")) if hit_only else row.get("start")
    start = scene.get("start", {}).get(whole(name), start)
    items = {item: entry["value"] for item, entry in kind.get("items", {}).items()}
    kept = scene.get("pinned", {}).get(name)
    if items and isinstance(kept, list):
        items = {item: value for item, value in items.items() if item in kept}
    low, high = {
        "Enumeration": lambda: (min(items.values()), max(items.values())),
        "Boolean": lambda: (0, 1),
    }.get(kind["base"], lambda: (row.get("min", kind.get("min")), row.get("max", kind.get("max"))))()
    values = {"key": key, "reference": 100 * blocks.get(owner, 0) + row["vr"] + component}
    values |= {"base": kind["base"], "type": row["type"], "causality": row["causality"]}
    values |= {"tunable": row.get("tunable", False), "unit": kind.get("unit"), "min": float(low)}
    values |= {"max": float(high), "start": start[component] if isinstance(start, list) else start}
    values |= {"component": component, "reinit": row.get("reinit", False), "symbol": row.get("symbol")}
    values |= {
        "named": row.get("rate_of", key),
        "length": row.get("dim", 1),
        "items": items,
        "description": row["description"],
    }
    return values


FIELDS = {
    "XML": ("reference", "base", "type", "causality", "unit", "min", "max", "items", "tunable"),
    "C": ("reference", "base", "causality", "min", "max", "component", "length", "reinit", "tunable"),
    "page": ("reference", "type", "causality", "unit", "tunable"),
}


def disagreements(files: dict[str, str], scene: dict) -> list[str]:
    """Returns one line for each thing that the files of a scene say differently."""
    xml, table = parse_xml(files["modelDescription.xml"]), parse_c(files["scene_variables.c"])
    page = parse_page(files["documentation/index.html"])
    found = []
    for source, variables in (("C table", table), ("page", page)):
        if list(variables) != list(xml):
            found.append(f"{source}: other variables or order: {sorted(set(variables) ^ set(xml))}")
    for name in xml.keys() & table.keys() & page.keys():
        wanted = expected(name, scene)
        for source, told in (("XML", xml), ("C", table), ("page", page)):
            found += _differences(f"{source} {name}", told[name], wanted, FIELDS[source])
        if table[name]["row"] != wanted["named"].replace(".", "_"):  # a rate has that of its state
            found.append(f"C {name}: row {table[name]['row']}")
        found += _page_texts(name, page[name], xml[name], wanted)
        if not _same_start(xml[name], wanted["start"]):
            found.append(f"XML {name}: start {xml[name]['start']}, expected {wanted['start']}")
    return found


def _differences(where: str, said: dict, wanted: dict, keys) -> list[str]:
    return [f"{where}: {key} {said[key]}, wanted {wanted[key]}" for key in keys if said[key] != wanted[key]]


def _same_start(entry: dict, wanted) -> bool:
    text = entry["start"]
    if wanted is None or text is None:
        return wanted is None and text is None
    if entry["base"] == "Boolean":
        return text == ("true" if wanted else "false")
    if entry["base"] == "Enumeration":
        return entry["items"].get(wanted) == int(text)
    return float(text) == float(wanted)


def _page_texts(name: str, said: dict, xml: dict, wanted: dict) -> list[str]:
    """Ranges, start, symbol and meaning as printed on the page."""
    found = []
    if wanted["base"] in ("Real", "Integer"):
        for key in ("min", "max"):
            if float(said[key]) != wanted[key]:
                found.append(f"page {name}: {key} {said[key]}, wanted {wanted[key]}")
    start = wanted["start"]
    shown = said["start"]
    if wanted["base"] in ("Real", "Integer") and start is not None:
        if shown is None or float(shown) != float(start):
            found.append(f"page {name}: start {shown}, wanted {start}")
    elif shown != (str(start).lower() if start is not None else None):
        found.append(f"page {name}: start {shown}, wanted {start}")
    words = re.sub(r"\\\{\w+\\\}", r"[\\w\\[\\]]+", re.escape(wanted["description"]))
    if not re.fullmatch(words, said["meaning"]) or not xml["description"].startswith(said["meaning"]):
        found.append(f"page {name}: '{said['meaning']}', XML '{xml['description']}'")
    if bool(said["symbol"]) != bool(wanted["symbol"]):
        found.append(f"page {name}: symbol '{said['symbol']}', wanted '{wanted['symbol']}'")
    if said["symbol"] and not xml["description"].replace("_", "").endswith(f"({said['symbol']})"):
        found.append(f"page {name}: symbol '{said['symbol']}' is not that of '{xml['description']}'")
    return found
