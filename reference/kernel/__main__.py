"""`python -m reference.kernel FOLDER`: run the deck in FOLDER; exit 3 when the run is unstable."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

from reference.kernel.deck import Plan, read_deck
from reference.kernel.output import FRAMES, SERIES, SeriesWriter, write_frame
from reference.kernel.program.simulation import ProgramSimulation, fastest
from reference.kernel.simulation import KernelUnstable, Simulation

UNSTABLE = 3


def main(folder: Path) -> int:
    """Run; the last line of standard output is a JSON object with the finished marker and timings."""
    import h5py

    clock = _Clock()
    model, plan = read_deck(folder)
    series = SeriesWriter(folder / SERIES, model)
    try:
        simulation = fastest(model)
        clock.lap("setup")
        with h5py.File(folder / FRAMES, "w") as file:
            file.attrs["dimension"] = model.dimension
            if model.periodic is not None:
                file.attrs["periodic"] = [length > 0 for length in model.periodic]
            _run(simulation, plan, series, file, clock)
            file.attrs["finished"] = 1
    except KernelUnstable as reason:
        print(f"unstable: {reason}")
        return UNSTABLE
    finally:
        series.close()
    steps, rebuilds = simulation.state.step, simulation.rebuilds
    print(json.dumps({"finished": True, "steps": steps, "rebuilds": rebuilds, "timings": clock.laps}))
    return 0


def _run(simulation: Simulation | ProgramSimulation, plan: Plan, series: SeriesWriter, file, clock: _Clock) -> None:
    stops = sorted({*range(0, plan.steps + 1, plan.sample_every), *range(0, plan.steps + 1, plan.frame_every)})
    for before, step in zip([0, *stops], stops, strict=False):
        simulation.advance(step - before)
        clock.lap("run")
        if step % plan.sample_every == 0:
            series.write(simulation)
        if step % plan.frame_every == 0:
            write_frame(file, step // plan.frame_every, simulation, contacts=plan.contacts)
        clock.lap("output")


class _Clock:
    """CPU seconds of this process, by phase."""

    def __init__(self):
        self.laps: dict[str, float] = {}
        self._last = time.process_time()

    def lap(self, phase: str) -> None:
        now = time.process_time()
        self.laps[phase] = self.laps.get(phase, 0.0) + now - self._last
        self._last = now


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
