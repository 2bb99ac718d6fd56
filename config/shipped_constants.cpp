// shipped_constants OUTPUT FILE.toml ...: the shipped configurations as constant expressions, a header that
// the specialised forms are compiled from. Run by the build (config/CMakeLists.txt).
#include <fmt/format.h>

#include <cctype>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "config/config.hpp"

namespace bitspan {
namespace {

std::string text(bool x) { return x ? "true" : "false"; }
template <class Enum>
std::string text(const char* type, Enum x) {
  return fmt::format("{}{{{}}}", type, static_cast<int>(x));
}
std::string text(const Format& f) {
  return fmt::format("Format{{{}, {}, {}, {}, {}, {}}}", f.word, f.integer, text(f.is_signed),
                     text("Rounding", f.rounding), text("Overflow", f.overflow), text(f.overflow_expected));
}
std::string text(const Reciprocal& r) {
  return fmt::format("{{{}, {}, {}, {}, {}, {}, {}, {}, {}, {}}}", text("ReciprocalKind", r.kind),
                     text(r.normalize), r.operand_bits, r.index_bits, r.table_bits, r.internal_bits, r.steps,
                     r.bits_per_cycle, text(r.pipelined), text(r.output));
}
std::string text(const StartOffset& o) { return fmt::format("{{{}, {:a}}}", text(o.half_ulp), o.value); }

// A function that returns the configuration without its name.
std::string function(const std::string& name, const Config& c) {
  std::string out = fmt::format("constexpr Config {}() {{\n  Config c;\n", name);
  const auto set = [&out](const char* member, const auto& value) {
    out += fmt::format("  c.{} = {};\n", member, value);
  };
  set("subpixel_bits", c.subpixel_bits);
  set("coordinate_bits", c.coordinate_bits);
  set("fill_rule", text("FillRule", c.fill_rule));
  set("edge_walk", text("EdgeWalk", c.edge_walk));
  set("dda_update", text("DdaUpdate", c.dda_update));
  set("perspective", text("Perspective", c.perspective));
  set("numerator", text("Numerator", c.numerator));
  set("edge_slope", text("SlopeForm", c.edge_slope));
  set("row_slope", text("SlopeForm", c.row_slope));
  set("edge_reciprocal", text(c.edge_reciprocal));
  set("row_reciprocal", text(c.row_reciprocal));
  set("pixel_reciprocal", text(c.pixel_reciprocal));
  const StartOffsets& o = c.start_offset;
  set("start_offset",
      fmt::format("{{{}, {}, {}, {}, {}, {}, {}}}", text(o.edge_x), text(o.edge_h), text(o.edge_f),
                  text(o.edge_shade), text(o.span_h), text(o.span_f), text(o.span_shade)));
  set("depth_bits", c.depth_bits);
  set("depth_code", text("DepthCode", c.depth_code));
  set("depth_rounding", text("Rounding", c.depth_rounding));
  set("depth_overflow", text("Overflow", c.depth_overflow));
  set("filter", text("TextureFilter", c.filter));
  set("wrap", text("TextureWrap", c.wrap));
  if (c.transparent) {
    const auto& t = *c.transparent;
    set("transparent", fmt::format("std::array<std::uint8_t, 3>{{{}, {}, {}}}", t[0], t[1], t[2]));
  }
  set("fog", text("FogMode", c.fog));
  set("fog_depth_bits", c.fog_depth_bits);
  set("fog_zone_bits", c.fog_zone_bits);
  for (std::size_t i = 0; i < c.formats.size(); ++i) {
    out += fmt::format("  c.formats[{}] = {};  // {}\n", i, text(c.formats[i]),
                       key_of(static_cast<FormatId>(i)));
  }
  for (std::size_t i = 0; i < c.timing.size(); ++i) {
    const StageTiming& t = c.timing[i];
    out += fmt::format("  c.timing[{}] = {{{}, {}, {}}};\n", i, t.latency, t.interval, t.fifo);
  }
  const MemoryTiming& m = c.memory;
  set("memory", fmt::format("{{{}, {}, {}, {}, {}}}", m.latency, m.width_bytes, m.cache_line_bytes,
                            m.cache_sets, m.cache_ways));
  return out + "  return c;\n}\n\n";
}

std::string header(const std::vector<std::string>& paths) {
  std::string functions, entries;
  for (const std::string& path : paths) {
    const Config config = load_config(path);
    for (const char ch : config.name) {
      if (std::isalnum(static_cast<unsigned char>(ch)) == 0 && ch != '_') {
        throw InputError(path + ": a shipped configuration's name has letters, digits and underscores only");
      }
    }
    functions += function(config.name, config);
    entries += fmt::format("    Entry{{\"{0}\", \"{1}\", {0}}},\n", config.name, config_hash(config));
  }
  return "// Made by shipped_constants from config/*.toml.\n"
         "#pragma once\n\n"
         "#include <array>\n#include <cstdint>\n#include <string_view>\n\n"
         "#include \"config/config.hpp\"\n\n"
         "namespace bitspan::shipped {\n\n"
         "// The configurations of config/ as constant expressions, their names left empty.\n" +
         functions +
         "struct Entry {\n"
         "  std::string_view name;  // the file's stem\n"
         "  std::string_view hash;  // config_hash\n"
         "  Config (*make)();\n"
         "};\n"
         "inline constexpr std::array all{\n" +
         entries + "};\n\n}  // namespace bitspan::shipped\n";
}

}  // namespace
}  // namespace bitspan

int main(int argc, char** argv) {
  try {
    if (argc < 3) throw bitspan::InputError("usage: shipped_constants OUTPUT FILE.toml ...");
    const std::string text = bitspan::header({argv + 2, argv + argc});
    std::ofstream out(argv[1], std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    if (!out) throw bitspan::InputError(std::string(argv[1]) + ": cannot be written");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "shipped_constants: %s\n", error.what());
    return 2;
  }
  return 0;
}
