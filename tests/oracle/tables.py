"""Hardening curves of brick and mortar from the rows of a deck (docs/theory/damage-plasticity.md, "Tables").

A row is (nominal stress [MPa], inelastic strain [-], damage [-]). It becomes a node (kappa, sigma, sigma_bar) with

    kappa = eps_in - d/(1 - d) sigma/E          sigma_bar = sigma + E (eps_in - kappa) = sigma/(1 - d)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Rows = Sequence[tuple[float, float, float]]

#: Smallest part of an increment of inelastic strain that has to be plastic.
PLASTIC_PART = 0.1
#: Pieces into which `lit` cuts the interval between two rows.
PIECES = 20


@dataclass(frozen=True)
class Curve:
    """Nominal and effective stress, both linear in kappa between nodes and constant beyond the last one."""

    eps_in: Floats
    kappa: Floats
    sigma: Floats
    sigma_bar: Floats

    @property
    def damage(self) -> Floats:
        """Damage at the nodes."""
        return 1.0 - self.sigma / self.sigma_bar

    def segment(self, kappa: float) -> int:
        """Index of the segment that begins at or before kappa."""
        return max(int(np.searchsorted(self.kappa, kappa, side="right")) - 1, 0)

    def end(self, segment: int) -> float:
        """Where a segment ends; infinite for the part beyond the last node."""
        return self.kappa[segment + 1] if segment + 1 < len(self.kappa) else np.inf

    def at(self, kappa: float, segment: int) -> tuple[float, float, float, float]:
        """sigma_bar, its slope, d, its slope. A segment goes on straight beyond its ends."""
        sigma, effective = self.sigma[segment], self.sigma_bar[segment]
        if segment + 1 == len(self.kappa):
            return effective, 0.0, 1.0 - sigma / effective, 0.0
        length = self.kappa[segment + 1] - self.kappa[segment]
        slope = (self.sigma[segment + 1] - sigma) / length
        effective_slope = (self.sigma_bar[segment + 1] - effective) / length
        sigma += slope * (kappa - self.kappa[segment])
        effective += effective_slope * (kappa - self.kappa[segment])
        damage_slope = (sigma * effective_slope / effective - slope) / effective
        return effective, effective_slope, 1.0 - sigma / effective, damage_slope


def curve(rows: Rows, E: float, *, interpolation: str = "eff1", length_ratio: float = 1.0) -> Curve:
    """The curve of a table.

    Parameters
    ----------
    rows
        The table. Shape (rows, 3).
    E
        Young's modulus [MPa].
    interpolation
        "eff1": the nodes are the rows. "lit": nominal stress and damage are linear in the inelastic strain, on
        `PIECES` pieces between two rows.
    length_ratio
        l_ref/l_eq, which multiplies the inelastic strain beyond the peak ("Crack band").
    """
    sigma, eps_in, damage = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    peak = int(np.argmax(sigma))
    eps_in[peak + 1 :] = eps_in[peak] + (eps_in[peak + 1 :] - eps_in[peak]) * length_ratio
    if interpolation == "lit":
        # Between rows i and i + 1 at the parts 1/PIECES, 2/PIECES, ... 1 of the way.
        row = np.arange(len(sigma), dtype=float)
        place = np.linspace(0.0, row[-1], PIECES * (len(sigma) - 1) + 1)
        sigma, eps_in, damage = (np.interp(place, row, values) for values in (sigma, eps_in, damage))
    elif interpolation != "eff1":
        raise ValueError(interpolation)
    kappa = np.zeros_like(sigma)
    for i in range(1, len(sigma)):
        literal = eps_in[i] - damage[i] / (1.0 - damage[i]) * sigma[i] / E
        # The cap: the stress stays, damage is lowered until the plastic strain grows enough.
        kappa[i] = max(literal, kappa[i - 1] + PLASTIC_PART * (eps_in[i] - eps_in[i - 1]))
    sigma_bar = sigma + E * (eps_in - kappa)
    found = Curve(eps_in, kappa, sigma, sigma_bar)
    # 1e-14: rounding where two rows have the same damage.
    if (np.diff(found.damage) < -1e-14).any():
        raise ValueError("the cap makes the damage decrease")
    return found
