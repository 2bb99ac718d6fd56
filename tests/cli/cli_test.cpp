// SPDX-License-Identifier: Apache-2.0
// The built program from outside: exit codes, messages, files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "engine/records.hpp"
#include "io/png.hpp"
#include "report/replay.hpp"
#include "scene/random.hpp"
#include "scene/texture.hpp"
#include "scene/tri_stream.hpp"
#include "tb/rtl_build.hpp"
#include "tests/cli/program.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/scene/gltf_builder.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

class Cli : public Program {
 protected:
  // Besides, nothing on stdout, and no file that was not there before.
  void refused(const std::string& arguments, const std::string& part) const {
    const auto before = files();
    EXPECT_EQ(Program::refused(arguments, part).out, "") << arguments;
    EXPECT_EQ(files(), before) << arguments;
  }

  std::vector<std::string> files() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      out.push_back(entry.path().string());
    }
    std::sort(out.begin(), out.end());
    return out;
  }
};

TEST_F(Cli, EveryCommandHasHelpWithAnExample) {
  for (const char* command :
       {"demo",         "verify",      "render",       "explain",        "sim",
        "fuzz",         "replay",      "config",       "study",          "vectors",
        "check",        "completion",  "make",         "make curve",     "make patches",
        "make quadric", "config show", "config check", "config emit-sv", "config schema"}) {
    const Result r = run(std::string(command) + " --help");
    EXPECT_EQ(r.code, 0) << command;
    EXPECT_NE(r.out.find("Example:\n  bitspan " + std::string(command)), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("Exit: 0 "), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("; 2 bad input or usage; 3 a missing or broken tool"), std::string::npos) << r.out;
    EXPECT_EQ(r.err, "");
  }
  EXPECT_NE(run("--help").out.find("Example:"), std::string::npos);
  EXPECT_NE(run("--help").out.find("Exit: 0 all held; 1 a difference"), std::string::npos);
  EXPECT_TRUE(run("--version").out.starts_with("bitspan 0."));
}

TEST_F(Cli, TexturesThatAMeshMissesAreWarningsUnlessStrict) {
  folder.write("q.obj", "mtllib q.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  folder.write("q.mtl", "newmtl m\nmap_Kd none.jpg\n");
  const Result r = run("render q.obj --no-cull --size 32x24 -o a.png");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("bitspan: warning: "), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("none.jpg: cannot read the texture"), std::string::npos) << r.err;
  EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
  refused("render q.obj --no-cull --size 32x24 --strict -o b.png", "none.jpg: cannot read the texture");
  refused("render demo --strict -o b.png", "--strict is for meshes");
}

TEST_F(Cli, AFlatMeshThatFacesTheViewerIsDrawn) {
  folder.write("q.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
  for (const char* config : {"depth16", "depth20", "narrow"}) {
    const Result r =
        run(std::string("render q.obj --yaw 0 --pitch 0 --size 32x24 -o a.png --config ") + config);
    EXPECT_EQ(r.code, 0) << config << ": " << r.err;
    EXPECT_NE(r.out.find("faces: 2 read, 0 culled, 0 outside, 2 drawn\n"), std::string::npos) << r.out;
  }
}

TEST_F(Cli, WhatAMeshLeavesOutIsAWarning) {
  folder.write("q.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\np 1\n");
  const Result r = run("render q.obj --yaw 0 --size 32x24 -o a.png");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_TRUE(r.err.starts_with("bitspan: warning: q.obj: ")) << r.err;
  EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
  folder.write(
      "q.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n0 1 0\n1 0 0\n3 0 1 2\n");
  const Result ply = run("render q.ply --yaw 0 --size 32x24 -o a.png");
  EXPECT_NE(ply.out.find("0 culled, 0 outside, 1 drawn; 1 have two sides\n"), std::string::npos)
      << ply.out << ply.err;
}

TEST_F(Cli, AFaultOfAssimpIsOneLine) {
  folder.write("t.stl", "solid\nfacet");
  refused("render t.stl -o a.png", "t.stl: cannot read the mesh: ");
  const Environment none("BITSPAN_ASSIMP", "/bin/false");
  refused("render t.stl -o a.png", "t.stl: cannot read the mesh: bitspan-assimp ended with code 1");
}

TEST_F(Cli, VectorsAreWrittenAndChecked) {
  stream("a.tri");
  for (const std::string format : {"hex", "json", "npy"}) {
    const Result made = run("vectors a.tri --stage texture --format " + format + " -o v." + format);
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_NE(made.out.find("records of texture made from 1 of constants, "), std::string::npos) << made.out;
    const Result checked = run("check v." + format);
    EXPECT_EQ(checked.code, 0) << checked.err;
    EXPECT_NE(checked.out.find("\ntexture: all held\n"), std::string::npos) << checked.out;
  }
  EXPECT_EQ(run("vectors a.tri --stage setup.edge --format json").code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path("setup.edge.vectors.json")));
  EXPECT_EQ(run("vectors a.tri --stage depth --format hex").code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path("depth.vectors/vectors.vh")));

  // A wrong digit: exit 1, and the field is named.
  std::string words = folder.read("v.hex/output.texture.hex");
  words[words.find('\n') - 1] ^= 1;
  folder.write("answers.hex", words);
  const Result wrong = run("check v.hex --answers answers.hex");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_NE(wrong.out.find("stage texture, field killed: model 0, design 1"), std::string::npos) << wrong.out;
  EXPECT_NE(wrong.out.find("reproduce      bitspan check v.hex --answers answers.hex\n"), std::string::npos);
  EXPECT_EQ(run("check v.hex --answers answers.hex --fields x,y").code, 0);
  folder.write("answers.hex", "");
  EXPECT_EQ(run("check v.hex --answers answers.hex").code, 1);

  refused("check nowhere", "nowhere");
  refused("check v.hex --answers v.hex", "v.hex: cannot read");
  refused("check v.npy --answers v.npy", "v.npy: cannot read");
  refused("check v.hex --fields x,nothing", "nothing");
  refused("check v.json --answers answers.hex", "--answers");
  folder.write("answers.hex", words.substr(0, words.size() / 2 - 3));
  refused("check v.hex --answers answers.hex", "answers.hex:");
  refused("vectors a.tri --stage nothing --format hex", "nothing");
  refused("vectors a.tri --stage span --format xml", "xml");
  refused("vectors a.tri --stage span", "--format");
  refused("vectors a.tri --stage span --format hex -o a.tri", "a.tri: cannot write");
  refused("vectors a.tri --stage span --format json -o none/a.json", "none/a.json: cannot write");
  refused("vectors none.tri --stage span --format json", "none.tri");
  const Result none = run("vectors a.tri --stage plane_walk --format json -o none.json");
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("makes no record of plane_walk"), std::string::npos) << none.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path("none.json")));
}

TEST_F(Cli, BadUsageIsRefused) {
  refused("", "subcommand");
  refused("dance", "dance");
  refused("render", "scene");
  refused("render demo --no-such-flag -o a.png", "no-such-flag");
  refused("render demo", "nothing to write");
  refused("config", "subcommand");
  refused("explain demo 1", "y");
  refused("explain demo one 2", "x");
}

TEST_F(Cli, BadScenesAreRefused) {
  refused("render none.tri -o a.png", "none.tri");
  refused("render none.obj -o a.png", "none.obj");
  refused("verify none.tri", "none.tri");
  folder.write("empty.tri", "");
  refused("render empty.tri -o a.png", "empty.tri");
  stream("nan.tri", "{\"v\": [[NaN, 2, 2, 0, 0], [30, 4, 50, 20, 0], [5, 22, 9, 0, 20]]}\n");
  refused("render nan.tri -o a.png", "nan.tri:2");
  stream("huge.tri", "{\"v\": [[1e999, 2, 2, 0, 0], [30, 4, 50, 20, 0], [5, 22, 9, 0, 20]]}\n");
  refused("render huge.tri -o a.png", "huge.tri:2");
  stream("cut.tri", std::string(good_triangle).substr(0, 40));
  refused("render cut.tri -o a.png --dump d", "cut.tri:2");
  stream("near.tri", "{\"v\": [[2, 2, 0.5, 0, 0], [30, 4, 50, 20, 0], [5, 22, 9, 0, 20]]}\n");
  refused("verify near.tri --junit j.xml", "near.tri:2");
  stream("flat.tri", "{\"v\": [[2, 2, 2, 0, 0], [4, 4, 50, 20, 0], [6, 6, 9, 0, 20]]}\n");
  refused("render flat.tri -o a.png", "flat.tri:2");
  folder.write(
      "texture.tri",
      "{\"bitspan\": 1, \"width\": 32, \"height\": 24, \"s_min\": 1.0, \"s_max\": 100.0, \"focal\": 30.0, "
      "\"background\": [1, 2, 3], \"textures\": [\"t.png\"]}\n");
  refused("render texture.tri -o a.png", "t.png");
  const std::vector<std::uint8_t> pixels(4 * 8 * 8, 77);
  const auto png = encode_png(8, 8, 4, pixels);
  folder.write("t.png", std::string(png.begin(), png.begin() + static_cast<std::ptrdiff_t>(png.size() / 2)));
  refused("render texture.tri -o a.png", "t.png");
  folder.write("t.png", "no picture at all");
  refused("render texture.tri -o a.png", "t.png");
  folder.write("bad.obj", "this is no mesh\n");
  refused("render bad.obj -o a.png", "bad.obj");
}

TEST_F(Cli, BadOptionsAreRefused) {
  stream("a.tri");
  refused("render a.tri -o a.png --size 10x10", "32x24");
  for (const std::string size : {"10", "10x10x10"}) {
    refused("render demo -o a.png --size " + size,
            "--size: '" + size + "' is no size; expected WIDTHxHEIGHT, such as 640x480");
  }
  for (const std::string size : {"0x10", "99999x99999", "30000x30000"}) {
    refused("render demo -o a.png --size " + size,
            "--size: " + size + " is out of range; expected 1..32768 each way and at most 67108864 pixels");
  }
  refused("render a.tri -o a.png --yaw 3", "--yaw");
  refused("render a.tri -o a.png --engine warp", "warp");
  refused("verify a.tri --engines golden,golden", "twice");
  refused("verify a.tri --engines golden,", "''");
  refused("verify a.tri --engines ideal", "--engines");
  refused("render a.tri -o a.png --config none", "depth16");
  refused("explain a.tri 32 0 --engines golden,model", "outside");
  refused("explain a.tri -- -1 0", "outside");
  refused("render extreme -o a.png", "name one");
  refused("render extreme/none -o a.png", "extreme/none");
  refused("fuzz --engines golden --count 1", "--engines");
  refused("fuzz --engines golden,model --count 1 --streams-per-config 0", "--streams-per-config");
  refused("fuzz --engines golden,model --count 0", "--count");
  refused("fuzz --engines golden,model --pixels 0", "--pixels");
  refused("replay none.json", "none.json");
}

TEST_F(Cli, BadConfigurationsAreRefused) {
  stream("a.tri");
  std::string toml = run("config show --toml narrow").out;
  ASSERT_NE(toml.find("[raster]\n"), std::string::npos);
  folder.write("unknown.toml", toml + "\n[extra]\nkey = 1\n");
  refused("config check unknown.toml", "unknown.toml");
  refused("render a.tri -o a.png --config unknown.toml", "extra");
  folder.write("broken.toml", "[raster\n");
  refused("config check broken.toml", "broken.toml");
  toml.replace(toml.find("subpixel_bits"), 13, "pixel_bits   ");
  folder.write("renamed.toml", toml);
  refused("config check renamed.toml", "pixel_bits");
}

TEST_F(Cli, UnwritableOutputsAreRefused) {
  stream("a.tri");
  refused("render a.tri -o no/such/folder/a.png", "no/such/folder");
  refused("render a.tri --dump no/such/d", "no/such/d");
  refused("render a.tri --dump a.tri", "a.tri");
  refused("render a.tri --emit-tri no/such/b.tri", "no/such");
  folder.write("file", "");
  refused("demo --engines golden,model -o file/x --size 32x24", "file/x");
  // Before the work: the scene is not even read.
  refused("verify none.tri --engines golden,model --junit no/j.xml", "no/j.xml");
  refused("verify none.tri --engines golden,model --json no/v.json", "no/v.json");
  refused("sim none.tri --json no/s.json", "no/s.json");
  refused("render none.tri -o no/a.png", "no/a.png");
  refused("render none.tri --dump no/d", "no/d");
  refused("fuzz --engines golden,model --count 1000000 -o file/no", "file/no: cannot write");
  EXPECT_EQ(WEXITSTATUS(std::system(
                ("'" + build_path("cli/bitspan") + "' config show depth16 >/dev/full 2>/dev/null").c_str())),
            2);
}

TEST_F(Cli, ConfigShowsChecksAndEmits) {
  for (const std::string& name : shipped_names) {
    EXPECT_NE(run(std::string("config show ") + name).out.find("span.uv"), std::string::npos);
    const std::string check = run(std::string("config check ") + name).out;
    EXPECT_NE(check.find("legal"), std::string::npos);
    EXPECT_NE(check.find("model computes in"), std::string::npos) << check;
    EXPECT_NE(check.find("form specialised (these formats are compiled in)"), std::string::npos) << check;
    EXPECT_NE(check.find(name == "narrow" ? ", a pixel every 8\n" : ", a pixel every clock\n"),
              std::string::npos)
        << check;
    const Result sv = run(std::string("config emit-sv ") + name + " -o p.sv");
    EXPECT_EQ(sv.code, 0) << sv.err;
    EXPECT_NE(folder.read("p.sv").find("package bitspan_cfg_pkg"), std::string::npos);
  }
  EXPECT_EQ(run("config emit-sv narrow").out, folder.read("p.sv"));  // the last one
  folder.write("mine.toml", run("config show --toml depth20").out);
  const auto hash = [](const std::string& text) { return text.substr(text.find('('), 18); };
  EXPECT_EQ(hash(run("config check mine.toml").out), hash(run("config check depth20").out));
}

