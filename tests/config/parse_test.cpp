// SPDX-License-Identifier: Apache-2.0
// The reader is strict: every fault is one line with file, line, key and what is legal.
#include <gtest/gtest.h>

#include <algorithm>

#include "config/names.hpp"
#include "tests/config/support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

std::string at(std::size_t line) { return "file.toml:" + std::to_string(line) + ": "; }

// The canonical text of depth16 as lines, and what stands on each.
struct Line {
  std::size_t number = 0;   // from 1
  std::size_t section = 0;  // the line of the [table] around it
  std::string path;         // of the key
  std::string key;          // as written
  std::string value;
};

struct Text {
  std::vector<std::string> lines;
  std::vector<Line> keys;
};

Text canonical() {
  Text text;
  text.lines = lines_of(to_toml(shipped_config("depth16")));
  std::string section;
  std::size_t section_line = 0;
  for (std::size_t i = 0; i < text.lines.size(); ++i) {
    const std::string& line = text.lines[i];
    if (line.starts_with('[')) {
      section = line.substr(1, line.size() - 2);
      section_line = i + 1;
    } else if (const auto equals = line.find(" = "); equals != std::string::npos) {
      std::string key = line.substr(0, equals);
      std::string bare = key;
      std::erase(bare, '"');
      std::string path = section;
      path.append(".").append(bare);
      text.keys.push_back({i + 1, section_line, path, key, line.substr(equals + 3)});
    }
  }
  return text;
}

std::string replaced(std::vector<std::string> lines, std::size_t number, const std::string& line) {
  lines[number - 1] = line;
  return text_of(lines);
}

// Keys that a file may leave out although the canonical text has them.
bool optional_key(const Line& line) {
  const bool restoring_row =
      line.path.starts_with("reciprocal.row.") || line.path.starts_with("reciprocal.edge.");
  for (const char* key : {"operand_bits", "index_bits", "table_bits", "internal_bits", "steps"}) {
    if (restoring_row && line.key == key) return true;
  }
  if (line.path == "reciprocal.pixel.bits_per_cycle") return true;
  if (line.path == "fog.depth_bits" || line.path == "fog.zone_bits") return true;
  const bool derived = line.path.starts_with("timing.") && !line.path.starts_with("timing.setup.") &&
                       !line.path.starts_with("timing.edge_walk.");
  return derived && (line.key == "latency" || line.key == "interval");
}

TEST(Parse, EveryKeyIsMandatory) {
  const Text text = canonical();
  std::size_t optional = 0;
  for (const Line& line : text.keys) {
    const std::string error = parse_error_of(replaced(text.lines, line.number, ""));
    if (optional_key(line)) {
      ++optional;
      EXPECT_EQ(error, "") << line.path;
      continue;
    }
    EXPECT_TRUE(error.starts_with(at(line.section) + line.path + ": missing; legal: ")) << line.path << "\n"
                                                                                        << error;
  }
  EXPECT_EQ(optional, 2U * 5U + 1U + 2U + 2U * 6U);
  EXPECT_GT(text.keys.size(), 120U);
}

TEST(Parse, EveryTableIsMandatory) {
  const Text text = canonical();
  std::size_t tables = 0;
  for (std::size_t i = 0; i < text.lines.size(); ++i) {
    if (!text.lines[i].starts_with('[')) continue;
    std::vector<std::string> lines = text.lines;
    std::size_t end = i + 1;
    while (end < lines.size() && !lines[end].starts_with('[')) ++end;
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i),
                lines.begin() + static_cast<std::ptrdiff_t>(end));
    const std::string name = text.lines[i].substr(1, text.lines[i].size() - 2);
    const std::string error = parse_error_of(text_of(lines));
    EXPECT_NE(error.find(": " + name + ": missing; legal: "), std::string::npos) << name << "\n" << error;
    ++tables;
  }
  EXPECT_EQ(tables, 9U + 3U + 8U);
}

TEST(Parse, UnknownKeysAreRefusedAtTheirLine) {
  const Text text = canonical();
  for (const Line& line : text.keys) {
    std::vector<std::string> lines = text.lines;
    lines[line.number - 1] += "\nbogus = 1";
    const std::string section = line.path.substr(0, line.path.rfind('.'));
    const std::string parent = line.path.starts_with("formats.") ? "formats" : section;
    const std::string error = parse_error_of(text_of(lines));
    EXPECT_TRUE(error.starts_with(at(line.number + 1) + parent + ".bogus: unknown key; legal: ")) << error;
  }
  std::vector<std::string> lines = text.lines;
  lines.emplace_back("[extra]");
  const std::string error = parse_error_of(text_of(lines));
  EXPECT_TRUE(error.starts_with(at(lines.size()) + "extra: unknown table; legal: raster, ")) << error;
}

