"""Studies that stop, are killed, and go on."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from study_fakes import FakeModel, made, taken_name, twice
import wythe
from wythe import Study, StudyError, StudyInterrupted, study

HERE = Path(__file__).parent
GRID = {"a": [1.0, 2.0, 3.0], "b": [0.0, 1.0]}


@pytest.fixture
def pool() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(2) as executor:
        yield executor


def whole(pool: ThreadPoolExecutor, **keys: Any) -> list[dict[str, Any]]:
    return list(study(FakeModel(), GRID, executor=pool, progress=False, **keys))


def test_a_study_that_was_stopped_goes_on(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    notes = tmp_path / "notes"
    notes.mkdir()
    model = FakeModel(notes=str(notes))
    seen: list[dict[str, Any]] = []

    def stop(row: dict[str, Any]) -> Any:
        seen.append(row)
        return np.bool_(len(seen) < 2)

    out = tmp_path / "out"
    part = study(model, GRID, executor=pool, out=out, progress=False, callback=stop)
    assert len(part) == 2 and len(part.missing) == 4 and part.total == 6
    assert sorted(seen, key=lambda row: row["sample"]) == list(part)
    again = study(model, GRID, executor=pool, out=out, progress=False)
    assert list(again) == whole(pool) and again.missing == ()
    # What was done is not done again; what was under way when it stopped may have begun twice.
    begun = len(list(notes.iterdir()))
    assert 6 <= begun <= 6 + 4
    assert list(study(model, GRID, executor=pool, out=out, progress=False)) == list(again)
    assert len(list(notes.iterdir())) == begun


def test_a_folder_tells_its_study(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    table = study(FakeModel(), GRID, executor=pool, out=tmp_path / "out", progress=False)
    loaded = Study.load(tmp_path / "out")
    assert list(loaded) == list(table) and loaded.folder == tmp_path / "out"
    assert (tmp_path / "out" / "study.csv").read_text().count("\n") == 7
    with pytest.raises(StudyError, match="no journal.jsonl"):
        Study.load(tmp_path)


def test_a_journal_cut_anywhere_in_its_last_line_goes_on(
    pool: ThreadPoolExecutor, tmp_path: Path
) -> None:
    expected = whole(pool, out=tmp_path)
    journal = tmp_path / "journal.jsonl"
    content = journal.read_bytes()
    begin = content.rfind(b"\n", 0, -1) + 1
    # Every one of the 300 takes long; a cut in a number, a name, a bracket is one of each seventh.
    for cut in [*range(begin, len(content), 7), *range(len(content) - 3, len(content))]:
        journal.write_bytes(content[:cut])
        assert len(Study.load(tmp_path)) == 5
        assert whole(pool, out=tmp_path) == expected
        assert journal.read_bytes().count(b"\n") == 7


def test_a_journal_cut_in_its_header_begins_anew(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    expected = whole(pool, out=tmp_path)
    journal = tmp_path / "journal.jsonl"
    header = journal.read_bytes().splitlines(keepends=True)[0]
    for cut in (0, 1, len(header) // 2, len(header) - 1):
        journal.write_bytes(header[:cut])
        assert whole(pool, out=tmp_path) == expected


def test_another_study_in_the_folder_is_refused(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    whole(pool, out=tmp_path)
    before = (tmp_path / "journal.jsonl").read_bytes()

    def again(model: Any, grid: Any, **keys: Any) -> None:
        study(model, grid, executor=pool, out=tmp_path, progress=False, **keys)

    with pytest.raises(StudyError, match="out: .* holds a study of another model"):
        again(FakeModel(b=3.0), GRID)
    with pytest.raises(StudyError, match="holds a study of 6 samples instead of 2"):
        again(FakeModel(), {"a": [1.0, 2.0]})
    with pytest.raises(StudyError, match="holds a study of other samples"):
        again(FakeModel(), {**GRID, "b": [0.0, 1.5]})
    with pytest.raises(StudyError, match=r"holds a study of another measure \(none\)"):
        again(FakeModel(), GRID, measure=twice)
    assert (tmp_path / "journal.jsonl").read_bytes() == before


def test_functions_are_known_again(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    samples = {"ten": [1.0, 2.0]}
    for _ in range(2):
        table = study(made, samples=samples, executor=pool, out=tmp_path, measure=twice, progress=False)
        assert list(table["twice"]) == [60.0, 120.0]
    with pytest.raises(StudyError, match="another measure .twice."):
        study(made, samples=samples, executor=pool, out=tmp_path, measure=taken_name, progress=False)
    with pytest.raises(StudyError, match="another model"):
        study(
            lambda sample: made(sample),
            samples=samples, executor=pool, out=tmp_path, measure=twice, progress=False,
        )  # fmt: skip


def test_what_is_no_journal_is_not_touched(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(wythe.OutputError, match="cannot be written"):
        whole(pool, out=tmp_path / "file" / "below")
    with pytest.raises(StudyError, match="is a file"):
        whole(pool, out=tmp_path / "file")
    journal = tmp_path / "out" / "journal.jsonl"
    journal.parent.mkdir()
    for content in ("my diary", "my\ndiary\n", '{"wythe_study": 9}\n'):
        journal.write_text(content)
        with pytest.raises(StudyError, match=r"is not the journal|expected format 1, got 9"):
            whole(pool, out=journal.parent)
        assert journal.read_text() == content
    journal.unlink()
    (journal.parent / "sample-0001").mkdir()
    with pytest.raises(StudyError, match="has runs .* but no journal"):
        whole(pool, out=journal.parent)


def test_a_damaged_line_is_named(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    whole(pool, out=tmp_path)
    journal = tmp_path / "journal.jsonl"
    lines = journal.read_text().splitlines()
    lines[3] = lines[3][:-9]
    journal.write_text("\n".join(lines) + "\n")
    with pytest.raises(StudyError, match="line 4 is damaged"):
        whole(pool, out=tmp_path)


def test_samples_that_were_lost_have_another_go(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    expected = whole(pool, out=tmp_path)
    journal = tmp_path / "journal.jsonl"
    header, *lines = journal.read_text().splitlines()
    for status in ("lost", "interrupted", "failed"):
        changed = {**json.loads(lines[-1]), "status": status, "measures": {}}
        journal.write_text("\n".join([header, *lines[:-1], json.dumps(changed)]) + "\n")
        rows = whole(pool, out=tmp_path)
        if status == "failed":
            assert sorted(row["status"] for row in rows) == ["completed"] * 5 + ["failed"]
        else:
            assert rows == expected


SCRIPT = """
import sys
from concurrent.futures import ThreadPoolExecutor
from study_fakes import FakeModel
from wythe import study
if __name__ == "__main__":
    with ThreadPoolExecutor(2) as pool:
        print("begun", flush=True)
        study(FakeModel(sleep=float(sys.argv[2])), {"a": list(range(40))}, executor=pool, out=sys.argv[1])
