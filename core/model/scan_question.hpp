// Requests that change nothing in any device and show whether one responds. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// Reads one item of an area.
struct ScanQuestion {
  std::string at;  // "holding:0"
  Range range;
};

// One or two requests of different areas, because a device may ignore areas that it does not have.
// A declared record is read completely. `declaration`: empty for a built-in protocol.
[[nodiscard]] std::vector<ScanQuestion> scan_questions(
    const Protocol& protocol, const declared::SharedDeclaration& declaration);

// An item that identifies the type of a device: D8001 of an FX, SMB6 of an S7-200, id:basic of
// Modbus (vendor, product code, revision).
struct IdentityQuestion {
  ScanQuestion question;
  std::string label;  // "type and version"; empty: the item is a text that describes itself
};
// Empty if the protocol has no such item.
[[nodiscard]] std::optional<IdentityQuestion> identity_question(const Protocol& protocol);
// "Schneider Electric, PM5110, 1.2", "type and version 24123 (D8001 is 24123)". `value`: of the
// item, as a text.
[[nodiscard]] std::string identity_text(const IdentityQuestion& identity, const std::string& value);

}  // namespace fieldcast
