// SPDX-License-Identifier: Apache-2.0
// URIs as glTF files have them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bitspan {

// Whether the bytes stand in the URI itself: "data:...".
bool is_data_uri(std::string_view uri);
// Returns the bytes of a data URI in base64; none where it is another one or has an illegal digit.
std::optional<std::vector<std::uint8_t>> data_of_uri(std::string_view uri);
// Returns the path that a relative URI stands for: %20 is a space. None where an escape is not two
// hexadecimal digits, or stands for the byte 0.
std::optional<std::string> path_of_uri(std::string_view uri);

}  // namespace bitspan
