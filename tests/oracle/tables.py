"""Hardening curves of brick and mortar from the rows of a table.

Source: docs/theory/damage-plasticity.md, eqs 9 to 11, and docs/theory/crack-band.md, eq. 4. A row (sigma, eps_in, d)
becomes a node (kappa, sigma, sigma_bar):

    kappa = eps_in - d/(1 - d) sigma/E          sigma_bar = sigma + E (eps_in - kappa) = sigma/(1 - d)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Rows = Sequence[tuple[float, float, float]]

#: b of eq. 10: smallest part of an increment of inelastic strain that is plastic.
PLASTIC_PART = 0.1
#: Pieces into which `lit` divides the interval between two rows.
PIECES = 20


@dataclass(frozen=True)
class Curve:
    """Nominal and effective stress [MPa], both linear in kappa between nodes, constant beyond the last one."""

    eps_in: Floats
    kappa: Floats
    sigma: Floats
    sigma_bar: Floats

    @property
    def damage(self) -> Floats:
        """Damage at the nodes."""
        return 1.0 - self.sigma / self.sigma_bar

    def segment(self, kappa: float) -> int:
        """Index of the segment that holds kappa; a node belongs to the segment that begins there."""
        return max(int(np.searchsorted(self.kappa, kappa, side="right")) - 1, 0)

    def end(self, segment: int) -> float:
        """kappa at the end of a segment; infinite beyond the last node."""
        return float(self.kappa[segment + 1]) if segment + 1 < len(self.kappa) else np.inf

    def at(self, kappa: float, segment: int) -> tuple[float, float, float, float]:
        """sigma_bar, its slope, d, its slope. The formulas of a segment hold beyond its ends, too."""
        sigma, effective = float(self.sigma[segment]), float(self.sigma_bar[segment])
        if segment + 1 == len(self.kappa):
            return effective, 0.0, 1.0 - sigma / effective, 0.0
        length = float(self.kappa[segment + 1] - self.kappa[segment])
        slope = (float(self.sigma[segment + 1]) - sigma) / length
        effective_slope = (float(self.sigma_bar[segment + 1]) - effective) / length
        sigma += slope * (kappa - float(self.kappa[segment]))
        effective += effective_slope * (kappa - float(self.kappa[segment]))
        damage_slope = (sigma * effective_slope / effective - slope) / effective
        return effective, effective_slope, 1.0 - sigma / effective, damage_slope


def curve(rows: Rows, E: float, *, interpolation: str = "eff1", length_ratio: float = 1.0) -> Curve:
    """The curve of a table.

    Parameters
    ----------
    rows
        Nominal stress [MPa], inelastic strain [-], damage [-]. Shape (rows, 3).
    E
        Young's modulus [MPa].
    interpolation
        "eff1": the nodes are the rows. "lit": nominal stress and damage are linear in the inelastic strain, with
        `PIECES` intervals between two rows.
    length_ratio
        l_ref/l of the crack band: it multiplies the inelastic strain beyond the peak.
    """
    sigma, eps_in, damage = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    peak = int(np.argmax(sigma))
    eps_in[peak + 1 :] = eps_in[peak] + (eps_in[peak + 1 :] - eps_in[peak]) * length_ratio
    if interpolation == "lit":
        row = np.arange(len(sigma), dtype=float)
        place = np.linspace(0.0, row[-1], PIECES * (len(sigma) - 1) + 1)
        sigma, eps_in, damage = (np.interp(place, row, values) for values in (sigma, eps_in, damage))
    elif interpolation != "eff1":
        raise ValueError(interpolation)
    kappa = np.zeros_like(sigma)
    for i in range(1, len(sigma)):
        literal = eps_in[i] - damage[i] / (1.0 - damage[i]) * sigma[i] / E
        # Where this bound holds, the stress stays and the damage follows from eq. 11.
        kappa[i] = max(literal, kappa[i - 1] + PLASTIC_PART * (eps_in[i] - eps_in[i - 1]))
    found = Curve(eps_in, kappa, sigma, sigma + E * (eps_in - kappa))
    # 1e-14: rounding between two rows of the same damage.
    if (np.diff(found.damage) < -1e-14).any():
        raise ValueError("the bound of the plastic strain makes the damage decrease")
    return found
