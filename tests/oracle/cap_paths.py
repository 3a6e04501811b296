"""Golden curves of the joint with a compression cap: joints and paths."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cap import CapJoint
from paths import JointCase, legs

#: An invented joint: the friction does not change and slip does not dilate.
PLAIN = CapJoint(0.25, 0.35, 0.75, 0.75, 0.018, 0.125, 10.5, 0.09, 5.0, 82.0, 36.0)
#: An invented joint of which no parameter has its default.
DILATANT = CapJoint(
    0.2, 0.4, 0.9, 0.6, 0.03, 0.15, 8.0, 0.05, 3.0, 120.0, 50.0,
    C_nn=1.3, C_ss=7.0, tan_psi=0.5, sigma_u=3.0, delta=2.0, closes=False,
)  # fmt: skip
#: The same joint with faces that meet again.
CLOSING = replace(DILATANT, closes=True)
#: An invented joint without bond: tan phi_0 and the energies of the bond have no effect.
DRY = CapJoint(0.0, 0.0, 0.9, 0.65, 1.0, 1.0, 9.0, 0.04, 3.0, 100.0, 40.0, tan_psi=0.2, sigma_u=2.0)

CAP_CASES = [
    JointCase(
        "cap_plain_open_and_crush",
        "opened, half closed, opened further, crushed past the peak, opened, crushed into the exponential part",
        PLAIN,
        legs((16, 0.03, 0, 0), (8, 0.027, 0, 0), (16, 0.06, 0, 0), (24, -0.4, 0, 0), (16, 0.08, 0, 0), (32, -2, 0, 0)),
    ),
    JointCase(
        "cap_plain_shear_cyclic",
        "cyclic shear under 0.8 MPa: without dilatancy the pressure stays",
        PLAIN,
        legs((1, -0.01, 0, 0), *((24, -0.01, slip, 0) for slip in (0.1, -0.1, 0.3))),
    ),
    JointCase(
        "cap_plain_mixed",
        "opened with slip in changing directions, closed, crushed with slip",
        PLAIN,
        legs((16, 0.02, 0.02, 0.01), (16, 0.03, 0.02, 0.06), (16, -0.02, 0.1, 0.05), (24, -0.05, 0.2, 0.3)),
    ),
    JointCase(
        "cap_plain_crushed_then_sheared",
        "pressed with slip to the cap, slid across, back, torn apart",
        PLAIN,
        legs((16, -0.1, 0.02, 0.05), (16, -0.2, 0.25, 0.05), (24, -0.25, -0.2, -0.1), (24, 0.02, 0, -0.2)),
    ),
    JointCase(
        "cap_dilatant_open",
        "opened, half closed, opened, slid while open",
        DILATANT,
        legs((16, 0.03, 0, 0), (8, 0.01, 0, 0), (16, 0.05, 0.01, 0), (16, 0.05, 0.03, 0)),
    ),
    JointCase(
        "cap_dilatant_shear_cyclic",
        "cyclic shear at a constant opening: pressure by dilatancy up to the cap",
        DILATANT,
        legs((1, -0.01, 0, 0), *((24, -0.01, slip, 0) for slip in (0.2, -0.2, 0.5))),
    ),
    JointCase(
        "cap_dilatant_shear_circle",
        "slip along a circle at a constant opening",
        DILATANT,
        legs(
            (1, -0.01, 0, 0),
            (10, -0.01, 0.05, 0),
            *((1, -0.01, 0.05 * np.cos(a), 0.05 * np.sin(a)) for a in np.radians(np.arange(6, 361, 6))),
        ),
    ),
    JointCase(
        "cap_dilatant_mixed",
        "opened with slip in changing directions, closed, crushed with slip: every set of surfaces",
        DILATANT,
        legs((16, 0.02, 0.02, 0.01), (16, 0.03, 0.02, 0.06), (16, -0.02, 0.1, 0.05), (24, -0.05, 0.2, 0.3)),
    ),
    JointCase(
        "cap_dilatant_crushed_then_sheared",
        "pressed beyond sigma_u and to the cap, slid, relieved while sliding, torn apart",
        DILATANT,
        legs((16, -0.1, 0.02, 0.05), (16, -0.2, 0.25, 0.05), (24, -0.15, -0.2, -0.1), (24, 0.02, 0, -0.2)),
    ),
    JointCase(
        "cap_closing_to_and_fro",
        "opened, closed and pressed, opened further with slip, slid while the gap closes, pressed, slid, opened",
        CLOSING,
        legs(
            (16, 0.03, 0, 0), (24, -0.01, 0, 0), (24, 0.08, 0.02, 0.01), (16, 0.04, 0.06, -0.02),
            (16, -0.02, 0.06, -0.02), (16, -0.04, 0.06, 0.05), (16, 0.05, 0.06, 0.05),
        ),
    ),
    JointCase(
        "cap_dry_spiral",
        "no bond: slip along a spiral while the joint closes, up to the cap",
        DRY,
        legs(
            *(
                (1, -0.012 - 0.002 * a - 0.004 * np.sin(3 * a), 0.02 * a * np.cos(a), 0.02 * a * np.sin(a))
                for a in np.radians(np.arange(9, 721, 9))
            )
        ),
    ),
]
