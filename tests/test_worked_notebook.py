"""docs/notebook runs from top to bottom as a reader runs it: in a kernel of its own, every value shown."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest

from commands import ROOT

NOTEBOOKS = sorted((ROOT / "docs" / "notebook").glob("*.ipynb"))

LONGEST_S = 120


def run(cells: list[str], folder: Path) -> list[nbformat.NotebookNode]:
    """The outputs of cells that run one after the other in a folder."""
    from nbclient import NotebookClient

    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    NotebookClient(
        notebook, timeout=LONGEST_S, kernel_name="python3", resources={"metadata": {"path": folder}}
    ).execute()
    return [output for cell in notebook.cells for output in cell.outputs]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_outputs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert cells
    assert [cell for cell in cells if cell.outputs or cell.execution_count is not None] == []


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path) -> None:
    cells = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    outputs = run(cells, path.parent)
    html = [output.data["text/html"] for output in outputs if "text/html" in output.get("data", {})]
    assert len(html) >= 7
    assert not any("internal fault: " in text for text in html)
    assert [output for output in outputs if output.output_type == "error"] == []
    assert sum("motion.v1_mm_s: the slider stops" in text for text in html) == 1
    assert any(output.get("data", {}).get("text/plain") == "'39.9 % less peak power'" for output in outputs)


@pytest.mark.slow
def test_a_cell_that_fails_is_seen(tmp_path: Path) -> None:
    from nbclient.exceptions import CellExecutionError

    with pytest.raises(CellExecutionError, match="ZeroDivisionError"):
        run(["1 / 0"], tmp_path)
