"""Reads a job: a TOML file, or mappings with the same keys."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np

from wythe import _wythe
from wythe._calibrate._errors import CalibrationError
from wythe._calibrate._job import Column, Curve, CurveTest, Job, Key, Parameter, Prior, Sampling, Settings
from wythe._calibrate._table import Table, told
from wythe._errors import ModelError, OutputError, need
from wythe._model import Model
from wythe._study._worker import RESERVED

GUIDE = "docs/reference/calibration.md lists all keys"
# Fewest points of a curve that can be compared.
FEWEST = 3


def toml_of(text: str) -> dict[str, Any]:
    """Content of a TOML text; a ValueError if it is none."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        need("tomli", "study")
        import tomli as tomllib
    content: dict[str, Any] = tomllib.loads(text)
    return content


def job_of_file(path: str, posterior: object = None) -> Job:
    """Reads a job file; files named in it are relative to its folder. ``posterior`` replaces that of the job."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text in UTF-8"
        raise CalibrationError(f"cannot be read: {reason}", fix="check the path of the job", file=path) from error
    try:
        content = toml_of(text)
    except ValueError as error:
        raise CalibrationError(f"no TOML: {error}", fix="correct the syntax there", file=path) from error
    if posterior is not None:
        content["posterior"] = posterior
    return job_of(content, path)


def job_of(content: Mapping[str, Any], file: str | None = None) -> Job:
    """Reads and checks a job; without a file, paths are relative to the current folder."""
    table = Table(content, "", file)
    folder = Path(file).parent if file is not None else Path()
    version = table.whole("format", 1, 1)
    if version != 1:
        table.fail("format", f"format {version} is not known", "write format = 1, or use a newer wythe")
    title = table.text("title", Path(file).stem if file is not None else "Calibration")
    out = table.text("out", "") or None
    tests = _tests(table, folder)
    parameters = _parameters(table, [test.name for test in tests])
    settings = _settings(Table(table.get("fit") or {}, "fit", file))
    sampling = _sampling(table.get("posterior"), len(parameters), file)
    table.end()
    job = Job(
        title=title,
        parameters=parameters,
        tests=tests,
        settings=settings,
        sampling=sampling,
        out=None if out is None else str(folder / out),
        file=file,
    )
    _try_keys(job)
    return job


def _parameters(job: Table, tests: list[str]) -> tuple[Parameter, ...]:
    content = job.need("parameters", "write [parameters.NAME] with key, start and bounds")
    table = Table(content, "parameters", job.file)
    if not table.keys():
        table.fail("", "there is none", "write [parameters.NAME] with key, start and bounds")
    return tuple(_parameter(table, name, tests) for name in table.keys())  # noqa: SIM118


def _parameter(above: Table, name: str, tests: list[str]) -> Parameter:
    table = Table(above.get(name), f"parameters.{name}", above.file)
    if not re.fullmatch(r"[A-Za-z_]\w*", name) or name in RESERVED or name == "test":
        table.fail("", f"`{name}` cannot be a name", "choose a name of letters, digits and _, such as f_t")
    keys = _keys(table, tests)
    start, unit = table.quantity("start", table.need("start", "write a first guess: start = 0.2"))
    bounds = table.items("bounds", table.need("bounds", "write bounds = [low, high]"))
    if len(bounds) != 2:
        table.fail("bounds", f"expected two, got {len(bounds)}", "write bounds = [low, high]")
    (low, low_unit), (high, high_unit) = (table.quantity("bounds", bound) for bound in bounds)
    prior, prior_unit = _prior(table, unit)
    if len({unit, low_unit, high_unit, prior_unit}) > 1:
        fix = "write start, bounds and the mean of the prior in one unit"
        table.fail("", f"units differ: start in {unit or 'none'}, bounds in {low_unit or 'none'}", fix)
    if not low < high:
        table.fail("bounds", f"{low:g} is not below {high:g}", "write the lower bound first")
    if not low <= start <= high:
        table.fail("start", f"{start:g} is not between the bounds {low:g} and {high:g}", "move start or bounds")
    log = table.choice("scale", "linear", ("linear", "log")) == "log"
    lognormal = prior is not None and prior.kind == "lognormal"
    for needs, what in ((log, "a logarithmic scale"), (lognormal, "a lognormal prior")):
        if needs and low <= 0.0:
            table.fail("bounds", f"{what} needs bounds above 0, got {low:g}", "give a lower bound above 0")
    table.end()
    return Parameter(name, keys, start, low, high, prior, log, unit)


def _keys(table: Table, tests: list[str]) -> tuple[Key, ...]:
    if table.has("key") == table.has("keys"):
        fix = 'write key = "interfaces.joint.f_t", or keys = […] for several'
        table.fail("key", "expected either key or keys", fix)
    many = table.has("keys")
    given = table.items("keys", table.get("keys")) if many else [table.get("key")]
    return tuple(_key(table, f"keys.{at}" if many else "key", item, tests) for at, item in enumerate(given))


def _key(table: Table, where: str, item: object, tests: list[str]) -> Key:
    if isinstance(item, str) and item:
        return Key(item, 1.0, None)
    if not isinstance(item, Mapping):
        fix = 'write a dotted path, or { key = "interfaces.joint.f_t", factor = 2, tests = ["shear"] }'
        table.fail(where, f"expected a deck key, got {told(item)}", fix)
    own = Table(item, f"{table.where}.{where}", table.file)
    key = own.need("key", 'write key = "interfaces.joint.f_t"')
    if not isinstance(key, str) or not key:
        own.fail("key", f"expected a dotted path, got {told(key)}", 'write key = "interfaces.joint.f_t"')
    factor = own.number("factor", 1.0)
    names = tuple(own.items("tests", own.get("tests"))) if own.has("tests") else None
    for name in names or ():
        if name not in tests:
            own.fail("tests", f"there is no test named {told(name)}", f"the tests are {', '.join(tests)}")
    own.end()
    return Key(key, factor, names)


def _prior(above: Table, unit: str) -> tuple[Prior | None, str]:
    if not above.has("prior"):
        return None, unit
    table = Table(above.get("prior"), f"{above.where}.prior", above.file)
    kind = table.choice("kind", "lognormal", ("normal", "lognormal"))
    mean, own = table.quantity("mean", table.need("mean", "write mean = the expected value"))
    cv = table.number("cv", None, least=0.0)
    if mean == 0.0 or (kind == "lognormal" and mean < 0.0):
        table.fail("mean", f"{mean:g} is not admissible", "give a mean above 0, of which cv is a part")
    table.end()
    return Prior(cast('Literal["normal", "lognormal"]', kind), mean, cv), own


def _tests(job: Table, folder: Path) -> tuple[CurveTest, ...]:
    given = job.items("tests", job.need("tests", "write [[tests]] with name, deck and curves"))
    tests = [_test(Table(item, f"tests.{at}", job.file), at, folder) for at, item in enumerate(given)]
    names = [test.name for test in tests]
    for at, name in enumerate(names):
        if name in names[:at]:
            job.fail(f"tests.{at}.name", f"`{name}` is the name of another test", "give each test its own name")
    return tuple(tests)


def _test(table: Table, at: int, folder: Path) -> CurveTest:
    name = table.text("name", f"test {at + 1}")
    model = _model(table, folder)
    given = table.need("curves", 'write curves = ["measured.csv"]')
    # An array of shape (points, 2) is one curve.
    several = [given] if isinstance(given, (str, os.PathLike, np.ndarray)) else table.items("curves", given)
    curves = tuple(_curve(table, f"curves.{n}", item, folder) for n, item in enumerate(several))
    x, y = _column(table, "x", "displacement_mm"), _column(table, "y", "force_kN")
    steps = tuple(table.items("steps", table.get("steps"))) if table.has("steps") else None
    if steps is not None and not all(isinstance(step, int) and step >= 0 for step in steps):
        table.fail("steps", "expected numbers of steps", "count the steps of the deck from 0: steps = [1]")
    low, high = _limit(table, "from", -np.inf), _limit(table, "to", np.inf)
    if not low < high:
        table.fail("to", f"{high:g} is not above from = {low:g}", "give to a larger displacement than from")
    for curve in curves:
        inside = (curve.displacement >= low) & (curve.displacement <= high)
        if np.count_nonzero(inside) < FEWEST:
            what = f"{curve.name} has {np.count_nonzero(inside)} points between from and to"
            table.fail("curves", f"{what}, expected {FEWEST} or more", "widen the window, or digitise more points")
    factor = table.number("factor", 1.0)
    weight, peak = table.number("weight", 1.0, least=0.0), table.number("peak", 0.0)
    if peak < 0.0:
        table.fail("peak", f"{peak:g} is negative", "give 0, or as how many points the peak counts")
    table.end()
    return CurveTest(name, model, curves, x, y, steps, factor, weight, peak, low, high)


def _limit(table: Table, key: str, default: float) -> float:
    if not table.has(key):
        return float(default)
    number, unit = table.quantity(key, table.get(key))
    if unit not in ("", "mm"):
        table.fail(key, f"the unit {unit} is not that of the curves", "give a number, or a text in mm")
    return number


def _column(table: Table, key: str, default: str) -> Column:
    name = table.text(key, default)
    return Column(name.removeprefix("-"), -1.0 if name.startswith("-") else 1.0)


def _model(table: Table, folder: Path) -> Any:
    deck = table.need("deck", 'write deck = "couplet.toml"')
    changes = _changes(table)
    if hasattr(deck, "with_"):
        try:
            return deck.with_(changes)
        except ModelError as error:
            table.fail("set", str(error).replace("\n  fix:", "; fix:"), "correct the key or its value")
    if not isinstance(deck, (str, os.PathLike)):
        table.fail("deck", f"expected a path or a wythe.Model, got {told(deck)}", 'write deck = "couplet.toml"')
    path = folder / os.fspath(deck)
    try:
        return Model.from_toml(path, changes)
    except (ModelError, OutputError) as error:
        fix = "correct the deck; `wythe check` shows all its errors"
        if isinstance(error, OutputError):
            fix = "check the path; it is relative to the folder of the job"
        table.fail("deck", str(error).replace("\n  fix:", "; fix:"), fix)


def _changes(table: Table) -> dict[str, Any]:
    given = table.get("set")
    if given is None:
        return {}
    if isinstance(given, Mapping):
        return dict(given)
    changes: dict[str, Any] = {}
    for item in table.items("set", given):
        key, equals, value = str(item).partition("=")
        if not equals or not key.strip():
            table.fail("set", f"expected KEY=VALUE, got {told(item)}", 'write set = ["steps.1.displacement=0.1 mm"]')
        try:
            changes[key.strip()] = toml_of(f"value = {value}")["value"]
        except ValueError:
            changes[key.strip()] = value.strip()
    return changes


def _curve(table: Table, where: str, item: object, folder: Path) -> Curve:
    if isinstance(item, (str, os.PathLike)):
        path = folder / os.fspath(item)
        try:
            name, points = _wythe.experiment(path)
        except (ModelError, OutputError) as error:
            fix = error.fix or "see docs/how-to/compare-with-a-test.md for the form of the file"
            if isinstance(error, OutputError):
                fix = "check the path; it is relative to the folder of the job"
            table.fail(where, str(error).partition("\n")[0], fix)
    else:
        name, points = f"curve {where.rpartition('.')[2]}", _points(table, where, item)
    if not np.all(np.isfinite(points)):
        table.fail(where, f"{name} has numbers that are not finite", "leave such points out")
    if np.max(points[:, 1]) <= 0.0:
        fix = "turn the sign of the forces, so that the driven direction is positive"
        table.fail(where, f"{name} has no force above 0", fix)
    back = np.max(np.maximum.accumulate(points[:, 0]) - points[:, 0])
    if back > 0.1 * np.ptp(points[:, 0]):
        table.fail(where, f"{name} goes back by {back:.4g} mm", "give the envelope of a cyclic test")
    return Curve(name, points[:, 0].copy(), points[:, 1].copy())


def _points(table: Table, where: str, item: object) -> Any:
    wanted = "expected a path or an array of shape (points, 2)"
    fix = "give displacements [mm] and forces [kN] in two columns"
    try:
        points = np.asarray(item, dtype=np.float64)
    except (TypeError, ValueError):
        table.fail(where, f"{wanted}, got {told(item)}", fix)
    if points.ndim != 2 or points.shape[-1] != 2:
        got = f"one of shape {points.shape}" if points.ndim else told(item)
        table.fail(where, f"{wanted}, got {got}", fix)
    if len(points) < FEWEST:
        table.fail(where, f"{wanted} with {FEWEST} points or more, got {len(points)}", fix)
    return points


def _settings(table: Table) -> Settings:
    settings = Settings(
        iterations=table.whole("iterations", Settings.iterations, 1),
        tolerance=table.number("tolerance", Settings.tolerance, least=0.0),
        step=table.number("step", Settings.step, least=0.0),
        central=table.choice("differences", "central", ("central", "forward")) == "central",
        noise=table.number("noise", None, least=0.0) if table.has("noise") else None,
    )
    table.end()
    return settings


def _sampling(content: object, count: int, file: str | None) -> Sampling | None:
    """The posterior: a table, or one word."""
    if content is None or content is False or content == "none":
        return None
    table = Table({"kind": content} if isinstance(content, str) else content, "posterior", file)
    kind = table.choice("kind", "linearised", ("linearised", "model", "none"))
    cheap = kind == "linearised"
    sampling = Sampling(
        kind="linearised" if cheap else "model",
        walkers=table.whole("walkers", max(32 if cheap else 8, 2 * count + 2), 2 * count + 2),
        steps=table.whole("steps", 2000 if cheap else 150, 10),
        burn=table.whole("burn", 500 if cheap else 50, 0),
        draws=table.whole("draws", 16, 0),
        seed=table.whole("seed", 1, 0),
    )
    if sampling.burn >= sampling.steps:
        table.fail("burn", f"{sampling.burn} is not below steps = {sampling.steps}", "give fewer steps to burn")
    table.end()
    return None if kind == "none" else sampling


def _try_keys(job: Job) -> None:
    """Sets the start in every deck, so that a misspelt key is an error at once."""
    start = {parameter.name: parameter.start for parameter in job.parameters}
    for at, test in enumerate(job.tests):
        for parameter in job.parameters:
            for n, key in enumerate(parameter.keys):
                if key.tests is not None and test.name not in key.tests:
                    continue
                value = parameter.deck_value(start[parameter.name], key.factor)
                try:
                    test.model.with_({key.key: value})
                except ModelError as error:
                    raise CalibrationError(
                        f"the deck of test `{test.name}` (tests.{at}) refuses {key.key} = {value}: {error.message}",
                        key=f"parameters.{parameter.name}.{f'keys.{n}' if len(parameter.keys) > 1 else 'key'}",
                        fix=_advice(error, len(job.tests)),
                        file=job.file,
                    ) from error


def _advice(error: ModelError, tests: int) -> str:
    advice = error.fix or "correct the key, or the start"
    if tests > 1 and error.kind in ("unknown-key", "unknown-name", "missing"):
        advice += '; a key of some decks only: { key = "…", tests = ["NAME"] }'
    return advice


def names(items: Iterable[str]) -> str:
    """Names in a sentence."""
    listed = list(items)
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} and {listed[-1]}"
