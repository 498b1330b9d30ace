"""A commented design file to begin with, one for each law.

Plain text with next to no imports, so that the command line can list the laws without loading the schema.
"""

from __future__ import annotations

from enum import StrEnum

from ncgear.design.reading.text import plain_value


class Law(StrEnum):
    """The laws there is a template for."""

    THREE_SEGMENT_STROKE = "three_segment_stroke"
    RATIO_EXPRESSION = "ratio_expression"
    HARMONIC_RATIO = "harmonic_ratio"
    ELLIPSE = "ellipse"
    TABLE = "table"
    UNIFORM_CRANK = "uniform_crank"


def template(name: str, law: Law = Law.THREE_SEGMENT_STROKE) -> str:
    """A complete design file called ``name``, with a comment on every value."""
    # Names such as 12 or true must not be read as a number or a truth value, nor one of dashes as a list.
    quoted = name if name[0].isalpha() and isinstance(plain_value(name), str) else f'"{name}"'
    head = _HEAD.replace("name: {name}", f"name: {quoted}").format(name=name)
    return "\n".join((head, _MOTIONS[law], _GEARS, _MACHINE))


_HEAD = """\
# A design file of ncgear. Lengths in mm, angles in the unit their key ends in (_rad, _deg, or _pi: multiples of pi).
#   ncgear check {name}.yaml    kinematics and power
#   ncgear build {name}.yaml    gears, into export/{name}

name: {name}               # letters, digits, - and _; also names the output folder
description: ""            # free text

linkage:                   # the crank-slider that the driven gear turns
  crank_mm: 380
  rod_mm: 960
  offset_mm: 0             # distance of the slider's line from the crank axis

operation:
  speed_rpm: 20            # speed of the driving gear
"""

_MOTIONS: dict[Law, str] = {
    Law.THREE_SEGMENT_STROKE: """\
motion:                    # how the slider moves
  law: three_segment_stroke
  solve_for: law_speed     # law_speed, v1, v2, a1 or stroke: its own key is left out below
  theta1_pi: 0.4           # the slider's speed is v1, its acceleration zero
  theta2_pi: 0.7           # from here it presses at constant speed v2 ...
  theta3_pi: 1.0           # ... to here, and then slows down
  theta4_pi: 1.3           # extended dead centre; the rest of the turn is the return
  v1_mm_s: 1600            # slider speeds, at the law speed
  v2_mm_s: 1100
  a1_mm_s2: -1500          # slider acceleration at theta4, negative
  a1_speed_rpm: 20         # speed at which a1 is stated; left out: the law speed
  # law_speed_rpm:         # speed at which v1 and v2 hold; found here
  stroke_mm: 760           # left out: the stroke of the linkage
  return:                  # the return stroke
    basis: ratio           # ratio or inverse_ratio
    e: least_acceleration  # a number (with basis ratio), or least_acceleration to have it found
""",
    Law.RATIO_EXPRESSION: """\
motion:                    # the law of the gears, as a formula of phi, the driving angle in rad
  law: ratio_expression
  ratio: "1 + 0.3*cos(phi)"  # transmission ratio dphi1/dphi2
  scale_to_close: true     # multiply it by the constant that makes the driven gear come round
  # driven_angle: "phi - 0.08*sin(2*phi)"   # instead of ratio: the driven angle in rad
""",
    Law.HARMONIC_RATIO: """\
motion:                    # the law of the gears by harmonics; the form in which optimised laws are stored
  law: harmonic_ratio
  # ln(dphi1/dphi2) = c0 - 0.25 cos(phi2) + 0.05 cos(2 phi2) + 0.1 sin(phi2), phi2 being the driven angle; c0 is found,
  # so that the driven gear comes round. With several lobes of the driven gear, phi2 stands for lobes.driven * phi2.
  cosine: [-0.25, 0.05]
  sine: [0.1]
""",
    Law.ELLIPSE: """\
motion:                    # equal ellipses, each turning about a focus
  law: ellipse
  eccentricity: 0.3        # 0 (a circle) to under 1
  phase_deg: 0             # driving angle at which the driving radius is smallest
""",
    Law.TABLE: """\
motion:                    # the law point by point
  law: table
  # Driving angles of one cycle, strictly rising; phi1_rad or phi1_pi can take the place of phi1_deg.
  phi1_deg: [0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330]
  # Transmission ratios dphi1/dphi2; displacement_mm (of the slider, from its retracted end) can take their place.
  ratio: [1.2, 1.1732, 1.1, 1.0, 0.9, 0.8268, 0.8, 0.8268, 0.9, 1.0, 1.1, 1.1732]
  scale_to_close: true     # multiply the ratio by the constant that makes the driven gear come round
  # file: points.csv       # instead of the two lists: a CSV file whose header names the same columns
""",
    Law.UNIFORM_CRANK: """\
motion:                    # circular gears, to compare with
  law: uniform_crank
""",
}

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
  backlash_mm: 0           # normal backlash
  index_holes: true        # a small hole in each gear; they face each other at phi1 = 0, so that teeth pair up right
  # tolerances: {standard: ISO 1328-1, grade: "8", tooth_thickness_upper_mm: -0.05, tooth_thickness_lower_mm: -0.1}
  # measuring_pin_mm: 3.5  # of the data sheet; left out: one that fits
  # first_layer_chamfer_mm: 0.4   # bevel of all edges at z = 0, where the first layers of a print spread
  # process_clearance_mm: 0.05    # the solids' teeth and bores are drawn back by it, since a print swells
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

