// SPDX-License-Identifier: Apache-2.0
// Vectors written and read back: nothing differs, every planted bit is found, and damaged files are refused.
#include "report/vectors.hpp"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>

#include "config/modes.hpp"
#include "io/npy.hpp"
#include "model/stages/merge.hpp"
#include "report/random_config.hpp"
#include "scene/random.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr std::array formats{VectorFormat::hex, VectorFormat::json, VectorFormat::npy};

Scene small_scene(std::uint64_t seed) {
  Scene scene = random_scene(seed, {.width = 16,
                                    .height = 12,
                                    .triangles = 4,
                                    .size_max = 16,
                                    .depth_ratio_max = 4,
                                    .uv_limit = 8,
                                    .texture_size_max = 4});
  scene.name = "small";
  return scene;
}

std::string output_file(const Vectors& v, const std::string& extension) {
  return "output." + std::string(stage_of(v.stage)) + extension;
}

// Draws of random configurations that take the scene, some in each mode.
std::vector<std::pair<Config, Scene>> random_cases(std::uint64_t seed, std::size_t count) {
  const std::vector<Config> bases = shipped_configs();
  std::vector<std::pair<Config, Scene>> out;
  for (std::uint64_t i = seed; out.size() < count; ++i) {
    const Config config = random_config(i, bases);
    const Scene scene = small_scene(i);
    try {
      const Vectors v = make_vectors(config, scene, RecordType::fragment);
      if (v.trace.merge.size() > 20) out.emplace_back(config, scene);
    } catch (const InputError&) {
    }
  }
  return out;
}

// The records of each stage that there are.
std::vector<Vectors> all_stages(const Config& config, const Scene& scene) {
  std::vector<Vectors> out;
  const Vectors drawn = make_vectors(config, scene, RecordType::fragment);
  for (const StageRow& row : stage_table) {
    if (view_of(drawn.trace, row.type).records == 0) continue;
    out.push_back(make_vectors(config, scene, row.type));
  }
  return out;
}

TEST(Vectors, OfRandomConfigurationsComeBackEqualInEveryFormat) {
  std::size_t checked = 0;
  bool has_planes = false;
  for (const auto& [config, scene] : random_cases(1, 12)) {
    has_planes = has_planes || has_plane_rows(config.perspective);
    for (const Vectors& v : all_stages(config, scene)) {
      for (const VectorFormat format : formats) {
        const TemporaryFolder folder;
        write_vectors(v, format, folder.path("v"), "0");
        const VectorCheck check = check_vectors(folder.path("v"));
        const RecordView view = view_of(v.trace, v.stage);
        EXPECT_TRUE(check.held()) << check_text(check, {"small", ""});
        EXPECT_EQ(check.matched, view.records * view.fields.size());
        EXPECT_GT(check.non_trivial, 0U);
        EXPECT_LE(check.non_trivial, check.matched);
        EXPECT_EQ(check.unchecked, 0U);
        EXPECT_TRUE(check.unchecked_fields.empty());
        ++checked;
      }
    }
  }
  EXPECT_TRUE(has_planes);
  EXPECT_GT(checked, 300U);
}

// Flips bit `bit`, counted from the right, of line `line` of a .hex text.
void flip(std::string& text, std::size_t line, int bit) {
  const std::size_t width = text.find('\n') + 1;
  char& digit = text[line * width + width - 2 - static_cast<std::size_t>(bit / 4)];
  const int value = digit <= '9' ? digit - '0' : digit - 'a' + 10;
  digit = "0123456789abcdef"[value ^ 1 << bit % 4];
}

TEST(Vectors, EveryPlantedBitIsFoundAndNamed) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int step = 7;  // one bit in seven: the sanitized build is slow, and looks for other faults
#else
  constexpr int step = 1;
