"""Numbers in the text come from a file that a program writes: :measured:`absorb.open:.3f`.

The file is ``measured.json`` beside the pages, made by ``make measured`` (``docs/measure.py``). The role looks up the
name and writes the number in the format that stands behind the colon, one of Python: ``.3f``, ``.2g``, ``.1%``. A name
that the file does not have, or a format that does not fit a number, is a warning, so with ``-W`` the build fails.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from docutils import nodes
from sphinx.util import logging
from sphinx.util.docutils import SphinxRole

logger = logging.getLogger(__name__)
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
SPACE = "\N{NO-BREAK SPACE}"


def typeset(value: float, form: str) -> str:
    """The number as the book prints it: a true minus, a space before %, powers of ten raised."""
    text = format(value, form).replace("%", f"{SPACE}%")
    text = re.sub(
        r"e([+-])0*(\d+)", lambda m: f"·10{(m[1].replace('+', '') + m[2]).translate(RAISED)}", text
    )
    return text.replace("-", "−")


class Measured(SphinxRole):
    def run(self):
        path = Path(self.env.srcdir) / self.config.measured_file
        self.env.note_dependency(str(path))
        name, _, form = self.text.partition(":")
        group, _, key = name.partition(".")
        try:
            text = typeset(json.loads(path.read_text(encoding="utf-8"))[group][key], form)
        except (OSError, KeyError):
            logger.warning(
                "measured: %s has no number %s (make measured)",
                path.name,
                name,
                location=self.get_location(),
                type="measured",
            )
            text = "?"
        except ValueError as error:
            logger.warning(
                "measured: %s: %s", self.text, error, location=self.get_location(), type="measured"
            )
            text = "?"
        return [nodes.inline(self.rawtext, text, classes=["measured"])], []


def setup(app):
    app.add_config_value("measured_file", "measured.json", "env")
    app.add_role("measured", Measured())
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
