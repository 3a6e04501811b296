#!/usr/bin/env python3
"""Kratos Multiphysics beside wythe on the couplet in shear (scene 1 of docs/accuracy-speed.md).

    python3 -m venv target/kratos        # Python 3.11; the wheels of 10.4.4 were used
    target/kratos/bin/pip install KratosMultiphysics KratosStructuralMechanicsApplication \\
        KratosConstitutiveLawsApplication KratosPoromechanicsApplication \\
        KratosLinearSolversApplication
    cargo build --release
    target/kratos/bin/python benches/peers/kratos.py target/release/wythe
    target/kratos/bin/python benches/peers/kratos.py target/release/wythe --softening linear

The curve goes to `--out` as CSV. Seconds are `time.process_time()` around the making of the model
and every step, on one thread, without the import; the median of runs by turns with wythe counts.
Never a dependency, never run in CI.

What it has alike is told in couplet.py. What stands for the joint, and differs:

- Two interface elements of the PoromechanicsApplication a facet
  (UPlSmallStrainInterfaceElement3D8N, points at the nodes, pore pressure held at zero), for no law
  of Kratos has a bond that softens beside a friction that stays, but BilinearCohesive3DLaw, below.
- Friction: ElastoPlasticMohrCoulombCohesive3DLaw, with cohesion and tensile strength of next to
  nothing (zero divides by zero). It carries all of the pressure.
- Bond: IsotropicDamageCohesive3DLaw with f_t, shear weighted so that it yields at the bond's
  strength at the mean pressure. Its softening is exponential with the energy of the law up to
  delta_k, so that a tail is left beyond, or linear to delta_k. Tension has the same curve over its
  own slip, not u_k and zeta. In compression its tangent is not consistent, so that Newton's method
  converges linearly.
- Elements: SmallDisplacementElement3D8N (full integration), displacements small.
- Balance: the application's default, corrections below 1e-4 of the displacements, at most 50. (Its
  criterion of residuals sees the forces of the level top, and is not met.) Increments are fixed.

BilinearCohesive3DLaw has both in one, but its damage is that of the step before, its friction has
no stick and acts in each direction by itself. With lateral displacements held, 4 um of elastic slip
and steps that grow by 2 % it was 1.6 % above the peak and 11 % above the energy in twice the time
of the linear form here; with first steps of 7.5 um it begins with more than 400 kN.
"""

import argparse
import math
import sys
import time
from pathlib import Path

# couplet sets the number of threads, before Kratos looks.
from couplet import Couplet, compare

import KratosMultiphysics as Kratos
import KratosMultiphysics.LinearSolversApplication  # registers its solvers
import KratosMultiphysics.PoromechanicsApplication as Poro
import KratosMultiphysics.StructuralMechanicsApplication as Structural
from KratosMultiphysics import python_linear_solver_factory

NEXT_TO_NOTHING = 1e-6  # [MPa]
TOLERANCE, CORRECTIONS = 1e-4, 50
# The interface elements read these without asking whether they are there.
NODAL = ("DISPLACEMENT", "REACTION", "VELOCITY", "ACCELERATION", "VOLUME_ACCELERATION",
         "POINT_LOAD", "LIQUID_PRESSURE", "REACTION_LIQUID_PRESSURE", "DT_LIQUID_PRESSURE",
         "INITIAL_STRESS_TENSOR", "NODAL_JOINT_AREA", "NODAL_JOINT_WIDTH", "NODAL_JOINT_DAMAGE",
         "NODAL_MID_PLANE_LIQUID_PRESSURE")


def variable(name):
    return Kratos.KratosGlobals.GetVariable(name)


