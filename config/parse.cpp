// The strict reader: every key is known, given once, of its type, and, unless it is said to be optional,
// given.
#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <map>
#include <span>
#include <system_error>
#include <utility>

#include "config/check.hpp"
#include "config/names.hpp"

namespace bitspan {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;

std::string join(std::span<const std::string_view> names) {
  std::string text;
  for (const auto name : names) {
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

// What a file holds may stand in a message, which is one line whatever it is.
std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

std::string_view type_name(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "an array";
  if (node.is_string()) return "a string";
  if (node.is_integer()) return "an integer";
  if (node.is_floating_point()) return "a float";
  if (node.is_boolean()) return "a boolean";
  return "a date or time";
}

int line_of(const toml::source_region& region) {
  return region.begin.line > 0 ? static_cast<int>(region.begin.line) : 1;
}

// Where each key stands, so that a rule between keys can name a line.
using Lines = std::map<std::string, int, std::less<>>;

// One table of the file. The constructor refuses unknown keys; the readers refuse missing and mistyped ones.
class Section {
 public:
  Section(const toml::table& table, std::string path, int line, const std::string& origin, Lines& lines,
          std::span<const std::string_view> legal)
      : table_(table), path_(std::move(path)), line_(line), origin_(origin), lines_(lines) {
    lines_.emplace(path_, line_);
    for (const auto& [key, node] : table_) {
      const int at = line_of(key.source());
      if (std::ranges::find(legal, key.str()) == legal.end()) {
        fail(at, path_of(key.str()),
             std::string(node.is_table() ? "unknown table" : "unknown key") + "; legal: " + join(legal));
      }
      lines_.emplace(path_of(key.str()), at);
    }
  }
  Section(const toml::table& table, std::string path, int line, const std::string& origin, Lines& lines,
          std::initializer_list<std::string_view> legal)
      : Section(table, std::move(path), line, origin, lines, std::span(legal.begin(), legal.size())) {}

  bool has(std::string_view key) const { return table_.contains(key); }

  Section section(std::string_view key, std::span<const std::string_view> legal) const {
    const toml::node& node = need(key, "a table with the keys " + join(legal));
    if (!node.is_table()) wrong_type(key, node, "a table with the keys " + join(legal));
    return Section(*node.as_table(), path_of(key), line(key), origin_, lines_, legal);
  }
  Section section(std::string_view key, std::initializer_list<std::string_view> legal) const {
    return section(key, std::span(legal.begin(), legal.size()));
  }

  int integer(std::string_view key) const {
    const toml::node& node = need(key, "an integer");
    if (!node.is_integer()) wrong_type(key, node, "an integer");
    const std::int64_t value = node.as_integer()->get();
    if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) {
      fail(line(key), path_of(key),
           std::to_string(value) + " is far out of range; legal: an integer of 32 bits");
    }
    return static_cast<int>(value);
  }

  bool boolean(std::string_view key) const {
    const toml::node& node = need(key, "true, false");
    if (!node.is_boolean()) wrong_type(key, node, "true, false");
    return node.as_boolean()->get();
  }

  template <class E>
  E name(std::string_view key) const {
    const toml::node& node = need(key, join(enum_names<E>));
    if (!node.is_string()) wrong_type(key, node, "a string, one of " + join(enum_names<E>));
    const std::string& text = node.as_string()->get();
    const auto found = std::ranges::find(enum_names<E>, text);
    if (found == enum_names<E>.end()) {
      fail(line(key), path_of(key), '"' + text + "\" is no value of this key; legal: " + join(enum_names<E>));
    }
    return static_cast<E>(found - enum_names<E>.begin());
  }

  StartOffset offset(std::string_view key) const {
    constexpr std::string_view kLegal = "a finite number, \"half_ulp\"";
    const toml::node& node = need(key, std::string(kLegal));
    StartOffset result;
    if (node.is_string()) {
      if (node.as_string()->get() != "half_ulp") {
        fail(line(key), path_of(key),
             '"' + node.as_string()->get() + "\" is no start offset; legal: " + std::string(kLegal));
      }
      result.half_ulp = true;
    } else if (node.is_integer()) {
      const std::int64_t value = node.as_integer()->get();
      result.value = static_cast<double>(value);
      if (std::abs(result.value) > 0x1p53) {
        fail(line(key), path_of(key), "an integer beyond 2^53; legal: " + std::string(kLegal));
      }
    } else if (node.is_floating_point()) {
      result.value = node.as_floating_point()->get();
      if (!std::isfinite(result.value)) {
        fail(line(key), path_of(key), "is not a finite number; legal: " + std::string(kLegal));
      }
    } else {
      wrong_type(key, node, kLegal);
    }
    if (result.value == 0) result.value = 0;  // no negative zero
    return result;
  }

  std::optional<std::array<std::uint8_t, 3>> color(std::string_view key) const {
    constexpr std::string_view kLegal = "\"none\", an array of three integers 0..255";
    const toml::node& node = need(key, std::string(kLegal));
    if (node.is_string() && node.as_string()->get() == "none") return std::nullopt;
    const toml::array* array = node.as_array();
    if (array == nullptr && !node.is_string()) wrong_type(key, node, kLegal);
    std::array<std::uint8_t, 3> result{};
    bool good = array != nullptr && array->size() == result.size();
    for (std::size_t i = 0; good && i < result.size(); ++i) {
      const auto* value = array->get(i)->as_integer();
      good = value != nullptr && value->get() >= 0 && value->get() <= 255;
      if (good) result[i] = static_cast<std::uint8_t>(value->get());
    }
    if (!good) fail(line(key), path_of(key), "is no colour; legal: " + std::string(kLegal));
    return result;
  }

  // The node of a key, missing keys refused.
  const toml::node& need(std::string_view key, const std::string& legal) const {
    const toml::node* node = table_.get(key);
    if (node == nullptr) fail(line_, path_of(key), "missing; legal: " + legal);
    return *node;
  }

  [[noreturn]] void fail(int at, const std::string& key, const std::string& text) const {
    throw InputError(origin_ + ":" + std::to_string(at) + ": " + one_line(key + ": " + text));
  }
  [[noreturn]] void wrong_type(std::string_view key, const toml::node& node, std::string_view legal) const {
    fail(line(key), path_of(key), "is " + std::string(type_name(node)) + "; legal: " + std::string(legal));
  }

  std::string path_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  }
  int line(std::string_view key) const {
    const auto found = lines_.find(path_of(key));
    return found == lines_.end() ? line_ : found->second;
  }
  const toml::table& table() const { return table_; }
  const std::string& origin() const { return origin_; }
  Lines& lines() const { return lines_; }

 private:
  const toml::table& table_;
  std::string path_;
  int line_;
  const std::string& origin_;
  Lines& lines_;
};

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
  const bool lut = r.kind != ReciprocalKind::restoring;
  // A key that the kind does not use may be left out, so that files stay short, or be given, so that the
  // kind can be changed by one key.
  const auto integer = [&s](std::string_view key, bool needed, int absent) {
    return needed || s.has(key) ? s.integer(key) : absent;
  };
  r.operand_bits = integer("operand_bits", lut, r.operand_bits);
  r.index_bits = integer("index_bits", lut, r.index_bits);
  r.table_bits = integer("table_bits", lut, r.table_bits);
  r.internal_bits = integer("internal_bits", lut, r.internal_bits);
  r.steps = integer("steps", r.kind == ReciprocalKind::lut_newton, r.steps);
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
    config.format(id) =
        read_format(Section(*value->as_table(), path, at, root.origin(), root.lines(), kFormatFields));
  }
}

