"""Every command in README.md and docs/*.md runs as it is written, in the order in which the pages are read.

Runs are kept short (--duration-s), pages and ports get free numbers instead of those written; what serves until
Ctrl-C is looked at and ended so. Each other command that cannot run here is named below, with the reason.

    commands_test.py PROGRAM SOURCE_FOLDER [--all]
"""

import contextlib
import pathlib
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

import documents

PROGRAM, ROOT = str(pathlib.Path(sys.argv[1]).resolve()), documents.root_of(sys.argv[2])
ALL = "--all" in sys.argv

#: (page, command): why it cannot run here, and what runs in its place.
ELSEWHERE = {
    ("docs/trackers.md", 'softfinger run scenes/sphere.toml --tracker "natnet:192.168.1.20,body=index tip"'): (
        "an OptiTrack server of that address",
        'softfinger run scenes/sphere.toml --tracker "natnet:127.0.0.1,body=index tip"',
    ),
    ("docs/trackers.md", "softfinger run scenes/sphere.toml --tracker natnet:192.168.1.2,body=index_tip --filter --predict-ms 20"): (
        "an OptiTrack server of that address",
        "softfinger run scenes/sphere.toml --tracker natnet:127.0.0.1,body=index_tip --filter --predict-ms 20",
    ),
    ("docs/trackers.md", 'softfinger finger register --person anna.toml --model fingers/index.toml --table-mm 0 --tracker "natnet:192.168.1.20,body=index tip"'): (
        "an OptiTrack server of that address, and a person",
        'softfinger finger register --person anna.toml --model fingers/index.toml --table-mm 0 --tracker "natnet:127.0.0.1,body=index tip"',
    ),
    ("docs/headsets.md", "softfinger run scenes/sphere.toml --tracker webxr --listen 192.168.1.5 --token secret.txt --certificate page.pem --key page-key.pem"): (
        "this machine has another address",
        "softfinger run scenes/sphere.toml --tracker webxr --listen 127.0.0.1 --token secret.txt --certificate page.pem --key page-key.pem",
    ),
    ("docs/headsets.md", "mkcert -cert-file page.pem -key-file page-key.pem 192.168.1.5"): (
        "another program, not in Debian's main section for servers",
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=127.0.0.1 -keyout page-key.pem -out page.pem",
    ),
    ("README.md", "sudo apt install ./build/packages/*.deb"): ("changes the machine; tests/install does it in one of its own", None),
    ("docs/headsets.md", "adb reverse tcp:8080 tcp:8080"): ("a headset by cable", None),
    ("docs/studies.md", "softfinger study studies/thimble.toml --out thimble-study"): ("minutes; README.md has a short one", None),
    ("docs/wearer.md", "softfinger device fit thimble-3rrs-dynamixel --sensor udp --real-time --finger index --person anna.toml"): (
        "keeps to the clock: a machine that runs other tests commands the device too late, which ends what presses by itself",
        "softfinger device fit thimble-3rrs-dynamixel --sensor emulator --finger index --person anna.toml",
    ),
    ("docs/motors.md", "oscdump 9000"): ("liblo-tools, for those who have them", None),
    ("docs/motors.md", "sudo usermod -aG dialout $USER"): ("changes the machine", None),
    ("docs/trackers.md", "oscsend 127.0.0.1 9000 /finger/pose fffffff -0.0025 0 0.0257 1 0 0 0"): (
        "liblo-tools; the message is sent by this test",
        None,
    ),
}
#: Five fingers and their devices take seconds to load; only with --all.
SLOW = "scenes/hand.toml"


def free_port(kind=socket.SOCK_DGRAM):
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def substituted(command, ports):
    """The words, with this program and free ports for those that are written."""
    words = shlex.split(command)
    if words[0] in ("softfinger", "build/softfinger"):
        words[0] = PROGRAM
    for index, word in enumerate(words):
        for kind in ("udp", "osc"):
            if match := re.fullmatch(rf"{kind}:(\d+)", word):
                words[index] = f"{kind}:{ports.setdefault(match[1], free_port())}"
        if words[index - 1] == "--port" and word in ports:
            words[index] = str(ports[word])
        if word.startswith("natnet:127.0.0.1,"):
            words[index] = word.replace(",", f":{ports.setdefault('1510', free_port())},", 1)
    if words[1:3] == ["emulate", "natnet"]:
        words += ["--port", str(ports.setdefault("1510", free_port()))]
    return words


