"""The Python package against the command line, to the bit, and what it refuses.

    package_test.py PROGRAM SOURCE_FOLDER
"""

import ctypes
import contextlib
import csv
import gc
import json
import math
import pathlib
import re
import resource
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import softfinger as sf

PROGRAM, ROOT = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
PLANE, FINGER = ROOT / "scenes/plane.toml", ROOT / "fingers/index.toml"
THIMBLE = ROOT / "devices/thimble-3rrs.toml"


def command_line(*arguments):
    run = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True)
    return json.loads(run.stdout) if "--json" in arguments else run.stdout


def touching_poses(seconds):
    """(n, 7) once a millisecond: down into the table, tipping and sliding, and half way up again."""
    time = np.arange(round(1000 * seconds) + 1) / 1000
    depth = np.minimum(time, 1.5 * seconds - time) / seconds
    half = 0.05 + 0.05 * depth
    nothing = np.zeros_like(time)
    return time, np.stack([2e-3 * depth, nothing, 8.5e-3 - 4e-3 * depth, np.cos(half), nothing, np.sin(half), nothing], 1)


def recorded_steps(recording):
    """All that was computed in each step, with the hash of the whole state; without the clocks."""
    with contextlib.closing(sqlite3.connect(recording)) as database:
        rows = database.execute("SELECT * FROM steps ORDER BY step")
        names = [column[0] for column in rows.description]
        kept = [i for i, name in enumerate(names) if name not in ("cpu_s", "wall_s")]
        return [tuple(row[i] for i in kept) for row in rows]


def numbers(columns, names):
    return {name: columns[name].tolist() for name in names}


