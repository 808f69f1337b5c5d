"""clients/csharp against a real softfinger, and against servers that answer otherwise.

    client_test.py PROGRAM SOURCE_FOLDER
"""

import base64
import contextlib
import hashlib
import json
import math
import pathlib
import socket
import sqlite3
import struct
import sys
import tempfile
import threading
import unittest

import mono

PROGRAM, ROOT = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
HERE, CLIENT = ROOT / "tests/csharp", ROOT / "clients/csharp"
PLANE = ROOT / "scenes/plane.toml"
#: The device that loads fastest.
PLATE = "--device", ROOT / "devices/plate-2dof.toml"
#: On both fingers of a scene that two of them touch.
PLATES = [word for finger in ("index", "thumb") for word in ("--device", f"{finger}={ROOT / 'devices/plate-2dof.toml'}")]
test = None


def setUpModule():
    global test
    test = mono.Compiled(CLIENT / "src", HERE / "Check.cs", HERE / "ClientTest.cs")
    unittest.addModuleCleanup(test.close)


@contextlib.contextmanager
def answering(*messages, close=None, status="101 Switching Protocols"):
    """A WebSocket server of one visitor: sends these texts and bytes, closes with (code, reason)."""

    def frame(opcode, content):
        size = len(content)
        length = bytes([size]) if size < 126 else b"\x7e" + struct.pack(">H", size) if size < 65536 else b"\x7f" + struct.pack(">Q", size)
        return bytes([0x80 | opcode]) + length + content

    def serve():
        with contextlib.suppress(OSError):
            visitor, _ = listener.accept()
            with visitor:
                request = b""
                while b"\r\n\r\n" not in request:
                    request += visitor.recv(4096)
                key = next(line.split(b":")[1].strip() for line in request.split(b"\r\n") if line.lower().startswith(b"sec-websocket-key"))
                accept = base64.b64encode(hashlib.sha1(key + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest()).decode()
                visitor.sendall(f"HTTP/1.1 {status}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {accept}\r\n"
                                "Content-Length: 0\r\n\r\n".encode())
                for message in messages:
                    visitor.sendall(frame(1, message.encode()) if isinstance(message, str) else frame(2, message))
                if close:
                    visitor.sendall(frame(8, struct.pack(">H", close[0]) + close[1].encode()))
                visitor.shutdown(socket.SHUT_WR)
                while visitor.recv(4096):
                    pass

    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        finally:
            with contextlib.suppress(OSError):
                listener.shutdown(socket.SHUT_RDWR)
            thread.join()


SCENE = {"type": "scene", "protocol_version": 2, "generation": 3, "scene": "none", "scenes": [], "duration_s": 0, "objects": [], "fingers": [],
         "notices": [], "objectives": [], "device_states": [], "latency_stages": []}


#: A snapshot of that, up to the number of its soft objects.
EMPTY = b"SFSA" + struct.pack("<3I", 3, 0, 0) + bytes(36)


def sensing_device(folder):
    """One that feels what it presses."""
    device = pathlib.Path(folder) / "sensing.toml"
    device.write_text((ROOT / "devices/thimble-3rrs.toml").read_text() + '\n[force_sensor]\nkind = "emulator"\n')
    return device


def scene(**changed):
    return json.dumps({key: value for key, value in (SCENE | changed).items() if value is not None})


def numbers_of(blob):
    return struct.unpack(f"<{len(blob) // 8}d", blob)


class Client(unittest.TestCase):
    def passes(self, *arguments):
        status, out, error = test.run(*arguments)
        self.assertEqual(status, 0, out[-2000:] + error)
        return out

    def test_snapshots_are_what_was_computed_and_contact_prints_them(self):
        contact = mono.Compiled(CLIENT / "src", CLIENT / "examples/Contact.cs")
        self.addCleanup(contact.close)
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder) / "run.sqlite"
            with mono.softfinger(PROGRAM, PLANE, "--record", recording, twin=True) as address:
                printing = contact.start(address)
                told = [line.split() for line in self.passes("watch", address).splitlines()]
                rows = [printing.stdout.readline().split()]
                while rows[-1] and (len(rows) < 5 or float(rows[-1][2]) < 0.1):
                    rows.append(printing.stdout.readline().split())
            with contextlib.closing(sqlite3.connect(recording)) as database:
                database.row_factory = sqlite3.Row
                steps = {row["step"]: dict(row) for row in database.execute("SELECT * FROM steps")}
                ticks = {row["tick"]: dict(row) for row in database.execute("SELECT * FROM ticks")}
        self.compare(told, steps, ticks)
        # It ends with the program. Read to the end by the same reader, which may hold a part of a line already.
        rows += [line.split() for line in printing.stdout]
        self.assertEqual((printing.stderr.read(), printing.wait(mono.PATIENCE_S)), ("", 0))
        self.assertTrue(all(row[1] == "s" and row[3] == "N" for row in rows), rows)
        self.assertEqual(sorted(float(row[0]) for row in rows), [float(row[0]) for row in rows])
        self.assertEqual(contact.run("nowhere://")[0], 2)
        status, out, error = contact.run("127.0.0.1:1")
        self.assertEqual((status, out), (1, ""))
        self.assertEqual(error, "Contact: http://127.0.0.1:1: nobody answers: is softfinger running, and its page there?\n")

    def compare(self, told, steps, ticks):
        self.assertGreaterEqual(len(told), 20)
        compared, compared_ticks, pressed = 0, 0, 0
        for line in told:
            *numbers, state = line
            step, time, normal, tangential, area, normal_sum, slip, *rest = map(float, numbers)
            position, turn, (tick, deviation), configuration, joints = rest[:3], rest[3:7], rest[7:9], rest[9:12], rest[12:]
            if int(step) not in steps:
                continue  # the state at the very end or beginning
            row = steps[int(step)]
            compared += 1
            pressed += normal > 0.1
            self.assertAlmostEqual(time, row["time_s"], delta=1.5e-3)
            for found, name in ((normal, "normal_force_N"), (tangential, "tangential_force_N"), (area, "contact_area_m2"),
                                (normal_sum, "normal_force_sum_N"), (slip, "slip_ratio")):
                self.close([found], [row[name]], name, 1e-12)
            self.close(position, [row[f"bone_{axis}_m"] for axis in "xyz"], "X_WF", 1e-9)
            self.close([abs(part) for part in turn], [abs(row[f"bone_q{part}"]) for part in "wxyz"], "X_WF", 1e-7)
            if int(tick) in ticks:
                row = ticks[int(tick)]
                self.assertEqual(len(configuration), 3)
                self.close(configuration, numbers_of(row["configuration"]), "configuration", 1e-9)
                self.close(joints, numbers_of(row["joints_rad"]), "joints", 1e-7)
                self.close([deviation], [row["deviation_m2"]], "deviation", 1e-15)
                compared_ticks += 1
            self.assertIn(state, ("homing", "ready", "rendering", "holding", "retracting"))
        self.assertGreaterEqual(compared, 18)
        self.assertGreaterEqual(compared_ticks, 10)
        self.assertGreaterEqual(pressed, 9)

    def close(self, found, wanted, name, least):
        """To a float32 of the wire, in other units."""
        self.assertEqual(len(found), len(wanted), name)
        for one, other in zip(found, wanted):
            self.assertTrue(math.isclose(one, other, rel_tol=5e-7, abs_tol=least), (name, found, wanted))

    def test_requests(self):
        with tempfile.TemporaryDirectory() as folder:
            token = pathlib.Path(folder) / "token.txt"
            token.write_text("0123456789abcdef0123456789abcdef\n")
            token.chmod(0o600)
            with mono.softfinger(PROGRAM, PLANE, *PLATE, "--tracker", "page", "--token", token) as address:
                self.passes("token", address, address.split("/?")[0])
                self.passes("spoil", address)
                for case in ("refuse", "move", "stop", "choose"):
                    with self.subTest(case):
                        self.passes(case, address)

    def test_an_object_is_taken_and_let_go(self):
        with mono.softfinger(PROGRAM, ROOT / "scenes/tower.toml", *PLATE, "--repeat") as address:
            self.passes("hold", address)

    def test_a_soft_object_is_told_as_it_deforms(self):
        with mono.softfinger(PROGRAM, ROOT / "scenes/sponge.toml", *PLATES) as address:
            self.passes("soft", address)

    def test_events_of_objects_are_told(self):
        with mono.softfinger(PROGRAM, ROOT / "scenes/button.toml", *PLATE, "--repeat") as address:
            self.passes("events", address)

    def test_a_hand_moves_the_finger(self):
        with mono.softfinger(PROGRAM, PLANE, *PLATE, "--tracker", "webxr") as address:
            self.passes("hand", address)

    def test_a_device_learns_its_wearer_until_that_is_cancelled(self):
        with tempfile.TemporaryDirectory() as folder:
            with mono.softfinger(PROGRAM, PLANE, "--device", sensing_device(folder), "--person", pathlib.Path(folder) / "anna.toml") as address:
                self.passes("fit", address)

    def test_other_answers_are_told_in_one_line(self):
        for says, messages, more in (
            ("speaks protocol 3, this client 2", [scene(protocol_version=3)], {}),
            ("a message: not JSON: at character 2", ["{"], {}),
            ("a message: type is missing", ["{}"], {}),
            ("a message: fingers is missing", [scene(fingers=None)], {}),
            ("a message: generation: a whole number from 0", [scene(generation=-1)], {}),
            ("speaks protocol 1, this client 2", [scene(protocol_version=None)], {}),
            ("a snapshot before any scene", [b"SFSA"], {}),
            ("a snapshot does not begin with SFSA", [scene(), b"SFS9" + bytes(48)], {}),
            ("a snapshot: cut short after 8 bytes", [scene(), b"SFSA" + struct.pack("<I", 3)], {}),
            ("a snapshot: of object 7, the scene has 0", [scene(), EMPTY + struct.pack("<4I", 1, 7, 0, 0)], {}),
            ("refused what this client sent: more than any page sends", [scene()], {"close": (1008, "more than any page sends")}),
            ("no page of softfinger", [], {"status": "200 OK"}),
            ("nobody answers", [], {}),
            # What a later version may say is skipped.
            ("ended", [scene(), '{"type": "song"}', b"SFSA" + struct.pack("<I", 4)], {"close": (1000, "")}),
            ("ended", [scene()], {}),
        ):
            with self.subTest(says), answering(*messages, **more) as address:
                self.passes("answer", address, says)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
