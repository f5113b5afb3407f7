#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/text_cases.hpp"
#include "tools/import/importer.hpp"

namespace fieldcast::importing {

inline tl::expected<Outcome, std::string> import_text(const std::string& file,
                                                      const std::string& text,
                                                      const ImportOptions& options = {}) {
  return run_import({{file, text}}, options);
}

// Returns an empty outcome, and fails the test, if the import reports a fault.
inline Outcome imported_files(const std::vector<InputFile>& files,
                              const ImportOptions& options = {}) {
  auto outcome = run_import(files, options);
  if (outcome) return std::move(*outcome);
  ADD_FAILURE() << outcome.error();
  return {};
}

inline Outcome imported(const std::string& file, const std::string& text,
                        const ImportOptions& options = {}) {
  return imported_files({{file, text}}, options);
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

// Each case is "NAME -> PART": the channel line, or the fate, of the point NAME contains PART.
using Parts = std::initializer_list<std::string_view>;

inline void expect_channels(const Outcome& outcome, Parts cases) {
  for (const auto text : cases) {
    const auto [name, part] = test::text_case(text);
    EXPECT_THAT(channel_line(outcome, name), testing::HasSubstr(part)) << name;
  }
}

inline void expect_fates(const Outcome& outcome, Parts cases) {
  for (const auto text : cases) {
    const auto [name, part] = test::text_case(text);
    EXPECT_THAT(fate_of(outcome, name), testing::HasSubstr(part)) << name;
  }
}

}  // namespace fieldcast::importing
