#include "tools/sim/check/subject.hpp"

#include <algorithm>

#include "core/model/make_protocol.hpp"

namespace fieldcast::sim {
namespace {

using Options = std::map<std::string, std::string>;

// What changes the frames of a family.
std::vector<Options> options_of(std::string_view protocol) {
  if (protocol == "modbus-rtu") return {{}, {{"mask-write", "true"}}};
  if (protocol == "dtc") return {{{"threshold", "65535"}}, {{"threshold", "0"}}};
  if (protocol == "mitsubishi-fx") return {{}, {{"commands", "extended"}}};
  if (protocol == "omron-hostlink")
    return {{}, {{"mode", "fins"}}, {{"mode", "fins"}, {"network", "5"}, {"node", "3"}}};
  if (protocol == "s7-freeport") return {{}, {{"letters", "swapped"}}};
  return {{}};
}

std::string text_of(const Options& options) {
  std::string text;
  for (const auto& [name, value] : options)
    text += (text.empty() ? "" : ", ") + name + ": " + value;
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
  if (find_protocol(protocol) == nullptr) return subjects;
  for (const Options& options : options_of(protocol)) {
    Subject subject{text_of(options), device_at(7), serial(), true};
    subject.device.protocol = protocol;
    subject.device.link.options = options;
    if (protocol == "modbus-tcp") {  // TCP carries the check
      subject.port = TcpPortSpec{};
      subject.checked = false;
    }
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
