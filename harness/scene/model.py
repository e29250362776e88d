"""The scene as people write it: typed, frozen data, one struct a table of the TOML file.

Units are SI, `x` to the right, `y` up. A table that is absent is an effect that does not exist;
there are no defaults that switch physics on. Names follow the ON-DEM vocabulary where it has one
(`normal_stiffness`, `shear_stiffness`, `normal_damping`, `shear_friction`).

Ranges that one number must obey stand here as msgspec bounds; what several numbers must obey
together stands in `harness.scene.checks`.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

Positive = Annotated[float, Meta(gt=0)]
NonNegative = Annotated[float, Meta(ge=0)]
Count = Annotated[int, Meta(ge=1)]
Vector = Annotated[tuple[float, ...], Meta(min_length=2, max_length=3)]
Name = Annotated[
    str,
    Meta(
        pattern=r"\A[a-z][a-z0-9_]{0,23}\Z",
        description="a word of up to 24 lower-case letters, digits and _, beginning with a letter",
    ),
]
"""Names reach decks and file names, so they are plain lower-case words: nothing to inject."""
Title = Annotated[
    str,
    Meta(
        pattern=r"\A[A-Za-z0-9 .,:;()/%+=*'~^_-]{1,100}\Z",
        description="one line of up to 100 letters (A-Z), digits, blanks and .,:;()/%+=*'~^_-",
    ),
]
"""Titles reach deck comments, where a line end, & or $ could begin a command."""


class Table(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of the scene file: unknown keys are refused."""


# --- particles -------------------------------------------------------------------------------


class UniformRadius(Table, tag="uniform", tag_field="kind"):
    """Radii drawn from U(min, max), in m."""

    min: Positive
    max: Positive


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
    radius: UniformRadius | None = None
    seed: Annotated[int, Meta(ge=0)] | None = None
    packing: str | None = None


class Body(Table):
    """One particle of a free scene; `position` and vectors have 2 or 3 components as the scene has."""

    position: Vector
    radius: Positive
    mass: Positive
    velocity: Vector | None = None
    spin: tuple[float, ...] | None = None
    inertia: Inertia = "sphere"


# --- contact effects -------------------------------------------------------------------------


class LinearNormal(Table, tag="linear", tag_field="law"):
    """f_n = k_n delta - gamma_n v_n (v_n the rate of separation); `attraction` clips f_n < 0 or not.

    Restitution with and without clipping are two laws (Schwager & Poeschel 2007), so the scene
    has to say which.
    """

    normal_stiffness: Positive
    normal_damping: NonNegative
    attraction: Literal["allowed", "clipped"]


class HertzNormal(Table, tag="hertz", tag_field="law"):
    """Elastic spheres (Hertz 1882) with the dashpot of constant restitution e (Antypov & Elliott 2011).

    f_n = 4/3 E* sqrt(R*) delta^(3/2) - gamma v_n, E* = E/(2 (1 - nu^2)) for two partners of one material (and
    for walls, which are of it too), S_n = 2 E* sqrt(R* delta),
    gamma = sqrt(10/3) beta sqrt(S_n m*), beta = -ln e/sqrt(ln^2 e + pi^2).

    Hertz has no contact time of its own: `impact_speed` (m/s) is the speed for which it is taken.
    """

    youngs_modulus: Positive
    poisson_ratio: Annotated[float, Meta(gt=-1, le=0.5)]
    restitution: Annotated[float, Meta(gt=0, le=1)]
    attraction: Literal["allowed", "clipped"]
    impact_speed: Positive


class HystereticNormal(Table, tag="hysteretic", tag_field="law"):
    """Piecewise linear, adhesive, constant k_2 (the talks; Walton & Braun 1986 without adhesion).

    k_1 delta on first loading; k_2 (delta - delta_0) below the largest overlap, with
    delta_0 = (1 - k_1/k_2) delta_max; never below -k_c delta, where delta_max is drawn back. - gamma_n v_n besides.
    """

    loading_stiffness: Positive
    unloading_stiffness: Positive
    adhesion_stiffness: NonNegative
    normal_damping: NonNegative


