"""The contact laws as a scene names them: one struct a law, formula and source, units SI.

`harness.scene.laws` knows their scales; the engines and the kernel have a row for each that they compute.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from harness.scene.tables import Name, NonNegative, Positive, Table


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


class NormalNumbers(Table):
    """Numbers of a `linear` normal law."""

    normal_stiffness: Positive
    normal_damping: NonNegative


class SlidingNumbers(Table):
    """Numbers of a `spring` sliding law without a dynamic coefficient."""

    shear_friction: Positive
    shear_stiffness: Positive
    shear_damping: NonNegative


class Between(Table):
    """Two materials (or one twice) and the numbers that stand between them in place of those of `contact`.

    Without `sliding` those of contact.sliding stand.
    """

    materials: tuple[Name, Name]
    normal: NormalNumbers
    sliding: SlidingNumbers | None = None


class Contact(Table):
    """The contact effects between particles; a table that is absent is an effect that does not exist.

    `between` gives numbers for pairs of materials, of linear laws in free scenes; there is no mixing rule, and every
    pair without an entry has the numbers of `normal` and `sliding`.
    """

    normal: NormalLaw
    sliding: SlidingLaw | None = None
    rolling: RollingLaw | None = None
    torsion: SpringTorsion | None = None
    between: tuple[Between, ...] = ()
