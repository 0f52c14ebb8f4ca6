"""What a scene's joined sources do not need: branches that the scene decides, by the preprocessor or by
`if`, functions and constants that nobody asks for. Every FMU carries the file.

It goes by how this project is formatted: definitions begin in the first column, and bodies end with a brace
there.
"""

import operator
import re
from collections import Counter

DIRECTIVE = re.compile(r"#(if|ifdef|ifndef|elif|else|endif)\b(.*)")
NAME = re.compile(r"[A-Za-z_]\w*")
DEFINED = re.compile(r"^#define ((?:SCENE|HAS|CONTACT_ANY)_\w+) (-?\d+)(?: */\*.*\*/)?$", re.MULTILINE)
# A function that returns one word, as those of scene.h do where the scene pins a choice
PINNED = re.compile(
    r"^static inline [\w ]+ (\w+)\([^)]*\)\n\{\n(?:    \(void\)\w+;\n)*    return (\w+);\n\}$", re.MULTILINE
)
ENUM = re.compile(r"^(?:typedef )?enum(?: \w+)? \{([^}]*)\}", re.MULTILINE)
CALLED = re.compile(r"(\w+)\(")
RESULT = re.compile(
    r"^(?:static )?(?:inline )?bool [^{]*\n\{\n(?:    \(void\)\w+;\n)*    return ([^;]*);\n\}$"
)
FLAG = re.compile(r"^static const (?:bool|int) \w+ = ([^;]*);$")
LOCAL = re.compile(r"^ +const (?:bool|int) (\w+) = ([^;]*);$", re.MULTILINE)
ASSIGNED = re.compile(r" [-+*/|&]?= ")
TO_ITSELF = re.compile(r"(\w+) = \1;")
COMPARE = {"==": operator.eq, "!=": operator.ne, "<": operator.lt, ">": operator.gt, "<=": operator.le}
COMPARE[">="] = operator.ge
BRACKETS = {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}
# What is no function: members, tags, attributes.
OTHER = re.compile(r"(?:->|\.)\w+|\b(?:struct|enum|union) \w+|__attribute__\(\(\w+")
VARIABLE = re.compile(r"(?:\b(?!sizeof |return )\w+(?: |\*| \*)|, \*?(?=\w+;))(\w+)(?=\[|;|,|\)| =)")
TYPE = re.compile(r"^(?:struct|union) (\w+) \{\n(?:[^}\n].*\n)+\};\n", re.MULTILINE)
CONSTANT = re.compile(r"(?:static )?const [\w ]*?[ *](\w+)(?:\[[^=]*)? =")


def pruned(text, scene_header, left_out):
    """The text of C as the macros of scene.h have it; left_out: all macros CONTACT_ANY_... that are 0"""
    values = {name: int(value) for name, value in DEFINED.findall(scene_header)}
    lines, rest = _chosen(text.split("\n"), 0, Conditions(values, left_out))
    assert rest == len(text.split("\n"))
    text = "\n".join(lines)
    values |= {name: int(value) for name, value in DEFINED.findall(text)} | dict.fromkeys(left_out, 0)
    known = Known(values | _enumerators(text))
    for name, word in PINNED.findall(scene_header):
        number = known.number(word)
        if number is not None:
            known.functions[name] = number
    pieces = _pieces(lines)
    while new := known.learn(pieces):
        for piece in pieces:
            if piece.is_function() and new & set(NAME.findall(piece.text())):
                while (made := _without_dead(piece.lines, known)) != piece.lines:
                    piece.lines = made
    wanted = _without_declarations(_wanted(pieces), scene_header)
    return _without_types("\n".join(line for piece in wanted for line in piece.lines), scene_header)


def _without_types(text, scene_header):
    """Without structures that are named nowhere but where they are defined"""
    named = Counter(NAME.findall(text + scene_header))
    less = TYPE.sub(lambda found: found[0] if named[found[1]] > 1 else "", text)
    return text if less == text else _without_types(less, scene_header)


