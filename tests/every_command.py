"""What ``every_output.py`` asks of ncgear: all commands on all designs, and a great many files that are wrong."""

from __future__ import annotations

import json
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

ROOT = Path(__file__).parents[1]
DESIGNS = {
    path.stem: path
    for path in sorted((ROOT / "designs").glob("*.yaml"))
    if "\ntrain:" not in path.read_text(encoding="utf-8")
}
BALANCES = {path.stem: path for path in sorted((ROOT / "designs" / "balance").glob("*.yaml"))}
CASES = {path.stem: path for path in sorted((ROOT / "tests" / "cases").glob("*.yaml"))}

COMMANDS = (
    "build report animate check compare formulas simulate strength tolerance size design optimize frontier fit sweep "
    "measured bench balance new explain reproduce schema"
)
LAWS = (
    "three_segment_stroke", "ratio_expression", "harmonic_ratio", "spline_ratio", "ellipse", "table", "pitch_curve",
    "uniform_crank",
)  # fmt: skip
SIZES = {"stroke": 80, "crank": 40, "rod": 150, "speed": 50, "teeth": 30, "module": 2, "face-width": 9}
UNITS = {"stroke": "-mm", "crank": "-mm", "rod": "-mm", "speed": "-rpm", "module": "-mm", "face-width": "-mm"}

STEP = "ellipse", "printed-pump", "internal-1-2"
QUICK_BUILDS = "baler", "printed-pump", "internal-1-2"
ANIMATED = "ellipse", "internal-1-2", "baler-frontier"
SIZED = "pusher", "baler-half-dynamics"
FRONTIERS = "baler-frontier", "printed-pump"
TOLERATED = "ellipse", "internal-1-2", "desk-toy", "baler-drivetrain"
SWEPT = "baler", "ellipse", "feeder-table", "internal-1-2", "baler-66-two-stage", "pusher"
AS_JSON = """
build designs/printed-pump.yaml --format svg | build designs/baler-66-two-stage.yaml --format svg
report designs/printed-pump.yaml | simulate designs/baler-dynamics.yaml | strength designs/printed-pump.yaml
tolerance designs/ellipse.yaml --samples 256 | size designs/pusher.yaml | optimize designs/pusher.yaml | reproduce
sweep designs/pusher.yaml --vary linkage.rod_mm=50:400:4
"""
"""Commands whose figures are also printed for programs, as those of checks and of balances are."""
VARIED = "baler-dynamics", "printed-pump", "internal-1-2", "feeder-table", "helical-ellipse", "baler-half"
VARIED_GEARS = "printed-pump", "helical-ellipse"
"""Designs of which each key of the gears is also changed for a build."""


SOUND = "twice", "half"
"""Changes that mostly give another design, whose check takes longer than a refusal."""


@dataclass(frozen=True)
class Run:
    """One use of the command line, in a folder that holds ``designs`` and the files of ``texts``.

    Runs that are ``together`` (all that say the same word) share interpreters; the others have one each.
    """

    name: str
    arguments: tuple[str, ...]
    texts: dict[str, str] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)
    together: str = ""
    quick: bool = False


def all_runs(keys: dict[str, list[str]]) -> Iterator[Run]:
    """Everything, what takes long first; ``keys`` are those that ``explain`` knows, by kind of file."""
    yield from _long_work()
    yield from _designs()
    yield from _balances()
    yield from _new_files()
    yield from _words(keys)
    yield from _wrong_use()
    yield from _wrong_texts()
    yield from _varied_files()


def _place(path: Path) -> str:
    return str(path.relative_to(ROOT))


def _long_work() -> Iterator[Run]:
    for name in FRONTIERS:
        yield Run(f"frontier/{name}", ("frontier", _place(DESIGNS[name]), "--points", "2"))
    for name, path in reversed(DESIGNS.items()):
        yield Run(f"optimize/{name}", ("optimize", _place(path)))
    for name in STEP:
        yield Run(f"step/{name}", ("build", _place(DESIGNS[name]), "--format", "step", "--out", "made"))
    yield Run("reproduce", ("reproduce",))


