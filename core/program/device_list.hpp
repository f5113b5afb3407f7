// The list of devices that an engineer may program, as frames from the bridge to a client that has
// requested it; see frame.hpp for their form. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.hpp"

namespace fieldcast::program {

struct ListedDevice {
  enum class State : std::uint8_t { kFree, kInUse, kNotOnline };
  std::string number, bus, device;
  State state = State::kFree;
  std::string who;  // kInUse: the engineer, if the client may know
  friend bool operator==(const ListedDevice&, const ListedDevice&) = default;
};
[[nodiscard]] std::string_view to_text(ListedDevice::State state);  // "in use"

// A longer list is cut; its end still has the number of all devices.
inline constexpr std::size_t kMaxListed = 1024;
inline constexpr std::size_t kMaxListedText = 192;  // bytes of `who`; the rest is cut

// One LD frame for each device, then LE. Without `with_who`, the field `who` stays empty.
[[nodiscard]] Bytes list_frames(const std::vector<ListedDevice>& devices, bool with_who);
// Empty if the code is not a valid LD.
[[nodiscard]] std::optional<ListedDevice> listed_device_from(std::string_view code);
// The count of LE. Empty if the code is not a valid LE.
[[nodiscard]] std::optional<std::size_t> list_end_from(std::string_view code);

}  // namespace fieldcast::program
