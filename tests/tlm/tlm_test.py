# SPDX-License-Identifier: Apache-2.0
"""examples/tlm against the program's picture and clocks, and planted bugs that the tests must find."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(os.environ["BITSPAN_BUILD"])
BITSPAN = os.environ["BITSPAN_PROGRAM"]
PLATFORM = os.environ["BITSPAN_PLATFORM"]
LIBRARY = pathlib.Path(os.environ["BITSPAN_LIBRARY"])


def run(*command, cwd=None, code=0, env=None):
    done = subprocess.run([str(word) for word in command], cwd=cwd, env={**os.environ, **(env or {})},
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", errors="replace")
    if code is not None and done.returncode != code:
        raise AssertionError(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stdout}")
    return done.stdout


class Platform(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="bitspan-tlm-")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def pixels(self, picture, width, height):
        head = f"P6\n{width} {height}\n255\n".encode()
        data = picture.read_bytes()
        self.assertTrue(data.startswith(head))
        return numpy.frombuffer(data[len(head):], numpy.uint8).reshape(height, width, 3)

    def test_picture_is_that_of_render_and_clocks_are_those_of_sim(self):
        for config, size in (("depth16", "640x480"), ("depth20", "200x150"), ("narrow", "200x150")):
            width, height = map(int, size.split("x"))
            words = ("demo", "--config", config, "--size", size)
            run(BITSPAN, "render", *words, "--dump", "dump", cwd=self.folder)
            cycles = re.search(r"^cycles: (\d+)$", run(BITSPAN, "sim", *words, cwd=self.folder), re.M)[1]
            wanted = numpy.load(self.folder / "dump/color.npy")[:, :, :3]
            for timing in ((), ("--approximate",)):
                out = run(PLATFORM, "demo.ppm", "--config", config, "--size", size, *timing, cwd=self.folder)
                self.assertIn(f"demo.ppm: {size}, {cycles} cycles, ended at ", out)
                pixels = self.pixels(self.folder / "demo.ppm", width, height)
                self.assertTrue(numpy.array_equal(pixels, wanted))
            self.assertGreater(len(numpy.unique(wanted)), 100)

    def test_errors_are_one_line(self):
        for words, says in ((("demo.ppm", "--config", "nowhere.toml"), "nowhere.toml"),
                            (("demo.ppm", "--size", "0x7"), "0x7"), ((), "usage")):
            out = run(PLATFORM, *words, cwd=self.folder, code=None)
            self.assertFalse((self.folder / "demo.ppm").exists())
            self.assertIn(says, out)

    def test_the_documents_start(self):
        shown = re.search(r"```sh\n(.*?)```", (SOURCE / "docs/tlm.md").read_text(), re.S)[1]
        self.assertLessEqual(shown.count("\n"), 15)
        (self.folder / "examples").symlink_to(SOURCE / "examples")
        prefix = self.folder / "prefix"
        # A prefix without an installation; tests/install builds the example with a real one.
        for name, target in (("bin/bitspan", BITSPAN), ("lib/libbitspan.so", LIBRARY.resolve()),
                             ("lib/libbitspan.so.0", LIBRARY.resolve()),
                             ("include/bitspan/bitspan.h", SOURCE / "include/bitspan/bitspan.h"),
                             ("include/bitspan/bitspan_tlm.hpp", SOURCE / "tlm/bitspan_tlm.hpp"),
                             ("include/bitspan/bitspan_tlm_map.h", SOURCE / "tlm/bitspan_tlm_map.h"),
                             ("lib/cmake/bitspan/bitspan-tlm.cmake", SOURCE / "packaging/bitspan-tlm.cmake")):
            (prefix / name).parent.mkdir(parents=True, exist_ok=True)
            (prefix / name).symlink_to(target)
        (prefix / "lib/cmake/bitspan/bitspan-c.cmake").write_text(
            "add_library(bitspan::c SHARED IMPORTED)\n"
            f'set_target_properties(bitspan::c PROPERTIES IMPORTED_LOCATION "{prefix}/lib/libbitspan.so"\n'
            f'  INTERFACE_INCLUDE_DIRECTORIES "{prefix}/include")\n')
        (prefix / "lib/cmake/bitspan/bitspan-config.cmake").write_text(
            "include(${CMAKE_CURRENT_LIST_DIR}/bitspan-tlm.cmake)\n")
        (prefix / "lib/cmake/bitspan/bitspan-config-version.cmake").write_text("set(PACKAGE_VERSION_COMPATIBLE TRUE)\n")
        out = run("bash", "-e", "-c", shown, cwd=self.folder, env={"PREFIX": str(prefix)})
        lines = [line[4:] for line in (SOURCE / "docs/tlm.md").read_text().splitlines()
                 if re.match("    (demo.ppm: |cycles: )", line)]
        self.assertEqual(out.splitlines()[-2:], lines)
        self.pixels(self.folder / "demo.ppm", 640, 480)


class Planted(unittest.TestCase):
    """A bug in the device turns its tests red. Each is an expression of the header that occurs once, another one in its place,
    and the tests that must find it."""

    bugs = (
        ("t.get_data_length() != 4", "t.get_data_length() == 0", "Registers.*Response*"),
        ("t.get_byte_enable_ptr() != nullptr", "false", "Registers.*Response*"),
        ("epoch_ != run_epoch_", "false", "Reset.*"),
        ("latched_[offset / 4]", "values_[offset / 4]", "Picture.ComesFrom*"),
        ("static_cast<std::uint64_t>(cycles) * (y + 1) / color.rows", "std::uint64_t{y}", "Time.*"),
        ("t.is_response_ok()", "true", "WrongList.EveryTransfer*"),
        ("write_row(depth_, depth, y)", "write_row(depth_, color, y)", "Picture.IsTheModels*"),
        ("size - at >= expected", "true", "WrongList.Sets*"),
        ("value(r.offset) &= ~to", "value(r.offset) = 0", "Registers.TheMask*"),
    )

    def test_each_is_found(self):
        header = (SOURCE / "tlm/bitspan_tlm.hpp").read_text()
        # All in one program, and the environment chooses.
        for number, (old, new, _) in enumerate(self.bugs):
            self.assertEqual(header.count(old), 1, old)
            header = header.replace(old, f"(planted == {number} ? ({new}) : ({old}))")
        header = header.replace("namespace bitspan_tlm {\n", "namespace bitspan_tlm {\n"
                                'inline const int planted = std::atoi(std::getenv("PLANTED"));\n', 1)
        with tempfile.TemporaryDirectory(prefix="bitspan-tlm-") as name:
            folder = pathlib.Path(name)
            (folder / "bitspan").mkdir()
            (folder / "bitspan/bitspan_tlm_map.h").symlink_to(SOURCE / "tlm/bitspan_tlm_map.h")
            (folder / "bitspan/bitspan_tlm.hpp").write_text(header)
            program = folder / "test"
            run("c++", "-std=c++17", "-O0", f'-DBITSPAN_SOURCE_DIR="{SOURCE}"', f"-I{folder}", f"-I{SOURCE / 'include'}",
                SOURCE / "tests/tlm/tlm_test.cpp", "-o", program, f"-L{LIBRARY.parent}", f"-Wl,-rpath,{LIBRARY.parent}",
                "-lbitspan", "-lsystemc", "-lgtest", "-lpthread")
            every = ":".join(words for _, _, words in self.bugs)
            run(program, f"--gtest_filter={every}", env={"PLANTED": "-1"})
            for number, (_, new, words) in enumerate(self.bugs):
                out = run(program, f"--gtest_filter={words}", env={"PLANTED": str(number)}, code=None)
                self.assertIn("FAILED TEST", out, new)


if __name__ == "__main__":
    unittest.main()
