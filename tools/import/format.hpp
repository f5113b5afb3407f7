// The formats that can be imported: one row for each in format.cpp. A reader is pure: texts in,
// points and refusals out; no exception leaves it, whatever the texts hold.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "tools/import/model.hpp"
#include "tools/import/text.hpp"

namespace fieldcast::importing {

// One file that was given, as text.
struct SourceText {
  std::string file;  // its path as given
  std::string text;  // UTF-8, lines ended by '\n'
};

// What the list itself does not say and the user may.
struct ReadOptions {
  std::optional<WordOrder> word_order;
  std::optional<unsigned> base;  // the number of the first register: 0 or 1
  std::string protocol;          // "mitsubishi-fx"; empty: a family of Modbus
};

// How sure it is that a text is of a format: 0 (it is not) to 100.
using Confidence = unsigned;
inline constexpr Confidence kCertain = 100, kLikely = 70, kGuess = 40;

struct Format {
  std::string_view name;   // "kepware", for --from
  std::string_view title;  // "Kepware tag export (CSV)"
  Confidence (*recognise)(const SourceText& source) = nullptr;
  // The files belong together. The error: they cannot be read at all, one line, with the file.
  tl::expected<Found, std::string> (*read)(std::span<const SourceText> sources,
                                           const ReadOptions& options) = nullptr;
  std::string_view base;  // from which number its addresses count; empty: --base may say it
};

[[nodiscard]] std::span<const Format> formats();
[[nodiscard]] const Format* format_by_name(std::string_view name);

struct Recognised {
  const Format* format = nullptr;  // nothing: of none
  Confidence confidence = 0;
};
[[nodiscard]] Recognised recognise(const SourceText& source);

// "certainly", "probably", "perhaps"
[[nodiscard]] std::string_view to_text_of(Confidence confidence);

// "plant/meter 1.csv" gives "meter 1".
[[nodiscard]] std::string stem_of(std::string_view path);

}  // namespace fieldcast::importing
