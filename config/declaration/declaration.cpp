#include "config/declaration/declaration.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declared_frame.hpp"
#include "config/document/document.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "core/model/channel_kind.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

namespace {

using declared::Declaration;
using declared::DeclaredArea;
using declared::Notation;

constexpr std::size_t kMaxAreas = 64;
constexpr std::size_t kMaxCodes = 1'000;
constexpr std::size_t kMaxRounds = 8;
constexpr std::size_t kMaxRefusals = 8;
constexpr std::size_t kMaxForms = 16;
constexpr std::string_view kForm = "answer";
constexpr std::string_view kForms = "answers";
constexpr Duration kMinPause = std::chrono::milliseconds{1}, kMaxPause = std::chrono::seconds{1};
constexpr std::int64_t kMaxItems = 1 << 24;
constexpr std::int64_t kMaxOrigin = UINT32_MAX - kMaxItems;

constexpr std::pair<std::string_view, Notation> kEncodings[] = {{"binary", Notation::kBinary},
                                                                {"hex", Notation::kHex}};
constexpr std::pair<std::string_view, bool> kOrders[] = {{"big-endian", false},
                                                         {"little-endian", true}};
constexpr std::pair<std::string_view, bool> kBitOrders[] = {{"low-first", false},
                                                            {"high-first", true}};
constexpr std::pair<std::string_view, declared::Escape> kEscapes[] = {
    {"dle", declared::Escape::kDle},     {"slip", declared::Escape::kSlip},
    {"cobs", declared::Escape::kCobs},   {"hdlc", declared::Escape::kHdlc},
    {"shdlc", declared::Escape::kShdlc}, {"kmp", declared::Escape::kKmp}};
constexpr std::pair<std::string_view, declared::Block> kBlocks[] = {
    {"records", declared::Block::kRecords},
    {"tag-value", declared::Block::kTagValue},
    {"tag-length-value", declared::Block::kTagLengthValue}};
constexpr std::pair<std::string_view, std::uint8_t> kItems[] = {
    {"bit", 1}, {"byte", 8}, {"16bit", 16}, {"32bit", 32}, {"64bit", 64}};
constexpr std::pair<std::string_view, std::uint8_t> kBases[] = {
    {"octal", 8}, {"decimal", 10}, {"hexadecimal", 16}, {"channel", declared::kChannelBase}};

class DeclarationReader {
 public:
  DeclarationReader(const Node& root, const std::string& name, FaultList& faults)
      : map_(root, kDeclarationKeys, faults), faults_(faults) {
    declaration_.name = name;
  }

  Declaration run() {
    map_.read_required("summary", declaration_.summary, TextRule{kMaxDescription},
                       "one line for the user");
    read_addresses();
    map_.read("encoding", defaults_.notation, ChoiceRule<Notation>{kEncodings});
    map_.read("order", defaults_.little_endian, ChoiceRule<bool>{kOrders});
    map_.read("bit-order", defaults_.high_first, ChoiceRule<bool>{kBitOrders});
    map_.read("escape", defaults_.escape, ChoiceRule<declared::Escape>{kEscapes});
    map_.read("blocks", defaults_.block, ChoiceRule<declared::Block>{kBlocks});
    if (const Node* areas = list("areas", kMaxAreas)) {
      for (const Node* node : areas->items) read_area(*node);
    }
    if (const Node* operations = list("operations", declared::kMaxOperations)) {
      for (const Node* node : operations->items) read_operation(*node);
    }
    place_values(declaration_, operations_, faults_);
    for (const auto& draft : operations_) check_operation(declaration_, draft, faults_);
    if (const Node* login = map_.find("login")) declaration_.login = read_rounds(*login, "login");
    check_requests(operations_, declaration_.login, faults_);
    read_errors();
    check_areas();
    for (auto& draft : operations_) {
      draft.operation.request = draft.request.frame();
      draft.operation.response = draft.response.frame();
      for (const DraftFrame& other : draft.others) draft.operation.others.push_back(other.frame());
      declaration_.operations.push_back(std::move(draft.operation));
    }
    return std::move(declaration_);
  }

 private:
  const Node* list(std::string_view key, std::size_t most) {
    const Node* node = map_.require(key, "a list");
    const bool good = node != nullptr &&
                      is_list(*node, key, 1, most, fmt::format("a list of 1 to {}", most), faults_);
    return good ? node : nullptr;
  }

