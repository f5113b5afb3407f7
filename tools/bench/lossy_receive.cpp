// Datagrams that never arrive, for benches: in a program that links this file, recvmsg() drops a
// share of what a UDP socket receives, as a bad path would. Any thread.
#include "tools/bench/lossy_receive.hpp"

#include <dlfcn.h>
#include <sys/socket.h>

#include <atomic>
#include <random>

namespace fieldcast::bench {
namespace {

std::atomic<double> share_lost = 0;

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

}  // namespace

void lose(double share) { share_lost = share; }

}  // namespace fieldcast::bench

// In place of the C library's, also for the libraries of the program.
extern "C" ssize_t recvmsg(int socket, msghdr* message, int flags) {
  static const auto received =
      reinterpret_cast<ssize_t (*)(int, msghdr*, int)>(dlsym(RTLD_NEXT, "recvmsg"));
  while (true) {
    const msghdr asked = *message;
    const ssize_t size = received(socket, message, flags);
    if (size < 0 || !fieldcast::bench::lost() || !fieldcast::bench::is_datagram(socket))
      return size;
    *message = asked;
  }
}
