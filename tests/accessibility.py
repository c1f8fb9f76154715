"""What axe-core finds wrong in a page, in light and in dark colors.

Input: a page of playwright. Output: a line for each violation of WCAG 2.2 A and AA. A page opened
with a policy that forbids foreign scripts needs ``bypass_csp=True``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import pytest

AXE: Final = Path(__file__).parents[1] / "web" / "node_modules" / "axe-core" / "axe.min.js"
RULES: Final = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
needs_axe: Final = pytest.mark.skipif(
    not AXE.exists(), reason="axe-core is not installed: run `npm ci` in web/"
)
_RUN: Final = """(rules) => axe.run(document, { runOnly: { type: "tag", values: rules } }).then(
  ({ violations }) => violations.map(
    (v) => `${v.id} ${v.nodes.map(({ target, html }) => `${target} ${html.slice(0, 120)}`)}`
  )
)"""


def violations(page: Any) -> list[str]:
    """What is wrong with the page as it is shown now; empty where all is well."""
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(AXE.read_text(encoding="utf-8"))
    found = []
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        found += [f"{scheme}: {line}" for line in page.evaluate(_RUN, RULES)]
    return found
