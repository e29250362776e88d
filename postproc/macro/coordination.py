"""Coordination number, with and without rattlers."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.contact_ends import ContactEnds

MINIMUM_CONTACTS = 2
"""A particle with fewer contacts cannot be in equilibrium (without gravity), whatever the contact
law: two opposite contacts can hold a disc, with friction even off-axis. Without friction the
force balance of a stable particle needs dimension + 1: pass 3 in 2D, 4 in 3D."""


def coordination_number(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """C = sum_p w C^p / sum_p w, shape (K,): mean number of contacts of a particle.

    A contact with a wall counts for its particle like any other, so for a whole box
    C = (2 contacts between particles + contacts with walls) / N. NaN in a cell without particles.
    """
    return cells.mean(contact_number(ends))


def contact_number(ends: ContactEnds) -> np.ndarray:
    """C^p = sum_c 1, shape (N,)."""
    return ends.sum_c(np.ones(len(ends.particle)))


def backbone(ends: ContactEnds, minimum: int = MINIMUM_CONTACTS) -> tuple[np.ndarray, np.ndarray]:
    """Remove rattlers until none is left; return (who stays, bool (N,); contacts among them, (N,)).

    A rattler has fewer than `minimum` contacts with walls and particles that are not rattlers
    themselves; removing one can make others, hence the iteration.
    Source: Agnolin and Roux, Phys. Rev. E 76, 061302 (2007), section on rattlers.
    """
    stays = np.ones(ends.count, dtype=bool)
    while True:
        partner_stays = np.append(stays, True)[ends.partner]  # WALL = -1 reads the True at the end
        contacts = np.where(stays, ends.sum_c(partner_stays), 0.0)
        if (contacts[stays] >= minimum).all():
            return stays, contacts
        stays = stays & (contacts >= minimum)


def backbone_coordination_number(
    ends: ContactEnds, cells: Cells, minimum: int = MINIMUM_CONTACTS
) -> np.ndarray:
    """C* = sum_{p not rattler} w C*^p / sum_{p not rattler} w, shape (K,).

    C*^p counts the contacts that are left when all rattlers are removed (Agnolin and Roux's z*).
    Not quite Thornton's mechanical coordination number (Geotechnique 50, 43 (2000)), which takes
    particles with 0 or 1 contact out once and leaves their contacts with the others in.
    NaN where all particles are rattlers.
    """
    stays, contacts = backbone(ends, minimum)
    return divide(cells.total(contacts), cells.total(stays))


def rattler_fraction(ends: ContactEnds, cells: Cells, minimum: int = MINIMUM_CONTACTS) -> np.ndarray:
    """Share of particles that are rattlers, sum_{p rattler} w / sum_p w, shape (K,)."""
    stays, _ = backbone(ends, minimum)
    return cells.mean(~stays)