Config read_config(const toml::table& table, const std::string& origin, Lines& lines) {
  const Section root(table, "", 1, origin, lines,
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
  c.start_offset.edge_x = offset.offset("edge_x");
  c.start_offset.edge_h = offset.offset("edge_h");
  c.start_offset.edge_f = offset.offset("edge_f");
  c.start_offset.edge_shade = offset.offset("edge_shade");
  c.start_offset.span_h = offset.offset("span_h");
  c.start_offset.span_f = offset.offset("span_f");
  c.start_offset.span_shade = offset.offset("span_shade");

  const Section depth = root.section("depth", {"bits", "code", "round", "overflow"});
  c.depth_bits = depth.integer("bits");
  c.depth_code = depth.name<DepthCode>("code");
  c.depth_rounding = depth.name<Rounding>("round");
  c.depth_overflow = depth.name<Overflow>("overflow");

  const Section texture = root.section("texture", {"filter", "wrap", "transparent"});
  c.filter = texture.name<TextureFilter>("filter");
  c.wrap = texture.name<TextureWrap>("wrap");
  c.transparent = texture.color("transparent");

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

// The line of a key, or of the nearest table around it.
int line_near(const Lines& lines, std::string key) {
  while (true) {
    if (const auto found = lines.find(key); found != lines.end()) return found->second;
    const auto dot = key.rfind('.');
    if (dot == std::string::npos) return 1;
    key.resize(dot);
  }
}

}  // namespace

Config parse_config(std::string_view text, const std::string& origin) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw InputError(origin +
                     ":1: the configuration is empty; legal: a TOML file, such as config/depth16.toml");
  }
  toml::table table;
  try {
    table = toml::parse(text, origin);
  } catch (const toml::parse_error& error) {
    throw InputError(origin + ":" + std::to_string(line_of(error.source())) +
                     ": does not parse as TOML: " + one_line(std::string(error.description())));
  }
  Lines lines;
  Config config = read_config(table, origin, lines);
  config.name = std::filesystem::path(origin).stem().string();
  if (const auto violation = first_violation(config)) {
    throw InputError(origin + ":" + std::to_string(line_near(lines, violation->key)) + ": " + violation->key +
                     ": " + violation->text);
  }
  return config;
}

Config load_config(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path + ": no such configuration file");
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a directory; expected a configuration file in TOML");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read: " + std::strerror(errno == 0 ? EIO : errno));
  std::string text(kMaxFileBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw InputError(path + ": cannot be read: " + std::strerror(errno == 0 ? EIO : errno));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMaxFileBytes) {
    throw InputError(path + ": is larger than 1 MiB; expected a configuration file in TOML");
  }
  return parse_config(text, path);
}

}  // namespace bitspan