TEST_F(Cli, EmitSvPrefixesAndWritesTheRtl) {
  const auto emitted = [&](const std::string& arguments) { return run("config emit-sv " + arguments).out; };
  EXPECT_NE(emitted("--prefix a_").find("package a_bitspan_cfg_pkg;"), std::string::npos);
  EXPECT_NE(emitted("--part pixels").find("package bitspan_pixel_pkg;"), std::string::npos);
  EXPECT_NE(emitted("--part pixels").find("DepthIsLate = 0;"), std::string::npos);
  EXPECT_EQ(emitted("--part pixels --depth-when early"), emitted("--part pixels"));
  EXPECT_NE(emitted("--part pixels --depth-when late").find("DepthIsLate = 1;"), std::string::npos);
  EXPECT_EQ(emitted("--part both --prefix a_"),
            emitted("--part interpolator --prefix a_") + emitted("--part pixels --prefix a_"));
  const Result r = run("config emit-sv narrow --prefix a_ --rtl sub/a");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_TRUE(r.out.starts_with("sub/a: ") && r.out.find(" a_bitspan.f ") != std::string::npos) << r.out;
  EXPECT_NE(folder.read("sub/a/a_bitspan.f").find("a_pixel_pipe.sv\n"), std::string::npos);
  EXPECT_EQ(folder.read("sub/a/a_bitspan_cfg_pkg.sv"), emitted("narrow --prefix a_"));
  EXPECT_EQ(run("config emit-sv --part pixels --rtl b").code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.path("b/span.sv")));

  const std::vector<std::string> before = files();
  for (const std::string prefix : {"''", "9", "a-b", "module", "'a b'"}) {
    refused("config emit-sv --prefix " + prefix, "--prefix: ");
    refused("config emit-sv --rtl c --prefix " + prefix, "--prefix: ");
  }
  refused("config emit-sv --part all", "all");
  refused("config emit-sv --part project", "project.unit is none; the RTL of project needs reciprocal");
  refused("config emit-sv --part light", "light.at is none; the RTL of light needs pixel");
  refused("config emit-sv --part pixels --depth-when never", "never");
  refused("config emit-sv --rtl c -o d", "excludes");
  refused("config emit-sv --rtl ''", "--rtl");
  refused("config emit-sv --rtl c --prefix row_", "row_divide");
  refused("config emit-sv --rtl b", "expected a new or an empty folder");
  refused("config emit-sv --prefix a_ -o no/p.sv", "no/p.sv");
  EXPECT_EQ(files(), before);
}

// Commands count also where no triangle stands between them.
TEST_F(Cli, RenderClearsAPictureWithoutTriangles) {
  const std::string size = R"("width": 8, "height": 4, "s_min": 1, "s_max": 2, "focal": 9, )";
  folder.write("cleared.tri", R"({"bitspan": 2, )" + size +
                                  R"("background": [0, 0, 0]})"
                                  "\n" +
                                  R"({"clear": {"color": [0, 128, 255]}})"
                                  "\n");
  folder.write("same.tri", R"({"bitspan": 1, )" + size +
                               R"("background": [0, 128, 255]})"
                               "\n");
  ASSERT_EQ(run("render cleared.tri -o cleared.png").code, 0);
  ASSERT_EQ(run("render same.tri -o same.png").code, 0);
  EXPECT_EQ(folder.read("cleared.png"), folder.read("same.png"));
}

TEST_F(Cli, RenderWritesTheSameEveryTime) {
  stream("a.tri");
  const Result r = run("render a.tri -o a.png --dump a.dump --config narrow");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.err, "") << "no progress in a pipe";
  ASSERT_EQ(run("render a.tri -o b.png --dump b.dump/ --config narrow --engine golden").code, 0);
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  EXPECT_TRUE(folder.read("a.png").starts_with("\x89PNG"));
  for (const char* file : {"color.npy", "depth.npy", "u.npy", "v.npy", "triangle.npy"}) {
    EXPECT_EQ(folder.read(std::string("a.dump/") + file), folder.read(std::string("b.dump/") + file)) << file;
  }
  const std::string color = folder.read("a.dump/color.npy");
  EXPECT_NE(color.find("'|u1'"), std::string::npos);
  EXPECT_NE(color.find("(24, 32, 4)"), std::string::npos);
  EXPECT_EQ(color.size(), 128U + 24U * 32U * 4U);
  const std::string depth = folder.read("a.dump/depth.npy");
  EXPECT_NE(depth.find("'<u4'"), std::string::npos);
  EXPECT_NE(folder.read("a.dump/u.npy").find("'<f8'"), std::string::npos);
  EXPECT_NE(folder.read("a.dump/triangle.npy").find("'<i4'"), std::string::npos);
  const auto json = nlohmann::json::parse(folder.read("a.dump/run.json"));
  EXPECT_EQ(json.at("configuration").at("name"), "narrow");
  EXPECT_EQ(json.at("counters").at("triangles"), 1);
  EXPECT_GT(json.at("counters").at("written"), 100);
}

TEST_F(Cli, EveryFormOfTheModelDrawsTheSame) {
  const std::string scene = "render demo --size 96x72 --config narrow";
  ASSERT_EQ(run(scene + " -o a.png --dump a --engine golden").code, 0);
  const auto same = [&](const std::string& flags) {
    const Result r = run(scene + " -o b.png --dump b " + flags);
    if (r.code == 2 && r.err.find("no such instructions") != std::string::npos) return nlohmann::json();
    EXPECT_EQ(r.code, 0) << flags << "\n" << r.err;
    EXPECT_EQ(folder.read("a.png"), folder.read("b.png")) << flags;
    for (const char* file : {"depth.npy", "u.npy", "v.npy", "triangle.npy"}) {
      EXPECT_EQ(folder.read(std::string("a/") + file), folder.read(std::string("b/") + file))
          << flags << ": " << file;
    }
    return nlohmann::json::parse(folder.read("b/run.json")).at("model");
  };
  EXPECT_EQ(same("--form scalar --threads 1"), (nlohmann::json{{"form", "scalar"}, {"threads", 1}}));
  int targets = 0;
  for (const std::string target : {"avx512", "avx2", "baseline"}) {
    const nlohmann::json vector = same("--form vector --threads 1 --target " + target);
    if (vector.is_null()) continue;
    ++targets;
    EXPECT_EQ(vector, (nlohmann::json{{"form", "vector"}, {"threads", 1}, {"target", target}}));
    EXPECT_EQ(same("--form specialised --threads 3 --target " + target),
              (nlohmann::json{{"form", "specialised"}, {"threads", 3}, {"target", target}}));
  }
  EXPECT_GE(targets, 1);
  const nlohmann::json found = same("");
  EXPECT_EQ(found.at("form"), "specialised");  // narrow is compiled in
  EXPECT_GE(found.at("threads"), 1);
  EXPECT_EQ(same("--threads 0").at("threads"), found.at("threads"));
  EXPECT_FALSE(nlohmann::json::parse(folder.read("a/run.json")).contains("model"));
  // Without a dump the picture is the same.
  ASSERT_EQ(run(scene + " -o c.png").code, 0);
  EXPECT_EQ(folder.read("a.png"), folder.read("c.png"));
}

TEST_F(Cli, FormsThatDoNotExistAreRefused) {
  stream("a.tri");
  refused("render a.tri -o a.png --form fast", "legal: auto, scalar, vector, specialised");
  refused("render a.tri -o a.png --target sse", "legal: best, avx512, avx2, baseline");
  refused("render a.tri -o a.png --threads=-1", "--threads");
  refused("render a.tri -o a.png --threads 100000", "1..1024");
  refused("render a.tri -o a.png --threads many", "--threads");
  refused("render a.tri -o a.png --engine golden --form vector", "--form: only the engine model");
  refused("render a.tri -o a.png --statistics --threads 2", "--statistics");
  refused("verify a.tri --engines golden,systemc --target avx2", "--target: only the engine model");
  refused("fuzz --engines golden,systemc --count 1 --threads 2", "--threads: only the engine model");
  std::string toml = run("config show --toml narrow").out;
  const auto at = toml.find("word = 22", toml.find("\"span.uv\" = "));  // a register of all kernels
  ASSERT_NE(at, std::string::npos);
  toml[at + 8] = '1';
  folder.write("mine.toml", toml);
  refused("render a.tri -o a.png --config mine.toml --form specialised", "specialised");
  EXPECT_EQ(run("render a.tri -o a.png --config mine.toml --form vector").code, 0);
}

TEST_F(Cli, VerifyAndFuzzTakeForms) {
  stream("a.tri");
  for (const char* flags : {"--form scalar", "--form vector --target baseline", "--threads 2"}) {
    const Result r = run("verify a.tri --engines golden,model " + std::string(flags));
    EXPECT_EQ(r.code, 0) << flags << r.out << r.err;
    const Result fuzz = run("fuzz --seed 2 --count 4 --engines golden,model " + std::string(flags));
    EXPECT_EQ(fuzz.code, 0) << flags << fuzz.out << fuzz.err;
  }
}

TEST_F(Cli, StatisticsTellWhatARegisterNeeded) {
  stream("s.tri");
  const Result r = run("render s.tri -o a.png --statistics");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("span.h "), std::string::npos) << r.out;
  // The picture is the one drawn without observers.
  EXPECT_EQ(run("render s.tri -o b.png").code, 0);
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  std::filesystem::remove(folder.path("a.png"));
  refused("render s.tri -o a.png --statistics --engine golden", "--statistics");
  refused("render s.tri --emit-tri e.tri --statistics", "--statistics");
}

TEST_F(Cli, AMeshIsSeenByParallelLines) {
  const std::string z = run("config show --toml depth16").out;
  folder.write("z.toml", std::string(z).replace(z.find("[depth]"), 7, "[depth]\nline = \"z\""));
  folder.write("cube.obj",
               "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
               "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n");
  for (const std::string name : {"orthographic", "isometric", "oblique --receding 1,30"}) {
    const Result r = run(
        "verify cube.obj --config z.toml --size 64x48 --engines golden,model,systemc,ideal --projection " +
        name);
    EXPECT_EQ(r.code, 0) << r.out << r.err;
  }
  ASSERT_EQ(run("render cube.obj --config z.toml --size 64x48 --projection oblique -o a.png").code, 0);
  ASSERT_EQ(run("render cube.obj --config z.toml --size 64x48 --projection orthographic -o b.png").code, 0);
  ASSERT_EQ(run("render cube.obj --config z.toml --size 64x48 --projection central -o c.png").code, 0);
  ASSERT_EQ(run("render cube.obj --config z.toml --size 64x48 -o d.png").code, 0);
  EXPECT_NE(folder.read("a.png"), folder.read("b.png"));
  EXPECT_NE(folder.read("b.png"), folder.read("c.png"));
  EXPECT_EQ(folder.read("c.png"), folder.read("d.png"));
  const std::string parallel = "render cube.obj --config z.toml -o e.png --projection ";
  refused("render cube.obj -o e.png --projection oblique", "depth.line = \"z\"");
  refused(parallel + "steep", "steep is not legal; expected central, orthographic, isometric, oblique");
  refused(parallel + "isometric --yaw 10", "--yaw: --projection isometric has its own direction");
  refused(parallel + "orthographic --receding 1,2", "--receding: is for lines away");
  refused(parallel + "oblique --receding 9,2", "receding lines are 9");
  refused(parallel + "oblique --receding 1", "--receding");
  refused(parallel + "oblique --fog 1,2,3,4", "--fog: needs distances from a viewer");
  refused(parallel + "oblique --stereo pair", "--stereo: two eyes see distances");
  refused("render demo --config z.toml -o e.png --projection oblique", "--projection is for meshes");
}

TEST_F(Cli, AnEmittedStreamDrawsTheSamePicture) {
  ASSERT_EQ(run("render demo --size 96x72 -o a.png --emit-tri d.tri").code, 0);
  const Result r = run("render d.tri -o b.png");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
}

// A stream with views and a copy; the pictures of both targets.
TEST_F(Cli, TheMirrorIsDrawnInTwoPasses) {
  const Result r = run("verify mirror --size 96x72 --engines golden,model,systemc");
  EXPECT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("constants   golden = model"), std::string::npos) << r.out;
  ASSERT_EQ(run("render mirror --size 96x72 -o a.png --emit-tri m.tri").code, 0);
  ASSERT_EQ(run("render m.tri -o b.png --dump d --position").code, 0);
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  ASSERT_EQ(run("render m.tri -o c.png --show-target 1 --dump e").code, 0);
  EXPECT_NE(folder.read("e/depth.npy").find("'shape': (256, 256)"), std::string::npos);
  const Result told = run("explain mirror 48 30 --size 96x72");
  EXPECT_EQ(told.code, 0) << told.out << told.err;
  EXPECT_NE(told.out.find(", target 0"), std::string::npos) << told.out;
  const Result averaged = run("verify mirror --size 96x72 --supersample 2 --engines golden,model");
  EXPECT_EQ(averaged.code, 0) << averaged.out << averaged.err;
  refused("vectors mirror --stage span --format json -o v", "expected a scene that no command changes");
}

// An image at the second coordinates of a glTF, which are turned by 90 degrees against the first.
TEST_F(Cli, AMeshHasASecondTexture) {
  testing_gltf::Gltf gltf = testing_gltf::textured_quad("a.png");
  gltf.attributes()["TEXCOORD_1"] = gltf.add("VEC2", std::vector<float>{0, 0, 0, 1, 1, 1, 1, 0});
  folder.write("q.gltf", gltf.text());
  write_png(folder.path("a.png"), 1, 2, 3, std::vector<std::uint8_t>{200, 100, 100, 100, 200, 200});
  write_png(folder.path("light.png"), 1, 2, 3, std::vector<std::uint8_t>{255, 255, 255, 51, 51, 51});
  std::string toml = run("config show --toml depth16").out;
  folder.write("c.toml", toml.insert(toml.find("[texture]\n") + 10, "second = \"own\"\n"));
  const std::string quad = "q.gltf --yaw 0 --pitch 0 --size 64x64 --config c.toml --texture1 light.png";
  const Result r = run("render " + quad + " -o a.png --emit-tri s.tri --dump d");
  ASSERT_EQ(r.code, 0) << r.err;
  ASSERT_EQ(run("render s.tri -o b.png --config c.toml").code, 0);
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  const Texture picture = read_texture(folder.path("a.png"));
  const auto at = [&](int x, int y) {
    const std::uint8_t* p = &picture.rgba[static_cast<std::size_t>(4 * (64 * y + x))];
    return std::array<int, 3>{p[0], p[1], p[2]};
  };
  using Rgb = std::array<int, 3>;
  EXPECT_EQ(at(24, 24), (Rgb{200, 100, 100}));
  EXPECT_EQ(at(24, 40), (Rgb{100, 200, 200}));
  EXPECT_EQ(at(40, 24), (Rgb{40, 20, 20}));
  EXPECT_EQ(at(40, 40), (Rgb{20, 40, 40}));
  EXPECT_EQ(run("verify " + quad + " --engines golden,model,systemc").code, 0);
  refused("render q.gltf -o x.png --texture1 light.png",
          "--texture1: the configuration gives the second texture unit the first one's coordinates");
  refused("render " + quad + " -o x.png --shadow 3,4,5", "--texture1: has the unit that --shadow");
  refused("render demo -o x.png --config c.toml --texture1 light.png", "--texture1 is for meshes");
  refused("render " + source_path("tests/data/spot.obj") + " -o x.png --config c.toml --texture1 light.png",
          "the mesh has no second texture coordinates");
  refused("render " + quad + "x -o x.png", "light.pngx: cannot read");
}

