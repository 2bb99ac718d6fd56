// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/height_field.hpp"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

#include "config/config.hpp"
#include "io/npy.hpp"
#include "scene/mesh_text.hpp"
#include "scene/png.hpp"

namespace bitspan {
namespace {

constexpr std::string_view expected_file = "a height field: an NPY, an NPZ or a PNG file of grey levels";
constexpr std::string_view expected_array =
    "an array of plain numbers with two axes: integers of 1 to 8 bytes, or floating-point numbers of 4 or 8";
constexpr std::size_t widest_number = 8;  // bytes

[[noreturn]] void refuse(const std::string& origin, const std::string& what,
                         std::string_view expected = expected_array) {
  throw InputError(fmt::format("{}: {}; expected {}", origin, what, expected));
}

void check_size(std::size_t columns, std::size_t rows, const std::string& origin) {
  constexpr std::size_t side = field_side_limit;
  if (columns >= 2 && rows >= 2 && columns <= side && rows <= side && columns * rows <= field_area_limit)
    return;
  refuse(origin, fmt::format("has {} x {} samples", columns, rows),
         fmt::format("2 to {} each way and at most {} in all", side, field_area_limit));
}

void check_height(double height, std::size_t i, std::size_t j, const std::string& origin) {
  if (std::abs(height) <= field_height_limit) return;  // false where it is no number
  refuse(origin, fmt::format("the height in column {}, row {} is {}", i, j, height),
         "numbers of at most 2^53 either way");
}

// A number of an array: the bytes at `from`, turned round where they are big-endian.
template <class T>
double number_at(const char* from, bool is_turned) {
  std::array<char, sizeof(T)> bytes{};
  std::copy_n(from, sizeof(T), bytes.begin());
  if (is_turned) std::ranges::reverse(bytes);
  return static_cast<double>(std::bit_cast<T>(bytes));
}

struct NumberType {
  std::string_view name;  // without the byte order
  std::size_t bytes;
  double (*read)(const char*, bool);
};
constexpr NumberType number_types[] = {
    {"i1", 1, number_at<std::int8_t>},   {"i2", 2, number_at<std::int16_t>},
    {"i4", 4, number_at<std::int32_t>},  {"i8", 8, number_at<std::int64_t>},
    {"u1", 1, number_at<std::uint8_t>},  {"u2", 2, number_at<std::uint16_t>},
    {"u4", 4, number_at<std::uint32_t>}, {"u8", 8, number_at<std::uint64_t>},
    {"f4", 4, number_at<float>},         {"f8", 8, number_at<double>},
};

// `file` is the whole array.
HeightField field_of_npy(std::string_view file, const std::string& origin) {
  const NpyHeader header = parse_npy_header(file, origin, expected_array);
  if (header.shape.size() != 2) refuse(origin, fmt::format("has {} axes", header.shape.size()));
  const std::string_view order = std::string_view(header.type).substr(0, 1);
  const auto* type = std::ranges::find(number_types, header.type.substr(order.size()), &NumberType::name);
  if (type == std::end(number_types) || (order != "<" && order != ">" && order != "|" && order != "=")) {
    refuse(origin, fmt::format("is of type {}", in_quotes(header.type)));
  }
  const std::size_t rows = header.shape[0], columns = header.shape[1];
  check_size(columns, rows, origin);
  if (file.size() - header.bytes != rows * columns * type->bytes) {
    refuse(origin,
           fmt::format("has {} bytes of numbers, and its shape asks for {}", file.size() - header.bytes,
                       rows * columns * type->bytes),
           "a whole file");
  }
  HeightField out{static_cast<int>(columns), static_cast<int>(rows), {}};
  out.heights.reserve(rows * columns);
  for (std::size_t j = 0; j < rows; ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t at = header.is_fortran ? i * rows + j : j * columns + i;
      const double height = type->read(file.data() + header.bytes + at * type->bytes, order == ">");
      check_height(height, i, j, origin);
      out.heights.push_back(height);
    }
  }
  return out;
}

HeightField field_of_png(std::string_view file, const std::string& origin) {
  const ByteSpan bytes{reinterpret_cast<const std::uint8_t*>(file.data()), file.size()};
  const GreyCodes grey = decode_grey_png(bytes, origin);
  check_size(static_cast<std::size_t>(grey.width), static_cast<std::size_t>(grey.height), origin);
  return {grey.width, grey.height, {grey.codes.begin(), grey.codes.end()}};
}

// An NPZ file: a ZIP archive with an NPY file per array. Sizes that it promises are not believed: memory is
// taken as bytes come.
class Archive {
 public:
  Archive(const std::string& path, std::string_view file) : path_(path) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_buffer_create(file.data(), file.size(), 0, &error);
    if (source != nullptr) zip_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
    const std::string reason = zip_error_strerror(&error);
    if (!zip_ && source != nullptr) zip_source_free(source);
    zip_error_fini(&error);
    if (!zip_) refuse(path_, fmt::format("is a damaged archive: {}", reason), expected_file);
  }

