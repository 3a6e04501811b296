"""The loop, with a place that does as it is told."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from wythe._study._drive import drive
from wythe._study._executors import Died, Finished
from wythe._study._samples import Sample
from wythe._study._worker import Outcome

DONE = Outcome(status="completed", message="", measures={}, again=False)
TROUBLE = Outcome(status="failed", message="disk full", measures={}, again=True)


class Script:
    """A place of four whose samples end as a function says."""

    workers = 4

    def __init__(self, ends: Callable[[int, set[int]], Finished | Died | None]) -> None:
        self.ends = ends
        self.under_way: deque[int] = deque()
        self.most = 0
        self.began: list[int] = []

    def room(self) -> int:
        return 4

    def submit(self, number: int, sample: Sample) -> None:
        assert sample == {"n": number}
        self.under_way.append(number)
        self.began.append(number)
        self.most = max(self.most, len(self.under_way))

    def wait(self, seconds: float) -> list[Finished | Died]:
        beside = set(self.under_way)
        number = self.under_way.popleft()
        event = self.ends(number, beside - {number})
        if event is None:
            self.under_way.append(number)
            return []
        return [event]

    def close(self, finished: bool) -> None:
        pass


def run(place: Script, count: int, retries: int = 2) -> dict[int, tuple[str, int]]:
    rows: dict[int, tuple[str, int]] = {}

    def record(number: int, attempts: int, outcome: Outcome) -> bool:
        assert number not in rows
        rows[number] = (outcome["status"], attempts)
        return True

    samples: list[Sample] = [{"n": n} for n in range(1, count + 1)]
    drive(place, samples, range(1, count + 1), retries, record, lambda: None)
    assert not place.under_way
    return rows


def test_no_more_are_sent_than_there_is_room_for() -> None:
    place = Script(lambda number, beside: Finished(number, DONE))
    assert run(place, 100) == {n: ("completed", 1) for n in range(1, 101)}
    assert place.most == 4


def test_a_killer_is_lost_after_its_retries_and_alone() -> None:
    def ends(number: int, beside: set[int]) -> Finished | Died:
        # Whoever runs beside sample 5 dies with it, and nobody can tell.
        if number == 5 or 5 in beside:
            return Died(number, starts=1, certain=False, why="died")
        return Finished(number, DONE)

    place = Script(ends)
    rows = run(place, 20)
    assert rows.pop(5) == ("lost", 3)
    assert all(status == "completed" for status, _ in rows.values()) and len(rows) == 19
    assert place.began[-1] == 5


def test_a_certain_killer_is_not_kept_for_the_end() -> None:
    place = Script(
        lambda number, _: Died(number, 1, True, "died") if number == 1 else Finished(number, DONE)
    )
    rows = run(place, 8, retries=1)
    assert rows[1] == ("lost", 2) and place.began.count(1) == 2


def test_who_only_waited_where_another_died_has_made_no_attempt() -> None:
    deaths = [0]

    def ends(number: int, beside: set[int]) -> Finished | Died:
        if number == 2 and deaths[0] < 4:
            deaths[0] += 1
            return Died(number, starts=0, certain=False, why="died")
        return Finished(number, DONE)

    place = Script(ends)
    rows = run(place, 6, retries=0)
    # Four deaths are more than a bystander has: from the third on it is alone, and the death is its own.
    assert rows[2] == ("lost", 1)
    deaths[0] = 1
    assert run(Script(ends), 6, retries=0)[2] == ("completed", 1)


def test_restarts_elsewhere_are_attempts() -> None:
    place = Script(lambda number, _: Finished(number, DONE, starts=2))
    assert run(place, 2) == {1: ("completed", 2), 2: ("completed", 2)}


def test_trouble_of_the_machine_is_tried_again() -> None:
    tries: dict[int, int] = {}

    def ends(number: int, beside: set[int]) -> Finished:
        tries[number] = tries.get(number, 0) + 1
        return Finished(number, TROUBLE if number == 3 and tries[3] <= 2 else DONE)

    assert run(Script(ends), 4)[3] == ("completed", 3)
    tries.clear()
    assert run(Script(ends), 4, retries=1)[3] == ("failed", 2)


def test_a_record_that_says_no_stops() -> None:
    place = Script(lambda number, _: Finished(number, DONE))
    seen: list[int] = []

    def record(number: int, attempts: int, outcome: Outcome) -> bool:
        seen.append(number)
        return len(seen) < 3

    drive(place, [{"n": n} for n in range(1, 9)], range(1, 9), 2, record, lambda: None)
    assert seen == [1, 2, 3]
