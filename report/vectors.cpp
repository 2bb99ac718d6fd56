// SPDX-License-Identifier: Apache-2.0
#include "report/vectors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "config/lines.hpp"
#include "config/one_line.hpp"
#include "engine/range.hpp"
#include "engine/registry.hpp"
#include "io/atomic_file.hpp"
#include "io/atomic_folder.hpp"
#include "io/json_depth.hpp"
#include "io/npy.hpp"
#include "report/lockstep.hpp"
#include "report/scene_json.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view description = "vectors.json";
// Bits of an index, a count or a flag in a word.
constexpr int integer_bits = 32;

// Where a field stands in the records of a file.
struct Place {
  int field = 0;  // of the record
  int word = 0, fraction = 0;
  bool is_signed = true;
  int column = 0;  // json and npy
  int lsb = 0;     // hex
};

struct Layout {
  int bits = 0;  // of a word in hex
  std::vector<Place> places;
};

// What merge reads of the picture; no stage makes it.
constexpr std::string_view stored_table = "merge.stored";
constexpr auto stored_fields = std::to_array<Field>({{"triangle", FieldKind::integer, FormatId::count},
                                                     {"x", FieldKind::integer, FormatId::count},
                                                     {"y", FieldKind::integer, FormatId::count},
                                                     {"r", FieldKind::format, FormatId::merge_color},
                                                     {"g", FieldKind::format, FormatId::merge_color},
                                                     {"b", FieldKind::format, FormatId::merge_color},
                                                     {"a", FieldKind::integer, FormatId::count}});

bool reads_picture(RecordType stage) {
  return stage == RecordType::merge || stage == RecordType::merge_alpha;
}

// Of a field of a channel: on the grid of the first channel that the configuration has, and as wide as the
// widest of them.
std::optional<Format> widest_format(const Field& field, const Config& config) {
  std::optional<Format> out = format_of(field, config);
  bool is_first = true;
  for (const int channel : ChannelList(config)) {
    const std::optional<Format> own = format_of(field, config, channel);
    if (!own) continue;
    if (std::exchange(is_first, false)) {
      out = own;
      continue;
    }
    const bool is_signed = out->is_signed || own->is_signed;
    const auto needed = [&](const Format& f) { return f.word + (is_signed && !f.is_signed ? 1 : 0); };
    const int word = std::max(needed(*out), needed(*own));
    out->integer += word - out->word;
    out->word = word;
    out->is_signed = is_signed;
  }
  return out;
}

// All fields of a record; the first one is leftmost in a word.
Layout layout_of(std::span<const Field> all, const Config& config) {
  Layout out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::optional<Format> format = widest_format(all[i], config);
    Place place{static_cast<int>(i), integer_bits, 0, true, static_cast<int>(i), 0};
    if (format) {
      place.word = std::max(1, format->word);
      place.fraction = format->fraction();
      place.is_signed = format->is_signed;
    }
    out.bits += place.word;
    out.places.push_back(place);
  }
  int above = out.bits;
  for (Place& place : out.places) {
    above -= place.word;
    place.lsb = above;
  }
  return out;
}

// ---- words of many bits ----

class Word {
 public:
  explicit Word(int bits) : limbs_(static_cast<std::size_t>(bits + 63) / 64 + 1) {}

  void put(std::uint64_t value, int lsb, int width) {
    if (width < 64) value &= (std::uint64_t{1} << width) - 1;
    const auto limb = static_cast<std::size_t>(lsb / 64);
    const int shift = lsb % 64;
    limbs_[limb] |= value << shift;
    if (shift != 0) limbs_[limb + 1] |= value >> (64 - shift);
  }
  std::uint64_t get(int lsb, int width) const {
    const auto limb = static_cast<std::size_t>(lsb / 64);
    const int shift = lsb % 64;
    std::uint64_t value = limbs_[limb] >> shift;
    if (shift != 0) value |= limbs_[limb + 1] << (64 - shift);
    return width < 64 ? value & ((std::uint64_t{1} << width) - 1) : value;
  }

 private:
  std::vector<std::uint64_t> limbs_;
};

int digits_of(int bits) { return (bits + 3) / 4; }

