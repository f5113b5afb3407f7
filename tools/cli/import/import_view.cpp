#include "tools/cli/import/import_view.hpp"

#include <fmt/format.h>

namespace fieldcast::cli {
namespace {

using importing::Fate;
using importing::PointFate;

std::string one_line(std::string_view text) {
  std::string line = printable(text);
  for (char& c : line) {
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  }
  return line;
}

Cell fate_cell(const PointFate& row) {
  switch (row.fate) {
    case Fate::kMoved: return {"moved", Tone::kGood};
    case Fate::kChanged: return {"moved, but: " + one_line(row.words), Tone::kWarning};
    case Fate::kRefused: return {"not moved: " + one_line(row.words), Tone::kBad};
  }
  return {};
}

}  // namespace

std::vector<std::string> import_lines(const importing::Outcome& outcome, bool all,
                                      const Screen& screen) {
  TextTable table({{"WHERE"}, {"NAME"}, {"CHANNEL"}, {"AT"}, {"TYPE"}, {"WITH"}, {"MOVED?"}});
  const bool files = outcome.recognised.size() > 1;
  std::size_t moved = 0;
  for (const PointFate& row : outcome.rows) {
    if (row.fate == Fate::kMoved && ++moved > kMovedShown && !all) continue;
    std::string where = files ? fmt::format("{}:{}", one_line(row.origin.file), row.origin.line)
                              : fmt::format("line {}", row.origin.line);
    if (row.origin.column > 0) where += fmt::format(":{}", row.origin.column);
    table.add_row({{where, Tone::kFaint},
                   {clip(one_line(row.name), 40)},
                   {row.channel},
                   {row.at},
                   {row.type},
                   {importing::settings_of(row)},
                   fate_cell(row)});
  }
  std::vector<std::string> lines =
      table.rows() == 0 ? std::vector<std::string>{} : table.render(screen);
  if (moved > kMovedShown && !all)
    lines.push_back(
        fmt::format("{} more moved as they are; --all shows them", moved - kMovedShown));
  return lines;
}

std::string import_summary(const importing::Outcome& outcome) {
  return fmt::format("{} moved, {} moved with a change, {} cannot be moved",
                     outcome.count(Fate::kMoved), outcome.count(Fate::kChanged),
                     outcome.count(Fate::kRefused));
}

Json fate_json(const PointFate& row) {
  constexpr const char* kFates[] = {"moved", "changed", "refused"};
  Json json = {{"fate", kFates[static_cast<std::size_t>(row.fate)]},
               {"name", row.name},
               {"channel", row.channel},
               {"at", row.at},
               {"type", row.type},
               {"why", row.words},
               {"file", row.origin.file},
               {"line", row.origin.line}};
  if (row.origin.column > 0) json.add("column", row.origin.column);
  if (row.fate == Fate::kRefused) return json;
  const auto order = [](bool little) { return little ? "little-endian" : "big-endian"; };
  json.add("scale", row.scale);
  json.add("offset", row.offset);
  json.add("word_order", order(row.word_order == WordOrder::kLittleEndian));
  json.add("byte_order", order(row.byte_order == ByteOrder::kLittleEndian));
  json.add("access", to_text(row.access));
  return json;
}

}  // namespace fieldcast::cli
