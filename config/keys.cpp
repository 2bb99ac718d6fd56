#include "config/keys.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"

namespace bitspan {
namespace {

Place place_of(int& v) { return &v; }
Place place_of(bool& v) { return &v; }
Place place_of(StartOffset& v) { return &v; }
Place place_of(Color& v) { return &v; }
Place place_of(Format& v) { return &v; }
template <class E>
requires std::is_enum_v<E> Place place_of(E& v) {
  static_assert(std::is_same_v<std::underlying_type_t<E>, std::uint8_t> && !enum_names<E>.empty());
  return Choice{reinterpret_cast<std::uint8_t*>(&v), enum_names<E>};  // a byte may name any object
}

constexpr std::array<std::string_view, 3> unit_names{"edge", "row", "pixel"};
Reciprocal& unit_of(Config& c, std::size_t i) {
  return i == 0 ? c.edge_reciprocal : i == 1 ? c.row_reciprocal : c.pixel_reciprocal;
}
const Reciprocal& unit_of(const Config& c, std::size_t i) {
  return i == 0 ? c.edge_reciprocal : i == 1 ? c.row_reciprocal : c.pixel_reciprocal;
}

bool is_lut(const Config& c, std::size_t i) { return has_table(unit_of(c, i).kind); }
bool is_restoring(const Config& c, std::size_t i) { return !is_lut(c, i); }
bool is_newton(const Config& c, std::size_t i) { return has_newton_steps(unit_of(c, i).kind); }
std::string for_kind(const Config& c, std::size_t i) {
  return " for " + std::string(to_string(unit_of(c, i).kind));
}
bool in_rtl_unit(std::size_t i) { return i != 0; }

bool reads_fog_table(const Config& c, std::size_t /*i*/) { return has_fog_table(c.fog); }
std::string beside_depth_bits(const Config& c, std::size_t /*i*/) {
  return " beside " + std::to_string(c.fog_depth_bits) + " depth_bits, so that the index has at most " +
         std::to_string(max_fog_index_bits);
}
std::string of_depth_bits(const Config& /*c*/, std::size_t /*i*/) { return ", and at most depth.bits"; }

// The clocks of these two follow from the reciprocal units.
bool has_own_clocks(const Config& /*c*/, std::size_t i) {
  return static_cast<Stage>(i) != Stage::span_setup && static_cast<Stage>(i) != Stage::span;
}

// The registers of the RTL, and those that its pixel index or the units' operands hang on.
bool in_rtl_format(std::size_t i) {
  using F = FormatId;
  constexpr std::array registers{F::setup_b, F::edge_x,       F::edge_x_acc,  F::edge_h,      F::edge_uv,
                                 F::plane_k, F::span_h_step,  F::span_h,      F::span_f_diff, F::span_f_step,
                                 F::span_f,  F::span_uv_step, F::span_uv_acc, F::span_uv};
  return std::ranges::find(registers, static_cast<F>(i)) != registers.end();
}

constexpr unsigned ideal = affects::ideal, values = affects::values, clocks = affects::clocks,
                   rtl = affects::rtl;

constexpr KeyUse of_lut{Presence::where_used, "restoring", is_lut, Unused::zero, for_kind, in_rtl_unit};
constexpr KeyUse of_newton{Presence::where_used, "the kinds without steps", is_newton, Unused::zero, for_kind,
                           in_rtl_unit};
constexpr KeyUse of_restoring{Presence::where_used, "the table kinds", is_restoring,
                              Unused::zero,         for_kind,          in_rtl_unit};
constexpr KeyUse of_own_clocks{
    .presence = Presence::where_used, .unused_for = "span_setup and span", .used = has_own_clocks};

#define MEMBER(m) #m, [](Config & c, [[maybe_unused]] std::size_t i) { return place_of(c.m); }
#define IN_UNIT(m) "UNIT_reciprocal." #m, [](Config& c, std::size_t i) { return place_of(unit_of(c, i).m); }

constexpr KeyRow rows[] = {
    {"raster.subpixel_bits",
     MEMBER(subpixel_bits),
     {0, 12},
     "",
     ideal | values,
     "vertices snap to 2^-this pixel"},
    {"raster.coordinate_bits",
     MEMBER(coordinate_bits),
     {2, 24},
     "",
     ideal | values | rtl,
     "integer bits of a snapped coordinate, sign included: 16 holds -32768..32767 pixels"},
    {"raster.fill_rule",
     MEMBER(fill_rule),
     {},
     "",
     ideal | values,
     "a shared edge is drawn once; or both ends of every line are drawn"},
    {"raster.edge_walk",
     MEMBER(edge_walk),
     {},
     "",
     values | rtl,
     "an integer error term; or a slope register of the format `edge.x_step`"},
    {"raster.dda_update",
     MEMBER(dda_update),
     {},
     "",
     values,
     "dda: the slope is added once per row; or multiplied by the rows from the start"},

    {"perspective.mode",
     MEMBER(perspective),
     {},
     "",
     values | clocks | rtl,
     "T1: one reciprocal per pixel; N1, N2: one per row of constant depth; N3: two divides per pixel; none"},
    {"perspective.numerator",
     MEMBER(numerator),
     {},
     "",
     values,
     "const_depth_rows: where u q and v q are taken"},

    {"slope.edge",
     MEMBER(edge_slope),
     {},
     "",
     values,
     "an edge's slopes: exact quotients, or products with one rounded reciprocal"},
    {"slope.row",
     MEMBER(row_slope),
     {},
     "",
     values | clocks | rtl,
     "the same for a row; const_depth_rows has no row slopes"},

    {"reciprocal.UNIT.kind",
     IN_UNIT(kind),
     {},
     "",
     values | clocks | rtl,
     "UNIT is edge (of an edge's height), row (of a span's length; of h + B in const_depth_rows) or pixel "
     "(of "
     "h + B); reciprocals.md describes the kinds",
     {.in_rtl = in_rtl_unit}},
    {"reciprocal.UNIT.normalize",
     IN_UNIT(normalize),
     {},
     "",
     values | clocks | rtl,
     "mantissa and exponent; or one fixed-point number",
     {.in_rtl = in_rtl_unit}},
    {"reciprocal.UNIT.operand_bits",
     IN_UNIT(operand_bits),
     {2, 60},
     "",
     values | rtl,
     "fraction bits kept of the normalised operand",
     of_lut},
    {"reciprocal.UNIT.index_bits",
     IN_UNIT(index_bits),
     {1, 12},
     ", under operand_bits",
     values | rtl,
     "the table has 2^this intervals",
     of_lut},
    {"reciprocal.UNIT.table_bits",
     IN_UNIT(table_bits),
     {2, 40},
     "",
     values | rtl,
     "fraction bits of a table entry",
     of_lut},
    {"reciprocal.UNIT.internal_bits",
     IN_UNIT(internal_bits),
     {2, 60},
     "",
     values | rtl,
     "fraction bits after each step",
     of_lut},
    {"reciprocal.UNIT.steps", IN_UNIT(steps), {0, 4}, "", values | clocks | rtl, "Newton steps", of_newton},
    {"reciprocal.UNIT.bits_per_cycle",
     IN_UNIT(bits_per_cycle),
     {1, 8},
     "",
     clocks | rtl,
     "quotient bits made per clock",
     of_restoring},
    {"reciprocal.UNIT.pipelined",
     IN_UNIT(pipelined),
     {},
     "; pixel: true",
     clocks | rtl,
     "one operand per clock; or one at a time",
     {.in_rtl = in_rtl_unit}},
    {"reciprocal.UNIT.output",
     IN_UNIT(output),
     {},
     ", unsigned, with a fraction; normalised: able to hold 1, or int = 0 and saturating",
     values | clocks | rtl,
     "of the mantissa; not normalised: of the reciprocal",
     {.in_rtl = in_rtl_unit}},

    {"start_offset.edge_x",
     MEMBER(start_offset.edge_x),
     {},
     "",
     values,
     "added to the start of edge.x_acc (dda); half an ulp of edge.x"},
    {"start_offset.edge_h",
     MEMBER(start_offset.edge_h),
     {},
     "",
     values,
     "added to the start of edge.h_acc; half an ulp of edge.h"},
    {"start_offset.edge_f",
     MEMBER(start_offset.edge_f),
     {},
     "",
     values,
     "added to the start of edge.f; half an ulp of it"},
    {"start_offset.edge_shade",
     MEMBER(start_offset.edge_shade),
     {},
     "",
     values,
     "added to the start of edge.shade_acc; half an ulp of edge.shade"},
    {"start_offset.span_h",
     MEMBER(start_offset.span_h),
     {},
     "",
     values | rtl,
     "added to the start of span.h; half a depth code"},
    {"start_offset.span_f",
     MEMBER(start_offset.span_f),
     {},
     "",
     values | rtl,
     "added to the start of span.f (delta_f, hyperbolic; half an ulp of it) or of span.uv_acc (affine, "
     "const_depth_rows; half an ulp of span.uv)"},
    {"start_offset.span_shade",
     MEMBER(start_offset.span_shade),
     {},
     "",
     values,
     "added to the start of span.shade_acc; half an ulp of span.shade"},

    {"depth.bits",
     MEMBER(depth_bits),
     {8, 32},
     "",
     ideal | values | clocks,
     "the depth buffer's bits; hmax = 2^bits - 1"},
    {"depth.code", MEMBER(depth_code), {}, "", ideal | values, "D1; the two codes of H6"},
    {"depth.func",
     MEMBER(depth_func),
     {},
     "",
     ideal | values,
     "which fragments pass, by distance: `less` those nearer than what is stored",
     {.presence = Presence::later}},
    {"depth.round", MEMBER(depth_rounding), {}, "", values, "of the stored code"},
    {"depth.overflow", MEMBER(depth_overflow), {}, " but SC_WRAP_SM", values, "of the stored code"},

    {"texture.filter", MEMBER(filter), {}, "", ideal | values | clocks, "one texel; T3, four"},
    {"texture.wrap", MEMBER(wrap), {}, "", ideal | values | clocks, "T7; the edge texel goes on"},
    {"texture.transparent",
     MEMBER(transparent),
     {},
     "",
     ideal | values,
     "T4: texels of exactly this colour are holes"},

    {"fog.mode",
     MEMBER(fog),
     {},
     "",
     ideal | values,
     "F3: 1 - S/DT; F2: a table by depth and distance from the picture's middle"},
    {"fog.depth_bits",
     MEMBER(fog_depth_bits),
     {1, max_fog_index_bits, false, "", most_fog_depth_bits},
     ", at most depth.bits",
     values,
     "of the table's index: top bits of h",
     {.presence = Presence::optional,
      .used = reads_fog_table,
      .unused = Unused::initial,
      .reason = of_depth_bits}},
    {"fog.zone_bits",
     MEMBER(fog_zone_bits),
     {0, 8, false, "", most_fog_zone_bits},
     ", at most 12 with depth_bits",
     values,
     "and bits of the zone of r^2",
     {.presence = Presence::optional,
      .used = reads_fog_table,
      .unused = Unused::initial,
      .reason = beside_depth_bits}},

    {"formats.FORMAT", MEMBER(formats[i]), {}, "", values | clocks | rtl, "", {.in_rtl = in_rtl_format}},

    {"timing.STAGE.latency",
     MEMBER(timing[i].latency),
     {1, 1000, false, " clocks"},
     "",
     clocks,
     "timed model: clocks from acceptance to delivery; the two follow from the reciprocal units, and a value "
     "given is not used",
     of_own_clocks},
    {"timing.STAGE.interval",
     MEMBER(timing[i].interval),
     {1, 1000, false, " clocks"},
     "",
     clocks,
     "clocks from one acceptance to the next",
     of_own_clocks},
    {"timing.STAGE.fifo",
     MEMBER(timing[i].fifo),
     {1, 65536, false, " records"},
     "",
     clocks,
     "records that fit in front of the stage; not used for span, which takes from the result register of "
     "span_setup, as the RTL does"},

    {"memory.latency",
     MEMBER(memory.latency),
     {1, 10000, false, " clocks"},
     "",
     clocks,
     "clocks from a read request to its first beat"},
    {"memory.width_bytes", MEMBER(memory.width_bytes), {1, 1024, true}, "", clocks, "bytes per clock"},
    {"memory.cache_line_bytes",
     MEMBER(memory.cache_line_bytes),
     {4, 4096, true},
     ", at least width_bytes",
     clocks,
     "the texture cache's line"},
    {"memory.cache_sets", MEMBER(memory.cache_sets), {1, 65536, true}, "", clocks, "its sets"},
    {"memory.cache_ways", MEMBER(memory.cache_ways), {1, 64}, "", clocks, "its lines per set"},
};

#undef MEMBER
#undef IN_UNIT
#define FIELD(m) #m, [](Format & f) { return place_of(f.m); }

constexpr FieldRow fields[] = {
    {"signed", FIELD(is_signed), "true, false", "two's complement, or no sign", values | clocks | rtl},
    {"word", FIELD(word), "1..64 signed, 1..63 unsigned", "all bits", values | clocks | rtl},
    {"int", FIELD(integer), "-32..64, and word - int in -32..64",
     "bits left of the binary point, the sign included; an ulp is 2^(int - word)", values | clocks | rtl},
    {"round", FIELD(rounding), "",
     "nearest, a tie going up, to zero, down, away from zero, to even; down; to zero", values | rtl},
    {"overflow", FIELD(overflow), " (the last signed only)",
     "low bits; clamp; 0; clamp to a symmetric range; sign-magnitude wrap", values | rtl},
    {"overflow_expected", FIELD(overflow_expected), "true, false",
     "the scene may exceed the format on purpose: the range check keeps silent", 0, Presence::later},
};
#undef FIELD

void replace(std::string& text, std::string_view what, std::string_view by) {
  if (const auto at = text.find(what); at != std::string::npos) text.replace(at, what.size(), by);
}

constexpr std::string_view stages = "STAGE", units = "UNIT", formats = "FORMAT";

std::vector<Key> make_entries() {
  std::vector<Key> out;
  for (const KeyRow& row : rows) {
    const auto has = [&row](std::string_view name) { return row.path.find(name) != std::string_view::npos; };
    const std::size_t count = has(stages)    ? static_cast<std::size_t>(stage_count)
                              : has(units)   ? unit_names.size()
                              : has(formats) ? static_cast<std::size_t>(format_count)
                                             : 1;
    for (std::size_t i = 0; i < count; ++i) {
      Key key{std::string(row.path), row.path.rfind('.') + 1, &row, i, nullptr};
      if (has(stages)) replace(key.path, stages, enum_names<Stage>[i]);
      if (has(units)) replace(key.path, units, unit_names[i]);
      if (has(formats)) {
        replace(key.path, formats, key_of(static_cast<FormatId>(i)));
      } else {
        key.name_at = key.path.rfind('.') + 1;
      }
      out.push_back(std::move(key));
    }
  }
  // Tables that have one part per name are written one after the other: [timing.setup], then
  // [timing.edge_walk].
  std::map<std::string, std::size_t, std::less<>> tables;
  for (const Key& key : out) tables.emplace(key.table(), tables.size());
  std::ranges::stable_sort(out, {}, [&](const Key& key) { return tables.find(key.table())->second; });
  return out;
}

std::vector<Key> make_keys() {
  std::vector<Key> out;
  Config config;
  for (const Key& entry : entries()) {
    if (!std::holds_alternative<Format*>(place(config, entry))) {
      out.push_back(entry);
      continue;
    }
    for (const FieldRow& field : fields) {
      out.push_back(
          {entry.path + "." + std::string(field.name), entry.path.size() + 1, entry.row, entry.i, &field});
    }
  }
  return out;
}

constexpr std::string_view legal_offset = "a finite number, \"half_ulp\"";
constexpr std::string_view legal_color = "\"none\", an array of three integers 0..255";

std::string join(std::span<const std::string_view> names) {
  std::string out;
  for (const auto name : names) out.append(out.empty() ? "" : ", ").append(name);
  return out;
}

std::string is_a(const KeyValue& value) {
  constexpr std::array<std::string_view, 4> types{"a boolean", "an integer", "a float", "a string"};
  return "is " + std::string(types[value.index()]) + "; legal: ";
}

using Fault = std::optional<std::string>;

Fault set(int* to, const KeyValue& value) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  if (integer == nullptr) return is_a(value) + "an integer";
  if (*integer < std::numeric_limits<int>::min() || *integer > std::numeric_limits<int>::max()) {
    return std::to_string(*integer) + " is far out of range; legal: an integer of 32 bits";
  }
  *to = static_cast<int>(*integer);
  return std::nullopt;
}

Fault set(bool* to, const KeyValue& value) {
  const auto* truth = std::get_if<bool>(&value);
  if (truth == nullptr) return is_a(value) + "true, false";
  *to = *truth;
  return std::nullopt;
}

Fault set(const Choice& to, const KeyValue& value) {
  const auto* name = std::get_if<std::string>(&value);
  if (name == nullptr) return is_a(value) + "a string, one of " + join(to.names);
  const auto found = std::ranges::find(to.names, *name);
  if (found == to.names.end()) return '"' + *name + "\" is no value of this key; legal: " + join(to.names);
  *to.number = static_cast<std::uint8_t>(found - to.names.begin());
  return std::nullopt;
}

Fault set(StartOffset* to, const KeyValue& value) {
  const std::string legal = "; legal: " + std::string(legal_offset);
  if (const auto* name = std::get_if<std::string>(&value)) {
    if (*name != "half_ulp") return '"' + *name + "\" is no start offset" + legal;
    *to = {true, 0};
    return std::nullopt;
  }
  double number = 0;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    number = static_cast<double>(*integer);
    if (std::abs(number) > 0x1p53) return "an integer beyond 2^53" + legal;
  } else if (const auto* real = std::get_if<double>(&value)) {
    number = *real;
    if (!std::isfinite(number)) return "is not a finite number" + legal;
  } else {
    return is_a(value) + std::string(legal_offset);
  }
  *to = {false, number == 0 ? 0 : number};  // no negative zero
  return std::nullopt;
}

