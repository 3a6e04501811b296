"""Studies: many runs of one model, on one machine or a cluster."""

from wythe._study._api import study
from wythe._study._errors import StudyError, StudyInterrupted
from wythe._study._pool import WorkerDied, Workers
from wythe._study._ranking import Rank, Ranking
from wythe._study._sampling import Distribution, latin_hypercube, lognormal, normal
from wythe._study._table import Study

__all__ = [
    "Distribution",
    "Rank",
    "Ranking",
    "Study",
    "StudyError",
    "StudyInterrupted",
    "WorkerDied",
    "Workers",
    "latin_hypercube",
    "lognormal",
    "normal",
    "study",
]