// By the unit, by the front end, and without.
TEST_F(Cli, AMeshHasALight) {
  std::string toml = run("config show --toml depth16").out;
  folder.write("c.toml", toml.insert(toml.find("[fog]"), "[light]\nat = \"pixel\"\n\n"));
  folder.write("p.toml", toml.insert(toml.find("at = "), "source = \"point\"\n"));
  const std::string spot = source_path("tests/data/spot.obj") + " --size 96x72";
  std::set<std::string> pictures;
  for (const std::string rest :
       {"", " --unlit", " --light=3,5,-4", " --light=3,5,-4,0.1,0.5,24", " --config c.toml --light=3,5,-4",
        " --config p.toml --light=3,5,-4", " --config c.toml --light=3,5,-4,0.1,0.5,24"}) {
    const Result r = run("render " + spot + rest + " -o a.png --emit-tri s.tri");
    ASSERT_EQ(r.code, 0) << rest << r.err;
    EXPECT_TRUE(pictures.insert(folder.read("a.png")).second) << rest;
    const bool by_unit = rest.find(".toml") != std::string::npos;
    EXPECT_EQ(folder.read("s.tri").find("\"light\":") != std::string::npos, by_unit) << rest;
    const std::string config = by_unit ? rest.substr(0, rest.find(" --light")) : "";
    ASSERT_EQ(run("render s.tri -o b.png" + config).code, 0);
    EXPECT_EQ(folder.read("a.png"), folder.read("b.png")) << rest;
  }
  EXPECT_EQ(run("verify " + spot + " --config p.toml --light=3,5,-4 --engines golden,model,systemc").code, 0);
  // The unit in RTL.
  const Result unit = run("config emit-sv c.toml --part light --rtl unit --prefix near_");
  EXPECT_EQ(unit.code, 0) << unit.err;
  EXPECT_NE(folder.read("unit/near_bitspan.f").find("near_light.sv"), std::string::npos);
  EXPECT_NE(folder.read("unit/near_light.sv").find("near_bitspan_light_pkg::"), std::string::npos);
  // The lunar law, a light that falls, and one that is a texture.
  std::string all = toml;
  all.insert(all.find("source = "), "law = \"lunar\"\nfall = \"second\"\n");
  folder.write("l.toml", all);
  std::string own = run("config show --toml depth16").out;
  folder.write("t.toml", own.insert(own.find("wrap = "), "second = \"own\"\n"));
  for (const std::string rest :
       {" --config l.toml --light=3,5,-4,0.1,0.2,24,2", " --config l.toml --light=3,5,-4,0.1,0.2,24,2,6,0.5",
        " --light=3,5,-4,0.1,0.2,24,2", " --config t.toml --light-map=1,2,-2,2"}) {
    const Result r = run("verify " + spot + rest + " --engines golden,model,systemc");
    EXPECT_EQ(r.code, 0) << rest << r.out << r.err;
    ASSERT_EQ(run("render " + spot + rest + " -o a.png").code, 0) << rest;
    EXPECT_TRUE(pictures.insert(folder.read("a.png")).second) << rest;
  }
  refused("render " + spot + " --config p.toml --light=3,5,-4,0.1,0.2,24,2 -o x.png", "light.law is lambert");
  refused("render " + spot + " --config p.toml --light=3,5,-4,0,0,24,0,6,0 -o x.png", "light.fall is none");
  refused("render " + spot + " --light=3,5,-4,0,0,24,0,6,0 -o x.png", "--light.reach: ");
  refused("render " + spot + " --light=3,5,-4,0,0,24,0,6 -o x.png", "--light: '3,5,-4,0,0,24,0,6' is not");
  refused("render " + spot + " --light-map=1,2,-2,2 -o x.png", "expected one with texture.second");
  refused("render " + spot + " --config t.toml --light-map=1,2,-2,0 -o x.png", "--light-map: a reach of 0");
  refused("render " + spot + " --config t.toml --light-map=1,2,-2,1 --light=1,2,3 -o x.png",
          "expected no --light beside it");
  refused("render demo --config t.toml --light-map=1,2,3,1 -o x.png", "--light-map is for meshes");
  refused("render " + spot + " --light 1,2 -o x.png", "--light: ");
  refused("render " + spot + " --light=1,2,3,0.5,0.6,8 -o x.png", "--light.specular: is not legal");
  refused("render " + spot + " --light=1,2,3,0.5,0.1,8.5 -o x.png", "--light: the exponent 8.5 is not legal");
  refused("render " + spot + " --light=1,2,3 --unlit -o x.png", "--unlit: draws without light");
  refused("render demo --light=1,2,3 -o x.png", "--light is for meshes");
}

// What each of two configurations draws of the room.
TEST_F(Cli, ARoomFollowsTheConfiguration) {
  std::string toml = run("config show --toml depth16").out;
  folder.write("r.toml", toml.insert(toml.find("[fog]"),
                                     "[project]\nunit = \"reciprocal\"\n\n[light]\nat = \"pixel\"\nsource = "
                                     "\"point\"\nnormal = \"map\"\n\n"));
  const std::string room = "room --size 64x48";
  for (const std::string config : {"depth16", "r.toml"}) {
    const Result r = run("verify " + room + " --engines golden,model,systemc --config " + config);
    EXPECT_EQ(r.code, 0) << r.out << r.err;
    EXPECT_EQ(r.out.find("light") != std::string::npos, config == "r.toml") << r.out;
  }
  refused("render room --size 100x10 -o x.png", "100x10 is not legal for the room");
  refused("render room --light=1,2,3 -o x.png", "--light is for meshes");
  refused("render room --config r.toml --shadow=1,2,3 -o x.png", "a shadow");
}

// A wall whose normals are in a map, under a light on either side.
TEST_F(Cli, AWallHasARelief) {
  std::string toml = run("config show --toml depth16").out;
  toml.insert(toml.find("wrap = "), "second = \"own\"\n");
  folder.write("r.toml", toml.insert(toml.find("[fog]"),
                                     "[light]\nat = \"pixel\"\nsource = \"point\"\nnormal = \"map\"\n\n"));
  folder.write("wall.obj",
               "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
               "f 1/1 2/2 3/3 4/4\n");
  folder.write("plain.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n");
  // The left half faces the left, the right half the right.
  write_png(folder.path("map.png"), 2, 1, 3, std::vector<std::uint8_t>{38, 128, 217, 217, 128, 217});
  const std::string wall =
      "wall.obj --size 64x48 --yaw 0 --pitch 0 --config r.toml --relief map.png --light=";
  const auto halves = [&](const std::string& light) {
    const Result r = run("render " + wall + light + " -o w.png --emit-tri w.tri");
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_EQ(run("verify " + wall + light + " --engines golden,model,systemc").code, 0);
    EXPECT_EQ(run("render w.tri --config r.toml -o v.png").code, 0);
    EXPECT_EQ(folder.read("w.png"), folder.read("v.png"));
    const Texture image = read_texture(folder.path("w.png"));
    const auto red = [&](int x) { return int{image.rgba[4 * static_cast<std::size_t>(24 * 64 + x)]}; };
    return std::pair(red(26), red(38));
  };
  const auto [near_left, far_right] = halves("-2,0,1,0.1,0,1");
  EXPECT_GT(near_left, far_right + 60);
  const auto [far_left, near_right] = halves("2,0,1,0.1,0,1");
  EXPECT_GT(near_right, far_left + 60);
  refused("render " + wall.substr(0, wall.find(" --light")) + " -o x.png", "expected --light beside it");
  refused("render wall.obj --config depth16 --relief map.png --light=1,2,3 -o x.png", "texture.second");
  refused("render plain.obj --config r.toml --relief map.png --light=1,2,3 -o x.png",
          "the mesh has no texture coordinates");
  refused("render " + wall + "1,2,3 --texture1 map.png -o x.png", "expected no --texture1 beside it");
  std::string without = wall;
  refused("render " + without.replace(without.find("map.png"), 7, "none.png") + "1,2,3 -o x.png", "none.png");
  refused("render demo --config r.toml --relief map.png -o x.png", "--relief is for meshes");
}

// Two panes of glass that cut each other, in either order of their faces.
TEST_F(Cli, GlassIsBlendedFromBackToFront) {
  folder.write("g.mtl", "newmtl red\nKd 1 0.2 0.1\nd 0.5\nnewmtl blue\nKd 0.1 0.2 1\nd 0.6\n");
  const std::string points =
      "mtllib g.mtl\nv -1 -1 -1\nv 1 -1 1\nv 1 1 1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 1\n";
  const std::string red = "usemtl red\nf 1 2 3 4\n", blue = "usemtl blue\nf 5 6 7 8\n";
  folder.write("a.obj", points + red + blue);
  folder.write("b.obj", points + blue + red);
  const std::string flags = " --size 80x60 --no-cull --unlit --yaw 20 --config depth20";
  const auto picture = [&](const std::string& scene, const std::string& rest) {
    const Result r = run("render " + scene + flags + rest + " -o g.png --emit-tri g.tri");
    EXPECT_EQ(r.code, 0) << r.err;
    return folder.read("g.png");
  };
  EXPECT_NE(picture("a.obj", ""), picture("b.obj", ""));
  EXPECT_EQ(picture("a.obj", " --translucency order"), picture("a.obj", ""));
  const std::string first = picture("a.obj", " --translucency passes");
  EXPECT_EQ(picture("b.obj", " --translucency passes"), first);
  EXPECT_NE(folder.read("g.tri").find(R"({"resolve":true})"), std::string::npos);
  ASSERT_EQ(run("render g.tri --config depth20 -o again.png").code, 0);
  EXPECT_EQ(folder.read("again.png"), first);
  EXPECT_EQ(run("verify a.obj" + flags + " --translucency passes --engines golden,model,systemc").code, 0);
  const Result judged =
      run("verify a.obj" + flags + " --translucency passes --engines golden,model --oracles abuffer");
  EXPECT_EQ(judged.code, 0) << judged.err;
  EXPECT_NE(judged.out.find(" 0 unexplained"), std::string::npos) << judged.out;
  // A triangle is missing in one pass, and the lists tell.
  std::string tri = folder.read("g.tri");
  const std::size_t line = tri.find('\n', tri.find("candidate")) + 1;
  folder.write("lost.tri", tri.erase(line, tri.find('\n', line) + 1 - line));
  const Result lost = run("verify lost.tri --config depth20 --engines golden,model --oracles abuffer");
  EXPECT_EQ(lost.code, 1) << lost.out;
  EXPECT_NE((lost.out + lost.err).find(" layers make "), std::string::npos) << lost.out << lost.err;
  const Result told = run("explain a.obj 40 30" + flags + " --translucency passes --oracles abuffer");
  EXPECT_EQ(told.code, 0) << told.err;
  EXPECT_NE(told.out.find("layer 1: triangle "), std::string::npos) << told.out;
  // A stream, and more samples.
  ASSERT_EQ(run("render b.obj" + flags + " -o x.png --emit-tri b.tri").code, 0);
  ASSERT_EQ(run("render b.tri --config depth20 --translucency passes -o again.png").code, 0);
  EXPECT_EQ(folder.read("again.png"), first);
  EXPECT_EQ(run("render a.obj" + flags + " --translucency passes --supersample 2 -o x.png").code, 0);
  refused("render a.obj --translucency glass -o x.png", "--translucency");
  refused("render a.obj" + flags + " --translucency passes --shadow-volumes --shadow=3,5,4 -o x.png",
          "translucency by passes is for a picture in one draw state");
  folder.write("bad.tri", folder.read("g.tri") + "{\"resolve\": 1}\n");
  refused("render bad.tri -o x.png", "resolve: 1 is not legal; expected true");
}

TEST_F(Cli, TwoEyesSeeAPicture) {
  const std::string spot = source_path("tests/data/spot.obj") + " --size 96x72";
  std::set<std::string> pictures;
  for (const std::string rest :
       {" --stereo pair", " --stereo anaglyph", " --stereo pair --stereo-by depth",
        " --stereo anaglyph --parallax 3", " --stereo anaglyph --stereo-zero near"}) {
    const Result r = run("render " + spot + rest + " -o a.png");
    ASSERT_EQ(r.code, 0) << rest << r.err;
    EXPECT_NE(r.out.find(rest.find("pair") == std::string::npos ? " 96x72, anaglyph" : " 192x72, pair"),
              std::string::npos)
        << r.out;
    EXPECT_EQ(r.out.find("holes: ") != std::string::npos, rest.find("depth") != std::string::npos) << r.out;
    EXPECT_TRUE(pictures.insert(folder.read("a.png")).second) << rest;
  }
  EXPECT_EQ(run("render mirror --size 96x72 --stereo pair --stereo-by depth -o a.png").code, 0);
  refused("render mirror --size 96x72 --stereo pair -o a.png", "--stereo: a scene in passes");
  refused("render " + spot + " --stereo both -o a.png",
          "--stereo: both is not legal; expected pair, anaglyph");
  refused("render " + spot + " --stereo pair --stereo-by eye -o a.png", "--stereo-by: eye is not legal");
  refused("render " + spot + " --stereo pair --stereo-zero no -o a.png", "--stereo-zero: no is not legal");
  refused("render " + spot + " --stereo pair --parallax 1e9 -o a.png", "--parallax: 1000000000 is not legal");
  for (const std::string flag : {"--stereo-by depth", "--stereo-zero far", "--parallax 3"}) {
    refused("render " + spot + " -o a.png " + flag, "is of two pictures; give --stereo");
  }
  refused("render " + spot + " --stereo pair --dump d", "--stereo: makes a picture alone");
}

