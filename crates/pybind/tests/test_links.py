"""What Python writes takes the place of links, and is never written through them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import wythe


def test_links_are_replaced(tmp_path: Path, couplet: wythe.Results) -> None:
    mine = tmp_path / "mine"
    for name in ("history.csv", "cracks.svg", "wall.toml", "model.inp"):
        mine.write_text("mine")
        path = tmp_path / name
        for link in (path, tmp_path / f"{name}.tmp"):
            link.symlink_to(mine)
        if name == "history.csv":
            couplet.history.to_csv(path)
        elif name == "wall.toml":
            wythe.templates.shear_wall().save(path)
        elif name == "model.inp":
            couplet.export("inp", out=tmp_path)
        else:
            wythe.templates.shear_wall().picture().save(path)
        assert mine.read_text() == "mine", name
        assert path.is_file() and not path.is_symlink(), name
        assert not os.path.lexists(tmp_path / f"{name}.tmp"), name


def test_a_run_over_its_own_deck_is_refused(tmp_path: Path) -> None:
    path = wythe.templates.shear_wall().save(tmp_path / "model.toml")
    before = Path(path).read_text()
    with pytest.raises(wythe.OutputError, match="would replace an input"):
        wythe.Model.from_toml(path).run(tmp_path)
    assert Path(path).read_text() == before
