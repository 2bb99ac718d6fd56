// SPDX-License-Identifier: Apache-2.0
// Other mesh formats through bitspan-assimp, and what becomes of its faults.
#include "scene/assimp.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <random>
#include <sstream>

#include "io/data_folder.hpp"
#include "scene/mesh.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

const char* const triangle_stl =
    "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    "endsolid t\n";

// A triangle in z = 0; `node` is what the scene has.
std::string collada(const std::string& node) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" +
         node +
         R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}
const char* const instance = R"(<instance_geometry url="#g"/>)";

double turn(const MeshTriangle& t) {
  return cross(t.corner[1].position - t.corner[0].position, t.corner[2].position - t.corner[0].position).z;
}

// A program in place of bitspan-assimp.
class Fake {
 public:
  explicit Fake(const std::string& script)
      : path_(folder_.write("fake", "#!/bin/sh\n" + script + "\n")), assimp_("BITSPAN_ASSIMP", path_) {
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
  }

 private:
  TemporaryFolder folder_;
  std::string path_;
  Environment assimp_;
};

TEST(Assimp, ReadsStl) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.write("t.stl", triangle_stl));
  ASSERT_EQ(mesh.faces.size(), 1U);
  EXPECT_EQ(mesh.faces[0].corner[1].position, (Vec3{1, 0, 0}));
  EXPECT_EQ(mesh.faces[0].corner[1].c, (std::array<double, 4>{1, 1, 1, 1}))
      << "no grey that a library invents";
}

TEST(Assimp, NodesPlaceAndMirrors) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& node) {
    return read_by_assimp(folder.write("t.dae", collada(node))).triangles.at(0);
  };
  EXPECT_EQ(turn(read(std::string("<node>") + instance + "</node>")), 1);
  const MeshTriangle mirrored = read(std::string("<node><scale>-2 1 1</scale>") + instance + "</node>");
  EXPECT_EQ(turn(mirrored), 2);
  const MeshTriangle moved =
      read(std::string("<node><translate>5 6 7</translate><node>") + instance + "</node></node>");
  EXPECT_EQ(moved.corner[0].position, (Vec3{5, 6, 7}));
}

TEST(Assimp, RefusesInOneLine) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.xyz", "hello");
  const std::string message = input_error([&] { read_mesh(path); });
  EXPECT_TRUE(message.starts_with(path + ": cannot read the mesh: ")) << message;
  expect_refusal([&] { read_mesh(folder.write("b.stl", "solid\nfacet")); }, "b.stl: ");
  expect_refusal([&] { read_mesh(folder.write("c.dae", "<COLLADA><a>")); }, "c.dae: ");
}

// Assimp's own recursion has no limit, and overflows its stack.
TEST(Assimp, ACrashIsOneLine) {
  const TemporaryFolder folder;
  std::string nodes;
  for (int i = 0; i < 200000; ++i) nodes += "<node>";
  const std::string path = folder.write("deep.dae", collada(nodes));
  const std::string message = input_error([&] { read_mesh(path); });
  EXPECT_TRUE(message.starts_with(path + ": cannot read the mesh: ")) << message;
}

TEST(Assimp, FaultsOfTheProgramAreOneLine) {
  const TemporaryFolder folder;
  const std::string path = folder.write("t.stl", triangle_stl);
  const auto refusal = [&](double seconds = 60) {
    const std::string message = input_error([&] { read_by_assimp(path, seconds); });
    EXPECT_TRUE(message.starts_with(path + ": cannot read the mesh: ")) << message;
    return message;
  };
  const auto refused = [&](const std::string& script) {
    const Fake fake(script);
    return refusal();
  };
  EXPECT_TRUE(names(refused("exit 1"), "ended with code 1"));
  EXPECT_TRUE(names(refused("exit 0"), "gave no answer"));
  EXPECT_TRUE(names(refused("kill -SEGV $$"), "ended by signal 11"));
  EXPECT_TRUE(names(refused("kill -XCPU $$"), "more than 60 s"));
  EXPECT_TRUE(names(refused("yes"), "does not begin as a mesh does")) << "it would write for ever";
  EXPECT_TRUE(
      names(refused("printf 'bitmesh1\\377\\377\\377\\377\\377\\377\\377\\377abcdefgh'"), "too large"));
  EXPECT_TRUE(names(refused("printf 'bitmesh1\\020\\0\\0\\0\\0\\0\\0\\0abcdefgh'; exit 3"), "code 3"));
  EXPECT_TRUE(names(refused("printf 'bitmesh1\\010\\0\\0\\0\\0\\0\\0\\0abcdefghabcdefgh'"), "checksum"));
  const auto start = std::chrono::steady_clock::now();
  {
    const Fake fake("sleep 1000");
    EXPECT_TRUE(names(refusal(0.2), "not been read in time"));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  {
    const Environment none("BITSPAN_ASSIMP", folder.path("none"));
    EXPECT_TRUE(names(refusal(), "does not run: No such file"));
  }
  {
    const Environment data("BITSPAN_ASSIMP", path);
    EXPECT_TRUE(names(refusal(), "does not run: Permission denied"));
  }
}

// A file that nobody writes holds the program while its limits are read.
TEST(Assimp, TheProgramLimitsItself) {
  const TemporaryFolder folder;
  const std::string program = assimp_program().string(), fifo = folder.path("f.stl");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::execl(program.c_str(), program.c_str(), fifo.c_str(), nullptr);
    ::_exit(99);
  }
  std::map<std::string, std::string> expected{{"Max cpu time", "60 61"}, {"Max core file size", "0 0"}};
#ifndef __SANITIZE_ADDRESS__
  expected["Max address space"] = "8589934592 8589934592";
#endif
  std::map<std::string, std::string> said;
  const auto last = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (said != expected && std::chrono::steady_clock::now() < last) {
    std::istringstream lines(read_file("/proc/" + std::to_string(child) + "/limits"));
    for (std::string line; std::getline(lines, line);) {
      const std::string name = line.substr(0, line.find("  "));
      std::istringstream columns(line.substr(name.size()));
      std::string soft, hard;
      columns >> soft >> hard;
      if (expected.contains(name)) said[name] = soft + " " + hard;
    }
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(said, expected);
}

TEST(Assimp, AHostMayIgnoreItsChildren) {
  const TemporaryFolder folder;
  const auto old = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(read_mesh(folder.write("t.stl", triangle_stl)).faces.size(), 1U);
  std::signal(SIGCHLD, old);
}

TEST(Assimp, FuzzMutatedFiles) {
  const int files = is_long_run() ? 2000 : is_gate_run() ? 20 : 60;
  const TemporaryFolder folder;
  const std::string dae = collada(std::string("<node>") + instance + "</node>");
  int read = 0, refusals = 0;
  for (int i = 0; i < files; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    std::string text = i % 2 == 0 ? triangle_stl : dae;
    for (std::uint64_t changes = random() % 4; changes > 0; --changes) {
      text[random() % text.size()] = static_cast<char>(random());
    }
    try {
      read_mesh(folder.write(i % 2 == 0 ? "m.stl" : "m.dae", text));
      ++read;
    } catch (const InputError& error) {
      ++refusals;
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(read, 0);
  EXPECT_GT(refusals, 0);
}

}  // namespace
}  // namespace bitspan
