// SPDX-License-Identifier: Apache-2.0
// Binary streams: what the reader takes and refuses is put together here by hand, from docs/formats.md.
#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <set>
#include <sstream>

#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

const std::string magic = "\x89TRIB1\r\n";
const std::string header =
    R"({"bitspan": 2, "width": 64, "height": 48, "s_min": 1, "s_max": 1000, "focal": 50.5, "background": [0, 0, 0]})";

std::string bytes_of(std::uint32_t value) {
  std::string out;
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 255U);
  return out;
}

std::string bytes_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return bytes_of(static_cast<std::uint32_t>(bits)) + bytes_of(static_cast<std::uint32_t>(bits >> 32U));
}

std::string bytes_of(std::initializer_list<double> values) {
  std::string out;
  for (const double value : values) out += bytes_of(value);
  return out;
}

// Blocks of these bytes, the last one empty.
std::string sealed(const std::vector<std::string>& blocks) {
  std::string out = magic;
  uLong crc = 0;
  for (const std::string& block : blocks) {
    crc = crc32(crc, reinterpret_cast<const Bytef*>(block.data()), static_cast<uInt>(block.size()));
    out += bytes_of(static_cast<std::uint32_t>(block.size())) + bytes_of(static_cast<std::uint32_t>(crc)) +
           block;
  }
  return out + bytes_of(0U) + bytes_of(static_cast<std::uint32_t>(crc));
}

std::string tag(char letter, char more = 0) { return {letter, more, 0, 0}; }
std::string kind(const std::string& tag, std::uint32_t size) { return tag + bytes_of(size); }

const std::string plain_kind = kind(tag('T'), 128), color_kind = kind(tag('T', 1), 224),
                  fog_kind = kind(tag('T', 2), 152), full_kind = kind(tag('T', 3), 248),
                  command_kind = kind(tag('C'), 128), part_kind = kind(tag('C', '+'), 128);
const std::string all_kinds =
    bytes_of(6U) + plain_kind + color_kind + fog_kind + full_kind + command_kind + part_kind;

// Of the stream with one block of records.
std::string stream(const std::string& records, const std::string& json = header) {
  return sealed({all_kinds + json, records});
}
// Where the records begin: behind the magic, two heads of blocks, and the first block.
const std::size_t records_begin = 8 + 8 + all_kinds.size() + header.size() + 8;

const std::string corners = bytes_of({1, 2, 3, 4, 5, 10.5, 2, 4, 5, 6, 1, 20, 1000, -7, 8e2});
const std::string colors = bytes_of({1, 0, 0, 1, 0, 0.25, 0, 1, 0, 0, 1, 0.5});
const std::string plain = tag('T') + bytes_of(0xffffffffU) + corners;

std::string command(std::string text, char more = 0) {
  text.resize(124);
  return tag('C', more) + text;
}

std::string text_of(const Scene& scene) {
  std::ostringstream out;
  write_tri(out, scene);
  return out.str();
}
std::string binary_of(const Scene& scene) {
  std::ostringstream out;
  write_trib(out, scene);
  return out.str();
}

std::string parse_error(const std::string& bytes) {
  return input_error([&] { parse_tri(bytes, "x.trib"); });
}

TEST(Trib, ReadsRecordsOfEveryKind) {
  const Scene scene = parse_tri(
      stream(plain + command(R"({"state":{"depth.func":"lequal"}})") + tag('T', 1) + bytes_of(0xffffffffU) +
             corners + colors + command(R"({"clear":)", '+') + command(R"({"depth":true}})") + tag('T', 2) +
             bytes_of(0xffffffffU) + corners + bytes_of({0, 0.25, 1}) + tag('T', 3) + bytes_of(0xffffffffU) +
             corners + colors + bytes_of({1, 0.5, 0})),
      "x.trib");
  EXPECT_EQ(scene.name, "x");
  const std::string v = R"({"v":[[1,2,3,4,5],[10.5,2,4,5,6],[1,20,1000,-7,800]])";
  const std::string c = R"(,"c":[[1,0,0,1],[0,0.25,0,1],[0,0,1,0.5]])";
  EXPECT_EQ(
      text_of(scene),
      R"({"bitspan":2,"width":64,"height":48,"s_min":1,"s_max":1000,"focal":50.5,"color_max":1,"background":[0,0,0]})"
      "\n" +
          v + "}\n" + R"({"state":{"depth.func":"lequal"}})" + "\n" + v + c + "}\n" +
          R"({"clear":{"depth":true}})" + "\n" + v + R"(,"fog":[0,0.25,1]})" + "\n" + v + c +
          R"(,"fog":[1,0.5,0]})" + "\n");
}

