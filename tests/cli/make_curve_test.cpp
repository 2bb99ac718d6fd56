// SPDX-License-Identifier: Apache-2.0
// bitspan make curve, make patches, patches as a scene, and a mesh on a turntable.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/cli/program.hpp"

namespace bitspan {
namespace {

class MakeCurve : public Program {
 protected:
  void SetUp() override { folder.write("p.csv", "0,0\n8,16\n24,8\n32,0\n"); }
  std::string teapot() const { return source_path("tests/data/teapot.bez"); }
};

TEST_F(MakeCurve, WritesALineOrATable) {
  EXPECT_EQ(run("make curve p.csv --kind bezier -k 1 -o a.obj").code, 0);
  EXPECT_EQ(folder.read("a.obj"), "v 0 0 0\nv 16 9 0\nv 32 0 0\nl 1 2 3\n");
  EXPECT_EQ(run("make curve p.csv --kind catmull_rom -k 0 -o a.csv").out, "a.csv: 3 pieces, 4 points\n");
  EXPECT_EQ(folder.read("a.csv"), "t,x,y,z\n0,0,0,0\n1,8,16,0\n2,24,8,0\n3,32,0,0\n");
}

TEST_F(MakeCurve, ByAddersTellsWhatItLost) {
  const std::string exact = run("make curve p.csv --kind bezier --adders -k 5 -o b.csv").out;
  EXPECT_NE(exact.find("certificate: every point is exact\nerror: 0 at most, bound 0; 0 of 1 pieces"),
            std::string::npos)
      << exact;
  run("make curve p.csv --kind bezier -k 5 -o c.csv");
  EXPECT_EQ(folder.read("b.csv"), folder.read("c.csv"));
  const std::string lossy = run("make curve p.csv --kind bezier --adders -k 8 -o b.csv").out;
  EXPECT_NE(lossy.find("certificate: formats.curve.d1 has 31 fraction bits;"), std::string::npos) << lossy;
}

TEST_F(MakeCurve, RefusesWhatIsNotLegal) {
  refused("make curve none.csv -o a.obj", "none.csv");
  refused("make curve p.csv --kind hermite --end closed -o a.obj",
          "--end is for --kind bspline and catmull_rom");
  refused("make curve p.csv --first-tangent 1,2 -o a.obj", "are for --kind spline");
  refused("make curve p.csv -k 13 -o a.obj", "--halvings");
  folder.write("q.csv", "0,0\n1,x\n");
  refused("make curve q.csv -o a.obj", "q.csv:2: is no point");
  EXPECT_FALSE(std::filesystem::exists(folder.path("a.obj")));
}

TEST_F(MakeCurve, PatchesCrackWithABitLess) {
  EXPECT_NE(run("make patches '" + teapot() + "' -k 3").out.find("cracks: 0 of 468 points on 52 shared"),
            std::string::npos);
  const std::string less = run("make patches '" + teapot() + "' -k 3 --guard-bits 8 -o t.obj").out;
  EXPECT_NE(less.find("cracks: 164 of 468"), std::string::npos) << less;
  EXPECT_EQ(run("render t.obj --size 40x30 -o t.png").code, 0);
  refused("make patches '" + teapot() + "' -k 3 --guard-bits 10", "expected 0..9");
}

TEST_F(MakeCurve, PatchesAreAScene) {
  EXPECT_NE(
      run("render '" + teapot() + "' --patch-depth 2 --size 40x30 -o a.png").out.find("faces: 992 read"),
      std::string::npos);
  refused("render '" + teapot() + "' --patch-depth 7 -o a.png", "--patch-depth");
  refused("render demo --patch-depth 3 -o a.png", "--patch-depth is for meshes");
  folder.write("bad.bez", "1\n1,2,3\n");
  refused("verify bad.bez", "bad.bez:3: the file ends; expected a number of a vertex");
}

// Whole numbers stay exact, and so does the picture that is not turned; half a turn later the other face is
// seen.
TEST_F(MakeCurve, ATurntableTurnsAMesh) {
  folder.write("t.obj", "v -2 0 0\nv 2 0 0\nv 1 3 0\nv 1 3 1\nf 1 2 3\nf 1 4 2\n");
  EXPECT_EQ(run("render t.obj --no-cull --size 40x30 -o t.png").code, 0);
  EXPECT_EQ(run("render t.obj --no-cull --size 40x30 --turntable 12 -o turn.png").code, 0);
  EXPECT_EQ(folder.read("turn-00.png"), folder.read("t.png"));
  EXPECT_NE(folder.read("turn-06.png"), folder.read("t.png"));
  EXPECT_TRUE(std::filesystem::exists(folder.path("turn-11.png")));
  EXPECT_FALSE(std::filesystem::exists(folder.path("turn.png")));
  refused("render demo --turntable 4 -o a.png", "--turntable is for meshes");
  refused("render t.obj --turntable 0 -o a.png", "--turntable");
  refused("render t.obj --turntable 4 --dump d", "--turntable: makes pictures alone");
}

}  // namespace
}  // namespace bitspan
