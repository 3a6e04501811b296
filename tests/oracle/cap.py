"""The joint with a compression cap: functions of the state, rate equations, a point along a path.

Source: docs/theory/joint-cap.md, of which equations have their numbers here. Opening u and slip delta in mm, normal
traction sigma (tension positive) and shear traction tau in MPa. The surfaces on which the point lies are active; their
multipliers follow from

    df_i/dt = 0 of active surfaces, with lam_i >= 0        df_j/dt <= 0 of the other ones

The curve (9) of the cap has an infinite slope at kappa = 0. Up to its peak an angle theta takes the place of kappa,

    kappa = kappa_p (1 - cos theta)        f_bar = sigma_i + (f_m - sigma_i) sin theta

in which curve and flow are smooth. It goes on as theta = pi/2 + (kappa - kappa_p)/kappa_p. The rates are smooth between
changes of the active surfaces and kinks; DOP853 of SciPy integrates one such piece after the other.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.integrate import fixed_quad, solve_ivp

from pieces import PIECES, leaves
from tables import Floats

#: Tolerances of the integrator, relative and absolute in MPa, mm, N/mm (README.md, "Accuracy").
RTOL, ATOL = 1e-12, 1e-15
#: A state with f above -ON_SURFACE [MPa] lies on a surface: more than ten times the drift of f.
ON_SURFACE = 1e-9
#: A rate of f or a multiplier below this share of the elastic rate of the tractions is zero.
ROUNDING = 1e-9
#: A traction that is zero but for its sign [MPa].
SMALLEST = 1e-300
#: -ln(1 - D) of D = 1: its exponential is 0.
BROKEN = 1e3


@dataclass(frozen=True)
class CapJoint:
    """Parameters of a joint with the names of the deck: MPa, mm, N/mm, N/mm^3, delta in 1/mm."""

    f_t: float
    c: float
    tan_phi: float
    mu: float
    G_I: float
    G_II: float
    f_m: float
    kappa_p: float
    G_fc: float
    normal_stiffness: float
    shear_stiffness: float
    C_nn: float = 1.0
    C_ss: float = 9.0
    tan_psi: float = 0.0
    sigma_u: float = math.inf
    delta: float = 0.0
    closes: bool = True

    @property
    def dry(self) -> bool:
        """Whether there is no bond; then D = 1."""
        return self.f_t == 0.0 and self.c == 0.0

    @cached_property
    def strengths(self) -> tuple[float, float, float]:
        """sigma_i, sigma_m, sigma_r [MPa]."""
        return self.f_m / 3.0, self.f_m / 2.0, self.f_m / 7.0

    @cached_property
    def kappa_m(self) -> float:
        """kappa_m (12) [mm] from the integrals of (9) to (11), in which kappa_m - kappa_p is a factor."""
        initial, middle, rest = self.strengths
        rising = self.kappa_p * (initial - rest + 0.25 * math.pi * (self.f_m - initial))
        falling = self.f_m - rest - (self.f_m - middle) / 3.0
        tail = (middle - rest) ** 2 / (2.0 * (self.f_m - middle))
        return self.kappa_p + (self.G_fc - rising) / (falling + tail)

    def kappa(self, theta: float) -> float:
        """kappa [mm]."""
        if theta <= 0.5 * math.pi:
            return self.kappa_p * (1.0 - math.cos(theta))
        return self.kappa_p * (1.0 + theta - 0.5 * math.pi)

    @cached_property
    def kinks(self) -> tuple[float, float, float]:
        """theta at the ends of (9) and (10); infinity, the end of (11)."""
        return 0.5 * math.pi, 0.5 * math.pi + self.kappa_m / self.kappa_p - 1.0, math.inf

    def curve(self, theta: float, piece: int) -> tuple[float, float, float]:
        """f_bar, its derivative and that of kappa with respect to theta; a piece's formulas hold beyond its ends."""
        initial, middle, rest = self.strengths
        if piece == 0:
            height = self.f_m - initial
            return initial + height * math.sin(theta), height * math.cos(theta), self.kappa_p * math.sin(theta)
        kappa = self.kappa_p * (1.0 + theta - 0.5 * math.pi)
        width = self.kappa_m - self.kappa_p
        if piece == 1:
            x = (kappa - self.kappa_p) / width
            f, slope = self.f_m + (middle - self.f_m) * x * x, 2.0 * (middle - self.f_m) * x / width
        else:
            m = 2.0 * (middle - self.f_m) / width
            left = math.exp(m * (kappa - self.kappa_m) / (middle - rest))
            f, slope = rest + (middle - rest) * left, m * left
        return f, slope * self.kappa_p, self.kappa_p


