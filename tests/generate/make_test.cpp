// SPDX-License-Identifier: Apache-2.0
// bitspan make from outside: outputs that are read back, and what is refused.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/npy.hpp"
#include "tests/cli/program.hpp"

namespace bitspan {
namespace {

class Make : public Program {
 protected:
  Make() { std::filesystem::copy(source_path("tests/data/hills.png"), folder.path("hills.png")); }

  // Runs, and returns what it printed.
  std::string made(const std::string& arguments) const {
    const Result r = run("make " + arguments);
    EXPECT_EQ(r.code, 0) << arguments << "\n" << r.err;
    return r.out;
  }
};

TEST_F(Make, EveryMeshIsDrawn) {
  EXPECT_EQ(made("terrain hills.png -o a.obj"),
            "a.obj: 97 x 73 samples, right grid, 7081 vertices, 13824 triangles\n");
  EXPECT_NE(made("terrain hills.png -o b.obj --grid equilateral --columns 40 --vertical 0.002 --shade")
                .find("equilateral grid"),
            std::string::npos);
  EXPECT_NE(made("terrain hills.png -o c.obj --rings 0,0,8 --vertical 0.002").find("rings of"),
            std::string::npos);
  EXPECT_NE(
      made("delaunay hills.png -o d.obj --points 300 --vertical 0.002 --voronoi e.obj").find("300 points"),
      std::string::npos);
  EXPECT_NE(made("lod hills.png -o f.obj --every 3 --vertical 0.002 --rank-of f.npy").find("RMS of a grid"),
            std::string::npos);
  for (const char* name : {"b", "c", "d", "e", "f"}) {
    const std::string mesh = std::string(name) + ".obj";
    const Result r = run("render " + mesh + " --size 40x30 --unlit -o " + name + ".png");
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_EQ(r.err, "");
  }
  // Made again, it has the same bytes.
  for (const char* command : {"terrain hills.png --rings 0,0,8 --vertical 0.002",
                              "delaunay hills.png --points 300 --vertical 0.002"}) {
    made(std::string(command) + " -o again.obj");
    EXPECT_EQ(folder.read("again.obj"), folder.read(command[0] == 't' ? "c.obj" : "d.obj"));
  }
}

TEST_F(Make, ASimplerMeshAndBack) {
  const std::string spot = source_path("tests/data/spot.obj");
  made("simplify " + spot + " -o whole.obj --triangles 5856");
  EXPECT_NE(
      made("simplify " + spot + " -o small.obj --triangles 1000 --log log").find("5856 triangles to 1000"),
      std::string::npos);
  made("simplify --undo log -o back.obj");
  EXPECT_EQ(folder.read("back.obj"), folder.read("whole.obj"));
  made("simplify --undo log -o middle.obj --triangles 3000");
  EXPECT_NE(made("simplify middle.obj -o same.obj --triangles 3000").find("3000 triangles to 3000"),
            std::string::npos);
}

TEST_F(Make, BadInputIsOneLineAndLeavesNoFile) {
  folder.write("note.txt", "no field\n");
  folder.write("bad.log", "{}\n");
  refused("make", "A subcommand is required");
  refused("make terrain", "field is required");
  refused("make terrain hills.png", "nothing to write; give -o");
  refused("make terrain none.npy -o a.obj", "none.npy: cannot read");
  refused("make terrain note.txt -o a.obj", "note.txt: is none; expected a height field");
  refused("make terrain hills.png --array x -o a.obj", "one array without a name");
  refused("make terrain hills.png -o no/such/a.obj", "cannot write");
  refused("make terrain hills.png -o a.obj --grid round", "--grid");
  refused("make terrain hills.png -o a.obj --columns 1", "--columns: 1 is not legal; expected 2 to");
  refused("make terrain hills.png -o a.obj --rings 0,0", "--rings: \"0,0\" is not legal");
  refused("make terrain hills.png -o a.obj --rings 0,0,1", "at least 2 samples");
  refused("make terrain hills.png -o a.obj --rings 0,0,nan", "--rings");
  refused("make terrain hills.png -o a.obj --rings 0,0,8 --columns 9",
          "--rings: are of the field's own samples");
  refused("make terrain hills.png -o a.obj --spacing 0", "--spacing: 0 is not legal");
  refused("make terrain hills.png -o a.obj --vertical nan", "--vertical: nan is not legal");
  refused("make terrain hills.png -o a.obj --every 0", "--every: 0 is not legal");
  refused("make terrain hills.png -o a.obj --every 80", "leaves no triangle");
  refused("make delaunay hills.png -o a.obj --points 3", "--points: 3 is not legal; expected 4 to 7081");
  refused("make delaunay hills.png -o a.obj --points 7082", "--points: 7082");
  refused("make delaunay hills.png -o a.obj --voronoi no/such/a.obj", "cannot write");
  refused("make lod hills.png", "nothing to write");
  refused("make lod hills.png -o a.obj --ranks 0", "--ranks: 0 is not legal");
  refused("make lod hills.png -o a.obj --keep 1", "--keep: 1 is not legal");
  refused("make lod hills.png -o a.obj --rank 8", "--rank: 8 is not legal; expected 0 to 7");
  refused("make simplify hills.png -o a.obj --triangles 5", "hills.png");
  refused("make simplify none.obj -o a.obj", "--triangles: is missing");
  refused("make simplify --undo bad.log -o a.obj", "bad.log:1: is no log");
  refused("make simplify --undo none.log -o a.obj", "none.log: cannot read");
  EXPECT_EQ(folder.files(), 3);
}

}  // namespace
}  // namespace bitspan
