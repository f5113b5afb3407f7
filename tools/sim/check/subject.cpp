#include "tools/sim/check/subject.hpp"

#include <algorithm>

#include "core/model/bus_spec.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::sim {
namespace {

std::string text_of(const ProtocolVariant& variant) {
  std::string text;
  for (const auto& [name, value] : variant.options) {
    text += text.empty() ? "" : ", ";
    text.append(name).append(": ").append(value);
  }
  return text;
}

DeviceSpec device_at(std::uint16_t address) {
  DeviceSpec device;
  device.name = "device";
  device.link.address = address;
  device.timeout = std::chrono::seconds{1};
  device.retries = 0;
  return device;
}

PortSpec serial() {
  SerialPortSpec port;
  port.line = LineFormat{115200, 8, Parity::kEven, 1};
  return port;
}

bool has_check(const declared::Frame& frame) {
  return std::ranges::any_of(
      frame.fields, [](const auto& field) { return field.kind == declared::FieldKind::kChecksum; });
}

}  // namespace

std::unique_ptr<Protocol> Subject::protocol() const {
  DeviceSpec spec = device;
  auto made = make_protocol(spec, line());
  return made ? std::move(*made) : nullptr;
}

std::optional<Subject> Subject::neighbour() const {
  Subject other = *this;
  const auto made = protocol();
  const auto [lowest, highest] =
      std::pair(made->traits().lowest_address, made->traits().highest_address);
  if (lowest == highest) return std::nullopt;
  other.device.link.address = static_cast<std::uint16_t>(
      device.link.address < highest ? device.link.address + 1 : device.link.address - 1);
  return other;
}

std::vector<Subject> subjects_of(std::string_view protocol) {
  std::vector<Subject> subjects;
  const ProtocolEntry* entry = find_protocol(protocol);
  if (entry == nullptr) return subjects;
  for (const ProtocolVariant& variant : entry->variants) {
    Subject subject{text_of(variant), device_at(7), serial(), true, variant.addresses};
    subject.device.protocol = protocol;
    subject.device.link = link_of(variant, subject.device.link.address);
    if (entry->network_only) subject.port = TcpPortSpec{};
    subject.checked = !entry->carrier_checks;
    subjects.push_back(std::move(subject));
  }
  return subjects;
}

std::vector<Subject> subjects_of(const declared::SharedDeclaration& declaration) {
  const declared::Declaration& value = *declaration.value;
  Subject subject{
      "", device_at(std::clamp<std::uint16_t>(7, value.lowest_address, value.highest_address)),
      serial(), true};
  subject.device.protocol = value.name;
  subject.device.declaration = declaration;
  subject.checked = std::ranges::all_of(value.operations,
                                        [](const auto& each) { return has_check(each.answer); }) &&
                    (value.refusal.fields.empty() || has_check(value.refusal));
  return {subject};
}

}  // namespace fieldcast::sim
