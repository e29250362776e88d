"""The scene as people write it: typed, frozen data, one struct a table of the TOML file.

Units are SI, `x` to the right, `y` up. A table that is absent is an effect that does not exist;
there are no defaults that switch physics on. Names follow the ON-DEM vocabulary where it has one
(`normal_stiffness`, `shear_stiffness`, `normal_damping`, `shear_friction`).

Ranges that one number must obey stand here as msgspec bounds; what several numbers must obey
together stands in `harness.scene.checks`.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from harness.scene.contact import Contact
from harness.scene.expect import Expect
from harness.scene.judged import Compare, FreeCompare, RingCompare
from harness.scene.tables import Count, Name, NonNegative, Positive, Table, Title, Vector

# --- particles -------------------------------------------------------------------------------


class UniformRadius(Table, tag="uniform", tag_field="kind"):
    """Radii drawn from U(min, max), in m."""

    min: Positive
    max: Positive


class SteppedRadius(Table, tag="stepped", tag_field="kind"):
    """Radii drawn from `steps` equally likely values, the middles of as many equal parts of min to max, in m.

    A uniform distribution for what can tell apart a few sizes only.
    """

    min: Positive
    max: Positive
    steps: Annotated[int, Meta(ge=2, le=1000)]


class SphereMass(Table, tag="sphere", tag_field="kind"):
    """m = 4/3 pi rho a^3 (the discs of the talks' biaxial box weigh as spheres)."""

    density: Positive


class DiscMass(Table, tag="disc", tag_field="kind"):
    """m = rho h pi a^2, a disc of height h."""

    density: Positive
    height: Positive


Inertia = Literal["sphere", "disc", "ring"] | Annotated[float, Meta(gt=0, le=1)]
"""Moment of inertia I = q m a^2: sphere q = 2/5, disc q = 1/2, ring q = 1, or q itself."""


class RandomParticles(Table):
    """Many discs: `count`, `radius` and `seed` for a random packing, or `packing`, a CSV id,x,y,radius.

    Either is a start state that the preparation brings to rest.
    """

    mass: SphereMass | DiscMass
    inertia: Inertia
    count: Annotated[int, Meta(ge=1, le=1_000_000)] | None = None
    radius: UniformRadius | SteppedRadius | None = None
    seed: Annotated[int, Meta(ge=0)] | None = None
    packing: str | None = None


class Body(Table):
    """One particle of a free scene; `position` and vectors have 2 or 3 components as the scene has.

    `material` is a word of `contact.between`.
    """

    position: Vector
    radius: Positive
    mass: Positive
    velocity: Vector | None = None
    spin: tuple[float, ...] | None = None
    inertia: Inertia = "sphere"
    material: Name | None = None


class Background(Table):
    """Drag of the surroundings, f = -c v on every particle, c in kg/s; no torque."""

    translational_drag: Positive


# --- numerics and outputs --------------------------------------------------------------------


class Numerics(Table):
    """Time step as a fraction of the time scale of the smallest pair.

    Linear and hysteretic laws: pi / sqrt(k/m* - b^2) with k_n, k_2 or k_p, the contact time of the linear
    law. An overdamped pair (b^2 >= k/m*) has no such time; pi / sqrt(k/m*) takes its place. Laws that
    stiffen: the contact time of an impact at `impact_speed`.
    """

    dt_fraction: Positive


class Outputs(Table):
    """How often to look: `samples` rows of wall forces, `frames` full states (with contacts or not).

    With `rotations` every frame says how far each disc has turned since the start (2D, with a law that turns it).

    Both come besides the initial state. The number of steps is rounded up to a common multiple of
    both, and the time step gets smaller accordingly (`harness.scene.numerics.plan_steps`).
    """

    samples: Count
    frames: Count
    contacts: bool
    rotations: bool = False


# --- biaxial box -----------------------------------------------------------------------------


class Preparation(Table):
    """Frictionless isotropic packing at `pressure` (N/m), relaxed until residual <= tolerance.

    It is relaxed with linear springs of stiffness k_n; of k_1 for hysteretic laws, which begin with it.
    """

    pressure: Positive
    residual_tolerance: Annotated[float, Meta(gt=0, le=1e-2)]


class TopWall(Table):
    """Strain control: z(t) = z_f + (z_0 - z_f)/2 (1 + cos(pi t/T)), eps = 1 - z/z_0 (talk, 'Bi-axial box').

    The run ends at T (`duration`), at the final strain; with `cycles` the wall goes on, down and up so many times, and
    the run ends at 2 T cycles, at the height it began with.
    """

    final_strain: Annotated[float, Meta(gt=0, lt=1)]
    duration: Positive
    cycles: Annotated[int, Meta(ge=1, le=1000)] | None = None


class SideWall(Table):
    """Stress control: m_x x'' = F_x - p_x z(t) - gamma_x x' (talk, 'Bi-axial box')."""

    pressure: Positive
    mass: Positive
    damping: NonNegative


class Biaxial(Table, tag="biaxial", tag_field="kind"):
    """Four smooth walls: bottom and left fixed, top strain-controlled, right stress-controlled."""

    title: Title
    particles: RandomParticles
    preparation: Preparation
    contact: Contact
    top: TopWall
    side: SideWall
    numerics: Numerics
    outputs: Outputs
    background: Background | None = None
    compare: Compare = Compare()
    expect: Expect | None = None

    @property
    def dimension(self) -> int:
        """The box of the talks is two-dimensional."""
        return 2

    @property
    def duration(self) -> float:
        """The run ends when the top wall comes to rest."""
        return self.top.duration * (1 if self.top.cycles is None else 2 * self.top.cycles)


# --- Couette ring ----------------------------------------------------------------------------


class Species(Table):
    """Equal discs: how many, and their radius in m."""

    count: Annotated[int, Meta(ge=1, le=1_000_000)]
    radius: Positive


class RingParticles(Table):
    """Discs of a few sizes, placed at random by `seed` and grown to their size."""

    mass: DiscMass | SphereMass
    inertia: Inertia
    seed: Annotated[int, Meta(ge=0)]
    species: Annotated[tuple[Species, ...], Meta(min_length=1)]


class Rings(Table):
    """Two circles of glued discs, centred on `inner_radius` and `outer_radius` (m), which touch one another.

    The inner one turns with `omega` (rad/s, counter-clockwise), the outer one rests.
    """

    inner_radius: Positive
    outer_radius: Positive
    grain_radius: Positive
    omega: float


class Growth(Table):
    """The discs grow from `start_size` of their radius to all of it in `grow` seconds, then flow for `settle`.

    The inner ring turns meanwhile: its rate rises smoothly to omega within `grow`. Contacts rub as in the run if
    their friction has no memory, else not at all. The run starts with the places, velocities and spins reached.
    """

    start_size: Annotated[float, Meta(gt=0, lt=1)]
    grow: Positive
    settle: NonNegative


class Couette(Table, tag="couette", tag_field="kind"):
    """Discs between two rough rings of which the inner one turns (Laetzel et al., Granular Matter 2, 123 (2000))."""

    title: Title
    particles: RingParticles
    rings: Rings
    preparation: Growth
    contact: Contact
    duration: Positive
    numerics: Numerics
    outputs: Outputs
    compare: RingCompare
    background: Background | None = None
    expect: Expect | None = None

    @property
    def dimension(self) -> int:
        """The ring of the talks is two-dimensional."""
        return 2


# --- free scenes -----------------------------------------------------------------------------


class Lattice(Table):
    """Bodies on a lattice: `counts` of them along each axis, `spacing` (m) apart, the first one centred on `corner`.

    "square" in 3D is simple cubic; "triangular" is 2D, its rows sqrt(3)/2 spacings apart. With `speed` (m/s) every
    component of velocity is drawn from N(0, speed), less the mean; radii and velocities belong to `seed`.
    """

    arrangement: Literal["square", "triangular"]
    counts: Annotated[tuple[Count, ...], Meta(min_length=2, max_length=3)]
    spacing: Positive
    corner: Vector
    radius: UniformRadius
    mass: SphereMass | DiscMass
    inertia: Inertia
    speed: Positive | None = None
    seed: Annotated[int, Meta(ge=0)] | None = None


class ConstantMotion(Table, tag="constant", tag_field="kind"):
    """The wall moves with a constant velocity."""

    velocity: Vector


class CosineMotion(Table, tag="cosine", tag_field="kind"):
    """Smooth travel along the normal: d(t) = travel/2 (1 - cos(pi t/T)) for t < T, then rest."""

    travel: float
    duration: Positive


class LoadedMotion(Table, tag="loaded", tag_field="kind"):
    """A wall with mass, pressed along its normal: m d'' = load + F.n - damping d'."""

    mass: Positive
    load: float
    damping: NonNegative = 0.0


class Plane(Table):
    """A flat wall through `point`; `normal` points to the side where the particles are.

    With `friction` the particles' own sliding, rolling and torsion laws act at it too. `material` as of a `Body`.
    """

    name: Name
    point: Vector
    normal: Vector
    friction: bool
    material: Name | None = None
    motion: ConstantMotion | CosineMotion | LoadedMotion | None = None


class Free(Table, tag="free", tag_field="kind"):
    """Explicit particles, planes, gravity: collisions, single bodies, chains and lattices.

    `bodies` stand inline, in a CSV file (`bodies_file`: x,y[,z],radius,mass and optionally vx,vy[,vz], wz in 2D or
    wx,wy,wz in 3D, inertia, material) or on a lattice (`bodies_from`). `periodic` gives the box length of each axis, 0
    for open ones.
    """

    title: Title
    dimension: Literal[2, 3]
    contact: Contact
    duration: Positive
    numerics: Numerics
    outputs: Outputs
    bodies: tuple[Body, ...] = ()
    bodies_file: str | None = None
    planes: tuple[Plane, ...] = ()
    gravity: Vector | None = None
    periodic: tuple[NonNegative, ...] | None = None
    background: Background | None = None
    bodies_from: Lattice | None = None
    compare: FreeCompare = FreeCompare()
    expect: Expect | None = None


Scene = Biaxial | Couette | Free