TEST(Parse, DuplicateKeysAreRefusedAtTheirLine) {
  const Text text = canonical();
  for (const Line& line : text.keys) {
    std::vector<std::string> lines = text.lines;
    lines[line.number - 1] += "\n" + text.lines[line.number - 1];
    const std::string error = parse_error_of(text_of(lines));
    EXPECT_TRUE(error.starts_with(at(line.number + 1))) << line.path << "\n" << error;
    EXPECT_NE(error.find("redefine"), std::string::npos) << error;
  }
}

TEST(Parse, WrongTypesAreRefusedAtTheirLine) {
  const Text text = canonical();
  for (const Line& line : text.keys) {
    for (const char* value : {"1979-05-27", "[[1]]", "{ x = 1 }"}) {
      const std::string error = parse_error_of(replaced(text.lines, line.number, line.key + " = " + value));
      EXPECT_TRUE(error.starts_with(at(line.number) + line.path)) << line.path << " " << value << "\n"
                                                                  << error;
      EXPECT_NE(error.find("; legal: "), std::string::npos) << error;
    }
  }
}

TEST(Parse, IntegersMayNotBeFloatsStringsOrHuge) {
  const Text text = canonical();
  std::size_t integers = 0;
  for (const Line& line : text.keys) {
    if (line.value.find_first_not_of("0123456789") != std::string::npos ||
        line.path.starts_with("start_offset.")) {
      continue;
    }
    ++integers;
    for (const char* value : {"1.0", "\"1\"", "true", "99999999999", "-99999999999", "nan"}) {
      const std::string error = parse_error_of(replaced(text.lines, line.number, line.key + " = " + value));
      EXPECT_TRUE(error.starts_with(at(line.number) + line.path + ": ")) << error;
      EXPECT_NE(error.find("; legal: an integer"), std::string::npos) << error;
    }
    // In the reader's range, and out of the key's.
    const std::string error = parse_error_of(replaced(text.lines, line.number, line.key + " = -7"));
    EXPECT_TRUE(error.starts_with(at(line.number) + line.path + ": is -7; legal: ")) << error;
  }
  EXPECT_GT(integers, 45U);
}

TEST(Parse, NamesOutsideTheListAreRefusedWithTheList) {
  const Text text = canonical();
  std::size_t names = 0;
  for (const Line& line : text.keys) {
    if (!line.value.starts_with('"') || line.path.starts_with("start_offset.")) continue;
    ++names;
    const std::string error = parse_error_of(replaced(text.lines, line.number, line.key + " = \"Nonsense\""));
    EXPECT_TRUE(
        error.starts_with(at(line.number) + line.path + ": \"Nonsense\" is no value of this key; legal: "))
        << error;
    const std::string own = line.value.substr(1, line.value.size() - 2);
    EXPECT_NE(error.find(own), std::string::npos) << "the list has the legal value: " << error;
  }
  EXPECT_GT(names, 15U);
}