// A plan of two passes, whichever scene the light falls on.
TEST_F(Cli, AnySceneHasShadows) {
  std::string toml = run("config show --toml depth16").out;
  folder.write("c.toml", toml.insert(toml.find("[fog]"), "[project]\nunit = \"reciprocal\"\n\n"));
  const std::string light = " --config c.toml --shadow-map 64 --shadow ";
  const std::string spot = source_path("tests/data/spot.obj");
  const std::pair<std::string, std::string> scenes[] = {{"demo", "-12,16,-2,0,2,-26,60"},
                                                        {"demo@2", "0,-20,0"},
                                                        {"floor", "0,-20,5"},
                                                        {spot, "3,4,-3"},
                                                        {spot + "@3", "3,4,-3"}};
  for (const auto& [scene, from] : scenes) {
    const std::string size = " --size 96x72";
    ASSERT_EQ(run("render " + scene + size + " -o plain.png --config c.toml").code, 0);
    const Result r = run("render " + scene + size + light + from + " -o a.png --emit-tri s.tri");
    ASSERT_EQ(r.code, 0) << scene << r.err;
    EXPECT_NE(folder.read("s.tri").find("\"projector\":{\"s_min\":"), std::string::npos) << scene;
    ASSERT_EQ(run("render s.tri -o b.png --config c.toml").code, 0);
    EXPECT_EQ(folder.read("a.png"), folder.read("b.png")) << scene;
    // A floor alone has no shadow.
    if (scene != "floor") {
      EXPECT_NE(folder.read("a.png"), folder.read("plain.png")) << scene;
    }
  }
  // By the header of a stream, where its viewer sees the light.
  ASSERT_EQ(run("render " + spot + " --size 96x72 -o plain.png --emit-tri plain.tri").code, 0);
  const std::string rest = " --config c.toml --shadow-map 64 --shadow=1,-3,-2";
  ASSERT_EQ(run("render plain.tri -o by_flag.png" + rest).code, 0);
  std::string stream = folder.read("plain.tri");
  stream.replace(stream.find("\"bitspan\":1"), 11,
                 "\"bitspan\":2,\"shadow\":{\"light\":[1,-3,-2],\"map\":64}");
  folder.write("header.tri", stream);
  ASSERT_EQ(run("render header.tri -o by_header.png --config c.toml").code, 0);
  EXPECT_EQ(folder.read("by_flag.png"), folder.read("by_header.png"));
  EXPECT_EQ(run("verify header.tri --config c.toml --engines golden,model").code, 0);
  EXPECT_EQ(run("render header.tri -o c.png --config c.toml --shadow=1,2,3").code, 2);
  // Rays judge it, and find what a bias of 0 does.
  const std::string judge = "verify demo --size 96x72 --engines model --oracles ray" + light;
  const Result judged = run(judge + "-12,16,-2,0,2,-26,60 --json j.json");
  EXPECT_EQ(judged.code, 0) << judged.out << judged.err;
  EXPECT_NE(judged.out.find("oracle ray_shadows against model: "), std::string::npos) << judged.out;
  EXPECT_NE(folder.read("j.json").find("\"edges\""), std::string::npos);
  EXPECT_EQ(run(judge + "-12,16,-2,0,2,-26,60 --shadow-bias 0").code, 1);
  const Result pixel =
      run("explain demo 40 60 --size 96x72 --engines model --oracles ray" + light + "-12,16,-2,0,2,-26,60");
  EXPECT_EQ(pixel.code, 0) << pixel.out << pixel.err;
  EXPECT_NE(pixel.out.find("oracle ray_shadows against model: equal"), std::string::npos) << pixel.out;
  // The unit in RTL.
  const Result unit = run("config emit-sv c.toml --part project --rtl unit");
  EXPECT_EQ(unit.code, 0) << unit.err;
  EXPECT_NE(folder.read("unit/bitspan.f").find("project.sv"), std::string::npos);
  // A stream, with the light where its viewer sees it.
  ASSERT_EQ(run("render floor --size 96x72 -o f.png --emit-tri f.tri").code, 0);
  const Result drawn = run("render f.tri -o c.png" + light + "0,-20,5");
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  const Result held = run("verify demo --size 96x72 --engines golden,model" + light + "-12,16,-2,0,2,-26,60");
  EXPECT_EQ(held.code, 0) << held.out << held.err;
  EXPECT_NE(held.out.find("project"), std::string::npos) << held.out;
  // The options make another picture, each.
  const std::string lamp = light + "-12,16,-2,0,2,-26,60";
  ASSERT_EQ(run("render demo --size 96x72 -o a.png" + lamp).code, 0);
  for (const std::string more : {"--shadow-dark 0.9", "--shadow-bias 40"}) {
    ASSERT_EQ(run("render demo --size 96x72 -o b.png " + more + lamp).code, 0);
    EXPECT_NE(folder.read("a.png"), folder.read("b.png")) << more;
  }
  ASSERT_EQ(run("render demo --size 96x72 -o b.png --shadow-bias auto" + lamp).code, 0);
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  // Volumes need no key of the configuration.
  const Result counted =
      run("verify demo --size 96x72 --engines golden,model --shadow-volumes --shadow=-12,16,-2");
  EXPECT_EQ(counted.code, 0) << counted.out << counted.err;
  EXPECT_NE(counted.out.find("stencil"), std::string::npos) << counted.out;
}

TEST_F(Cli, WireFramesAreDrawn) {
  const std::string size = " --size 96x72";
  const std::string spot = source_path("tests/data/spot.obj");
  ASSERT_EQ(run("render " + spot + " -o solid.png" + size).code, 0);
  ASSERT_EQ(run("render " + spot + " -o all.png --wireframe all" + size).code, 0);
  ASSERT_EQ(run("render " + spot + " -o hidden.png --wireframe hidden --emit-tri h.tri" + size).code, 0);
  EXPECT_NE(folder.read("solid.png"), folder.read("all.png"));
  EXPECT_NE(folder.read("all.png"), folder.read("hidden.png"));
  EXPECT_NE(folder.read("h.tri").find("{\"l\":"), std::string::npos);
  const Result held = run("verify " + spot + " --engines golden,model --wireframe hidden" + size);
  EXPECT_EQ(held.code, 0) << held.out << held.err;
  EXPECT_NE(held.out.find("line_walk"), std::string::npos) << held.out;
  const std::string bias = "--wireframe-bias: is of hidden lines; give --wireframe hidden too";
  stream("a.tri");
  for (const std::string& scene : {spot, std::string("a.tri")}) {
    refused("render " + scene + " -o a.png --wireframe-bias 3", bias);
    refused("render " + scene + " -o a.png --wireframe all --wireframe-bias 3", bias);
    refused("render " + scene + " -o a.png --wireframe some", "--wireframe");
  }
  refused("render h.tri@2 -o a.png", "leave @2 out");
}

TEST_F(Cli, BadShadowsAreRefused) {
  stream("a.tri");
  const std::string demo = "render demo --size 64x48 -o a.png ";
  for (const std::string light : {"1,2", "1,2,3,4", "1,2,x", "1,2,3,4,5,6", "1,2,3,4,5,6,7,8", "one"}) {
    refused(demo + "--shadow " + light, "--shadow: '" + light + "' is not a light");
  }
  refused(demo + "--shadow nan,0,0", "--shadow: ");
  refused(demo + "--shadow 1e999,0,0", "--shadow: ");
  refused(demo + "--shadow 0,9,0,0,0,9,160", "--shadow: 160 is not legal; expected 0, or 0.01 to below 160");
  refused(demo + "--shadow 0,9,0,0,9,0,60", "the light stands at what it looks at");
  refused(demo + "--shadow 0,9,0 --shadow-map 0", "--shadow-map: 0 is not legal; expected 1..8192 texels");
  refused(demo + "--shadow 0,9,0 --shadow-map 9000", "--shadow-map: 9000 is not legal");
  refused(demo + "--shadow 0,9,0 --shadow-map x", "--shadow-map");
  refused(demo + "--shadow 0,9,0 --shadow-bias -1", "--shadow-bias: -1 is not legal; expected 0..64 texels");
  refused(demo + "--shadow 0,9,0 --shadow-bias much",
          "--shadow-bias: 'much' is not a number of texels or auto");
  refused(demo + "--shadow 0,9,0 --shadow-bias auto --shadow-volumes", "--shadow-volumes: needs no map");
  refused(demo + "--shadow-volumes", "--shadow-volumes: is for a shadow");
  refused(demo + "--shadow 0,9,0 --shadow-volumes --shadow-plane 0,0,0,0,1,0",
          "--shadow-plane, --shadow-volumes: exclude each other");
  refused(demo + "--shadow 0,9,0 --shadow-dark 2", "--shadow-dark: 2 is not legal; expected 0..1");
  // Companions without a light, whatever scene it is.
  const std::vector<std::string> scenes{"demo", "floor", "a.tri", "extreme/slivers",
                                        source_path("tests/data/spot.obj")};
  const std::vector<std::string> flags{"--shadow-map", "--shadow-bias", "--shadow-dark"};
  for (const std::string& scene : scenes) {
    for (const std::string& flag : flags) {
      refused("render " + scene + " -o a.png " + flag + " 1",
              flag + ": is for a shadow; expected --shadow x,y,z beside it");
    }
  }
  refused("verify a.tri --shadow-map 1", "--shadow-map: is for a shadow");
  // A configuration that does not divide, and scenes with passes of their own.
  refused(demo + "--shadow 30,60,0",
          "texture1.coordinates: is project, and the configuration has project.unit");
  refused("render mirror --size 64x48 -o a.png --shadow 0,9,0",
          "mirror: a shadow is for a scene without commands and projector; leave it out");
}

// What an array of NumPy holds behind its header.
std::string data_of(const std::string& npy) { return npy.substr(npy.find('\n') + 1); }
bool has_shape(const std::string& npy, const std::string& shape) {
  return npy.substr(0, npy.find('\n')).find("'shape': (" + shape + ")") != std::string::npos;
}

// The larger scene drawn alone, its picture averaged here, against --supersample.
TEST_F(Cli, SamplesAreAveraged) {
  const Result r = run("render floor --size 32x24 --supersample 3 -o a.png --dump d --emit-tri larger.tri");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("floor: 96x72 averaged to 32x24, "), std::string::npos) << r.out;
  ASSERT_EQ(run("render larger.tri --dump e --engine golden").code, 0);
  EXPECT_EQ(folder.read("d/color.npy"), folder.read("e/color.npy"));
  EXPECT_EQ(folder.read("d/depth.npy"), folder.read("e/depth.npy"));
  const std::string resolved = folder.read("d/resolved.npy");
  ASSERT_TRUE(has_shape(folder.read("d/color.npy"), "72, 96, 4"));
  ASSERT_TRUE(has_shape(resolved, "24, 32, 4"));
  const std::string samples = data_of(folder.read("e/color.npy"));
  std::string mean;
  std::set<char> codes;
  for (std::size_t y = 0; y < 24; ++y) {
    for (std::size_t x = 0; x < 32; ++x) {
      for (std::size_t c = 0; c < 4; ++c) {
        int sum = 0;
        for (std::size_t s = 0; s < 9; ++s) {
          sum += static_cast<unsigned char>(samples[4 * ((3 * y + s / 3) * 96 + 3 * x + s % 3) + c]);
        }
        mean += static_cast<char>((2 * sum + 9) / 18);  // SC_RND
        codes.insert(mean.back());
      }
    }
  }
  EXPECT_TRUE(data_of(resolved) == mean);
  EXPECT_GT(codes.size(), 20U);  // edges are smooth
  EXPECT_EQ(nlohmann::json::parse(folder.read("d/run.json")).at("supersample"), 3);
  EXPECT_FALSE(nlohmann::json::parse(folder.read("e/run.json")).contains("supersample"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("e/resolved.npy")));
  ASSERT_EQ(run("render floor --size 32x24 --supersample 3 -o b.png --engine golden").code, 0);
  EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  ASSERT_EQ(run("render floor --size 32x24 --supersample 1 -o c.png").code, 0);
  ASSERT_EQ(run("render floor --size 32x24 -o d.png").code, 0);
  EXPECT_EQ(folder.read("c.png"), folder.read("d.png"));
  EXPECT_NE(folder.read("a.png"), folder.read("c.png"));
}

TEST_F(Cli, VerifyComparesTheAverages) {
  const Result r =
      run("verify floor --size 32x24 --supersample 2 --engines golden,model,systemc,ideal --json v.json");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("averaged picture against ideal: PSNR "), std::string::npos) << r.out;
  const auto scene = nlohmann::json::parse(folder.read("v.json")).at("scenes")[0];
  const auto& pairs = scene.at("pairs");
  // The mean smooths where samples differ from those of ideal.
  EXPECT_GT(scene.at("resolve_samples").at("psnr_db"), scene.at("picture").at("psnr_db"));
  const auto& model = pairs[0].at("resolve_samples");
  EXPECT_EQ(model.at("values"), 32 * 24 * 4);
  EXPECT_EQ(model.at("own"), 32 * 24 * 4);
  EXPECT_GT(model.at("non_trivial"), 100);
  EXPECT_EQ(model.at("differences"), 0);
  EXPECT_EQ(pairs[1].at("resolve_samples").at("own"), 0);  // systemc takes the model's
  int values = 0;
  for (const auto& stage : pairs[0].at("stages")) values += stage.at("values").get<int>();
  for (const char* part : {"picture", "resolve_samples", "counters"})
    values += pairs[0].at(part).at("values").get<int>();
  EXPECT_EQ(pairs[0].at("all").at("values"), values);
  EXPECT_EQ(run("verify floor --size 32x24 --engines golden,model").out.find("resolve_samples"),
            std::string::npos);
}