def pruned_header(header, text):
    """scene.h without comments and without functions and constants that a text has no name of"""
    pieces = _pieces(header.split("\n"))
    for piece in pieces:
        found = re.match(r"#define (\w+) ", piece.lines[0])
        piece.name = found[1] if found else piece.name
    wanted = _wanted(pieces, NAME.findall(text))
    return "\n".join(line for piece in wanted for line in piece.lines)


def _enumerators(text):
    """The numbers of all items of enumerations"""
    values = {}
    for items in ENUM.findall(text):
        number = -1
        for item in items.split(","):
            name, _, given = item.strip().partition(" = ")
            number = number + 1 if not given else int(given) if given.isdigit() else values.get(given)
            if not name or number is None:
                break
            values[name] = number
    return values


class Conditions:
    """What is known of them when a scene's sources are joined"""

    def __init__(self, values, left_out):
        self.values = values
        self.left_out = left_out

    def value(self, kind, condition):
        """True or false, or None where a compiler decides"""
        condition = condition.strip()
        if kind in ("ifdef", "ifndef"):
            if not condition.startswith("CONTACT_ANY_"):
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
        declared = VARIABLE.findall(text) + VARIABLE.findall(self.text())
        return set(NAME.findall(text)) - (set(declared) - set(CALLED.findall(text)))


class Known:
    """What has one value in this scene: macros, constants, and functions such as those that consist of
    `return SCENE_ANY_CAPS && ...` alone"""

    def __init__(self, values, functions=None):
        self.values = dict(values)
        self.functions = dict(functions or {})
        self.told = set()

    def learn(self, pieces):
        """The names of what is known now and was not when it was asked before"""
        for piece in pieces:
            for pattern, names in ((RESULT, self.functions), (FLAG, self.values)):
                found = pattern.search(piece.text())
                value = self.value(found[1]) if found else None
                if value is not None:
                    names[piece.name] = int(value)
        before, self.told = self.told, {*self.values, *self.functions, "return"}
        return self.told - before

    def within(self, lines):
        """The same, with what a function's own constants are, of those that are declared once"""
        inside = Known(self.values, self.functions)
        text = "\n".join(lines)
        declared = VARIABLE.findall(text)
        inside.values = {name: value for name, value in inside.values.items() if name not in declared}
        for name, expression in LOCAL.findall(text):
            value = inside.value(expression)
            if value is not None and declared.count(name) == 1:
                inside.values[name] = int(value)
        return inside

    def value(self, condition):
        """True, false, or None where it is not known"""
        condition = " ".join(condition.split())
        asked = _split(condition, " ? ")[0]
        if asked != condition:  # a choice binds less than && and ||
            one, other = (self.value(choice) for choice in _choices(condition[len(asked) + 3 :]))
            chosen = one == other or self.value(asked)
            return None if chosen is None else one if chosen else other
        for sign, decides in (("||", True), ("&&", False)):
            parts = _split(condition, sign)
            if len(parts) > 1:
                values = [self.value(part) for part in parts]
                return decides if decides in values else None if None in values else not decides
        if condition.startswith("!"):
            value = self.value(condition[1:])
            return None if value is None else not value
        if condition.startswith("(") and _closed(condition, 0) == len(condition) - 1:
            return self.value(condition[1:-1])
        for sign, holds in COMPARE.items():
            parts = [self.number(part) for part in condition.split(f" {sign} ")]
            if len(parts) == 2:
                return None if None in parts else holds(*parts)
        number = self.number(condition)
        return None if number is None else number != 0

    def number(self, word):
        """That of a constant or of a function's call, or None"""
        if word.isdigit():
            return int(word)
        found = re.match(r"\w+(?=\()", word)
        if found and _closed(word, found.end()) == len(word) - 1:
            return self.functions.get(found[0])
        return {"true": 1, "false": 0}.get(word, self.values.get(word))