TEST(Trib, WritesWhatTheDocumentSays) {
  Scene scene = parse_tri(stream(plain + tag('T', 3) + bytes_of(0xffffffffU) + corners + colors +
                                 bytes_of({1, 0.5, 0}) + command(R"({"target":1})")),
                          "x.trib");
  const std::string text = text_of(scene);
  EXPECT_EQ(binary_of(scene), stream(plain + tag('T', 3) + bytes_of(0xffffffffU) + corners + colors +
                                         bytes_of({1, 0.5, 0}) + command(R"({"target":1})"),
                                     text.substr(0, text.find('\n'))));
}

// Bits 2 to 4 of the channels are project_x, project_y and project_w. Their kinds are listed where they
// occur.
TEST(Trib, TrianglesGiveTheProjection) {
  const std::string texture = bytes_of(0xffffffffU);
  const std::string w_alone = tag('T', 16) + texture + corners + bytes_of({-1, 0, 1e300});
  const std::string all = tag('T', 31) + texture + corners + colors + bytes_of({1, 0.5, 0}) +
                          bytes_of({1, 2, 3}) + bytes_of({4, 5, 6}) + bytes_of({7, 8, 9});
  const std::string kinds = bytes_of(8U) + plain_kind + color_kind + fog_kind + full_kind +
                            kind(tag('T', 16), 152) + kind(tag('T', 31), 320) + command_kind + part_kind;
  std::string second = header;
  second.insert(second.size() - 1, R"(,"projector":{"s_min":1,"s_max":8})");
  const Scene scene = parse_tri(sealed({kinds + second, plain + w_alone + all}), "x.trib");
  EXPECT_EQ(scene.projector, (Projector{1, 8}));
  const auto numbers = [&](std::size_t triangle, double Attributes::*member) {
    const auto& v = scene.triangles[triangle].v;
    return std::array{v[0].*member, v[1].*member, v[2].*member};
  };
  EXPECT_EQ(numbers(0, &Attributes::project_w), (std::array{0.0, 0.0, 0.0}));
  EXPECT_EQ(numbers(1, &Attributes::project_w), (std::array{-1.0, 0.0, 1e300}));
  EXPECT_EQ(numbers(1, &Attributes::project_x), (std::array{0.0, 0.0, 0.0}));
  EXPECT_EQ(numbers(2, &Attributes::fog), (std::array{1.0, 0.5, 0.0}));
  EXPECT_EQ(numbers(2, &Attributes::project_x), (std::array{1.0, 2.0, 3.0}));
  EXPECT_EQ(numbers(2, &Attributes::project_y), (std::array{4.0, 5.0, 6.0}));
  EXPECT_EQ(numbers(2, &Attributes::project_w), (std::array{7.0, 8.0, 9.0}));
  const std::string text = text_of(scene);
  EXPECT_EQ(binary_of(scene), sealed({kinds + text.substr(0, text.find('\n')), plain + w_alone + all}));
  EXPECT_EQ(text_of(parse_tri(text, "x.tri")), text);
  const auto refused = [&](const std::string& list, const std::string& record) {
    return parse_error(sealed({list + header, plain + record}));
  };
  EXPECT_TRUE(names(refused(all_kinds, w_alone), "a record of the tag 54 10 00 00; expected one of those"));
  EXPECT_TRUE(names(refused(kinds, tag('T', 16) + texture + corners + bytes_of({0, HUGE_VAL, 0})),
                    "project_w[1]: inf is "));
}

