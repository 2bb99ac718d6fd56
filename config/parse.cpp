// The strict reader: every key is known, given once, of its type, and, unless it is said to be optional,
// given.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/toml_section.hpp"

namespace bitspan {
namespace {

StartOffset read_offset(const Section& s, std::string_view key) {
  constexpr std::string_view kLegal = "a finite number, \"half_ulp\"";
  const toml::node& node = s.need(key, std::string(kLegal));
  StartOffset result;
  if (node.is_string()) {
    if (node.as_string()->get() != "half_ulp") {
      s.fail(key, '"' + node.as_string()->get() + "\" is no start offset; legal: " + std::string(kLegal));
    }
    result.half_ulp = true;
  } else if (node.is_integer()) {
    const std::int64_t value = node.as_integer()->get();
    result.value = static_cast<double>(value);
    if (std::abs(result.value) > 0x1p53) {
      s.fail(key, "an integer beyond 2^53; legal: " + std::string(kLegal));
    }
  } else if (node.is_floating_point()) {
    result.value = node.as_floating_point()->get();
    if (!std::isfinite(result.value)) {
      s.fail(key, "is not a finite number; legal: " + std::string(kLegal));
    }
  } else {
    s.wrong_type(key, node, kLegal);
  }
  if (result.value == 0) result.value = 0;  // no negative zero
  return result;
}

std::optional<std::array<std::uint8_t, 3>> read_color(const Section& s, std::string_view key) {
  constexpr std::string_view kLegal = "\"none\", an array of three integers 0..255";
  const toml::node& node = s.need(key, std::string(kLegal));
  if (node.is_string() && node.as_string()->get() == "none") return std::nullopt;
  const toml::array* array = node.as_array();
  if (array == nullptr && !node.is_string()) s.wrong_type(key, node, kLegal);
  std::array<std::uint8_t, 3> result{};
  bool good = array != nullptr && array->size() == result.size();
  for (std::size_t i = 0; good && i < result.size(); ++i) {
    const auto* value = array->get(i)->as_integer();
    good = value != nullptr && value->get() >= 0 && value->get() <= 255;
    if (good) result[i] = static_cast<std::uint8_t>(value->get());
  }
  if (!good) s.fail(key, "is no colour; legal: " + std::string(kLegal));
  return result;
}

Format read_format(const Section& s) {
  Format f;
  f.is_signed = s.boolean("signed");
  f.word = s.integer("word");
  f.integer = s.integer("int");
  f.rounding = s.name<Rounding>("round");
  f.overflow = s.name<Overflow>("overflow");
  if (s.has("overflow_expected")) f.overflow_expected = s.boolean("overflow_expected");
  return f;
}

constexpr auto kFormatFields =
    std::to_array<std::string_view>({"signed", "word", "int", "round", "overflow", "overflow_expected"});

Reciprocal read_reciprocal(const Section& s) {
  Reciprocal r;
  r.kind = s.name<ReciprocalKind>("kind");
  r.normalize = s.boolean("normalize");
  r.pipelined = s.boolean("pipelined");
  const bool lut = has_table(r.kind);
  // A key that the kind does not use may be left out, so that files stay short, or be given, so that the
  // kind can be changed by one key.
  const auto integer = [&s](std::string_view key, bool needed, int absent) {
    return needed || s.has(key) ? s.integer(key) : absent;
  };
  r.operand_bits = integer("operand_bits", lut, r.operand_bits);
  r.index_bits = integer("index_bits", lut, r.index_bits);
  r.table_bits = integer("table_bits", lut, r.table_bits);
  r.internal_bits = integer("internal_bits", lut, r.internal_bits);
  r.steps = integer("steps", has_newton_steps(r.kind), r.steps);
  r.bits_per_cycle = integer("bits_per_cycle", !lut, r.bits_per_cycle);
  r.output = read_format(s.section("output", kFormatFields));
  return r;
}

// [formats]: quoted keys ("setup.s" = {...}) or dotted ones (setup.s = {...}), both in one file at will.
void read_formats(const Section& root, Config& config) {
  std::vector<std::string_view> keys;
  std::vector<std::string_view> groups;
  for (int i = 0; i < format_count; ++i) {
    const std::string_view key = key_of(static_cast<FormatId>(i));
    const std::string_view group = key.substr(0, key.find('.'));
    keys.push_back(key);
    if (std::ranges::find(groups, group) == groups.end()) groups.push_back(group);
  }
  const toml::node& node = root.need("formats", "a table with a format for each of " + join(keys));
  if (!node.is_table()) root.wrong_type("formats", node, "a table with a format for each of " + join(keys));
  const int line = root.line("formats");

  // One flat table, in the order of the file's lines for messages, key -> (node, line).
  std::map<std::string, std::pair<const toml::node*, int>, std::less<>> flat;
  const auto add = [&](const std::string& key, const toml::node& value, int at) {
    if (std::ranges::find(keys, key) == keys.end()) {
      root.fail(at, "formats." + key, "unknown key; legal: " + join(keys));
    }
    if (!flat.emplace(key, std::pair(&value, at)).second) {
      root.fail(at, "formats." + key, "is given twice, quoted and dotted; legal: once");
    }
  };
  for (const auto& [key, value] : *node.as_table()) {
    const int at = line_of(key.source());
    const bool group = std::ranges::find(groups, key.str()) != groups.end();
    if (!group || !value.is_table()) {
      add(std::string(key.str()), value, at);
      continue;
    }
    for (const auto& [inner, inner_value] : *value.as_table()) {
      add(std::string(key.str()) + "." + std::string(inner.str()), inner_value, line_of(inner.source()));
    }
  }

  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    const std::string path = "formats." + std::string(key_of(id));
    const auto found = flat.find(key_of(id));
    if (found == flat.end()) {
      root.fail(line, path,
                "missing; legal: a format of " + std::string(text_of(id)) + " [" + std::string(unit_of(id)) +
                    "], with " + join(kFormatFields));
    }
    const auto& [value, at] = found->second;
    if (!value->is_table()) {
      root.fail(
          at, path,
          "is " + std::string(type_name(*value)) + "; legal: a format, a table with " + join(kFormatFields));
    }
    config.format(id) = read_format(Section(*value->as_table(), path, at, root.origin(), kFormatFields));
  }
}

Config read_config(const toml::table& table, const std::string& origin) {
  const Section root(table, "", 1, origin,
                     {"raster", "perspective", "slope", "reciprocal", "start_offset", "depth", "texture",
                      "fog", "formats", "timing", "memory"});
  Config c;

  const Section raster =
      root.section("raster", {"subpixel_bits", "coordinate_bits", "fill_rule", "edge_walk", "dda_update"});
  c.subpixel_bits = raster.integer("subpixel_bits");
  c.coordinate_bits = raster.integer("coordinate_bits");
  c.fill_rule = raster.name<FillRule>("fill_rule");
  c.edge_walk = raster.name<EdgeWalk>("edge_walk");
  c.dda_update = raster.name<DdaUpdate>("dda_update");

  const Section perspective = root.section("perspective", {"mode", "numerator"});
  c.perspective = perspective.name<Perspective>("mode");
  c.numerator = perspective.name<Numerator>("numerator");

  const Section slope = root.section("slope", {"edge", "row"});
  c.edge_slope = slope.name<SlopeForm>("edge");
  c.row_slope = slope.name<SlopeForm>("row");

  const Section reciprocal = root.section("reciprocal", {"edge", "row", "pixel"});
  const auto unit = [&reciprocal](std::string_view key) {
    return read_reciprocal(
        reciprocal.section(key, {"kind", "normalize", "operand_bits", "index_bits", "table_bits",
                                 "internal_bits", "steps", "bits_per_cycle", "pipelined", "output"}));
  };
  c.edge_reciprocal = unit("edge");
  c.row_reciprocal = unit("row");
  c.pixel_reciprocal = unit("pixel");

  const Section offset = root.section(
      "start_offset", {"edge_x", "edge_h", "edge_f", "edge_shade", "span_h", "span_f", "span_shade"});
  c.start_offset.edge_x = read_offset(offset, "edge_x");
  c.start_offset.edge_h = read_offset(offset, "edge_h");
  c.start_offset.edge_f = read_offset(offset, "edge_f");
  c.start_offset.edge_shade = read_offset(offset, "edge_shade");
  c.start_offset.span_h = read_offset(offset, "span_h");
  c.start_offset.span_f = read_offset(offset, "span_f");
  c.start_offset.span_shade = read_offset(offset, "span_shade");

  const Section depth = root.section("depth", {"bits", "code", "round", "overflow"});
  c.depth_bits = depth.integer("bits");
  c.depth_code = depth.name<DepthCode>("code");
  c.depth_rounding = depth.name<Rounding>("round");
  c.depth_overflow = depth.name<Overflow>("overflow");

  const Section texture = root.section("texture", {"filter", "wrap", "transparent"});
  c.filter = texture.name<TextureFilter>("filter");
  c.wrap = texture.name<TextureWrap>("wrap");
  c.transparent = read_color(texture, "transparent");

  const Section fog = root.section("fog", {"mode", "depth_bits", "zone_bits"});
  c.fog = fog.name<FogMode>("mode");
  if (fog.has("depth_bits")) c.fog_depth_bits = fog.integer("depth_bits");
  if (fog.has("zone_bits")) c.fog_zone_bits = fog.integer("zone_bits");

  read_formats(root, c);

  const Section timing = root.section("timing", enum_names<Stage>);
  for (int i = 0; i < stage_count; ++i) {
    const auto stage = static_cast<Stage>(i);
    StageTiming& t = c.timing[static_cast<std::size_t>(i)];
    const Section s = timing.section(to_string(stage), {"latency", "interval", "fifo"});
    // These two follow from the reciprocal units.
    const bool derived = stage == Stage::span_setup || stage == Stage::span;
    if (!derived || s.has("latency")) t.latency = s.integer("latency");
    if (!derived || s.has("interval")) t.interval = s.integer("interval");
    t.fifo = s.integer("fifo");
  }

  const Section memory =
      root.section("memory", {"latency", "width_bytes", "cache_line_bytes", "cache_sets", "cache_ways"});
  c.memory.latency = memory.integer("latency");
  c.memory.width_bytes = memory.integer("width_bytes");
  c.memory.cache_line_bytes = memory.integer("cache_line_bytes");
  c.memory.cache_sets = memory.integer("cache_sets");
  c.memory.cache_ways = memory.integer("cache_ways");
  return c;
}

// The line of a key, or of the nearest table around it, which stands at `line`. A format's name has a dot in
// it and may be one key or two.
int line_near(const toml::table& table, std::string_view key, int line) {
  for (std::string_view head = key;; head = head.substr(0, head.rfind('.'))) {
    if (const auto found = table.find(head); found != table.end()) {
      const int at = line_of(found->first.source());
      const toml::table* inner = found->second.as_table();
      return inner == nullptr || head == key ? at : line_near(*inner, key.substr(head.size() + 1), at);
    }
    if (head.find('.') == std::string_view::npos) return line;
  }
}

}  // namespace

Config parse_config(std::string_view text, const std::string& origin) {
  const toml::table table =
      parse_toml(text, origin, "the configuration is empty; legal: a TOML file, such as config/depth16.toml");
  Config config = read_config(table, origin);
  config.name = std::filesystem::path(origin).stem().string();
  if (const auto violation = first_violation(config)) {
    throw InputError(origin + ":" + std::to_string(line_near(table, violation->key, 1)) + ": " +
                     violation->key + ": " + violation->text);
  }
  return config;
}

Config load_config(const std::string& path) {
  return parse_config(read_toml_file(path, "configuration file"), path);
}

}  // namespace bitspan
