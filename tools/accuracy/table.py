"""The table of errors: rows, the limits that hold them, Markdown."""

import math
import re
from dataclasses import dataclass

# Largest error that a method may show where a case states no tolerance: of form factors, of the largest value of their
# matrix (single plane: less what it cannot see); of light, of the mean over the room. Rays and item buffers sample.
LIMITS = {
    "pairs": 1e-5, "exact": 1e-4, "rays": 0.03, "hemicube": 0.01, "cubic-tetrahedron": 0.01, "single-plane": 0.15,
    "matrix": 1e-4, "hierarchical": 0.025,
}
# Of an unbiased estimate, which has no error but chance.
LARGEST_DEVIATE = 4
# The standard error of the path tracer is that of so many independent means (src/trace/irradiance_estimate.h).
SCRAMBLINGS = 16


def stated_tolerance(case):
    """Relative, as the first percentage of the case's own words; None where it says nothing."""
    found = re.search(r"([0-9.]+) %", case.get("tolerance", ""))
    return float(found.group(1)) / 100 if found else None


def normal_deviate(t, freedom=SCRAMBLINGS - 1):
    """The standard normal deviate that is as unlikely as Student's t (Wallace 1959)."""
    if math.isinf(t):
        return t
    return math.sqrt(freedom * math.log1p(t * t / freedom)) * (8 * freedom + 1) / (8 * freedom + 3)


@dataclass
class Row:
    """One case through one method. `deviate` is the worst of an estimate, in standard errors."""
    case: str
    method: str
    error: float | None
    limit: float | None
    deviate: float | None
    seconds: float | None
    note: str
    published: str
    largest: float  # deviate

    def is_beyond_limit(self):
        too_far = self.error is not None and self.limit is not None and not self.error <= self.limit
        return too_far or (self.deviate is not None and not self.deviate <= self.largest)

    def text(self):
        def number(value, form):
            return "–" if value is None else format(value, form)

        mark = "**beyond its limit** " if self.is_beyond_limit() else ""
        cells = (self.case, self.method, number(self.error, ".2e"), number(self.limit, ".1e"),
                 number(self.deviate, ".1f"), number(self.seconds, ".2f"), mark + self.note, self.published)
        return "| " + " | ".join(cells) + " |"


class Table:
    """Rows in the order in which they were measured."""

    HEAD = ("| case | method | error | limit | deviate | seconds | | others, published |\n"
            "| --- | --- | ---: | ---: | ---: | ---: | --- | --- |\n")

    def __init__(self):
        self.rows = []

    def add(self, case, method, error=None, *, limit=None, deviate=None, seconds=None, note="", published="",
            largest=LARGEST_DEVIATE):
        """`limit` is the case's own; without one, that of the method holds."""
        if limit is None and error is not None:
            limit = LIMITS.get(method)
        self.rows.append(Row(case, method, error, limit, deviate, seconds, note, published, largest))

    def skip(self, case, reason):
        self.rows.append(Row(case, "–", None, None, None, None, reason, "", LARGEST_DEVIATE))

    def text(self):
        return self.HEAD + "".join(row.text() + "\n" for row in self.rows)

    def failures(self):
        return [row for row in self.rows if row.is_beyond_limit()]
