// The only user of libyaml. Its events show duplicate keys, and aliases before they expand.
#include <fmt/format.h>
#include <yaml.h>

#include <algorithm>
#include <new>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/yaml/yaml_error.hpp"

namespace fieldcast::config {
namespace {

constexpr auto kNone = std::string_view::npos;

struct Abandoned {};  // thrown after a fault that ends the parsing

void add(FaultList& faults, const YamlError& error) {
  faults.add(error.position, error.what, error.allowed, error.suggestion);
}

std::string_view text_of(const yaml_char_t* text) {
  return text == nullptr ? std::string_view{} : reinterpret_cast<const char*>(text);
}

// The library counts columns in characters, a Position in bytes. Marks ascend, so that each line is
// walked once.
class Marks {
 public:
  explicit Marks(const Source& source)
      : source_(source),
        ascii_(std::ranges::all_of(source.text, [](char c) { return (c & 0x80) == 0; })) {}

  [[nodiscard]] Position position(const yaml_mark_t& mark) {
    const auto line = static_cast<std::uint32_t>(mark.line);
    if (ascii_) return {&source_, line, static_cast<std::uint32_t>(mark.column)};
    if (line != line_ || mark.column < characters_) {
      line_ = line;
      characters_ = bytes_ = 0;
    }
    const std::string_view text = source_.line(line);
    for (; characters_ < mark.column && bytes_ < text.size(); ++characters_) {
      do ++bytes_;
      while (bytes_ < text.size() && (static_cast<unsigned char>(text[bytes_]) & 0xC0) == 0x80);
    }
    return {&source_, line, static_cast<std::uint32_t>(bytes_)};
  }
  [[nodiscard]] Position position(std::size_t offset) const {
    const std::string_view before = std::string_view(source_.text).substr(0, offset);
    const auto begin = before.rfind('\n') + 1;  // 0 if there is none
    return {&source_, static_cast<std::uint32_t>(std::ranges::count(before, '\n')),
            static_cast<std::uint32_t>(before.size() - begin)};
  }

 private:
  const Source& source_;
  const bool ascii_;
  std::uint32_t line_ = 0;
  std::size_t characters_ = 0, bytes_ = 0;  // of the line
};

class Builder {
 public:
  Builder(Document& document, Marks& marks, FaultList& faults)
      : document_(document), marks_(marks), faults_(faults) {}

  void take(const yaml_event_t& event) {
    const Position at = marks_.position(event.start_mark);
    switch (event.type) {
      case YAML_DOCUMENT_START_EVENT:
        if (++documents_ == 1) return;
        add(faults_, explain_second_document(document_.source, at));
        throw Abandoned{};
      case YAML_ALIAS_EVENT: return take_alias(text_of(event.data.alias.anchor), at);
      case YAML_SCALAR_EVENT: return take_scalar(event.data.scalar, at);
      case YAML_SEQUENCE_START_EVENT:
        check_tag(text_of(event.data.sequence_start.tag), at);
        return open(make(Kind::kList, at), text_of(event.data.sequence_start.anchor));
      case YAML_MAPPING_START_EVENT:
        check_tag(text_of(event.data.mapping_start.tag), at);
        return open(make(Kind::kMap, at), text_of(event.data.mapping_start.anchor));
      case YAML_SEQUENCE_END_EVENT:
      case YAML_MAPPING_END_EVENT: return close();
      default: return;
    }
  }

 private:
  struct Open {
    Node* node;
    std::string anchor;                         // empty: none
    std::size_t weight = 1;                     // nodes inside, with aliases expanded
    const Node* key = nullptr;                  // of a map: a key without its value so far
    std::unordered_set<std::string_view> keys;  // of a map
  };
  struct Anchored {
    const Node* node;
    std::size_t weight;
  };

  [[noreturn]] void abandon(const Position& at, std::string_view what,
                            std::string_view allowed = {}) {
    faults_.add(at, what, allowed);
    throw Abandoned{};
  }