"""


def begun(script: Path, out: Path, sleep: float) -> subprocess.Popen[bytes]:
    """Another process with the study, once its journal has some lines."""
    script.write_text(SCRIPT)
    path = os.pathsep.join([str(HERE), *filter(None, sys.path)])
    process = subprocess.Popen(
        [sys.executable, script, out, str(sleep)],
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    journal = out / "journal.jsonl"
    while not journal.exists() or journal.read_bytes().count(b"\n") < 6:
        assert process.poll() is None
        time.sleep(0.01)
    return process


def test_a_killed_study_goes_on_to_the_same_table(
    pool: ThreadPoolExecutor, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    process = begun(tmp_path / "script.py", out, 0.02)
    with pytest.raises(StudyError, match=f"a study is at work in .*process {process.pid} on"):
        study(FakeModel(sleep=0.02), {"a": range(40)}, executor=pool, out=out, progress=False)
    process.kill()
    process.communicate()
    done = len(Study.load(out))
    assert 5 <= done < 40
    fresh: list[int] = []
    table = study(
        FakeModel(sleep=0.02), {"a": range(40)}, executor=pool, out=out, progress=False,
        callback=lambda row: fresh.append(row["sample"]),
    )  # fmt: skip
    assert len(fresh) == 40 - done
    assert list(table["peak_force_kN"]) == [3.0 * a for a in range(40)]


def test_ctrl_c_keeps_what_is_done_and_says_how_to_go_on(tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = begun(tmp_path / "script.py", out, 0.05)
    process.send_signal(signal.SIGINT)
    error = process.communicate(timeout=20)[1].decode()
    assert process.returncode != 0
    assert f"samples are done and kept in {out}: the same call goes on from there" in error
    assert "StudyInterrupted" in error
    assert 5 <= len(Study.load(out)) < 40


def test_an_interrupted_study_has_what_is_done(pool: ThreadPoolExecutor) -> None:
    def interrupt(row: dict[str, Any]) -> None:
        if row["sample"] == 3:
            raise KeyboardInterrupt

    with pytest.raises(StudyInterrupted, match=r"of 6 samples are done: .* \.study") as caught:
        study(FakeModel(), GRID, executor=pool, progress=False, callback=interrupt)
    assert 3 in caught.value.study["sample"]


def test_one_study_at_a_time_in_this_process(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    def nested(row: dict[str, Any]) -> None:
        with pytest.raises(StudyError, match="this process"):
            study(FakeModel(), GRID, executor=pool, progress=False, out=tmp_path)

    study(FakeModel(), GRID, executor=pool, progress=False, out=tmp_path, callback=nested)


def test_runs_are_kept_under_the_numbers_of_their_samples(
    pool: ThreadPoolExecutor, tmp_path: Path
) -> None:
    (tmp_path / "leftover").mkdir()
    table = study(
        FakeModel(), {"a": [1.0, 2.0], "fail": [False, True]},
        executor=pool, progress=False, out=tmp_path, keep="results", measure=taken_name,
    )  # fmt: skip
    # The measure is wrong, but the runs are there.
    assert [row["status"] for row in table] == ["failed"] * 4
    assert table[0]["message"] == "measure: ValueError: status is a column already, choose another name"
    assert table[0]["peak_force_kN"] == 3.0
    assert sorted(path.name for path in tmp_path.glob("sample-*")) == ["sample-0001", "sample-0003"]
    assert (table.run_folder(3) / "summary.json").is_file()
    with pytest.raises(StudyError, match="the run of sample 2 was not kept"):
        table.run_folder(2)


def test_what_surrounds_a_measure_belongs_to_its_study(pool: ThreadPoolExecutor, tmp_path: Path) -> None:
    def scaled(by: float) -> Any:
        def measure(results: Any) -> dict[str, float]:
            return {"scaled": by * results.summary["peak_force_kN"]}

        return measure

    def done(by: float) -> Study:
        out = tmp_path / "out"
        return study(FakeModel(), GRID, executor=pool, out=out, progress=False, measure=scaled(by))

    first = list(done(2.0))
    assert list(done(2.0)) == first
    with pytest.raises(StudyError, match="measure"):
        done(3.0)


def test_files_of_a_deck_belong_to_its_study(tmp_path: Path) -> None:
    deck, table = tmp_path / "deck.toml", tmp_path / "way.csv"
    table.write_text("0,0\n1,1\n")
    deck.write_text(wythe.templates.couplet("0.02 mm").with_({"steps.1.amplitude": [[0, 0], [1, 1]]}).to_toml())
    model = wythe.Model.from_toml(deck).with_({"steps.1.amplitude": "way.csv"})
    keys = {"interfaces.joint.f_t": ["2.5 MPa", "3 MPa"]}
    first = study(model, keys, out=tmp_path / "out", progress=False, executor=1)
    again = study(model, keys, out=tmp_path / "out", progress=False, executor=1)
    assert list(again) == list(first)
    table.write_text("0,0\n1,0.5\n")
    with pytest.raises(StudyError, match="another model"):
        study(model, keys, out=tmp_path / "out", progress=False, executor=1)
