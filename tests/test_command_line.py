"""The command line: exit status, what goes to which stream, and above all what is said about a wrong design file."""

from __future__ import annotations

import json
import os
import platform
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import ncgear
import ncgear.cli
from at_once import at_once
from commands import Run, changed, environment, fresh
from ncgear.design.laws.registry import LawName
from ncgear.design.reading.design_file import parsed
from ncgear.design.template import template
from ncgear.errors import NoSuchMechanism, WrongInput

STROKE = template("baler")
TABLE = template("points", LawName.TABLE)
PLAIN = "name: a\nlinkage: {crank_mm: 1, rod_mm: 3}\noperation: {speed_rpm: 1}\n"


def spot(text: str, mark: str) -> str:
    """``LINE:COLUMN`` of the only ``mark`` in ``text``."""
    assert text.count(mark) == 1, f"{mark!r} stands {text.count(mark)} times"
    before = text[: text.index(mark)]
    return f"{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}"


# Each row: what the design file holds, the text at which the fault is to be reported (or the LINE:COLUMN itself),
# the key that is to be named, and what is to be said.
ROD = "rod_mm: 960"
BAD: dict[str, tuple[str, str, str, str]] = {
    "empty": ("", "1:1", "", "is empty; a design file is lines of `key: value`"),
    "only a comment": ("# nothing\n", "1:1", "", "is empty"),
    "a list": ("- 1\n- 2\n", "1:1", "", "holds a list"),
    "a word": ("hello\n", "1:1", "", "holds 'hello'"),
    "syntax": (changed(STROKE, ROD, "rod_mm: 960: 1"), "10:14", "", "YAML: a colon stands where no key"),
    "tab": (changed(STROKE, "  " + ROD, "\t" + ROD), "10:1", "", "is not YAML"),
    "unclosed bracket": ("a: [1, 2\n", "2:1", "", "is not YAML"),
    "NUL": ("name: a\nb: \x00\n", "2:4", "", "cannot stand in a text"),
    "half a character": (changed(STROKE, 'description: ""', r'description: "\ud800"'), "6:14", "description", "escape"),
    "escape of a terminal": (
        changed(STROKE, 'description: ""', r'description: "\e[31m"'),
        "6:14",
        "description",
        "'\\x1b'",
    ),
    "no character": (changed(STROKE, 'description: ""', r'description: "\UFEDCBA98"'), "6:12", "", "too large"),
    "beyond the last character": (changed(STROKE, ROD, r'rod_mm: "\U00110000"'), "10:9", "", "too large"),
    "version": ("%YAML 1." + "9" * 5000 + "\n---\nname: a\n", "1:1", "", "too large"),
    "null in a key": (r'"a\0": 1', "1:1", "", "cannot stand in a text"),
    "half a character as key": (r'"\ud800": 1', "1:1", "", "write the character itself"),
    "two documents": (PLAIN + "---\n" + PLAIN, "5:1", "", "a second document begins"),
    "duplicate key": (changed(STROKE, ROD, f"{ROD}\n  rod_mm: 961"), "11:3", "linkage.rod_mm", "first in line 10"),
    "anchor": (changed(STROKE, ROD, "rod_mm: &r 960"), "10:11", "linkage.rod_mm", "&r is an anchor or alias"),
    "alias": (changed(STROKE, ROD, "rod_mm: *r"), "10:11", "linkage.rod_mm", "*r is an anchor or alias"),
    "anchored group": ("a: &a [x]\nb: &b [*a, *a]\n", "1:4", "a", "write the value itself"),
    "tag": (changed(STROKE, ROD, "rod_mm: !!float 960"), "10:11", "linkage.rod_mm", "is a tag"),
    "deep lists": ("a: " + "[" * 100_000, "1:15", "", "nested over 12 levels deep"),
    "deep groups": ("{a: " * 100_000, "1:49", "", "nested over 12 levels deep"),
    "many keys": ("".join(f"k{i}: 1\n" for i in range(1000)), "201:1", "", "over 200 keys in one group"),
    "group as key": ("? [1]\n: 2\n", "1:3", "", "a key is a word"),
    "colon without a space": (changed(STROKE, ROD, "rod_mm:960"), "10:3", "", "the line is 'rod_mm:960'"),
    "no space in brackets": ("linkage: {rod_mm:960}", "1:11", "linkage", "no space follows the colon in 'rod_mm:960'"),
    "open quote": ('name: "a\nmotion: 3\n', "1:7", "", "the line is 'name: \"a'"),
    "empty key": ("linkage: {: 960}", "1:12", "linkage", "the key before a colon is empty"),
    "decimal comma": (
        PLAIN.replace("rod_mm: 3", "rod_mm: 3,5") + "motion: {law: uniform_crank}\n",
        "5}",
        "linkage.5",
        "decimals have a point",
    ),
    "too small for a number": (
        changed(STROKE, ROD, "rod_mm: 1e-400"),
        "rod_mm",
        "linkage.rod_mm",
        "1e-400 given; a fin",
    ),
    "vanishing length": (changed(STROKE, ROD, "rod_mm: 1e-320"), "rod_mm", "linkage.rod_mm", "1e-12 mm or over is"),
    "key given under two names": (
        changed(STROKE, ROD, f"{ROD}\n  rod_m: 1"),
        "rod_m:",
        "linkage.rod_m",
        "rod_mm, which is like it, is given too: keep rod_mm and leave rod_m out",
    ),
    "angle given under two names": (
        changed(STROKE, "theta2_pi: 0.7", "theta2_pi: 0.7\n  theta2_degree: 126"),
        "theta2_degree",
        "motion.theta2_degree",
        "keep theta2_pi and leave theta2_degree out",
    ),
    "key of another group": (
        PLAIN + "motion: {law: uniform_crank}\nteeth: 90\n",
        "teeth:",
        "teeth",
        "unknown key here; teeth stands under gears",
    ),
    "dotted key": (PLAIN + "motion.law: ellipse\n", "motion.law", "motion.law", "law stands under motion"),
    "only key of a group": (
        changed(STROKE, "operation:\n  speed_rpm", "operation:\n  rpm"),
        "rpm: 20            #",
        "operation.rpm",
        "did you mean speed_rpm?",
    ),
    "unknown kind": (
        changed(STROKE, ROD, f"{ROD}\n  kind: crank_roker\n  coupler_mm: 3"),
        "kind: crank_roker",
        "linkage.kind",
        "'crank_roker' given; crank_slider, scotch_yoke, crank_rocker, slotted_lever, rack_pinion or none is needed",
    ),
    "keys of another kind": (
        PLAIN.replace("rod_mm: 3", "coupler_mm: 3, rocker_mm: 2, ground_mm: 3") + "masses: {rocker: {mass_kg: 2}}\n",
        "coupler_mm",
        "linkage.coupler_mm",
        "unknown key of kind crank_slider; kind: crank_rocker has coupler_mm, rocker_mm and ground_mm",
    ),
    "empty linkage": (
        PLAIN.replace("{crank_mm: 1, rod_mm: 3}", "") + "motion: {law: uniform_crank}\n",
        "linkage",
        "linkage",
        "needed: crank_mm, rod_mm",
    ),
    "empty angle": (
        changed(STROKE, "theta2_pi: 0.7", "theta2_pi:"),
        "theta2_pi",
        "motion.theta2_pi",
        "nothing given; one of theta2_rad, theta2_deg or theta2_pi",
    ),
    "empty crank": (
        changed(STROKE, "crank_mm: 380", "crank_mm:"),
        "crank_mm",
        "linkage.crank_mm",
        "nothing given; give it (length of the crank in mm",
    ),
    "empty teeth": (
        changed(STROKE, "teeth: 90 ", "teeth: "),
        "teeth: ",
        "gears.teeth",
        "nothing given; only module_mm",
    ),
    "misspelt key": (
        changed(STROKE, "rod_mm", "rod_m"),
        "rod_m:",
        "linkage.rod_m",
        "unknown key; did you mean rod_mm?",
    ),
    "unknown key": (
        changed(STROKE, ROD, f"{ROD}\n  zzz: 1"),
        "zzz:",
        "linkage.zzz",
        "unknown key; known are crank_mm, rod_mm, offset_mm and kind",
    ),
    "unknown key of a law": (changed(STROKE, "v2_mm_s", "v2_m_s"), "v2_m_s", "motion.v2_m_s", "did you mean v2_mm_s?"),
    "unknown top key": (
        STROKE + "\noutputs: {chord_tolerance_mm: 0.004}\n",
        "outputs:",
        "outputs",
        "did you mean output?",
    ),
    "python name of a key": (changed(STROKE, "  return:", "  return_:"), "return_:", "motion.return_", "mean return?"),
    "missing key": (changed(STROKE, ROD, "# gone"), "linkage:", "linkage.rod_mm", "missing; give it (length of the"),
    "missing top key": (
        changed(STROKE, "operation:\n  speed_rpm: 20", "#"),
        "name: baler ",
        "operation",
        "missing; give it",
    ),
    "missing crank": (
        changed(STROKE, "crank_mm: 380", "# gone"),
        "linkage:",
        "linkage.crank_mm",
        "missing; give it (length of the crank in mm; may be left out only",
    ),
    "text for a number": (
        changed(STROKE, ROD, "rod_mm: long"),
        "rod_mm",
        "linkage.rod_mm",
        "'long' given; a number is",
    ),
    "quoted number": (changed(STROKE, ROD, "rod_mm: '960'"), "rod_mm", "linkage.rod_mm", "'960' given; a number is"),
    "truth for a number": (changed(STROKE, ROD, "rod_mm: true"), "rod_mm", "linkage.rod_mm", "true given; a number is"),
    "date for a number": (changed(STROKE, ROD, "rod_mm: 2001-01-01"), "rod_mm", "linkage.rod_mm", "a number is needed"),
    "blank for a number": (changed(STROKE, ROD, "rod_mm:"), "rod_mm", "linkage.rod_mm", "nothing given; a number is"),
    "list for a number": (changed(STROKE, ROD, "rod_mm: [1]"), "rod_mm", "linkage.rod_mm", "a list given; a number is"),
    "nan": (changed(STROKE, ROD, "rod_mm: .nan"), "rod_mm", "linkage.rod_mm", ".nan given; a finite number is needed"),
    "inf": (
        changed(STROKE, ROD, "rod_mm: -.inf"),
        "rod_mm",
        "linkage.rod_mm",
        "-.inf given; a finite number is needed",
    ),
    "overflow": (changed(STROKE, ROD, "rod_mm: 1e999"), "rod_mm", "linkage.rod_mm", "a finite number is needed"),
    "400 digits": (changed(STROKE, ROD, f"rod_mm: {'9' * 399}"), "rod_mm", "linkage.rod_mm", "finite number is needed"),
    "310 digits": (changed(STROKE, ROD, f"rod_mm: {'7' * 310}"), "rod_mm", "linkage.rod_mm", "777... given; a finite"),
    "5000 digits": (changed(STROKE, ROD, f"rod_mm: {'9' * 5000}"), "rod_mm", "linkage.rod_mm", "number is needed"),
    "negative": (changed(STROKE, ROD, "rod_mm: -960"), "rod_mm", "linkage.rod_mm", "-960 given; a number over 0 is"),
    "number for a group": (
        changed(STROKE, "operation:\n  speed_rpm: 20", "operation: 20\n#"),
        "operation",
        "operation",
        "20 given; a group of keys is needed: speed_rpm",
    ),
    "path as name": (changed(STROKE, "name: baler ", "name: ../x "), "name: ../x", "name", "letters, digits, - and _"),
    "long name": (changed(STROKE, "name: baler ", f"name: {'x' * 65} "), "name: xx", "name", "at most 64"),
    "number as name": (changed(STROKE, "name: baler ", "name: 12 "), "name: 12", "name", "in quotes, if it looks like"),
    "misspelt law": (
        changed(STROKE, "law: three_segment_stroke", "law: three_segments"),
        "law: three",
        "motion.law",
        "did you mean three_segment_stroke?",
    ),
    "unknown law": (
        PLAIN + "motion: {law: 3}\n",
        "law",
        "motion.law",
        "3 is no known law; one of three_segment_stroke",
    ),
    "list as law": (PLAIN + "motion: {law: [a]}\n", "law", "motion.law", "a list is no known law; one of"),
    "no law": (
        PLAIN + "motion: {e: 3}\n",
        "motion",
        "motion.law",
        "missing; give law, one of three_segment_stroke, ratio_ex",
    ),
    "number as motion": (PLAIN + "motion: 3\n", "motion", "motion", "a group of keys with law, one of three_segment"),
    "unknown solve_for": (
        changed(STROKE, "solve_for: v1 ", "solve_for: speed "),
        "solve_for",
        "motion.solve_for",
        "'speed' given; law_speed, v1, v2, a1 or stroke is needed",
    ),
    "solved quantity given": (
        changed(STROKE, "solve_for: v1 ", "solve_for: v2 "),
        "v2_mm_s:",
        "motion.v2_mm_s",
        "leave v2_mm_s out",
    ),
    "needed quantity absent": (
        changed(STROKE, "v2_mm_s: 416.6", "# gone"),
        "motion:",
        "motion.v2_mm_s",
        "missing; give it: solve_for: v1 needs law_speed_rpm, v2_mm_s and a1_mm_s2",
    ),
    "angle twice": (
        changed(STROKE, "theta2_pi: 0.7", "theta2_pi: 0.7\n  theta2_deg: 126"),
        "theta2_pi",
        "motion.theta2_pi",
        "keep one",
    ),
    "angle absent": (changed(STROKE, "theta2_pi: 0.7", ""), "motion:", "motion", "theta2_rad, theta2_deg or theta2_pi"),
    "angle of zero": (changed(STROKE, "theta1_pi: 0.4", "theta1_pi: 0"), "theta1_pi", "motion.theta1_pi", "be over 0"),
    "angles fall": (
        changed(STROKE, "theta2_pi: 0.7", "theta2_deg: 9"),
        "theta2_deg",
        "motion.theta2_deg",
        "over theta1",
    ),
    "theta3 low": (
        changed(STROKE, "theta3_pi: 1.0", "theta3_pi: .69"),
        "theta3_pi",
        "motion.theta3_pi",
        "theta2 or over",
    ),
    "full turn": (changed(STROKE, "theta4_pi: 1.3", "theta4_deg: 360"), "theta4_deg", "motion.theta4_deg", "and 2 pi"),
    "word for e": (
        changed(STROKE, "e: least_acceleration", "e: least"),
        "e: least ",
        "motion.return.e",
        "'least' given; a finite number or the word least_acceleration is needed",
    ),
    "nan for e": (changed(STROKE, "e: least_acceleration", "e: .nan"), "e: .nan", "motion.return.e", ".nan given"),
    "truth for e": (changed(STROKE, "e: least_acceleration", "e: true"), "e: true", "motion.return.e", "true given"),
    "two formulas": (
        PLAIN + "motion: {law: ratio_expression, ratio: '1', driven_angle: phi}\n",
        "driven_angle",
        "motion.driven_angle",
        "ratio and driven_angle are given",
    ),
    "scaled angle": (
        PLAIN + "motion: {law: ratio_expression, driven_angle: phi, scale_to_close: true}\n",
        "scale_to_close",
        "motion.scale_to_close",
        "there is no ratio to scale",
    ),
    "eccentricity of 1": (
        PLAIN + "motion: {law: ellipse, eccentricity: 1}\n",
        "eccentricity",
        "motion.eccentricity",
        "a number under 1 is needed",
    ),
    "half a tooth": (changed(STROKE, "teeth: 90 ", "teeth: 90.5 "), "teeth: 90.5", "gears.teeth", "a whole number is"),
    "two teeth": (changed(STROKE, "teeth: 90 ", "teeth: 2 "), "teeth: 2 ", "gears.teeth", "a number of 3 or over is"),
    "one size": (changed(STROKE, "teeth: 90 ", "# "), "gears:", "gears", "only module_mm is given; two of teeth"),
    "profile": (changed(STROKE, "profile: A ", "profile: E "), "profile: E", "gears.rack.profile", "A, B, C or D is"),
    "pressure angle": (
        changed(STROKE, "pressure_angle_deg: 20", "pressure_angle_deg: 40"),
        "pressure_angle_deg: 40",
        "gears.rack.pressure_angle_deg",
        "under 40",
    ),
    "wide keyway": (
        changed(STROKE, "width_mm: 4,", "width_mm: 12,"),
        "width_mm: 12,",
        "gears.driving.keyway.width_mm",
        "under 12 mm is right",
    ),
    "keyway without bore": (changed(STROKE, "    bore_mm: 12\n", ""), "keyway", "gears.driving.keyway", "without bore"),
    "lobes": (changed(STROKE, "driven: 1}", "driven: 2}"), "driven: 2", "gears.lobes.driven", "1 is right"),
    "coefficient": (
        changed(STROKE, "[-131.2779, 3.447", "[-131.2779, x"),
        "x, 1.846e-2",
        "resistance.polynomial_n.1",
        "'x' given; a number is needed",
    ),
    "no figure": (
        PLAIN + "motion: {law: uniform_crank}\ncomparison:\n  published:\n    - {name: x, speed_rpm: 1}\n",
        "{name",
        "comparison.published.0",
        "give at least one of peak_power_w",
    ),
    "quoted power alone": (
        PLAIN + "motion: {law: uniform_crank}\ncomparison:\n  published:\n"
        "    - {name: x, speed_rpm: 1, peak_power_w: 2, quoted_power_w: 3}\n",
        "quoted_power_w",
        "comparison.published.0.quoted_power_w",
        "given without quoted_speed_rpm",
    ),
    "tolerance": (
        changed(PLAIN, "speed_rpm: 1}", "speed_rpm: 1}\nmotion: {law: uniform_crank}\noutput: {chord_tolerance_mm: 0}"),
        "chord_tolerance_mm",
        "output.chord_tolerance_mm",
        "a number over 0",
    ),
    "table falls": (changed(TABLE, "[0, 30, 60", "[0, 60, 59"), "59,", "motion.phi1_deg.2", "59 follows 60"),
    "table over a turn": (changed(TABLE, "330]", "361]"), "361]", "motion.phi1_deg.11", "361 is outside the cycle"),
    "table uneven": (
        changed(TABLE, "[0, 30, 60", "[0, 60"),
        "ratio: [",
        "motion.ratio",
        "12 values, but phi1_deg has 11",
    ),
    "table of a word": (changed(TABLE, "330]", "no]"), "no]", "motion.phi1_deg.11", "'no' given; a number is needed"),
    "table with nan": (changed(TABLE, "330]", ".nan]"), ".nan]", "motion.phi1_deg.11", "a finite number is needed"),
    "table too short": (
        PLAIN + "motion: {law: table, phi1_deg: [0, 1], ratio: [1, 1]}\n",
        "phi1_deg",
        "motion.phi1_deg",
        "a list of 2 given; a list of at least 4 items is needed",
    ),
    "table without file": (
        PLAIN + "motion: {law: table, file: no.csv}\n",
        "file",
        "motion.file",
        "no.csv cannot be read",
    ),
}


