// SPDX-License-Identifier: Apache-2.0
#include "report/table.hpp"

#include <algorithm>
#include <cstddef>

#include "report/junit.hpp"

namespace bitspan {
namespace {

bool is_number(const std::string& text) {
  return text.empty() || text == "-" ||
         (text.find_first_of("0123456789") != std::string::npos &&
          text.find_first_not_of("0123456789.+-e%inf ") == std::string::npos);
}

std::vector<bool> number_columns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<bool> out;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    out.resize(std::max(out.size(), rows[r].size()), true);
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      out[c] = out[c] && is_number(rows[r][c]);
    }
  }
  return out;
}

}  // namespace

std::string text_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<bool> right = number_columns(rows);
  std::vector<std::size_t> width;
  for (const auto& row : rows) {
    width.resize(std::max(width.size(), row.size()), 0);
    for (std::size_t c = 0; c < row.size(); ++c) {
      width[c] = std::max(width[c], row[c].size());
    }
  }
  right.resize(width.size(), false);
  std::string out;
  const auto line = [&](const std::vector<std::string>& row) {
    std::string text;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(width[c] - row[c].size(), ' ');
      text += (c == 0 ? "" : "  ") + (right[c] ? pad + row[c] : row[c] + pad);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    line(rows[r]);
    if (r == 0) {
      std::vector<std::string> rule;
      rule.reserve(width.size());
      for (const std::size_t w : width) {
        rule.emplace_back(w, '-');
      }
      line(rule);
    }
  }
  return out;
}

std::string html_table(const std::vector<std::vector<std::string>>& rows) {
  const std::vector<bool> right = number_columns(rows);
  std::string out = "<table>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::string tag = r == 0 ? "th" : "td";
    out += "<tr>";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const bool number = c < right.size() && right[c];
      out += "<" + tag + (number ? " class=\"n\">" : ">") + xml_escape(rows[r][c]) + "</" + tag + ">";
    }
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

std::string markdown_table(const std::vector<std::vector<std::string>>& rows) {
  const std::vector<bool> right = number_columns(rows);
  std::string out;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out += "|";
    for (const std::string& cell : rows[r]) {
      out += " " + cell + " |";
    }
    out += "\n";
    if (r == 0) {
      out += "|";
      for (std::size_t c = 0; c < rows[0].size(); ++c) {
        out += c < right.size() && right[c] ? "---:|" : "---|";
      }
      out += "\n";
    }
  }
  return out;
}

}  // namespace bitspan
