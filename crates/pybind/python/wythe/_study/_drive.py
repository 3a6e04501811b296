"""The loop of a study: it sends waiting samples, records finished ones, and repeats those whose worker died.

A sample is given up as lost only if it certainly ran alone when its worker died. If that is unknown (several threads
in one worker), its last attempt is made at the end, while no other sample runs. So a sample that kills its workers
does not affect others.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from wythe._study._executors import Died, Finished, Place
from wythe._study._samples import Sample
from wythe._study._worker import Outcome

# After this many deaths of its worker a sample that seemed to wait only is treated as a possible cause.
BYSTANDER = 3
# Longest time between updates of the progress [s].
TICK = 0.5


@dataclass
class _Course:
    """Remaining samples of a study and the state of their attempts."""

    place: Place
    samples: list[Sample]
    left: deque[int]
    """Numbers (from 1) of waiting samples."""
    retries: int
    last: deque[int] = field(default_factory=deque)
    """Samples whose last attempt is made alone, at the end."""
    under_way: set[int] = field(default_factory=set)
    alone: int | None = None
    attempts: Counter[int] = field(default_factory=Counter)
    waited: Counter[int] = field(default_factory=Counter)

    def send(self) -> None:
        """Submits as many samples as there is room for."""
        room = self.place.room()
        while self.left and self.alone is None and len(self.under_way) < room:
            self._submit(self.left.popleft())
        if self.last and not self.under_way:
            self.alone = self.last.popleft()
            self._submit(self.alone)

    def _submit(self, number: int) -> None:
        self.under_way.add(number)
        self.place.submit(number, self.samples[number - 1])

    def judge(self, event: Finished | Died) -> Outcome | None:
        """Processes an event: returns the outcome of the sample, or None if it is tried again."""
        number = event.number
        self.under_way.discard(number)
        alone, self.alone = self.alone == number, None
        if isinstance(event, Finished):
            self.attempts[number] += event.starts
            if event.outcome["again"] and self.attempts[number] <= self.retries:
                self.left.append(number)
                return None
            return event.outcome
        starts = max(1, event.starts) if alone else event.starts
        self.attempts[number] += starts
        self.waited[number] += starts == 0
        certain = event.certain or alone
        attempts = self.attempts[number]
        if attempts > self.retries and certain:
            message = f"{event.why} in attempt {attempts}"
            return Outcome(status="lost", message=message, measures={}, again=True)
        suspect = attempts >= self.retries and not certain and starts > 0
        (self.last if suspect or self.waited[number] >= BYSTANDER else self.left).append(number)
        return None


def drive(
    place: Place,
    samples: list[Sample],
    left: Iterable[int],
    retries: int,
    record: Callable[[int, int, Outcome], bool],
    show: Callable[[], None],
) -> None:
    """Runs the samples ``left``. ``record(number, attempts, outcome)`` returns whether to continue."""
    course = _Course(place, samples, deque(left), retries)
    while course.left or course.last or course.under_way:
        course.send()
        for event in place.wait(TICK):
            outcome = course.judge(event)
            if outcome is not None and not record(event.number, course.attempts[event.number], outcome):
                return
        show()