// Whatever attributes the triangles of a stream give.
TEST(Trib, EverySetOfAttributes) {
  Random random(1);
  Scene scene = parse_tri(stream(plain), "x.trib");
  scene.triangles.resize(2000, scene.triangles[0]);
  for (Triangle& t : scene.triangles) {
    for (const GivenAttribute& given : given_attributes) {
      if (!random.chance(0.5)) continue;
      for (Vertex& v : t.v) v.*given.member = random.uniform(0, 1);
    }
  }
  std::set<unsigned> sets;
  for (const Triangle& t : scene.triangles) {
    unsigned set = 0;
    for (const GivenAttribute& given : given_attributes) set = 2 * set + (given.is_given(t.v) ? 1 : 0);
    sets.insert(set);
  }
  EXPECT_GT(sets.size(), 12U);
  const Scene back = parse_tri(binary_of(scene), "x.trib");
  ASSERT_EQ(back.triangles.size(), scene.triangles.size());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (const GivenAttribute& given : given_attributes) {
        ASSERT_EQ(back.triangles[i].v[k].*given.member, scene.triangles[i].v[k].*given.member)
            << given.key << " " << i;
      }
    }
  }
  EXPECT_EQ(text_of(back), text_of(scene));
}

TEST(Trib, GivesTheSameTextBack) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("a"));
  std::filesystem::create_directory(folder.path("b"));
  std::size_t commands = 0, triangles = 0, fogged = 0, textured = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Scene scene = random_scene(seed, {.textures = 2, .command_probability = 0.3});
    for (std::size_t i = 0; i < scene.triangles.size(); i += 3) {
      for (Vertex& v : scene.triangles[i].v) v.fog = 0.125;
      ++fogged;
    }
    write_tri_file(folder.path("a/s.tri"), scene);
    const Scene read = read_tri(folder.path("a/s.tri"));
    write_tri_file(folder.path("b/s.trib"), read);
    EXPECT_TRUE(std::filesystem::exists(folder.path("b/s.0.png")) ||
                std::filesystem::exists(folder.path("b/s.0.bin")) || scene.textures.empty());
    const Scene back = read_tri(folder.path("b/s.trib"));
    EXPECT_EQ(text_of(back), text_of(read)) << seed;
    EXPECT_TRUE(back.commands == read.commands) << seed;
    EXPECT_EQ(binary_of(back), binary_of(read)) << seed;
    write_tri_file(folder.path("b/s.tri"), back);
    EXPECT_EQ(folder.read("b/s.tri"), folder.read("a/s.tri")) << seed;
    ASSERT_EQ(back.textures.size(), read.textures.size());
    for (std::size_t i = 0; i < back.textures.size(); ++i) {
      EXPECT_EQ(back.textures[i].rgba, read.textures[i].rgba);
      EXPECT_EQ(back.textures[i].raw, read.textures[i].raw);
    }
    commands += back.commands.size();
    triangles += back.triangles.size();
    for (const Triangle& t : back.triangles) textured += t.texture >= 0 ? 1 : 0;
  }
  EXPECT_GT(commands, 100U);
  EXPECT_GT(triangles, 100U);
  EXPECT_GT(fogged, 30U);
  EXPECT_GT(textured, 30U);
}

TEST(Trib, KeepsEveryBitOfADouble) {
  std::mt19937_64 random(7);
  Scene scene = parse_tri(stream(plain), "x.trib");
  const Triangle first = scene.triangles[0];
  constexpr double least = std::numeric_limits<double>::denorm_min();
  for (int n = 0; n < 20000; ++n) {
    Triangle t = first;
    for (Vertex& v : t.v) {
      for (double* const to : {&v.u, &v.v}) {
        do *to = std::bit_cast<double>(random());
        while (!std::isfinite(*to));
      }
      v.c = {-0.0, least, std::bit_cast<double>(random() >> 2U), 1};
      if (!(v.c[2] <= 1)) v.c[2] = 0x1.fffffffffffffp-1;
    }
    t.v[0].x = -0.0;
    t.v[1].u = n % 2 == 0 ? -0.0 : -least * n;
    t.v[0].fog = -0.0;
    t.v[1].fog = least;
    t.v[2].fog = 0.1;
    scene.triangles.push_back(t);
  }
  const Scene back = parse_tri(binary_of(scene), "x.trib");
  ASSERT_EQ(back.triangles.size(), scene.triangles.size());
  std::size_t compared = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto numbers = [](const Vertex& v) {
        return std::array{v.x, v.y, v.s, v.u, v.v, v.c[0], v.c[1], v.c[2], v.c[3], v.fog};
      };
      const auto a = numbers(scene.triangles[i].v[k]), b = numbers(back.triangles[i].v[k]);
      for (std::size_t n = 0; n < a.size(); ++n, ++compared) {
        ASSERT_EQ(std::bit_cast<std::uint64_t>(a[n]), std::bit_cast<std::uint64_t>(b[n])) << i << " " << n;
      }
    }
  }
  EXPECT_EQ(compared, 20001U * 30);
  // Through text, too: the same bytes.
  EXPECT_EQ(binary_of(parse_tri(text_of(back), "x.tri")), binary_of(scene));
}