TEST_F(Cli, PositionsComeWithTheDumpOnRequest) {
  stream("a.tri");
  ASSERT_EQ(run("render a.tri --dump d --position").code, 0);
  ASSERT_EQ(run("render a.tri --dump e").code, 0);
  EXPECT_TRUE(has_shape(folder.read("d/s.npy"), "24, 32"));
  EXPECT_TRUE(has_shape(folder.read("d/position.npy"), "24, 32, 3"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("e/s.npy")));
  for (const char* file : {"color.npy", "depth.npy", "u.npy", "v.npy", "triangle.npy"}) {
    EXPECT_EQ(folder.read(std::string("d/") + file), folder.read(std::string("e/") + file)) << file;
  }
  const std::string s = data_of(folder.read("d/s.npy"));
  const std::string depth = data_of(folder.read("d/depth.npy"));
  ASSERT_EQ(s.size(), 2 * depth.size());
  int seen = 0;
  for (std::size_t i = 0; i < 32 * 24; ++i) {
    double distance = 0;
    std::uint32_t code = 0;
    std::memcpy(&distance, s.data() + 8 * i, 8);
    std::memcpy(&code, depth.data() + 4 * i, 4);
    EXPECT_EQ(code == 0, std::isnan(distance));
    if (code == 0) continue;
    ++seen;
    EXPECT_TRUE(distance > 1.9 && distance < 50.1) << distance;
  }
  EXPECT_GT(seen, 100);
}

TEST_F(Cli, DynamicAndProceduralTexturesAreDrawnAndStored) {
  const std::string sea = "'" + source_path("tests/data/sea.tri") + "'";
  ASSERT_EQ(run("render " + sea + " -o zero.png").code, 0);
  ASSERT_EQ(run("render " + sea + " -o first.png --frame 0").code, 0);
  ASSERT_EQ(run("render " + sea + " -o two.png --frame 2 --emit-tri plain.tri --plain-textures").code, 0);
  EXPECT_EQ(folder.read("zero.png"), folder.read("first.png"));
  EXPECT_NE(folder.read("zero.png"), folder.read("two.png"));
  EXPECT_EQ(folder.read("plain.tri").find("procedural"), std::string::npos);
  ASSERT_EQ(run("render plain.tri -o stored.png --engine golden").code, 0);
  EXPECT_EQ(folder.read("two.png"), folder.read("stored.png"));
}

// Two triangles, each on a target of its own.
// More triangles than a piece has, which is read while the one before it is drawn.
TEST_F(Cli, ALongStreamIsDrawnWhileItIsRead) {
  constexpr int count = 40000;
  std::string text =
      R"({"bitspan": 2, "width": 64, "height": 48, "s_min": 1, "s_max": 100, "focal": 60, "background": [1, 2, 3]})"
      "\n";
  const auto triangle = [](int i, double u) {
    const double x = (i * 7) % 60, y = (i * 13) % 44;
    return fmt::format(R"({{"v": [[{0}, {1}, {2}, {3}, 0], [{4}, {1}, 50, 8, 0], [{0}, {5}, 9, 0, 8]]}})"
                       "\n",
                       x, y, 2 + i % 90, u, x + 3, y + 3);
  };
  for (int i = 0; i < count; ++i) {
    if (i % 4096 == 0)
      text += fmt::format(R"({{"state": {{"scissor.left": {}}}}})"
                          "\n",
                          i / 4096);
    if (i % 16384 == 16383) text += fmt::format("{{\"target\": {}}}\n", i / 16384 % 2);
    text += triangle(i, 4);
  }
  text += "{\"clear\": {\"depth\": true}}\n";
  folder.write("long.tri", text);
  const Result in_pieces = run("render long.tri -o a.png --dump a");
  ASSERT_EQ(in_pieces.code, 0) << in_pieces.err;
  EXPECT_NE(in_pieces.out.find(fmt::format("{} triangles", count)), std::string::npos);
  // What is emitted is read whole.
  ASSERT_EQ(run("render long.tri -o b.png --dump b --emit-tri same.tri").code, 0);
  for (const char* engine : {"golden", "systemc"}) {
    ASSERT_EQ(run(fmt::format("render long.tri --engine {} -o {}.png", engine, engine)).code, 0);
    EXPECT_EQ(folder.read(std::string(engine) + ".png"), folder.read("a.png"));
  }
  ASSERT_EQ(run("render same.tri -o c.png").code, 0);
  for (const char* file : {"b.png", "c.png"}) EXPECT_EQ(folder.read(file), folder.read("a.png"));
  for (const char* plane : {"color", "depth", "u", "v", "triangle"}) {
    const std::string name = fmt::format("/{}.npy", plane);
    EXPECT_EQ(folder.read("a" + name), folder.read("b" + name));
  }
  ASSERT_EQ(run("render long.tri -o t.png --show-target 1 --supersample 2").code, 0);
  ASSERT_EQ(run("render long.tri -o t2.png --show-target 1 --supersample 2 --emit-tri t.tri").code, 0);
  EXPECT_EQ(folder.read("t.png"), folder.read("t2.png"));
  refused("render long.tri -o d.png --show-target 2", "expected one of 0, 1");
  for (const char* engines : {"golden,model", "model,ideal --allow-missing"}) {
    const Result held = run(fmt::format("verify long.tri --engines {}", engines));
    EXPECT_EQ(held.code, 0) << held.out << held.err;
    EXPECT_NE(held.out.find(fmt::format("drawn: {0} of {0} triangles", count)), std::string::npos);
  }
  // What the last piece has wrong is told as if it had been first, and leaves no picture.
  folder.write("wide.tri", text + triangle(7, -300000) + triangle(8, 400000));
  refused("render wide.tri -o d.png",
          "the scene needs -300000 (triangle 40000) to 400000 (triangle 40001) texel;");
  refused("verify wide.tri --engines golden,model", "-300000 (triangle 40000) to 400000 (triangle 40001)");
  folder.write("bad.tri", text + "{}\n");
  refused("render bad.tri -o d.png", "bad.tri:40015: v: key is missing");
  EXPECT_FALSE(std::filesystem::exists(folder.path("d.png")));
}

TEST_F(Cli, AnyTargetOfAStreamIsShown) {
  const std::string header =
      R"({"bitspan": 2, "width": 32, "height": 24, "s_min": 2, "s_max": 50, "focal": 20, "background": [9, 9, 9]})";
  const auto triangle = [](const std::string& color) {
    return "{\"v\": [[2, 2, 4, 0, 0], [30, 2, 4, 0, 0], [2, 20, 9, 0, 0]], \"c\": [" + color + ", " + color +
           ", " + color + "]}\n";
  };
  const std::string red = triangle("[255, 0, 0, 255]"), blue = triangle("[0, 0, 255, 255]");
  folder.write("red.tri", header + "\n" + red);
  folder.write("blue.tri", header + "\n" + blue);
  folder.write("two.tri", header + "\n" + red + "{\"target\": 4}\n" + blue);
  for (const char* name : {"red", "blue"}) {
    ASSERT_EQ(run(std::string("render ") + name + ".tri -o " + name + ".png").code, 0);
  }
  for (const char* engine : {"golden", "model", "systemc", "ideal"}) {
    const std::string render = std::string("render two.tri --engine ") + engine;
    ASSERT_EQ(run(render + " -o last.png").code, 0) << engine;
    ASSERT_EQ(run(render + " -o four.png --show-target 4").code, 0) << engine;
    ASSERT_EQ(run(render + " -o zero.png --show-target 0").code, 0) << engine;
    EXPECT_EQ(folder.read("last.png"), folder.read("four.png")) << engine;
    EXPECT_EQ(folder.read("zero.png"), folder.read("red.png")) << engine;
    EXPECT_EQ(folder.read("four.png"), folder.read("blue.png")) << engine;
  }
  const Result held = run("verify two.tri --show-target 0");
  EXPECT_EQ(held.code, 0) << held.err;
  EXPECT_NE(run("explain two.tri 5 5 --show-target 0").out.find("triangle 0, target 0"), std::string::npos);
  EXPECT_NE(run("explain two.tri 5 5 --show-target 0").out.find("picture at (5, 5), target 0"),
            std::string::npos);
  EXPECT_NE(run("explain two.tri 5 5").out.find("triangle 1, target 4"), std::string::npos);
  refused("render two.tri -o a.png --show-target 1",
          "--show-target 1: the stream does not draw on it; expected one of 0, 4");
  refused("render red.tri -o a.png --show-target 1",
          "--show-target 1: the stream does not draw on it; expected 0");
  refused("render demo -o a.png --show-target 0", "demo: --show-target is for streams");
  refused("verify --suite 'fill.*' --show-target 0", "leave out --show-target");
}

TEST_F(Cli, FramesAndSamplesThatAreNoneAreRefused) {
  stream("a.tri");
  const std::string sea = "'" + source_path("tests/data/sea.tri") + "'";
  refused("render " + sea + " -o b.png --frame 3", "frame: 3 is not legal; expected a whole number 0..2");
  refused("render a.tri -o b.png --frame 0", "frame: the header has no dynamic texture");
  refused("render demo -o b.png --frame 0", "demo: --frame is for streams");
  refused("render a.tri -o b.png --supersample 0", "--supersample");
  refused("render a.tri -o b.png --supersample 17", "--supersample");
  refused("render demo --size 8000x6000 -o b.png --supersample 4", "are too large a picture");
  refused("render a.tri -o b.png --position", "give --dump DIR too");
  refused("render a.tri -o b.png --plain-textures", "give --emit-tri FILE.tri too");
  refused("verify --suite 'fill.*' --supersample 2", "leave out --supersample");
}

TEST_F(Cli, VerifyHoldsAndWritesItsReports) {
  stream("a.tri");
  const Result r = run("verify a.tri --engines golden,model,systemc,ideal --junit j.xml --json v.json");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("golden = systemc"), std::string::npos);
  EXPECT_NE(r.out.find("error against ideal"), std::string::npos);
  EXPECT_NE(r.out.find("0 differences (0 missed"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("a.tri: all held"), std::string::npos);
  std::istringstream in(folder.read("j.xml"));
  boost::property_tree::ptree tree;
  ASSERT_NO_THROW(boost::property_tree::read_xml(in, tree));
  const auto& suite = tree.get_child("testsuites.testsuite");
  EXPECT_GE(suite.count("testcase"), 20U);
  EXPECT_EQ(suite.get<int>("<xmlattr>.failures"), 0);
  const auto json = nlohmann::json::parse(folder.read("v.json"));
  EXPECT_TRUE(json.at("held"));
  EXPECT_EQ(json.at("scenes")[0].at("pairs").size(), 2U);
  EXPECT_GT(json.at("scenes")[0].at("pairs")[0].at("stages").at("span").at("non_trivial"), 1000);
}

TEST_F(Cli, OraclesAreDrawn) {
  stream("a.tri");
  const Result r = run("render a.tri --engine oracle:painter -o a.png");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find(" pixels covered, "), std::string::npos) << r.out;
  EXPECT_TRUE(std::filesystem::exists(folder.path("a.png")));
  refused("render a.tri --engine oracle:nobody -o b.png",
          "--engine: 'nobody' is no oracle; legal: abuffer, ");
  refused("render a.tri --engine oracle:painter --dump b", "--engine: an oracle makes a picture alone");
  refused("render a.tri --engine oracle:painter -o b.png --form scalar",
          "--form: only the engine model has it");
  EXPECT_FALSE(std::filesystem::exists(folder.path("b.png")));
}

TEST_F(Cli, BandsDrawThePictureOfTheWhole) {
  ASSERT_EQ(run("render demo --size 64x48 -o whole.png --dump whole").code, 0);
  for (const std::string engine : {"golden", "model", "model --form scalar", "model --threads 2"}) {
    const Result r = run("render demo --size 64x48 -o b.png --dump b --bands 7 --engine " + engine);
    ASSERT_EQ(r.code, 0) << r.err;
    EXPECT_NE(r.out.find("bits per pixel: depth 16, colour 24\n"), std::string::npos) << r.out;
    EXPECT_EQ(folder.read("b.png"), folder.read("whole.png")) << engine;
    for (const std::string plane : {"color", "depth", "u", "v", "triangle"}) {
      EXPECT_EQ(folder.read("b/" + plane + ".npy"), folder.read("whole/" + plane + ".npy")) << plane;
    }
    const auto json = [&](const std::string& name) {
      auto out = nlohmann::json::parse(folder.read(name + "/run.json"));
      return out.at("counters");
    };
    EXPECT_EQ(json("b"), json("whole")) << engine;
  }
  ASSERT_EQ(run("render demo --size 32x24 -o fine.png --supersample 2").code, 0);
  ASSERT_EQ(run("render demo --size 32x24 -o bands.png --supersample 2 --bands 5").code, 0);
  EXPECT_EQ(folder.read("fine.png"), folder.read("bands.png"));

  const std::string drawn = "render demo --size 64x48 -o no.png --bands=";
  refused(drawn + "0", "--bands: '0' is no height of bands; expected rows, 1 to 32768, as 16 or 480,16,1");
  refused(drawn + "-4", "--bands: '-4' is no height of bands");
  refused(drawn + "4.5", "--bands: '4.5' is no height of bands");
  refused(drawn + "49", "--bands: 49 rows are more than the picture's; expected 1 to 48 for demo");
  refused(drawn + "8,4", "--bands: one picture has bands of one height");
  refused(drawn + "8 --engine ideal",
          "--bands: the engine ideal draws whole pictures; expected golden or model");
  refused(drawn + "8 --engine systemc", "--bands: the engine systemc draws whole pictures");
  refused(drawn + "8 --statistics", "--bands: of a drawn picture");
  refused(drawn + "8 --stereo pair", "--stereo: makes a picture alone");
  refused("render demo --emit-tri no.tri --bands 8", "--bands: of a drawn picture");
}

