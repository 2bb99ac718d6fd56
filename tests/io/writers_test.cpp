// SPDX-License-Identifier: Apache-2.0
// The writers of pictures, arrays and whole-or-nothing files.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <barrier>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numeric>
#include <set>
#include <thread>

#include "io/atomic_file.hpp"
#include "io/atomic_folder.hpp"
#include "io/json_depth.hpp"
#include "io/leftovers.hpp"
#include "io/npy.hpp"
#include "io/png.hpp"
#include "scene/texture.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(AtomicFile, AppearsOnCommitOnly) {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder.path("a.txt"));
    file.write("half");
    EXPECT_FALSE(std::filesystem::exists(folder.path("a.txt")));
    file.write(" whole");
    file.commit();
    EXPECT_EQ(folder.read("a.txt"), "half whole");
  }
  EXPECT_EQ(folder.files(), 1);
  {
    AtomicFile file(folder.path("a.txt"));
    file.write(std::string(1 << 20, 'x'));
  }  // abandoned
  EXPECT_EQ(folder.read("a.txt"), "half whole") << "the old content stays";
  EXPECT_EQ(folder.files(), 1) << "nothing is left behind";
}

TEST(AtomicFile, KeepsOrderAcrossItsBuffer) {
  const TemporaryFolder folder;
  std::string expected;
  AtomicFile file(folder.path("a.bin"));
  for (std::size_t size : {1U, 65535U, 3U, 65536U, 70000U, 10U, 200000U, 0U, 7U}) {
    const std::string piece(size, static_cast<char>('a' + size % 26));
    file.write(piece);
    expected += piece;
  }
  file.commit();
  EXPECT_EQ(folder.read("a.bin"), expected);
}