@dataclass
class Curves:
    """Results, one entry per row of the path."""

    #: sigma, tau1, tau2 [MPa]. Shape (rows, 3).
    tractions: Floats
    #: D, s_p, kappa, u_p, delta_p1, delta_p2. Shape (rows, 6).
    state: Floats
    #: Work of the tractions [N/mm]. Shape (rows,).
    work: Floats
    #: Largest |f| of an active surface at the end of a piece [MPa].
    drift: float = 0.0
    #: Sets of active surfaces that occurred.
    branches: set[tuple[int, ...]] = field(default_factory=set)


@dataclass(frozen=True)
class Branch:
    """A smooth piece of the rates."""

    #: Active surfaces, 0: tension, 1: friction, 2: cap, 3: closing.
    active: tuple[int, ...]
    #: sigma < 0.
    pressed: bool
    #: -sigma < sigma_u.
    dilates: bool
    #: Piece of the curve of the cap.
    piece: int


#: Places in the state: sigma, tau1, tau2, -ln(1 - D), s_p, theta, work, gap w; their number.
TAU, LOSS, SLIP, THETA, WORK, GAP = slice(1, 3), 3, 4, 5, 6, 7
STATES = 8
#: -f_4 of a joint that has no gap to close [MPa].
NO_GAP = 1.0


