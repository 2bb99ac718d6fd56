# SPDX-License-Identifier: Apache-2.0
"""What `cmake --install` and `cpack` make, used from another place and with an empty environment."""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(os.environ["BITSPAN_BUILD"])
CMAKE = os.environ["BITSPAN_CMAKE"]
CPACK = pathlib.Path(CMAKE).with_name("cpack")


def run(*command, cwd=None, env=None, code=0):
    """Runs a command and returns what it says; fails where the exit code is another one."""
    done = subprocess.run([str(word) for word in command], cwd=cwd, env=env, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, encoding="utf-8", errors="replace")
    if done.returncode != code:
        raise AssertionError(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stdout}")
    return done.stdout


class Installed(unittest.TestCase):
    """A prefix that was installed and then moved, and a folder and an environment of nobody's."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="bitspan-install-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.first = self.folder / "first"
        self.prefix = self.folder / "moved/here"
        run(CMAKE, "--install", BUILD, "--prefix", self.first)
        self.prefix.parent.mkdir()
        self.first.rename(self.prefix)
        self.work = self.folder / "work"
        self.work.mkdir()
        self.env = {"PATH": "/usr/bin:/bin", "HOME": str(self.folder / "home")}

    def bitspan(self, *arguments, code=0, env=None):
        program = self.prefix / "bin/bitspan"
        return run(program, *arguments, cwd=self.work, env={**self.env, **(env or {})}, code=code)


class Prefix(Installed):
    def test_no_file_names_the_build_the_sources_or_the_prefix(self):
        files = [path for path in self.prefix.rglob("*") if path.is_file()]
        self.assertGreater(len(files), 100)
        links = [path for path in self.prefix.rglob("*") if path.is_symlink()]
        self.assertEqual([path.name for path in links], ["libbitspan.so"])
        self.assertEqual(os.readlink(links[0]), "libbitspan.so.0")
        for path in files:
            content = path.read_bytes()
            for folder in (SOURCE, BUILD, self.first):
                self.assertNotIn(str(folder).encode(), content, f"{path} names {folder}")

    def test_every_header_has_what_it_includes(self):
        root = self.prefix / "include/bitspan/cpp"
        self.assertEqual([entry.name for entry in (self.prefix / "include").iterdir()], ["bitspan"])
        headers = list(root.rglob("*.hpp"))
        self.assertGreater(len(headers), 30)
        for header in headers:
            for name in re.findall(r'#include ["<]([^">]+/[^">]+|[^">]+\.h(?:pp)?)[">]', header.read_text()):
                self.assertTrue((root / name).is_file(), f"{header} includes {name}")

    def test_what_a_source_folder_has_is_there(self):
        for part, pattern in (("rtl", "*.sv"), ("rtl", "*.f"), ("config", "**/*.toml"), ("schema", "*.json"), ("dv", "**/*.?pp"), ("dv", "**/*.sv"), ("tb", "rtl_*harness.cpp"),
                              ("python/bitspan_report", "**/*.py"), ("python/bitspan_report", "*.js"), ("python/bitspan_report", "*.css")):
            wanted = sorted(path.relative_to(SOURCE) for path in (SOURCE / part).glob(pattern))
            self.assertTrue(wanted)
            for path in wanted:
                self.assertEqual((self.prefix / "share/bitspan" / path).read_bytes(), (SOURCE / path).read_bytes())


class Program(Installed):
    def test_demo_and_verify_build_the_rtl_that_is_installed(self):
        out = self.bitspan("demo", "--size", "80x60", "--engines", "golden,model,systemc,rtl,ideal")
        self.assertIn("demo: all held", out)
        self.assertIn("golden = rtl", out)
        self.assertTrue((self.work / "bitspan-demo/report.html").is_file())
        built = list((self.folder / "home/.cache/bitspan").glob("rtl-*.so"))
        self.assertGreater(len(built), 0)
        out = self.bitspan("verify", "demo", "--size", "80x60", "--engines", "model,rtl")
        self.assertRegex(out, r"all +model = rtl +\d{5,}")

    def test_the_library_finds_its_plugins_and_these_the_rtl(self):
        program = """
