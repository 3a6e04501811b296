"""The loop of a study: it sends waiting samples, records finished ones, and repeats those whose worker died.

A sample is given up as lost only if it certainly ran alone when its worker died. If that is unknown (several threads
in one worker), its last attempt is made at the end, while no other sample runs. So a sample that kills its workers
does not affect others.
"""

from __future__ import annotations

from collections import deque
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
class Course:
    """Remaining samples of a study and the state of their attempts."""

    samples: list[Sample]
    left: deque[int]
    """Numbers (from 1) of waiting samples."""
    retries: int
    last: deque[int] = field(default_factory=deque)
    """Samples whose last attempt is made alone, at the end."""
    under_way: set[int] = field(default_factory=set)
    alone: int | None = None
    attempts: dict[int, int] = field(default_factory=dict)
    waited: dict[int, int] = field(default_factory=dict)


def drive(
    place: Place,
    samples: list[Sample],
    left: Iterable[int],
    retries: int,
    record: Callable[[int, int, Outcome], bool],
    show: Callable[[], None],
) -> None:
    """Runs the samples ``left``. ``record(number, attempts, outcome)`` returns whether to continue."""
    course = Course(samples, deque(left), retries)
    while course.left or course.last or course.under_way:
        _send(place, course)
        for event in place.wait(TICK):
            outcome = _judge(course, event)
            if outcome is not None and not record(
                event.number, course.attempts[event.number], outcome
            ):
                return
        show()


def _send(place: Place, course: Course) -> None:
    room = place.room()
    while course.left and course.alone is None and len(course.under_way) < room:
        _submit(place, course, course.left.popleft())
    if course.last and not course.under_way:
        course.alone = course.last.popleft()
        _submit(place, course, course.alone)


def _submit(place: Place, course: Course, number: int) -> None:
    course.under_way.add(number)
    place.submit(number, course.samples[number - 1])


def _judge(course: Course, event: Finished | Died) -> Outcome | None:
    """Processes an event: returns the outcome of the sample, or None if it is tried again."""
    number = event.number
    course.under_way.discard(number)
    alone, course.alone = course.alone == number, None
    before = course.attempts.get(number, 0)
    if isinstance(event, Finished):
        course.attempts[number] = before + event.starts
        if event.outcome["again"] and course.attempts[number] <= course.retries:
            course.left.append(number)
            return None
        return event.outcome
    starts = max(1, event.starts) if alone else event.starts
    course.attempts[number] = before + starts
    if starts == 0:
        course.waited[number] = course.waited.get(number, 0) + 1
    certain = event.certain or alone
    if course.attempts[number] > course.retries and certain:
        return Outcome(
            status="lost",
            message=f"{event.why} in attempt {course.attempts[number]}",
            measures={},
            again=True,
        )
    if course.attempts[number] >= course.retries and not certain and starts > 0:
        course.last.append(number)
    elif course.waited.get(number, 0) >= BYSTANDER:
        course.last.append(number)
    else:
        course.left.append(number)
    return None