// Of "[255, 0, 255]".
Color color_in(std::string_view text) {
  if (!text.starts_with('[') || !text.ends_with(']')) return std::nullopt;
  text = text.substr(1, text.size() - 2);
  std::array<std::uint8_t, 3> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out[i]);
    if (error != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (i + 1 == out.size()) break;
    if (!text.starts_with(',')) return std::nullopt;
    text.remove_prefix(1);
  }
  return text.empty() ? Color(out) : std::nullopt;
}

Fault set(Color* to, const KeyValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) return is_a(value) + std::string(legal_color);
  const Color color = color_in(*text);
  if (!color && *text != "none") return "is no colour; legal: " + std::string(legal_color);
  *to = color;
  return std::nullopt;
}

Fault set(Format* /*to*/, const KeyValue& /*value*/) { return "is a format; legal: one of its fields"; }

KeyValue get(const int* v) { return std::int64_t{*v}; }
KeyValue get(const bool* v) { return *v; }
KeyValue get(const Choice& v) {
  return *v.number < v.names.size() ? std::string(v.names[*v.number]) : std::string("?");
}
KeyValue get(const StartOffset* v) {
  if (v->half_ulp) return std::string("half_ulp");
  if (v->value == 0) return std::int64_t{0};
  return v->value;
}
KeyValue get(const Color* v) {
  if (!*v) return std::string("none");
  std::string list;
  for (const int code : **v) list.append(list.empty() ? "[" : ", ").append(std::to_string(code));
  return list + "]";
}
KeyValue get(const Format* /*v*/) { return std::string("a format"); }

