"""Equal models: how they compare, hash, pickle, copy and show themselves."""

from __future__ import annotations

import copy
import hashlib
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest
import wythe
from helpers import EXAMPLES
from wythe._model import _interface as summary_of_interface

COUPLET = wythe.templates.couplet()


def test_what_says_the_same_is_equal() -> None:
    same = COUPLET.with_({"materials.brick.E": 16700, "wall.mesh": [5, 2, 2]})
    assert same == COUPLET
    assert hash(same) == hash(COUPLET)
    assert len({same, COUPLET, wythe.templates.couplet()}) == 1


def test_what_says_something_else_is_not() -> None:
    others = [COUPLET.with_(title="x"), COUPLET.with_(output__every=1), wythe.templates.arch()]
    assert all(other != COUPLET for other in others)
    assert COUPLET != "couplet"
    assert COUPLET.__eq__(3) is NotImplemented


def test_equal_models_have_one_hash_whatever_zeros_and_order() -> None:
    above, below = (
        COUPLET.with_({"materials.brick.nu": 0.0}),
        COUPLET.with_({"materials.brick.nu": -0.0}),
    )
    assert above == below
    assert hash(above) == hash(below)
    deck = COUPLET.to_dict()
    deck["materials"] = dict(reversed(deck["materials"].items()))
    turned = wythe.Model.from_dict(deck)
    assert turned != COUPLET or hash(turned) == hash(COUPLET)


def test_files_that_decide_belong_to_the_model(tmp_path: Path) -> None:
    """Of two folders with files of the same name, each makes its own model."""
    deck = COUPLET.with_({"output.experiment": "test.csv"}).to_dict()
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "test.csv").write_text("displacement_mm,force_kN\n0,0\n1,1\n")
    one, other = (wythe.Model.from_dict(deck, folder=tmp_path / name) for name in ("a", "b"))
    assert one != other
    assert one == wythe.Model.from_dict(deck, folder=str(tmp_path / "a"))
    # Where no file is named the folder says nothing.
    plain = COUPLET.to_dict()
    assert wythe.Model.from_dict(plain, folder=tmp_path) == COUPLET


def test_the_digest_is_that_of_the_text(couplet: wythe.Results) -> None:
    model = wythe.templates.couplet("0.02 mm")
    assert model.digest == hashlib.sha256(model.to_toml().encode()).hexdigest()
    assert model.digest == hashlib.sha256((couplet.deck or "").encode()).hexdigest()
    assert couplet.model == model


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_copies_are_equal(path: Path) -> None:
    model = wythe.Model.from_toml(path)
    for made in (pickle.loads(pickle.dumps(model)), copy.copy(model), copy.deepcopy(model)):
        assert made == model
        assert (hash(made), made.digest) == (hash(model), model.digest)
        assert Path(made.folder).resolve() == Path(model.folder).resolve()


def _ran(model: wythe.Model) -> tuple[str, int, float]:
    return model.digest, hash(model) == hash(COUPLET), model.run(threads=1).peak_force


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_models_run_in_other_processes(method: str, model: wythe.Model) -> None:
    peak = model.run().peak_force
    with ProcessPoolExecutor(2, mp_context=get_context(method)) as pool:
        told = list(pool.map(_ran, [model, model]))
    assert told == [(model.digest, False, peak)] * 2


def test_what_is_found_and_drawn_can_be_pickled(model: wythe.Model, couplet: wythe.Results) -> None:
    for thing in (model.check(), model.picture(), wythe.Problem("a", "b", 1, 2, "c")):
        assert pickle.loads(pickle.dumps(thing)) == thing
    history = pickle.loads(pickle.dumps(couplet.history))
    assert history.probes == couplet.history.probes
    for name, column in couplet.history.items():
        assert (history[name] == column).all()


def test_errors_can_be_pickled(couplet: wythe.Results) -> None:
    inner = wythe.ModelError("two", key="b")
    model = wythe.ModelError("one", key="a", fix="mend", file="f", line=1, column=2, others=[inner])
    made = pickle.loads(pickle.dumps(model))
    assert str(made) == str(model)
    assert (made.message, made.key, made.fix) == ("one", "a", "mend")
    assert (made.file, made.line, made.column) == ("f", 1, 2)
    assert [other.message for other in made.others] == ["two"]
    with pytest.raises(wythe.OutputError) as raised:
        wythe.Results("/nowhere")
    output = pickle.loads(pickle.dumps(raised.value))
    assert (str(output), output.fix) == (str(raised.value), raised.value.fix)
    for kind in (wythe.ConvergenceError, wythe.RunInterrupted):
        stopped = pickle.loads(pickle.dumps(kind("why", couplet)))
        assert str(stopped) == stopped.message == "why"
        assert stopped.results.peak_force == couplet.peak_force


def test_a_model_shows_itself() -> None:
    shown = repr(wythe.templates.shear_wall("2.12 MPa", "4 mm"))
    for said in (
        "'shear wall'",
        "10 courses",
        "stretcher",
        "damaged plasticity",
        "2.12 MPa",
        "4 mm in x",
    ):
        assert said in shown
    assert "dry, mu = " in repr(wythe.templates.arch())
    assert "voussoirs" in repr(wythe.templates.arch())
    assert "blocks" in repr(wythe.templates.column())


def test_a_model_shows_its_laws() -> None:
    stone = {"kind": "drucker-prager", "E": 8000, "nu": 0.2, "c": 3, "phi": "40 deg", "f_t": 1}
    deck = {**COUPLET.to_dict()}
    deck["materials"] = {**deck["materials"], "mortar": {**stone, "density": "1900 kg/m^3"}}
    shown = repr(wythe.Model.from_dict(deck))
    assert "elastic, E = 16700 MPa" in shown
    assert "drucker-prager, E = 8000 MPa, nu = 0.2" in shown
    assert shown.count("elastic") == 1
    assert "f_t = 0.28 MPa, c = 0.87 MPa, mu = 0.73" in shown
    cap = {"kind": "cap", "f_t": 0.25, "G_I": 0.018, "c": 0.35, "G_II": 0.125, "tan_phi": 0.75}
    cap |= {"mu": 0.6, "f_m": 10.5, "G_fc": 5, "kappa_p": 0.09}
    shown = repr(wythe.Model.from_dict({**COUPLET.to_dict(), "interfaces": {"joint": cap}}))
    assert "cap, f_t = 0.25 MPa, c = 0.35 MPa, mu = 0.6" in shown


def test_the_summary_of_a_joint_needs_no_key_that_only_some_laws_have() -> None:
    assert summary_of_interface({"kind": "rough", "angle": 30.0}) == "rough"
    assert summary_of_interface({"kind": "rough", "mu": 0.5}) == "rough, mu = 0.5"


@pytest.mark.parametrize("name", wythe.templates.names())
def test_a_model_shows_itself_in_notebooks(name: str) -> None:
    model = wythe.Model.from_toml(wythe.templates.text(name), {"title": "a < b"})
    shown = model._repr_html_()
    assert "a &lt; b" in shown
    assert "<svg" in shown


def test_a_model_that_cannot_be_shows_why() -> None:
    shown = COUPLET.with_({"output.experiment": "<none>.csv"})._repr_html_()
    assert "<pre>output.experiment: " in shown
    assert "&lt;none&gt;.csv: No such file" in shown