import ctypes, sys
lib = ctypes.CDLL(sys.argv[1])
lib.bs_last_error.restype = ctypes.c_char_p
config, model = ctypes.c_void_p(), ctypes.c_void_p()
assert lib.bs_config_load(b"depth16", ctypes.byref(config)) == 0
for engine in (b"systemc", b"rtl"):
    assert lib.bs_open(config, engine, ctypes.byref(model)) == 0, lib.bs_last_error()
    lib.bs_close(model)
"""
        run("/usr/bin/python3", "-c", program, self.prefix / "lib/libbitspan.so.0", env=self.env)
        self.assertGreater(len(list((self.folder / "home/.cache/bitspan").glob("rtl-*.so"))), 0)

    def test_meshes_of_other_formats(self):
        (self.work / "t.stl").write_text("solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                         "vertex 0 1 0\nendloop\nendfacet\nendsolid t\n")
        self.assertIn("1 drawn", self.bitspan("render", "t.stl", "--yaw", "0", "-o", "t.png"))
        program = self.prefix / "libexec/bitspan/bitspan-assimp"
        program.unlink()
        self.assertIn("BITSPAN_ASSIMP", self.bitspan("render", "t.stl", "-o", "t.png", code=2))
        self.bitspan("render", "t.stl", "--yaw", "0", "-o", "t.png", env={"BITSPAN_ASSIMP": str(BUILD / "libexec/bitspan/bitspan-assimp")})

    def test_config(self):
        self.assertIn("span.h", self.bitspan("config", "show", "narrow"))
        schema = (self.prefix / "share/bitspan/schema/configuration.schema.json").read_text()
        self.assertEqual(schema, self.bitspan("config", "schema"))
        self.bitspan("config", "show", self.prefix / "share/bitspan/config/depth20.toml")
        self.bitspan("config", "emit-sv", "depth16", "--rtl", "rtl")
        self.assertTrue((self.work / "rtl/span_interpolator.sv").is_file())

    def test_study_with_a_report(self):
        (self.work / "study.toml").write_text(
            '[study]\nname = "small"\nbase = "depth16"\nscenes = ["demo"]\nsize = "64x48"\n'
            'metrics = ["span.u.p999"]\ncost = "cost.register_bits"\n'
            '[[vary]]\nkeys = ["formats.span.uv.word"]\nvalues = [22, 23]\n')
        self.bitspan("study", "study.toml", "--report", "out")
        self.assertTrue((self.work / "out/report.html").is_file())

    def test_without_its_files_it_says_so(self):
        (self.prefix / "share").rename(self.folder / "share")
        out = self.bitspan("verify", "demo", "--engines", "model,rtl", "--size", "16x16", code=2)
        self.assertIn("BITSPAN_ROOT", out)
        self.bitspan("config", "show")
        self.bitspan("config", "emit-sv", "--rtl", "rtl", env={"BITSPAN_ROOT": str(self.folder / "share/bitspan")})


class Users(Installed):
    """Programs of others, with warnings of their own that are not ours."""

    def example(self, file):
        """A copy of an example that would not compile under our flags."""
        folder = self.work / "example"
        shutil.copytree((SOURCE / "examples" / file).parent, folder)
        source = folder / pathlib.Path(file).name
        text = source.read_text()
        self.assertRegex(text, r"\nint (sc_)?main\(.*\) \{\n")
        source.write_text(re.sub(r"(\nint (?:sc_)?main\(.*\) \{\n)", r"\1  int of_the_user = 1;\n", text))
        return source

    def check(self, program):
        config = self.prefix / "share/bitspan/config/depth16.toml"
        self.assertRegex(run(program, config, env=self.env), r"^\d{3,} records of span: equal\n")

    def test_find_package(self):
        build = self.work / "build"
        run(CMAKE, "-S", self.example("cpp/compare.cpp").parent, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            "-DCMAKE_CXX_STANDARD=17", env=self.env)
        run(CMAKE, "--build", build, env=self.env)
        self.check(build / "compare")

    def pkg_config(self, name):
        env = {**self.env, "PKG_CONFIG_PATH": str(self.prefix / "lib/pkgconfig")}
        return run("pkg-config", "--cflags", "--libs", name, env=env).split()

    matched = r"^[1-9]\d+ values matched, [1-9]\d+ non-trivial, 0 records unchecked\n$"

    def test_c_by_find_package(self):
        build = self.work / "build"
        run(CMAKE, "-S", self.example("c/bench.c").parent, "-B", build, "-G", "Ninja",
            f"-DCMAKE_PREFIX_PATH={self.prefix}", env=self.env)
        run(CMAKE, "--build", build, env=self.env)
        self.assertRegex(run(build / "bench", env=self.env), self.matched)

    def test_c_by_pkg_config_in_each_language(self):
        words = self.pkg_config("bitspan")
        source = self.example("c/bench.c")
        for language in (("cc", "-std=c11"), ("c++", "-std=c++17", "-x", "c++"), ("c++", "-std=c++20", "-x", "c++")):
            program = self.work / "bench"
            run(*language, "-Wall", "-Wextra", source, "-x", "none", *words, "-o", program, env=self.env)
            out = run(program, env={**self.env, "LD_LIBRARY_PATH": str(self.prefix / "lib")})
            self.assertRegex(out, self.matched)

    def test_tlm_by_find_package_and_pkg_config(self):
        source = self.example("tlm/platform.cpp")
        words = self.pkg_config("bitspan-tlm")
        build = self.work / "build"
        run(CMAKE, "-S", source.parent, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}", env=self.env)
        run(CMAKE, "--build", build, env=self.env)
        run("c++", "-std=c++17", "-Wall", "-Wextra", source, *words, "-o", self.work / "platform", env=self.env)
        for program in (build / "platform", self.work / "platform"):
            out = run(program, "demo.ppm", "--size", "64x48", cwd=self.work,
                      env={**self.env, "LD_LIBRARY_PATH": str(self.prefix / "lib")})
            self.assertRegex(out, r"demo.ppm: 64x48, [1-9]\d+ cycles")
            self.assertEqual((self.work / "demo.ppm").stat().st_size, 13 + 64 * 48 * 3)

    def test_the_starts_of_the_document(self):
        env = {**self.env, "PKG_CONFIG_PATH": str(self.prefix / "lib/pkgconfig")}
        page = (SOURCE / "docs/own_bench.md").read_text()
        for language, package, compiler in (("c", "bitspan", ("cc", "-std=c11")), ("c++", "bitspan-cpp", ("c++", "-std=c++20"))):
            start = re.search(rf"```{re.escape(language)}\n(.*?)```", page, re.S)[1]
            self.assertLessEqual(start.count("\n"), 15)
            source, program = self.work / f"first.{language}", self.work / "first"
            source.write_text(start)
            words = run("pkg-config", "--cflags", "--libs", package, env=env).split()
            run(*compiler, "-Wall", "-Wextra", source, *words, "-o", program, env=env)
            out = run(program, env={**self.env, "LD_LIBRARY_PATH": str(self.prefix / "lib")})
            said = re.search(r"prints\s`(.*?)`", page)[1] if language == "c" else "329826 records of span, u of the first: "
            self.assertTrue(out.startswith(said), out)

    def test_find_package_of_what_is_not_there(self):
        project = self.work / "CMakeLists.txt"
        for wanted, says in (("0.2 REQUIRED COMPONENTS nothing", "no component nothing"), ("9.0 REQUIRED", "9.0")):
            project.write_text("cmake_minimum_required(VERSION 3.25)\nproject(p LANGUAGES CXX)\n"
                               f"find_package(bitspan {wanted})\n")
            out = run(CMAKE, "-S", self.work, "-B", self.work / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                      env=self.env, code=1)
            self.assertIn(says, out)

    def test_pkg_config(self):
        words = self.pkg_config("bitspan-cpp")
        program = self.work / "compare"
        run("c++", "-std=c++20", "-Wall", "-Wextra", self.example("cpp/compare.cpp"), *words, "-o", program, env=self.env)
        self.check(program)


class Subproject(unittest.TestCase):
    def test_a_parent_of_another_standard_whose_warnings_are_errors(self):
        # It stays, so that a second run has nothing to compile. A build without optimisation takes a third of the time,
        # and the vectors must be right in it.
        folder = BUILD / "tests/install/parent"
        (folder / "source").mkdir(parents=True, exist_ok=True)
        (folder / "source/CMakeLists.txt").write_text(f"""\
