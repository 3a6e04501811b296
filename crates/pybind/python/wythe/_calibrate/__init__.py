"""Calibrations: parameters of decks from measured curves."""

from wythe._calibrate._api import calibrate
from wythe._calibrate._errors import CalibrationError
from wythe._calibrate._posterior import Posterior
from wythe._calibrate._result import Calibration, CurveFit
from wythe._calibrate._runs import FailedRun

__all__ = [
    "Calibration",
    "CalibrationError",
    "CurveFit",
    "FailedRun",
    "Posterior",
    "calibrate",
]
