#!/usr/bin/env python3
"""Renders pages and says which rows of tables and items of lists became text.

`python .ci/rendered.py PAGE …`, with the package markdown-it-py; `.ci/pages` asks for all pages.
"""

import re
import sys
from pathlib import Path

from markdown_it import MarkdownIt

ITEM = re.compile(r"([-*+]|\d+[.)])\s")


def cells(row):
    """How many cells a row has: | that are not escaped, one at each end."""
    return len(re.findall(r"(?<!\\)\|", row.strip())) - 1


def check(text):
    """Faults of a page: lines, counted from 1, and words."""
    lines, faults, head = text.splitlines(), [], 0
    items = []  # Indents of the text of the list items around a token.
    for token in MarkdownIt("commonmark").enable("table").parse(text):
        if token.type == "list_item_open":
            line = lines[token.map[0]]
            indent = len(line) - len(line.lstrip())
            items.append(indent + len(token.info + token.markup) + 1)
        elif token.type == "list_item_close":
            items.pop()
        elif token.type == "ordered_list_open" and token.attrGet("start") is not None:
            faults.append((token.map[0] + 1, "the list does not begin with 1: it was cut"))
        elif token.type in ("table_open", "tr_open"):
            row = lines[token.map[0]]
            if token.type == "table_open":
                head = cells(row)
            if not row.startswith("|") or not row.rstrip().endswith("|"):
                faults.append((token.map[0] + 1, "a row begins and ends with |"))
            elif cells(row) != head:
                faults.append((token.map[0] + 1, f"{cells(row)} cells, not {head}"))
        elif token.type == "paragraph_open":
            begin, end = token.map
            indent = items[-1] if items else 0
            for number in range(begin, end):
                line = lines[number]
                words = line.lstrip(" >")
                # The first line of an item has the mark of the list before its text.
                if number == begin and items and ITEM.match(words):
                    continue
                if words.startswith("|") and words.endswith("|"):
                    faults.append((number + 1, "a row of a table became text"))
                elif ITEM.match(words):
                    faults.append((number + 1, "an item of a list became text"))
                elif line.startswith(">"):
                    continue
                elif len(line) - len(words) != indent:
                    faults.append((number + 1, f"the indent is not {indent}"))
    return faults


TABLE = "| a | b |\n|---|---|\n| 1 | 2 |\n"
FINE = f"""# Title

{TABLE}| `\\|x\\|` | 4 |

Text, 3 - 2,
and more.

1. One
   goes on.

   Another paragraph.
2. Two
   - inner
     goes on
- other

> quoted
"""
FAULTS = {
    "a blank line in a table": f"{TABLE}\n| 3 | 4 |\n",
    "a row of other length": f"{TABLE}| 3 |\n",
    "a longer row": f"{TABLE}| 3 | 4 | 5 |\n",
    "a wrapped row": f"{TABLE}| 3 |\n4 |\n",
    "a space before a row": f"{TABLE} | 3 | 4 |\n",
    "a table after text": "Text\n| a | b |\n| 1 | 2 |\n",
    "an item without its indent": "- one\ngoes on\n",
    "a paragraph of an item without its indent": "1. one\n\nmore\n2. two\n",
    "an inner item without its indent": "1. one\n   - inner\n  goes on\n",
    "a wrapped number": "There are\n3. in all\n",
    "a space before text": "Text\n\n On\n",
}


def faults(pages, root=Path()):
    """Those of pages as words, and the kinds that are not noticed."""
    for kind, text in FAULTS.items():
        if not check(text):
            yield f".ci/rendered.py does not notice {kind}"
    texts = [(page, (root / page).read_text()) for page in pages]
    for page, text in [("a page without faults", FINE), *texts]:
        yield from (f"{page}:{line}: {words}" for line, words in check(text))


if __name__ == "__main__":
    found = list(faults(sys.argv[1:]))
    print(*found, sep="\n")
    sys.exit(bool(found))