TEST(Parse, FormatFieldsAreStrict) {
  const Text text = canonical();
  const auto with = [&](const std::string& inner) {
    for (const Line& line : text.keys) {
      if (line.path == "formats.span.h") {
        return std::pair(line.number,
                         parse_error_of(replaced(text.lines, line.number, "\"span.h\" = { " + inner + " }")));
      }
    }
    return std::pair(std::size_t{0}, std::string());
  };
  const std::string all = "signed = false, word = 34, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\"";
  EXPECT_EQ(with(all).second, "");
  EXPECT_EQ(with(all + ", overflow_expected = true").second, "");
  const struct {
    const char* inner;
    const char* says;
  } faults[] = {
      {"word = 34, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.signed: missing; legal: true, false"},
      {"signed = false, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\"", "formats.span.h.word: missing"},
      {"signed = false, word = 34, round = \"SC_TRN\", overflow = \"SC_SAT\"", "formats.span.h.int: missing"},
      {"signed = false, word = 34, int = 16, overflow = \"SC_SAT\"",
       "formats.span.h.round: missing; legal: SC_RND, "},
      {"signed = false, word = 34, int = 16, round = \"SC_TRN\"",
       "formats.span.h.overflow: missing; legal: SC_WRAP, "},
      {"signed = 0, word = 34, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.signed: is an integer; legal: true, false"},
      {"signed = false, word = 64, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.word: is 64; legal: 1..63 for an unsigned format"},
      {"signed = true, word = 65, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.word: is 65; legal: 1..64 for a signed format"},
      {"signed = false, word = 0, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.word: is 0; legal: "},
      {"signed = false, word = 34, int = 65, round = \"SC_TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.int: is 65; legal: -32..64"},
      {"signed = false, word = 34, int = -31, round = \"SC_TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.int: is -31; legal: -30..66, so that word - int"},
      {"signed = false, word = 34, int = 16, round = \"TRN\", overflow = \"SC_SAT\"",
       "formats.span.h.round: \"TRN\" is no value of this key; legal: SC_RND, SC_RND_ZERO, "},
      {"signed = false, word = 34, int = 16, round = \"SC_TRN\", overflow = \"SC_WRAP_SM\"",
       "formats.span.h.overflow: is SC_WRAP_SM in an unsigned format; legal: SC_WRAP, "},
      {"signed = false, word = 34, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\", overflow_expected = "
       "1",
       "formats.span.h.overflow_expected: is an integer; legal: true, false"},
      {"signed = false, word = 34, int = 16, round = \"SC_TRN\", overflow = \"SC_SAT\", n_bits = 0",
       "formats.span.h.n_bits: unknown key; legal: signed, word, int, round, overflow, overflow_expected"},
  };
  for (const auto& fault : faults) {
    const auto [line, error] = with(fault.inner);
    EXPECT_TRUE(error.starts_with(at(line) + fault.says)) << error;
  }
}

TEST(Parse, FormatsMayBeDottedButNotGivenTwice) {
  const Config quoted = shipped_config("depth16");
  std::string dotted = to_toml(quoted);
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    const std::string key(key_of(id));
    const auto where = dotted.find('"' + key + '"');
    if (where == std::string::npos && default_format(quoted.formats, id)) continue;
    ASSERT_NE(where, std::string::npos);
    dotted.replace(where, key.size() + 2, key);
  }
  Config read = parse_config(dotted, "file.toml");
  read.name = quoted.name;
  EXPECT_EQ(read, quoted);

  std::vector<std::string> lines = lines_of(to_toml(quoted));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].starts_with("\"span.h\"")) continue;
    lines[i] += "\nspan.h" + lines[i].substr(8);
    const std::string error = parse_error_of(text_of(lines));
    EXPECT_NE(error.find("formats.span.h: is given twice, quoted and dotted; legal: once"), std::string::npos)
        << error;
  }
}

TEST(Parse, UnknownFormatsAreRefused) {
  std::string text = to_toml(shipped_config("depth16"));
  const auto where = text.find("\"span.h\"");
  text.insert(where, "span.w = { signed = false, word = 1, int = 1 }\n");
  const auto line = static_cast<std::size_t>(
                        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(where), '\n')) +
                    1;
  const std::string error = parse_error_of(text);
  EXPECT_TRUE(error.starts_with(at(line) + "formats.span.w: unknown key; legal: setup.s, ")) << error;
}

TEST(Parse, StartOffsets) {
  const Text text = canonical();
  const auto with = [&](const std::string& value) {
    for (const Line& line : text.keys) {
      if (line.path == "start_offset.edge_x") {
        return replaced(text.lines, line.number, "edge_x = " + value);
      }
    }
    return std::string();
  };
  EXPECT_EQ(parse_config(with("0"), "f").start_offset.edge_x, (StartOffset{false, 0}));
  EXPECT_EQ(parse_config(with("1"), "f").start_offset.edge_x, (StartOffset{false, 1}));
  EXPECT_EQ(parse_config(with("-0.5"), "f").start_offset.edge_x, (StartOffset{false, -0.5}));
  EXPECT_EQ(parse_config(with("\"half_ulp\""), "f").start_offset.edge_x, (StartOffset{true, 0}));
  const Config negative_zero = parse_config(with("-0.0"), "f");
  EXPECT_EQ(config_hash(negative_zero), config_hash(parse_config(with("0"), "f")));
  for (const char* value :
       {"nan", "inf", "-inf", "\"half\"", "true", "0.1", "1e300", "9223372036854775807"}) {
    const std::string error = parse_error_of(with(value));
    EXPECT_NE(error.find("start_offset.edge_x: "), std::string::npos) << value << ": " << error;
    EXPECT_NE(error.find("legal: "), std::string::npos) << error;
  }
}