#endif
  std::size_t found = 0;
  for (const auto& [config, scene] : random_cases(100, 1)) {
    for (const Vectors& v : all_stages(config, scene)) {
      const TemporaryFolder folder;
      write_vectors(v, VectorFormat::hex, folder.path("v"), "0");
      const auto json = nlohmann::json::parse(folder.read("v/vectors.json"));
      const auto& table = json.at("tables").back();
      const std::string good = folder.read("v/" + output_file(v, ".hex"));
      const RecordView view = view_of(v.trace, v.stage);
      const int bits = table.at("bits").get<int>();
      for (int bit = 0; bit < bits; bit += step) {
        const std::size_t record = static_cast<std::size_t>(bit) % view.records;
        std::string bad = good;
        flip(bad, record, bit);
        folder.write("v/" + output_file(v, ".hex"), bad);
        const VectorCheck check = check_vectors(folder.path("v"));
        ASSERT_FALSE(check.held()) << stage_of(v.stage) << " bit " << bit;
        ASSERT_TRUE(check.pair.first);
        const Divergence& d = *check.pair.first;
        if (d.kind != DivergenceKind::value) continue;  // the bit is of what tells which record it is
        const auto& field = table.at("fields").at(static_cast<std::size_t>(d.field_number));
        EXPECT_LE(field.at("lsb").get<int>(), bit);
        EXPECT_GE(field.at("msb").get<int>(), bit);
        EXPECT_EQ(check.matched, view.records * view.fields.size() - 1);
        // The model's value is the record's, decoded on its own.
        EXPECT_EQ(d.reference, view.record(record)[static_cast<std::size_t>(d.field_number)]);
        ++found;
      }
      // What is left of the first word, to whole digits.
      for (int bit = bits; bit % 4 != 0; ++bit) {
        std::string bad = good;
        flip(bad, 0, bit);
        folder.write("v/" + output_file(v, ".hex"), bad);
        expect_refusal([&] { check_vectors(folder.path("v")); }, "bits");
      }
    }
  }
  EXPECT_GT(found, 2000U / step);
}

TEST(Vectors, EveryPlantedBitOfTheInputsIsRefused) {
  const auto [config, scene] = random_cases(200, 1).front();
  std::mt19937 random(1);
  for (const Vectors& v : all_stages(config, scene)) {
    const TemporaryFolder folder;
    write_vectors(v, VectorFormat::hex, folder.path("v"), "0");
    for (const RecordView& input : inputs_of(v)) {
      const std::string name = "v/input." + std::string(input.stage) + ".hex";
      const std::string good = folder.read(name);
      for (int i = 0; i < 20; ++i) {
        std::string bad = good;
        flip(bad, random() % input.records, static_cast<int>(random() % 100));
        folder.write(name, bad);
        expect_refusal([&] { check_vectors(folder.path("v")); }, name);
      }
      std::filesystem::remove(folder.path(name));
      EXPECT_TRUE(check_vectors(folder.path("v")).held()) << "answers alone will do";
    }
  }
}

TEST(Vectors, AWrongValueIsFoundInJsonAndNpy) {
  const auto [config, scene] = random_cases(300, 1).front();
  const Vectors v = make_vectors(config, scene, RecordType::depth);
  const TemporaryFolder folder;
  write_vectors(v, VectorFormat::json, folder.path("v.json"), "0");
  const auto good = nlohmann::json::parse(folder.read("v.json"));
  const std::size_t z = static_cast<std::size_t>(field_index(RecordType::depth, "z"));
  auto bad = good;
  auto& value = bad["tables"].back()["records"][3][z];
  value = value.get<std::int64_t>() ^ 1;
  folder.write("bad.json", bad.dump());
  VectorCheck check = check_vectors(folder.path("bad.json"));
  ASSERT_EQ(check.failures.size(), 1U);
  EXPECT_NE(check.failures[0].find("stage depth, field z: model 0x"), std::string::npos) << check.failures[0];
  const std::string text = check_text(check, {"small", "bitspan check bad.json"});
  for (const char* part :
       {"first divergence: model against design", "1 values differ", "fed by span in model",
        "reproduce      bitspan check bad.json", "FAILED: model against design: triangle "}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }

  write_vectors(v, VectorFormat::npy, folder.path("v"), "0");
  IntegerTable table = read_npy_table(folder.path("v/output.depth.npy"));
  table.values[5 * table.columns + z] ^= 4;
  write_npy(folder.path("answers.npy"), {table.rows, table.columns},
            std::span<const std::int64_t>(table.values));
  check = check_vectors(folder.path("v"), {.answers = folder.path("answers.npy"), .fields = {}});
  EXPECT_EQ(check.matched + 1, table.values.size());
  ASSERT_TRUE(check.pair.first);
  EXPECT_EQ(check.pair.first->reference ^ check.pair.first->other, 4);
  EXPECT_TRUE(check_vectors(folder.path("v")).held());
}

