#include "core/program/last_request.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "core/protocol/families/registry.hpp"

namespace fieldcast::program {
namespace {

// Names of the fields that say what is requested, in the frames of the built-in protocols and in
// those of most declarations.
constexpr std::array<std::string_view, 4> kOperations{"function", "header", "command", "FNC"};
constexpr std::array<std::string_view, 12> kArguments{"first",   "last", "count", "quantity",
                                                      "item",    "file", "type",  "element",
                                                      "address", "area", "value", "parameters"};

// A declared frame has the name of its operation in its remark: "request: read data registers".
std::string_view operation_of(const FrameField& field) {
  constexpr std::string_view kDeclared = "request: ";
  const std::string_view value = field.value;
  if (field.name == "frame" && value.starts_with(kDeclared)) return value.substr(kDeclared.size());
  return std::ranges::count(kOperations, field.name) > 0 ? value : std::string_view{};
}

// Returns an empty text if the bytes are not a valid frame with an operation.
std::string text_of(const std::vector<FrameField>& fields, bool is_declared) {
  std::string operation, arguments;
  for (const FrameField& field : fields) {
    if (!field.fault.empty()) return {};
    const std::string_view found = operation_of(field);
    const bool is_remark = field.name == "frame";
    if (!found.empty() && is_remark == is_declared) {
      operation = found;
      arguments.clear();  // FINS in a frame of Host Link
    } else if (std::ranges::count(kArguments, field.name) > 0) {
      arguments += ", " + field.name + ' ' + field.value;
    }
  }
  if (operation.empty()) return {};
  return operation + arguments;
}

}  // namespace

void LastRequest::on_sent(ByteView bytes, UtcTime at) {
  if (sent_.size() + bytes.size() > kMaxBytes + 1)
    bytes = bytes.first(kMaxBytes + 1 - sent_.size());
  append(sent_, bytes);
  sent_at_ = at;
}

void LastRequest::on_received() {
  if (sent_.empty()) return;
  whole_ = std::exchange(sent_, {});
  whole_at_ = sent_at_;
}

std::optional<LastRequest::Decoded> LastRequest::take() {
  const Bytes bytes = std::exchange(whole_, {});
  if (bytes.empty() || bytes.size() > kMaxBytes) return std::nullopt;
  std::string text;
  if (declaration_) {
    text = text_of(declared::explain(*declaration_.value, bytes, declared::Sender::kBridge), true);
  } else if (const ProtocolEntry* entry = find_protocol(protocol_); entry && entry->explain) {
    text = text_of(entry->explain(bytes), false);
  }
  if (text.empty()) return std::nullopt;
  return Decoded{std::move(text), whole_at_};
}

}  // namespace fieldcast::program
