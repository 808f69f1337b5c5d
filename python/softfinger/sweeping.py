"""The same work with keys of a file varied."""

from __future__ import annotations

import concurrent.futures
import itertools
import pathlib
import tempfile
from collections.abc import Callable, Mapping, MutableMapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._library import InputError, OperationError, file_of
from ._long_work import Group, bar
from ._tables import Columns
from .rendering import Path
from .results import Evaluation, evaluate


def sweep(
    work: Callable[..., Columns | Evaluation],
    file: Path,
    *,
    vary: Mapping[str, Sequence[Any] | NDArray[Any]],
    threads: int = 1,
    **options: Any,
) -> Columns:
    """`work(file, **options)` for every combination of the values of keys of that file.

    work: press or evaluate, or a function like them. vary: values by key, tables and arrays of tables
    with dots: "material.youngs_modulus_kPa", "finger.0.friction_coefficient". The file itself stays as
    it is; what it names is found from where it stands. threads: so many at a time.

    Columns are the varied keys, then those of the work: of a press every row, of an evaluation the means
    and how many frames were missed, one row a combination. Rows are in the order of the combinations,
    the last key fastest, whatever the number of threads. Needs tomlkit (Debian: python3-tomlkit).
    """
    if not vary:
        raise InputError("vary: names no key")
    keys = list(vary)
    combinations = list(itertools.product(*(_plain(vary[key]) for key in keys)))
    if not combinations:
        raise InputError("vary: a key has no values")
    show, done, group = bar("sweep", len(combinations)), 0, Group()
    with tempfile.TemporaryDirectory(prefix="softfinger-sweep-") as folder:
        whole = file_of(file, ("scene", "finger", "device") if work is evaluate else ("finger", "scene", "device"))
        files = [_changed(whole, dict(zip(keys, values)), pathlib.Path(folder, f"{number}"))
                 for number, values in enumerate(combinations)]
        with concurrent.futures.ThreadPoolExecutor(max(1, threads), initializer=group.join) as pool:
            jobs = [pool.submit(_rows_of, work, changed, str(file), options) for changed in files]
            try:
                for _ in concurrent.futures.as_completed(jobs):
                    done += 1
                    show(done)
                tables = [job.result() for job in jobs]
            except BaseException:
                group.end()
                pool.shutdown(cancel_futures=True)
                raise
            finally:
                show(None)
    return _joined(keys, combinations, tables)


def _plain(values: Sequence[Any] | NDArray[Any]) -> list[Any]:
    """As a TOML file can have them."""
    return list(values.tolist() if isinstance(values, np.ndarray) else values)


def _changed(file: pathlib.Path, values: Mapping[str, Any], folder: pathlib.Path) -> pathlib.Path:
    """A copy of the file with these values in it, in a new folder; files that it names are found."""
    try:
        import tomlkit
    except ImportError:
        raise OperationError("sweep: needs tomlkit (Debian: python3-tomlkit)") from None
    try:
        document = tomlkit.parse(file.read_text(encoding="utf-8"))
    except OSError as failure:
        raise InputError(f"{file}: {failure.strerror}") from None
    except tomlkit.exceptions.ParseError as failure:
        raise InputError(f"{file}: {failure}") from None
    _name_absolutely(document, file.resolve().parent)
    for key, value in values.items():
        _put(document, key, value)
    folder.mkdir()
    changed = folder / file.name
    changed.write_text(tomlkit.dumps(document), encoding="utf-8")
    return changed


def _name_absolutely(item: Any, folder: pathlib.Path) -> None:
    """Words that are names of files beside the file, from anywhere."""
    pairs = item.items() if isinstance(item, MutableMapping) else enumerate(item) if isinstance(item, list) else ()
    for key, value in list(pairs):
        if isinstance(value, str):
            if value and (folder / value).is_file():
                item[key] = str(folder / value)
        else:
            _name_absolutely(value, folder)


def _put(document: Any, key: str, value: Any) -> None:
    *tables, last = key.split(".")
    at = document
    for name in tables:
        try:
            at = at[int(name)] if isinstance(at, list) else at.setdefault(name, {})
        except (ValueError, IndexError):
            raise InputError(f"vary {key}: {name} is none of an array of {len(at)}") from None
    if not isinstance(at, MutableMapping):
        raise InputError(f"vary {key}: {last} is not a key of a table")
    at[last] = value


def _rows_of(work: Callable[..., Columns | Evaluation], changed: pathlib.Path, file: str, options: Mapping[str, Any]) -> Columns:
    try:
        result = work(changed, **options)
    except (InputError, OperationError) as failure:
        # The copy is gone when this is read.
        raise type(failure)(str(failure).replace(str(changed), file)) from None
    if isinstance(result, Columns):
        return result
    row = {name: np.array([np.nan if value is None else value]) for name, value in result.mean.items()}
    for name in ("frames_missed", "frames_false"):
        row[name] = np.array([result.report[name]])
    return Columns(row)


def _joined(keys: list[str], combinations: list[tuple[Any, ...]], tables: list[Columns]) -> Columns:
    rows = [len(next(iter(table.values()))) for table in tables]
    varied = {key: np.repeat(np.array([values[i] for values in combinations]), rows) for i, key in enumerate(keys)}
    names = list(tables[0])
    return Columns({**varied, **{name: np.concatenate([table[name] for table in tables]) for name in names}})
