"""The command line: thin. It parses, calls a study, prints, and turns wrong input into one line.

Exit status 0: done and as declared; 1: a check differs or a run failed; 2: the input is wrong.
Imports are local, so that `grainproof --help` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from harness import __version__
from harness.arguments import OneLineParser, as_typed
from harness.errors import InputError, system_line
from harness.places import check_places


def main(arguments: list[str] | None = None) -> int:
    """Run one command; return the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] == ["average"]:
        return _average(words[1:])
    options = parser().parse_args(words)
    try:
        check_places(options)
        return options.run(options)
    except InputError as error:
        _complain(error, words)
        return 2
    except KeyboardInterrupt:
        print("grainproof: interrupted; finished runs are kept, the same command goes on from here", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader has seen enough; the interpreter must not write to it again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        _complain(error)
        return 1
    except ExceptionGroup as several:  # of runs side by side; a full disk, say, is nobody's bug
        if several.subgroup(lambda e: not isinstance(e, OSError | ExceptionGroup)):
            raise
        _complain(_first(several))
        return 1


def _first(several: ExceptionGroup) -> Exception:
    """Return the first error that is not itself a group."""
    error = several.exceptions[0]
    return _first(error) if isinstance(error, ExceptionGroup) else error


def _complain(error: Exception, words: Sequence[str] = ()) -> None:
    """Print one line that a terminal cannot be harmed by, whatever the user's words were; options as in `words`."""
    from harness.scene.fault import printable

    line = system_line(error) if isinstance(error, OSError) else str(error)
    print(f"grainproof: {printable(as_typed(line, words))}", file=sys.stderr)


def parser() -> argparse.ArgumentParser:
    """Return the command line's parser; every verb names the function that runs it."""
    from harness.verbs import add_all  # `average` needs none of them

    top = OneLineParser(
        prog="grainproof", description="Do two DEM codes agree? One scene, every code, one page.",
        epilog="Exit status: 0 done and as declared, 1 a check differs or a run failed, 2 the input is wrong.",
    )
    top.add_argument("--version", action="version", version=f"grainproof {__version__}")
    verbs = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    add_all(verbs)
    verbs.add_parser("average", help="the post-processor alone, on a neutral state file")
    return top


def _average(words: list[str]) -> int:
    """The post-processor has its own parser: it is a tool of its own and imports nothing of the harness."""
    from postproc.average import main as average

    return average(words, prog="grainproof average")


if __name__ == "__main__":
    sys.exit(main())
