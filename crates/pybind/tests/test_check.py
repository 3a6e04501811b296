"""What is wrong with a model: findings before a run, and the errors that tell the same."""

from __future__ import annotations

from pathlib import Path

import pytest
import wythe

TEXT = wythe.templates.text("couplet")


def line_of(text: str, begin: str) -> int:
    """Number of the first line that begins so, from 1."""
    return next(i for i, line in enumerate(text.splitlines(), 1) if line.startswith(begin))


def test_a_sound_model() -> None:
    found: wythe.Findings = wythe.templates.couplet().check()
    assert found
    assert found.ok
    assert found.title == "couplet"
    assert (found.errors, found.warnings) == ((), ())
    assert any("k_n / k_s = 9900" in note for note in found.notes)
    sizes = (found.units, found.elements, found.nodes, found.dofs, found.contact_points)
    assert sizes == (2, 24, 75, 135, 32)
    assert 0.0 < found.memory_MB < 100.0
    low, high = found.processor_time_s
    assert 0.0 < low < high < 10.0
    assert "2 units, 24 elements, 75 nodes" in str(found)


def test_a_model_that_cannot_be_run_has_no_sizes() -> None:
    text = TEXT.replace("[[steps]]", 'output = { experiment = "no.csv" }\n[[steps]]', 1)
    text = text.replace("output = ", "[output]\nexperiment = ").replace(
        '{ experiment = "no.csv" }', '"no.csv"'
    )
    found = wythe.Model.from_toml(text).check()
    assert not found
    sizes = (found.units, found.elements, found.nodes, found.dofs, found.contact_points)
    assert sizes == (0, 0, 0, 0, 0)
    assert found.memory_MB == 0.0
    assert found.processor_time_s == (0.0, 0.0)
    (error,) = found.errors
    assert error.key == "output.experiment"
    assert error.line == line_of(text, "experiment")
    assert error.column == len("experiment = ") + 1
    assert "No such file" in error.message
    assert error.fix
    assert f"(line {error.line})" in str(error)
    assert "cannot be run" in str(found)


def test_warnings_have_their_lines() -> None:
    text = TEXT.replace('f_t = "0.28 MPa"', 'f_t = "2 MPa"')
    found = wythe.Model.from_toml(text).check()
    assert found.ok
    (warning,) = found.warnings
    assert warning.key == "interfaces.joint.f_t"
    assert (warning.line, warning.fix) == (line_of(text, "f_t"), "")
    assert "slides without resistance" in warning.message
    assert "warning: interfaces.joint.f_t" in str(found)


def test_what_no_one_has_written_has_no_lines() -> None:
    found = wythe.templates.couplet(f_t="2 MPa").check()
    assert [(problem.line, problem.column) for problem in found.warnings] == [(None, None)]
    with pytest.raises(wythe.ModelError) as raised:
        wythe.templates.couplet().with_(wall__courses=0)
    error = raised.value
    assert (error.file, error.line, error.column, error.key) == (None, None, None, "wall.courses")
    assert str(error).startswith("wall.courses: a wall has at least one course\n  fix: ")


def test_all_errors_of_a_text_at_once() -> None:
    text = TEXT.replace("16.7 GPa", "16.7 GN").replace("mu = 0.73", "mu = -1")
    with pytest.raises(wythe.ModelError) as raised:
        wythe.Model.from_toml(text)
    error = raised.value
    assert (error.file, error.key) == (None, "materials.brick.E")
    assert (error.line, error.column) == (line_of(text, 'E = "16.7 GN"'), 5)
    assert '"GN" is not a known unit' in error.message
    assert error.fix == 'write it like this: E = "16.7 GPa"'
    (other,) = error.others
    assert (other.key, other.line, other.others) == ("interfaces.joint.mu", line_of(text, "mu"), ())
    assert str(error).startswith(f"line {error.line}:5: materials.brick.E: ")
    assert f"\nline {other.line}:6: interfaces.joint.mu: -1 is negative" in str(error)
    assert isinstance(error, wythe.WytheError)
    assert isinstance(error, ValueError)


def test_errors_of_a_file_name_it(tmp_path: Path) -> None:
    path = tmp_path / "wall.toml"
    path.write_text(TEXT.replace("courses = 2", "curses = 2"))
    with pytest.raises(wythe.ModelError) as raised:
        wythe.Model.from_toml(path)
    error = raised.value
    assert error.file == str(path)
    assert error.key == "wall.curses"
    assert str(error).startswith(f"{path}:{error.line}:1: wall.curses: ")


def test_errors_of_overrides_name_the_key_and_no_line(tmp_path: Path) -> None:
    path = tmp_path / "wall.toml"
    path.write_text(TEXT)
    wrong: dict[str, wythe.build.Quantity] = {"wall.courses": 0.5, "wall.curses": 2}
    for source in (TEXT, str(path)):
        with pytest.raises(wythe.ModelError) as raised:
            wythe.Model.from_toml(source, wrong)
        error = raised.value
        assert [e.key for e in (error, *error.others)] == ["wall.courses", "wall.curses"]
        assert {(e.file, e.line, e.column) for e in (error, *error.others)} == {(None, None, None)}
        assert "--set" not in str(error)


def test_the_first_layer_hides_the_second() -> None:
    """Physics are judged where the form is right: a model that cannot be made has no findings."""
    with pytest.raises(wythe.ModelError, match="at least one course"):
        wythe.templates.couplet().with_({"wall.courses": 0, "interfaces.joint.f_t": "2 MPa"})


def test_a_run_tells_what_a_check_tells() -> None:
    model = wythe.templates.couplet().with_({"output.experiment": "no.csv"})
    (error,) = model.check().errors
    for refuse in (model.run, model.picture, model.to_inp):
        with pytest.raises(wythe.ModelError) as raised:
            refuse()
        assert (raised.value.key, raised.value.message) == (error.key, error.message)
        assert raised.value.fix == error.fix
