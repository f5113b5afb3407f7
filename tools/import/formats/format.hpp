// Registry of import formats. A reader is pure and throws no exception for any input.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "tools/import/points/model.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

struct SourceText {
  std::string file;  // path as given
  std::string text;  // UTF-8, lines end with '\n'
};

// Facts that are not in the list.
struct ReadOptions {
  std::optional<WordOrder> word_order;
  std::optional<unsigned> base;  // number of the first register: 0 or 1
  std::string protocol;          // "mitsubishi-fx"; empty: Modbus
};

// 0 (not this format) to 100.
using Confidence = unsigned;
inline constexpr Confidence kCertain = 100, kLikely = 70, kGuess = 40;

struct Format {
  std::string_view name;   // "kepware", for --from
  std::string_view title;  // "Kepware tag export (CSV)"
  Confidence (*recognise)(const SourceText& source) = nullptr;
  // Reads related files. The error is one line with the file: nothing can be read.
  tl::expected<Found, std::string> (*read)(std::span<const SourceText> sources,
                                           const ReadOptions& options) = nullptr;
  std::string_view base;  // first address number of the format; empty: --base may set it
};

[[nodiscard]] std::span<const Format> formats();
[[nodiscard]] const Format* format_by_name(std::string_view name);

struct Recognised {
  const Format* format = nullptr;  // null: unknown format
  Confidence confidence = 0;
};
[[nodiscard]] Recognised recognise(const SourceText& source);

// "certainly", "probably", "perhaps"
[[nodiscard]] std::string_view to_text_of(Confidence confidence);

// "plant/meter 1.csv" gives "meter 1".
[[nodiscard]] std::string stem_of(std::string_view path);

// Readers of all formats, each defined in the file of its name.

using Read = tl::expected<Found, std::string>;

[[nodiscard]] Confidence recognise_kepware(const SourceText& source);
[[nodiscard]] Read read_kepware(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_telegraf(const SourceText& source);
[[nodiscard]] Read read_telegraf(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_mqmgateway(const SourceText& source);
[[nodiscard]] Read read_mqmgateway(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_epics(const SourceText& source);
[[nodiscard]] Read read_epics(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_wb(const SourceText& source);
[[nodiscard]] Read read_wb(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_neuron(const SourceText& source);
[[nodiscard]] Read read_neuron(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_modbus_list(const SourceText& source);
[[nodiscard]] Read read_modbus_list(std::span<const SourceText> sources,
                                    const ReadOptions& options);

}  // namespace fieldcast::importing