class VariableHystereticNormal(Table, tag="hysteretic_variable", tag_field="law"):
    """As `hysteretic` with k_2 = k_1 + (k_p - k_1) delta_max/delta_max*, k_p above it (Luding 2008, eqs. 6-8).

    delta_max* = k_p/(k_p - k_1) phi_f 2 a_i a_j/(a_i + a_j); at a wall a_j is infinite.
    """

    loading_stiffness: Positive
    largest_unloading_stiffness: Positive
    adhesion_stiffness: NonNegative
    plasticity_depth: Annotated[float, Meta(gt=0, lt=1)]
    normal_damping: NonNegative


class DmtNormal(Table, tag="dmt", tag_field="law"):
    """Hertz with the constant adhesion 4 pi w R* (Derjaguin, Muller & Toporov 1975); w: `surface_energy`, J/m^2."""

    youngs_modulus: Positive
    poisson_ratio: Annotated[float, Meta(gt=-1, le=0.5)]
    surface_energy: Positive
    normal_damping: NonNegative
    impact_speed: Positive


class JkrNormal(Table, tag="jkr", tag_field="law"):
    """Hertz with adhesion inside the contact (Johnson, Kendall & Roberts 1971); it holds on beyond overlap zero."""

    youngs_modulus: Positive
    poisson_ratio: Annotated[float, Meta(gt=-1, le=0.5)]
    surface_energy: Positive
    normal_damping: NonNegative
    impact_speed: Positive


NormalLaw = (
    LinearNormal | HertzNormal | HystereticNormal | VariableHystereticNormal | DmtNormal | JkrNormal
)


class SpringSliding(Table, tag="spring", tag_field="law"):
    """Tangential spring k_t and dashpot gamma_t, limited by Coulomb's mu f_n (Cundall & Strack 1979).

    With `dynamic_friction` mu_d <= mu a contact that slides carries mu_d f_n until it sticks again. Where the
    normal law attracts, f_n + k_c delta (Luding 2008) takes the place of f_n in the limit; of dmt and jkr
    the elastic force and twice the pull-off force (Thornton 1991).
    """

    shear_friction: NonNegative
    shear_stiffness: Positive
    shear_damping: NonNegative
    dynamic_friction: Positive | None = None


class MindlinSliding(Table, tag="mindlin", tag_field="law"):
    """Mindlin's no-slip stiffness k_t = 8 G* sqrt(R* delta), G* = E/(4 (2 - nu)(1 + nu)), Coulomb limit.

    Incremental, without rescaling of the spring on unloading; dashpot sqrt(10/3) beta sqrt(k_t m*), beta as in
    `hertz`, the only normal law it goes with.
    """

    shear_friction: Positive


class ViscousSliding(Table, tag="viscous", tag_field="law"):
    """f_t = -min(gamma_t |v_t|, mu f_n) v_t/|v_t|: no spring, no history (Laetzel, Luding & Herrmann 2000)."""

    shear_friction: Positive
    shear_damping: Positive


SlidingLaw = SpringSliding | MindlinSliding | ViscousSliding


class SpringRolling(Table, tag="spring", tag_field="law"):
    """Rolling resistance as a sliding contact of a quasi-force that acts as a couple only (Luding 2008, 2.3).

    v_r = -a* (n x omega_i - n x omega_j), spring k_r, dashpot gamma_r, limit mu_r f_n, couple a* n x f_r on i;
    a* = a_i a_j/(a_i + a_j), a_i at a wall.
    """

    rolling_friction: Positive
    rolling_stiffness: Positive
    rolling_damping: NonNegative


