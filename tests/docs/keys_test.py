"""Every key that a reader knows stands in docs/files.md, in the section of its file, and no other.

The keys are those of the JSON Schemas, which the program makes of what its readers ask for.

    keys_test.py PROGRAM SOURCE_FOLDER
"""

import re
import sys
import unittest

import documents

PROGRAM, ROOT = sys.argv[1], documents.root_of(sys.argv[2])
PAGE = ROOT / "docs" / "files.md"
WORD = re.compile(r"[A-Za-z]\w*")
UNIT = re.compile(r"_(?:mm2?|deg|rad|N|kPa|Hz|s|ms|us|g|ticks|kg_per_m3|per_\w+|s2)$")


def keys_of(schema):
    """Names of all keys and tables in a schema."""
    keys = set()
    for name, inner in schema.get("properties", {}).items():
        keys |= {name} | keys_of(inner)
    inner = [*schema.get("anyOf", []), *schema.get("patternProperties", {}).values()]
    inner += [schema[key] for key in ("items", "additionalProperties") if isinstance(schema.get(key), dict)]
    return keys.union(*(keys_of(one) for one in inner)) if inner else keys


def choices_of(schema):
    """(key, word) for all words among which a key of a schema lets choose."""
    found = set()
    for name, inner in schema.get("properties", {}).items():
        words = inner.get("enum", [inner["const"]] if "const" in inner else [])
        found |= {(name, word) for word in words if isinstance(word, str)} | choices_of(inner)
    inner = [*schema.get("anyOf", []), *schema.get("patternProperties", {}).values()]
    inner += [schema[key] for key in ("items", "additionalProperties") if isinstance(schema.get(key), dict)]
    return found.union(*(choices_of(one) for one in inner))


def words_in(text):
    return {word for span in documents.SPAN.findall(text) for word in WORD.findall(span)}


class Keys(unittest.TestCase):
    def check(self, title, schemas, own_names=frozenset()):
        """`own_names`: of keys that a file chooses itself, as the page's examples have them."""
        text = documents.section(PAGE, title)
        known = set().union(*(keys_of(schema) for schema in schemas))
        self.assertGreater(len(known), 5)
        self.assertEqual({key for key in known - words_in(text) if not own_names or not re.match(own_names, key)}, set())
        # The other way round: what looks like a key, anywhere; and all of the first column of tables of keys.
        unknown = {word for word in words_in(text) if UNIT.search(word)} - known
        for table in re.findall(r"^\| key[^\n]*\n\| ---[^\n]*\n((?:\|[^\n]*\n)+)", text, re.M):
            for row in table.splitlines():
                unknown |= words_in(row.split("|")[1]) - known
        unknown = {word for word in unknown if not word.isupper()}
        self.assertEqual({word for word in unknown if not own_names or not re.match(own_names, word)}, set())

    def test_scene(self):
        self.check("Scene", [self.schemas["scene"]])

    def test_finger(self):
        self.check("Finger", [self.schemas["finger"]])

    def test_person(self):
        self.check("Person", [self.schemas["person"]])

    def test_device(self):
        self.check("Device", self.schemas["device"].values(), r"height_(\d+|I)_(\d+|J)_mm$")

    def test_every_choice_is_named(self):
        text = PAGE.read_text(encoding="utf-8")
        choices = set()
        for schema in (*(self.schemas[kind] for kind in ("scene", "finger", "person")), *self.schemas["device"].values()):
            choices |= choices_of(schema)
        self.assertGreater(len(choices), 20)
        self.assertEqual({one for one in choices if f'"{one[1]}"' not in text and f"`{one[1]}`" not in text}, set())

    @classmethod
    def setUpClass(cls):
        cls.schemas = documents.schemas(PROGRAM)


unittest.main(argv=sys.argv[:1])