@pytest.mark.tiers(
    thorough=["check-u*", "check-t*", "check-a*"],
    slow=[
        "check-*",
        "build-deep*",
        "build-colon without a space",
        "build-no space in brackets",
        "build-open quote",
        "build-empty key",
        "build-decimal comma",
        "build-too small for a number",
        "build-vanishing length",
        "build-angle given under two names",
        "build-key of another group",
        "build-dotted key",
        "build-only key of a group",
        "build-keys of another kind",
        "build-empty linkage",
        "build-empty angle",
        "build-empty crank",
        "build-empty teeth",
        "build-only a comment",
        "build-a word",
        "build-tab",
        "build-NUL",
        "build-escape of a terminal",
        "build-beyond the last character",
        "build-null in a key",
        "build-two documents",
        "build-anchor",
        "build-anchored group",
        "build-group as key",
        "build-unknown key",
        "build-unknown top key",
        "build-missing key",
        "build-missing crank",
        "build-quoted number",
        "build-date for a number",
        "build-list for a number",
        "build-inf",
        "build-400 digits",
        "build-5000 digits",
        "build-path as name",
        "build-number as name",
        "build-unknown law",
        "build-no law",
        "build-unknown solve_for",
        "build-needed quantity absent",
        "build-angle absent",
        "build-angles fall",
        "build-full turn",
        "build-nan for e",
        "build-two formulas",
        "build-eccentricity of 1",
        "build-two teeth",
        "build-profile",
        "build-wide keyway",
        "build-lobes",
        "build-no figure",
        "build-tolerance",
        "build-table over a turn",
        "build-table of a word",
        "build-table too short",
    ],
    rest="long",
)
@pytest.mark.parametrize(("text", "where", "key", "said"), BAD.values(), ids=BAD.keys())
@pytest.mark.parametrize("command", ["check", "build"])
def test_wrong_design_file(run: Run, tmp_path: Path, command: str, text: str, where: str, key: str, said: str) -> None:
    Path(tmp_path, "d.yaml").write_text(text, encoding="utf-8")
    place = where if where.replace(":", "").isdigit() else spot(text, where)
    status, out, err = run(command, "d.yaml")
    assert (status, out) == (2, "")
    assert err.startswith(f"d.yaml:{place}: {key + ': ' if key else ''}")
    assert said in err.splitlines()[0]
    assert "Traceback" not in err
    assert os.listdir(tmp_path) == ["d.yaml"]


