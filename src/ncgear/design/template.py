"""The commented design file of ``ncgear new``: the same machine and gears for every law, and the law's own part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ncgear.design.laws.registry import DEFAULT_LAW, LawName
from ncgear.design.laws.templates import TEMPLATES
from ncgear.design.reading.text import plain_value


def template(name: str, law: LawName = DEFAULT_LAW, wishes: Mapping[str, Any] | None = None) -> str:
    """A complete design file called ``name``, with a comment on every value.

    ``wishes`` of the motion by their kinds, in the form of a design file; with some, the file has limits for the law
    that keeps them.
    """
    wished = _wished(wishes) if wishes else _WISHES
    return "\n".join((f"{head(name)}{_LINKAGE}", TEMPLATES[law], _GEARS, _RESISTANCE, wished, _MACHINE))


def head(name: str) -> str:
    """The first lines of a design file called ``name``."""
    # Names such as 12 or true must not be read as a number or a truth value, and a name of dashes not as a list.
    quoted = name if name[0].isalpha() and isinstance(plain_value(name), str) else f'"{name}"'
    return _HEAD.format(name=name, quoted=quoted)


def _wished(wishes: Mapping[str, Any]) -> str:
    from ncgear.design.rewritten import flow_text

    return "\n".join((_WISHED, *(f"  {kind}: {flow_text(value)}" for kind, value in wishes.items()), _BEST))


_HEAD = """\
# A design file of ncgear. Lengths in mm, angles in the unit their key ends in (_rad, _deg, or _pi: multiples of pi).
#   ncgear check {name}.yaml    kinematics and power (ncgear studio {name}.yaml: on a page on which it runs)
#   ncgear build {name}.yaml    gears, into export/{name}

name: {quoted}               # letters, digits, - and _; also names the output folder
"""

_LINKAGE = """\
description: ""            # free text

linkage:                   # the crank-slider that the driven gear turns
  crank_mm: 380
  rod_mm: 960
  offset_mm: 0             # distance of the slider's line from the crank axis

fit: {driving_shaft: ends}   # below the rod, which passes over it; through: it stands in the rod's way

operation:
  speed_rpm: 20            # speed of the driving gear
"""

_GEARS = """\
gears:                     # a check does without, a build needs it
  mesh: external           # or internal: the driven gear is a ring, which needs a ratio over 1 everywhere
  lobes: {driving: 1, driven: 1}   # how often the law repeats in one turn
  teeth: 90                # of the driving gear; any two of teeth, module_mm and center_distance_mm
  module_mm: 2
  # center_distance_mm:    # found here
  face_width_mm: 20
  rack:                    # basic rack of ISO 53
    profile: A             # A, B, C or D
    pressure_angle_deg: 20
    # addendum: 1          # in modules, in place of the profile's
    # dedendum: 1.25
    # root_radius: 0.38
  # helix: {angle_deg: 15, kind: helical, hand: right}   # or herringbone, left; left out: straight teeth
  backlash_mm: 0.07        # normal backlash: hobbed pairs of this size turn; 0: the exact pair, which jams
  index_holes: true        # a small hole in each gear; they face each other at phi1 = 0, so that teeth pair up right
  material: 42CrMo4        # both gears; or {driving: 16MnCr5, driven: POM}; docs/materials.md lists all
  # tolerances: {standard: ISO 1328-1, grade: "8", tooth_thickness_upper_mm: -0.05, tooth_thickness_lower_mm: -0.1}
  # measuring_pin_mm: 3.5  # of the data sheet; left out: one that fits
  # first_layer_chamfer_mm: 0.4   # bevel of all edges at z = 0, where the first layers of a print spread
  # process_clearance_mm: 0.05    # for a print that swells; negative: half the kerf of a laser or wire
  driving:
    bore_mm: 12
    keyway: {width_mm: 4, depth_mm: 1.8}
    # hub:                 # a cylinder on the upper face
    #   diameter_mm: 24
    #   height_mm: 10
    #   set_screw: {diameter_mm: 3.3, direction_deg: 90}   # height_mm over the face left out: half the hub's
    # web: {thickness_mm: 6, rim_mm: 6}       # pockets from above; hub_mm: diameter left about the axis
    # lightening_holes: {count: 5, least_wall_mm: 4}   # diameter_mm left out: as large as the walls allow
  driven: {bore_mm: 12}