TEST(Parse, TransparentColours) {
  const Text text = canonical();
  const auto with = [&](const std::string& value) {
    for (const Line& line : text.keys) {
      if (line.path == "texture.transparent") {
        return replaced(text.lines, line.number, "transparent = " + value);
      }
    }
    return std::string();
  };
  EXPECT_EQ(parse_config(with("\"none\""), "f").transparent, std::nullopt);
  EXPECT_EQ(parse_config(with("[0, 1, 255]"), "f").transparent, (std::array<std::uint8_t, 3>{0, 1, 255}));
  for (const char* value :
       {"\"magenta\"", "[0, 1]", "[0, 1, 2, 3]", "[0, 1, 256]", "[0, 1, -1]", "[0, 1, 1.5]", "7"}) {
    const std::string error = parse_error_of(with(value));
    EXPECT_NE(error.find("texture.transparent: is "), std::string::npos) << value << ": " << error;
    EXPECT_NE(error.find("legal: \"none\", an array of three integers 0..255"), std::string::npos) << error;
  }
}

TEST(Parse, RulesBetweenKeysNameTheLine) {
  const Text text = canonical();
  for (const Line& line : text.keys) {
    if (line.path == "reciprocal.pixel.pipelined") {
      const std::string error = parse_error_of(replaced(text.lines, line.number, "pipelined = false"));
      EXPECT_TRUE(error.starts_with(at(line.number) + "reciprocal.pixel.pipelined: is false")) << error;
    }
    if (line.path == "formats.merge.color") {
      const std::string error = parse_error_of(replaced(
          text.lines, line.number,
          R"("merge.color" = { signed = false, word = 9, int = 8, round = "SC_RND", overflow = "SC_SAT" })"));
      EXPECT_TRUE(
          error.starts_with(at(line.number) + "formats.merge.color: is unsigned, word 9, int 8; legal: "))
          << error;
    }
  }
}

TEST(Parse, WhateverAKeyOrAValueHoldsTheRefusalIsOneLine) {
  EXPECT_TRUE(
      parse_error_of("\"a\\nb\" = 1\n").starts_with("file.toml:1: a b: unknown key; legal: raster, "));
  const std::string text = to_toml(shipped_config("depth16"));
  const auto with = [&text](const std::string& from, const std::string& to) {
    std::string changed = text;
    return changed.replace(changed.find(from), from.size(), to);
  };
  const std::string key = parse_error_of(with("\"span.h\"", "\"span\\n.h\""));
  EXPECT_NE(key.find("formats.span .h: unknown key; "), std::string::npos) << key;
  const std::string value = parse_error_of(with("\"top_left\"", "\"top\\u001b\\tleft\""));
  EXPECT_NE(value.find("raster.fill_rule: \"top  left\" is no value of this key; "), std::string::npos)
      << value;
}

TEST(Parse, WhatIsNoTomlIsRefused) {
  EXPECT_NE(parse_error_of("").find("file.toml:1: the configuration is empty"), std::string::npos);
  EXPECT_NE(parse_error_of(" \n\t\r\n").find("empty"), std::string::npos);
  EXPECT_TRUE(parse_error_of("# only a comment\n").starts_with("file.toml:1: raster: missing; legal: "));
  EXPECT_TRUE(
      parse_error_of("[raster]\nsubpixel_bits = \n").starts_with("file.toml:2: does not parse as TOML: "));
  EXPECT_TRUE(
      parse_error_of("raster = 3\n").starts_with("file.toml:1: raster: is an integer; legal: a table"));
  EXPECT_NE(parse_error_of("\xff\xfe\x01").find("does not parse"), std::string::npos);
}

TEST(Parse, TruncatedAndDamagedTextNeverPassesSilentlyOrCrashes) {
  const std::string text = read_file(source_path("config/depth16.toml"));
  const std::size_t last_key = text.rfind("cache_ways");
  for (std::size_t size = 0; size < last_key; size += 97) {
    EXPECT_NE(parse_error_of(text.substr(0, size)), "") << size;
  }
  std::mt19937_64 random(20);
  std::size_t refused = 0;
  for (int i = 0; i < 500; ++i) {
    std::string damaged = text;
    for (int n = 0; n < 3; ++n) damaged[random() % damaged.size()] = static_cast<char>(random());
    refused += parse_error_of(damaged).empty() ? 0 : 1;  // otherwise only a comment or a legal digit changed
  }
  EXPECT_GT(refused, 200U);
}

