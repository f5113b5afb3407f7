#include "core/model/scan_question.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

namespace fieldcast {
namespace {

constexpr std::size_t kMostQuestions = 2;

struct IdentityRow {
  std::string_view protocol, at, label;
};
constexpr IdentityRow kIdentities[] = {
    {"modbus-rtu", "id:basic", ""}, {"modbus-ascii", "id:basic", ""},
    {"modbus-tcp", "id:basic", ""}, {"mitsubishi-fx", "D8001", "type and version"},
    {"s7-ppi", "SMB6", "CPU"},
};

// First item of an area in the protocol's notation; for a record its first value.
std::optional<std::string> first_of(const Protocol& protocol,
                                    const declared::SharedDeclaration& declaration,
                                    AreaIndex index) {
  if (declaration) {
    const declared::DeclaredArea& area = declaration.value->areas[index];
    if (area.record && !area.places.empty()) return area.places.front().name;
  }
  const std::string name(protocol.areas()[index].name);
  for (const char* end : {":0", "0", "B0", "W0", "00"}) {
    const auto parsed = protocol.parse_address(name + end);
    if (parsed && parsed->area == index && parsed->first == 0 && !parsed->bit) return name + end;
  }
  return std::nullopt;
}

}  // namespace

std::vector<ScanQuestion> scan_questions(const Protocol& protocol,
                                         const declared::SharedDeclaration& declaration) {
  std::vector<ScanQuestion> questions;
  const auto add = [&](bool registers) {
    for (std::size_t i = 0; i < protocol.areas().size(); ++i) {
      const auto index = static_cast<AreaIndex>(i);
      const Area& area = protocol.areas()[i];
      if ((area.item_bits > 1) != registers) continue;
      const bool record = area.window && declaration;
      const Range range{index, 0, record ? area.items : std::max<std::uint32_t>(1, area.alignment)};
      const auto at = first_of(protocol, declaration, index);
      if (at && questions.size() < kMostQuestions && protocol.size(ReadRequest{{range}}))
        questions.push_back({*at, range});
    }
  };
  add(true);
  if (questions.empty()) add(false);
  return questions;
}

std::optional<IdentityQuestion> identity_question(const Protocol& protocol) {
  const auto row = std::ranges::find(kIdentities, protocol.traits().name, &IdentityRow::protocol);
  if (row == std::end(kIdentities)) return std::nullopt;
  const std::string at(row->at);
  const auto parsed = protocol.parse_address(at);
  if (!parsed) return std::nullopt;
  const std::uint32_t items = std::max<std::uint32_t>(1, parsed->text_characters);
  return IdentityQuestion{{at, {parsed->area, parsed->first, items}}, std::string(row->label)};
}

std::string identity_text(const IdentityQuestion& identity, const std::string& value) {
  if (identity.label.empty()) return value;
  return identity.label + ' ' + value + " (" + identity.question.at + " is " + value + ')';
}

}  // namespace fieldcast