def _designs() -> Iterator[Run]:
    for name, path in DESIGNS.items():
        place = _place(path)
        yield Run(f"build/{name}", ("build", place, "--report"), quick=name in QUICK_BUILDS)
        yield Run(f"report/{name}", ("report", place, "--out", "page"))
        moving = "" if "masses:" in path.read_text(encoding="utf-8") else "simulate"
        for level in ("rigid", "quasi_static", "dynamic"):
            yield Run(f"simulate/{name}/{level}", ("simulate", place, "--level", level), together=moving)
        for option in ((), ("--verbose",)):
            of = "".join(option).removeprefix("--")
            words = "strength", place, *option
            yield Run(f"strength/{name}/{of or 'screen'}", words, together="strength", quick=name in QUICK_BUILDS)
        yield Run(f"check/{name}", ("check", place), together="check", quick=True)
        yield Run(f"check/{name}/verbose", ("check", place, "--verbose"), together="check", quick=True)
        yield Run(f"check/{name}/json", ("check", place, "--json"), together="check", quick=True)
    for name in TOLERATED:
        few = "--samples", "256"
        yield Run(f"tolerance/{name}", ("tolerance", _place(DESIGNS[name]), *few), together="tolerance")
        yield Run(
            f"tolerance/{name}/verbose", ("tolerance", _place(DESIGNS[name]), *few, "--verbose"), together="tolerance"
        )
    yield Run("check/alone", ("check", "designs/baler.yaml", "--timing"), quick=True)
    for name in SIZED:
        yield Run(f"size/{name}", ("size", _place(DESIGNS[name]), "--out", "sized.yaml"))
    for name in ANIMATED:
        small = "--frames", "6", "--width", "320"
        yield Run(f"animate/{name}", ("animate", _place(DESIGNS[name]), *small))
    yield Run("animate/mp4", ("animate", "designs/ellipse.yaml", *small, "--out", "loop.mp4"))
    for name in SWEPT:
        rod = YAML(typ="safe").load(DESIGNS[name])["linkage"]["rod_mm"]
        vary = "--vary", f"linkage.rod_mm={rod / 4}:{rod * 2}:4", "--vary", "operation.speed_rpm=10:40:2"
        yield Run(f"sweep/{name}", ("sweep", _place(DESIGNS[name]), *vary))
    for words in _lines(AS_JSON):
        yield Run(f"json/{'-'.join(Path(word).stem for word in words[:2])}", (*words, "--json"))
    for name, path in CASES.items():
        file = {f"{name}.yaml": path.read_text(encoding="utf-8")}
        yield Run(f"case/{name}/check", ("check", f"{name}.yaml"), file, together="check", quick=True)
        yield Run(f"case/{name}/build", ("build", f"{name}.yaml"), file, together="build")


def _balances() -> Iterator[Run]:
    for name, path in BALANCES.items():
        quick = name == "threshing-drum"
        yield Run(f"balance/{name}", ("balance", _place(path)), quick=quick)
        yield Run(f"balance/{name}/verbose", ("balance", _place(path), "--verbose"), together="balance", quick=quick)
        yield Run(f"balance/{name}/json", ("balance", _place(path), "--json"), together="balance", quick=quick)


def _new_files() -> Iterator[Run]:
    def new(name: str, *options: str, quick: bool = False) -> Run:
        return Run(f"new/{name}", ("new", "mine", *options), together="new", quick=quick)

    sizes = {f"--{size}{UNITS.get(size, '')}": str(value) for size, value in SIZES.items()}
    every = [word for option in sizes.items() if option[0] != "--crank-mm" for word in option]
    for law in LAWS:
        yield new(law, "--law", law, quick=True)
        yield new(f"{law}-sized", "--law", law, *every, "--yes")
    for option, value in sizes.items():
        yield new(f"given{option}", option, value)
        for wrong in ("0", "-1", "nan", "1e300", "much", ""):
            yield new(f"wrong{option}-{wrong}", option, wrong, quick=wrong != "1e300")
    yield new("two-lengths", "--stroke-mm", "80", "--crank-mm", "50", quick=True)
    yield new("short-rod", "--crank-mm", "50", "--rod-mm", "40", quick=True)
    yield Run("new/taken", ("new", "mine"), {"mine.yaml": "name: mine\n"}, quick=True)
    for number, name in enumerate(("../x", "a.yaml", "", "x" * 65, "a b", "é", "a\n")):
        yield Run(f"new/name-{number}", ("new", name), together="new", quick=True)


