// SPDX-License-Identifier: Apache-2.0
// bitspan make quadric, and scenes of quadric bodies from outside. [V2]
#include <gtest/gtest.h>

#include <string>

#include "tests/cli/program.hpp"

namespace bitspan {
namespace {

class MakeQuadric : public Program {
 protected:
  // Runs, and returns what it printed.
  std::string held(const std::string& arguments) const {
    const Result r = run(arguments);
    EXPECT_EQ(r.code, 0) << arguments << "\n" << r.out << r.err;
    return r.out;
  }
};

TEST_F(MakeQuadric, WritesAMeshWithNormals) {
  const std::string said = held("make quadric sphere --radii 2 --steps 8 -o a.obj");
  EXPECT_EQ(said.substr(0, said.find(';')), "a.obj: sphere, 26 vertices, 48 triangles, closed");
  const std::string text = folder.read("a.obj");
  EXPECT_EQ(text.substr(0, 2), "v ");
  EXPECT_NE(text.find("\nvn "), std::string::npos);
  EXPECT_NE(text.find("\nf 1//1 "), std::string::npos);
  held("render a.obj --size 40x30 -o a.png");
  EXPECT_NE(held("make quadric paraboloid --to 2 --open -o b.obj").find("open; f within"), std::string::npos);
}

TEST_F(MakeQuadric, RefusesWhatIsNotLegal) {
  refused("make quadric ball -o a.obj", "ball");
  refused("make quadric cone -o a.obj", "make quadric: from, to: a cone goes on without end");
  refused("make quadric sphere --radii 1,2 -o a.obj", "--radii: has 2 numbers");
  refused("make quadric sphere --radii 1,2,1 -o a.obj", "a sphere has one radius");
  refused("make quadric sphere --steps 2 -o a.obj", "--steps");
  folder.write("bad.quad", "[[body]]\nshape = \"cone\"\nradius = 1\n");
  refused("verify bad.quad", "bad.quad:1: body[1].from, to: a cone goes on without end");
}

TEST_F(MakeQuadric, RaysJudgeTheBodyItself) {
  held("make quadric cone --radii 1,2,1 --from -2 --to 0 --axis 1,3,0 -o a.quad");
  const std::string flags = " --size 60x45 --engines golden,model --oracles ray";
  const std::string said = held("verify a.quad" + flags);
  EXPECT_NE(said.find("ray_quadrics against golden: "), std::string::npos) << said;
  EXPECT_NE(said.find("of the shell's width at most"), std::string::npos) << said;
  const std::string words = held("explain a.quad 30 22 --size 60x45 --oracles ray --engines golden");
  EXPECT_NE(words.find("oracle ray_quadrics against golden: equal"), std::string::npos) << words;
  // A stream keeps what rays know, and they find where it is another body.
  held("render a.quad --size 60x45 --emit-tri a.tri -o a.png");
  EXPECT_NE(held("verify a.tri --engines golden,model --oracles ray").find("ray_quadrics against"),
            std::string::npos);
  std::string stream = folder.read("a.tri");
  const std::string key = "\"from\":-2";
  const std::size_t at = stream.find(key);
  ASSERT_NE(at, std::string::npos) << stream.substr(0, 600);
  stream[at + key.size() - 1] = '1';  // a base that stands higher
  folder.write("b.tri", stream);
  const Result r = run("verify b.tri --engines golden,model --oracles ray");
  EXPECT_EQ(r.code, 1) << r.out << r.err;
  EXPECT_NE((r.out + r.err).find("oracle ray_quadrics against golden"), std::string::npos) << r.out << r.err;
  // Without quadrics there is one report.
  EXPECT_EQ(held("verify floor" + flags).find("ray_quadrics"), std::string::npos);
}

TEST_F(MakeQuadric, AnotherProjectionHasNoQuadrics) {
  held("make quadric sphere -o a.quad");
  held("render a.quad --size 60x45 --emit-tri a.tri -o a.png");
  EXPECT_NE(folder.read("a.tri").find("quadrics"), std::string::npos);
  held("render a.tri@2 --emit-tri b.tri -o a.png");
  EXPECT_EQ(folder.read("b.tri").find("quadrics"), std::string::npos);
}

}  // namespace
}  // namespace bitspan