def with_duration(words, seconds):
    if "--duration-s" in words:
        words[words.index("--duration-s") + 1] = seconds
        return words
    return [*words, "--duration-s", seconds]


class Running:
    """A program that serves until Ctrl-C."""

    def __init__(self, words, folder):
        self.words = words
        self.log = tempfile.TemporaryFile("w+")  # pylint: disable=consider-using-with
        self.process = subprocess.Popen(  # pylint: disable=consider-using-with
            words, cwd=folder, stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT
        )

    def text(self):
        self.log.seek(0)
        return self.log.read()

    def wait_for(self, pattern, seconds=60):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if found := re.search(pattern, self.text()):
                return found
            if self.process.poll() is not None:
                break
            time.sleep(0.05)
        raise AssertionError(f"{self.words}: no '{pattern}' but:\n{self.text()}")

    def interrupt(self, status=0):
        self.process.send_signal(signal.SIGINT)
        ended = self.process.wait(30)
        text = self.text()
        self.log.close()
        if ended != status:
            raise AssertionError(f"{self.words}: ended with {ended}:\n{text}")
        return text

    def stop(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        if not self.log.closed:
            self.log.close()


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="softfinger-docs-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        for kind in ("fingers", "devices", "scenes", "objects", "studies"):
            shutil.copytree(ROOT / kind, cls.folder / kind)
        (cls.folder / "secret.txt").write_text("a-secret-of-the-docs-test\n")
        (cls.folder / "secret.txt").chmod(0o600)
        cls.ports = {}
        cls.emulators = []
        cls.tried, cls.tried_families = set(), set()

    @classmethod
    def tearDownClass(cls):
        for emulator in cls.emulators:
            emulator.stop()

    def run_words(self, words, status=0):
        done = subprocess.run(words, cwd=self.folder, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, status, f"{words}: {done.stderr}")
        return done

    def open_page(self, running):
        address = running.wait_for(r"(https?://127\.0\.0\.1:\S+)")[1]
        if address.startswith("https:"):
            return  # a certificate that nobody signed
        with urllib.request.urlopen(address, timeout=20) as answer:
            self.assertEqual(answer.status, 200)
            self.assertIn(b"softfinger", answer.read())

    def natnet_server(self, command):
        """The emulator of the body that a command follows, where no command on the pages is one."""
        body = re.search(r'body=([^"\s,]+(?: tip)?)', command)[1]
        server = Running(
            [PROGRAM, "emulate", "natnet", "motion.sqlite", "--repeat", "--body", body, "--port",
             str(self.ports.setdefault("1510", free_port()))], self.folder)
        server.wait_for("Ctrl-C ends")
        return server

    def run_live(self, command, words):
        running = Running([*words, "--port", "0"], self.folder)
        with contextlib.ExitStack() as ends:
            ends.callback(running.stop)
            self.open_page(running)
            if "osc:" in command:
                self.send_osc_pose(self.ports["9000"])
            text = running.interrupt()
            self.assertIn("commands sent", text)

    def send_osc_pose(self, port):
        """As oscsend would."""
        import struct  # pylint: disable=import-outside-toplevel

        def padded(text):
            return text + b"\0" * (4 - len(text) % 4)

        message = padded(b"/finger/pose") + padded(b",fffffff") + struct.pack(">7f", -0.0025, 0, 0.0257, 1, 0, 0, 0)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(message, ("127.0.0.1", port))

    def run_command(self, command):
        follows_server = "natnet:127" in command
        if command in self.tried and "--record" not in command and not follows_server:
            return
        self.tried.add(command)
        words = substituted(command, self.ports)
        part = words[1:3]
        if words[0] != PROGRAM:
            self.run_words(words)
        elif part[0] == "run" and "--headless" in words:
            self.run_words(with_duration(words, "1.0"))
        elif part[0] == "run":
            # One of those that differ in their device alone, or in how poses are smoothed.
            family = re.sub(r" --(device|predict-ms|threads) \S+| --filter", "", command)
            if not ALL and (SLOW in command or family in self.tried_families):
                return
            self.tried_families.add(family)
            server = self.emulators.pop() if self.emulators else None
            if follows_server and server is None:
                server = self.natnet_server(command)
            with contextlib.ExitStack() as ends:
                if server is not None:
                    ends.callback(server.stop)
                self.run_live(command, words)
                if server is not None:
                    server.interrupt()
        elif part == ["emulate", "natnet"]:
            self.emulators.append(Running(words, self.folder))
            self.emulators[-1].wait_for("Ctrl-C ends")
        elif part[0] == "emulate":
            self.run_words(words)
        elif part == ["finger", "register"]:
            server = self.natnet_server(command)
            running = Running(words, self.folder)
            with contextlib.ExitStack() as ends:
                ends.callback(server.stop)
                ends.callback(running.stop)
                running.wait_for("1 of 5: rest the pad flat on the table")
                running.interrupt(status=1)
                server.interrupt()
        elif part[0] == "evaluate":
            self.run_words(with_duration(words, "0.5"))
        elif part[0] == "export":
            self.run_words(words)
            exported = self.folder / words[words.index("--to") + 1]
            self.assertTrue(exported.is_file() and exported.stat().st_size or any(exported.glob("*.csv")), exported)
        else:
            self.assertTrue(self.run_words(words).stdout)

    def leaf_of(self, command):
        """The command that it calls, or that it speaks of; None where that has parts and none is named."""
        words = tuple(command.replace("build/softfinger", "softfinger").split()[1:])
        return next((one for one in self.leaves if one == words[: len(one)]), None)

    def is_only_named(self, command):
        leaf = self.leaf_of(command)
        return leaf is None or (len(command.split()) == 1 + len(leaf) and leaf[-1] != "schema")

    def check_synopsis(self, command):
        """That the command and the flags in it exist."""
        leaf = self.leaf_of(command)
        if leaf is None:
            first = command.split()[1].rstrip(",")
            self.assertIn(first, {"COMMAND", "help", *(one[0] for one in self.leaves)})
            return
        known = documents.flags(PROGRAM, leaf)
        self.assertLessEqual(set(re.findall(r"--[a-z][\w-]*", command)), known, command)

    def check_work(self, command):
        """What takes minutes is there."""
        words = shlex.split(command)
        if words[0] == "./dev":
            listed = subprocess.run([ROOT / "dev", "help"], capture_output=True, text=True, check=True).stdout
            self.assertRegex(listed, rf"(?m)^ *\./dev {words[1]}\b")
            if words[1] == "fuzz" and len(words) > 2 and words[2].isidentifier():
                self.assertTrue((ROOT / "fuzz" / f"{words[2]}_fuzz.cpp").exists(), command)
        elif words[0].startswith("tools/"):
            self.assertTrue((ROOT / words[0]).exists(), command)
        elif words[0].startswith("build/tests/"):
            module = words[0].removeprefix("build/tests/").removesuffix("_test")
            filtered = re.search(r"--gtest_filter='?(\w+)", command)
            suite = filtered[1] if filtered else r"\w+"
            sources = (ROOT / "tests" / module).glob("*.cpp")
            self.assertTrue(any(re.search(rf"TEST(_F|_P)?\({suite}\b", one.read_text()) for one in sources), command)
        elif words[0] == "cmake" and "--preset" in words:
            self.assertIn(f'"name": "{words[words.index("--preset") + 1]}"', (ROOT / "CMakePresets.json").read_text())
        elif words[0] == "cmake":
            self.assertIn("--install", words, command)
        else:
            self.fail(f"{command}: not known to this test; run it, or say above why it cannot run")

    def test_every_command_of_the_pages(self):
        self.leaves = sorted(documents.leaf_commands(PROGRAM), key=len, reverse=True)
        used, ran = set(), 0
        for page in documents.pages(ROOT):
            name = str(page.relative_to(ROOT))
            for number, command in documents.commands(page):
                is_ours = re.match(r"(build/)?softfinger ", command)
                with self.subTest(f"{name}:{number}: {command}"):
                    if (name, command) in ELSEWHERE:
                        used.add((name, command))
                        variant = ELSEWHERE[name, command][1]
                        if variant is not None:
                            self.run_command(variant)
                    elif is_ours and (documents.is_synopsis(command) or self.is_only_named(command)):
                        self.check_synopsis(command)
                    elif is_ours:
                        self.run_command(command)
                        ran += 1
                    else:
                        self.check_work(command)
        self.assertGreater(ran, 25)
        self.assertEqual(set(ELSEWHERE) - used, set(), "listed above and no longer on the pages")


unittest.main(argv=sys.argv[:1])
