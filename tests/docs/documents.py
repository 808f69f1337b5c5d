"""README.md and docs/*.md as the tests read them: sections, code, and the commands in it."""

import json
import pathlib
import re
import subprocess

SPAN = re.compile(r"`([^`\n]+)`")
#: Words in capitals stand for what a reader puts there.
PLACEHOLDER = re.compile(r"(?<![\w.-])[A-Z]{2,}[A-Z_]*(?![\w-])|\[|\.\.\.")


def pages(root):
    """In the order in which a newcomer reads them."""
    return [root / "README.md", *sorted((root / "docs").glob("*.md"))]


def section(page, title, level="##"):
    """The text under a heading, up to the next of its level or above."""
    text = page.read_text(encoding="utf-8")
    found = re.search(rf"^{level} {re.escape(title)}\n(.*?)(?=^#{{1,{len(level)}}} |\Z)", text, re.M | re.S)
    if found is None:
        raise LookupError(f"{page}: no section '{title}'")
    return found.group(1)


def code_lines(page):
    """(line number, line) of blocks of code, those that go on with a backslash as one; what stands after a gap
    of two spaces or a # is for people."""
    lines, fenced, begun = [], False, None
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
            continue
        if not fenced and not re.match(r" {4,}\S", line):
            begun = None
            continue
        text = line.strip()
        if begun is not None:
            number, text = begun[0], f"{begun[1]} {text}"
        if text.endswith("\\"):
            begun = (number, text[:-1].rstrip())
            continue
        begun = None
        lines.append((number, re.split(r"\s{2,}(?=\S)|\s+#\s", text)[0]))
    return lines


def commands(page):
    """(line number, command) of all code that is a command for a shell, in the order of the page."""
    tools = r"(?:build/)?softfinger |\./dev |cmake |ctest |tools/|build/|oscsend |oscdump |mkcert |adb |sudo "
    found = [(number, 0, line) for number, line in code_lines(page)]
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if not line.startswith("    "):
            found += [(number, span.start(), span[1]) for span in SPAN.finditer(line)]
    return [(number, line) for number, _, line in sorted(found) if re.match(tools, line)]


def is_synopsis(command):
    return PLACEHOLDER.search(re.sub(r"\$\w+", "", command)) is not None


def run(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(arguments)}: {done.stderr}")
    return done.stdout


def parts(program, command):
    """Names of the parts of a command, by its help."""
    help_text = run(program, *command, "--help")
    return re.findall(r"^  ([a-z][\w-]*)", help_text.partition("Subcommands:\n")[2], re.M)


def leaf_commands(program):
    """Every command that does work: ("run",), ("device", "show"), ..."""
    leaves = []
    for name in parts(program, ()):
        inner = parts(program, (name,))
        leaves += [(name, part) for part in inner]
        if not inner or flags(program, (name,)):
            leaves.append((name,))
    return [leaf for leaf in leaves if leaf != ("help",)]


def flags(program, command):
    """Those of `COMMAND --help`, but for --help itself."""
    help_text = run(program, *command, "--help").partition("Subcommands:\n")[0]
    return set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", help_text, re.M)) - {"--help"}


def choices(program, command):
    """{flag: words} of the flags that take one of some words."""
    help_text = run(program, *command, "--help").partition("Subcommands:\n")[0]
    return {flag: set(words.split(",")) for flag, words in
            re.findall(r"^  (?:-\w,)?(--[\w-]+) TEXT:\{([^}\s]*)\}", help_text, re.M)}


def schemas(program):
    """All that the program prints, by the kind of file; those of devices by the kind of device."""
    every = json.loads(run(program, "device", "schema"))
    devices = {one: json.loads(run(program, "device", "schema", one)) for one in every["properties"]["kind"]["enum"]}
    return {
        "scene": json.loads(run(program, "scene", "schema")),
        "finger": json.loads(run(program, "finger", "schema")),
        "person": json.loads(run(program, "finger", "schema", "--person")),
        "device": devices,
    }


def root_of(argument):
    return pathlib.Path(argument).resolve()
