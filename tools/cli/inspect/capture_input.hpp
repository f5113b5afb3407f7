#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "tools/cli/inspect/frame_report.hpp"
#include "tools/cli/text/exit_code.hpp"

namespace fieldcast::cli {

// True for pcapng, and for pcap, which is refused later. Consumes nothing. Main thread.
[[nodiscard]] bool is_capture(std::istream& in);

// "x.pcapng": such a word is never a protocol.
[[nodiscard]] bool has_name_of_capture(std::string_view path);

// Prints a read fault to `err` after the frames before it. Returns kFound for an invalid frame or a
// truncated capture, kUsage if it is not a capture.
[[nodiscard]] ExitCode show_capture(std::istream& in, const std::string& name, FrameReport& report,
                                    std::ostream& err);

// Returns false if no line belongs to a trace.
[[nodiscard]] bool show_trace(std::string_view text, FrameReport& report);

}  // namespace fieldcast::cli