TEST(Vectors, FieldsAndValuesMayBeMissing) {
  const auto [config, scene] = random_cases(400, 1).front();
  const Vectors v = make_vectors(config, scene, RecordType::fragment);
  const std::size_t records = v.trace.fragment.size();
  const TemporaryFolder folder;
  write_vectors(v, VectorFormat::hex, folder.path("v"), "0");
  const std::string good = folder.read("v/output.span.hex");

  // A design that has x and y alone: its other bits may be anything.
  std::string other = good;
  const auto json = nlohmann::json::parse(folder.read("v/vectors.json"));
  for (const auto& field : json.at("tables").back().at("fields")) {
    if (field.at("name") == "x" || field.at("name") == "y") continue;
    for (std::size_t i = 0; i < records; ++i) flip(other, i, field.at("lsb").get<int>());
  }
  folder.write("answers.hex", other);
  VectorCheckOptions options{.answers = folder.path("answers.hex"), .fields = {"x", "y"}};
  VectorCheck check = check_vectors(folder.path("v"), options);
  EXPECT_TRUE(check.held()) << check_text(check, {"", ""});
  EXPECT_EQ(check.matched, 2 * records);
  EXPECT_EQ(check.unchecked_fields.size(), fields<FragmentRecord>.size() - 2);
  options.fields = {"x", "y", "h"};
  check = check_vectors(folder.path("v"), options);
  EXPECT_FALSE(check.held());
  EXPECT_TRUE(names(check_text(check, {"", ""}), " | -  texel\n"))
      << "what the design does not have is not shown";
  options.fields = {"x", "nothing"};
  expect_refusal([&] { check_vectors(folder.path("v"), options); }, "--fields: 'nothing'");
  options.fields = {"x", "x"};
  expect_refusal([&] { check_vectors(folder.path("v"), options); }, "twice");

  // A record that is lost: one record, and no value that differs, also where fields are missing.
  std::string lost = good;
  const std::size_t width = lost.find('\n') + 1;
  lost.erase(3 * width, width);
  folder.write("answers.hex", lost);
  for (const std::vector<std::string>& some : {std::vector<std::string>{}, {"triangle", "x", "y", "u"}}) {
    options.fields = some;
    check = check_vectors(folder.path("v"), options);
    EXPECT_FALSE(check.held());
    ASSERT_TRUE(check.pair.first);
    EXPECT_EQ(check.pair.first->kind, DivergenceKind::missing);
    const StageCount& count = check.pair.stages[static_cast<std::size_t>(RecordType::fragment)];
    EXPECT_EQ(count.unmatched, 1U);
    EXPECT_EQ(count.differences, 0U);
    EXPECT_EQ(check.unchecked, 1U);
    EXPECT_EQ(check.matched, (records - 1) * (some.empty() ? fields<FragmentRecord>.size() : 4));
  }

  // Bits that are x, as of a register without reset.
  std::string unknown = good;
  unknown.replace(2 * width, width - 1, width - 1, 'x');
  folder.write("answers.hex", unknown);
  options.fields = {"x", "u"};
  check = check_vectors(folder.path("v"), options);
  ASSERT_EQ(check.failures.size(), 1U);
  EXPECT_NE(check.failures[0].find("unknown (x or z) in 2 values, first in record 2, field x"),
            std::string::npos)
      << check.failures[0];
  EXPECT_EQ(check.matched, 2 * (records - 1));

  // null in JSON is no answer.
  write_vectors(v, VectorFormat::json, folder.path("v.json"), "0");
  auto nulls = nlohmann::json::parse(folder.read("v.json"));
  nulls["tables"].back()["records"][0][5] = nullptr;
  nulls["tables"].back()["fields"].erase(2);
  folder.write("n.json", nulls.dump());
  check = check_vectors(folder.path("n.json"));
  EXPECT_TRUE(check.held()) << check_text(check, {"", ""});
  EXPECT_EQ(check.unanswered, 1U);
  EXPECT_EQ(check.unchecked_fields, std::vector<std::string>{"y"});
}

