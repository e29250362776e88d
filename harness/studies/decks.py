"""The committed decks: what every engine is told for the shipped scenes, kept beside the scenes.

`inputs/decks/<scene>/<engine>/` holds each deck file as the engine renders it, and nothing else. A file
with more than `LARGEST` bytes (the particles of a big packing) is generated data: instead of it there
is `<file>.sha256`, so that git notices when it changes. The packing is made by elementwise IEEE
arithmetic only, so these bytes do not depend on the machine. The discs of a ring have flowed, which
multiplies every last bit: in its committed decks stand the discs that they grow from, in decks written
elsewhere the real ones.
"""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.engines.protocol import takes
from harness.engines.registry import ENGINES
from harness.errors import InputError
from harness.packing.stand_in import stand_in
from harness.scene.load import load_scene
from harness.scene.model import Couette
from harness.scene.resolve import resolve, scene_name
from harness.studies.prepare import prepare

LARGEST = 30_000
"""Bytes; about 250 discs."""

Decks = Mapping[str, str]
"""Deck texts by ``<scene>/<engine>/<file>``."""


def shipped_scenes() -> list[Path]:
    """Return the scene files of this checkout, sorted; InputError when there is none."""
    found = sorted((_inputs() / "scenes").glob("*.toml"))
    if not found:
        raise InputError(file=_inputs() / "scenes", expected="scene files (*.toml)", got="none", fix="name them")
    return found


def default_decks_folder() -> Path:
    """Return inputs/decks of this checkout."""
    return _inputs() / "decks"


def rendered_decks(scenes: Sequence[Path], *, flowed: bool = False) -> dict[str, str]:
    """Return what the decks folder must hold for these scenes, for all engines that take them.

    Only a scene's first packing is rendered. flowed: with the discs of a ring as they start a run. Raises
    InputError for a scene that is wrong, or two scenes of one name, whose decks would overwrite each other.
    """
    names = [scene_name(s.stem) for s in scenes]
    twice = next((s for k, s in enumerate(scenes) if names[k] in names[:k]), None)
    if twice is not None:
        raise InputError(file=twice, expected="scenes of different names", got=f"{scene_name(twice.stem)} again")
    with tempfile.TemporaryDirectory() as cache:
        return {name: text for s in scenes for name, text in _decks_of(s, Path(cache), flowed).items()}


def check_decks(decks: Decks, folder: Path, *, whole: bool) -> list[dict]:
    """Compare with the disk; return one row a file: scene, file, state.

    States: current, stale, missing, left over (on disk, but nothing that is rendered). whole: look for
    left-overs in all of `folder`, not only where these scenes have decks.
    """
    rows = [(name, _state(folder / name, text)) for name, text in decks.items()]
    rows += [(name, "left over") for name in _left_over(decks, folder, whole=whole)]
    return [_row(name, state) for name, state in rows]


def write_decks(decks: Decks, folder: Path, *, whole: bool, remove: bool) -> list[dict]:
    """Write what is not current; return the rows of `check_decks` with what was done as state.

    remove: delete what is left over; only for a folder that holds decks and nothing of the user's.
    """
    from harness.runs.atomic import write_text_atomic

    rows = check_decks(decks, folder, whole=whole)
    for row in rows:
        path = folder / row["scene"] / row["file"]
        if row["state"] in ("stale", "missing"):
            path.parent.mkdir(parents=True, exist_ok=True)
            write_text_atomic(path, decks[f"{row['scene']}/{row['file']}"])
            row["state"] = "written"
        elif row["state"] == "left over" and remove:
            path.unlink()
            row["state"] = "removed"
    return rows


def _decks_of(scene_file: Path, cache: Path, flowed: bool) -> dict[str, str]:
    scene = load_scene(scene_file)
    if isinstance(scene, Couette) and not flowed:
        system = resolve(scene, scene_file, stand_in(scene))
    else:
        system = prepare(scene, scene_file, packings=1, cache=cache)[0].system
    able = [e for e in ENGINES.values() if takes(e, system)]
    folders = {f"{system.scene_name}/{e.name.replace(':', '-')}": e.render(system) for e in able}
    return dict(_kept(f"{folder}/{name}", text) for folder, deck in folders.items() for name, text in deck.items())


def _kept(name: str, text: str) -> tuple[str, str]:
    """Return the file to be kept: itself, or its hash in the format of sha256sum."""
    data = text.encode()
    if len(data) <= LARGEST:
        return name, text
    return f"{name}.sha256", f"{hashlib.sha256(data).hexdigest()}  {Path(name).name}\n"


def _state(path: Path, text: str) -> str:
    if not path.exists():
        return "missing"
    return "current" if path.read_bytes() == text.encode() else "stale"


def _left_over(decks: Decks, folder: Path, *, whole: bool) -> list[str]:
    places = [folder] if whole else sorted({folder.joinpath(*Path(name).parts[:2]) for name in decks})
    found = {p.relative_to(folder).as_posix() for place in places for p in place.rglob("*") if p.is_file()}
    return sorted(found - decks.keys())


def _row(name: str, state: str) -> dict:
    scene, _, file = name.partition("/")
    return {"scene": scene, "file": file, "state": state}


def _inputs() -> Path:
    return Path(__file__).resolve().parents[2] / "inputs"