TEST(AtomicFile, KeepsModeAndLinks) {
  const TemporaryFolder folder;
  folder.write("real.txt", "old");
  ::chmod(folder.path("real.txt").c_str(), 0640);
  std::filesystem::create_symlink("real.txt", folder.path("link.txt"));
  write_file(folder.path("link.txt"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link.txt")));
  EXPECT_EQ(folder.read("real.txt"), "new");
  struct stat info {};
  ::stat(folder.path("real.txt").c_str(), &info);
  EXPECT_EQ(info.st_mode & 0777U, 0640U);
  const mode_t mask = ::umask(022);
  ::umask(mask);
  write_file(folder.path("fresh.txt"), "x");
  ::stat(folder.path("fresh.txt").c_str(), &info);
  EXPECT_EQ(info.st_mode & 0777U, 0666U & ~mask);
}

TEST(AtomicFile, RefusesWhatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_NE(input_error([&] {
              write_file(folder.path("none/a.txt"), "x");
            }).find("none/a.txt: cannot write: No such"),
            std::string::npos);
  EXPECT_NE(input_error([&] { write_file(folder.path(), "x"); }).find("cannot write: Is a directory"),
            std::string::npos);
  EXPECT_NE(input_error([&] { write_file("", "x"); }).find("cannot write"), std::string::npos);
  folder.write("file", "");
  EXPECT_NE(
      input_error([&] { write_file(folder.path("file/a.txt"), "x"); }).find("cannot write: Not a directory"),
      std::string::npos);
  EXPECT_NE(input_error([&] {
              write_file(folder.path(std::string(300, 'n')), "x");
            }).find("cannot write: File name too long"),
            std::string::npos);
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, FullDiskShows) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_NE(input_error([&] { write_file("/dev/full", "x"); }).find("/dev/full: cannot write: No space left"),
            std::string::npos);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full")) << "a device is written to, not replaced";
}

TEST(AtomicFile, TakesEveryNameThatTheSystemTakes) {
  const TemporaryFolder folder;
  for (std::size_t size = 240; size <= 255; ++size) {
    write_file(folder.path(std::string(size, 'n')), "x");
    EXPECT_EQ(folder.read(std::string(size, 'n')), "x");
  }
  EXPECT_EQ(folder.files(), 16);
}

TEST(AtomicFolder, TakesEveryNameThatTheSystemTakes) {
  const TemporaryFolder folder;
  for (std::size_t size = 240; size <= 255; ++size) {
    AtomicFolder made(folder.path(std::string(size, 'n')));
    write_file(made.path("a"), "x");
    made.commit("a");
    EXPECT_EQ(folder.read(std::string(size, 'n') + "/a"), "x");
  }
  EXPECT_EQ(folder.files(), 16);
  expect_refusal([&] { AtomicFolder(folder.path(std::string(256, 'n'))); }, "File name too long");
  EXPECT_EQ(folder.files(), 16);
}

// Each writer's files are of one set, and the last one's stay.
TEST(AtomicFolder, TakesTwoWritersAtOnce) {
  const TemporaryFolder folder;
  for (int round = 0; round < 50; ++round) {
    const std::string path = folder.path("d" + std::to_string(round % 5));
    if (round % 2 == 0) std::filesystem::remove_all(path);
    std::barrier start(2);
    const auto write = [&](const std::string& text) {
      AtomicFolder made(path);
      for (const char* name : {"a", "b", "c", "last"}) write_file(made.path(name), text);
      start.arrive_and_wait();
      made.commit("last");
    };
    std::jthread one(write, "one");
    write("two");
    one.join();
    for (const char* name : {"a", "b", "c"})
      ASSERT_EQ(read_file(path + "/" + name), read_file(path + "/last"));
  }
  EXPECT_EQ(folder.files(), 5);
}

// A program that ends in the middle of its writing, by every signal that can end it there.
TEST(Leftovers, ASignalRemovesThem) {
  for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE, SIGXCPU}) {
    const TemporaryFolder folder;
    write_file(folder.path("old"), "old");
    write_file(folder.path("whole"), "x");
    std::filesystem::create_directory(folder.path("kept"));
    write_file(folder.path("kept/file"), "x");
    EXPECT_EXIT(
        {
          remove_leftovers_on_signals();
          AtomicFile file(folder.path("new"));
          AtomicFile over(folder.path("old"));
          AtomicFolder dump(folder.path("dump"));
          write_file(dump.path("a.npy"), "x");
          AtomicFile inside(dump.path("b.npy"));
          const Leftover deep(folder.path("deep"));
          std::filesystem::create_directories(folder.path("deep/empty"));
          std::filesystem::create_directories(folder.path("deep/1/2/3"));
          for (int i = 0; i < 300; ++i) write_file(folder.path("deep/1/2/" + std::to_string(i) + ".o"), "x");
          std::filesystem::create_directory_symlink(folder.path("kept"), folder.path("deep/link"));
          for (AtomicFile* half : {&file, &over, &inside}) half->write(std::string(1 << 20, 'h'));
          if (folder.files() != 7) ::_exit(1);
          ::raise(number);
          ::_exit(2);
        },
        ::testing::KilledBySignal(number), "");
    EXPECT_EQ(folder.files(), 3) << number;
    EXPECT_EQ(folder.read("old"), "old");
    EXPECT_EQ(folder.read("kept/file"), "x") << "a link is removed, not what it names";
  }
}

TEST(Leftovers, AnIgnoredSignalStaysSoAndALimitOfSizeIsAnError) {
  const TemporaryFolder folder;
  EXPECT_EXIT(
      {
        ::signal(SIGHUP, SIG_IGN);
        remove_leftovers_on_signals();
        ::raise(SIGHUP);
        ::raise(SIGXFSZ);
        rlimit limit{};
        limit.rlim_cur = limit.rlim_max = 1 << 16;
        ::setrlimit(RLIMIT_FSIZE, &limit);
        const std::string error =
            input_error([&] { write_file(folder.path("a"), std::string(1 << 20, 'x')); });
        ::_exit(names(error, "cannot write: File too large") ? 7 : 1);
      },
      ::testing::ExitedWithCode(7), "");
  EXPECT_EQ(folder.files(), 0);
}