def _words(keys: dict[str, list[str]]) -> Iterator[Run]:
    """What is only read: help, keys, schemas, versions, and what the shell is offered."""
    yield Run("help/ncgear", ("--help",), quick=True)
    yield Run("help/version", ("--version",), quick=True)
    for command in COMMANDS.split():
        yield Run(f"help/{command}", (command, "--help"), together="words", quick=True)
    for kind, known in keys.items():
        yield Run(f"schema/{kind}", ("schema", "--of", kind), together="words", quick=True)
        for key in ("", *known):
            asked = ("explain", *([key] if key else []), "--of", kind)
            yield Run(f"explain/{kind}/{key or 'all'}", asked, together="words", quick=not key)
    for number, typed in enumerate(TYPED.split("|")):
        yield Run(f"offered/{number}", (), {}, completing(f"ncgear {typed}"), together="words", quick=True)
    for shell in ("bash", "zsh", "fish"):
        yield Run(f"offered/{shell}", (), {}, {"_NCGEAR_COMPLETE": f"source_{shell}"}, together="words", quick=True)


TYPED = (
    "|expl|check |check designs/|explain |explain gears.|explain --of balance |new x --law |build --"
    "|simulate x --level |schema --of "
)


def completing(typed: str) -> dict[str, str]:
    """What bash sets to learn what may follow ``typed``."""
    words = {"COMP_WORDS": typed, "COMP_CWORD": str(len(typed.split(" ")) - 1)}
    return {"_NCGEAR_COMPLETE": "complete_bash", **words}


WRONG_USE = """
nonsense | check | check --no | check none.yaml | build none.yaml | check designs | report none.yaml | balance none.yaml
check designs/balance/baler.yaml | balance designs/baler.yaml | build designs/ellipse.yaml --format pdf | build --out
build designs/ellipse.yaml --out designs/baler.yaml | report designs/ellipse.yaml --out designs/baler.yaml/x
animate designs/ellipse.yaml --frames 1 | animate designs/ellipse.yaml --width 20 | animate none.yaml --out a.b
animate designs/ellipse.yaml --seconds nan | frontier designs/ellipse.yaml
frontier designs/ellipse.yaml --points 1 | simulate designs/ellipse.yaml --level hard | sweep designs/pusher.yaml
sweep designs/pusher.yaml --vary motion.theta9_pi=1:2:3 | sweep designs/pusher.yaml --vary gears.teeth
sweep designs/pusher.yaml --vary gears.teeth=9:3:x | sweep designs/pusher.yaml --vary name=1:2:3
sweep designs/pusher.yaml --vary linkage.rod_mm=1:2:0 | sweep designs/pusher.yaml --vary linkage.rod_mm=1:2:99999999
optimize none.yaml | explain teeht | explain zzz | explain --of none | schema --of none | bench none.yaml
reproduce --out designs/baler.yaml | new | new a --law circle | new a --teeth 2.5 | new a b | check designs/baler.yaml x
"""


def _lines(text: str) -> list[tuple[str, ...]]:
    """The words of each command of a text, which stand on lines of their own or between bars."""
    return [words for line in text.replace("\n", "|").split("|") if (words := tuple(line.split()))]


def _wrong_use() -> Iterator[Run]:
    for words in _lines(WRONG_USE):
        name = f"wrong-use/{' '.join(words).replace('/', ':')}"
        yield Run(name, words, together="wrong use", quick=True)
    yield Run("wrong-use/nothing", (), quick=True)
    yield Run("wrong-use/missing", ("check", "none.yaml"), quick=True)


INSIDE = {
    "doubled-key": "crank_mm: 380, rod_mm: 960, crank_mm: 380}",
    "colon": "crank_mm: 380: 1, rod_mm: 960}",
    "open-bracket": "crank_mm: 380, rod_mm: 960",
    "open-quote": "crank_mm: '380, rod_mm: 960}",
    "anchor": "crank_mm: &a 380, rod_mm: *a}",
    "alias-of-none": "crank_mm: 380, rod_mm: *a}",
    "merge": "<<: {crank_mm: 380}, rod_mm: 960}",
    "tag": "crank_mm: !!float 380, rod_mm: 960}",
    "infinite": "crank_mm: .inf, rod_mm: .nan}",
    "long": f"crank_mm: {'9' * 999}, rod_mm: 1e999}}",
    "words": "crank_mm: yes, rod_mm: 2001-01-01}",
    "escape": 'crank_mm: "\\e[31m", rod_mm: 960}',
}


