// What a LineWriter needs of the operating system. Only for bridge/log, and for the file of Windows
// that takes the place of log_output.cpp.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>

namespace fieldcast {

// Largest write. poll() reports a pipe as writable if this many bytes do not block (PIPE_BUF of
// Linux, pipe(7)). The thread therefore waits in poll(), where it can be ended, and rarely in
// write().
inline constexpr std::size_t kOutputPiece = 4096;

// Returns a descriptor of the same file that child processes do not inherit, or -1.
[[nodiscard]] int duplicate_output(int fd);

// Writes at most kOutputPiece bytes of the text. Returns how many were written: 0 if none could be
// within 100 ms. Empty if the descriptor refuses bytes, or is invalid.
[[nodiscard]] std::optional<std::size_t> write_output(int fd, std::string_view text);

// Starts a thread that is never joined. It handles no signals.
void start_output_thread(std::function<void()> run);

}  // namespace fieldcast
