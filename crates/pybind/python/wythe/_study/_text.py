"""Tables in HTML."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence


def page(title: str, names: Sequence[str], rows: Iterable[Iterable[str]], notes: Iterable[str] = ()) -> str:
    """A table in HTML below its title and above its notes."""

    def line(cells: Iterable[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(line(row, "td") for row in rows)
    below = "".join(f"<p>{html.escape(note)}</p>" for note in notes)
    head = f"<p>{html.escape(title)}</p><table><thead>{line(names, 'th')}</thead>"
    return f"{head}<tbody>{body}</tbody></table>{below}"
