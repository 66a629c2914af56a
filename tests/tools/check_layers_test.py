"""tools/check_layers.py catches what it promises to catch, and names the line."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class CheckLayers(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.write("layers.toml", (ROOT / "layers.toml").read_text())
        self.write("src/isochor/base/error.h", "#pragma once\n#include <string>\n")
        self.write("src/isochor/step/reader.h", '#pragma once\n#include "isochor/base/error.h"\n')
        self.write("apps/isochor/main.cpp", "#include <CLI/CLI.hpp>\n")

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def run_check(self):
        script = ROOT / "tools/check_layers.py"
        return subprocess.run([sys.executable, "-B", script, "--root", self.root],
                              capture_output=True, text=True, check=False)

    def expect_caught(self, where, *words):
        result = self.run_check()
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        lines = result.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith(where + ": "), lines[0])
        for word in words:
            self.assertIn(word, lines[0])

    def test_right_order_passes(self):
        self.write("src/isochor/step/reader.cpp",
                   '#include "isochor/step/reader.h"\n#include <TopoDS_Shape.hxx>\n')
        result = self.run_check()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("4 files", result.stdout)

    def test_include_of_a_later_layer(self):
        self.write("src/isochor/volume/form.cpp",
                   '// a comment\n\n#include "isochor/step/reader.h"\n')
        self.expect_caught("src/isochor/volume/form.cpp:3", "volume must not use step")

    def test_relative_include_of_a_later_layer(self):
        self.write("src/isochor/volume/form.cpp", '#include "../step/reader.h"\n')
        self.expect_caught("src/isochor/volume/form.cpp:1", "volume must not use step")

    def test_foreign_headers_outside_of_their_layer(self):
        for header, name in [("flint/fmpz.h", "FLINT"), ("gmp.h", "FLINT"),
                             ("Geom_BSplineSurface.hxx", "OpenCASCADE"),
                             ("opensubdiv/far/topologyRefiner.h", "OpenSubdiv"),
                             ("nlohmann/json.hpp", "JSON"), ("CLI/CLI.hpp", "command line")]:
            with self.subTest(header):
                self.write("src/isochor/edit/solve.h", f"#pragma once\n#  include <{header}>\n")
                self.expect_caught("src/isochor/edit/solve.h:2", header, name, "not edit")

    def test_link_to_a_later_layer(self):
        self.write("src/isochor/volume/CMakeLists.txt",
                   "isochor_add_module(volume\n  SOURCES form.cpp\n  DEPENDS base step\n"
                   "  LINK Eigen3::Eigen)\n")
        self.expect_caught("src/isochor/volume/CMakeLists.txt:3", "link to step")

    def test_link_by_target_name(self):
        self.write("src/isochor/volume/CMakeLists.txt",
                   "# isochor::step in a comment is fine\n"
                   "target_link_libraries(isochor_volume PRIVATE isochor::step)\n")
        self.expect_caught("src/isochor/volume/CMakeLists.txt:2", "link to step")

    def test_link_to_foreign_code_of_another_layer(self):
        for target in ("TKernel", "FLINT::FLINT", "nlohmann_json::nlohmann_json", "CLI11::CLI11"):
            with self.subTest(target):
                self.write("src/isochor/edit/CMakeLists.txt",
                           f"isochor_add_module(edit\n  PRIVATE_LINK {target})\n")
                self.expect_caught("src/isochor/edit/CMakeLists.txt:2", target)

    def test_folder_that_is_no_layer(self):
        self.write("src/isochor/misc/helpers.h", "#pragma once\n")
        self.expect_caught("src/isochor/misc/helpers.h:1", "'misc'")

    def test_include_of_an_unknown_layer(self):
        self.write("src/isochor/edit/solve.cpp", '#include "isochor/misc/helpers.h"\n')
        self.expect_caught("src/isochor/edit/solve.cpp:1", "'misc' is not a layer")

    def test_broken_rules_are_an_error_of_their_own(self):
        self.write("layers.toml", 'order = ["base"]\n[[exclusive]]\nname = "X"\n'
                                  'layers = ["nowhere"]\nheaders = []\ntargets = []\n')
        result = self.run_check()
        self.assertEqual(result.returncode, 2)
        self.assertIn("'nowhere'", result.stderr)


if __name__ == "__main__":
    unittest.main()
