// The only place that knows yaml-cpp. Its events, not its nodes, are used: they tell duplicate keys apart, and aliases are
// counted before they can grow. Its exceptions end here.
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <sstream>
#include <unordered_map>
#include <unordered_set>

#include "config/document.hpp"
#include "config/fault_list.hpp"
#include "config/limits.hpp"

namespace fieldcast::config {
namespace {

struct Abandoned {};  // a fault that ends the parsing has been noted

class Builder final : public YAML::EventHandler {
 public:
  Builder(Document& document, FaultList& faults) : document_(document), faults_(faults) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) abandon(place(mark), "a second document begins", "one document in a file, no '---' after the first");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node& node = make(Kind::kNull, mark);
    if (!open_.empty() && open_.back().key != nullptr) node.place = open_.back().key->place;  // an absent value stands nowhere
    finish(node, anchor, 1);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) abandon(place(mark), "an alias stands inside its own anchor");
    count(found->second.weight, place(mark));
    attach(*found->second.node, found->second.weight);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
    check_tag(mark, tag);
    Node& node = make(Kind::kScalar, mark);
    node.quoted = tag == "!";
    node.text = value;
    finish(node, anchor, 1);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(make(Kind::kList, mark), anchor);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(make(Kind::kMap, mark), anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    Node* node;
    YAML::anchor_t anchor;
    std::size_t weight = 1;                     // nodes inside, aliases counted in full
    const Node* key = nullptr;                  // of a map: read, its value is still to come
    std::unordered_set<std::string_view> keys;  // of a map
  };
  struct Anchored {
    const Node* node;
    std::size_t weight;
  };

  [[nodiscard]] Place place(const YAML::Mark& mark) const {
    return {&document_.source, static_cast<std::uint32_t>(mark.line < 0 ? 0 : mark.line),
            static_cast<std::uint32_t>(mark.column < 0 ? 0 : mark.column)};
  }

  [[noreturn]] void abandon(const Place& at, std::string what, std::string allowed = {}) {
    faults_.add(at, std::move(what), std::move(allowed));
    throw Abandoned{};
  }

  void check_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!") faults_.add(place(mark), "tag '" + tag + "'", "no tags");
  }

  void count(std::size_t nodes, const Place& at) {
    nodes_ += nodes;
    if (nodes_ > kMaxNodes)
      abandon(at, "the file holds too many values", std::to_string(kMaxNodes) + ", with what aliases repeat");
  }

  Node& make(Kind kind, const YAML::Mark& mark) {
    count(1, place(mark));
    Node& node = document_.nodes.emplace_back();
    node.kind = kind;
    node.place = place(mark);
    return node;
  }

  void open(Node& node, YAML::anchor_t anchor) {
    if (open_.size() == kMaxNesting) abandon(node.place, "too deep nesting", std::to_string(kMaxNesting) + " levels");
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

  // Puts a finished node into the map or list around it.
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
      faults_.add(key.place, "a key is " + std::string(to_text(key.kind)), "a word");
    } else if (!map.keys.insert(key.text).second) {
      faults_.add(key.place, "key '" + key.text + "' stands twice", "each key once");
    } else {
      map.node->entries.push_back({&key, &value});
    }
  }

  Document& document_;
  FaultList& faults_;
  std::vector<Open> open_;
  std::unordered_map<YAML::anchor_t, Anchored> anchors_;
  std::size_t nodes_ = 0;
  unsigned documents_ = 0;
};

// What the parser's message does not say.
bool indented_with_tab(std::string_view text, std::uint32_t line) {
  std::size_t start = 0;
  for (; line > 0; --line) {
    start = text.find('\n', start);
    if (start++ == std::string_view::npos) return false;
  }
  const auto first = text.find_first_not_of(' ', start);
  return first != std::string_view::npos && text[first] == '\t';
}

// What would make the parser hold too much at once, wherever it stands.
bool check_tokens(const Source& source, FaultList& faults) {
  std::size_t brackets = 0, commas = 0;
  Place place{&source, 0, 0};
  for (const char c : source.text) {
    if (c == '[' || c == '{') ++brackets;
    if (c == ',') ++commas;
    if (brackets > kMaxBrackets || commas > kMaxCommas) {
      const std::string limit =
          brackets > kMaxBrackets ? std::to_string(kMaxBrackets) + " of [ and {" : std::to_string(kMaxCommas) + " commas";
      faults.add(place, "the file holds too many values", limit + "; long channel lists belong in CSV files");
      return false;
    }
    ++place.column;
    if (c == '\n') ++place.line, place.column = 0;
  }
  return true;
}

}  // namespace

std::unique_ptr<Document> parse_yaml(Source source, FaultList& faults) {
  auto document = std::make_unique<Document>();
  document->source = std::move(source);
  if (!check_text(document->source, faults) || !check_tokens(document->source, faults)) return document;
  try {
    std::istringstream stream(document->source.text);
    YAML::Parser parser(stream);
    Builder builder(*document, faults);
    while (parser.HandleNextDocument(builder)) {}
  } catch (const YAML::Exception& fault) {
    document->root = nullptr;
    Place place{&document->source, 0, 0};
    if (!fault.mark.is_null()) {
      place.line = static_cast<std::uint32_t>(fault.mark.line);
      place.column = static_cast<std::uint32_t>(fault.mark.column);
    }
    const bool tab = indented_with_tab(document->source.text, place.line);
    faults.add(place, "YAML: " + fault.msg, tab ? "spaces for indentation, no tabs" : "");
  } catch (const Abandoned&) { document->root = nullptr; }
  return document;
}

}  // namespace fieldcast::config
