#include "tools/cli/capture/capture_stream.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "bridge/base/file_descriptor.hpp"
#include "core/capture/pcapng.hpp"

namespace fieldcast::cli {

namespace {

// Little-endian: the bridge runs on the same machine.
std::uint32_t number_at(ByteView bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

}  // namespace

std::vector<BlockCutter::Block> BlockCutter::take(ByteView bytes) {
  append(waiting_, bytes);
  std::vector<Block> blocks;
  std::size_t at = 0;
  while (!broken_ && waiting_.size() - at >= 8) {
    const std::uint32_t type = number_at(waiting_, at), length = number_at(waiting_, at + 4);
    broken_ = length < 12 || length % 4 != 0 || length > pcapng::kMaxBlock;
    if (broken_ || waiting_.size() - at < length) break;
    const ByteView block = ByteView(waiting_).subspan(at, length);
    blocks.push_back({type, Bytes(block.begin(), block.end())});
    at += length;
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(at));
  return blocks;
}

namespace {

constexpr std::size_t kMaxResponse = 65536;  // characters: 256 bus names
constexpr std::size_t kMaxBridges = 64;      // bridges requested
constexpr timeval kResponseLimit{1, 0};

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
  (void)::setsockopt(made.get(), SOL_SOCKET, SO_RCVTIMEO, &kResponseLimit, sizeof kResponseLimit);
  return made;
}

// Returns the text line; the bytes behind it stay in the socket.
tl::expected<std::string, int> ask(const FileDescriptor& socket, const std::string& request) {
  const std::string line = request + '\n';
  if (::send(socket.get(), line.data(), line.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(line.size()))
    return tl::unexpected(errno);
  std::string response;
  for (char c{}; response.size() < kMaxResponse; response += c) {
    const auto got = ::recv(socket.get(), &c, 1, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return tl::unexpected(got == 0 ? ECONNRESET : errno);
    if (c == '\n') return response;
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
    const auto response = ask(*connection, "list");
    if (!response) continue;
    std::istringstream words(*response);
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
  const auto response = ask(*connection, "capture " + bus);
  if (!response)
    return tl::unexpected("the bridge does not respond: " + errno_text(response.error()));
  if (*response == "ok") return *std::move(connection);
  return tl::unexpected("the bridge says: " + *response);
}

}  // namespace fieldcast::cli