  void read_addresses() {
    const Node* node = map_.require("addresses", "addresses: { from: 1, to: 31 }");
    if (node == nullptr) return;
    MapReader map(*node, kAddressesKeys, faults_);
    if (map.read("text", declaration_.address_characters, WholeRule{1, 64}) || map.has("text")) {
      declaration_.lowest_address = 0;
      declaration_.highest_address = 65535;
      for (const auto* key : {"from", "to"}) {
        if (map.find(key) != nullptr)
          map.fault(key, "addresses are numbers and texts", "from and to, or text");
      }
      return;
    }
    map.read_required("from", declaration_.lowest_address, WholeRule{0, 65535},
                      "the lowest address of a device");
    map.read_required("to", declaration_.highest_address, WholeRule{0, INT64_MAX},
                      "the highest address of a device");
    if (map.has("from") && map.has("to") &&
        declaration_.lowest_address > declaration_.highest_address)
      map.fault("to", "addresses end below their beginning", "from <= to");
  }

  void read_area(const Node& node) {
    MapReader map(node, kAreaKeys, faults_);
    DeclaredArea area;
    map.read_required("name", area.name, NameRule{}, "a name for the area");
    area_names_.add("area", area.name, node.position, faults_);
    area_positions_.push_back(node.position);
    map.read("record", area.record, FlagRule{});
    map.read("trigger", area.trigger, FlagRule{});
    map.read("item", area.item_bits, ChoiceRule<std::uint8_t>{kItems});
    map.read("items", area.items, WholeRule{1, kMaxItems});
    area.prefix = area.name + ':';
    map.read("prefix", area.prefix, TextRule{kMaxNameLength});
    map.read("base", area.base, ChoiceRule<std::uint8_t>{kBases});
    map.read("origin", area.origin, WholeRule{0, kMaxOrigin});
    if (area.trigger && area.record)
      map.fault("trigger", "an area is a record and a trigger", "one of record, trigger");
    for (const auto* key : {"item", "items", "prefix", "base", "origin"}) {
      if (area.record && map.has(key))
        map.fault(key, fmt::format("'{}' has no meaning for a record", key),
                  "the places of a record are the values of its response");
      if (area.trigger && map.has(key))
        map.fault(key, fmt::format("'{}' has no meaning for a trigger", key),
                  "its address is its name");
    }
    if (area.trigger) area.items = 1, area.item_bits = 1, area.origin = 0;
    if (area.record) area.items = 0, area.item_bits = 16;
    declaration_.areas.push_back(std::move(area));
  }

  void read_operation(const Node& node) {
    MapReader map(node, kOperationKeys, faults_);
    DraftOperation draft;
    draft.position = node.position;
    map.read_required("name", draft.operation.name, TextRule{kMaxNameLength},
                      "a name for the operation");
    const Node* read = map.find("read");
    const Node* write = map.find("write");
    if (read != nullptr && write != nullptr)
      faults_.add(write->position, "an operation reads and writes", "one of read, write");
    if (map.is_map() && !map.has_or_means("read") && !map.has_or_means("write"))
      faults_.add(map.position(), "an operation neither reads nor writes",
                  "read: AREA, or write: AREA");
    draft.operation.write = read == nullptr;
    const Node* naming = read != nullptr ? read : write;
    draft.good = naming != nullptr && area_named(*naming, draft.operation.area);
    draft.has_command = map.read("command", draft.operation.command, WholeRule{0, INT64_MAX});
    read_count(map, draft);
    const unsigned item_bits = draft.good ? declaration_.areas[draft.operation.area].item_bits : 16;
    defaults_.origin = draft.good ? declaration_.areas[draft.operation.area].origin : 0;
    const auto frame = [&](std::string_view key) {
      const Node* list = map.require(key, "a list of fields");
      if (list != nullptr) return read_frame(*list, key, defaults_, item_bits, faults_);
      DraftFrame missing;
      missing.good = false;
      return missing;
    };
    map.read("unsolicited", draft.operation.unsolicited, DurationRule{kMinRefresh, kMaxRefresh});
    if (!map.has("unsolicited")) draft.request = frame("request");
    for (const auto* key : {"request", "before", "count"}) {
      if (map.has("unsolicited") && map.find(key) != nullptr)
        map.fault(key, fmt::format("'{}' has no meaning for a frame without a request", key),
                  "no '" + std::string(key) + "'");
    }
    const bool no_response =
        map.read("no-response", draft.operation.no_response, DurationRule{kMinPause, kMaxPause}) ||
        map.has("no-response");
    for (const auto key : {kForm, kForms}) {
      if (no_response && map.find(key) != nullptr)
        map.fault(key, fmt::format("'{}' has no meaning for a write without a response", key),
                  fmt::format("no '{}', or no 'no-response'", key));
    }
    const Node* forms = map.find(kForms);
    if (no_response)
      draft.response.position = node.position, draft.response.good = draft.operation.write;
    else if (forms == nullptr)
      draft.response = frame(kForm);
    else
      read_forms(map, *forms, draft);
    if (const Node* before = map.find("before"))
      draft.operation.before = read_rounds(*before, "before");
    operations_.push_back(std::move(draft));
  }

