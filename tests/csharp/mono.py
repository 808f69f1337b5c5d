"""C# sources compiled by mcs with warnings as errors and run by mono, and a softfinger whose page they can reach."""

import contextlib
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import threading

#: C# 7.2 is what Unity 2018.3 and later have.
COMPILER = ["mcs", "-langversion:7.2", "-unsafe", "-warn:4", "-warnaserror"]
PATIENCE_S = 240


class Compiled:
    """A program of these sources, files or folders; it is there as long as this is."""

    def __init__(self, *sources, references=()):
        self._folder = tempfile.TemporaryDirectory()
        self.file = pathlib.Path(self._folder.name) / "program.exe"
        files = []
        for source in map(pathlib.Path, sources):
            files += sorted(source.rglob("*.cs")) if source.is_dir() else [source]
        ran = subprocess.run([*COMPILER, f"-out:{self.file}", *(f"-r:{r}" for r in references), *map(str, files)],
                             capture_output=True, text=True)
        if ran.returncode != 0:
            raise AssertionError(ran.stdout + ran.stderr)

    def close(self):
        self._folder.cleanup()

    def run(self, *arguments, library=None):
        """(status, stdout, stderr) of mono with these arguments. library: the folder of libsoftfinger.so.0."""
        with self.start(*arguments, library=library) as process:
            out, error = process.communicate(timeout=PATIENCE_S)
        return process.returncode, out, error

    def start(self, *arguments, library=None):
        # Mono keeps settings in the home; a test leaves nothing there.
        environment = {**os.environ, "HOME": self._folder.name}
        if library is not None:
            environment["LD_LIBRARY_PATH"] = str(library)
        return subprocess.Popen(["mono", str(self.file), *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, env=environment)


@contextlib.contextmanager
def softfinger(program, *arguments, twin=False):
    """`softfinger run` with its page at a free port; gives the address it prints, and ends it as Ctrl-C does."""
    command = [program, "run", *map(str, arguments), *([] if twin else ["--no-twin"]), "--port", "0"]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        said, address = [], None
        while address is None:
            line = process.stdout.readline()
            if not line:
                raise AssertionError(f"softfinger ended before its page: {''.join(said)}")
            said.append(line)
            address = re.search(r"https?://127\.0\.0\.1:\d+\S*", line)
        reader = threading.Thread(target=lambda: said.extend(process.stdout))
        reader.start()
        try:
            yield address[0]
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            status = process.wait(PATIENCE_S)
            reader.join()
        if status != 0:
            raise AssertionError(f"softfinger ended with {status}: {''.join(said)}")
