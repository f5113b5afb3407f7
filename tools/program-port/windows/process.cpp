// What the shared sources need of the process, the console and the network of Windows.
#include <winsock2.h>
// winsock2.h must be first.
#include <fcntl.h>
#include <io.h>
#include <mstcpip.h>
#include <windows.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/log/log_output.hpp"
#include "bridge/net/byte_stream.hpp"
#include "tools/cli/text/character_width.hpp"
#include "tools/program-port/bridge_socket.hpp"
#include "tools/progress/terminal.hpp"

namespace fieldcast {

void end_for_broken_rule(const char* file, int line, const char* condition) {
  std::fprintf(stderr, "%s:%d: broken rule: %s\n", file, line, condition);
  std::abort();
}

// A service has no standard output.
int duplicate_output(int fd) { return fd < 0 ? -1 : ::_dup(fd); }

// A console does not accept bytes while its user selects text, so this may wait.
std::optional<std::size_t> write_output(int fd, std::string_view text) {
  if (fd < 0) return std::nullopt;
  const int size =
      ::_write(fd, text.data(), static_cast<unsigned>(std::min(text.size(), kOutputPiece)));
  return size > 0 ? std::optional(static_cast<std::size_t>(size)) : std::nullopt;
}

void start_output_thread(std::function<void()> run) { std::thread(std::move(run)).detach(); }

namespace {

HANDLE console_of(int fd) { return ::GetStdHandle(fd == 2 ? STD_ERROR_HANDLE : STD_OUTPUT_HANDLE); }

}  // namespace

bool is_terminal(int fd) {
  DWORD mode = 0;
  return ::GetConsoleMode(console_of(fd), &mode) &&
         ::SetConsoleMode(console_of(fd), mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

std::size_t terminal_columns(int fd) {
  CONSOLE_SCREEN_BUFFER_INFO info{};
  if (!::GetConsoleScreenBufferInfo(console_of(fd), &info)) return 0;
  return static_cast<std::size_t>(info.srWindow.Right - info.srWindow.Left + 1);
}

namespace cli {

// The C library of Windows has no widths. The texts of this program are ASCII.
WidthsOfUnicode::WidthsOfUnicode() : before_(nullptr) {}
WidthsOfUnicode::~WidthsOfUnicode() = default;
int WidthsOfUnicode::of(char32_t) const { return 1; }

}  // namespace cli

// Windows does not report the unsent bytes of a socket.
std::size_t queued_at(int) { return 0; }

namespace port {

// A vanished bridge is detected by its missing heartbeats; the system then closes the socket.
void tune_bridge_socket(boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code ignored;
  socket.set_option(boost::asio::ip::tcp::no_delay(true), ignored);
  tcp_keepalive keepalive{1, 10'000, 3'000};  // on, idle time and interval in ms
  DWORD size = 0;
  (void)::WSAIoctl(socket.native_handle(), SIO_KEEPALIVE_VALS, &keepalive, sizeof keepalive,
                   nullptr, 0, &size, nullptr, nullptr);
}

}  // namespace port
}  // namespace fieldcast