class Model:
    """The couplet in Kratos."""

    def __init__(self, couplet, softening):
        self.couplet = couplet
        self.model = Kratos.Model()  # owns the part
        self.part = self.model.CreateModelPart("couplet", 2)
        for name in NODAL:
            self.part.AddNodalSolutionStepVariable(variable(name))
        for name, value in (("DOMAIN_SIZE", 3), ("DELTA_TIME", 1.0), ("VELOCITY_COEFFICIENT", 1.0),
                            ("DT_LIQUID_PRESSURE_COEFFICIENT", 1.0), ("NODAL_SMOOTHING", False),
                            ("IS_CONVERGED", True)):
            self.part.ProcessInfo[variable(name)] = value
        solid = self.properties(1, Structural.LinearElastic3DLaw(), YOUNG_MODULUS=couplet.modulus,
                                POISSON_RATIO=couplet.poisson, DENSITY=0.0)
        joints = [self.friction(), self.bond(softening)]
        for tag, place in couplet.nodes.items():
            self.part.CreateNewNode(tag, *place)
        elements = [("SmallDisplacementElement3D8N", nodes, solid) for *_, nodes in couplet.solids]
        elements += [("UPlSmallStrainInterfaceElement3D8N", below + above, joint)
                     for below, above in couplet.facets for joint in joints]
        for tag, element in enumerate(elements, 1):
            self.part.CreateNewElement(element[0], tag, *element[1:])
        self.hold()
        lead, *others = couplet.top
        vertical = variable("DISPLACEMENT_Z")
        for tag, other in enumerate(others, 1):  # level
            self.part.CreateNewMasterSlaveConstraint(
                "LinearMasterSlaveConstraint", tag, self.part.GetNode(lead), vertical,
                self.part.GetNode(other), vertical, 1.0, 0.0)
        self.part.CreateNewCondition("PointLoadCondition3D1N", 1, [lead], solid)
        load = [0.0, 0.0, -couplet.load]
        self.part.GetNode(lead).SetSolutionStepValue(variable("POINT_LOAD"), load)
        self.strategy = self.newton()
        self.steps = self.solves = 0

    def properties(self, tag, law, **values):
        made = self.part.CreateNewProperties(tag)
        made.SetValue(Kratos.CONSTITUTIVE_LAW, law)
        for name, value in values.items():
            made.SetValue(variable(name), value)
        return made

    def joint(self, tag, law, **values):
        """What an interface element asks for, without effect of the liquid."""
        liquid = {"INITIAL_JOINT_WIDTH": 1e-8, "TRANSVERSAL_PERMEABILITY_COEFFICIENT": 0.0,
                  "DENSITY_SOLID": 0.0, "DENSITY_LIQUID": 0.0, "POROSITY": 0.3,
                  "BULK_MODULUS_SOLID": 1e12, "BULK_MODULUS_LIQUID": 1e9,
                  "DYNAMIC_VISCOSITY_LIQUID": 1e-3, "BIOT_COEFFICIENT": 0.0,
                  "YOUNG_MODULUS": 1.0, "POISSON_RATIO": 0.2,
                  "NORMAL_STIFFNESS": self.couplet.normal,
                  "SHEAR_STIFFNESS": self.couplet.tangential}
        return self.properties(tag, law, **liquid, **values)

    def friction(self):
        return self.joint(2, Poro.ElastoPlasticMohrCoulombCohesive3DLaw(), PENALTY_STIFFNESS=1.0,
                          TENSILE_STRENGTH=NEXT_TO_NOTHING, COHESION=NEXT_TO_NOTHING,
                          FRICTION_ANGLE=math.atan(self.couplet.mu), DILATANCY_ANGLE=0.0)

    def bond(self, softening):
        c = self.couplet
        # An equivalent opening of beta × slip yields at f_t over the normal stiffness.
        beta = c.tangential * c.f_t / (c.normal * c.bond)
        if softening == "linear":
            energy, law = c.f_t * (beta * c.delta_k - c.f_t / c.normal) / 2, 1
        else:
            energy, law = c.f_t * beta * c.energy_of_bond() / c.bond, 2
        return self.joint(3, Poro.IsotropicDamageCohesive3DLaw(), PENALTY_STIFFNESS=1e-6,
                          TENSILE_STRENGTH=c.f_t, FRACTURE_ENERGY=energy,
                          BETA_EQSTRAIN_SHEAR_FACTOR=beta, DAMAGE_EVOLUTION_LAW=law)

    def hold(self):
        utilities = Kratos.VariableUtils()
        for name in ("DISPLACEMENT_X", "DISPLACEMENT_Y", "DISPLACEMENT_Z"):
            reaction = variable(name.replace("DISPLACEMENT", "REACTION"))
            utilities.AddDof(variable(name), reaction, self.part)
        pressure = variable("LIQUID_PRESSURE")
        utilities.AddDof(pressure, variable("REACTION_LIQUID_PRESSURE"), self.part)
        stress = variable("INITIAL_STRESS_TENSOR")
        for node in self.part.Nodes:
            node.Fix(pressure)
            for step in (0, 1):
                node.SetSolutionStepValue(stress, step, Kratos.Matrix(3, 3, 0.0))
        for tags, axes in ((self.couplet.base, "XYZ"), (self.couplet.top, "XY")):
            for tag in tags:
                for axis in axes:
                    self.part.GetNode(tag).Fix(variable(f"DISPLACEMENT_{axis}"))

    def newton(self):
        solver = Kratos.Parameters('{"solver_type": "LinearSolversApplication.sparse_lu"}')
        builder = Kratos.ResidualBasedBlockBuilderAndSolver(
            python_linear_solver_factory.ConstructSolver(solver))
        strategy = Kratos.ResidualBasedNewtonRaphsonStrategy(
            self.part, Kratos.ResidualBasedIncrementalUpdateStaticScheme(),
            Kratos.DisplacementCriteria(TOLERANCE, 1e-9), builder, CORRECTIONS, True, False, False)
        strategy.SetEchoLevel(0)
        strategy.Initialize()
        strategy.Check()
        return strategy

    def step(self, u):
        """To the displacement u of the top."""
        self.steps += 1
        self.part.CloneTimeStep(float(self.steps))
        self.part.ProcessInfo[Kratos.STEP] += 1
        for tag in self.couplet.top:
            self.part.GetNode(tag).SetSolutionStepValue(variable("DISPLACEMENT_X"), u)
        self.strategy.InitializeSolutionStep()
        self.strategy.Predict()
        if not self.strategy.SolveSolutionStep():
            raise SystemExit(f"Kratos found no equilibrium at {u:.4f} mm")
        self.strategy.FinalizeSolutionStep()
        self.solves += self.part.ProcessInfo[Kratos.NL_ITERATION_NUMBER]

    def force(self):
        """What the drive takes [kN]."""
        reaction = variable("REACTION_X")
        base = map(self.part.GetNode, self.couplet.base)
        return -sum(node.GetSolutionStepValue(reaction) for node in base) / 1e3


def run(softening):
    """Rows of displacement, force, CPU seconds and solves, see `compare`."""
    couplet = Couplet()
    rows, begin = [], time.process_time()
    model = Model(couplet, softening)
    for u in [0.0, *couplet.drive()]:  # the first one presses
        model.step(u)
        rows.append((u, model.force(), time.process_time() - begin, model.solves))
    return rows


def main():
    parser = argparse.ArgumentParser(description="Kratos beside wythe on the couplet in shear")
    parser.add_argument("wythe", nargs="?", help="the binary; without it Kratos runs alone")
    parser.add_argument("--softening", choices=("exponential", "linear"), default="exponential")
    parser.add_argument("--out", type=Path, default=Path("target/kratos-results"))
    arguments = parser.parse_args()
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    Kratos.ParallelUtilities.SetNumThreads(1)
    softening = arguments.softening
    compare(f"kratos_{softening}", lambda: run(softening), arguments.wythe, arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