TEST(Vectors, NothingMatchedAndNothingNonTrivialFail) {
  const auto [config, scene] = random_cases(500, 1).front();
  const Vectors v = make_vectors(config, scene, RecordType::fragment);
  const TemporaryFolder folder;
  write_vectors(v, VectorFormat::json, folder.path("v.json"), "0");
  const auto good = nlohmann::json::parse(folder.read("v.json"));

  auto none = good;
  none["tables"].back()["records"] = nlohmann::json::array();
  folder.write("none.json", none.dump());
  const VectorCheck empty = check_vectors(folder.path("none.json"));
  EXPECT_FALSE(empty.held());
  EXPECT_EQ(empty.failures.back(), "nothing was matched");
  EXPECT_EQ(empty.unchecked, v.trace.fragment.size());

  auto nulls = good;
  for (auto& record : nulls["tables"].back()["records"]) {
    for (auto& value : record) value = nullptr;
  }
  folder.write("nulls.json", nulls.dump());
  EXPECT_EQ(check_vectors(folder.path("nulls.json")).failures,
            std::vector<std::string>{"nothing was matched"});

  auto fields = good;
  fields["tables"].back()["fields"] = nlohmann::json::array();
  folder.write("fields.json", fields.dump());
  EXPECT_EQ(check_vectors(folder.path("fields.json")).failures,
            std::vector<std::string>{"nothing was matched"});

  // Values that are right and always 0 say nothing.
  const Config plain = shipped_config("depth16");
  const Scene plain_scene = small_scene(3);
  const Vectors depth = make_vectors(plain, plain_scene, RecordType::fragment);
  write_vectors(depth, VectorFormat::json, folder.path("d.json"), "0");
  auto trivial = nlohmann::json::parse(folder.read("d.json"));
  for (auto& record : trivial["tables"].back()["records"]) {
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (record[i] != 0) record[i] = nullptr;
    }
  }
  folder.write("trivial.json", trivial.dump());
  const VectorCheck check = check_vectors(folder.path("trivial.json"));
  EXPECT_GT(check.matched, 0U);
  EXPECT_EQ(check.failures, std::vector<std::string>{"nothing non-trivial was matched"});
}

// Files that are cut anywhere, and files with a byte that is wrong, are refused or fail: they never crash,
// and never pass for equal unless what they hold is equal.
TEST(Vectors, DamagedFilesAreRefused) {
  const auto [config, scene] = random_cases(600, 1).front();
  const Vectors v = make_vectors(config, scene, RecordType::merge);
  std::mt19937 random(7);
  std::size_t refused = 0;
  std::size_t failed = 0;
  const auto try_check = [&](const TemporaryFolder& folder, const std::string& path) {
    try {
      if (check_vectors(folder.path(path)).held()) return true;
      ++failed;
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      EXPECT_TRUE(text.starts_with(folder.path())) << text;
      EXPECT_LT(text.size(), 1500U) << text;
      ++refused;
    }
    return false;
  };
  for (const VectorFormat format : formats) {
    const TemporaryFolder folder;
    write_vectors(v, format, folder.path("v"), "0");
    std::vector<std::string> files{"v"};
    if (format != VectorFormat::json) {
      const std::string extension = format == VectorFormat::hex ? ".hex" : ".npy";
      files = {"v/vectors.json", "v/output.merge" + extension, "v/input.constants" + extension};
    }
    for (const std::string& file : files) {
      const std::string good = folder.read(file);
      for (int i = 0; i < 60; ++i) {
        folder.write(file, good.substr(0, random() % (good.size() - 1)));
        EXPECT_FALSE(try_check(folder, "v")) << file;
        std::string bad = good;
        bad[random() % bad.size()] = static_cast<char>(random());
        folder.write(file, bad);
        try_check(folder, "v");
      }
      folder.write(file, "");
      EXPECT_FALSE(try_check(folder, "v")) << file;
      folder.write(file, good);
      EXPECT_TRUE(try_check(folder, "v")) << file;
    }
  }
  EXPECT_GT(refused, 300U);
  EXPECT_GT(failed, 20U);
}

