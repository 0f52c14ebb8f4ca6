"""What a scene's joined sources do not need: branches that the scene decides, by the preprocessor or by
`if`, functions and constants that nobody asks for. Every FMU carries the file.

It goes by how this project is formatted: definitions begin in the first column, and bodies end with a brace
there.
"""

import re

DIRECTIVE = re.compile(r"#(if|ifdef|ifndef|elif|else|endif)\b(.*)")
NAME = re.compile(r"[A-Za-z_]\w*")
DEFINED = re.compile(r"^#define ((?:SCENE|CONTACT_ANY)_\w+) (-?\d+)(?: */\*.*\*/)?$", re.MULTILINE)
CALLED = re.compile(r"(\w+)\(")
RESULT = re.compile(r"^(?:static )?(?:inline )?bool [^{]*\n\{\n    return ([^;]*);\n\}$")
# What is no function: members, tags, attributes.
OTHER = re.compile(r"(?:->|\.)\w+|\b(?:struct|enum|union) \w+|__attribute__\(\(\w+")
VARIABLE = re.compile(r"(?:\b(?!sizeof |return )\w+(?: |\*| \*)|, \*?(?=\w+;))(\w+)(?=\[|;|,|\)| =)")
CONSTANT = re.compile(r"(?:static )?const [\w ]*?[ *](\w+)(?:\[[^=]*)? =")


def pruned(text, scene_header, left_out):
    """The text of C as the macros of scene.h have it; left_out: all macros CONTACT_NO_... that are defined"""
    known = {name: int(value) for name, value in DEFINED.findall(scene_header)}
    lines, rest = _chosen(text.split("\n"), 0, Conditions(known, left_out))
    assert rest == len(text.split("\n"))
    known |= {name: int(value) for name, value in DEFINED.findall("\n".join(lines))}
    pieces = _pieces(lines)
    never = Never(known, pieces)
    for piece in pieces:
        if piece.is_function():
            piece.lines = _without_dead(piece.lines, never)
    return "\n".join(line for piece in _wanted(pieces) for line in piece.lines)


class Conditions:
    """What is known of them when a scene's sources are joined"""

    def __init__(self, values, left_out):
        self.values = values
        self.left_out = left_out

    def value(self, kind, condition):
        """True or false, or None where a compiler decides"""
        condition = condition.strip()
        if kind in ("ifdef", "ifndef"):
            if not condition.startswith("CONTACT_NO_"):
                return None
            return (condition in self.left_out) == (kind == "ifdef")
        names = NAME.findall(condition)
        if not names or not all(name in self.values for name in names):
            return None
        condition = NAME.sub(lambda found: str(self.values[found[0]]), condition)
        condition = condition.replace("&&", " and ").replace("||", " or ")
        return bool(eval(re.sub(r"!(?!=)", " not ", condition), {"__builtins__": {}}))


def _chosen(lines, at, conditions):
    """Lines up to an #elif, #else or #endif of nobody here, and where that is"""
    kept = []
    while at < len(lines):
        found = DIRECTIVE.match(lines[at])
        if not found:
            kept.append(lines[at])
            at += 1
        elif found[1] in ("elif", "else", "endif"):
            break
        else:
            group, at = _group(lines, at, conditions)
            kept += group
    return kept, at


def _group(lines, at, conditions):
    """An #if with its #endif: one branch of it where all is known, else all of them"""
    whole, branches = [], []
    while True:
        kind, condition = DIRECTIVE.match(lines[at]).groups()
        head = lines[at]
        if kind == "endif":
            break
        inside, at = _chosen(lines, at + 1, conditions)
        value = True if kind == "else" else conditions.value(kind, condition)
        branches.append((value, inside))
        whole += [head, *inside]
    for value, inside in branches:
        if value is None:
            return [*whole, lines[at]], at + 1
        if value:
            return inside, at + 1
    return [], at + 1


class Piece:
    """A function's definition or declaration, a constant, or a line of anything else, which has no name"""

    def __init__(self, lines, name=None, declares=False):
        self.lines = lines
        self.name = name
        self.declares = declares

    def is_function(self):
        return self.lines[-1] == "}" and self.name is not None

    def text(self):
        return "\n".join(self.lines)

    def needs(self):
        """Names in it, without those of its variables; the declaration of a function needs only its types"""
        if self.declares:
            return set()
        text = OTHER.sub("", self.text())
        return set(NAME.findall(text)) - (set(VARIABLE.findall(text)) - set(CALLED.findall(text)))


