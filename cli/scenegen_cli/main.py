"""The `scenegen` command: find the subcommand, load only that, turn what goes wrong into one line and an exit code."""

from __future__ import annotations

import importlib
import os
import signal
import sys
from collections.abc import Sequence

from scenegen_cli.console import complain, say
from scenegen_cli.leaving import INTERRUPTED, TERMINATED, HelpShown, TerminatedError, terminate

GROUPS = {
    "make": {
        "demo": "make a few pairs in a minute and show where the pictures are",
        "render": "make a dataset, resume one, or grow one",
        "status": "how far a dataset is while it is being made",
        "sense": "look at the stored radiance through another camera",
    },
    "look": {
        "info": "what a dataset holds",
        "preview": "draw contact sheet and animation of a dataset",
        "view": "look at a dataset in a browser",
        "report": "a dataset on one page: pictures, audits, provenance, cost",
        "audit": "measure what a dataset is like",
    },
    "keep and share": {
        "verify": "check every byte, array and rule of a dataset",
        "repair": "bring a damaged dataset back to the bytes it had",
        "clean": "remove from a dataset what is no part of it",
        "release": "verify a dataset and give it a version",
        "diff": "compare two datasets, and say which version the change needs",
        "merge": "join several datasets into one",
        "export": "write a dataset in a format other tools read",
        "push": "copy a dataset to a Hub or any storage",
    },
    "learn and fly": {
        "train": "teach a depth network on a dataset",
        "evaluate": "judge a trained network",
        "fly": "fly missions in closed loop and count collisions",
        "table1": "the paper's Table 1 on a dataset",
        "table2": "the paper's Table 2 in closed loop",
        "onnx": "export a trained network, and what it costs",
        "budget": "what depth networks cost a drone",
    },
    "know": {
        "doctor": "check this machine and say what to do",
        "maps": "list the kinds of worlds, or look at one",
        "classes": "list the semantic classes",
        "materials": "list the materials",
        "sensors": "list the cameras",
    },
}
"""Subcommands by what they are for; each is a module of this package with ``run(arguments) -> exit code``."""

COMMANDS = {name: meaning for group in GROUPS.values() for name, meaning in group.items()}
"""All subcommands."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns
    -------
    int
        0 ok, 1 a check failed, 2 bad input, 3 finished with quarantined clips, 4 no space left, 130/143 interrupted.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    if words[0:1] == ["help"] and words[1:]:
        words = [words[1], "--help"]
    if not words or words[0] in ("-h", "--help", "help"):
        say(_help())
        return 0 if words else 2
    if words[0] == "--version":
        from importlib.metadata import version

        say(f"scenegen {version('thermal-scenegen')}")
        return 0
    before = signal.signal(signal.SIGTERM, terminate)
    try:
        return _run(words)
    except HelpShown:
        return 0
    except KeyboardInterrupt:
        return INTERRUPTED
    except TerminatedError:
        return TERMINATED
    except BrokenPipeError:
        # The reader left, as in `scenegen ... | head`.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        return _explain(error)
    finally:
        signal.signal(signal.SIGTERM, before)


def _run(words: list[str]) -> int:
    name, rest = words[0], words[1:]
    if name not in COMMANDS:
        from scenegen.foundation.errors import InputError, nearest

        raise InputError(f"unknown command '{name}'{nearest(name, COMMANDS)}")
    module = importlib.import_module(f"scenegen_cli.{name}")
    code = module.run(rest)
    assert isinstance(code, int)
    return code


def _explain(error: Exception) -> int:
    """One line for a user; a bug's traceback goes to a file, which the line names."""
    from pathlib import Path

    from scenegen.foundation.atomic import explained, is_full
    from scenegen.foundation.errors import ScenegenError

    if isinstance(error, OSError) and is_full(error):
        error = explained(error, Path(error.filename or "what is written"))
    if isinstance(error, ScenegenError):
        complain(" ".join(str(error).split()))
        return error.exit_code
    import tempfile
    import traceback

    with tempfile.NamedTemporaryFile(
        "w", prefix="scenegen-", suffix=".txt", delete=False, encoding="utf-8"
    ) as file:
        file.write("".join(traceback.format_exception(error)))
    complain(
        f"a bug: {type(error).__name__}: {' '.join(str(error).split())[:200]}; the traceback is in {file.name}"
    )
    return 1


def _help() -> str:
    width = max(map(len, COMMANDS))
    groups = "\n\n".join(
        "\n".join([f"{title}:", *(f"  {name:<{width}}  {meaning}" for name, meaning in group.items())])
        for title, group in GROUPS.items()
    )
    return (
        "usage: scenegen COMMAND [flags]\n\n"
        "Paired thermal and depth datasets from procedural worlds.\n\n"
        f"{groups}\n\n"
        "'scenegen COMMAND --help' explains one; start with 'scenegen demo'.\n"
        "exit codes: 0 ok, 1 a check failed, 2 bad input, 3 finished without some clips or flights, 4 no space left,\n"
        "            130/143 interrupted"
    )


if __name__ == "__main__":
    sys.exit(main())