std::string hex_line(std::span<const std::int64_t> record, const Layout& layout) {
  Word word(layout.bits + 3);
  for (const Place& p : layout.places) {
    word.put(static_cast<std::uint64_t>(record[static_cast<std::size_t>(p.field)]), p.lsb, p.word);
  }
  std::string line;
  for (int d = digits_of(layout.bits) - 1; d >= 0; --d) {
    line += "0123456789abcdef"[word.get(4 * d, 4)];
  }
  return line + "\n";
}

// ---- writing ----

// INPUT_SPAN_SETUP, OUTPUT_SPAN.
std::string macro_of(std::string_view role, std::string_view stage, std::string_view name = "") {
  std::string out = fmt::format("{}_{}{}{}", role, stage, name.empty() ? "" : "_", name);
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return c == '.' ? '_' : static_cast<char>(std::toupper(c)); });
  return out;
}

struct Table {
  std::string_view role;  // "input" or "output"
  RecordView view;
};
std::vector<Table> tables_of(const Vectors& vectors) {
  std::vector<Table> out;
  for (const RecordView& view : inputs_of(vectors)) out.push_back({"input", view});
  out.push_back({"output", view_of(vectors.trace, vectors.stage)});
  return out;
}

std::string file_of(const Table& table, VectorFormat format) {
  return fmt::format("{}.{}.{}", table.role, table.view.stage,
                     vector_formats[static_cast<std::size_t>(format)]);
}

Json table_json(const Table& table, const Vectors& vectors, VectorFormat format) {
  const RecordView& view = table.view;
  const Layout layout = layout_of(view.fields, vectors.config);
  Json json;
  json["role"] = table.role;
  json["stage"] = view.stage;
  json["count"] = view.records;
  if (format != VectorFormat::json) json["file"] = file_of(table, format);
  if (format == VectorFormat::hex) json["bits"] = layout.bits;
  json["fields"] = Json::array();
  for (const Place& p : layout.places) {
    const Field& field = view.fields[static_cast<std::size_t>(p.field)];
    Json one{{"name", field.name},
             {"word", p.word},
             {"fraction", p.fraction},
             {"signed", p.is_signed},
             {"unit", unit_of(field, vectors.config)}};
    if (format == VectorFormat::hex) {
      one["msb"] = p.lsb + p.word - 1;
      one["lsb"] = p.lsb;
    } else {
      one["column"] = p.column;
    }
    json["fields"].push_back(std::move(one));
  }
  return json;
}

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

// What the files are, one table and one record of JSON per line.
std::string vectors_json(const Vectors& vectors, VectorFormat format, const std::string& version) {
  const Config& config = vectors.config;
  Json head;
  head["bitspan_vectors"] = 1;
  head["bitspan"] = version;
  head["format"] = vector_formats[static_cast<std::size_t>(format)];
  head["stage"] = stage_of(vectors.stage);
  head["configuration"] = {{"name", config.name}, {"hash", config_hash(config)}, {"toml", to_toml(config)}};
  head["scene_name"] = vectors.scene.name;
  head["scene"] = scene_json(vectors.scene);
  std::string out = "{";
  for (const auto& [key, value] : head.items()) out += fmt::format("\"{}\": {},\n ", key, dumped(value));
  out += "\"tables\": [";
  std::string_view between = "\n";
  for (const Table& table : tables_of(vectors)) {
    out.append(between).append(dumped(table_json(table, vectors, format)));
    between = ",\n";
    if (format != VectorFormat::json) continue;
    const RecordView& view = table.view;
    out.back() = ',';  // of the table's brace
    out += "\"records\": [\n";
    for (std::size_t i = 0; i < view.records; ++i) {
      out += fmt::format("[{}]{}\n", fmt::join(view.record(i), ","), i + 1 == view.records ? "" : ",");
    }
    out += "]}";
  }
  return out + "]}\n";
}

// Macros for `include: how many records, how wide their words are, and where each field stands.
std::string verilog_header(const Vectors& vectors) {
  std::string out =
      fmt::format("// {}, configuration {} ({}): the words of the .hex files, by bitspan vectors.\n",
                  stage_of(vectors.stage), vectors.config.name, config_hash(vectors.config));
  for (const Table& table : tables_of(vectors)) {
    const RecordView& view = table.view;
    const Layout layout = layout_of(view.fields, vectors.config);
    const auto define = [&](std::string_view name, const std::string& value) {
      out += fmt::format("`define {} {}\n", macro_of(table.role, view.stage, name), value);
    };
    define("RECORDS", fmt::format("{}", view.records));
    define("BITS", fmt::format("{}", layout.bits));
    for (const Place& p : layout.places) {
      define(view.fields[static_cast<std::size_t>(p.field)].name,
             fmt::format("{}:{}", p.lsb + p.word - 1, p.lsb));
    }
  }
  return out;
}