  void take_alias(std::string_view name, const Position& at) {
    const auto found = anchors_.find(std::string(name));
    if (found != anchors_.end()) {
      count(found->second.weight, at);
      return attach(*found->second.node, found->second.weight);
    }
    if (std::ranges::any_of(open_, [&](const Open& open) { return open.anchor == name; }))
      abandon(at, "an alias stands inside its own anchor");
    abandon(at, "no value above has the name of this alias",
            "&NAME at a value above, or the text in quotes");
  }

  void take_scalar(const auto& scalar, const Position& at) {
    const std::string_view tag = text_of(scalar.tag);
    check_tag(tag, at);
    const std::string_view text{reinterpret_cast<const char*>(scalar.value), scalar.length};
    const bool quoted = scalar.style != YAML_PLAIN_SCALAR_STYLE || tag == "!";
    Node& node = make(!quoted && tag.empty() && is_null(text) ? Kind::kNull : Kind::kScalar, at);
    if (node.kind == Kind::kScalar) {
      node.quoted = quoted;
      node.text = text;
    } else if (!open_.empty() && open_.back().key != nullptr) {
      node.position = open_.back().key->position;  // an absent value has no position
    }
    finish(node, text_of(scalar.anchor), 1);
  }

  // YAML 1.2, 10.3.2.
  static bool is_null(std::string_view text) {
    return text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL";
  }

  void check_tag(std::string_view tag, const Position& at) {
    if (!tag.empty() && tag != "!") faults_.add(at, fmt::format("tag '{}'", tag), "no tags");
  }

  void count(std::size_t nodes, const Position& at) {
    nodes_ += nodes;
    if (nodes_ > kMaxNodes)
      abandon(at, "the file holds too many values",
              fmt::format("{}, with what aliases repeat", kMaxNodes));
  }

  Node& make(Kind kind, const Position& at) {
    count(1, at);
    Node& node = document_.nodes.emplace_back();
    node.kind = kind;
    node.position = at;
    return node;
  }

  void open(Node& node, std::string_view anchor) {
    if (open_.size() == kMaxNesting)
      abandon(node.position, "too deep nesting", fmt::format("{} levels", kMaxNesting));
    if (++collections_ > kMaxCollections)
      abandon(node.position, "the file holds too many maps and lists",
              fmt::format("{}; long channel lists belong in CSV files", kMaxCollections));
    open_.push_back(Open{&node, std::string(anchor), 1, nullptr, {}});
  }

  void close() {
    const Open done = std::move(open_.back());
    open_.pop_back();
    finish(*done.node, done.anchor, done.weight);
  }

  void finish(const Node& node, std::string_view anchor, std::size_t weight) {
    if (!anchor.empty()) anchors_[std::string(anchor)] = {&node, weight};
    attach(node, weight);
  }

  void attach(const Node& node, std::size_t weight) {
    if (open_.empty()) {
      document_.root = &node;
      return;
    }
    Open& around = open_.back();
    around.weight += weight;
    if (around.node->kind == Kind::kList) {
      around.node->items.push_back(&node);
    } else if (around.key == nullptr) {
      around.key = &node;
    } else {
      add_entry(around, *around.key, node);
      around.key = nullptr;
    }
  }

  void add_entry(Open& map, const Node& key, const Node& value) {
    if (key.kind != Kind::kScalar) {
      faults_.add(key.position, fmt::format("a key is {}", to_text(key.kind)), "a word");
    } else if (map.keys.size() == kMaxKeys) {
      abandon(key.position, "the map has too many keys", std::to_string(kMaxKeys));
    } else if (!map.keys.insert(key.text).second) {
      faults_.add(key.position, fmt::format("key '{}' stands twice", key.text), "each key once");
    } else {
      map.node->entries.push_back({&key, &value});
    }
  }

