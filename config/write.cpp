// The canonical text of a configuration, and the hash over it.
#include <charconv>
#include <cstdio>

#include "config/modes.hpp"
#include "config/names.hpp"

namespace bitspan {
namespace {

// The shortest decimal that reads back as the same double.
std::string number(double value) {
  if (value == 0) return "0";
  std::array<char, 40> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string quoted(std::string_view text) { return std::string("\"").append(text).append("\""); }

std::string format_text(const Format& f) {
  return std::string("{ signed = ") + (f.is_signed ? "true" : "false") +
         ", word = " + std::to_string(f.word) + ", int = " + std::to_string(f.integer) +
         ", round = " + quoted(to_string(f.rounding)) + ", overflow = " + quoted(to_string(f.overflow)) +
         (f.overflow_expected ? ", overflow_expected = true }" : " }");
}

class Writer {
 public:
  void table(std::string_view name) {
    if (!text_.empty()) text_ += '\n';
    text_.append("[").append(name).append("]\n");
  }
  void raw(std::string_view key, std::string_view value) {
    text_.append(key).append(" = ").append(value).append("\n");
  }
  void key(std::string_view name, int value) { raw(name, std::to_string(value)); }
  void key(std::string_view name, bool value) { raw(name, value ? "true" : "false"); }
  template <class E>
  requires std::is_enum_v<E>
  void key(std::string_view name, E value) { raw(name, quoted(to_string(value))); }
  void key(std::string_view name, const StartOffset& value) {
    raw(name, value.half_ulp ? quoted("half_ulp") : number(value.value));
  }
  void key(std::string_view name, const Format& value) { raw(name, format_text(value)); }
  void key(std::string_view name, const Reciprocal& r) {
    table(name);
    key("kind", r.kind);
    key("normalize", r.normalize);
    key("operand_bits", r.operand_bits);
    key("index_bits", r.index_bits);
    key("table_bits", r.table_bits);
    key("internal_bits", r.internal_bits);
    key("steps", r.steps);
    key("bits_per_cycle", r.bits_per_cycle);
    key("pipelined", r.pipelined);
    key("output", r.output);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

// Unused keys of a reciprocal's kind do not determine results.
Reciprocal used_part(Reciprocal r) {
  if (!has_table(r.kind)) {
    r.operand_bits = r.index_bits = r.table_bits = r.internal_bits = 0;
  } else {
    r.bits_per_cycle = 0;
  }
  if (!has_newton_steps(r.kind)) r.steps = 0;
  return r;
}

}  // namespace

std::string to_toml(const Config& c) {
  Writer w;
  w.table("raster");
  w.key("subpixel_bits", c.subpixel_bits);
  w.key("coordinate_bits", c.coordinate_bits);
  w.key("fill_rule", c.fill_rule);
  w.key("edge_walk", c.edge_walk);
  w.key("dda_update", c.dda_update);

  w.table("perspective");
  w.key("mode", c.perspective);
  w.key("numerator", c.numerator);

  w.table("slope");
  w.key("edge", c.edge_slope);
  w.key("row", c.row_slope);

  w.key("reciprocal.edge", c.edge_reciprocal);
  w.key("reciprocal.row", c.row_reciprocal);
  w.key("reciprocal.pixel", c.pixel_reciprocal);

  w.table("start_offset");
  w.key("edge_x", c.start_offset.edge_x);
  w.key("edge_h", c.start_offset.edge_h);
  w.key("edge_f", c.start_offset.edge_f);
  w.key("edge_shade", c.start_offset.edge_shade);
  w.key("span_h", c.start_offset.span_h);
  w.key("span_f", c.start_offset.span_f);
  w.key("span_shade", c.start_offset.span_shade);

  w.table("depth");
  w.key("bits", c.depth_bits);
  w.key("code", c.depth_code);
  w.key("round", c.depth_rounding);
  w.key("overflow", c.depth_overflow);

  w.table("texture");
  w.key("filter", c.filter);
  w.key("wrap", c.wrap);
  if (c.transparent) {
    std::string list;
    for (const int code : *c.transparent) list.append(list.empty() ? "[" : ", ").append(std::to_string(code));
    w.raw("transparent", list.append("]"));
  } else {
    w.raw("transparent", quoted("none"));
  }

  w.table("fog");
  w.key("mode", c.fog);
  w.key("depth_bits", c.fog_depth_bits);
  w.key("zone_bits", c.fog_zone_bits);

  w.table("formats");
  for (int i = 0; i < format_count; ++i) {
    const auto id = static_cast<FormatId>(i);
    w.key(quoted(key_of(id)), c.format(id));
  }

  for (int i = 0; i < stage_count; ++i) {
    const StageTiming& t = c.timing[static_cast<std::size_t>(i)];
    w.table("timing." + std::string(to_string(static_cast<Stage>(i))));
    w.key("latency", t.latency);
    w.key("interval", t.interval);
    w.key("fifo", t.fifo);
  }

  w.table("memory");
  w.key("latency", c.memory.latency);
  w.key("width_bytes", c.memory.width_bytes);
  w.key("cache_line_bytes", c.memory.cache_line_bytes);
  w.key("cache_sets", c.memory.cache_sets);
  w.key("cache_ways", c.memory.cache_ways);
  return w.take();
}

std::string config_hash(const Config& config) {
  Config used = config;
  used.edge_reciprocal = used_part(config.edge_reciprocal);
  used.row_reciprocal = used_part(config.row_reciprocal);
  used.pixel_reciprocal = used_part(config.pixel_reciprocal);
  if (!has_fog_table(config.fog)) {
    used.fog_depth_bits = Config().fog_depth_bits;
    used.fog_zone_bits = Config().fog_zone_bits;
  }
  // FNV-1a, 64 bits: the same on every machine.
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char ch : to_toml(used)) {
    hash ^= static_cast<unsigned char>(ch);
    hash *= 0x100000001b3U;
  }
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

}  // namespace bitspan