TEST(Parse, AHeaderWithoutAKeyIsRefusedWhateverFollows) {
  for (int byte = 0; byte < 256; ++byte) {
    for (const std::string header : {"[", "[[", "[ ", "[a."}) {
      const std::string text = header + static_cast<char>(byte);
      EXPECT_NE(parse_error_of(text), "") << text;
      EXPECT_NE(parse_error_of(text + "]\n"), "") << text;
    }
  }
}

TEST(Load, NamesTheFileAndTheFault) {
  const auto error = [](const std::string& path) { return error_of([&path] { (void)load_config(path); }); };
  EXPECT_EQ(error("no/such.toml"), "no/such.toml: no such configuration file");
  const TemporaryFolder folder;
  const std::string path = folder.path("test.toml");
  EXPECT_EQ(error(folder.path()), folder.path() + ": is a directory; expected a configuration file in TOML");

  folder.write("test.toml", "");
  EXPECT_TRUE(error(path).starts_with(path + ":1: the configuration is empty")) << error(path);
  folder.write("test.toml", std::string(3U << 20U, '#'));
  EXPECT_EQ(error(path), path + ": is larger than 1 MiB; expected a configuration file in TOML");
  folder.write("test.toml", to_toml(shipped_config("narrow")));
  EXPECT_EQ(load_config(path).name, "test");
}

// A stack that ends kills the program; deep text never reaches the parser.
TEST(Parse, DepthIsLimitedBeforeTheParser) {
  const auto refused = [](const std::string& text, const std::string& part) {
    expect_refusal([&] { parse_config(text, "file.toml"); }, part);
  };
  const auto dotted = [](std::size_t parts, const std::string& one) {
    std::string key = one;
    for (std::size_t i = 1; i < parts; ++i) key.append(" . ").append(one);
    return key;
  };
  const std::string parts = "a key has too many parts; expected at most 17";
  const std::string nested = "values are nested too deep; expected at most 64 in each other";
  for (const char* one : {"a", "\"a.b\"", "'a'", "\"\\\"\""}) {
    refused("\n" + dotted(18, one) + " = 1\n", at(2) + parts);
    refused("[" + dotted(18, one) + "]\n", at(1) + parts);
    refused("x = {y = 1, " + dotted(200'000, one) + " = 1}\n", at(1) + parts);
    refused(dotted(17, one) + " = 1\n", "unknown table");
  }
  refused("x = \"\"\"\n" + dotted(30, "a") + "\n\"\"\"\n[" + dotted(18, "a") + "]\n", at(4) + parts);
  refused("x = [\n" + std::string(64, '[') + std::string(64, ']') + "]\n", at(2) + nested);
  std::string tables = "x = ";
  for (int i = 0; i < 65; ++i) tables += "{a = ";
  refused(tables, at(1) + nested);
  refused("x = " + std::string(64, '[') + std::string(64, ']') + "\n", "unknown key");

  // What looks deep and is not.
  const std::string toml = to_toml(shipped_config("depth16"));
  const std::string dots(100, '.'), brackets(100, '[');
  for (const std::string& comment : {"# " + dots + brackets + "\n", "# \"\n#" + brackets + "\n"}) {
    EXPECT_EQ(config_hash(parse_config(comment + toml, "file.toml")), config_hash(shipped_config("depth16")));
  }
  for (const std::string& text : {"\"" + dots + brackets + "\"", "'" + dots + brackets + "'",
                                  "\"\"\"" + dots + "\n\\\"\"\"" + brackets + "\"\"\"\"\"",
                                  "'\'\'" + dots + "\\\n''" + brackets + "\'\'\'"}) {
    refused("x = " + text + "\n", "unknown key");
  }
  for (std::size_t i = 0; i < 300; ++i) tables = "a" + std::to_string(i) + ".b = 1.5\n";
  refused(tables, "unknown table");
}

TEST(Parse, AByteOrderMarkIsNoPartOfTheText) {
  const std::string mark = "\xEF\xBB\xBF";
  const std::string toml = to_toml(shipped_config("narrow"));
  EXPECT_EQ(config_hash(parse_config(mark + toml, "file.toml")), config_hash(shipped_config("narrow")));
  expect_refusal([&] { parse_config(mark, "file.toml"); }, at(1) + "the configuration is empty");
  expect_refusal([&] { parse_config(mark + "\nx = 1\n", "file.toml"); }, at(2) + "x: unknown key");
}

}  // namespace
}  // namespace bitspan