class ConstantRolling(Table, tag="constant", tag_field="law"):
    """Constant directional torque mu_r a* f_el against the relative rolling (Ai et al. 2011, type A).

    f_el is the elastic normal force. It jumps with the direction of rolling.
    """

    rolling_friction: Positive


RollingLaw = SpringRolling | ConstantRolling


class SpringTorsion(Table, tag="spring", tag_field="law"):
    """Torsion resistance, as `rolling` about the normal: v_o = a* n.(omega_i - omega_j), couple a* f_o n (3D)."""

    torsion_friction: Positive
    torsion_stiffness: Positive
    torsion_damping: NonNegative


class Contact(Table):
    """The contact effects between particles; a table that is absent is an effect that does not exist."""

    normal: NormalLaw
    sliding: SlidingLaw | None = None
    rolling: RollingLaw | None = None
    torsion: SpringTorsion | None = None


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


class Window(Table):
    """A declared pointwise check: up to `strain` two codes' top-wall forces differ by <= `tolerance`.

    `pairs` is "same_conventions" (an engine and the kernel in that engine's conventions) or
    "codes" (LAMMPS and LIGGGHTS, each with its own).
    """

    pairs: Literal["same_conventions", "codes"]
    strain: Positive
    tolerance: Positive


MOST_PACKINGS = 1000
"""Of one comparison: an error bar over a thousand packings is 3 % of their spread; more is a slip."""


class Compare(Table):
    """What `grainproof compare` judges; never part of a run's hash."""

    packings: Annotated[int, Meta(ge=1, le=MOST_PACKINGS)] = 1
    windows: tuple[Window, ...] = ()
    plateau: Annotated[tuple[float, float], Meta(description="two numbers, a range of strains")] | None = None
    published: tuple[str, ...] = ()
    """Names of `reference/values/*.toml` that hold under this scene's conditions."""


class Agreement(Table):
    """A declared check of whole trajectories: largest difference of x, v, spin over their largest size.

    `pairs` as in `Window`.
    """

    pairs: Literal["same_conventions", "codes"]
    tolerance: Positive


class FreeCompare(Table):
    """What `grainproof compare` judges on a free scene; never part of a run's hash."""

    agreements: tuple[Agreement, ...] = ()


# --- biaxial box -----------------------------------------------------------------------------


class Preparation(Table):
    """Frictionless isotropic packing at `pressure` (N/m), relaxed until residual <= tolerance.

    It is relaxed with linear springs of stiffness k_n; of k_1 for hysteretic laws, which begin with it.
    """

    pressure: Positive
    residual_tolerance: Annotated[float, Meta(gt=0, le=1e-2)]


class TopWall(Table):
    """Strain control: z(t) = z_f + (z_0 - z_f)/2 (1 + cos(pi t/T)), eps = 1 - z/z_0 (talk, 'Bi-axial box')."""

    final_strain: Annotated[float, Meta(gt=0, lt=1)]
    duration: Positive


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

    @property
    def dimension(self) -> int:
        """The box of the talks is two-dimensional."""
        return 2

    @property
    def duration(self) -> float:
        """The run ends when the top wall comes to rest."""
        return self.top.duration


# --- free scenes -----------------------------------------------------------------------------


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

    With `friction` the particles' own sliding, rolling and torsion laws act at it too.
    """

    name: Name
    point: Vector
    normal: Vector
    friction: bool
    motion: ConstantMotion | CosineMotion | LoadedMotion | None = None


class Free(Table, tag="free", tag_field="kind"):
    """Explicit particles, planes, gravity: collisions, single bodies, chains and lattices.

    `bodies` stand inline or in a CSV file (`bodies_file`: x,y[,z],radius,mass and optionally
    vx,vy[,vz], wz in 2D or wx,wy,wz in 3D, inertia). `periodic` gives the box length of each axis, 0 for open ones.
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
    compare: FreeCompare = FreeCompare()


Scene = Biaxial | Free
