"""Limit analysis of a semicircular arch of rigid voussoirs by linear programming (static theorem, associated friction).

Prints the least thickness over the radius and the largest horizontal multiplier of the weight. A joint carries a normal
force at its intrados and one at its extrados, both pressing, and shear of at most tan(phi) times each: with friction so high
that nothing slides this is Heyman's arch. Weights and centroids are those of the voussoirs: `flat` as `[arch]` of wythe builds
them (eight corners on the two circles, straight faces), `curved` exact sectors of the ring.

    python3 limit_analysis.py             # the tables of this page; needs numpy and scipy
    python3 limit_analysis.py 7 27 35     # other numbers of voussoirs
"""

import sys

import numpy as np
from scipy.optimize import linprog


def voussoirs(number, thickness, flat):
    """Weight (area) and centroid of each voussoir of an arch of radius 1, from left to right."""
    outer, inner = 1 + thickness / 2, 1 - thickness / 2
    half = np.pi / (2 * number)
    middles = np.pi - half * (1 + 2 * np.arange(number))
    if flat:
        # Two triangles from the centre, the larger less the smaller: areas r² sin(half) cos(half), centroids 2/3 r cos(half).
        areas = np.array([outer, inner]) ** 2 * np.sin(half) * np.cos(half)
        centroids = 2 / 3 * np.array([outer, inner]) * np.cos(half)
    else:
        areas = np.array([outer, inner]) ** 2 * half
        centroids = 2 / 3 * np.array([outer, inner]) * np.sin(half) / half
    area = areas[0] - areas[1]
    radius = (areas[0] * centroids[0] - areas[1] * centroids[1]) / area
    return area, radius * np.cos(middles), radius * np.sin(middles)


def multiplier(number, thickness, flat=True, tan_phi=2.0):
    """Largest ratio of horizontal to vertical body force with equilibrium; None if the arch does not stand at all."""
    area, x, z = voussoirs(number, thickness, flat)
    angles = np.pi - np.pi / number * np.arange(number + 1)
    # Unknowns: normal and shear force at the inner and the outer edge of each joint (4 a joint), and the multiplier.
    unknowns = 4 * (number + 1) + 1
    balance = np.zeros((3 * number, unknowns))
    loads = np.zeros(3 * number)
    for joint, angle in enumerate(angles):
        normal = np.array([np.sin(angle), -np.cos(angle)])  # along the arch, from left to right
        shear = np.array([np.cos(angle), np.sin(angle)])  # outwards
        for edge, radius in enumerate((1 - thickness / 2, 1 + thickness / 2)):
            at = radius * np.array([np.cos(angle), np.sin(angle)])
            for kind, direction in enumerate((normal, shear)):
                column = 4 * joint + 2 * edge + kind
                # A joint presses the voussoir on its right along the arch, that on its left against it.
                for block, sign in ((joint, 1), (joint - 1, -1)):
                    if 0 <= block < number:
                        balance[3 * block : 3 * block + 2, column] += sign * direction
                        arm = at - np.array([x[block], z[block]])
                        balance[3 * block + 2, column] += sign * (arm[0] * direction[1] - arm[1] * direction[0])
    for block in range(number):
        balance[3 * block, -1] = area
        loads[3 * block + 1] = area
    cone = np.zeros((4 * (number + 1), unknowns))
    for point in range(2 * (number + 1)):
        cone[2 * point, [2 * point, 2 * point + 1]] = -tan_phi, 1
        cone[2 * point + 1, [2 * point, 2 * point + 1]] = -tan_phi, -1
    bounds = [(0, None), (None, None)] * (2 * (number + 1)) + [(0, None)]
    scale = area
    result = linprog(
        -np.eye(1, unknowns, unknowns - 1)[0],
        A_ub=cone,
        b_ub=np.zeros(len(cone)),
        A_eq=balance / scale,
        b_eq=loads / scale,
        bounds=bounds,
        method="highs",
    )
    return result.x[-1] if result.success else None


def least_thickness(number, flat=True, tan_phi=2.0):
    """Least thickness over the radius of the centre line with which the arch stands under its weight."""
    low, high = 0.03, 0.2
    while high - low > 1e-7:
        middle = (low + high) / 2
        if multiplier(number, middle, flat, tan_phi) is None:
            low = middle
        else:
            high = middle
    return high


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:]] or [5, 7, 9, 11, 15, 19, 27, 35]
    print("voussoirs,tmin_flat,tmin_curved")
    for number in numbers:
        print(f"{number},{least_thickness(number):.6f},{least_thickness(number, flat=False):.6f}")
    print("voussoirs,t_over_R,lambda_flat,lambda_curved")
    for number in numbers:
        for thickness in (0.11, 0.12, 0.15, 0.2):
            flat, curved = (multiplier(number, thickness, kind) for kind in (True, False))
            print(f"{number},{thickness},{flat:.6f},{curved:.6f}")
