// SPDX-License-Identifier: Apache-2.0
// Plain text tables for a terminal.
#pragma once

#include <string>
#include <vector>

namespace bitspan {

// The first row is the header, ruled off; columns that hold numbers below it are set right. No trailing
// blanks.
std::string text_table(const std::vector<std::vector<std::string>>& rows);
// The same as an HTML table, its texts escaped.
std::string html_table(const std::vector<std::vector<std::string>>& rows);
// The same as a Markdown table.
std::string markdown_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace bitspan
