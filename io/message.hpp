// SPDX-License-Identifier: Apache-2.0
// What a program says on standard error.
#pragma once

#include <string_view>

namespace bitspan {

// Where nobody can be told (a full or closed standard error, a pipe without reader), nothing happens: the
// exit code says it all the same.
void say(std::string_view text) noexcept;

// Gives the standard streams that the caller closed a place where reading and writing fail. Else the next
// file that is opened takes theirs, and the report goes into a picture. To be called first.
void open_standard_streams() noexcept;

}  // namespace bitspan
