// SPDX-License-Identifier: Apache-2.0
#include "scene/mesh_text.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "config/config.hpp"

namespace bitspan {
namespace {

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

// Whether a decimal number that is no double is so for being too near to 0, not too far from it.
bool is_tiny(std::string_view number) {
  const std::size_t e = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, e);
  std::int64_t exponent = 0;
  if (e != number.size()) {
    std::string_view text = number.substr(e + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto error = std::from_chars(text.data(), text.data() + text.size(), exponent).ec;
    if (error != std::errc()) return text.starts_with('-');
  }
  // The power of ten of the first digit that is not 0; no file is so long that the sum overflows.
  const std::size_t first = digits.find_first_of("123456789");
  if (first == std::string_view::npos) return true;
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const auto power = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(first);
  return exponent < -power;
}

}  // namespace

std::string read_whole(const std::string& path, std::string_view expected) {
  const auto fail = [&](std::string_view reason) {
    return InputError(path + ": cannot read: " + std::string(reason) + "; expected " + std::string(expected));
  };
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) throw fail("is a folder");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw fail(std::strerror(errno));
  std::string bytes;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  // A byte more than the file's, so that its end is seen; a pipe has no size.
  std::size_t room = !code && size < bytes.max_size() / 2 ? static_cast<std::size_t>(size) + 1 : 1 << 16;
  std::size_t used = 0;
  while (true) {
    bytes.resize(room);
    used += std::fread(bytes.data() + used, 1, room - used, file.get());
    if (used < room) break;
    room *= 2;
  }
  if (std::ferror(file.get()) != 0) throw fail(std::strerror(errno));
  bytes.resize(used);
  return bytes;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view take_word(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_blank(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

std::optional<double> to_number(std::string_view word) {
  if (word.starts_with('+')) {
    word.remove_prefix(1);
    if (word.starts_with('-')) return std::nullopt;
  }
  const bool is_negative = word.starts_with('-');
  // Not the words inf and nan.
  const std::size_t first = is_negative ? 1 : 0;
  if (word.size() <= first || !(is_digit(word[first]) || word[first] == '.')) return std::nullopt;
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    if (!is_tiny(word.substr(first))) return std::nullopt;
    return is_negative ? -0.0 : 0.0;
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t length_max = 80;
  std::string out = "\"";
  for (const char letter : text.substr(0, length_max)) {
    const auto code = static_cast<unsigned char>(letter);
    out += code < 0x20 || code == 0x7f ? '?' : letter;
  }
  return out + (text.size() > length_max ? "...\"" : "\"");
}

}  // namespace bitspan
