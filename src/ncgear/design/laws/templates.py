"""The group ``motion`` of a new design file for each law, with a comment on every value.

The texts are apart from the models of the laws' keys, so that ``ncgear new`` writes a file without loading pydantic.
"""

from __future__ import annotations

from ncgear.design.laws.registry import LawName

TEMPLATES: dict[LawName, str] = {
    LawName.THREE_SEGMENT_STROKE: """\
motion:                    # how the slider moves
  law: three_segment_stroke
  solve_for: v1            # law_speed, v1, v2, a1 or stroke: its own key is left out below
  theta1_pi: 0.4           # the slider's speed is v1, its acceleration zero
  theta2_pi: 0.7           # from here it presses at constant speed v2 ...
  theta3_pi: 1.0           # ... to here, and then slows down
  theta4_pi: 1.3           # extended dead centre; the rest of the turn is the return
  # v1_mm_s:               # slider's speed at theta1; found here
  v2_mm_s: 416.6           # slider's speed while it presses
  a1_mm_s2: -1500          # slider acceleration at theta4, negative
  # a1_speed_rpm: 20       # speed at which a1 is stated; left out: the law speed
  law_speed_rpm: 20        # speed at which v1 and v2 hold
  stroke_mm: 760           # left out: the stroke of the linkage
  return:                  # the return stroke
    basis: ratio           # ratio or inverse_ratio
    e: least_acceleration  # a number, or least_acceleration to have it found
""",
    LawName.RATIO_EXPRESSION: """\
motion:                    # the law of the gears, as a formula of phi, the driving angle in rad
  law: ratio_expression
  ratio: "1 + 0.3*cos(phi)"  # transmission ratio dphi1/dphi2
  scale_to_close: true     # multiply it by the constant that makes the driven gear come round
  # driven_angle: "phi - 0.08*sin(2*phi)"   # instead of ratio: the driven angle in rad
  # range_deg: 200         # gears that turn to and fro over these degrees, less than once; without scale_to_close
""",
    LawName.HARMONIC_RATIO: """\
motion:                    # the law of the gears by harmonics; the form in which optimised laws are stored
  law: harmonic_ratio
  # ln(dphi1/dphi2) = c0 - 0.25 cos(phi2) + 0.05 cos(2 phi2) + 0.1 sin(phi2), phi2 being the driven angle; c0 is found,
  # so that the driven gear comes round. With several lobes of the driven gear, phi2 stands for lobes.driven * phi2.
  cosine: [-0.25, 0.05]
  sine: [0.1]
""",
    LawName.SPLINE_RATIO: """\
motion:                    # the law of the gears as a smooth curve; the form in which optimised laws are stored
  law: spline_ratio
  # Ratios dphi1/dphi2 at the driven angles below. A common factor is found, so that the driven gear comes round.
  ratio: [0.82, 0.9, 1.05, 1.2, 1.25, 1.18, 1.0, 0.86]
  # Strictly rising from 0 to under 360, left out: even steps; driven_angle_rad or driven_angle_pi can take its place.
  # With several lobes of the driven gear, they stand for lobes.driven times the driven angle.
  driven_angle_deg: [0, 45, 90, 135, 180, 225, 270, 315]
""",
    LawName.ELLIPSE: """\
motion:                    # equal ellipses, each turning about a focus
  law: ellipse
  eccentricity: 0.3        # 0 (a circle) to under 1
  phase_deg: 0             # driving angle at which the driving radius is smallest
""",
    LawName.TABLE: """\
motion:                    # the law point by point
  law: table
  # Driving angles of one cycle, strictly rising; phi1_rad or phi1_pi can take the place of phi1_deg.
  phi1_deg: [0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330]
  # Transmission ratios dphi1/dphi2; displacement_mm (of the slider, from its retracted end) can take their place.
  ratio: [1.2, 1.1732, 1.1, 1.0, 0.9, 0.8268, 0.8, 0.8268, 0.9, 1.0, 1.1, 1.1732]
  scale_to_close: true     # multiply the ratio by the constant that makes the driven gear come round
  # file: points.csv       # instead of the two lists: a CSV file whose header names the same columns
""",
    LawName.PITCH_CURVE: """\
motion:                    # the pitch curve of the driving gear; its mate follows
  law: pitch_curve
  ellipse:                 # or expression_mm, points, b_spline, dxf, modified_ellipse, rounded_polygon
    semi_major_mm: 23
    semi_minor_mm: 16.44
    axis_x_mm: 4           # the ellipse turns about this point, counted from its centre
    axis_y_mm: -4
  solve_for: scale         # the curve grows to the size of the gears; or center_distance, semi_minor, ...
  # center_distance_mm: 40 # the curve grows to this distance of the axes; teeth or module_mm is then left out below
  # gear: driven           # the driven gear has the curve; left out: the driving gear
""",
    LawName.UNIFORM_CRANK: """\
motion:                    # circular gears, to compare with
  law: uniform_crank
""",
    LawName.SPIRAL: """\
motion:                    # logarithmic spirals: gears that turn to and fro, less than once
  law: spiral
  range_deg: 160           # what the driving gear turns from end to end
  ratio_start: 1.5         # transmission ratio dphi1/dphi2 at the beginning
  ratio_end: 0.8           # and at the end; the pressure angle is the same all the way
""",
    LawName.FUNCTION_GENERATOR: """\
motion:                    # the driving angle is a scale of x, the driven one of y
  law: function_generator
  function: "log(x)"       # y, as a formula of x
  x_from: 1                # x at the beginning
  x_to: 4                  # x at the end
  driving_range_deg: 160   # what the driving gear turns from end to end
  driven_range_deg: 160    # and the driven gear
""",
}