// ---- reading ----

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code ignored;
  if (!in.is_open() || fs::is_directory(path, ignored)) {
    throw InputError(path + ": cannot read; expected what bitspan vectors wrote");
  }
  return {std::istreambuf_iterator<char>(in), {}};
}

// The records of a file; what is not answered has no value.
struct Answers {
  Layout layout;  // of the fields that the file has
  std::size_t records = 0;
  std::vector<std::int64_t> values;   // records x places
  std::vector<std::uint8_t> missing;  // the same; empty: none
  std::uint64_t unknown = 0;
  std::string first_unknown;

  void mark_missing(std::size_t value) {
    missing.resize(values.size());
    missing[value] = 1;
  }
};

int integer_of(const Json& json, const char* key, int low, int high) {
  const auto value = json.at(key).get<std::int64_t>();
  if (value < low || value > high) {
    throw InputError(fmt::format("{}: {}; expected {} to {}", key, value, low, high));
  }
  return static_cast<int>(value);
}

// The fields of a table as the file has them. They must be the record's under the configuration.
Layout parse_layout(const Json& table, std::span<const Field> fields, std::string_view stage,
                    const Config& config, VectorFormat format) {
  constexpr int limit = 1 << 16;
  const Layout whole = layout_of(fields, config);
  Layout out;
  if (format == VectorFormat::hex) out.bits = integer_of(table, "bits", 1, limit);
  std::vector<bool> seen(whole.places.size());
  for (const Json& json : table.at("fields")) {
    const auto name = json.at("name").get<std::string>();
    const auto at = std::ranges::find(fields, name, &Field::name);
    if (at == fields.end()) throw InputError(fmt::format("fields: {} has no field '{}'", stage, name));
    const auto index = static_cast<std::size_t>(at - fields.begin());
    if (seen[index]) throw InputError(fmt::format("fields: '{}' is there twice", name));
    seen[index] = true;
    Place place = whole.places[index];
    if (json.at("word").get<int>() != place.word || json.at("fraction").get<int>() != place.fraction ||
        json.at("signed").get<bool>() != place.is_signed) {
      throw InputError(
          fmt::format("fields: {}: the format is not that of the configuration; expected a word of {} "
                      "bits, {} of them fraction, {}",
                      name, place.word, place.fraction, place.is_signed ? "signed" : "unsigned"));
    }
    if (format == VectorFormat::hex) {
      place.lsb = integer_of(json, "lsb", 0, out.bits - 1);
      if (integer_of(json, "msb", 0, out.bits - 1) != place.lsb + place.word - 1) {
        throw InputError(fmt::format("fields: {}: msb and lsb are not {} bits", name, place.word));
      }
    } else {
      place.column = integer_of(json, "column", 0, limit);
    }
    out.places.push_back(place);
  }
  return out;
}

// Leaves only these fields.
void keep_fields(Layout& layout, RecordType type, const std::vector<std::string>& names) {
  if (names.empty()) return;
  std::vector<Place> kept;
  for (const std::string& name : names) {
    const int at = field_index(type, name);
    const auto place = std::ranges::find(layout.places, at, &Place::field);
    if (at < 0 || place == layout.places.end()) {
      std::string legal;
      for (const Place& p : layout.places) {
        legal.append(legal.empty() ? "" : ", ")
            .append(fields_of(type)[static_cast<std::size_t>(p.field)].name);
      }
      throw InputError(fmt::format("--fields: '{}' is no field of these vectors, or named twice; expected {}",
                                   name, legal));
    }
    kept.push_back(*place);
    layout.places.erase(place);
  }
  layout.places = std::move(kept);
}

