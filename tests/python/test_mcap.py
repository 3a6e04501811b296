"""run.mcap as the reader of MCAP's own Python package sees it."""

import csv
import io
import json
import os
import shutil
import signal
import subprocess
import time
from collections import defaultdict
from pathlib import Path

import pytest
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, make_reader

from conftest import HINT, ROOT, TARGET

TICK = 100_000_000
TOPICS = {"/step", "/iteration", "/procedures", "/log", "/scene", "/interfaces"}
COMMAND = TARGET / "release" / "wythe"


def read(path: Path) -> dict[str, list[tuple[int, dict]]]:
    """Log times and messages by topic, by way of the index."""
    topics = defaultdict(list)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_summary() is not None
        for schema, channel, message in reader.iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            known = json.loads(schema.data)["properties"]
            value = json.loads(message.data)
            assert set(value) <= set(known)
            topics[channel.topic].append((message.log_time, value))
    return topics


def rows_of(folder: Path) -> list[dict[str, str]]:
    with (folder / "history.csv").open() as file:
        return list(csv.DictReader(file))


def same(message: dict, row: dict[str, str]) -> bool:
    """The same numbers to the last bit, under the same names."""
    return set(message) == set(row) and all(
        value == (text if isinstance(value, str) else type(value)(text))
        for value, text in ((message[name], row[name]) for name in row)
    )


def salvage(*arguments) -> subprocess.CompletedProcess:
    command = [COMMAND, "salvage", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


def test_the_steps_are_the_history(couplet: Path) -> None:
    topics, rows = read(couplet / "run.mcap"), rows_of(couplet)
    steps = topics["/step"]
    assert [log_time for log_time, _ in steps] == [TICK * (i + 1) for i in range(len(rows))]
    assert len(steps) == len(rows)
    assert all(same(message, row) for (_, message), row in zip(steps, rows))
    solves = [message for _, message in topics["/iteration"]]
    assert len(solves) == json.loads((couplet / "summary.json").read_text())["iterations"]
    last = {message["increment"]: message["iterations"] for message in solves}
    assert [last.get(i + 1, 0) for i in range(len(rows))] == [int(row["iterations"]) for row in rows]
    assert topics["/log"][-1][1]["message"] == "completed"


def test_every_topic_is_declared_and_the_deck_attached(couplet: Path) -> None:
    with (couplet / "run.mcap").open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        attached = {a.name: a.data for a in reader.iter_attachments()}
    assert {channel.topic for channel in summary.channels.values()} == TOPICS
    names = {schema.name for schema in summary.schemas.values()}
    assert {"foxglove.SceneUpdate", "foxglove.Log", "wythe.Step"} <= names
    assert attached == {"model.toml": (couplet / "model.toml").read_bytes()}


def test_the_scene_shows_the_deformed_wall(couplet: Path) -> None:
    topics, rows = read(couplet / "run.mcap"), rows_of(couplet)
    heights = []
    for log_time, scene in topics["/scene"]:
        (entity,) = scene["entities"]
        assert entity["timestamp"] == {"sec": log_time // 10**9, "nsec": log_time % 10**9}
        triangles = entity["triangles"]
        assert all(max(t["indices"]) < len(t["points"]) for t in triangles)
        assert all(len(t["indices"]) % 3 == 0 for t in triangles)
        heights.append(max(point["z"] for t in triangles for point in t["points"]))
    # At rest, then pulled upwards to the displacement of the history, within a micrometre [m].
    displacement = [0.0] + [float(row["displacement_mm"]) for row in rows]
    at = [log_time // TICK for log_time, _ in topics["/scene"]]
    assert at[0] == 0 and at[-1] == len(rows)
    for height, increment in zip(heights, at):
        expected = heights[0] + 1e-3 * displacement[increment]
        assert height == pytest.approx(expected, abs=1.1e-6)
    # Interfaces: intact at first, softening or open at the end.
    colours = [
        {tuple(t["color"].values()) for t in scene["entities"][0]["triangles"]}
        for _, scene in topics["/interfaces"]
    ]
    assert len(colours[0]) == 1 and colours[0] != colours[-1]


def test_a_file_that_was_cut_is_salvaged(couplet: Path, tmp_path: Path) -> None:
    whole = (couplet / "run.mcap").read_bytes()
    rows = rows_of(couplet)
    path = tmp_path / "run.mcap"
    for part in (0.2, 0.4, 0.6):
        path.write_bytes(whole[: int(part * len(whole))])
        with pytest.raises(McapError), path.open("rb") as file:
            list(make_reader(file).iter_messages())
        done = salvage(path)
        assert done.returncode == 0, done.stderr
        assert "left out" in done.stdout
        steps = read(path)["/step"]
        assert 0 < len(steps) < len(rows)
        assert all(same(message, row) for (_, message), row in zip(steps, rows))
        assert os.listdir(tmp_path) == ["run.mcap"]
    assert "it was whole" in salvage(path).stdout


def test_files_that_cannot_be_repaired_are_reported(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    missing = salvage(path)
    assert missing.returncode == 4 and "run.mcap" in missing.stderr
    path.write_text("no MCAP")
    other = salvage(path)
    assert other.returncode == 4 and "no MCAP file" in " ".join(other.stderr.replace("│", "").split())
    assert path.read_text() == "no MCAP"


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Example 01 with an experiment, killed on the way."""
    assert COMMAND.is_file(), HINT
    folder = tmp_path_factory.mktemp("killed")
    model = shutil.copy(ROOT / "examples" / "01_couplet_tension.toml", folder / "couplet.toml")
    (folder / "test.csv").write_text("displacement_mm,force_kN\n0,0\n0.01,5\n")
    small = ["--set", "steps.1.increments.max=1e-5", "--set", "steps.1.increments.initial=1e-5"]
    run = subprocess.Popen(
        [COMMAND, "run", model, "--set", "output.experiment=test.csv", *small],
        stderr=subprocess.DEVNULL,
    )
    out, until = folder / "couplet.out", time.monotonic() + 120
    while not (out / "history.csv").is_file() or len(rows_of(out)) < 12:
        assert run.poll() is None and time.monotonic() < until
        time.sleep(0.02)
    run.send_signal(signal.SIGKILL)
    run.wait()
    return out


def test_a_killed_run_is_read_in_its_order_and_salvaged(killed: Path, tmp_path: Path) -> None:
    rows = rows_of(killed)
    seen = 0
    try:
        stream = io.BytesIO((killed / "run.mcap").read_bytes())
        for _, channel, _ in NonSeekingReader(stream).iter_messages(log_time_order=False):
            seen += channel.topic == "/step"
    except McapError:
        pass
    # The row is written before the message.
    assert len(rows) - 1 <= seen <= len(rows)
    out = tmp_path / "whole.mcap"
    done = salvage(killed / "run.mcap", "--out", out)
    assert done.returncode == 0, done.stderr
    steps = read(out)["/step"]
    assert len(rows) - 1 <= len(steps) <= len(rows)
    assert all(same(message, row) for (_, message), row in zip(steps, rows))
    with out.open("rb") as file:
        attached = {a.name: a.data for a in make_reader(file).iter_attachments()}
    assert set(attached) == {"model.toml", "test.csv"}
    assert attached["test.csv"].startswith(b"displacement_mm")
