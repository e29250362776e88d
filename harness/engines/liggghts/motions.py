"""How walls move: prescribed motions, and the equation of motion of walls with a mass.

A wall's state is its displacement d along its normal since step 0 (inwards positive) and the rate of
d. `move/mesh` adds velocity * dt to the mesh at the beginning of a step, and the same velocity is in
the damping and friction of that step: it is the mean rate of the step, (d(n) - d(n-1))/dt.

A wall with a mass follows velocity Verlet, written as leapfrog, with the rate h at half steps:

    h(n+1/2) = h(n-1/2) + dt/m F(n),    h(1/2) = h(0) + dt/2m F(0),    d(n+1) = d(n) + dt h(n+1/2)
    F = load + stress * extent - damping h + f.n            f: force of the particles on the wall

LIGGGHTS has no state variables, so h and d are kept in the velocity components of a carrier atom
that stays where it is: `fix move variable` sets vx to h and vy to d. It runs at the beginning of
step n+1, when the meshes still hold their forces of step n; hence no lag, and every wall has its
own force (`mesh/surface/stress`), whatever else touches the same particle.
"""

from __future__ import annotations

import math

import numpy as np

from harness.engines.facts import carrier_id, loaded_walls
from harness.engines.glued import GROUP
from harness.engines.liggghts.planes import is_still, mesh_velocity, meshes, normal_speed, space
from harness.engines.text import number
from harness.scene.system import Constant, Cosine, Loaded, System, Wall


def constant_motion_lines(system: System) -> list[str]:
    """Return the motions with constant velocity.

    They stand behind `fix wall/gran` and before the step of length 0: only so do the forces of the
    set-up know the velocity of the wall.
    """
    moving = [w for w in meshes(system) if isinstance(w.motion, Constant) and not is_still(w)]
    return [
        f"fix {w.name}_move all move/mesh mesh {w.name}_mesh linear {space(mesh_velocity(system, w))}" for w in moving
    ]


def motion_lines(system: System) -> list[str]:
    """Return the motions that depend on time; they stand behind `fix nve/sphere`."""
    moving = [w for w in system.walls if isinstance(w.motion, Cosine | Loaded)]
    if not moving:
        return []
    lines = ["", "# motions", "variable zero equal 0.0"]
    for wall in moving:
        lines += _cosine(system, wall) if isinstance(wall.motion, Cosine) else _loaded(system, wall)
    return lines


def displacement(system: System, wall: Wall, step: str = "step") -> str:
    """Return d at a step (an expression) as an expression; "0.0" for a wall that stays."""
    motion = wall.motion
    if is_still(wall):
        return "0.0"
    if isinstance(motion, Constant):
        return f"{_signed(normal_speed(wall) * system.dt)}*{step}"
    if isinstance(motion, Loaded):
        return f"vy[{carrier_id(system, wall)}]"
    rising = f"{_signed(motion.travel)}*sin({number(_half_angle(system, motion))}*{step})^2"
    last = _last_step(system, motion)
    return rising if last is None else f"({step}<={last})*{rising}+({step}>{last})*{_signed(motion.rest)}"


def rate(system: System, wall: Wall) -> str:
    """Return the rate of d at the end of a step as an expression."""
    motion = wall.motion
    if is_still(wall):
        return "0.0"
    if isinstance(motion, Constant):
        return number(normal_speed(wall))
    if isinstance(motion, Loaded):
        half_kick = number(0.5 * system.dt / motion.mass)
        return f"vx[{carrier_id(system, wall)}]+(step>0)*{half_kick}*v_{wall.name}_force"
    peak = _signed(motion.travel * math.pi / (2.0 * motion.duration))
    rising = f"{peak}*sin({number(2.0 * _half_angle(system, motion))}*step)"
    last = _last_step(system, motion)
    return rising if last is None else f"(step<={last})*{rising}"


def force(system: System, wall: Wall, step: str = "step") -> str:
    """Return F of the module's formula, at the last step whose forces are known, as an expression."""
    motion = wall.motion
    pushed = [f"{_signed(n)}*{mesh_force(wall, a, step)}" for a, n in enumerate(wall.normal) if n]
    terms = ([_signed(motion.load)] if motion.load else []) + pushed
    if motion.span is not None and motion.stress:
        terms.append(f"{_signed(motion.stress)}*({_extent(system, motion, step)})")
    if motion.damping:
        terms.append(f"{_signed(-motion.damping)}*vx[{carrier_id(system, wall)}]")
    return "+".join(terms)