void read_json_records(const Json& records, Answers& into) {
  std::size_t columns = 0;
  for (const Place& p : into.layout.places)
    columns = std::max(columns, static_cast<std::size_t>(p.column) + 1);
  into.records = records.size();
  into.values.reserve(records.size() * into.layout.places.size());
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Json& record = records[i];
    if (!record.is_array() || record.size() < columns) {
      throw InputError(fmt::format("records: record {}: expected an array of {} integers", i, columns));
    }
    for (const Place& p : into.layout.places) {
      const Json& value = record[static_cast<std::size_t>(p.column)];
      if (value.is_null()) {
        missing.push_back(into.values.size());
      } else if (!value.is_number_integer() ||
                 (value.is_number_unsigned() &&
                  value.get<std::uint64_t>() >
                      static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))) {
        throw InputError(
            fmt::format("records: record {}, column {}: expected an integer, or null", i, p.column));
      }
      into.values.push_back(value.is_null() ? 0 : value.get<std::int64_t>());
    }
  }
  for (const std::size_t value : missing) into.mark_missing(value);
}

void read_npy_records(const std::string& path, Answers& into) {
  const IntegerTable table = read_npy_table(path);
  into.records = table.rows;
  for (const Place& p : into.layout.places) {
    if (static_cast<std::size_t>(p.column) >= table.columns) {
      throw InputError(fmt::format("{}: {} columns; expected column {}, too", path, table.columns, p.column));
    }
  }
  for (std::size_t i = 0; i < table.rows; ++i) {
    for (const Place& p : into.layout.places) {
      into.values.push_back(table.values[i * table.columns + static_cast<std::size_t>(p.column)]);
    }
  }
}

// One word of a .hex file. Digits x and z set the bits of `unknown`.
void parse_word(std::string_view digits, Word& value, Word& unknown, const std::string& where) {
  int lsb = 4 * static_cast<int>(digits.size());
  for (const char c : digits) {
    lsb -= 4;
    const char lower = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const bool is_decimal = lower >= '0' && lower <= '9';
    const int digit = is_decimal ? lower - '0' : lower - 'a' + 10;
    if (lower == 'x' || lower == 'z') {
      unknown.put(15, lsb, 4);
    } else if (is_decimal || (lower >= 'a' && lower <= 'f')) {
      value.put(static_cast<std::uint64_t>(digit), lsb, 4);
    } else {
      const auto code = static_cast<unsigned char>(c);
      throw InputError(code > 32 && code < 127
                           ? fmt::format("{}: '{}' is no hexadecimal digit", where, c)
                           : fmt::format("{}: byte {:#04x} is no hexadecimal digit", where, code));
    }
  }
}

void read_hex_records(const std::string& path, std::span<const Field> fields, Answers& into) {
  const std::string text = text_of(path);
  const auto digits = static_cast<std::size_t>(digits_of(into.layout.bits));
  std::istringstream lines(text);
  std::string line;
  std::vector<std::size_t> unknown_values;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string where = fmt::format("{}:{}", path, number);
    if (const auto comment = line.find("//"); comment != std::string::npos) line.erase(comment);
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (word[0] == '@') {
        // $writememh tells addresses; only the order that is anyway is one of records.
        if (word.size() > 17 || word.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos ||
            word.size() < 2 || std::stoull(word.substr(1), nullptr, 16) != into.records) {
          throw InputError(
              fmt::format("{}: address {}; expected @{:x}, the next record", where, word, into.records));
        }
        continue;
      }
      std::erase(word, '_');
      if (word.size() != digits) {
        throw InputError(fmt::format("{}: {} digits; expected {}", where, word.size(), digits));
      }
      Word value(4 * static_cast<int>(digits));
      Word unknown(4 * static_cast<int>(digits));
      parse_word(word, value, unknown, where);
      const int padding = 4 * static_cast<int>(digits) - into.layout.bits;
      if (padding > 0 && value.get(into.layout.bits, padding) != 0) {
        throw InputError(fmt::format("{}: the word has more than {} bits", where, into.layout.bits));
      }
      for (const Place& p : into.layout.places) {
        if (unknown.get(p.lsb, p.word) != 0) {
          if (into.unknown++ == 0) {
            into.first_unknown = fmt::format("record {}, field {}", into.records,
                                             fields[static_cast<std::size_t>(p.field)].name);
          }
          unknown_values.push_back(into.values.size());
        }
        auto raw = value.get(p.lsb, p.word);
        if (p.is_signed && p.word < 64 && (raw >> (p.word - 1)) != 0) raw |= ~std::uint64_t{0} << p.word;
        into.values.push_back(static_cast<std::int64_t>(raw));
      }
      ++into.records;
    }
  }
  for (const std::size_t value : unknown_values) into.mark_missing(value);
}

