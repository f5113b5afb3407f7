// Where `fieldcast capture` reaches a bridge of the same machine: a Unix socket with an abstract
// name, so that no file is left behind and no network reaches it.
//
//   @fieldcast/capture/UID/BRIDGE/PID     UID: of the user that the bridge runs as
//
// The bridge serves root and its own user, by what the kernel says of the peer; who asks checks in
// the same way that it is the named user who answers. The request is one text line, the answer is
// one text line; after "ok" comes pcapng until one side ends:
//
//   list            →  ok bridge NAME buses BUS BUS ..
//   capture BUS     →  ok                 or   no BUS BUS ..: there is no such bus, but these
//                      refused REASON
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast {

inline constexpr std::size_t kMaxCaptureRequest = 256;  // characters

// Without the zero byte that begins it.
[[nodiscard]] std::string capture_socket_name(uid_t user, const std::string& bridge, pid_t process);

struct CaptureSocketName {
  std::string name;
  uid_t user = 0;
  std::string bridge;
  pid_t process = 0;
};
// Nothing: it is another socket.
[[nodiscard]] std::optional<CaptureSocketName> parse_capture_socket(std::string_view name);
// Those in a text of the form of /proc/net/unix, in its order.
[[nodiscard]] std::vector<CaptureSocketName> capture_sockets(std::string_view table);

// Who is at the other end of a connected Unix socket; nothing: the kernel does not say.
[[nodiscard]] std::optional<uid_t> peer_user(int socket);

}  // namespace fieldcast
