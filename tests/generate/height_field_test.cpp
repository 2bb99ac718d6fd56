// SPDX-License-Identifier: Apache-2.0
// Height fields of NPY, NPZ and PNG files, and files that are none.
#include "scene/generate/height_field.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <zip.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "io/npy.hpp"
#include "io/png.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

// An NPY file of any type, order and shape.
std::string npy(const std::string& type, const std::string& order, const std::string& shape,
                const std::string& data) {
  std::string text = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  text.append(63 - (10 + text.size()) % 64, ' ');
  text += '\n';
  std::string out = "\x93NUMPY";
  out += '\1';
  out += '\0';
  out += static_cast<char>(text.size() & 255U);
  out += static_cast<char>(text.size() >> 8U);
  return out + text + data;
}

// The numbers as bytes of T, of one byte order or the other.
template <class T>
std::string bytes_of(const std::vector<double>& numbers, bool is_big_endian) {
  std::string out;
  for (const double number : numbers) {
    const T value = static_cast<T>(number);
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  }
  return out;
}

// A ZIP file, its entries deflated or stored.
void write_zip(const std::string& path, const std::map<std::string, std::string>& entries,
               bool is_deflated = true) {
  int error = 0;
  zip_t* zip = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
  ASSERT_NE(zip, nullptr);
  for (const auto& [name, data] : entries) {
    zip_source_t* source = zip_source_buffer(zip, data.data(), data.size(), 0);
    const zip_int64_t index = zip_file_add(zip, name.c_str(), source, 0);
    ASSERT_GE(index, 0);
    zip_set_file_compression(zip, static_cast<zip_uint64_t>(index),
                             is_deflated ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 9);
  }
  ASSERT_EQ(zip_close(zip), 0);
}

std::string grey_png(int width, int height, int bits, const std::vector<std::uint16_t>& codes) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, std::size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), n);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (bits < 8) png_set_packing(png);
  for (int j = 0; j < height; ++j) {
    std::vector<std::uint8_t> row;
    for (int i = 0; i < width; ++i) {
      const unsigned code = codes[static_cast<std::size_t>(j * width + i)];
      if (bits == 16) row.push_back(static_cast<std::uint8_t>(code >> 8U));
      row.push_back(static_cast<std::uint8_t>(code & 255U));
    }
    png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return out;
}

const std::vector<double> six{1, 2, 3, 40, 50, 60};  // 2 rows of 3

TEST(HeightField, ReadsEveryTypeAndOrderOfNumbers) {
  const TemporaryFolder folder;
  const auto expect_six = [&](const std::string& type, const std::string& order, const std::string& data) {
    const HeightField field = read_height_field(folder.write("a.npy", npy(type, order, "(2, 3)", data)));
    EXPECT_EQ(field.columns, 3) << type;
    EXPECT_EQ(field.rows, 2) << type;
    EXPECT_EQ(field.heights, six) << type;
  };
  const std::vector<double> by_columns{1, 40, 2, 50, 3, 60};
  for (const bool big : {false, true}) {
    const std::string order = big ? ">" : "<";
    expect_six(order + "i2", "False", bytes_of<std::int16_t>(six, big));
    expect_six(order + "i4", "False", bytes_of<std::int32_t>(six, big));
    expect_six(order + "i8", "False", bytes_of<std::int64_t>(six, big));
    expect_six(order + "u2", "False", bytes_of<std::uint16_t>(six, big));
    expect_six(order + "u4", "True", bytes_of<std::uint32_t>(by_columns, big));
    expect_six(order + "u8", "False", bytes_of<std::uint64_t>(six, big));
    expect_six(order + "f4", "False", bytes_of<float>(six, big));
    expect_six(order + "f8", "True", bytes_of<double>(by_columns, big));
  }
  expect_six("|i1", "False", bytes_of<std::int8_t>(six, false));
  expect_six("|u1", "True", bytes_of<std::uint8_t>(by_columns, false));
  const HeightField field = read_height_field(folder.write(
      "n.npy", npy("<i2", "False", "(2, 2)", bytes_of<std::int16_t>({-1, -2, -32768, 5}, false))));
  EXPECT_EQ(field.heights, (std::vector<double>{-1, -2, -32768, 5}));
}

