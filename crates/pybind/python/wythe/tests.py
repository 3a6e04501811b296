"""Standard tests of masonry: specimens that run, and the evaluation that their standards report.

>>> import wythe
>>> test = wythe.tests.en1052_3(precompression="0.2, 1.0 MPa")
>>> [part for part in test.models]
['0.2', '1']

``test.run()`` runs the models and evaluates them. All functions take the same options:

unit
    Length, thickness and height of a unit, ``"250x120x55"`` or ``[250, 120, 55]`` [mm].
joint
    Thickness of the joints, ``10`` or ``"1 cm"`` [mm].
precompression
    Pressures, ``"0.2, 0.6, 1.0 MPa"`` or a sequence of numbers [MPa]; a model for each.
size
    Length and height of a wall, ``"1200x1200"`` or ``[1200, 1200]`` [mm]; the nearest whole units and courses are taken.
materials
    A TOML file with ``[materials.unit]``, ``[materials.mortar]`` and ``[interfaces.joint]``, a model that has them,
    or a dictionary; without it those of the catalogue.

``docs/reference/standard-tests.md`` describes each test.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, SupportsFloat, TypeAlias

from wythe import _wythe
from wythe._errors import as_path, expected, unread
from wythe._model import Model
from wythe._results import Results

__all__ = [
    "Evaluation",
    "Maker",
    "Test",
    "TestValue",
    "astm_c1531",
    "astm_e519",
    "couplet_tension",
    "direct_shear",
    "en1052_1",
    "en1052_2",
    "en1052_3",
    "en1052_5",
    "evaluate",
    "flat_jack",
    "flat_jack_double",
    "names",
    "out_of_plane",
    "out_of_plane_four_point",
    "out_of_plane_two_way",
    "rilem_lumb6",
    "shear_compression",
    "shear_compression_cantilever",
    "shear_compression_cyclic",
    "standard",
    "tilting_table",
]

#: A TOML file, a model, or a dictionary of ``materials`` and ``interfaces``.
Materials: TypeAlias = "str | os.PathLike[str] | Model | Mapping[str, Any]"
#: A number in base units, or a text with a unit.
Quantity: TypeAlias = "float | str"
#: Several of them.
Quantities: TypeAlias = "float | str | Sequence[float]"
#: Numbers [mm], or a text with ``x`` between them.
Sizes: TypeAlias = "str | Sequence[float]"


@dataclass(frozen=True)
class TestValue:
    """A result of a test.

    Attributes
    ----------
    name : str
        Symbol, such as ``f_v0``.
    value : float
        Value in its unit.
    unit : str
        Unit; empty for ratios.
    about : str
        Meaning and definition.
    """

    __test__ = False

    name: str
    value: float
    unit: str
    about: str


@dataclass(frozen=True)
class Evaluation(Mapping[str, float]):
    """Results of a standard test; ``evaluation["f_v0"]`` is a value of all runs together, or of the only run.

    Attributes
    ----------
    test : str
        Kind of the test.
    runs : dict
        Results of each run, by the name of its folder.
    together : dict
        Results of all runs together, by symbol; empty if the test has none.
    notes : tuple of str
        Remarks on how far the results can be trusted.
    results : dict
        ``Results`` of the runs, by what sets them apart; empty if ``evaluate`` was given folders.
    """

    test: str
    runs: dict[str, dict[str, TestValue]]
    together: dict[str, TestValue]
    notes: tuple[str, ...]
    results: dict[str, Results] = field(default_factory=dict, repr=False, compare=False)

    def _single(self) -> dict[str, TestValue]:
        only = next(iter(self.runs.values())) if len(self.runs) == 1 else {}
        return {**only, **self.together}

    def __getitem__(self, name: str) -> float:
        found = self._single()
        if name not in found:
            raise KeyError(f"{name}: there are {', '.join(found) or 'none'}; `runs` has those of each run")
        return found[name].value

    def __iter__(self) -> Any:
        return iter(self._single())

    def __len__(self) -> int:
        return len(self._single())

    def __str__(self) -> str:
        lines: list[str] = []
        for name, values in [*self.runs.items(), *([("all runs", self.together)] if self.together else [])]:
            lines.append(name)
            lines += [f"  {v.name:20}{v.value:12.4g} {v.unit:6} {v.about}" for v in values.values()]
        lines += [f"note: {note}" for note in self.notes]
        return "\n".join(lines)


@dataclass(frozen=True)
class Test:
    """The models of a standard test.

    Attributes
    ----------
    name : str
        Name of the test.
    models : dict
        Models by what sets them apart, such as the precompression ``"0.2"``; ``""`` if there is only one.
    """

    __test__ = False

    name: str
    models: dict[str, Model]

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        threads: int | None = None,
        progress: bool = False,
    ) -> Evaluation:
        """Runs all models, one after the other, and evaluates them.

        Parameters
        ----------
        out
            Folder for the folders of the runs; without one they are temporary.
        threads
            Number of threads; all cores by default.
        progress
            A line on standard error that follows each run.
        """
        results: dict[str, Results] = {}
        for part, model in self.models.items():
            folder = None
            if out is not None:
                folder = Path(out) / f"{self.name}{'-' if part else ''}{part}.out"
                folder.parent.mkdir(parents=True, exist_ok=True)
            results[part] = model.run(folder, threads=threads, progress=progress)
        found = evaluate(*results.values())
        names = [f"{self.name}{'-' if part else ''}{part}" for part in results]
        runs = dict(zip(names, found.runs.values(), strict=True))
        return Evaluation(found.test, runs, found.together, found.notes, results)


def names() -> dict[str, str]:
    """Names of the tests, as for ``wythe new --test``, with their descriptions."""
    return dict(_wythe.tests())


def evaluate(*runs: Results | str | os.PathLike[str]) -> Evaluation:
    """What a standard test reports, of runs or their folders."""
    folders = [os.fspath(run.path if isinstance(run, Results) else run) for run in runs]
    found = json.loads(_wythe.evaluate(folders))

    def values(rows: Sequence[Mapping[str, Any]]) -> dict[str, TestValue]:
        return {row["name"]: TestValue(**row) for row in rows}

    of_runs: dict[str, dict[str, TestValue]] = {}
    for number, run in enumerate(found["runs"], start=1):
        # Folders in different places may have one name.
        name = run["run"] if run["run"] not in of_runs else f"{run['run']}-{number}"
        of_runs[name] = values(run["values"])
    return Evaluation(
        found["test"],
        of_runs,
        values(found["together"]),
        tuple(found["notes"]),
    )


def _text(argument: str, value: Quantities | None, example: str) -> str | None:
    """A number or several as the text of the option."""
    if value is None or isinstance(value, str):
        return value
    numbers = _numbers(value)
    if not numbers:
        raise expected(argument, f"numbers, or a text such as {example}", value)
    return ", ".join(map(repr, numbers))


def _sizes(argument: str, value: Sizes | None, example: str) -> str | None:
    """Sizes as the text of the option."""
    if value is None or isinstance(value, str):
        return value
    numbers, wanted = _numbers(value), example.count("x") + 1
    if len(numbers) != wanted or isinstance(value, (float, int)):
        raise expected(argument, f"{wanted} numbers in mm, or a text such as {example}", value)
    return "x".join(map(repr, numbers))


def _numbers(value: object) -> list[float]:
    """Numbers of a sequence, an array or a single one; none if something else is among them."""
    tolist = getattr(value, "tolist", None)
    items: Any = tolist() if callable(tolist) else value
    if not isinstance(items, Sequence) or isinstance(items, str):
        items = [items]
    if any(isinstance(item, bool) or not isinstance(item, SupportsFloat) for item in items):
        return []
    return [float(item) for item in items]


def _tables(materials: Materials | None) -> str | None:
    if materials is None:
        return None
    if isinstance(materials, Model):
        return materials.to_toml()
    if isinstance(materials, Mapping):
        return Model.from_dict({"format": 1, **materials}).to_toml()
    name = as_path("materials", materials)
    try:
        return Path(name).read_text(encoding="utf-8")
    except OSError as error:
        raise unread(name, error) from error
    except UnicodeDecodeError as error:
        raise ValueError(f"materials: {name} is no text in UTF-8") from error


def standard(
    name: str,
    *,
    unit: Sizes | None = None,
    joint: Quantity | None = None,
    precompression: Quantities | None = None,
    size: Sizes | None = None,
    materials: Materials | None = None,
) -> Test:
    """The test of this name, see ``names``; the module describes the options."""
    decks = _wythe.test_decks(
        name,
        _sizes("unit", unit, '"250x120x55"'),
        _text("joint", joint, '"1 cm"'),
        _text("precompression", precompression, '"0.2, 1.0 MPa"'),
        _sizes("size", size, '"1200x1200"'),
        _tables(materials),
    )
    return Test(name, {part: Model.from_toml(text) for part, text in decks})


class Maker(Protocol):
    """A function that makes a standard test; the module describes its options."""

    __name__: str

    def __call__(
        self,
        *,
        unit: Sizes | None = None,
        joint: Quantity | None = None,
        precompression: Quantities | None = None,
        size: Sizes | None = None,
        materials: Materials | None = None,
    ) -> Test:
        """The test with these options."""
        ...


def _named(name: str, about: str) -> Maker:
    def make(
        *,
        unit: Sizes | None = None,
        joint: Quantity | None = None,
        precompression: Quantities | None = None,
        size: Sizes | None = None,
        materials: Materials | None = None,
    ) -> Test:
        return standard(
            name, unit=unit, joint=joint, precompression=precompression, size=size, materials=materials
        )

    make.__name__ = make.__qualname__ = name.replace("-", "_")
    make.__doc__ = about[0].upper() + about[1:] + ". The module describes the options."
    return make


_ABOUT = names()

en1052_1: Maker = _named("en1052-1", _ABOUT["en1052-1"])
en1052_2: Maker = _named("en1052-2", _ABOUT["en1052-2"])
en1052_3: Maker = _named("en1052-3", _ABOUT["en1052-3"])
en1052_5: Maker = _named("en1052-5", _ABOUT["en1052-5"])
couplet_tension: Maker = _named("couplet-tension", _ABOUT["couplet-tension"])
direct_shear: Maker = _named("direct-shear", _ABOUT["direct-shear"])
astm_e519: Maker = _named("astm-e519", _ABOUT["astm-e519"])
rilem_lumb6: Maker = _named("rilem-lumb6", _ABOUT["rilem-lumb6"])
shear_compression: Maker = _named("shear-compression", _ABOUT["shear-compression"])
shear_compression_cantilever: Maker = _named(
    "shear-compression-cantilever", _ABOUT["shear-compression-cantilever"]
)
shear_compression_cyclic: Maker = _named("shear-compression-cyclic", _ABOUT["shear-compression-cyclic"])
out_of_plane: Maker = _named("out-of-plane", _ABOUT["out-of-plane"])
out_of_plane_two_way: Maker = _named("out-of-plane-two-way", _ABOUT["out-of-plane-two-way"])
out_of_plane_four_point: Maker = _named("out-of-plane-four-point", _ABOUT["out-of-plane-four-point"])
tilting_table: Maker = _named("tilting-table", _ABOUT["tilting-table"])
flat_jack: Maker = _named("flat-jack", _ABOUT["flat-jack"])
flat_jack_double: Maker = _named("flat-jack-double", _ABOUT["flat-jack-double"])
astm_c1531: Maker = _named("astm-c1531", _ABOUT["astm-c1531"])