class SameBits(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_an_exploration_is_that_of_the_command_line(self):
        time, poses = touching_poses(0.8)
        # What both read alike: numbers that are written out, in mm.
        written = [[f"{t:.3f}", *(f"{1e3 * p:.6f}" for p in pose[:3]), *(repr(float(q)) for q in pose[3:])]
                   for t, pose in zip(time, poses)]
        poses = np.array([[float(p) * 1e-3 for p in row[1:4]] + [float(q) for q in row[4:]] for row in written])
        file = self.folder / "pose.csv"
        file.write_text("\n".join(["time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz", *map(",".join, written)]) + "\n")
        run = self.folder / "run.sqlite"
        command_line("run", PLANE, "--headless", "--as-fast-as-possible", "--tracker", f"csv:{file}", "--record", run)
        ours = self.folder / "ours.sqlite"
        with sf.Rendering(PLANE, record=ours) as rendering:
            told = rendering.step_many(poses, time)
        self.assertEqual(recorded_steps(ours), recorded_steps(run))
        recording = sf.Recording(ours)
        self.assertGreater(told["normal_force_N"].max(), 0.3)
        np.testing.assert_allclose(told["normal_force_N"], recording.steps["normal_force_N"], rtol=1e-11)
        np.testing.assert_allclose(recording.poses, poses, atol=1e-11)
        self.assertEqual(len(recording.ticks["state"]), len(set(told["tick"])) - (told["tick"][0] < 0))
        self.assertEqual(recording.replay(), "")
        self.assertEqual(recording.note, "")
        self.same_as_the_exported(recording, ours)
        for name, begin in (("run.h5", b"\x89HDF\r\n"), ("run.mcap", b"\x89MCAP0")):
            recording.export(pathlib.Path(ours).with_name(name))
            self.assertTrue(pathlib.Path(ours).with_name(name).read_bytes().startswith(begin))
        with self.assertRaisesRegex(sf.InputError, r"\.mcap \(MCAP\)"):
            recording.export(pathlib.Path(ours).with_name("run.txt"))

    def same_as_the_exported(self, recording, file):
        command_line("export", file, "--to", self.folder / "csv")
        self.assertEqual(recording.tables, sorted(table.stem for table in (self.folder / "csv").glob("*.csv")))
        for name in recording.tables:
            with (self.folder / "csv" / f"{name}.csv").open(newline="") as stream:
                header, *rows = csv.reader(stream)
            table = recording.table(name)
            self.assertEqual(list(table), header)
            for column, texts in zip(header, zip(*rows)):
                if table.units[column]:
                    np.testing.assert_allclose(table[column], [float(text or "nan") for text in texts], rtol=1e-11, err_msg=column)
                else:
                    self.assertEqual(table[column].tolist(), list(texts), column)
        self.assertEqual((recording.steps.units["normal_force_N"], recording.ticks.units["pitch_deg"]), ("N", "deg"))
        self.assertEqual((recording.ticks.units["state"], recording.steps.units["slip_ratio"]), ("", "1"))

    def test_an_object_is_where_its_caller_has_it(self):
        """The plane comes up to a finger that stays: the same as the finger that goes down, but for gravity's side."""
        down, up = 2.5e-3, np.eye(4)
        times = np.arange(0.0, 0.5, 2e-3)
        with sf.Rendering(PLANE) as goes, sf.Rendering(PLANE) as stays:
            for moment in times:
                depth = down * min(moment / 0.3, 1.0)
                goes.step([0, 0, 8.5e-3 - depth, 1, 0, 0, 0], moment)
                up[2, 3] = depth
                stays.move_object(0, up)
                stays.step([0, 0, 8.5e-3, 1, 0, 0, 0], moment)
            np.testing.assert_allclose(stays.snapshot().X_WO[0], up)
            self.assertGreater(goes.snapshot().normal_force, 0.1)
            self.assertAlmostEqual(stays.snapshot().normal_force, goes.snapshot().normal_force, delta=0.02 * goes.snapshot().normal_force)
            with self.assertRaisesRegex(sf.InputError, "object_count"):
                stays.move_object(1, up)
            with self.assertRaisesRegex(sf.InputError, "1000 m"):
                stays.move_object(0, np.full(7, np.nan))
        with sf.Rendering(PLANE, record=self.folder / "moved.sqlite") as recorded, self.assertRaisesRegex(sf.InputError, "recording"):
            recorded.move_object(0, up)
        with sf.Rendering("cup", all_fingers=True) as cup, self.assertRaisesRegex(sf.InputError, "moves by forces"):
            cup.move_object(0, up)

    def test_a_press_is_that_of_the_command_line(self):
        for flags, words in (
            (["--to-mm", "1"], {"to_mm": 1}),
            (["--to-mm", "0.7", "--sphere-mm", "6", "--at-mm", "1,-2", "--no-friction", "--angle-deg", "20"],
             {"to_mm": 0.7, "sphere_mm": 6, "at_mm": (1, -2), "friction": False, "angle_deg": 20}),
            (["--to-mm", "0.5", "--edge", "--edge-radius-mm", "2", "--no-strain-limits"],
             {"to_mm": 0.5, "edge": True, "edge_radius_mm": 2, "strain_limits": False}),
        ):
            rows = command_line("press", FINGER, "--steps", "3", *flags, "--json")
            columns = sf.press(FINGER, steps=3, **words)
            self.assertEqual(list(columns), list(rows[0]))
            self.assertEqual({name: [row[name] for row in rows] for name in rows[0]}, numbers(columns, rows[0]))
            self.assertGreater(columns["normal_force_N"][-1], 0.01)

    def test_an_evaluation_is_that_of_the_command_line(self):
        device = ROOT / "devices/membrane.toml"
        report = command_line("evaluate", PLANE, "--device", device, "--duration-s", "1.6", "--json")
        judged = sf.evaluate(PLANE, device=device, duration_s=1.6)
        self.assertEqual(judged.mean, report["mean"])
        self.assertEqual(judged.verdict, report["verdict"])
        self.assertIsNotNone(judged.mean["iou"])
        for name in ("time_s", "iou", "normal_force_error", "virtual_force_N", "twin_force_N"):
            expected = [math.nan if frame[name] is None else frame[name] for frame in report["frames"]]
            np.testing.assert_array_equal(judged.frames[name], expected, name)

    def test_a_run_is_that_of_the_command_line(self):
        theirs, ours = self.folder / "theirs.sqlite", self.folder / "ours.sqlite"
        report = command_line("run", PLANE, "--headless", "--as-fast-as-possible", "--duration-s", "1.2", "--record", theirs, "--json")
        told = sf.run(PLANE, duration_s=1.2, record=ours)
        self.assertEqual(list(told), list(report))
        self.assertEqual(told["steps"], 1200)
        self.assertEqual(recorded_steps(ours), recorded_steps(theirs))
        self.assertGreater(sf.Recording(ours).steps["normal_force_N"].max(), 0.1)

    def test_nodes_of_soft_objects_are_recorded_and_replayed(self):
        file = self.folder / "sponge.sqlite"
        sf.run("sponge", record=file, record_state=True, duration_s=0.02)
        recording = sf.Recording(file)
        nodes = recording.table("object_nodes")
        self.assertEqual(set(nodes["object"]), {"sponge"})
        self.assertEqual(len(nodes["time_s"]), 21 * (int(nodes["node"].max()) + 1))
        self.assertEqual(recording.replay(), "")
        with contextlib.closing(sqlite3.connect(file)) as database:
            blob = bytearray(database.execute("SELECT nodes FROM object_states WHERE step = 7").fetchone()[0])
            blob[0] ^= 1
            database.execute("UPDATE object_states SET nodes = ? WHERE step = 7", (bytes(blob),))
            database.commit()
        self.assertIn("object sponge", recording.replay())
        with self.assertRaisesRegex(sf.InputError, "table beauty: there is .*object_nodes"):
            recording.table("beauty")

    def test_a_fit_is_that_of_the_command_line(self):
        curve, ours, theirs = self.folder / "press.csv", self.folder / "ours.toml", self.folder / "theirs.toml"
        pressed = sf.press(FINGER, to_mm=0.8, steps=5)
        rows = zip(pressed["indentation_mm"], pressed["normal_force_N"], (1.01, 0.99, 1.0, 1.01, 0.99))
        curve.write_text("indentation_mm,force_N\n" + "".join(f"{d},{f * noise}\n" for d, f, noise in rows))
        report = command_line("finger", "fit", FINGER, "--data", curve, "--out", theirs, "--parameters", "youngs_modulus_kPa", "--json")
        found = sf.fit(FINGER, curve, out=ours, parameters=("youngs_modulus_kPa",))
        self.assertEqual({**found.report, "out": None}, {**report, "out": None})
        self.assertEqual(ours.read_text(), theirs.read_text())
        self.assertAlmostEqual(found.parameters["youngs_modulus_kPa"].value, 26.0, delta=1.0)

    def test_what_files_say_is_that_of_the_command_line(self):
        self.assertEqual(sf.check_scene("cup"), command_line("scene", "check", "cup", "--json"))
        self.assertEqual(sf.show_finger(FINGER), command_line("finger", "show", FINGER, "--json"))
        self.assertEqual(sf.schema("scene"), json.loads(command_line("scene", "schema")))
        self.assertEqual(sf.schema("finger"), json.loads(command_line("finger", "schema")))
        self.assertEqual(sf.schema("person"), json.loads(command_line("finger", "schema", "--person")))
        self.assertEqual(sf.schema("device"), json.loads(command_line("device", "schema")))
        self.assertEqual(sf.schema("device", "membrane"), json.loads(command_line("device", "schema", "membrane")))
        for device in ("thimble-3rrs", "membrane"):
            self.assertEqual(sf.Device(device).workspace(), command_line("device", "workspace", device, "--json"))

    def test_a_study_is_that_of_the_command_line(self):
        """Of a device alone, which takes no time; cut in shards, read while it goes on, and taken together."""
        study = self.folder / "travel.toml"
        study.write_text(f"""device = "{THIMBLE}"
[vary]
device.geometry.disk_radius_mm = {{ values = [6, 8, 10] }}
[objectives]
gap = {{ formula = "12 - device.geometry.disk_radius_mm" }}
[constraints]
broad = {{ formula = "device.geometry.disk_radius_mm", at_least = 7 }}
[design]
kind = "grid"
""")
        ours, theirs = self.folder / "ours", self.folder / "theirs"
        command_line("study", study, "--out", theirs)
        command_line("study", "export", theirs, "--to", self.folder / "theirs.csv")
        self.assertEqual(sf.study(study, ours, shard=(1, 2))["end"], "shard done")
        self.assertEqual(sf.study(study, ours, shard=(2, 2))["end"], "shard done")
        report = sf.study(study, ours)
        self.assertEqual((report["end"], report["designs"], report["infeasible"]), ("finished", 3, 1))
        self.assertEqual(report["recorded"], report["cases"])
        found = sf.Study(ours)
        self.assertTrue(found.finished)
        self.assertEqual((found.parameters, found.objectives, found.constraints),
                         (["device.geometry.disk_radius_mm"], ["gap"], ["broad"]))
        self.assertEqual(found.table["device.geometry.disk_radius_mm"].tolist(), [6.0, 8.0, 10.0])
        self.assertEqual(found.table["feasible"].tolist(), ["false", "true", "true"])
        self.assertIn("broad", found.table["reason"][0])
        self.assertEqual(found.table.units["device.geometry.disk_radius_mm"], "mm")
        self.assertEqual(found.export(self.folder / "ours.csv"), "")
        self.assertEqual((self.folder / "ours.csv").read_bytes(), (self.folder / "theirs.csv").read_bytes())
        found.export_device(2, self.folder / "best.toml")
        self.assertEqual(sf.Device(self.folder / "best.toml").show()["geometry"]["disk_radius_mm"], 10.0)
        self.assertIn("<svg", found.plot(self.folder / "page").read_text())
        study.write_text(study.read_text().replace("at_least = 7", "at_least = 8"))
        with self.assertRaisesRegex(sf.InputError, "ours"):
            sf.study(study, ours)

    def test_a_finger_is_registered_as_by_the_command_line(self):
        report = command_line("finger", "register", "--person", self.folder / "theirs.toml", "--finger", "ring", "--breadth-mm", "15.5",
                              "--json")
        told = sf.register_finger(self.folder / "ours.toml", finger="ring", breadth_mm=15.5)
        self.assertEqual({**told, "person": None}, {**report, "person": None})
        self.assertEqual((self.folder / "ours.toml").read_text(), (self.folder / "theirs.toml").read_text())
        # A body that is held still, in one posture alone, tells nothing; what is asked for is told.
        poses = self.folder / "body.csv"
        poses.write_text("time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n" + "".join(f"{0.1 * i:.1f},30,0,20,1,0,0,0\n" for i in range(30)))
        asked = []
        with self.assertRaisesRegex(sf.InputError, "^tracker csv:.*ends before posture"):
            sf.register_finger(self.folder / "none.toml", tracker=f"csv:{poses}", model=FINGER, ask=asked.append)
        self.assertFalse((self.folder / "none.toml").exists())

    def test_servos_are_calibrated_as_by_the_command_line(self):
        device, written = ROOT / "devices/thimble-3rrs-feetech.toml", 0
        for number, at in enumerate(([31.6, 31.6, 31.6], [31.6, 31.0, 32.0], [1000.0, 31.6, 31.6])):
            theirs, ours = self.folder / f"theirs{number}.toml", self.folder / f"ours{number}.toml"
            run = subprocess.run([PROGRAM, "device", "calibrate", device, "--out", theirs, "--at", ",".join(map(str, at)), "--moved", "10,10,10"],
                                 capture_output=True, text=True, check=False)
            if run.returncode == 0:
                lines = sf.calibrate_device(device, ours, at=at, moved=[10.0, 10.0, 10.0])
                self.assertEqual(ours.read_text(), theirs.read_text())
                self.assertRegex(lines[2], "^joint 3 reaches .* degrees$")
                written += 1
            else:
                with self.assertRaises(sf.InputError) as refused:
                    sf.calibrate_device(device, ours, at=at, moved=[10.0, 10.0, 10.0])
                self.assertEqual(f"softfinger: {refused.exception}\n", run.stderr.replace(str(theirs), str(ours)))
                self.assertFalse(ours.exists())
        self.assertIn(written, (1, 2))
        with self.assertRaisesRegex(sf.InputError, "^at and moved: need 3 numbers each"):
            sf.calibrate_device(device, self.folder / "short.toml", at=[1.0], moved=[1.0])

    def test_conditioning_is_that_of_the_command_line(self):
        poses = self.folder / "poses.csv"
        poses.write_text("time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n" + "".join(
            f"{0.01 * i:.2f},{20 * math.sin(0.05 * i):.6f},0,20,1,0,0,0\n" for i in range(200)))
        report = command_line("condition", poses, "--filter", "--predict-ms", "12", "--noise-mm", "0.3", "--json")
        self.assertEqual(sf.condition(poses, filter=True, predict_ms=12, noise_mm=0.3), report)
        with self.assertRaisesRegex(sf.InputError, "^rate_Hz"):
            sf.condition(poses, filter=True, rate_Hz=0)
        with self.assertRaisesRegex(sf.InputError, "filter, predict_ms: give one"):
            sf.condition(poses)

    def test_a_device_learns_its_wearer_as_on_the_command_line(self):
        ours, theirs, middle = self.folder / "ours.toml", self.folder / "theirs.toml", FINGER.parent / "middle.toml"
        found = sf.fit_device(THIMBLE, FINGER, ours, name="middle", wearer=middle, sensor="emulator", sensor_noise_N=0.02)
        self.assertEqual(found["presses"], 9)
        self.assertLess(found["predicted_force_error"], 0.1)
        # Of a finger that is larger than the model's, and felt otherwise; which of three sizes is told may vary.
        self.assertGreater(found["known_force_error"], 5 * found["predicted_force_error"])
        sizes = [found["parameters"][f"{name}_mm"] for name in ("length", "breadth", "depth")]
        self.assertGreater(math.prod(size["value"] for size in sizes), math.prod(size["prior"] for size in sizes))
        told = command_line("device", "fit", THIMBLE, "--finger", FINGER, "--person", theirs, "--name", "middle",
                            "--wearer", middle, "--sensor", "emulator", "--sensor-noise-N", "0.02", "--json")
        self.assertEqual({**found, "written": ""}, {**told, "written": ""})
        self.assertEqual(ours.read_text(), theirs.read_text())

    def test_a_device_learns_its_wearer_by_touch_as_on_the_command_line(self):
        ours, theirs, middle = self.folder / "ours.toml", self.folder / "theirs.toml", FINGER.parent / "middle.toml"
        found = sf.fit_device(THIMBLE, FINGER, ours, wearer=middle, by_touch=True, touches=ctypes.c_int32(0))
        self.assertEqual((found["by"], found["presses"]), ("touches", 10))
        told = command_line("device", "fit", THIMBLE, "--finger", FINGER, "--person", theirs, "--wearer", middle, "--by-touch", "--json")
        self.assertEqual({**found, "written": ""}, {**told, "written": ""})

    def test_a_device_that_cannot_learn_its_wearer_writes_nothing(self):
        person = self.folder / "anna.toml"
        with self.assertRaisesRegex(sf.OperationError, "nothing written"):
            sf.fit_device(THIMBLE, FINGER, person, sensor="emulator", fault="dead")
        with self.assertRaisesRegex(sf.InputError, "^sensor_noise_N 20"):
            sf.fit_device(THIMBLE, FINGER, person, sensor="emulator", sensor_noise_N=20)
        with self.assertRaisesRegex(sf.InputError, "sensor smell: there is emulator"):
            sf.fit_device(THIMBLE, FINGER, person, sensor="smell")
        self.assertFalse(person.exists())

    def test_a_sweep_is_the_same_one_by_one(self):
        files = {26.0: FINGER, 39.0: self.folder / "stiff.toml"}
        files[39.0].write_text(re.sub("(?m)^youngs_modulus_kPa = .*", "youngs_modulus_kPa = 39.0", FINGER.read_text()).replace(
            '"index.msh"', f'"{FINGER.parent}/index.msh"'))
        for threads in (1, 2):
            swept = sf.sweep(sf.press, FINGER, to_mm=0.4, steps=2, threads=threads,
                             vary={"material.youngs_modulus_kPa": np.array([26.0, 39.0]), "bone.mass_g": [10.0, 11.0]})
            self.assertEqual(swept["material.youngs_modulus_kPa"].tolist(), [26.0] * 4 + [39.0] * 4)
            self.assertEqual(swept["bone.mass_g"].tolist(), [10.0, 10.0, 11.0, 11.0] * 2)
            for modulus, file in files.items():
                alone = sf.press(file, to_mm=0.4, steps=2)["normal_force_N"]
                self.assertEqual(swept["normal_force_N"][swept["material.youngs_modulus_kPa"] == modulus].tolist(), [*alone, *alone])
        # By its name, as anywhere else.
        shipped = sf.sweep(sf.press, "index", to_mm=0.4, steps=2, vary={"bone.mass_g": [10.0]})
        self.assertEqual(shipped["normal_force_N"].tolist(), swept["normal_force_N"][:2].tolist())
        self.assertGreater(swept["normal_force_N"][7], 1.3 * swept["normal_force_N"][3])

    def test_a_device_is_that_of_the_command_line(self):
        device = sf.Device(THIMBLE)
        self.assertEqual(device.show(), command_line("device", "show", THIMBLE, "--json"))
        q = device.configuration(pitch_deg=5, travel_mm=1)
        joints, reachable = device.solve(q)
        solved = command_line("device", "solve", THIMBLE, "--configuration", "pitch_deg=5,travel_mm=1", "--json")
        self.assertEqual((joints / (math.pi / 180)).tolist(), solved["joints_deg"])
        self.assertTrue(reachable)
        np.testing.assert_allclose(device.pose(joints), q, atol=1e-9)
        self.assertEqual(list(device.named(q)), ["pitch_deg", "roll_deg", "travel_mm"])
        self.assertIsNone(device.solve(device.configuration(travel_mm=500))[0])
        with self.assertRaises(sf.OperationError):
            device.pose([0.0, 1.5, 0.0])

    def test_a_match_is_that_of_the_command_line(self):
        with sf.Rendering(PLANE) as rendering:
            time, poses = touching_poses(0.3)
            rendering.step_many(poses, time)
            skin = rendering.snapshot()
        self.assertGreater(skin.in_contact.sum(), 3)
        points = self.folder / "points.json"
        in_mm = (skin.sample_positions_F / 1e-3).tolist()
        points.write_text(json.dumps({"points_mm": in_mm, "in_contact": skin.in_contact.tolist()}))
        found = command_line("match", THIMBLE, "--points", points, "--json")
        device = sf.Device(THIMBLE)
        match = device.match(np.array(in_mm) * 1e-3, skin.in_contact, separation=0.2e-3)
        self.assertEqual(device.named(match.configuration), found["configuration"])
        self.assertEqual(match.iterations, found["iterations"])
        self.assertEqual(match.termination, found["termination"])
        self.assertEqual(list(match.at_limit), found["at_limit"])
        for objective in ("published", "plane"):
            found = command_line("match", THIMBLE, "--points", points, "--objective", objective, "--json")
            other = device.match(np.array(in_mm) * 1e-3, skin.in_contact, objective=objective)
            self.assertEqual(device.named(other.configuration), found["configuration"], objective)
            self.assertEqual(list(other.at_limit), found["at_limit"], objective)
        self.assertFalse(np.array_equal(other.configuration, match.configuration))
        with self.assertRaisesRegex(sf.InputError, "published.*clamp"):
            device.match(np.array(in_mm) * 1e-3, skin.in_contact, objective="published", limits="inside")

    def test_all_fingers_of_a_scene_hold_what_moves(self):
        """Index and thumb squeeze the sponge, as matrices and as numbers; the bits are those of the command line."""
        scene, run = ROOT / "scenes/sponge.toml", self.folder / "run.sqlite"
        command_line("run", scene, "--headless", "--as-fast-as-possible", "--duration-s", "0.7", "--record", run)
        recording = sf.Recording(run)
        with contextlib.closing(sqlite3.connect(run)) as database:
            rows = database.execute("SELECT x_m, y_m, z_m, qw, qx, qy, qz FROM steps ORDER BY step, finger").fetchall()
        poses = np.array(rows).reshape(-1, 2, 7)
        with sf.Rendering(scene, all_fingers=True, threads=2) as rendering:
            self.assertEqual([finger.name for finger in rendering.fingers], ["index", "thumb"])
            for step, pair in enumerate(poses):
                commands = rendering.step_all(list(pair), step / 1000)
            self.assertEqual([command.state for command in commands], ["rendering", "rendering"])
            index, thumb = (finger.snapshot() for finger in rendering.fingers)
            forces = recording.steps["normal_force_N"].reshape(-1, 2)[-1]
            self.assertGreater(forces.min(), 0.1)
            np.testing.assert_allclose([index.normal_force, thumb.normal_force], forces, rtol=1e-11)
            self.assertEqual(rendering.fingers[1].configuration_names, ["pitch_deg", "roll_deg", "travel_mm"])
            sponge, table = rendering.object(0), rendering.object(1)
            self.assertTrue(sponge.moves and sponge.soft and sponge.joint is None and not table.moves)
            surface, triangles = rendering.object_positions(0), rendering.object_triangles(0)
            self.assertEqual(triangles.max() + 1, len(surface))
            np.testing.assert_allclose(surface.mean(0)[:2], sponge.X_WO[:2, 3], atol=2e-3)
            self.assertEqual(rendering.object_positions(1).shape, (0, 3))
            met = {event.other: event for event in rendering.events() if event.kind == "impact"}
            self.assertLessEqual({"index", "thumb"}, set(met))
            self.assertEqual(met["index"].object, "sponge")
            self.assertEqual(rendering.events(), [])
            # The thumb is lost: its device retracts.
            for step in range(300):
                commands = rendering.step_all([sf.matrix_of(poses[-1, 0, :3], poses[-1, 0, 3:]), None], 0.701 + step / 1000)
            self.assertEqual([command.state for command in commands], ["rendering", "retracting"])
            with self.assertRaisesRegex(sf.InputError, "there must be 2 poses, there are 1"):
                rendering.step_all([np.eye(4)], 2)
            with self.assertRaisesRegex(sf.InputError, "several fingers"):
                rendering.step(np.eye(4), 2)
            with self.assertRaisesRegex(sf.InputError, "quaternion"):
                rendering.step_all([np.zeros((4, 4)), None], 2)


class Refusals(unittest.TestCase):
    def test_a_wrong_file_is_told_by_its_place(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "device.toml")
            file.write_text(THIMBLE.read_text().replace("crank_mm", "krank_mm"))
            with self.assertRaises(sf.InputError) as refused:
                sf.Device(file)
        self.assertEqual(refused.exception.file, str(file))
        self.assertGreater(refused.exception.line, 1)
        self.assertIn("crank_mm", str(refused.exception))
        self.assertIsInstance(refused.exception, ValueError)

    def test_what_is_no_pose_or_no_time(self):
        with sf.Rendering(PLANE) as rendering:
            rendering.step(np.eye(4), 1.0)
            for pose, time in ((np.eye(3), 2.0), (np.zeros(7), 2.0), (np.full((4, 4), np.nan), 2.0), (np.eye(4), 0.5),
                               (np.eye(4), math.nan), (2 * np.eye(4), 2.0)):
                with self.assertRaises(sf.InputError, msg=f"{pose} {time}"):
                    rendering.step(pose, time)
            for kind in (np.float32, np.int64, int):
                rendering.step(np.eye(4), kind(2))
            for time in ("soon", None, np.zeros(2)):
                for call in (lambda: rendering.step(np.eye(4), time), lambda: rendering.lost(time)):
                    with self.assertRaisesRegex(sf.InputError, "must be a number of seconds"):
                        call()
            with self.assertRaises(sf.InputError):
                rendering.step_many(np.zeros((3, 4, 4)), np.zeros(2))

    def test_a_rendering_that_has_ended(self):
        rendering = sf.Rendering(PLANE)
        rendering.close()
        rendering.close()
        for call in (rendering.snapshot, rendering.stop, lambda: rendering.step(np.eye(4), 0.0)):
            with self.assertRaisesRegex(sf.InputError, "has ended"):
                call()

    def test_a_second_thread_in_one_rendering(self):
        refused = []

        def steps(rendering):
            for _ in range(100):
                try:
                    rendering.step_many(np.stack([np.eye(4)] * 5), time[0] + 0.01 * np.arange(5))
                except sf.InputError as error:
                    refused.append(str(error))
                time[0] += 0.1

        time = [0.0]
        with sf.Rendering(PLANE) as rendering:
            threads = [threading.Thread(target=steps, args=(rendering,)) for _ in range(2)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            rendering.step(np.eye(4), time[0] + 1.0)
        self.assertTrue(any("thread" in line for line in refused), refused[:3])

    def test_options_that_are_wrong(self):
        for options in ({"finger": "thumb"}, {"predict_s": 0.2}, {"device": "/no/such.toml"}, {"person": "/no/such.toml"}):
            with self.assertRaises(sf.InputError):
                sf.Rendering(PLANE, **options)
        for options in ({"to_mm": 0}, {"to_mm": -1}, {"steps": 0}, {"hold_ms": 5}, {"sphere_mm": 3, "edge": True}):
            with self.assertRaises(sf.InputError, msg=options):
                sf.press(FINGER, **options)
        with self.assertRaisesRegex(sf.InputError, "there is .*surface"):
            sf.evaluate(PLANE, objective="beauty")
        for options in ({"record_state": True}, {"threads": 100}, {"duration_s": -1.0}, {"device": "/no/such.toml"}):
            with self.assertRaises(sf.InputError, msg=options):
                sf.run(PLANE, **options)
        with self.assertRaisesRegex(sf.InputError, "noise beauty: there are likelier"):
            sf.fit(FINGER, "/no/such.csv", noise="beauty")
        with self.assertRaisesRegex(sf.InputError, "/no/such.csv"):
            sf.fit(FINGER, "/no/such.csv")

    def test_sweeps_that_are_wrong_name_the_file_that_was_given(self):
        for vary, words in (({"material.youngs_modulus_kPa": [-1.0]}, "fingers/index.toml:.*youngs_modulus_kPa"),
                            ({"material.beauty": [1.0]}, "fingers/index.toml:.*beauty"),
                            ({"bone.mass_g.deep": [1.0]}, "not a key of a table"), ({}, "names no key"),
                            ({"bone.mass_g": []}, "no values")):
            with self.assertRaisesRegex(sf.InputError, words):
                sf.sweep(sf.press, FINGER, to_mm=0.2, steps=1, vary=vary)
        with self.assertRaisesRegex(sf.InputError, "/no/such.toml: No such file"):
            sf.sweep(sf.press, "/no/such.toml", vary={"bone.mass_g": [1.0]})

    def test_ctrl_c_ends_a_long_run_and_leaves_its_recording_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder, "run.sqlite")
            interrupt = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
            interrupt.start()
            with self.assertRaises(KeyboardInterrupt):
                sf.run(ROOT / "scenes/hand.toml", record=recording, duration_s=60)
            # Where it came while the scene loaded, nothing was begun.
            if recording.exists():
                self.assertEqual(sf.Recording(recording).replay(), "")


    def test_ctrl_c_ends_what_is_done_with_a_recording_and_leaves_nothing_of_it(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "run.sqlite")
            sf.run(ROOT / "scenes/hand.toml", record=file, record_state=True, duration_s=0.8)
            recording = sf.Recording(file)
            before = set(pathlib.Path(folder).iterdir())
            for work in (recording.replay, *(lambda to=to: recording.export(pathlib.Path(folder, to)) for to in ("csv", "run.h5", "run.mcap")),
                         lambda: recording.table("nodes")):
                interrupt = threading.Timer(0.15, signal.raise_signal, [signal.SIGINT])
                interrupt.start()
                began = time.monotonic()
                with self.assertRaises(KeyboardInterrupt):
                    work()
                self.assertLess(time.monotonic() - began, 2.0)
                self.assertEqual(set(pathlib.Path(folder).iterdir()), before)
            self.assertEqual(recording.replay(), "")

    def test_ctrl_c_ends_a_study_which_goes_on_later(self):
        with tempfile.TemporaryDirectory() as folder:
            interrupt = threading.Timer(1.0, signal.raise_signal, [signal.SIGINT])
            interrupt.start()
            with self.assertRaises(KeyboardInterrupt):
                sf.study("disk", pathlib.Path(folder, "disk"))
            self.assertFalse(sf.Study(pathlib.Path(folder, "disk")).finished)

    def test_ctrl_c_ends_a_long_press(self):
        interrupt = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
        interrupt.start()
        # Minutes, but for that.
        with self.assertRaises(KeyboardInterrupt):
            sf.press(ROOT / "fingers/index-medium.toml", to_mm=3, steps=10000)

    def test_names_that_end_within(self):
        for call in (lambda: sf.Rendering(PLANE, device="membrane\0.toml"), lambda: sf.press("index\0"), lambda: sf.Rendering("plane\0"),
                     lambda: sf.Rendering(PLANE, finger="index\0"), lambda: sf.Rendering(PLANE, finger=3)):
            with self.assertRaisesRegex(sf.InputError, "zero"):
                call()


class WhatItGives(unittest.TestCase):
    def test_snapshots_are_copies(self):
        time, poses = touching_poses(0.3)
        with sf.Rendering(PLANE) as rendering:
            self.assertEqual(rendering.configuration_names, ["pitch_deg", "roll_deg", "travel_mm"])
            self.assertEqual(rendering.object_names, ["table"])
            self.assertEqual((rendering.simulation_rate, rendering.device_rate), (1000.0, 30.0))
            rendering.step(poses[0], 0.0)
            before = rendering.snapshot()
            kept = before.sample_positions_F.copy()
            command = rendering.step_many(poses, time + 1.0)[-1]
            after = rendering.snapshot()
            self.assertEqual(rendering.skin_triangles.max() + 1, len(kept))
            np.testing.assert_array_equal(before.sample_positions_F, kept)
            self.assertFalse((after.sample_positions_F == kept).all())
            with self.assertRaises(ValueError):
                after.sample_positions_F[0, 0] = 1.0
            self.assertGreater(after.normal_force, 0.1)
            self.assertGreater(after.sample_pressures.max(), 0.0)
            self.assertEqual(after.X_WO.shape, (1, 4, 4))
            np.testing.assert_allclose(after.X_WFt, sf.matrix_of(poses[-1][:3], poses[-1][3:]), atol=1e-12)
            self.assertGreater(after.X_WF[2, 3], after.X_WFt[2, 3])
            self.assertEqual(command["joints"].shape, (3,))

    def test_stop_and_release(self):
        with sf.Rendering(PLANE) as rendering:
            self.assertFalse(rendering.release())
            pose = touching_poses(0.3)[1][-1]

            def hold(begin, end):
                for time in np.arange(begin, end, 4e-3):
                    command = rendering.step(pose, time)
                return command

            self.assertEqual(hold(0.0, 2.0).state, "rendering")
            rendering.stop()
            command = hold(2.0, 3.0)
            self.assertTrue(command.stopped and command.stop_confirmed)
            self.assertEqual((command.state, command.stops), ("retracting", 1))
            self.assertTrue(rendering.release())
            self.assertFalse(hold(3.0, 4.0).stopped)

    def test_what_people_should_know_of_a_device_is_told_once(self):
        with tempfile.TemporaryDirectory() as folder:
            device = pathlib.Path(folder, "device.toml")
            device.write_text(re.sub(r"(?m)^approach_mm = .*", "approach_mm = 12.0", THIMBLE.read_text()))
            with sf.Rendering(PLANE, device=device) as rendering:
                lines = rendering.messages()
                self.assertRegex(lines[0], "^matching.approach_mm: ")
                self.assertEqual(rendering.messages(), [])

    def test_fingers_of_a_scene(self):
        self.assertEqual(sf.fingers(ROOT / "scenes/hand.toml"), ["thumb", "index", "middle", "ring", "pinky"])

    def test_memory_stays(self):
        with sf.Rendering(PLANE) as rendering:
            rendering.step(np.eye(4), 0.0)

            def grown(times):
                for _ in range(times):
                    rendering.snapshot()
                    rendering.step(np.eye(4), 0.0)
                gc.collect()
                return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

            at_first = grown(2000)
            self.assertLess(grown(20000) - at_first, 2000)  # kB

    def test_it_has_a_version(self):
        self.assertEqual(sf.__version__, command_line("--version").split()[-1])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
