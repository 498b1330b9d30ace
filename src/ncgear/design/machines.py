"""The design files of whole machines that ``ncgear new --machine`` begins with: sizes, loads, masses, gears, wishes.

Their laws are simple ones whose gears build at once; ``ncgear optimize`` looks for the best law for the same wishes.
"""

from __future__ import annotations

from enum import StrEnum

from ncgear.design.template import head


class MachineName(StrEnum):
    """The machines, by the names of the command line."""

    PUMP = "pump"
    PUSHER = "pusher"
    PRESS_FEEDER = "press-feeder"
    BALER = "baler"
    DESK_TOY = "desk-toy"


CHOICES = {
    MachineName.PUMP: "a plunger pump: force both ways, a quick return, least power",
    MachineName.PUSHER: "a packaging pusher: even speed, a quick return",
    MachineName.PRESS_FEEDER: "a press feeder: it lingers at its far end",
    MachineName.BALER: "a baler: a steep load, half of a plain crank's power",
    MachineName.DESK_TOY: "a desk toy to print: it lingers at its far end",
}
"""What each machine is, in a few words."""


def machine_template(name: str, machine: MachineName) -> str:
    """A complete design file called ``name`` of a machine, with comments."""
    return f"{head(name)}\n{_BODIES[machine]}"


_PUMP = """\
description: A plunger pump that delivers on the way out and comes back quicker

linkage: {crank_mm: 30, rod_mm: 120}
operation: {speed_rpm: 120}

motion:                    # a simple law that builds at once; ncgear optimize finds the best one
  law: harmonic_ratio
  sine: [0.35]             # slower on the way out, where the ratio is over 1

gears:
  teeth: 40
  module_mm: 2
  face_width_mm: 20
  backlash_mm: 0.06
  index_holes: true
  material: 42CrMo4
  driving: {bore_mm: 15, keyway: {width_mm: 5, depth_mm: 2.3}}
  driven: {bore_mm: 15, keyway: {width_mm: 5, depth_mm: 2.3}}

resistance:                # forces against the plunger over its displacement
  table: {displacement_mm: [0, 2, 60], force_n: [0, 400, 400]}              # delivery, once the valves have closed
  returning: {table: {displacement_mm: [0, 58, 60], force_n: [60, 60, 0]}}  # suction on the way back
  friction_n: 15           # of the seals, on both strokes

masses:
  slider_kg: 0.8
  rod: {mass_kg: 0.5, center_mm: 45, inertia_kg_mm2: 900}
  crank: {mass_kg: 0.6, center_mm: 12, inertia_kg_mm2: 300}

wishes:
  time_ratio: {at_least: 1.5}   # delivery takes so many times the time of suction

optimize:
  goal: least_power
  limits:
    peak_acceleration_mm_s2: 10000   # of the plunger
    ratio_min: 0.4
    ratio_max: 2.5
    pressure_angle_deg: 55
    free_of_undercut: true
"""

_PUSHER = """\
description: A packaging pusher that pushes cartons at even speed

linkage: {crank_mm: 125, rod_mm: 400}
operation: {speed_rpm: 30}

motion:                    # builds at once; ncgear optimize finds the best law
  law: three_segment_stroke
  solve_for: v1
  theta1_pi: 0.4
  theta2_pi: 0.5
  theta3_pi: 1.0
  theta4_pi: 1.3
  v2_mm_s: 230             # while it pushes
  a1_mm_s2: -1670
  law_speed_rpm: 30
  return: {basis: inverse_ratio}

gears:
  teeth: 48
  module_mm: 1.5
  face_width_mm: 12
  backlash_mm: 0.06
  index_holes: true
  material: 42CrMo4
  driving: {bore_mm: 10}
  driven: {bore_mm: 10}
fit: {driving_shaft: ends}   # below the rod, which passes over it

resistance:
  table: {displacement_mm: [0, 80, 90, 250], force_n: [0, 0, 50, 50]}   # the carton stands a third of the way off
  friction_n: 10           # of the guides, on both strokes
  shown_as: carton         # in pictures

masses:
  slider_kg: 3
  rod: {mass_kg: 0.8, center_mm: 180, inertia_kg_mm2: 12000}
  crank: {mass_kg: 1.2, center_mm: 45, inertia_kg_mm2: 6000}

wishes:
  constant_speed: [{from_mm: 100, to_mm: 200, tolerance: 0.005}]   # within half a percent
  time_ratio: {at_least: 1.5}                                      # a quick return

optimize:
  goal: least_acceleration
  limits: {ratio_min: 0.4, ratio_max: 3, pressure_angle_deg: 60, free_of_undercut: true}
"""

