// Simulates packet loss: in a program that links this file, recvfrom() and recvmsg() drop a share
// of the received UDP datagrams. Thread-safe.
#include "tools/bench/support/lossy_receive.hpp"

#include <dlfcn.h>
#include <sys/socket.h>

#include <atomic>
#include <cstdint>
#include <random>

namespace fieldcast::bench {
namespace {

std::atomic<double> share_lost = 0;
std::atomic<std::uint64_t> datagrams_lost = 0;
std::atomic<std::int64_t> until_lost = -1;  // datagrams before the lost one; negative: none

bool lost() {
  thread_local std::minstd_rand random(std::random_device{}());
  const double share = share_lost.load(std::memory_order_relaxed);
  return share > 0 && std::uniform_real_distribution<double>(0, 1)(random) < share;
}

bool is_datagram(int socket) {
  int type = 0;
  socklen_t size = sizeof type;
  return getsockopt(socket, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM;
}

bool is_lost(int socket, ssize_t size) {
  const bool is_one = until_lost.load(std::memory_order_relaxed) >= 0;
  if (size < 0 || !(is_one || lost()) || !is_datagram(socket)) return false;
  if (is_one && until_lost.fetch_sub(1) != 0) return false;
  ++datagrams_lost;
  return true;
}

}  // namespace

void lose(double share) { share_lost = share; }

void lose_one(std::int64_t after) { until_lost = after; }

std::uint64_t lost_datagrams() { return datagrams_lost; }

}  // namespace fieldcast::bench

// Replace the C library's functions also for libraries: Asio uses recvfrom() or recvmsg().
extern "C" {

ssize_t recvmsg(int socket, msghdr* message, int flags) {
  using Receive = ssize_t (*)(int, msghdr*, int);
  static const auto receive = reinterpret_cast<Receive>(dlsym(RTLD_NEXT, "recvmsg"));
  const msghdr original = *message;
  while (true) {
    const ssize_t size = receive(socket, message, flags);
    if (!fieldcast::bench::is_lost(socket, size)) return size;
    *message = original;
  }
}

ssize_t recvfrom(int socket, void* buffer, std::size_t room, int flags, sockaddr* from,
                 socklen_t* from_size) {
  using Receive = ssize_t (*)(int, void*, std::size_t, int, sockaddr*, socklen_t*);
  static const auto receive = reinterpret_cast<Receive>(dlsym(RTLD_NEXT, "recvfrom"));
  const socklen_t original = from_size == nullptr ? 0 : *from_size;
  while (true) {
    const ssize_t size = receive(socket, buffer, room, flags, from, from_size);
    if (!fieldcast::bench::is_lost(socket, size)) return size;
    if (from_size != nullptr) *from_size = original;
  }
}
}