class Never:
    """What is false in this scene: macros that are 0, and functions that return nothing else, as those do
    that consist of `return SCENE_ANY_CAPS && ...` alone"""

    def __init__(self, known, pieces):
        self.names = {name for name, value in known.items() if value == 0}
        results = {piece.name: found[1] for piece in pieces if (found := RESULT.search(piece.text()))}
        before = None
        while before != len(self.names):
            before = len(self.names)
            self.names |= {name for name, result in results.items() if self.holds_not(result)}

    def holds_not(self, condition):
        """Whether it is known to be false"""
        condition = " ".join(condition.split())
        either = _split(condition, "||")
        if len(either) > 1:
            return all(self.holds_not(one) for one in either)
        both = _split(condition, "&&")
        if len(both) > 1:
            return any(self.holds_not(one) for one in both)
        if condition.startswith("(") and _closed(condition, 0) == len(condition) - 1:
            return self.holds_not(condition[1:-1])
        found = re.match(r"\w+", condition)
        rest = condition[found.end() :] if found else "none"
        called = rest.startswith("(") and _closed(rest, 0) == len(rest) - 1
        return found is not None and found[0] in self.names and (called or not rest)


def _closed(text, at):
    """Where the bracket at a place is closed"""
    depth = 0
    for place in range(at, len(text)):
        depth += {"(": 1, ")": -1}.get(text[place], 0)
        if depth == 0:
            return place
    return len(text)


def _split(text, operator):
    """At an operator that is in no bracket"""
    parts, depth, start = [], 0, 0
    for place, character in enumerate(text):
        depth += {"(": 1, ")": -1}.get(character, 0)
        if depth == 0 and text.startswith(operator, place):
            parts.append(text[start:place])
            start = place + len(operator)
    return [*parts, text[start:]]


def _without_dead(lines, never):
    """Without the branches and loops that are never taken"""
    kept, at = [], 0
    while at < len(lines):
        begins = re.match(r"( +)(?:if|for) \(", lines[at])
        if not begins:
            kept.append(lines[at])
            at += 1
            continue
        branches, at = _branches(lines, at, begins[1])
        alive = [branch for branch in branches if not never.holds_not(_condition(branch[0]))]
        for number, (head, inside) in enumerate(alive):
            first = head[0] if number else head[0].replace("} else ", "", 1)
            kept += [first, *head[1:], *_without_dead(inside, never)]
        if alive:
            kept.append(begins[1] + "}")
    return kept


def _branches(lines, at, indent):
    """The heads of `if ... else if ... else`, or of a loop, each with what is inside; and where they end"""
    found = []
    while True:
        head = _until(lines, at, "{")
        at += len(head)
        end = next(k for k in range(at, len(lines)) if lines[k].startswith(indent + "}"))
        found.append((head, lines[at:end]))
        at = end
        if lines[end] == indent + "}":
            return found, end + 1


def _condition(head):
    text = " ".join(line.strip() for line in head)
    opened = text.find("(")
    condition = text[opened + 1 : _closed(text, opened)] if opened >= 0 else ""
    return condition.split(";")[1] if text.startswith("for ") else condition


def _pieces(lines):
    found, at = [], 0
    while at < len(lines):
        piece = _piece(lines, at)
        found.append(piece)
        at += len(piece.lines)
    return found


def _piece(lines, at):
    line = lines[at]
    constant = CONSTANT.match(line)
    if constant:
        return Piece(_until(lines, at, ";"), constant[1])
    if line.startswith("extern "):  # what it declares is there for whoever else asks for it
        return Piece(_until(lines, at, ";"), declares=True)
    if not re.match(r"[A-Za-z_]", line) or line.startswith(("typedef ", "_Static_assert")):
        return Piece([line])
    if re.match(r"[A-Z][A-Z0-9_]*\(", line):  # a macro that makes a function
        end = at
        while (text := "\n".join(lines[at : end + 1])).count("(") > text.count(")"):
            end += 1
        return Piece(lines[at : end + 1])
    head = _until(lines, at, (";", "{", "}"))  # a long type has a line of its own
    if not re.match(r"[A-Za-z_][^=]*\(", " ".join(head)):
        return Piece([line])
    called = re.search(r"(\w+)\(", re.sub(r"\b[A-Z]+_[A-Z_]+(?:\([^()]*\))?", "", " ".join(head)))
    if called is None or any(one.startswith("#") for one in head) or "=" in " ".join(head):
        return Piece([line])
    if head[-1].endswith(";"):
        return Piece(head, called[1], declares=True)
    if head[-1] == "{":
        end = lines.index("}", at)
        return Piece(lines[at : end + 1], called[1])
    return Piece([line])


def _until(lines, at, ends):
    end = at
    while not lines[end].endswith(ends):
        end += 1
    return lines[at : end + 1]


def _wanted(pieces):
    """Without functions and constants that neither FMI nor anything that is kept has a name of"""
    of_name = {}
    for piece in pieces:
        of_name.setdefault(piece.name, []).append(piece)
    waiting = [name for piece in of_name.get(None, []) for name in piece.needs()]
    waiting += [name for name in of_name if name and re.match(r"fmi[23][A-Z]", name)]
    needed = set()
    while waiting:
        name = waiting.pop()
        if name not in needed:
            needed.add(name)
            waiting += [other for piece in of_name.get(name, ()) for other in piece.needs()]
    return [piece for piece in pieces if piece.name is None or piece.name in needed]
