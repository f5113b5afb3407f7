#include "bridge/capture/capture_socket.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <charconv>

namespace fieldcast {
namespace {

constexpr std::string_view kPrefix = "fieldcast/capture/";

std::string_view until_slash(std::string_view& text) {
  const auto slash = text.find('/');
  const std::string_view part = text.substr(0, slash);
  text = slash == text.npos ? std::string_view{} : text.substr(slash + 1);
  return part;
}

template <typename Number>
bool parse(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::string capture_socket_name(uid_t user, const std::string& bridge, pid_t process) {
  return fmt::format("{}{}/{}/{}", kPrefix, user, bridge, process);
}

std::optional<CaptureSocketName> parse_capture_socket(std::string_view name) {
  CaptureSocketName parsed{.name = std::string(name)};
  if (!name.starts_with(kPrefix)) return std::nullopt;
  name.remove_prefix(kPrefix.size());
  const auto user = until_slash(name), bridge = until_slash(name), process = until_slash(name);
  if (!name.empty() || bridge.empty() || !parse(user, parsed.user) ||
      !parse(process, parsed.process))
    return std::nullopt;
  parsed.bridge = bridge;
  return parsed;
}

std::vector<CaptureSocketName> capture_sockets(std::string_view table) {
  std::vector<CaptureSocketName> all;
  while (!table.empty()) {
    const auto end = table.find('\n');
    const std::string_view row = table.substr(0, end);
    table = end == table.npos ? std::string_view{} : table.substr(end + 1);
    const auto at = row.rfind(" @");
    if (at == row.npos) continue;
    auto parsed = parse_capture_socket(row.substr(at + 2));
    if (!parsed) continue;
    bool known = false;  // connections have the name of their listener
    for (const auto& each : all) known |= each.name == parsed->name;
    if (!known) all.push_back(*std::move(parsed));
  }
  return all;
}

std::optional<uid_t> peer_user(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  return peer.uid;
}

}  // namespace fieldcast
