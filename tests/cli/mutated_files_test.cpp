// SPDX-License-Identifier: Apache-2.0
// Files of every kind that a command reads beside scenes, changed at random: each is read, or refused in one
// line. Under the sanitizers nothing else may happen either.
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <functional>
#include <sstream>

#include "config/config.hpp"
#include "config/store.hpp"
#include "io/npy.hpp"
#include "report/replay.hpp"
#include "report/vectors.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "study/plan.hpp"
#include "study/sweep.hpp"
#include "tb/dut_map.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

std::size_t below(Random& random, std::size_t end) {
  return end == 0 ? 0 : static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(end) - 1));
}

// What a reader may stumble on, in one format or another.
constexpr std::array<std::string_view, 32> pieces{"[",
                                                  "]",
                                                  "{",
                                                  "}",
                                                  "\"",
                                                  "'",
                                                  "\"\"\"",
                                                  "\\",
                                                  ".",
                                                  ",",
                                                  "=",
                                                  ":",
                                                  "\n",
                                                  "#",
                                                  "-",
                                                  "1e999",
                                                  "nan",
                                                  "inf",
                                                  "null",
                                                  "99999999999999999999",
                                                  "-9223372036854775808",
                                                  "18446744073709551616",
                                                  "0",
                                                  "-1",
                                                  "0.1",
                                                  "true",
                                                  "\xEF\xBB\xBF",
                                                  "\xff",
                                                  "1979-05-27",
                                                  "[[",
                                                  "\\u0000",
                                                  "0x"};

// One to four changes: of a byte, a piece put in, a range lost, doubled or moved, the end cut off, a run of
// one bracket.
std::string mutated(std::string text, Random& random) {
  for (std::int64_t n = random.integer(1, 4); n > 0; --n) {
    const std::size_t at = below(random, text.size());
    const std::size_t length = below(random, std::min<std::size_t>(text.size() - at, 40));
    switch (random.integer(0, 7)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(random.integer(0, 255));
        break;
      case 1:
        text.insert(at, pieces[below(random, pieces.size())]);
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(at, length));
        break;
      case 4:
        text.insert(below(random, text.size()), text.substr(at, length));
        break;
      case 5:
        text.replace(at, length, pieces[below(random, pieces.size())]);
        break;
      case 6:
        if (random.chance(0.2)) text.resize(at);
        break;
      case 7:
        if (random.chance(0.1)) {
          std::string run;
          const std::string_view piece = pieces[below(random, pieces.size())];
          for (std::int64_t i = random.integer(1, 2000); i > 0; --i) run += piece;
          text.insert(at, run);
        }
        break;
    }
  }
  return text;
}

// The bytes of each block of a binary stream, but for the last one, which is empty.
std::vector<std::string> blocks_of(const std::string& stream) {
  std::vector<std::string> out;
  for (std::size_t at = 8; at + 8 < stream.size(); at += 8 + out.back().size()) {
    std::uint32_t size = 0;
    std::memcpy(&size, &stream[at], sizeof size);
    out.push_back(stream.substr(at + 8, size));
  }
  return out;
}

std::string with_blocks(std::vector<std::string> blocks) {
  blocks.emplace_back();
  std::string out = "\x89TRIB1\r\n";
  std::array<std::uint32_t, 2> head{};  // size, checksum
  for (const std::string& block : blocks) {
    head[0] = static_cast<std::uint32_t>(block.size());
    head[1] = static_cast<std::uint32_t>(
        crc32_z(head[1], reinterpret_cast<const unsigned char*>(block.data()), block.size()));
    out.append(reinterpret_cast<const char*>(head.data()), sizeof head);
    out += block;
  }
  return out;
}

using Reader = std::function<void(const std::string& text)>;
using Change = std::function<std::string(const std::string& text, Random& random)>;

// Each change of each text. Both ends must be seen: texts that are read, and texts that are refused.
void read_mutated(const std::vector<std::string>& texts, const Reader& read, const Change& change = mutated) {
  const std::size_t count = is_long_run() ? 100'000 : 500;
  std::size_t was_read = 0, refused = 0;
  double longest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Random random(i);
    const std::string text = change(texts[i % texts.size()], random);
    SCOPED_TRACE(i);
    // Of the processor: a busy machine is not the text's fault.
    const std::clock_t start = std::clock();
    std::string error;
    ASSERT_NO_THROW(error = error_of([&] { read(text); }));
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    longest = std::max(longest, seconds);
    ASSERT_LT(seconds, 10);
    if (testing::Test::HasFailure()) return;
    ++(error.empty() ? was_read : refused);
  }
  EXPECT_GT(was_read, 0U);
  EXPECT_GT(refused, 0U);
  std::printf("%zu texts: %zu read, %zu refused, at most %.3f s each\n", count, was_read, refused, longest);
}

Scene small_scene() {
  return random_scene(3, {.width = 16,
                          .height = 12,
                          .triangles = 3,
                          .size_max = 16,
                          .depth_ratio_max = 4,
                          .uv_limit = 8,
                          .texture_size_max = 4});
}

TEST(MutatedFiles, Configurations) {
  std::vector<std::string> texts;
  for (const std::string& name : shipped_names) {
    texts.push_back(read_file(source_path("config/") + name + ".toml"));
    texts.push_back(to_toml(shipped_config(name)));
  }
  read_mutated(texts, [](const std::string& text) { parse_config(text, "a.toml"); });
}

