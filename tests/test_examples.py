"""Worked designs that come with the program: whoever has it can begin with them, wherever it is installed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import ncgear
from commands import ROOT, Run
from drives import TRAINS
from ncgear.design.reading.balance_file import load_balance
from ncgear.design.reading.design_file import load, load_train
from ncgear.design.template import examples

DESIGNS = ROOT / "designs"
NAMES = sorted(path.relative_to(DESIGNS).with_suffix("").as_posix() for path in DESIGNS.rglob("*.yaml"))


def test_every_design_is_listed_with_what_it_is(run: Run) -> None:
    status, out, err = run("examples")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert [line.split()[0] for line in lines] == NAMES
    assert all(len(line) <= 110 and len(line.split()) > 3 for line in lines)
    assert list(examples()) == NAMES


@pytest.mark.tiers(quick=["pusher", "traced-egg"], rest="slow")
@pytest.mark.parametrize("name", NAMES)
def test_an_example_is_read_where_it_is_written(run: Run, name: str, tmp_path: Path) -> None:
    """All that it names is written with it, byte for byte, and nothing else."""
    status, out, err = run("new", "--example", name)
    assert (status, err) == (0, "")
    written = out.split()
    assert written[0] == f"{name}.yaml"
    assert sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.*")) == sorted(written)
    for one in written:
        source = next(place / one for place in (DESIGNS, DESIGNS / "balance") if (place / one).exists())
        assert Path(one).read_bytes() == source.read_bytes()
    reader = load_balance if name.startswith("balance/") else load_train if name in TRAINS else load
    assert reader(Path(written[0]))


def test_another_name_is_the_designs_own(run: Run) -> None:
    assert run("new", "12", "--example", "pusher")[:2] == (0, "12.yaml\n")
    own, other = Path("12.yaml").read_text(), (DESIGNS / "pusher.yaml").read_text()
    assert ncgear.load("12.yaml").design.name == "12"
    assert re.sub("^name:.*$", "", own, flags=re.M) == re.sub("^name:.*$", "", other, flags=re.M)


def test_no_file_is_replaced(run: Run) -> None:
    """Files of points of another example stay where they are the same; else nothing is written."""
    assert run("new", "--example", "traced-egg")[0] == 0
    assert run("new", "egg", "--example", "traced-egg")[:2] == (0, "egg.yaml\n")
    status, _, err = run("new", "--example", "traced-egg")
    assert (status, err) == (2, "traced-egg.yaml: exists already; choose another name, or remove it\n")
    Path("traced-egg.csv").write_text("my own\n")
    status, _, err = run("new", "third", "--example", "traced-egg")
    assert (status, err) == (2, "traced-egg.csv: exists already; choose another name, or remove it\n")
    assert not Path("third.yaml").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--example", "pushr"), "--example: 'pushr' is no example; did you mean pusher?"),
        (("--example", "../designs/pusher"), "--example: '../designs/pusher' is no example"),
        (("--example", "pusher", "--teeth", "20"), "--teeth: given with --example pusher"),
        (("--example", "pusher", "--law", "ellipse"), "--law: given with --example pusher"),
        (("a/b", "--example", "pusher"), "NAME: 'a/b' cannot name a design"),
    ],
)
def test_what_is_no_example_is_refused(run: Run, options: tuple[str, ...], said: str, tmp_path: Path) -> None:
    status, out, err = run("new", *options)
    assert (status, out) == (2, "")
    assert err.startswith(said)
    assert not list(tmp_path.iterdir())
