#include "tools/cli/capture/bridge_socket.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "bridge/base/errno_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kMaxAnswer = 65536;  // characters: 256 bus names
constexpr std::size_t kMaxBridges = 64;    // bridges requested
constexpr timeval kAnswerLimit{1, 0};

// Fails with errno.
tl::expected<FileDescriptor, int> connect_to(const CaptureSocketName& socket) {
  FileDescriptor made(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  if (socket.name.size() + 1 > sizeof address.sun_path) return tl::unexpected(ENAMETOOLONG);
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, socket.name.data(), socket.name.size());
  const auto size =
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + socket.name.size());
  if (!made.valid() ||
      ::connect(made.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0)
    return tl::unexpected(errno);
  // Any user can bind such a name.
  if (peer_user(made.get()) != socket.user) return tl::unexpected(EPERM);
  (void)::setsockopt(made.get(), SOL_SOCKET, SO_RCVTIMEO, &kAnswerLimit, sizeof kAnswerLimit);
  return made;
}

// Returns the text line; the bytes behind it stay in the socket.
tl::expected<std::string, int> ask(const FileDescriptor& socket, const std::string& request) {
  const std::string line = request + '\n';
  if (::send(socket.get(), line.data(), line.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(line.size()))
    return tl::unexpected(errno);
  std::string answer;
  for (char c{}; answer.size() < kMaxAnswer; answer += c) {
    const auto got = ::recv(socket.get(), &c, 1, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return tl::unexpected(got == 0 ? ECONNRESET : errno);
    if (c == '\n') return answer;
  }
  return tl::unexpected(EMSGSIZE);
}

}  // namespace

Bridges find_bridges() {
  std::ifstream table("/proc/net/unix");
  std::stringstream text;
  text << table.rdbuf();
  auto sockets = capture_sockets(text.str());
  if (sockets.size() > kMaxBridges) sockets.resize(kMaxBridges);
  Bridges bridges;
  for (const CaptureSocketName& socket : sockets) {
    if (::geteuid() != 0 && socket.user != ::geteuid()) {
      bridges.refused.push_back(socket.bridge);
      continue;
    }
    const auto connection = connect_to(socket);
    if (!connection) continue;
    const auto answer = ask(*connection, "list");
    if (!answer) continue;
    std::istringstream words(*answer);
    std::string ok, word;
    FoundBridge found{socket};
    words >> ok >> word >> found.name >> word;
    if (ok != "ok") continue;
    while (words >> word) found.buses.push_back(word);
    bridges.found.push_back(std::move(found));
  }
  return bridges;
}

tl::expected<FileDescriptor, std::string> ask_for_capture(const CaptureSocketName& socket,
                                                          const std::string& bus) {
  auto connection = connect_to(socket);
  if (!connection)
    return tl::unexpected("the bridge does not respond: " + errno_text(connection.error()));
  const auto answer = ask(*connection, "capture " + bus);
  if (!answer) return tl::unexpected("the bridge does not respond: " + errno_text(answer.error()));
  if (*answer == "ok") return *std::move(connection);
  return tl::unexpected("the bridge says: " + *answer);
}

}  // namespace fieldcast::cli