@dataclass(frozen=True)
class Law:
    """The rates of a joint."""

    joint: CapJoint

    def surfaces(self, y: Floats) -> Floats:
        """f_1, f_2, f_3 (2 to 4) and f_4 (13) [MPa]."""
        j, sigma, shear = self.joint, float(y[0]), math.hypot(*y[TAU])
        left = math.exp(-y[LOSS])
        friction = j.mu + (j.tan_phi - j.mu) * left
        piece = next(i for i, kink in enumerate(j.kinks) if y[THETA] <= kink)
        cap = math.sqrt(j.C_nn * min(sigma, 0.0) ** 2 + j.C_ss * shear**2) - j.curve(y[THETA], piece)[0]
        closing = -sigma if y[GAP] > 0.0 else -NO_GAP
        return np.array([sigma - left * j.f_t, shear + friction * sigma - left * j.c, cap, closing])

    def linear(self, y: Floats, branch: Branch, gap: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Rates of the state and of the surfaces as affine functions of the multipliers.

        The multipliers are those of tension and friction, the rate of theta and that of closing. Returns the elastic rates of the state,
        their derivatives by the multipliers (columns), and the same of the surfaces.
        """
        j, sigma, tau = self.joint, float(y[0]), y[TAU]
        shear = math.hypot(*tau)
        n = tau / shear if shear > 0.0 else np.zeros(2)
        left, pressure = math.exp(-y[LOSS]), -sigma if branch.pressed else 0.0
        friction = j.mu + (j.tan_phi - j.mu) * left
        dilatancy = j.tan_psi * math.exp(-j.delta * y[SLIP]) * (1.0 - pressure / j.sigma_u if branch.dilates else 0.0)
        # (8): the multiplier of the cap for a rate of theta.
        _, f_slope, kappa_slope = j.curve(y[THETA], branch.piece)
        length = math.hypot(j.C_nn * pressure, j.C_ss * shear)
        cap = kappa_slope / length if length > 0.0 else 0.0
        plastic_u = np.array([1.0, dilatancy, -j.C_nn * pressure * cap, -1.0])
        plastic_slip = np.outer(n, [0.0, 1.0, j.C_ss * shear * cap, 0.0])
        start, by = np.zeros(STATES), np.zeros((STATES, 4))
        start[0], start[TAU] = j.normal_stiffness * gap[0], j.shear_stiffness * gap[1:]
        by[0], by[TAU] = -j.normal_stiffness * plastic_u, -j.shear_stiffness * plastic_slip
        by[LOSS] = [j.f_t / j.G_I, j.c / j.G_II, 0.0, 0.0]
        by[GAP] = [1.0, 0.0, 0.0, -1.0] if j.closes else 0.0
        by[SLIP, 1] = by[THETA, 2] = 1.0
        start[WORK] = sigma * gap[0] + float(tau @ gap[1:])
        # Gradients of the surfaces by the state.
        grad = np.zeros((4, STATES))
        grad[0, [0, LOSS]] = [1.0, left * j.f_t]
        grad[1, 0], grad[1, TAU] = friction, n
        grad[1, LOSS] = left * (j.c - (j.tan_phi - j.mu) * sigma)
        root = math.sqrt(j.C_nn * pressure**2 + j.C_ss * shear**2)
        if root > 0.0:
            grad[2, 0], grad[2, TAU] = -j.C_nn * pressure / root, j.C_ss * tau / root
        grad[2, THETA] = -f_slope
        grad[3, 0] = -1.0
        return start, by, grad @ start, grad @ by

    def multipliers(self, y: Floats, branch: Branch, gap: Floats) -> tuple[Floats, Floats, Floats]:
        """Multipliers of the active surfaces, the others 0; rates of the surfaces; rates of the state."""
        start, by, f_start, f_by = self.linear(y, branch, gap)
        active, out = list(branch.active), np.zeros(4)
        if active:
            out[active] = np.linalg.solve(f_by[np.ix_(active, active)], -f_start[active])
        return out, f_start + f_by @ out, start + by @ out


@dataclass
class _Point:
    """A point during its path."""

    law: Law
    y: Floats = field(default_factory=lambda: np.zeros(STATES))
    drift: float = 0.0
    branches: set[tuple[int, ...]] = field(default_factory=set)

    def branch(self, gap: Floats, neutral: bool) -> Branch:
        """The branch that holds from here on.

        `neutral` says that the last piece was elastic and had no length: a multiplier may then begin at zero.
        """
        j, y, law = self.law.joint, self.y, self.law
        near = [i for i, f in enumerate(law.surfaces(y)) if f > -ON_SURFACE]
        scale = math.hypot(j.normal_stiffness * gap[0], j.shear_stiffness * math.hypot(*gap[1:]))
        pressed = y[0] < 0.0 or (y[0] == 0.0 and gap[0] < 0.0)
        piece = next(i for i, kink in enumerate(j.kinks) if y[THETA] < kink)
        for count in range(1 if neutral else 0, len(near) + 1):
            for active in itertools.combinations(near, count):
                if {0, 3} <= set(active):
                    # A joint does not open and close at a time.
                    continue
                tried = Branch(active, pressed, -y[0] < j.sigma_u, piece)
                multipliers, rates, _ = law.multipliers(y, tried, gap)
                # In units of traction.
                sizes = multipliers * [j.normal_stiffness, j.shear_stiffness, j.f_m, j.normal_stiffness]
                others = [i for i in near if i not in active]
                least = -ROUNDING if neutral else ROUNDING
                if (sizes[list(active)] > least * scale).all() and (rates[others] < ROUNDING * scale).all():
                    return tried
        raise RuntimeError(f"no branch at {y} along {gap}")

    def elastic(self, gap: Floats, start: float) -> float:
        """Integrates until a surface is reached; returns that time, or 1."""
        j, begin = self.law.joint, self.y.copy()
        rate = np.zeros(STATES)
        rate[0], rate[TAU] = j.normal_stiffness * gap[0], j.shear_stiffness * gap[1:]
        end = leaves(lambda t: float(self.law.surfaces(begin + (t - start) * rate).max()), start)

        def power(t: float) -> float:
            now = begin + (t - start) * rate
            return float(now[0] * gap[0] + now[TAU] @ gap[1:])

        self.y = begin + (end - start) * rate
        # Linear in time.
        self.y[WORK] += float(fixed_quad(np.vectorize(power), start, end, n=1)[0])
        return end

    def plastic(self, gap: Floats, start: float, branch: Branch) -> float:
        """Integrates while the branch holds; returns the end time, or 1."""
        law, j = self.law, self.law.joint
        kink = j.kinks[branch.piece]
        closing = 3 in branch.active
        if closing:
            self.y[0] = 0.0

        def right_hand_side(_: float, y: Floats) -> Floats:
            return law.multipliers(y, branch, gap)[2]

        # Each event is positive on the piece and falls through zero at its end.
        events: list[Callable[[float, Floats], float]] = [
            lambda _, y: 1.0 if closing else -y[0] if branch.pressed else y[0],
            lambda _, y: kink - y[THETA] if branch.piece < 2 else 1.0,
            lambda _, y: (j.sigma_u + y[0]) * (1.0 if branch.dilates else -1.0),
            lambda _, y: y[GAP] if closing else 1.0,
        ]
        for i in range(4):
            if i in branch.active:
                events.append(lambda _, y, i=i: law.multipliers(y, branch, gap)[0][i])
            else:
                events.append(lambda _, y, i=i: -law.surfaces(y)[i])
        for event in events:
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        done = solve_ivp(right_hand_side, (start, 1.0), self.y, "DOP853", events=events, rtol=RTOL, atol=ATOL)
        if done.status < 0:
            raise RuntimeError(f"no answer beyond the time {done.t[-1]} of a row: {done.message}")
        self.y = done.y[:, -1]
        # Move to the other side of a kink, independently of rounding.
        if len(done.t_events[0]):
            self.y[0] = SMALLEST if branch.pressed else -SMALLEST
        if len(done.t_events[1]):
            self.y[THETA] = kink
        if len(done.t_events[2]):
            self.y[0] = np.nextafter(-j.sigma_u, -math.inf if branch.dilates else math.inf)
        if closing:
            self.y[0] = 0.0
        self.drift = max(self.drift, float(np.abs(law.surfaces(self.y)[list(branch.active)]).max()))
        if len(done.t_events[3]):
            self.y[GAP] = 0.0
        self.branches.add(branch.active)
        return float(done.t[-1])


def drive(joint: CapJoint, path: Floats) -> Curves:
    """Drives a point from rest along a path of u and two slips [mm], shape (rows, 3), straight between rows."""
    point = _Point(Law(joint))
    point.y[LOSS] = BROKEN if joint.dry else 0.0
    rows = len(path)
    answer = Curves(np.zeros((rows, 3)), np.zeros((rows, 6)), np.zeros(rows))
    last = np.zeros(3)
    for i, to in enumerate(path):
        _go(point, to - last)
        last, y = to, point.y
        plastic = to - y[:3] / [joint.normal_stiffness, joint.shear_stiffness, joint.shear_stiffness]
        answer.tractions[i] = y[:3]
        answer.state[i] = [-math.expm1(-y[LOSS]), y[SLIP], joint.kappa(y[THETA]), *plastic]
        answer.work[i] = y[WORK]
    answer.drift, answer.branches = point.drift, point.branches
    return answer


def _go(point: _Point, gap: Floats) -> None:
    """Integrates to the end of a row, whose time runs from 0 to 1."""
    t, neutral = 0.0, False
    for _ in range(PIECES):
        before = t
        branch = point.branch(gap, neutral)
        t = point.plastic(gap, t, branch) if branch.active else point.elastic(gap, t)
        neutral = not branch.active and t == before
        if t >= 1.0:
            return
    raise RuntimeError(f"more than {PIECES} pieces")
