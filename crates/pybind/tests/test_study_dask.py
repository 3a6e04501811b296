"""Studies on a real Dask cluster of this machine, whose workers are killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from study_fakes import FakeModel, made, twice
from wythe import Study, StudyError, study
from wythe._study._dask import local_cluster
from wythe._study._worker import Job

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")
HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """As a user may have one, of two threads a worker. Dask itself tries twice, to save time."""
    with dask.config.set({"distributed.scheduler.allowed-failures": 1}):
        made_one = distributed.LocalCluster(
            n_workers=2, threads_per_worker=2, dashboard_address=":0", silence_logs=50
        )
    with made_one:
        yield made_one


@pytest.fixture(scope="module")
def client(cluster: Any) -> Iterator[Any]:
    with distributed.Client(cluster) as one:
        yield one


def test_a_study_starts_a_cluster_of_its_own_and_survives_killers(tmp_path: Path) -> None:
    samples = {"a": [float(n) for n in range(12)], "kill": [0, 0, 1, 0, -1, 0, 0, 0, 0, 0, 0, 0]}
    table = study(
        FakeModel(notes=str(tmp_path)), samples=samples, executor=3, progress=False, measure=twice,
        retries=1,
    )  # fmt: skip
    assert len(table) == 12
    assert {row["sample"]: row["status"] for row in table if row["status"] != "completed"} == {
        5: "lost"
    }
    assert {row["sample"]: row["attempts"] for row in table if row["attempts"] > 1} == {
        3: 2, 5: 2,
    }  # fmt: skip
    assert "died in attempt 2" in table[4]["message"]
    done = [n for n in range(12) if n != 4]
    assert [table[n]["twice"] for n in done] == [6.0 * n for n in done]


def test_a_worker_killed_from_outside_in_mid_study(client: Any, tmp_path: Path) -> None:
    killed: list[int] = []

    def kill(row: dict[str, Any]) -> None:
        if len(killed) < 2 and len(Study.load(tmp_path / "out")) in (3, 9):
            pids = client.run(os.getpid)
            killed.append(next(iter(pids.values())))
            os.kill(killed[-1], signal.SIGKILL)

    table = study(
        FakeModel(sleep=0.1), {"a": range(24)}, executor=client, progress=False,
        callback=kill, out=tmp_path / "out",
    )  # fmt: skip
    assert len(killed) == 2
    assert list(table["status"]) == ["completed"] * 24
    assert list(table["peak_force_kN"]) == [3.0 * a for a in range(24)]
    # Both threads of a killed worker may have been at work.
    assert 24 <= sum(table["attempts"]) <= 24 + 4


def test_a_cluster_of_its_own_that_lost_a_worker_for_good_has_another() -> None:
    # What becomes of one that is killed while it starts.
    job = Job(FakeModel(), measure=None, keep=None, scratch=None, asker="")
    place = local_cluster(1, job)
    own = place._own[-1]
    before = time.monotonic()
    with dask.config.set({"distributed.deploy.lost-worker-timeout": "10 ms"}):
        own.sync(own.workers[0].close)
        while place._client.nthreads() or own.workers:
            assert time.monotonic() < before + 20.0
            time.sleep(0.02)
    place.submit(1, {"a": 2.0})
    events: list[Any] = []
    while not events:
        assert time.monotonic() < before + 40.0
        place.room()
        events = place.wait(0.1)
    assert events[0].outcome["measures"]["peak_force_kN"] == 6.0
    place.close(finished=True)
    assert own.status.name == "closed"


def test_a_killer_beside_others_in_a_worker_takes_none_with_it(
    client: Any, tmp_path: Path
) -> None:
    samples = {
        "a": [float(n) for n in range(8)],
        "sleep": [0.2] * 8,
        "kill": [0, -1, 0, 0, 0, 0, 0, 0],
    }
    model = FakeModel(notes=str(tmp_path))
    table = study(model, samples=samples, executor=client, progress=False)
    assert [row["sample"] for row in table if row["status"] != "completed"] == [2]
    assert table[1]["status"] == "lost"
    # Dask tries twice before it tells; then the sample is tried alone, to be sure that it was it.
    assert 3 <= table[1]["attempts"] <= 4


def test_a_cluster_is_taken_like_its_client(cluster: Any, client: Any) -> None:
    expected = [20.0 * 3.0, 40.0 * 3.0]
    for executor in (cluster, client, client.get_executor()):
        table = study(
            made, samples={"ten": [1.0, 2.0]}, executor=executor, measure=twice, progress=False
        )
        assert list(table["twice"]) == expected
    assert client.run(os.getpid) and distributed.get_client() is client


def test_outcomes_that_are_not_heard_are_fetched(
    client: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wythe._study._dask.Dask._heard", lambda self, event: None)
    table = study(FakeModel(), {"a": [1.0, 2.0, 3.0]}, executor=client, progress=False)
    assert list(table["peak_force_kN"]) == [3.0, 6.0, 9.0] and list(table["attempts"]) == [1] * 3


def test_lambdas_pass(client: Any) -> None:
    table = study(
        lambda sample: made(sample), samples={"ten": [1.0]}, executor=client, progress=False
    )
    assert list(table["peak_force_kN"]) == [30.0]


def test_a_cluster_that_goes_away_is_said(tmp_path: Path) -> None:
    cluster = distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, dashboard_address=":0", silence_logs=60, processes=False
    )
    client = distributed.Client(cluster)

    def leave(row: dict[str, Any]) -> None:
        client.close()
        cluster.close()

    with pytest.raises(StudyError, match=r"executor: .*of 40 samples are done and kept"):
        study(
            FakeModel(sleep=0.02), {"a": range(40)}, executor=client, progress=False,
            out=tmp_path, callback=leave,
        )  # fmt: skip
    assert len(Study.load(tmp_path)) >= 1


def test_asynchronous_clients_are_refused() -> None:
    async def make() -> None:
        async with distributed.Client(processes=False, asynchronous=True, dashboard_address=":0") as one:
            with pytest.raises(TypeError, match="executor: expected a Dask client that is not async"):
                study(FakeModel(), {"a": [1]}, executor=one, progress=False)

    import asyncio

    asyncio.run(make())


SCRIPT = """
import sys
from study_fakes import FakeModel
from wythe import study
{guard}
study(FakeModel(sleep=0.2), {{"a": list(range(400))}}, executor=2, out=sys.argv[1], progress=False)
"""


def begun(script: Path, out: Path, guard: str) -> subprocess.Popen[bytes]:
    text = SCRIPT.format(guard="if __name__ == '__main__':" if guard else "")
    script.write_text(text.replace("\nstudy(", "\n  study(") if guard else text)
    path = os.pathsep.join([str(HERE), *filter(None, sys.path)])
    return subprocess.Popen(
        [sys.executable, script, out],
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def test_ctrl_c_at_the_terminal_ends_the_cluster_too(tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = begun(tmp_path / "script.py", out, guard="main")
    journal = out / "journal.jsonl"
    while not journal.exists() or journal.read_bytes().count(b"\n") < 4:
        assert process.poll() is None
        time.sleep(0.02)
    # A terminal sends it to the workers as well.
    os.killpg(process.pid, signal.SIGINT)
    error = process.communicate(timeout=30)[1].decode()
    assert "StudyInterrupted: study interrupted" in error and "the same call goes on" in error
    assert len(Study.load(out)) >= 3
    with pytest.raises(ProcessLookupError):
        for _ in range(100):
            os.killpg(process.pid, 0)
            time.sleep(0.05)


def test_an_unguarded_script_is_told_what_it_lacks(tmp_path: Path) -> None:
    process = begun(tmp_path / "script.py", tmp_path / "out", guard="")
    error = process.communicate(timeout=60)[1].decode()
    assert process.returncode != 0
    assert 'must do so under `if __name__ == "__main__":`' in error
