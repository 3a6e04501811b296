"""The other files of a run."""

import csv
import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

COLUMNS = (
    "increment,step,time,displacement_mm,force_kN,reaction_kN,iterations,cutbacks,"
    "external_work_J,elastic_energy_J,plastic_damage_dissipation_J,interface_dissipation_J,"
    "viscous_dissipation_J,open_points,sliding_points,max_interface_damage,max_tensile_damage,"
    "max_compressive_damage"
).split(",")
KEYS = (
    "status verdict verdict_kind message peak_force_kN displacement_at_peak_mm displacement_at_80_percent_mm "
    "final_displacement_mm initial_stiffness_kN_per_mm units elements nodes dofs contact_points mirror_planes "
    "increments iterations cutbacks factorisations reused local_solves force_evaluations wall_s cpu_s "
    "seconds_by_phase peak_rss_MB energy_balance_error threads version warnings log dissipated_energy_J answers"
).split()
PHASES = "elements contact assembly factorise solve output".split()


def test_the_history_has_its_columns_and_a_row_an_increment(couplet: Path) -> None:
    with (couplet / "history.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[: len(COLUMNS)] == COLUMNS
    assert [int(row["increment"]) for row in rows] == list(range(1, len(rows) + 1))
    summary = json.loads((couplet / "summary.json").read_text())
    assert len(rows) == summary["increments"]
    assert sum(int(row["iterations"]) for row in rows) <= summary["iterations"]
    peak = max(rows, key=lambda row: float(row["force_kN"]))
    assert float(peak["force_kN"]) == summary["peak_force_kN"]
    assert float(peak["displacement_mm"]) == summary["displacement_at_peak_mm"]
    assert float(rows[-1]["displacement_mm"]) == summary["final_displacement_mm"]


def test_the_summary_has_its_keys(couplet: Path) -> None:
    summary = json.loads((couplet / "summary.json").read_text())
    assert list(summary) == KEYS
    assert list(summary["seconds_by_phase"]) == PHASES
    assert summary["status"] == "completed" and summary["message"] == ""
    assert summary["units"] == 2 and summary["threads"] >= 1
    # A quarter of it is solved.
    assert len(summary["mirror_planes"]) == 2
    # Phases do not overlap; only the time between them is missing.
    assert 0 < sum(summary["seconds_by_phase"].values()) <= summary["wall_s"]


@pytest.mark.parametrize("name", ["load_displacement.svg", "crack_pattern.svg"])
def test_the_pictures_are_well_formed(couplet: Path, known: Path, name: str) -> None:
    for folder in (couplet, known):
        root = ElementTree.parse(folder / name).getroot()
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        texts = {(text.text or "").strip() for text in root.iter("{http://www.w3.org/2000/svg}text")}
        wanted = "force [kN]" if name.startswith("load") else "compressive damage above 0.25"
        assert wanted in texts