def mesh_force(wall: Wall, axis: int, step: str = "step") -> str:
    """Return a component of the force on a mesh as an expression; `step` is the step it belongs to.

    At step 0 LIGGGHTS holds twice the force: once from the step of length 0, once from the set-up.
    """
    return f"f_{wall.name}_mesh[{axis + 1}]*(1.0-0.5*({step}==0))"


def _cosine(system: System, wall: Wall) -> list[str]:
    """The difference of two sin^2 is a product of sines, which does not cancel."""
    motion, name = wall.motion, wall.name
    half = _half_angle(system, motion)
    mean = f"{_signed(motion.travel * math.sin(half) / system.dt)}*sin({number(half)}*(2*step-1))"
    last = _last_step(system, motion)
    if last is not None:
        mean = f"(step<={last})*{mean}+(step=={last + 1})*{_signed(_left_over(motion, half * last) / system.dt)}"
    return [f"# {name}: mean rate of the step", f'variable {name}_mean equal "{mean}"', *_move(wall, f"v_{name}_mean")]


def _loaded(system: System, wall: Wall) -> list[str]:
    name, atom = wall.name, carrier_id(system, wall)
    kick = f"{number(system.dt / wall.motion.mass)}*(1.0-0.5*(step==1))"
    depth = "NULL" if system.dimension == 2 else "v_zero"
    return [
        f"# {name}: rate at the half step and displacement, kept as vx and vy of atom {atom}",
        f'variable {name}_half equal "vx[{atom}]+{kick}*({force(system, wall, "(step-1)")})"',
        f'variable {name}_next equal "vy[{atom}]+{number(system.dt)}*v_{name}_half"',
        f"fix {name}_state {name}_carrier move variable v_zero v_zero {depth} v_{name}_half v_{name}_next NULL",
        *_move(wall, f"vx[{atom}]"),
    ]


def carrier_lines(system: System) -> list[str]:
    """Return the groups: the particles, and each carrier."""
    lines = [f"group grains id 1:{len(system.particles)}"]
    lines += [f"group {w.name}_carrier id {carrier_id(system, w)}" for w in loaded_walls(system)]
    others = f"grains {GROUP}" if system.rings else "grains"
    return lines + ([f"group carriers subtract all {others}"] if loaded_walls(system) else [])


def _move(wall: Wall, speed: str) -> list[str]:
    """Return the motion of a mesh along its normal with a speed that is an expression."""
    axes = {a: n for a, n in zip("xyz", wall.normal, strict=False) if n}
    velocity = [f'variable {wall.name}_mesh_v{a} equal "{_signed(n)}*{speed}"' for a, n in axes.items()]
    names = " ".join(f"v_{wall.name}_mesh_v{a}" if a in axes else "v_zero" for a in "xyz")
    return [*velocity, f"fix {wall.name}_move all move/mesh mesh {wall.name}_mesh linear/variable {names}"]


def _extent(system: System, motion: Loaded, step: str) -> str:
    """Return the distance of the walls of the span, along the normal of the first."""
    first, second = (system.wall(name) for name in motion.span)
    normal = np.array(first.normal)
    terms = [_signed(float(np.subtract(second.point, first.point) @ normal))]
    for wall, share in ((first, -1.0), (second, float(np.dot(second.normal, normal)))):
        if not is_still(wall) and share:
            terms.append(f"{_signed(share)}*({displacement(system, wall, step)})")
    return "+".join(terms)


def _left_over(motion: Cosine, angle: float) -> float:
    """Return the way from d = travel sin^2(angle) to where the wall rests."""
    return motion.travel * math.cos(angle) ** 2 if motion.rest else -motion.travel * math.sin(angle) ** 2


def _half_angle(system: System, motion: Cosine) -> float:
    """Return pi dt / 2T: d = travel/2 (1 - cos(pi t/T)) = travel sin^2(n pi dt/2T), without cancellation."""
    return math.pi * system.dt / (2.0 * motion.duration)


def _last_step(system: System, motion: Cosine) -> int | None:
    """Return the last step at which the wall still moves; None if the run ends before."""
    last = math.floor(motion.end / system.dt * (1.0 + 1e-12))
    return last if last < system.steps else None


def _signed(value: float) -> str:
    """Return a number fit for the middle of an expression."""
    return number(value) if value >= 0 else f"({number(value)})"