TEST(MutatedFiles, Studies) {
  std::vector<std::string> texts;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("config/studies"))) {
    texts.push_back(read_file(entry.path()));
  }
  std::ranges::sort(texts);
  ASSERT_FALSE(texts.empty());
  read_mutated(texts, [](const std::string& text) { parse_study(text, "a.toml", find_config); });
}

TEST(MutatedFiles, MapsOfDesigns) {
  const std::vector<std::string> texts{read_file(source_path("examples/dut/span_walker.toml")),
                                       read_file(source_path("examples/cocotb/acme_walk.toml"))};
  read_mutated(texts, [](const std::string& text) { parse_dut_map(text, "a.toml"); });
}

TEST(MutatedFiles, Replays) {
  Replay replay;
  replay.engines = {"golden", "model"};
  replay.found = "a test";
  replay.config = shipped_config("narrow");
  replay.scene = small_scene();
  read_mutated({replay_json(replay)}, [](const std::string& text) { parse_replay(text, "a.json"); });
}

TEST(MutatedFiles, Streams) {
  std::vector<std::string> texts;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::ostringstream text;
    write_tri(text, random_scene(seed, {.width = 16,
                                        .height = 12,
                                        .triangles = 4,
                                        .size_max = 16,
                                        .textures = 0,
                                        .command_probability = 0.5}));
    texts.push_back(text.str());
  }
  read_mutated(texts, [](const std::string& text) { check_scene(parse_tri(text, "a.tri"), "a.tri"); });
}

// What a block of a binary stream holds is changed, and its checksum made anew, so that the change is read.
TEST(MutatedFiles, BinaryStreams) {
  std::vector<std::string> texts;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Scene scene = random_scene(seed, {.width = 16,
                                      .height = 12,
                                      .triangles = 4,
                                      .size_max = 16,
                                      .textures = 0,
                                      .command_probability = 0.5});
    for (Vertex& v : scene.triangles[0].v) v.fog = 0.5;
    std::ostringstream text;
    write_trib(text, scene);
    texts.push_back(text.str());
  }
  read_mutated(
      texts, [](const std::string& text) { check_scene(parse_tri(text, "a.trib"), "a.trib"); },
      [](const std::string& text, Random& random) {
        if (random.chance(0.1)) return mutated(text, random);
        std::vector<std::string> blocks = blocks_of(text);
        std::string& block = blocks[below(random, blocks.size())];
        block = mutated(block, random);
        return with_blocks(blocks);
      });
}

TEST(MutatedFiles, Commands) {
  read_mutated({R"({"state": {"depth.func": "less", "blend.source": "one", "scissor": [0, 0, 5, 5]}})",
                R"({"clear": {"depth": 1.0, "color": [0, 0.5, 1]}})", R"({"target": 3})",
                R"({"view": {"width": 16, "height": 12, "s_min": 1.0, "s_max": 10.0, "focal": 8.0}})",
                R"({"copy": {"target": 1, "plane": "color", "texture": 0}})"},
               [](const std::string& text) { parse_command(text, "a"); });
}

TEST(MutatedFiles, PointsOfADatabase) {
  const std::string settings = settings_json(
      {{"formats.span.h.word", std::int64_t{34}}, {"perspective.mode", "affine"}, {"a.b", 0.5}});
  const std::string scenes = scenes_json({small_scene()}, 3.5);
  read_mutated({settings}, [](const std::string& text) { parse_settings(text); });
  read_mutated({scenes}, [](const std::string& text) { s_ratio_of(text); });
}

TEST(MutatedFiles, NumPyArrays) {
  const TemporaryFolder folder;
  const std::vector<std::int64_t> values{1, -2, 3, 4, 5, 6};
  write_npy(folder.path("a.npy"), {3, 2}, std::span(values));
  const std::string good = folder.read("a.npy");
  read_mutated({good}, [&](const std::string& text) {
    const IntegerTable table = read_npy_table(folder.write("a.npy", text));
    ASSERT_EQ(table.values.size(), table.rows * table.columns);
  });
}

// Vectors and their answers; what passes is drawn and compared, too.
void read_mutated_vectors(VectorFormat format, const std::string& changed) {
  const TemporaryFolder folder;
  write_vectors(make_vectors(shipped_config("narrow"), small_scene(), RecordType::depth), format,
                folder.path("v"), "0");
  const std::string name = changed.empty() ? "v" : "v/" + changed;
  read_mutated({folder.read(name)}, [&](const std::string& text) {
    folder.write(name, text);
    check_vectors(folder.path("v"), {});
  });
}

TEST(MutatedFiles, VectorsInJson) { read_mutated_vectors(VectorFormat::json, ""); }
TEST(MutatedFiles, DescriptionsOfVectors) { read_mutated_vectors(VectorFormat::npy, "vectors.json"); }
TEST(MutatedFiles, AnswersInHex) { read_mutated_vectors(VectorFormat::hex, "output.depth.hex"); }
TEST(MutatedFiles, AnswersInNpy) { read_mutated_vectors(VectorFormat::npy, "output.depth.npy"); }

}  // namespace
}  // namespace bitspan