RecordView view_of_stored(const Vectors& vectors) {
  return {RecordType::count, stored_table, stored_fields, vectors.stored.data(),
          vectors.stored.size() / stored_fields.size()};
}

struct ReadTable {
  std::string role, stage;
  Answers answers;
  std::string origin;  // the file that has the records
  bool is_there = true;
};

struct ReadVectors {
  Config config;
  Scene scene;
  RecordType stage = RecordType::count;
  std::vector<ReadTable> inputs;
  ReadTable output;
};

RecordType type_named(const std::string& name) {
  for (const StageRow& row : stage_table) {
    if (row.name == name) return row.type;
  }
  throw InputError(fmt::format("stage: '{}' is none", name));
}

ReadTable read_table(const Json& json, VectorFormat format, const fs::path& folder, const std::string& origin,
                     const VectorCheckOptions& options, const Config& config) {
  ReadTable out;
  json.at("role").get_to(out.role);
  json.at("stage").get_to(out.stage);
  const bool is_output = out.role == "output";
  const std::span<const Field> fields = !is_output && out.stage == stored_table
                                            ? std::span<const Field>(stored_fields)
                                            : fields_of(type_named(out.stage));
  out.answers.layout = parse_layout(json, fields, out.stage, config, format);
  if (is_output) keep_fields(out.answers.layout, type_named(out.stage), options.fields);
  if (format == VectorFormat::json) {
    out.origin = origin;
    read_json_records(json.at("records"), out.answers);
    return out;
  }
  const fs::path name = json.at("file").get<std::string>();
  if (name.has_parent_path())
    throw InputError("file: '" + name.string() + "' is not in the folder of the vectors");
  out.origin = is_output && !options.answers.empty() ? options.answers : (folder / name).string();
  std::error_code ignored;
  if (!is_output && !fs::exists(out.origin, ignored)) {
    out.is_there = false;
  } else if (format == VectorFormat::hex) {
    read_hex_records(out.origin, fields, out.answers);
  } else {
    read_npy_records(out.origin, out.answers);
  }
  return out;
}

ReadVectors read_vectors(const std::string& path, const VectorCheckOptions& options) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(path, ignored);
  const std::string origin = is_folder ? (fs::path(path) / description).string() : path;
  ReadVectors out;
  std::string toml;
  Json json;
  VectorFormat format = VectorFormat::json;
  std::string hash;
  try {
    const std::string text = text_of(origin);
    check_json_depth(text);
    json = Json::parse(text);
    if (json.at("bitspan_vectors").get<int>() != 1) throw InputError("bitspan_vectors: expected 1");
    format = vector_format(json.at("format").get<std::string>());
    if (format == VectorFormat::json && !options.answers.empty()) {
      throw InputError("--answers: the records of this file are in itself; expected vectors of hex or npy");
    }
    out.stage = type_named(json.at("stage").get<std::string>());
    out.scene = scene_of(json.at("scene"));
    out.scene.name = json.at("scene_name").get<std::string>();
    json.at("configuration").at("toml").get_to(toml);
    json.at("configuration").at("name").get_to(out.config.name);
    json.at("configuration").at("hash").get_to(hash);
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: no vectors: {}", origin, fault_of(error)));
  } catch (const InputError& error) {
    const std::string what = one_line(error.what());
    throw InputError(what.starts_with(origin) ? what : fmt::format("{}: {}", origin, what));
  }
  const std::string name = out.config.name;
  out.config = parse_config(toml, origin + ": configuration");
  out.config.name = name;
  if (config_hash(out.config) != hash) {
    throw InputError(
        fmt::format("{}: configuration: the hash is {}, and that of the text is {}; expected the same",
                    origin, one_line(hash), config_hash(out.config)));
  }
  check_scene(out.scene, origin);
  bool has_output = false;
  try {
    for (const Json& table : json.at("tables")) {
      ReadTable read = read_table(table, format, fs::path(origin).parent_path(), origin, options, out.config);
      if (read.role == "output" && read.stage == stage_of(out.stage) && !has_output) {
        has_output = true;
        out.output = std::move(read);
      } else if (read.role == "input") {
        out.inputs.push_back(std::move(read));
      } else {
        throw InputError("tables: expected inputs, and one output of the stage");
      }
    }
    if (!has_output) throw InputError("tables: expected one output of the stage");
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: no vectors: {}", origin, fault_of(error)));
  } catch (const InputError& error) {
    const std::string what = one_line(error.what());
    const bool names_a_file = what.starts_with(fs::path(origin).parent_path().string() + "/") ||
                              (!options.answers.empty() && what.starts_with(options.answers));
    throw InputError(names_a_file ? what : fmt::format("{}: {}", origin, what));
  }
  return out;
}

