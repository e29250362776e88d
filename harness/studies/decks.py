"""The committed decks: what every engine is told for the shipped scenes, kept beside the scenes.

`inputs/decks/<scene>/<engine>/` holds each deck file as the engine renders it. A file with more than
`LARGEST` bytes (the particles of a big packing) is generated data: instead of it there is
`<file>.sha256`, so that git notices when it changes. The packing is made by elementwise IEEE
arithmetic only, so these bytes do not depend on the machine.
"""

from __future__ import annotations

import hashlib
import tempfile
from pathlib import Path

from harness.engines.registry import ENGINES
from harness.errors import InputError
from harness.scene.load import load_scene
from harness.studies.prepare import prepare

LARGEST = 64_000
"""Bytes; about three hundred particles."""


def shipped_scenes() -> list[Path]:
    """Return the scene files of this checkout, sorted; InputError when there is none."""
    found = sorted((_inputs() / "scenes").glob("*.toml"))
    if not found:
        raise InputError(file=_inputs() / "scenes", expected="scene files (*.toml)", got="none", fix="name them")
    return found


def default_decks_folder() -> Path:
    """Return inputs/decks of this checkout."""
    return _inputs() / "decks"


def write_decks(scenes: list[Path], folder: Path) -> list[dict]:
    """Rewrite the decks of these scenes; return one row a file: scene, engine, file, state."""
    from harness.runs.atomic import write_text_atomic

    rows = []
    for scene in scenes:
        rendered = rendered_decks(scene)
        rows += _states(rendered, folder / scene.stem, words=("current", "written", "written", "removed"))
        for name, text in rendered.items():
            path = folder / scene.stem / name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_text_atomic(path, text)
        for name in _on_disk(folder / scene.stem) - rendered.keys():
            (folder / scene.stem / name).unlink()
    return rows


def check_decks(scenes: list[Path], folder: Path) -> list[dict]:
    """Compare without writing; states: current, stale, missing, left over."""
    words = ("current", "stale", "missing", "left over")
    return [row for s in scenes for row in _states(rendered_decks(s), folder / s.stem, words=words)]


def rendered_decks(scene_file: Path) -> dict[str, str]:
    """Return what the folder of this scene must hold: text by ``<engine>/<file>``, for all engines.

    An engine that refuses the scene has no deck. Only the scene's first packing is rendered.
    """
    scene = load_scene(scene_file)
    with tempfile.TemporaryDirectory() as cache:
        system = prepare(scene, scene_file, packings=1, cache=Path(cache))[0].system
    found = {}
    for engine in ENGINES.values():
        if any(s.level in ("unsupported", "known_wrong") for s in engine.supports(system)):
            continue
        for name, text in engine.render(system).items():
            kept, content = _kept(name, text)
            found[f"{engine.name.replace(':', '-')}/{kept}"] = content
    return found


def _kept(name: str, text: str) -> tuple[str, str]:
    data = text.encode()
    if len(data) <= LARGEST:
        return name, text
    return f"{name}.sha256", f"{hashlib.sha256(data).hexdigest()}  {name}\n"


def _states(rendered: dict[str, str], folder: Path, *, words: tuple[str, str, str, str]) -> list[dict]:
    current, changed, missing, extra = words

    def state(name: str, text: str) -> str:
        path = folder / name
        if not path.exists():
            return missing
        return current if path.read_text(encoding="utf-8") == text else changed

    rows = [(name, state(name, text)) for name, text in rendered.items()]
    rows += [(name, extra) for name in sorted(_on_disk(folder) - rendered.keys())]
    return [{"scene": folder.name, "file": name, "state": word} for name, word in rows]


def _on_disk(folder: Path) -> set[str]:
    return {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()}


def _inputs() -> Path:
    return Path(__file__).resolve().parents[2] / "inputs"
