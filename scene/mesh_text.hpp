// SPDX-License-Identifier: Apache-2.0
// What the readers of meshes share: a whole file, words, numbers.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace bitspan {

// Returns the file's bytes. Throws InputError where it cannot be read; `expected` ends the message.
std::string read_whole(const std::string& path, std::string_view expected);

inline bool is_blank(char letter) { return letter == ' ' || (letter >= '\t' && letter <= '\r'); }

std::string_view trimmed(std::string_view text);
// Takes the first word off `text`; returns "" where there is none.
std::string_view take_word(std::string_view& text);

// Returns the nearest double of a decimal number, with an optional sign; nothing where the word is another
// one, or beyond the doubles.
std::optional<double> to_number(std::string_view word);

// Returns the text in quotes as a message shows it: on one line, and not at any length.
std::string in_quotes(std::string_view text);

}  // namespace bitspan
