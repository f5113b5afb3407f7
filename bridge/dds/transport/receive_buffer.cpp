#include "bridge/dds/transport/receive_buffer.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {

std::optional<std::uint32_t> granted_receive_buffer(std::uint32_t asked) {
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const int wanted = static_cast<int>(asked);
  int granted = 0;
  socklen_t size = sizeof granted;
  if (setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted) != 0 ||
      getsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size) != 0)
    return std::nullopt;
  return static_cast<std::uint32_t>(granted) / 2;  // Linux uses the other half for its own overhead
}

std::optional<std::string> receive_buffer_remark(std::optional<std::uint32_t> granted,
                                                 std::uint32_t asked) {
  if (!granted || *granted >= asked) return std::nullopt;
  return fmt::format(
      "the kernel holds {} KiB of what comes by UDP where {} KiB were asked for: bursts of many "
      "channels get lost and are sent again; remedy: sysctl -w net.core.rmem_max={}",
      *granted / 1024, asked / 1024, asked);
}

std::optional<std::string> receive_buffer_remark(const DdsSpec& spec) {
  if (spec.profile) return std::nullopt;
  return receive_buffer_remark(granted_receive_buffer());
}

}  // namespace fieldcast