// ---- comparing ----

// The records of a table that a file must have unchanged.
void check_input(const ReadTable& table, const Vectors& model) {
  if (!table.is_there) return;
  const RecordView view =
      table.stage == stored_table ? view_of_stored(model) : view_of(model.trace, type_named(table.stage));
  const Answers& a = table.answers;
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{}: input of {}: {}; expected the records that bitspan vectors wrote",
                                 table.origin, table.stage, what));
  };
  if (a.records != view.records) refuse(fmt::format("{} records, {} of the model", a.records, view.records));
  if (a.unknown > 0) refuse(a.first_unknown + " is unknown");
  const std::size_t places = a.layout.places.size();
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const auto field = static_cast<std::size_t>(a.layout.places[i % places].field);
    if ((!a.missing.empty() && a.missing[i] != 0) || a.values[i] == view.record(i / places)[field]) continue;
    refuse(fmt::format("record {}, field {} is not the model's", i / places, view.fields[field].name));
  }
}

template <class Record>
void set_records(Trace& trace, const std::vector<std::int64_t>& values) {
  auto& to = records_of<Record>(trace);
  to.resize(values.size() / fields<Record>.size());
  std::copy(values.begin(), values.end(), reinterpret_cast<std::int64_t*>(to.data()));
}
Trace trace_of(RecordType type, const std::vector<std::int64_t>& values) {
  Trace trace;
#define BITSPAN_SET(Record, LIST, name, member) \
  if (type == RecordType::member) set_records<Record>(trace, values);
  BITSPAN_RECORDS(BITSPAN_SET)
#undef BITSPAN_SET
  return trace;
}

// The answers as whole records: in the place of what is not answered stands the model's value of that record.
std::vector<std::int64_t> filled(const Answers& a, const RecordView& view) {
  const std::size_t columns = view.fields.size();
  std::vector<std::int64_t> out(a.records * columns);
  for (std::size_t i = 0; i < a.records; ++i) {
    if (i < view.records)
      std::ranges::copy(view.record(i), out.begin() + static_cast<std::ptrdiff_t>(i * columns));
    for (std::size_t k = 0; k < a.layout.places.size(); ++k) {
      const std::size_t from = i * a.layout.places.size() + k;
      if (!a.missing.empty() && a.missing[from] != 0) continue;
      out[i * columns + static_cast<std::size_t>(a.layout.places[k].field)] = a.values[from];
    }
  }
  return out;
}

// Records with 0 in every field that no record answers, on both sides alike.
std::vector<std::int64_t> masked(std::vector<std::int64_t> values, const std::vector<bool>& answered) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!answered[i % answered.size()]) values[i] = 0;
  }
  return values;
}

void count(VectorCheck& out, const Answers& a, const RecordView& view) {
  const std::size_t columns = view.fields.size();
  const std::size_t places = a.layout.places.size();
  StageCount& c = out.pair.stages[static_cast<std::size_t>(out.stage)];
  out.unchecked = view.records - std::min<std::uint64_t>(view.records, c.records);
  const auto left_out = static_cast<std::uint64_t>(std::ranges::count(a.missing, 1));
  out.unknown = a.unknown;
  out.first_unknown = a.first_unknown;
  out.unanswered = left_out - std::min(left_out, a.unknown);
  c.values = c.records * places;
  out.matched = c.values - std::min(c.values, c.differences + left_out);
  std::vector<std::int64_t> previous(columns);
  for (std::size_t i = 0; i < std::min(a.records, view.records); ++i) {
    const auto record = view.record(i);
    for (std::size_t k = 0; k < places; ++k) {
      if (!a.missing.empty() && a.missing[i * places + k] != 0) continue;
      const auto field = static_cast<std::size_t>(a.layout.places[k].field);
      if (record[field] != 0 && record[field] != previous[field]) ++out.non_trivial;
    }
    std::ranges::copy(record, previous.begin());
  }
  c.non_trivial = out.non_trivial;
}

}  // namespace