"""

_RESISTANCE = """\
resistance:                # the force against the slider; left out: none
  polynomial_n: [-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7]   # N, rising powers of the displacement in mm
  # table: {displacement_mm: [0, 400, 760], force_n: [0, 2000, 30000]}   # instead, or {file: points.csv}
  # expression_n: "200 + 3*exp(x/90)"                                  # instead: a formula of x, the displacement
  where_negative: zero     # zero, or keep
  shown_as: straw          # in pictures: straw; load, a plain block; carton; sheet
  # returning: {polynomial_n: [50]}   # the force on the way back, in any of the three forms; left out: none
  # friction_n: 20         # constant, against the motion, on both strokes
"""

_WISHES = """\
# wishes:                  # for the slider; ncgear check says what is kept, ncgear optimize finds a law that keeps all
#   constant_speed: [{from_mm: 400, to_mm: 700, tolerance: 0.005}]   # within half a percent; or stroke: return
#   time_ratio: {at_least: 1.2}                                      # time of the working stroke over the return's
#   dwell: [{at: extended, within_mm: 2, for_deg: 20}]               # close to an end; or at: retracted
#   speed_at: [{at_mm: 600, make: slowest, hard: false}]             # or at_least_mm_s, at_most_mm_s
#   gentle_stop: [{from_mm: 700, deceleration_at_most_mm_s2: 9000}]  # or speed_at_most_mm_s, to_mm, stroke: return
#   positions: [{at_mm: 300, phi1_deg: 80, tolerance_mm: 1}]         # places at driving angles
#   working_stroke: {angle_deg: 200, tolerance_deg: 1}

# optimize:                # for ncgear optimize; left out: least acceleration, ratios from 0.2 to 5
#   goal: least_acceleration   # or least_power, least_flywheel, ...: docs/design-file.md lists goals and limits
#   limits: {peak_power_w: 5000, ratio_min: 0.4, ratio_max: 2.5, pressure_angle_deg: 55}
"""

_WISHED = "wishes:                    # for the slider; ncgear check says what is kept"

_BEST = """
optimize:                  # ncgear optimize finds a law that keeps all wishes
  goal: least_acceleration
  limits: {ratio_min: 0.4, ratio_max: 2.5, pressure_angle_deg: 55}
"""

_MACHINE = """\
# masses:                  # for ncgear simulate; forces need them
#   slider_kg: 150
#   rod: {mass_kg: 30, center_mm: 430, inertia_kg_mm2: 2.8e+6}     # centre from the crank pin, inertia about the centre
#   crank: {mass_kg: 40, center_mm: 120, inertia_kg_mm2: 1.6e+6}   # inertia about the axis
#   # driving_gear_kg_mm2:   # left out, these follow from the teeth
#   # driven_gear_kg_mm2:
#   # flywheel: {inertia_kg_mm2: 0, speed_fluctuation: 0.05}
#   # gravity: {direction_deg: -90}                                # from the slider's way out, counter-clockwise

# simulation:              # for ncgear simulate --level quasi_static and dynamic
#   # stiffness_n_mm:        # of a pair of teeth; left out: each pair's own, from its teeth, material and face width
#   # exponent: 1            # of the depth, in the force of a pair; other than 1 only with stiffness_n_mm
#   # damping_n_s_mm:        # of a pair of teeth, full from a depth on; left out: by the ratio
#   damping_ratio: 0.07      # to the critical damping of one pair of teeth
#   full_damping_depth_mm: 0.002
#   friction: {static: 0.08, dynamic: 0.05, static_speed_mm_s: 1, dynamic_speed_mm_s: 10}
#   # motor: {no_load_speed_rpm: 21, stall_torque_n_m: 60000}        # left out: the operating speed, whatever it takes
#   start: on_law          # or rest
#   turns: 1               # of the driving gear

# strength:                # for ncgear strength; left out: 20 000 h in oil
#   method: estimate       # or elements
#   life_h: 20000          # or life_strokes
#   application_factor: 1.0   # jolts beyond the computed load
#   face_load_factor: 1.3  # uneven load along the width
#   reliability: 0.99
#   lubrication: oil       # grease or dry
#   oil_viscosity_mm2_s: 220
#   flank_roughness_um: 6  # Rz; 3 ground, 6 hobbed, 12 milled
#   root_roughness_um: 16
#   temperature_c: 20      # of the oil or the air
#   # contact_safety: 1.0    # least ones wanted; left out: by the material
#   # bending_safety: 1.4

# comparison:              # published mechanisms, compared at equal speed
#   published:
#     - name: author and year
#       speed_rpm: 60      # the speed its figures belong to
#       peak_power_w: 18750             # at least one of these four
#       peak_acceleration_mm_s2: 45000
#       peak_speed_mm_s: 2100
#       compression_speed_mm_s: 820

# output:
#   chord_tolerance_mm: 0.005   # greatest distance of an outline's chords from the exact curve
"""