TEST_F(Cli, BandsAreComparedWithTheWhole) {
  const Result r =
      run("verify demo --size 64x48 --engines golden,model --bands 48,16,1 --json v.json --junit j.xml");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("bands of 1 row, golden = model: "), std::string::npos) << r.out;
  const auto bands = nlohmann::json::parse(folder.read("v.json")).at("scenes")[0].at("bands");
  ASSERT_EQ(bands.size(), 3U);
  for (const auto& one : bands) {
    EXPECT_TRUE(one.at("held").get<bool>());
    EXPECT_EQ(one.at("hash"), bands[0].at("hash"));
    EXPECT_EQ(one.at("records"), bands[0].at("records"));
  }
  EXPECT_EQ(bands[0].at("set_up_again"), 0);
  EXPECT_GT(bands[2].at("set_up_again"), bands[1].at("set_up_again"));
  EXPECT_EQ(bands[2].at("bytes"), 64 * (16 + 24) / 8);
  EXPECT_NE(folder.read("j.xml").find("bands of 16 rows"), std::string::npos);

  // An engine without bands: a note where it was not named, else a failure.
  const Result left = run("verify demo --size 32x24 --no-cycles --engines golden,systemc --bands 8");
  EXPECT_EQ(left.code, 1) << left.out;
  EXPECT_NE(left.out.find("systemc left out of the bands: it draws whole pictures"), std::string::npos);
  EXPECT_EQ(
      run("verify demo --size 32x24 --no-cycles --engines golden,systemc --bands 8 --allow-missing").code, 0);
  refused("verify demo --size 32x24 --engines systemc,ideal --bands 8",
          "--bands: no engine of --engines draws bands; expected golden or model");
  refused("verify demo --size 32x24 --engines golden,model --bands 8,8", "--bands: 8 is given twice");
  refused("verify demo --size 32x24 --engines golden,model --bands 8,", "--bands: '' is no height of bands");
  refused("verify demo --size 32x24 --engines golden,model --bands 25",
          "--bands: 25 rows are more than the picture's; expected 1 to 24 for demo");
  refused("verify --suite 'fill.*' --bands 2", "leave out --bands");
}

TEST_F(Cli, HeightFieldsAreDrawnByTheirOracles) {
  const std::string ridges = "'" + source_path("tests/data/ridges.tri") + "'";
  for (const std::string name : {"horizon", "ybuffer", "ybuffer_lines"}) {
    const Result r = run("render " + ridges + " --engine oracle:" + name + " -o " + name + ".png");
    ASSERT_EQ(r.code, 0) << r.out << r.err;
  }
  EXPECT_NE(folder.read("horizon.png"), folder.read("ybuffer_lines.png"));
  stream("a.tri");
  refused("verify a.tri --oracles horizon", "--oracles: 'horizon' draws lines, and judges no picture");
  refused("render '" + source_path("tests/data/spot.obj") + "' --size 64x48 --engine oracle:horizon -o b.png",
          "is no height field in the picture's vertical direction");
  refused("render '" + source_path("tests/data/cycle.tri") + "' --engine oracle:ybuffer -o b.png",
          "--engine: oracle ybuffer does not draw this: in column ");
  // In a parallel projection vertices give their depths, and oracles judge those.
  const std::string z = run("config show --toml depth20").out;
  folder.write("z.toml", std::string(z).replace(z.find("[depth]"), 7, "[depth]\nline = \"z\""));
  ASSERT_EQ(
      run("make terrain '" + source_path("tests/data/hills.png") + "' -o h.obj --every 4 --vertical 0.00008")
          .code,
      0);
  const Result r = run(
      "verify h.obj --config z.toml --projection orthographic --no-cull --size 96x72 --engines golden,model "
      "--oracles scanline,ybuffer,painter,ray,parametric --json v.json");
  EXPECT_EQ(r.code, 0) << r.out << r.err;
  const auto json = nlohmann::json::parse(folder.read("v.json"));
  for (const auto& oracle : json.at("scenes")[0].at("oracles")) {
    EXPECT_EQ(oracle.at("unexplained"), 0) << oracle;
    EXPECT_GT(oracle.at("equal"), 600) << oracle;
  }
}

TEST_F(Cli, OraclesAreComparedAndShown) {
  stream("a.tri");
  const Result r =
      run("verify a.tri --engines golden,model --oracles all --oracle-maps maps --junit j.xml --json v.json");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("oracle half_planes against golden: "), std::string::npos) << r.out;
  EXPECT_NE(r.out.find(" ties that the bounds predict, 0 unexplained\n"), std::string::npos) << r.out;
  EXPECT_TRUE(std::filesystem::exists(folder.path("maps/a.tri-simplex.png")));
  EXPECT_NE(folder.read("j.xml").find("oracle rotations = golden"), std::string::npos);
  const auto json = nlohmann::json::parse(folder.read("v.json"));
  const auto& oracles = json.at("scenes")[0].at("oracles");
  ASSERT_GE(oracles.size(), 4U);
  for (const auto& oracle : oracles) {
    if (oracle.at("truth")) {
      EXPECT_EQ(oracle.at("unexplained"), 0) << oracle;
      EXPECT_GT(oracle.at("equal"), oracle.at("unit") == "pixels" ? 100 : 40) << oracle;
    }
    if (oracle.at("oracle") == "parametric") {
      EXPECT_EQ(oracle.at("counts").at("gaps"), 0) << oracle;
    }
  }
  // An oracle is enough of a comparison, but for one that is not of the truth.
  EXPECT_EQ(run("verify a.tri --engines model --oracles simplex").code, 0);
  EXPECT_EQ(run("verify a.tri --engines model --oracles painter_mid_z").code, 1);
  const Result explained = run("explain a.tri 8 8 --engines golden,model --oracles half_planes");
  EXPECT_EQ(explained.code, 0) << explained.out;
  EXPECT_NE(explained.out.find("oracle half_planes against golden: equal"), std::string::npos)
      << explained.out;

  // What no oracle draws is told, and is a failure unless it is allowed.
  std::string text = folder.read("a.tri");
  text[text.find('1')] = '2';  // the format
  folder.write("clear.tri", text + "{\"clear\": {\"depth\": true}}\n");
  const Result left_out = run("verify clear.tri --engines golden,model --oracles simplex --junit j.xml");
  EXPECT_EQ(left_out.code, 1) << left_out.out;
  EXPECT_NE(left_out.out.find("FAILED: oracle simplex left out: the stream has a command"), std::string::npos)
      << left_out.out;
  EXPECT_EQ(run("verify clear.tri --engines golden,model --oracles simplex --allow-missing").code, 0);
  EXPECT_EQ(run("explain clear.tri 8 8 --engines golden --oracles simplex").code, 1);
  // All asks for those that fit, which is one at least.
  EXPECT_EQ(run("verify clear.tri --engines golden,model --oracles all").code, 1);
  EXPECT_EQ(run("explain clear.tri 8 8 --engines golden --oracles all").code, 1);
  refused("explain a.tri 8 8 --oracles nobody", "'nobody' is no oracle");
  refused("verify a.tri --oracles nobody", "'nobody' is no oracle; legal: all, abuffer, half_planes, ");
  refused("verify a.tri --engines golden,model --oracle-maps maps", "--oracle-maps: goes with --oracles");
  refused("verify --suite 'fill.*' --oracles all", "leave out --oracles");
}

TEST_F(Cli, EdgesAreDrawnJudgedAndExplained) {
  const std::string bodies = source_path("tests/data/bodies.obj") + " --yaw 35 --pitch 22 --size 120x90";
  const Result drawn = run("render " + bodies + " --engine oracle:roberts -o edges.png");
  ASSERT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_NE(drawn.out.find("\n11 bodies, 0 of them triangles of what is not convex, "), std::string::npos)
      << drawn.out;
  const Result r =
      run("verify " + bodies +
          " --engines golden,model --oracles roberts --oracle-maps maps --junit j.xml --json v.json");
  EXPECT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("oracle roberts against rays: "), std::string::npos) << r.out;
  EXPECT_NE(r.out.find(" near a crossing, 0 unexplained; 11 bodies, "), std::string::npos) << r.out;
  EXPECT_FALSE(std::filesystem::is_empty(folder.path("maps")));
  EXPECT_NE(folder.read("j.xml").find("oracle roberts = rays"), std::string::npos);
  const auto judged = nlohmann::json::parse(folder.read("v.json")).at("scenes")[0].at("oracles")[0];
  EXPECT_EQ(judged.at("unit"), "points of edges");
  EXPECT_GT(judged.at("counts").at("new edges where bodies cut each other"), 3);
  // It says nothing of an engine.
  const Result alone = run("verify " + bodies + " --engines golden --oracles roberts");
  EXPECT_EQ(alone.code, 1) << alone.out;
  EXPECT_NE(alone.out.find("FAILED: nothing was compared"), std::string::npos) << alone.out;
  stream("a.tri");
  const Result pixel = run("explain a.tri 3 11 --engines golden,model --oracles roberts");
  EXPECT_EQ(pixel.code, 0) << pixel.out << pixel.err;
  EXPECT_NE(pixel.out.find("oracle roberts, edge of triangle "), std::string::npos) << pixel.out;
  EXPECT_NE(pixel.out.find(", visible against rays: equal"), std::string::npos) << pixel.out;
  EXPECT_NE(run("explain a.tri 8 8 --engines golden,model --oracles roberts").out.find("no edge passes"),
            std::string::npos);
  refused("render a.tri --engine oracle:roberts --dump d", "--engine: an oracle makes a picture alone");
}

TEST_F(Cli, VerifySaysWhereNothingIsDrawn) {
  stream("off.tri", "{\"v\": [[-20, 2, 2, 0, 0], [-3, 4, 50, 20, 0], [-5, 22, 9, 0, 20]]}\n");
  const Result r = run("verify off.tri --engines golden,model,ideal --junit j.xml");
  EXPECT_EQ(r.code, 1) << r.out << r.err;
  EXPECT_NE(r.out.find("FAILED: the scene covers no pixel centre"), std::string::npos) << r.out;
  EXPECT_NE(folder.read("j.xml").find("failures=\"1\""), std::string::npos) << folder.read("j.xml");
  const Result allowed = run("verify off.tri --engines golden,model,ideal --allow-empty --json v.json");
  EXPECT_EQ(allowed.code, 0) << allowed.out << allowed.err;
  EXPECT_NE(allowed.out.find("note: the scene covers no pixel centre"), std::string::npos) << allowed.out;
  EXPECT_NE(allowed.out.find("off.tri: nothing was compared, as allowed"), std::string::npos) << allowed.out;
  EXPECT_EQ(allowed.out.find("all held"), std::string::npos) << allowed.out;
  const auto json = nlohmann::json::parse(folder.read("v.json"));
  EXPECT_TRUE(json.at("held"));
  EXPECT_FALSE(json.at("scenes")[0].at("compared"));
  // render draws the background.
  EXPECT_EQ(run("render off.tri -o off.png").code, 0);
}

// Every stage up to depth has values, so the pair has: the verdict says which stages have none.
TEST_F(Cli, StagesThatNoPixelReachesAreNoSuccess) {
  stream("one.tri");
  Config c = shipped_config("narrow");
  c.depth_func = DepthFunc::never;
  folder.write("never.toml", to_toml(c));
  const std::string text =
      "texture, fog and merge compared nothing: no pixel passes the depth test (depth.func = never)";
  const std::string verify = "verify one.tri --config never.toml --engines golden,model,ideal";
  const Result r = run(verify + " --junit j.xml --json v.json");
  EXPECT_EQ(r.code, 1) << r.out << r.err;
  EXPECT_NE(r.out.find("FAILED: " + text + " (--allow-empty accepts this)"), std::string::npos) << r.out;
  EXPECT_NE(folder.read("j.xml").find("failures=\"1\""), std::string::npos) << folder.read("j.xml");
  const auto json = nlohmann::json::parse(folder.read("v.json"));
  EXPECT_FALSE(json.at("held"));
  EXPECT_EQ(json.at("scenes")[0].at("not_reached"), (std::vector<std::string>{"texture", "fog", "merge"}));

  const Result allowed = run(verify + " --allow-empty --junit j.xml");
  EXPECT_EQ(allowed.code, 0) << allowed.out << allowed.err;
  EXPECT_NE(allowed.out.find("note: " + text), std::string::npos) << allowed.out;
  EXPECT_NE(allowed.out.find("one.tri: all held but what no pixel reaches, as allowed"), std::string::npos)
      << allowed.out;
  EXPECT_NE(folder.read("j.xml").find("skipped=\"3\""), std::string::npos) << folder.read("j.xml");

  // All pixels of the triangle are transparent.
  stream("clear.tri",
         "{\"v\": [[2, 2, 2, 0, 0], [30, 4, 50, 20, 0], [5, 22, 9, 0, 20]], "
         "\"c\": [[1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0]]}\n");
  const Result clear = run("verify clear.tri --engines golden,model");
  EXPECT_EQ(clear.code, 1) << clear.out << clear.err;
  EXPECT_NE(
      clear.out.find("FAILED: fog and merge compared nothing: the texture kills every pixel that passes "
                     "the depth test (--allow-empty accepts this)"),
      std::string::npos)
      << clear.out;
  const Result seen = run("verify one.tri --engines golden,model --json v.json");
  EXPECT_EQ(seen.code, 0) << seen.out;
  EXPECT_TRUE(nlohmann::json::parse(folder.read("v.json")).at("scenes")[0].at("not_reached").empty());
}

TEST_F(Cli, AMeshWithoutAFaceInSightIsNoSuccess) {
  folder.write("tilted.obj", "v 0 0 0\nv 1 0 0.5\nv 0 1 -0.5\nf 1 2 3\n");
  const Result seen = run("verify tilted.obj --yaw 0 --size 64x48 --engines golden,model --json v.json");
  EXPECT_EQ(seen.code, 0) << seen.out << seen.err;
  EXPECT_NE(seen.out.find("faces: 1 read, 0 culled, 0 outside, 1 drawn"), std::string::npos) << seen.out;
  EXPECT_EQ(nlohmann::json::parse(folder.read("v.json")).at("scenes")[0].at("faces").at("drawn"), 1);
  const std::string culled = "tilted.obj --yaw 180 --size 64x48 ";
  const auto before = files();
  const std::vector<std::string> commands = {"render " + culled + "-o a.png", "sim " + culled,
                                             "explain tilted.obj 3 3 --yaw 180 --size 64x48"};
  for (const std::string& command : commands) {
    const Result r = run(command);
    EXPECT_EQ(r.code, 1) << command << r.err;
    EXPECT_NE(r.err.find("no face is drawn; faces: 1 read, 1 culled, 0 outside, 0 drawn"), std::string::npos)
        << r.err;
    EXPECT_EQ(r.out, "");
  }
  EXPECT_EQ(files(), before);
  const Result verify = run("verify " + culled + "--engines golden,model");
  EXPECT_EQ(verify.code, 1) << verify.out << verify.err;
  EXPECT_NE(verify.out.find("FAILED: no face of the mesh is drawn"), std::string::npos) << verify.out;
  EXPECT_EQ(run("verify " + culled + "--engines golden,model --allow-empty").code, 0);
  for (const std::string& command : commands) {
    EXPECT_EQ(run(command + " --allow-empty").code, 0) << command;
  }
}

