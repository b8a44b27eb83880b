#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of the house that a compiler does not check.

Includes go one way down, public headers stand on std alone, a name is that of one thing, files stay
small, every file names its licence, and pages name files that exist. docs/design.md explains the
layers; this file is their exact definition.
"""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

# Folders of src/ from the bottom up; a folder may include itself and those before it.
LAYERS = ["base", "cloud", "register", "io", "sensor", "image", "field", "paper", "fixed", "entropy",
          "compact", "format", "records", "codec", "map", "mapfile", "mapview", "dense", "reconstruct"]
# Rooms beside the codec; they see these layers only, and no layer sees them.
BESIDE = {"metrics", "simulate", "render"}
SEEN_BESIDE = {"base", "cloud", "io", "sensor", "image"}

# The layer that each public header belongs to. settings.hpp holds plain values that flow down to
# every layer that needs them; paper.hpp shows stages of the codec.
HEADERS = {
    "version": "base", "result": "base", "progress": "base", "vec3": "base", "motion": "base", "cloud": "cloud",
    "io": "io", "sensor": "sensor", "calibrate": "sensor", "lattice": "image", "project": "image",
    "settings": "image",
    "pose": "io", "register": "register", "sequence": "codec", "map_tile": "map", "map_settings": "map", "map": "mapfile",
    "map_view": "mapview",
    "field": "field", "dense": "dense", "paper": "codec", "codec": "codec", "compare": "metrics",
    "metrics": "metrics",
    "simulate": "simulate", "drive": "simulate", "render": "render", "verify": "codec", "reconstruct": "reconstruct",
}

SOURCE_FOLDERS = ["include", "src", "apps", "examples", "tests", "bench", "fuzz", "tools"]
MAX_LINES = 600
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)

SHARED_NAME = re.compile(r"(?:struct|class|enum class|enum) (\w+)(?!::)\b[^;]*\{"
                         r"|inline constexpr [\w:<>, ]+? (\w+)(?:\[|\{| =|;)"
                         r"|(?:inline|constexpr) .*? (\w+)\(")


def source_files(*folders):
    files = [file for folder in folders for file in sorted((ROOT / folder).rglob("*"))
             if file.suffix in {".hpp", ".cpp", ".py"}]
    assert files, f"no sources in {folders}"
    return files


def includes(file):
    """(quote, path) of every include of a file."""
    return INCLUDE.findall(file.read_text(encoding="utf-8"))


def layer_of_include(path):
    """The layer an include leads to, or None if it leaves the library."""
    folder, _, rest = path.partition("/")
    if folder == "curlidar":
        name = rest.removesuffix(".hpp")
        assert name in HEADERS, f"{path}: add the new public header to HEADERS in {__file__}"
        return HEADERS[name]
    return folder if rest and folder in {*LAYERS, *BESIDE} else None


def may_include(layer, other):
    if layer == other:
        return True
    if layer in BESIDE:
        return other in SEEN_BESIDE
    return other in LAYERS and LAYERS.index(other) < LAYERS.index(layer)


def shared_names(file):
    """Types, constants and inline functions of a file that the linker takes for those of another
    file with the same name and namespace: all but those of unnamed namespaces. Lines alone are
    read, so members are not seen, and overloads in two files count as one name."""
    spaces, names = [], set()
    for line in file.read_text(encoding="utf-8").splitlines():
        if opened := re.match(r"namespace(?: ([\w:]+))? \{", line):
            spaces.append(opened[1])
        elif line.startswith("}  // namespace"):
            spaces.pop()
        elif None not in spaces and (named := SHARED_NAME.match(line)):
            names.add("::".join([*spaces, next(filter(None, named.groups()))]))
    return names


class LayersTest(unittest.TestCase):
    def test_rule_itself(self):
        self.assertTrue(may_include("codec", "base"))
        self.assertFalse(may_include("base", "codec"))
        self.assertTrue(may_include("metrics", "sensor"))
        self.assertFalse(may_include("metrics", "codec"))
        self.assertFalse(may_include("codec", "metrics"))

    def test_every_folder_of_src_has_a_place(self):
        folders = {folder.name for folder in (ROOT / "src").iterdir() if folder.is_dir()}
        self.assertLessEqual(folders, {*LAYERS, *BESIDE})

    def test_includes_of_the_library_go_down(self):
        wrong = []
        for file in source_files("src"):
            layer = file.relative_to(ROOT / "src").parts[0]
            for quote, path in includes(file):
                other = layer_of_include(path)
                if other is not None and not may_include(layer, other):
                    wrong.append(f"{file.relative_to(ROOT)} ({layer}) includes {path} ({other})")
                if quote == '"' and other is None and not (ROOT / "src" / path).is_file():
                    wrong.append(f"{file.relative_to(ROOT)} includes {path}: not in the library")
        self.assertEqual(wrong, [])

    def test_public_headers_go_down_and_use_std_only(self):
        wrong = []
        for file in source_files("include"):
            layer = layer_of_include(f"curlidar/{file.name}")
            for quote, path in includes(file):
                if quote == "<":
                    if "/" in path or path.endswith(".h"):
                        wrong.append(f"{file.name} includes <{path}>, which is not std")
                elif not path.startswith("curlidar/"):
                    wrong.append(f"{file.name} includes {path}, which is not public")
                elif not may_include(layer, layer_of_include(path)):
                    wrong.append(f"{file.name} ({layer}) includes {path}")
        self.assertEqual(wrong, [])

    def test_the_command_uses_public_headers_only(self):
        wrong = [f"{file.relative_to(ROOT)} includes {path}"
                 for file in source_files("apps") for _, path in includes(file)
                 if not path.startswith("curlidar/") and layer_of_include(path) is not None]
        self.assertEqual(wrong, [])

    def test_one_name_is_one_thing(self):
        # Two definitions of one name, and the linker keeps either of them: what breaks depends on
        # what the compiler has inlined.
        where = {}
        for file in source_files("include", "src", "apps"):
            for name in shared_names(file):
                where.setdefault(name, []).append(str(file.relative_to(ROOT)))
        twice = {name: files for name, files in where.items() if len(files) > 1}
        self.assertGreater(len(where), 100)
        self.assertEqual(twice, {})

    def test_files_stay_small(self):
        long = [f"{file.relative_to(ROOT)}: {lines} lines" for file in source_files(*SOURCE_FOLDERS)
                if (lines := len(file.read_text(encoding="utf-8").splitlines())) > MAX_LINES]
        self.assertEqual(long, [])

    def test_every_file_names_its_licence(self):
        scripts = [ROOT / "dev", ROOT / ".ci" / "run"]
        bare = [str(file.relative_to(ROOT)) for file in source_files(*SOURCE_FOLDERS) + scripts
                if not any("SPDX-License-Identifier: BSD-3-Clause" in line for line in
                           file.read_text(encoding="utf-8").splitlines()[:2])]
        self.assertEqual(bare, [])

    def test_pages_name_files_that_exist(self):
        pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("bench/*.md")]
        gone = []
        for page in pages:
            text = page.read_text(encoding="utf-8")
            links = [page.parent / link for link in re.findall(r"\]\(([^):#]+)\)", text)]
            paths = [ROOT / path for path in
                     re.findall(r"`((?:src|include|tests|bench|apps|cmake)/[\w./-]+)`", text)]
            gone += [f"{page.relative_to(ROOT)}: {path}" for path in links + paths
                     if not path.exists()]
        self.assertGreater(len(pages), 3)
        self.assertEqual(gone, [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
