// The client side of a request for the list of devices, used by `fieldcast-port list`. Pure; the
// shell sends request(), passes the received bytes, and disconnects after the result or kLimit.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/program/device_list.hpp"
#include "core/program/marker_framing.hpp"
#include "core/program/port_client.hpp"

namespace fieldcast::program {

struct DeviceList {
  std::vector<ListedDevice> devices;
  std::size_t omitted = 0;  // further devices that the bridge does not list
};

class ListClient {
 public:
  static constexpr Duration kLimit = std::chrono::seconds{10};  // from the request to the result
  using Result = tl::expected<DeviceList, PortEnd>;

  // `user`: empty: no login is sent.
  ListClient(std::string user, std::string password)
      : user_(std::move(user)), password_(std::move(password)) {}

  [[nodiscard]] Bytes request() const;
  // Returns the result when the list is complete or refused. Ignores bytes after it.
  [[nodiscard]] std::optional<Result> on_bytes(ByteView bytes);

 private:
  [[nodiscard]] std::optional<Result> on_code(std::string_view code);

  const std::string user_, password_;
  MarkerReader reader_{Sender::kBridge};
  DeviceList list_;
  bool over_ = false;
};

}  // namespace fieldcast::program
