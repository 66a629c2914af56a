"""tools/install_deps keeps its promises, shown with commands that only write down how they are called."""

import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

DPKG_QUERY = """#!/bin/sh
for name; do :; done
case "$*" in
  *db:Status*) grep -qx "$name" "$FAKE/missing" && exit 1; printf installed ;;
  *) printf 'Package: src:glibc\\nPin: version 2.36\\nPin-Priority: 990\\n\\n' ;;
esac
"""
APT_GET = """#!/bin/sh
echo "$*" >>"$FAKE/calls"
case "$*" in
  *--simulate*) cat "$FAKE/plan"; exit "$(cat "$FAKE/plan_status")" ;;
esac
"""
SUDO = """#!/bin/sh
echo "sudo $*" >>"$FAKE/calls"
exit 1
"""


class InstallDeps(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.fake = pathlib.Path(self.folder.name)
        for name, text in {"dpkg-query": DPKG_QUERY, "apt-get": APT_GET, "sudo": SUDO,
                           "id": "#!/bin/sh\ncat $FAKE/user\n"}.items():
            (self.fake / name).write_text(text)
            (self.fake / name).chmod(0o755)
        for name, text in {"missing": "", "calls": "", "plan": "", "plan_status": "0",
                           "user": "0"}.items():
            (self.fake / name).write_text(text)

    def tearDown(self):
        self.folder.cleanup()

    def run_script(self, *arguments):
        environment = dict(os.environ, FAKE=str(self.fake), ISOCHOR_SKIP_DEPS="0",
                           PATH=f"{self.fake}:{os.environ['PATH']}")
        result = subprocess.run([ROOT / "tools/install_deps", *arguments], env=environment,
                                stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                check=False)
        return result, (self.fake / "calls").read_text().splitlines()

    def test_nothing_missing_calls_no_apt(self):
        result, calls = self.run_script()
        self.assertEqual((result.returncode, result.stdout, calls), (0, "", []))

    def test_installs_only_what_is_missing(self):
        (self.fake / "missing").write_text("ninja-build\nlibflint-dev\n")
        result, calls = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        install = calls[-1]
        self.assertTrue(install.endswith(" ninja-build libflint-dev"), install)
        for option in ("--yes", "--no-install-recommends", "--no-upgrade", "--no-remove"):
            self.assertIn(option, install)
        self.assertTrue(any("update" in call for call in calls))

    def test_checks_are_installed_only_when_asked_for(self):
        (self.fake / "missing").write_text("clang-tidy\n")
        self.assertEqual(self.run_script()[1], [])
        result, calls = self.run_script("--checks")
        self.assertEqual(result.returncode, 0)
        self.assertTrue(calls[-1].endswith(" clang-tidy"))

    def test_any_version_of_the_boost_headers_will_do(self):
        (self.fake / "missing").write_text("libboost-dev\n")
        self.assertEqual(self.run_script()[1], [])
        (self.fake / "missing").write_text("libboost-dev\nlibboost1.81-dev\n")
        self.assertTrue(self.run_script()[1][-1].endswith(" libboost-dev"))

    def test_without_rights_prints_the_line(self):
        (self.fake / "missing").write_text("cmake\n")
        (self.fake / "user").write_text("1000")
        result, calls = self.run_script()
        self.assertEqual(result.returncode, 2)
        self.assertIn("apt-get install --yes --no-install-recommends --no-upgrade --no-remove cmake",
                      result.stderr)
        self.assertEqual(calls, ["sudo -n true"])

    def test_never_upgrades(self):
        (self.fake / "missing").write_text("build-essential\n")
        (self.fake / "plan").write_text("Inst libc6 [2.36-1] (2.36-2 Debian:12 [amd64])\n"
                                        "Inst libc6-dev (2.36-2 Debian:12 [amd64])\n")
        result, calls = self.run_script()
        self.assertEqual(result.returncode, 2)
        self.assertIn("newer versions of: libc6\n", result.stderr)
        self.assertFalse([c for c in calls if "install" in c and "--simulate" not in c])

    def test_a_plan_that_fails_changes_nothing(self):
        (self.fake / "missing").write_text("cmake\n")
        (self.fake / "plan").write_text("E: Packages need to be removed but remove is disabled.\n")
        (self.fake / "plan_status").write_text("100")
        result, calls = self.run_script()
        self.assertEqual(result.returncode, 1)
        self.assertIn("remove is disabled", result.stderr)
        self.assertFalse([c for c in calls if "install" in c and "--simulate" not in c])

    def test_wrong_usage(self):
        result, calls = self.run_script("--everything")
        self.assertEqual((result.returncode, calls), (2, []))
        self.assertIn("usage:", result.stderr)


if __name__ == "__main__":
    unittest.main()