def test_faults_come_in_file_order_up_to_ten(run: Run, tmp_path: Path) -> None:
    lines = "".join(f"k{i}: 1\n" for i in range(30))
    Path(tmp_path, "d.yaml").write_text(PLAIN + lines + "motion: {law: uniform_crank}\n")
    status, _, err = run("check", "d.yaml")
    assert status == 2
    starts = [line.split(" ")[0] for line in err.splitlines()[:10]]
    assert starts == [f"d.yaml:{4 + i}:1:" for i in range(10)]
    assert err.splitlines()[10:] == ["and 20 more"]


SLIPS = ["misspelt key", "only key of a group", "unknown kind", "keys of another kind", "empty angle", "empty key"]


@at_once("name", SLIPS)
def test_one_slip_is_told_once(name: str) -> None:
    with pytest.raises(WrongInput) as refused:
        parsed(BAD[name][0], Path("d.yaml"))
    assert str(refused.value).count("\n") == 0


def test_a_law_beside_its_group_is_one_slip() -> None:
    with pytest.raises(WrongInput, match=r"^d\.yaml:4:1: law: unknown key here; law stands under motion$"):
        parsed(PLAIN + "law: ellipse\n", Path("d.yaml"))


def test_file_missing(run: Run) -> None:
    status, out, err = run("check", "no.yaml")
    assert (status, out) == (2, "")
    assert err.startswith("no.yaml: cannot be read: No such file or directory; give an existing")


