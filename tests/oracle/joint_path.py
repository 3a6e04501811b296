"""A point of a joint along a path whose rows are joined by straight lines, from rest.

The rates of joint.py are smooth between changes of the branch of sigma, of the variable that drives D, of the growth of
s_max, and the ends of slip. DOP853 of SciPy (explicit Runge-Kutta, order 8, with events), or Radau (implicit) where n
turns fast, integrates one such piece after the other. While the joint sticks everything follows from the gap.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import fixed_quad, solve_ivp

from joint import Branch, Joint, Part, outwards, rates
from pieces import PIECES, leaves
from tables import Floats

#: Tolerances of the integrator, relative and absolute in mm, rad, N/mm (README.md, "Accuracy").
RTOL, ATOL = 1e-12, 1e-16
#: A shear traction this little below its limit slips [MPa].
ON_SURFACE = 1e-9
#: Smallest |tau| for the rotation of n [MPa]: in an open joint n would rotate infinitely fast.
SMALLEST = 1e-9
#: Above this ratio of the slip of a part to |tau|/k_s, the slip over which n turns, the implicit integrator is faster.
STIFF = 1e4
#: Rounding of the damage: two variables that drive it equally end no piece.
SLACK = 1e-14


@dataclass
class Curves:
    """Results, one entry per row of the path."""

    #: sigma, tau1, tau2 [MPa]. Shape (rows, 3).
    tractions: Floats
    #: D, u_max, s_max, delta_p1, delta_p2. Shape (rows, 5).
    state: Floats
    #: Work of the tractions [N/mm]. Shape (rows,).
    work: Floats
    #: Largest difference between k_s |delta - delta_p| and g at the end of a piece that slips [MPa].
    drift: float = 0.0


@dataclass
class _Point:
    """A point during its path."""

    joint: Joint
    u_max: float = 0.0
    s_max: float = 0.0
    plastic: Floats = field(default_factory=lambda: np.zeros(2))
    damage: float = 0.0
    work: float = 0.0
    drift: float = 0.0

    # ---- Functions of the time in a part -----------------------------------------------------------------------

    def opened(self, part: Part, t: float) -> tuple[float, float]:
        """u and u_max."""
        u = part.u + t * part.u_rate
        return u, max(self.u_max, u)

    def damage_by_opening(self, part: Part, t: float) -> float:
        """D while nothing slips."""
        j, D = self.joint, self.damage
        if not part.softening or D >= 1.0:
            return D
        u, _ = self.opened(part, t)
        if j.coupling == "max":
            return max(D, j.Q(u - j.u_0))
        # dD/dw = Q'(Q^-1(D)) is linear in D, so that 1 - (1 - e^-zeta) D decays exponentially.
        whole = -math.expm1(-j.zeta)
        rest = (1.0 - whole * D) * math.exp(-j.zeta * (u - max(self.u_max, j.u_0)) / j.u_k)
        return min((1.0 - rest) / whole, 1.0)

    def tractions(self, part: Part, t: float) -> tuple[float, Floats, float]:
        """sigma, tau and g while nothing slips."""
        D = self.damage_by_opening(part, t)
        sigma = self.joint.normal(*self.opened(part, t), D)
        tau = self.joint.shear_stiffness * (part.slip + t * part.slip_rate - self.plastic)
        return sigma, tau, self.joint.limit(sigma, D)

    # ---- Branches of the rates ------------------------------------------------------------------------------

    def direction(self, part: Part, t: float) -> Floats:
        """n; the direction of the slip rate where there is no shear traction."""
        tau = self.joint.shear_stiffness * (part.slip + t * part.slip_rate - self.plastic)
        towards = tau if math.hypot(*tau) > SMALLEST else part.slip_rate
        length = math.hypot(*towards)
        return towards / length if length > 0.0 else np.array([1.0, 0.0])

    def branch(self, part: Part, t: float) -> Branch:
        """The branch on which the point lies if it slips from here on."""
        j = self.joint
        u, u_max = self.opened(part, t)
        D = self.damage_by_opening(part, t)
        n = self.direction(part, t)
        length = math.hypot(*self.plastic)
        growing = length >= self.s_max * (1.0 - SLACK) and outwards(self.plastic, n) > 0.0
        elastic = not part.closed and u_max < (1.0 - D) * j.u_0 * (1.0 - SLACK)
        if D >= 1.0:
            return Branch(elastic, "", growing)
        if j.coupling == "additive":
            return Branch(elastic, "both", growing)
        Q, H = j.Q(u_max - j.u_0), j.H(self.s_max)
        if abs(Q - H) > SLACK:
            return Branch(elastic, "Q" if Q > H else "H", growing)
        damaging = {
            driver: rates(j, part, Branch(elastic, driver, growing), u, u_max, D, self.plastic, n)[1]
            for driver in "QH"
        }
        return Branch(elastic, "H" if damaging["H"] > damaging["Q"] else "Q", growing)

    # ---- Pieces ------------------------------------------------------------------------------------------------

    def slips(self, part: Part, t: float, neutral: bool) -> Branch | None:
        """The branch on which the point slips from here on; None if it sticks.

        `neutral` says that it stuck for no time before: the multiplier may then begin at zero.
        """
        _, tau, g = self.tractions(part, t)
        if math.hypot(*tau) < g - ON_SURFACE:
            return None
        branch, n = self.branch(part, t), self.direction(part, t)
        D = self.damage_by_opening(part, t)
        gamma, _ = rates(self.joint, part, branch, *self.opened(part, t), D, self.plastic, n)
        return branch if gamma > 0.0 or neutral else None

    def stick(self, part: Part, start: float) -> float:
        """Integrates until the point slips; returns that time, or 1."""

        def f(t: float) -> float:
            _, tau, g = self.tractions(part, t)
            return math.hypot(*tau) - g

        end = leaves(f, start)

        def power(t: float) -> float:
            sigma, tau, _ = self.tractions(part, t)
            return sigma * part.u_rate + float(tau @ part.slip_rate)

        # A smooth integrand.
        self.work += float(fixed_quad(np.vectorize(power), start, end, n=16)[0])
        self.damage = self.damage_by_opening(part, end)
        self.u_max = self.opened(part, end)[1]
        return end

    def gape(self, part: Part) -> None:
        """Integrates to the end of a part in which the joint is broken and open: delta_p follows delta."""
        self.u_max = self.opened(part, 1.0)[1]
        self.plastic = part.slip + part.slip_rate
        self.s_max = max(self.s_max, math.hypot(*part.slip), math.hypot(*self.plastic))

    def slide(self, part: Part, start: float, branch: Branch) -> float:
        """Integrates while the point slips on a branch; returns the end time, or 1."""
        j = self.joint
        before = replace(self)
        n = self.direction(part, start)
        # n turns over slips of |tau|/k_s, which makes the rates stiff where |tau| vanishes.
        speed = math.hypot(*part.slip_rate)
        turns = abs(across(n, part.slip_rate)) > 1e-9 * speed
        least = min(self.tractions(part, t)[2] for t in (start, 0.5, 1.0))
        stiff = turns and j.shear_stiffness * speed > STIFF * least

        def place(t: float, y: Floats) -> tuple[float, float, float, Floats]:
            """D, sigma, g, n."""
            u, u_max = before.opened(part, t)
            D = {
                "Q": lambda: j.Q(u_max - j.u_0),
                "H": lambda: j.H(math.hypot(y[0], y[1]) if branch.growing else before.s_max),
                "both": lambda: min(y[4], 1.0),
                "": lambda: before.damage,
            }[branch.driver]()
            sigma = j.normal(u, u_max, D)
            return D, sigma, j.limit(sigma, D), np.array([math.cos(y[2]), math.sin(y[2])])

        def right_hand_side(t: float, y: Floats) -> Floats:
            D, sigma, g, n = place(t, y)
            gamma, D_rate = rates(j, part, branch, *before.opened(part, t), D, y[:2], n)
            turning = turns * j.shear_stiffness * across(n, part.slip_rate) / max(g, SMALLEST)
            power = sigma * part.u_rate + g * float(n @ part.slip_rate)
            return np.array([gamma * n[0], gamma * n[1], turning, power, D_rate])

        # Each event is positive on the piece and falls through zero at its end.
        def sticks(t: float, y: Floats) -> float:
            D, _, _, n = place(t, y)
            return rates(j, part, branch, *before.opened(part, t), D, y[:2], n)[0]

        def outgrows(t: float, y: Floats) -> float:
            if branch.growing:
                return outwards(y[:2], place(t, y)[3]) + SLACK
            return before.s_max - math.hypot(y[0], y[1])

        def breaks(t: float, y: Floats) -> float:
            return 1.0 - place(t, y)[0] if branch.driver else 1.0

        def softens(t: float, y: Floats) -> float:
            return (1.0 - place(t, y)[0]) * j.u_0 - before.opened(part, t)[1] if branch.elastic else 1.0

        def changes(t: float, y: Floats) -> float:
            Q = j.Q(before.opened(part, t)[1] - j.u_0)
            H = j.H(math.hypot(y[0], y[1]) if branch.growing else before.s_max)
            return (Q - H if branch.driver == "Q" else H - Q) + SLACK

        events: list[Callable[[float, Floats], float]] = [sticks, outgrows, breaks, softens]
        if branch.driver in ("Q", "H"):
            events.append(changes)
        for event in events:
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        y = np.array([*self.plastic, math.atan2(n[1], n[0]), self.work, self.damage])
        method = "Radau" if stiff else "DOP853"
        done = solve_ivp(right_hand_side, (start, 1.0), y, method, events=events, rtol=RTOL, atol=ATOL)
        if done.status < 0:
            raise RuntimeError(f"no answer beyond the time {done.t[-1]} of a part: {done.message}")
        end, y = float(done.t[-1]), done.y[:, -1]
        D, _, g, n = place(end, y)
        slip = part.slip + end * part.slip_rate
        self.drift = max(self.drift, abs(math.hypot(*(j.shear_stiffness * (slip - y[:2]))) - g))
        self.u_max = before.opened(part, end)[1]
        self.plastic = slip - g / j.shear_stiffness * n
        self.s_max = max(self.s_max, math.hypot(*self.plastic))
        # Exactly, so that the next piece is one of a broken joint.
        self.damage = 1.0 if len(done.t_events[2]) else max(self.damage, D)
        self.work = float(y[3])
        return end


def across(n: Floats, rate: Floats) -> float:
    """Component of a rate across n."""
    return float(n[0] * rate[1] - n[1] * rate[0])


def drive(joint: Joint, path: Floats) -> Curves:
    """Drives a point from rest along a path of u and two slips [mm], shape (rows, 3), straight between rows."""
    point = _Point(joint, damage=1.0 if joint.dry else 0.0)
    rows = len(path)
    answer = Curves(np.zeros((rows, 3)), np.zeros((rows, 5)), np.zeros(rows))
    last = np.zeros(3)
    for i, to in enumerate(path):
        for begin, end in _parts(joint, point.u_max, last[0], to[0]):
            there = last + begin * (to - last)
            rate = (end - begin) * (to - last)
            middle = there[0] + 0.5 * rate[0]
            loading = rate[0] > 0.0 and middle > point.u_max
            softening = loading and not joint.dry and middle > joint.u_0
            part = Part(there[0], rate[0], there[1:], rate[1:], middle < 0.0, loading, softening)
            _go(point, part)
        last = to
        D = point.damage
        sigma = joint.normal(to[0], point.u_max, D)
        answer.tractions[i] = [sigma, *(joint.shear_stiffness * (to[1:] - point.plastic))]
        answer.state[i] = [D, point.u_max, point.s_max, *point.plastic]
        answer.work[i] = point.work
    answer.drift = point.drift
    return answer


def _parts(joint: Joint, u_max: float, u: float, to: float) -> list[tuple[float, float]]:
    """Begin and end of the parts of a row, between which u passes a kink of its law."""
    kinks = [0.0] if to < u else [0.0, u_max, joint.u_0, joint.u_0 + joint.u_k]
    times = sorted({(kink - u) / (to - u) for kink in kinks} if to != u else set())
    cuts = [0.0, *(t for t in times if 1e-13 < t < 1.0 - 1e-13), 1.0]
    return list(zip(cuts[:-1], cuts[1:], strict=True))


def _go(point: _Point, part: Part) -> None:
    """Integrates to the end of a part."""
    if point.damage >= 1.0 and not part.closed:
        point.gape(part)
        return
    t, neutral = 0.0, False
    for _ in range(PIECES):
        before = t
        branch = point.slips(part, t, neutral)
        t = point.slide(part, t, branch) if branch else point.stick(part, t)
        neutral = branch is None and t == before
        if t >= 1.0:
            return
    raise RuntimeError(f"more than {PIECES} pieces")