TEST(HeightField, RefusesArraysThatAreNone) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& file, std::string_view part) {
    const std::string path = folder.write("a.npy", file);
    const std::string message = input_error([&] { read_height_field(path); });
    EXPECT_TRUE(names(message, "a.npy: ") && names(message, part)) << message;
  };
  const std::string data = bytes_of<std::int16_t>(six, false);
  refused(npy("<i2", "False", "(6,)", data), "has 1 axes");
  refused(npy("<i2", "False", "()", data), "has 0 axes");
  refused(npy("<i2", "False", "(1, 2, 3)", data), "has 3 axes");
  refused(npy("<i2", "False", "(1, 6)", data), "6 x 1 samples");
  refused(npy("<i2", "False", "(2, 0)", ""), "0 x 2 samples");
  refused(npy("<i2", "False", "(2, 4)", data), "12 bytes of numbers, and its shape asks for 16");
  refused(npy("<i2", "False", "(2, 3)", data + "x"), "13 bytes");
  // Products that leave 64 bits, or the memory.
  refused(npy("<i2", "False", "(4294967296, 4294967296)", data), "samples");
  refused(npy("<i2", "False", "(18446744073709551615, 2)", data), "samples");
  refused(npy("<i2", "False", "(18446744073709551616, 2)", data), "damaged description");
  refused(npy("<i2", "False", "(32768, 32768)", data), "at most 67108864 in all");
  refused(npy("<i2", "False", "(-2, 3)", data), "damaged description");
  refused(npy("<c16", "False", "(2, 3)", data), "\"<c16\"");
  refused(npy("<f2", "False", "(2, 3)", data), "of type");
  refused(npy("|O", "False", "(2, 3)", data), "of type");
  refused(npy("", "False", "(2, 3)", data), "of type");
  refused(npy("<i2", "Maybe", "(2, 3)", data), "damaged description");
  refused(npy("<f4", "False", "(2, 2)", bytes_of<float>({1, 2, std::nanf(""), 4}, false)),
          "column 0, row 1 is nan");
  refused(npy("<f8", "False", "(2, 2)", bytes_of<double>({1, 1e300, 3, 4}, false)), "column 1, row 0");
  refused(npy("<u8", "False", "(2, 2)", std::string(32, '\xff')), "at most 2^53");
  std::string records = npy("<i2", "False", "(2, 3)", data);
  records.replace(records.find("'<i2'"), 5, "[('a'");
  refused(records, "array of records");
  const std::string good = npy("<i2", "False", "(2, 3)", data);
  for (std::size_t size = 0; size < good.size(); ++size) refused(good.substr(0, size), "expected");
  std::string version = good;
  version[6] = 9;
  refused(version, "unknown version");
  version[6] = 2;  // a length of gigabytes
  refused(version, "a.npy: ");
}

TEST(HeightField, ReadsTheArrayOfAnArchive) {
  const TemporaryFolder folder;
  const std::string six_file = npy("<i2", "False", "(2, 3)", bytes_of<std::int16_t>(six, false));
  const std::string four_file = npy("<f8", "False", "(2, 2)", bytes_of<double>({1, 2, 3, 4}, false));
  const std::string number = npy("<f8", "False", "()", bytes_of<double>({0.5}, false));
  const std::string path = folder.path("a.npz");
  for (const bool is_deflated : {false, true}) {
    write_zip(path, {{"elevation.npy", six_file}, {"dx.npy", number}, {"note.txt", "not an array"}},
              is_deflated);
    EXPECT_EQ(read_height_field(path).heights, six);
    EXPECT_EQ(read_height_field(path, "elevation").heights, six);
  }
  expect_refusal([&] { read_height_field(path, "dx"); }, "a.npz (\"dx\"): has 0 axes");
  expect_refusal([&] { read_height_field(path, "height"); },
                 "has no array \"height\"; expected one; --array names one of \"dx\" \"elevation\"");
  write_zip(path, {{"a.npy", six_file}, {"b.npy", four_file}});
  expect_refusal([&] { read_height_field(path); },
                 "2 arrays with two axes; expected one; --array names one of \"a\" \"b\"");
  EXPECT_EQ(read_height_field(path, "b").heights.size(), 4U);
  write_zip(path, {{"note.txt", "x"}});
  expect_refusal([&] { read_height_field(path); }, "names one of none");
  expect_refusal([&] { read_height_field(folder.write("a.npy", six_file), "a"); },
                 "one array without a name");
}