def _closed(text, at):
    """Where the bracket at a place is closed"""
    depth = 0
    for place in range(at, len(text)):
        depth += BRACKETS.get(text[place], 0)
        if depth == 0:
            return place
    return len(text)


def _split(text, sign):
    """At a sign that is in no bracket"""
    parts, depth, start = [], 0, 0
    for place, character in enumerate(text):
        depth += BRACKETS.get(character, 0)
        if depth == 0 and text.startswith(sign, place):
            parts.append(text[start:place])
            start = place + len(sign)
    return [*parts, text[start:]]


def _simple(text, known):
    """An expression, or several, without operands and choices that are known to have no effect"""
    for sign in (";", ","):
        parts = _split(text, sign)
        if len(parts) > 1:
            return sign.join(_simple(part, known) for part in parts)
    assigned = ASSIGNED.search(text)
    if assigned and _split(text, assigned[0])[0] == text[: assigned.start()]:
        return text[: assigned.end()] + _simple(text[assigned.end() :], known)
    if text.strip().startswith("return "):
        rest = text[text.index("return ") + 7 :]
        return text[: -len(rest)] + _simple(rest, known)
    begins = text[: len(text) - len(text.lstrip())]
    return begins + _simple_value(text[len(begins) :], known)


def _simple_value(text, known):
    condition = _split(text, " ? ")[0]
    if condition != text:
        first, second = _choices(text[len(condition) + 3 :])
        value = known.value(condition)
        if value is not None:
            return _simple_value(first if value else second, known)
        parts = [_simple_value(part, known) for part in (condition, first, second)]
        return f"{parts[0]} ? {parts[1]} : {parts[2]}"
    for sign in (" || ", " && "):
        parts = _split(text, sign)
        if len(parts) > 1:
            value = known.value(text)
            if value is not None:
                return str(value).lower()
            return sign.join(_simple_value(part, known) for part in parts if known.value(part) is None)
    return _in_brackets(text, known)


def _choices(text):
    """The two results of `condition ? one : other`, of which the first may be such a choice itself"""
    depth = inside = 0
    for place, character in enumerate(text):
        depth += BRACKETS.get(character, 0)
        if depth == 0 and text.startswith((" ? ", " : "), place):
            inside += 1 if text[place + 1] == "?" else -1
            if inside < 0:
                return text[:place], text[place + 3 :]
    raise ValueError(text)


def _in_brackets(text, known):
    made, at = "", 0
    while at < len(text):
        made += text[at]
        if text[at] in "([{":
            end = _closed(text, at)
            made += _simple(text[at + 1 : end], known) + text[end : end + 1]
            at = end
        at += 1
    return made


def _without_dead(lines, known):
    """A function without what never happens: operands, branches, loops, what is behind a return"""
    begin = lines.index("{") + 1
    known = known.within(lines)
    kept, at = [], begin
    while at < len(lines) - 1:
        statement = _statement(lines, at)
        at += len(statement)
        kept += _simple_statement(statement, known)
    return [*lines[:begin], *_alive(kept, known), "}"]


def _statement(lines, at):
    """The lines of a statement, of the head of a block, or of a block's end"""
    depth = 0
    for end in range(at, len(lines)):
        line = lines[end].strip()
        depth += sum(BRACKETS.get(character, 0) for character in line.removeprefix("}"))
        block = depth == 1 and re.search(r"(?<!=) \{$", line)
        if block or (depth == 0 and re.search(r"^#|^\}$|;$|^(?:case .*|\w+):$|^$", line)):
            return lines[at : end + 1]
    return lines[at : at + 1]  # a compiler chooses between lines of which each opens the same bracket


