#include "tools/cli/terminal/terminal.hpp"

#define NCURSES_NOMACROS
#include <curses.h>
#include <fcntl.h>
#include <langinfo.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/terminal/terminal_name.hpp"

namespace fieldcast::cli {
namespace {

// ms after which an ESC is the key itself, not the start of a sequence
constexpr int kEscapeWait = 25;

// Data for a crash handler, prepared because it cannot allocate.
struct Rescue {
  std::atomic<bool> armed = false;
  termios modes{};
  std::array<char, 256> reset{};
  std::size_t reset_size = 0;
};
Rescue rescue;

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

std::atomic<bool> stop_asked = false;  // Ctrl-Z
std::atomic<bool> continued = false;   // after a stop by SIGSTOP

void on_stop(int) { stop_asked = true; }
void on_continue(int) { continued = true; }
void on_crash(int signal) {
  give_terminal_back_now();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

int colour_of(Tone tone) {
  switch (tone) {
    case Tone::kGood: return COLOR_GREEN;
    case Tone::kWarning: return COLOR_YELLOW;
    case Tone::kBad: return COLOR_RED;
    default: return -1;
  }
}

std::string utf8_of(wint_t character) {
  std::array<char, MB_LEN_MAX> bytes{};
  std::mbstate_t state{};
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the state is its own
  const std::size_t size = std::wcrtomb(bytes.data(), static_cast<wchar_t>(character), &state);
  return size == static_cast<std::size_t>(-1) ? std::string{} : std::string(bytes.data(), size);
}

std::optional<Key> key_of_code(int code) {
  using Kind = Key::Kind;
  constexpr std::pair<int, Kind> kKinds[] = {
      {KEY_UP, Kind::kUp},        {KEY_DOWN, Kind::kDown},
      {KEY_LEFT, Kind::kLeft},    {KEY_RIGHT, Kind::kRight},
      {KEY_PPAGE, Kind::kPageUp}, {KEY_NPAGE, Kind::kPageDown},
      {KEY_HOME, Kind::kHome},    {KEY_END, Kind::kEnd},
      {KEY_ENTER, Kind::kEnter},  {KEY_BACKSPACE, Kind::kBackspace},
      {KEY_DC, Kind::kBackspace}, {KEY_RESIZE, Kind::kRedraw},
  };
  if (code >= KEY_F(1) && code <= KEY_F(12)) return function_key(code - KEY_F0);
  const auto* found = std::ranges::find(kKinds, code, &std::pair<int, Kind>::first);
  return found == std::end(kKinds) ? std::nullopt : std::optional(Key{found->second});
}

std::optional<Key> mouse_key() {
  MEVENT event{};
  if (::getmouse(&event) != OK) return std::nullopt;
  Key key{Key::Kind::kClick};
  key.row = static_cast<std::size_t>(std::max(0, event.y));
  key.column = static_cast<std::size_t>(std::max(0, event.x));
  if ((event.bstate & BUTTON4_PRESSED) != 0) key.kind = Key::Kind::kWheelUp;
  if ((event.bstate & BUTTON5_PRESSED) != 0) key.kind = Key::Kind::kWheelDown;
  constexpr mmask_t kKnown = BUTTON1_PRESSED | BUTTON1_CLICKED | BUTTON4_PRESSED | BUTTON5_PRESSED;
  return (event.bstate & kKnown) != 0 ? std::optional(key) : std::nullopt;
}

std::optional<Key> key_of_character(wint_t character) {
  using Kind = Key::Kind;
  switch (character) {
    case L'\r':
    case L'\n': return Key{Kind::kEnter};
    case 27: return Key{Kind::kEscape};
    case 8:
    case 127: return Key{Kind::kBackspace};
    case 21: return Key{Kind::kClear};
    case 12: return Key{Kind::kRedraw};
    default: break;
  }
  if (character < 32) return std::nullopt;
  std::string text = utf8_of(character);
  return text.empty() ? std::nullopt : std::optional(text_key(std::move(text)));
}

}  // namespace

void give_terminal_back_now() noexcept {
  if (!rescue.armed.exchange(false)) return;
  const int before = errno;
  [[maybe_unused]] const auto written =
      ::write(STDOUT_FILENO, rescue.reset.data(), rescue.reset_size);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &rescue.modes);
  errno = before;
}

bool use_terminal_locale() {
  // NOLINTBEGIN(concurrency-mt-unsafe): there are no other threads yet
  std::setlocale(LC_CTYPE, "");
  const bool unicode = std::string_view(::nl_langinfo(CODESET)) == "UTF-8";
  if (!unicode) std::setlocale(LC_CTYPE, "C.UTF-8");
  // NOLINTEND(concurrency-mt-unsafe)
  return unicode;
}

std::string no_screen_reason() {
  if (!output_is_terminal()) return "the output is no terminal";
  if (::isatty(STDIN_FILENO) == 0) return "the input is no terminal";
  if (usable_terminal_name().empty())
    return "the terminal '" + terminal_name() + "' (TERM) cannot move its cursor";
  return {};
}

// Redirects standard error while the screen is shown.
class QuietErrors {
 public:
  QuietErrors() {
    if (::isatty(STDERR_FILENO) == 0 || ::pipe2(pipe_.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
    before_ = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
    ::dup2(pipe_[1], STDERR_FILENO);
  }
  ~QuietErrors() {
    if (before_ < 0) return;
    ::dup2(before_, STDERR_FILENO);
    ::close(before_);
    ::close(pipe_[1]);
    std::array<char, 4096> text{};
    for (ssize_t got = 0; (got = ::read(pipe_[0], text.data(), text.size())) > 0;) {
      if (::write(STDERR_FILENO, text.data(), static_cast<std::size_t>(got)) < 0) break;
    }
    ::close(pipe_[0]);
  }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  std::array<int, 2> pipe_{-1, -1};
  int before_ = -1;
};

struct Terminal::State {
  QuietErrors errors;
  SCREEN* screen = nullptr;
  bool colour = false;

  void arm() const;
  void suspend();
  [[nodiscard]] attr_t attributes(Tone tone) const;
  [[nodiscard]] short pair(Tone tone) const;
};

void Terminal::State::arm() const {
  std::string reset;
  for (const char* name : {"sgr0", "cnorm", "rmcup"}) {
    const char* text = ::tigetstr(name);
    // Sequences with delays are for printing terminals.
    if (text != nullptr && text != reinterpret_cast<const char*>(-1) &&
        std::strstr(text, "$<") == nullptr)
      reset += text;
  }
  const bool mouse = ::tigetstr("kmous") != nullptr;
  if (mouse) reset = "\x1b[?1000l\x1b[?1006l" + reset;
  rescue.reset_size = std::min(reset.size(), rescue.reset.size());
  std::copy_n(reset.data(), rescue.reset_size, rescue.reset.data());
  rescue.armed = true;
}

// REQUIRES: Ctrl-Z was pressed. Returns when the process is in the foreground again.
void Terminal::State::suspend() {
  ::endwin();
  handle(SIGTSTP, SIG_DFL);
  ::raise(SIGTSTP);
  handle(SIGTSTP, on_stop);
  stop_asked = false;
}

attr_t Terminal::State::attributes(Tone tone) const {
  switch (tone) {
    case Tone::kTitle: return A_BOLD;
    case Tone::kFaint: return A_DIM;
    case Tone::kBad: return A_BOLD;
    default: return A_NORMAL;
  }
}

short Terminal::State::pair(Tone tone) const {
  return colour && colour_of(tone) >= 0 ? static_cast<short>(colour_of(tone)) : short{0};
}

Terminal::Terminal() : state_(std::make_unique<State>()) {
  ::tcgetattr(STDIN_FILENO, &rescue.modes);
  // Before newterm: ncurses leaves a signal alone that has a handler. Its own handling ignores
  // SIGTSTP during each refresh, and a Ctrl-Z pressed then is lost.
  handle(SIGTSTP, on_stop);
  const std::string name = usable_terminal_name();
  state_->screen = ::newterm(name.c_str(), stdout, stdin);
  if (state_->screen == nullptr) {
    handle(SIGTSTP, SIG_DFL);
    throw std::runtime_error("the terminal '" + name + "' cannot be used; --plain prints lines");
  }
  ::set_term(state_->screen);
  ::cbreak();
  ::noecho();
  ::nonl();
  ::intrflush(stdscr, FALSE);
  ::keypad(stdscr, TRUE);
  ::nodelay(stdscr, TRUE);
  ::set_escdelay(kEscapeWait);
  ::typeahead(-1);  // draws complete frames even during input
  ::curs_set(0);
  state_->colour = output_screen().colour && ::has_colors();
  if (state_->colour) {
    ::start_color();
    ::use_default_colors();
    for (const short one : {short{COLOR_RED}, short{COLOR_GREEN}, short{COLOR_YELLOW}})
      ::init_pair(one, one, -1);
  }
  ::mouseinterval(0);
  ::mousemask(BUTTON1_PRESSED | BUTTON1_CLICKED | BUTTON4_PRESSED | BUTTON5_PRESSED, nullptr);
  state_->arm();
  handle(SIGCONT, on_continue);
  for (const int signal : kCrashes) handle(signal, on_crash);
}

Terminal::~Terminal() {
  ::mousemask(0, nullptr);
  ::endwin();
  rescue.armed = false;
  for (const int signal : kCrashes) handle(signal, SIG_DFL);
  handle(SIGTSTP, SIG_DFL);
  handle(SIGCONT, SIG_DFL);
  ::delscreen(state_->screen);
}

std::optional<Key> Terminal::key(Instant until) {
  for (;;) {
    if (stop_asked) {
      state_->suspend();
      continued = true;
    }
    if (continued.exchange(false)) {
      ::reset_prog_mode();
      ::clearok(curscr, TRUE);
      return Key{Key::Kind::kRedraw};
    }
    wint_t character = 0;
    const int kind = ::get_wch(&character);
    std::optional<Key> key;
    if (kind == KEY_CODE_YES)
      key = character == KEY_MOUSE ? mouse_key() : key_of_code(static_cast<int>(character));
    else if (kind == OK)
      key = key_of_character(character);
    if (key) {
      if (key->kind == Key::Kind::kRedraw) ::clearok(curscr, TRUE);
      return key;
    }
    if (kind != ERR) continue;  // an unused key
    const auto left = until - instant_now();
    if (left <= Duration{}) return std::nullopt;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const timespec time{static_cast<std::time_t>(left.count() / 1'000'000'000),
                        static_cast<long>(left.count() % 1'000'000'000)};
    ::ppoll(&input, 1, &time, nullptr);  // a signal also ends it
    if ((input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) {
      // The terminal was closed; SIGHUP ends the command.
      ::ppoll(nullptr, 0, &time, nullptr);
      return std::nullopt;
    }
  }
}

void Terminal::draw(const Frame& frame) {
  const Screen screen = size();
  ::erase();
  const std::size_t rows = std::min(frame.lines.size(), screen.rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const FrameLine& line = frame.lines[row];
    ::move(static_cast<int>(row), 0);
    for (const Span& span : line.spans) {
      const attr_t inverse = line.inverse ? A_REVERSE : A_NORMAL;
      ::attr_set(state_->attributes(span.tone) | inverse, state_->pair(span.tone), nullptr);
      ::addnstr(span.text.data(), static_cast<int>(span.text.size()));
    }
    ::attr_set(A_NORMAL, 0, nullptr);
  }
  if (frame.cursor) {
    ::curs_set(1);
    ::move(static_cast<int>(frame.cursor->first), static_cast<int>(frame.cursor->second));
  } else {
    ::curs_set(0);
  }
  ::refresh();
}

Screen Terminal::size() const {
  Screen screen{static_cast<std::size_t>(std::max(1, getmaxx(stdscr))),
                static_cast<std::size_t>(std::max(1, getmaxy(stdscr))), state_->colour};
  return screen;
}

}  // namespace fieldcast::cli