TEST(Vectors, WhatIsWrongIsNamed) {
  const auto [config, scene] = random_cases(700, 1).front();
  const Vectors v = make_vectors(config, scene, RecordType::merge);
  const TemporaryFolder folder;
  write_vectors(v, VectorFormat::hex, folder.path("v"), "0");
  const std::string description = folder.read("v/vectors.json");
  const std::string words = folder.read("v/output.merge.hex");
  const auto refused = [&](const std::string& file, const std::string& text, const std::string& part) {
    const std::string good = folder.read(file);
    folder.write(file, text);
    expect_refusal([&] { check_vectors(folder.path("v")); }, part);
    folder.write(file, good);
  };
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const std::string hash = config_hash(config);
  refused("v/vectors.json", changed(description, hash, "0000000000000000"), "the hash is 0000000000000000");
  refused("v/vectors.json", changed(description, "\"bitspan_vectors\": 1", "\"bitspan_vectors\": 2"),
          "expected 1");
  refused("v/vectors.json", changed(description, "\"format\": \"hex\"", "\"format\": \"oct\""), "'oct'");
  refused("v/vectors.json", changed(description, "\"output.merge.hex\"", "\"../output.merge.hex\""),
          "folder");
  refused("v/vectors.json",
          changed(description, "{\"name\":\"triangle\",\"word\":32", "{\"name\":\"triangle\",\"word\":31"),
          "word of 32 bits");
  refused("v/output.merge.hex", words + "12\n",
          "output.merge.hex:" + std::to_string(v.trace.merge.size() + 1) + ": 2 digits");
  refused("v/output.merge.hex", "g" + words.substr(1), "output.merge.hex:1: 'g' is no hexadecimal digit");
  refused("v/output.merge.hex", "@5\n" + words, "output.merge.hex:1: address @5");
  expect_refusal([&] { check_vectors(folder.path("nowhere")); }, "nowhere: cannot read");
  expect_refusal([&] { check_vectors(folder.path()); }, "vectors.json: cannot read");
  expect_refusal([&] { check_vectors(folder.path("v"), {.answers = folder.path("none.hex"), .fields = {}}); },
                 "none.hex: cannot read");
  // What $writememh writes is read: comments, addresses, capitals, underscores.
  std::string upper = words;
  std::ranges::transform(upper, upper.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  upper.insert(1, "_");
  folder.write("v/output.merge.hex", "// 0x00000000\n@0\n" + upper);
  EXPECT_TRUE(check_vectors(folder.path("v")).held());
}

// ---- a bench of merge that knows the fields of the vectors alone ----

struct BenchTable {
  std::vector<std::string> names;
  std::vector<std::vector<std::int64_t>> rows;
  std::int64_t at(std::size_t row, const std::string& name) const {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) throw std::logic_error("no field " + name);
    return rows[row][static_cast<std::size_t>(found - names.begin())];
  }
  // The row of that triangle and pixel, or none.
  std::optional<std::size_t> find(const BenchTable& of, std::size_t row) const {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (std::equal(rows[i].begin(), rows[i].begin() + 3, of.rows[row].begin())) return i;
    }
    return std::nullopt;
  }
};
std::map<std::string, BenchTable> bench_tables(const std::string& text) {
  std::map<std::string, BenchTable> out;
  const nlohmann::json all = nlohmann::json::parse(text);
  for (const auto& json : all.at("tables")) {
    BenchTable& table = out[json.at("stage").get<std::string>()];
    for (const auto& field : json.at("fields")) table.names.push_back(field.at("name"));
    json.at("records").get_to(table.rows);
  }
  return out;
}
// The registers as the last record of state in front of a triangle has them.
DrawState bench_state(const BenchTable& states, const Config& config, std::int64_t triangle) {
  DrawState state = first_state(config);
  for (const auto& row : states.rows) {
    if (row[0] > triangle) break;
    StateChange change;
    for (std::size_t i = 0; i < state_registers().size(); ++i) change.settings.push_back({i, row[i + 1]});
    state = changed_state(state, change, config);
  }
  return state;
}

