// Registry of import formats, and what several formats read. A reader is pure and throws no
// exception for any input.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "tools/import/points/model.hpp"
#include "tools/import/points/names.hpp"
#include "tools/import/text/text.hpp"
#include "tools/import/text/tree.hpp"

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
  [[nodiscard]] bool is_modbus() const {
    return protocol.empty() || protocol.starts_with("modbus");
  }
};

using Read = Result<Found>;
using Sources = std::span<const SourceText>;

// 0 (not this format) to 100.
using Confidence = unsigned;
inline constexpr Confidence kCertain = 100, kLikely = 70, kGuess = 40;

struct Format {
  std::string_view name;   // "kepware", for --from
  std::string_view title;  // "Kepware tag export (CSV)"
  Confidence (*recognise)(const SourceText& source) = nullptr;
  // Reads related files. The error is one line with the file: nothing can be read.
  Read (*read)(Sources sources, const ReadOptions& options) = nullptr;
  std::string_view base;  // first address number of the format; empty: --base may set it
};

[[nodiscard]] std::span<const Format> formats();
[[nodiscard]] const Format* format_by_name(std::string_view name);

struct Recognised {
  const Format* format = nullptr;  // null: unknown format
  Confidence confidence = 0;
};
[[nodiscard]] Recognised recognise(const SourceText& source);

[[nodiscard]] std::string_view to_text_of(Confidence confidence);

// "plant/meter 1.csv" gives "meter 1".
[[nodiscard]] std::string stem_of(std::string_view path);

struct Sign {
  std::string_view words;
  Confidence confidence;
};
// The confidence of the first sign whose words (separated by blanks) are all in the text, or 0.
[[nodiscard]] Confidence confidence_by(std::string_view text, std::initializer_list<Sign> signs);

template <typename ReadSource>
[[nodiscard]] Read read_each(Sources sources, ReadSource read) {
  Found found;
  for (const SourceText& source : sources) {
    if (const MayFail fault = read(source, found)) return refused("{}: {}", source.file, *fault);
  }
  return found;
}
template <typename ReadTree>
[[nodiscard]] Read read_each_tree(Sources sources, Tree (*parse)(std::string_view), ReadTree read) {
  return read_each(sources, [&](const SourceText& source, Found& found) -> MayFail {
    const Tree tree = parse(source.text);
    return tree ? read(source, *(*tree)->root, found) : MayFail(tree.error());
  });
}

inline constexpr const char* kSparseText = "a text with one character in each register";
inline constexpr const char* kTruthNotNumber = "true and false instead of 1 and 0";
inline constexpr const char* kTextLength = "a text without a length of 1 to 125 registers";

// The device with this address, which is added if the bus has none.
[[nodiscard]] Device& device_at(Bus& bus, std::uint16_t address);

struct LineKeys {
  std::string_view baud, data_bits, parity, stop_bits;
  char usual_parity = 'N';
};
[[nodiscard]] Line line_at(const Node& map, const LineKeys& keys);
// "HOST:PORT"; 502 without a port.
[[nodiscard]] std::string tcp_at(const Node& map, std::string_view host, std::string_view port);

// Reports what a reader of a tree does not move. REQUIRES: the tree outlives it.
class TreeReader {
 public:
  TreeReader(const SourceText& source, Found& found) : source_(source), found_(found) {}

 protected:
  [[nodiscard]] Origin origin_of(const Node& node) const { return {source_.file, line_of(node)}; }
  void refuse(const Node& node, std::string_view name, std::string reason) {
    found_.refuse(name, origin_of(node), std::move(reason));
  }
  void tell_others() const { other_keys_.tell(source_.file, found_); }

  const SourceText& source_;
  Found& found_;
  OtherKeys other_keys_;
};

extern const Format kKepwareFormat, kTelegrafFormat, kMqmgatewayFormat, kEpicsFormat, kWbFormat,
    kNeuronFormat, kModbusListFormat;

}  // namespace fieldcast::importing
