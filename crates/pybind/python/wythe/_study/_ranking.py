"""Influence of parameters: rank correlations and standardised regression coefficients."""

from __future__ import annotations

import importlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict

import numpy as np
from numpy.typing import NDArray

from wythe._errors import need
from wythe._study._quantity import quantity
from wythe._study._text import page

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, unused-ignore]


class Rank(TypedDict):
    """Effect of a parameter on a measure."""

    parameter: str
    spearman: float
    """Spearman's rank correlation, −1 to 1; it detects any monotone relation."""
    regression: float
    """Change of the measure for a change of this parameter alone, both in standard deviations."""


@dataclass(frozen=True, repr=False)
class Ranking:
    """Parameters in the order of their effect, the strongest first."""

    of: str
    """The measure."""
    ranks: tuple[Rank, ...]
    samples: int
    """Number of samples used."""
    not_converged: int
    """Number of these that did not converge."""
    r_squared: float
    """Fraction of the variance of the measure explained by the linear regression."""
    noise: float
    """Correlations below this value may be chance: 95 % of those between independent columns are lower."""
    left_out: Mapping[str, str]
    """Parameters that cannot be ranked, with the reason."""

    def __len__(self) -> int:
        return len(self.ranks)

    def __getitem__(self, at: int) -> Rank:
        return self.ranks[at]

    def __iter__(self) -> Iterator[Rank]:
        return iter(self.ranks)

    def to_pandas(self) -> pandas.DataFrame:
        """The ranking as a DataFrame; needs pandas (``pip install 'wythe[study]'``)."""
        need("pandas", "study")
        import pandas

        return pandas.DataFrame(list(self.ranks), columns=["parameter", "spearman", "regression"])

    def __repr__(self) -> str:
        width = max(len(name) for name in ("parameter", *(rank["parameter"] for rank in self.ranks)))
        lines = [f"{'parameter':<{width}}  spearman  regression"]
        for rank, (name, spearman, regression) in zip(self.ranks, self._cells(), strict=True):
            bar = "█" * round(12 * abs(rank["spearman"]))
            lines.append(f"{name:<{width}}  {spearman:>8}  {regression:>10}  {bar}".rstrip())
        return "\n".join([self._title(), *lines, *self._notes()])

    def _repr_html_(self) -> str:
        return page(self._title(), ("parameter", "spearman", "regression"), self._cells(), self._notes())

    def _cells(self) -> list[tuple[str, str, str]]:
        return [
            (
                rank["parameter"],
                f"{rank['spearman']:+.2f}",
                "–" if math.isnan(rank["regression"]) else f"{rank['regression']:+.2f}",
            )
            for rank in self.ranks
        ]

    def _title(self) -> str:
        unsure = f", {self.not_converged} of them not converged" if self.not_converged else ""
        return f"What moves {self.of}: {self.samples} samples{unsure}"

    def _notes(self) -> list[str]:
        notes: list[str] = []
        if math.isfinite(self.r_squared):
            notes.append(f"The linear regression explains {100.0 * self.r_squared:.0f} % of the variance.")
        elif self.ranks:
            notes.append("Too few or dependent columns for a regression.")
        if self.ranks:
            notes.append(f"Correlations below {self.noise:.2f} may be chance.")
        notes.extend(f"Left out: {name}, {why}." for name, why in self.left_out.items())
        return notes


def ranked(
    of: str,
    cells: Sequence[object],
    inputs: Mapping[str, Sequence[object]],
    not_converged: Sequence[bool],
) -> Ranking:
    """Ranks the inputs by their effect on ``of``; ``cells`` and the inputs have one value per sample."""
    y = _numbers(cells)
    if y is None:
        raise ValueError(f"of: expected a column of numbers, {of} is none")
    used = np.isfinite(y)
    y = y[used]
    columns: dict[str, NDArray[np.float64]] = {}
    left_out: dict[str, str] = {}
    for name, values in inputs.items():
        column = _numbers([value for value, use in zip(values, used, strict=True) if use])
        if column is None:
            left_out[name] = "not numbers of one unit"
        elif _constant(column):
            left_out[name] = "constant"
        else:
            columns[name] = column
    count = int(y.size)
    if count < 3 or _constant(y):
        why = f"{of} is constant" if count >= 3 else f"fewer than 3 samples have {of}"
        left_out.update((name, why) for name in columns)
        columns = {}
    regression, r_squared = _regression(columns, y)
    need("scipy", "study")
    stats = importlib.import_module("scipy.stats")
    ranks = [
        Rank(
            parameter=name,
            spearman=float(stats.spearmanr(column, y).statistic),
            regression=regression[name],
        )
        for name, column in columns.items()
    ]
    ranks.sort(key=lambda rank: -abs(rank["spearman"]))
    return Ranking(
        of=of,
        ranks=tuple(ranks),
        samples=count,
        not_converged=sum(flag for flag, use in zip(not_converged, used, strict=True) if use),
        r_squared=r_squared,
        noise=min(1.0, 1.96 / math.sqrt(max(1, count - 1))),
        left_out=left_out,
    )


def _regression(
    columns: Mapping[str, NDArray[np.float64]], y: NDArray[np.float64]
) -> tuple[dict[str, float], float]:
    """Coefficients of standardised columns and R²; NaN if the columns do not determine them."""
    nothing = dict.fromkeys(columns, math.nan), math.nan
    if not columns or y.size < len(columns) + 2:
        return nothing
    x, z = ((a - a.mean(axis=0)) / a.std(axis=0) for a in (np.stack([*columns.values()], axis=1), y))
    coefficients, _, rank, _ = np.linalg.lstsq(x, z, rcond=1e-10)
    if rank < len(columns):
        return nothing
    rest = z - x @ coefficients
    return dict(zip(columns, map(float, coefficients), strict=True)), float(1.0 - rest @ rest / (z @ z))


def _constant(column: NDArray[np.float64]) -> bool:
    """Whether a column is constant up to rounding, for example of a conversion of units."""
    if column.size == 0:
        return True
    return float(np.ptp(column)) <= 1e-12 * float(np.max(np.abs(column)))


def _numbers(cells: Sequence[object]) -> NDArray[np.float64] | None:
    """Numbers, with NaN for missing ones; quantities if they have a common unit; None otherwise."""
    units: set[str] = set()
    numbers: list[float] = []
    for cell in cells:
        if cell is None or (isinstance(cell, float) and math.isnan(cell)):
            numbers.append(math.nan)
            continue
        read = quantity(cell)
        if read is None:
            return None
        numbers.append(read[0])
        units.add(read[1])
    return np.array(numbers, dtype=np.float64) if len(units) <= 1 else None
