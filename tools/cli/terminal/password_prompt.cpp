#include "tools/cli/terminal/password_prompt.hpp"

#include <termios.h>
#include <unistd.h>

#include <iostream>

#include "bridge/base/secret_file.hpp"

namespace fieldcast::cli {
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