TEST_F(Cli, NothingComparedIsNoSuccess) {
  const Result one = run("demo --engines golden --size 64x48");
  EXPECT_EQ(one.code, 1) << one.out << one.err;
  EXPECT_NE(one.out.find("FAILED: nothing was compared"), std::string::npos) << one.out;
  EXPECT_EQ(folder.read("bitspan-demo/report.html").find("all held"), std::string::npos);
  EXPECT_EQ(run("demo --engines golden --size 64x48 --allow-missing").code, 0);
  stream("a.tri");
  EXPECT_EQ(run("verify a.tri --engines golden,ideal").code, 1);
  const Result allowed = run("verify a.tri --engines golden,ideal --allow-missing");
  EXPECT_EQ(allowed.code, 0);
  EXPECT_NE(allowed.out.find("a.tri: nothing was compared, as allowed"), std::string::npos) << allowed.out;
  const Result explained = run("explain a.tri 8 8 --engines golden");
  EXPECT_EQ(explained.code, 0);
  EXPECT_NE(explained.out.find("one engine: nothing was compared"), std::string::npos) << explained.out;
}

TEST_F(Cli, OwnValuesAreThoseOfTheEngineItself) {
  stream("a.tri");
  const Result r = run("verify a.tri --engines golden,model,systemc,rtl --json v.json");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  const auto pairs = nlohmann::json::parse(folder.read("v.json")).at("scenes")[0].at("pairs");
  const auto& model = pairs.at(0);
  const auto& systemc = pairs.at(1);
  const auto& rtl = pairs.at(2);
  EXPECT_EQ(model.at("all").at("own"), model.at("all").at("values"));
  EXPECT_EQ(systemc.at("stages").at("span").at("own"), 0);
  EXPECT_EQ(systemc.at("all").at("own"), systemc.at("counters").at("values"));
  const std::uint64_t spans = rtl.at("stages").at("span_setup").at("records");
  const std::uint64_t fragments = rtl.at("stages").at("span").at("records");
  EXPECT_GT(fragments, 100U);
  EXPECT_EQ(rtl.at("stages").at("span_setup").at("own"), 29 * spans);
  EXPECT_EQ(rtl.at("stages").at("span").at("own"), 13 * fragments);
  EXPECT_EQ(rtl.at("stages").at("edge_walk").at("own"), 0);
  // All but the triangle.
  std::uint64_t pixel_values = 0;
  for (const RecordType type : {RecordType::depth, RecordType::texture, RecordType::fog, RecordType::merge}) {
    const auto& stage = rtl.at("stages").at(std::string(stage_of(type)));
    const std::uint64_t own = stage.at("own");
    EXPECT_EQ(own, stage.at("records").get<std::uint64_t>() * (fields_of(type).size() - 1));
    EXPECT_GT(own, 0U);
    pixel_values += own;
  }
  EXPECT_EQ(rtl.at("picture").at("own"), 6 * 32 * 24);
  EXPECT_EQ(rtl.at("counters").at("own"), 3);
  EXPECT_EQ(rtl.at("all").at("own"), 29 * spans + 13 * fragments + pixel_values + 6 * 32 * 24 + 3);
}

// Registers change and planes are cleared while the chain in RTL runs beside the timed model.
TEST_F(Cli, TheChainKeepsItsClocksInEveryDrawStateThatItHas) {
  const auto set = [](const char* key, std::int64_t value) {
    return StateSetting{*find_state_register(key), value};
  };
  Scene scene = random_scene(4, {.width = 64, .height = 48, .triangles = 20, .size_max = 40});
  scene.commands = {{3, StateChange{false, {set("depth.write", 0), set("depth.bias", 300)}}},
                    {6, StateChange{false, {set("color.write", 0), set("depth.write", 1)}}},
                    {9, StateChange{true, {set("stipple", 0x5aa55aa5), set("scissor.left", 9)}}},
                    {12, Clear{{{1, 2, 3}}, {}, true, {}}},
                    {13, Target{1}},
                    {14, StateChange{false, {set("depth.func", static_cast<int>(DepthFunc::always))}}},
                    {20, Clear{{}, {}, true, {}}}};
  write_tri_file(folder.path("states.tri"), scene);
  const std::string verify = "verify states.tri --engines model,systemc,rtl";
  const Result held = run(verify + " --json v.json");
  EXPECT_EQ(held.code, 0) << held.out << held.err;
  EXPECT_NE(held.out.find("ideal memory"), std::string::npos) << held.out;
  const auto pairs = nlohmann::json::parse(folder.read("v.json")).at("scenes")[0].at("pairs");
  EXPECT_GT(pairs.at(1).at("stages").at("depth").at("own").get<std::uint64_t>(), 400U);

  scene.commands.push_back({20, StateChange{false, {set("target.format", 1)}}});
  write_tri_file(folder.path("states.tri"), scene);
  const Result other = run(verify);
  EXPECT_EQ(other.code, 0) << other.out << other.err;
  EXPECT_EQ(other.out.find("ideal memory"), std::string::npos) << other.out;
}

// What a tool does wrong is not the user's fault.
TEST_F(Cli, ABrokenToolExitsWith3) {
  stream("a.tri");
  const Environment cache("BITSPAN_CACHE", folder.path("cache"));
  const Environment no_tools("PATH", "/nonexistent");
  const Result r = run("render a.tri --engine rtl -o a.png");
  EXPECT_EQ(r.code, 3) << r.err;
  EXPECT_EQ(std::ranges::count(r.err, '\n'), 1) << r.err;
  EXPECT_NE(r.err.find("needs it on PATH"), std::string::npos) << r.err;
  EXPECT_EQ(r.out, "");
}

TEST_F(Cli, AFailureOfAnRtlReplaysWithThatRtlOnly) {
  {
    const RtlCopy copy;
    copy.plant_doubled_pixel();
    const Result r = run("fuzz --seed 1 --count 1 --config depth16 --engines model,rtl");
    ASSERT_EQ(r.code, 1) << r.out << r.err;
    EXPECT_NE(r.out.find("BITSPAN_ROOT=" + copy.path() + " bitspan fuzz --seed 1"), std::string::npos)
        << r.out;
    EXPECT_NE(r.out.find("BITSPAN_ROOT=" + copy.path() + " bitspan replay"), std::string::npos) << r.out;
    EXPECT_EQ(nlohmann::json::parse(folder.read("fuzz-1-0.replay.json")).at("rtl"), rtl_sources_hash());
    const Result again = run("replay fuzz-1-0.replay.json");
    EXPECT_EQ(again.code, 1) << again.out << again.err;
    EXPECT_NE(again.out.find("RTL " + rtl_sources_hash()), std::string::npos) << again.out;
  }
  refused("replay fuzz-1-0.replay.json", "BITSPAN_ROOT names another folder");
  const Result mended = run("replay --changed-rtl fuzz-1-0.replay.json");
  EXPECT_EQ(mended.code, 0) << mended.out << mended.err;
  EXPECT_NE(mended.out.find("no longer fails"), std::string::npos) << mended.out;
}

TEST_F(Cli, SuitesAreListedRunAndToldInJunitAndJson) {
  const Result all = run("verify --suite '*' --list");
  EXPECT_EQ(all.code, 0) << all.err;
  EXPECT_GE(std::ranges::count(all.out, '\n'), 240);
  EXPECT_NE(all.out.find("\ndepth.lequal/delta_f/64x48\n"), std::string::npos);
  const Result one = run("verify --suite 'depth.[gl]equal/affine/32x24' --junit j.xml --json j.json");
  EXPECT_EQ(one.code, 0) << one.out << one.err;
  EXPECT_NE(one.out.find("\n2 of "), std::string::npos) << one.out;
  EXPECT_NE(one.out.find(", 0 differences, "), std::string::npos) << one.out;
  EXPECT_NE(folder.read("j.xml").find("name=\"depth.gequal/affine/32x24\""), std::string::npos);
  const auto json = nlohmann::json::parse(folder.read("j.json"));
  EXPECT_TRUE(json.at("held"));
  ASSERT_EQ(json.at("suites").size(), 2U);
  EXPECT_GT(json.at("suites")[0].at("effect"), 0);
  EXPECT_EQ(json.at("suites")[0].at("differences"), 0);
  const std::string digest = json.at("suites")[0].at("digest");
  EXPECT_NE(one.out.find(digest), std::string::npos);
  EXPECT_NE(run("verify --suite depth.lequal/affine/32x24").out.find(digest), std::string::npos);
  EXPECT_EQ(run("verify --suite depth.lequal/affine/32x24 --seed 2").out.find(digest), std::string::npos);
}

TEST_F(Cli, SuitesRefuseWhatTheyMakeThemselves) {
  refused("verify --suite 'no.such/*'", "--suite no.such/*: matches none of");
  refused("verify --suite 'no.such/*' --list", "matches none of");
  refused("verify --suite ''", "matches none of");
  refused("verify", "scene is required, or --suite GLOB");
  refused("verify demo --list", "--list: goes with --suite");
  refused("verify demo -o .", "--output: goes with --suite");
  refused("verify demo --suite 'depth.*'", "leave out scene");
  refused("verify --suite 'depth.*' --config narrow", "leave out --config");
  refused("verify --suite 'depth.*' --engines golden", "at least two engines");
  refused("verify --suite 'depth.*' --engines golden,ideal", "ideal is not quantised");
  folder.write("file", "");
  refused("verify --suite 'depth.less/*' -o file/no", "file/no: cannot write");
}

TEST_F(Cli, AFailureOfASuiteIsToldAndReplays) {
  const RtlCopy copy;
  copy.plant_doubled_pixel();
  const Result r = run("verify --suite 'row_slope.reciprocal/delta_f/32x24' --engines model,rtl");
  ASSERT_EQ(r.code, 1) << r.out << r.err;
  EXPECT_NE(r.out.find("\n1 of "), std::string::npos) << r.out;
  EXPECT_NE(r.out.find(": 1 failed; "), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("again: BITSPAN_ROOT=" + copy.path() +
                       " bitspan verify --suite 'row_slope.reciprocal/delta_f/32x24' --engines model,rtl\n"),
            std::string::npos)
      << r.out;
  EXPECT_EQ(run("replay suite-row_slope.reciprocal-delta_f-32x24.replay.json").code, 1);
}

TEST_F(Cli, AnRtlThatIsNotWhatThePackageSaysIsADifference) {
  stream("a.tri");
  const RtlCopy copy;
  copy.replace("rtl/span.sv", "RecipTick = 1 + PixelUnitClocks;", "RecipTick = 2 + PixelUnitClocks;");
  const Result r = run("verify a.tri --engines model,golden,rtl");
  EXPECT_EQ(r.code, 1) << r.out << r.err;
  EXPECT_NE(r.out.find("FAILED: rtl broke off: assertion in the RTL"), std::string::npos) << r.out;
}

TEST_F(Cli, AReplayThatDrawsNothingSaysNothing) {
  Replay empty;
  empty.engines = {"golden", "model"};
  empty.config = shipped_config("depth16");
  Triangle off;
  off.v[0] = {-20, 2, 2, 0, 0, {1, 1, 1, 1}};
  off.v[1] = {-3, 4, 50, 20, 0, {1, 1, 1, 1}};
  off.v[2] = {-5, 22, 9, 0, 20, {1, 1, 1, 1}};
  empty.scene.triangles = {off};
  folder.write("empty.json", replay_json(empty));
  const Result r = run("replay empty.json");
  EXPECT_EQ(r.code, 1) << r.out << r.err;
  EXPECT_NE(r.out.find("this says nothing: the scene covers no pixel centre"), std::string::npos) << r.out;
  EXPECT_EQ(r.out.find("no longer fails"), std::string::npos) << r.out;
}

TEST_F(Cli, CoverageIsNotCheckedAgainstTheFirstViewWhereAViewChangesIt) {
  Replay small;
  small.engines = {"golden", "model"};
  small.config = shipped_config("depth16");
  small.scene = with_view({.width = 12, .height = 8});
  Triangle wide;
  wide.v[0] = {-20, -20, 2, 0, 0, {1, 1, 1, 1}};
  wide.v[1] = {40, -20, 5, 20, 0, {1, 1, 1, 1}};
  wide.v[2] = {-20, 40, 9, 0, 20, {1, 1, 1, 1}};
  small.scene.triangles = {wide};
  small.scene.commands = {{0, ViewChange{.width = 3, .height = 2}}};
  folder.write("small.json", replay_json(small));
  const Result r = run("replay small.json");
  EXPECT_EQ(r.code, 0) << r.out << r.err;
}

// Two tables' rows are equal whatever they are drawn with.
std::string cells(const std::string& line) {
  std::string out;
  for (const char c : line) {
    if (c != '|' && (c != ' ' || (!out.empty() && out.back() != ' '))) out += c;
  }
  while (out.ends_with(' ')) out.pop_back();
  return out;
}

TEST_F(Cli, TheReadmeQuotesWhatTheDemoPrints) {
  const std::string readme = read_file(source_path("README.md"));
  const Result r = run("demo");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  std::set<std::string> reported;
  std::istringstream report(folder.read("bitspan-demo/report.md"));
  for (std::string line; std::getline(report, line);) reported.insert(cells(line));
  const std::string prompt = "    $ ./dev demo\n";
  ASSERT_NE(readme.find(prompt), std::string::npos);
  std::istringstream quoted(readme.substr(readme.find(prompt) + prompt.size()));
  std::size_t at = 0;
  int rows = 0;
  for (std::string line; std::getline(quoted, line) && (line.empty() || line.starts_with("    "));) {
    const std::string text = line.empty() ? "" : line.substr(4);
    if (text.empty() || text == "...") continue;
    at = r.out.find(text + "\n", at);
    ASSERT_NE(at, std::string::npos) << "the demo does not print, or not in this order: " << text;
    if (text.find(" golden = ") == std::string::npos) continue;
    ++rows;
    EXPECT_TRUE(reported.contains(cells(text))) << text;
  }
  EXPECT_GE(rows, 6);
}

