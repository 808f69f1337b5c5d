"""All that the command line does, Python does: every command has its function, every flag its word, but for what is said here.

    commands_test.py PROGRAM
"""

import inspect
import re
import subprocess
import sys
import unittest

import softfinger as sf

PROGRAM = sys.argv[1]

FUNCTIONS = {
    "run": sf.run,
    "press": sf.press,
    "match": sf.Device.match,
    "evaluate": sf.evaluate,
    "device show": sf.Device.show,
    "device solve": sf.Device.solve,
    "device pose": sf.Device.pose,
    "device workspace": sf.Device.workspace,
    "device calibrate": sf.calibrate_device,
    "device fit": sf.fit_device,
    "device schema": sf.schema,
    "finger show": sf.show_finger,
    "finger schema": sf.schema,
    "finger fit": sf.fit,
    "finger register": sf.register_finger,
    "scene schema": sf.schema,
    "scene check": sf.check_scene,
    "study": sf.study,
    "study export": sf.export_study,
    "study plot": sf.Study.plot,
    "replay": sf.Recording.replay,
    "export": sf.Recording.export,
    "condition": sf.condition,
}
# Commands that serve a terminal, or another program until Ctrl-C; docs/python.md says so too.
WITHOUT_FUNCTION = {"help", "emulate natnet", "emulate udp", "emulate osc"}

# Flags whose word is another one.
RENAMED = {
    "press --no-strain-limits": "strain_limits",
    "press --no-friction": "friction",
    "match --points": "points_F",
    "match --separation": "gaps",  # without them it is constant
    "match --weights": "areas",  # without them they are alike
    "device pose --joints-deg": "joints",
    "device pose --joints-mm": "joints",
    "device calibrate --out": "to",
    "finger fit --data": "curve",
    "finger fit --area": "areas",
    "finger schema --person": "what",
    "study --out": "folder",
}
# Flags of the live page and of the terminal, and what a function of its own does.
WITHOUT_WORD = {
    "run": {"headless", "as-fast-as-possible",  # always
            "listen", "token", "certificate", "key", "plain-http", "port", "wait-for-device", "repeat", "no-twin", "events",
            "simd"},
    "device calibrate": {"sensor-g"},  # a person lays weights on it, and presses Enter
    "study": {"port"},
    "study export": {"design"},  # Study.export_device
    "replay": {"simd"},
}
ALWAYS_WITHOUT = {"help", "version", "json", "csv"}


def explained(command):
    """(Names of its parts, its flags), as the program explains it."""
    text = subprocess.run([PROGRAM, "help", *command.split()], capture_output=True, text=True, check=True).stdout
    parts = text.partition("\nSubcommands:\n")[2] if "\nSubcommands:\n" in text else ""
    return re.findall(r"^  (\w[\w-]*) {2,}", parts, re.MULTILINE), set(re.findall(r"^  (?:-\w,)?--([\w-]+)", text, re.MULTILINE))


def commands():
    """Every one that does something itself, with its flags."""
    found, waiting = {}, [""]
    while waiting:
        command = waiting.pop()
        parts, flags = explained(command)
        waiting += [f"{command} {part}".strip() for part in parts]
        if command and (not parts or flags - ALWAYS_WITHOUT):
            found[command] = flags - ALWAYS_WITHOUT
    return found


class Commands(unittest.TestCase):
    def setUp(self):
        self.found = commands()

    def test_each_has_its_function(self):
        self.assertGreater(len(self.found), 20)
        self.assertEqual(set(self.found) - set(FUNCTIONS), WITHOUT_FUNCTION)
        self.assertEqual(set(FUNCTIONS) - set(self.found), set(), "functions of commands that are gone")

    def test_each_flag_has_its_word(self):
        compared = 0
        for command, function in FUNCTIONS.items():
            words = set(inspect.signature(function).parameters)
            left_out = WITHOUT_WORD.get(command, set())
            self.assertLessEqual(left_out, self.found[command], f"{command}: flags that are gone")
            for flag in self.found[command] - left_out:
                word = RENAMED.get(f"{command} --{flag}", flag.replace("-", "_"))
                self.assertIn(word, words, f"softfinger {command} --{flag}")
                compared += 1
        self.assertGreater(compared, 70)

    def test_each_function_says_what_it_takes_and_gives(self):
        for name in sf.__all__:
            self.assertTrue(inspect.getdoc(getattr(sf, name)) or not callable(getattr(sf, name)), name)


unittest.main(argv=sys.argv[:1])