TEST(Trib, LongCommandsGoOnInFurtherRecords) {
  Scene scene = parse_tri(stream(plain), "x.trib");
  StateChange change;
  change.reset = true;
  for (std::size_t i = 0; i < state_registers().size(); ++i) {
    if (state_registers()[i].key != "texture1" && state_registers()[i].key != "stencil.test")
      change.settings.push_back({i, 0});
  }
  scene.commands.push_back({.before = 1, .what = change});
  ASSERT_GT(command_text(scene.commands[0]).size(), 1000U);
  EXPECT_TRUE(parse_tri(binary_of(scene), "x.trib").commands == scene.commands);
  // A text that fills its record.
  for (const std::size_t size : {123U, 124U, 125U, 248U, 249U}) {
    std::string text = R"({"target":1})";
    text.insert(text.size() - 1, size - text.size(), ' ');
    std::string records;
    for (std::size_t at = 0; at < size; at += 124) {
      records += command(text.substr(at, 124), at + 124 < size ? '+' : '\0');
    }
    EXPECT_EQ(parse_tri(stream(records), "x.trib").commands.size(), 1U) << size;
  }
}

TEST(Trib, EveryTruncationIsRefusedAtItsOffset) {
  const std::string good = stream(plain + command(R"({"target":1})"));
  ASSERT_EQ(parse_tri(good, "x.trib").triangles.size(), 1U);
  for (std::size_t size = 0; size < good.size(); ++size) {
    const std::string message = parse_error(good.substr(0, size));
    EXPECT_TRUE(message.starts_with("x.trib: byte " + std::to_string(size) + ": ")) << size << " " << message;
    EXPECT_TRUE(names(message, "truncated?")) << message;
  }
  EXPECT_EQ(parse_error(good + "\n"), "x.trib: byte " + std::to_string(good.size()) +
                                          ": the file goes on behind its last block; expected its end");
}

TEST(Trib, EveryWrongBitIsRefusedWithAnOffset) {
  const std::string good = stream(plain + command(R"({"target":1})"));
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string bad = good;
      bad[at] = static_cast<char>(static_cast<unsigned char>(bad[at]) ^ 1U << bit);
      const std::string message = parse_error(bad);
      EXPECT_TRUE(message.starts_with("x.trib: byte ")) << at << " " << message;
    }
  }
}

TEST(Trib, ALostOrMovedBlockIsRefused) {
  const std::string first = plain, second = command(R"({"target":1})"), head = all_kinds + header;
  const auto block = [&](const std::string& file, std::size_t at, const std::string& bytes) {
    return file.substr(at, 8 + bytes.size());
  };
  const std::string good = sealed({head, first, second});
  ASSERT_EQ(parse_tri(good, "x.trib").commands.size(), 1U);
  const std::size_t at = 8 + 8 + head.size();
  const std::string a = block(good, at, first), b = block(good, at + a.size(), second);
  const std::string end = good.substr(at + a.size() + b.size());
  ASSERT_EQ(end.size(), 8U);
  const std::string place = "x.trib: byte " + std::to_string(at) + ": the checksum behind this block's ";
  EXPECT_TRUE(parse_error(good.substr(0, at) + b + end).starts_with(place));
  EXPECT_TRUE(parse_error(good.substr(0, at) + b + a + end).starts_with(place));
  EXPECT_TRUE(names(parse_error(good.substr(0, at) + a + end), "the checksum"));
}

