#      | | | | | | | |  1 MPa
#      v v v v v v v v
#    ┌─────────────────┐
#    │░░░░░░░░░░░░░░░░░│──> x, 0.8 mm          force
#    ├────────┬────────┤                         │   ,-._
#    ├────┬───┴────┬───┤  bricks in mortar,      │  /    `-._
#    ├────┴───┬────┴───┤  six courses            │ /         `-
#    │░░░░░░░░░░░░░░░░░│                         └────────────> displacement
#    └─────────────────┘
#    /////////////////// held
#
# A short wall between stiff beams is pressed, then pushed sideways: a strut from corner to corner carries the push,
# until joints open in steps along it and its foot is crushed.
#
#     python examples/10_push_a_wall.py

from pathlib import Path

import wythe

HERE = Path(__file__).parent

wall = wythe.templates.shear_wall("1 MPa", "0.8 mm", length="420.5 mm", courses=6)
run = wall.run(HERE / "10_push_a_wall.out", progress=True)

print(f"{run.status}: {run.peak_force:.1f} kN at {run.displacement_at_peak:.2f} mm")
print(f"widest crack in a brick: {run.frame().crack_width.max():.2f} mm")
print(f"widest open joint: {run.interfaces().opening.max():.2f} mm")
for kind in ("curves", "cracks"):
    print(run.picture(kind).save(HERE / "10_push_a_wall.out" / f"{kind}.svg"))
