"""The one error a wrong input file may raise: a line that names the file, the key and what is allowed."""


class InputError(Exception):
    """str() of it is the whole message for the user."""

    def __init__(self, file: str, text: str):
        super().__init__(f"{file}: {' '.join(text.split())}")


def allowed(names) -> str:
    """' (allowed: a, b, c)', sorted unless the order is given."""
    names = sorted(names) if isinstance(names, (set, frozenset, dict)) else list(names)
    return f"(allowed: {', '.join(names) if names else 'none'})"
