"""Pictures as SVG, for notebooks and files."""

from __future__ import annotations

import os
from dataclasses import dataclass

from wythe import _wythe
from wythe._errors import as_path, write_bytes

__all__ = ["Picture"]


@dataclass(frozen=True)
class Picture:
    """A picture. Notebooks show it; ``save`` writes it.

    Attributes
    ----------
    svg : str
        The picture as SVG text.
    """

    svg: str

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<Picture: {len(self.svg) / 1e3:.0f} kB of SVG; .save('picture.svg') or .png()>"

    def png(self, zoom: float = 2.0) -> bytes:
        """The picture as PNG with ``zoom`` pixels per pixel of the SVG."""
        return bytes(_wythe.png(self.svg, float(zoom)))

    def save(self, path: str | os.PathLike[str], zoom: float = 2.0) -> str:
        """Writes the picture as ``.svg`` or ``.png``, by the ending of the name, and returns the path.

        Raises
        ------
        OutputError
            The file cannot be written.
        ValueError
            The name has another ending.
        """
        name = as_path("path", path)
        ending = os.path.splitext(name)[1].lower()
        if ending == ".svg":
            content = self.svg.encode()
        elif ending == ".png":
            content = self.png(zoom)
        else:
            raise ValueError(f"path: expected a name that ends in .svg or .png, got {name!r}")
        return write_bytes(name, content)
