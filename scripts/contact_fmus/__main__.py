"""contact-fmus COMMAND [OPTION ...]

Contact of spheres, cylinders, planes and tori as FMUs of FMI 2.0 and 3.0: build them from scenes, run them,
check them, measure them."""

import importlib
import os
import sys

from .errors import BAD_REQUEST, INTERRUPTED, OUTPUT_CLOSED, RUN_FAILED, UserError, similar
from .options import commands, parse

# name: (module and function, what it does). Modules are imported when asked for: some take a while.
COMMANDS = {name: (about["main"], about["text"]) for name, about in commands().items()}

# The extras of the Python package and the modules that each brings
BRINGS = {"plot": "matplotlib scipy", "sweep": "dask distributed pyarrow", "dev": "mpmath pandas", "zig": "ziglang"}
EXTRAS = {module: extra for extra, modules in BRINGS.items() for module in modules.split()}

STATUSES = """status: 0 done, 1 a claim does not hold or a check found something,
        2 the request makes no sense, 3 a run failed, 130 interrupted"""


def usage() -> str:
    """One line for each command"""
    lines = [f"  {name:14} {text}" for name, (_, text) in COMMANDS.items()]
    return "\n".join([__doc__, "", *lines, "", "contact-fmus COMMAND --help: its options", STATUSES])


def version() -> str:
    """The version of the installed package"""
    from importlib.metadata import PackageNotFoundError
    from importlib.metadata import version as installed

    try:
        return installed("contact-fmus")
    except PackageNotFoundError:
        return "not installed, run from its sources"


def os_error(error: OSError) -> tuple[str, int]:
    """The sentence and the status of a failed file operation: a wrong name is a bad request"""
    names = [str(name) for name in (error.filename, error.filename2) if name is not None]
    if isinstance(error, FileExistsError):  # of folders that are to be made
        return f"{names[0] if names else error}: this is a file, and a folder is needed", BAD_REQUEST
    text = ": ".join([*names, error.strerror]) if error.strerror else str(error)
    asked = (FileNotFoundError, FileExistsError, IsADirectoryError, NotADirectoryError, PermissionError)
    return text, BAD_REQUEST if isinstance(error, asked) else RUN_FAILED


def guarded(name: str, arguments: list[str]) -> int:
    """The command's status; an expected error is one sentence on stderr"""
    module, _, function = COMMANDS[name][0].partition(":")
    try:
        # No extra is needed to tell the options. Words in braces are the modules' own, which need no extra either.
        if not {"-h", "--help"}.isdisjoint(arguments) and "{" not in commands()[name]["description"]:
            parse(name, arguments)
        return getattr(importlib.import_module(f"contact_fmus.{module}"), function)(arguments)
    except UserError as error:
        text, status = str(error), error.exit_status
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("contact_fmus"):
            raise  # a fault of this package
        module, status = (error.name or "").partition(".")[0], BAD_REQUEST
        text = f"the Python package {module} is not installed: pip install {module}"
        if module in EXTRAS:
            text = f"this needs {module}: pip install 'contact-fmus[{EXTRAS[module]}]'"
    except BrokenPipeError:
        # Python would complain once more when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OUTPUT_CLOSED
    except OSError as error:
        text, status = os_error(error)
    except KeyboardInterrupt:
        text, status = "interrupted", INTERRUPTED
    print(f"contact-fmus {name}: {text}", file=sys.stderr)
    return status


def main(arguments: list[str] | None = None) -> int:
    """The command's status; 2 where there is no such command"""
    name, *rest = (sys.argv[1:] if arguments is None else arguments) or [""]
    if name in ("-h", "--help", "help"):
        print(usage())
        return 0
    if name == "--version":
        print(f"contact-fmus {version()}")
        return 0
    if name not in COMMANDS:
        text = f"unknown command '{name}'{similar(name, COMMANDS)}" if name else "a command is missing"
        print(f"contact-fmus: {text}; contact-fmus --help lists them", file=sys.stderr)
        return BAD_REQUEST
    return guarded(name, rest)


if __name__ == "__main__":
    sys.exit(main())