  // The names of its arrays, without ".npy".
  std::vector<std::string> arrays() const {
    const zip_int64_t count = zip_get_num_entries(zip_.get(), 0);
    if (count > entries_limit) refuse(path_, fmt::format("has {} entries", count), "at most 4096");
    std::vector<std::string> out;
    for (zip_int64_t i = 0; i < count; ++i) {
      const char* name = zip_get_name(zip_.get(), static_cast<zip_uint64_t>(i), ZIP_FL_ENC_RAW);
      const std::string_view text = name == nullptr ? "" : name;
      if (text.ends_with(suffix)) out.emplace_back(text.substr(0, text.size() - suffix.size()));
    }
    return out;
  }

  std::string origin(const std::string& array) const {
    return fmt::format("{} ({})", path_, in_quotes(array));
  }

  // The first bytes of an array's file, `most` at most.
  std::string read(const std::string& array, std::size_t most) const {
    const std::string name = fmt::format("{}{}", array, suffix);
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> entry(
        zip_fopen(zip_.get(), name.c_str(), ZIP_FL_ENC_RAW), zip_fclose);
    if (!entry) refuse(origin(array), fmt::format("cannot be read: {}", zip_strerror(zip_.get())));
    std::string out;
    while (out.size() < most) {
      const std::size_t before = out.size();
      out.resize(std::min(most, before + chunk_bytes));
      const zip_int64_t count = zip_fread(entry.get(), out.data() + before, out.size() - before);
      if (count < 0) refuse(origin(array), fmt::format("cannot be read: {}", zip_file_strerror(entry.get())));
      out.resize(before + static_cast<std::size_t>(count));
      if (count == 0) break;
    }
    return out;
  }

 private:
  static constexpr zip_int64_t entries_limit = 4096;
  static constexpr std::string_view suffix = ".npy";
  static constexpr std::size_t chunk_bytes = 1 << 20;

  const std::string& path_;
  std::unique_ptr<zip_t, void (*)(zip_t*)> zip_{nullptr, zip_discard};
};

HeightField field_of_npz(std::string_view file, const std::string& path,
                         const std::optional<std::string>& array) {
  const Archive archive(path, file);
  const std::vector<std::string> all = archive.arrays();
  std::vector<std::string> names;
  if (array) {
    if (std::ranges::find(all, *array) != all.end()) names = {*array};
  } else {
    // A damaged one is looked at again where it is named.
    std::ranges::copy_if(all, std::back_inserter(names), [&](const std::string& name) {
      try {
        const std::string head = archive.read(name, npy_header_limit);
        return parse_npy_header(head, archive.origin(name), expected_array).shape.size() == 2;
      } catch (const InputError&) {
        return all.size() == 1;
      }
    });
  }
  if (names.size() != 1) {
    std::string known;
    for (const std::string& name : names.empty() ? all : names) known += fmt::format(" {}", in_quotes(name));
    refuse(path,
           array ? fmt::format("has no array {}", in_quotes(*array))
                 : fmt::format("has {} arrays with two axes", names.size()),
           fmt::format("one; --array names one of{}", known.empty() ? " none" : known));
  }
  const std::size_t most = npy_header_limit + field_area_limit * widest_number;
  const std::string head = archive.read(names[0], npy_header_limit);
  const NpyHeader header = parse_npy_header(head, archive.origin(names[0]), expected_array);
  // One byte more than the shape asks for shows that there are more.
  std::size_t wanted = most;
  if (header.shape.size() == 2) {
    check_size(header.shape[1], header.shape[0], archive.origin(names[0]));
    wanted = header.bytes + header.shape[0] * header.shape[1] * widest_number + 1;
  }
  return field_of_npy(archive.read(names[0], wanted), archive.origin(names[0]));
}

}  // namespace

HeightField read_height_field(const std::string& path, const std::optional<std::string>& array) {
  std::error_code code;
  const bool is_file = std::filesystem::is_regular_file(path, code);
  if (!is_file) {
    refuse(path, code ? fmt::format("cannot read: {}", code.message()) : "cannot read: is no plain file",
           expected_file);
  }
  std::array<char, 8> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  const std::string_view start{head.data(), head.size()};
  const bool is_npy = start.starts_with("\x93NUMPY"), is_zip = start.starts_with("PK");
  if (!is_npy && !is_zip && !start.starts_with("\x89PNG\r\n\x1a\n")) {
    // What cannot be opened says why.
    read_whole(std::ifstream(path) ? "/dev/null" : path, expected_file);
    refuse(path, "is none", expected_file);
  }
  if (array && !is_zip) refuse(path, "has one array without a name", "no --array, or an NPZ file");
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  const std::size_t most = 2 * field_area_limit * widest_number;
  if (code || size > most) refuse(path, fmt::format("has {} bytes", size), fmt::format("at most {}", most));
  const std::string file = read_whole(path, expected_file);
  if (is_npy) return field_of_npy(file, path);
  return is_zip ? field_of_npz(file, path, array) : field_of_png(file, path);
}

HeightField every_nth(const HeightField& field, int n) {
  HeightField out{(field.columns - 1) / n + 1, (field.rows - 1) / n + 1, {}};
  if (out.columns < 2 || out.rows < 2) {
    throw InputError(
        fmt::format("every sample number {} of {} x {} leaves no triangle; expected a smaller step", n,
                    field.columns, field.rows));
  }
  for (int j = 0; j < out.rows; ++j) {
    for (int i = 0; i < out.columns; ++i) out.heights.push_back(field.at(i * n, j * n));
  }
  return out;
}

}  // namespace bitspan