  // The response of a read has one of several forms; constants or lengths distinguish them.
  void read_forms(MapReader& map, const Node& node, DraftOperation& draft) {
    const bool record = draft.good && declaration_.areas[draft.operation.area].record;
    if (map.find(kForm) != nullptr)
      map.fault(kForms, "a response has one form and several", "one of the two keys");
    if (draft.good && (!record || draft.operation.write || map.has("unsolicited")))
      map.fault(kForms, "only a response that reads a record has several forms", "one form");
    draft.response.good = false;
    if (!is_list(node, kForms, 2, kMaxForms, "a list of 2 to 16 frames", faults_)) return;
    for (const Node* item : node.items) {
      DraftFrame form = read_frame(*item, "a form of the response", defaults_, 16, faults_);
      (item == node.items[0] ? draft.response : draft.others.emplace_back()) = std::move(form);
    }
  }

  std::vector<declared::Operation> read_rounds(const Node& node, std::string_view key) {
    std::vector<declared::Operation> rounds;
    if (!is_list(node, key, 1, kMaxRounds, "a list of rounds", faults_)) return rounds;
    for (const Node* item : node.items) {
      MapReader map(*item, kRoundKeys, faults_);
      DraftOperation round;
      round.operation.name = std::string(key);
      map.read("name", round.operation.name, TextRule{kMaxNameLength});
      round.has_command = map.read("command", round.operation.command, WholeRule{0, INT64_MAX});
      const auto frame = [&](std::string_view of) {
        const Node* list = map.require(of, "a list of fields");
        return list == nullptr ? DraftFrame{} : read_frame(*list, of, defaults_, 16, faults_);
      };
      round.request = frame("request");
      round.response = frame("answer");
      check_round(declaration_, round, faults_);
      round.operation.request = round.request.frame();
      round.operation.response = round.response.frame();
      rounds.push_back(std::move(round.operation));
    }
    return rounds;
  }

  bool area_named(const Node& naming, AreaIndex& index) {
    std::vector<std::string_view> names;
    for (const auto& area : declaration_.areas) names.push_back(area.name);
    if (names.empty()) return false;  // a fault was already added
    const auto* text = scalar_of(naming, "area", joined(names), faults_);
    if (text == nullptr) return false;
    const auto found = std::ranges::find(names, *text);
    if (found == names.end()) {
      faults_.add(naming.position, fmt::format("no area is named '{}'", *text), joined(names),
                  closest(*text, names));
      return false;
    }
    index = static_cast<AreaIndex>(found - names.begin());
    return true;
  }

  // count: 125, or { from: 2, to: 125 }.
  void read_count(MapReader& map, DraftOperation& draft) {
    auto& operation = draft.operation;
    const Node* node = map.find("count");
    draft.count_position = node == nullptr ? draft.position : node->position;
    if (node == nullptr) return;
    if (node->kind != Kind::kMap) {
      if (const auto most = WholeRule{1, 65535}(*node, "count", faults_))
        operation.max_count = static_cast<std::uint16_t>(*most);
    } else {
      MapReader range(*node, kCountKeys, faults_);
      range.read_required("from", operation.min_count, WholeRule{1, 65535}, "the fewest items");
      range.read_required("to", operation.max_count, WholeRule{1, 65535}, "the most items");
      if (range.has("from") && range.has("to") && operation.min_count > operation.max_count)
        range.fault("to", "count ends below its beginning", "from <= to");
    }
    if (draft.good && declaration_.areas[operation.area].record)
      faults_.add(node->position, "'count' has no meaning for a record", "a record is read whole");
  }

