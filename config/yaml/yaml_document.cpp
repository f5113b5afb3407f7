// The only user of yaml-cpp. Its events show duplicate keys, and aliases before they expand. Its
// exceptions do not leave this file.
#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <optional>
#include <sstream>
#include <unordered_map>
#include <unordered_set>

#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/yaml/yaml_error.hpp"
#include "config/yaml/yaml_scan.hpp"

namespace fieldcast::config {
namespace {

struct Abandoned {};  // thrown after a fault that ends the parsing

void add(FaultList& faults, const YamlError& error) {
  faults.add(error.position, error.what, error.allowed, error.suggestion);
}

class Builder final : public YAML::EventHandler {
 public:
  Builder(Document& document, FaultList& faults) : document_(document), faults_(faults) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ == 1) return;
    add(faults_, explain_second_document(document_.source, position(mark)));
    throw Abandoned{};
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node& node = make(Kind::kNull, mark);
    // An absent value has no position.
    if (!open_.empty() && open_.back().key != nullptr) node.position = open_.back().key->position;
    finish(node, anchor, 1);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) abandon(position(mark), "an alias stands inside its own anchor");
    count(found->second.weight, position(mark));
    attach(*found->second.node, found->second.weight);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    check_tag(mark, tag);
    Node& node = make(Kind::kScalar, mark);
    node.quoted = tag == "!";
    if (node.quoted) last_quote_ = node.position;
    node.text = value;
    finish(node, anchor, 1);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(make(Kind::kList, mark), anchor);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(make(Kind::kMap, mark), anchor);
  }
  void OnMapEnd() override { close(); }

  // The parser accepts the end of the text as a closing quote. Only the last quote can be open.
  void check_last_quote() {
    if (!last_quote_) return;
    const auto quote = quote_at(document_.source, *last_quote_);
    if (!quote || quote->closed) return;
    add(faults_, explain_yaml_error(document_.source, quote->end, "illegal EOF in scalar"));
    throw Abandoned{};
  }

 private:
  struct Open {
    Node* node;
    YAML::anchor_t anchor;
    std::size_t weight = 1;                     // nodes inside, with aliases expanded
    const Node* key = nullptr;                  // of a map: a key without its value so far
    std::unordered_set<std::string_view> keys;  // of a map
  };
  struct Anchored {
    const Node* node;
    std::size_t weight;
  };

  [[nodiscard]] Position position(const YAML::Mark& mark) const {
    return {&document_.source, static_cast<std::uint32_t>(mark.line < 0 ? 0 : mark.line),
            static_cast<std::uint32_t>(mark.column < 0 ? 0 : mark.column)};
  }

  [[noreturn]] void abandon(const Position& at, std::string what, std::string allowed = {}) {
    faults_.add(at, std::move(what), std::move(allowed));
    throw Abandoned{};
  }

  void check_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!")
      faults_.add(position(mark), fmt::format("tag '{}'", tag), "no tags");
  }

  void count(std::size_t nodes, const Position& at) {
    nodes_ += nodes;
    if (nodes_ > kMaxNodes)
      abandon(at, "the file holds too many values",
              fmt::format("{}, with what aliases repeat", kMaxNodes));
  }

  Node& make(Kind kind, const YAML::Mark& mark) {
    count(1, position(mark));
    Node& node = document_.nodes.emplace_back();
    node.kind = kind;
    node.position = position(mark);
    return node;
  }

  void open(Node& node, YAML::anchor_t anchor) {
    if (open_.size() == kMaxNesting)
      abandon(node.position, "too deep nesting", fmt::format("{} levels", kMaxNesting));
    if (++collections_ > kMaxCollections)
      abandon(node.position, "the file holds too many maps and lists",
              fmt::format("{}; long channel lists belong in CSV files", kMaxCollections));
    open_.push_back(Open{&node, anchor, 1, nullptr, {}});
  }

  void close() {
    const Open done = std::move(open_.back());
    open_.pop_back();
    finish(*done.node, done.anchor, done.weight);
  }

  void finish(const Node& node, YAML::anchor_t anchor, std::size_t weight) {
    if (anchor != 0) anchors_[anchor] = {&node, weight};
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
  FaultList& faults_;
  std::vector<Open> open_;
  std::unordered_map<YAML::anchor_t, Anchored> anchors_;
  std::optional<Position> last_quote_;
  std::size_t nodes_ = 0, collections_ = 0;
  unsigned documents_ = 0;
};

}  // namespace

std::unique_ptr<Document> parse_yaml(Source source, FaultList& faults) {
  auto document = std::make_unique<Document>();
  document->source = std::move(source);
  if (!check_text(document->source, faults) || !check_tokens(document->source, faults))
    return document;
  try {
    std::istringstream stream(document->source.text);
    YAML::Parser parser(stream);
    Builder builder(*document, faults);
    while (parser.HandleNextDocument(builder)) {}
    builder.check_last_quote();
  } catch (const YAML::Exception& fault) {
    document->root = nullptr;
    document->nodes.clear();  // the explanation needs memory
    Position stopped{&document->source, 0, 0};
    if (!fault.mark.is_null()) {
      stopped.line = static_cast<std::uint32_t>(fault.mark.line);
      stopped.column = static_cast<std::uint32_t>(fault.mark.column);
    }
    add(faults, explain_yaml_error(document->source, stopped, fault.msg));
  } catch (const Abandoned&) { document->root = nullptr; }
  return document;
}

}  // namespace fieldcast::config
