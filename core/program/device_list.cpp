#include "core/program/device_list.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "core/base/message_text.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

std::string_view to_text(ListedDevice::State state) {
  switch (state) {
    case ListedDevice::State::kFree: return "free";
    case ListedDevice::State::kInUse: return "in use";
    case ListedDevice::State::kNotOnline: return "not online";
  }
  return "?";
}

Bytes list_frames(const std::vector<ListedDevice>& devices, bool with_who) {
  Bytes out;
  for (const ListedDevice& device :
       std::span(devices).first(std::min(devices.size(), kMaxListed))) {
    std::string code = std::string(kListedCode) + device.number + ':';
    code += std::to_string(static_cast<int>(device.state));
    for (const std::string& text :
         {device.bus, device.device, with_who ? printable(device.who, kMaxListedText) : ""})
      code += ':' + hex_of_text(text);
    append(out, control_frame(code));
  }
  append(out, control_frame(std::string(kListEndCode) + std::to_string(devices.size())));
  return out;
}

std::optional<ListedDevice> listed_device_from(std::string_view code) {
  if (!code.starts_with(kListedCode)) return std::nullopt;
  code.remove_prefix(kListedCode.size());
  std::array<std::string_view, 5> fields;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto colon = code.find(':');
    if ((colon == code.npos) != (i + 1 == fields.size())) return std::nullopt;
    fields[i] = code.substr(0, colon);
    if (colon != code.npos) code.remove_prefix(colon + 1);
  }
  const std::string_view state = fields[1];
  if (!is_device_number(fields[0]) || state.size() != 1 || state < "0" || state > "2")
    return std::nullopt;
  const auto bus = text_of_hex(fields[2]), device = text_of_hex(fields[3]),
             who = text_of_hex(fields[4]);
  if (!bus || !is_name_in_line(*bus) || !device || !is_name_in_line(*device)) return std::nullopt;
  if (!who || (!who->empty() && !is_name_in_line(*who))) return std::nullopt;
  return ListedDevice{std::string(fields[0]), *bus, *device,
                      static_cast<ListedDevice::State>(state[0] - '0'), *who};
}

std::optional<std::size_t> list_end_from(std::string_view code) {
  constexpr std::size_t kMaxDigits = 9;
  if (!code.starts_with(kListEndCode)) return std::nullopt;
  code.remove_prefix(kListEndCode.size());
  std::size_t count = 0;
  const auto read = std::from_chars(code.data(), code.data() + code.size(), count);
  if (read.ec != std::errc{} || read.ptr != code.data() + code.size() || code.size() > kMaxDigits)
    return std::nullopt;
  return count;
}

}  // namespace fieldcast::program