_MACHINE = """\
resistance:                # the force against the slider; left out: none
  polynomial_n: [-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7]   # N, rising powers of the displacement in mm
  # table: {displacement_mm: [0, 400, 760], force_n: [0, 2000, 30000]}   # instead, or {file: points.csv}
  # expression_n: "200 + 3*exp(x/90)"                                  # instead: a formula of x, the displacement
  where_negative: zero     # zero, or keep

# masses:                  # for ncgear simulate; forces need them
#   slider_kg: 150
#   rod: {mass_kg: 30, center_mm: 430, inertia_kg_mm2: 2.8e+6}     # centre from the crank pin, inertia about the centre
#   crank: {mass_kg: 40, center_mm: 120, inertia_kg_mm2: 1.6e+6}   # inertia about the axis
#   # driving_gear_kg_mm2:   # left out, these follow from the teeth
#   # driven_gear_kg_mm2:
#   # flywheel: {inertia_kg_mm2: 0, speed_fluctuation: 0.05}
#   # gravity: {direction_deg: -90}                                # from the slider's way out, counter-clockwise

# simulation:              # for ncgear simulate --level quasi_static and dynamic; left out: as published for a baler
#   youngs_modulus_gpa: 201
#   poisson: 0.29
#   # stiffness_n_mm:        # force at a depth of 1 mm; left out: from the two above
#   exponent: 2.2          # of the depth, in the force of a contact
#   damping_n_s_mm: 100    # full from a depth on
#   full_damping_depth_mm: 0.1
#   friction: {static: 0.08, dynamic: 0.05, static_speed_mm_s: 1, dynamic_speed_mm_s: 10}
#   # motor: {no_load_speed_rpm: 21, stall_torque_n_m: 60000}        # left out: the operating speed, whatever it takes
#   start: on_law          # or rest
#   turns: 1               # of the driving gear

# comparison:              # published mechanisms, compared at equal speed
#   published:
#     - name: author and year
#       speed_rpm: 60      # the speed its figures belong to
#       peak_power_w: 18750             # at least one of these four
#       peak_acceleration_mm_s2: 45000
#       peak_speed_mm_s: 2100
#       compression_speed_mm_s: 820

output:
  chord_tolerance_mm: 0.005   # greatest distance of an outline's chords from the exact curve
"""