TEST_F(Cli, VerifyHoldsOnTheExtremes) {
  const Result r = run("verify extreme --engines golden,model,ideal");
  EXPECT_EQ(r.code, 0) << r.out << r.err;
}

TEST_F(Cli, EveryModeRunsOnTheRtl) {
  stream("a.tri");
  const std::string shipped = run("config show --toml depth16").out;
  const auto at = shipped.find("\"delta_f\"");
  ASSERT_NE(at, std::string::npos);
  for (const std::string mode : {"hyperbolic", "affine", "const_depth_rows"}) {
    std::string toml = shipped;
    folder.write("mode.toml", toml.replace(at, 9, '"' + mode + '"'));
    const Result r = run("verify a.tri --config mode.toml");
    EXPECT_EQ(r.code, 0) << r.out << r.err;
    EXPECT_NE(r.out.find("golden = rtl"), std::string::npos) << r.out;
    EXPECT_EQ(r.out.find("left out"), std::string::npos) << r.out;
  }
}

TEST_F(Cli, ExplainShowsEveryStageOfAPixel) {
  stream("a.tri");
  const Result r = run("explain a.tri 8 8 --engines golden,model");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  for (const char* stage : {"constants", "setup", "setup.edge", "edge_walk", "span_setup", "span", "depth",
                            "texture", "fog", "merge", "ideal"}) {
    EXPECT_NE(r.out.find(stage), std::string::npos) << stage;
  }
  EXPECT_NE(r.out.find("all engines agree"), std::string::npos);
  EXPECT_NE(run("explain a.tri 0 0 --engines golden,model").out.find("fragments on it: 0"),
            std::string::npos);
}

TEST_F(Cli, ExplainShowsTheDrawStateOfAFragment) {
  const std::string v = R"({"v": [[2,2,5,0,0],[28,3,6,0,0],[4,20,9,0,0]]})";
  folder.write("a.tri", R"({"bitspan": 2, "width": 32, "height": 24, "s_min": 1, "s_max": 100, "focal": 20, )"
                        R"("background": [0, 0, 0]})"
                        "\n" +
                            v + "\n" + R"({"state": {"depth.func": "always", "blend.dst": "one"}})" + "\n" +
                            v + "\n" + R"({"state": {"blend.dst": "zero"}})" + "\n" + v + "\n");
  for (const char* flags : {"", " --brief"}) {
    const Result r = run("explain a.tri 8 6 --engines golden,model" + std::string(flags));
    ASSERT_EQ(r.code, 0) << r.out << r.err;
    const std::size_t second = r.out.find("fragment 2 of 3");
    const std::size_t third = r.out.find("fragment 3 of 3");
    ASSERT_NE(third, std::string::npos) << r.out;
    // The first fragment has the first state; the others show what differs from it, and nothing else.
    EXPECT_EQ(r.out.substr(0, second).find("depth_func"), std::string::npos) << r.out;
    const std::string in_second = r.out.substr(second, third - second);
    EXPECT_NE(in_second.find("depth_func"), std::string::npos) << in_second;
    EXPECT_NE(in_second.find("always"), std::string::npos) << in_second;
    EXPECT_NE(in_second.find("one"), std::string::npos) << in_second;
    EXPECT_EQ(in_second.find("blend_src"), std::string::npos) << in_second;
    EXPECT_NE(r.out.substr(third).find("zero"), std::string::npos) << r.out;
  }
}

TEST_F(Cli, SimCountsClocks) {
  stream("a.tri");
  const Result r = run("sim a.tri --json s.json --vcd w.vcd");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("busy %"), std::string::npos);
  const auto json = nlohmann::json::parse(folder.read("s.json"));
  const std::uint64_t cycles = json.at("cycles");
  EXPECT_GT(cycles, 100U);
  for (const auto& stage : json.at("stages")) {
    const std::uint64_t sum =
        stage.at("busy").get<std::uint64_t>() + stage.at("starved").get<std::uint64_t>() +
        stage.at("blocked").get<std::uint64_t>() + stage.at("memory").get<std::uint64_t>();
    EXPECT_EQ(sum, cycles) << stage;
  }
  EXPECT_NE(folder.read("w.vcd").find("$enddefinitions"), std::string::npos);
}

TEST_F(Cli, SimCountsTheSameClocksInBothModes) {
  const auto numbers = [&](const std::string& mode) {
    const Result r = run("sim demo --size 48x36 --mode " + mode + " --json " + mode + ".json");
    EXPECT_EQ(r.code, 0) << r.err;
    auto json = nlohmann::json::parse(folder.read(mode + ".json"));
    EXPECT_EQ(json.at("mode"), mode);
    EXPECT_NE(r.out.find("mode " + mode + ", memory bus\n"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("cycles: " + json.at("cycles").dump() + "\n"), std::string::npos) << r.out;
    json.erase("mode");
    return json;
  };
  const auto cycle = numbers("cycle");
  EXPECT_GT(cycle.at("cycles").get<std::uint64_t>(), 400U);
  EXPECT_GT(cycle.at("fragments").get<std::uint64_t>(), 400U);
  EXPECT_EQ(numbers("span"), cycle);
}

TEST_F(Cli, SimTellsOfTheCaches) {
  const std::string sim = "sim demo --size 48x36 --json s.json ";
  EXPECT_EQ(run(sim).out.find("compulsory"), std::string::npos);
  EXPECT_FALSE(nlohmann::json::parse(folder.read("s.json")).contains("caches"));
  const Result r = run(sim + "--caches --access-log a.csv");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("compulsory"), std::string::npos) << r.out;
  const auto json = nlohmann::json::parse(folder.read("s.json"));
  ASSERT_EQ(json.at("caches").size(), 1U);
  const auto& texture = json.at("caches")[0];
  EXPECT_EQ(texture.at("cache"), "texture");
  const auto count = [&](const char* name) { return texture.at(name).get<std::int64_t>(); };
  EXPECT_EQ(count("hit"), json.at("cache").at("hits").get<std::int64_t>());
  EXPECT_EQ(count("compulsory") + count("capacity") + count("conflict"),
            json.at("cache").at("misses").get<std::int64_t>());
  const std::string log = folder.read("a.csv");
  EXPECT_TRUE(log.starts_with("cache,access,byte,result,writes_back\ntexture,read,")) << log.substr(0, 100);
  EXPECT_EQ(std::ranges::count(log, '\n'), 1 + count("reads"));
  refused("sim demo --memory ports --caches", "--memory bus has them");
  refused("sim demo --memory ports --access-log a.csv", "--memory bus has them");
}

TEST_F(Cli, SimRunsWithTheRtlsPorts) {
  const auto numbers = [&](const std::string& options) {
    const Result r = run("sim demo --size 48x36 --memory ports --json p.json " + options);
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_NE(r.out.find("memory ports: "), std::string::npos) << r.out;
    EXPECT_EQ(r.out.find("texture cache"), std::string::npos) << r.out;
    auto json = nlohmann::json::parse(folder.read("p.json"));
    EXPECT_EQ(json.at("ports").at("accesses").size(), 6U);
    EXPECT_FALSE(json.contains("cache"));
    json.erase("mode");
    return json;
  };
  const auto ideal = numbers("");
  EXPECT_EQ(numbers("--mode cycle"), ideal);
  EXPECT_EQ(numbers("--port-latency 1:1 --seed 5").at("cycles"), ideal.at("cycles"));
  const auto fixed = numbers("--port-latency 9");
  EXPECT_GT(fixed.at("cycles"), ideal.at("cycles"));
  EXPECT_EQ(fixed.at("ports").at("latency_min"), 9);
  const auto random = numbers("--port-latency 1:25 --port-stall 0.2 --seed 5");
  EXPECT_EQ(numbers("--port-latency 1:25 --port-stall 0.2 --seed 5"), random);
  EXPECT_NE(numbers("--port-latency 1:25 --port-stall 0.2 --seed 6").at("cycles"), random.at("cycles"));
  EXPECT_GT(random.at("ports").at("accesses")[0].at("stalled"), 10);
  EXPECT_NE(run("sim demo --size 48x36 --memory ports --port-latency 1:25 --seed 7")
                .out.find("memory ports: 1 to 25 clocks from request to answer, seed 7\n"),
            std::string::npos);
}

TEST_F(Cli, SimRefusesPortsThatAreNone) {
  const std::string sim = "sim demo --size 48x36 ";
  refused(sim + "--memory dram", "--memory: dram not in {bus,ports}");
  for (const char* option : {"--port-latency 3", "--port-stall 0.1", "--seed 4"}) {
    refused(sim + option, "--memory ports reads them");
    refused(sim + "--memory bus " + option, "--memory ports reads them");
  }
  for (const char* latency : {"0", "9:3", "1:10001"}) {
    refused(sim + "--memory ports --port-latency " + latency, "1 <= MIN <= MAX <= 10000 clocks");
  }
  for (const char* latency : {"x", "3:", ":3", "1:2:3", "1.5", "''"}) {
    refused(sim + "--memory ports --port-latency " + latency, "--port-latency");
  }
  refused(sim + "--memory ports --port-stall 1", "a probability from 0 to 0.99");
}

// In triangles of a pixel, fragments of one pixel follow one another.
constexpr const char* clocks_of_the_chain =
    "verify demo triangles/1 --size 96x72 --engines model,systemc,rtl";

TEST_F(Cli, ClocksOfTheChainAreCompared) {
  const Result right = run(std::string(clocks_of_the_chain) + " --json v.json");
  EXPECT_EQ(right.code, 0) << right.out << right.err;
  const auto chain = nlohmann::json::parse(folder.read("v.json")).at("scenes")[0].at("chain");
  ASSERT_EQ(chain.size(), 2U);
  for (const auto& memory : chain) {
    EXPECT_EQ(memory.at("systemc"), memory.at("rtl"));
    EXPECT_GT(memory.at("fragments"), 1000);
    EXPECT_NE(
        right.out.find(", clock for clock, " + memory.at("memory").get<std::string>() + ": systemc " +
                       memory.at("systemc").dump() + " cycles, rtl " + memory.at("rtl").dump() + " cycles"),
        std::string::npos)
        << right.out;
  }
  const std::string sim = run("sim demo --size 96x72 --memory ports").out;
  EXPECT_NE(sim.find("cycles: " + chain[0].at("systemc").dump() + "\n"), std::string::npos) << sim;
}

// The chain of the RTL carries out the commands itself.
TEST_F(Cli, TheChainObeysAMaskedClear) {
  const std::string triangle = "{\"v\": [[1, 1, 4, 0, 0], [30, 2, 4, 0, 0], [2, 20, 9, 0, 0]]}\n";
  folder.write(
      "masked.tri",
      R"({"bitspan": 2, "width": 32, "height": 24, "s_min": 2, "s_max": 50, "focal": 20, )"
      R"("background": [9, 9, 9]})"
      "\n" +
          triangle +
          R"({"state": {"scissor.left": 4, "scissor.bottom": 9, "color.mask": 5, "depth.write": false}})"
          "\n"
          R"({"clear": {"color": [255, 1, 2], "alpha": 3, "depth": true, "masked": true}})"
          "\n" +
          triangle);
  const Result r = run("verify masked.tri --engines systemc,rtl");
  EXPECT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("clock for clock"), std::string::npos) << r.out;
}

// A bug that costs the RTL clocks and changes none of its values.
TEST_F(Cli, ClocksOfTheChainThatDifferAreADifference) {
  const RtlCopy copy;
  copy.replace("rtl/scoreboard.sv", "assign know = hold || !known_valid_q;", "assign know = hold;");
  const Result late = run(clocks_of_the_chain);
  EXPECT_EQ(late.code, 1) << late.out << late.err;
  EXPECT_NE(late.out.find("FAILED: cycles of the chain, systemc against rtl, "), std::string::npos)
      << late.out;
  EXPECT_NE(late.out.find(" is 1 in systemc, 0 in rtl"), std::string::npos) << late.out;
}

TEST_F(Cli, SimRefusesWhatNoModeCanDo) {
  refused("sim demo --size 48x36 --mode spin", "--mode: spin not in {cycle,span}");
  refused("sim demo --size 48x36 --mode ''", "--mode");
  refused("sim demo --size 48x36 --mode span --vcd w.vcd", "mode span has no waveform");
}

TEST_F(Cli, FuzzHoldsAndACaseStandsAlone) {
  const Result r = run("fuzz --seed 3 --count 12 --streams-per-config 3 --engines golden,model");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  EXPECT_NE(r.out.find("seed 3"), std::string::npos);
  EXPECT_NE(r.out.find("0 differences"), std::string::npos);
  const auto pixels = [](const std::string& text) {
    const auto end = text.find(" span pixels");
    const auto begin = text.rfind('\n', end) + 1;
    return std::stoull(text.substr(begin, end - begin));
  };
  unsigned long long sum = 0;
  for (int i = 0; i < 12; i += 4) {
    sum += pixels(run("fuzz --seed 3 --first " + std::to_string(i) +
                      " --count 4 --streams-per-config 3 --engines golden,model")
                      .out);
  }
  EXPECT_EQ(sum, pixels(r.out));
}

TEST_F(Cli, DemoWritesItsReport) {
  const Result r = run("demo --engines golden,model --size 120x90 -o out");
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  for (const char* file : {"color.png", "depth.png", "ideal.png", "error_depth.png", "error_uv.png",
                           "error_color.png", "report.md", "report.html"}) {
    EXPECT_GT(folder.read(std::string("out/") + file).size(), 100U) << file;
  }
  const std::string html = folder.read("out/report.html");
  EXPECT_NE(html.find("all held"), std::string::npos);
  EXPECT_EQ(html.find("src=\"color"), std::string::npos) << "the page needs no other file";
}

}  // namespace
}  // namespace bitspan