_PRESS_FEEDER = """\
description: A press feeder that lingers at its far end while the gripper opens

linkage: {crank_mm: 75, rod_mm: 260}
operation: {speed_rpm: 40}

motion:                    # a simple law that builds at once; ncgear optimize finds the best one
  law: harmonic_ratio
  cosine: [-0.25]          # slower about the far end, where the ratio is over 1

gears:
  teeth: 50
  module_mm: 2
  face_width_mm: 20
  backlash_mm: 0.06
  index_holes: true
  material: 42CrMo4
  driving: {bore_mm: 15, keyway: {width_mm: 5, depth_mm: 2.3}}
  driven: {bore_mm: 15, keyway: {width_mm: 5, depth_mm: 2.3}}

resistance:
  polynomial_n: [120]                # the sheet is pushed in
  returning: {polynomial_n: [15]}    # the gripper comes back empty
  friction_n: 25                     # of the guides, on both strokes
  shown_as: sheet                    # in pictures

masses:
  slider_kg: 6
  rod: {mass_kg: 1.2, center_mm: 110, inertia_kg_mm2: 9000}
  crank: {mass_kg: 2, center_mm: 30, inertia_kg_mm2: 5000}

wishes:                              # the simple law lingers for 14.7 deg: ncgear check says so
  dwell: [{at: extended, within_mm: 0.5, for_deg: 18}]

optimize:
  goal: least_acceleration
  limits:
    peak_power_w: 50                 # of the driving shaft, all masses counted
    ratio_min: 0.4
    ratio_max: 2.5
    pressure_angle_deg: 55
    free_of_undercut: true
"""

_BALER = """\
description: A baler that presses straw with half the peak power of a plain crank

linkage: {crank_mm: 380, rod_mm: 960}
operation: {speed_rpm: 20}

motion:                    # builds at once; ncgear optimize finds the best law
  law: three_segment_stroke
  solve_for: v1
  theta1_pi: 0.4
  theta2_pi: 0.7
  theta3_pi: 1.0
  theta4_pi: 1.3
  v2_mm_s: 416.6           # while it presses
  a1_mm_s2: -1500
  law_speed_rpm: 20
  return: {basis: ratio}

gears:
  teeth: 60
  module_mm: 8
  face_width_mm: 50
  backlash_mm: 0.1
  index_holes: true
  material: 18CrNiMo7-6
  driving: {bore_mm: 80, keyway: {width_mm: 22, depth_mm: 5.4}}
  driven: {bore_mm: 80, keyway: {width_mm: 22, depth_mm: 5.4}}

resistance:                # of the straw: next to nothing at first, then ever steeper
  table:
    displacement_mm: [0, 35, 100, 200, 400, 500, 600, 700, 760]
    force_n: [0, 0, 270, 440, 520, 2100, 6900, 17300, 27400]
  friction_n: 150          # of the plunger in its guides, on both strokes
  shown_as: straw          # in pictures

masses:
  slider_kg: 150
  rod: {mass_kg: 30, center_mm: 430, inertia_kg_mm2: 2.8e+6}
  crank: {mass_kg: 40, center_mm: 120, inertia_kg_mm2: 1.6e+6}

wishes: {}                 # none: what counts is the motor, and how hard the machine is shaken
optimize:
  goal: least_acceleration
  limits:
    peak_power_w: 4500               # of the driving shaft, all masses counted
    ratio_min: 0.4
    ratio_max: 2.5
    pressure_angle_deg: 60
    free_of_undercut: true
"""

_DESK_TOY = """\
description: A desk toy, printed in PLA, turned by a small motor

linkage: {crank_mm: 15, rod_mm: 60}
operation: {speed_rpm: 30}

motion:                    # a simple law that builds at once; ncgear optimize finds the best one
  law: harmonic_ratio
  cosine: [-0.2]

gears:
  teeth: 36
  module_mm: 1.5
  face_width_mm: 8
  backlash_mm: 0.16
  material: PLA-print              # rough figures: docs/materials.md
  index_holes: true
  first_layer_chamfer_mm: 0.4      # the first layers of a print spread
  process_clearance_mm: 0.05       # walls come out so much too thick
  driving: {bore_mm: 5}
  driven: {bore_mm: 5}

resistance: {friction_n: 0.5}      # nothing else resists it

masses:
  slider_kg: 0.01
  rod: {mass_kg: 0.004, center_mm: 30, inertia_kg_mm2: 1.5}
  crank: {mass_kg: 0.006, center_mm: 6, inertia_kg_mm2: 0.6}

strength: {lubrication: dry, life_h: 200}

wishes:
  dwell: [{at: extended, within_mm: 0.1, for_deg: 10}]   # it lingers at its far end

optimize:
  goal: least_acceleration
  limits: {ratio_min: 0.5, ratio_max: 2, pressure_angle_deg: 55, free_of_undercut: true}
"""

_BODIES = {
    MachineName.PUMP: _PUMP,
    MachineName.PUSHER: _PUSHER,
    MachineName.PRESS_FEEDER: _PRESS_FEEDER,
    MachineName.BALER: _BALER,
    MachineName.DESK_TOY: _DESK_TOY,
}
