// A channel list as comma-separated values (RFC 4180). Tolerates files of spreadsheets: byte order
// mark, CRLF, ';' or tab instead of ',' (as in the header row), blank lines, and lines that begin
// with '#'. Each row becomes the map of a channel as in YAML, so that channel.cpp reads both.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/document/map_reader.hpp"
#include "config/document/suggest.hpp"

namespace fieldcast::config {
namespace {

struct Cell {
  std::string text;
  Position position;
};
using Row = std::vector<Cell>;

constexpr std::size_t kMaxCells = 64;  // of a row; the format has 24 columns

class RowReader {
 public:
  RowReader(const Source& source, FaultList& faults)
      : source_(source), text_(source.text), faults_(faults) {}

  // Skips blank rows; empty at the end, or after a fault that invalidates the rest.
  std::optional<Row> next() {
    while (at_ < text_.size()) {
      if (text_[at_] == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
        end_line();
        continue;
      }
      if (separator_ == '\0') separator_ = separator_of(text_.substr(at_));
      Row row;
      if (!read_row(row)) return std::nullopt;
      if (std::ranges::any_of(row, [](const Cell& cell) { return !cell.text.empty(); })) return row;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] Position here() const {
    return {&source_, line_, static_cast<std::uint32_t>(at_ - line_start_)};
  }

  void end_line() {
    if (at_ < text_.size()) ++at_;
    ++line_;
    line_start_ = at_;
  }

  // The first line that is not blank determines it; a line of one column uses ','.
  static char separator_of(std::string_view text) {
    const auto found = text.find_first_of(",;\t\n");
    if (found == std::string_view::npos) return ',';
    return text[found] == '\n' ? (found > 1 ? ',' : '\0') : text[found];
  }

  bool read_row(Row& row) {
    for (;;) {
      if (row.size() == kMaxCells) {
        faults_.add(here(), "a row has too many cells", std::to_string(kMaxCells));
        return false;
      }
      Cell cell{{}, here()};
      if (!(at_ < text_.size() && text_[at_] == '"' ? read_quoted(cell) : read_plain(cell)))
        return false;
      row.push_back(std::move(cell));
      if (at_ < text_.size() && text_[at_] == separator_) {
        ++at_;
        continue;
      }
      if (at_ < text_.size() && text_[at_] == '\r') ++at_;
      end_line();
      return true;
    }
  }

  bool read_plain(Cell& cell) {
    const auto end =
        std::min(text_.find_first_of(std::string{separator_, '\n'}, at_), text_.size());
    std::string_view text = text_.substr(at_, end - at_);
    at_ = end;
    if (text.ends_with('\r')) text.remove_suffix(1);
    while (text.starts_with(' ')) text.remove_prefix(1), ++cell.position.column;
    while (text.ends_with(' ')) text.remove_suffix(1);
    cell.text = text;
    return true;
  }

  bool read_quoted(Cell& cell) {
    const Position start = here();
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
          ++at_;
        } else {
          ++at_;
          return after_quote();
        }
      } else if (text_[at_] == '\n') {
        ++line_;
        line_start_ = at_ + 1;
      }
      cell.text += text_[at_];
    }
    faults_.add(start, "a quoted cell has no end", "a closing '\"'");
    return false;
  }

  bool after_quote() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    if (at_ == text_.size() || text_[at_] == separator_ || text_[at_] == '\n' ||
        text_.substr(at_).starts_with("\r\n"))
      return true;
    faults_.add(
        here(), "text after a quoted cell",
        fmt::format("'{}' or the end of the line; a quote inside is written \"\"", separator_));
    return false;
  }

  const Source& source_;
  std::string_view text_;
  FaultList& faults_;
  char separator_ = '\0';  // unknown
  std::size_t at_ = 0, line_start_ = 0;
  std::uint32_t line_ = 0;
};

// Null for an unknown column. Empty without the required columns name and at.
std::vector<const Column*> read_header(const Row& row, FaultList& faults) {
  std::vector<std::string_view> names;
  for (const auto& column : columns()) names.push_back(column.name);
  std::vector<const Column*> header;
  for (const auto& cell : row) {
    const auto found = std::ranges::find(columns(), cell.text, &Column::name);
    const Column* column = found == columns().end() ? nullptr : &*found;
    if (column == nullptr) {
      faults.add(cell.position, fmt::format("unknown column '{}'", cell.text), joined(names),
                 closest(cell.text, names));
    } else if (std::ranges::find(header, column) != header.end()) {
      faults.add(cell.position, fmt::format("column '{}' stands twice", cell.text),
                 "each column once");
    }
    header.push_back(column);
  }
  bool complete = true;
  for (const std::string_view needed : {"name", "at"}) {
    if (std::ranges::none_of(header, [&](const Column* column) {
          return column != nullptr && column->name == needed;
        })) {
      faults.add(row.front().position, fmt::format("column '{}' is missing", needed),
                 joined(names));
      complete = false;
    }
  }
  return complete ? header : std::vector<const Column*>{};
}

class ListBuilder {
 public:
  explicit ListBuilder(Document& document) : document_(document) {}

  Node& make(Kind kind, const Position& position, std::string text = {}) {
    Node& node = document_.nodes.emplace_back();
    node.kind = kind;
    node.position = position;
    node.text = std::move(text);
    return node;
  }

  const Node& channel(const std::vector<const Column*>& header, const Row& row) {
    Node& channel = make(Kind::kMap, row.front().position);
    std::map<std::string_view, Node*> inner;  // limits, write: created when a cell needs them
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Column* column = header[i];
      const Cell& cell = row[i];
      // An empty cell means an absent key.
      if (column == nullptr || cell.text.empty()) continue;
      Node* map = &channel;
      if (!column->map.empty()) {
        Node*& known = inner[column->map];
        if (known == nullptr) {
          known = &make(Kind::kMap, cell.position);
          add(channel, column->map, *known);
        }
        map = known;
      }
      add(*map, column->key, make(Kind::kScalar, cell.position, cell.text));
    }
    return channel;
  }

 private:
  void add(Node& map, std::string_view key, const Node& value) {
    map.entries.push_back({&make(Kind::kScalar, value.position, std::string(key)), &value});
  }

  Document& document_;
};

}  // namespace

std::unique_ptr<Document> parse_csv(Source source, FaultList& faults) {
  auto document = std::make_unique<Document>();
  document->source = std::move(source);
  if (!check_text(document->source, faults)) return document;
  const auto faults_before = faults.size();
  RowReader rows(document->source, faults);
  const auto first = rows.next();
  if (!first) {
    if (faults.size() == faults_before) {
      faults.add({&document->source, 0, 0}, "the channel list is empty",
                 "a header row such as name,at,type,refresh, then one row for each channel");
    }
    return document;
  }
  const auto header = read_header(*first, faults);
  if (header.empty()) return document;
  ListBuilder builder(*document);
  Node& list = builder.make(Kind::kList, first->front().position);
  while (const auto row = rows.next()) {
    if (row->size() != header.size()) {
      faults.add(row->front().position, fmt::format("the row has {} cells", row->size()),
                 fmt::format("{}, as the header row", header.size()));
      continue;
    }
    if (list.items.size() == kMaxChannels) {
      faults.add(row->front().position, "too many channels", std::to_string(kMaxChannels));
      break;
    }
    list.items.push_back(&builder.channel(header, *row));
  }
  document->root = &list;
  return document;
}

}  // namespace fieldcast::config
