#include "tools/cli/terminal/console.hpp"

#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "bridge/process/secret.hpp"

namespace fieldcast::cli {

bool output_is_terminal() { return isatty(STDOUT_FILENO) == 1; }

bool output_is_pipe() {
  struct stat about {};
  return fstat(STDOUT_FILENO, &about) == 0 && S_ISFIFO(about.st_mode);
}

Screen output_screen() {
  if (!output_is_terminal()) return {};
  winsize size{};
  const bool known =
      ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets the environment
  const char* no_colour = std::getenv("NO_COLOR");
  const bool colour = no_colour == nullptr || *no_colour == '\0';
  return known ? Screen{size.ws_col, size.ws_row, colour} : Screen{80, 24, colour};
}

namespace {

constexpr std::array kEndingSignals{SIGINT, SIGTERM, SIGHUP, SIGQUIT};

termios modes_before{};  // of the terminal, while it has no echo; for the signal handler

// SA_RESETHAND: the second signal ends the process.
void restore_echo_and_end(int signal) {
  ::tcsetattr(STDIN_FILENO, TCSANOW, &modes_before);
  ::raise(signal);
}

// Only one at a time. A signal that ends the process restores the echo first.
class Silence {
 public:
  Silence() {
    ::tcgetattr(STDIN_FILENO, &modes_before);
    for (const int signal : kEndingSignals) replace(signal, SIG_DFL, restore_echo_and_end);
    termios quiet = modes_before;
    quiet.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &quiet);
  }
  ~Silence() {
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &modes_before);
    for (const int signal : kEndingSignals) replace(signal, restore_echo_and_end, SIG_DFL);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  using Handler = void (*)(int);
  // An ignored signal stays ignored.
  static void replace(int signal, Handler from, Handler to) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler != from) return;
    action.sa_handler = to;
    action.sa_flags = SA_RESETHAND;
    ::sigaction(signal, &action, nullptr);
  }
};

tl::expected<Secret, std::string> first_line(std::istream& in, const std::string& source) {
  std::string line;
  if (!std::getline(in, line)) return tl::unexpected("no password in " + source);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return Secret::taken_from(line);
}

Secret asked(const char* question, std::istream& in, std::ostream& prompt) {
  prompt << question << std::flush;
  std::string line;
  const Silence silence;
  std::getline(in, line);
  prompt << '\n';
  return Secret::taken_from(line);
}

}  // namespace

tl::expected<Secret, std::string> new_password(const std::string& file, std::istream& in,
                                               std::ostream& prompt) {
  if (!file.empty() && file != "-") return read_secret_line(file, Readers::kOwner);
  if (&in != &std::cin || ::isatty(STDIN_FILENO) != 1) return first_line(in, "the standard input");
  Secret once = asked("password: ", in, prompt);
  if (!same_bytes(asked("once more: ", in, prompt).text(), once.text()))
    return tl::unexpected(std::string("the two passwords differ"));
  return once;
}

}  // namespace fieldcast::cli