cmake_minimum_required(VERSION 3.25)
project(parent LANGUAGES C CXX)
set(CMAKE_CXX_STANDARD 17)
add_compile_options(-Wall -Wextra -Werror)
include(CTest)
add_subdirectory("{SOURCE / 'examples/cpp'}" example)
add_executable(other other.cpp)
install(FILES other.cpp DESTINATION share)
file(WRITE "${{CMAKE_BINARY_DIR}}/settings" "${{CMAKE_CXX_STANDARD}} ${{BITSPAN_TESTS}} ${{BITSPAN_INSTALL}}")
""")
        (folder / "source/other.cpp").write_text("static_assert(__cplusplus == 201703L);\nint main() {}\n")
        build = folder / "build"
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        run(CMAKE, "-S", folder / "source", "-B", build, "-G", "Ninja", f"-DBITSPAN_SOURCES={SOURCE}",
            "-DCMAKE_BUILD_TYPE=", *launcher)
        run(CMAKE, "--build", build)
        self.assertIn("records of span: equal", run(build / "example/compare", SOURCE / "config/narrow.toml"))
        # Nothing of ours is tested, installed or made beside the libraries.
        self.assertEqual((build / "settings").read_text(), "17 OFF OFF")
        self.assertIn("No tests were found", run("ctest", "--test-dir", build))
        shutil.rmtree(folder / "prefix", ignore_errors=True)
        run(CMAKE, "--install", build, "--prefix", folder / "prefix")
        installed = [path.name for path in (folder / "prefix").rglob("*") if path.is_file()]
        self.assertEqual(installed, ["other.cpp"])
        self.assertEqual(list(build.rglob("bitspan_bench")) + list(build.rglob("cli")), [])


class Pages(Installed):
    """The pages and the completion against what --help says."""

    def commands(self, *above):
        """Every command, as a tuple of words, with its help."""
        text = self.bitspan(*above, "--help")
        yield above, text
        listed = re.search(r"^Subcommands:\n((?:  .*\n)*)", text, re.M)
        for name in re.findall(r"^  ([a-z][\w-]*)", listed[1], re.M) if listed else []:
            yield from self.commands(*above, name)

    @staticmethod
    def flags(text):
        found = set()
        for line in re.findall(r"^  (-\S+)", text, re.M):
            found.update(line.split(","))
        return found

    def complete(self, *words):
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _bitspan; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        file = self.prefix / "share/bash-completion/completions/bitspan"
        return set(run("bash", "-u", "-c", script, "bash", file, *words, cwd=self.work, env=self.env).split())

    def test_a_page_per_command_with_every_flag(self):
        pages = self.prefix / "share/man/man1"
        commands = list(self.commands())
        self.assertGreater(len(commands), 12)
        wanted = {"-".join(("bitspan",) + words) + ".1" for words, _ in commands}
        self.assertEqual({path.name for path in pages.iterdir()}, wanted)
        for words, text in commands:
            name = "-".join(("bitspan",) + words)
            page = (pages / f"{name}.1").read_text().replace("\\-", "-").replace("\\fR", "")
            self.assertRegex(page, rf"(?m)^{name} - ")
            self.assertIn(".SH EXAMPLE", page)
            for flag in self.flags(text):
                self.assertRegex(page, rf"(?m)(^|,|fB){flag}\b", f"{name}.1")
        top = (pages / "bitspan.1").read_text()
        for words, _ in commands:
            if len(words) == 1:
                self.assertRegex(top, rf"(?m)^{words[0]}$")

    def test_completion_has_every_command_and_flag(self):
        checked = 0
        for words, text in self.commands():
            flags = self.flags(text)
            self.assertIn("--help", flags)
            self.assertEqual(self.complete("bitspan", *words, "-"), flags, words)
            checked += len(flags)
        self.assertGreater(checked, 80)
        names = {words[0] for words, _ in self.commands() if len(words) == 1}
        self.assertEqual(self.complete("bitspan", ""), names)
        self.assertEqual(self.complete("bitspan", "config", "e"), {"emit-sv"})

    def test_completion_of_values(self):
        shipped = {path.stem for path in (SOURCE / "config").glob("*.toml")}
        self.assertEqual(self.complete("bitspan", "render", "--config", ""), shipped)
        self.assertEqual(self.complete("bitspan", "render", "--config", "=", ""), shipped)
        self.assertEqual(self.complete("bitspan", "render", "--config", "="), shipped)
        self.assertEqual(self.complete("bitspan", "config", "show", "d"), {"depth16", "depth20"})
        self.assertEqual(self.complete("bitspan", "verify", "--engines", "golden,r"), {"golden,rtl"})
        oracles = {"oracle:" + name for name in self.complete("bitspan", "verify", "--oracles", "") if name != "all"}
        self.assertLessEqual({"oracle:ray", "oracle:painter", "oracle:scanline"}, oracles)
        self.assertEqual(self.complete("bitspan", "render", "--engine", ""),
                         {"golden", "model", "systemc", "rtl", "ideal", "oracle:horizon", "oracle:ybuffer_lines"} | oracles)
        self.assertEqual(self.complete("bitspan", "sim", "--mode", ""), {"cycle", "span"})
        (self.work / "mesh.obj").write_text("")
        self.assertEqual(self.complete("bitspan", "verify", ""), {"demo", "extreme", "floor", "mirror", "room", "mesh.obj"})
        self.assertEqual(self.complete("bitspan", "render", "demo", "-o", "m"), {"mesh.obj"})


class Package(unittest.TestCase):
    def test_debian_package_from_another_root(self):
        with tempfile.TemporaryDirectory(prefix="bitspan-deb-") as name:
            folder = pathlib.Path(name)
            run(CPACK, "-G", "DEB", "-B", folder, cwd=BUILD)
            (package,) = folder.glob("bitspan_*.deb")
            fields = run("dpkg-deb", "--field", package)
            depends = re.search(r"^Depends: (.*)", fields, re.M)[1]
            for library in ("libc6 (>=", "libfmt", "libsystemc", "libsqlite3"):
                self.assertIn(library, depends)
            for tool in ("verilator", "iverilog", "yosys"):
                self.assertIn(tool, re.search(r"^Recommends: (.*)", fields, re.M)[1])
            self.assertIn("Section: electronics", fields)
            root = folder / "root"
            run("dpkg-deb", "-x", package, root)
            for path in ("doc/bitspan/copyright", "man/man1/bitspan.1", "bash-completion/completions/bitspan"):
                self.assertTrue((root / "usr/share" / path).is_file(), path)
            env = {"PATH": "/usr/bin:/bin", "HOME": name}
            program = root / "usr/bin/bitspan"
            out = run(program, "verify", "demo", "--size", "80x60", "--engines", "golden,model", cwd=folder, env=env)
            self.assertIn("golden = model", out)
            run(program, "config", "emit-sv", "--rtl", "rtl", cwd=folder, env=env)
            self.assertTrue((folder / "rtl/bitspan.f").is_file())


if __name__ == "__main__":
    unittest.main()
