"""./test runs its steps in order, stops at the first that fails and ends with ctest's summary.

It runs here in a folder of its own, with commands that only write down how they are called.
"""

import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOTE = '#!/bin/sh\necho "{name} $*" >>"$FAKE/calls"\ngrep -q "^{name}$" "$FAKE/broken" && exit 7\nexit 0\n'
CTEST = """#!/bin/sh
echo "ctest $*" >>"$FAKE/calls"
if [ -n "$ISOCHOR_EXTRA_DATA" ]; then
  printf 'a.step\\nb.step\\na.step\\n' >>"$ISOCHOR_EXTRA_DATA_LOG"
fi
echo "some test output"
grep -q '^ctest$' "$FAKE/broken" && { echo "50% tests passed, 1 tests failed out of 2"; exit 8; }
echo "100% tests passed, 0 tests failed out of 2"
echo
echo "Total Test time (real) = 0.10 sec"
"""
SUMMARY = "100% tests passed, 0 tests failed out of 2\n\nTotal Test time (real) = 0.10 sec\n"


class TestScript(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.fake = pathlib.Path(self.folder.name)
        checkout = self.fake / "checkout"
        (checkout / "tools").mkdir(parents=True)
        (checkout / ".ci").mkdir()
        for name in ("test", "tools/common.sh", ".ci/run"):
            shutil.copy(ROOT / name, checkout / name)
        for name in ("install_deps", "check_layers.py", "check_format", "check_names"):
            self.command(checkout / "tools" / name, NOTE.format(name=name))
        self.command(self.fake / "cmake", NOTE.format(name="cmake"))
        self.command(self.fake / "ctest", CTEST)
        for name in ("calls", "broken"):
            (self.fake / name).write_text("")

    def tearDown(self):
        self.folder.cleanup()

    @staticmethod
    def command(path, text):
        path.write_text(text)
        path.chmod(0o755)

    def run_script(self, *arguments, script="test", **extra):
        environment = {k: v for k, v in os.environ.items() if not k.startswith("ISOCHOR_")}
        environment.update(FAKE=str(self.fake), PATH=f"{self.fake}:{os.environ['PATH']}", **extra)
        result = subprocess.run([self.fake / "checkout" / script, *arguments], env=environment,
                                cwd="/", stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                check=False)
        return result, (self.fake / "calls").read_text().splitlines()

    def test_plain_run_builds_and_tests_only(self):
        result, calls = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([call.split()[0] for call in calls],
                         ["install_deps", "cmake", "cmake", "ctest"])
        self.assertEqual(calls[0].strip(), "install_deps")

    def test_full_run_adds_the_checks_and_tests_the_release_last(self):
        result, calls = self.run_script("--full")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(calls[0], "install_deps --checks")
        for name in ("check_layers.py", "check_format", "check_names"):
            self.assertTrue(any(call.startswith(name) for call in calls), name)
        self.assertTrue(any("all_verify_interface_header_sets" in call for call in calls))
        tested = [call for call in calls if call.startswith("ctest")]
        self.assertEqual(len(tested), 2)
        self.assertIn("build/asan", tested[0])
        self.assertIn("build/release", tested[1])
        self.assertEqual(tested[1], calls[-1])

    def test_the_summary_is_the_last_thing_printed(self):
        for arguments in ((), ("--full",)):
            with self.subTest(arguments):
                result, _ = self.run_script(*arguments)
                self.assertTrue(result.stdout.endswith(SUMMARY), result.stdout)
                self.assertRegex(result.stdout, r"\d+ s  total")

    def test_failing_tests_fail_the_run_and_still_end_with_the_summary(self):
        (self.fake / "broken").write_text("ctest\n")
        result, _ = self.run_script()
        self.assertEqual(result.returncode, 8)
        self.assertTrue(result.stdout.endswith("50% tests passed, 1 tests failed out of 2\n"))

    def test_a_failing_step_stops_the_run(self):
        for broken in ("install_deps", "check_layers.py", "check_format", "check_names", "cmake"):
            with self.subTest(broken):
                (self.fake / "broken").write_text(broken + "\n")
                (self.fake / "calls").write_text("")
                result, calls = self.run_script("--full")
                self.assertNotEqual(result.returncode, 0)
                self.assertTrue(calls[-1].startswith(broken), calls)
                self.assertIn("error:", result.stderr)

    def test_real_files_are_counted_once_each(self):
        result, _ = self.run_script(ISOCHOR_EXTRA_DATA="/somewhere")
        self.assertIn("real files that ran: 2\n", result.stdout)
        self.assertNotIn("real files", self.run_script()[0].stdout)

    def test_the_sanitizer_run_sees_no_real_files(self):
        (self.fake / "calls").write_text("")
        ctest = CTEST.replace("$*\"", "$* data=$ISOCHOR_EXTRA_DATA\"", 1)
        self.command(self.fake / "ctest", ctest)
        _, calls = self.run_script("--full", ISOCHOR_EXTRA_DATA="/somewhere")
        tested = [call for call in calls if call.startswith("ctest")]
        self.assertTrue(tested[0].endswith("data="), tested[0])
        self.assertTrue(tested[1].endswith("data=/somewhere"), tested[1])

    def test_build_folder_can_be_moved(self):
        _, calls = self.run_script(ISOCHOR_BUILD_DIR=str(self.fake / "elsewhere"))
        self.assertIn(str(self.fake / "elsewhere" / "release"), calls[-1])

    def test_ci_finds_real_files_beside_the_checkout(self):
        result, calls = self.run_script(script=".ci/run")
        self.assertEqual(calls[0], "install_deps --checks")
        self.assertNotIn("real files", result.stdout)
        (self.fake / "shared" / "data").mkdir(parents=True)
        result, _ = self.run_script(script=".ci/run")
        self.assertIn("real files that ran: 2\n", result.stdout)
        self.assertTrue(result.stdout.endswith(SUMMARY))

    def test_wrong_usage(self):
        result, calls = self.run_script("--quick")
        self.assertEqual((result.returncode, calls), (2, []))
        self.assertIn("usage:", result.stderr)


if __name__ == "__main__":
    unittest.main()