// What a forked child does with its signals is no end of the parent's files.
TEST(Leftovers, AChildRemovesNothing) {
  const TemporaryFolder folder;
  EXPECT_EXIT(
      {
        remove_leftovers_on_signals();
        AtomicFile file(folder.path("a"));
        file.write("x");
        const pid_t child = ::fork();
        if (child == 0) {
          ::raise(SIGTERM);
          ::_exit(0);
        }
        ::waitpid(child, nullptr, 0);
        file.commit();
        ::_exit(folder.read("a") == "x" ? 7 : 1);
      },
      ::testing::ExitedWithCode(7), "");
}

TEST(JsonDepth, TheLimitIsOfNestingAlone) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + "\"\\\"[[[\"" + std::string(depth, ']');
  };
  check_json_depth(nested(64));
  check_json_depth("\xEF\xBB\xBF[" + nested(63) + "," + nested(63) + "]");
  expect_refusal([&] { check_json_depth("{\n" + nested(64)); },
                 "line 2: arrays and objects are nested too deep");
  expect_refusal([&] { check_json_depth(std::string(1'000'000, '{')); }, "expected at most 64");
  std::string flat = "[";
  for (int i = 0; i < 1000; ++i) flat += "{\"a\": [1]},";
  check_json_depth(flat + "0]");
  check_json_depth("]]]]\"");
}

TEST(Png, ReadsBackInEveryLayout) {
  for (int channels = 1; channels <= 4; ++channels) {
    Bytes pixels(static_cast<std::size_t>(9 * 5 * channels));
    std::iota(pixels.begin(), pixels.end(), std::uint8_t{3});
    const Texture texture = decode_texture(encode_png(9, 5, channels, pixels), "p");
    ASSERT_EQ(texture.width, 9);
    ASSERT_EQ(texture.height, 5);
    const std::size_t n = static_cast<std::size_t>(channels);
    for (std::size_t i = 0; i < 45; ++i) {
      const bool grey = channels < 3;
      for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(texture.rgba[4 * i + k], pixels[n * i + (grey ? 0 : k)]);
      ASSERT_EQ(texture.rgba[4 * i + 3], channels % 2 == 0 ? pixels[n * i + n - 1] : 255);
    }
  }
}

TEST(Png, SamePixelsSameBytes) {
  const Bytes pixels(300, 7);
  EXPECT_EQ(encode_png(10, 10, 3, pixels), encode_png(10, 10, 3, pixels));
  EXPECT_THROW(encode_png(10, 11, 3, pixels), std::invalid_argument);
  EXPECT_THROW(encode_png(0, 10, 3, {}), std::invalid_argument);
}

TEST(Png, UnwritableIsInputError) {
  const TemporaryFolder folder;
  EXPECT_NE(
      input_error([&] { write_png(folder.path("x/p.png"), 1, 1, 1, Bytes{0}); }).find("p.png: cannot write"),
      std::string::npos);
}

