#include "bridge/port/unsent.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace fieldcast {
Unsent::Outcome Unsent::write(int fd, ByteView bytes) {
  if (rest_.size() + bytes.size() > Port::kMaxUnsent) return Outcome::kFull;
  const bool waiting = !rest_.empty();
  if (waiting) append(rest_, bytes);
  ByteView todo = waiting ? ByteView(rest_) : bytes;
  while (!todo.empty()) {
    const ssize_t sent = write_some(fd, todo);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK) return Outcome::kFailed;
    if (sent <= 0) break;
    todo = todo.subspan(static_cast<std::size_t>(sent));
  }
  rest_ = Bytes(todo.begin(), todo.end());
  return rest_.empty() ? Outcome::kAllSent : Outcome::kBlocked;
}

ssize_t Unsent::write_some(int fd, ByteView bytes) const {
  // After the peer has closed, the call then fails with EPIPE and raises no signal.
  if (kind_ == Kind::kSocket) return ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return ::write(fd, bytes.data(), bytes.size());
}

}  // namespace fieldcast
