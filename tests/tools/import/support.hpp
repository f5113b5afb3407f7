#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tools/import/importer.hpp"

namespace fieldcast::importing {

inline tl::expected<Outcome, std::string> import_text(const std::string& file,
                                                      const std::string& text,
                                                      const ImportOptions& options = {}) {
  return run_import({{file, text}}, options);
}

inline std::string channel_line(const Outcome& outcome, const std::string& name) {
  for (const WrittenFile& file : outcome.files) {
    const std::string begin = "- { name: " + name + ",";
    const std::size_t at = file.text.find(begin);
    if (at == std::string::npos) continue;
    return file.text.substr(at + 2, file.text.find('\n', at) - at - 2);
  }
  return {};
}

// Returns "ok", the changes, or "no: " and the reason.
inline std::string fate_of(const Outcome& outcome, const std::string& name) {
  const auto row = std::ranges::find(outcome.rows, name, &PointFate::name);
  if (row == outcome.rows.end()) return "not in the list";
  if (row->fate == Fate::kRefused) return "no: " + row->words;
  return row->words.empty() ? "ok" : row->words;
}

}  // namespace fieldcast::importing