  Document& document_;
  Marks& marks_;
  FaultList& faults_;
  std::vector<Open> open_;
  std::unordered_map<std::string, Anchored> anchors_;
  std::size_t nodes_ = 0, collections_ = 0;
  unsigned documents_ = 0;
};

// The library takes these for the end of a line, or refuses them.
std::string_view replacement(std::string_view text) {
  if (text[0] == '\r') return text.starts_with("\r\n") ? "" : " ";
  if (text.size() > 1 && text[0] == '\xC2' && (text[1] & 0xE0) == 0x80)  // U+0080 to U+009F
    return "\u00A0";
  if (text.starts_with("\u2028") || text.starts_with("\u2029")) return "\u202F";
  if (text.starts_with("\uFFFE") || text.starts_with("\uFFFF")) return "\uFFFD";
  return "";
}

// Returns the end of the blanks of a line in which YAML allows tabs and the library refuses them:
// before a comment, the end of brackets or nothing, and behind the '-' of an item.
std::size_t end_of_blanks(std::string_view line) {
  const auto content = std::min(line.find_first_not_of(" \t"), line.size());
  if (content == line.size() || std::string_view("\r#,]}").find(line[content]) != kNone)
    return content;
  const std::string_view before = line.substr(0, content), item = line.substr(content, 2);
  const bool is_item = (item == "- " || item == "-\t") && before.find('\t') == kNone;
  return is_item ? std::min(line.find_first_not_of("- \t", content), line.size()) : 0;
}

// First bytes of all that readable() replaces.
constexpr std::string_view kReplaced = "\t\r\xC2\xE2\xEF";

// The text for the library, with the same lines and columns.
std::string readable(std::string text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto character = replacement(std::string_view(text).substr(at));
    text.replace(at, character.size(), character);
  }
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const auto line = text.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto blanks = end_of_blanks(std::string_view(text).substr(begin, end - begin));
    std::replace(line, line + static_cast<std::ptrdiff_t>(blanks), '\t', ' ');
    begin = end + 1;
  }
  return text;
}

class Parser {
 public:
  // `source` must outlive this object.
  explicit Parser(const std::string& source)
      : copy_(source.find_first_of(kReplaced) == kNone ? "" : readable(source)) {
    if (yaml_parser_initialize(&parser_) == 0) throw std::bad_alloc();
    yaml_parser_set_encoding(&parser_, YAML_UTF8_ENCODING);
    const std::string& text = copy_.empty() ? source : copy_;
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const yaml_char_t*>(text.data()),
                                 text.size());
  }
  ~Parser() {
    yaml_event_delete(&event_);
    yaml_parser_delete(&parser_);
  }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  // Valid until the next call. Null after an error.
  [[nodiscard]] const yaml_event_t* next() {
    yaml_event_delete(&event_);
    return yaml_parser_parse(&parser_, &event_) == 0 ? nullptr : &event_;
  }
  [[nodiscard]] YamlProblem problem(Marks& marks) const {
    if (parser_.error == YAML_MEMORY_ERROR) throw std::bad_alloc();
    if (parser_.error == YAML_READER_ERROR) {  // has no mark
      const Position at = marks.position(parser_.problem_offset);
      return {at, parser_.problem, at, ""};
    }
    return {marks.position(parser_.problem_mark), parser_.problem,
            marks.position(parser_.context_mark),
            parser_.context == nullptr ? "" : parser_.context};
  }

 private:
  const std::string copy_;  // empty if the source needs no replacement
  yaml_parser_t parser_{};
  yaml_event_t event_{};
};

}  // namespace

std::unique_ptr<Document> parse_yaml(Source source, FaultList& faults) {
  auto document = std::make_unique<Document>();
  document->source = std::move(source);
  if (!check_text(document->source, faults)) return document;
  if (std::ranges::count(document->source.text, '\n') > static_cast<std::ptrdiff_t>(kMaxLines)) {
    faults.add({&document->source, kMaxLines, 0}, "the file holds too many lines",
               fmt::format("{}; long channel lists belong in CSV files", kMaxLines));
    return document;
  }
  Marks marks(document->source);
  Parser parser(document->source.text);
  try {
    Builder builder(*document, marks, faults);
    const yaml_event_t* event = parser.next();
    for (; event != nullptr && event->type != YAML_STREAM_END_EVENT; event = parser.next())
      builder.take(*event);
    if (event != nullptr) return document;
    document->root = nullptr;
    document->nodes.clear();  // the explanation needs memory
    add(faults, explain_yaml_error(document->source, parser.problem(marks)));
  } catch (const Abandoned&) { document->root = nullptr; }
  return document;
}

}  // namespace fieldcast::config
