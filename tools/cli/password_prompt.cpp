#include "tools/cli/password_prompt.hpp"

#include <termios.h>
#include <unistd.h>

#include <fstream>
#include <iostream>

namespace fieldcast::cli {
namespace {

// The terminal shows nothing of what is typed while this lives.
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

tl::expected<std::string, std::string> first_line(std::istream& in, const std::string& source) {
  std::string line;
  if (!std::getline(in, line)) return tl::unexpected("no password in " + source);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}

std::string asked(const char* question, std::istream& in, std::ostream& prompt) {
  prompt << question << std::flush;
  std::string line;
  const Silence silence;
  std::getline(in, line);
  prompt << '\n';
  return line;
}

}  // namespace

tl::expected<std::string, std::string> new_password(const std::string& file, std::istream& in,
                                                    std::ostream& prompt) {
  if (!file.empty() && file != "-") {
    std::ifstream content(file);
    if (!content) return tl::unexpected(file + " cannot be read");
    return first_line(content, file);
  }
  if (&in != &std::cin || ::isatty(STDIN_FILENO) != 1) return first_line(in, "the standard input");
  std::string once = asked("password: ", in, prompt);
  if (asked("once more: ", in, prompt) != once)
    return tl::unexpected(std::string("the two passwords differ"));
  return once;
}

}  // namespace fieldcast::cli
