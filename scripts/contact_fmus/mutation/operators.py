"""The small ways in which a C source can be broken: one change of one token, condition or statement.

Comments, strings and preprocessor lines are left alone. A change that does not compile is no harm: it is
thrown away later.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

_TOKEN = re.compile(
    r"""(?P<skip>\s+|//[^\n]*|/\*.*?\*/|\#(?:\\\n|[^\n])*|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
      |(?P<number>(?:0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[uUlLfF]*)
      |(?P<name>[A-Za-z_]\w*)
      |(?P<sign>->|\+\+|--|<<=|>>=|\.\.\.|[-+*/%&|^<>=!]=|&&|\|\||<<|>>|[-+*/%&|^~!<>=?:;,.(){}\[\]])""",
    re.VERBOSE | re.DOTALL,
)
_KEYWORDS = {
    *("return", "if", "else", "for", "while", "do", "switch", "case", "default", "break", "continue", "goto"),
    *(
        "sizeof",
        "struct",
        "enum",
        "union",
        "const",
        "static",
        "inline",
        "extern",
        "typedef",
        "void",
        "double",
    ),
    *("int", "char", "bool", "unsigned", "long", "float", "size_t", "volatile", "__attribute__"),
}
_SIGNS = {
    **{
        "<": ("<=", ">="),
        "<=": ("<", ">"),
        ">": (">=", "<="),
        ">=": (">", "<"),
        "==": ("!=",),
        "!=": ("==",),
    },
    **{"&&": ("||",), "||": ("&&",), "+=": ("-=",), "-=": ("+=",), "*=": ("/=",), "/=": ("*=",)},
    **{"++": ("--",), "--": ("++",), "+": ("-",), "-": ("+",), "*": ("/",), "/": ("*",), "%": ("*",)},
    **{"&": ("|",), "|": ("&",), "<<": (">>",), ">>": ("<<",)},
}
_NAMES = {
    **{"fmin": "fmax", "fmax": "fmin", "sin": "cos", "cos": "sin", "floor": "ceil", "ceil": "floor"},
    **{
        "true": "false",
        "false": "true",
        "fabs": "",
        "sqrt": "",
        "vec3_add": "vec3_sub",
        "vec3_sub": "vec3_add",
    },
}
_KIND = {"&&": "logical", "||": "logical", "==": "relational", "!=": "relational"}


class Token(NamedTuple):
    kind: str
    text: str
    start: int

    @property
    def end(self) -> int:
        return self.start + len(self.text)


class Change(NamedTuple):
    """Characters `start` to `end` of the file become `text`"""

    kind: str
    start: int
    end: int
    text: str


def tokens_of(source: str) -> list[Token]:
    return [
        Token(one.lastgroup, one[0], one.start())
        for one in _TOKEN.finditer(source)
        if one.lastgroup != "skip"
    ]


def changes_of(source: str) -> list[Change]:
    """Every change, in the order of the file"""
    tokens = tokens_of(source)
    found = set()
    for index in range(1, len(tokens) - 1):
        found.update(_of_token(tokens, index))
        found.update(_of_condition(source, tokens, index))
        found.update(_of_statement(source, tokens, index))
    return sorted(one for one in found if source[one.start : one.end] != one.text)


def _of_token(tokens: list[Token], index: int) -> Iterator[Change]:
    before, token = tokens[index - 1], tokens[index]
    ends_value = before.text in (")", "]") or (
        before.kind in ("number", "name")
        and before.text not in _KEYWORDS
        and tokens[index - 2].text not in ("struct", "enum")  # struct thing *x
    )
    if token.kind == "number":
        for text in _other_numbers(token.text):
            yield Change("constant", token.start, token.end, text)
    elif token.kind == "name" and token.text in _NAMES:
        yield Change("function", token.start, token.end, _NAMES[token.text])
    elif token.text in ("!", "-") and not ends_value:
        yield Change("sign", token.start, token.end, "")
    elif token.text in _SIGNS and (ends_value or token.text in ("++", "--")):
        relational = (
            token.text[0] in "<>" and len(token.text.strip("<>")) < 2 and token.text not in ("<<", ">>")
        )
        kind = _KIND.get(token.text, "relational" if relational else "arithmetic")
        for text in _SIGNS[token.text]:
            yield Change(kind, token.start, token.end, text)


def _other_numbers(text: str) -> list[str]:
    if re.fullmatch(r"\d+", text):
        value = int(text)
        return [str(value + 1), *([str(value - 1)] if value else [])]
    if not re.fullmatch(r"[\d.eE+-]+", text):
        return []
    return ["1.0"] if float(text) == 0.0 else ["0.0", f"(2.0 * {text})", f"(0.5 * {text})"]


def _of_condition(source: str, tokens: list[Token], index: int) -> Iterator[Change]:
    """The condition of `if` or `while` negated or never met, that of `?:` always or never met"""
    token = tokens[index]
    if token.text in ("if", "while") and tokens[index + 1].text == "(":
        last = _closing(tokens, index + 1)
        if last is not None:
            start, end = tokens[index + 1].start, tokens[last].end
            yield Change("condition", start, end, f"(!{source[start:end]})")
            yield Change("condition", start, end, f"(0 && {source[start:end]})")
    elif token.text == "?":
        yield Change("condition", token.start, token.end, "&& 0 ?")
        yield Change("condition", token.start, token.end, "|| 1 ?")


def _closing(tokens: list[Token], index: int) -> int | None:
    depth = 0
    for place in range(index, len(tokens)):
        depth += {"(": 1, ")": -1}.get(tokens[place].text, 0)
        if depth == 0:
            return place
    return None


def _of_statement(source: str, tokens: list[Token], index: int) -> Iterator[Change]:
    """A statement that is not done, a value that is not returned"""
    before, token = tokens[index - 1], tokens[index]
    if before.text not in (";", "{", "}", ")", "else") or token.kind != "name":
        return
    end = next((i for i in range(index, len(tokens)) if tokens[i].text in (";", "{", "}")), None)
    if end is None or tokens[end].text != ";":
        return
    if token.text == "return" and end > index + 1:
        first, last = tokens[index + 1], tokens[end - 1]
        yield Change("returned", first.start, last.end, "0")
        yield Change("returned", first.start, last.end, f"-({source[first.start : last.end]})")
    elif token.text in ("break", "continue"):
        yield Change("statement", token.start, token.end, "")
    elif token.text not in _KEYWORDS and not _declares(tokens, index):
        yield Change("statement", token.start, tokens[end - 1].end, "")


def _declares(tokens: list[Token], index: int) -> bool:
    after = tokens[index + 1]
    return after.kind == "name" or (after.text == "*" and tokens[index + 2].kind == "name")