template <class T>
void copy(const T* from, const Place& to) {
  *std::get<T*>(to) = *from;
}
void copy(const Choice& from, const Place& to) { *std::get<Choice>(to).number = *from.number; }
template <class T>
bool same(const T* a, const Place& b) {
  return *a == *std::get<T*>(b);
}
bool same(const Choice& a, const Place& b) { return *a.number == *std::get<Choice>(b).number; }

}  // namespace

std::span<const KeyRow> key_rows() { return rows; }
std::span<const FieldRow> field_rows() { return fields; }

std::span<const Key> entries() {
  static const std::vector<Key> all = make_entries();
  return all;
}
std::span<const Key> keys() {
  static const std::vector<Key> all = make_keys();
  return all;
}

const Key* find_key(std::string_view path) {
  static const auto by_path = [] {
    std::unordered_map<std::string_view, const Key*> out;
    for (const Key& key : keys()) out.emplace(key.path, &key);
    return out;
  }();
  const auto found = by_path.find(path);
  return found == by_path.end() ? nullptr : found->second;
}

Place place(Config& config, const Key& key) {
  const Place whole = key.row->place(config, key.i);
  return key.field == nullptr ? whole : key.field->place(*std::get<Format*>(whole));
}
Place place(const Config& config, const Key& key) {
  return place(const_cast<Config&>(config), key);  // whoever asks only reads
}