VectorFormat vector_format(std::string_view name) {
  const auto at = std::ranges::find(vector_formats, name);
  if (at == vector_formats.end()) {
    throw InputError(fmt::format("format: '{}'; expected hex, json or npy", name));
  }
  return static_cast<VectorFormat>(at - vector_formats.begin());
}

std::vector<RecordView> inputs_of(const Vectors& vectors) {
  std::vector<RecordView> out;
  const auto add = [&](RecordType type) {
    const RecordView view = view_of(vectors.trace, type);
    if (type != vectors.stage && view.records > 0) out.push_back(view);
  };
  add(RecordType::constants);
  add(RecordType::state);
  // The new alpha is made of what the new colour is made of.
  if (vectors.stage == RecordType::merge_alpha) {
    for (const RecordType type : row_of(RecordType::merge).made_from) add(type);
  }
  for (const RecordType type : row_of(vectors.stage).made_from) {
    if (type != RecordType::constants) add(type);
  }
  if (!vectors.stored.empty()) out.push_back(view_of_stored(vectors));
  return out;
}

namespace {

// Draws one triangle and the commands around it, and keeps what merge finds in the picture. `picture`: as it
// was left behind the triangle in front; empty at first.
void draw_with_stored(Engine& engine, std::size_t triangle, std::vector<std::uint8_t>& picture,
                      Vectors& out) {
  const auto commands = commands_of(out.scene, triangle, 1);
  const auto index = static_cast<std::int64_t>(triangle);
  const auto behind = std::ranges::upper_bound(commands, triangle, {}, &DrawCommand::before);
  for (auto c = commands.begin(); c != behind; ++c) engine.execute(*c, index, &out.trace);
  if (picture.empty() || behind != commands.begin()) picture = engine.frame().color;
  const std::size_t first = out.trace.merge.size();
  engine.draw(std::span(out.scene.triangles).subspan(triangle, 1), index, &out.trace);
  const Frame& frame = engine.frame();
  // A triangle has each pixel once.
  for (const MergeRecord& merged : std::span(out.trace.merge).subspan(first)) {
    const auto pixel = 4 * static_cast<std::size_t>(merged.y * frame.width + merged.x);
    out.stored.insert(out.stored.end(), {merged.triangle, merged.x, merged.y});
    for (std::size_t c = pixel; c < pixel + 4; ++c) {
      out.stored.push_back(picture[c]);
      picture[c] = frame.color[c];
    }
  }
  for (auto c = behind; c != commands.end(); ++c) engine.execute(*c, index + 1, &out.trace);
}

}  // namespace

Vectors make_vectors(const Config& config, const Scene& scene, RecordType stage,
                     const DrawProgress& progress) {
  if (changes_scene(scene.commands)) {
    throw InputError(scene.name +
                     ": vectors have the constants of one view; expected a scene that no command changes");
  }
  check_scene_range(config, scene);
  Vectors out{config, scene, stage, {}, {}};
  const auto engine = make_engine("model", config);
  engine->begin(scene);
  const LockStepOptions steps;
  std::vector<std::uint8_t> picture;
  for (std::size_t done = 0; done < scene.triangles.size();) {
    const std::size_t n = reads_picture(stage) ? 1 : next_batch(scene, done, steps);
    if (reads_picture(stage)) {
      draw_with_stored(*engine, done, picture, out);
    } else {
      draw_scene(*engine, scene, done, n, &out.trace);
    }
    done += n;
    if (progress) progress(done, scene.triangles.size());
  }
  return out;
}