def _wrong_texts() -> Iterator[Run]:
    """Files that are no YAML, or none that is read: broken texts, doubled keys, tabs, anchors, control characters."""
    baler = DESIGNS["baler"].read_text(encoding="utf-8")
    line = "linkage: {crank_mm: 380, rod_mm: 960}\n"
    replaced = {
        "doubled-group": line * 2,
        "tab": "linkage:\n\tcrank_mm: 380\n\trod_mm: 960\n",
        "deep": f"linkage: {'[' * 99}{']' * 99}\n",
        "list": "linkage: [380, 960]\n",
        "null": "linkage:\n",
        "python-tag": "linkage: !!python/object:os.system {crank_mm: 380}\n",
        "thirty-more": line + "".join(f"k{number}: 1\n" for number in range(30)),
    } | {name: f"linkage: {{{inside}\n" for name, inside in INSIDE.items()}
    texts = {name: baler.replace(line, text) for name, text in replaced.items()}
    texts |= {"empty": "", "comment": "# nothing\n", "a-list": "- 1\n", "a-word": "hello\n", "nul": "a: \x00\n"}
    texts |= {"two": f"{baler}---\n{baler}", "flow": "{a: [1, 2\n", "group-as-key": "? [1]\n: 2\n"}
    texts |= {"byte-order-mark": f"\ufeff{baler}"}
    for name, text in texts.items():
        for command in ("check", "build", "report", "balance"):
            if command == "check" or name != "byte-order-mark":
                words = command, "d.yaml"
                yield Run(f"wrong-text/{name}/{command}", words, {"d.yaml": text}, together="wrong text", quick=True)


def _varied_files() -> Iterator[Run]:
    seen: set[str] = set()
    built: set[str] = set()
    for name in VARIED:
        for what, text in variations(DESIGNS[name]):
            file = {"designs/d.yaml": text}
            checked, quick = ("check", "designs/d.yaml"), what not in seen and not what.endswith(SOUND)
            yield Run(f"varied/{name}/{what}/check", checked, file, together="varied", quick=quick)
            seen.add(what)
            if name in VARIED_GEARS and what.startswith("gears") and what not in built:
                # All that a build can be refused for comes before its files; these are few, to be quick.
                made = "build", "designs/d.yaml", "--format", "svg"
                yield Run(f"varied/{name}/{what}/build", made, file, together="varied build")
                built.add(what)
    for name, path in BALANCES.items():
        for what, text in variations(path):
            words = "balance", "designs/balance/d.yaml"
            file = {words[1]: text}
            yield Run(f"varied-balance/{name}/{what}", words, file, together="varied balance")


def variations(path: Path) -> Iterator[tuple[str, str]]:
    """The text of a file with one key gone, misspelt beside itself, of a wrong type, or of another size."""
    whole = YAML(typ="safe").load(path)
    for keys in _paths(whole):
        label = ".".join(map(str, keys))
        for what in ("gone", "unknown", "type", "negative", "zero", "huge", *SOUND):
            changed = deepcopy(whole)
            holder = changed
            for key in keys[:-1]:
                holder = holder[key]
            if _vary(holder, keys[-1], what):
                yield f"{label}-{what}", _yaml(changed)


def _paths(value: Any, before: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """All keys, groups before what is in them; of a list the first item."""
    inner = value.items() if isinstance(value, dict) else enumerate(value[:1]) if isinstance(value, list) else ()
    for key, below in inner:
        yield (*before, key)
        yield from _paths(below, (*before, key))


def _vary(holder: Any, key: Any, what: str) -> bool:
    """Make the change in place; False where there is no such change of this key."""
    value = holder[key]
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if what == "gone":
        del holder[key]
    elif what == "unknown" and isinstance(holder, dict):
        holder[f"{key}x"] = value
    elif what == "type":
        holder[key] = 7 if isinstance(value, str | dict) else "word"
    elif number and what in (sizes := _other_sizes(value)):
        holder[key] = sizes[what]
    else:
        return False
    return True


def _other_sizes(value: float) -> dict[str, float]:
    huge = 10**9 if isinstance(value, int) else 1e300
    half = value // 2 if isinstance(value, int) else value / 2
    return {"negative": -abs(value) or -1, "zero": 0, "huge": huge, "twice": 2 * value, "half": half}


def _yaml(data: dict[str, Any], margin: str = "") -> str:
    """Groups line by line, other values each on one."""
    lines = []
    for key, value in data.items():
        group = isinstance(value, dict) and value
        lines.append(f"{margin}{key}:" + ("" if group else f" {json.dumps(value, ensure_ascii=False)}"))
        if group:
            lines.append(_yaml(value, f"{margin}  ").rstrip("\n"))
    return "\n".join(lines) + "\n"
