"""Formulas in the words of a page: $p_n = f_p E_ref diag$ becomes MathML, or plain text outside HTML

What may stand between two $: numbers (1e6 is 10 to the 6th), names with one index (p_n, E_ref), Greek names
(tau, pi), powers (x^2), sqrt(...), brackets and operators.
"""

from __future__ import annotations

import re

from markupsafe import Markup, escape

FORMULA = re.compile(r"\$([^$\n]+)\$")
GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "lambda": "λ",
    "mu": "μ", "omega": "ω", "pi": "π", "rho": "ρ", "sigma": "σ", "tau": "τ", "phi": "φ",
}  # fmt: skip
SIGNS = {"-": "−", "*": "·", "<=": "≤", ">=": "≥"}
TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?)(?:e(?P<power>[-+]?\d+))?"
    r"|(?P<name>[A-Za-zΑ-ω]+)(?:_(?P<index>\w+))?"
    r"|(?P<sign><=|>=|[-+*/=<>,()|·√^]))"
)


class FormulaError(ValueError):
    """Something that formulas do not have"""


def typeset(text: str) -> Markup:
    """The text for HTML, its formulas as MathML"""
    parts = FORMULA.split(text)
    return Markup("").join(
        Markup("<math>{}</math>").format(_Row(part).all()) if k % 2 else escape(part)
        for k, part in enumerate(parts)
    )


def plain(text: str) -> str:
    """The text for a terminal or Markdown: $sqrt(m/p_n)$ is √(m/p_n)"""
    return FORMULA.sub(lambda match: _plain(match[1]), text)


def _plain(formula: str) -> str:
    names = "|".join(GREEK)
    formula = re.sub(rf"\b({names})(?=\b|_)", lambda match: GREEK[match[1]], formula)
    return formula.replace("sqrt(", "√(").replace("<=", "≤").replace(">=", "≥").replace("*", "·")


class _Row:
    """One formula, read from left to right"""

    def __init__(self, text: str):
        self.text, self.tokens, at = text, [], 0
        while text[at:].strip():
            match = TOKEN.match(text, at)
            if match is None:
                raise FormulaError(f"formula '{text}': '{text[at:].strip()[0]}' is not known here")
            self.tokens.append(match)
            at = match.end()
        self.place = 0

    def all(self) -> Markup:
        row = self.until("")
        if self.place < len(self.tokens):
            raise FormulaError(f"formula '{self.text}': a bracket too many")
        return row

    def until(self, end: str) -> Markup:
        """What stands before the sign `end`"""
        parts: list[Markup] = []
        while self.place < len(self.tokens) and self.tokens[self.place]["sign"] != (end or ")"):
            if self.tokens[self.place]["sign"] == "^":
                self.place += 1
                parts.append(Markup("<msup>{}{}</msup>").format(parts.pop(), self.one()))
            else:
                if parts and self.place > 0 and not self.after_sign() and self.sign() in (None, "("):
                    parts.append(Markup('<mspace width="0.2em"/>'))  # a product
                parts.append(self.one())
        if end and self.place == len(self.tokens):
            raise FormulaError(f"formula '{self.text}': '{end}' is missing")
        return Markup("").join(parts)

    def one(self) -> Markup:
        """A number, a name, a root, a bracket or a sign"""
        if self.place == len(self.tokens):
            raise FormulaError(f"formula '{self.text}' ends too early")
        token = self.tokens[self.place]
        self.place += 1
        if token["number"]:
            return _number(token["number"], token["power"])
        if token["name"] == "sqrt" and self.sign() == "(":
            return Markup("<msqrt>{}</msqrt>").format(self.bracket())
        if token["name"]:
            return _name(token["name"], token["index"])
        if token["sign"] == "(":
            self.place -= 1
            return Markup("<mrow><mo>(</mo>{}<mo>)</mo></mrow>").format(self.bracket())
        return Markup("<mo>{}</mo>").format(SIGNS.get(token["sign"], token["sign"]))

    def after_sign(self) -> bool:
        """Whether an operator stands just before, so that what follows is no factor of a product"""
        return self.tokens[self.place - 1]["sign"] not in (None, ")")

    def sign(self) -> str | None:
        return self.tokens[self.place]["sign"] if self.place < len(self.tokens) else None

    def bracket(self) -> Markup:
        """What a pair of brackets holds; the place is at the opening one"""
        self.place += 1
        inner = self.until(")")
        self.place += 1
        return inner


def _number(digits: str, power: str | None) -> Markup:
    if power is None:
        return Markup("<mn>{}</mn>").format(digits)
    exponent = str(int(power)).replace("-", "−")
    ten = Markup("<msup><mn>10</mn><mn>{}</mn></msup>").format(exponent)
    return ten if digits == "1" else Markup("<mn>{}</mn><mo>·</mo>{}").format(digits, ten)


def _name(name: str, index: str | None) -> Markup:
    shown = Markup("<mi>{}</mi>").format(GREEK.get(name, name))
    return Markup("<msub>{}<mtext>{}</mtext></msub>").format(shown, index) if index else shown