TEST(Trib, WhatIsNotLegalIsRefusedAtItsRecord) {
  const auto refused = [](const std::string& bytes, std::size_t at, const std::string& what) {
    EXPECT_EQ(parse_error(bytes), "x.trib: byte " + std::to_string(at) + ": " + what);
  };
  // Behind a good record of 128 bytes.
  const auto second = [&](const std::string& record, const std::string& what) {
    refused(stream(plain + record), records_begin + 128, what);
  };
  const auto with = [](std::size_t index, double value) {
    return tag('T') + bytes_of(0xffffffffU) + std::string(corners).replace(8 * index, 8, bytes_of(value));
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = HUGE_VAL;
  second(with(0, nan), "v[0][0]: x = nan is out of range; expected -32767..32767 pixels");
  second(with(6, -inf), "v[1][1]: y = -inf is out of range; expected -32767..32767 pixels");
  second(with(12, nan), "v[2][2]: s = nan is out of range; expected s_min..s_max, 1..1000");
  second(with(2, 0.5), "v[0][2]: s = 0.5 is out of range; expected s_min..s_max, 1..1000");
  second(with(3, nan), "v[0]: u, v are not finite; expected finite numbers");
  second(with(14, inf), "v[2]: u, v are not finite; expected finite numbers");
  second(with(11, 2), "v: the triangle has no area; expected three positions that are not on one line");
  second(tag('T') + bytes_of(0U) + corners, "tex: the header names no textures; expected no \"tex\"");
  second(tag('T', 1) + bytes_of(0xffffffffU) + corners + std::string(colors).replace(8, 8, bytes_of(nan)),
         "c: component nan is out of range; expected 0..255");
  second(tag('T', 2) + bytes_of(0xffffffffU) + corners + bytes_of({0, 1.5, 0}),
         "fog[1]: 1.5 is out of range; expected 0..1");
  second(tag('T', 2) + bytes_of(0xffffffffU) + corners + bytes_of({0, 0, nan}),
         "fog[2]: nan is out of range; expected 0..1");
  second(tag('T', 4) + std::string(300, '\0'),
         "a record of the tag 54 04 00 00; expected one of those that the header lists");
  second(std::string("T\0\0\1", 4) + std::string(300, '\0'),
         "a record of the tag 54 00 00 01; expected one of those that the header lists");
  second(plain.substr(0, 127), "the block ends 127 bytes behind this; expected the whole record");
  second(plain.substr(0, 100), "the block ends 100 bytes behind this; expected the whole record");
  second("T", "the block ends 1 bytes behind this; expected a record, whose tag has 4 bytes");
  second(command("{}"),
         "{} is no command; expected state, clear, target, view, copy, resolve, frame or a line, l");
  second(command(R"({"target": 9})"), "target: 9 is not legal; expected a whole number 0..7");
  second(command(R"({"target": 1)"),
         "the line ends inside its JSON (truncated?); expected one whole JSON object a line");
  second(command(R"({"frame": 0})"),
         "frame: the header has no dynamic texture; expected one with \"frames\"");
  refused(stream(command("{", '+') + plain), records_begin + 128,
          "a triangle inside a command; expected the rest of the command");
  refused(stream(command("{", '+')), records_begin + 128 + 8,
          "the stream ends inside a command; expected the rest of it");
  // Textures.
  std::string textured = header;
  textured.insert(textured.size() - 1,
                  R"(, "textures": [{"procedural": {"kind": "checker", "width": 4, "height": 4, "colors": )"
                  R"([[0, 0, 0, 255], [9, 9, 9, 255]], "cell_width": 1, "cell_height": 1}}])");
  const auto texture = [&](std::uint32_t index) {
    return stream(tag('T') + bytes_of(index) + corners, textured);
  };
  EXPECT_EQ(parse_tri(texture(0), "x.trib").triangles[0].texture, 0);
  EXPECT_EQ(parse_tri(texture(0xffffffffU), "x.trib").triangles[0].texture, -1);
  const std::size_t first = records_begin - header.size() + textured.size();
  refused(texture(1), first, "tex: 1 is not legal; expected a whole number 0..0");
  refused(texture(0xfffffffeU), first, "tex: -2 is not legal; expected a whole number 0..0");
  // The header.
  const auto with_kinds = [](const std::string& kinds, const std::string& json = header) {
    return sealed({kinds + json, plain});
  };
  refused(with_kinds(bytes_of(1U) + kind(tag('T'), 136)), 20,
          "records of the tag 54 00 00 00 have 136 bytes; expected 128");
  refused(
      with_kinds(bytes_of(2U) + plain_kind + kind(tag('Q'), 16)), 28,
      "records of the tag 51 00 00 00 are not known; expected 43 00 00 00, 43 2b 00 00, or 54 00 00 00 to 54 "
      "ff 3f 00");
  refused(with_kinds(bytes_of(3U) + plain_kind + command_kind + plain_kind), 36,
          "records of the tag 54 00 00 00 are listed twice; expected once");
  refused(with_kinds(bytes_of(1U) + command_kind), 8 + 8 + 12 + header.size() + 8,
          "a record of the tag 54 00 00 00; expected one of those that the header lists");
  refused(sealed({bytes_of(0xffffffffU)}), 20,
          "the block ends 0 bytes behind this; expected a kind of records: its tag and its size");
  refused(with_kinds(all_kinds, "{}"), 68,
          "bitspan: no header; expected a first line {\"bitspan\": 1, \"width\": ..., ...}");
  refused(sealed({}), 16, "the stream ends in front of its header; expected a block that holds it");
  std::string version = header;
  version[12] = '1';
  refused(stream(tag('T', 2) + bytes_of(0xffffffffU) + corners + bytes_of({0, 0, 0}), version), records_begin,
          "bitspan: a triangle of version 1 gives only colours; expected a header {\"bitspan\": 2, ...}");
  refused(stream(command(R"({"target":1})"), version), records_begin,
          "bitspan: a stream of version 1 has no commands; expected a header {\"bitspan\": 2, ...}");
  // Sizes.
  std::string full;
  for (int n = 0; n < 8192; ++n) full += plain;
  EXPECT_EQ(parse_tri(stream(full), "x.trib").triangles.size(), 8192U);
  refused(stream(full + plain), records_begin - 8, "the block has 1048704 bytes; expected at most 1048576");
  std::string records;
  for (int n = 0; n < 8200; ++n) records += command(std::string(124, ' '), '+');
  const auto begin = [&](std::size_t n) { return records.substr(128 * n, std::size_t{128} * 4100); };
  EXPECT_TRUE(names(parse_error(sealed({all_kinds + header, begin(0), begin(4100), begin(0), begin(0)})),
                    "the command is too long; expected at most 1048576 bytes"));
}

TEST(Trib, OtherVersionsAndForeignFilesAreRefused) {
  std::string next = stream(plain);
  next[5] = '2';
  EXPECT_EQ(parse_error(next), "x.trib: byte 5: the binary stream is of version 2; expected version 1");
  const std::string expected = "; expected the first bytes of a .trib, 89 54 52 49 42 31 0d 0a";
  EXPECT_EQ(parse_error("\x89PNG\r\n\x1a\n"), "x.trib: byte 1: is no binary stream" + expected);
  EXPECT_EQ(parse_error("\xff\xd8\xff\xe0 JFIF"), "x.trib: byte 0: is no binary stream" + expected);
  // Line ends that a transfer changed.
  EXPECT_EQ(parse_error("\x89TRIB1\n"), "x.trib: byte 6: is no binary stream" + expected);
}

TEST(Trib, TheContentsDecideAndNotTheName) {
  const TemporaryFolder folder;
  const std::string text = text_of(parse_tri(stream(plain), "x.trib"));
  const std::string binary = stream(plain);
  EXPECT_EQ(read_tri(folder.write("a.trib", text)).triangles.size(), 1U);
  EXPECT_EQ(read_tri(folder.write("b.tri", binary)).triangles.size(), 1U);
  EXPECT_EQ(read_tri(folder.write("c", binary)).triangles.size(), 1U);
  EXPECT_TRUE(is_stream(folder.path("c")));
  EXPECT_FALSE(is_stream(folder.write("d", text)));
  EXPECT_FALSE(is_stream(folder.write("e.obj", "v 0 0 0\n")));
  EXPECT_FALSE(is_stream(folder.write("f", "\x89TRI")));
  EXPECT_FALSE(is_stream(folder.path()));
  for (const char* const name : {"-", "none.tri", "none.trib"}) EXPECT_TRUE(is_stream(name));
  EXPECT_TRUE(input_error([&] { parse_tri("nonsense", "x.tri"); }).starts_with("x.tri:1: not JSON"));
}

TEST(Trib, MoreThanABlock) {
  Scene scene = parse_tri(stream(plain), "x.trib");
  scene.triangles.resize(3000, scene.triangles[0]);
  for (std::size_t i = 0; i < 3000; ++i) scene.triangles[i].v[0].u = static_cast<double>(i);
  const std::string bytes = binary_of(scene);
  EXPECT_GT(bytes.size(), 3000U * 128);
  EXPECT_EQ(text_of(parse_tri(bytes, "x.trib")), text_of(scene));
}

}  // namespace
}  // namespace bitspan
