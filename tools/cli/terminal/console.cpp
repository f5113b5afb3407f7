#include "tools/cli/terminal/console.hpp"

#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

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

class Silence {
 public:
  Silence() {
    ::tcgetattr(STDIN_FILENO, &before_);
    termios quiet = before_;
    quiet.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &quiet);
  }
  ~Silence() { ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  termios before_{};
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
