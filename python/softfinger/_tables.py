"""Tables of the library as columns."""

from __future__ import annotations

import ctypes
import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _library
from ._library import library
from ._long_work import Watch


class Columns(Mapping[str, NDArray[Any]]):
    """Arrays of one length by name; a missing value is NaN. Made to be plotted."""

    def __init__(self, columns: Mapping[str, NDArray[Any]], units: Mapping[str, str] | None = None) -> None:
        self._columns = dict(columns)
        #: of each column as far as it is known: "mm", "deg/s"; "1" of a pure number, "" of words
        self.units: dict[str, str] = dict(units or {})

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()))) if self._columns else 0
        return f"Columns({rows} rows: {', '.join(self._columns)})"


def taken(table: ctypes.c_void_p) -> tuple[Columns, str]:
    """Columns and text of a table of the library, which is given back."""
    try:
        rows, count = ctypes.c_size_t(), ctypes.c_size_t()
        library.sf_table_size(table, ctypes.byref(rows), ctypes.byref(count))
        columns: dict[str, NDArray[Any]] = {}
        units: dict[str, str] = {}
        for index in range(count.value):
            name = read_text(library.sf_table_name, table, index)
            units[name] = read_text(library.sf_table_unit, table, index)
            values = np.empty(rows.value)
            library.sf_table_column(table, index, values.ctypes.data, rows.value, None)
            columns[name] = values if units[name] else _words(table, index, values)
        return Columns(columns, units), read_text(library.sf_table_text, table)
    finally:
        library.sf_table_destroy(table)


def read_text(read: Callable[..., int], *of: Any) -> str:
    """A text of any length, by a call that says how long it is."""
    size = ctypes.c_size_t()
    read(*of, None, 0, ctypes.byref(size))
    text = ctypes.create_string_buffer(size.value)
    read(*of, text, size.value, None)
    return text.value.decode()


def table_of(watch: Watch, title: str, call: Callable[..., int]) -> tuple[Columns, str]:
    """What a long call makes: call(&table, error, error_size). After Ctrl-C it has ended before KeyboardInterrupt goes on."""
    table, error = ctypes.c_void_p(), _library.ErrorText()
    try:
        error.check(watch.run(lambda: int(call(ctypes.byref(table), *error.arguments)), title))
    except KeyboardInterrupt:
        library.sf_table_destroy(table)
        raise
    return taken(table)


def report_of(watch: Watch, title: str, call: Callable[..., int]) -> dict[str, Any]:
    """The same where it has no columns: what the command prints with --json."""
    report: dict[str, Any] = json.loads(table_of(watch, title, call)[1])
    return report


def _words(table: ctypes.c_void_p, column: int, numbers: NDArray[np.float64]) -> NDArray[Any]:
    """(rows,) of text."""
    count = int(numbers.max()) + 1 if len(numbers) else 0
    words: NDArray[Any] = np.array([read_text(library.sf_table_word, table, column, number) for number in range(count)], str)
    chosen: NDArray[Any] = words[numbers.astype(int)]
    return chosen