def _simple_statement(lines, known):
    first = lines[0].lstrip()
    text = " ".join([first, *(line.strip() for line in lines[1:])])
    if '"' in text or "'" in text or not re.search(r" (?:&&|\|\||\?) ", text):
        return lines
    end = 1 if text[-1] in ";{:" else 0
    begin = 2 if text.startswith("} ") else 0  # of `} else if (...) {`
    body = text[begin : len(text) - end]
    made = text[:begin] + _simple(body, known) + text[len(text) - end :]
    if TO_ITSELF.fullmatch(made):
        return []
    return lines if made == text else [lines[0][: -len(first)] + made]


def _alive(lines, known):
    """The statements of a block without those that are never reached"""
    indent = next((re.match(" *", line)[0] for line in lines if line[:1] == " "), "")
    choice = any(line.startswith("#") for line in lines)  # a compiler's
    kept, at = [], 0
    while at < len(lines):
        begins = re.match(r"( +)(?:if|for|while) \(.*", lines[at])
        if not begins:
            kept.append(lines[at])
            returns = re.match(rf"{indent}return\b", lines[at])
            at += 1
            if returns and not choice:
                while not kept[-1].endswith(";"):
                    kept.append(lines[at])
                    at += 1
                return kept
            continue
        branches, at = _branches(lines, at, begins[1])
        made = _chosen_branches(branches, begins[1], known)
        kept += made
        if begins[1] == indent and not choice and made and made[0].strip() != "{" and _returns(made, indent):
            return kept
    return kept


def _returns(lines, indent):
    """Whether the last statement of a block is a return"""
    last = [line for line in lines if line.startswith(indent) and line[len(indent)] != " "]
    return last[-1].startswith(f"{indent}return")


def _chosen_branches(branches, indent, known):
    """Those of an `if` or a loop that may be taken, each without what is dead in it"""
    made = []
    for head, inside in branches:
        value = known.value(_condition(head))
        if value is False:
            continue
        inside = _alive(inside, known)
        loops = re.match(" +(?:for|while) ", head[0])
        if value is None or loops:
            made += [head[0] if made else head[0].replace("} else ", "", 1), *head[1:], *inside]
            continue
        if made:
            return [*made, f"{indent}}} else {{", *inside, f"{indent}}}"]
        if inside and _returns(inside, indent + "    "):
            return [line.removeprefix("    ") for line in inside]
        return [f"{indent}{{", *inside, f"{indent}}}"]
    return [*made, f"{indent}}}"] if made else []


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
    """What decides; of a mere `else` what is true"""
    text = " ".join(line.strip() for line in head)
    opened = text.find("(")
    condition = text[opened + 1 : _closed(text, opened)] if opened >= 0 else "true"
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
        if re.search(r", \w+ = ", line):
            raise ValueError(f"a line declares several constants, which are left out one by one: {line}")
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


def _wanted(pieces, asked=()):
    """Without functions and constants that neither FMI nor anything that is kept has a name of"""
    of_name = {}
    for piece in pieces:
        of_name.setdefault(piece.name, []).append(piece)
    waiting = [*asked, *(name for piece in of_name.get(None, []) for name in piece.needs())]
    waiting += [name for name in of_name if name and re.match(r"fmi[23][A-Z]", name)]
    needed = set()
    while waiting:
        name = waiting.pop()
        if name not in needed:
            needed.add(name)
            waiting += [other for piece in of_name.get(name, ()) for other in piece.needs()]
    return [piece for piece in pieces if piece.name is None or piece.name in needed]


def _without_declarations(pieces, scene_header):
    """Without declarations of functions that nothing names before their definitions; those with attributes
    and those that a macro names stay"""
    macros = "".join(piece.text() for piece in pieces if piece.lines[0].startswith("#define "))
    kept, first = [], dict.fromkeys(NAME.findall(macros))
    for piece in reversed(pieces):
        named = first.get(piece.name)
        if piece.declares and named and named.name == piece.name and "CONTACT_" not in piece.text():
            continue
        if not piece.declares:
            text = scene_header if piece.text() == '#include "scene.h"' else piece.text()
            first |= {name: piece for name in NAME.findall(text) if first.get(name, piece)}
        kept.append(piece)
    return kept[::-1]