TEST(Vectors, MergeFollowsFromTheFieldsAlone) {
  std::size_t colors = 0, alphas = 0, needed = 0, alphas_needed = 0;
  for (std::uint64_t seed = 40; seed < 52; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Config config = shipped_configs()[seed % 3];
    const Scene scene = random_scene(seed, {.width = 24,
                                            .height = 18,
                                            .triangles = 30,
                                            .size_max = 24,
                                            .translucent_probability = 0.7,
                                            .command_probability = 0.5});
    for (const RecordType stage : {RecordType::merge, RecordType::merge_alpha}) {
      const Vectors v = make_vectors(config, scene, stage);
      if (view_of(v.trace, stage).records == 0) continue;
      const TemporaryFolder folder;
      write_vectors(v, VectorFormat::json, folder.path("v.json"), "0");
      EXPECT_TRUE(check_vectors(folder.path("v.json")).held());
      auto tables = bench_tables(folder.read("v.json"));
      const BenchTable& stored = tables["merge.stored"];
      const BenchTable& merged = tables["merge"];
      ASSERT_EQ(stored.rows.size(), merged.rows.size());
      const BenchTable& out = tables[std::string(stage_of(stage))];
      for (std::size_t i = 0; i < out.rows.size(); ++i) {
        const std::size_t from = stored.find(out, i).value();
        const auto second = tables["texture.second"].find(out, i);
        const BenchTable& texel = tables[second ? "texture.second" : "texture"];
        TextureRecord t{out.at(i, "triangle"), out.at(i, "x"), out.at(i, "y")};
        t.a = texel.at(second ? *second : texel.find(out, i).value(), "a");
        model::MergeStage bench = model::prepare_merge(config);
        model::set_blend(bench, model::blend_of(bench_state(tables["state"], config, t.triangle)));
        const auto code = [&](const char* name) { return static_cast<std::uint8_t>(stored.at(from, name)); };
        if (stage == RecordType::merge_alpha) {
          EXPECT_EQ(model::merged_alpha(bench, t, code("a")).a, out.at(i, "a"));
          alphas_needed +=
              model::merged_alpha(bench, t, static_cast<std::uint8_t>(~code("a"))).a != out.at(i, "a") ? 1
                                                                                                       : 0;
          ++alphas;
          continue;
        }
        ASSERT_EQ(from, i);
        DepthRecord z{t.triangle, t.x, t.y};
        z.z = tables["depth"].at(tables["depth"].find(out, i).value(), "z");
        const BenchTable& fogs = tables["fog"];
        const std::size_t fog = fogs.find(out, i).value();
        FogRecord f{t.triangle, t.x, t.y};
        f.r = fogs.at(fog, "r");
        f.g = fogs.at(fog, "g");
        f.b = fogs.at(fog, "b");
        const auto differs = [&](const std::array<std::uint8_t, 4>& found) {
          MergeRecord r;
          model::merge(bench, z, t, f, found, r);
          return r.r != out.at(i, "r") || r.g != out.at(i, "g") || r.b != out.at(i, "b") ||
                 r.z != out.at(i, "z");
        };
        EXPECT_FALSE(differs({code("r"), code("g"), code("b"), code("a")})) << "record " << i;
        needed += differs({static_cast<std::uint8_t>(~code("r")), code("g"), code("b"), code("a")}) ? 1 : 0;
        ++colors;
      }
    }
  }
  EXPECT_GT(colors, 500U);
  EXPECT_GT(needed, 300U);
  EXPECT_GT(alphas, 250U);
  EXPECT_GT(alphas_needed, 100U);
}

}  // namespace
}  // namespace bitspan