void write_vectors(const Vectors& vectors, VectorFormat format, const std::string& path,
                   const std::string& version) {
  const std::string text = vectors_json(vectors, format, version);
  if (format == VectorFormat::json) {
    write_file(path, text);
    return;
  }
  AtomicFolder folder(path);
  for (const Table& table : tables_of(vectors)) {
    const RecordView& view = table.view;
    const std::string file = folder.path(file_of(table, format));
    if (format == VectorFormat::npy) {
      write_npy(file, {view.records, view.fields.size()},
                std::span(view.values, view.records * view.fields.size()));
      continue;
    }
    const Layout layout = layout_of(view.fields, vectors.config);
    AtomicFile out(file);
    for (std::size_t i = 0; i < view.records; ++i) out.write(hex_line(view.record(i), layout));
    out.commit();
  }
  if (format == VectorFormat::hex) write_file(folder.path("vectors.vh"), verilog_header(vectors));
  write_file(folder.path(description), text);
  folder.commit(description);
}

VectorCheck check_vectors(const std::string& path, const VectorCheckOptions& options,
                          const DrawProgress& progress) {
  ReadVectors read = read_vectors(path, options);
  const Answers& answers = read.output.answers;
  const Vectors model = make_vectors(read.config, read.scene, read.stage, progress);
  for (const ReadTable& table : read.inputs) check_input(table, model);

  VectorCheck out;
  out.config = read.config;
  out.scene = read.scene.name;
  out.stage = read.stage;
  out.pair.reference = "model";
  out.pair.other = "design";
  const RecordView view = view_of(model.trace, read.stage);
  std::vector<bool> answered(view.fields.size());
  for (const auto& p : answers.layout.places) answered[static_cast<std::size_t>(p.field)] = true;
  for (std::size_t i = 0; i < answered.size(); ++i) {
    if (!answered[i]) out.unchecked_fields.emplace_back(view.fields[i].name);
  }
  const std::vector<std::int64_t> values = filled(answers, view);
  compare_records(model.trace, trace_of(read.stage, values), read.stage, out.pair);
  StageCount& counted = out.pair.stages[static_cast<std::size_t>(read.stage)];
  if (counted.unmatched > 0 && !out.unchecked_fields.empty()) {
    // Records are not in step, so that what stands in for an answer may be another record's: count without
    // it.
    Comparison again;
    compare_records(
        trace_of(read.stage,
                 masked({view.values, view.values + view.records * view.fields.size()}, answered)),
        trace_of(read.stage, masked(values, answered)), read.stage, again);
    counted = again.stages[static_cast<std::size_t>(read.stage)];
  }
  count(out, answers, view);

  if (out.pair.first) {
    out.pair.first->has_other = answered;
    out.failures.push_back(fmt::format("model against design: {}", summary(*out.pair.first, out.config)));
  }
  if (out.unknown > 0) {
    out.failures.push_back(fmt::format("the design's bits are unknown (x or z) in {} values, first in {}",
                                       out.unknown, out.first_unknown));
  }
  if (out.matched == 0) {
    out.failures.emplace_back("nothing was matched");
  } else if (out.non_trivial == 0) {
    out.failures.emplace_back("nothing non-trivial was matched");
  }
  return out;
}

std::string check_text(const VectorCheck& check, const RunLabel& label) {
  const StageCount& c = check.pair.stages[static_cast<std::size_t>(check.stage)];
  std::string out = fmt::format("stage {}, scene {}, configuration {} ({})\n\n", stage_of(check.stage),
                                label.scene, check.config.name, config_hash(check.config));
  out += fmt::format("{} values matched, {} non-trivial, {} records unchecked\n", check.matched,
                     check.non_trivial, check.unchecked);
  if (c.differences + c.unmatched > 0) {
    out += fmt::format("{} values differ, {} records are on one side only\n", c.differences, c.unmatched);
  }
  if (!check.unchecked_fields.empty()) {
    out += fmt::format("fields unchecked: {}\n", fmt::join(check.unchecked_fields, ", "));
  }
  if (check.unanswered > 0)
    out += fmt::format("{} values unchecked: the design gives none\n", check.unanswered);
  if (check.pair.first) out += "\n" + describe(*check.pair.first, check.config, label);
  out += "\n";
  for (const std::string& failure : check.failures) out += "FAILED: " + failure + "\n";
  if (check.held()) out += fmt::format("{}: all held\n", stage_of(check.stage));
  return out;
}

}  // namespace bitspan