def test_file_is_a_folder(run: Run, tmp_path: Path) -> None:
    Path(tmp_path, "d.yaml").mkdir()
    status, _, err = run("check", "d.yaml")
    assert (status, err) == (2, "d.yaml: is a folder; give a file\n")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with a name")
def test_file_is_a_pipe(run: Run, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "d.yaml")
    status, _, err = run("check", "d.yaml")
    assert (status, err) == (2, "d.yaml: is no regular file; give one on disk\n")


@pytest.mark.skipif(getattr(os, "geteuid", lambda: 0)() == 0, reason="root may read every file")
def test_file_unreadable(run: Run, tmp_path: Path) -> None:
    Path(tmp_path, "d.yaml").write_text(STROKE)
    Path(tmp_path, "d.yaml").chmod(0)
    status, _, err = run("check", "d.yaml")
    assert status == 2
    assert err.startswith("d.yaml: cannot be read: Permission denied")


def test_file_of_100_mb_is_not_read(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Path(tmp_path, "d.yaml").open("wb") as file:
        file.truncate(100_000_000)
    monkeypatch.setattr(Path, "read_bytes", lambda path: pytest.fail("the file was read"))
    status, _, err = run("check", "d.yaml")
    assert (status, err) == (2, "d.yaml: holds 100.0 MB; at most 5 MB is right\n")


def test_file_is_not_utf8(run: Run, tmp_path: Path) -> None:
    Path(tmp_path, "d.yaml").write_bytes(b"name: a\nb: \xfcber\n")
    status, _, err = run("check", "d.yaml")
    assert (status, err) == (2, "d.yaml:2:4: byte 0xfc is not UTF-8 text; save the file as UTF-8\n")


def test_build_needs_gears_and_says_so_before_computing(run: Run, tmp_path: Path) -> None:
    Path(tmp_path, "d.yaml").write_text(PLAIN + "motion: {law: uniform_crank}\n")
    status, out, err = run("build", "d.yaml")
    assert (status, out) == (2, "")
    assert err.startswith("d.yaml:1:1: gears: missing; a build needs it")


@pytest.mark.thorough
def test_output_folder_is_a_file(run: Run, tmp_path: Path) -> None:
    Path(tmp_path, "d.yaml").write_text(STROKE)
    Path(tmp_path, "taken").write_text("")
    for out_folder in ("taken", "taken/below"):
        status, out, err = run("build", "d.yaml", "--out", out_folder)
        assert (status, out) == (2, "")
        assert "taken: is no folder; choose another folder with --out" in err


@pytest.mark.thorough
def test_new_writes_a_design_that_loads_and_does_not_overwrite(run: Run, tmp_path: Path) -> None:
    from ncgear.design.reading.design_file import load

    assert run("new", "mine", "--law", "ellipse") == (0, "mine.yaml\n", "")
    assert load(Path("mine.yaml")).design.motion.law == "ellipse"
    Path(tmp_path, "mine.yaml").write_text("precious")
    status, out, err = run("new", "mine")
    assert (status, out, err) == (2, "", "mine.yaml: exists already; choose another name, or remove it\n")
    assert Path(tmp_path, "mine.yaml").read_text() == "precious"


@pytest.mark.parametrize("name", ["../x", "a.yaml", "", "x" * 65, "a b", "é", "a\n"])
def test_new_refuses_names_that_are_no_names(run: Run, tmp_path: Path, name: str) -> None:
    status, out, err = run("new", name)
    assert (status, out) == (2, "")
    assert "letters, digits, - and _, at most 64 of them" in err
    assert os.listdir(tmp_path) == []


@pytest.mark.slow
def test_schema_is_json_on_stdout(run: Run) -> None:
    status, out, err = run("schema")
    assert (status, err) == (0, "")
    assert json.loads(out)["$schema"].startswith("https://json-schema.org/")


def test_version(run: Run) -> None:
    """And of the libraries, as a report of a fault needs them."""
    status, out, err = run("--version")
    assert (status, err) == (0, "")
    assert out.startswith(f"ncgear {ncgear.__version__}, Python {platform.python_version()}")
    assert f"numpy {np.__version__}," in out


@at_once("arguments", [["nonsense"], ["check"], ["check", "--no"], ["new", "a", "--law", "circle"]])
def test_usage_errors(run: Run, arguments: list[str]) -> None:
    status, out, err = run(*arguments)
    assert (status, out) == (2, "")
    assert "Usage:" in err
    assert "Traceback" not in err


def failing(error: BaseException) -> Callable[..., None]:
    """A stand-in for loading that raises ``error``."""

    def load(path: Path, *, for_loads: bool) -> None:
        raise error

    return load


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (NoSuchMechanism("no stroke", key="motion", location="d.yaml:1:1"), 3, "d.yaml:1:1: motion: no stroke\n"),
        (PermissionError(13, "Permission denied", "out"), 2, "out: Permission denied; give a path that can be read"),
        (OSError(28, "No space left on device"), 2, "No space left on device"),
        (
            ZeroDivisionError("by\nzero"),
            1,
            "ncgear: internal fault: ZeroDivisionError: by zero; please report it with what ncgear --version says; "
            "NCGEAR_DEBUG=1 shows where it arose\n",
        ),
        (
            RecursionError("too deep"),
            1,
            "ncgear: internal fault: RecursionError: too deep; please report it with what ncgear --version says; "
            "NCGEAR_DEBUG=1 shows where it arose\n",
        ),
        (
            ImportError("libGL.so.1: cannot open shared object file: No such file or directory"),
            2,
            "libGL.so.1: cannot open shared object file: No such file or directory; install what it needs",
        ),
        (ImportError("cannot import name 'a' from 'b'"), 1, "ncgear: internal fault: ImportError: cannot import name"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_exit_status(run: Run, monkeypatch: pytest.MonkeyPatch, error: BaseException, status: int, said: str) -> None:
    monkeypatch.setattr("ncgear.design.reading.design_file.load", failing(error))
    got, out, err = run("check", "d.yaml")
    assert (got, out) == (status, "")
    assert err.startswith(said)
    assert "Traceback" not in err


def test_later_errors_get_the_place_of_their_key(run: Run, tmp_path: Path) -> None:
    """A law names a quantity; the user reads the key as it is written in the file, and where."""
    text = changed(STROKE, "a1_mm_s2: -1500", "a1_mm_s2: 1500")
    Path(tmp_path, "d.yaml").write_text(text)
    status, out, err = run("check", "d.yaml")
    assert (status, out) == (3, "")
    assert err.startswith(f"d.yaml:{spot(text, 'a1_mm_s2')}: motion.a1_mm_s2: ")


def test_traceback_of_a_fault_on_demand(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ncgear.design.reading.design_file.load", failing(ZeroDivisionError("by zero")))
    monkeypatch.setenv("NCGEAR_DEBUG", "1")
    status, out, err = run("check", "d.yaml")
    assert (status, out) == (1, "")
    assert "Traceback" in err
    assert err.endswith(
        "ncgear: internal fault: ZeroDivisionError: by zero; please report it with what ncgear --version says; "
        "NCGEAR_DEBUG=1 shows where it arose\n"
    )


@pytest.mark.slow
def test_in_a_process_of_its_own(tmp_path: Path) -> None:
    assert fresh("new", "mine", folder=tmp_path).returncode == 0
    Path(tmp_path, "mine.yaml").write_text(changed(template("mine"), "rod_mm", "rod_m"))
    done = fresh("check", "mine.yaml", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "mine.yaml:10:3: linkage.rod_m: unknown key; did you mean rod_mm?\n"


@pytest.mark.slow
def test_help_names_every_command(tmp_path: Path) -> None:
    done = fresh("--help", folder=tmp_path)
    assert done.returncode == 0
    commands = "build", "check", "simulate", "sweep", "new", "schema"
    assert all(f"  {command} " in done.stdout for command in commands)


def in_shell(redirected: str, folder: Path) -> tuple[int, str]:
    """Exit status and stderr of a command line in bash; ``ncgear`` runs the package of this checkout."""
    line = f'ncgear() {{ "{sys.executable}" -m ncgear "$@"; }}; {redirected}'
    done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, cwd=folder, env=environment())
    return done.returncode, done.stderr


@pytest.mark.tiers(
    slow=["ncgear check missing.yaml 2>&--2", "ncgear check right.yaml --timing 2>/dev/full-2"], rest="long"
)
@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("ncgear check right.yaml 2>&-", 0),
        ("ncgear check right.yaml <&- >&- 2>&-", 0),
        ("ncgear check missing.yaml 2>&-", 2),
        ("ncgear check missing.yaml 2>/dev/full", 2),
        ("ncgear check --unknown right.yaml 2>/dev/full", 2),
        ("ncgear check impossible.yaml 2>/dev/full", 3),
        ("ncgear check right.yaml --timing 2>/dev/full", 2),
        ("ncgear check right.yaml >/dev/full", 2),
        ("ncgear check right.yaml | true; exit ${PIPESTATUS[0]}", 141),
    ],
)
def test_streams_that_take_nothing_do_not_change_what_a_status_means(tmp_path: Path, line: str, status: int) -> None:
    (tmp_path / "right.yaml").write_text(template("right"))
    (tmp_path / "impossible.yaml").write_text(changed(template("a"), "a1_mm_s2: -1500", "a1_mm_s2: 1700"))
    assert in_shell(line, tmp_path)[0] == status


@pytest.mark.thorough
def test_a_file_does_not_get_the_number_of_a_closed_stream(tmp_path: Path) -> None:
    """Whatever opens a file first after the start, here the design file, would otherwise take number 2."""
    code = "from ncgear.cli.run import open_streams; open_streams(); print(open('right.yaml').fileno() > 2)"
    (tmp_path / "right.yaml").write_text("")
    shell = f'"{sys.executable}" -c "{code}" 2>&- <&-'
    done = subprocess.run(["bash", "-c", shell], capture_output=True, text=True, cwd=tmp_path, env=environment())
    assert done.stdout == "True\n"


def test_a_command_that_is_printed_can_be_pasted(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the path: the shell takes the words of the line apart into the command and the file."""
    monkeypatch.chdir(tmp_path)
    file = Path("my gears & more", "a pusher.yaml")
    file.parent.mkdir()
    file.write_text(TABLE, encoding="utf-8")
    _, told, _ = run("check", str(file))
    (line,) = (line for line in told.splitlines() if line.startswith("Next: "))
    assert shlex.split(line.removeprefix("Next: ").partition(";")[0]) == ["ncgear", "build", str(file)]
