"""The notebook runs, cell by cell."""

import json

import pytest

from conftest import ROOT


def test_the_notebook_runs(monkeypatch):
    for module in ("pandas", "sklearn"):
        pytest.importorskip(module)
    folder = ROOT / "crates" / "python" / "examples"
    notebook = json.loads((folder / "first_steps.ipynb").read_text(encoding="utf-8"))
    monkeypatch.chdir(folder)
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(code) > 3
    names = {}
    for cell in code:
        exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
