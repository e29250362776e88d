"""`python -m reference.kernel FOLDER`: run the deck in FOLDER; exit 3 when the run is unstable.

A run that was killed goes on from its last checkpoint, see `reference.kernel.checkpoint`.
"""

from __future__ import annotations

import fcntl
import json
import sys
import time
from pathlib import Path

from reference.kernel.checkpoint import CHECKPOINT, EVERY, OWNER, read_checkpoint, write_checkpoint
from reference.kernel.deck import Plan, read_deck
from reference.kernel.guards import KernelUnstable, refuse_late_springs
from reference.kernel.output import SERIES, FramesWriter, SeriesWriter
from reference.kernel.program.simulation import ProgramSimulation, fastest
from reference.kernel.watches import Watches

UNSTABLE = 3


def main(folder: Path) -> int:
    """Run; the last line of standard output is a JSON object with the finished marker and timings."""
    with open(folder / OWNER, "w") as owner:
        fcntl.flock(owner, fcntl.LOCK_EX)
        run = _Run(folder)
        try:
            run.start()
            run.advance()
        except KernelUnstable as reason:
            print(f"unstable: {reason}")
            return UNSTABLE
        finally:
            run.close()
        print(json.dumps(run.report()))
    return 0


class _Run:
    """A run and its files, from the start or from where a checkpoint stands."""

    def __init__(self, folder: Path):
        self.folder, self._clock, self.resumed_at = folder, _Clock(), None
        self._model, self._plan = read_deck(folder)
        self._watches = Watches(self._model, self._plan.steps)
        self._found = read_checkpoint(folder)
        length, part = (None, 0) if self._found is None else (int(self._found[1][n]) for n in ("series", "part"))
        self._series = SeriesWriter(folder / SERIES, self._model, length=length)
        self._frames = FramesWriter(folder, self._model, part=part)

    def start(self) -> None:
        """Set up; go on from the checkpoint if there is one. Raises KernelUnstable for what cannot go well."""
        refuse_late_springs(self._model, self._plan.steps)
        self._simulation = fastest(self._model)
        if self._found is not None:
            state, outputs = self._found
            self._simulation.take(state)
            self._watches.take(state)
            self.resumed_at = self._simulation.walls.step
            self._clock.add({n.removeprefix("cpu_"): v for n, v in outputs.items() if n.startswith("cpu_")})
        self._clock.lap("setup")

    def advance(self) -> None:
        """Make all steps that are left; samples, frames and checkpoints on the way."""
        self._now, written = self.resumed_at or 0, -1 if self.resumed_at is None else self.resumed_at
        for step in (s for s in _stops(self._plan) if s > written):
            self._advance_to(step)
            self._clock.lap("run")
            self._write(step)
        self._frames.finish()
        (self.folder / CHECKPOINT).unlink(missing_ok=True)

    def _advance_to(self, step: int) -> None:
        """Make the steps up to `step`; on the way the watches look."""
        while (look := self._watches.next_look) is not None and look <= step:
            self._simulation.advance(look - self._now)
            self._now = look
            self._watches.look(self._simulation)
        self._simulation.advance(step - self._now)
        self._now = step

    def _write(self, step: int) -> None:
        plan, simulation = self._plan, self._simulation
        if step % plan.sample_every == 0:
            self._series.write(simulation)
        if step % plan.frame_every == 0:
            self._frames.write(step // plan.frame_every, simulation, contacts=plan.contacts)
        self._clock.lap("output")
        if self._clock.since_mark >= EVERY and isinstance(simulation, ProgramSimulation):
            cpu = {f"cpu_{phase}": seconds for phase, seconds in self._clock.laps.items()}
            length, part = self._series.flushed_length(), self._frames.next_part()
            write_checkpoint(self.folder, simulation, self._watches.kept(), series=length, part=part, **cpu)
            self._clock.mark()

    def report(self) -> dict:
        """Return the finished marker, CPU seconds by phase, those before a checkpoint among them, and any warning."""
        simulation = self._simulation
        report = {
            "finished": True, "steps": simulation.state.step, "rebuilds": simulation.rebuilds,
            "timings": self._clock.laps,
        }
        warning = self._watches.warning()
        report |= {} if warning is None else {"warning": warning}
        return report | ({"resumed_at": self.resumed_at} if self.resumed_at is not None else {})

    def close(self) -> None:
        """Close the files."""
        self._series.close()
        self._frames.close()


def _stops(plan: Plan) -> list[int]:
    return sorted({*range(0, plan.steps + 1, plan.sample_every), *range(0, plan.steps + 1, plan.frame_every)})


class _Clock:
    """CPU seconds of this process, by phase."""

    def __init__(self):
        self.laps: dict[str, float] = {}
        self._last = self._marked = time.process_time()

    def lap(self, phase: str) -> None:
        now = time.process_time()
        self.laps[phase] = self.laps.get(phase, 0.0) + now - self._last
        self._last = now

    def add(self, laps: dict[str, float]) -> None:
        """Count what an earlier process needed, too."""
        for phase, seconds in laps.items():
            self.laps[phase] = self.laps.get(phase, 0.0) + seconds

    def mark(self) -> None:
        self._marked = time.process_time()

    @property
    def since_mark(self) -> float:
        return time.process_time() - self._marked


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