  void read_errors() {
    const Node* node = map_.find("errors");
    if (node == nullptr) return;
    MapReader map(*node, kErrorsKeys, faults_);
    const auto read_refusal = [&](const Node& frame, std::string_view key) {
      const DraftFrame refusal = read_frame(frame, key, defaults_, 16, faults_);
      check_refusal(declaration_, operations_, refusal, faults_);
      declaration_.refusals.push_back(refusal.frame());
    };
    if (const Node* codes = map.find("codes")) read_codes(*codes);
    const Node* frames = map.find("frames");
    if (frames != nullptr && map.find("frame") != nullptr)
      map.fault("frames", "a refusal is one frame and several", "one of frame, frames");
    if (frames != nullptr &&
        is_list(*frames, "frames", 1, kMaxRefusals, "a list of frames", faults_)) {
      for (const Node* frame : frames->items) read_refusal(*frame, "a frame of a refusal");
    } else if (frames == nullptr) {
      if (const Node* frame = map.require("frame", "the fields of a refusal"))
        read_refusal(*frame, "frame");
    }
    const Node* busy = map.find("busy");
    if (busy == nullptr) return;
    if (!is_list(*busy, "busy", 0, kAnyCount, "a list of codes", faults_, as_list(*busy))) return;
    for (const Node* item : busy->items) {
      if (const auto code = WholeRule{0, 65535}(*item, "busy", faults_))
        declaration_.busy.push_back(static_cast<std::uint16_t>(*code));
    }
  }

  void read_codes(const Node& node) {
    if (node.kind != Kind::kMap || node.entries.size() > kMaxCodes) {
      faults_.add(
          node.position,
          "codes is " + (node.kind == Kind::kMap ? "too long" : std::string(to_text(node.kind))),
          fmt::format("at most {} lines CODE: TEXT", kMaxCodes));
      return;
    }
    for (const auto& [key, value] : node.entries) {
      const auto code = WholeRule{0, 65535}(*key, "code", faults_);
      const auto text = TextRule{kMaxDescription}(*value, key->text, faults_);
      if (code && text) declaration_.codes[static_cast<std::uint16_t>(*code)] = *text;
    }
  }

  void check_areas() {
    if (operations_.empty()) return;
    for (std::size_t i = 0; i < declaration_.areas.size(); ++i) {
      const auto uses = [&](bool write) {
        return std::ranges::count_if(operations_, [&](const DraftOperation& draft) {
          return (draft.operation.area == i && draft.operation.write == write) || !draft.good;
        });
      };
      const auto same = [&](const DeclaredArea& other) {
        return other.name == declaration_.areas[i].name;
      };
      // Two areas with one name: a fault was already added.
      if (std::ranges::count_if(declaration_.areas, same) > 1) continue;
      const std::string area = fmt::format("area '{}'", declaration_.areas[i].name);
      if (declaration_.areas[i].trigger) {
        if (uses(true) == 0)
          faults_.add(area_positions_[i], area + " is written by no operation",
                      "an operation with write: " + declaration_.areas[i].name);
        continue;
      }
      if (uses(false) == 0)
        faults_.add(area_positions_[i], area + " is read by no operation",
                    "an operation with read: " + declaration_.areas[i].name);
    }
  }

  MapReader map_;
  FaultList& faults_;
  Declaration declaration_;
  FieldDefaults defaults_;
  UniqueNames area_names_;
  std::vector<Position> area_positions_;
  std::vector<DraftOperation> operations_;
};

}  // namespace

declared::SharedDeclaration read_declaration(const Node& root, const std::string& name,
                                             FaultList& faults) {
  const std::size_t before = faults.size();
  auto declaration = DeclarationReader(root, name, faults).run();
  if (faults.size() != before) return {};
  return {std::make_shared<const Declaration>(std::move(declaration))};
}

ProtocolChoice read_protocol(const Node& node, std::string_view key, LoadState& state) {
  std::vector<std::string> names;
  for (const auto& entry : protocols()) names.emplace_back(entry.name);
  const auto listed = [&] { return std::vector<std::string_view>(names.begin(), names.end()); };
  const std::string* text =
      scalar_of(node, key, joined(listed()) + ", or the name of a declaration", state.faults);
  if (text == nullptr) return {};
  if (const auto* entry = find_protocol(*text)) return {*text, entry, {}};
  const auto found = state.library.protocol_declaration(node);
  if (!found.exists) {
    for (auto& name : state.library.declared_protocols(node)) names.push_back(std::move(name));
    const auto meant = meant_value("protocol", *text);
    state.faults.add(node.position, fmt::format("{} '{}' is unknown", key, *text), joined(listed()),
                     meant.empty() ? closest(*text, listed()) : meant);
    return {};
  }
  if (found.root == nullptr) return {};
  const auto [known, fresh] = state.declarations.try_emplace(found.root);
  if (fresh) known->second = read_declaration(*found.root, *text, state.faults);
  if (!known->second) return {};
  return {*text, nullptr, known->second};
}

}  // namespace fieldcast::config
