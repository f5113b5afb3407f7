#include "core/model/scan_question.hpp"

#include <algorithm>
#include <optional>

namespace fieldcast {
namespace {

constexpr std::size_t kMostQuestions = 2;

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

}  // namespace fieldcast
