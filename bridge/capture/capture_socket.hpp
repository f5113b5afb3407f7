// The Unix socket between `fieldcast capture` and a bridge on the same machine. Its name is
// abstract: it leaves no file behind and cannot be reached from a network.
//
//   @fieldcast/capture/UID/BRIDGE/PID     UID: of the user that the bridge runs as
//
// The bridge serves root and its own user; the kernel reports the user of the peer. The client
// checks in the same way that the named user responds. Request and response are one text line each.
// After "ok", pcapng follows until one side closes:
//
//   list            →  ok bridge NAME buses BUS BUS ..
//   capture BUS     →  ok                 or   no BUS BUS ..: no such bus; these exist
//                      refused REASON
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast {

inline constexpr std::size_t kMaxCaptureRequest = 256;  // characters

// Without the leading zero byte.
[[nodiscard]] std::string capture_socket_name(uid_t user, const std::string& bridge, pid_t process);

struct CaptureSocketName {
  std::string name;
  uid_t user = 0;
  std::string bridge;
  pid_t process = 0;
};
[[nodiscard]] std::optional<CaptureSocketName> parse_capture_socket(std::string_view name);
// Returns the capture sockets in a table in the format of /proc/net/unix, in its order.
[[nodiscard]] std::vector<CaptureSocketName> capture_sockets(std::string_view table);

// Returns the user at the other end of a connected Unix socket, or `std::nullopt` if unknown.
[[nodiscard]] std::optional<uid_t> peer_user(int socket);

}  // namespace fieldcast