TEST(HeightField, RefusesArchivesThatSwell) {
  const TemporaryFolder folder;
  const std::string path = folder.path("bomb.npz");
  // 16 MB of zeros behind an array of six numbers, in 16 kB.
  const std::string six_file = npy("<i2", "False", "(2, 3)", bytes_of<std::int16_t>(six, false));
  write_zip(path, {{"a.npy", six_file + std::string(std::size_t{1} << 24, '\0')}});
  EXPECT_LT(std::filesystem::file_size(path), 30'000U);
  expect_refusal([&] { read_height_field(path); }, "and its shape asks for 12");
  // One that promises 400 MB and has none.
  write_zip(path, {{"a.npy", npy("<f8", "False", "(8000, 8000)", "")}});
  expect_refusal([&] { read_height_field(path); }, "has 0 bytes of numbers");
}

TEST(HeightField, DamagedArchivesAreRefusedOrRead) {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.npz");
  write_zip(path, {{"a.npy", npy("<i2", "False", "(2, 3)", bytes_of<std::int16_t>(six, false))}});
  const std::string good = folder.read("a.npz");
  for (std::size_t size = 0; size < good.size(); ++size) {
    folder.write("a.npz", good.substr(0, size));
    input_error([&] { read_height_field(path); });
  }
  constexpr unsigned seed = 20261129;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  int refused = 0;
  for (int k = 0; k < (is_long_run() ? 5000 : 300); ++k) {
    std::string text = good;
    for (auto n = 1 + random() % 3; n > 0; --n) text[random() % text.size()] = static_cast<char>(random());
    folder.write("a.npz", text);
    refused += error_of([&] { EXPECT_GE(read_height_field(path).heights.size(), 4U); }).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 150);
}

TEST(HeightField, ReadsCodesOfAPng) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& file) { return read_height_field(folder.write("a.png", file)); };
  EXPECT_EQ(read(grey_png(3, 2, 16, {0, 1, 65535, 256, 257, 4660})).heights,
            (std::vector<double>{0, 1, 65535, 256, 257, 4660}));
  EXPECT_EQ(read(grey_png(3, 2, 8, {0, 1, 255, 128, 7, 9})).heights,
            (std::vector<double>{0, 1, 255, 128, 7, 9}));
  EXPECT_EQ(read(grey_png(3, 2, 4, {0, 1, 15, 8, 7, 9})).heights, (std::vector<double>{0, 1, 15, 8, 7, 9}));
  const std::string path = folder.path("a.png");
  const std::vector<std::uint8_t> pixels(2 * 2 * 4, 9);
  write_png(path, 2, 2, 4, pixels);
  expect_refusal([&] { read_height_field(path); }, "colours or alpha");
  folder.write("a.png", grey_png(3, 1, 16, {1, 2, 3}));
  expect_refusal([&] { read_height_field(path); }, "3 x 1 samples");
  const std::string good = grey_png(3, 2, 16, {0, 1, 65535, 256, 257, 4660});
  for (std::size_t size = 0; size + 12 < good.size(); ++size) {
    folder.write("a.png", good.substr(0, size));
    input_error([&] { read_height_field(path); });
  }
}

TEST(HeightField, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  expect_refusal([&] { read_height_field(folder.path("none.npy")); }, "none.npy: cannot read");
  expect_refusal([&] { read_height_field(folder.path()); }, "is no plain file");
  expect_refusal([&] { read_height_field("/dev/zero"); }, "is no plain file");
  expect_refusal([&] { read_height_field(folder.write("a.txt", "1 2 3\n4 5 6\n")); },
                 "is none; expected a height field");
}

TEST(HeightField, HeightsBetweenSamplesAreBilinear) {
  const HeightField field{3, 2, {0, 10, 20, 100, 110, 160}};
  EXPECT_EQ(height_at(field, 0, 0), 0);
  EXPECT_EQ(height_at(field, 2, 1), 160);
  EXPECT_EQ(height_at(field, 0.5, 0), 5);
  EXPECT_EQ(height_at(field, 0.5, 0.5), 55);
  EXPECT_EQ(height_at(field, 1.5, 1), 135);
  EXPECT_EQ(every_nth({5, 4, {0, 1, 2, 3, 4, 10, 11, 12, 13, 14, 20, 21, 22, 23, 24, 30, 31, 32, 33, 34}}, 2)
                .heights,
            (std::vector<double>{0, 2, 4, 20, 22, 24}));
  expect_refusal([&] { every_nth(field, 2); }, "leaves no triangle");
}

}  // namespace
}  // namespace bitspan