unsigned affected(const Key& key) {
  unsigned out = key.row->affects;
  if (key.row->use.in_rtl != nullptr && !key.row->use.in_rtl(key.i)) out &= ~(affects::clocks | affects::rtl);
  return key.field == nullptr ? out : out & key.field->affects;
}

bool is_used(const Config& config, const Key& key) {
  return key.row->use.used == nullptr || key.row->use.used(config, key.i);
}

bool same_value(const Config& a, const Config& b, const Key& key) {
  return std::visit([&](const auto& at) { return same(at, place(b, key)); }, place(a, key));
}

void copy_value(const Config& from, Config& to, const Key& key) {
  std::visit([&](const auto& at) { copy(at, place(to, key)); }, place(from, key));
}

std::string member_of(const Key& key) {
  std::string out(key.row->member);
  replace(out, "[i]", std::string("[").append(std::to_string(key.i)).append("]"));
  if (key.row->path.find(units) != std::string_view::npos) replace(out, units, unit_names[key.i]);
  return key.field == nullptr ? out : out + "." + std::string(key.field->member);
}

Config used_part(const Config& config) {
  static const Config initial;
  Config out = config;
  for (const Key& key : entries()) {
    if (key.row->use.unused == Unused::value || is_used(config, key)) continue;
    if (key.row->use.unused == Unused::initial) {
      copy_value(initial, out, key);
    } else {
      *std::get<int*>(place(out, key)) = 0;
    }
  }
  return out;
}

std::string to_string(const KeyValue& value) {
  if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&value)) {
    if (std::isnan(*real)) return "nan";
    if (std::isinf(*real)) return *real < 0 ? "-inf" : "inf";
    // The shortest decimal that reads back as the same double.
    std::array<char, 40> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), *real).ptr;
    std::string text(buffer.data(), end);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
  }
  return std::get<std::string>(value);
}

KeyValue value_of(const Config& config, const Key& key) {
  return std::visit([](const auto& at) { return get(at); }, place(config, key));
}

std::optional<std::string> set_value(Config& config, const Key& key, const KeyValue& value) {
  return std::visit([&value](const auto& to) { return set(to, value); }, place(config, key));
}

std::string legal_values(const Key& key) {
  static const Config any;
  const Place at = place(any, key);
  if (std::holds_alternative<bool*>(at)) return "true, false";
  if (const auto* choice = std::get_if<Choice>(&at)) return join(choice->names);
  if (std::holds_alternative<StartOffset*>(at)) return std::string(legal_offset);
  if (std::holds_alternative<Color*>(at)) return std::string(legal_color);
  return "an integer";
}

}  // namespace bitspan
