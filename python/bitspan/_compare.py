# SPDX-License-Identifier: Apache-2.0
"""Records of a design against those of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping

import numpy as np
from numpy.typing import NDArray

from . import _core, _html
from ._core import InputError
from ._divergence import Divergence
from ._model import as_table
from ._run import Run


@dataclass(frozen=True)
class Comparison:
    """What compare() found. A bench must fail where it is not `equal`."""

    first: Divergence | None
    matched: int  #: values that are equal
    nontrivial: int  #: those of them that are neither 0 nor the same field's value in the record before
    unchecked: int  #: records of the run that the design did not deliver
    differences: int  #: values that differ, of extra records all

    @property
    def equal(self) -> bool:
        """Whether there is no difference, nothing is unchecked, and something non-trivial was compared."""
        return self.first is None and self.unchecked == 0 and self.nontrivial > 0

    def __str__(self) -> str:
        counts = (f"{self.matched} values matched, {self.nontrivial} non-trivial, {self.unchecked} records unchecked, "
                  f"{self.differences} values differ")
        return counts if self.first is None else f"{self.first}\n{counts}"

    def _repr_html_(self) -> str:
        rows = [(name, getattr(self, name)) for name in ("equal", "matched", "nontrivial", "unchecked", "differences")]
        return _html.table(["comparison", ""], rows) + ("" if self.first is None else self.first._repr_html_())


def _first_difference(run: Run, stage: str, expected: NDArray[np.int64], actual: NDArray[np.int64], wrong: NDArray[np.bool_], differences: int) -> Divergence:
    names = run.names(stage)
    if wrong.any():
        record, column = (int(i) for i in np.unravel_index(int(np.argmax(wrong)), wrong.shape))
        place, name = expected[record], names[column]
    else:
        record, column, name = len(expected), -1, None
        place = actual[record]

    def of(*wanted: str) -> int:
        return next((int(place[names.index(w)]) for w in wanted if w in names), -1)

    where = {"triangle": of("triangle"), "x": of("x", "x_first"), "y": of("y")}
    text = f"{stage}: record {record}, triangle {where['triangle']}, pixel {where['x']} {where['y']}: "
    if name is None:
        return Divergence("extra", stage, record, **where, field=None, expected=0, actual=0, expected_value=0.0, actual_value=0.0,
                          unit="", differences=differences, text=text + "the model has no such record; expected no more records")
    about = run.config.field(f"{stage}.{name}")
    wanted, got = int(expected[record, column]), int(actual[record, column])
    ulp = 2.0 ** -about.fraction
    text += f"{name}: {got} ({got * ulp:.9g} {about.unit}); expected {wanted} ({wanted * ulp:.9g} {about.unit})"
    return Divergence("value", stage, record, **where, field=name, expected=wanted, actual=got, expected_value=wanted * ulp,
                      actual_value=got * ulp, unit=about.unit, differences=differences, text=text)


def compare(run: Run, dut_records: Any, stage: str = "span") -> Comparison:
    """Compares records of a design under test with those of a run.

    dut_records  records of one stage as Model.check takes them; or a mapping of stages to such; or another Run, of which all
                 stages are compared
    stage        of the records, where there are those of one stage alone

    The stages are compared in the order of the pipeline, and `first` is of the earliest stage that differs.
    """
    if not isinstance(run, Run):
        raise InputError(f"compare: {run!r} is no run; expected what bitspan.render returns")
    if isinstance(dut_records, Run):
        given: dict[str, Any] = {s: dut_records.table(s) for s in _core.stages}
    elif isinstance(dut_records, Mapping) and dut_records and set(dut_records) <= set(_core.stages):
        given = {s: dut_records[s] for s in _core.stages if s in dut_records}
    else:
        given = {stage: dut_records}
    first = None
    matched = nontrivial = unchecked = differences = 0
    for name, records in given.items():
        expected = run.table(name)
        actual = as_table(records, run.names(name), name)
        n = min(len(expected), len(actual))
        same = expected[:n] == actual[:n]
        before = np.zeros_like(expected[:n])
        before[1:] = expected[: max(n - 1, 0)]
        matched += int(np.count_nonzero(same))
        nontrivial += int(np.count_nonzero(same & (expected[:n] != 0) & (expected[:n] != before)))
        unchecked += len(expected) - n
        here = int(np.count_nonzero(~same)) + (len(actual) - n) * expected.shape[1]
        differences += here
        if here and first is None:
            first = _first_difference(run, name, expected, actual, ~same, here)
    return Comparison(first, matched, nontrivial, unchecked, differences)
