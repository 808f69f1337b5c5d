"""Work of the library that takes a while: Ctrl-C ends it, and a bar shows how far it is."""

from __future__ import annotations

import ctypes
import importlib
import sys
import threading
from collections.abc import Callable
from typing import Any

from . import _library


class Group:
    """What works on several threads, and ends together."""

    _of_thread = threading.local()

    def __init__(self) -> None:
        self._watches: list[Watch] = []
        self._ended = False

    def join(self) -> None:
        """All work of this thread is of the group from now on, and shows no bar of its own."""
        Group._of_thread.group = self

    def end(self) -> None:
        self._ended = True
        for watch in self._watches:
            watch.end()

    def add(self, watch: Watch) -> None:
        self._watches.append(watch)
        if self._ended:
            watch.end()

    @staticmethod
    def here() -> Group | None:
        return getattr(Group._of_thread, "group", None)


class Watch:
    """What a call of the library looks at and writes meanwhile."""

    def __init__(self) -> None:
        self._stop, self._progress = ctypes.c_int32(0), ctypes.c_double(0.0)
        #: for the options' fields of these names
        self.stop = ctypes.pointer(self._stop)
        self.progress = ctypes.pointer(self._progress)
        #: for calls that take nothing else
        self.options = _library.WatchOptions(
            size=ctypes.sizeof(_library.WatchOptions), stop=self.stop, progress=self.progress)
        #: told now and then how much of it is done, of 1
        self.tell: Callable[[float], None] = lambda done: None

    def end(self) -> None:
        self._stop.value = 1

    def run(self, call: Callable[[], int], title: str) -> int:
        """The call's status; after Ctrl-C it has ended before KeyboardInterrupt goes on."""
        group = Group.here()
        if group is not None:  # Ctrl-C comes to another thread
            group.add(self)
            return call()
        status: list[int] = []
        ended = threading.Event()  # Thread.join() takes a thread for ended where Ctrl-C comes while it waits

        def work() -> None:
            try:
                status.append(call())
            finally:
                ended.set()

        # On a thread of its own: this one is there for Ctrl-C.
        threading.Thread(target=work).start()
        show = bar(title, 100)
        try:
            while not ended.wait(0.1):
                show(round(100 * self._progress.value))
                self.tell(self._progress.value)
            show(100)
        except BaseException:  # Ctrl-C, or what tell() throws
            self.end()
            ended.wait()
            raise
        finally:
            show(None)
        return status[0]


def bar(title: str, total: int) -> Callable[[int | None], None]:
    """Takes how much of `total` is done, None at the end. Shows tqdm's bar on a terminal and in a notebook, where tqdm
    is installed; else nothing."""
    shown: Any = None
    if sys.stderr.isatty() or "ipykernel" in sys.modules:
        try:
            shown = importlib.import_module("tqdm.auto").tqdm(total=total, desc=title, leave=False)
        except ImportError:
            pass

    def show(done: int | None) -> None:
        if shown is None:
            return
        if done is None:
            shown.close()
        else:
            shown.update(done - shown.n)

    return show
