"""Run a module of the harness under another Python, which does not have it: ``OTHER_PYTHON apart.py MODULE ...``.

Only the package `harness` is made known there, by its place: nothing else of this environment gets onto that Python's
path, so that its own libraries are the ones that answer. The modules meant for it import no more than that Python
can be asked to have.
"""

import importlib.util
import runpy
import sys
from pathlib import Path


def make_known(name: str, folder: Path) -> None:
    """Import the package in `folder` as `name`."""
    spec = importlib.util.spec_from_file_location(
        name, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    spec.loader.exec_module(package)


if __name__ == "__main__":
    sys.path.pop(0)  # this script's own folder
    sys.argv = sys.argv[1:]
    make_known("harness", Path(__file__).resolve().parents[1])
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