// Header text and data of a version 1.0 file.
std::pair<std::string, std::string> split_npy(const std::string& file) {
  EXPECT_EQ(file.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t length = static_cast<std::uint8_t>(file[8]) + 256U * static_cast<std::uint8_t>(file[9]);
  EXPECT_EQ((10 + length) % 64, 0U);
  EXPECT_EQ(file[9 + length], '\n');
  std::string header = file.substr(10, length);
  header.erase(header.find_last_not_of(" \n") + 1);
  return {header, file.substr(10 + length)};
}

template <class T>
void expect_npy(const std::vector<T>& values, std::initializer_list<std::size_t> shape,
                const std::string& header) {
  const TemporaryFolder folder;
  write_npy(folder.path("a.npy"), shape, std::span<const T>(values));
  const auto [text, data] = split_npy(folder.read("a.npy"));
  EXPECT_EQ(text, header);
  ASSERT_EQ(data.size(), values.size() * sizeof(T));
  if (!values.empty()) {
    EXPECT_EQ(std::memcmp(data.data(), values.data(), data.size()), 0);
  }
}

TEST(CheckWritable, RefusesWhatCannotBeWrittenAndLeavesNothing) {
  const TemporaryFolder folder;
  check_writable("");
  check_writable(folder.path("new"));
  EXPECT_EQ(folder.files(), 0);
  const std::string old = folder.write("old", "text");
  check_writable(old);
  EXPECT_EQ(folder.read("old"), "text");
  EXPECT_EQ(folder.files(), 1);
  check_writable("/dev/null");
  EXPECT_THROW(check_writable(folder.path("no/such")), InputError);
  EXPECT_THROW(check_writable(folder.path()), InputError);
  EXPECT_THROW(check_writable(old + "/below"), InputError);
  EXPECT_THROW(make_writable_folder(old), InputError);
  make_writable_folder(folder.path("made/here"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path("made/here")));
}

TEST(Npy, HeadersAndData) {
  expect_npy<std::uint8_t>({1, 2, 3, 4, 5, 6, 7, 8}, {1, 2, 4},
                           "{'descr': '|u1', 'fortran_order': False, 'shape': (1, 2, 4), }");
  expect_npy<std::uint32_t>({1, 4000000000, 3, 4, 5, 6}, {2, 3},
                            "{'descr': '<u4', 'fortran_order': False, 'shape': (2, 3), }");
  expect_npy<std::int32_t>({-1, 7}, {2}, "{'descr': '<i4', 'fortran_order': False, 'shape': (2,), }");
  expect_npy<double>({0.1, std::nan(""), -0.0, 1e300}, {2, 2},
                     "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }");
  expect_npy<double>({}, {0, 5}, "{'descr': '<f8', 'fortran_order': False, 'shape': (0, 5), }");
  EXPECT_THROW(write_npy("a.npy", {2, 2}, std::span<const double>()), std::invalid_argument);
}

TEST(Npy, ATableComesBackAndAnythingElseIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.path("a.npy");
  const std::vector<std::int64_t> values{1, -2, std::numeric_limits<std::int64_t>::min(), 4, 5, 6};
  write_npy(path, {3, 2}, std::span(values));
  const std::string good = folder.read("a.npy");
  IntegerTable table = read_npy_table(path);
  EXPECT_EQ(table.rows, 3U);
  EXPECT_EQ(table.columns, 2U);
  EXPECT_EQ(table.values, values);

  const auto changed = [&](std::string_view from, std::string_view to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    folder.write("a.npy", text.replace(at, from.size(), to));
  };
  const auto refused = [&](std::string_view part) { expect_refusal([&] { read_npy_table(path); }, part); };
  // As NumPy writes it, and as others may.
  changed("(3, 2), }", "(3,2), } ");
  EXPECT_EQ(read_npy_table(path).values, values);
  changed(", 2), }", ", 2,)} ");
  EXPECT_EQ(read_npy_table(path).values, values);
  std::string second = good;
  second[6] = 2;
  second.insert(10, 2, '\0');
  folder.write("a.npy", second);
  EXPECT_EQ(read_npy_table(path).values, values);

  changed("(3, 2), }", "(6,), }  ");
  refused("has not two axes");
  changed("(3, 2), }", "(3,2,1)} ");
  refused("has not two axes");
  changed("(3, 2), }", "(3, 2     ");
  refused("two axes");
  changed("(3, 2)", "(2, 3)");
  EXPECT_EQ(read_npy_table(path).columns, 3U);
  changed("(3, 2)", "(3, 3)");
  refused("cut short, or too long");
  changed("(3, 2)", "(-3,2)");
  refused("a.npy");
  changed("<i8", "<f8");
  refused("another type");
  changed("False", "True ");
  refused("C order");
  changed("NUMPY", "NUMPI");
  refused("no NumPy file");
  for (std::size_t size = 0; size < good.size(); ++size) {
    folder.write("a.npy", good.substr(0, size));
    refused("a.npy: ");
  }
  folder.write("a.npy", good + "x");
  refused("too long");
  expect_refusal([&] { read_npy_table(folder.path()); }, "cannot read");
  expect_refusal([&] { read_npy_table(folder.path("b.npy")); }, "b.npy: cannot read");
}

}  // namespace
}  // namespace bitspan
